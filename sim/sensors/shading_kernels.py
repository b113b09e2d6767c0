"""The loops of `sim.sensors.shading`, compiled by numba.

Images of OpenGL have their bottom row first. Positions are in camera axes: right, up and ahead, in metres. The small
grid has one point for each `STEP` x `STEP` pixels. Nothing is random: the sampling directions alternate between the
points of a 2 x 2 pattern, which the blur removes exactly.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

STEP = 5
"""Pixels of the image for each point of the small grid."""
_HALF = STEP // 2
_LEAST = np.float32(0.3)
"""Smallest share of light that ambient occlusion leaves."""
_BRIGHT = 224
"""Lamps and the sky emit light: colours brighter than this are darkened less, from 16 more on not at all."""
MAP_REACH_PX = 6
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
    for j in range(columns):
        tap[0, 0, :, j], tap[0, 1, :, j] = taps[j & 1, :, 0], taps[j & 1, :, 1]
        tap[1, 0, :, j], tap[1, 1, :, j] = taps[2 + (j & 1), :, 0], taps[2 + (j & 1), :, 1]
    weight = np.float32(strength / taps.shape[1])
    for i in range(rows):
        _measure_reach(points[2, i], np.float32(radius_m * focal_px / STEP), work[0])
        share[i] = np.float32(1.0)
        for k in range(taps.shape[1]):
            _find_places(i, rows, work, tap[i & 1, 0, k], tap[i & 1, 1, k], np.float32(STEP / focal_px), place)
            for j in range(columns):
                work[3, j] = depth[place[j]]
            _lose(share[i], points[:, i], work, np.float32(1.0 / radius_m**2), weight)
        for j in range(columns):
            share[i, j] = share[i, j] if share[i, j] > _LEAST else _LEAST
    return share


@njit(cache=True, error_model="numpy")
def _measure_reach(z: NDArray, scale: np.float32, reach: NDArray) -> None:
    """Writes the radius of the sampling disc of each point, in grid cells."""
    for j in range(len(z)):
        cells = scale / z[j]
        cells = cells if cells > np.float32(2.5) else np.float32(2.5)
        reach[j] = cells if cells < np.float32(26.0) else np.float32(26.0)


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
def _lose(share: NDArray, points: NDArray, work: NDArray, sharp: np.float32, weight: np.float32) -> None:
    """Subtracts from the share of a row what one sample of each point covers."""
    zero, one = np.float32(0.0), np.float32(1.0)
    for j in range(len(share)):
        q = work[3, j]
        dx, dy, dz = q * work[1, j] - points[0, j], q * work[2, j] - points[1, j], q - points[2, j]
        square = dx * dx + dy * dy + dz * dz
        rise = dx * points[3, j] + dy * points[4, j] + dz * points[5, j] - np.float32(0.004) * points[2, j]
        near = one - square * sharp
        near = near if near > zero else zero
        rise = rise if rise > zero else zero
        share[j] -= weight * near * rise / np.sqrt(square + np.float32(1e-6))


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
        lamp: position (3), strength, attenuation (3), exponent, radius of the lamp and the map's largest slope.
        maps: (3, n, n) see `sim.sensors.lamp_maps`.
        strength: share of the lamp's light that a full shadow takes.
    """
    _, rows, columns = points.shape
    size = maps.shape[1]
    work = np.empty((10, columns), np.float32)
    place = np.empty(columns, np.int32)
    view = frame.astype(np.float32)
    for i in range(rows):
        _place_on_map(points[:, i], view, lamp.astype(np.float32), size, work, place)
        for j in range(columns):
            if place[j] < 0:
                continue
            row, column = place[j] // size, place[j] % size
            front = work[6, j]
            if maps[1, row, column] >= front:  # nothing around is between the lamp and the point
                continue
            dark = 1.0
            if maps[2, row, column] >= front:
                dark = _shadow(work[:, j], lamp, maps, taps[(i & 1) * 2 + (j & 1)])
            if dark > 0.0:
                direct = _lamp_share(
                    work[0, j], work[1, j], work[2, j], work[3, j], work[4, j], work[5, j], lights, lamp
                )
                share[i, j] *= 1.0 - strength * dark * work[9, j] * direct


@njit(cache=True, error_model="numpy")
def _place_on_map(points: NDArray, frame: NDArray, lamp: NDArray, size: int, work: NDArray, place: NDArray) -> None:
    """Writes the flat index on the map of each point of a row, -1 outside, and into `work`: its position (3), normal
    (3), the depth of its shadow's end, column and row on the map, and a factor that falls to 0 at the map's border.
    """
    zero, one, gap = np.float32(0.0), np.float32(1.0), np.float32(0.03)
    limit = lamp[9]
    scale = np.float32(0.5) * np.float32(size) / limit
    for j in range(points.shape[1]):
        x, y, z = points[0, j], points[1, j], points[2, j]
        nx, ny, nz = points[3, j], points[4, j], points[5, j]
        wx = nx * frame[1, 0] + ny * frame[2, 0] + nz * frame[3, 0]
        wy = nx * frame[1, 1] + ny * frame[2, 1] + nz * frame[3, 1]
        wz = nx * frame[1, 2] + ny * frame[2, 2] + nz * frame[3, 2]
        px = frame[0, 0] + x * frame[1, 0] + y * frame[2, 0] + z * frame[3, 0] + gap * wx
        py = frame[0, 1] + x * frame[1, 1] + y * frame[2, 1] + z * frame[3, 1] + gap * wy
        pz = frame[0, 2] + x * frame[1, 2] + y * frame[2, 2] + z * frame[3, 2] + gap * wz
        drop = lamp[2] - pz
        u, v = (px - lamp[0]) / drop, (py - lamp[1]) / drop
        far = abs(u) if abs(u) > abs(v) else abs(v)
        inside = drop > np.float32(0.15) and far < np.float32(0.98) * limit
        column, row = (limit - v) * scale, (u + limit) * scale
        fade = np.float32(5.0) * (np.float32(0.98) - far / limit)
        work[0, j], work[1, j], work[2, j], work[3, j], work[4, j], work[5, j] = px, py, pz, wx, wy, wz
        work[6, j] = np.float32(0.988) * drop - np.float32(0.01)
        work[7, j], work[8, j] = column, row
        work[9, j] = fade if fade < one else one
        column, row = column if inside else zero, row if inside else zero
        place[j] = np.int32(row) * np.int32(size) + np.int32(column) if inside else np.int32(-1)


@njit(cache=True, error_model="numpy")
def _lamp_share(
    px: float, py: float, pz: float, nx: float, ny: float, nz: float, lights: NDArray, lamp: NDArray
) -> float:
    """Returns the lamp's share of the light that falls on a surface, in [0, 1]."""
    tx, ty, tz = lamp[0] - px, lamp[1] - py, lamp[2] - pz
    far = math.sqrt(tx * tx + ty * ty + tz * tz)
    facing = (tx * nx + ty * ny + tz * nz) / far
    if facing <= 0.0 or tz <= 0.0:
        return 0.0
    direct = (
        lamp[3]
        * facing
        * (tz / far if lamp[7] == 1.0 else (tz / far) ** lamp[7])
        / (lamp[4] + far * (lamp[5] + far * lamp[6]))
    )
    rest = lights[0, 3]
    for k in range(1, lights.shape[0]):
        rest += max(0.0, -(lights[k, 0] * nx + lights[k, 1] * ny + lights[k, 2] * nz)) * lights[k, 3]
    return direct / (direct + rest + 1e-6)


@njit(cache=True, error_model="numpy")
def _shadow(point: NDArray, lamp: NDArray, maps: NDArray, taps: NDArray) -> float:
    """Returns the share in [0, 1] of a round lamp that is hidden from a point; wider penumbras farther from objects."""
    size, column, row, front = maps.shape[1], point[7], point[8], point[6]
    near = maps[1, int(row), int(column)]
    blur = lamp[8] * (front - near) / near * 0.5 * size / (lamp[9] * front)
    blur = min(max(blur, 0.8), float(MAP_REACH_PX))
    dark = 0
    for k in range(taps.shape[0]):
        c, r = int(column + blur * taps[k, 0]), int(row + blur * taps[k, 1])
        if 0 <= c < size and 0 <= r < size and maps[0, r, c] < front:
            dark += 1
    return dark / taps.shape[0]


@njit(cache=True, error_model="numpy")
def blur(share: NDArray, depth: NDArray) -> NDArray:
    """Returns the image blurred by weights 1 2 1 along rows and columns, but not across edges of depth."""
    rows, columns = share.shape
    wide = np.empty_like(share)
    for i in range(rows):
        for j in range(columns):
            wide[i, j] = _blend(share, depth, i, j, i, max(j - 1, 0), i, min(j + 1, columns - 1))
    high = np.empty_like(share)
    for i in range(rows):
        for j in range(columns):
            high[i, j] = _blend(wide, depth, i, j, max(i - 1, 0), j, min(i + 1, rows - 1), j)
    return high


@njit(cache=True, error_model="numpy")
def _blend(share: NDArray, depth: NDArray, i: int, j: int, ia: int, ja: int, ib: int, jb: int) -> float:
    """Returns the weighted mean of a point and of its two neighbours that are at about the same depth."""
    z = depth[i, j]
    a = share[ia, ja] if abs(depth[ia, ja] - z) < 0.08 * z else share[i, j]
    b = share[ib, jb] if abs(depth[ib, jb] - z) < 0.08 * z else share[i, j]
    return 0.5 * share[i, j] + 0.25 * (a + b)


@njit(cache=True, error_model="numpy")
def apply_share(color: NDArray, raw: NDArray, share: NDArray, smooth: NDArray) -> NDArray:
    """Returns the colour image (h, w, 3), the top row first, times the share.

    Args:
        color: (h, w, 3), the bottom row first.
        raw: (h, w) reversed depth buffer.
        share: (rows, columns) of the small grid.
        smooth: (h, w) the share, interpolated. Where the four grid points around a pixel differ in depth, it is
            replaced by the mean of those at the depth of the pixel.
    """
    height, width = raw.shape
    out = np.empty_like(color)
    scale = np.empty(width, np.uint16)
    for r in range(height):
        for c in range(width):
            scale[c] = np.uint16(np.float32(256.0) * smooth[r, c])
        _mend_edges(r, raw, share, scale)
        source = color[r].reshape(-1)
        target = out[height - 1 - r].reshape(-1)
        for c in range(width):
            red, green, blue = source[3 * c], source[3 * c + 1], source[3 * c + 2]
            bright = red if red > green else green
            bright = np.int32(bright if bright > blue else blue) - np.int32(_BRIGHT)
            bright = bright if bright > np.int32(0) else np.int32(0)
            bright = bright if bright < np.int32(16) else np.int32(16)
            kept = np.int32(scale[c])
            kept += ((np.int32(256) - kept) * bright) >> np.int32(4)
            target[3 * c] = np.uint8((np.int32(red) * kept) >> np.int32(8))
            target[3 * c + 1] = np.uint8((np.int32(green) * kept) >> np.int32(8))
            target[3 * c + 2] = np.uint8((np.int32(blue) * kept) >> np.int32(8))
    return out


@njit(cache=True, error_model="numpy")
def _mend_edges(r: int, raw: NDArray, share: NDArray, scale: NDArray) -> None:
    """Replaces the factors, in 1/256, of those pixels of a row that lie between grid points of different depth."""
    rows, columns = share.shape
    i = min(max((r - _HALF) // STEP, 0), rows - 2)
    low, high = raw[i * STEP + _HALF], raw[(i + 1) * STEP + _HALF]
    t = min(max((r - _HALF) / STEP - i, 0.0), 1.0)
    for j in range(columns - 1):
        c0 = j * STEP + _HALF
        r00, r01, r10, r11 = low[c0], low[c0 + STEP], high[c0], high[c0 + STEP]
        most, least = max(max(r00, r01), max(r10, r11)), min(min(r00, r01), min(r10, r11))
        if most < 1.25 * least:
            continue
        first, last = c0 if j > 0 else 0, c0 + STEP if j < columns - 2 else raw.shape[1]
        for c in range(first, last):
            x = min(max((c - c0) / STEP, 0.0), 1.0)
            here, near = raw[r, c], 0.1 * raw[r, c]
            w00 = (1.01 - t) * (1.01 - x) if abs(r00 - here) < near else 1e-6
            w01 = (1.01 - t) * (0.01 + x) if abs(r01 - here) < near else 1e-6
            w10 = (0.01 + t) * (1.01 - x) if abs(r10 - here) < near else 1e-6
            w11 = (0.01 + t) * (0.01 + x) if abs(r11 - here) < near else 1e-6
            total = w00 * share[i, j] + w01 * share[i, j + 1] + w10 * share[i + 1, j] + w11 * share[i + 1, j + 1]
            scale[c] = np.uint16(256.0 * total / (w00 + w01 + w10 + w11))
