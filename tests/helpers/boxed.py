"""Maps of a square arena around the start, for tests of explorers."""

from __future__ import annotations

import numpy as np

from sim.core.geometry.grid import GridFrame
from stubborn.mapping.collision_marks import CollisionConfig, mark_visited
from stubborn.mapping.navmap import NavMap
from tests.helpers.ground import START

FRAME = GridFrame.around_start(240, 0.05)


def empty() -> NavMap:
    """Returns a map on which nothing is known but the ground under the robot."""
    navmap = NavMap.empty(FRAME)
    mark_visited(navmap, START, START, 0.18, CollisionConfig())
    return navmap


def all_seen(navmap: NavMap) -> None:
    """Marks all ground as seen."""
    navmap.frames_in_view[:] = 1
    navmap.grow_known(*(slice(0, n) for n in FRAME.shape))


def box_in(layer: np.ndarray, half_m: float) -> None:
    """Enters a closed square of obstacle cells around the start."""
    low, _ = FRAME.cell(-half_m, -half_m)
    high, _ = FRAME.cell(half_m, half_m)
    layer[low : high + 1, [low, high]] = True
    layer[[low, high], low : high + 1] = True


def close_quarter(layer: np.ndarray, corner: int) -> None:
    """Enters a wall that separates a corner of the window from the rest."""
    middle = FRAME.shape[0] // 2
    rows = slice(middle + 20, None) if corner in (0, 3) else slice(None, middle - 20)
    cols = slice(middle + 20, None) if corner in (0, 1) else slice(None, middle - 20)
    layer[rows, middle + 20 if corner in (0, 1) else middle - 20] = True
    layer[middle + 20 if corner in (0, 3) else middle - 20, cols] = True
