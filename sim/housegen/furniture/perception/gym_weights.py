"""Weights and small gym equipment of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, hoop, loft
from sim.housegen.furniture.workbench import Workbench


def weight_discs(w: Workbench, x: float, y: float, z: float, side: int, radius: float, count: int) -> float:
    """Adds weight discs on a bar along y, outwards from `y`, and returns the y where they end."""
    for i in range(count):
        thick, r = 0.035, radius * (1.0 - 0.18 * i)
        look = w.look("rubber") if i % 2 == 0 else w.look("paint")
        w.rod((x, y, z), (x, y + side * thick, z), r, look)
        y += side * (thick + 0.004)
    return y


def squat_rack(w: Workbench) -> None:
    """Builds a power cage or a half rack with a loaded barbell."""
    half, high, deep = 0.5 * w.length(1.08, 1.25), w.height(1.80, 2.20), w.length(0.80, 1.30)
    iron, steel = w.look("iron") if w.chance(0.65) else w.look("paint"), w.look("chrome")
    cage = w.chance(0.6)
    x0, x1, t = -0.5 * deep, 0.5 * deep, 0.035
    for side in BOTH_SIDES:
        y = side * (half - t)
        w.box((x0, x1), (y - t, y + t), (0.0, 0.07), iron)
        for x in (x0 + t, x1 - t) if cage else (x0 + 0.3 * deep,):
            w.box((x - t, x + t), (y - t, y + t), (0.07, high), iron)
        if cage:
            w.box((x0, x1), (y - t, y + t), (high - 0.07, high), iron)
            w.rod((x0, y, 0.75), (x1, y, 0.75), 0.02, steel)
        else:
            w.box((x0 + 0.3 * deep, x1), (y - 0.03, y + 0.03), (0.62, 0.69), iron)
            w.bar((x0 + 0.05, y, 0.05), (x0 + 0.3 * deep, y, 0.55), 0.06, 0.06, iron)
    w.box((x0, x0 + 0.07), (-half, half), (0.0, 0.07), iron)
    post = x1 - t if cage else x0 + 0.3 * deep
    if cage:
        for x in (x0 + t, x1 - t):
            w.box((x - t, x + t), (-half, half), (high - 0.07, high), iron)
    else:
        w.box((post - t, post + t), (-half, half), (high - 0.10, high - 0.02), iron)
    z, reach, x = w.length(0.95, 1.40), 0.5 * w.length(1.80, 2.10), post + t + 0.025
    for side in BOTH_SIDES:
        w.box((post, post + 0.12), (side * (half - t) - 0.03, side * (half - t) + 0.03), (z - 0.06, z - 0.014), iron)
        end = weight_discs(w, x, side * (reach - 0.30), z, side, w.length(0.18, 0.225), w.whole(1, 3))
        w.rod((x, end, z), (x, side * reach, z), 0.025, steel)
    w.rod((x, -reach + 0.25, z), (x, reach - 0.25, z), 0.015, steel)
    if cage and w.chance(0.6):
        parts.leather_pad(w, (1.10, 0.28, 0.08), (0.1, 0.0, 0.43))
        for c in (-0.30, 0.50):
            w.box((c - 0.03, c + 0.03), (-0.20, 0.20), (0.0, 0.05), iron)
            w.box((c - 0.03, c + 0.03), (-0.03, 0.03), (0.05, 0.40), iron)


def plate_tree(w: Workbench) -> None:
    """Builds a stand with weight discs on pegs."""
    iron, steel = w.look("iron"), w.look("chrome")
    high, foot = w.length(0.95, 1.25), w.length(0.28, 0.36)
    w.box((-foot, foot), (-0.04, 0.04), (0.0, 0.06), iron)
    for x in (-foot + 0.04, foot - 0.04):
        w.box((x - 0.04, x + 0.04), (-0.30, 0.30), (0.0, 0.06), iron)
    twin = w.chance(0.5)
    if twin:
        for side in BOTH_SIDES:
            w.bar((side * (foot - 0.05), 0.0, 0.05), (side * 0.03, 0.0, high), 0.07, 0.06, iron)
    else:
        w.box((-0.04, 0.04), (-0.04, 0.04), (0.06, high), iron)
    levels = w.whole(2, 3)
    for i in range(levels):
        z = 0.30 + (high - 0.42) * i / (levels - 1)
        for side in BOTH_SIDES:
            w.rod((0.0, side * 0.02, z), (0.0, side * 0.26, z), 0.024, steel)
            weight_discs(w, 0.0, side * 0.05, z, side, (0.225, 0.17, 0.125)[i] * w.length(0.9, 1.0), w.whole(1, 3))
        if twin:
            reach = 0.03 + (foot - 0.08) * (high - z) / (high - 0.05)
            w.box((-reach, reach), (-0.035, 0.035), (z - 0.03, z + 0.03), iron)


def incline_bench(w: Workbench) -> None:
    """Builds an adjustable bench with a raised back pad, and sometimes dumbbells beside it."""
    frame, pivot, lean = w.look("iron") if w.chance(0.6) else w.look("appliance"), 0.42, w.length(0.3, 1.3)
    wide, back = w.length(0.25, 0.32), w.length(0.70, 0.85)
    w.box((-0.65, 0.55), (-0.035, 0.035), (0.06, 0.12), frame)
    for x, half in ((-0.62, w.length(0.20, 0.32)), (0.52, w.length(0.18, 0.26))):
        w.box((x - 0.035, x + 0.035), (-half, half), (0.0, 0.07), frame)
    w.bar((0.20, 0.0, 0.10), (0.15, 0.0, pivot), 0.06, 0.06, frame)
    parts.leather_pad(w, (0.36, wide, 0.08), (0.22, 0.0, pivot + 0.03), tilt=w.length(-0.25, 0.0))
    c, s = math.cos(lean), math.sin(lean)
    middle = (0.02 - 0.5 * back * c, pivot + 0.05 + 0.5 * back * s)
    parts.leather_pad(w, (back, wide, 0.08), (middle[0], 0.0, middle[1]), tilt=lean)
    w.bar((0.12, 0.0, pivot), (middle[0], 0.0, middle[1] - 0.03), 0.05, 0.05, frame)
    w.bar((-0.45, 0.0, 0.10), (middle[0], 0.0, middle[1]), 0.05, 0.05, frame)
    if w.chance(0.5):
        w.bar((0.18, 0.0, 0.40), (0.52, 0.0, 0.36), 0.05, 0.05, frame)
        w.bar((0.50, 0.0, 0.50), (0.56, 0.0, 0.12), 0.05, 0.05, frame)
        for z, x in ((0.48, 0.50), (0.20, 0.57)):
            w.rod((x, -0.22, z), (x, 0.22, z), 0.05, w.look("rubber"))
    for i in range(w.whole(0, 2)):
        x, r = 0.1 - 0.32 * i, w.length(0.05, 0.085)
        w.rod((x, 0.42, r), (x, 0.66, r), 0.016, w.look("chrome"))
        for y in (0.44, 0.64):
            w.rod((x, y - 0.045, r), (x, y + 0.045, r), r, w.look("rubber"))


def trampoline(w: Workbench) -> None:
    """Builds a small round trampoline, with or without a bar to hold."""
    r, z, legs = w.length(0.46, 0.68), w.length(0.20, 0.32), w.choice((4, 6, 8))
    w.cylinder((0.0, 0.0), (z - 0.02, z), r - 0.08, w.look("dark"))
    w.mesh(hoop(r, 0.12, 0.045), (0.0, 0.0, z), w.look("bright") if w.chance(0.6) else w.look("rubber"))
    for i in range(legs):
        a = math.tau * (i + 0.5) / legs
        at = ((r - 0.05) * math.cos(a), (r - 0.05) * math.sin(a))
        w.rod((*at, 0.0), (*at, z - 0.01), 0.016, w.look("metal"))
        w.rod((*at, 0.0), (*at, 0.035), 0.023, w.look("rubber"))
    if w.chance(0.55):
        high, x = w.length(0.95, 1.25), -0.86 * r
        for side in BOTH_SIDES:
            w.rod((x, side * 0.30, 0.0), (x - 0.05, side * 0.30, high), 0.016, w.look("metal"))
        w.rod((x - 0.05, -0.32, high), (x - 0.05, 0.32, high), 0.022, w.look("rubber"), round_ends=True)
        w.rod((x, -0.30, z - 0.02), (x, 0.30, z - 0.02), 0.014, w.look("metal"))


def medicine_balls(w: Workbench) -> None:
    """Builds a tower or a sloping rack with medicine balls."""
    count, r = w.whole(3, 5), w.length(0.105, 0.14)
    iron = w.look("iron") if w.chance(0.6) else w.look("chrome")
    if w.chance(0.5):
        w.cylinder((-r - 0.03, 0.0), (0.0, 0.03), 0.20, iron)
        w.box((-r - 0.20, 0.10), (-0.20, 0.20), (0.0, 0.03), iron)
        w.rod((-r - 0.03, 0.0, 0.03), (-r - 0.03, 0.0, 0.05 + count * (2 * r + 0.05)), 0.022, iron)
        for i in range(count):
            z = 0.06 + i * (2 * r + 0.05)
            w.rod((-r - 0.03, 0.0, z), (0.02, 0.0, z), 0.012, iron)
            w.mesh(hoop(0.7 * r, 0.02, 0.02, 16), (0.0, 0.0, z), iron)
            w.ball((0.0, 0.0, z + 0.76 * r), r, w.new_look("bright") if i % 2 else w.look("rubber"))
    else:
        half = 0.5 * count * 2.15 * r
        rows = w.whole(1, 2)
        for side in BOTH_SIDES:
            w.bar((0.18, side * half, 0.0), (-0.16, side * half, 0.35 + 0.40 * rows), 0.04, 0.05, iron)
            w.bar((-0.28, side * half, 0.0), (-0.10, side * half, 0.45), 0.04, 0.05, iron)
        for row in range(rows):
            z = 0.25 + 0.40 * row
            x = 0.18 - 0.34 * z / (0.35 + 0.40 * rows)
            for dx in (0.0, 1.2 * r):
                w.rod((x + dx, -half, z), (x + dx, half, z), 0.014, iron)
            for side in BOTH_SIDES:
                w.rod((x, side * half, z), (x + 1.2 * r, side * half, z), 0.014, iron)
            for i in range(count):
                y = (i - 0.5 * (count - 1)) * 2.1 * r
                w.ball((x + 0.6 * r, y, z + 0.8 * r), r, w.new_look("bright") if i % 2 else w.look("rubber"))


def floor_kit(w: Workbench) -> None:
    """Builds small equipment side by side: a balance ball, a wheel, grips, a rolled mat, blocks."""
    y, dark = 0.0, w.look("dark")
    kinds = [kind for kind in ("dome", "wheel", "grips", "roll", "blocks") if w.chance(0.65)] or ["dome", "grips"]
    for kind in kinds:
        if kind == "dome":
            r = w.length(0.27, 0.32)
            rings = [
                Ring(0.04, r, r),
                Ring(0.12, 0.93 * r, 0.93 * r),
                Ring(0.20, 0.7 * r, 0.7 * r),
                Ring(0.26, 0.25 * r, 0.25 * r),
            ]
            w.cylinder((0.0, y + r), (0.0, 0.05), r, dark)
            w.mesh(loft(rings, 16, hull=True), (0.0, y + r, 0.0), w.new_look("bright"))
            y += 2 * r + 0.08
        elif kind == "wheel":
            r = w.length(0.085, 0.11)
            for d in (0.14, 0.20)[: w.whole(1, 2)]:
                w.rod((0.0, y + d - 0.025, r), (0.0, y + d + 0.025, r), r, w.look("bright"))
            w.rod((0.0, y, r), (0.0, y + 0.34, r), 0.016, dark)
            y += 0.42
        elif kind == "grips":
            for x in (-0.22, 0.22):
                for d in (0.03, 0.19):
                    w.box((x - 0.08, x + 0.08), (y + d - 0.02, y + d + 0.02), (0.0, 0.03), w.look("metal"))
                    w.rod((x, y + d, 0.02), (x, y + d, 0.15), 0.012, w.look("metal"))
                w.rod((x, y, 0.15), (x, y + 0.22, 0.15), 0.018, w.look("rubber"), round_ends=True)
            y += 0.32
        elif kind == "roll":
            r = w.length(0.06, 0.085)
            w.rod((-0.32, y + r, r), (0.32, y + r, r), r, w.new_look("bright"))
            for x in (-0.18, 0.18):
                w.rod((x - 0.012, y + r, r), (x + 0.012, y + r, r), r + 0.004, dark, solid=False)
            y += 2 * r + 0.08
        else:
            for i in range(w.whole(2, 3)):
                w.box((-0.115, 0.115), (y, y + 0.15), (0.08 * i, 0.08 * i + 0.077), w.new_look("bright"))
            y += 0.22


STYLES: tuple[Style, ...] = (
    Style("gym_equipment", "squat_rack", "wide", squat_rack, ("weights",)),
    Style("gym_equipment", "plate_tree", "wide", plate_tree, ("weights",)),
    Style("gym_equipment", "incline_bench", "wide", incline_bench, ("weights",)),
    Style("gym_equipment", "trampoline", "wide", trampoline, ("small",)),
    Style("gym_equipment", "medicine_balls", "wide", medicine_balls, ("small",)),
    Style("gym_equipment", "floor_kit", "wide", floor_kit, ("small",)),
)
