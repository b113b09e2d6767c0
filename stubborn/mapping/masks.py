"""Functions on masks over a grid: distances, connected parts, lines of sight. Units are cells, not metres."""

from __future__ import annotations

import math
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int

from sim.core.interface import ConfigError
from stubborn.kernels.grids import MAX_REACH, distance_within

Cells = tuple[Int[np.ndarray, " n"], Int[np.ndarray, " n"]]
"""Rows and columns."""


def distance_to(mask: Bool[np.ndarray, "rows cols"]) -> Float32[np.ndarray, "rows cols"]:
    """Returns the exact distance from every cell's centre to that of the nearest True cell; huge in an empty mask."""
    return np.asarray(cv2.distanceTransform((~mask).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE), np.float32)


def farther_than(
    mask: Bool[np.ndarray, "rows cols"], distance_m: float, cell_m: float
) -> Bool[np.ndarray, "rows cols"]:
    """Returns the cells with their centre farther than a distance from the centre of every True cell.

    Raises:
        ConfigError: the distance is longer than 178 cells.
    """
    reach = math.floor(distance_m / cell_m) + 2  # one for rounding
    if reach > MAX_REACH:
        raise ConfigError(
            f"A distance on the map, such as own_known_m, must be at most {(MAX_REACH - 2) * cell_m:g} m "
            f"with cells of {cell_m:g} m, got {distance_m:g} m."
        )
    return distance_within(mask, reach) * np.float32(cell_m) > np.float32(distance_m)


class NearestCells(NamedTuple):
    """For every cell of a grid, the nearest cell of a mask."""

    gap_cells: Float32[np.ndarray, "rows cols"]
    """Distance to it, with an error of at most 2 %."""
    rows: Int[np.ndarray, "rows cols"]
    cols: Int[np.ndarray, "rows cols"]


def nearest(mask: Bool[np.ndarray, "rows cols"]) -> NearestCells:
    """Returns the nearest True cell of every cell.

    The mask must hold at least one True cell.
    """
    distance, marked = cv2.distanceTransformWithLabels(
        (~mask).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL
    )
    labels = np.asarray(marked, np.intp)
    rows, cols = np.nonzero(mask)
    row_of = np.zeros(int(labels.max()) + 1, np.intp)
    col_of = np.zeros_like(row_of)
    row_of[labels[rows, cols]], col_of[labels[rows, cols]] = rows, cols
    return NearestCells(np.asarray(distance, np.float32), row_of[labels], col_of[labels])


def connected(
    mask: Bool[np.ndarray, "rows cols"], row: int, col: int, *, connectivity: int
) -> Bool[np.ndarray, "rows cols"]:
    """Returns the connected part of a mask that contains a cell; empty when that cell is not in the mask."""
    if not mask[row, col]:
        return np.zeros_like(mask)
    image = mask.astype(np.uint8, order="C")  # a copy, which OpenCV fills
    cv2.floodFill(image, None, (int(col), int(row)), 2, flags=connectivity)
    return image == 2


def numbered_parts(
    mask: Bool[np.ndarray, "rows cols"],
) -> tuple[Int[np.ndarray, "rows cols"], Int[np.ndarray, " parts"]]:
    """Returns the number of each cell's 8-connected part, 0 outside the mask, and the number of cells of each part."""
    _, parts, stats, _ = cv2.connectedComponentsWithStats(np.ascontiguousarray(mask).view(np.uint8), connectivity=8)
    return np.asarray(parts, np.intp), np.asarray(stats)[:, cv2.CC_STAT_AREA].astype(np.intp)


def large_parts(mask: Bool[np.ndarray, "rows cols"], least_cells: float) -> Bool[np.ndarray, "rows cols"]:
    """Returns the mask without its 8-connected parts of fewer cells."""
    parts, sizes = numbered_parts(mask)
    large = sizes >= least_cells
    large[0] = False  # part 0 is the background
    return large[parts]


def sight_is_clear(
    blocked: Bool[np.ndarray, "rows cols"], starts: Cells, ends: Cells, edge_cells: float
) -> Bool[np.ndarray, " n"]:
    """Returns, for each pair of cells, whether the straight line between their centres crosses no blocked cell.

    The last `edge_cells` before the end do not count.
    """
    d_row, d_col = ends[0] - starts[0], ends[1] - starts[1]
    length = np.hypot(d_row, d_col)
    if length.size == 0:
        return np.zeros(0, np.bool_)
    samples = max(2, math.ceil(float(length.max()) * 1.5))
    share = np.linspace(0.0, 1.0, samples)[:, None] * np.maximum(0.0, 1.0 - edge_cells / np.maximum(length, 1e-9))
    rows = np.rint(starts[0] + share * d_row).astype(np.intp)
    cols = np.rint(starts[1] + share * d_col).astype(np.intp)
    return np.asarray(~blocked[rows, cols].any(axis=0))
