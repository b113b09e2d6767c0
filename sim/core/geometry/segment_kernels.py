"""The compiled loop over the cells of `sim.core.geometry.grid.cells_near_segment`."""

import numpy as np

from sim.core.geometry.compiling import njit


@njit(cache=True)
def mask_near_segment(rows, cols, corner_x_m, corner_y_m, cell_m, start_x_m, start_y_m, end_x_m, end_y_m, radius_m):
    """Returns a mask (rows, cols) of the cells with their centre within `radius_m` of a segment."""
    inside = np.empty((rows, cols), np.bool_)
    dx, dy = end_x_m - start_x_m, end_y_m - start_y_m
    length_sq = dx * dx + dy * dy
    for row in range(rows):
        y_m = corner_y_m + (row + 0.5) * cell_m
        for col in range(cols):
            x_m = corner_x_m + (col + 0.5) * cell_m
            along = 0.0
            if length_sq > 0.0:
                along = min(max(((x_m - start_x_m) * dx + (y_m - start_y_m) * dy) / length_sq, 0.0), 1.0)
            gap_x_m, gap_y_m = x_m - start_x_m - along * dx, y_m - start_y_m - along * dy
            inside[row, col] = gap_x_m * gap_x_m + gap_y_m * gap_y_m <= radius_m * radius_m
    return inside
