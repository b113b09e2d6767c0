"""Gym equipment.

Usual retail dimensions: treadmills 1.70-2.10 m long, 0.75-0.90 m wide, 1.30-1.50 m high; benches 1.10-1.30 m long,
0.42-0.48 m high; barbells 1.50-2.20 m; exercise bikes 1.00-1.25 m long; rowers 2.10-2.45 m; yoga mats 1.83 x 0.61 m.
"""

from __future__ import annotations

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.shapes import chamfered_box
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


def treadmill(w: Workbench) -> None:
    """Running deck with motor hood, uprights and a console; one steps on from the front (+x)."""
    length, half, dark, metal = w.depth(1.60, 1.85), 0.5 * w.length(0.74, 0.84), w.look("dark"), w.look("metal")
    x0, x1 = -0.5 * length, 0.5 * length
    w.box((x0 + 0.1, x1), (-half + 0.10, half - 0.10), (0.05, 0.14), w.look("rubber"))
    for side in _BOTH:
        y = side * (half - 0.06)
        w.box((x0 + 0.1, x1), (y - 0.045, y + 0.045), (0.03, 0.17), metal)
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
    w.box((x0 + 0.10, x0 + 0.11), (-0.18, 0.18), (1.16, 1.34), w.look("screen"), tilt=-0.4, solid=False)
    w.box((x1 - 0.1, x1 - 0.02), (-half + 0.02, half - 0.02), (0.0, 0.06), dark)


def bench_barbell(w: Workbench) -> None:
    """Flat bench under a barbell on two stands."""
    leather, metal, steel = w.look("leather"), w.look("iron"), w.look("chrome")
    w.mesh(chamfered_box((1.15, 0.28, 0.08), 0.02), (0.1, 0.0, 0.44), leather)
    w.box((-0.35, 0.60), (-0.03, 0.03), (0.35, 0.41), metal)
    for x in (-0.30, 0.55):
        w.box((x - 0.03, x + 0.03), (-0.03, 0.03), (0.04, 0.36), metal)
        w.box((x - 0.03, x + 0.03), (-0.25, 0.25), (0.0, 0.05), metal)
    half, high = 0.5 * w.width(1.60, 1.90), w.length(0.95, 1.05)
    for side in _BOTH:
        w.box((-0.40, -0.34), (side * 0.42 - 0.03, side * 0.42 + 0.03), (0.0, high + 0.04), metal)
        w.box((-0.62, -0.12), (side * 0.42 - 0.03, side * 0.42 + 0.03), (0.0, 0.05), metal)
        w.box((-0.35, -0.28), (side * 0.42 - 0.02, side * 0.42 + 0.02), (high - 0.04, high - 0.012), metal)
        w.rod((-0.31, side * (half - 0.24), high), (-0.31, side * (half - 0.19), high), 0.20, w.look("rubber"))
        w.rod((-0.31, side * (half - 0.18), high), (-0.31, side * (half - 0.14), high), 0.14, w.look("paint"))
    w.rod((-0.31, -half, high), (-0.31, half, high), 0.014, steel)
    w.box((-0.40, -0.34), (-0.42, 0.42), (0.25, 0.30), metal)


def exercise_bike(w: Workbench) -> None:
    """Spinning bike: flywheel, saddle, bars, pedals."""
    dark, frame = w.look("dark"), w.look("paint")
    for x in (-0.45, 0.48):
        w.box((x - 0.04, x + 0.04), (-0.25, 0.25), (0.0, 0.06), dark)
    w.bar((-0.45, 0.0, 0.05), (-0.05, 0.0, 0.40), 0.06, 0.08, frame)
    w.bar((0.48, 0.0, 0.05), (0.40, 0.0, 0.62), 0.06, 0.07, frame)
    w.bar((-0.05, 0.0, 0.36), (0.42, 0.0, 0.58), 0.06, 0.10, frame)
    w.rod((0.36, -0.03, 0.30), (0.36, 0.03, 0.30), 0.22, w.look("chrome"))
    w.rod((-0.05, 0.0, 0.38), (-0.20, 0.0, 0.88), 0.026, w.look("chrome"))
    w.mesh(chamfered_box((0.27, 0.17, 0.06), 0.028), (-0.21, 0.0, 0.91), w.look("leather"))
    w.rod((0.40, 0.0, 0.58), (0.34, 0.0, 1.04), 0.026, w.look("chrome"))
    w.rod((0.36, -0.22, 1.06), (0.36, 0.22, 1.06), 0.016, dark)
    for side in _BOTH:
        w.rod((0.36, side * 0.22, 1.06), (0.20, side * 0.22, 1.12), 0.016, dark, round_ends=True)
    w.rod((0.02, -0.09, 0.34), (0.02, 0.09, 0.34), 0.10, dark)
    for side in _BOTH:
        w.bar(
            (0.02, side * 0.085, 0.34),
            (0.02 + side * 0.12, side * 0.085, 0.34 - side * 0.12),
            0.02,
            0.03,
            w.look("chrome"),
            solid=False,
        )
        w.box(
            (0.09 * side + 0.0, 0.09 * side + 0.12),
            (side * 0.14 - 0.05, side * 0.14 + 0.05),
            (0.325 - side * 0.12, 0.345 - side * 0.12),
            dark,
            solid=False,
        )


def dumbbell_rack(w: Workbench) -> None:
    """Sloped rack with two rows of hexagonal dumbbells."""
    half, metal, rubber = 0.5 * w.width(0.95, 1.25), w.look("iron"), w.look("rubber")
    for side in _BOTH:
        y = side * (half - 0.03)
        w.box((-0.25, 0.28), (y - 0.03, y + 0.03), (0.0, 0.06), metal)
        w.bar((0.20, y, 0.04), (-0.16, y, 0.82), 0.05, 0.07, metal)
    count = 4
    for x, z in ((0.09, 0.36), (-0.06, 0.70)):
        for dx in (-0.10, 0.10):
            w.bar(
                (x + dx, -half, z - 0.10 * dx / 0.1 * 0.3), (x + dx, half, z - 0.10 * dx / 0.1 * 0.3), 0.03, 0.05, metal
            )
        for i in range(count):
            y = (i + 0.5) * (2 * half - 0.1) / count - half + 0.05
            w.rod((x - 0.14, y, z + 0.10), (x + 0.14, y, z + 0.10 - 0.05), 0.015, w.look("chrome"), solid=False)
            for dx in (-0.10, 0.10):
                w.rod(
                    (x + dx - 0.04, y, z + 0.08 - 0.2 * dx + 0.01),
                    (x + dx + 0.04, y, z + 0.08 - 0.2 * dx - 0.01),
                    0.058,
                    rubber,
                )


STYLES = (
    Style("gym_equipment", "treadmill", "train", treadmill, ("machine",)),
    Style("gym_equipment", "bench_barbell", "train", bench_barbell, ("weights",)),
    Style("gym_equipment", "exercise_bike", "heldout", exercise_bike, ("machine",)),
    Style("gym_equipment", "dumbbell_rack", "heldout", dumbbell_rack, ("weights",)),
)
