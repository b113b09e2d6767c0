"""Compiled loops over the pixels of one frame, for `stubborn.detection.tracks`: labels, regions, voxels, means."""

from __future__ import annotations

import math

import numpy as np

from sim.core.geometry.compiling import njit

NO_LABEL = -1


@njit(cache=True)
def label_pixels(posteriors, is_object, goal, hot):
    """Returns the most probable class of each pixel, -1 if its class is not an object; the goal from `hot` on.

    Args:
        posteriors: (classes, rows, cols) float32.
        is_object: (classes,) bool.
        goal: class of the goal.
        hot: least probability of the goal at which a pixel gets its label.
    """
    classes, rows, cols = posteriors.shape
    flat = posteriors.reshape(classes, rows * cols)
    best = flat[0].copy()
    label = np.zeros(rows * cols, np.int32)
    for first in range(1, classes, 4):  # four classes at a time and no branch: six times as fast
        for i in range(rows * cols):
            highest, at = best[i], label[i]
            for offset in range(4):
                k = min(first + offset, classes - 1)
                at = k if flat[k, i] > highest else at
                highest = flat[k, i] if flat[k, i] > highest else highest
            best[i], label[i] = highest, at
    for i in range(rows * cols):
        if flat[goal, i] >= hot:
            label[i] = goal
        elif not is_object[label[i]]:
            label[i] = NO_LABEL
    return label.reshape(rows, cols)


@njit(cache=True)
def voxels_of(depth, left, up, x_m, y_m, yaw_rad, height_m, near_m, far_m, origin_x_m, origin_y_m, edge_m, shape):
    """Returns the row-major voxel of each depth pixel, -1 for pixels without a voxel.

    Args:
        depth: (rows, cols) float32, metres along the optical axis.
        left: (cols,) metres to the left per metre of depth.
        up: (rows,) metres upwards per metre of depth.
        x_m: position of the camera, with `y_m`, `yaw_rad` and its `height_m` above the floor.
        near_m: depths from here to `far_m` are valid.
        origin_x_m: outer corner of the first voxel; also `origin_y_m`.
        edge_m: edge of a voxel.
        shape: rows (y), columns (x) and layers (height) of the volume.
    """
    rows, cols = depth.shape
    result = np.full((rows, cols), -1, np.int64)
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    for r in range(rows):
        for c in range(cols):
            d = depth[r, c]
            if not near_m <= d < far_m:
                continue
            x = x_m + d * (cos - sin * left[c]) - origin_x_m
            y = y_m + d * (sin + cos * left[c]) - origin_y_m
            row, col = int(y / edge_m), int(x / edge_m)
            layer = int(max(height_m + d * up[r], 0.0) / edge_m)
            if x >= 0.0 and y >= 0.0 and row < shape[0] and col < shape[1] and layer < shape[2]:
                result[r, c] = (row * shape[1] + col) * shape[2] + layer
    return result


@njit(cache=True)
def _root(parent, i):
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(cache=True)
def regions_of(label, voxel, depth, jump, objects=None):
    """Returns the number of each pixel's region, from 1 (0: no region), and the number of regions.

    Neighbours belong together if their labels are equal and their depths differ by less than `jump` of the depth; where
    `objects` (rows, cols) numbers the object of each pixel, these must be equal, too.
    """
    rows, cols = label.shape
    parent = np.arange(rows * cols)
    for r in range(rows):
        for c in range(cols):
            if label[r, c] < 0 or voxel[r, c] < 0:
                continue
            for other_r, other_c in ((r - 1, c), (r, c - 1)):
                if other_r < 0 or other_c < 0 or voxel[other_r, other_c] < 0:
                    continue
                if label[other_r, other_c] != label[r, c]:
                    continue
                if objects is not None and objects[other_r, other_c] != objects[r, c]:
                    continue
                if abs(depth[r, c] - depth[other_r, other_c]) < jump * depth[r, c]:
                    parent[_root(parent, r * cols + c)] = _root(parent, other_r * cols + other_c)
    number = np.zeros(rows * cols, np.int32)
    region = np.zeros((rows, cols), np.int32)
    count = 0
    for r in range(rows):
        for c in range(cols):
            if label[r, c] < 0 or voxel[r, c] < 0:
                continue
            root = _root(parent, r * cols + c)
            if number[root] == 0:
                count += 1
                number[root] = count
            region[r, c] = number[root]
    return region, count


@njit(cache=True)
def overlaps_of(region, count, label, voxel, owner, tracks):
    """Returns the pixels of each region by the track that owns their voxels, (count + 1, tracks), and their labels.

    Column 0 counts voxels without an owner.
    """
    overlap = np.zeros((count + 1, tracks), np.int32)
    labels = np.zeros(count + 1, np.int16)
    for r in range(region.shape[0]):
        for c in range(region.shape[1]):
            if region[r, c] > 0:
                overlap[region[r, c], owner[voxel[r, c]]] += 1
                labels[region[r, c]] = label[r, c]
    return overlap, labels


@njit(cache=True)
def claim(region, voxel, owner, track_of, takes_over, size, low, high, shape):
    """Gives voxels to tracks: voxels without an owner and, where a region takes over, all voxels of the region.

    Args:
        region: (rows, cols) number of each pixel's region, 0: no region.
        voxel: (rows, cols) row-major voxel of each pixel.
        owner: (voxels,) track of each voxel, 0: no track; it is changed.
        track_of: (regions,) track of each region, 0: no track.
        takes_over: (regions,) True: voxels of other tracks change their owner.
        size: (tracks,) number of voxels of each track; it is changed.
        low: (tracks, 3) smallest row, column and layer that each track ever owned; it is changed.
        high: (tracks, 3) largest ones; it is changed.
        shape: shape of the volume.
    """
    for r in range(region.shape[0]):
        for c in range(region.shape[1]):
            track = track_of[region[r, c]]
            if track == 0:
                continue
            at = voxel[r, c]
            before = owner[at]
            if before == track or (before != 0 and not takes_over[region[r, c]]):
                continue
            owner[at] = track
            size[track] += 1
            if before != 0:
                size[before] -= 1
            layer = at % shape[2]
            col = (at // shape[2]) % shape[1]
            row = at // (shape[2] * shape[1])
            for axis, value in ((0, row), (1, col), (2, layer)):
                low[track, axis] = min(low[track, axis], value)
                high[track, axis] = max(high[track, axis], value)


@njit(cache=True)
def means_by_track(posteriors, voxel, owner, tracks):
    """Returns the mean posterior of the pixels of each track, (tracks, classes), and how many pixels it has.

    Every second pixel enters the mean, as on a chessboard: neighbouring pixels hold nearly the same values.
    """
    classes, rows, cols = posteriors.shape
    flat = posteriors.reshape(classes, rows * cols)
    at = np.empty(rows * cols, np.int32)
    track = np.empty(rows * cols, np.int32)
    pixels, used = np.zeros(tracks, np.int32), np.zeros(tracks, np.int32)
    count = 0
    for r in range(rows):
        for c in range(cols):
            if voxel[r, c] < 0 or owner[voxel[r, c]] == 0:
                continue
            number = owner[voxel[r, c]]
            pixels[number] += 1
            if (r + c) % 2 == 0 or used[number] == 0:
                at[count], track[count] = r * cols + c, number
                used[number] += 1
                count += 1
    means = np.zeros((classes, tracks), np.float32)
    for k in range(classes):
        for j in range(count):
            means[k, track[j]] += flat[k, at[j]]
        for number in range(tracks):
            means[k, number] /= max(used[number], 1)
    return means.T.copy(), pixels
