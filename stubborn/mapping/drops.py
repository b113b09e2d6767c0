"""Finds missing floor from depth: where a ray passes through the plane of the floor, the robot would fall.

A depth camera shows at a stairwell or at the edge of a landing only the surfaces below, or nothing if they are out of
range. The ground is known to be missing where a ray crosses the plane of the floor and continues. If even the lowest
ray of a column does so, the ground between that crossing and the ground that was seen is unknown and may be missing
too: it is marked until a frame shows floor there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel, ConfigError
from stubborn.mapping.navmap import NavMap
from stubborn.mapping.projection import Rays

_EVERY_COLUMN = 2
"""One in this many columns is used; they are 3 cm apart at `DropConfig.range_m` with the default camera and stride."""


@dataclass(frozen=True, kw_only=True)
class DropConfig:
    """The evidence that the floor is missing somewhere."""

    enabled: bool = True
    """False: drops are not mapped, and the agent drives over edges."""
    below_m: float = 0.10
    """A ray that reaches this far below the floor has passed through it."""
    range_m: float = 3.0
    """Rays that cross the plane of the floor farther away do not count: the depth error exceeds a step there."""
    hit: int = 2
    """Evidence that a frame adds to a cell where a ray passes through the floor."""
    miss: int = 1
    """Evidence that a frame removes from a cell where it shows floor."""
    drop_from: int = 2
    """A cell with at least this much evidence is a drop."""
    most: int = 10
    """Evidence does not grow beyond this."""

    def __post_init__(self) -> None:
        if not (self.below_m > 0.0 and self.range_m > 0.0):
            raise ConfigError(
                f"DropConfig: below_m and range_m must be positive, got {self.below_m} and {self.range_m} m."
            )
        if not 0 < self.drop_from <= self.most <= 100 or min(self.hit, self.miss) < 0:
            raise ConfigError("DropConfig needs 0 < drop_from <= most <= 100, and hit and miss not negative.")


class Drops:
    """Enters missing floor into a map. It has no memory of its own; the evidence is on the map."""

    def __init__(self, camera: CameraModel, rays: Rays, config: DropConfig) -> None:
        self._config = config
        self._left = rays.left[::_EVERY_COLUMN]
        self._first = int(np.count_nonzero(rays.up >= -camera.height_m / config.range_m))
        down = -rays.up[self._first :]  # metres below the camera per metre of depth, of rows from far to near
        self._floor_m = camera.height_m / down
        """Depth at which each row crosses the plane of the floor."""
        self._floor_from_m = np.maximum((camera.height_m - config.below_m) / down, camera.min_depth_m)[:, None]
        self._through_m = ((camera.height_m + config.below_m) / down)[:, None]

    def add(self, view: NavMap, depth: Float32[np.ndarray, "h w"], camera_pose: Pose) -> None:
        """Enters a sampled depth image into the drop layers of a view that contains everything in range.

        Args:
            view: part of the map.
            depth: metres, for the rays given to the constructor; the farthest depth also stands for all larger depths.
            camera_pose: pose of the camera.
        """
        if not self._config.enabled or not len(self._floor_m):
            return
        near = depth[self._first :, ::_EVERY_COLUMN]
        missing = near > self._through_m
        if missing.any():  # single pixels may be noise
            missing = np.asarray(cv2.erode(missing.view(np.uint8), np.ones((3, 3), np.uint8)), np.uint8).view(np.bool_)
        seen = bool(missing.any())
        if not (seen or view.drop_evidence.any()):
            return
        config, evidence = self._config, view.drop_evidence
        cells = self._crossings(view.frame, camera_pose)
        hits = np.zeros(evidence.shape, np.bool_)
        hits.reshape(-1)[cells[missing]] = True
        floor = np.zeros(evidence.shape, np.bool_)
        floor.reshape(-1)[cells[(near >= self._floor_from_m) & (near <= self._through_m)]] = True
        floor &= ~hits
        evidence[floor] = np.maximum(evidence[floor] - config.miss, 0)
        evidence[hits] = np.minimum(evidence[hits] + config.hit, config.most)
        if seen:
            doubtful = self._unseen_before(view, missing[-1], camera_pose)
            evidence[doubtful] = np.maximum(evidence[doubtful], config.drop_from)
        view.seen_drop[:] = evidence >= config.drop_from

    def _crossings(self, frame: GridFrame, pose: Pose) -> Int[np.ndarray, "h w"]:
        """Returns the row-major cell in which each pixel's ray crosses the plane of the floor."""
        return _cells_at(frame, pose, self._floor_m[:, None], self._left)

    def _unseen_before(
        self, view: NavMap, missing: Bool[np.ndarray, " w"], pose: Pose
    ) -> Bool[np.ndarray, "rows cols"]:
        """Returns a mask of the cells from the lowest ray's crossing back to ground that was seen or driven over.

        `missing` is True for a column if its lowest ray passes through the floor.
        """
        if not missing.any():
            return np.zeros(view.frame.shape, np.bool_)
        depth_m = np.arange(float(self._floor_m[-1]), 0.0, -view.frame.cell_m, dtype=np.float32)
        cells = _cells_at(view.frame, pose, depth_m[:, None], self._left[missing])
        known = ((view.frames_in_view > 0) | view.visited) & ~view.seen_drop
        unknown = ~np.logical_or.accumulate(known.reshape(-1)[cells], axis=0)
        drops = np.zeros(view.frame.shape, np.bool_)
        drops.reshape(-1)[cells[unknown]] = True
        return drops


def _cells_at(
    frame: GridFrame, pose: Pose, depth_m: Float32[np.ndarray, "h 1"], left: Float32[np.ndarray, " w"]
) -> Int[np.ndarray, "h w"]:
    """Returns the row-major cells at some depths along the columns of the image, clipped to the map."""
    cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    x = (pose.x_m - frame.origin_xy_m[0]) + depth_m * (cos - sin * left)
    y = (pose.y_m - frame.origin_xy_m[1]) + depth_m * (sin + cos * left)
    cols = np.clip((x / frame.cell_m).astype(np.int32), 0, frame.shape[1] - 1)
    rows = np.clip((y / frame.cell_m).astype(np.int32), 0, frame.shape[0] - 1)
    return rows * np.int32(frame.shape[1]) + cols
