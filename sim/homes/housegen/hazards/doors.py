"""Door leaves that jam: they stand half open as others do, but do not give when the robot pushes them."""

from __future__ import annotations

import math

from sim.homes.housegen.hazards.floor_map import FloorMap
from sim.homes.housegen.hazards.hazard import Sketch, box
from sim.homes.housegen.structure.openings import HALF_WALL_M

GAP_M = (0.50, 0.62)
"""Room beside a leaf that jams; the robot is 0.36 m wide."""
HALF_M, FLOOR_GAP_M, HIGH_M = 0.02, 0.008, 2.06
"""Half the thickness of a leaf, its lower and its upper edge."""


def jammed_leaf(s: Sketch, floor: FloorMap) -> bool:
    """Hangs a leaf that is swollen or blocked into a doorway that has none."""
    doors = [opening for opening in floor.openings if opening.kind == "door" and opening.leaf is None]
    if not doors:
        return False
    opening = doors[int(s.rng.integers(len(doors)))]
    low, high = opening.clear_span()
    s.move_into(opening, 0.5 * (low + high))
    width = high - low - 0.02
    hinge, into = (1 if s.rng.random() < 0.5 else -1), (1 if s.rng.random() < 0.5 else -1)
    angle = 2.0 * math.asin(float(s.rng.uniform(*GAP_M)) / (2.0 * width))
    wood, metal = s.look("wood"), s.looks["frame"]
    leaf = [box((0.0, width), (-HALF_M, HALF_M), (FLOOR_GAP_M, HIGH_M), wood)]
    for side in (-1, 1):
        y = sorted((side * HALF_M, side * (HALF_M + 0.04)))
        leaf.append(box((width - 0.16, width - 0.05), (y[0], y[1]), (1.01, 1.03), metal, solid=False))
    # The closed leaf points along -hinge * y from its hinge; it opens towards into * x.
    at, closed = (into * (HALF_WALL_M + 0.05), hinge * 0.5 * width), -hinge * math.pi / 2
    s.add("door", leaf, at=at, yaw_rad=closed + hinge * into * angle)
    return True


DESIGNS = (jammed_leaf,)
