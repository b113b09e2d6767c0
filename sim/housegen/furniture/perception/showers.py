"""Showers of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, drape, hoop, loft
from sim.housegen.furniture.workbench import Workbench


def shower_fittings(w: Workbench, x: float, y: float, floor: float, metal: Look) -> None:
    """Adds shower fittings to a back wall at x: a rail with hand shower, an arm, an exposed pipe or a column."""
    kind, z = w.choice(("bar", "arm", "exposed", "column")), floor + w.length(0.95, 1.1)
    if kind == "column":
        w.box(
            (x - 0.005, x + 0.04),
            (y - 0.09, y + 0.09),
            (floor + 0.6, 1.95),
            w.look(w.choice(("dark", "steel", "glass"))),
            solid=False,
        )
        for i in range(3):
            w.rod(
                (x + 0.03, y, floor + 0.8 + 0.25 * i), (x + 0.055, y, floor + 0.8 + 0.25 * i), 0.03, metal, solid=False
            )
        w.box((x, x + 0.30), (y - 0.10, y + 0.10), (1.93, 1.96), metal, solid=False)
        return
    w.box((x - 0.005, x + 0.05), (y - 0.13, y + 0.13), (z, z + 0.05), metal, solid=False)
    if kind == "bar":
        w.rod((x + 0.04, y + 0.10, z + 0.04), (x + 0.04, y + 0.10, 1.90), 0.009, metal, solid=False)
        w.rod((x - 0.005, y + 0.10, 1.88), (x + 0.04, y + 0.10, 1.88), 0.012, metal, solid=False)
        w.rod((x + 0.04, y + 0.10, 1.75), (x + 0.13, y + 0.10, 1.83), 0.012, metal, solid=False, round_ends=True)
        w.rod((x + 0.12, y + 0.10, 1.845), (x + 0.145, y + 0.10, 1.82), 0.05, metal, solid=False)
        parts.arched_pipe(w, (x + 0.04, y, z), (x + 0.05, y + 0.10, 1.75), -0.25, 0.006, metal, 4)
    elif kind == "arm":
        w.rod((x - 0.005, y, 2.0), (x + 0.28, y, 2.0), 0.011, metal, solid=False)
        w.cylinder((x + 0.28, y), (1.96, 2.0), w.length(0.06, 0.15), metal, solid=False)
        w.rod((x - 0.005, y, z - 0.15), (x + 0.03, y, z - 0.15), 0.05, metal, solid=False)
    else:
        w.rod((x + 0.04, y, z + 0.04), (x + 0.04, y, 1.95), 0.011, metal, solid=False)
        parts.arched_pipe(w, (x + 0.04, y, 1.95), (x + 0.34, y, 1.97), 0.09, 0.011, metal, 3)
        w.rod((x + 0.34, y, 1.98), (x + 0.34, y, 1.93), 0.022, metal, solid=False)
        w.cylinder((x + 0.34, y), (1.915, 1.935), w.length(0.07, 0.13), metal, solid=False)


def tiled_niche(w: Workbench) -> None:
    """Builds a tiled recess with a kerb; its glass door is shut or ajar, or it has a curtain or nothing."""
    width, depth, high = w.width(0.85, 1.30), w.depth(0.85, 1.10), w.length(2.05, 2.25)
    tile, metal, thick = w.look(w.choice(("masonry", "stone", "ceramic"))), parts.fitting_look(w), w.length(0.06, 0.11)
    x, y = parts.footprint(depth, width)
    w.box((x[0], x[0] + 0.04), y, (0.0, high), tile)
    low_side = w.length(1.0, 1.5) if w.chance(0.3) else high
    for side, top in ((-1, high), (1, low_side)):
        a, b = sorted((side * y[1], side * (y[1] - thick)))
        w.box((x[0] + 0.04, x[1]), (a, b), (0.0, top), tile)
    inner = (y[0] + thick, y[1] - thick)
    w.box((x[0] + 0.04, x[1]), inner, (0.0, 0.03), w.look(w.choice(("stone", "ceramic"))))
    w.box((x[1] - 0.09, x[1]), inner, (0.03, w.length(0.06, 0.14)), tile)
    span = inner[1] - inner[0]
    kind = w.choice(("shut", "ajar", "curtain", "open"))
    if kind == "shut":
        w.box((x[1] - 0.05, x[1] - 0.042), inner, (0.05, 1.95), w.look("glass"))
        w.rod((x[1] - 0.01, inner[1] - 0.10, 0.9), (x[1] - 0.01, inner[1] - 0.10, 1.2), 0.011, metal, solid=False)
        w.rod((x[1] - 0.045, inner[1] - 0.10, 1.05), (x[1] - 0.01, inner[1] - 0.10, 1.05), 0.008, metal, solid=False)
        w.box((x[1] - 0.06, x[1] - 0.03), inner, (1.95, 1.98), metal, solid=False)
    elif kind == "ajar":
        a = w.length(0.3, 0.8)
        end = (x[1] - 0.04 + 0.95 * span * math.sin(a), inner[0] + 0.95 * span * math.cos(a))
        middle = (0.5 * (x[1] - 0.04 + end[0]), 0.5 * (inner[0] + end[1]))
        half = 0.475 * span
        w.box(
            (middle[0] - 0.004, middle[0] + 0.004),
            (middle[1] - half, middle[1] + half),
            (0.15, 1.95),
            w.look("glass"),
            turn=-a,
        )
        w.cylinder((x[1] - 0.04, inner[0] + 0.012), (0.05, 1.97), 0.014, metal)
        w.cylinder(end, (0.95, 1.20), 0.014, metal, solid=False)
    elif kind == "curtain":
        w.rod((x[1] - 0.05, inner[0], 1.98), (x[1] - 0.05, inner[1], 1.98), 0.012, metal)
        wide = span * w.length(0.35, 0.95)
        w.mesh(
            drape(wide, 1.82, 0.06, w.whole(5, 10)),
            (x[1] - 0.08, inner[0] + 0.5 * wide, 0.16),
            w.look("curtain"),
            solid=False,
        )
    if w.chance(0.5):
        w.box((x[0] + 0.04, x[0] + 0.34), (inner[1] - 0.30, inner[1]), (0.03, 0.45), tile)
    shower_fittings(w, x[0] + 0.04, w.length(-0.15, 0.1) * width, 0.03, metal)


def crittall(w: Workbench) -> None:
    """Builds a walk-in shower behind one or two screens of small panes in dark bars."""
    width, depth, high = w.width(0.90, 1.50), w.depth(0.80, 1.00), w.length(1.90, 2.10)
    iron, metal = w.look(w.choice(("dark", "iron", "brass", "ceramic"))), parts.fitting_look(w)
    x, y = parts.footprint(depth, width)
    tray = w.choice((0.02, 0.05, 0.12))
    w.box(x, y, (0.0, tray), w.look(w.choice(("stone", "ceramic", "masonry"))))
    if w.chance(0.7):
        w.box((x[0] - 0.02, x[0] + 0.005), y, (0.0, high + 0.1), w.look(w.choice(("ceramic", "stone", "masonry"))))
    end = y[1] - (w.length(0.35, 0.55) if width > 1.05 else 0.0)
    columns, rows = w.whole(2, 4), w.whole(3, 5)
    face = x[1] - 0.02
    w.box((face - 0.004, face + 0.004), (y[0], end), (tray, high), w.look("glass"))
    for i in range(columns + 1):
        c, t = y[0] + 0.015 + i * (end - y[0] - 0.03) / columns, 0.015 if i in (0, columns) else 0.009
        w.box((face - 0.013, face + 0.013), (c - t, c + t), (tray, high), iron)
    for i in range(rows + 1):
        z = tray + 0.015 + i * (high - tray - 0.03) / rows
        w.box((face - 0.013, face + 0.013), (y[0], end), (z - 0.010, z + 0.010), iron)
    if w.chance(0.7):
        w.box(x, (y[0], y[0] + 0.008), (tray, high), w.look("glass"))
        for i in range(rows + 1):
            z = tray + 0.015 + i * (high - tray - 0.03) / rows
            w.box(x, (y[0] - 0.004, y[0] + 0.014), (z - 0.010, z + 0.010), iron)
        for c in (x[0] + 0.012, 0.0):
            w.box((c - 0.012, c + 0.012), (y[0] - 0.004, y[0] + 0.014), (tray, high), iron)
    else:
        w.rod((face, end - 0.02, high - 0.02), (x[0], end - 0.02, high - 0.02), 0.010, iron)
    w.box((x[0] - 0.015, x[0] + 0.012), (-0.14, 0.14), (tray - 0.01, 2.02), w.look("ceramic"), solid=False)
    shower_fittings(w, x[0] + 0.012, 0.0, tray, metal)


def care_shower(w: Workbench) -> None:
    """Builds a level-access shower with half-height doors or a curtain, a seat and grab bars."""
    width, depth, metal = w.width(0.85, 1.20), w.depth(0.85, 1.10), w.look(w.choice(("chrome", "plastic", "steel")))
    x, y = parts.footprint(depth, width)
    white = w.look(w.choice(("ceramic", "ceramic", "stone")))
    w.box(x, y, (0.0, 0.025), white)
    w.box((x[0], x[0] + 0.02), y, (0.025, 2.05), white)
    w.box(x, (y[0], y[0] + 0.02), (0.025, 2.05), white)
    glass, doors = w.look(w.choice(("glass", "plastic"))), w.chance(0.6)
    if doors:
        top = w.length(0.75, 1.0)
        for a, b in ((y[0] + 0.02, -0.01), (0.01, y[1])):
            w.box((x[1] - 0.03, x[1] - 0.02), (a, b), (0.025, top), glass)
            w.box((x[1] - 0.04, x[1] - 0.01), (a, b), (top, top + 0.03), metal)
            for c in (a, b):
                w.box((x[1] - 0.04, x[1] - 0.01), (c - 0.012, c + 0.012), (0.025, top), metal)
        w.box(x, (y[1] - 0.01, y[1]), (0.025, top), glass)
    if not doors or w.chance(0.5):
        w.rod((x[1] - 0.06, y[0], 2.0), (x[1] - 0.06, y[1] - 0.05, 2.0), 0.012, metal)
        w.rod((x[0], y[1] - 0.05, 2.0), (x[1] - 0.06, y[1] - 0.05, 2.0), 0.012, metal)
        wide = w.length(0.3, 0.7) * width
        w.mesh(drape(wide, 1.9, 0.07, 7), (x[1] - 0.09, y[0] + 0.03 + 0.5 * wide, 0.10), w.look("curtain"), solid=False)
    seat = w.choice(("folding", "stool", "none"))
    if seat == "folding":
        w.box((x[0] + 0.02, x[0] + 0.40), (-0.20, 0.20), (0.46, 0.49), w.look("plastic"))
        for side in BOTH_SIDES:
            w.rod((x[0] + 0.02, side * 0.15, 0.20), (x[0] + 0.36, side * 0.15, 0.46), 0.012, metal)
    elif seat == "stool":
        w.box((x[0] + 0.12, x[0] + 0.46), (-0.22, 0.18), (0.44, 0.48), w.look("plastic"))
        w.legs((x[0] + 0.14, x[0] + 0.44), (-0.20, 0.16), (0.025, 0.45), 0.025, metal, splay=0.03)
    z = w.length(0.8, 1.0)
    w.rod((x[0] + 0.08, 0.05, z), (x[0] + 0.08, y[1] - 0.06, z), 0.016, metal)
    for c in (0.07, y[1] - 0.08):
        w.rod((x[0] + 0.02, c, z), (x[0] + 0.08, c, z), 0.014, metal)
    w.rod((x[0] + 0.30, y[0] + 0.07, 0.7), (x[0] + 0.30, y[0] + 0.07, 1.35), 0.016, metal)
    for c in (0.72, 1.33):
        w.rod((x[0] + 0.30, y[0] + 0.02, c), (x[0] + 0.30, y[0] + 0.07, c), 0.014, metal)
    shower_fittings(w, x[0] + 0.02, -0.15, 0.025, metal)


def timber_shower(w: Workbench) -> None:
    """Builds a shower with a slatted wooden deck, a boarded back with exposed pipes and slatted screens."""
    width, depth, high = w.width(0.85, 1.20), w.depth(0.80, 1.00), w.length(2.02, 2.15)
    wood, metal = w.look("wood"), w.look(w.choice(("brass", "chrome", "iron")))
    x, y = parts.footprint(depth, width)
    for c in (x[0] + 0.06, x[1] - 0.06):
        w.box((c - 0.03, c + 0.03), y, (0.0, 0.05), w.look("dark"))
    count = round(width / 0.11)
    for i in range(count):
        c = y[0] + (i + 0.5) * width / count
        w.box(x, (c - 0.045, c + 0.045), (0.05, 0.075), wood)
    boards = round(high / 0.22)
    for i in range(boards):
        z = 0.075 + i * (high - 0.075) / boards
        w.box((x[0], x[0] + 0.025), y, (z, z + (high - 0.075) / boards - 0.008), wood)
    for c in y:
        inner = c - math.copysign(0.02, c)
        a, b = sorted((c, inner))
        w.box((x[0], x[0] + 0.04), (a, b), (0.05, high), wood)
    side = w.choice((-1, -1, 0))
    if side:
        for i in range(w.whole(4, 7)):
            z = 0.25 + i * 0.24
            w.box((x[0] + 0.025, x[1]), (y[0], y[0] + 0.02), (z, z + w.choice((0.10, 0.16))), wood)
        w.box((x[1] - 0.05, x[1]), (y[0], y[0] + 0.05), (0.05, high), wood)
    shower_fittings(w, x[0] + 0.025, 0.0, 0.075, metal)


def hoop_curtain(w: Workbench) -> None:
    """Builds a round or square tray with a curtain on a hoop that an upright pipe carries."""
    half, high, metal = 0.5 * w.width(0.75, 1.00), w.length(1.95, 2.15), parts.fitting_look(w)
    power, rim = w.choice((2.0, 6.0)), w.length(0.06, 0.30)
    tray = [Ring(0.0, half, half, power=power), *parts.hollow_rings(rim, half, half, min(0.8 * rim, 0.2), 0.04, power)]
    w.mesh(loft(tray, 18), (0.0, 0.0, 0.0), parts.sanitary_look(w))
    x, r = -half + 0.03, half - 0.06
    w.rod((x, 0.0, rim - 0.01), (x, 0.0, high), 0.014, metal)
    w.mesh(hoop(r, 0.016, 0.02, 20), (0.0, 0.0, high - 0.05), metal, solid=False)
    w.rod((x, 0.0, high - 0.05), (0.0, 0.0, high + 0.06), 0.009, metal, solid=False)
    w.rod((0.0, 0.0, high + 0.06), (r, 0.0, high - 0.05), 0.007, metal, solid=False)
    cloth, each = w.look(w.choice(("curtain", "sheer", "linen"))), 0.62 * r
    angles = w.choice(
        (
            (1.2, 1.9, 2.6, -2.6, -1.9, -1.2),
            (0.0, 0.62, -0.62, 1.25, 1.9, -1.25, -1.9),
            (1.6, 2.2),
            (-0.6, 0.0, 0.6, 1.2, 1.8),
        )
    )
    low = max(0.12, rim - 0.05)
    for a in angles:
        at = ((r - 0.03) * math.cos(a), (r - 0.03) * math.sin(a), low)
        w.mesh(drape(each, high - 0.05 - low, 0.06, 3), at, cloth, turn=a, solid=False)
    w.rod((x, 0.0, high - 0.10), (x + 0.26, 0.0, high - 0.08), 0.010, metal, solid=False)
    w.cylinder((x + 0.26, 0.0), (high - 0.12, high - 0.08), 0.07, metal, solid=False)
    w.box((x - 0.02, x + 0.05), (-0.12, 0.12), (1.0, 1.05), metal, solid=False)


STYLES: tuple[Style, ...] = (
    Style("shower", "tiled_niche", "wide", tiled_niche),
    Style("shower", "crittall", "wide", crittall),
    Style("shower", "care", "wide", care_shower),
    Style("shower", "timber", "wide", timber_shower),
    Style("shower", "hoop_curtain", "wide", hoop_curtain),
)
