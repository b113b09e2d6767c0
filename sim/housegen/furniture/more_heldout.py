"""Styles of the held-out pool for uses of which a home needs several: armchairs, desks, cabinets, mirrors, consoles.

Usual retail dimensions; easy chairs follow Panero & Zelnik (seats 0.38-0.43 m high, 0.65-0.90 m wide).
"""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, chamfered_box, hoop, loft
from sim.housegen.furniture.workbench import Workbench


def channel_chair(w: Workbench) -> None:
    """Builds a round easy chair whose back is a half ring of upright padded rolls, on a plinth."""
    r, height, seat = 0.5 * w.width(0.70, 0.80), w.length(0.70, 0.80), w.length(0.40, 0.44)
    cloth = w.look("fabric")
    w.cylinder((0.0, 0.0), (0.0, 0.06), r - 0.10, w.look("dark"))
    w.cylinder((0.0, 0.0), (0.05, seat), r - 0.04, cloth)
    for n in range(9):
        a = math.pi + (n - 4) * 0.36
        x, y, top = (r - 0.075) * math.cos(a), (r - 0.075) * math.sin(a), height - 0.02 * abs(n - 4)
        w.rod((x, y, 0.14), (x, y, top - 0.075), 0.075, cloth, round_ends=True)
    w.top((-0.4 * r, 0.7 * r), (-0.5 * r, 0.5 * r), seat, "seat")


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
    parts.star_base(w, 0.34, 4, steel, seat - 0.12, castors=False)
    w.top((-0.4 * r, 0.7 * r), (-0.6 * r, 0.6 * r), seat, "seat")


def cane_chair(w: Workbench) -> None:
    """Builds an armchair with a bent wooden frame, cane sides and cushions."""
    width, depth, height = w.width(0.64, 0.72), w.depth(0.68, 0.76), w.length(0.78, 0.88)
    seat, wood, cane, cloth = w.length(0.39, 0.43), w.look("wood"), w.look("wicker"), w.look("fabric")
    x0, x1, half = -0.5 * depth, 0.5 * depth, 0.5 * width
    for side in BOTH_SIDES:
        y = side * (half - 0.02)
        for x in (x0 + 0.04, x1 - 0.04):
            w.box((x - 0.02, x + 0.02), (y - 0.02, y + 0.02), (0.0, 0.60), wood)
        w.box((x0 + 0.02, x1 - 0.02), (y - 0.025, y + 0.025), (0.58, 0.62), wood)
        w.box((x0 + 0.05, x1 - 0.05), (y - 0.006, y + 0.006), (seat - 0.12, 0.585), cane)
    w.box((x0 + 0.03, x1 - 0.03), (-half + 0.03, half - 0.03), (seat - 0.14, seat - 0.10), wood)
    w.box((x0 + 0.02, x0 + 0.05), (-half + 0.02, half - 0.02), (seat - 0.12, height), cane)
    w.box((x0 + 0.01, x0 + 0.06), (-half + 0.01, half - 0.01), (height - 0.02, height + 0.02), wood)
    w.mesh(chamfered_box((depth - 0.12, width - 0.12, 0.12), 0.035), (0.03, 0.0, seat - 0.05), cloth)
    w.mesh(chamfered_box((0.13, width - 0.14, 0.36), 0.04), (x0 + 0.13, 0.0, seat + 0.19), cloth, tilt=-0.12)
    w.top((x0 + 0.2, x1 - 0.03), (-half + 0.08, half - 0.08), seat + 0.01, "seat")


def sliding_wardrobe(w: Workbench) -> None:
    """Builds a wardrobe with two sliding doors, one of them a mirror, and rails above and below."""
    width, depth, height = w.width(1.20, 1.90), w.depth(0.56, 0.64), w.height(1.95, 2.15)
    body, panel, metal = w.look("wood"), w.look("lacquer"), w.look("metal")
    x, y = parts.case(w, depth, width, (0.05, height), body, foot=0.05)
    middle = 0.5 * (y[0] + y[1])
    w.box((x, x + 0.012), (y[0] + 0.02, middle + 0.03), (0.09, height - 0.05), panel, solid=False)
    w.box((x, x + 0.022), (middle - 0.03, y[1] - 0.02), (0.09, height - 0.05), w.look("mirror"), solid=False)
    for z in (0.07, height - 0.035):
        w.box((x, x + 0.026), (y[0] + 0.01, y[1] - 0.01), (z - 0.012, z + 0.012), metal, solid=False)
    w.box((x, x + 0.028), (middle - 0.04, middle - 0.025), (0.09, height - 0.05), metal, solid=False)


def wing_desk(w: Workbench) -> None:
    """Builds a desk of one board on a block of drawers and a trestle."""
    width, depth, height = w.width(1.20, 1.60), w.depth(0.60, 0.72), w.length(0.72, 0.76)
    top, body, metal = w.look("wood"), w.look("lacquer"), w.look("metal")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, (height - 0.035, height), top)
    w.box((x[0] + 0.04, x[1] - 0.04), (y[0] + 0.04, y[0] + 0.42), (0.03, height - 0.035), body)
    for n in range(3):
        z = 0.06 + n * (height - 0.12) / 3
        w.box((x[1] - 0.04, x[1] - 0.025), (y[0] + 0.05, y[0] + 0.41), (z, z + 0.19), body, solid=False)
        w.box((x[1] - 0.026, x[1] - 0.01), (y[0] + 0.17, y[0] + 0.29), (z + 0.13, z + 0.145), metal, solid=False)
    for end in (x[0] + 0.05, x[1] - 0.05):
        w.bar((end, y[1] - 0.06, 0.0), (0.4 * end, y[1] - 0.10, height - 0.035), 0.035, 0.035, metal)
    w.bar((x[0] + 0.08, y[1] - 0.07, 0.14), (x[1] - 0.08, y[1] - 0.07, 0.14), 0.03, 0.03, metal)
    w.top((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.03, y[1] - 0.03), height)


def mirror_sunburst(w: Workbench) -> None:
    """Builds a round mirror in a ring with rays."""
    r, brass = 0.5 * w.width(0.55, 0.80), w.look("brass")
    inner = 0.62 * r
    w.mount_height_m = 1.25
    w.rod((0.0, 0.0, r), (0.02, 0.0, r), inner, w.look("mirror"))
    for n in range(12):
        a = math.tau * n / 12
        tip = (0.012, r * math.sin(a), r + r * math.cos(a))
        foot = (0.012, 0.96 * inner * math.sin(a), r + 0.96 * inner * math.cos(a))
        w.rod(foot, tip, 0.011, brass, solid=False)


def console_drawers(w: Workbench) -> None:
    """Builds a narrow table with two drawers, a lower shelf and turned legs."""
    width, depth, height = w.width(0.90, 1.30), w.depth(0.30, 0.38), w.length(0.76, 0.84)
    wood, metal = w.look("wood"), w.look("brass")
    x, y = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
    w.box(x, y, (height - 0.025, height), wood)
    w.box((x[0] + 0.02, x[1] - 0.025), (y[0] + 0.02, y[1] - 0.02), (height - 0.16, height - 0.025), wood)
    for side in BOTH_SIDES:
        c = side * 0.24 * width
        w.box(
            (x[1] - 0.025, x[1] - 0.012),
            (c - 0.2 * width, c + 0.2 * width),
            (height - 0.15, height - 0.035),
            wood,
            solid=False,
        )
        w.ball((x[1] - 0.004, c, height - 0.09), 0.014, metal, solid=False)
    w.legs((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.03, y[1] - 0.03), (0.0, height - 0.15), 0.045, wood, round_=True)
    w.box((x[0] + 0.02, x[1] - 0.02), (y[0] + 0.02, y[1] - 0.02), (0.14, 0.16), wood)
    w.top(x, y, height)


def slatted_sideboard(w: Workbench) -> None:
    """Builds a sideboard with slatted doors on a sled base."""
    width, depth, height = w.width(1.20, 1.60), w.depth(0.40, 0.46), w.length(0.72, 0.84)
    wood, body, metal = w.look("wood"), w.look("lacquer"), w.look("iron")
    x, y = parts.case(w, depth, width, (0.16, height), body)
    parts.styled_doors(w, x, y, (0.18, height - 0.03), 3, wood, metal, "slats", "slot")
    parts.feet(w, (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width), 0.17, "sled", metal)


def drum_stool_table(w: Workbench) -> None:
    """Builds a small round table with a hoop near the floor on three legs."""
    r, height, wood, metal = 0.5 * w.width(0.42, 0.52), w.length(0.48, 0.56), w.look("wood"), w.look("iron")
    w.cylinder((0.0, 0.0), (height - 0.03, height), r, wood)
    for n in range(3):
        a = math.tau * n / 3
        w.rod(
            (0.8 * r * math.cos(a), 0.8 * r * math.sin(a), 0.0),
            (0.6 * r * math.cos(a), 0.6 * r * math.sin(a), height - 0.03),
            0.012,
            metal,
        )
    w.mesh(hoop(0.78 * r, 0.02, 0.02), (0.0, 0.0, 0.12), metal, solid=False)
    half = 0.62 * r
    w.top((-half, half), (-half, half), height)


STYLES = (
    Style("chair", "channel_chair", "heldout", channel_chair, ("arm",)),
    Style("chair", "egg_chair", "heldout", egg_chair, ("arm",)),
    Style("chair", "cane_chair", "heldout", cane_chair, ("arm",)),
    Style("cabinet", "sliding_wardrobe", "heldout", sliding_wardrobe, ("wardrobe",)),
    Style("cabinet", "slatted_sideboard", "heldout", slatted_sideboard, ("sideboard",)),
    Style("table", "wing_desk", "heldout", wing_desk, ("desk",)),
    Style("table", "console_drawers", "heldout", console_drawers, ("console",)),
    Style("table", "drum_stool_table", "heldout", drum_stool_table, ("side",)),
    Style("mirror", "mirror_sunburst", "heldout", mirror_sunburst, ("wall",), "wall"),
)
