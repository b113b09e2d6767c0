"""The boxes with which a model collides, and the top on which smaller objects may stand."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.housegen.imported.meshes import Part

MAX_BOXES = 12
MIN_SAVED_M3, MIN_SAVED_SHARE = 0.002, 0.015
"""A box is divided if that saves so much volume, and this share of the volume of the box around the model."""
CUTS = 24
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
    while len(groups) < MAX_BOXES:
        best = max(range(len(groups)), key=lambda n: _best_cut(groups[n])[0])
        saved, axis, at = _best_cut(groups[best])
        if saved < least:
            break
        below = groups[best][:, axis] < at
        groups[best : best + 1] = [groups[best][below], groups[best][~below]]
    boxes = np.array([[*group.min(axis=0), *group.max(axis=0)] for group in groups])
    thin = boxes[:, 3:] - boxes[:, :3] < MIN_SIDE_M
    middle = 0.5 * (boxes[:, 3:] + boxes[:, :3])
    boxes[:, :3] = np.where(thin, middle - 0.5 * MIN_SIDE_M, boxes[:, :3])
    boxes[:, 3:] = np.where(thin, middle + 0.5 * MIN_SIDE_M, boxes[:, 3:])
    boxes[:, 2] = np.maximum(boxes[:, 2], 0.0)
    return np.round(boxes, 3)


def top_of(parts: tuple[Part, ...]) -> tuple[float, float, float, float, float] | None:
    """Returns lowest x, y, highest x, y and the height of the largest free level rectangle; None where none is large.

    It is free if nothing of the model is above it.
    """
    points = _samples(parts, 8 * POINTS)
    low, high = points.min(axis=0), points.max(axis=0)
    shape = np.maximum(1, np.ceil((high[:2] - low[:2]) / CELL_M).astype(int))
    cells = np.minimum(((points[:, :2] - low[:2]) / CELL_M).astype(int), shape - 1)
    heights = np.full(shape, -1.0)
    np.maximum.at(heights, (cells[:, 0], cells[:, 1]), points[:, 2])
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
    areas = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    rng = np.random.default_rng(0)
    chosen = rng.choice(len(corners), size=count, p=areas / areas.sum())
    u, v = rng.random((2, count, 1))
    u, v = np.where(u + v > 1.0, 1.0 - u, u), np.where(u + v > 1.0, 1.0 - v, v)
    a, b, c = (corners[chosen, k] for k in range(3))
    return np.vstack([corners.reshape(-1, 3), a + u * (b - a) + v * (c - a)])


def _volume(points: NDArray) -> float:
    return float(np.prod(np.maximum(np.ptp(points, axis=0), MIN_SIDE_M)))


def _best_cut(points: NDArray) -> tuple[float, int, float]:
    """Returns the volume that the best division of the box around some points saves, its axis and its position."""
    best = (0.0, 0, 0.0)
    low, high, whole = points.min(axis=0), points.max(axis=0), _volume(points)
    for axis in range(3):
        if high[axis] - low[axis] < 4 * MIN_SIDE_M:
            continue
        order = points[np.argsort(points[:, axis], kind="stable")]
        first_low, first_high = np.minimum.accumulate(order), np.maximum.accumulate(order)
        last_low = np.minimum.accumulate(order[::-1])[::-1]
        last_high = np.maximum.accumulate(order[::-1])[::-1]
        for at in np.linspace(low[axis], high[axis], CUTS + 1)[1:-1]:
            n = int(np.searchsorted(order[:, axis], at))
            if not 0 < n < len(order):
                continue
            sides = (first_high[n - 1] - first_low[n - 1], last_high[n] - last_low[n])
            saved = whole - sum(float(np.prod(np.maximum(side, MIN_SIDE_M))) for side in sides)
            if saved > best[0]:
                best = (saved, axis, float(at))
    return best


def _largest_rectangle(cells: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """Returns the range of rows and columns of the largest rectangle of true cells."""
    best, found = 0, (0, 0, 0, 0)
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
                    found = (row - high + 1, left, row + 1, right + 1)
    return found
