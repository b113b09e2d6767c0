"""Measures where a network is right and wrong: pixels by distance, and objects by their size in the image.

An object is a connected region of one goal category in the true labels; two chairs that overlap in the image count as
one. An object is found if at least half of its pixels get its category.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field

import cv2
import numpy as np
from jaxtyping import Float32, Int64, UInt8

from sim.core.interface import GOAL_CATEGORIES
from sim.training.segmentation.dataset import GOAL_IDS
from sim.training.segmentation.evaluation import Iou, confusion
from stubborn.segmentation.rednet import CLASSES

DISTANCES_M = (1.0, 2.0, 3.0, 4.0, 5.0)
"""Edges of the bins of depth. Pixels that are nearer, at the largest depth or without one belong to no bin."""
EDGES_PX = (0, 16, 32, 64, 128, 640)
"""Edges of the bins of size: the square root of an object's area, in pixels of the 640 x 480 image."""
MIN_PIXELS = 4
"""Objects with fewer pixels at the network's resolution are not counted."""
FOUND_SHARE = 0.5


@dataclass(frozen=True)
class SeenObject:
    """An object in one view."""

    category: str
    edge_px: float
    """Square root of its area, in pixels of the 640 x 480 image."""
    right: float
    """Share of its pixels that got its category."""


@dataclass
class Breakdown:
    """Counts over views."""

    by_distance: Int64[np.ndarray, "bins classes classes"] = field(
        default_factory=lambda: np.zeros((len(DISTANCES_M) - 1, CLASSES, CLASSES), np.int64)
    )
    """Confusion matrices, see `sim.training.segmentation.evaluation.confusion`."""
    objects: list[SeenObject] = field(default_factory=list)

    def add(
        self,
        predicted: Int64[np.ndarray, "h w"],
        semantic: UInt8[np.ndarray, "h w"],
        depth_m: Float32[np.ndarray, "h w"],
        block_px: int,
    ) -> None:
        """Counts one view.

        Args:
            predicted: class channels (mpcat40 id - 1).
            semantic: true mpcat40 ids; 0 is void.
            depth_m: metres; 0: no return.
            block_px: edge of the square of pixels of the 640 x 480 image that one pixel stands for.
        """
        truth = semantic.astype(np.int64) - 1
        bins = np.digitize(depth_m, DISTANCES_M) - 1
        for i, counts in enumerate(self.by_distance):
            inside = bins == i
            counts += confusion(predicted[inside], truth[inside])
        self.objects += _objects(predicted, semantic, block_px)

    def iou_by_distance(self) -> list[tuple[float, float, Iou]]:
        """Returns the limits of each bin of depth in metres and the intersection over union of its pixels."""
        ends = itertools.pairwise(DISTANCES_M)
        return [(low, high, Iou.of(counts)) for (low, high), counts in zip(ends, self.by_distance, strict=True)]

    def found_by_size(self) -> list[tuple[int, int, int, float]]:
        """Returns the limits of each bin of size in pixels, the number of objects in it and the share that is found.

        Bins without an object are left out.
        """
        rows = []
        for low, high in itertools.pairwise(EDGES_PX):
            hits = [seen.right >= FOUND_SHARE for seen in self.objects if low <= seen.edge_px < high]
            if hits:
                rows.append((low, high, len(hits), float(np.mean(hits))))
        return rows

    def found_by_category(self) -> dict[str, tuple[int, float]]:
        """Returns the number of objects and the share that is found, of each goal category in the views."""
        result = {}
        for name in GOAL_CATEGORIES:
            hits = [seen.right >= FOUND_SHARE for seen in self.objects if seen.category == name]
            if hits:
                result[name] = (len(hits), float(np.mean(hits)))
        return result


def _objects(
    predicted: Int64[np.ndarray, "h w"], semantic: UInt8[np.ndarray, "h w"], block_px: int
) -> list[SeenObject]:
    """Returns the objects of goal categories in one view."""
    objects = []
    for name, category in zip(GOAL_CATEGORIES, GOAL_IDS, strict=True):
        mask = semantic == category
        if not mask.any():
            continue
        count, regions = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
        area_px = np.bincount(regions.reshape(-1), minlength=count)[1:]
        right_px = np.bincount(regions[predicted == category - 1], minlength=count)[1:]
        for area, right in zip(area_px, right_px, strict=True):
            if area >= MIN_PIXELS:
                objects.append(SeenObject(name, float(np.sqrt(area)) * block_px, float(right / area)))
    return objects
