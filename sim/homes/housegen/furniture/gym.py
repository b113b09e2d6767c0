"""Gym equipment.

Usual retail dimensions: treadmills 1.70-2.10 m long, 0.75-0.90 m wide, 1.30-1.50 m high; benches 1.10-1.30 m long,
0.42-0.48 m high; barbells 1.50-2.20 m; exercise bikes 1.00-1.25 m long; rowers 2.10-2.45 m; yoga mats 1.83 x 0.61 m.
"""

from __future__ import annotations

from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.parts import BOTH_SIDES, around, centred, inset
from sim.homes.housegen.furniture.shapes import chamfered_box
from sim.homes.housegen.furniture.workbench import Workbench


def treadmill(w: Workbench) -> None:
    """Builds a treadmill with a motor hood, uprights and a console; its user steps on from the front (+x)."""
    length, half, dark, metal = w.depth(1.60, 1.85), 0.5 * w.length(0.74, 0.84), w.look("dark"), w.look("metal")
    x0, x1 = centred(length)
    w.box((x0 + 0.1, x1), (-half + 0.10, half - 0.10), (0.05, 0.14), w.look("rubber"))
    for side in BOTH_SIDES:
        y = side * (half - 0.06)
        w.box((x0 + 0.1, x1), around(y, 0.045), (0.03, 0.17), metal)
        w.bar((x0 + 0.16, side * (half - 0.03), 0.0), (x0 + 0.06, side * (half - 0.03), 1.20), 0.05, 0.07, metal)
        w.rod(
            (x0 + 0.08, side * (half - 0.03), 1.02),
            (x0 + 0.62, side * (half - 0.03), 0.98),
            0.022,
            dark,
            round_ends=True,
        )
    w.mesh(chamfered_box((0.34, 2 * half - 0.10, 0.22), 0.05), (x0 + 0.27, 0.0, 0.14), dark)
    w.box((x0 + 0.02, x0 + 0.08), (-half + 0.02, half - 0.02), (1.10, 1.38), dark, tilt=-0.4)
    w.box((x0 + 0.072, x0 + 0.082), (-0.18, 0.18), (1.162, 1.342), w.look("screen"), tilt=-0.4, solid=False)
    w.box((x1 - 0.1, x1 - 0.02), (-half + 0.02, half - 0.02), (0.0, 0.06), dark)


def bench_barbell(w: Workbench) -> None:
    """Builds a flat bench under a barbell on two stands."""
    leather, metal, steel = w.look("leather"), w.look("iron"), w.look("chrome")
    w.mesh(chamfered_box((1.15, 0.28, 0.08), 0.02), (0.1, 0.0, 0.44), leather)
    w.box((-0.35, 0.60), (-0.03, 0.03), (0.35, 0.41), metal)
    for x in (-0.30, 0.55):
        w.box(around(x, 0.03), (-0.03, 0.03), (0.04, 0.36), metal)
        w.box(around(x, 0.03), (-0.25, 0.25), (0.0, 0.05), metal)
    half, high = 0.5 * w.width(1.60, 1.90), w.length(0.95, 1.05)
    for side in BOTH_SIDES:
        w.box((-0.40, -0.34), around(side * 0.42, 0.03), (0.0, high + 0.04), metal)
        w.box((-0.62, -0.12), around(side * 0.42, 0.03), (0.0, 0.05), metal)
        w.box((-0.35, -0.28), around(side * 0.42, 0.02), (high - 0.04, high - 0.012), metal)
        w.rod_y((-0.31, high), (side * (half - 0.24), side * (half - 0.19)), 0.20, w.look("rubber"))
        w.rod_y((-0.31, high), (side * (half - 0.18), side * (half - 0.14)), 0.14, w.look("paint"))
    w.rod_y((-0.31, high), (-half, half), 0.014, steel)
    w.box((-0.40, -0.34), (-0.42, 0.42), (0.25, 0.30), metal)


def exercise_bike(w: Workbench) -> None:
    """Builds a spinning bike with a flywheel, a saddle, bars and pedals."""
    dark, frame = w.look("dark"), w.look("paint")
    for x in (-0.45, 0.48):
        w.box(around(x, 0.04), (-0.25, 0.25), (0.0, 0.06), dark)
    w.bar((-0.45, 0.0, 0.05), (-0.05, 0.0, 0.40), 0.06, 0.08, frame)
    w.bar((0.48, 0.0, 0.05), (0.40, 0.0, 0.62), 0.06, 0.07, frame)
    w.bar((-0.05, 0.0, 0.36), (0.42, 0.0, 0.58), 0.06, 0.10, frame)
    w.rod_y((0.36, 0.30), (-0.03, 0.03), 0.22, w.look("chrome"))
    w.rod((-0.05, 0.0, 0.38), (-0.20, 0.0, 0.88), 0.026, w.look("chrome"))
    w.mesh(chamfered_box((0.27, 0.17, 0.06), 0.028), (-0.21, 0.0, 0.91), w.look("leather"))
    w.rod((0.40, 0.0, 0.58), (0.34, 0.0, 1.04), 0.026, w.look("chrome"))
    w.rod_y((0.36, 1.06), (-0.22, 0.22), 0.016, dark)
    for side in BOTH_SIDES:
        w.rod((0.36, side * 0.22, 1.06), (0.20, side * 0.22, 1.12), 0.016, dark, round_ends=True)
    w.rod_y((0.02, 0.34), (-0.09, 0.09), 0.10, dark)
    for side in BOTH_SIDES:
        w.bar(
            (0.02, side * 0.085, 0.34),
            (0.02 + side * 0.12, side * 0.085, 0.34 - side * 0.12),
            0.02,
            0.03,
            w.look("chrome"),
            solid=False,
        )
        w.box(
            (0.09 * side, 0.09 * side + 0.12),
            around(side * 0.14, 0.05),
            (0.325 - side * 0.12, 0.345 - side * 0.12),
            dark,
            solid=False,
        )


def dumbbell_rack(w: Workbench) -> None:
    """Builds a sloped rack with two rows of hexagonal dumbbells."""
    half, metal, rubber = 0.5 * w.width(0.95, 1.25), w.look("iron"), w.look("rubber")
    for y in inset((-half, half), 0.03):
        w.box((-0.25, 0.28), around(y, 0.03), (0.0, 0.06), metal)
        w.bar((0.20, y, 0.04), (-0.16, y, 0.82), 0.05, 0.07, metal)
    count = 4
    for x, z in ((0.09, 0.36), (-0.06, 0.70)):
        for dx in (-0.10, 0.10):
            w.bar((x + dx, -half, z - 0.3 * dx), (x + dx, half, z - 0.3 * dx), 0.03, 0.05, metal)
        for i in range(count):
            y = (i + 0.5) * (2 * half - 0.1) / count - half + 0.05
            w.rod((x - 0.14, y, z + 0.10), (x + 0.14, y, z + 0.05), 0.015, w.look("chrome"), solid=False)
            for dx in (-0.10, 0.10):
                w.rod(
                    (x + dx - 0.04, y, z + 0.08 - 0.2 * dx + 0.01),
                    (x + dx + 0.04, y, z + 0.08 - 0.2 * dx - 0.01),
                    0.058,
                    rubber,
                )


def punching_bag(w: Workbench) -> None:
    """Builds a bag that hangs from a standing frame."""
    iron, leather, high = w.look("iron"), w.look("leather"), w.length(1.95, 2.15)
    w.box((-0.55, 0.40), (-0.04, 0.04), (0.0, 0.06), iron)
    w.box((-0.55, -0.47), (-0.45, 0.45), (0.0, 0.06), iron)
    w.box((0.32, 0.40), (-0.30, 0.30), (0.0, 0.06), iron)
    w.box((-0.55, -0.47), (-0.04, 0.04), (0.06, high), iron)
    w.box((-0.55, 0.10), (-0.04, 0.04), (high - 0.07, high), iron)
    w.bar((-0.50, 0.0, high - 0.45), (-0.12, 0.0, high - 0.05), 0.05, 0.05, iron)
    w.cylinder((0.05, 0.0), (high - 0.32, high - 0.06), 0.010, w.look("chrome"))
    w.cylinder((0.05, 0.0), (high - 1.35, high - 0.30), 0.165, leather)
    w.cylinder((0.05, 0.0), (high - 0.75, high - 0.60), 0.168, w.look("paint"), solid=False)


def kettlebells(w: Workbench) -> None:
    """Builds a row of kettlebells on a low rack."""
    count = w.whole(3, 5)
    rubber, iron = w.look("rubber"), w.look("iron")
    half = 0.5 * 0.24 * count + 0.04
    w.box((-0.15, 0.15), (-half, half), (0.14, 0.17), iron)
    for side in BOTH_SIDES:
        w.box((-0.15, 0.15), around(side * (half - 0.03), 0.02), (0.0, 0.14), iron)
    for i in range(count):
        y, r = (i + 0.5) * 0.24 - 0.12 * count, 0.07 + 0.008 * i
        w.ball((0.0, y, 0.17 + 0.95 * r), r, rubber if i % 2 else w.look("paint"))
        for side in BOTH_SIDES:
            w.rod(
                (0.0, y + side * 0.045, 0.17 + 1.7 * r),
                (0.0, y + side * 0.055, 0.17 + 1.85 * r + 0.06),
                0.014,
                rubber,
                solid=False,
            )
        w.rod_y((0.0, 0.235 + 1.85 * r), around(y, 0.055), 0.015, rubber, solid=False, round_ends=True)


def mat_and_ball(w: Workbench) -> None:
    """Builds a yoga mat, a gymnastic ball and two small dumbbells."""
    w.box((-0.92, 0.92), (-0.31, 0.31), (0.0, 0.010), w.look("bright"), solid=False)
    r = w.length(0.27, 0.33)
    w.ball((-0.50, 0.31 + 0.05 + r, r), r, w.new_look("bright"))
    for x in (0.25, 0.45):
        w.rod_y((x, 0.05), (0.44, 0.62), 0.014, w.look("chrome"))
        for y in (0.45, 0.61):
            w.rod_y((x, 0.05), around(y, 0.03), 0.05, w.look("rubber"))


def multi_gym(w: Workbench) -> None:
    """Builds a weight tower with a stack of plates behind a seat, a pull-down bar and a cable column."""
    iron, chrome, leather = w.look("iron"), w.look("chrome"), w.look("leather")
    high = w.length(1.95, 2.10)
    for side in BOTH_SIDES:
        w.box((-0.62, -0.54), around(side * 0.20, 0.03), (0.0, high), iron)
    w.box((-0.62, -0.54), (-0.23, 0.23), (high - 0.07, high), iron)
    w.box((-0.66, 0.55), (-0.04, 0.04), (0.0, 0.06), iron)
    w.box((-0.66, -0.50), (-0.32, 0.32), (0.0, 0.06), iron)
    w.box((0.47, 0.55), (-0.28, 0.28), (0.0, 0.06), iron)
    w.box((-0.68, -0.48), (-0.14, 0.14), (0.10, 0.85), w.look("rubber"))
    w.box((-0.66, -0.50), (-0.10, 0.10), (0.05, 0.12), iron)
    w.box((-0.62, 0.02), (-0.03, 0.03), (high - 0.07, high), iron)
    w.cylinder((-0.02, 0.0), (high - 0.30, high - 0.05), 0.005, w.look("dark"), solid=False)
    w.rod_y((-0.02, high - 0.30), (-0.50, 0.50), 0.015, chrome)
    w.box((0.02, 0.08), (-0.04, 0.04), (0.05, 0.44), iron)
    w.mesh(chamfered_box((0.36, 0.34, 0.08), 0.02), (0.08, 0.0, 0.48), leather)
    w.mesh(chamfered_box((0.08, 0.30, 0.62), 0.02), (-0.22, 0.0, 0.98), leather)
    w.bar((-0.58, 0.0, 0.80), (-0.22, 0.0, 0.80), 0.06, 0.05, iron)
    w.bar((0.04, 0.0, 0.42), (0.04, 0.0, 0.30), 0.06, 0.05, iron)
    w.rod_y((0.38, 0.40), (-0.22, 0.22), 0.05, leather)
    w.bar((0.10, 0.0, 0.42), (0.38, 0.0, 0.40), 0.04, 0.04, iron)


def rower(w: Workbench) -> None:
    """Builds a rowing machine with a long rail, a sliding seat and a fan housing."""
    metal, dark = w.look("metal"), w.look("dark")
    length = w.depth(2.05, 2.30)
    x0, x1 = centred(length)
    w.bar((x0 + 0.30, 0.0, 0.28), (x1 - 0.02, 0.0, 0.36), 0.07, 0.05, metal)
    w.rod_y((x0 + 0.27, 0.34), (-0.06, 0.06), 0.26, dark)
    w.rod_y((x0 + 0.27, 0.34), (-0.065, 0.065), 0.19, w.look("chrome"), solid=False)
    w.box((x0 + 0.14, x0 + 0.22), (-0.24, 0.24), (0.0, 0.06), dark)
    w.box((x1 - 0.09, x1 - 0.02), (-0.20, 0.20), (0.0, 0.05), dark)
    w.bar((x1 - 0.055, 0.0, 0.03), (x1 - 0.055, 0.0, 0.34), 0.05, 0.05, metal)
    w.mesh(chamfered_box((0.24, 0.30, 0.06), 0.025), (0.35, 0.0, 0.38), w.look("leather"))
    for side in BOTH_SIDES:
        w.box((x0 + 0.56, x0 + 0.80), around(side * 0.14, 0.055), (0.30, 0.33), dark, tilt=-0.6)
    w.rod_y((x0 + 0.66, 0.31), (-0.13, 0.13), 0.014, metal)
    w.rod_y((x0 + 0.56, 0.50), (-0.25, 0.25), 0.014, dark, solid=False)
    w.rod((x0 + 0.40, 0.0, 0.48), (x0 + 0.56, 0.0, 0.50), 0.008, dark, solid=False)
    w.bar((x0 + 0.36, 0.0, 0.50), (x0 + 0.46, 0.0, 0.86), 0.04, 0.03, metal)
    w.box((x0 + 0.43, x0 + 0.47), (-0.11, 0.11), (0.80, 0.96), w.look("screen"), tilt=-0.3)


def step_and_roller(w: Workbench) -> None:
    """Builds an aerobic step, a foam roller, a medicine ball and two leaning plates."""
    dark, bright = w.look("rubber"), w.look("bright")
    w.mesh(chamfered_box((0.36, 0.90, 0.08), 0.02), (0.0, 0.0, 0.14), dark)
    for side in BOTH_SIDES:
        w.box((-0.18, 0.18), around(side * 0.34, 0.09), (0.0, 0.11), bright)
    w.rod_y((0.33, 0.075), (-0.40, 0.20), 0.075, w.new_look("bright"))
    w.ball((0.35, 0.40, 0.14), 0.14, w.new_look("paint"))


def pull_up_tower(w: Workbench) -> None:
    """Builds a pull-up and dip station."""
    iron, dark, high = w.look("iron"), w.look("leather"), w.length(2.0, 2.15)
    for side in BOTH_SIDES:
        y = side * 0.40
        w.box((-0.50, 0.45), around(y, 0.03), (0.0, 0.06), iron)
        w.bar((-0.40, y, 0.04), (-0.28, y, high), 0.06, 0.06, iron)
        w.bar((0.30, y, 0.04), (-0.32, y, 1.15), 0.05, 0.05, iron)
        w.rod((-0.33, y, 1.16), (0.22, y, 1.18), 0.022, iron, round_ends=True)
        w.mesh(chamfered_box((0.30, 0.11, 0.05), 0.015), (-0.10, y, 1.22), dark)
        w.rod((-0.28, y, high - 0.02), (-0.10, y * 1.2, high - 0.08), 0.018, iron, round_ends=True)
    w.rod_y((-0.28, high - 0.02), (-0.42, 0.42), 0.020, iron)
    w.box((-0.38, -0.32), (-0.40, 0.40), (0.62, 0.68), iron)
    w.box((-0.46, -0.40), (-0.40, 0.40), (0.01, 0.05), iron)
    w.mesh(chamfered_box((0.07, 0.28, 0.45), 0.02), (-0.31, 0.0, 1.33), dark)
    w.box((-0.37, -0.31), (-0.40, 0.40), (1.28, 1.34), iron)


STYLES = (
    Style("gym_equipment", "treadmill", "train", treadmill, ("machine",)),
    Style("gym_equipment", "bench_barbell", "train", bench_barbell, ("weights",)),
    Style("gym_equipment", "exercise_bike", "heldout", exercise_bike, ("machine",)),
    Style("gym_equipment", "dumbbell_rack", "heldout", dumbbell_rack, ("weights",)),
    Style("gym_equipment", "punching_bag", "train", punching_bag, ("weights",)),
    Style("gym_equipment", "kettlebells", "train", kettlebells, ("small",)),
    Style("gym_equipment", "mat_and_ball", "train", mat_and_ball, ("small",)),
    Style("gym_equipment", "multi_gym", "train", multi_gym, ("machine",)),
    Style("gym_equipment", "rower", "heldout", rower, ("machine",)),
    Style("gym_equipment", "step_and_roller", "heldout", step_and_roller, ("small",)),
    Style("gym_equipment", "pull_up_tower", "heldout", pull_up_tower, ("weights",)),
)
