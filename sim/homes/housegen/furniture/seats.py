"""Seating other than chairs, sofas and stools: benches, ottomans, poufs, bean bags.

Sizes follow Panero & Zelnik, Human Dimension and Interior Space (benches 0.42-0.47 m high, 0.35-0.45 m deep,
0.90-1.50 m wide) and usual retail dimensions of poufs (0.40-0.60 m across).
"""

from __future__ import annotations

import math

from sim.homes.housegen.furniture import parts
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import around, centred, inset, polar
from sim.homes.housegen.furniture.shapes import Ring, chamfered_box, loft, puffed
from sim.homes.housegen.furniture.workbench import Workbench


def bench_wood(w: Workbench) -> None:
    """Builds a wooden hall bench with a thin pad."""
    width, depth, seat, wood = w.width(0.90, 1.40), w.depth(0.34, 0.42), w.length(0.42, 0.46), w.look("wood")
    x, y = parts.footprint(depth, width)
    w.box(x, y, (seat - 0.04, seat), wood)
    w.mesh(chamfered_box((depth - 0.03, width - 0.06, 0.05), 0.015), (0.0, 0.0, seat + 0.02), w.look("fabric"))
    w.legs(inset(x, 0.02), inset(y, 0.05), (0.0, seat - 0.04), 0.05, wood)
    w.box((-0.02, 0.02), inset(y, 0.08), (0.16, 0.20), wood)
    for edge in centred(width, 0.075):
        w.box(inset(x, 0.04), around(edge, 0.015), (0.16, 0.20), wood)
    w.top(x, inset(y, 0.1), seat + 0.045, "seat")


def ottoman(w: Workbench) -> None:
    """Builds an upholstered block with a lid seam on short legs."""
    width, depth, height, cloth = w.width(0.55, 1.20), w.depth(0.45, 0.60), w.length(0.40, 0.46), w.look("fabric")
    w.box(centred(depth, 0.01), centred(width, 0.01), (0.08, height - 0.12), cloth)
    w.mesh(chamfered_box((depth, width, 0.13), 0.03), (0.0, 0.0, height - 0.065), cloth)
    w.legs(centred(depth, 0.03), centred(width, 0.03), (0.0, 0.085), 0.045, w.look("wood"))
    w.top((-0.4 * depth, 0.4 * depth), (-0.4 * width, 0.4 * width), height, "seat")


def pouf(w: Workbench) -> None:
    """Builds a round knitted pouf."""
    w.mass_kg = 4.0
    r, height = 0.5 * w.length(0.45, 0.60), w.length(0.34, 0.42)
    cloth = w.look("bright")
    w.mesh(puffed(r, height), (0.0, 0.0, 0.0), cloth)
    for i in range(6):
        a = math.pi * i / 6
        seam = [(*polar(s * 0.5 * r, a), height + 0.001) for s in (-1, 1)]
        w.bar(seam[0], seam[1], 0.008, 0.004, parts.darker(cloth, 0.6), solid=False)
    w.cylinder((0.0, 0.0), (height, height + 0.008), 0.03, w.look("dark"), solid=False)


def storage_bench(w: Workbench) -> None:
    """Builds a hall bench with open cubbies with shoes below and a cushion on top."""
    width, depth, seat = w.width(0.90, 1.30), w.depth(0.36, 0.42), w.length(0.44, 0.48)
    look = parts.wood_look(w)
    x, y = parts.footprint(depth, width)
    w.box(x, y, (seat - 0.07, seat - 0.04), look)
    w.box(x, y, (0.03, 0.055), look)
    w.box((x[0], x[0] + 0.012), y, (0.05, seat - 0.06), look)
    for i in range(4):
        c = y[0] + 0.011 + i * (width - 0.022) / 3
        w.box(x, around(c, 0.011), (0.0, seat - 0.06), look)
    w.mesh(chamfered_box((depth - 0.01, width - 0.01, 0.06), 0.02), (0.0, 0.0, seat - 0.012), w.look("fabric"))
    for i in range(3):
        c = y[0] + (i + 0.5) * width / 3
        for dy in (-0.055, 0.055):
            w.ellipsoid((0.02, c + dy, 0.10), (0.13, 0.042, 0.048), w.new_look("book"), solid=False)
    w.top(x, inset(y, 0.1), seat + 0.015, "seat")


def beanbag(w: Workbench) -> None:
    """Builds a slumped bean bag with a raised back."""
    w.mass_kg = 4.0
    r, cloth = 0.5 * w.length(0.72, 0.90), w.look("bright")
    rings = [
        Ring(0.0, 0.86 * r, 0.86 * r),
        Ring(0.05, 0.97 * r, 0.97 * r),
        Ring(0.14, r, r),
        Ring(0.26, 0.94 * r, 0.95 * r, -0.02),
        Ring(0.36, 0.72 * r, 0.84 * r, -0.1),
        Ring(0.44, 0.46 * r, 0.7 * r, -0.2),
        Ring(0.60, 0.32 * r, 0.56 * r, -0.25),
        Ring(0.72, 0.22 * r, 0.4 * r, -0.27),
        Ring(0.77, 0.08 * r, 0.16 * r, -0.27),
    ]
    w.mesh(loft(rings, 18), (0.0, 0.0, 0.0), cloth)
    w.bar((-0.27, -0.03, 0.77), (-0.27, 0.03, 0.77), 0.01, 0.02, parts.darker(cloth, 0.6), solid=False)


def tufted_bench(w: Workbench) -> None:
    """Builds an upholstered bed bench on crossed metal legs."""
    width, depth, seat = w.width(0.95, 1.35), w.depth(0.40, 0.48), w.length(0.44, 0.48)
    metal, cloth = w.look("brass"), w.look("fabric")
    count = max(2, round(width / 0.35))
    for i in range(count):
        w.mesh(
            chamfered_box((depth, round(width / count - 0.004, 3), 0.12), 0.03),
            (0.0, (i + 0.5) * width / count - 0.5 * width, seat - 0.06),
            cloth,
        )
    w.box(centred(depth, 0.04), centred(width, 0.05), (seat - 0.15, seat - 0.11), w.look("dark"))
    for y in centred(width, 0.16):
        w.bar((-0.17, y, 0.0), (0.17, y, seat - 0.14), 0.025, 0.015, metal)
        w.bar((0.17, y, 0.0), (-0.17, y, seat - 0.14), 0.025, 0.015, metal)
    w.rod_y((0.0, 0.5 * (seat - 0.14)), centred(width, 0.16), 0.010, metal)
    w.top((-0.4 * depth, 0.4 * depth), (-0.4 * width, 0.4 * width), seat, "seat")


def settle(w: Workbench) -> None:
    """Builds a wooden hall bench with a panelled back and arms."""
    width, depth, high, seat, wood = (
        w.width(1.00, 1.40),
        w.depth(0.44, 0.52),
        w.length(0.92, 1.05),
        w.length(0.42, 0.45),
        w.look("wood"),
    )
    x, y = parts.footprint(depth, width)
    w.box((x[0], x[0] + 0.03), y, (seat - 0.04, high), wood)
    w.box((x[0] - 0.005, x[0] + 0.045), y, (high - 0.06, high), wood)
    w.box(x, y, (seat - 0.035, seat), wood)
    for c in centred(width, 0.02):
        w.box((x[0], x[1]), around(c, 0.02), (0.0, seat), wood)
        w.box((x[1] - 0.05, x[1] - 0.01), around(c, 0.02), (seat, 0.64), wood)
        w.box((x[0], x[1] + 0.01), around(c, 0.03), (0.64, 0.67), wood)
    w.box((x[1] - 0.04, x[1] - 0.02), y, (0.10, seat - 0.03), wood)
    for i in range(3):
        c = (i - 1) * width / 3.2
        w.mesh(
            chamfered_box((0.03, round(width / 3.8, 2), 0.30), 0.014),
            (x[0] + 0.03, c, 0.5 * (seat + high)),
            wood,
            solid=False,
        )
    w.top((x[0] + 0.05, x[1]), inset(y, 0.1), seat, "seat")


def slab_bench(w: Workbench) -> None:
    """Builds a bench of stone or plank on two blocks."""
    width, depth, seat = w.width(0.95, 1.40), w.depth(0.36, 0.42), w.length(0.42, 0.46)
    w.box(centred(depth), centred(width), (seat - 0.07, seat), w.look("wood"))
    for y in centred(width, 0.22):
        w.box(centred(depth, 0.03), around(y, 0.06), (0.0, seat - 0.07), w.look("stone"))
    w.top((-0.4 * depth, 0.4 * depth), (-0.4 * width, 0.4 * width), seat, "seat")


STYLES = (
    Style("seating", "bench_wood", "train", bench_wood, ("bench", "plain")),
    Style("seating", "storage_bench", "train", storage_bench, ("bench",)),
    Style("seating", "beanbag", "train", beanbag, ("ottoman",)),
    Style("seating", "tufted_bench", "train", tufted_bench, ("bench", "plain")),
    Style("seating", "ottoman", "train", ottoman, ("ottoman",)),
    Style("seating", "pouf", "heldout", pouf, ("ottoman",)),
    Style("seating", "settle", "heldout", settle, ("bench",)),
    Style("seating", "slab_bench", "heldout", slab_bench, ("bench", "plain")),
)
