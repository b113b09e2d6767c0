"""Potted plants.

Usual retail dimensions: floor plants 0.60-1.80 m high in pots 0.25-0.40 m across, table plants 0.15-0.40 m high.
"""

from __future__ import annotations

import math

from sim.housegen.furniture.catalogue import Style
from sim.housegen.furniture.shapes import Leaf, Ring, foliage, loft
from sim.housegen.furniture.workbench import Workbench


def _pot(w: Workbench, r: float, high: float) -> None:
    look = w.look("pot")
    w.mesh(
        loft(
            [
                Ring(0.0, 0.72 * r, 0.72 * r),
                Ring(0.85 * high, 0.95 * r, 0.95 * r),
                Ring(0.86 * high, r, r),
                Ring(high, r, r),
            ],
            14,
            hull=True,
        ),
        (0.0, 0.0, 0.0),
        look,
    )
    w.cylinder((0.0, 0.0), (high - 0.004, high + 0.004), 0.9 * r, w.look("soil"), solid=False)


def broadleaf(w: Workbench) -> None:
    """Builds a plant with big arching leaves in a pot."""
    r, high, tall = w.length(0.14, 0.20), w.length(0.22, 0.32), w.length(0.45, 0.90)
    _pot(w, r, high)
    leaves = []
    for i in range(14):
        a = 2.4 * i
        reach, rise = (0.30 + 0.02 * (i % 4)) * tall / 0.7 * (0.4 + 0.04 * i), tall * (1.05 - 0.045 * i)
        leaves.append(
            Leaf(
                (0.02 * math.cos(a), 0.02 * math.sin(a), high),
                (reach * math.cos(a), reach * math.sin(a), high + rise),
                0.13 + 0.05 * tall,
                0.10 * tall,
            )
        )
    w.mesh(foliage(leaves), (0.0, 0.0, 0.0), w.look("foliage"), solid=False)
    w.cylinder((0.0, 0.0), (high, high + 0.5 * tall), 0.02, w.look("foliage"))


def tree(w: Workbench) -> None:
    """Builds a small tree with a bare stem and a round crown."""
    r, high, tall = w.length(0.15, 0.20), w.length(0.26, 0.34), w.length(1.20, 1.65)
    _pot(w, r, high)
    crown = w.length(0.24, 0.32)
    w.rod((0.0, 0.0, high - 0.01), (0.02, 0.0, tall - crown), 0.018, w.look("wood"))
    for dx, dy, dz, s in (
        (0.0, 0.0, 0.0, 1.0),
        (0.12, 0.10, -0.12, 0.7),
        (-0.10, 0.12, -0.05, 0.7),
        (0.02, -0.15, -0.10, 0.75),
        (0.0, 0.02, 0.16, 0.6),
    ):
        w.ellipsoid(
            (dx, dy, tall - 0.8 * crown + dz), (s * crown, s * crown, 0.8 * s * crown), w.look("hedge"), solid=dz == 0.0
        )


def snake_plant(w: Workbench) -> None:
    """Builds a plant with upright sword leaves in a cube pot."""
    half, high, tall = 0.5 * w.length(0.24, 0.34), w.length(0.22, 0.30), w.length(0.45, 0.80)
    w.box((-half, half), (-half, half), (0.0, high), w.look("pot"))
    w.box(
        (-half + 0.015, half - 0.015), (-half + 0.015, half - 0.015), (high, high + 0.004), w.look("soil"), solid=False
    )
    leaves = []
    for i in range(12):
        a, reach = 2.4 * i, 0.55 * half * (0.3 + 0.06 * i)
        c, s = math.cos(a), math.sin(a)
        leaves.append(
            Leaf(
                (reach * c, reach * s, high - 0.01),
                (1.7 * reach * c, 1.7 * reach * s, high + tall * (1.0 - 0.05 * i)),
                0.075,
            )
        )
    w.mesh(foliage(leaves), (0.0, 0.0, 0.0), w.look("foliage"), solid=False)
    w.cylinder((0.0, 0.0), (high, high + 0.5 * tall), 0.03, w.look("foliage"))


def palm(w: Workbench) -> None:
    """Builds a palm with several thin stems, each with a fan of narrow drooping leaves."""
    r, high, tall = w.length(0.14, 0.18), w.length(0.26, 0.34), w.length(1.10, 1.60)
    _pot(w, r, high)
    green, bark = w.look("foliage"), w.look("wood")
    for k in range(3):
        a = math.tau * k / 3 + 0.3
        top = (0.12 * math.cos(a), 0.12 * math.sin(a), tall * (0.72 - 0.12 * k))
        w.rod((0.04 * math.cos(a), 0.04 * math.sin(a), high - 0.01), top, 0.016, bark)
        leaves = []
        for i in range(9):
            b = math.tau * i / 9 + a
            reach, rise = 0.30 + 0.05 * (i % 3), 0.30 - 0.16 * (i % 3)
            leaves.append(Leaf((0.0, 0.0, 0.0), (reach * math.cos(b), reach * math.sin(b), rise), 0.085, 0.10))
        w.mesh(foliage(leaves), top, green, solid=False)


def rubber_tree(w: Workbench) -> None:
    """Builds a plant with one stem and big oval leaves at all heights."""
    r, high, tall = w.length(0.14, 0.18), w.length(0.24, 0.32), w.length(0.90, 1.40)
    _pot(w, r, high)
    w.rod((0.0, 0.0, high - 0.01), (0.0, 0.0, tall - 0.10), 0.014, w.look("wood"))
    leaves = []
    for i in range(16):
        t = i / 15
        a, z = 2.4 * i, high + 0.15 + (tall - high - 0.20) * t
        reach = 0.30 - 0.14 * t
        leaves.append(Leaf((0.0, 0.0, z), (reach * math.cos(a), reach * math.sin(a), z + 0.02 + 0.16 * t), 0.13, 0.05))
    w.mesh(foliage(leaves), (0.0, 0.0, 0.0), w.look("foliage"), solid=False)


def topiary(w: Workbench) -> None:
    """Builds a clipped shrub of two balls in a footed urn."""
    r, ball = w.length(0.15, 0.19), w.length(0.18, 0.24)
    look = w.look("pot")
    w.mesh(
        loft(
            [
                Ring(0.0, 0.8 * r, 0.8 * r),
                Ring(0.04, 0.8 * r, 0.8 * r),
                Ring(0.09, 0.35 * r, 0.35 * r),
                Ring(0.16, 0.8 * r, 0.8 * r),
                Ring(0.30, r, r),
                Ring(0.32, 1.1 * r, 1.1 * r),
            ],
            14,
        ),
        (0.0, 0.0, 0.0),
        look,
    )
    green = w.look("hedge")
    w.cylinder((0.0, 0.0), (0.31, 0.34 + 2.6 * ball), 0.018, w.look("wood"))
    w.ball((0.0, 0.0, 0.31 + ball), ball, green)
    w.ball((0.0, 0.0, 0.31 + 2.55 * ball), 0.72 * ball, green)


def table_fern(w: Workbench) -> None:
    """Builds a small pot full of arching leaves."""
    r, high = w.length(0.06, 0.09), w.length(0.08, 0.12)
    _pot(w, r, high)
    leaves = []
    for i in range(15):
        a, reach = 2.4 * i, 0.10 + 0.05 * (i % 3)
        leaves.append(
            Leaf(
                (0.0, 0.0, high - 0.01),
                (reach * math.cos(a), reach * math.sin(a), high + 0.12 - 0.05 * (i % 3)),
                0.05,
                0.05,
            )
        )
    w.mesh(foliage(leaves), (0.0, 0.0, 0.0), w.look("foliage"), solid=False)


def flower_pot(w: Workbench) -> None:
    """Builds a small flowering plant."""
    r, high = w.length(0.06, 0.08), w.length(0.09, 0.12)
    _pot(w, r, high)
    leaves = [
        Leaf((0.0, 0.0, high - 0.01), (0.10 * math.cos(2.4 * i), 0.10 * math.sin(2.4 * i), high + 0.05), 0.06, 0.02)
        for i in range(8)
    ]
    w.mesh(foliage(leaves), (0.0, 0.0, 0.0), w.look("foliage"), solid=False)
    bloom = w.look("flower")
    for i in range(4):
        a = math.tau * i / 4
        tip = (0.05 * math.cos(a), 0.05 * math.sin(a), high + 0.12 + 0.03 * (i % 2))
        w.rod((0.0, 0.0, high), tip, 0.003, w.look("foliage"), solid=False)
        w.ball(tip, 0.026, bloom, solid=False)


def cactus(w: Workbench) -> None:
    """Builds a column cactus with arms."""
    r, high, tall = w.length(0.13, 0.17), w.length(0.20, 0.28), w.length(0.60, 1.10)
    w.cylinder((0.0, 0.0), (0.0, high), r, w.look("pot"))
    w.cylinder((0.0, 0.0), (high, high + 0.004), 0.9 * r, w.look("soil"), solid=False)
    green = w.look("foliage")
    w.rod((0.0, 0.0, high), (0.0, 0.0, high + tall), 0.07, green, round_ends=True)
    for side, z in ((1, 0.45), (-1, 0.6)):
        y = side * 0.17
        w.rod((0.0, 0.0, high + (z - 0.12) * tall), (0.0, y, high + (z - 0.12) * tall), 0.045, green, round_ends=True)
        w.rod((0.0, y, high + (z - 0.12) * tall), (0.0, y, high + (z + 0.18) * tall), 0.045, green, round_ends=True)
    w.ellipsoid((0.0, 0.0, high + tall + 0.065), (0.03, 0.03, 0.02), w.look("flower"), solid=False)


def monstera(w: Workbench) -> None:
    """Builds a plant with round broad leaves on long stalks that spread from the pot."""
    r, high, tall = w.length(0.15, 0.20), w.length(0.22, 0.30), w.length(0.60, 0.95)
    _pot(w, r, high)
    green = w.look("foliage")
    for i in range(6):
        a, t = 2.4 * i, i / 5
        reach = 0.16 + 0.20 * t
        tip = (reach * math.cos(a), reach * math.sin(a), high + tall * (1.0 - 0.65 * t))
        w.rod((0.0, 0.0, high - 0.01), tip, 0.007, green, solid=i < 3)
        leaf = (tip[0] + 0.08 * math.cos(a), tip[1] + 0.08 * math.sin(a), tip[2] - 0.045)
        w.ellipsoid(leaf, (0.13, 0.11, 0.008), green, solid=False, tilt=0.5, turn=a)


def bonsai(w: Workbench) -> None:
    """Builds a small crooked tree in a flat tray."""
    w.box((-0.07, 0.07), (-0.11, 0.11), (0.0, 0.045), w.look("pot"))
    w.box((-0.06, 0.06), (-0.10, 0.10), (0.045, 0.049), w.look("soil"), solid=False)
    bark, green = w.look("wood"), w.look("hedge")
    w.rod((0.0, 0.02, 0.045), (0.0, -0.04, 0.13), 0.013, bark, round_ends=True)
    w.rod((0.0, -0.04, 0.13), (0.0, 0.03, 0.20), 0.010, bark, round_ends=True)
    for at, s in (((0.0, 0.04, 0.215), 1.0), ((0.01, -0.07, 0.155), 0.8), ((-0.02, 0.08, 0.165), 0.65)):
        w.ellipsoid(at, (0.06 * s, 0.075 * s, 0.032 * s), green)


STYLES = (
    Style("plant", "broadleaf", "train", broadleaf, ("floor",)),
    Style("plant", "tree", "heldout", tree, ("floor",)),
    Style("plant", "snake_plant", "train", snake_plant, ("floor",)),
    Style("plant", "palm", "train", palm, ("floor",)),
    Style("plant", "rubber_tree", "train", rubber_tree, ("floor",)),
    Style("plant", "topiary", "train", topiary, ("floor",)),
    Style("plant", "table_fern", "train", table_fern, ("top",), "top"),
    Style("plant", "flower_pot", "train", flower_pot, ("top",), "top"),
    Style("plant", "cactus", "heldout", cactus, ("floor",)),
    Style("plant", "monstera", "heldout", monstera, ("floor",)),
    Style("plant", "bonsai", "heldout", bonsai, ("top",), "top"),
)
