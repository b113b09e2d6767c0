"""Candidates as objects: connected cells that score as the target, without those of rejected objects.

A rejected object keeps its cells for the rest of the episode. Its outline changes with every frame, so cells that join
it later belong to it too, as long as there are at most as many as it had when it was rejected. A larger part cannot
belong to it: it is another object that touches it, such as a table next to a rejected chair.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Int

from stubborn.mapping.masks import numbered_parts
from stubborn.mapping.navmap import NavMap


@dataclass(frozen=True)
class CandidateParts:
    """The candidates on a view of the map; each has a number."""

    labels: Int[np.ndarray, "rows cols"]
    """Number of the candidate that a cell belongs to; 0: no candidate."""
    count: int
    """Candidates have the numbers 1 to `count`."""

    @classmethod
    def of(cls, view: NavMap, candidate_score: float, least_cells: int) -> CandidateParts:
        """Returns the candidates on a view; parts with fewer than `least_cells` cells do not count."""
        shown = view.score_max > candidate_score
        unrejected = shown & ~view.rejected
        if not unrejected.any():
            return cls(np.zeros(shown.shape, np.intp), 0)
        objects, _ = numbered_parts(_grown(shown))  # pieces of one outline, with gaps between them
        parts, areas = numbered_parts(unrejected)
        rejected_cells = np.bincount(objects[shown & view.rejected], minlength=int(objects.max()) + 1)
        object_of = np.zeros(len(areas), np.intp)
        object_of[parts[unrejected]] = objects[unrejected]
        counts = (areas >= least_cells) & (areas > rejected_cells[object_of])
        counts[0] = False  # the background
        number = np.where(counts, np.cumsum(counts), 0)
        return cls(number[parts], int(counts.sum()))

    @property
    def mask(self) -> Bool[np.ndarray, "rows cols"]:
        """Returns the cells of all candidates."""
        return self.labels > 0


def _grown(mask: Bool[np.ndarray, "rows cols"]) -> Bool[np.ndarray, "rows cols"]:
    """Returns the mask with the 8 neighbours of its cells."""
    kernel = np.ones((3, 3), np.uint8)
    return np.asarray(cv2.dilate(np.ascontiguousarray(mask).view(np.uint8), kernel), np.uint8).view(np.bool_)
