"""Gym equipment of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, chamfered_box, frustum, hoop, loft, named_mesh
from sim.housegen.furniture.workbench import Point, Workbench


def _leather_pad(w: Workbench, size: Point, at: Point, *, tilt: float = 0.0) -> None:
    """Adds an upholstered pad with its middle at `at`."""
    parts.pad(w, size, at, w.look("leather"), 0.25 * min(size), tilt=tilt)


def _weight_discs(w: Workbench, x: float, y: float, z: float, side: int, radius: float, count: int) -> float:
    """Adds weight discs on a bar along y, outwards from `y`, and returns the y where they end."""
    for i in range(count):
        thick, r = 0.035, radius * (1.0 - 0.18 * i)
        look = w.look("rubber") if i % 2 == 0 else w.look("paint")
        w.rod((x, y, z), (x, y + side * thick, z), r, look)
        y += side * (thick + 0.004)
    return y


def elliptical(w: Workbench) -> None:
    """Builds a cross trainer with a flywheel housing, two pedal arms and two swinging handles."""
    length, high = w.depth(1.35, 1.85), w.length(1.50, 1.75)
    iron, dark, grey = w.look("iron"), w.look("dark"), w.look("metal")
    x0, x1, apart = -0.5 * length, 0.5 * length, w.length(0.11, 0.16)
    w.box((x0, x1), (-0.05, 0.05), (0.03, 0.10), iron)
    for x in (x0 + 0.04, x1 - 0.04):
        w.rod((x, -0.28, 0.035), (x, 0.28, 0.035), 0.035, dark)
    front = w.chance(0.5)
    cx = x0 + 0.35 if front else x1 - 0.35
    r = w.length(0.22, 0.30)
    w.rod((cx, -0.06, 0.08 + r), (cx, 0.06, 0.08 + r), r, dark)
    w.rod((cx, -0.075, 0.08 + r), (cx, 0.075, 0.08 + r), 0.4 * r, w.look("bright") if w.chance(0.4) else grey)
    mast = x0 + 0.20
    w.bar((mast + 0.06, 0.0, 0.08), (mast, 0.0, high - 0.12), 0.08, 0.06, iron)
    w.box((mast - 0.03, mast + 0.03), (-0.14, 0.14), (high - 0.20, high), dark, tilt=-0.4)
    w.box(
        (mast + 0.024, mast + 0.034),
        (-0.10, 0.10),
        (high - 0.17, high - 0.04),
        w.look("screen"),
        tilt=-0.4,
        solid=False,
    )
    swing = w.length(-0.16, 0.16)
    w.rod((mast + 0.02, -0.26, 0.9), (mast + 0.02, 0.26, 0.9), 0.025, iron)
    for side in BOTH_SIDES:
        y, dx, dz = side * apart, side * swing, side * 0.08
        w.rod((mast + 0.02 - dx, side * 0.24, 0.30), (mast + 0.02, side * 0.24, 0.90), 0.022, grey)
        w.rod((mast + 0.02, side * 0.24, 0.90), (mast + 0.10 + dx, side * 0.24, high - 0.16), 0.020, grey)
        w.rod(
            (mast + 0.10 + dx, side * 0.24, high - 0.16),
            (mast + 0.16 + dx, side * 0.20, high + 0.02),
            0.024,
            dark,
            round_ends=True,
        )
        back = x1 - 0.25
        w.bar((mast + 0.02 - dx, side * 0.22, 0.30), (back, y, 0.30 + dz), 0.05, 0.05, iron)
        if front:
            w.bar((back - 0.1, y, 0.08), (back - 0.05, y, 0.30 + dz), 0.04, 0.04, grey)
        else:
            w.bar((cx, side * 0.075, 0.08 + r), (back, y, 0.30 + dz), 0.04, 0.04, grey)
        foot = mast + w.length(0.50, 0.62) + dx
        w.box(
            (foot - 0.19, foot + 0.19),
            (y + side * 0.03 - 0.08, y + side * 0.03 + 0.08),
            (0.30 + 0.4 * dz, 0.36 + 0.4 * dz),
            w.look("rubber"),
        )


def stair_climber(w: Workbench) -> None:
    """Builds a stair machine with steps between side panels, handrails and a console."""
    half, length = 0.5 * w.width(0.72, 0.90), w.depth(1.15, 1.45)
    shell, dark = w.look("dark") if w.chance(0.5) else w.look("appliance"), w.look("dark")
    count, rise = w.whole(3, 5), w.length(0.17, 0.21)
    x1 = 0.5 * length
    run = (length - 0.30) / count
    for i in range(count):
        w.box(
            (x1 - (i + 1) * run, x1 - i * run + 0.02),
            (-half + 0.09, half - 0.09),
            (0.0 if i == 0 else i * rise - 0.05, (i + 1) * rise),
            w.look("rubber"),
        )
    back, peak = x1 - count * run, count * rise
    w.box((-x1, back), (-half + 0.09, half - 0.09), (0.0, peak + 0.25), shell)
    for side in BOTH_SIDES:
        y = sorted((side * (half - 0.09), side * half))
        outline = [(-x1, 0.0), (x1, 0.0), (x1, 0.20), (back, peak + 0.18), (-x1, peak + 0.30)]
        w.mesh(named_mesh("cheek", [(x, at, z) for at in y for x, z in outline]), (0.0, 0.0, 0.0), shell)
        c = side * (half - 0.045)
        w.rod((x1 - 0.15, c, 0.25), (x1 - 0.20, c, 1.05), 0.022, w.look("metal"))
        w.rod((x1 - 0.20, c, 1.05), (back - 0.05, c, peak + 0.85), 0.022, w.look("metal"), round_ends=True)
        w.bar((-x1 + 0.12, c, peak + 0.20), (-x1 + 0.10, c, peak + 1.05), 0.05, 0.08, shell)
        w.rod((back - 0.05, c, peak + 0.85), (-x1 + 0.10, c, peak + 0.90), 0.022, w.look("metal"), round_ends=True)
    w.box((-x1 + 0.04, -x1 + 0.11), (-half + 0.02, half - 0.02), (peak + 0.85, peak + 1.20), dark, tilt=-0.3)
    w.box(
        (-x1 + 0.10, -x1 + 0.118), (-0.18, 0.18), (peak + 0.92, peak + 1.14), w.look("screen"), tilt=-0.3, solid=False
    )


def functional_trainer(w: Workbench) -> None:
    """Builds two cable columns with weight stacks, a cross beam and handles on cords."""
    half, high = 0.5 * w.width(1.20, 1.75), w.height(1.95, 2.15)
    iron, chrome = w.look("iron") if w.chance(0.6) else w.look("appliance"), w.look("chrome")
    angled = w.length(0.0, 0.25)
    for side in BOTH_SIDES:
        y = side * (half - 0.13)
        w.box((-0.35, 0.45), (y - 0.11, y + 0.11), (0.0, 0.06), iron)
        for x in (-0.28, 0.10):
            w.box((x - 0.035, x + 0.035), (y - 0.035, y + 0.035), (0.06, high), iron)
        w.box((-0.20, 0.02), (y - 0.09, y + 0.09), (0.06, w.length(0.55, 0.95)), w.look("rubber"))
        for dy in (-0.05, 0.05):
            w.rod((-0.09, y + dy, 0.06), (-0.09, y + dy, high - 0.06), 0.010, chrome, solid=False)
        w.box((-0.31, 0.14), (y - 0.07, y + 0.07), (high - 0.08, high), iron)
        z = w.length(0.4, 1.5)
        w.box((0.13, 0.24), (y - 0.05, y + 0.05), (z, z + 0.12), w.look("dark"))
        w.rod((0.22, y, z + 0.02), (0.22 + angled, y - side * 0.06, z - 0.22), 0.006, w.look("dark"), solid=False)
        w.rod(
            (0.22 + angled, y - side * 0.13, z - 0.22),
            (0.22 + angled, y + side * 0.01, z - 0.22),
            0.018,
            w.look("rubber"),
        )
    w.box((-0.31, -0.25), (-half + 0.13, half - 0.13), (high - 0.08, high), iron)
    if w.chance(0.6):
        w.rod((0.10, -half + 0.12, high - 0.04), (0.10, half - 0.12, high - 0.04), 0.018, chrome)
    if w.chance(0.5):
        w.box((-0.31, -0.26), (-half + 0.13, half - 0.13), (0.15, 0.75), iron)


def vibration_plate(w: Workbench) -> None:
    """Builds a thick rounded platform with a column, two handles and a console."""
    deep, half = w.length(0.62, 0.80), 0.5 * w.width(0.60, 0.78)
    shell = w.look("appliance") if w.chance(0.5) else w.look("dark")
    plinth, high = w.length(0.13, 0.20), w.length(1.15, 1.40)
    rings = [
        Ring(0.0, 0.48 * deep, 0.94 * half, power=3.5),
        Ring(0.6 * plinth, 0.5 * deep, half, power=3.5),
        Ring(plinth, 0.46 * deep, 0.92 * half, power=3.5),
    ]
    w.mesh(loft(rings, 20, hull=True), (0.0, 0.0, 0.0), shell)
    w.box((-0.18 * deep, 0.40 * deep), (-0.8 * half, 0.8 * half), (plinth, plinth + 0.012), w.look("rubber"))
    x = -0.42 * deep
    if w.chance(0.6):
        w.mesh(
            frustum((0.14, 0.26), (0.09, 0.14), high - plinth - 0.05, (0.10, 0.0)),
            (x + 0.09, 0.0, plinth - 0.03),
            shell,
        )
        w.bar((x + 0.15, 0.0, high - 0.12), (x + 0.22, 0.0, high - 0.12), 0.10, 0.05, shell)
    else:
        for side in BOTH_SIDES:
            w.rod((x + 0.06, side * 0.14, plinth - 0.02), (x + 0.19, side * 0.12, high - 0.05), 0.024, w.look("metal"))
    w.box((x + 0.16, x + 0.21), (-0.17, 0.17), (high - 0.12, high + 0.10), shell, tilt=-0.5)
    w.box((x + 0.205, x + 0.215), (-0.11, 0.11), (high - 0.07, high + 0.06), w.look("screen"), tilt=-0.5, solid=False)
    for side in BOTH_SIDES:
        y = side * 0.75 * half
        w.rod((x + 0.18, 0.0, high - 0.05), (x + 0.18, y, high - 0.06), 0.020, w.look("dark"), round_ends=True)
        w.rod((x + 0.18, y, high - 0.06), (x + 0.42, y, high - 0.10), 0.020, w.look("dark"), round_ends=True)


def reformer(w: Workbench) -> None:
    """Builds a Pilates reformer: a long frame with a padded carriage, shoulder rests and a foot bar."""
    length, half, z = w.depth(2.10, 2.40), 0.5 * w.width(0.60, 0.72), w.length(0.18, 0.42)
    frame = w.look("wood") if w.chance(0.7) else w.look("metal")
    x0, x1 = -0.5 * length, 0.5 * length
    for side in BOTH_SIDES:
        y = sorted((side * (half - 0.05), side * half))
        w.box((x0, x1), (y[0], y[1]), (z, z + 0.12), frame)
        for x in (x0 + 0.02, x1 - 0.10):
            w.box((x, x + 0.08), (y[0], y[1]), (0.0, z), frame)
    for x in (x0, x1 - 0.05):
        w.box((x, x + 0.05), (-half, half), (z, z + 0.12), frame)
    at = w.length(-0.35, 0.15)
    w.box((at - 0.40, at + 0.40), (-half + 0.04, half - 0.04), (z + 0.10, z + 0.14), w.look("dark"))
    _leather_pad(w, (0.85, 2 * half - 0.12, 0.07), (at, 0.0, z + 0.17))
    for side in BOTH_SIDES:
        _leather_pad(w, (0.06, 0.14, 0.18), (at - 0.30, side * 0.15, z + 0.28))
        w.rod(
            (x0 + 0.06, side * (half - 0.03), z + 0.10),
            (x0 + 0.06, side * (half - 0.03), z + w.length(0.35, 0.60)),
            0.018,
            w.look("chrome"),
        )
        w.rod(
            (x1 - 0.35, side * (half - 0.02), z + 0.10),
            (x1 - 0.15, side * (half - 0.02), z + 0.45),
            0.016,
            w.look("chrome"),
        )
    _leather_pad(w, (0.20, 0.30, 0.05), (at - 0.52, 0.0, z + 0.20), tilt=w.length(0.0, 0.3))
    w.rod(
        (x1 - 0.15, -half + 0.01, z + 0.45),
        (x1 - 0.15, half - 0.01, z + 0.45),
        0.026,
        w.look("rubber"),
        round_ends=True,
    )
    w.box((x1 - 0.30, x1 - 0.04), (-half + 0.03, half - 0.03), (z + 0.10, z + 0.15), w.look("leather"))
    for i in range(w.whole(3, 5)):
        y = 0.08 * (i - 2)
        w.rod((at + 0.38, y, z + 0.12), (x1 - 0.04, y, z + 0.08), 0.012, w.look("chrome"), solid=False)


def inversion_table(w: Workbench) -> None:
    """Builds an A-frame with a tilted padded board and foot clamps."""
    half, pivot, tilt = 0.5 * w.width(0.62, 0.76), w.length(0.80, 1.00), w.length(0.25, 0.95)
    iron, y_in = w.look("iron") if w.chance(0.6) else w.look("paint"), 0.5 * w.length(0.36, 0.44)
    spread = w.length(0.45, 0.60)
    for side in BOTH_SIDES:
        y = side * (half - 0.025)
        for foot in (-spread, spread):
            w.rod((foot, y, 0.025), (0.0, y, pivot), 0.022, iron)
        w.box((-0.05, 0.05), (y - 0.03, y + 0.03), (pivot - 0.06, pivot + 0.10), w.look("dark"))
        w.rod((0.0, y, pivot), (0.0, side * (y_in - 0.02), pivot), 0.016, iron)
        if w.chance(0.5):
            w.rod((0.0, y, pivot + 0.10), (0.28, y, pivot + 0.28), 0.020, w.look("rubber"), round_ends=True)
    for foot in (-spread, spread):
        w.rod((foot, -half, 0.025), (foot, half, 0.025), 0.025, iron)
    c, s = math.cos(tilt), math.sin(tilt)
    back = w.length(0.95, 1.20)
    w.mesh(
        chamfered_box((back, 2 * y_in, 0.07), 0.02),
        (-0.25 * back * c, 0.0, pivot + 0.25 * back * s),
        w.look("leather"),
        tilt=tilt,
    )
    w.rod((0.20 * c, 0.0, pivot - 0.20 * s), (0.85 * c, 0.0, pivot - 0.85 * s), 0.022, w.look("chrome"))
    for t in (0.70, 0.82):
        at = (t * c, pivot - t * s)
        w.rod((at[0], -0.16, at[1] + 0.03), (at[0], 0.16, at[1] + 0.03), 0.045, w.look("rubber"))


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
        end = _weight_discs(w, x, side * (reach - 0.30), z, side, w.length(0.18, 0.225), w.whole(1, 3))
        w.rod((x, end, z), (x, side * reach, z), 0.025, steel)
    w.rod((x, -reach + 0.25, z), (x, reach - 0.25, z), 0.015, steel)
    if cage and w.chance(0.6):
        _leather_pad(w, (1.10, 0.28, 0.08), (0.1, 0.0, 0.43))
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
            _weight_discs(w, 0.0, side * 0.05, z, side, (0.225, 0.17, 0.125)[i] * w.length(0.9, 1.0), w.whole(1, 3))
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
    _leather_pad(w, (0.36, wide, 0.08), (0.22, 0.0, pivot + 0.03), tilt=w.length(-0.25, 0.0))
    c, s = math.cos(lean), math.sin(lean)
    middle = (0.02 - 0.5 * back * c, pivot + 0.05 + 0.5 * back * s)
    _leather_pad(w, (back, wide, 0.08), (middle[0], 0.0, middle[1]), tilt=lean)
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
    Style("gym_equipment", "elliptical", "wide", elliptical, ("machine",)),
    Style("gym_equipment", "stair_climber", "wide", stair_climber, ("machine",)),
    Style("gym_equipment", "functional_trainer", "wide", functional_trainer, ("machine",)),
    Style("gym_equipment", "vibration_plate", "wide", vibration_plate, ("machine",)),
    Style("gym_equipment", "reformer", "wide", reformer, ("machine",)),
    Style("gym_equipment", "inversion_table", "wide", inversion_table, ("machine",)),
    Style("gym_equipment", "squat_rack", "wide", squat_rack, ("weights",)),
    Style("gym_equipment", "plate_tree", "wide", plate_tree, ("weights",)),
    Style("gym_equipment", "incline_bench", "wide", incline_bench, ("weights",)),
    Style("gym_equipment", "trampoline", "wide", trampoline, ("small",)),
    Style("gym_equipment", "medicine_balls", "wide", medicine_balls, ("small",)),
    Style("gym_equipment", "floor_kit", "wide", floor_kit, ("small",)),
)
