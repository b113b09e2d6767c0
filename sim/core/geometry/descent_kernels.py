"""The compiled loop that follows a field of distances down to its source."""

import numpy as np

from sim.core.geometry.compiling import njit


@njit(cache=True)
def descend(field_m, row, col):
    """Returns the cells (n, 2) from one cell to a local minimum, each the smallest neighbour of the one before.

    Among equal neighbours, the path takes the first one in the order of rows and columns.
    """
    rows, cols = field_m.shape
    path = np.empty((rows * cols, 2), np.int64)
    count = 0
    while True:
        path[count, 0], path[count, 1] = row, col
        count += 1
        best_m, best_row, best_col = field_m[row, col], row, col
        for near_row in range(max(row - 1, 0), min(row + 2, rows)):
            for near_col in range(max(col - 1, 0), min(col + 2, cols)):
                if field_m[near_row, near_col] < best_m:
                    best_m, best_row, best_col = field_m[near_row, near_col], near_row, near_col
        if best_row == row and best_col == col:
            return path[:count].copy()
        row, col = best_row, best_col
