"""Surface normals of a view, from its depth and the geoms of its pixels.

The neighbours of a pixel in the same geom give the plane of its surface, so that normals are not mixed across edges.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import CameraModel

_FAR_M = np.float32(1e6)
"""Step in depth to a neighbour that is not in the same geom."""


def surface_normals(depth_m: NDArray[np.float32], geom: NDArray[np.int32], camera: CameraModel) -> NDArray[np.float32]:
    """Returns the unit normal of each pixel, float32 (h, w, 3), towards the camera.

    Axes are those of OpenCV's camera: x to the right, y down, z along the optical axis. A normal is zero where the
    depth is outside of the camera's range, and at pixels without a neighbour in the same geom in both directions.

    Args:
        depth_m: (h, w) without noise, at the camera's resolution.
        geom: (h, w) geom id of each pixel; -1: none.
        camera: intrinsics and range of depth.
    """
    height, width = depth_m.shape
    x = (np.arange(width, dtype=np.float32) + 0.5 - 0.5 * width) / np.float32(camera.focal_px)
    y = (np.arange(height, dtype=np.float32) + 0.5 - 0.5 * height) / np.float32(camera.focal_px)
    points = np.stack([x * depth_m, y[:, None] * depth_m, depth_m], axis=-1)  # (h, w, 3) metres
    valid = (depth_m > 0.0) & (depth_m < camera.max_depth_m) & (geom >= 0)
    surface = np.where(valid, geom, -1)
    right = _difference(points, surface, axis=1)
    down = _difference(points, surface, axis=0)
    normals = np.cross(down, right)
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
    away = (normals * points).sum(axis=-1, keepdims=True) > 0.0
    return np.where(away, -normals, normals).astype(np.float32)


def encode_normals(normals: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Returns normals (h, w, 3) as uint8, `round(127.5 * (n + 1))`; (0, 0, 0) for pixels without a normal."""
    levels = np.rint(127.5 * (normals + 1.0)).astype(np.uint8)
    return np.where(normals.any(axis=-1, keepdims=True), levels, np.uint8(0))


def _difference(points: NDArray[np.float32], surface: NDArray[np.int32], axis: int) -> NDArray[np.float32]:
    """Returns the difference of neighbouring points (h, w, 3) along an axis: the mean of those in the same geom.

    If the surface is curved or has an edge inside the geom, the side with the smaller step in depth counts.
    """
    step = np.diff(points, axis=axis)
    same = np.diff(surface, axis=axis) == 0
    same &= np.take(surface, range(same.shape[axis]), axis=axis) >= 0
    none = [(0, 0)] * 3
    after, before = ([*none] for _ in range(2))
    after[axis], before[axis] = (0, 1), (1, 0)
    sides = [np.pad(step, pad) for pad in (after, before)]
    sides_seen = [np.pad(same, pad[:2]) for pad in (after, before)]
    bend = [np.where(side, np.abs(bends[..., 2]), _FAR_M) for bends, side in zip(sides, sides_seen, strict=True)]
    both = sides_seen[0] & sides_seen[1] & (np.abs(bend[0] - bend[1]) < 0.25 * np.minimum(*bend) + 1e-4)
    nearer = np.where((bend[0] <= bend[1])[..., None], sides[0], sides[1])
    mean = 0.5 * (sides[0] + sides[1])
    chosen = np.where(both[..., None], mean, nearer)
    return np.where((sides_seen[0] | sides_seen[1])[..., None], chosen, 0.0).astype(np.float32)
