"""Toilets.

Sizes follow Neufert, Architects' Data: 0.35-0.42 m wide, 0.60-0.72 m deep, seat 0.39-0.45 m high.
"""

from __future__ import annotations

from dataclasses import replace

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, loft
from sim.homes.housegen.furniture.workbench import Workbench

Profile = tuple[tuple[float, float, float, float], ...]
"""Rings of a pan, each with its height as a share of the height of the rim, its half depth and half width as shares of
those of the rim, and how far it is moved to the wall as a share of the half depth of the rim."""
PEDESTAL: Profile = ((0.0, 0.66, 0.62, 0.3), (0.12, 0.6, 0.56, 0.3), (0.5, 0.62, 0.6, 0.28), (0.78, 0.9, 0.92, 0.06))
"""A narrow foot under a wide bowl."""
SKIRTED: Profile = ((0.0, 0.86, 0.78, 0.12), (0.3, 0.84, 0.78, 0.13), (0.75, 0.93, 0.92, 0.05))
"""Nearly straight sides."""
_SEAT_M = 0.020
"""Thickness of a seat."""


def water_look(ceramic: Look) -> Look:
    """Returns the look of shallow water on ceramic: a little darker and bluer."""
    r, g, b, a = ceramic.rgba
    return replace(ceramic, rgba=(round(0.76 * r, 3), round(0.86 * g, 3), round(0.92 * b, 3), a), texture=None)


def bowl_rings(rim: float, r: float, half: float, middle: float, power: float) -> list[Ring]:
    """Returns the rings of the hollow of a pan, from its rim at the height `rim` inwards and down to its bottom."""
    return [
        Ring(rim, 0.76 * r, 0.74 * half, middle + 0.02, power=power),
        Ring(rim - 0.06, 0.66 * r, 0.64 * half, middle + 0.02, power=power),
        Ring(rim - 0.15, 0.34 * r, 0.34 * half, middle, power=power),
    ]


def _toilet(
    w: Workbench, x: tuple[float, float], half: float, seat: float, look: Look, cover: Look, *, profile: Profile,
    open_: bool, seat_x: float, low: float = 0.0, power: float = 2.3,
) -> None:  # fmt: skip
    """Adds a pan with its seat and its lid: the top of the seat is at the height `seat`, the lid is up if `open_`.

    Args:
        w: the workbench.
        x: wall side and nose of the pan.
        half: half width of the pan.
        seat: height of the top of the seat.
        look: look of the pan.
        cover: look of the seat and the lid.
        profile: outline of the pan below its rim.
        open_: whether the lid is up, so that the bowl is visible.
        seat_x: the wall side of the seat.
        low: height of the lowest point of the pan.
        power: shape of the rings; 2 is an ellipse.
    """
    middle, r, rim = 0.5 * (x[0] + x[1]), 0.5 * (x[1] - x[0]), seat - _SEAT_M
    rings = [Ring(low + z * (rim - low), a * r, b * half, middle - back * r, power=power) for z, a, b, back in profile]
    rings += [Ring(rim - 0.03, r, half, middle, power=power), Ring(rim, 0.985 * r, 0.97 * half, middle, power=power)]
    middle, r = 0.5 * (seat_x + x[1]), 0.5 * (x[1] - seat_x)
    if open_:
        rings += bowl_rings(rim, r, half, middle, power)
        w.ellipsoid((middle, 0.0, rim - 0.135), (0.39 * r, 0.38 * half, 0.004), water_look(look), solid=False)
    w.mesh(loft(rings, 14), (0.0, 0.0, 0.0), look)
    flat = [Ring(0.0, r, half, power=power), Ring(_SEAT_M, 0.985 * r, 0.98 * half, power=power)]
    hole = [Ring(z, 0.66 * r, 0.64 * half, 0.02, power=2.0) for z in (_SEAT_M, 0.0)]
    lid = [Ring(0.0, 0.99 * r, 0.99 * half, power=power), Ring(0.012, 0.99 * r, 0.99 * half, power=power)]
    lid = loft([*lid, Ring(0.024, 0.9 * r, 0.9 * half, power=power)], 14, hull=True)
    if open_:
        w.mesh(loft([*flat, *hole], 14, loop=True), (middle, 0.0, rim), cover)
        w.mesh(lid, (seat_x + 0.035, 0.0, seat + r - 0.005), cover, tilt=-1.48)
    else:
        w.mesh(loft(flat, 14, hull=True), (middle, 0.0, rim), cover)
        w.mesh(lid, (middle, 0.0, seat + 0.002), cover)
    for side in BOTH_SIDES:
        w.box((seat_x - 0.01, seat_x + 0.035), around(side * 0.08, 0.015), (rim, seat + 0.006), cover,
              solid=False)  # fmt: skip


def close_coupled(w: Workbench) -> None:
    """Builds a floor-standing pan with its cistern behind it."""
    white, half, seat = w.look("ceramic"), 0.5 * w.length(0.36, 0.40), w.length(0.40, 0.43)
    depth = w.length(0.62, 0.70)
    x0 = -0.5 * depth
    w.mesh(chamfered_box((0.18, 2 * half + 0.02, 0.36), 0.025), (x0 + 0.09, 0.0, seat + 0.16), white)
    w.mesh(chamfered_box((0.20, 2 * half + 0.04, 0.035), 0.012), (x0 + 0.10, 0.0, seat + 0.355), white)
    w.cylinder((x0 + 0.10, 0.0), (seat + 0.37, seat + 0.38), 0.025, w.look("chrome"), solid=False)
    w.box((x0 + 0.02, x0 + 0.28), (-0.10, 0.10), (0.0, seat - 0.022), white)
    _toilet(w, (x0 + 0.15, 0.5 * depth), half, seat, white, white, profile=PEDESTAL, open_=w.chance(0.5),
            seat_x=x0 + 0.2)  # fmt: skip


def wall_hung(w: Workbench) -> None:
    """Builds a pan on a slim sanitary module, which holds the cistern, with a flush plate."""
    white, half, seat = w.look("ceramic"), 0.5 * w.length(0.35, 0.38), w.length(0.40, 0.43)
    boxed = w.look("lacquer")
    w.box((-0.36, -0.18), (-0.25, 0.25), (0.0, 1.0), boxed)
    w.box((-0.18, -0.172), (-0.12, 0.12), (0.80, 0.94), w.look("chrome"), solid=False)
    profile = ((0.0, 0.42, 0.5, 0.5), (0.2, 0.68, 0.78, 0.28), (0.6, 0.92, 0.96, 0.06))
    w.box((-0.19, -0.04), (-0.8 * half, 0.8 * half), (0.16, seat - 0.025), white)
    _toilet(w, (-0.19, 0.34), half, seat, white, white, profile=profile, open_=w.chance(0.5), seat_x=-0.13, low=0.08)


def high_cistern(w: Workbench) -> None:
    """Builds an old toilet with a high cistern on the wall, a pipe and a wooden seat."""
    white, wood, brass, half, seat = w.look("ceramic"), w.look("wood"), w.look("brass"), 0.19, w.length(0.41, 0.44)
    x0 = -0.30
    w.box((x0 + 0.02, x0 + 0.24), (-0.09, 0.09), (0.12, seat - 0.03), white)
    _toilet(w, (x0 + 0.06, 0.30), half, seat, white, wood, profile=PEDESTAL, open_=True, seat_x=x0 + 0.10)
    w.cylinder((x0 + 0.04, 0.0), (0.30, 1.70), 0.018, brass)
    w.box((x0, x0 + 0.19), (-0.24, 0.24), (1.68, 2.0), white)
    w.box((x0, x0 + 0.20), (-0.25, 0.25), (2.0, 2.02), wood)
    w.cylinder((x0 + 0.15, 0.22), (1.05, 1.69), 0.004, brass, solid=False)
    w.ball((x0 + 0.15, 0.22, 1.04), 0.02, wood, solid=False)
    for z in (0.8, 1.4):
        w.box((x0, x0 + 0.05), (-0.03, 0.03), (z, z + 0.02), brass, solid=False)


def low_level(w: Workbench) -> None:
    """Builds a toilet with a cistern at shoulder height, joined to the pan by a bent pipe, and a lever."""
    white, chrome, half, seat = w.look("ceramic"), w.look("chrome"), 0.5 * w.length(0.36, 0.39), w.length(0.40, 0.43)
    x0 = -0.34
    w.mesh(chamfered_box((0.18, 0.46, 0.34), 0.03), (x0 + 0.09, 0.0, 0.86), white)
    w.mesh(chamfered_box((0.20, 0.48, 0.03), 0.012), (x0 + 0.10, 0.0, 1.04), white)
    w.rod_x((-0.15, 0.96), (x0 + 0.18, x0 + 0.20), 0.012, chrome, solid=False)
    w.bar((x0 + 0.205, -0.15, 0.96), (x0 + 0.205, -0.07, 0.94), 0.012, 0.012, chrome, solid=False)
    w.cylinder((x0 + 0.09, 0.0), (0.28, 0.72), 0.022, chrome)
    w.rod_x((0.0, 0.30), (x0 + 0.09, x0 + 0.22), 0.022, chrome, round_ends=True)
    w.box((x0 + 0.03, x0 + 0.26), (-0.09, 0.09), (0.0, 0.29), white)
    _toilet(w, (x0 + 0.10, 0.32), half, seat, white, white, profile=PEDESTAL, open_=w.chance(0.5), seat_x=x0 + 0.16)


def square_modern(w: Workbench) -> None:
    """Builds a rounded block with a flat lid, straight sides down to the floor, and a cistern as wide as the pan."""
    white, half, seat = w.look("ceramic"), 0.5 * w.length(0.35, 0.38), w.length(0.41, 0.44)
    depth = w.length(0.62, 0.68)
    x0 = -0.5 * depth
    profile = ((0.0, 0.93, 0.90, 0.05), (0.05, 0.93, 0.90, 0.05), (0.8, 0.99, 0.98, 0.01))
    _toilet(w, (x0 + 0.01, 0.5 * depth), half, seat, white, white, profile=profile, open_=w.chance(0.4),
            seat_x=x0 + 0.17, power=4.0)  # fmt: skip
    w.mesh(chamfered_box((0.15, round(2 * half, 3), 0.41), 0.02), (x0 + 0.075, 0.0, seat + 0.155), white)
    w.box((x0 + 0.03, x0 + 0.12), (-0.06, 0.06), (seat + 0.36, seat + 0.366), w.look("chrome"), solid=False)


def one_piece(w: Workbench) -> None:
    """Builds a skirted toilet: its tank and pan form one curve."""
    white, half, seat = w.look("ceramic"), 0.5 * w.length(0.37, 0.41), w.length(0.40, 0.43)
    x0 = -0.35
    _toilet(w, (x0 + 0.01, 0.345), half, seat, white, white, profile=SKIRTED, open_=w.chance(0.5), seat_x=x0 + 0.21)
    tank = [
        Ring(seat - 0.06, 0.13, half, x0 + 0.13, power=4),
        Ring(seat + 0.14, 0.10, 0.96 * half, x0 + 0.10, power=4),
        Ring(seat + 0.285, 0.10, half, x0 + 0.10, power=4),
        Ring(seat + 0.30, 0.09, 0.96 * half, x0 + 0.10, power=4),
    ]
    w.mesh(loft(tank, 16, hull=True), (0.0, 0.0, 0.0), white)
    w.cylinder((x0 + 0.10, 0.0), (seat + 0.298, seat + 0.306), 0.03, w.look("chrome"), solid=False)


STYLES = (
    Style("toilet", "close_coupled", "train", close_coupled),
    Style("toilet", "wall_hung", "train", wall_hung),
    Style("toilet", "high_cistern", "heldout", high_cistern),
    Style("toilet", "low_level", "train", low_level),
    Style("toilet", "square_modern", "train", square_modern),
    Style("toilet", "one_piece", "heldout", one_piece),
)
