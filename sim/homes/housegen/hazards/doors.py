"""Door leaves that jam: they stand half open as others do, but do not give when the robot pushes them."""

from __future__ import annotations

import math

from sim.homes.housegen.hazards.hazard import Sketch, box

GAP_M = (0.50, 0.62)
"""Room beside a leaf that jams; the robot is 0.36 m wide."""
HALF_M, FLOOR_GAP_M, HIGH_M = 0.02, 0.008, 2.06
"""Half the thickness of a leaf, its lower and its upper edge."""


def jammed_leaf(s: Sketch) -> bool:
    """Hangs a leaf that is swollen or blocked into a doorway that has none."""
    opening = s.draw_opening("door", bare=True)
    if opening is None:
        return False
    width = s.move_into(opening) - 0.02
    at, yaw_rad = s.draw_hinge(width, 2.0 * math.asin(s.uniform(*GAP_M) / (2.0 * width)))
    wood, metal = s.look("wood"), s.looks["frame"]
    leaf = [box((0.0, width), (-HALF_M, HALF_M), (FLOOR_GAP_M, HIGH_M), wood)]
    for side in (-1, 1):
        y = sorted((side * HALF_M, side * (HALF_M + 0.04)))
        leaf.append(box((width - 0.16, width - 0.05), (y[0], y[1]), (1.01, 1.03), metal, solid=False))
    s.add("door", leaf, at=at, yaw_rad=yaw_rad)
    return True


DESIGNS = (jammed_leaf,)
