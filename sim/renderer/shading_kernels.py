"""The loops of `sim.renderer.shading`, compiled by numba.

Images of OpenGL have their bottom row first. Positions are in camera axes: right, up and ahead, in metres. The small
grid has one point for each `STEP` x `STEP` pixels. Nothing is random: the sampling directions alternate between the
points of a 2 x 2 pattern, which the blur removes exactly.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.compiling import njit

STEP = 6
"""Pixels of the image for each point of the small grid."""
_HALF = STEP // 2
_MIN_SHARE = np.float32(0.3)
"""Smallest share of light that ambient occlusion leaves."""
_BRIGHT = 224
"""Lamps and the sky emit light: colours brighter than this are darkened less, from 16 more on not at all."""
_BLOCK = 96
"""Bytes of a row that are searched together for bright pixels; a multiple of 3."""
MAP_REACH_PX = 4
"""Largest radius of a penumbra on the map of a lamp."""


@njit(cache=True, error_model="numpy")
def grid_points(raw: NDArray, slope: float, offset: float, focal_px: float) -> NDArray:
    """Returns the points (6, rows, columns) of the small grid: right, up, ahead, and the unit normal towards the eye.

    The normal comes from the more similar one of two neighbouring pixels, along rows and along columns.
    """
    height, width = raw.shape
    rows, columns = height // STEP, width // STEP
    points = np.empty((6, rows, columns), np.float32)
    one, m, b, f = np.float32(1.0), np.float32(slope), np.float32(offset), np.float32(focal_px)
    for i in range(rows):
        r = i * STEP + _HALF
        y = np.float32((r + 0.5 - 0.5 * height) / focal_px)
        for j in range(columns):
            c = j * STEP + _HALF
            x = (np.float32(c) + np.float32(0.5) - np.float32(0.5) * np.float32(width)) / f
            z = one / (m * raw[r, c] + b)
            right, left = one / (m * raw[r, c + 1] + b) - z, z - one / (m * raw[r, c - 1] + b)
            above, below = one / (m * raw[r + 1, c] + b) - z, z - one / (m * raw[r - 1, c] + b)
            dx = right if abs(right) < abs(left) else left  # change of depth from one pixel to the next
            dy = above if abs(above) < abs(below) else below
            back = -(z / f + x * dx + y * dy)  # (dx, dy, back) is the cross product of both tangents, times -f / z
            scale = one / np.sqrt(dx * dx + dy * dy + back * back)
            points[0, i, j], points[1, i, j], points[2, i, j] = x * z, y * z, z
            points[3, i, j], points[4, i, j], points[5, i, j] = dx * scale, dy * scale, back * scale
    return points


@njit(cache=True, error_model="numpy")
def open_share(points: NDArray, taps: NDArray, focal_px: float, radius_m: float, strength: float) -> NDArray:
    """Returns the share (rows, columns) of the surroundings of each point that no nearby surface covers.

    The loops over a row are separate where they read from places that depend on the data: so the others are vectorised.

    Args:
        points: from `grid_points`.
        taps: (4, k, 2) sampling offsets inside the unit disc for the points of the 2 x 2 pattern.
        focal_px: focal length in pixels.
        radius_m: surfaces farther away do not count.
        strength: share that a completely covered point loses.
    """
    _, rows, columns = points.shape
    depth = points[2].reshape(-1)
    share = np.empty((rows, columns), np.float32)
    work = np.empty((4, columns), np.float32)
    place = np.empty(columns, np.int32)
    tap = np.empty((2, 2, taps.shape[1], columns), np.float32)
    for k in range(taps.shape[1]):  # by number, since an assignment to a slice would take seconds to compile
        for j in range(columns):
            for odd in range(2):
                tap[odd, 0, k, j], tap[odd, 1, k, j] = taps[2 * odd + (j & 1), k, 0], taps[2 * odd + (j & 1), k, 1]
    weight = np.float32(strength / taps.shape[1])
    for i in range(rows):
        _measure_reach(points[2, i], np.float32(radius_m * focal_px / STEP), work[0])
        share[i] = np.float32(1.0)
        for k in range(taps.shape[1]):
            _find_places(i, rows, work, tap[i & 1, 0, k], tap[i & 1, 1, k], np.float32(STEP / focal_px), place)
            for j in range(columns):
                work[3, j] = depth[place[j]]
            _lose(share, points, i, work, np.float32(1.0 / radius_m**2), weight)
        for j in range(columns):
            share[i, j] = share[i, j] if share[i, j] > _MIN_SHARE else _MIN_SHARE
    return share


@njit(cache=True, error_model="numpy")
def _measure_reach(z: NDArray, scale: np.float32, reach: NDArray) -> None:
    """Writes the radius of the sampling disc of each point, in grid cells."""
    for j in range(len(z)):
        cells = scale / z[j]
        cells = cells if cells > np.float32(2.5) else np.float32(2.5)
        reach[j] = cells if cells < np.float32(15.0) else np.float32(15.0)


@njit(cache=True, error_model="numpy")
def _find_places(
    i: int, rows: int, work: NDArray, tap_x: NDArray, tap_y: NDArray, cell: np.float32, place: NDArray
) -> None:
    """Writes the flat index of each sampled point, clamped to the grid, and the slopes of its ray into `work`."""
    columns = len(tap_x)
    zero, half = np.float32(0.0), np.float32(0.5)
    last_row, last_column = np.float32(rows - 1), np.float32(columns - 1)
    for j in range(columns):
        down = np.float32(i) + half + work[0, j] * tap_y[j]
        across = np.float32(j) + half + work[0, j] * tap_x[j]
        down = down if down > zero else zero
        across = across if across > zero else zero
        row = np.int32(down if down < last_row else last_row)
        column = np.int32(across if across < last_column else last_column)
        place[j] = row * np.int32(columns) + column
        work[1, j] = (np.float32(column) - half * last_column) * cell
        work[2, j] = (np.float32(row) - half * last_row) * cell


@njit(cache=True, error_model="numpy")
def _lose(share: NDArray, points: NDArray, i: int, work: NDArray, sharp: np.float32, weight: np.float32) -> None:
    """Subtracts the area that one sample of each point covers from the share of a row."""
    zero, one = np.float32(0.0), np.float32(1.0)
    for j in range(share.shape[1]):
        q = work[3, j]
        dx, dy, dz = q * work[1, j] - points[0, i, j], q * work[2, j] - points[1, i, j], q - points[2, i, j]
        square = dx * dx + dy * dy + dz * dz
        rise = dx * points[3, i, j] + dy * points[4, i, j] + dz * points[5, i, j]
        rise -= np.float32(0.004) * points[2, i, j]
        near = one - square * sharp
        near = near if near > zero else zero
        rise = rise if rise > zero else zero
        share[i, j] -= weight * near * rise / np.sqrt(square + np.float32(1e-6))


@njit(cache=True, error_model="numpy")
def shade(
    share: NDArray, points: NDArray, taps: NDArray, frame: NDArray, lights: NDArray, lamp: NDArray, maps: NDArray,
    strength: float,
) -> None:  # fmt: skip
    """Multiplies the share of each point by that of its light which the shadow of a lamp leaves.

    Args:
        share: (rows, columns), changed in place.
        points: from `grid_points`.
        taps: see `open_share`.
        frame: (4, 3) the eye, and the camera's right, up and forward axes in the world.
        lights: (n, 4) the ambient light in the first row, last column; then directions and strengths.
        lamp: position (3), strength, attenuation (3), exponent (its next integer counts), radius of the lamp and the
            map's largest slope.
        maps: (3, n, n) see `sim.renderer.lamp_maps`.
        strength: share of the lamp's light that a full shadow takes.
    """
    _, rows, columns = points.shape
    size = np.int32(maps.shape[1])
    work = np.empty((9, columns), np.float32)
    frame32, lights32, lamp32 = frame.astype(np.float32), lights.astype(np.float32), lamp.astype(np.float32)
    width = np.float32(0.5 * lamp[8] * size / lamp[9])
    weight = np.float32(1.0 / taps.shape[1])
    for i in range(rows):
        _place_on_map(points, i, frame32, lamp32, size, work)
        _lamp_share(work, lights32, lamp32, np.float32(strength))
        for j in range(columns):
            if work[8, j] < np.float32(0.01):
                continue
            front, column, row = work[3, j], work[4, j], work[5, j]
            near, far = maps[1, np.int32(row), np.int32(column)], maps[2, np.int32(row), np.int32(column)]
            if near >= front:  # nothing around is between the lamp and the point
                continue
            dark = np.float32(1.0)
            if far >= front:
                radius = width * (front / near - np.float32(1.0)) / front
                tap = taps[(i & 1) * 2 + (j & 1)]
                dark = weight * np.float32(_hidden_taps(column, row, front, radius, maps[0], tap))
            share[i, j] *= np.float32(1.0) - dark * work[8, j]


@njit(cache=True, error_model="numpy")
def _place_on_map(points: NDArray, i: int, frame: NDArray, lamp: NDArray, size: np.int32, work: NDArray) -> None:
    """Writes into `work` for each point of a row: its normal (3) in the world, the depth of its shadow's end, its
    column and row on the map, the lamp's distance and the cosines at the point and at the lamp, 0 outside the map.
    """
    zero, one, gap = np.float32(0.0), np.float32(1.0), np.float32(0.03)
    limit, lamp_x, lamp_y, lamp_z = lamp[9], lamp[0] - frame[0, 0], lamp[1] - frame[0, 1], lamp[2] - frame[0, 2]
    right_x, right_y, right_z = frame[1, 0], frame[1, 1], frame[1, 2]
    up_x, up_y, up_z = frame[2, 0], frame[2, 1], frame[2, 2]
    ahead_x, ahead_y, ahead_z = frame[3, 0], frame[3, 1], frame[3, 2]
    scale = np.float32(0.5) * np.float32(size) / limit
    border = limit * (one - np.float32(2 * MAP_REACH_PX + 2) / np.float32(size))
    for j in range(points.shape[2]):
        x, y, z = points[0, i, j], points[1, i, j], points[2, i, j]
        nx, ny, nz = points[3, i, j], points[4, i, j], points[5, i, j]
        wx = nx * right_x + ny * up_x + nz * ahead_x
        wy = nx * right_y + ny * up_y + nz * ahead_y
        wz = nx * right_z + ny * up_z + nz * ahead_z
        tx = lamp_x - (x * right_x + y * up_x + z * ahead_x + gap * wx)
        ty = lamp_y - (x * right_y + y * up_y + z * ahead_y + gap * wy)
        drop = lamp_z - (x * right_z + y * up_z + z * ahead_z + gap * wz)
        u, v = -tx / drop, -ty / drop
        far = abs(u) if abs(u) > abs(v) else abs(v)
        fade = np.float32(5.0) * (border - far) / limit
        fade = fade if fade < one else one
        fade = fade if fade > zero and drop > np.float32(0.15) else zero
        distance = np.sqrt(tx * tx + ty * ty + drop * drop)
        facing = (tx * wx + ty * wy + drop * wz) / distance
        work[0, j], work[1, j], work[2, j] = wx, wy, wz
        work[3, j] = np.float32(0.988) * drop - np.float32(0.01)
        work[4, j], work[5, j] = (limit - v) * scale, (u + limit) * scale
        work[6, j], work[7, j] = distance, drop / distance
        work[8, j] = fade * facing if facing > zero else zero


@njit(cache=True, error_model="numpy")
def _lamp_share(work: NDArray, lights: NDArray, lamp: NDArray, strength: np.float32) -> None:
    """Replaces the last row of `work` from `_place_on_map` by the share of the light that a full shadow takes."""
    zero = np.float32(0.0)
    columns = work.shape[1]
    rest = np.full(columns, lights[0, 3] + np.float32(1e-6))
    for k in range(1, lights.shape[0]):
        for j in range(columns):
            lit = -lights[k, 3] * (lights[k, 0] * work[0, j] + lights[k, 1] * work[1, j] + lights[k, 2] * work[2, j])
            rest[j] += lit if lit > zero else zero
    bright = np.full(columns, lamp[3])
    for _ in range(math.ceil(lamp[7])):
        for j in range(columns):
            bright[j] *= work[7, j]
    for j in range(columns):
        far = work[6, j]
        direct = bright[j] / (lamp[4] + far * (lamp[5] + far * lamp[6]))
        # the fade at the border of the map is a factor of the last row, in addition to the cosine
        work[8, j] = strength * work[8, j] * direct / (work[8, j] * direct + rest[j])


@njit(cache=True, error_model="numpy")
def _hidden_taps(
    column: np.float32, row: np.float32, front: np.float32, radius: np.float32, nearest: NDArray, taps: NDArray
) -> np.int32:
    """Returns how many samples of the penumbra of a point lie in shadow. `MAP_REACH_PX` keeps them on the map."""
    radius = radius if radius > np.float32(1.3) else np.float32(1.3)
    radius = radius if radius < np.float32(MAP_REACH_PX) else np.float32(MAP_REACH_PX)
    count = np.int32(0)
    for k in range(taps.shape[0]):
        c, r = np.int32(column + radius * taps[k, 0]), np.int32(row + radius * taps[k, 1])
        count += np.int32(nearest[r, c] < front)
    return count


@njit(cache=True, error_model="numpy")
def blur(share: NDArray, depth: NDArray) -> NDArray:
    """Returns the image blurred by weights 1 2 1 along rows and columns, but not across edges of depth."""
    rows = len(share)
    wide, high = share.copy(), np.empty_like(share)
    for i in range(rows):
        s, z = share[i], depth[i]
        _blend(s[1:-1], s[:-2], s[2:], z[1:-1], z[:-2], z[2:], wide[i, 1:-1])
    for i in range(rows):
        above, below = max(i - 1, 0), min(i + 1, rows - 1)
        _blend(wide[i], wide[above], wide[below], depth[i], depth[above], depth[below], high[i])
    return high


@njit(cache=True, error_model="numpy")
def _blend(s: NDArray, sa: NDArray, sb: NDArray, z: NDArray, za: NDArray, zb: NDArray, out: NDArray) -> None:
    """Writes the weighted means of points and of their two neighbours that are at about the same depth."""
    half, quarter = np.float32(0.5), np.float32(0.25)
    for j in range(len(s)):
        near = np.float32(0.08) * z[j]
        a, b = sa[j], sb[j]
        a = a if abs(za[j] - z[j]) < near else s[j]
        b = b if abs(zb[j] - z[j]) < near else s[j]
        out[j] = half * s[j] + quarter * (a + b)


@njit(cache=True, error_model="numpy")
def apply_share(color: NDArray, raw: NDArray, share: NDArray) -> NDArray:
    """Returns the colour image (h, w, 3), the top row first, times the share.

    It is interpolated between the points of the grid, in integers: 256 is a share of 1.

    Args:
        color: (h, w, 3), the bottom row first.
        raw: (h, w) reversed depth buffer.
        share: (rows, columns) of the small grid.
    """
    height, width = raw.shape
    out = np.empty_like(color)
    low, high = np.empty(3 * width, np.float32), np.empty(3 * width, np.float32)
    scale = np.empty(3 * width, np.uint16)
    edges = np.empty(share.shape[1], np.int32)
    _widen(share[0], high)
    done, count = -1, 0
    for r in range(height):
        i = min(max((r - _HALF) // STEP, 0), share.shape[0] - 2)
        if i != done:
            low, high = high, low
            _widen(share[i + 1], high)
            done, count = i, _find_edges(i, raw, share, edges)
        _interpolate(low, high, np.float32(min(max(r - _HALF - i * STEP, 0), STEP)) / np.float32(STEP), scale)
        for k in range(count):
            _mend_edge(r, i, edges[k], raw, share, scale)
        _multiply(color[r].reshape(-1), scale, out[height - 1 - r].reshape(-1))
    return out


@njit(cache=True, error_model="numpy")
def _widen(share: NDArray, wide: NDArray) -> None:
    """Writes the factors, in 1/256, of a row of the grid for each channel of each pixel."""
    unit, last = np.float32(256.0), len(share) - 1
    wide[: 3 * _HALF] = unit * share[0]
    wide[3 * (last * STEP + _HALF) :] = unit * share[last]
    for j in range(last):
        first, step = unit * share[j], unit / np.float32(STEP) * (share[j + 1] - share[j])
        k = 3 * (j * STEP + _HALF)
        for x in range(STEP):
            factor = first + np.float32(x) * step
            wide[k + 3 * x], wide[k + 3 * x + 1], wide[k + 3 * x + 2] = factor, factor, factor


@njit(cache=True, error_model="numpy")
def _interpolate(low: NDArray, high: NDArray, t: np.float32, scale: NDArray) -> None:
    """Writes the factors of a row of pixels between two rows of the grid."""
    for k in range(len(scale)):
        scale[k] = np.uint16(low[k] + (high[k] - low[k]) * t)


@njit(cache=True, error_model="numpy")
def _multiply(source: NDArray, scale: NDArray, target: NDArray) -> None:
    """Writes a row of colours times their factors. Bright pixels keep more, see `_BRIGHT`."""
    for k in range(len(source)):
        target[k] = np.uint8((np.int32(source[k]) * np.int32(scale[k])) >> np.int32(8))
    for start in range(0, len(source), _BLOCK):
        end = min(start + _BLOCK, len(source))
        brightest = np.uint8(0)
        for k in range(start, end):
            brightest = max(brightest, source[k])
        if brightest > _BRIGHT:
            _keep_bright(source[start:end], scale[start:end], target[start:end])


@njit(cache=True, error_model="numpy")
def _keep_bright(source: NDArray, scale: NDArray, target: NDArray) -> None:
    """Writes the bright ones of some pixels."""
    for k in range(0, len(source), 3):
        red, green, blue = np.int32(source[k]), np.int32(source[k + 1]), np.int32(source[k + 2])
        bright = min(max(red, green, blue) - np.int32(_BRIGHT), np.int32(16))
        if bright > 0:
            kept = np.int32(scale[k])
            kept += ((np.int32(256) - kept) * bright) >> np.int32(4)
            target[k] = np.uint8((red * kept) >> np.int32(8))
            target[k + 1] = np.uint8((green * kept) >> np.int32(8))
            target[k + 2] = np.uint8((blue * kept) >> np.int32(8))


@njit(cache=True, error_model="numpy")
def _find_edges(i: int, raw: NDArray, share: NDArray, edges: NDArray) -> int:
    """Writes the columns of a row's grid cells that have corners of different depth and share; returns the count."""
    low, high = raw[i * STEP + _HALF], raw[(i + 1) * STEP + _HALF]
    count = 0
    for j in range(share.shape[1] - 1):
        c = j * STEP + _HALF
        r00, r01, r10, r11 = low[c], low[c + STEP], high[c], high[c + STEP]
        s00, s01, s10, s11 = share[i, j], share[i, j + 1], share[i + 1, j], share[i + 1, j + 1]
        differ = max(s00, s01, s10, s11) - min(s00, s01, s10, s11) > np.float32(0.03)
        edges[count] = j
        count += differ and max(r00, r01, r10, r11) >= np.float32(1.25) * min(r00, r01, r10, r11)
    return count


@njit(cache=True, error_model="numpy")
def _mend_edge(r: int, i: int, j: int, raw: NDArray, share: NDArray, scale: NDArray) -> None:
    """Replaces the factors of a row of pixels of a cell by the mean of those corners at the depth of the pixel."""
    c0, width = j * STEP + _HALF, raw.shape[1]
    low, high = raw[i * STEP + _HALF], raw[(i + 1) * STEP + _HALF]
    r00, r01, r10, r11 = low[c0], low[c0 + STEP], high[c0], high[c0 + STEP]
    s00, s01, s10, s11 = share[i, j], share[i, j + 1], share[i + 1, j], share[i + 1, j + 1]
    one, little, least = np.float32(1.01), np.float32(0.01), np.float32(1e-6)
    t = np.float32(min(max(r - _HALF - i * STEP, 0), STEP)) / np.float32(STEP)
    first, last = c0 if j > 0 else 0, c0 + STEP if j < share.shape[1] - 2 else width
    for c in range(first, last):
        x = np.float32(min(max(c - c0, 0), STEP)) / np.float32(STEP)
        here = raw[r, c]
        near = np.float32(0.1) * here
        w00 = (one - t) * (one - x) if abs(r00 - here) < near else least
        w01 = (one - t) * (little + x) if abs(r01 - here) < near else least
        w10 = (little + t) * (one - x) if abs(r10 - here) < near else least
        w11 = (little + t) * (little + x) if abs(r11 - here) < near else least
        total = w00 * s00 + w01 * s01 + w10 * s10 + w11 * s11
        factor = np.uint16(np.float32(256.0) * total / (w00 + w01 + w10 + w11))
        scale[3 * c], scale[3 * c + 1], scale[3 * c + 2] = factor, factor, factor
