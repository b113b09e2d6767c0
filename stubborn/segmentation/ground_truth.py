"""Ground-truth segmentation: the scores of an ideal network, from the `semantic` image of the observation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.interface import MPCAT40_ID, ConfigError, Observation, Scores, SegmenterSpec


class GroundTruthSegmenter:
    """A segmenter that scores 1 where a pixel's category is the goal, else 0."""

    spec = SegmenterSpec(sensors=("semantic",), exact_outlines=True, needs_verification=False)

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns scores at the resolution of the image; void pixels score 0 for every category.

        Raises:
            ConfigError: there is no such category.
        """
        if goal not in MPCAT40_ID:
            raise ConfigError(f"No category {goal!r} in mpcat40. There is: {', '.join(MPCAT40_ID)}.")
        semantic = observation["semantic"]
        target = semantic == MPCAT40_ID[goal]
        other = (semantic != 0) & ~target
        return Scores(target.astype(np.float32), other.astype(np.float32))

    def categories(self, observation: Observation) -> NDArray[np.uint8]:
        """Returns the category of each pixel, mpcat40 ids (h, w)."""
        return observation["semantic"]
