"""What the agent believes: named layers over the ground, on one grid."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from stubborn.grid import GridFrame, Window


@dataclass
class NavMap:
    """What the agent believes so far; every layer is (rows, cols) on `frame`. Paper channel in brackets.

    Unknown ground is free ground; what was ever in view is where `frames_in_view` is not 0.
    """

    frame: GridFrame
    seen_obstacle: NDArray[np.bool_]
    """True: depth saw a surface between step height and robot height [1]."""
    seen_at_eye_level: NDArray[np.bool_]
    """True: depth saw a surface at the camera's height, so a wall or something as tall."""
    bumped_wide: NDArray[np.bool_]
    """True: inside a 25 x 25 cm mark in front of a failed move; the pessimistic map [2]."""
    bumped_narrow: NDArray[np.bool_]
    """True: inside a 15 x 15 cm mark in front of a failed move; the optimistic map [3]."""
    visited: NDArray[np.bool_]
    """True: the robot's disc swept over this cell."""
    trail: NDArray[np.bool_]
    """True: the robot's centre passed here, to a cell."""
    frames_in_view: NDArray[np.uint16]
    """How many frames saw something in this cell, floor included [4]."""
    score_sum: NDArray[np.float32]
    """Sum over frames of the target's score, each frame giving its highest in the cell [5]."""
    score_max: NDArray[np.float32]
    """Highest score of the target in any frame [6]."""
    other_max: NDArray[np.float32]
    """Highest score of any other category in any frame [7]."""
    found_step: NDArray[np.int16]
    """Step at which `score_max` first made this cell a candidate; meaningful only where it did."""
    rejected: NDArray[np.bool_]
    """True: verification refused a candidate here; it never counts again in this episode."""
    set_aside: NDArray[np.bool_]
    """True: a candidate here could not be reached; it waits until the map has grown."""

    @classmethod
    def empty(cls, frame: GridFrame) -> NavMap:
        """A map on which nothing is known yet."""

        def layer(dtype: type) -> NDArray:
            return np.zeros(frame.shape, dtype)

        return cls(
            frame=frame,
            seen_obstacle=layer(np.bool_),
            seen_at_eye_level=layer(np.bool_),
            bumped_wide=layer(np.bool_),
            bumped_narrow=layer(np.bool_),
            visited=layer(np.bool_),
            trail=layer(np.bool_),
            frames_in_view=layer(np.uint16),
            score_sum=layer(np.float32),
            score_max=layer(np.float32),
            other_max=layer(np.float32),
            found_step=layer(np.int16),
            rejected=layer(np.bool_),
            set_aside=layer(np.bool_),
        )

    def view(self, window: Window) -> NavMap:
        """The part of the map in a window; its layers share memory with this map's."""
        layers = {f.name: getattr(self, f.name)[window.index] for f in fields(self) if f.name != "frame"}
        return NavMap(frame=window.frame, **layers)

    def known_window(self, margin_cells: int) -> Window:
        """The smallest rectangle that holds all that was ever in view or walked on, with a margin."""
        known = (self.frames_in_view > 0) | self.trail
        rows, cols = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
        if rows.size == 0:
            middle = self.frame.centres(self.frame.shape[0] // 2, self.frame.shape[1] // 2)
            return self.frame.window_at(float(middle[0]), float(middle[1]), 2 * margin_cells + 1)
        return self.frame.part(
            slice(max(int(rows[0]) - margin_cells, 0), int(rows[-1]) + margin_cells + 1),
            slice(max(int(cols[0]) - margin_cells, 0), int(cols[-1]) + margin_cells + 1),
        )
