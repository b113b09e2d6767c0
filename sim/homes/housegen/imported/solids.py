"""The boxes with which a model collides, and the top on which smaller objects may stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import grey_closing

from sim.homes.housegen.imported.meshes import Part
from sim.homes.housegen.mjcf.triangles import triangle_areas

MAX_BOXES = 12
MIN_SAVED_M3, MIN_SAVED_SHARE = 0.002, 0.015
"""A box is divided if that saves at least this volume, and this share of the volume of the box around the model."""
CUTS, AHEAD = 24, 2
"""Cells of the grid along an axis, and every how many of them a division is tried that pays by later ones only."""
POINTS = 6_000
MIN_SIDE_M = 0.01
POT_M = 0.3
"""Height up to which a plant collides: leaves and branches give way."""
CELL_M = 0.02
TOP_M = (0.25, 1.3)
"""Heights at which a top can be."""
MIN_TOP_SHARE, MIN_TOP_SIDE_M = 0.3, 0.16


def collision_boxes(parts: tuple[Part, ...], category: str) -> NDArray[np.float64]:
    """Returns few boxes (n, 6) around the surface of a model, lowest corner and then highest, in metres.

    The box around everything is divided where that saves most empty space, again and again.
    """
    points = _samples(parts)
    if category == "plant":
        low = points[points[:, 2] <= min(POT_M, 0.35 * float(points[:, 2].max()))]
        points = low if len(low) > 20 else points
    groups = [points]
    least = max(MIN_SAVED_M3, MIN_SAVED_SHARE * _volume(points))
    cuts = [_best_cut(points)]
    while len(groups) < MAX_BOXES:
        best = max(range(len(groups)), key=lambda n: cuts[n][0])
        saved, axis, at = cuts[best]
        below = groups[best][:, axis] < at
        if saved < least or below.all() or not below.any():
            break
        sides = [groups[best][below], groups[best][~below]]
        groups[best : best + 1] = sides
        cuts[best : best + 1] = [_best_cut(side) for side in sides]
    boxes = np.array([[*group.min(axis=0), *group.max(axis=0)] for group in groups])
    boxes = thickened(boxes)
    boxes[:, 2] = np.maximum(boxes[:, 2], 0.0)
    return np.asarray(np.round(boxes, 3), dtype=np.float64)


def thickened(boxes_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns boxes (n, 6) with sides of at least `MIN_SIDE_M`, about their middles."""
    low, high = boxes_m[:, :3], boxes_m[:, 3:]
    thin, middle = high - low < MIN_SIDE_M, 0.5 * (low + high)
    ends = np.where(thin, middle - 0.5 * MIN_SIDE_M, low), np.where(thin, middle + 0.5 * MIN_SIDE_M, high)
    return np.hstack(ends)


def top_of(parts: tuple[Part, ...]) -> tuple[float, float, float, float, float] | None:
    """Returns lowest x, y, highest x, y and the height of the largest free level rectangle; None if all are small.

    It is free if nothing of the model is above it.
    """
    points = _samples(parts, 8 * POINTS)
    low, high = points.min(axis=0), points.max(axis=0)
    shape = np.maximum(1, np.ceil((high[:2] - low[:2]) / CELL_M).astype(int))
    cells = np.minimum(((points[:, :2] - low[:2]) / CELL_M).astype(int), shape - 1)
    heights = np.full(shape, -1.0)
    np.maximum.at(heights, (cells[:, 0], cells[:, 1]), points[:, 2])
    heights = grey_closing(heights, size=(3, 3))  # cells without a point on their upper side
    levels = heights[(heights >= TOP_M[0]) & (heights <= TOP_M[1])]
    if len(levels) < MIN_TOP_SHARE * heights.size:
        return None
    counts, edges = np.histogram(levels, bins=np.arange(TOP_M[0], TOP_M[1] + 0.02, 0.01))
    level = float(edges[int((counts[:-1] + counts[1:]).argmax()) + 1])
    flat = np.abs(heights - level) <= 0.0125
    if flat.sum() < MIN_TOP_SHARE * heights.size:
        return None
    i0, j0, i1, j1 = _largest_rectangle(flat)
    x0, y0, x1, y1 = (*(low[:2] + CELL_M * np.array([i0, j0])), *(low[:2] + CELL_M * np.array([i1, j1])))
    if min(x1 - x0, y1 - y0) < MIN_TOP_SIDE_M:
        return None
    height = float(np.median(heights[i0:i1, j0:j1]))
    x0, y0, x1, y1, z = (round(float(v), 3) for v in (x0, y0, x1, y1, height))
    return x0, y0, x1, y1, z


def _samples(parts: tuple[Part, ...], count: int = POINTS) -> NDArray[np.float64]:
    """Returns all vertices, and points spread evenly over the triangles, the same in each run."""
    corners = np.vstack([part.vertices_m[part.faces] for part in parts])
    areas = triangle_areas(corners)
    rng = np.random.default_rng(0)
    chosen = rng.choice(len(corners), size=count, p=areas / areas.sum())
    u, v = rng.random((2, count, 1))
    u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
    a, b, c = (corners[chosen, k] for k in range(3))
    return np.vstack([corners.reshape(-1, 3), a + u * (b - a) + v * (c - a)])


def _volume(points: NDArray) -> float:
    return float(np.prod(np.maximum(np.ptp(points, axis=0), MIN_SIDE_M)))


@dataclass(frozen=True)
class _Cells:
    """The cells of a grid that a group of points fills."""

    filled: NDArray[np.bool_]  # (i, j, k)
    low_m: NDArray[np.float64]
    cell_m: NDArray[np.float64]

    @classmethod
    def of(cls, points: NDArray) -> _Cells:
        """Returns a grid of at most `CUTS` cells along each axis."""
        low, extent = points.min(axis=0), np.maximum(np.ptp(points, axis=0), MIN_SIDE_M)
        shape = np.clip(np.ceil(extent / MIN_SIDE_M), 1, CUTS).astype(int)
        filled = np.zeros(tuple(shape), dtype=bool)
        index = np.minimum(((points - low) / extent * shape).astype(int), shape - 1)
        filled[tuple(index.T)] = True
        return cls(filled, low, extent / shape)


def _best_cut(points: NDArray) -> tuple[float, int, float]:
    """Returns the volume that the best division of the box around some points saves, its axis and its position.

    A division without a saving of its own counts by the savings of the next ones: under a table top are four legs.
    """
    cells = _Cells.of(points)
    saved, axis, index = _direct_cut(cells.filled, cells.cell_m)
    if saved < MIN_SAVED_M3:
        saved, axis, index = _indirect_cut(cells)
    return saved, axis, float(cells.low_m[axis] + index * cells.cell_m[axis])


def _indirect_cut(cells: _Cells) -> tuple[float, int, int]:
    """Returns the division after which one more on each side saves most."""
    best = (0.0, 0, 0)
    for axis in range(3):
        for index in range(1, cells.filled.shape[axis], AHEAD):
            below, above = np.split(cells.filled, [index], axis=axis)
            saved = sum(_direct_cut(side, cells.cell_m)[0] for side in (below, above))
            if saved > best[0]:
                best = (saved, axis, index)
    return best


def _direct_cut(filled: NDArray[np.bool_], cell_m: NDArray[np.float64]) -> tuple[float, int, int]:
    """Returns the volume saved, the axis and the first cell of the upper side of the best division of a grid."""
    best = (0.0, 0, 0)
    if not filled.any():
        return best
    for axis in range(3):
        if filled.shape[axis] < 2:
            continue
        low, high = _ranges(filled, axis)
        below = _volumes(np.minimum.accumulate(low), np.maximum.accumulate(high), cell_m)
        above = _volumes(np.minimum.accumulate(low[::-1])[::-1], np.maximum.accumulate(high[::-1])[::-1], cell_m)
        saved = below[-1] - below[:-1] - above[1:]
        n = int(saved.argmax())
        if saved[n] > best[0]:
            best = (float(saved[n]), axis, n + 1)
    return best


def _ranges(filled: NDArray[np.bool_], axis: int) -> tuple[NDArray, NDArray]:
    """Returns the first and the last filled cell (n, 3) of every layer across an axis; beyond the grid if empty."""
    count = filled.shape[axis]
    low, high = np.full((count, 3), 10**6), np.full((count, 3), -1)
    occupied = filled.any(axis=tuple(other for other in range(3) if other != axis))
    low[occupied, axis] = high[occupied, axis] = np.flatnonzero(occupied)
    for other in range(3):
        if other != axis:
            seen = np.asarray(np.moveaxis(filled, (axis, other), (0, 1)).any(axis=2))[occupied]
            low[occupied, other] = seen.argmax(axis=1)
            high[occupied, other] = filled.shape[other] - 1 - seen[:, ::-1].argmax(axis=1)
    return low, high


def _volumes(low: NDArray, high: NDArray, cell_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the volumes of boxes of cells; 0 for empty boxes."""
    return np.prod(np.maximum(high - low + 1, 0) * cell_m, axis=1)


def _largest_rectangle(cells: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """Returns the range of rows and columns of the largest rectangle of true cells."""
    best, rectangle = 0, (0, 0, 0, 0)
    above = np.zeros(cells.shape[1], dtype=int)
    for row in range(cells.shape[0]):
        above = np.where(cells[row], above + 1, 0)
        for left in range(cells.shape[1]):
            high = int(above[left])
            for right in range(left, cells.shape[1]):
                high = min(high, int(above[right]))
                if not high:
                    break
                if high * (right - left + 1) > best:
                    best = high * (right - left + 1)
                    rectangle = (row - high + 1, left, row + 1, right + 1)
    return rectangle
