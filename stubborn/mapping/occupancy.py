"""Collects obstacle evidence from depth pixels, which their neighbours confirm and later frames may contradict.

A depth camera shows points that do not exist: flying pixels between the two sides of an edge, floor that seems to rise
far away, walls that shift with a noisy pose. Three tests keep them off the map: a pixel must lie on a surface, that is,
at the depth of some of its neighbours; a cell must hold more than one such point; and later frames must not see through
it. Exact depth passes all three tests, so that they change little.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int, UInt8

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel, ConfigError
from stubborn.kernels.frames import (
    cells_seen_past,
    enter_evidence,
    nearest_down_columns,
    shows_no_noise,
    smooth_surfaces,
)
from stubborn.mapping.navmap import NavMap


@dataclass(frozen=True, kw_only=True)
class OccupancyConfig:
    """The evidence that makes an obstacle, and the evidence that removes it."""

    jump_1_m: float = 0.03
    """Two pixels lie on one surface when their 1 / depth differs by less: 3 cm at 1 m, 27 cm at 3 m."""
    neighbours: int = 2
    """At least this many of a pixel's eight neighbours must lie on its surface: a thin leg is one pixel wide; 0: no
    test."""
    exact_1_m: float = 0.0005
    """An image is exact and not smoothed if its 1 / depth differs from the smoothed image by less, at the median."""
    hit: int = 2
    """Evidence that a frame adds to a cell with at least two points; a single noisy point adds half."""
    miss: int = 1
    """Evidence that a frame removes where it sees through a cell at all heights of the obstacle band; 0: nothing is
    removed."""
    obstacle_from: int = 2
    """A cell with at least this much evidence is an obstacle."""
    most: int = 10
    """Evidence does not grow beyond this, so that an object that was moved disappears after a few frames."""
    margin_m: float = 0.05
    """A frame sees through a cell when it sees farther than this past the cell's centre."""

    def __post_init__(self) -> None:
        if not 0 < self.obstacle_from <= self.most <= 100:
            raise ConfigError(
                f"OccupancyConfig needs 0 < obstacle_from <= most <= 100, got {self.obstacle_from} and {self.most}."
            )
        if min(self.jump_1_m, self.exact_1_m, self.hit, self.miss, self.neighbours) < 0:
            raise ConfigError("OccupancyConfig: jump_1_m, exact_1_m, hit, miss and neighbours must not be negative.")


@dataclass(frozen=True)
class Surfaces:
    """A depth image smoothed along surfaces, but not across their edges."""

    depth: Float32[np.ndarray, "h w"]
    """Metres: the mean of a pixel and those of its eight neighbours that lie on one surface with it."""
    neighbours: UInt8[np.ndarray, "h w"] | None
    """Number of these neighbours; None: the image shows no noise, so that every pixel counts."""

    @classmethod
    def of(cls, depth: Float32[np.ndarray, "h w"], config: OccupancyConfig) -> Surfaces:
        """Returns the surfaces of an image in metres, in which 0 means no distance."""
        every = 4
        change, count = _smoothed(depth, config, every)
        # At a silhouette the mean of one side is biased inwards: exact depth is better without smoothing.
        if shows_no_noise(depth, every, change, count, np.float32(config.exact_1_m)):
            return cls(depth, None)
        some = bool(count.any())
        change, count = _smoothed(depth, config, every=1)
        return cls(change + depth if some else depth, count)

    @property
    def exact(self) -> bool:
        """True: the image shows no noise."""
        return self.neighbours is None

    def confirmed(self, least: int) -> Bool[np.ndarray, "h w"]:
        """Returns True where a pixel has at least `least` neighbours on its surface; everywhere in an exact image."""
        if self.neighbours is None:
            return np.ones(self.depth.shape, np.bool_)
        return self.neighbours >= least


def _smoothed(
    depth: Float32[np.ndarray, "h w"], config: OccupancyConfig, every: int
) -> tuple[Float32[np.ndarray, "rows cols"], UInt8[np.ndarray, "rows cols"]]:
    """Returns the mean of a pixel and its neighbours on one surface with it, less the pixel, and their number.

    Only every `every`-th row and column is computed.
    """
    shape = -(-depth.shape[0] // every), -(-depth.shape[1] // every)
    change, count = np.empty(shape, np.float32), np.empty(shape, np.uint8)
    smooth_surfaces(np.ascontiguousarray(depth), np.float32(config.jump_1_m), every, change, count)
    return change, count


def agreeing(
    depth: Float32[np.ndarray, "h w"], config: OccupancyConfig
) -> tuple[Bool[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
    """Returns a mask of the pixels that lie on one surface with most of their neighbours, and the smoothed depth.

    `depth` is in metres, 0 where it is missing; such neighbours do not count.
    """
    surfaces = Surfaces.of(depth, config)
    if surfaces.neighbours is None:
        return np.ones(depth.shape, np.bool_), surfaces.depth
    known = cv2.boxFilter((depth > 0).view(np.uint8), -1, (3, 3), normalize=False, borderType=cv2.BORDER_CONSTANT)
    most = 2 * surfaces.neighbours + 1 >= np.asarray(known)
    return surfaces.confirmed(config.neighbours) & most, surfaces.depth


@dataclass(frozen=True)
class SightLines:
    """The range of sight of one frame through the obstacle band, by image column and lowest row."""

    nearest_m: Float32[np.ndarray, "h w"]
    """Depth of the nearest surface between the band's top row and this one; 0 where a depth is unknown."""
    up: Float32[np.ndarray, " h"]
    """Rise per metre of depth, decreasing in even steps."""
    left: Float32[np.ndarray, " w"]
    """Metres to the left per metre of depth, decreasing in even steps."""
    pose: Pose
    """Pose of the camera."""

    @classmethod
    def of_frame(
        cls,
        depth: Float32[np.ndarray, "h w"],
        up: Float32[np.ndarray, " h"],
        left: Float32[np.ndarray, " w"],
        pose: Pose,
        rise_m: float,
    ) -> SightLines:
        """Returns the lines of sight of an image; its pixels look `up` and `left`.

        The band ends `rise_m` above the camera. If `rise_m` is positive, rows that are above its top one metre away
        are left out.
        """
        first = int(np.count_nonzero(up > max(rise_m, 0.0)))
        return cls(nearest_down_columns(depth[first:]), up[first:], left, pose)

    def towards(self, target_m: Float32[np.ndarray, " w"]) -> SightLines:
        """Returns the same, cut off at the nearest target point of each column; inf: no target."""
        nearest_m = np.where(np.isfinite(target_m), np.minimum(self.nearest_m, target_m), np.float32(0.0))
        return replace(self, nearest_m=nearest_m)

    def passes(
        self,
        frame: GridFrame,
        rows: Int[np.ndarray, " n"],
        cols: Int[np.ndarray, " n"],
        drop_m: float,
        range_m: tuple[float, float],
        margin_m: float,
    ) -> Bool[np.ndarray, " n"]:
        """Returns, for each cell, whether the frame saw through it, from the camera's height to `drop_m` below it.

        The middle and both sides of a cell are tested. Cells outside the image or the range are not seen through.
        """
        return cells_seen_past(rows, cols, *self.geometry(frame), drop_m, *range_m, margin_m)

    def geometry(self, frame: GridFrame) -> tuple[tuple[float, ...], tuple[float, ...], Float32[np.ndarray, "h w"]]:
        """Returns `grid`, `sight` and `nearest_m` of `stubborn.kernels.frames.sees_past`."""
        cos, sin = math.cos(self.pose.yaw_rad), math.sin(self.pose.yaw_rad)
        steps = [(float(ray[0]), float(ray[0] - ray[1])) for ray in (self.up, self.left)]
        grid = (*frame.origin_xy_m, frame.cell_m)
        return grid, (self.pose.x_m, self.pose.y_m, cos, sin, *steps[0], *steps[1]), self.nearest_m


class Occupancy:
    """Adds and removes obstacle evidence. It has no memory of its own; the evidence is on the map."""

    def __init__(self, camera: CameraModel, config: OccupancyConfig, min_height_m: float) -> None:
        """The obstacle band starts at `min_height_m`."""
        self.camera = camera
        self.config = config
        self._drop_m = camera.height_m - min_height_m

    def add(
        self,
        view: NavMap,
        part: tuple[slice, slice],
        solid: UInt8[np.ndarray, "rows cols"],
        tall: UInt8[np.ndarray, "rows cols"],
        sight: SightLines,
        single: int,
    ) -> None:
        """Enters a frame into the obstacle layers of a view, where `part` contains everything in range.

        `solid` and `tall` are the numbers of points in the obstacle band and at eye level in each cell, where 2 means
        two or more; `single` is the evidence from a cell's only point, see `evidence_of_one`.
        """
        c, (rows, cols) = self.config, part
        bounds = rows.start, rows.stop, cols.start, cols.stop
        layers = view.obstacle_evidence, view.seen_obstacle, view.seen_at_eye_level
        rule = single, c.hit, c.miss, c.obstacle_from, c.most
        range_m = self.camera.min_depth_m, self.camera.max_depth_m
        enter_evidence(
            bounds, solid, tall, *layers, *rule, *sight.geometry(view.frame), self._drop_m, *range_m, c.margin_m
        )

    def evidence_of_one(self, surfaces: Surfaces) -> int:
        """Returns the evidence from a single point in a cell: full evidence in an exact image, half in a noisy one."""
        return self.config.hit if surfaces.exact else self.config.hit // 2
