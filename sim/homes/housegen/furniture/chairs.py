"""Dining chairs.

Sizes follow Panero & Zelnik, Human Dimension and Interior Space (seat 0.40-0.48 m high and 0.39-0.46 m deep, back to
0.78-1.02 m) and Neufert, Architects' Data (dining chairs 0.40-0.50 m wide).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, loft, strip
from sim.homes.housegen.furniture.workbench import Workbench

DINING_KG = 5.0


@dataclass(frozen=True)
class _Frame:
    """The main dimensions of a chair; x from `back` to `front`, y from -half to half."""

    back: float
    front: float
    half: float
    seat: float
    height: float
    rake: float
    """Distance along x from the rear edge of the seat to the top of the back."""

    def back_x(self, z: float) -> float:
        """Returns the x of the back at height z."""
        return self.back - self.rake * max(0.0, z - self.seat) / (self.height - self.seat)


def _dining_frame(w: Workbench, low: float = 0.80, high: float = 0.96) -> _Frame:
    """Draws the dimensions of a dining chair between `low` and `high` metres high."""
    w.mass_kg = DINING_KG
    depth, width = w.length(0.39, 0.45), w.length(0.40, 0.47)
    return _Frame(
        -0.5 * depth, 0.5 * depth, 0.5 * width, w.length(0.43, 0.47), w.length(low, high), w.length(0.04, 0.10)
    )


def _wooden_frame(w: Workbench, f: _Frame, wood: Look, thick: float) -> None:
    """Adds front legs, raked back posts and four seat rails."""
    inset = 0.5 * thick
    for side in BOTH_SIDES:
        y = side * (f.half - inset)
        w.box((f.front - thick, f.front), around(y, inset), (0.0, f.seat - 0.02), wood)
        w.bar((f.back + inset - 0.03, y, 0.0), (f.back + inset, y, f.seat), thick, thick, wood)
        w.bar((f.back + inset, y, f.seat - 0.01), (f.back_x(f.height) + inset, y, f.height), thick, thick, wood)
        w.box((f.back + thick, f.front - thick), around(y, 0.01), (f.seat - 0.08, f.seat - 0.02), wood)
    for x in (f.back + inset, f.front - inset):
        w.box(around(x, 0.01), (-f.half + thick, f.half - thick), (f.seat - 0.08, f.seat - 0.02), wood)


def _crossbar(w: Workbench, f: _Frame, z: tuple[float, float], thick: float, look: Look, half: float) -> None:
    """Adds a level board of the back between heights z that follows the rake of the back."""
    x = f.back_x(0.5 * (z[0] + z[1])) + 0.5 * thick
    tilt = -math.atan2(f.rake, f.height - f.seat)
    w.box(around(x, 0.5 * thick), (-half, half), z, look, tilt=tilt)


def slat_back(w: Workbench) -> None:
    """Builds a wooden chair with upright slats between two rails and a flat or padded seat."""
    f, wood, thick = _dining_frame(w), w.look("wood"), w.length(0.03, 0.04)
    _wooden_frame(w, f, wood, thick)
    padded = w.chance(0.5)
    top = f.seat + (0.03 if padded else 0.0)
    w.box(
        (f.back + 0.02, f.front + 0.01), (-f.half, f.half), (f.seat - 0.02, top), w.look("fabric") if padded else wood
    )
    _crossbar(w, f, (f.height - 0.06, f.height), 0.022, wood, f.half - 0.5 * thick)
    low = f.seat + 0.14
    _crossbar(w, f, (low, low + 0.03), 0.02, wood, f.half - 0.5 * thick)
    slats = w.whole(3, 5)
    for i in range(slats):
        y = (i + 1) / (slats + 1) * 2 * f.half - f.half
        a, b = low + 0.02, f.height - 0.04
        w.bar((f.back_x(a) + 0.011, y, a), (f.back_x(b) + 0.011, y, b), 0.025, 0.012, wood)


def ladder_back(w: Workbench) -> None:
    """Builds a country chair with three or four rungs across the back, a woven seat and low stretchers."""
    f, wood, thick = _dining_frame(w, 0.92, 1.02), w.look("wood"), 0.034
    for side in BOTH_SIDES:
        y = side * (f.half - 0.5 * thick)
        w.cylinder((f.front - 0.02, y), (0.0, f.seat), 0.5 * thick, wood)
        w.cylinder((f.back + 0.02, y), (0.0, f.seat), 0.5 * thick, wood)
        w.rod((f.back + 0.02, y, f.seat), (f.back_x(f.height) + 0.02, y, f.height), 0.5 * thick, wood)
        w.rod_x((y, 0.16), (f.front - 0.02, f.back + 0.02), 0.011, wood)
    for x in (f.front - 0.02, f.back + 0.02):
        w.rod_y((x, 0.24), (-f.half + 0.02, f.half - 0.02), 0.011, wood)
    w.box((f.back + 0.01, f.front - 0.01), (-f.half + 0.01, f.half - 0.01), (f.seat - 0.04, f.seat), w.look("wicker"))
    rungs = w.whole(3, 4)
    for i in range(rungs):
        z = f.seat + 0.14 + (f.height - f.seat - 0.20) * i / (rungs - 1)
        _crossbar(w, f, (z, z + 0.05), 0.014, wood, f.half - thick)


def shell(w: Workbench) -> None:
    """Builds a moulded shell chair, seat and back in one curve, on four splayed dowels."""
    f, colour = _dining_frame(w, 0.78, 0.86), w.look("plastic")
    path = [
        (f.front + 0.02, f.seat - 0.05),
        (f.front - 0.02, f.seat - 0.005),
        (f.front - 0.10, f.seat),
        (0.0, f.seat - 0.015),
        (f.back + 0.06, f.seat - 0.01),
        (f.back + 0.015, f.seat + 0.035),
        (f.back - 0.01, f.seat + 0.10),
        (f.back_x(f.height - 0.05), f.height - 0.06),
        (f.back_x(f.height) - 0.01, f.height),
    ]
    w.mesh(strip(path[::-1], 0.012, 2 * f.half), (0.0, 0.0, 0.0), colour)
    for side in BOTH_SIDES:  # the rims of the seat are turned up
        y = side * (f.half - 0.004)
        w.bar((f.front - 0.02, y, f.seat + 0.004), (f.back + 0.04, y, f.seat + 0.02), 0.012, 0.035, colour, solid=False)
    legs = w.look("wood") if w.chance(0.6) else w.look("iron")
    w.legs((-0.11, 0.11), (-0.12, 0.12), (0.0, f.seat - 0.012), 0.028, legs, splay=0.085)
    w.box((-0.13, 0.13), (-0.14, 0.14), (f.seat - 0.035, f.seat - 0.010), w.look("iron"))


def parsons(w: Workbench) -> None:
    """Builds a fully upholstered chair on short wooden legs."""
    f, cloth, wood = _dining_frame(w, 0.92, 1.02), w.look("fabric"), w.look("wood")
    w.mesh(chamfered_box((f.front - f.back, 2 * f.half, 0.13), 0.02), (0.0, 0.0, f.seat - 0.055), cloth)
    height = f.height - f.seat + 0.10
    tilt = -math.atan2(f.rake, height)
    centre_x = 0.5 * (f.back + f.back_x(f.height)) + 0.035
    w.mesh(chamfered_box((0.075, 2 * f.half, height), 0.02), (centre_x, 0.0, f.height - 0.5 * height), cloth, tilt=tilt)
    w.legs((f.back + 0.01, f.front - 0.01), (-f.half + 0.01, f.half - 0.01), (0.0, f.seat - 0.11), 0.042, wood)


def cantilever(w: Workbench) -> None:
    """Builds a chair of bent steel tube without back legs, its seat and back of leather or cane."""
    f, tube = _dining_frame(w, 0.78, 0.86), w.look("chrome")
    cover = w.look("leather") if w.chance(0.5) else w.look("wicker")
    r = 0.0125
    for side in BOTH_SIDES:
        y = side * (f.half - r)
        corners = [
            (f.back - 0.02, y, r),
            (f.front, y, r),
            (f.front, y, f.seat - 0.015),
            (f.back + 0.02, y, f.seat - 0.015),
            (f.back_x(f.height), y, f.height),
        ]
        w.bent_rod(corners, r, tube)
    w.rod_y((f.back - 0.02, r), (-f.half + r, f.half - r), r, tube)
    w.box((f.back + 0.04, f.front), (-f.half + 0.005, f.half - 0.005), around(f.seat, 0.015), cover)
    _crossbar(w, f, (f.height - 0.20, f.height - 0.01), 0.03, cover, f.half - 0.005)


def cafe_metal(w: Workbench) -> None:
    """Builds a pressed steel bistro chair with flared legs and one broad splat in a hooped back."""
    f, steel = _dining_frame(w, 0.82, 0.88), w.look("lacquer") if w.chance(0.5) else w.look("metal")
    w.mesh(chamfered_box((f.front - f.back, 2 * f.half - 0.02, 0.03), 0.01), (0.0, 0.0, f.seat - 0.015), steel)
    w.legs(
        (f.back + 0.04, f.front - 0.03), (-f.half + 0.04, f.half - 0.04), (0.0, f.seat - 0.01), 0.03, steel, splay=0.04
    )
    top = f.height - 0.012
    for side in BOTH_SIDES:
        w.rod(
            (f.back + 0.02, side * (f.half - 0.03), f.seat - 0.01),
            (f.back_x(top), side * (f.half - 0.05), top),
            0.012,
            steel,
            round_ends=True,
        )
    w.rod_y((f.back_x(top), top), (-f.half + 0.05, f.half - 0.05), 0.012, steel)
    w.bar((f.back + 0.015, 0.0, f.seat - 0.005), (f.back_x(top), 0.0, top), 0.13, 0.008, steel)


def windsor(w: Workbench) -> None:
    """Builds a chair with a saddle seat, splayed turned legs and a bow full of spindles."""
    f, wood = _dining_frame(w, 0.88, 1.0), w.look("wood")
    f = _Frame(f.back, f.front, f.half, f.seat, f.height, f.rake + 0.05)
    rim = [Ring(f.seat - 0.04, 0.9 * f.front, 0.9 * f.half, power=2.6), Ring(f.seat, f.front, f.half, power=2.6)]
    w.mesh(loft(rim, 14, hull=True), (0.0, 0.0, 0.0), wood)
    w.legs((-0.11, 0.12), (-0.13, 0.13), (0.0, f.seat - 0.02), 0.036, wood, splay=0.075)
    w.rod_y((0.0, 0.17), (-0.17, 0.17), 0.010, wood)
    for side in BOTH_SIDES:
        w.rod_x((side * 0.173, 0.17), (-0.15, 0.16), 0.010, wood)
    bow = []
    for i in range(7):
        angle = math.pi * i / 6
        z = f.seat + (f.height - f.seat - 0.012) * math.sin(angle) ** 0.6
        bow.append((f.back_x(z) + 0.05, 0.92 * f.half * math.cos(angle), z))
    w.bent_rod(bow, 0.012, wood)
    for i in range(1, 6):
        x, y, z = bow[i]
        w.rod((f.back + 0.05, 0.8 * y, f.seat - 0.01), (x, y, z), 0.007, wood)


def cross_back(w: Workbench) -> None:
    """Builds a bentwood chair with a round seat and crossed staves."""
    f, wood = _dining_frame(w, 0.86, 0.92), w.look("wood")
    w.cylinder((0.0, 0.0), (f.seat - 0.035, f.seat), f.half, w.look("wicker"))
    w.cylinder((0.0, 0.0), (f.seat - 0.06, f.seat - 0.008), f.half - 0.012, wood)
    for side in BOTH_SIDES:
        w.rod(
            (0.6 * f.half, side * 0.62 * f.half, f.seat - 0.02), (0.72 * f.half, side * 0.75 * f.half, 0.0), 0.016, wood
        )
        w.rod(
            (-0.75 * f.half - 0.03, side * 0.72 * f.half, 0.0),
            (-0.66 * f.half, side * 0.66 * f.half, f.seat),
            0.016,
            wood,
        )
        w.rod(
            (-0.66 * f.half, side * 0.66 * f.half, f.seat),
            (f.back_x(f.height), side * 0.80 * f.half, f.height - 0.06),
            0.014,
            wood,
            round_ends=True,
        )
        w.rod(
            (-0.7 * f.half, side * 0.62 * f.half, f.seat + 0.03),
            (f.back_x(f.height), -side * 0.6 * f.half, f.height - 0.02),
            0.010,
            wood,
        )
    arch = [
        (f.back_x(f.height), y * f.half, f.height - dz)
        for y, dz in ((-0.80, 0.06), (-0.5, 0.015), (0.5, 0.015), (0.80, 0.06))
    ]
    w.bent_rod(arch, 0.015, wood)


STYLES = (
    Style("chair", "slat_back", "train", slat_back, ("dining",)),
    Style("chair", "ladder_back", "train", ladder_back, ("dining",)),
    Style("chair", "shell", "train", shell, ("dining",)),
    Style("chair", "parsons", "train", parsons, ("dining",)),
    Style("chair", "cantilever", "train", cantilever, ("dining",)),
    Style("chair", "cafe_metal", "train", cafe_metal, ("dining",)),
    Style("chair", "windsor", "heldout", windsor, ("dining",)),
    Style("chair", "cross_back", "heldout", cross_back, ("dining",)),
)
