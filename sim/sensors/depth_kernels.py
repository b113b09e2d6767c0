"""Compiled loops over the pixels of a depth image (`sim.sensors.depth_noise`)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.compiling import njit


@njit(cache=True, error_model="numpy")
def cast_shadows(depth_m: NDArray[np.float32], focal_baseline_px_m: np.float32, seen_m: NDArray[np.float32]) -> None:
    """Copies a depth image and sets the pixels that the right imager does not see to 0.

    Pixel x of the left image is at x - d in the right one, with the disparity d = focal length * baseline / z. It is
    hidden if a pixel farther right, on a nearer surface, is at the same place or to the left of it, and it is outside
    of the right image if x - d < -0.5. Pixels without return hide nothing.

    Args:
        depth_m: (h, w) in the left image, 0: no return.
        focal_baseline_px_m: focal length in pixels times the baseline in metres.
        seen_m: (h, w) is overwritten.
    """
    rows, cols = depth_m.shape
    nothing, half = np.float32(0.0), np.float32(0.5)
    for row in range(rows):
        values, result = depth_m[row], seen_m[row]
        leftmost = np.float32(math.inf)  # in the right image, of all pixels farther right in the left one
        for col in range(cols - 1, -1, -1):
            value = values[col]
            place = np.float32(col) - focal_baseline_px_m / value
            hidden = (place > leftmost - half) | (place < -half) | (value <= nothing)
            result[col] = nothing if hidden else value
            leftmost = min(leftmost, place if value > nothing else leftmost)


@njit(cache=True)
def shift_pixels(
    depth_m: NDArray[np.float32],
    levels: NDArray[np.uint16],
    pairs: NDArray[np.int16],
    shifted_m: NDArray[np.float32],
) -> None:
    """Fills an image with the depth at another place near each pixel; places outside are moved to the border.

    Args:
        depth_m: (h, w).
        levels: (h, w) random index into `pairs`.
        pairs: (n, 2) shift in columns and in rows.
        shifted_m: (h, w) is overwritten.
    """
    rows, cols = depth_m.shape
    for row in range(rows):
        for col in range(cols):
            level = levels[row, col]
            from_row = min(max(row + pairs[level, 1], 0), rows - 1)
            from_col = min(max(col + pairs[level, 0], 0), cols - 1)
            shifted_m[row, col] = depth_m[from_row, from_col]


@njit(cache=True)
def find_edges(
    near_m: NDArray[np.float32], far_m: NDArray[np.float32], jump_1_m: np.float32, found: NDArray[np.int64]
) -> int:
    """Finds the pixels with a jump of 1 / z in their neighbourhood; returns their number.

    Args:
        near_m: (n,) smallest depth of each neighbourhood; 0, no return, does not count as an edge.
        far_m: (n,) largest depth.
        jump_1_m: smallest difference of 1 / z.
        found: (n + 1,) the first entries become the indices of the edge pixels.
    """
    count = 0
    for pixel in range(near_m.size):
        near, far = near_m[pixel], far_m[pixel]
        found[count] = pixel  # without a branch: the next edge overwrites it
        count += (near > np.float32(0.0)) & (far - near > jump_1_m * near * far)
    return count


@njit(cache=True)
def make_holes(
    depth_m: NDArray[np.float32], geom: NDArray[np.int32], level: NDArray[np.float32], field: NDArray[np.float32]
) -> None:
    """Sets the depth to 0 where a random field is below the level of the geom that the pixel shows.

    Args:
        depth_m: (h, w) is changed.
        geom: (h, w) geom of each pixel, or -1.
        level: (ngeom + 1,) of each geom; the last entry is for -1.
        field: (h, w) or more rows and columns.
    """
    rows, cols = depth_m.shape
    last = level.size - 1
    for row in range(rows):
        values, ids, random = depth_m[row], geom[row], field[row]
        for col in range(cols):
            which = ids[col]
            limit = level[which if which >= 0 else last]
            values[col] = np.float32(0.0) if random[col] < limit else values[col]


@njit(cache=True, error_model="numpy")
def add_errors(
    depth_m: NDArray[np.float32],
    sums: NDArray[np.int32],
    scale: tuple[np.float32, np.float32],
    bias_1_m: NDArray[np.float32],
    std: tuple[np.float32, np.float32, np.float32],
    step_1_m: np.float32,
    limits_m: tuple[np.float32, np.float32],
) -> None:
    """Adds random and systematic errors to the distances and rounds them, in place.

    Pixels without return and pixels at or beyond the maximum do not change. A distance below the minimum becomes 0.

    Args:
        depth_m: (h, w).
        sums: (h, w) or larger, random sums; the inner (h, w) are used.
        scale: mean of the sums, and 1 / their standard deviation.
        bias_1_m: (h, w), is added to 1 / z.
        std: a, b and c of the standard deviation a + b (z - c)^2, metres.
        step_1_m: 1 / z becomes a multiple of this; 0: it is not rounded.
        limits_m: minimum and maximum.
    """
    rows, cols = depth_m.shape
    top, left = (sums.shape[0] - rows) // 2, (sums.shape[1] - cols) // 2
    mean, deviations = scale
    at_start, growth, start_m = std
    least_m, most_m = limits_m
    one, half, nothing = np.float32(1.0), np.float32(0.5), np.float32(0.0)
    steps = one / step_1_m if step_1_m > nothing else nothing
    for row in range(rows):
        values, errors, biases = depth_m[row], sums[row + top], bias_1_m[row]
        for col in range(cols):
            true_m = values[col]
            beyond = true_m - start_m
            normal = (np.float32(errors[col + left]) - mean) * deviations
            z_m = true_m + normal * (at_start + growth * beyond * beyond)
            inverse = one / max(z_m, least_m * half) + biases[col]
            if steps > nothing:
                inverse = np.floor(inverse * steps + half) * step_1_m
            z_m = one / inverse if inverse * most_m > one else most_m
            z_m = z_m if z_m >= least_m else nothing
            values[col] = true_m if (true_m <= nothing) | (true_m >= most_m) else z_m
