"""Chairs: dining, office and arm chairs.

Ranges after Panero & Zelnik, Human Dimension and Interior Space (seat 0.40-0.48 m high and 0.39-0.46 m deep, back
to 0.78-1.02 m, easy chairs 0.38-0.43 m high and 0.70-0.95 m wide), Neufert, Architects' Data (dining chairs
0.40-0.50 m wide) and EN 1335 (office chairs: seat 0.40-0.51 m, base 0.60-0.70 m across).
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.item import Look
from sim.houses.furniture.shapes import Ring, chamfered_box, loft, strip
from sim.houses.furniture.workbench import Workbench

DINING_KG, OFFICE_KG = 5.0, 12.0
_BOTH = (-1, 1)


@dataclass(frozen=True)
class _Frame:
    """A chair's main lengths; x from `back` to `front`, y from -half to half."""

    back: float
    front: float
    half: float
    seat: float
    height: float
    rake: float
    """How far the top of the back lies behind the seat's back edge."""

    def back_x(self, z: float) -> float:
        """Where the back is at height z."""
        return self.back - self.rake * max(0.0, z - self.seat) / (self.height - self.seat)


def _dining_frame(w: Workbench, low: float = 0.80, high: float = 0.96) -> _Frame:
    w.mass_kg = DINING_KG
    depth, width = w.length(0.39, 0.45), w.length(0.40, 0.47)
    return _Frame(
        -0.5 * depth, 0.5 * depth, 0.5 * width, w.length(0.43, 0.47), w.length(low, high), w.length(0.04, 0.10)
    )


def _wooden_frame(w: Workbench, f: _Frame, wood: Look, thick: float) -> None:
    """Front legs, raked back posts and four seat rails."""
    inset = 0.5 * thick
    for side in _BOTH:
        y = side * (f.half - inset)
        w.box((f.front - thick, f.front), (y - inset, y + inset), (0.0, f.seat - 0.02), wood)
        w.bar((f.back + inset - 0.03, y, 0.0), (f.back + inset, y, f.seat), thick, thick, wood)
        w.bar((f.back + inset, y, f.seat - 0.01), (f.back_x(f.height) + inset, y, f.height), thick, thick, wood)
        w.box((f.back + thick, f.front - thick), (y - 0.01, y + 0.01), (f.seat - 0.08, f.seat - 0.02), wood)
    for x in (f.back + inset, f.front - inset):
        w.box((x - 0.01, x + 0.01), (-f.half + thick, f.half - thick), (f.seat - 0.08, f.seat - 0.02), wood)


def _crossbar(
    w: Workbench, f: _Frame, z: tuple[float, float], thick: float, look: Look, half: float | None = None
) -> None:
    """A level board of the back between heights z, following its rake."""
    half = f.half if half is None else half
    x = f.back_x(0.5 * (z[0] + z[1])) + 0.5 * thick
    tilt = -math.atan2(f.rake, f.height - f.seat)
    w.box((x - 0.5 * thick, x + 0.5 * thick), (-half, half), z, look, tilt=tilt)


def slat_back(w: Workbench) -> None:
    """Wooden chair, upright slats between two rails, flat or padded seat."""
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
    """Country chair: three or four rungs across the back, woven seat, stretchers near the floor."""
    f, wood, thick = _dining_frame(w, 0.92, 1.02), w.look("wood"), 0.034
    for side in _BOTH:
        y = side * (f.half - 0.5 * thick)
        w.rod((f.front - 0.02, y, 0.0), (f.front - 0.02, y, f.seat), 0.5 * thick, wood)
        w.rod((f.back + 0.02, y, 0.0), (f.back + 0.02, y, f.seat), 0.5 * thick, wood)
        w.rod((f.back + 0.02, y, f.seat), (f.back_x(f.height) + 0.02, y, f.height), 0.5 * thick, wood)
        w.rod((f.front - 0.02, y, 0.16), (f.back + 0.02, y, 0.16), 0.011, wood)
    for x in (f.front - 0.02, f.back + 0.02):
        w.rod((x, -f.half + 0.02, 0.24), (x, f.half - 0.02, 0.24), 0.011, wood)
    w.box((f.back + 0.01, f.front - 0.01), (-f.half + 0.01, f.half - 0.01), (f.seat - 0.04, f.seat), w.look("wicker"))
    rungs = w.whole(3, 4)
    for i in range(rungs):
        z = f.seat + 0.14 + (f.height - f.seat - 0.20) * i / (rungs - 1)
        _crossbar(w, f, (z, z + 0.05), 0.014, wood, f.half - thick)


def shell(w: Workbench) -> None:
    """Moulded shell, seat and back in one curve, on four splayed dowels."""
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
    for side in _BOTH:  # turned-up rims stiffen the seat
        y = side * (f.half - 0.004)
        w.bar((f.front - 0.02, y, f.seat + 0.004), (f.back + 0.04, y, f.seat + 0.02), 0.012, 0.035, colour, solid=False)
    legs = w.look("wood") if w.chance(0.6) else w.look("iron")
    w.legs((-0.11, 0.11), (-0.12, 0.12), (0.0, f.seat - 0.012), 0.028, legs, splay=0.085)
    w.box((-0.13, 0.13), (-0.14, 0.14), (f.seat - 0.035, f.seat - 0.010), w.look("iron"))


def parsons(w: Workbench) -> None:
    """Upholstered all over, short wooden legs."""
    f, cloth, wood = _dining_frame(w, 0.92, 1.02), w.look("fabric"), w.look("wood")
    w.mesh(chamfered_box((f.front - f.back, 2 * f.half, 0.13), 0.02), (0.0, 0.0, f.seat - 0.055), cloth)
    height = f.height - f.seat + 0.10
    tilt = -math.atan2(f.rake, height)
    centre_x = 0.5 * (f.back + f.back_x(f.height)) + 0.035
    w.mesh(chamfered_box((0.075, 2 * f.half, height), 0.02), (centre_x, 0.0, f.height - 0.5 * height), cloth, tilt=tilt)
    w.legs((f.back + 0.01, f.front - 0.01), (-f.half + 0.01, f.half - 0.01), (0.0, f.seat - 0.11), 0.042, wood)


def cantilever(w: Workbench) -> None:
    """Bent steel tube without back legs; seat and back of leather or cane."""
    f, tube = _dining_frame(w, 0.78, 0.86), w.look("chrome")
    cover = w.look("leather") if w.chance(0.5) else w.look("wicker")
    r = 0.0125
    for side in _BOTH:
        y = side * (f.half - r)
        corners = [
            (f.back - 0.02, y, r),
            (f.front, y, r),
            (f.front, y, f.seat - 0.015),
            (f.back + 0.02, y, f.seat - 0.015),
            (f.back_x(f.height), y, f.height),
        ]
        for a, b in itertools.pairwise(corners):
            w.rod(a, b, r, tube, round_ends=True)
    w.rod((f.back - 0.02, -f.half + r, r), (f.back - 0.02, f.half - r, r), r, tube)
    w.box((f.back + 0.04, f.front), (-f.half + 0.005, f.half - 0.005), (f.seat - 0.015, f.seat + 0.015), cover)
    _crossbar(w, f, (f.height - 0.20, f.height - 0.01), 0.03, cover, f.half - 0.005)


def cafe_metal(w: Workbench) -> None:
    """Pressed steel bistro chair: flared legs, one broad splat in a hooped back."""
    f, steel = _dining_frame(w, 0.82, 0.88), w.look("lacquer") if w.chance(0.5) else w.look("metal")
    w.mesh(chamfered_box((f.front - f.back, 2 * f.half - 0.02, 0.03), 0.01), (0.0, 0.0, f.seat - 0.015), steel)
    w.legs(
        (f.back + 0.04, f.front - 0.03), (-f.half + 0.04, f.half - 0.04), (0.0, f.seat - 0.01), 0.03, steel, splay=0.04
    )
    top = f.height - 0.012
    for side in _BOTH:
        w.rod(
            (f.back + 0.02, side * (f.half - 0.03), f.seat - 0.01),
            (f.back_x(top), side * (f.half - 0.05), top),
            0.012,
            steel,
            round_ends=True,
        )
    w.rod((f.back_x(top), -f.half + 0.05, top), (f.back_x(top), f.half - 0.05, top), 0.012, steel)
    w.bar((f.back + 0.015, 0.0, f.seat - 0.005), (f.back_x(top), 0.0, top), 0.13, 0.008, steel)


def windsor(w: Workbench) -> None:
    """Saddle seat, turned splayed legs, a bow full of spindles."""
    f, wood = _dining_frame(w, 0.88, 1.0), w.look("wood")
    f = _Frame(f.back, f.front, f.half, f.seat, f.height, f.rake + 0.05)
    rim = [Ring(f.seat - 0.04, 0.9 * f.front, 0.9 * f.half, power=2.6), Ring(f.seat, f.front, f.half, power=2.6)]
    w.mesh(loft(rim, 14, hull=True), (0.0, 0.0, 0.0), wood)
    w.legs((-0.11, 0.12), (-0.13, 0.13), (0.0, f.seat - 0.02), 0.036, wood, splay=0.075)
    w.rod((0.0, -0.17, 0.17), (0.0, 0.17, 0.17), 0.010, wood)
    for side in _BOTH:
        w.rod((-0.15, side * 0.173, 0.17), (0.16, side * 0.173, 0.17), 0.010, wood)
    bow = []
    for i in range(7):
        angle = math.pi * i / 6
        z = f.seat + (f.height - f.seat - 0.012) * math.sin(angle) ** 0.6
        bow.append((f.back_x(z) + 0.05, 0.92 * f.half * math.cos(angle), z))
    for a, b in itertools.pairwise(bow):
        w.rod(a, b, 0.012, wood, round_ends=True)
    for i in range(1, 6):
        x, y, z = bow[i]
        w.rod((f.back + 0.05, 0.8 * y, f.seat - 0.01), (x, y, z), 0.007, wood)


def cross_back(w: Workbench) -> None:
    """Bentwood chair with a round seat and crossed staves."""
    f, wood = _dining_frame(w, 0.86, 0.92), w.look("wood")
    w.cylinder((0.0, 0.0), (f.seat - 0.035, f.seat), f.half, w.look("wicker"))
    w.cylinder((0.0, 0.0), (f.seat - 0.06, f.seat - 0.008), f.half - 0.012, wood)
    for side in _BOTH:
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
    for a, b in itertools.pairwise(arch):
        w.rod(a, b, 0.015, wood, round_ends=True)


# ---- office ------------------------------------------------------------------------------------------------------


def _star_base(w: Workbench, radius: float, look: Look, seat: float) -> None:
    """Five feet on casters under a gas spring."""
    dark = w.look("rubber")
    for i in range(5):
        angle = math.tau * i / 5 + 0.3
        c, s = math.cos(angle), math.sin(angle)
        w.bar((0.0, 0.0, 0.09), (radius * c, radius * s, 0.065), 0.035, 0.022, look)
        w.ball((radius * c, radius * s, 0.028), 0.028, dark)
        w.cylinder((radius * c, radius * s), (0.04, 0.07), 0.009, dark, solid=False)
    w.cylinder((0.0, 0.0), (0.07, 0.5 * seat + 0.05), 0.028, dark)
    w.cylinder((0.0, 0.0), (0.5 * seat, seat), 0.016, w.look("chrome"))


def task_chair(w: Workbench) -> None:
    """Office chair on a five-star base: padded seat, thin back on a stalk, maybe armrests."""
    w.mass_kg = OFFICE_KG
    seat, half, height = w.length(0.44, 0.50), 0.5 * w.length(0.46, 0.50), w.length(0.86, 1.02)
    cloth, dark = w.look("fabric"), w.look("dark")
    _star_base(w, w.length(0.28, 0.32), dark, seat - 0.06)
    w.mesh(chamfered_box((0.46, 2 * half, 0.07), 0.025), (0.02, 0.0, seat - 0.035), cloth)
    w.box((-0.10, 0.10), (-0.10, 0.10), (seat - 0.095, seat - 0.06), dark)
    w.bar((-0.08, 0.0, seat - 0.08), (-0.26, 0.0, seat - 0.06), 0.06, 0.02, dark)
    w.bar((-0.255, 0.0, seat - 0.07), (-0.29, 0.0, seat + 0.25), 0.06, 0.02, dark)
    back = height - seat - 0.12
    w.mesh(chamfered_box((0.045, 2 * half - 0.04, back), 0.02), (-0.255, 0.0, height - 0.5 * back), cloth, tilt=-0.1)
    if w.chance(0.6):
        for side in _BOTH:
            y = side * (half + 0.025)
            w.box((-0.02, 0.02), (y - 0.012, y + 0.012), (seat - 0.08, seat + 0.19), dark)
            w.bar((0.0, y, seat - 0.075), (0.0, side * 0.09, seat - 0.075), 0.03, 0.014, dark)
            w.box((-0.12, 0.12), (y - 0.035, y + 0.035), (seat + 0.19, seat + 0.215), dark)


def conference_chair(w: Workbench) -> None:
    """Ribbed sling between polished side frames on a four-foot swivel base with casters."""
    w.mass_kg = OFFICE_KG
    seat, half, height = w.length(0.43, 0.48), 0.5 * w.length(0.46, 0.50), w.length(0.80, 0.88)
    chrome, cover = w.look("chrome"), w.look("leather")
    _star_base(w, 0.29, chrome, seat - 0.03)
    path = [
        (0.24, seat - 0.03),
        (0.18, seat),
        (-0.14, seat - 0.025),
        (-0.21, seat + 0.03),
        (-0.25, seat + 0.15),
        (-0.33, height),
    ]
    w.mesh(strip(path[::-1], 0.018, 2 * half - 0.03), (0.0, 0.0, 0.0), cover)
    for side in _BOTH:
        y = side * (half - 0.012)
        for a, b in itertools.pairwise(path[1:]):
            w.rod((a[0], y, a[1] - 0.008), (b[0], y, b[1] - 0.008), 0.012, chrome, round_ends=True)
        w.rod((0.10, side * half, seat - 0.01), (0.10, side * half, seat + 0.2), 0.01, chrome)
        w.bar((0.14, side * half, seat + 0.2), (-0.26, side * half, seat + 0.2), 0.04, 0.02, cover)
    w.box((-0.06, 0.06), (-half + 0.01, half - 0.01), (seat - 0.045, seat - 0.02), chrome)


def executive(w: Workbench) -> None:
    """High padded leather back with headrest and closed arms on a five-star base."""
    w.mass_kg = OFFICE_KG + 6
    seat, half, height = w.length(0.46, 0.51), 0.5 * w.length(0.50, 0.56), w.length(1.08, 1.20)
    leather, dark = w.look("leather"), w.look("dark")
    _star_base(w, 0.33, w.look("chrome"), seat - 0.08)
    w.mesh(chamfered_box((0.50, 2 * half - 0.06, 0.12), 0.04), (0.02, 0.0, seat - 0.06), leather)
    w.box((-0.14, 0.14), (-0.14, 0.14), (seat - 0.14, seat - 0.10), dark)
    for i, (low, high) in enumerate(((0.0, 0.24), (0.24, 0.45), (0.45, height - seat))):
        size = (0.11 - 0.01 * i, 2 * half - 0.04 - 0.04 * i, high - low + 0.01)
        w.mesh(
            chamfered_box(size, 0.035),
            (-0.235 - 0.22 * (0.5 * (low + high)), 0.0, seat + 0.5 * (low + high)),
            leather,
            tilt=-0.16,
        )
    for side in _BOTH:
        y = side * half
        w.mesh(chamfered_box((0.32, 0.07, 0.05), 0.02), (0.0, y, seat + 0.21), leather)
        w.bar((0.12, y, seat + 0.20), (0.06, y * 0.9, seat - 0.06), 0.03, 0.04, dark)
        w.bar((-0.13, y, seat + 0.20), (-0.14, y * 0.9, seat - 0.06), 0.03, 0.04, dark)


# ---- arm chairs ---------------------------------------------------------------------------------------------------


def club(w: Workbench) -> None:
    """Boxy upholstered armchair: arms, back and a loose seat cushion on short feet."""
    width, depth, height = w.width(0.74, 0.92), w.depth(0.76, 0.90), w.length(0.74, 0.86)
    seat, arm, back = w.length(0.40, 0.44), w.length(0.11, 0.16), 0.18
    cover, foot = (w.look("leather") if w.chance(0.4) else w.look("fabric")), w.look("wood")
    x0, x1 = -0.5 * depth, 0.5 * depth
    w.box((x0 + 0.02, x1 - 0.02), (-0.5 * width + 0.02, 0.5 * width - 0.02), (0.09, seat - 0.12), cover)
    w.mesh(
        chamfered_box((back, width - 2 * arm + 0.02, height - 0.10), 0.04),
        (x0 + 0.5 * back, 0.0, 0.5 * (height + 0.10)),
        cover,
    )
    top = w.length(0.56, 0.64)
    for side in _BOTH:
        w.mesh(
            chamfered_box((depth, arm, top - 0.09), 0.035), (0.0, side * 0.5 * (width - arm), 0.5 * (top + 0.09)), cover
        )
    w.mesh(chamfered_box((depth - back, width - 2 * arm, 0.14), 0.03), (0.5 * back, 0.0, seat - 0.06), cover)
    w.legs((x0 + 0.03, x1 - 0.03), (-0.5 * width + 0.03, 0.5 * width - 0.03), (0.0, 0.10), 0.05, foot)
    w.top((x0 + back, x1), (-0.5 * width + arm, 0.5 * width - arm), seat + 0.01, "seat")


def wingback(w: Workbench) -> None:
    """High back with wings, rolled arms, turned wooden legs."""
    width, depth, height = w.width(0.72, 0.82), w.depth(0.76, 0.86), w.length(1.0, 1.12)
    seat, cloth, wood = w.length(0.42, 0.46), w.look("fabric"), w.look("wood")
    x0, x1, half = -0.5 * depth, 0.5 * depth, 0.5 * width
    w.box((x0 + 0.06, x1 - 0.03), (-half + 0.04, half - 0.04), (0.18, seat - 0.10), cloth)
    w.mesh(chamfered_box((depth - 0.16, width - 0.22, 0.13), 0.035), (0.07, 0.0, seat - 0.05), cloth)
    w.mesh(
        chamfered_box((0.13, width - 0.12, height - 0.20), 0.04),
        (x0 + 0.10, 0.0, 0.5 * (height + 0.20)),
        cloth,
        tilt=-0.10,
    )
    for side in _BOTH:
        y = side * (half - 0.06)
        w.box((x0 + 0.12, x1 - 0.06), (y - 0.045, y + 0.045), (0.20, 0.58), cloth)
        w.rod((x0 + 0.14, y, 0.60), (x1 - 0.05, y, 0.60), 0.06, cloth)
        w.mesh(
            chamfered_box((0.24, 0.06, height - 0.70), 0.025),
            (x0 + 0.20, side * (half - 0.08), 0.5 * (height + 0.62)),
            cloth,
            tilt=-0.10,
        )
    w.legs((x0 + 0.09, x1 - 0.06), (-half + 0.08, half - 0.08), (0.0, 0.18), 0.04, wood, splay=0.02)
    w.top((x0 + 0.16, x1), (-half + 0.12, half - 0.12), seat + 0.015, "seat")


def lounge(w: Workbench) -> None:
    """Open wooden frame with loose seat and back cushions, sloping arms."""
    width, depth, height = w.width(0.66, 0.76), w.depth(0.72, 0.82), w.length(0.76, 0.84)
    seat, wood, cloth = w.length(0.38, 0.42), w.look("wood"), w.look("fabric")
    x0, x1, half = -0.5 * depth, 0.5 * depth, 0.5 * width
    for side in _BOTH:
        y = side * (half - 0.02)
        w.bar((x1 - 0.06, y, 0.0), (x1 - 0.10, y, 0.56), 0.04, 0.045, wood)
        w.bar((x0 + 0.06, y, 0.0), (x0 + 0.14, y, 0.52), 0.04, 0.045, wood)
        w.bar((x1 - 0.02, y, 0.575), (x0 + 0.08, y, 0.53), 0.07, 0.028, wood)
        w.bar((x1 - 0.08, y, seat - 0.12), (x0 + 0.12, y, seat - 0.20), 0.03, 0.06, wood)
    w.bar((0.0, -half + 0.03, seat - 0.17), (0.0, half - 0.03, seat - 0.17), 0.05, 0.03, wood)
    w.mesh(chamfered_box((0.58, width - 0.10, 0.13), 0.035), (0.06, 0.0, seat - 0.05), cloth, tilt=-0.12)
    w.mesh(
        chamfered_box((0.13, width - 0.10, height - seat + 0.06), 0.035),
        (x0 + 0.13, 0.0, height - 0.5 * (height - seat + 0.06)),
        cloth,
        tilt=-0.25,
    )
    w.bar((x0 + 0.12, -half + 0.03, 0.5), (x0 + 0.12, half - 0.03, 0.5), 0.04, 0.03, wood)
    w.top((x0 + 0.2, x1 - 0.05), (-half + 0.08, half - 0.08), seat + 0.03, "seat")


def tub(w: Workbench) -> None:
    """Barrel chair: one rounded shell round a deep cushion, on a plinth."""
    width, height, seat = w.width(0.72, 0.82), w.length(0.70, 0.78), w.length(0.40, 0.44)
    r, cloth = 0.5 * width, w.look("fabric")
    w.cylinder((0.0, 0.0), (0.05, seat - 0.10), r - 0.03, cloth)
    w.cylinder((0.0, 0.0), (0.0, 0.06), r - 0.10, w.look("dark"))
    w.mesh(
        loft(
            [Ring(-0.08, r - 0.10, r - 0.10), Ring(0.04, r - 0.10, r - 0.10), Ring(0.08, r - 0.15, r - 0.15)],
            14,
            hull=True,
        ),
        (0.02, 0.0, seat - 0.08),
        cloth,
    )
    for i in range(9):
        angle = math.pi + (i - 4) * 0.47
        top = height - 0.12 * abs(i - 4) / 4
        x, y = (r - 0.05) * math.cos(angle), (r - 0.05) * math.sin(angle)
        w.mesh(chamfered_box((0.10, 0.20, round(top - 0.10, 2)), 0.03), (x, y, 0.5 * (top + 0.10)), cloth, turn=angle)
    w.top((-0.5 * r, 0.6 * r), (-0.5 * r, 0.5 * r), seat, "seat")


def rocker(w: Workbench) -> None:
    """Rocking chair: curved runners, slatted high back, flat arms."""
    w.mass_kg = 9.0
    half, seat, height = 0.5 * w.length(0.56, 0.64), w.length(0.41, 0.45), w.length(1.0, 1.10)
    wood, cloth = w.look("wood"), w.look("fabric")
    curve = [(-0.46, 0.10), (-0.28, 0.035), (-0.05, 0.013), (0.18, 0.02), (0.38, 0.07)]
    for side in _BOTH:
        y = side * (half - 0.02)
        for a, b in itertools.pairwise(curve):
            w.rod((a[0], y, a[1]), (b[0], y, b[1]), 0.013, wood, round_ends=True)
        w.rod((0.22, y, 0.03), (0.20, y, 0.64), 0.018, wood)
        w.rod((-0.24, y, 0.03), (-0.20, y, seat), 0.018, wood)
        w.rod((-0.20, y, seat - 0.02), (-0.36, y, height), 0.018, wood, round_ends=True)
        w.bar((0.26, y, 0.65), (-0.24, y, 0.62), 0.07, 0.022, wood)
    w.box((-0.24, 0.25), (-half, half), (seat - 0.03, seat), wood, tilt=-0.05)
    w.mesh(chamfered_box((0.42, 2 * half - 0.10, 0.05), 0.02), (0.01, 0.0, seat + 0.02), cloth, tilt=-0.05)
    w.rod((-0.355, -half + 0.02, height - 0.04), (-0.355, half - 0.02, height - 0.04), 0.022, wood)
    for i in range(5):
        y = (i - 2) * (half - 0.06) / 2.5
        w.bar((-0.205, y, seat - 0.01), (-0.355, y, height - 0.03), 0.035, 0.012, wood)


STYLES = (
    Style("chair", "slat_back", "train", slat_back, ("dining",)),
    Style("chair", "ladder_back", "train", ladder_back, ("dining",)),
    Style("chair", "shell", "train", shell, ("dining",)),
    Style("chair", "parsons", "train", parsons, ("dining",)),
    Style("chair", "cantilever", "train", cantilever, ("dining",)),
    Style("chair", "cafe_metal", "train", cafe_metal, ("dining",)),
    Style("chair", "windsor", "heldout", windsor, ("dining",)),
    Style("chair", "cross_back", "heldout", cross_back, ("dining",)),
    Style("chair", "task_chair", "train", task_chair, ("office",)),
    Style("chair", "conference", "train", conference_chair, ("office",)),
    Style("chair", "executive", "heldout", executive, ("office",)),
    Style("chair", "club", "train", club, ("arm",)),
    Style("chair", "wingback", "train", wingback, ("arm",)),
    Style("chair", "lounge", "train", lounge, ("arm",)),
    Style("chair", "tub", "heldout", tub, ("arm",)),
    Style("chair", "rocker", "heldout", rocker, ("arm",)),
)
