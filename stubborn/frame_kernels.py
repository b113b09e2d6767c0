"""Compiled loops over the pixels of one frame, for `stubborn.mapping`: surfaces, ground points, scores of cells.

They are apart from their users because numba compiles them, so that no annotation of theirs can be checked at run time.
Sums are in float32 and in a fixed order, because maps, and so the agent's path, depend on the last digit.
"""

from __future__ import annotations

import numpy as np
from numba import njit

_PAIRS = ((1, 0), (0, 1), (1, 1), (1, -1))
"""Rows and columns to one of two opposite neighbours."""


@njit(cache=True)
def smooth_surfaces(depth, jump_1_m, every, change, count):
    """Computes the mean of each pixel and those of its eight neighbours that lie on one surface with it.

    Args:
        depth: (rows, cols) float32 metres; 0: no distance.
        jump_1_m: float32, largest difference in 1 / depth between neighbours on one surface.
        every: only every so many rows and columns are computed.
        change: (rows / every, cols / every) float32, is set to the mean less the pixel itself.
        count: the same shape, uint8, is set to the number of those neighbours.
    """
    rows, cols = depth.shape
    for i in range(count.shape[0]):
        for j in range(count.shape[1]):
            r, c = i * every, j * every
            d = depth[r, c]
            total, found = d, 0
            for k in range(4):
                dr, dc = _PAIRS[k]
                for side in (-1, 1):
                    nr, nc = r + side * dr, c + side * dc
                    if nr < 0 or nr >= rows or nc < 0 or nc >= cols:
                        continue
                    near = depth[nr, nc]
                    gap = near - d
                    # |1/a - 1/b| < jump, without a division; never true where one of them is 0. Both pixels of a pair
                    # round the same product, so that they agree.
                    later, earlier = (near, d) if side > 0 else (d, near)
                    if abs(gap) < (later * jump_1_m) * earlier:
                        total += gap
                        found += 1
            count[i, j] = found
            change[i, j] = (total - d) / (np.float32(found) + np.float32(1.0))


@njit(cache=True)
def ground_points(
    depth, confirmed, x_slope, y_slope, x_cells, y_cells, up, camera_m, near_m, far_m, valid, rows, cols, height_m
):
    """Projects depth pixels onto the ground and returns their number; see `stubborn.mapping.projection`.

    Args:
        depth: (h, w) float32 metres along the optical axis.
        confirmed: (h, w) bool; other pixels are left out, and so are those nearer than `near_m` or not below `far_m`.
        x_slope: (w,) columns of the grid per metre of depth; also `y_slope`, rows.
        x_cells: column of the camera, not rounded; also `y_cells`, its row.
        up: (h,) rise per metre of depth.
        camera_m: height of the camera.
        valid: (h, w) bool, is set to the pixels that count.
        rows: (h * w,) int32, its beginning is set to the row of each of them; also `cols` and `height_m`.
    """
    n = 0
    for r in range(depth.shape[0]):
        for c in range(depth.shape[1]):
            d = depth[r, c]
            counts = confirmed[r, c] and d >= near_m and d < far_m
            valid[r, c] = counts
            if counts:
                cols[n] = np.int32(d * x_slope[c] + x_cells)  # positive, so truncation is floor
                rows[n] = np.int32(d * y_slope[c] + y_cells)
                height_m[n] = d * up[r] + camera_m
                n += 1
    return n


@njit(cache=True)
def highest_scores(flat, target, other, in_view, target_of, other_of):
    """Reduces pixels to cells: the highest target score, and the highest other score where the target's is highest.

    Args:
        flat: (n,) row-major cell of each pixel.
        target: (n,) float32 score of the target; also `other`, the highest of any other category.
        in_view: (cells,) bool, is set to True where a pixel lies.
        target_of: (cells,) float32 zeros, is set to the highest target score.
        other_of: (cells,) float32 zeros, is set to the highest other score of the pixels with that target score.
    """
    for i in range(flat.size):
        in_view[flat[i]] = True
        if target[i] > target_of[flat[i]]:
            target_of[flat[i]] = target[i]
    for i in range(flat.size):
        if target[i] == target_of[flat[i]] and other[i] > other_of[flat[i]]:
            other_of[flat[i]] = other[i]


@njit(cache=True)
def goal_bits(posteriors, channels, first, every, least):
    """Returns a uint32 image (rows / every, cols / every) with bit g where goal category g is probable.

    Args:
        posteriors: (classes, rows, cols) float32.
        channels: (goals,) the channel of each goal category.
        first: the first row and column that is used; then every `every`-th.
        every: see above.
        least: a probability above this sets the bit.
    """
    _, rows, cols = posteriors.shape
    bits = np.zeros(((rows - first + every - 1) // every, (cols - first + every - 1) // every), np.uint32)
    for goal in range(channels.size):
        bit, channel = np.uint32(1) << np.uint32(goal), posteriors[channels[goal]]
        for i in range(bits.shape[0]):
            for j in range(bits.shape[1]):
                if channel[first + i * every, first + j * every] > least:
                    bits[i, j] |= bit
    return bits
