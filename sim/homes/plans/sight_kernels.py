"""The compiled loops of the camera in a plan (`sim.homes.plans.sight`): rays through the grid, and the map that they
draw.

An image column is a vertical plane. Its ray runs through the cells of the plan, and a set of bits says which rows of
the image are still open, that is, not hidden by what the ray has met so far. A span of height covers the rows between
its lower and its upper edge; those still open see it, and are closed. The rows lie in two words of 64 bits.

The agent enters obstacles at twice the resolution of scores. Of a surface that is seen at a flat angle, such as a table
top, the cells between two rows are obstacles too where they cover one of the rows a quarter above and below each row.
"""

import math

import numpy as np
from numba import types
from numba.extending import intrinsic

from sim.core.geometry.compiling import njit

IN_VIEW = 1
TARGET = 2
SOLID = 4
AT_EYE_LEVEL = 8


@intrinsic
def _ones(typing_context, word):
    """Returns the number of set bits of a word."""

    def generate(context, builder, signature, arguments):
        return builder.ctpop(arguments[0])

    return types.uint64(types.uint64), generate


@njit(cache=True, error_model="numpy")
def _bits(first, last):
    """Returns a word with the bits from `first` to `last` set, both in 0 to 63; 0 for an empty range."""
    first, last = max(first, 0), min(last, 63)
    if first > last:
        return np.uint64(0)
    return (np.uint64(0xFFFFFFFFFFFFFFFF) >> np.uint64(63 - (last - first))) << np.uint64(first)


@njit(cache=True, error_model="numpy")
def cast_rays(
    span_start, span_low_m, span_high_m, span_goal, floor, ceiling_m, cell_m, place, left, up, camera, bands, goal,
    map_pose, map_cell_m, flags, touched, seen_floor, goals_seen, pixels,
):  # fmt: skip
    """Looks once; returns the number of map cells in `touched`, and of newly seen floor cells.

    Args:
        span_start: (cells + 1,) see `sim.homes.plans.plan.Plan`, as the next three.
        span_low_m: (spans,)
        span_high_m: (spans,)
        span_goal: (spans,) goal category of each span; -1: none.
        floor: (rows, cols) True: floor.
        ceiling_m: height of the ceiling.
        cell_m: edge of a cell of the plan.
        place: camera in the plan: row and column with fractions, cosine and sine of the heading.
        left: (columns,) metres to the left per metre of depth.
        up: (rows,) rise per metre of depth, decreasing in even steps from the top of the image; at most 128.
        camera: height, least and largest depth of a distance, in metres.
        bands: heights in metres: lowest and highest of an obstacle, highest of a point in view, half width of the
            eye level.
        goal: the goal category; -2: none.
        map_pose: camera in the map: row and column with fractions, cosine and sine of the heading.
        map_cell_m: edge of a cell of the map.
        flags: (rows, cols) uint8 of the map; gets the flags of this module. It must be 0 everywhere.
        touched: (n,) int32, gets the row-major map cells with flags other than 0.
        seen_floor: (rows, cols) bool of the plan; gets True where the floor is in view.
        goals_seen: (rows, cols) uint32 of the map; gets bit g where goal category g is in view.
        pixels: (goals,) gets the number of pixels of each goal category added.
    """
    rows, cols = floor.shape
    map_rows, map_cols = flags.shape
    height_m, near_m, far_m = camera[0], camera[1], camera[2]
    low_band_m, high_band_m, top_m, eye_m = bands[0] - height_m, bands[1] - height_m, bands[2] - height_m, bands[3]
    image_rows, up_0, per_row = up.size, up[0], 1.0 / (up[0] - up[1])
    horizon = 0  # the first row that looks down
    while horizon < image_rows and up[horizon] >= 0.0:
        horizon += 1
    plane_m = np.empty(image_rows + 1)  # depth at which each row meets the floor or the ceiling
    for at in range(image_rows):
        plane_m[at] = ((ceiling_m - height_m) if at < horizon else -height_m) / up[at]
    per_m = 1.0 / map_cell_m
    count, new_floor = 0, 0
    for column in range(left.size):
        x_step = (place[2] - place[3] * left[column]) / cell_m
        y_step = (place[3] + place[2] * left[column]) / cell_m
        map_x_step = (map_pose[2] - map_pose[3] * left[column]) * per_m
        map_y_step = (map_pose[3] + map_pose[2] * left[column]) * per_m
        row, col = math.floor(place[0]), math.floor(place[1])
        d_row, d_col = (1 if y_step > 0.0 else -1), (1 if x_step > 0.0 else -1)
        x_every = abs(1.0 / x_step) if x_step != 0.0 else np.inf
        y_every = abs(1.0 / y_step) if y_step != 0.0 else np.inf
        x_next = (col + 1 - place[1] if x_step > 0.0 else place[1] - col) * x_every if x_step != 0.0 else np.inf
        y_next = (row + 1 - place[0] if y_step > 0.0 else place[0] - row) * y_every if y_step != 0.0 else np.inf
        open_0, open_1 = _bits(0, image_rows - 1), _bits(0, image_rows - 65)
        floor_row, ceiling_row = image_rows - 1, 0
        floor_depth_m, ceiling_depth_m = plane_m[floor_row], plane_m[0]
        enter_m = 0.02
        while 0 <= row < rows and 0 <= col < cols:
            leave_m = min(x_next, y_next)
            if leave_m > enter_m:
                cell = row * cols + col
                first, last = span_start[cell], span_start[cell + 1]
                middle_m = 0.5 * (enter_m + leave_m)
                if first < last:
                    near_1m, far_1m = 1.0 / enter_m, 1.0 / leave_m
                    for span in range(first, last):
                        high_m, low_m = span_high_m[span] - height_m, span_low_m[span] - height_m
                        rise_high = high_m * (near_1m if high_m > 0.0 else far_1m)
                        rise_low = low_m * (far_1m if low_m > 0.0 else near_1m)
                        top = max(math.ceil((up_0 - min(rise_high, 10.0)) * per_row), 0)
                        bottom = min(math.floor((up_0 - max(rise_low, -10.0)) * per_row), image_rows - 1)
                        new_0, new_1 = _bits(top, bottom) & open_0, _bits(top - 64, bottom - 64) & open_1
                        if (new_0 | new_1) == 0:
                            if not (low_band_m <= high_m < 0.0 and near_m <= middle_m < far_m):
                                continue
                            between = math.ceil(2.0 * (up_0 - rise_high) * per_row + 0.5)
                            at = (between - 1) // 2  # the row above it
                            if between > 2.0 * (up_0 - high_m * near_1m) * per_row + 0.5 or not 0 <= at < image_rows:
                                continue
                            if (_bits(at, at) & open_0) | (_bits(at - 64, at - 64) & open_1):
                                map_row = math.floor(map_pose[0] + middle_m * map_y_step)
                                map_col = math.floor(map_pose[1] + middle_m * map_x_step)
                                if 0 <= map_row < map_rows and 0 <= map_col < map_cols:
                                    if flags[map_row, map_col] == 0:
                                        touched[count] = map_row * map_cols + map_col
                                        count += 1
                                    flags[map_row, map_col] |= SOLID
                            continue
                        open_0, open_1 = open_0 & ~new_0, open_1 & ~new_1
                        category = span_goal[span]
                        if category >= 0:
                            pixels[category] += _ones(new_0) + _ones(new_1)  # type: ignore[call-arg]
                        if not near_m <= middle_m < far_m:
                            continue
                        map_row = math.floor(map_pose[0] + middle_m * map_y_step)
                        map_col = math.floor(map_pose[1] + middle_m * map_x_step)
                        if not (0 <= map_row < map_rows and 0 <= map_col < map_cols):
                            continue
                        flag, rows_per_m = 0, per_row / middle_m
                        top = math.ceil(up_0 * per_row - top_m * rows_per_m)
                        if (_bits(top, 63) & new_0) | (_bits(top - 64, 63) & new_1):
                            flag = IN_VIEW
                            if category == goal:
                                flag |= TARGET
                            if category >= 0:
                                goals_seen[map_row, map_col] |= np.uint32(1) << np.uint32(category)
                        top = math.ceil(up_0 * per_row - high_band_m * rows_per_m)
                        bottom = math.floor(up_0 * per_row - low_band_m * rows_per_m)
                        if (_bits(top, bottom) & new_0) | (_bits(top - 64, bottom - 64) & new_1):
                            flag |= SOLID
                        top = math.ceil(up_0 * per_row - eye_m * rows_per_m)
                        bottom = math.floor(up_0 * per_row + eye_m * rows_per_m)
                        if (_bits(top, bottom) & new_0) | (_bits(top - 64, bottom - 64) & new_1):
                            flag |= AT_EYE_LEVEL
                        if flag and flags[map_row, map_col] == 0:
                            touched[count] = map_row * map_cols + map_col
                            count += 1
                        flags[map_row, map_col] |= flag
                if floor[row, col] and not seen_floor[row, col] and near_m < middle_m <= far_m:
                    at = math.floor((up_0 + height_m / middle_m) * per_row)  # nearer rows are closed
                    if horizon <= at < image_rows and (_bits(at, at) & open_0) | (_bits(at - 64, at - 64) & open_1):
                        seen_floor[row, col] = True
                        new_floor += 1
                while floor_depth_m <= leave_m:
                    here_0, here_1 = (
                        _bits(floor_row, floor_row) & open_0,
                        _bits(floor_row - 64, floor_row - 64) & open_1,
                    )
                    if here_0 | here_1:
                        open_0, open_1 = open_0 & ~here_0, open_1 & ~here_1
                        if floor[row, col] and near_m <= floor_depth_m < far_m:
                            map_row = math.floor(map_pose[0] + floor_depth_m * map_y_step)
                            map_col = math.floor(map_pose[1] + floor_depth_m * map_x_step)
                            if 0 <= map_row < map_rows and 0 <= map_col < map_cols:
                                if flags[map_row, map_col] == 0:
                                    touched[count] = map_row * map_cols + map_col
                                    count += 1
                                flags[map_row, map_col] |= IN_VIEW
                    floor_row -= 1
                    floor_depth_m = plane_m[floor_row] if floor_row >= horizon else np.inf
                while ceiling_depth_m <= leave_m:
                    open_0 &= ~_bits(ceiling_row, ceiling_row)
                    open_1 &= ~_bits(ceiling_row - 64, ceiling_row - 64)
                    ceiling_row += 1
                    ceiling_depth_m = plane_m[ceiling_row] if ceiling_row < horizon else np.inf
                if (open_0 | open_1) == 0:
                    break
                enter_m = leave_m
            if x_next < y_next:
                x_next += x_every
                col += d_col
            else:
                y_next += y_every
                row += d_row
    return count, new_floor


@njit(cache=True, error_model="numpy")
def enter_frame(
    flags, touched, count, frames_in_view, obstacle_evidence, seen_obstacle, seen_at_eye_level, score_max, hit, most,
    obstacle_from,
):  # fmt: skip
    """Enters the flags of one frame into the layers of a map, sets the flags to 0, and returns the touched rectangle.

    Args:
        flags: (rows, cols) of `cast_rays`.
        touched: (n,) the cells with flags other than 0.
        count: number of them.
        frames_in_view: (rows, cols) layers of `stubborn.mapping.navmap.NavMap`, as the next four.
        obstacle_evidence: see above.
        seen_obstacle: see above.
        seen_at_eye_level: see above.
        score_max: see above.
        hit: evidence that a frame adds.
        most: limit of the evidence.
        obstacle_from: evidence that makes an obstacle.

    Returns:
        The first and last row and column of the touched cells; the last ones are -1 without such a cell.
    """
    cols = flags.shape[1]
    row_0, row_1, col_0, col_1 = flags.shape[0], -1, cols, -1
    for i in range(count):
        row, col = touched[i] // cols, touched[i] % cols
        flag = flags[row, col]
        flags[row, col] = 0
        row_0, row_1, col_0, col_1 = min(row_0, row), max(row_1, row), min(col_0, col), max(col_1, col)
        if flag & SOLID:
            obstacle_evidence[row, col] = min(obstacle_evidence[row, col] + hit, most)
            seen_obstacle[row, col] = obstacle_evidence[row, col] >= obstacle_from
        if flag & AT_EYE_LEVEL:
            seen_at_eye_level[row, col] = True
        if flag & IN_VIEW:
            frames_in_view[row, col] += 1
        if flag & TARGET:
            score_max[row, col] = 1.0
    return row_0, row_1, col_0, col_1
