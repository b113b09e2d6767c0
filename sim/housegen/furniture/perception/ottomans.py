"""Ottomans and footstools of the pool `wide`."""

from __future__ import annotations

import itertools
import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, chamfered_box, loft
from sim.housegen.furniture.workbench import Workbench


def footstool(w: Workbench) -> None:
    """Builds a small domed footstool with a wooden rim."""
    w.mass_kg = 4.0
    width, depth, height = w.width(0.40, 0.62), w.depth(0.34, 0.46), w.length(0.28, 0.44)
    cloth, wood, power = parts.upholstery_look(w, 0.35), parts.wood_look(w, 0.3), w.choice((2.0, 5.0, 8.0))
    rx, ry = 0.5 * depth, 0.5 * width
    rim = [Ring(z, rx - 0.01, ry - 0.01, power=power) for z in (0.0, 0.05)]
    w.mesh(loft(rim, 16, hull=True), (0.0, 0.0, height - 0.16), wood)
    dome = [
        Ring(0.0, rx, ry, power=power),
        Ring(0.05, rx, ry, power=power),
        Ring(0.095, 0.85 * rx, 0.85 * ry, power=power),
        Ring(0.115, 0.5 * rx, 0.5 * ry),
    ]
    w.mesh(loft(dome, 16, hull=True), (0.0, 0.0, height - 0.115), cloth)
    reach = 0.62 if power == 2.0 else 0.80
    splay, thick = w.choice((0.0, 0.03, 0.05)), w.length(0.028, 0.05)
    w.legs(
        (-reach * rx, reach * rx),
        (-reach * ry, reach * ry),
        (0.0, height - 0.13),
        thick,
        wood,
        splay=splay,
        round_=True,
    )
    if w.chance(0.4):
        for sx, sy in itertools.product(BOTH_SIDES, BOTH_SIDES):
            w.ball((sx * reach * rx, sy * reach * ry, height - 0.19), 0.8 * thick, wood)
    w.top((-0.3 * depth, 0.3 * depth), (-0.3 * width, 0.3 * width), height, "seat")


def storage_cube(w: Workbench) -> None:
    """Builds a box ottoman with an overhanging lid, and a pull tab, buttons or straps."""
    w.mass_kg = 6.0
    width, depth, height = w.width(0.38, 0.95), w.depth(0.38, 0.50), w.length(0.36, 0.46)
    cover = parts.upholstery_look(w, 0.5)
    x, y = parts.footprint(depth, width)
    w.box((x[0] + 0.012, x[1] - 0.012), (y[0] + 0.012, y[1] - 0.012), (0.0, height - 0.07), cover)
    parts.pad(
        w, (depth, width, 0.08), (0.0, 0.0, height - 0.04), cover if w.chance(0.7) else w.new_look("leather"), 0.02
    )
    kind = w.choice(("tab", "buttons", "straps"))
    if kind == "tab":
        w.box((x[1] - 0.005, x[1] + 0.008), (-0.03, 0.03), (height - 0.10, height - 0.05), w.look("dark"), solid=False)
    elif kind == "straps":
        for c in (-0.28 * width, 0.28 * width):
            w.box((x[1] - 0.014, x[1] + 0.004), (c - 0.02, c + 0.02), (0.0, height - 0.02), w.look("dark"), solid=False)
    else:
        columns = max(2, round(width / 0.18))
        for row, i in itertools.product(range(2), range(columns)):
            at = ((row - 0.5) * 0.45 * depth, (i + 0.5) * width / columns - 0.5 * width, height)
            w.ellipsoid(at, (0.014, 0.014, 0.006), w.look("dark"), solid=False)
    w.top((0.8 * x[0], 0.8 * x[1]), (0.8 * y[0], 0.8 * y[1]), height, "seat")


def lounge_ottoman(w: Workbench) -> None:
    """Builds the footrest of a lounge chair: a slanted cushion on a star, sled or crossed base."""
    w.mass_kg = 6.0
    width, height = w.width(0.48, 0.66), w.length(0.36, 0.44)
    cover, half, depth = parts.upholstery_look(w, 0.6), 0.5 * width, w.length(0.42, 0.54)
    slant, thick = w.length(0.0, 0.22), w.length(0.08, 0.14)
    parts.pad(w, (depth, width, thick), (0.0, 0.0, height - 0.5 * thick), cover, 0.035, tilt=slant)
    under = height - thick
    kind = w.choice(("star", "sled", "cross"))
    if kind == "star":
        w.mesh(chamfered_box((depth - 0.03, width - 0.03, 0.025), 0.012), (0.0, 0.0, under), w.look("wood"), tilt=slant)
        parts.star_base(w, w.length(0.22, 0.28), 4, w.look("chrome"), under, castors=False)
        return
    frame = w.look("wood") if w.chance(0.6) else parts.tube_look(w)
    for side in BOTH_SIDES:
        y, reach = side * (half - 0.04), 0.5 * depth - 0.03
        if kind == "sled":
            rise = reach * math.tan(slant)
            for a, b in itertools.pairwise(
                [(-reach, y, under + rise), (-reach, y, 0.015), (reach, y, 0.015), (reach, y, under - rise)]
            ):
                w.bar(a, b, 0.045, 0.022, frame)
        else:
            for sx in BOTH_SIDES:
                w.bar(
                    (sx * reach, y, 0.0),
                    (-0.8 * sx * reach, y, under + 0.8 * sx * reach * math.tan(slant)),
                    0.035,
                    0.03,
                    frame,
                )
    w.bar((0.0, -half + 0.04, 0.5 * under), (0.0, half - 0.04, 0.5 * under), 0.03, 0.03, frame)
    if kind == "sled":
        for side in BOTH_SIDES:
            w.box(
                (-0.5 * depth + 0.03, 0.5 * depth - 0.03),
                (side * (half - 0.04) - 0.015, side * (half - 0.04) + 0.015),
                (0.5 * under - 0.015, 0.5 * under + 0.015),
                frame,
            )


def rattan_drum(w: Workbench) -> None:
    """Builds a round wicker seat with a cushion."""
    w.mass_kg = 4.0
    r, height = 0.5 * w.length(0.42, 0.62), w.length(0.36, 0.46)
    waist, cane = w.choice((0.72, 0.85, 1.12)), w.look("wicker")
    body = height - 0.08
    profile = ((0.0, 0.92), (0.03, 0.95), (0.5 * body, 0.95 * waist), (body - 0.03, 0.95), (body, 0.92))
    rings = [Ring(z, share * r, share * r) for z, share in profile]
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), cane)
    for z in (0.02, body - 0.02):
        w.cylinder((0.0, 0.0), (z - 0.012, z + 0.012), 0.97 * r, w.look("wood"), solid=False)
    puff = [
        Ring(0.0, 0.85 * r, 0.85 * r),
        Ring(0.03, r, r),
        Ring(0.06, 0.95 * r, 0.95 * r),
        Ring(0.085, 0.6 * r, 0.6 * r),
    ]
    w.mesh(loft(puff, 16, hull=True), (0.0, 0.0, body - 0.005), parts.upholstery_look(w, 0.1))


STYLES: tuple[Style, ...] = (
    Style("seating", "footstool", "wide", footstool, ("ottoman",)),
    Style("seating", "storage_cube", "wide", storage_cube, ("ottoman",)),
    Style("seating", "lounge_ottoman", "wide", lounge_ottoman, ("ottoman",)),
    Style("seating", "rattan_drum", "wide", rattan_drum, ("ottoman",)),
)
