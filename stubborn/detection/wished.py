"""Scores of goals in words: the categories that the words mean, and the objects of them with the right name.

A segmentation knows the 40 categories. A goal in words may mean several of them ("something to sit on"), or only some
objects of one ("fridge" among the appliances). The posteriors are therefore rearranged: one category stands for the
goal, and everything behind the segmentation works as with a goal category.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from jaxtyping import Float32, Int32

from sim.core.interface import (
    GOAL_CATEGORIES,
    MPCAT40_ID,
    Observation,
    Scores,
    SeesObjects,
    Segmenter,
    SegmenterSpec,
    TakesWords,
    scores_of,
)
from sim.core.wishes import Wish, parse_wish

STANDS_FOR: Mapping[str, str] = MappingProxyType(
    {
        "appliances": "counter", "mirror": "sink", "shelving": "cabinet", "lighting": "table", "curtain": "bed",
        "blinds": "bed", "board_panel": "table", "furniture": "sofa", "objects": "table",
    }
)  # fmt: skip
"""The goal category in place of another one for explorers that know only those: one that is found in the same rooms."""
_OTHER = MPCAT40_ID["misc"] - 1
"""Channel of the posteriors that gets what is not the goal although it is of the goal's category."""


class WishedSegmenter:
    """A segmenter for goals in words; for a category it returns what the other one does."""

    def __init__(self, segmenter: Segmenter) -> None:
        self._segmenter = segmenter
        self.ask("chair")

    def ask(self, goal: str) -> None:
        """Sets the goal: a category, or words.

        Raises:
            WishError: a word is not known.
        """
        self.wish: Wish | None = None if goal in GOAL_CATEGORIES else parse_wish(goal)
        self.category = goal
        """The category that stands for the goal."""
        if self.wish is not None:
            categories = self.wish.categories
            self.category = next((name for name in categories if name in GOAL_CATEGORIES), categories[0])
            self._channels = np.array([MPCAT40_ID[name] - 1 for name in categories])
        if isinstance(self._segmenter, TakesWords):
            wish = self.wish
            self._segmenter.ask(*(("", frozenset()) if wish is None else (wish.noun, wish.names)))
        self._last: tuple[Observation, Float32[np.ndarray, "classes h w"]] | None = None

    @property
    def spec(self) -> SegmenterSpec:
        """See `sim.core.interface.Segmenter`."""
        return self._segmenter.spec

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the scores of the goal; `goal` is the category that stands for it."""
        if self.wish is None:
            return self._segmenter.scores(observation, goal)
        return scores_of(self.posteriors(observation), self.category)

    def posteriors(self, observation: Observation) -> Float32[np.ndarray, "classes h w"]:
        """Returns the probabilities of the categories; objects with another name count as `misc`."""
        if self.wish is None:
            return self._segmenter.posteriors(observation)
        if self._last is None or self._last[0] is not observation:
            posteriors = np.array(self._segmenter.posteriors(observation))
            meant = posteriors[self._channels]
            matching = meant * self._named(observation, posteriors.shape[1:])
            posteriors[self._channels] = 0.0
            posteriors[_OTHER] += (meant - matching).sum(axis=0)
            posteriors[MPCAT40_ID[self.category] - 1] += matching.sum(axis=0)
            self._last = observation, posteriors
        return self._last[1]

    def objects(
        self, observation: Observation, shape: tuple[int, ...]
    ) -> tuple[Int32[np.ndarray, "h w"], Sequence[str]] | None:
        """Returns the object of each pixel of the posteriors, -1: none, and the names; None: they look alike."""
        seen = self._segmenter.objects(observation) if isinstance(self._segmenter, SeesObjects) else None
        return None if seen is None else (_reduced(seen[0], shape), seen[1])

    def _named(self, observation: Observation, shape: tuple[int, ...]) -> Float32[np.ndarray, "h w"] | np.float32:
        """Returns the probability that the object at a pixel has the right name if its category is right."""
        seen = self.objects(observation, shape)
        if seen is None or self.wish is None:
            return np.float32(1.0)
        right = np.array([name in self.wish.names for name in seen[1]] + [False], np.float32)
        return right[seen[0]]


def _reduced(image: Int32[np.ndarray, "height width"], shape: tuple[int, ...]) -> Int32[np.ndarray, "h w"]:
    """Returns the middle pixel of each block of an image, at a whole fraction of its resolution."""
    block = image.shape[0] // shape[0]
    return np.ascontiguousarray(image[block // 2 :: block, block // 2 :: block])
