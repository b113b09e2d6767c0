"""The loops of `sim.renderer.occlusion`, compiled by numba; all bounds are conservative.

Upright boxes are given as their arrays (`sim.renderer.upright_boxes`): centre (n, 2), axis (n, 2), half (n, 2), bottom
(n,), top (n,). A yaw is its cosine and sine. Edges (strips + 1,) are slopes to the right.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.compiling import njit

Floats = NDArray[np.float64]


@njit(cache=True, error_model="numpy")
def crossing(
    centre: Floats, axis: Floats, half: Floats, box: int, eye_m: Floats, ray_x: float, ray_y: float
) -> tuple[float, float]:
    """Returns where a ray in plan from the eye enters and leaves a box, in lengths of the ray.

    The ray misses the box where it leaves before it enters. A ray parallel to a side is turned by a tiny angle, so that
    it still crosses the box.
    """
    ax, ay = axis[box, 0], axis[box, 1]
    ox, oy = centre[box, 0] - eye_m[0], centre[box, 1] - eye_m[1]
    slope, slope2 = ax * ray_x + ay * ray_y, ax * ray_y - ay * ray_x
    along = 1.0 / (slope if abs(slope) >= 1e-12 else 1e-12)
    across = 1.0 / (slope2 if abs(slope2) >= 1e-12 else 1e-12)
    middle, width = (ax * ox + ay * oy) * along, half[box, 0] * abs(along)
    middle2, width2 = (ax * oy - ay * ox) * across, half[box, 1] * abs(across)
    return max(middle - width, middle2 - width2), min(middle + width, middle2 + width2)


@njit(cache=True, error_model="numpy")
def nearest_walls(
    centre: Floats,
    axis: Floats,
    half: Floats,
    eye_m: Floats,
    yaw: tuple[float, float],
    edges: Floats,
    right_max: float,
    least_m: float,
) -> tuple[Floats, NDArray[np.intp]]:
    """Returns the depth (strips,) at which the nearest wall blocks a strip, and its index; inf and 0 without one.

    A wall counts where both edge rays of the strip enter it farther than `least_m`. Walls that lie completely outside
    the field of view are skipped; `right_max` is the slope of its half width.
    """
    c, s = yaw
    strips = len(edges) - 1
    depth_m, wall = np.full(strips, np.inf), np.zeros(strips, np.intp)
    reach = math.hypot(1.0, right_max)
    for box in range(len(centre)):
        dx, dy = centre[box, 0] - eye_m[0], centre[box, 1] - eye_m[1]
        radius = math.hypot(half[box, 0], half[box, 1])
        depth = c * dx + s * dy
        if depth <= -radius or abs(s * dx - c * dy) >= right_max * depth + reach * radius:
            continue
        last = np.inf
        for i in range(strips + 1):
            entry, leave = crossing(centre, axis, half, box, eye_m, c + s * edges[i], s - c * edges[i])
            entry = entry if least_m < entry <= leave else np.inf
            if i and max(last, entry) < depth_m[i - 1]:
                depth_m[i - 1], wall[i - 1] = max(last, entry), box
            last = entry
    return depth_m, wall


@njit(cache=True, error_model="numpy")
def open_past_slabs(
    centre: Floats,
    axis: Floats,
    half: Floats,
    bottom: Floats,
    top: Floats,
    eye_m: Floats,
    yaw: tuple[float, float],
    edges: Floats,
    least_m: float,
    slack: float,
    low_m: Floats,
    high_m: Floats,
    low: Floats,
    high: Floats,
) -> None:
    """Opens strips downwards or upwards without end where a floor below, or a ceiling above, reaches past their wall.

    Args:
        least_m: slabs nearer than this to the eye do not count.
        slack: the slab must reach past the edge of the wall by this slope.
        low_m: (strips,) lower edge of the wall above the eye; also `high_m`, the upper one.
        low: (strips,) its slope, becomes -inf where a floor reaches past it; also `high`, inf for a ceiling.
    """
    c, s = yaw
    for box in range(len(centre)):
        dx, dy = eye_m[0] - centre[box, 0], eye_m[1] - centre[box, 1]
        if abs(axis[box, 0] * dx + axis[box, 1] * dy) >= half[box, 0]:
            continue
        if abs(axis[box, 0] * dy - axis[box, 1] * dx) >= half[box, 1]:
            continue
        above = bottom[box] > eye_m[2] + least_m
        if not (above or top[box] < eye_m[2] - least_m):
            continue
        face_m = bottom[box] - eye_m[2] if above else top[box] - eye_m[2]
        last = np.inf
        for i in range(len(edges)):
            _, leave = crossing(centre, axis, half, box, eye_m, c + s * edges[i], s - c * edges[i])
            slope = face_m / min(last, leave)
            if i and above and face_m <= high_m[i - 1] and slope < high[i - 1] - slack:
                high[i - 1] = np.inf
            if i and not above and face_m >= low_m[i - 1] and slope > low[i - 1] + slack:
                low[i - 1] = -np.inf
            last = leave


@njit(cache=True, error_model="numpy")
def may_be_seen(
    corners: Floats,
    bounded: NDArray[np.bool_],
    eye_m: Floats,
    yaw: tuple[float, float],
    near_m: float,
    right_max: float,
    up_max: float,
    strip: float,
    slack: float,
    slack_m: float,
    wall_m: Floats,
    low: Floats,
    high: Floats,
) -> NDArray[np.bool_]:
    """Returns (n,) False for geoms that are outside the view or have their bounding box behind the walls.

    Args:
        corners: (n, 8, 3) of the bounding boxes, in the world.
        bounded: (n,) False for geoms that may always be seen.
        eye_m: (3,) optical centre.
        yaw: heading.
        near_m: depth of the near plane.
        right_max: slope of the right edge of the image; also `up_max`, of its upper edge.
        strip: width of a strip as a slope.
        slack: geoms are grown by this slope.
        slack_m: a hidden geom is farther than the wall by this.
        wall_m: (strips,) depth of the walls, with the slopes `low` and `high` of their edges.
    """
    c, s = yaw
    n, strips = len(corners), len(wall_m)
    limit_u, limit_v = right_max + slack, up_max + slack
    seen = np.ones(n, np.bool_)
    depth, right, up = np.empty(8), np.empty(8), np.empty(8)
    for geom in range(n):
        if not bounded[geom]:
            continue
        before = beyond_right = beyond_left = beyond_top = beyond_bottom = True
        nearest = np.inf
        for k in range(8):
            x, y, z = corners[geom, k, 0] - eye_m[0], corners[geom, k, 1] - eye_m[1], corners[geom, k, 2] - eye_m[2]
            d, r = c * x + s * y, s * x - c * y
            depth[k], right[k], up[k] = d, r, z
            nearest = min(nearest, d)
            before &= d < 0.99 * near_m
            beyond_right &= r > limit_u * d
            beyond_left &= r < -limit_u * d
            beyond_top &= z > limit_v * d
            beyond_bottom &= z < -limit_v * d
        if before or beyond_right or beyond_left or beyond_top or beyond_bottom:
            seen[geom] = False
            continue
        if nearest <= near_m:  # slopes are meaningful only for geoms completely in front of the eye
            continue
        u0 = v0 = np.inf
        u1 = v1 = -np.inf
        for k in range(8):
            u, v = right[k] / depth[k], up[k] / depth[k]
            u0, u1, v0, v1 = min(u0, u), max(u1, u), min(v0, v), max(v1, v)
        first = int(min(max(math.floor((u0 - slack + right_max) / strip), 0.0), strips - 1.0))
        last = int(min(max(math.floor((u1 + slack + right_max) / strip), 0.0), strips - 1.0))
        top, bottom = min(v1, up_max) + slack, max(v0, -up_max) - slack
        behind = True
        for i in range(first, last + 1):
            behind &= nearest > wall_m[i] + slack_m and top < high[i] and bottom > low[i]
        seen[geom] = not behind
    return seen


@njit(cache=True, error_model="numpy")
def hidden_by_strip(
    chosen: NDArray[np.intp],
    centre: Floats,
    axis: Floats,
    half: Floats,
    bottom: Floats,
    top: Floats,
    eye_m: Floats,
    yaw: tuple[float, float],
    edges: Floats,
    right_max: float,
    up_max: float,
    strip: float,
    slack: float,
    slack_m: float,
    wall_m: Floats,
    low: Floats,
    high: Floats,
) -> NDArray[np.bool_]:
    """Returns (k,) True for a chosen box if its part in each strip is behind the wall of that strip.

    The part of a convex outline in a strip has its corners where the edges of the strip enter the outline, and at the
    corners of the outline. The other arguments are those of `may_be_seen`.
    """
    c, s = yaw
    strips = len(wall_m)
    hidden = np.ones(len(chosen), np.bool_)
    near = np.empty(strips)  # depth of the nearest corner of the outline in each strip; inf without one
    for k in range(len(chosen)):
        box = chosen[k]
        rise, drop = max(top[box] - eye_m[2], 0.0), min(bottom[box] - eye_m[2], 0.0)
        near[:] = np.inf
        first, last = strips, -1  # the strips that the box may reach
        for corner in range(4):
            along, across = (
                half[box, 0] * (corner >> 1) * 2 - half[box, 0],
                half[box, 1] * (corner & 1) * 2 - half[box, 1],
            )
            dx = centre[box, 0] + axis[box, 0] * along - axis[box, 1] * across - eye_m[0]
            dy = centre[box, 1] + axis[box, 1] * along + axis[box, 0] * across - eye_m[1]
            depth = c * dx + s * dy
            if depth <= 0.0:
                first, last = 0, strips - 1
                continue
            u = (s * dx - c * dy) / depth
            for grown in (-slack, slack):
                at = math.floor((u + grown + right_max) / strip)
                first, last = int(max(min(first, at), 0.0)), int(min(max(last, at), strips - 1.0))
                if 0 <= at < strips:
                    near[int(at)] = min(near[int(at)], depth)
        entry = (
            _entry(centre, axis, half, box, eye_m, c + s * edges[first], s - c * edges[first]) if last >= first else 0.0
        )
        for i in range(first, last + 1):
            next_entry = _entry(centre, axis, half, box, eye_m, c + s * edges[i + 1], s - c * edges[i + 1])
            nearest = min(near[i], min(entry, next_entry))
            entry = next_entry
            if nearest == np.inf:  # the box does not reach this strip
                continue
            behind = nearest > wall_m[i] + slack_m
            behind &= min(rise / nearest, up_max) + slack < high[i]
            behind &= max(drop / nearest, -up_max) - slack > low[i]
            if not behind:
                hidden[k] = False
                break
    return hidden


@njit(cache=True, error_model="numpy")
def _entry(centre: Floats, axis: Floats, half: Floats, box: int, eye_m: Floats, ray_x: float, ray_y: float) -> float:
    """Returns where a ray enters a box; inf where it misses it, or the box is behind the eye."""
    entry, leave = crossing(centre, axis, half, box, eye_m, ray_x, ray_y)
    return entry if entry <= leave and leave >= 0.0 else np.inf
