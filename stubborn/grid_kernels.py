"""Compiled loops over the cells of a grid, for `stubborn.raster`, `stubborn.planning` and `stubborn.mapping`.

They are apart from their users because numba compiles them, so that no annotation of theirs can be checked at run time.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(cache=True)
def distance_within(mask, reach):
    """Returns the distance from every cell's centre to that of the nearest True cell, (rows, cols) float32 in cells.

    Distances up to `reach` cells, a whole number, are exact; all others are `reach`.
    """
    rows, cols = mask.shape
    one, beyond = np.float32(1.0), np.float32(reach + 1)  # whole numbers in float32 throughout: that is vectorised best
    squared = np.full((rows + 1, cols), beyond, np.float32)  # first the distance to a True cell of the same column
    for row in range(rows):
        above, here, marked = (
            squared[row - 1],
            squared[row],
            mask[row],
        )  # index -1, the last row, is used where there is none before
        for col in range(cols):
            gap = above[col] + one
            gap = gap if gap < beyond else beyond
            here[col] = np.float32(0.0) if marked[col] else gap
    for row in range(rows - 2, -1, -1):
        below, here = squared[row + 1], squared[row]
        for col in range(cols):
            gap = below[col] + one
            here[col] = gap if gap < here[col] else here[col]
    result = np.empty((rows, cols), np.float32)
    limit, cut = np.float32(reach * reach), np.float32(reach)
    for row in range(rows):
        line, least = squared[row] * squared[row], result[row]
        least[:] = line
        for step in range(1, min(reach, cols - 1) + 1):
            away, shifted, later = np.float32(step * step), line[step:], least[step:]
            for col in range(cols - step):
                other = shifted[col] + away
                least[col] = other if other < least[col] else least[col]
            for col in range(cols - step):
                other = line[col] + away
                later[col] = other if other < later[col] else later[col]
        for col in range(cols):
            root = np.sqrt(least[col])  # outside of the choice: a branch would not be vectorised
            least[col] = root if least[col] <= limit else cut
    return result


@njit(cache=True)
def bilinear(values, origin_x_m, origin_y_m, cell_m, x_m, y_m):
    """Returns bilinear values (n,) at points, over the finite ones of the four cells around each.

    The value is infinite off the grid and where that of the point's own cell is.
    """
    rows, cols = values.shape
    result = np.full(x_m.size, np.inf)
    for i in range(x_m.size):
        across, along = (x_m[i] - origin_x_m) / cell_m, (y_m[i] - origin_y_m) / cell_m
        row, col = math.floor(along), math.floor(across)
        if row < 0 or row >= rows or col < 0 or col >= cols or not math.isfinite(values[row, col]):
            continue
        fc, fr = across - 0.5, along - 0.5
        c0, r0 = math.floor(fc), math.floor(fr)
        total = weight = 0.0
        for dr in range(2):
            for dc in range(2):
                value = values[min(max(r0 + dr, 0), rows - 1), min(max(c0 + dc, 0), cols - 1)]
                if math.isfinite(value):
                    share = abs(1 - dr - (fr - r0)) * abs(1 - dc - (fc - c0))
                    total += share * value
                    weight += share
        if weight > 1e-6:
            result[i] = total / max(weight, 1e-9)
    return result


@njit(cache=True)
def sweep(traversable, clearance_m, least_m, origin_x_m, origin_y_m, cell_m, x_m, y_m):
    """Returns whether each line of points (points, n) stays on the grid and passable, and its least clearance.

    A cell is passable that is traversable or has a clearance of at least `least_m`.
    """
    rows, cols = traversable.shape
    clear, nearest_m = np.ones(x_m.shape[1], np.bool_), np.full(x_m.shape[1], np.inf, np.float32)
    for point in range(x_m.shape[0]):
        for i in range(x_m.shape[1]):
            row, col = (
                math.floor((y_m[point, i] - origin_y_m) / cell_m),
                math.floor((x_m[point, i] - origin_x_m) / cell_m),
            )
            clear[i] &= 0 <= row < rows and 0 <= col < cols
            row, col = min(max(row, 0), rows - 1), min(max(col, 0), cols - 1)
            clear[i] &= traversable[row, col] or clearance_m[row, col] >= least_m
            nearest_m[i] = min(nearest_m[i], clearance_m[row, col])
    return clear, nearest_m
