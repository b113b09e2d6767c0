"""The compiled loop that computes distances to the obstacles of a plan (`sim.homes.plans.export`)."""

import numpy as np

from sim.core.geometry.compiling import njit


@njit(cache=True, error_model="numpy")
def lower_to_gap(gap_m, x_m, y_m, vertices_m, normals, offsets_m):
    """Lowers the values of a field to the distance of each cell's centre to a convex polygon, negative inside.

    Args:
        gap_m: (rows, cols) is changed.
        x_m: (cols,) centres of the columns.
        y_m: (rows,) centres of the rows.
        vertices_m: (k, 2) of the polygon, counter-clockwise.
        normals: (k, 2) outward, of length 1.
        offsets_m: (k,) of the half planes `normals @ p <= offsets_m`.
    """
    count = len(vertices_m)
    for row in range(len(y_m)):
        for col in range(len(x_m)):
            x, y = x_m[col], y_m[row]
            outward_m = -np.inf
            for k in range(count):
                outward_m = max(outward_m, normals[k, 0] * x + normals[k, 1] * y - offsets_m[k])
            if outward_m >= gap_m[row, col]:
                continue
            if outward_m > 0.0:
                nearest_sq = np.inf
                for k in range(count):
                    sx, sy = vertices_m[k, 0], vertices_m[k, 1]
                    following = k + 1 if k + 1 < count else 0
                    ex, ey = vertices_m[following, 0] - sx, vertices_m[following, 1] - sy
                    ox, oy = x - sx, y - sy
                    t = min(max((ox * ex + oy * ey) / (ex * ex + ey * ey), 0.0), 1.0)
                    ox, oy = ox - t * ex, oy - t * ey
                    nearest_sq = min(nearest_sq, ox * ox + oy * oy)
                outward_m = np.sqrt(nearest_sq)
            gap_m[row, col] = min(gap_m[row, col], outward_m)
