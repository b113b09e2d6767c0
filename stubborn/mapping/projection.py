"""The projection of depth pixels onto the ground (paper: Mapping Module).

A pixel (u, v) with depth d lies d ahead of the camera, d (c_u - u) / f to its left and d (c_v - v) / f above it. The
camera is level, so that a column of the image is a vertical plane, and the ground position of a pixel depends on its
depth and its column only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Int32, UInt8

from sim.core.geometry.grid import GridFrame, Window
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from stubborn.kernels.frames import cells_of_pixels, count_obstacle_points, ground_points


@dataclass(frozen=True)
class GroundPoints:
    """Depth pixels of one frame seen from above; pixels without a distance are left out."""

    valid: Bool[np.ndarray, "h w"]
    """True where depth is a distance; the other fields hold these pixels only, in row-major order."""
    rows: Int32[np.ndarray, " n"]
    """Row of each point on the window's grid."""
    cols: Int32[np.ndarray, " n"]
    """Column of each point on the window's grid."""
    height_m: Float32[np.ndarray, " n"]
    """Height of each point above the floor."""


@dataclass(frozen=True)
class PixelCells:
    """The cells of a window that the depth pixels of one frame lie in."""

    rows: Int32[np.ndarray, "h w"]
    """Row of each pixel's cell; -1: the pixel has no distance, or shows a point that is too high."""
    cols: Int32[np.ndarray, "h w"]
    """Column of each pixel."""
    span: tuple[slice, slice] | None
    """Rows and columns of the smallest rectangle that holds all points, including those too high; None: no point."""


class Rays:
    """The directions of every `stride_px`-th pixel, from pixel `first_px` on, in rows and columns."""

    def __init__(self, camera: CameraModel, first_px: int, stride_px: int, top_m: float = math.inf) -> None:
        """Rows of the image that cannot show points below `top_m` are left out."""
        self.camera = camera
        u_px = np.arange(first_px, camera.width_px, stride_px)
        v_px = np.arange(first_px, camera.height_px, stride_px)
        self.left = ((0.5 * camera.width_px - (u_px + 0.5)) / camera.focal_px).astype(np.float32)  # per metre of depth
        up = ((0.5 * camera.height_px - (v_px + 0.5)) / camera.focal_px).astype(np.float32)  # per metre of depth
        lowest_m = camera.height_m + np.minimum(up * camera.min_depth_m, up * camera.max_depth_m)
        skipped = int(np.count_nonzero(lowest_m > top_m))  # rows run from top to bottom
        self.up = up[skipped:]
        self.pick = (slice(first_px + skipped * stride_px, None, stride_px), slice(first_px, None, stride_px))

    def sample(self, depth: Float32[np.ndarray, "height_px width_px"]) -> Float32[np.ndarray, "h w"]:
        """Returns the pixels of these rays in a full-size depth image in metres, as a new array."""
        return depth[self.pick].copy()

    def project(
        self, d: Float32[np.ndarray, "h w"], confirmed: Bool[np.ndarray, "h w"], camera_pose: Pose, window: Window
    ) -> GroundPoints:
        """Returns cells of `window` and heights of the confirmed points of a sampled depth image.

        The window contains everything in range (see `sight_window_cells`), except at the edge of the map, where cells
        may lie outside the window.
        """
        valid = np.empty(d.shape, np.bool_)
        rows, cols, height_m = np.empty(d.size, np.int32), np.empty(d.size, np.int32), np.empty(d.size, np.float32)
        n = ground_points(d, confirmed, *self._onto_ground(camera_pose, window), valid, rows, cols, height_m)
        return GroundPoints(valid, rows[:n], cols[:n], height_m[:n])

    def cells_below(self, d: Float32[np.ndarray, "h w"], camera_pose: Pose, window: Window, top_m: float) -> PixelCells:
        """Returns the cells of those points of `project` that are not higher than `top_m`."""
        rows, cols = np.empty(d.shape, np.int32), np.empty(d.shape, np.int32)
        onto = self._onto_ground(camera_pose, window)
        first_row, last_row, first_col, last_col = cells_of_pixels(
            d, *onto, np.float32(top_m), *window.frame.shape, rows, cols
        )
        span = (slice(first_row, last_row + 1), slice(first_col, last_col + 1)) if last_row >= 0 else None
        return PixelCells(rows, cols, span)

    def count_obstacles(
        self,
        d: Float32[np.ndarray, "h w"],
        confirmed: Bool[np.ndarray, "h w"],
        camera_pose: Pose,
        window: Window,
        *,
        band_m: tuple[float, float],
        eye_level_halfwidth_m: float,
    ) -> tuple[UInt8[np.ndarray, "rows cols"], UInt8[np.ndarray, "rows cols"]]:
        """Returns the number of points of `project` in each cell within a band of heights, and the number at eye level.

        Two means two or more. A point is at eye level if its height differs from the camera's by at most
        `eye_level_halfwidth_m`.
        """
        solid, tall = np.zeros(window.frame.shape, np.uint8), np.zeros(window.frame.shape, np.uint8)
        limits_m = (np.float32(limit_m) for limit_m in (*band_m, eye_level_halfwidth_m))
        count_obstacle_points(d, confirmed, *self._onto_ground(camera_pose, window), *limits_m, solid, tall)
        return solid, tall

    def _onto_ground(self, camera_pose: Pose, window: Window) -> tuple[Any, ...]:
        """Returns the arguments of the kernels from `x_slope` to `far_m`."""
        cos, sin = math.cos(camera_pose.yaw_rad), math.sin(camera_pose.yaw_rad)
        frame, camera = window.frame, self.camera
        x_cells = np.float32((camera_pose.x_m - frame.origin_xy_m[0]) / frame.cell_m)
        y_cells = np.float32((camera_pose.y_m - frame.origin_xy_m[1]) / frame.cell_m)
        x_slope = ((cos - sin * self.left) / frame.cell_m).astype(np.float32)
        y_slope = ((sin + cos * self.left) / frame.cell_m).astype(np.float32)
        limits_m = (np.float32(limit) for limit in (camera.height_m, camera.min_depth_m, camera.max_depth_m))
        return x_slope, y_slope, x_cells, y_cells, self.up, *limits_m


def sight_window_cells(camera: CameraModel, cell_m: float) -> int:
    """Returns the edge, in cells, of a square around the camera that contains every point within its range."""
    farthest_m = camera.max_depth_m / math.cos(0.5 * camera.hfov_rad)
    return 2 * (math.ceil(farthest_m / cell_m) + 1) + 1


def in_range(camera: CameraModel, camera_pose: Pose, frame: GridFrame) -> tuple[slice, slice]:
    """Returns the rows and columns of a rectangle that holds all cells that a frame shows a part of."""
    far_m = camera.max_depth_m / math.cos(0.5 * camera.hfov_rad)
    yaws_rad = (camera_pose.yaw_rad + side * 0.5 * camera.hfov_rad for side in (-1.0, 1.0))
    ends = [(camera_pose.x_m + far_m * math.cos(yaw), camera_pose.y_m + far_m * math.sin(yaw)) for yaw in yaws_rad]
    return frame.around(*zip(camera_pose.xy_m, *ends, strict=True), margin_m=2.0 * frame.cell_m)
