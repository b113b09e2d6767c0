"""Maps of the agent drawn with letters. The top line has the largest y; x grows to the right."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from stubborn.mapping.navmap import NavMap

LAYER_OF = {
    "#": ("seen_obstacle", "seen_at_eye_level"),
    "o": ("seen_obstacle",),
    "w": ("pessimistic_marks",),
    "n": ("optimistic_marks", "pessimistic_marks"),
    "v": ("visited", "trail"),
    "T": ("score_max",),
}
"""# wall, o low obstacle, w pessimistic mark only, n both marks, v visited, T target; R: the robot, .: free."""


def grid_of(text: str) -> NDArray[np.str_]:
    """Returns the letters as (rows, cols), row 0 the bottom line."""
    return np.array([list(line) for line in text.strip("\n").split("\n")][::-1])


def map_of(text: str, *, cell_m: float = 0.05) -> tuple[NavMap, Pose]:
    """Returns the map, and the pose in the middle of the cell marked R, with the heading along +x."""
    letters = grid_of(text)
    navmap = NavMap.empty(GridFrame(origin_xy_m=(0.0, 0.0), shape=letters.shape, cell_m=cell_m))
    for letter, layers in LAYER_OF.items():
        for layer in layers:
            getattr(navmap, layer)[letters == letter] = True
    rows, cols = np.nonzero(letters == "R")
    x_m, y_m = navmap.frame.centres(rows[0], cols[0]) if rows.size else (0.0, 0.0)
    return navmap, Pose(float(x_m), float(y_m), 0.0)


def mask_of(text: str, letter: str) -> NDArray[np.bool_]:
    """Returns the mask of the cells with the letter."""
    return grid_of(text) == letter


def enlarged(text: str, factor: int) -> str:
    """Returns the text with each letter enlarged to a block of letters."""
    lines = text.strip("\n").split("\n")
    return "\n".join("".join(c * factor for c in line) for line in lines for _ in range(factor))
