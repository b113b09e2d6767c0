"""The compiled loops that sample surfaces and join spans of height (`sim.homes.plans.surfaces`)."""

import math

import numpy as np

from sim.core.geometry.compiling import njit


@njit(cache=True)
def merge_spans(cell, owner, low_m, high_m, gap_m):
    """Returns spans in which those of one cell and one owner that overlap, or nearly so, are one.

    Args:
        cell: (n,) cell of each span; spans of one cell, and in it of one owner, lie together, by rising `low_m`.
        owner: (n,) instance.
        low_m: (n,) lower ends.
        high_m: (n,) upper ends.
        gap_m: a smaller gap between two spans is closed.
    """
    out_cell, out_owner = np.empty_like(cell), np.empty_like(owner)
    out_low, out_high = np.empty_like(low_m), np.empty_like(high_m)
    last = -1
    for i in range(cell.size):
        if (
            last >= 0
            and out_cell[last] == cell[i]
            and out_owner[last] == owner[i]
            and low_m[i] <= out_high[last] + gap_m
        ):
            out_high[last] = max(out_high[last], high_m[i])
            continue
        last += 1
        out_cell[last], out_owner[last], out_low[last], out_high[last] = cell[i], owner[i], low_m[i], high_m[i]
    end = last + 1
    return out_cell[:end].copy(), out_owner[:end].copy(), out_low[:end].copy(), out_high[:end].copy()


@njit(cache=True)
def mark_triangles(triangles, step_m, marks):
    """Marks the boxes of a grid that hold a sample of the surface of some triangles.

    Args:
        triangles: (n, 3, 3) corners, counted in boxes of the grid, as row, column and height.
        step_m: largest gap between two samples, counted in boxes.
        marks: (rows, cols, heights) bool, is changed; samples beyond it do not count.
    """
    rows, cols, heights = marks.shape
    for n in range(triangles.shape[0]):
        a = triangles[n, 0]
        ux, uy, uz = triangles[n, 1, 0] - a[0], triangles[n, 1, 1] - a[1], triangles[n, 1, 2] - a[2]
        vx, vy, vz = triangles[n, 2, 0] - a[0], triangles[n, 2, 1] - a[1], triangles[n, 2, 2] - a[2]
        count_u = math.ceil(math.sqrt(ux * ux + uy * uy + uz * uz) / step_m) + 1
        count_v = math.ceil(math.sqrt(vx * vx + vy * vy + vz * vz) / step_m) + 1
        for i in range(count_u + 1):
            s = i / count_u
            for j in range(count_v + 1):
                t = j / count_v * (1.0 - s)
                row = math.floor(a[0] + s * ux + t * vx)
                col = math.floor(a[1] + s * uy + t * vy)
                height = math.floor(a[2] + s * uz + t * vz)
                if 0 <= row < rows and 0 <= col < cols and 0 <= height < heights:
                    marks[row, col, height] = True


@njit(cache=True)
def runs_of_marks(marks):
    """Returns (n, 4) the runs of marked boxes above each cell: row, column, first height, height behind the last."""
    rows, cols, heights = marks.shape
    runs = np.empty((rows * cols * (heights // 2 + 1), 4), np.int64)
    count = 0
    for row in range(rows):
        for col in range(cols):
            first = -1
            for height in range(heights + 1):
                here = height < heights and marks[row, col, height]
                if here and first < 0:
                    first = height
                elif not here and first >= 0:
                    runs[count, 0], runs[count, 1], runs[count, 2], runs[count, 3] = row, col, first, height
                    count += 1
                    first = -1
    return runs[:count].copy()
