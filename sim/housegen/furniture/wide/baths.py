"""Showers and bathtubs of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.item import Look
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, drape, hoop, loft
from sim.housegen.furniture.workbench import Workbench


def _shower_fittings(w: Workbench, x: float, y: float, floor: float, metal: Look) -> None:
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
    _shower_fittings(w, x[0] + 0.04, w.length(-0.15, 0.1) * width, 0.03, metal)


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
    _shower_fittings(w, x[0] + 0.012, 0.0, tray, metal)


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
    _shower_fittings(w, x[0] + 0.02, -0.15, 0.025, metal)


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
    _shower_fittings(w, x[0] + 0.025, 0.0, 0.075, metal)


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


def _straight_tub(w: Workbench, x: float, y: float, high: float, rim: float, power: float, look: Look) -> None:
    """Adds a tub with straight outer sides and a rounded hollow with a drain; x and y are half sizes."""
    rings = [
        Ring(0.0, x, y, power=24), Ring(high, x, y, power=24), Ring(high, x - rim, y - rim, power=power),
        Ring(0.5 * high, 0.88 * (x - rim), 0.92 * (y - rim), power=power), Ring(0.14, 0.65 * x, 0.78 * y, power=power),
    ]  # fmt: skip
    w.mesh(loft(rings, 16), (0.0, 0.0, 0.0), look)
    w.cylinder((0.0, 0.55 * y), (0.135, 0.148), 0.03, w.look("chrome"), solid=False)


def platform_tub(w: Workbench) -> None:
    """Builds a tub in a broad tiled or wooden deck with one or two steps in front of it."""
    width, depth, high = w.width(1.70, 2.10), w.length(0.90, 1.20), w.length(0.45, 0.60)
    deck, white, metal = w.look(w.choice(("stone", "masonry", "wood"))), w.look("ceramic"), parts.fitting_look(w)
    x, y, power = 0.5 * depth, 0.5 * width, w.choice((2.3, 4.0, 8.0))
    bx, by = x - w.length(0.10, 0.16), y - w.length(0.14, 0.24)
    w.box((-x, -bx), (-y, y), (0.0, high), deck)
    w.box((bx, x), (-y, y), (0.0, high), deck)
    for side in BOTH_SIDES:
        a, b = sorted((side * by, side * y))
        w.box((-bx, bx), (a, b), (0.0, high), deck)
    _straight_tub(w, bx, by, high + 0.012, 0.05, power, white)
    wide = w.length(0.4, 1.0) * width
    steps = w.whole(1, 2)
    for i in range(steps):
        rise = high * (i + 1) / (steps + 1)
        w.box((x, x + 0.27 * (steps - i)), (-0.5 * wide, 0.5 * wide), (0.0, rise), deck)
    parts.any_tap(w, (-x + 0.05, w.choice((0.0, 0.35)) * width, high), 0.18, w.length(0.10, 0.22), metal)
    if w.chance(0.4):
        for side in BOTH_SIDES:
            w.cylinder((x - 0.06, side * (y - 0.06)), (high, 1.1), 0.02, metal)
        w.rod((x - 0.06, -y + 0.06, 1.1), (x - 0.06, y - 0.06, 1.1), 0.015, metal, solid=False)


def curtain_tub(w: Workbench) -> None:
    """Builds a tub with tiles behind it and at the tap end, a shower pipe and a curtain along its front."""
    width, depth, high = w.width(1.40, 1.75), w.depth(0.70, 0.82), w.length(0.38, 0.56)
    tile, white, metal = w.look(w.choice(("ceramic", "stone", "masonry"))), w.look("ceramic"), parts.fitting_look(w)
    x, y, top = 0.5 * depth, 0.5 * width, w.length(1.85, 2.05)
    _straight_tub(w, x, y, high, 0.06, w.choice((3.0, 5.0)), white)
    back = top + 0.12 if w.chance(0.6) else w.length(0.9, 1.3)
    w.box((-x - 0.02, -x + 0.002), (-y, y), (0.0, back), tile)
    w.box((-x - 0.02, x), (y, y + 0.03), (0.0, top + 0.12), tile)
    w.rod((x - 0.03, -y, top), (x - 0.03, y, top), 0.013, metal)
    if back < top:
        w.rod((x - 0.03, -y + 0.015, high), (x - 0.03, -y + 0.015, top), 0.012, metal)
    else:
        w.rod((-x, -y + 0.015, top), (x - 0.03, -y + 0.015, top), 0.012, metal)
    wide, inside = w.length(0.2, 0.85) * width, w.chance(0.4)
    start, low = w.choice((-y + 0.5 * wide, y - 0.5 * wide)), (high - 0.15 if inside else 0.15)
    look = w.look(w.choice(("curtain", "curtain", "sheer")))
    w.mesh(
        drape(wide, top - low, 0.07, w.whole(6, 11)), (x - 0.09 if inside else x - 0.02, start, low), look, solid=False
    )
    w.rod((0.0, y + 0.005, top - 0.02), (0.0, y - 0.14, top - 0.05), 0.011, metal, solid=False)
    w.rod((0.0, y - 0.13, top - 0.04), (0.0, y - 0.18, top - 0.10), 0.05, metal, solid=False)
    w.rod((0.0, y + 0.005, high + 0.14), (0.0, y - 0.14, high + 0.13), 0.02, metal, solid=False)
    w.rod((0.0, y + 0.005, high + 0.45), (0.0, y - 0.03, high + 0.45), 0.07, metal, solid=False)


def ofuro(w: Workbench) -> None:
    """Builds a short deep soaking tub of boards or stone with a broad rim, and sometimes a cover or a stool."""
    width, depth, high = w.width(0.85, 1.35), w.depth(0.75, 1.00), w.length(0.60, 0.80)
    look = w.look(w.choice(("wood", "wood", "stone")))
    x, y, thick = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width), w.length(0.03, 0.06)
    parts.basin(w, x, y, high, high - 0.04, thick, look)
    for side in BOTH_SIDES:
        w.box((x[0] + 0.02, x[1] - 0.02), (side * 0.3 * width - 0.04, side * 0.3 * width + 0.04), (0.0, 0.045), look)
        a, b = sorted((side * (y[1] + 0.03), side * (y[1] - thick - 0.01)))
        w.box((x[0] - 0.03, x[1] + 0.03), (a, b), (high, high + 0.025), look)
        c, d = sorted((side * (x[1] + 0.03), side * (x[1] - thick - 0.01)))
        w.box((c, d), (y[0] + thick, y[1] - thick), (high, high + 0.025), look)
    if w.chance(0.5):
        for i in range(1, w.whole(3, 5)):
            z = i * high / 5
            w.box(
                (x[0] - 0.006, x[1] + 0.006), (y[0] - 0.006, y[1] + 0.006), (z - 0.004, z + 0.004), parts.darker(look)
            )
    if w.chance(0.5):
        end = y[0] + w.length(0.3, 0.7) * width
        count = max(2, int((end - y[0]) / 0.12))
        for i in range(count):
            a = y[0] + i * 0.12
            w.box((x[0], x[1]), (a, a + 0.112), (high + 0.025, high + 0.045), look)
    else:
        w.box(
            (x[0] + thick, x[1] - thick),
            (y[0] + thick, y[1] - thick),
            (0.7 * high, 0.71 * high),
            w.look("glass"),
            solid=False,
        )
    if w.chance(0.6):
        w.box((x[1] + 0.03, x[1] + 0.31), (-0.24, 0.24), (0.24, 0.28), look)
        for side in BOTH_SIDES:
            w.box((x[1] + 0.02, x[1] + 0.29), (side * 0.2 - 0.02, side * 0.2 + 0.02), (0.0, 0.24), look)
    metal, spout = parts.fitting_look(w), y[1] - 0.2
    w.cylinder((x[0] + 0.012, spout), (high + 0.02, high + 0.16), 0.02, metal, solid=False)
    w.rod((x[0] + 0.012, spout, high + 0.14), (x[0] + 0.19, spout, high + 0.13), 0.016, metal, solid=False)


def walk_in_tub(w: Workbench) -> None:
    """Builds a high narrow tub with a door in its front, a seat at one end, a grab bar and a hand shower."""
    width, depth, high = w.width(1.20, 1.55), w.depth(0.68, 0.82), w.length(0.85, 1.02)
    white, metal = w.look("ceramic"), w.look("chrome")
    x, y, thick = (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width), 0.06
    tap_side = w.choice(BOTH_SIDES)
    parts.basin(w, x, y, high, high, thick, white)
    a, b = sorted((-tap_side * (y[1] - thick), -tap_side * (y[1] - 0.48)))
    w.box((x[0] + thick, x[1] - thick), (a, b), (thick, 0.45), white)
    a, b = sorted((tap_side * 0.03, tap_side * (0.03 + w.length(0.42, 0.50))))
    door = w.look(w.choice(("ceramic", "glass", "plastic")))
    w.box((x[1] - 0.01, x[1] + 0.015), (a, b), (0.12, high - 0.03), parts.darker(white, 0.6), solid=False)
    w.box((x[1], x[1] + 0.022), (a + 0.012, b - 0.012), (0.132, high - 0.042), door)
    w.box(
        (x[1] + 0.02, x[1] + 0.045), (tap_side * 0.09 - 0.015, tap_side * 0.09 + 0.015), (0.5, 0.68), metal, solid=False
    )
    w.rod((x[0] + 0.03, -0.2, high + 0.10), (x[0] + 0.03, 0.2, high + 0.10), 0.014, metal)
    for side in BOTH_SIDES:
        w.rod((x[0] + 0.03, side * 0.19, high), (x[0] + 0.03, side * 0.19, high + 0.10), 0.012, metal)
    parts.any_tap(w, (x[0] + 0.03, tap_side * (y[1] - 0.22), high), 0.14, 0.12, metal)
    if w.chance(0.5):
        at = (x[0] + 0.025, tap_side * (y[1] - 0.05))
        w.cylinder(at, (high, high + 0.75), 0.010, metal)
        w.rod((*at, high + 0.6), (at[0] + 0.10, at[1], high + 0.68), 0.014, metal, solid=False)
    if w.chance(0.5):
        for i in range(4):
            w.rod(
                (x[0] + thick - 0.005, 0.12 * i - 0.2, 0.4),
                (x[0] + thick + 0.01, 0.12 * i - 0.2, 0.4),
                0.025,
                metal,
                solid=False,
            )


def screened_tub(w: Workbench) -> None:
    """Builds a tub behind framed sliding panes up to head height, with an apron and a back panel."""
    width, depth, high = w.width(1.45, 1.80), w.depth(0.70, 0.82), w.length(0.42, 0.58)
    white, metal = w.look("ceramic"), w.look(w.choice(("chrome", "dark", "brass")))
    x, y, top = 0.5 * depth, 0.5 * width, w.length(1.75, 2.0)
    _straight_tub(w, x, y, high, 0.06, w.choice((3.0, 5.0)), white)
    apron = w.choice(("masonry", "wood", "stone", "none"))
    if apron != "none":
        w.box((x - 0.005, x + 0.012), (-y, y), (0.0, high - 0.03), w.look(apron))
    count = w.whole(2, 4)
    each = 2 * y / count
    slide = w.chance(0.5)
    for i in range(count):
        front = x - 0.02 - 0.016 * (i % 2)
        a = -y + i * each
        if slide and i == count - 1:
            a -= 0.6 * each
        w.box((front - 0.003, front + 0.003), (a, a + each), (high, top), w.look("glass"))
        for c in (a + 0.012, a + each - 0.012):
            w.box((front - 0.009, front + 0.009), (c - 0.012, c + 0.012), (high, top), metal)
    w.box((x - 0.055, x - 0.005), (-y, y), (top, top + 0.04), metal)
    w.box((x - 0.05, x - 0.01), (-y, y), (high - 0.002, high + 0.02), metal)
    for c in (-y + 0.012, y - 0.012):
        w.box((x - 0.05, x - 0.01), (c - 0.012, c + 0.012), (high, top), metal)
    w.box((-x - 0.02, -x + 0.002), (-y, y), (0.0, top + 0.1), w.look(w.choice(("ceramic", "stone", "masonry"))))
    w.rod((-x, 0.3 * width, 1.85), (-x + 0.22, 0.3 * width, 1.83), 0.011, metal, solid=False)
    w.cylinder((-x + 0.22, 0.3 * width), (1.79, 1.83), 0.09, metal, solid=False)
    w.box((-x, -x + 0.06), (0.3 * width - 0.12, 0.3 * width + 0.12), (high + 0.2, high + 0.25), metal, solid=False)


STYLES: tuple[Style, ...] = (
    Style("shower", "tiled_niche", "wide", tiled_niche),
    Style("shower", "crittall", "wide", crittall),
    Style("shower", "care", "wide", care_shower),
    Style("shower", "timber", "wide", timber_shower),
    Style("shower", "hoop_curtain", "wide", hoop_curtain),
    Style("bathtub", "platform", "wide", platform_tub),
    Style("bathtub", "curtain", "wide", curtain_tub),
    Style("bathtub", "ofuro", "wide", ofuro),
    Style("bathtub", "walk_in_tub", "wide", walk_in_tub),
    Style("bathtub", "screened", "wide", screened_tub),
)
