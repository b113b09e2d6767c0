"""Compiled loops over the pixels of one frame: surfaces, ground points, evidence and scores of cells.

They are in a module of their own because numba compiles them: their annotations cannot be checked at run time.
Sums are in float32 and in a fixed order, because maps, and therefore the agent's path, depend on the last digit.
"""

from __future__ import annotations

import math

import numpy as np

from sim.core.geometry.compiling import njit

_PAIRS = ((1, 0), (0, 1), (1, 1), (1, -1))
"""Offsets in rows and columns to one of each two opposite neighbours."""


@njit(cache=True)
def smooth_surfaces(depth, jump_1_m, every, change, count):
    """Computes the mean of each pixel and those of its eight neighbours that lie on one surface with it.

    Args:
        depth: (rows, cols) float32 metres; 0: no distance.
        jump_1_m: float32, largest difference in 1 / depth between neighbours on one surface.
        every: only every `every`-th row and column is computed.
        change: (rows / every, cols / every) float32; it is set to the mean less the pixel itself.
        count: the same shape, uint8; it is set to the number of those neighbours.
    """
    rows, cols = depth.shape
    for i in range(count.shape[0]):
        for j in range(count.shape[1]):
            r, c = i * every, j * every
            d = depth[r, c]
            total, found = d, 0
            for k in range(4):
                dr, dc = _PAIRS[k]
                for side in (-1, 1):
                    nr, nc = r + side * dr, c + side * dc
                    if nr < 0 or nr >= rows or nc < 0 or nc >= cols:
                        continue
                    near = depth[nr, nc]
                    gap = near - d
                    # |1/a - 1/b| < jump, without a division; never true where one of them is 0. Both pixels of a pair
                    # round the same product, so that they agree.
                    later, earlier = (near, d) if side > 0 else (d, near)
                    if abs(gap) < (later * jump_1_m) * earlier:
                        total += gap
                        found += 1
            count[i, j] = found
            change[i, j] = (total - d) / (np.float32(found) + np.float32(1.0))


@njit(cache=True)
def shows_no_noise(depth, every, change, count, limit):
    """Returns whether the median of the changes by `smooth_surfaces`, as 1 / depth, is less than `limit` (float32).

    Pixels without neighbours on one surface do not count. If no pixel counts, the median is undefined and the result
    is False.
    """
    total = below = 0
    largest_below, least_above = np.float32(-np.inf), np.float32(np.inf)
    for i in range(count.shape[0]):
        for j in range(count.shape[1]):
            if count[i, j] == 0:
                continue
            d = depth[i * every, j * every]
            rough = abs(change[i, j]) / (d * d)
            total += 1
            if rough < limit:
                below += 1
                largest_below = max(largest_below, rough)
            else:
                least_above = min(least_above, rough)
    if total > 0 and 2 * below == total:  # the median is the mean of the middle two
        return np.float32(0.5) * (largest_below + least_above) < limit
    return 2 * below > total


@njit(cache=True)
def nearest_down_columns(depth):
    """Returns, for each pixel (rows, cols), the least depth in its column from the first row to its own."""
    nearest = depth.copy()
    for r in range(1, depth.shape[0]):
        for c in range(depth.shape[1]):
            above, here = nearest[r - 1, c], depth[r, c]
            nearest[r, c] = above if above < here else here
    return nearest


@njit(cache=True)
def count_obstacle_points(
    depth, confirmed, x_slope, y_slope, x_cells, y_cells, up, camera_m, near_m, far_m, low_m, top_m, eye_m, solid, tall
):
    """Counts the points of each cell in the obstacle band and at eye level, at most 2 each, on the grid only.

    Args:
        depth: see `ground_points`, also for the next arguments up to `far_m`.
        low_m: heights from here to `top_m` are in the band.
        eye_m: heights that differ by no more than this from the camera's are at eye level.
        solid: (rows, cols) uint8 zeros; it is set to the number of points in the band, and `tall` to that at eye level.
    """
    in_band, at_eye_level = np.empty(depth.shape[1], np.bool_), np.empty(depth.shape[1], np.bool_)
    for r in range(depth.shape[0]):
        line, sure, rise = depth[r], confirmed[r], up[r]
        for c in range(line.size):  # without a branch, so that it is vectorised
            height_m = line[c] * rise + camera_m
            counts = sure[c] & (line[c] >= near_m) & (line[c] < far_m)
            in_band[c] = counts & (height_m >= low_m) & (height_m <= top_m)
            at_eye_level[c] = counts & (abs(height_m - camera_m) <= eye_m)
        for c in range(line.size):
            if not (in_band[c] or at_eye_level[c]):
                continue
            col, row = np.int32(line[c] * x_slope[c] + x_cells), np.int32(line[c] * y_slope[c] + y_cells)
            if not (0 <= row < solid.shape[0] and 0 <= col < solid.shape[1]):
                continue
            if in_band[c] and solid[row, col] < 2:
                solid[row, col] += 1
            if at_eye_level[c] and tall[row, col] < 2:
                tall[row, col] += 1


@njit(cache=True)
def sees_past(row, col, grid, sight, nearest_m, drop_m, near_m, far_m, margin_m):
    """Returns whether a frame saw past a cell; see `stubborn.mapping.occupancy.SightLines.passes`.

    Args:
        row: row of the cell; `col` is its column.
        grid: x and y of the grid's corner, and the edge of a cell.
        sight: x, y, cos and sin of the camera's pose; the first entry and the step of `SightLines.up`; the same of
            `left`.
        nearest_m: (h, w) float32; see `stubborn.mapping.occupancy.SightLines`.
        drop_m: distance from the camera down to the end of the band.
        near_m: cells nearer than this or, with the margin, not nearer than `far_m` are not seen through.
        margin_m: the frame must see farther than this past the cell's centre.
    """
    corner_x_m, corner_y_m, cell_m = grid
    camera_x_m, camera_y_m, cos, sin, up, up_step, left, left_step = sight
    dx = corner_x_m + (col + 0.5) * cell_m - camera_x_m
    dy = corner_y_m + (row + 0.5) * cell_m - camera_y_m
    ahead_m, left_m = cos * dx + sin * dy, cos * dy - sin * dx
    if not (ahead_m > near_m and ahead_m + margin_m < far_m):
        return False
    image_row = int(np.ceil((up + drop_m / ahead_m) / up_step))
    if image_row < 0 or image_row >= nearest_m.shape[0]:
        return False
    half_m = cell_m * math.sqrt(0.5)
    for side_m in (-half_m, 0.0, half_m):
        image_col = int(np.rint((left - (left_m + side_m) / ahead_m) / left_step))
        if image_col < 0 or image_col >= nearest_m.shape[1]:
            return False
        if not nearest_m[image_row, image_col] > ahead_m + margin_m:
            return False
    return True


@njit(cache=True)
def cells_seen_past(rows, cols, grid, sight, nearest_m, drop_m, near_m, far_m, margin_m):
    """Returns `sees_past` of each of some cells (n,)."""
    passed = np.empty(rows.size, np.bool_)
    for i in range(rows.size):
        passed[i] = sees_past(rows[i], cols[i], grid, sight, nearest_m, drop_m, near_m, far_m, margin_m)
    return passed


@njit(cache=True)
def enter_evidence(
    part, solid, tall, evidence, obstacle, eye_level, single, hit, miss, obstacle_from, most, grid, sight, nearest_m,
    drop_m, near_m, far_m, margin_m,
):  # fmt: skip
    """Enters the points of a frame into the obstacle layers; see `stubborn.mapping.occupancy.Occupancy.add`.

    Args:
        part: the first row, the row after the last, and the same for columns, of a rectangle that contains all the
            frame shows.
        solid: (rows, cols) uint8 number of points in the obstacle band, at most 2; `tall` is the number at eye level.
        evidence: (rows, cols) int8; it is changed, and so are `obstacle` and `eye_level` (bool).
        single: evidence of one point; `hit` is the evidence of two.
        miss: evidence that is removed where the frame sees past a cell.
        obstacle_from: a cell with at least this much evidence is an obstacle.
        most: evidence does not grow beyond this.
        grid: see `sees_past`, also for the arguments that follow.
    """
    for row in range(part[0], part[1]):
        for col in range(part[2], part[3]):
            if tall[row, col] != 0 and (hit if tall[row, col] > 1 else single) > 0:
                eye_level[row, col] = True
            if solid[row, col] == 0 and evidence[row, col] == 0:
                continue
            found = 0 if solid[row, col] == 0 else hit if solid[row, col] > 1 else single
            known = int(evidence[row, col])
            if found == 0 and known == 0:
                continue
            if found == 0 and miss > 0 and sees_past(
                row, col, grid, sight, nearest_m, drop_m, near_m, far_m, margin_m
            ):  # fmt: skip
                known = max(known - miss, 0)
            known = min(known + found, most)
            evidence[row, col] = known
            obstacle[row, col] = known >= obstacle_from
            if known <= 0:
                eye_level[row, col] = False


@njit(cache=True)
def ground_points(
    depth, confirmed, x_slope, y_slope, x_cells, y_cells, up, camera_m, near_m, far_m, valid, rows, cols, height_m
):
    """Projects depth pixels onto the ground and returns their number; see `stubborn.mapping.projection`.

    Args:
        depth: (h, w) float32 metres along the optical axis.
        confirmed: (h, w) bool; other pixels are left out, and so are those nearer than `near_m` or not below `far_m`.
        x_slope: (w,) columns of the grid per metre of depth; `y_slope` is in rows.
        x_cells: column of the camera, not rounded; `y_cells` is its row.
        up: (h,) rise per metre of depth.
        camera_m: height of the camera.
        valid: (h, w) bool; it is set to the pixels that count.
        rows: (h * w,) int32; its beginning is set to the row of each of them, and so are `cols` and `height_m`.
    """
    n = 0
    for r in range(depth.shape[0]):
        for c in range(depth.shape[1]):
            d = depth[r, c]
            counts = confirmed[r, c] and d >= near_m and d < far_m
            valid[r, c] = counts
            if counts:
                cols[n] = np.int32(d * x_slope[c] + x_cells)  # positive, so truncation is floor
                rows[n] = np.int32(d * y_slope[c] + y_cells)
                height_m[n] = d * up[r] + camera_m
                n += 1
    return n


@njit(cache=True)
def cells_of_pixels(
    depth, x_slope, y_slope, x_cells, y_cells, up, camera_m, near_m, far_m, top_m, height, width, rows, cols
):
    """Computes the cell of each depth pixel, and returns the first and last row and column of all cells.

    Args:
        depth: see `ground_points`, also for the next arguments up to `far_m`.
        top_m: points above this have no cell, but count in the returned numbers.
        height: number of rows of the grid; `width` is the number of columns. Points off the grid do not count.
        rows: (h, w) int32; it is set to the row of each pixel, -1 without a cell; `cols` is set to the columns.
    """
    first_row = first_col = 2**31 - 1
    last_row = last_col = -1
    for r in range(depth.shape[0]):
        for c in range(depth.shape[1]):
            d = depth[r, c]
            rows[r, c] = cols[r, c] = -1
            if not (d >= near_m and d < far_m):
                continue
            col, row = np.int32(d * x_slope[c] + x_cells), np.int32(d * y_slope[c] + y_cells)
            if not (0 <= row < height and 0 <= col < width):
                continue
            first_row, last_row = min(first_row, row), max(last_row, row)
            first_col, last_col = min(first_col, col), max(last_col, col)
            if d * up[r] + camera_m <= top_m:
                rows[r, c], cols[r, c] = row, col
    return first_row, last_row, first_col, last_col


@njit(cache=True)
def highest_scores(rows, cols, target, other, of_target_pixel, in_view, target_of, other_of):
    """Reduces pixels to cells: the highest target score and the highest other score of the pixels in a cell.

    Args:
        rows: (h, w) row of each pixel's cell, -1: no cell; `cols` is its column.
        target: (h, w) float32 score of the target; `other` is the highest score of any other category.
        of_target_pixel: True: other scores count only at the pixels of a cell that have its highest target score.
        in_view: (rows, cols) bool; it is set to True where a pixel lies.
        target_of: (rows, cols) float32 zeros; it is set to the highest target score.
        other_of: (rows, cols) float32 zeros; it is set to the highest other score.

    Returns:
        True if a target score in a cell is more than 0.
    """
    scored = False
    for i in range(rows.shape[0]):
        for j in range(rows.shape[1]):
            row, col = rows[i, j], cols[i, j]
            if row < 0:
                continue
            in_view[row, col] = True
            if target[i, j] > target_of[row, col]:
                target_of[row, col], scored = target[i, j], True
                if of_target_pixel:
                    other_of[row, col] = np.float32(0.0)
            elif of_target_pixel and target[i, j] < target_of[row, col]:
                continue
            other_of[row, col] = max(other_of[row, col], other[i, j])
    return scored


@njit(cache=True)
def goal_bits(posteriors, channels, least):
    """Returns a uint32 image (rows, cols) with bit g where goal category g has a probability above `least`.

    Args:
        posteriors: (classes, rows, cols) float32.
        channels: (goals,) the channel of each goal category.
        least: float32.
    """
    _, rows, cols = posteriors.shape
    bits = np.zeros((rows, cols), np.uint32)
    for row in range(rows):
        for goal in range(channels.size):
            channel, bit = channels[goal], np.uint32(1) << np.uint32(goal)
            for col in range(cols):  # without a branch, so that it is vectorised
                bits[row, col] |= bit if posteriors[channel, row, col] > least else np.uint32(0)
    return bits


@njit(cache=True)
def enter_bits(seen, rows, cols, bits, counts):
    """Sets bits in cells of a map.

    Args:
        seen: (rows, cols) uint32; it is changed.
        rows: (n,) row of each point; `cols` is its column.
        bits: (n,) uint32 bits of each point.
        counts: (n,) bool; other points are left out.
    """
    for i in range(rows.size):
        if counts[i]:
            seen[rows[i], cols[i]] |= bits[i]
