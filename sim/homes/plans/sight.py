"""The camera in a plan: the parts of floor and goal that one look shows, and the cells that it enters into a map."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, CameraModel, ConfigError
from sim.homes.plans.plan import Plan
from sim.homes.plans.sight_kernels import cast_rays, enter_frame

_MAX_ROWS = 128  # two words of 64 bits
_NO_GOAL = -2


class MapLayers(Protocol):
    """The layers that a look changes: those of `stubborn.mapping.navmap.NavMap` with these names, on `frame`."""

    frame: GridFrame
    frames_in_view: NDArray[np.uint32]
    obstacle_evidence: NDArray[np.int8]
    seen_obstacle: NDArray[np.bool_]
    seen_at_eye_level: NDArray[np.bool_]
    score_max: NDArray[np.float32]
    goals_seen: NDArray[np.uint32]


@dataclass(frozen=True, kw_only=True)
class SightConfig:
    """Resolution of the image, and which of its pixels enter which layer (as in the agent's `MappingConfig`)."""

    stride_px: int = 4
    """Spacing of the pixels that are computed, in rows and columns of the camera."""
    obstacle_min_height_m: float = 0.10
    """Lower surfaces are floor."""
    obstacle_max_height_m: float = 0.88
    """Higher surfaces are overhead."""
    score_max_height_m: float = 2.2
    """Points up to this height are in view."""
    eye_level_halfwidth_m: float = 0.06
    """Surfaces this near the camera's height are at eye level."""
    hit: int = 2
    """Evidence for an obstacle that a frame adds."""
    most: int = 10
    """Evidence does not grow beyond this."""
    obstacle_from: int = 2
    """A cell with at least this much evidence is an obstacle."""

    def __post_init__(self) -> None:
        if self.stride_px < 1:
            raise ConfigError(f"SightConfig.stride_px must be >= 1, got {self.stride_px}.")


@dataclass(frozen=True, eq=False)
class Look:
    """One frame."""

    shares: NDArray[np.float64]
    """(goals,) Share of the frame that each category of `GOAL_CATEGORIES` covers."""
    goal_share: float
    """The value of the goal; 0 without a goal."""
    touched: tuple[slice, slice] | None
    """Rectangle of the map that holds all points of the frame; None: the frame has no points."""


class PlanCamera:
    """The camera of the default robot in one plan. It remembers which floor it has seen since `reset`."""

    def __init__(self, plan: Plan, config: SightConfig | None = None) -> None:
        """Prepares the rays.

        Raises:
            ConfigError: the image has more than 128 rows after the stride.
        """
        self.plan = plan
        self.camera = CameraModel()
        self.config = config or SightConfig()
        stride, focal_px = self.config.stride_px, self.camera.focal_px
        u_px = np.arange(stride // 2, self.camera.width_px, stride)
        v_px = np.arange(stride // 2, self.camera.height_px, stride)
        if not 2 <= len(v_px) <= _MAX_ROWS:
            raise ConfigError(
                f"SightConfig.stride_px of {stride} leaves {len(v_px)} of {self.camera.height_px} rows of the image; "
                f"there must be 2 to {_MAX_ROWS}."
            )
        self._left = (0.5 * self.camera.width_px - (u_px + 0.5)) / focal_px
        self._up = (0.5 * self.camera.height_px - (v_px + 0.5)) / focal_px
        self._span_goal = plan.span_goals()
        self._flags = np.zeros((0, 0), np.uint8)
        """Flags of the cells of a map, 0 between two looks; made at the first look into a map of another shape."""
        self._touched = np.zeros(4 * self._left.size * self._up.size, np.int32)
        self.reset()

    def reset(self) -> None:
        """Forgets the cells that were seen."""
        self.seen_floor = np.zeros(self.plan.frame.shape, np.bool_)
        """Floor of the plan that was in view."""
        self._seen_cells = 0

    @property
    def area_seen_m2(self) -> float:
        """Area of the floor that was in view."""
        return self._seen_cells * self.plan.frame.cell_m**2

    def look(self, pose: Pose, goal: str | None, layers: MapLayers, map_pose: Pose) -> Look:
        """Looks from a pose and enters the frame into the layers of a map.

        Args:
            pose: of the robot, in the world; the camera is above its centre.
            goal: the goal category; None: no goal.
            layers: of the map; they are changed.
            map_pose: the same pose in the frame of the map.
        """
        frame, config = layers.frame, self.config
        if self._flags.shape != frame.shape:
            self._flags = np.zeros(frame.shape, np.uint8)
        pixels = np.zeros(len(GOAL_CATEGORIES), np.int64)
        number = _NO_GOAL if goal is None else GOAL_CATEGORIES.index(goal)
        count, new = cast_rays(
            self.plan.span_start,
            self.plan.span_low_m,
            self.plan.span_high_m,
            self._span_goal,
            self.plan.floor,
            self.plan.ceiling_m,
            self.plan.frame.cell_m,
            _place(pose, self.plan.frame),
            self._left,
            self._up,
            (self.camera.height_m, self.camera.min_depth_m, self.camera.max_depth_m),
            (
                config.obstacle_min_height_m,
                config.obstacle_max_height_m,
                config.score_max_height_m,
                config.eye_level_halfwidth_m,
            ),
            number,
            _place(map_pose, frame),
            frame.cell_m,
            self._flags,
            self._touched,
            self.seen_floor,
            layers.goals_seen,
            pixels,
        )
        row_0, row_1, col_0, col_1 = enter_frame(
            self._flags,
            self._touched,
            count,
            layers.frames_in_view,
            layers.obstacle_evidence,
            layers.seen_obstacle,
            layers.seen_at_eye_level,
            layers.score_max,
            config.hit,
            config.most,
            config.obstacle_from,
        )
        self._seen_cells += new
        touched = None if row_1 < 0 else (slice(row_0, row_1 + 1), slice(col_0, col_1 + 1))
        shares = pixels / (self._left.size * self._up.size)
        return Look(shares, 0.0 if goal is None else float(shares[number]), touched)


def _place(pose: Pose, frame: GridFrame) -> tuple[float, float, float, float]:
    """Returns row and column with fractions, cosine and sine of the heading."""
    return (
        (pose.y_m - frame.origin_xy_m[1]) / frame.cell_m,
        (pose.x_m - frame.origin_xy_m[0]) / frame.cell_m,
        math.cos(pose.yaw_rad),
        math.sin(pose.yaw_rad),
    )
