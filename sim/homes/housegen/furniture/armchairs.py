"""Arm chairs.

Sizes follow Panero & Zelnik, Human Dimension and Interior Space (easy chairs 0.38-0.43 m high and 0.70-0.95 m wide).
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset, polar
from sim.homes.housegen.furniture.shapes import Ring, arc_wall, chamfered_box, loft, turned
from sim.homes.housegen.furniture.workbench import Workbench


def club(w: Workbench) -> None:
    """Builds a boxy upholstered armchair with arms, a back and a loose seat cushion on short feet."""
    width, depth, height = w.width(0.74, 0.92), w.depth(0.76, 0.90), w.length(0.74, 0.86)
    seat, arm, back = w.length(0.40, 0.44), w.length(0.11, 0.16), 0.18
    cover, foot = (w.look("leather") if w.chance(0.4) else w.look("fabric")), w.look("wood")
    x0, x1 = centred(depth)
    w.box((x0 + 0.02, x1 - 0.02), centred(width, 0.02), (0.09, seat - 0.12), cover)
    w.mesh(
        chamfered_box((back, width - 2 * arm + 0.02, height - 0.10), 0.04),
        (x0 + 0.5 * back, 0.0, 0.5 * (height + 0.10)),
        cover,
    )
    top = w.length(0.56, 0.64)
    for side in BOTH_SIDES:
        w.mesh(
            chamfered_box((depth, arm, top - 0.09), 0.035), (0.0, side * 0.5 * (width - arm), 0.5 * (top + 0.09)), cover
        )
    w.mesh(chamfered_box((depth - back, width - 2 * arm, 0.14), 0.03), (0.5 * back, 0.0, seat - 0.06), cover)
    w.legs((x0 + 0.03, x1 - 0.03), centred(width, 0.03), (0.0, 0.10), 0.05, foot)
    w.top((x0 + back, x1), centred(width, arm), seat + 0.01, "seat")


def wingback(w: Workbench) -> None:
    """Builds an armchair with a high winged back, rolled arms and turned wooden legs."""
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
    for side in BOTH_SIDES:
        y = side * (half - 0.06)
        w.box((x0 + 0.12, x1 - 0.06), around(y, 0.045), (0.20, 0.58), cloth)
        w.rod_x((y, 0.60), (x0 + 0.14, x1 - 0.05), 0.06, cloth)
        w.mesh(
            chamfered_box((0.24, 0.06, height - 0.70), 0.025),
            (x0 + 0.20, side * (half - 0.08), 0.5 * (height + 0.62)),
            cloth,
            tilt=-0.10,
        )
    w.legs((x0 + 0.09, x1 - 0.06), (-half + 0.08, half - 0.08), (0.0, 0.18), 0.04, wood, splay=0.02)
    w.top((x0 + 0.16, x1), (-half + 0.12, half - 0.12), seat + 0.015, "seat")


def lounge(w: Workbench) -> None:
    """Builds an armchair with an open wooden frame, sloping arms and loose seat and back cushions."""
    width, depth, height = w.width(0.66, 0.76), w.depth(0.72, 0.82), w.length(0.76, 0.84)
    seat, wood, cloth = w.length(0.38, 0.42), w.look("wood"), w.look("fabric")
    x0, x1, half = -0.5 * depth, 0.5 * depth, 0.5 * width
    for y in inset((-half, half), 0.02):
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


def rocker(w: Workbench) -> None:
    """Builds a rocking chair with curved runners, a slatted high back and flat arms."""
    w.mass_kg = 9.0
    half, seat, height = 0.5 * w.length(0.56, 0.64), w.length(0.41, 0.45), w.length(1.0, 1.10)
    wood, cloth = w.look("wood"), w.look("fabric")
    curve = [(-0.46, 0.10), (-0.28, 0.035), (-0.05, 0.013), (0.18, 0.02), (0.38, 0.07)]
    for y in inset((-half, half), 0.02):
        w.bent_rod([(x, y, z) for x, z in curve], 0.013, wood)
        w.rod((0.22, y, 0.03), (0.20, y, 0.64), 0.018, wood)
        w.rod((-0.24, y, 0.03), (-0.20, y, seat), 0.018, wood)
        w.rod((-0.20, y, seat - 0.02), (-0.36, y, height), 0.018, wood, round_ends=True)
        w.bar((0.26, y, 0.65), (-0.24, y, 0.62), 0.07, 0.022, wood)
    w.box((-0.24, 0.25), (-half, half), (seat - 0.03, seat), wood, tilt=-0.05)
    w.mesh(chamfered_box((0.42, 2 * half - 0.10, 0.05), 0.02), (0.01, 0.0, seat + 0.02), cloth, tilt=-0.05)
    w.rod_y((-0.355, height - 0.04), (-half + 0.02, half - 0.02), 0.022, wood)
    for i in range(5):
        y = (i - 2) * (half - 0.06) / 2.5
        w.bar((-0.205, y, seat - 0.01), (-0.355, y, height - 0.03), 0.035, 0.012, wood)


def tub(w: Workbench) -> None:
    """Builds a barrel chair: one rounded shell around a deep cushion, on a plinth."""
    width, height, seat = w.width(0.72, 0.82), w.length(0.70, 0.78), w.length(0.40, 0.44)
    r, cloth = 0.5 * width, w.look("fabric")
    w.cylinder((0.0, 0.0), (0.05, seat - 0.10), r - 0.01, cloth)
    w.cylinder((0.0, 0.0), (0.0, 0.06), r - 0.08, w.look("dark"))
    cushion = [(-0.12, r - 0.11), (-0.03, r - 0.10), (0.0, r - 0.14)]
    w.mesh(turned(cushion, 16, hull=True), (0.02, 0.0, seat), cloth)
    angles = [math.pi + (i - 8) * 0.275 for i in range(17)]
    tops = [height - 0.15 * (abs(i - 8) / 8) ** 2 for i in range(17)]
    w.mesh(arc_wall(r, 0.10, 0.10, angles, tops), (0.0, 0.0, 0.0), cloth, solid=False)
    w.top((-0.5 * r, 0.6 * r), centred(r), seat, "seat")


def channel_chair(w: Workbench) -> None:
    """Builds a round easy chair on a plinth; its back is a half ring of upright padded rolls."""
    r, height, seat = 0.5 * w.width(0.70, 0.80), w.length(0.70, 0.80), w.length(0.40, 0.44)
    cloth = w.look("fabric")
    w.cylinder((0.0, 0.0), (0.0, 0.06), r - 0.10, w.look("dark"))
    w.cylinder((0.0, 0.0), (0.05, seat), r - 0.04, cloth)
    for n in range(9):
        a = math.pi + (n - 4) * 0.36
        x, y, top = (*polar(r - 0.075, a), height - 0.02 * abs(n - 4))
        w.rod((x, y, 0.14), (x, y, top - 0.075), 0.075, cloth, round_ends=True)
    w.top((-0.4 * r, 0.7 * r), centred(r), seat, "seat")


def egg_chair(w: Workbench) -> None:
    """Builds a shell chair with a high rounded back on a foot with four arms."""
    r, height, seat = 0.5 * w.width(0.70, 0.80), w.length(1.0, 1.12), w.length(0.40, 0.44)
    cloth, steel = w.look("leather") if w.chance(0.5) else w.look("fabric"), w.look("chrome")
    rings = [
        Ring(seat - 0.14, 0.45 * r, 0.45 * r),
        Ring(seat, r, r),
        Ring(seat + 0.02, 0.8 * r, 0.8 * r, 0.05),
        Ring(seat - 0.02, 0.5 * r, 0.5 * r, 0.05),
    ]
    w.mesh(loft(rings, 14), (0.0, 0.0, 0.0), cloth)
    back = [
        Ring(seat - 0.02, 0.10, 0.94 * r, -0.86 * r),
        Ring(seat + 0.30, 0.11, 0.98 * r, -0.98 * r),
        Ring(0.92 * height, 0.09, 0.72 * r, -1.08 * r),
        Ring(height, 0.05, 0.42 * r, -1.08 * r),
    ]
    w.mesh(loft(back, 12, hull=True), (0.0, 0.0, 0.0), cloth)
    for side in BOTH_SIDES:
        w.mesh(chamfered_box((1.2 * r, 0.09, 0.30), 0.04), (-0.25 * r, side * 0.86 * r, seat + 0.10), cloth, tilt=-0.1)
    _star_base(w, steel, seat - 0.12)
    w.top((-0.4 * r, 0.7 * r), (-0.6 * r, 0.6 * r), seat, "seat")


def _star_base(w: Workbench, look: Look, top: float) -> None:
    """Adds a column with four feet in a star, on glides."""
    dark, radius, low = w.look("rubber"), 0.34, 0.02
    for i in range(4):
        angle = math.tau * i / 4 + 0.3
        x, y = polar(radius, angle)
        w.bar((0.0, 0.0, low + 0.03), (x, y, low), 0.04, 0.025, look)
        w.cylinder((x, y), (0.0, low), 0.014, dark)
    w.cylinder((0.0, 0.0), (low, top), 0.026, w.look("chrome") if w.chance(0.5) else look)


def cane_chair(w: Workbench) -> None:
    """Builds an armchair with a bent wooden frame, cane sides and cushions."""
    width, depth, height = w.width(0.64, 0.72), w.depth(0.68, 0.76), w.length(0.78, 0.88)
    seat, wood, cane, cloth = w.length(0.39, 0.43), w.look("wood"), w.look("wicker"), w.look("fabric")
    x0, x1, half = -0.5 * depth, 0.5 * depth, 0.5 * width
    for y in inset((-half, half), 0.02):
        for x in (x0 + 0.04, x1 - 0.04):
            w.box(around(x, 0.02), around(y, 0.02), (0.0, 0.60), wood)
        w.box((x0 + 0.02, x1 - 0.02), around(y, 0.025), (0.58, 0.62), wood)
        w.box((x0 + 0.05, x1 - 0.05), around(y, 0.006), (seat - 0.12, 0.585), cane)
    w.box((x0 + 0.03, x1 - 0.03), (-half + 0.03, half - 0.03), (seat - 0.14, seat - 0.10), wood)
    w.box((x0 + 0.02, x0 + 0.05), (-half + 0.02, half - 0.02), (seat - 0.12, height), cane)
    w.box((x0 + 0.01, x0 + 0.06), (-half + 0.01, half - 0.01), around(height, 0.02), wood)
    w.mesh(chamfered_box((depth - 0.12, width - 0.12, 0.12), 0.035), (0.03, 0.0, seat - 0.05), cloth)
    w.mesh(chamfered_box((0.13, width - 0.14, 0.36), 0.04), (x0 + 0.13, 0.0, seat + 0.19), cloth, tilt=-0.12)
    w.top((x0 + 0.2, x1 - 0.03), (-half + 0.08, half - 0.08), seat + 0.01, "seat")


STYLES = (
    Style("chair", "club", "train", club, ("arm",)),
    Style("chair", "wingback", "train", wingback, ("arm",)),
    Style("chair", "lounge", "train", lounge, ("arm",)),
    Style("chair", "tub", "heldout", tub, ("arm",)),
    Style("chair", "rocker", "heldout", rocker, ("arm",)),
    Style("chair", "channel_chair", "heldout", channel_chair, ("arm",)),
    Style("chair", "egg_chair", "heldout", egg_chair, ("arm",)),
    Style("chair", "cane_chair", "heldout", cane_chair, ("arm",)),
)
