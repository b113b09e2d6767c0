"""Clothes that lie on the floor or on furniture, of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.perception import garments
from sim.housegen.furniture.shapes import Ring, chamfered_box, loft
from sim.housegen.furniture.workbench import Workbench


def strewn(w: Workbench) -> None:
    """Builds garments that lie flat and apart on the floor, with socks and sometimes shoes."""
    kinds = [w.choice(("shirt", "tee", "coat", "dress")), w.choice(("trousers", "skirt", "trousers"))]
    if w.chance(0.5):
        kinds.append(w.choice(("tee", "vest")))
    for i, kind in enumerate(kinds):
        turn, high = 2.1 * i + w.length(-0.5, 0.5), w.length(0.55, 0.85)
        at = (w.length(0.0, 0.15) * math.cos(turn), w.length(0.0, 0.15) * math.sin(turn), 0.025 + 0.02 * i)
        w.mesh(
            garments.garment(w, kind, high, 0.045),
            at,
            garments.garment_look(w),
            tilt=-0.5 * math.pi,
            turn=turn,
            solid=i == 0,
        )
    w.mesh(
        parts.crumpled_cloth(w, w.length(0.3, 0.5), w.length(0.25, 0.4), w.length(0.08, 0.18)),
        (0.0, 0.0, 0.02),
        garments.garment_look(w),
    )
    for i in range(w.whole(0, 3)):
        a = 1.3 + 1.7 * i
        w.mesh(
            chamfered_box((0.22, 0.08, 0.025), 0.01),
            (0.38 * math.cos(a), 0.38 * math.sin(a), 0.0125),
            garments.garment_look(w),
            turn=3 * a,
        )
    if w.chance(0.4):
        shoe = w.new_look("leather")
        for side in BOTH_SIDES:
            w.ellipsoid((0.35, -0.30 + 0.07 * side, 0.045), (0.13, 0.045, 0.045), shoe, turn=0.2 * side)


def mound(w: Workbench) -> None:
    """Builds a high heap of laundry from which legs and sleeves stick out."""
    r, high = w.length(0.22, 0.36), w.length(0.16, 0.38)
    core = [Ring(0.0, 0.7 * r, 0.7 * r), Ring(0.45 * high, 0.55 * r, 0.55 * r), Ring(0.7 * high, 0.2 * r, 0.2 * r)]
    w.mesh(loft(core, 10), (0.0, 0.0, 0.0), garments.garment_look(w))
    for i in range(w.whole(3, 5)):
        a, out = 2.3 * i, 0.2 * r * i
        at = (out * math.cos(a), out * math.sin(a), 0.11 * high * i)
        shape = parts.crumpled_cloth(w, (2.3 - 0.35 * i) * r, (2.0 - 0.3 * i) * r, (0.95 - 0.12 * i) * high)
        w.mesh(shape, at, garments.garment_look(w), turn=w.length(0.0, 3.0), solid=False)
    for i in range(w.whole(2, 4)):
        a, cloth = 1.6 * i + w.length(0.0, 1.0), garments.garment_look(w)
        p = (0.4 * r * math.cos(a), 0.4 * r * math.sin(a), 0.6 * high)
        q = (1.25 * r * math.cos(a), 1.25 * r * math.sin(a), 0.04)
        w.bar(p, q, w.length(0.08, 0.14), 0.04, cloth, solid=False)


def sorted_piles(w: Workbench) -> None:
    """Builds two to four piles of folded laundry on the floor."""
    count = w.whole(2, 4)
    for k in range(count):
        x, y, z = 0.17 * (-1) ** k if count > 2 else 0.0, (k - 0.5 * (count - 1)) * w.length(0.28, 0.36), 0.0
        size = (w.length(0.24, 0.34), w.length(0.20, 0.27))
        for i in range(w.whole(2, 5)):
            thick = w.length(0.03, 0.07)
            shape = chamfered_box((size[0] * w.length(0.9, 1.0), size[1] * w.length(0.9, 1.0), thick), 0.016)
            w.mesh(shape, (x, y, z + 0.5 * thick), garments.garment_look(w), turn=w.length(-0.1, 0.1), solid=i < 2)
            z += thick - 0.003
        if w.chance(0.4):
            for side in BOTH_SIDES:
                w.ellipsoid(
                    (x + 0.05 * side, y, z + 0.03), (0.045, 0.045, 0.035), garments.garment_look(w), solid=False
                )


def dress_shirts(w: Workbench) -> None:
    """Builds a pile of folded shirts with collars, and sometimes rolled ties beside it."""
    z, deep, wide = 0.0, w.length(0.30, 0.38), w.length(0.22, 0.27)
    count = w.whole(1, 4)
    for i in range(count):
        thick, cloth = w.length(0.025, 0.04), garments.garment_look(w)
        w.mesh(
            chamfered_box((deep, wide, thick), 0.010), (0.0, 0.0, z + 0.5 * thick), cloth, turn=w.length(-0.05, 0.05)
        )
        z += thick
        if i == count - 1 or w.chance(0.5):
            x = 0.5 * deep - 0.06
            for side in BOTH_SIDES:
                w.box(
                    (x - 0.02, x + 0.05),
                    (side * 0.045 - 0.035, side * 0.045 + 0.035),
                    (z - 0.004, z + 0.010),
                    cloth,
                    turn=side * 0.6,
                    solid=False,
                )
            z += 0.004
    w.box(
        (-0.45 * deep, 0.5 * deep - 0.06),
        (-0.012, 0.012),
        (z - 0.006, z + 0.001),
        parts.darker(w.look("linen"), 0.8),
        solid=False,
    )
    for i in range(w.whole(0, 3)):
        at = (-0.12 + 0.11 * i, 0.5 * wide + 0.06)
        w.cylinder(at, (0.0, 0.05), 0.04, garments.garment_look(w))
        w.cylinder(at, (0.048, 0.053), 0.015, w.look("dark"), solid=False)


def hat_and_scarf(w: Workbench) -> None:
    """Builds a hat or a knitted cap with a folded or crumpled scarf, and often gloves."""
    felt, r = w.new_look(w.choice(("fabric", "denim", "bright"))), w.length(0.085, 0.10)
    high = w.length(0.08, 0.13)
    if w.chance(0.6):
        brim = r + w.length(0.03, 0.09)
        rings = [
            Ring(0.0, brim * 1.05, brim),
            Ring(0.012, brim * 1.05, brim),
            Ring(0.02, r * 1.1, r),
            Ring(high, 0.9 * r, 0.78 * r),
        ]
        w.mesh(loft([*rings, Ring(high + 0.015, 0.5 * r, 0.4 * r)], 18), (0.0, 0.0, 0.0), felt)
        w.mesh(
            loft([Ring(0.022, r * 1.12, 1.02 * r), Ring(0.045, r * 1.09, 0.99 * r)], 18, hull=True),
            (0.0, 0.0, 0.0),
            w.look("dark"),
        )
    else:
        w.mesh(
            loft(
                [
                    Ring(0.0, r, r),
                    Ring(0.035, 1.04 * r, 1.04 * r),
                    Ring(0.04, 0.95 * r, 0.95 * r),
                    Ring(high, 0.6 * r, 0.6 * r),
                    Ring(high + 0.02, 0.2 * r, 0.2 * r),
                ],
                16,
            ),
            (0.0, 0.0, 0.0),
            felt,
        )
        w.ball((0.0, 0.0, high + 0.035), w.length(0.02, 0.035), garments.garment_look(w), solid=False)
    scarf = garments.garment_look(w)
    if w.chance(0.5):
        thick = w.length(0.04, 0.08)
        at = (0.0, 0.27, 0.5 * thick)
        w.mesh(chamfered_box((0.24, 0.16, thick), 0.018), at, scarf, turn=w.length(-0.3, 0.3))
    else:
        w.mesh(parts.crumpled_cloth(w, 0.34, 0.20, 0.08), (0.0, 0.27, 0.0), scarf, turn=w.length(-0.4, 0.4))
    if w.chance(0.6):
        glove = w.new_look("leather")
        for i in range(2):
            x, z = -0.02 + 0.04 * i, 0.012 + 0.015 * i
            w.box((x - 0.06, x + 0.05), (-0.28, -0.20), (z - 0.012, z + 0.012), glove, turn=0.15 * i)
            w.box((x + 0.04, x + 0.12), (-0.275, -0.205), (z - 0.010, z + 0.010), glove, turn=0.15 * i, solid=False)
            w.rod((x, -0.20, z), (x + 0.05, -0.17, z), 0.011, glove, solid=False, round_ends=True)


STYLES: tuple[Style, ...] = (
    Style("clothes", "strewn", "wide", strewn, ("floor",)),
    Style("clothes", "mound", "wide", mound, ("floor",)),
    Style("clothes", "sorted_piles", "wide", sorted_piles, ("floor",)),
    Style("clothes", "dress_shirts", "wide", dress_shirts, ("top",), "top"),
    Style("clothes", "hat_and_scarf", "wide", hat_and_scarf, ("top",), "top"),
)
