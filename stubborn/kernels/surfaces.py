"""Compiled functions that compute surfaces from a depth image.

They are in a module of their own because numba compiles them: their annotations cannot be checked at run time.
"""

import math

import numpy as np

from sim.core.geometry.compiling import njit


@njit(cache=True)
def fill_surface_channels(depth, focal_px, camera_height_m, max_depth_m, step, channels):
    """Fills the channels of `stubborn.segmentation.geometry` from a depth image.

    Args:
        depth: (rows, cols) metres along the optical axis; 0: no return.
        focal_px: focal length; the optical axis goes through the middle of the image.
        camera_height_m: height of the optical centre above the floor.
        max_depth_m: depths from here on are not valid.
        step: distance in pixels of the neighbours that give a normal.
        channels: (rows, cols, 6) float32; it is overwritten.
    """
    rows, cols = depth.shape
    middle_x, middle_y = 0.5 * cols, 0.5 * rows
    for row in range(rows):
        for col in range(cols):
            d = depth[row, col]
            up_m = (middle_y - row - 0.5) / focal_px * d
            here = channels[row, col]
            here[0] = 1.0 / d if d > 0.0 else 0.0
            here[1] = 1.0 if 0.0 < d < max_depth_m else 0.0
            here[2] = camera_height_m + up_m
            here[3] = here[4] = here[5] = 0.0
            if not 0.0 < d < max_depth_m:
                continue
            other_col = _nearest_neighbour(depth, row, col, 0, step, max_depth_m)
            other_row = _nearest_neighbour(depth, row, col, step, 0, max_depth_m)
            if other_col < 0 or other_row < 0:
                continue
            e, f = depth[row, other_col], depth[other_row, col]
            ax = ((other_col + 0.5 - middle_x) * e - (col + 0.5 - middle_x) * d) / focal_px
            ay = (middle_y - row - 0.5) * (e - d) / focal_px
            az = e - d
            bx = (col + 0.5 - middle_x) * (f - d) / focal_px
            by = ((middle_y - other_row - 0.5) * f - (middle_y - row - 0.5) * d) / focal_px
            bz = f - d
            nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            length = math.sqrt(nx * nx + ny * ny + nz * nz)
            if length == 0.0:
                continue
            towards = nx * (col + 0.5 - middle_x) + ny * (middle_y - row - 0.5) + nz * focal_px
            sign = -1.0 if towards > 0.0 else 1.0
            here[3], here[4], here[5] = sign * nx / length, sign * ny / length, sign * nz / length


@njit(cache=True)
def _nearest_neighbour(depth, row, col, down, right, max_depth_m):
    """Returns the row or column of the neighbour, of two opposite ones, that is nearer in depth; -1: none is valid."""
    rows, cols = depth.shape
    best, least = -1, np.inf
    for sign in (1, -1):
        r, c = row + sign * down, col + sign * right
        if r < 0 or r >= rows or c < 0 or c >= cols:
            continue
        d = depth[r, c]
        if 0.0 < d < max_depth_m and abs(d - depth[row, col]) < least:
            least = abs(d - depth[row, col])
            best = r if down else c
    return best
