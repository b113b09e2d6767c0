"""Makes map layers from images: depth points become obstacles, scores become object layers (paper: Mapping Module)."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int, UInt32

from sim.core.geometry.grid import Window
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, CameraModel, ConfigError, RobotModel, Scores
from stubborn.kernels.frames import enter_bits, goal_bits
from stubborn.mapping.drops import DropConfig, Drops
from stubborn.mapping.navmap import NavMap
from stubborn.mapping.object_layers import FrameScores, ObjectLayers, ObjectLayersConfig
from stubborn.mapping.occupancy import Occupancy, OccupancyConfig, SightLines, Surfaces, agreeing
from stubborn.mapping.projection import Rays, in_range, sight_window_cells

_GOAL_CHANNELS = np.array([MPCAT40_ID[goal] - 1 for goal in GOAL_CATEGORIES], np.int64)


@dataclass(frozen=True, kw_only=True)
class MappingConfig:
    """Defines which depth points and scores enter which layer."""

    obstacle_min_height_m: float = 0.10
    """Surfaces below this height are floor, such as rugs, thresholds and slabs that the robot drives over."""
    obstacle_max_height_m: float | None = None
    """Surfaces above this height are overhead; None takes the robot's height (0.88 m)."""
    score_max_height_m: float = 2.2
    """Object layers take points up to this height: pictures, towels and wall screens are mounted high."""
    eye_level_halfwidth_m: float = 0.06
    """Surfaces can hide an object behind them if their height differs from the camera's by at most this."""
    obstacle_stride_px: int = 2
    """Step between the depth pixels, in rows and columns, that enter the obstacle layer."""
    score_stride_px: int = 4
    """Step between the pixels, in rows and columns, that enter the object layers."""
    rim_px: int = 3
    """Width of the target's rim that does not count with inexact images, in pixels: depth and scores differ there."""
    other_of_target_pixel: bool = False
    """True: of the scores of other categories, a cell takes only those of the pixel with its highest target score. A
    picture shares its cell with the wall above and below it. False: the highest of all its pixels, as in the paper."""
    candidate_score: float = 0.5
    """A cell with a higher target score is a candidate."""
    candidate_gap_m: float = 0.15
    """A candidate is removed when a frame sees through it and shows the target only farther than this behind it."""
    occupancy: OccupancyConfig = field(default_factory=OccupancyConfig)
    """Evidence from a noisy depth image."""
    drops: DropConfig = field(default_factory=DropConfig)
    """Missing floor, such as a stairwell."""

    def __post_init__(self) -> None:
        if min(self.obstacle_stride_px, self.score_stride_px) < 1:
            raise ConfigError(
                f"MappingConfig strides must be >= 1 px, got {self.obstacle_stride_px} and {self.score_stride_px}."
            )


@dataclass(frozen=True)
class Sighting:
    """Target pixels of one frame, as cells of the whole map."""

    rows: Int[np.ndarray, " n"]
    cols: Int[np.ndarray, " n"]
    distance_m: Float32[np.ndarray, " n"]
    """Horizontal distance from the robot's centre."""

    def is_within(self, range_m: float) -> bool:
        """Returns whether a target point is within a distance."""
        return bool((self.distance_m <= range_m).any())

    def nearest(self, counts: Bool[np.ndarray, "rows cols"], range_m: float) -> tuple[int, int] | None:
        """Returns the map cell of the nearest target point on the cells that count, within a distance; else None."""
        distance_m = np.where(counts[self.rows, self.cols], self.distance_m, np.inf)
        point = int(np.argmin(distance_m)) if distance_m.size else -1
        if point < 0 or distance_m[point] > range_m:
            return None
        return int(self.rows[point]), int(self.cols[point])


NOTHING_SIGHTED = Sighting(np.zeros(0, np.intp), np.zeros(0, np.intp), np.zeros(0, np.float32))
"""A frame without a target pixel."""


@dataclass(frozen=True)
class Frame:
    """The pose of a camera frame that is entered into a map, and the part of the map that it is entered into."""

    navmap: NavMap
    pose: Pose
    """Pose of the robot in the frame of the map."""
    camera_pose: Pose
    window: Window
    """The part of the map that the camera can see."""

    @property
    def view(self) -> NavMap:
        """The layers of that part."""
        return self.navmap.view(self.window)


class Mapper:
    """Writes frames into a `NavMap`. It holds precomputed rays and no memory of the episode."""

    def __init__(
        self, camera: CameraModel, robot: RobotModel, config: MappingConfig, layers: ObjectLayers | None = None
    ) -> None:
        """Precomputes the rays of the camera. `layers` keeps the scores, by default of all frames as in the paper."""
        self.layers = layers or ObjectLayersConfig().make(config.candidate_score)
        top_m = robot.height_m if config.obstacle_max_height_m is None else config.obstacle_max_height_m
        low_m = max(config.obstacle_min_height_m, robot.climb_m)  # surfaces that the robot climbs do not block it
        if low_m >= top_m:
            raise ConfigError(
                f"The obstacle layer needs a band of heights: obstacle_min_height_m is {low_m} m, its top {top_m} m."
            )
        self.camera = camera
        self.camera_forward_m = robot.camera_forward_m
        self.config = config
        self._band_m = low_m, top_m
        stride_px = config.obstacle_stride_px
        used_top_m = max(top_m, camera.height_m + config.eye_level_halfwidth_m)
        self._obstacle_rays = Rays(camera, stride_px // 2, stride_px, used_top_m)
        self._score_rays: dict[int, Rays] = {}
        self._occupancy = Occupancy(camera, config.occupancy, low_m)
        self._drops = Drops(camera, self._obstacle_rays, config.drops)

    def frame(self, navmap: NavMap, pose: Pose, eye: Pose | None = None) -> Frame:
        """Returns the frame that the camera takes from a pose of the robot, for the methods below.

        Args:
            navmap: the map.
            pose: of the robot.
            eye: pose of the camera; None: that of an upright robot.
        """
        eye = eye or Pose(*pose.ahead(self.camera_forward_m), pose.yaw_rad)
        cells = sight_window_cells(self.camera, navmap.frame.cell_m)
        return Frame(navmap, pose, eye, navmap.frame.window_at(eye.x_m, eye.y_m, cells))

    def add_depth(self, frame: Frame, depth: Float32[np.ndarray, "height_px width_px"]) -> bool:
        """Enters one depth image in metres into the obstacle layers.

        Returns:
            True when the image is exact, that is, shows no noise.
        """
        camera_pose, window = frame.camera_pose, frame.window
        rays, c = self._obstacle_rays, self.config
        surfaces = Surfaces.of(rays.sample(depth), c.occupancy)
        solid, tall = rays.count_obstacles(
            surfaces.depth,
            surfaces.confirmed(c.occupancy.neighbours),
            camera_pose,
            window,
            band_m=self._band_m,
            eye_level_halfwidth_m=c.eye_level_halfwidth_m,
        )
        view = frame.view
        sight = SightLines.of_frame(
            surfaces.depth, rays.up, rays.left, camera_pose, rise_m=self._band_m[1] - self.camera.height_m
        )
        part = in_range(self.camera, camera_pose, window.frame)
        self._occupancy.add(view, part, solid, tall, sight, self._occupancy.evidence_of_one(surfaces))
        self._drops.add(view, surfaces.depth, camera_pose)
        return surfaces.exact

    def add_scores(
        self,
        frame: Frame,
        depth: Float32[np.ndarray, "height_px width_px"],
        scores: Scores,
        step: int,
        *,
        rim_px: int = 0,
    ) -> Sighting:
        """Enters one frame of scores into the object layers, and returns the target points in it.

        A rim of `rim_px` pixels of the image at the target's outline does not count: with inexact depth or scores it
        may show objects next to the target.
        """
        navmap, camera_pose, window = frame.navmap, frame.camera_pose, frame.window
        rays, score_pick = self._rays_for(scores.target.shape)
        d, target, other = rays.sample(depth), scores.target[score_pick], scores.best_other[score_pick]
        candidates = target > self.config.candidate_score
        if candidates.any():
            d, confirmed = self._confirm(candidates, d)
            confirmed &= self._inner(scores.target, rim_px)[score_pick] | ~candidates
            target, candidates = np.where(confirmed, target, np.float32(0.0)), candidates & confirmed
        cells = rays.cells_below(d, camera_pose, window, self.config.score_max_height_m)
        if cells.span is None:
            return NOTHING_SIGHTED
        row, col = (indices.start for indices in cells.span)
        part = navmap.frame.part(*(_moved(indices, by) for indices, by in zip(cells.span, window.corner, strict=True)))
        navmap.grow_known(*part.index)
        scored = FrameScores(
            part.frame.shape,
            cells.rows - row,
            cells.cols - col,
            target,
            other,
            other_of_target_pixel=self.config.other_of_target_pixel,
        )
        self.layers.add(navmap.view(part), scored, step)
        shown = candidates & (cells.rows >= 0)
        if not shown.any():
            return NOTHING_SIGHTED
        self._drop_candidates(frame.view, d, candidates, rays, camera_pose)
        flat = cells.rows[shown] * np.int32(window.frame.shape[1]) + cells.cols[shown]
        return note_sighting(navmap, window, *np.divmod(np.unique(flat), window.frame.shape[1]), frame.pose)

    def add_goals(
        self,
        frame: Frame,
        depth: Float32[np.ndarray, "height_px width_px"],
        posteriors: Float32[np.ndarray, "classes h w"],
    ) -> None:
        """Enters the goal categories that one frame shows with a probability above `candidate_score`."""
        navmap, camera_pose, window = frame.navmap, frame.camera_pose, frame.window
        rays, pick = self._rays_for(posteriors.shape[1:])
        bits: UInt32[np.ndarray, "h w"] = goal_bits(
            posteriors[:, *pick], _GOAL_CHANNELS, np.float32(self.config.candidate_score)
        )
        if not bits.any():
            return
        points = rays.project(rays.sample(depth), bits != 0, camera_pose, window)
        counts = points.height_m <= self.config.score_max_height_m
        counts &= window.frame.contains(
            points.rows, points.cols
        )  # at the edge of the map the camera sees points outside the map
        enter_bits(navmap.goals_seen[window.index], points.rows, points.cols, bits[points.valid], counts)

    def _confirm(
        self, candidates: Bool[np.ndarray, "h w"], d: Float32[np.ndarray, "h w"]
    ) -> tuple[Float32[np.ndarray, "h w"], Bool[np.ndarray, "h w"]]:
        """Returns depth smoothed over the target, and False at target pixels off their neighbours' surface.

        At the rim of an object a noisy depth image shows points behind it or in front of it.
        """
        confirmed = np.ones(d.shape, np.bool_)
        rows, cols = np.flatnonzero(candidates.any(axis=1)), np.flatnonzero(candidates.any(axis=0))
        if rows.size == 0 or self.config.occupancy.neighbours == 0:
            return d, confirmed
        box = slice(rows[0], rows[-1] + 1), slice(cols[0], cols[-1] + 1)
        sure, smooth = agreeing(np.where(candidates[box], d[box], np.float32(0.0)), self.config.occupancy)
        confirmed[box] = sure | ~candidates[box]
        d[box] = np.where(candidates[box], smooth, d[box])
        return d, confirmed

    def _inner(self, target: Float32[np.ndarray, "h w"], rim_px: int) -> Bool[np.ndarray, "h w"]:
        """Returns the target pixels that are farther than `rim_px` pixels of the image from the target's outline.

        At the rim of a near object, a noisy depth image gives its distance to the target behind it. A detected outline
        that includes a part of an object in front of the target has the same effect: the agent stops too early.
        """
        candidates = (target > self.config.candidate_score).view(np.uint8)
        if rim_px == 0:
            return candidates.view(np.bool_)
        rim = -(-rim_px * target.shape[1] // self.camera.width_px)
        kernel = np.ones((2 * rim + 1, 2 * rim + 1), np.uint8)
        return np.asarray(cv2.erode(candidates, kernel, borderType=cv2.BORDER_REPLICATE), np.uint8).view(np.bool_)

    def _drop_candidates(
        self,
        view: NavMap,
        d: Float32[np.ndarray, "h w"],
        candidates: Bool[np.ndarray, "h w"],
        rays: Rays,
        camera_pose: Pose,
    ) -> None:
        """Removes candidates in free space in front of the target: a noisy image shows far targets too near."""
        rows, cols = np.divmod(np.flatnonzero(view.score_max > self.config.candidate_score), view.frame.shape[1])
        target_m = np.where(candidates, d, np.float32(np.inf)).min(axis=0)
        sight = SightLines.of_frame(
            d, rays.up, rays.left, camera_pose, rise_m=self._band_m[1] - self.camera.height_m
        ).towards(target_m)
        range_m = self.camera.min_depth_m, self.camera.max_depth_m
        drop_m = self.camera.height_m - self._band_m[0]
        passed = sight.passes(view.frame, rows, cols, drop_m, range_m, self.config.candidate_gap_m)
        view.score_max[rows[passed], cols[passed]] = 0.0
        view.score_sum[rows[passed], cols[passed]] = 0.0

    def _rays_for(self, shape: tuple[int, ...]) -> tuple[Rays, tuple[slice, slice]]:
        """Returns the rays of the score pixels that are used, and the slices that pick these from score images."""
        height, width = shape
        block_px = self.camera.width_px // max(width, 1)
        if (height * block_px, width * block_px) != (self.camera.height_px, self.camera.width_px):
            raise ConfigError(
                f"Scores must be a whole fraction of the {self.camera.height_px} x {self.camera.width_px} image, "
                f"got {height} x {width}."
            )
        every = max(1, self.config.score_stride_px // block_px)
        pick = slice(every // 2, None, every)
        if block_px not in self._score_rays:
            first_px = (every // 2) * block_px + block_px // 2  # the depth pixel in the middle of the score's block
            self._score_rays[block_px] = Rays(self.camera, first_px, every * block_px)
        return self._score_rays[block_px], (pick, pick)


def note_sighting(
    navmap: NavMap, window: Window, rows: Int[np.ndarray, " n"], cols: Int[np.ndarray, " n"], pose: Pose
) -> Sighting:
    """Returns the target points in some cells of a window, and enters into the map the side from which they were seen.

    Args:
        navmap: the map; its layers `shown_x` and `shown_y` are changed.
        window: a part of the map.
        rows: rows of the cells in the window, each cell once.
        cols: their columns.
        pose: pose of the robot in the frame of the map.
    """
    x_m, y_m = window.frame.centres(rows, cols)
    to_x_m, to_y_m = pose.x_m - x_m, pose.y_m - y_m
    distance_m = np.hypot(to_x_m, to_y_m).astype(np.float32)
    rows, cols = rows + window.rows.start, cols + window.cols.start
    navmap.shown_x[rows, cols] += to_x_m / np.maximum(distance_m, 1e-6)
    navmap.shown_y[rows, cols] += to_y_m / np.maximum(distance_m, 1e-6)
    return Sighting(rows, cols, distance_m)


def _moved(indices: slice, by: int) -> slice:
    return slice(indices.start + by, indices.stop + by)
