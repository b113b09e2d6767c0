"""The compiled loop of `stubborn.mapping.levelling`.

It is in a module of its own because numba compiles it: its annotations cannot be checked at run time.
"""

from __future__ import annotations

import numpy as np

from sim.core.geometry.compiling import njit


@njit(cache=True)
def level_depth(depth, source_row, source_col, ahead, far_m, jump_1_m, level):
    """Fills a depth image of a level camera from that of a leaning one.

    Where the four pixels around a point lie on one surface, 1 / depth is interpolated, which is exact on a plane;
    elsewhere the nearest pixel counts, so that no point appears between two surfaces.

    Args:
        depth: (rows, cols) float32 metres along the axis of the leaning camera; 0: no return, `far_m`: at least this.
        source_row: (rows, cols) float32 row of each pixel of the level image in the leaning one; also `source_col`.
        ahead: (rows, cols) float32 depth in the leaning camera by that in the level one.
        far_m: float32, the largest depth.
        jump_1_m: float32, largest difference in 1 / depth on one surface.
        level: (rows, cols) float32; it is overwritten, with 0 outside of the leaning image.
    """
    rows, cols = depth.shape
    for r in range(rows):
        for c in range(cols):
            y, x = source_row[r, c], source_col[r, c]
            near_row, near_col = int(np.rint(y)), int(np.rint(x))
            if not (0 <= near_row < rows and 0 <= near_col < cols and ahead[r, c] > 0.0):
                level[r, c] = 0.0
                continue
            d = depth[near_row, near_col]
            if not 0.0 < d < far_m:
                level[r, c] = d
                continue
            r0, c0 = int(np.floor(y)), int(np.floor(x))
            if 0 <= r0 < rows - 1 and 0 <= c0 < cols - 1:
                a, b, e, f = depth[r0, c0], depth[r0, c0 + 1], depth[r0 + 1, c0], depth[r0 + 1, c0 + 1]
                low, high = min(min(a, b), min(e, f)), max(max(a, b), max(e, f))
                if low > 0.0 and high < far_m and high - low < jump_1_m * low * high:
                    down, right = y - r0, x - c0
                    top = (1.0 - right) / a + right / b
                    bottom = (1.0 - right) / e + right / f
                    d = 1.0 / ((1.0 - down) * top + down * bottom)
            level[r, c] = min(d / ahead[r, c], far_m)
