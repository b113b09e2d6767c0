"""The compiled loops of the robot in a plan: a straight move that the border of the free space stops, and its trail."""

import math

from sim.core.geometry.compiling import njit


@njit(cache=True, error_model="numpy")
def advance(slack_m, row, col, d_row, d_col, steps):
    """Returns how many of some steps in one direction keep the robot in the free space.

    A robot that is already outside may move on while it does not get farther out.

    Args:
        slack_m: (rows, cols) distance of cell centres to the border of the free space, positive inside.
        row: of the robot, with fraction; the centre of cell (0, 0) is at (0.5, 0.5).
        col: the same.
        d_row: rows that a step adds.
        d_col: the same.
        steps: number of steps.
    """
    here_m = interpolate(slack_m, row, col)
    for step in range(steps):
        row += d_row
        col += d_col
        there_m = interpolate(slack_m, row, col)
        if there_m < 0.0 and there_m < here_m:
            return step
        here_m = there_m
    return steps


@njit(cache=True, error_model="numpy")
def interpolate(field, row, col):
    """Returns the bilinear value of a field between cell centres; that of the nearest cell beyond its border."""
    rows, cols = field.shape
    r, c = min(max(row - 0.5, 0.0), rows - 1.001), min(max(col - 0.5, 0.0), cols - 1.001)
    i, j = int(r), int(c)
    s, t = r - i, c - j
    upper = field[i, j] * (1.0 - t) + field[i, j + 1] * t
    lower = field[i + 1, j] * (1.0 - t) + field[i + 1, j + 1] * t
    return upper * (1.0 - s) + lower * s


@njit(cache=True, error_model="numpy")
def mark_swept(layer, row_0, col_0, row_1, col_1, radius):
    """Sets the cells of a layer with their centre within `radius` cells of a segment, given as rows and columns."""
    d_row, d_col = row_1 - row_0, col_1 - col_0
    length_sq = d_row * d_row + d_col * d_col
    limit = radius * radius
    top, bottom = math.floor(min(row_0, row_1) - radius), math.floor(max(row_0, row_1) + radius)
    first, last = math.floor(min(col_0, col_1) - radius), math.floor(max(col_0, col_1) + radius)
    for row in range(max(top, 0), min(bottom + 1, layer.shape[0])):
        for col in range(max(first, 0), min(last + 1, layer.shape[1])):
            y, x = row + 0.5 - row_0, col + 0.5 - col_0
            along = 0.0
            if length_sq > 0.0:
                along = min(max((y * d_row + x * d_col) / length_sq, 0.0), 1.0)
            y, x = y - along * d_row, x - along * d_col
            if y * y + x * x <= limit:
                layer[row, col] = True


@njit(cache=True, error_model="numpy")
def mark_square(layer, row, col, cos, sin, near, edge):
    """Sets the cells of a layer with their centre in a square ahead of a pose (`square_ahead` of the agent).

    Args:
        layer: (rows, cols) bool, is changed.
        row: of the pose, with fraction.
        col: the same.
        cos: of the heading.
        sin: the same.
        near: cells from the pose to the near edge.
        edge: cells along an edge.
    """
    reach = near + 1.5 * edge
    for r in range(max(int(row - reach), 0), min(int(row + reach) + 1, layer.shape[0])):
        for c in range(max(int(col - reach), 0), min(int(col + reach) + 1, layer.shape[1])):
            y, x = r + 0.5 - row, c + 0.5 - col
            ahead, left = cos * x + sin * y, cos * y - sin * x
            if near <= ahead <= near + edge and abs(left) <= 0.5 * edge:
                layer[r, c] = True
