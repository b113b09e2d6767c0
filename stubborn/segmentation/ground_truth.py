"""Ground-truth segmentation: the scores of an ideal network, from the `semantic` image of the observation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40, Observation, Scores, SegmenterSpec, category_id

STRIDE_PX = 4
"""Edge of the image block of one posterior."""


class GroundTruthSegmenter:
    """A segmenter that scores 1 where a pixel's category is the goal, else 0."""

    spec = SegmenterSpec(sensors=("semantic",), exact_outlines=True, needs_verification=False)

    def __init__(self) -> None:
        self._last: tuple[NDArray[np.uint8], NDArray[np.float32]] | None = None
        """The last image and its posteriors: an agent may ask for them more than once."""

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns scores at the resolution of the image; void pixels score 0 for every category.

        Raises:
            ConfigError: the goal is not a category of mpcat40, or is void.
        """
        semantic = observation["semantic"]
        target = semantic == category_id(goal)
        return Scores(target.astype(np.float32), ((semantic != 0) & ~target).astype(np.float32))

    def categories(self, observation: Observation) -> NDArray[np.uint8]:
        """Returns the category of each pixel, mpcat40 ids (h, w)."""
        return observation["semantic"]

    def posteriors(self, observation: Observation) -> NDArray[np.float32]:
        """Returns 1 for the category in the middle of each 4 x 4 block, else (and for void) 0, (40, h / 4, w / 4).

        The array must not be changed: the next call for the same frame returns it again.
        """
        image = observation["semantic"]
        if self._last is None or self._last[0] is not image:
            semantic = image[STRIDE_PX // 2 :: STRIDE_PX, STRIDE_PX // 2 :: STRIDE_PX]
            by_id = np.zeros((len(MPCAT40), semantic.size), np.float32)
            by_id[semantic.reshape(-1), np.arange(semantic.size)] = 1.0
            self._last = image, by_id[1:].reshape(-1, *semantic.shape)
        return self._last[1]
