"""Compiled loops over the cells of a grid near a convex polygon (`sim.core.geometry.convex`).

They have a module of their own because numba compiles them, so that their annotations cannot be checked at run time.
"""

import numpy as np

from sim.core.geometry.compiling import njit

BOUNDARY_M = 1e-9
"""Points outside by at most this much count as inside."""


@njit(cache=True)
def clear_near(free, x_m, y_m, vertices_m, normals, offsets_m, radius_m):
    """Sets cells of `free` to False where the centre is nearer to a polygon than `radius_m`.

    Args:
        free: (rows, cols) bool, is changed.
        x_m: (cols,) centres of the columns.
        y_m: (rows,) centres of the rows.
        vertices_m: (k, 2) of the polygon, counter-clockwise.
        normals: (k, 2) outward, of length 1.
        offsets_m: (k,) of the half planes `normals @ p <= offsets_m`.
        radius_m: distance below which a cell is not free.
    """
    count = len(vertices_m)
    for row in range(len(y_m)):
        for col in range(len(x_m)):
            if not free[row, col]:
                continue
            x, y = x_m[col], y_m[row]
            inside, beyond = True, False
            for k in range(count):
                outward_m = normals[k, 0] * x + normals[k, 1] * y - offsets_m[k]
                inside = inside and outward_m <= BOUNDARY_M
                beyond = beyond or outward_m > radius_m + BOUNDARY_M
            if inside:
                free[row, col] = False
            elif not beyond:
                free[row, col] = np.sqrt(_nearest_sq(x, y, vertices_m)) >= radius_m


@njit(cache=True)
def mark_inside(covered, x_m, y_m, normals, offsets_m):
    """Sets cells of `covered` (rows, cols) to True where the centre lies in a polygon; arguments as in `clear_near`."""
    for row in range(len(y_m)):
        for col in range(len(x_m)):
            inside = True
            for k in range(len(offsets_m)):
                inside = inside and normals[k, 0] * x_m[col] + normals[k, 1] * y_m[row] - offsets_m[k] <= BOUNDARY_M
            covered[row, col] = covered[row, col] or inside


@njit(cache=True)
def _nearest_sq(x, y, vertices_m):
    """Returns the squared distance from a point to the edges of a polygon."""
    best = np.inf
    count = len(vertices_m)
    for k in range(count):
        sx, sy = vertices_m[k, 0], vertices_m[k, 1]
        nxt = k + 1 if k + 1 < count else 0
        ex, ey = vertices_m[nxt, 0] - sx, vertices_m[nxt, 1] - sy
        ox, oy = x - sx, y - sy
        t = min(max((ox * ex + oy * ey) / (ex * ex + ey * ey), 0.0), 1.0)
        ox, oy = ox - t * ex, oy - t * ey
        best = min(best, ox * ox + oy * oy)
    return best
