"""Potted plants.

Usual retail dimensions: floor plants 0.60-1.80 m high in pots 0.25-0.40 m across, table plants 0.15-0.40 m high.
"""

from __future__ import annotations

import math

from sim.houses.furniture.catalogue import Style
from sim.houses.furniture.shapes import (
    Leaf,
    Ring,
    foliage,
    loft,
)
from sim.houses.furniture.workbench import Workbench

_BOTH = (-1, 1)


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
    """Big arching leaves out of a pot."""
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
    """Small tree: bare stem, round crown."""
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
            (dx, dy, tall - 0.8 * crown + dz),
            (s * crown, s * crown, 0.8 * s * crown),
            w.look("foliage"),
            solid=dz == 0.0,
        )


STYLES = (
    Style("plant", "broadleaf", "train", broadleaf, ("floor",)),
    Style("plant", "tree", "heldout", tree, ("floor",)),
)
