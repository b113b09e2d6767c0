"""Scores of goals in words and pictures: the categories that they mean, and the objects with the right name.

A segmentation knows the 40 categories. A goal in words may mean several of them ("something to sit on"), or only some
objects of one ("fridge" among the appliances). Its scores are therefore rearranged: one category stands for the goal,
and what reads scores works as with a goal category. The posteriors stay those of the categories: tracks of objects
outlast the goal.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import cv2
import numpy as np
from jaxtyping import Float32, Int32, UInt8

from sim.core.interface import (
    GOAL_CATEGORIES,
    MPCAT40_ID,
    CameraModel,
    GuessesNames,
    Observation,
    Scores,
    SeesObjects,
    Segmenter,
    SegmenterSpec,
    SegmentsPictures,
    TakesWords,
)
from sim.core.vocabulary import vocabulary
from sim.core.wishes import Wish, parse_wish
from stubborn.detection.pictured import PictureGoal, one_hot

STANDS_FOR: Mapping[str, str] = MappingProxyType(
    {
        "appliances": "counter", "mirror": "sink", "shelving": "cabinet", "lighting": "table", "curtain": "bed",
        "blinds": "bed", "board_panel": "table", "furniture": "sofa", "objects": "table",
    }
)  # fmt: skip
"""The goal category in place of another one for explorers that know only those: one that is found in the same rooms."""
_PICTURE_DEPTH_M = 4.0
"""Depth that a segmenter gets for each pixel of a picture, which has none: of 1.5 to 5 m, the shipped network named the
most pictures of `train` right with this, which are few."""
_OTHER = MPCAT40_ID["misc"] - 1
"""Channel that gets what is not the goal although it is of the goal's category."""


class WishedSegmenter:
    """A segmenter for goals in words and pictures; for a category it returns what the other one does.

    Args:
        segmenter: the other one.
        camera: the robot's camera.
    """

    def __init__(self, segmenter: Segmenter, camera: CameraModel) -> None:
        self._segmenter, self._camera = segmenter, camera
        self.ask("chair")

    def ask(self, goal: str) -> None:
        """Sets the goal: a category, words, or "" for a picture, which `show` must get next.

        Raises:
            WishError: a word is not known.
        """
        self.picture: PictureGoal | None = None
        """What the picture of the goal shows; None: the goal is text, or the picture was not shown yet."""
        self.awaits_picture = not goal
        self.wish: Wish | None = None if goal in ("", *GOAL_CATEGORIES) else parse_wish(goal)
        self.category = goal or GOAL_CATEGORIES[0]
        """The category that stands for the goal."""
        if self.wish is not None:
            categories = self.wish.categories
            self.category = next((name for name in categories if name in GOAL_CATEGORIES), categories[0])
            self._channels = np.array([MPCAT40_ID[name] - 1 for name in categories])
        if isinstance(self._segmenter, TakesWords):
            wish = self.wish
            self._segmenter.ask(*(("", frozenset()) if wish is None else (wish.noun, wish.names)))

    def show(self, picture: UInt8[np.ndarray, "h w 3"]) -> None:
        """Sets the goal to the object in the middle of a picture."""
        ids = self._segmenter.picture_categories() if isinstance(self._segmenter, SegmentsPictures) else None
        self.picture = PictureGoal.of(picture, self._seen_by_robot(picture) if ids is None else one_hot(ids))
        self.category, self.awaits_picture = self.picture.category, False

    @property
    def spec(self) -> SegmenterSpec:
        """See `sim.core.interface.Segmenter`."""
        return self._segmenter.spec

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the scores of the goal; `goal` is the category that stands for it."""
        if self.wish is None:
            return self._segmenter.scores(observation, goal)
        posteriors = np.array(self._segmenter.posteriors(observation))
        meant = posteriors[self._channels]
        matching = meant * self._right_names(observation, posteriors.shape[1:])
        posteriors[self._channels] = 0.0
        posteriors[_OTHER] += (meant - matching).sum(axis=0)
        return Scores(matching.sum(axis=0), posteriors.max(axis=0))

    def posteriors(self, observation: Observation) -> Float32[np.ndarray, "classes h w"]:
        """Returns the probabilities of the categories, whatever the goal is."""
        return self._segmenter.posteriors(observation)

    def objects(
        self, observation: Observation, shape: tuple[int, ...]
    ) -> tuple[Int32[np.ndarray, "h w"], Sequence[str]] | None:
        """Returns the object of each pixel of the posteriors, -1: none, and the names; None: they look alike."""
        seen = self._segmenter.objects(observation) if isinstance(self._segmenter, SeesObjects) else None
        return None if seen is None else (_reduced(seen[0], shape), seen[1])

    def named(
        self, observation: Observation, shape: tuple[int, ...]
    ) -> tuple[Float32[np.ndarray, "names rows cols"], Sequence[str]] | None:
        """Returns the probability of each everyday name at a whole fraction of the resolution `shape` (h, w).

        The names follow. None: they are not known.
        """
        guessed = self._segmenter.named(observation) if isinstance(self._segmenter, GuessesNames) else None
        if guessed is None:
            return None
        image, names = guessed
        every = shape[0] // image.shape[1]
        if (every * image.shape[1], every * image.shape[2]) != tuple(shape):  # as of a camera of 640 x 500 pixels
            row, col = (np.arange(own) * size // own for own, size in zip(shape, image.shape[1:], strict=True))
            image = np.ascontiguousarray(image[:, row[:, None], col])
        return image, names

    def _seen_by_robot(self, picture: UInt8[np.ndarray, "h w 3"]) -> Float32[np.ndarray, "classes rows cols"]:
        """Returns the posteriors of a picture that is shown to the segmenter as an image of the robot's camera."""
        height, width = self._camera.height_px, self._camera.width_px
        scale = min(height / picture.shape[0], width / picture.shape[1])
        rows, cols = round(scale * picture.shape[0]), round(scale * picture.shape[1])
        top, left = (height - rows) // 2, (width - cols) // 2
        image = cv2.copyMakeBorder(
            cv2.resize(picture, (cols, rows), interpolation=cv2.INTER_AREA),
            top, height - rows - top, left, width - cols - left, cv2.BORDER_REPLICATE,
        )  # fmt: skip
        depth = np.full((height, width), _PICTURE_DEPTH_M, np.float32)
        posteriors = self._segmenter.posteriors({"rgb": image, "depth": depth})
        block = height // posteriors.shape[1]
        inside = slice(top // block, (top + rows) // block), slice(left // block, (left + cols) // block)
        return np.array(posteriors[:, *inside])

    def _right_names(
        self, observation: Observation, shape: tuple[int, ...]
    ) -> Float32[np.ndarray, "#categories h w"] | np.float32:
        """Returns the probability that the object at a pixel has a right name if it is of each category of the wish."""
        seen = self.objects(observation, shape)
        if self.wish is None:
            return np.float32(1.0)
        if seen is not None:
            right = np.array([name in self.wish.names for name in seen[1]] + [False], np.float32)
            return right[seen[0]][None]
        guessed = self.named(observation, shape)
        if guessed is None or not self.wish.names <= set(guessed[1]):
            return np.float32(1.0)
        image, names = guessed
        shares = np.ones((len(self.wish.categories), *image.shape[1:]), np.float32)
        for number, category in enumerate(self.wish.categories):
            of_category = [category in vocabulary().categories.get(name, ()) for name in names]
            meant = [is_so and name in self.wish.names for is_so, name in zip(of_category, names, strict=True)]
            shares[number] = image[meant].sum(axis=0) / np.maximum(image[of_category].sum(axis=0), 1e-9)
        every = shape[0] // image.shape[1]
        return shares.repeat(every, axis=1).repeat(every, axis=2)


def _reduced(image: Int32[np.ndarray, "height width"], shape: tuple[int, ...]) -> Int32[np.ndarray, "h w"]:
    """Returns the middle pixel of each block of an image, at a whole fraction of its resolution."""
    block = image.shape[0] // shape[0]
    return np.ascontiguousarray(image[block // 2 :: block, block // 2 :: block])
