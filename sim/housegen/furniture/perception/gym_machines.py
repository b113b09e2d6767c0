"""Gym machines of the pool `wide`."""

from __future__ import annotations

import math

from sim.housegen.furniture import parts
from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.parts import BOTH_SIDES
from sim.housegen.furniture.shapes import Ring, chamfered_box, frustum, loft, named_mesh
from sim.housegen.furniture.workbench import Workbench


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
    parts.leather_pad(w, (0.85, 2 * half - 0.12, 0.07), (at, 0.0, z + 0.17))
    for side in BOTH_SIDES:
        parts.leather_pad(w, (0.06, 0.14, 0.18), (at - 0.30, side * 0.15, z + 0.28))
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
    parts.leather_pad(w, (0.20, 0.30, 0.05), (at - 0.52, 0.0, z + 0.20), tilt=w.length(0.0, 0.3))
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


STYLES: tuple[Style, ...] = (
    Style("gym_equipment", "elliptical", "wide", elliptical, ("machine",)),
    Style("gym_equipment", "stair_climber", "wide", stair_climber, ("machine",)),
    Style("gym_equipment", "functional_trainer", "wide", functional_trainer, ("machine",)),
    Style("gym_equipment", "vibration_plate", "wide", vibration_plate, ("machine",)),
    Style("gym_equipment", "reformer", "wide", reformer, ("machine",)),
    Style("gym_equipment", "inversion_table", "wide", inversion_table, ("machine",)),
)
