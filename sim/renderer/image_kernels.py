"""Compiled loops over the pixels of a frame buffer; its rows run from the bottom to the top."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.compiling import njit


@njit(cache=True)
def look_up_ids(color: NDArray[np.uint8], table: NDArray, image: NDArray) -> None:
    """Fills an image, the top row first, with the table's entries for the id colours of a frame buffer.

    Args:
        color: (h, w, 3) bottom row first; red is the low byte of the index, green the high byte.
        table: entry of each index.
        image: (h, w) of the table's dtype, is overwritten.
    """
    rows, cols = image.shape
    for row in range(rows):
        for col in range(cols):
            pixel = color[rows - 1 - row, col]
            image[row, col] = table[np.uint32(pixel[0]) | (np.uint32(pixel[1]) << np.uint32(8))]


@njit(cache=True, error_model="numpy")
def to_metres(
    raw: NDArray[np.float32],
    slope: np.float32,
    offset: np.float32,
    near_m: np.float32,
    far_m: np.float32,
    depth_m: NDArray[np.float32],
) -> None:
    """Fills an image in metres, the top row first, from a reversed depth buffer.

    Args:
        raw: (h, w) bottom row first; 1 is the near plane, 0 means that no geom was rendered.
        slope: the depth in metres is 1 / (slope * raw + offset).
        offset: see `slope`.
        near_m: smaller depths become 0.
        far_m: larger depths become this.
        depth_m: (h, w) is overwritten.
    """
    rows, cols = depth_m.shape
    nothing = np.float32(0.0)
    for row in range(rows):
        values, result = raw[rows - 1 - row], depth_m[row]
        for col in range(cols):  # without a branch, so that it is vectorised
            value = values[col]
            metres = np.float32(1.0) / (value * slope + offset)
            metres = metres if metres < far_m else far_m
            result[col] = metres if (metres >= near_m) & (value > nothing) else nothing
