"""Toilets.

Sizes follow Neufert, Architects' Data: 0.35-0.42 m wide, 0.60-0.72 m deep, seat 0.39-0.45 m high.
"""

from __future__ import annotations

from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.shapes import Ring, chamfered_box, loft
from sim.housegen.furniture.workbench import Workbench


def _pan(w: Workbench, x0: float, x1: float, half: float, seat: float, look: Look, *, base: float = 0.6) -> None:
    """Adds a bowl from the wall side x0 to its nose x1, with a seat ring and a lid up to height `seat`."""
    middle, r = x1 - 0.5 * (x1 - x0), 0.5 * (x1 - x0)
    rings = [
        Ring(0.0, base * r, base * half, middle - 0.15 * r, power=2.6),
        Ring(0.35 * seat, (base - 0.04) * r, (base - 0.08) * half, middle - 0.15 * r, power=2.4),
        Ring(seat - 0.10, 0.95 * r, 0.95 * half, middle, power=2.2),
        Ring(seat - 0.04, r, half, middle, power=2.2),
    ]
    w.mesh(loft(rings, 14, hull=True), (0.0, 0.0, 0.0), look)


def _seat_and_lid(w: Workbench, x0: float, x1: float, half: float, seat: float, look: Look, *, open_: bool) -> None:
    middle, r = 0.5 * (x0 + x1), 0.5 * (x1 - x0)
    rings = [
        Ring(seat - 0.042, r, half, middle, power=2.2),
        Ring(seat, r, half, middle, power=2.2),
        Ring(seat, 0.66 * r, 0.64 * half, middle + 0.02, power=2.0),
        Ring(seat - 0.03, 0.60 * r, 0.58 * half, middle + 0.02, power=2.0),
    ]
    if open_:
        w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
        w.ellipsoid((middle + 0.02, 0.0, seat - 0.028), (0.58 * r, 0.56 * half, 0.003), w.look("screen"), solid=False)
        w.mesh(
            loft([Ring(0.0, r, half, power=2.2), Ring(0.018, 0.97 * r, 0.97 * half, power=2.2)], 16, hull=True),
            (x0 + 0.015, 0.0, seat + r),
            look,
            tilt=-1.48,
        )
    else:
        w.mesh(
            loft([*rings[:2], Ring(seat + 0.02, 0.96 * r, 0.96 * half, middle, power=2.2)], 16, hull=True),
            (0.0, 0.0, 0.0),
            look,
        )


def close_coupled(w: Workbench) -> None:
    """Builds a floor-standing pan with its cistern behind it."""
    white, half, seat = w.look("ceramic"), 0.5 * w.length(0.36, 0.40), w.length(0.40, 0.43)
    depth = w.length(0.62, 0.70)
    x0 = -0.5 * depth
    w.mesh(chamfered_box((0.18, 2 * half + 0.02, 0.36), 0.025), (x0 + 0.09, 0.0, seat + 0.16), white)
    w.mesh(chamfered_box((0.20, 2 * half + 0.04, 0.035), 0.012), (x0 + 0.10, 0.0, seat + 0.355), white)
    w.cylinder((x0 + 0.10, 0.0), (seat + 0.37, seat + 0.38), 0.025, w.look("chrome"), solid=False)
    w.box((x0 + 0.02, x0 + 0.25), (-0.10, 0.10), (0.0, seat - 0.01), white)
    _pan(w, x0 + 0.15, 0.5 * depth, half, seat, white)
    _seat_and_lid(w, x0 + 0.19, 0.5 * depth, half, seat, white, open_=w.chance(0.5))


def wall_hung(w: Workbench) -> None:
    """Builds a pan on a boxed-in cistern with a flush plate."""
    white, half, seat = w.look("ceramic"), 0.5 * w.length(0.35, 0.38), w.length(0.40, 0.43)
    boxed = w.look("lacquer")
    w.box((-0.36, -0.18), (-0.42, 0.42), (0.0, 1.12), boxed)
    w.box((-0.18, -0.172), (-0.12, 0.12), (0.90, 1.06), w.look("chrome"), solid=False)
    rings = [
        Ring(0.10, 0.12, 0.10, -0.08, power=2.6),
        Ring(0.20, 0.20, 0.85 * half, 0.0, power=2.4),
        Ring(seat - 0.04, 0.265, half, 0.075, power=2.4),
    ]
    w.mesh(loft(rings, 14, hull=True), (0.0, 0.0, 0.0), white)
    w.box((-0.19, -0.04), (-0.8 * half, 0.8 * half), (0.16, seat - 0.04), white)
    _seat_and_lid(w, -0.17, 0.34, half, seat, white, open_=w.chance(0.3))


def high_cistern(w: Workbench) -> None:
    """Builds an old toilet with a high cistern on the wall, a pipe and a wooden seat."""
    white, wood, brass, half, seat = w.look("ceramic"), w.look("wood"), w.look("brass"), 0.19, w.length(0.41, 0.44)
    x0 = -0.30
    w.box((x0 + 0.02, x0 + 0.20), (-0.10, 0.10), (0.10, seat - 0.05), white)
    _pan(w, x0 + 0.06, 0.30, half, seat, white, base=0.55)
    _seat_and_lid(w, x0 + 0.10, 0.30, half, seat, wood, open_=True)
    w.rod((x0 + 0.04, 0.0, 0.30), (x0 + 0.04, 0.0, 1.70), 0.018, brass)
    w.box((x0, x0 + 0.19), (-0.24, 0.24), (1.68, 2.0), white)
    w.box((x0, x0 + 0.20), (-0.25, 0.25), (2.0, 2.02), wood)
    w.rod((x0 + 0.15, 0.22, 1.05), (x0 + 0.15, 0.22, 1.69), 0.004, brass, solid=False)
    w.ball((x0 + 0.15, 0.22, 1.04), 0.02, wood, solid=False)
    for z in (0.8, 1.4):
        w.box((x0, x0 + 0.05), (-0.03, 0.03), (z, z + 0.02), brass, solid=False)


def low_level(w: Workbench) -> None:
    """Builds a toilet with a cistern at shoulder height, joined to the pan by a bent pipe, and a lever."""
    white, chrome, half, seat = w.look("ceramic"), w.look("chrome"), 0.5 * w.length(0.36, 0.39), w.length(0.40, 0.43)
    x0 = -0.34
    w.mesh(chamfered_box((0.18, 0.46, 0.34), 0.03), (x0 + 0.09, 0.0, 0.86), white)
    w.mesh(chamfered_box((0.20, 0.48, 0.03), 0.012), (x0 + 0.10, 0.0, 1.04), white)
    w.rod((x0 + 0.18, -0.15, 0.96), (x0 + 0.20, -0.15, 0.96), 0.012, chrome, solid=False)
    w.bar((x0 + 0.205, -0.15, 0.96), (x0 + 0.205, -0.07, 0.94), 0.012, 0.012, chrome, solid=False)
    w.rod((x0 + 0.09, 0.0, 0.28), (x0 + 0.09, 0.0, 0.72), 0.022, chrome)
    w.rod((x0 + 0.09, 0.0, 0.30), (x0 + 0.22, 0.0, 0.30), 0.022, chrome, round_ends=True)
    w.box((x0 + 0.03, x0 + 0.2), (-0.09, 0.09), (0.0, 0.28), white)
    _pan(w, x0 + 0.10, 0.32, half, seat, white)
    _seat_and_lid(w, x0 + 0.16, 0.32, half, seat, white, open_=w.chance(0.5))


def square_modern(w: Workbench) -> None:
    """Builds a rounded block with a flat lid, straight sides down to the floor, and a cistern as wide as the pan."""
    white, half, seat = w.look("ceramic"), 0.5 * w.length(0.35, 0.38), w.length(0.41, 0.44)
    depth = w.length(0.62, 0.68)
    x0 = -0.5 * depth
    w.mesh(
        loft(
            [
                Ring(0.0, 0.5 * (depth - 0.12), 0.92 * half, 0.02, power=5),
                Ring(seat - 0.04, 0.5 * (depth - 0.02), half, 0.01, power=5),
            ],
            16,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        white,
    )
    w.box((x0, x0 + 0.15), (-half, half), (seat - 0.05, seat + 0.36), white)
    w.mesh(
        loft(
            [
                Ring(seat - 0.035, 0.5 * (depth - 0.16), half, 0.08, power=5),
                Ring(seat + 0.012, 0.5 * (depth - 0.17), 0.98 * half, 0.08, power=5),
            ],
            16,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        white,
    )
    w.box((x0 + 0.03, x0 + 0.12), (-0.06, 0.06), (seat + 0.36, seat + 0.366), w.look("chrome"), solid=False)


def one_piece(w: Workbench) -> None:
    """Builds a skirted toilet whose tank and pan form one curve."""
    white, half, seat = w.look("ceramic"), 0.5 * w.length(0.37, 0.41), w.length(0.40, 0.43)
    x0 = -0.35
    rings = [
        Ring(0.0, 0.30, 0.75 * half, 0.0, power=3),
        Ring(0.22, 0.29, 0.78 * half, -0.01, power=3),
        Ring(seat - 0.04, 0.345, half, 0.0, power=2.4),
    ]
    w.mesh(loft(rings, 16, hull=True), (0.0, 0.0, 0.0), white)
    tank = [
        Ring(seat - 0.06, 0.13, half, x0 + 0.13, power=4),
        Ring(seat + 0.14, 0.10, 0.96 * half, x0 + 0.10, power=4),
        Ring(seat + 0.30, 0.10, half, x0 + 0.10, power=4),
    ]
    w.mesh(loft(tank, 16, hull=True), (0.0, 0.0, 0.0), white)
    w.cylinder((x0 + 0.10, 0.0), (seat + 0.298, seat + 0.306), 0.03, w.look("chrome"), solid=False)
    _seat_and_lid(w, x0 + 0.22, 0.345, half, seat, white, open_=w.chance(0.4))


STYLES = (
    Style("toilet", "close_coupled", "train", close_coupled),
    Style("toilet", "wall_hung", "train", wall_hung),
    Style("toilet", "high_cistern", "heldout", high_cistern),
    Style("toilet", "low_level", "train", low_level),
    Style("toilet", "square_modern", "train", square_modern),
    Style("toilet", "one_piece", "heldout", one_piece),
)
