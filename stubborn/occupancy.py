"""What single depth pixels are worth: those that nothing beside them confirms, and those that later looks contradict.

A depth camera invents points: flying pixels between the two sides of an edge, floor that seems to rise far away, walls
that shift with a noisy pose. Three questions keep them off the map. Does a pixel lie on a surface, that is, at the
depth of some of its neighbours? Does a cell hold enough such points for its distance? And do later frames see through
it? Exact depth passes all three, so there the map is as if nothing had been asked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.interface import CameraModel, ConfigError
from stubborn.grid import GridFrame, PlanarPose
from stubborn.navmap import NavMap


@dataclass(frozen=True, kw_only=True)
class OccupancyConfig:
    """How much evidence makes an obstacle, and what takes it away."""

    jump_1_m: float = 0.03
    """Two pixels lie on one surface when their 1 / depth differs by less: 3 cm at 1 m, 27 cm at 3 m."""
    neighbours: int = 2
    """Of its eight neighbours so many must lie on a pixel's surface: a thin leg is one pixel wide; 0: none need."""
    patch_m2: float = 0.0003
    """A cell must show in one frame as many points as a surface of this size facing the camera."""
    hit: int = 2
    """Evidence that a frame adds where it shows at least two points and the patch; a single point adds half."""
    miss: int = 1
    """Evidence that a frame takes away where it sees through a cell at all heights of the obstacle band; 0: none."""
    obstacle_from: int = 2
    """A cell is an obstacle from so much evidence on."""
    most: int = 10
    """Evidence does not grow beyond this: what was moved away is forgotten after so many looks."""
    margin_m: float = 0.05
    """A frame sees through a cell where it sees so far past the cell's centre."""

    def __post_init__(self) -> None:
        if not 0 < self.obstacle_from <= self.most <= 100:
            raise ConfigError(
                f"OccupancyConfig needs 0 < obstacle_from <= most <= 100, got {self.obstacle_from} and {self.most}."
            )
        if min(self.jump_1_m, self.patch_m2, self.hit, self.miss, self.neighbours) < 0:
            raise ConfigError("OccupancyConfig: jump_1_m, patch_m2, hit, miss and neighbours must not be negative.")


@dataclass(frozen=True)
class Surfaces:
    """A depth image smoothed along surfaces but never across their edges."""

    depth: NDArray[np.float32]
    """(h, w) metres: the mean of a pixel and those of its eight neighbours that lie on one surface with it."""
    neighbours: NDArray[np.uint8]
    """(h, w) how many of the neighbours that are."""

    @classmethod
    def of(cls, depth: NDArray[np.float32], jump_1_m: float) -> Surfaces:
        """Of an image (h, w) of metres, where 0 is no distance; `jump_1_m` as in `OccupancyConfig`."""
        scaled = depth * np.float32(jump_1_m)
        total, count = depth.copy(), np.zeros(depth.shape, np.uint8)
        for ahead, behind in _NEIGHBOUR_PAIRS:
            a, b = depth[ahead], depth[behind]
            gap = b - a
            # |1/a - 1/b| < jump, without a division; never true where one of them is 0.
            same = np.abs(gap) < scaled[ahead] * b
            gap *= same
            count[ahead] += same
            count[behind] += same
            total[ahead] += gap  # sums of differences from the pixel itself
            total[behind] -= gap
        total -= depth
        total /= count + np.float32(1.0)
        total += depth
        return cls(total, count)


def agreeing(depth: NDArray[np.float32], config: OccupancyConfig) -> tuple[NDArray[np.bool_], NDArray[np.float32]]:
    """Which pixels of an image lie on one surface with most of their neighbours that have a distance, and how far.

    `depth` is (h, w) metres, 0 where there is no distance; both results are (h, w).
    """
    known = cv2.boxFilter((depth > 0).view(np.uint8), -1, (3, 3), normalize=False, borderType=cv2.BORDER_CONSTANT)
    surfaces = Surfaces.of(depth, config.jump_1_m)
    same = surfaces.neighbours
    return (same >= config.neighbours) & (2 * same + 1 >= np.asarray(known)), surfaces.depth


_ALL, _FIRST, _LAST = slice(None), slice(None, -1), slice(1, None)
_NEIGHBOUR_PAIRS = (
    ((_LAST, _ALL), (_FIRST, _ALL)),
    ((_ALL, _LAST), (_ALL, _FIRST)),
    ((_LAST, _LAST), (_FIRST, _FIRST)),
    ((_LAST, _FIRST), (_FIRST, _LAST)),
)


@dataclass(frozen=True)
class SightLines:
    """How far one frame sees through the obstacle band, by image column and lowest row looked at."""

    nearest_m: NDArray[np.float32]
    """(rows, columns) depth of the nearest surface between the band's top row and this one; 0 where one is unknown."""
    up: NDArray[np.float32]
    """(rows,) rise per metre of depth, falling at even steps."""
    left: NDArray[np.float32]
    """(columns,) metres to the left per metre of depth, falling at even steps."""
    pose: PlanarPose
    """Of the camera."""

    @classmethod
    def of_frame(
        cls,
        depth: NDArray[np.float32],
        up: NDArray[np.float32],
        left: NDArray[np.float32],
        pose: PlanarPose,
        rise_m: float,
    ) -> SightLines:
        """Of an image whose pixels look `up` and `left`; the band ends `rise_m` above the camera.

        Where the band ends above the camera, rows count that reach its top a metre away.
        """
        first = int(np.count_nonzero(up > max(rise_m, 0.0)))
        return cls(np.minimum.accumulate(depth[first:], axis=0), up[first:], left, pose)

    def passes(
        self,
        frame: GridFrame,
        rows: NDArray[np.integer],
        cols: NDArray[np.integer],
        drop_m: float,
        range_m: tuple[float, float],
        margin_m: float,
    ) -> NDArray[np.bool_]:
        """For each cell whether the frame saw through it, from the camera's height to `drop_m` below the camera.

        Looks through the middle and both sides of a cell; cells outside the image or the range are not seen through.
        """
        x_m, y_m = frame.centres(rows, cols)
        cos, sin = math.cos(self.pose.yaw_rad), math.sin(self.pose.yaw_rad)
        dx, dy = x_m - self.pose.x_m, y_m - self.pose.y_m
        ahead_m, left_m = cos * dx + sin * dy, cos * dy - sin * dx
        passed = np.zeros(ahead_m.shape, np.bool_)
        near = np.flatnonzero((ahead_m > range_m[0]) & (ahead_m + margin_m < range_m[1]))
        ahead_m, left_m = ahead_m[near], left_m[near]
        row = np.ceil((self.up[0] + drop_m / ahead_m) / (self.up[0] - self.up[1])).astype(np.intp)
        column_step = self.left[0] - self.left[1]
        half_m = frame.cell_m * math.sqrt(0.5)
        columns = np.rint(
            (self.left[0] - (left_m + half_m * np.array([[-1.0], [0.0], [1.0]])) / ahead_m) / column_step
        ).astype(np.intp)  # (3, cells)
        inside = (row < self.up.size) & (columns.min(axis=0) >= 0) & (columns.max(axis=0) < self.left.size)
        near, ahead_m, row, columns = near[inside], ahead_m[inside], row[inside], columns[:, inside]
        passed[near] = self.nearest_m[row, columns].min(axis=0) > ahead_m + margin_m
        return passed


class Occupancy:
    """Weighs the points of each frame against what later frames see through. Keeps no memory: that is on the map."""

    def __init__(self, camera: CameraModel, config: OccupancyConfig, min_height_m: float, stride_px: int) -> None:
        """The obstacle band starts at `min_height_m`; every `stride_px`-th pixel is looked at, each way."""
        self.camera = camera
        self.config = config
        self._drop_m = camera.height_m - min_height_m
        self._points_m2 = config.patch_m2 * (camera.focal_px / stride_px) ** 2  # points of the patch, times range^2

    def add(self, view: NavMap, solid: NDArray[np.integer], tall: NDArray[np.integer], sight: SightLines) -> None:
        """Enter a frame into the obstacle layers of a view that holds everything within sight.

        `solid` (n,) and `tall` (n,) are the row-major cells of the points in the obstacle band and at eye level.
        """
        hits = self._hits(view.frame, solid, sight.pose)
        view.seen_at_eye_level |= self._hits(view.frame, tall, sight.pose) > 0
        rows, cols = np.nonzero(hits | view.obstacle_evidence)
        evidence, hit = view.obstacle_evidence[rows, cols], hits[rows, cols]
        if self.config.miss:
            contested = np.flatnonzero((hit == 0) & (evidence > 0))
            passed = contested[self._passes(view.frame, rows[contested], cols[contested], sight)]
            evidence[passed] = np.maximum(evidence[passed] - self.config.miss, 0)
        evidence = np.minimum(evidence + hit, self.config.most).astype(np.int8)
        view.obstacle_evidence[rows, cols] = evidence
        view.seen_obstacle[rows, cols] = evidence >= self.config.obstacle_from
        view.seen_at_eye_level[rows, cols] &= evidence > 0

    def _passes(
        self, frame: GridFrame, rows: NDArray[np.integer], cols: NDArray[np.integer], sight: SightLines
    ) -> NDArray[np.bool_]:
        range_m = (self.camera.min_depth_m, self.camera.max_depth_m)
        return sight.passes(frame, rows, cols, self._drop_m, range_m, self.config.margin_m)

    def _hits(self, frame: GridFrame, cells: NDArray[np.integer], pose: PlanarPose) -> NDArray[np.int8]:
        """(rows, cols) evidence from one frame's points."""
        evidence = np.zeros(frame.shape, np.int8)
        counts = np.bincount(cells, minlength=evidence.size)
        found = np.flatnonzero(counts)
        rows, cols = np.divmod(found, frame.shape[1])
        x_m, y_m = frame.centres(rows, cols)
        ahead_m = math.cos(pose.yaw_rad) * (x_m - pose.x_m) + math.sin(pose.yaw_rad) * (y_m - pose.y_m)
        count = counts[found]
        enough = count * ahead_m * ahead_m >= self._points_m2
        single = (count == 1) & (ahead_m > 1.0)
        hit = np.where(single, self.config.hit // 2, self.config.hit)
        evidence.reshape(-1)[found] = np.where(enough, hit, 0)
        return evidence
