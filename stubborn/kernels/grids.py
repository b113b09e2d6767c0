"""Compiled loops over the cells of a grid, for `stubborn.mapping.masks`, `stubborn.planning` and `stubborn.mapping`.

They are in a module of their own because numba compiles them: their annotations cannot be checked at run time.
"""

from __future__ import annotations

import math

import numpy as np

from sim.core.geometry.compiling import njit

MAX_REACH = 180
"""Largest distance in cells that `distance_within` computes: twice its square still fits into 16 bits."""


@njit(cache=True)
def distance_within(mask, reach):
    """Returns the distance from every cell's centre to that of the nearest True cell, (rows, cols) float32 in cells.

    Distances up to `reach` cells, a whole number up to `MAX_REACH`, are exact; all others are `reach`.
    """
    if reach > MAX_REACH:
        raise ValueError("distance_within: reach must be at most 180 cells, so that squares are 16-bit numbers.")
    rows, cols = mask.shape
    width = cols + reach  # the columns at the end are far from everything, so that a line may continue into the next
    one, beyond = np.uint16(1), np.uint16(reach + 1)  # 16-bit numbers throughout: many of them are computed at once
    gap = np.full((rows, width), beyond, np.uint16)  # first the distance to a True cell of the same column
    for row in range(rows):
        here, marked = gap[row], mask[row]
        for col in range(cols):
            here[col] = beyond * np.uint16(not marked[col])
    for row in range(1, rows):
        above, here = gap[row - 1], gap[row]
        for col in range(width):
            here[col] = min(np.uint16(above[col] + one), here[col])
    for row in range(rows - 2, -1, -1):
        below, here = gap[row + 1], gap[row]
        for col in range(width):
            here[col] = min(np.uint16(below[col] + one), here[col])
    squared = gap.reshape(-1)
    for i in range(squared.size):
        squared[i] = np.uint16(squared[i] * squared[i])
    least = squared.copy()
    for step in range(1, reach + 1):
        away, shifted, later = np.uint16(step * step), squared[step:], least[step:]
        for i in range(squared.size - step):
            least[i] = min(np.uint16(shifted[i] + away), least[i])
        for i in range(squared.size - step):
            later[i] = min(np.uint16(squared[i] + away), later[i])
    result = np.empty((rows, cols), np.float32)
    limit, cut = np.uint16(reach * reach), np.float32(reach)
    for row in range(rows):
        here, line = least[row * width : row * width + cols], result[row]
        for col in range(cols):
            root = np.sqrt(np.float32(here[col]))  # before the choice: a branch would not be vectorised
            line[col] = root if here[col] <= limit else cut
    return result


@njit(cache=True)
def speeds(clearance_m, least_m, open_m, edge_speed, rise):
    """Returns the speed at some clearances (rows, cols); all numbers are float32.

    It rises linearly from `edge_speed` at `least_m` to `edge_speed + rise`, at most 1, at `least_m + open_m`.
    """
    rows, cols = clearance_m.shape
    one, result = np.float32(1.0), np.empty((rows, cols), np.float32)
    for row in range(rows):
        for col in range(cols):
            speed = edge_speed + rise * ((clearance_m[row, col] - least_m) / open_m)
            result[row, col] = min(max(speed, edge_speed), one)
    return result


@njit(cache=True)
def bilinear(values, origin_x_m, origin_y_m, cell_m, x_m, y_m):
    """Returns bilinear values (n,) at points, over the finite ones of the four cells around each.

    The value is infinite off the grid and where the value of the point's own cell is infinite.
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

    A cell is passable if it is traversable or has a clearance of at least `least_m`.
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
