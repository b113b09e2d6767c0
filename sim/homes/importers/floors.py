"""Finds the storeys of a house of triangles, their flat floors, and rectangles that cover parts of a plan.

A scanned floor is uneven and has holes below furniture. Here each storey gets one level, and its floor covers the plan
of everything that stands on it, with holes closed, so that wheels roll on flat boxes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_closing, binary_fill_holes, label

from sim.core.errors import HouseError
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.importers.collision import joined_cells

PLAN_CELL_M = 0.05
"""Edge of a cell of a plan."""
MAX_PLAN_CELLS = 16_000_000
LEVEL_M = 0.12
"""Triangles of floors at most this far from the level of a storey belong to it, and are made flat."""
MIN_STOREY_M2 = 3.0
MIN_SHARE = 0.15
"""A level is a storey if its floor has this share of the area of the largest one."""
STOREYS_APART_M = 1.2
LEVEL_NORMAL = 0.8
"""Least vertical part of the normal of a triangle that is a piece of a floor."""
CLOSED_M = 0.4
"""Gaps of floors up to this width are closed."""
LARGEST_HOLE_M2 = 1.0
"""Larger holes of an upper storey stay: a staircase may be in them."""
COVERED = 0.995
MAX_RECTANGLES = 60


@dataclass(frozen=True)
class Plan:
    """A grid over the ground: `mask` (cols, rows) is indexed [x, y]."""

    origin_m: tuple[float, float]
    mask: NDArray[np.bool_]

    def rectangles(self, *, covered: float = COVERED, most: int = MAX_RECTANGLES) -> list[Rect]:
        """Returns rectangles without overlap that cover this share of the cells or more, the largest first.

        Args:
            covered: share of the cells at which no more are added.
            most: largest number.
        """
        rectangles = [] if not self.mask.any() else self._joined()
        rectangles.sort(key=lambda rect: -rect.area_m2)
        total, chosen = sum(rect.area_m2 for rect in rectangles), []
        for rect in rectangles[:most]:
            if sum(rectangle.area_m2 for rectangle in chosen) >= covered * total:
                break
            chosen.append(rect)
        return chosen

    def within(self, rects: Sequence[Rect]) -> list[Rect]:
        """Returns rectangles that cover the cells of this plan that are in one of some rectangles."""
        mask = np.zeros_like(self.mask)
        for rect in rects:
            corners_m = np.array([(rect.x0, rect.y0), (rect.x1, rect.y1)])
            cells = np.rint((corners_m - np.array(self.origin_m)) / PLAN_CELL_M)
            (x0, y0), (x1, y1) = np.maximum(cells, 0).astype(int).tolist()
            mask[x0:x1, y0:y1] = True
        return Plan(self.origin_m, mask & self.mask).rectangles(covered=0.99)

    def _joined(self) -> list[Rect]:
        ranges, _ = joined_cells(self.mask[:, :, None])
        (x, y), cell = self.origin_m, PLAN_CELL_M
        return [
            Rect(x + cell * x0, y + cell * y0, x + cell * x1, y + cell * y1) for x0, y0, _, x1, y1, _ in ranges.tolist()
        ]

    @property
    def area_m2(self) -> float:
        """Area of the cells."""
        return float(self.mask.sum()) * PLAN_CELL_M**2


@dataclass(frozen=True)
class Storey:
    """A level of the house."""

    z_m: float
    floor: Plan


def level_triangles(corners_m: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Returns (m,), whether triangles (m, 3, 3) are about horizontal and face up.

    If fewer than a fifth of the level ones face up, the sides of the triangles have no meaning and all count.
    """
    normal = np.cross(corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0])
    level = np.abs(normal[:, 2]) > LEVEL_NORMAL * np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    upward = level & (normal[:, 2] > 0.0)
    return upward if normal[upward, 2].sum() >= 0.2 * np.abs(normal[level, 2]).sum() else level


class NoFloorError(HouseError):
    """A home without a level floor, for example because another axis points up."""


def find_levels(floors_m: NDArray[np.float64]) -> list[float]:
    """Returns the heights of the storeys, the lowest first.

    Args:
        floors_m: triangles (m, 3, 3) of all floors.

    Raises:
        HouseError: a floor of some square metres at one height is missing.
    """
    level = floors_m[level_triangles(floors_m)] if len(floors_m) else floors_m
    area = 0.5 * np.abs(np.cross(level[:, 1] - level[:, 0], level[:, 2] - level[:, 0])[:, 2])
    z = level[:, :, 2].mean(axis=1)
    intervals: list[tuple[float, float]] = []
    left = np.ones(len(z), dtype=np.bool_)
    while left.any():
        edges = np.arange(z[left].min() - 0.05, z[left].max() + 0.1, 0.05)
        counts, edges = np.histogram(z[left], bins=edges, weights=area[left])
        peak = edges[int(np.convolve(counts, [1.0, 1.0, 1.0], "same").argmax())] + 0.025
        near = left & (np.abs(z - peak) <= LEVEL_M)
        height = _weighted_median(z[near], area[near]) if near.any() else peak
        size_m2 = float(area[near].sum())
        if size_m2 < MIN_STOREY_M2 or (intervals and size_m2 < MIN_SHARE * intervals[0][0]):
            break
        intervals.append((size_m2, height))
        left &= np.abs(z - height) > STOREYS_APART_M
    if not intervals:
        raise NoFloorError(f"it has no level floor of {MIN_STOREY_M2:g} m2 or more.")
    return sorted(height for _, height in intervals)


def _weighted_median(values: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return float(values[order][min(int(np.searchsorted(total, 0.5 * total[-1])), len(values) - 1)])


def make_storeys(
    levels_m: Sequence[float], floors_m: NDArray[np.float64], others_m: NDArray[np.float64]
) -> list[Storey]:
    """Returns the storeys with their floors.

    Args:
        levels_m: their heights, the lowest first.
        floors_m: triangles (m, 3, 3) of all floors.
        others_m: triangles of objects that stand on them, below which the floor goes on.
    """
    low = np.floor(floors_m.reshape(-1, 3).min(axis=0)[:2] / PLAN_CELL_M) - 4
    high = np.ceil(floors_m.reshape(-1, 3).max(axis=0)[:2] / PLAN_CELL_M) + 4
    shape = (high - low).astype(int)
    if int(shape[0]) * int(shape[1]) > MAX_PLAN_CELLS:
        raise HouseError(f"its floors extend over {shape[0] * PLAN_CELL_M:.0f} x {shape[1] * PLAN_CELL_M:.0f} m.")
    origin = (float(low[0] * PLAN_CELL_M), float(low[1] * PLAN_CELL_M))
    storeys = []
    for number, z_m in enumerate(levels_m):
        mine = floors_m[(np.abs(floors_m[:, :, 2].mean(axis=1) - z_m) <= LEVEL_M) & level_triangles(floors_m)]
        here = others_m[_between(others_m, z_m - LEVEL_M, z_m + 0.5)]
        floor = rasterized(mine, origin, (int(shape[0]), int(shape[1])))
        both = floor | (rasterized(here, origin, floor.shape) & _near(floor))
        storeys.append(Storey(z_m, Plan(origin, _closed(both, is_lowest=number == 0))))
    return storeys


def _between(corners_m: NDArray[np.float64], low_m: float, high_m: float) -> NDArray[np.bool_]:
    z = corners_m[:, :, 2]
    return (z.min(axis=1) <= high_m) & (z.max(axis=1) >= low_m)


def _near(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Returns the inside of the outline of a mask: objects outside of the house need no floor."""
    size = round(2.0 / PLAN_CELL_M) | 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    padded = np.pad(mask.astype(np.uint8), size)
    closed = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, kernel)[size:-size, size:-size]
    return np.asarray(binary_fill_holes(closed > 0))


def _closed(mask: NDArray[np.bool_], *, is_lowest: bool) -> NDArray[np.bool_]:
    """Returns a floor without gaps and holes; large holes stay above the lowest storey."""
    size = round(CLOSED_M / PLAN_CELL_M)
    closed = (
        np.asarray(binary_closing(np.pad(mask, size), np.ones((size, size))), dtype=np.bool_)[size:-size, size:-size]
        | mask
    )
    whole = np.asarray(binary_fill_holes(closed))
    if is_lowest:
        return whole
    holes = np.asarray(label(whole & ~closed)[0], dtype=np.int64)  # type: ignore[index]
    sizes_m2 = np.bincount(holes.ravel()) * PLAN_CELL_M**2
    return np.asarray(closed | ((holes > 0) & (sizes_m2[holes] <= LARGEST_HOLE_M2)))


def rasterized(
    corners_m: NDArray[np.float64], origin_m: tuple[float, float], shape: tuple[int, ...]
) -> NDArray[np.bool_]:
    """Returns the mask (cols, rows) [x, y] of the cells that triangles (m, 3, 3) cover in plan."""
    picture = np.zeros((shape[1], shape[0]), dtype=np.uint8)
    # Pixels are the cells; OpenCV's fractional coordinates have their origin at the middle of the first one.
    at = np.rint(((corners_m[:, :, :2] - np.array(origin_m)) / PLAN_CELL_M - 0.5) * 16.0).astype(np.int32)
    for triangle in at:
        cv2.fillConvexPoly(picture, triangle, 1, shift=4)
    return picture.T > 0
