"""Armchairs of the pool `wide`."""

from __future__ import annotations

import itertools
import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, loft, strip
from sim.housegen.furniture.workbench import Workbench


def cage_cube(w: Workbench) -> None:
    """Builds an armchair of thick leather cushions in a cage of steel tubes."""
    width, depth, seat = w.width(0.70, 0.84), w.depth(0.68, 0.78), w.length(0.40, 0.45)
    parts.cage_seat(w, width, depth, seat, 1)


def papasan(w: Workbench) -> None:
    """Builds a large round cane bowl with a thick cushion, tilted on a ring base."""
    r, seat, cane = w.length(0.46, 0.56), w.length(0.36, 0.44), w.look(w.choice(("wicker", "wood")))
    cloth, tilt = parts.upholstery_look(w, 0.05), w.length(0.28, 0.5)
    base = 0.6 * r
    neck = 0.55 * base
    stand = [Ring(0.0, base, base), Ring(0.04, base, base), Ring(0.20, neck, neck), Ring(0.22, neck, neck)]
    w.mesh(loft([*stand, Ring(0.3, 0.8 * base, 0.8 * base)], 16), (0.0, 0.0, 0.0), cane)
    outer = [Ring(0.0, 0.35 * r, 0.35 * r), Ring(0.09, 0.75 * r, 0.75 * r), Ring(0.22, r, r), Ring(0.25, r, r),
             Ring(0.22, 0.93 * r, 0.93 * r), Ring(0.12, 0.5 * r, 0.5 * r)]  # fmt: skip
    w.mesh(loft(outer, 16), (0.0, 0.0, seat - 0.13), cane, tilt=tilt)
    puff = [Ring(0.0, 0.4 * r, 0.4 * r), Ring(0.10, 0.75 * r, 0.75 * r), Ring(0.22, 0.97 * r, 0.97 * r),
            Ring(0.30, 0.9 * r, 0.9 * r), Ring(0.19, 0.62 * r, 0.62 * r), Ring(0.12, 0.25 * r, 0.25 * r)]  # fmt: skip
    w.mesh(loft(puff, 16), (0.0, 0.0, seat - 0.09), cloth, tilt=tilt)


def recliner(w: Workbench) -> None:
    """Builds a padded recliner with thick arms, a back of rolls, a footrest that is in or out, and a lever."""
    width, depth, seat = w.width(0.82, 1.0), w.depth(0.84, 0.96), w.length(0.44, 0.48)
    height, cover, arm = w.length(0.98, 1.10), parts.upholstery_look(w, 0.6), w.length(0.16, 0.22)
    x0, x1, half = -0.5 * depth, 0.5 * depth, 0.5 * width
    inner = width - 2 * arm
    w.box((x0 + 0.08, x1 - 0.06), (-half + 0.03, half - 0.03), (0.0, 0.10), w.look("dark"))
    w.box((x0 + 0.05, x1 - 0.05), (-half + 0.02, half - 0.02), (0.08, seat - 0.14), cover)
    for side in BOTH_SIDES:
        y = side * (half - 0.5 * arm)
        parts.pad(w, (depth - 0.06, arm - 0.03, 0.46), (0.03, y, 0.30), cover, 0.03)
        parts.pad(w, (depth - 0.10, arm, 0.12), (0.04, y, w.length(0.58, 0.60)), cover, 0.05)
    parts.pad(w, (depth - 0.22, inner + 0.01, 0.18), (0.11, 0.0, seat - 0.09), cover, 0.05)
    rolls = w.whole(2, 4)
    each = (height - seat + 0.04) / rolls
    for i in range(rolls):
        z = seat - 0.04 + (i + 0.5) * each
        x = x0 + 0.22 - 0.22 * (z - seat)
        wide = inner + (0.06 if i == rolls - 1 else 0.02)
        parts.pad(w, (0.22, wide, each + 0.01), (x, 0.0, z), cover, 0.06, tilt=-0.2)
    if w.chance(0.4):
        parts.pad(w, (0.42, inner - 0.02, 0.10), (x1 + 0.20, 0.0, seat - 0.10), cover, 0.03, tilt=0.08)
        for side in BOTH_SIDES:
            w.bar(
                (x1 - 0.08, side * 0.2, seat - 0.22), (x1 + 0.2, side * 0.2, seat - 0.14), 0.02, 0.02, w.look("metal")
            )
    else:
        parts.pad(w, (0.10, inner - 0.01, seat - 0.20), (x1 - 0.03, 0.0, 0.5 * (seat - 0.04)), cover, 0.03)
    if w.chance(0.5):
        y = half - 0.010
        w.bar((0.10, y, 0.30), (0.22, y, 0.38), 0.015, 0.03, w.look("wood"), solid=False)
    w.top((x0 + 0.3, x1), (-0.5 * inner, 0.5 * inner), seat, "seat")


def slipper_chair(w: Workbench) -> None:
    """Builds a low armchair without arms: one thick seat, a plain or buttoned back, short legs or a skirt."""
    width, depth, seat = w.width(0.54, 0.72), w.depth(0.64, 0.80), w.length(0.38, 0.44)
    height, cover = w.length(0.74, 0.92), parts.upholstery_look(w, 0.25)
    x0, x1, half, back = -0.5 * depth, 0.5 * depth, 0.5 * width, w.length(0.10, 0.18)
    thick = w.length(0.13, 0.20)
    parts.pad(w, (depth - 0.02, width, thick), (0.0, 0.0, seat - 0.5 * thick), cover, 0.035)
    tilt = -w.length(0.06, 0.20)
    tall = height - seat + 0.08
    x = x0 + 0.5 * back
    parts.pad(
        w, (back, width - 0.01, tall), (x - 0.3 * abs(tilt) * tall, 0.0, height - 0.5 * tall), cover, 0.04, tilt=tilt
    )
    if w.chance(0.5):
        face = x + 0.5 * back
        for row in range(2):
            for i in range(3):
                z = seat + (0.35 + 0.4 * row) * (height - seat)
                at = (face + tilt * (z - seat - 0.1) * 0.9 - 0.005, (i - 1) * 0.28 * width, z)
                w.ellipsoid(at, (0.012, 0.014, 0.014), w.look("dark"), solid=False)
    if w.chance(0.4):
        skirt = [
            Ring(0.0, 0.5 * depth, half + 0.01, power=8),
            Ring(seat - thick + 0.02, 0.5 * depth - 0.02, half - 0.01, power=8),
        ]
        w.mesh(loft(skirt, 16, hull=True), (0.0, 0.0, 0.0), cover)
    else:
        wood = w.look(w.choice(("wood", "brass", "iron")))
        splay = w.choice((0.0, 0.02, 0.04))
        w.legs(
            (x0 + 0.06, x1 - 0.06), (-half + 0.06, half - 0.06), (0.0, seat - thick + 0.02), 0.036, wood, splay=splay
        )
    w.top((x0 + back + 0.05, x1 - 0.02), (-half + 0.05, half - 0.05), seat, "seat")


def bent_lounge(w: Workbench) -> None:
    """Builds a lounge chair of bent laminated wood that runs from the floor into the arms, with one long cushion."""
    width, seat, height = w.width(0.62, 0.72), w.length(0.36, 0.42), w.length(0.92, 1.04)
    wood, cloth, half = w.look("wood"), parts.upholstery_look(w, 0.3), 0.5 * width
    wide = w.length(0.04, 0.06)
    arm = w.length(0.54, 0.60)
    for side in BOTH_SIDES:
        y = side * (half - 0.5 * wide)
        loop = [
            (-0.34, y, 0.012),
            (0.30, y, 0.012),
            (0.37, y, 0.10),
            (0.36, y, arm - 0.06),
            (0.28, y, arm),
            (-0.22, y, arm - 0.06),
        ]
        for a, b in itertools.pairwise(loop):
            w.bar(a, b, wide, 0.025, wood)
        inner = side * (half - wide - 0.012)
        w.bar((0.32, inner, seat), (-0.16, inner, seat - 0.12), 0.025, 0.045, wood)
        w.bar((-0.15, inner, seat - 0.13), (-0.36, inner, height - 0.10), 0.025, 0.045, wood)
    for x, z in ((0.31, seat - 0.01), (-0.235, arm - 0.075)):
        w.box((x - 0.015, x + 0.015), (-half + 0.02, half - 0.02), (z - 0.03, z + 0.01), wood)
    w.box((-0.32, -0.27), (-half + 0.02, half - 0.02), (0.0, 0.025), wood)
    path = [
        (-0.40, height),
        (-0.33, height - 0.14),
        (-0.16, seat - 0.05),
        (-0.10, seat - 0.09),
        (0.30, seat + 0.02),
        (0.36, seat),
    ]
    w.mesh(strip(path, w.length(0.06, 0.11), width - 2 * wide - 0.02), (0.0, 0.0, 0.0), cloth)
    if w.chance(0.5):
        parts.pad(w, (0.10, width - 0.16, 0.18), (-0.30, 0.0, height - 0.11), cloth, 0.035, tilt=-0.4)


def director(w: Workbench) -> None:
    """Builds a director's chair: a canvas seat and back between wooden side frames with crossed legs."""
    w.mass_kg = 5.0
    seat, half, wood = w.length(0.42, 0.48), 0.5 * w.length(0.54, 0.60), parts.wood_look(w, 0.3)
    canvas, height, arm = w.look(w.choice(("bright", "fabric", "leather"))), w.length(0.80, 0.90), w.length(0.62, 0.68)
    for side in BOTH_SIDES:
        y = side * (half - 0.02)
        w.box((-0.23, 0.25), (y - 0.025, y + 0.025), (arm - 0.022, arm), wood)
        w.box((-0.20, 0.20), (y - 0.015, y + 0.015), (seat - 0.03, seat), wood)
        w.box((-0.23, 0.23), (y - 0.015, y + 0.015), (0.0, 0.03), wood)
        for x in (-0.20, 0.18):
            w.box((x - 0.014, x + 0.014), (y - 0.012, y + 0.012), (seat - 0.02, arm - 0.01), wood)
        w.box((-0.215, -0.187), (y - 0.012, y + 0.012), (arm - 0.02, height), wood)
        for x in (-0.15, 0.15):
            w.bar((x + side * 0.014, -y, 0.015), (x + side * 0.014, y, seat - 0.015), 0.03, 0.022, wood)
    w.box((-0.19, 0.20), (-half + 0.02, half - 0.02), (seat - 0.004, seat + 0.006), canvas)
    parts.curved_board(w, -0.225, half - 0.01, (height - w.length(0.15, 0.20), height - 0.01), canvas, 0.012, 0.02)


def adirondack(w: Workbench) -> None:
    """Builds a porch chair of boards with fanned back slats, a sloping seat and broad flat arms."""
    width, wood, slats = w.width(0.68, 0.80), parts.wood_look(w, 0.6), w.whole(5, 7)
    half, high, height = 0.5 * width, w.length(0.34, 0.40), w.length(0.86, 1.02)
    arm = w.length(0.52, 0.58)
    for side in BOTH_SIDES:
        y = side * (half - 0.09)
        w.bar((0.34, y, high - 0.06), (-0.46, y, 0.035), 0.025, 0.09, wood)
        w.box((0.27, 0.35), (y - 0.012 + side * 0.02, y + 0.012 + side * 0.02), (0.0, arm - 0.01), wood)
        w.box((-0.42, 0.40), (side * half - side * 0.13, side * half), (arm - 0.022, arm), wood)
        w.box((-0.40, -0.34), (y - 0.012 + side * 0.02, y + 0.012 + side * 0.02), (0.0, arm - 0.01), wood)
    w.box((-0.40, -0.365), (-half + 0.02, half - 0.02), (arm - 0.06, arm - 0.015), wood)
    inner = 2 * half - 0.16
    slope = (high - 0.095) / 0.80
    for i in range(6):
        x = 0.34 - 0.112 * i
        z = 0.085 + slope * (x + 0.46)
        w.box((x - 0.042, x + 0.042), (-0.5 * inner, 0.5 * inner), (z - 0.010, z + 0.010), wood, tilt=-math.atan(slope))
    top_x, fan = -w.length(0.48, 0.56), w.length(1.0, 1.25)
    for i in range(slats):
        y = (i + 0.5) * (inner - 0.04) / slats - 0.5 * (inner - 0.04)
        drop = 0.10 * (2 * abs(i + 0.5 - 0.5 * slats) / slats) ** 2
        w.bar((-0.22, y, 0.10 + 0.24 * slope), (top_x, fan * y, height - drop), 0.8 * inner / slats, 0.018, wood)
    w.box((-0.36, -0.32), (-0.5 * inner, 0.5 * inner), (0.48, 0.54), wood)
    w.top((-0.18, 0.34), (-0.5 * inner, 0.5 * inner), high, "seat")


STYLES: tuple[Style, ...] = (
    Style("chair", "cage_cube", "wide", cage_cube, ("arm",)),
    Style("chair", "papasan", "wide", papasan, ("arm",)),
    Style("chair", "recliner", "wide", recliner, ("arm",)),
    Style("chair", "slipper_chair", "wide", slipper_chair, ("arm",)),
    Style("chair", "bent_lounge", "wide", bent_lounge, ("arm",)),
    Style("chair", "director", "wide", director, ("arm",)),
    Style("chair", "adirondack", "wide", adirondack, ("arm",)),
)
