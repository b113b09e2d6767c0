"""Decides when the robot looks aside: a turn does not lengthen the path, and a room seen from its door can be left out.

This is not in the paper. Where a turn on the spot would show much ground that was never in view, for example at an open
door or a corner, the robot looks there before it moves on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64

from sim.core.geometry.pose import Pose
from sim.core.interface import TURN_RAD, Action, CameraModel, ConfigError, wrap_angle
from stubborn.mapping.navmap import NavMap

_TURNS = (*range(-5, 0), *range(1, 7))
"""The headings that are compared, in turns to the left."""
_RAYS = 72
_STEP_M = 0.05  # a cell: longer steps would pass through thin walls
_GAP_STEPS = 4
_SAME_HEADING_RAD = 0.5 * TURN_RAD
_SAME_PLACE_M = 0.1
"""If the robot is farther than this from its last place, it has done something else since it began to turn."""


@dataclass(frozen=True, kw_only=True)
class GlanceConfig:
    """Parameters of the choice of a look."""

    gain_per_turn_m2: float = 0.75
    """New area that a look must show for each of its turns (there and back); 1e9: the robot never looks aside."""
    range_m: float = 3.5
    """Ground farther away than this does not count."""
    not_again_within_m: float = 1.0
    """Within this distance of a place from which the robot looked in a direction, it does not look in that direction
    again."""

    def __post_init__(self) -> None:
        if self.range_m < 0.5:
            raise ConfigError(f"GlanceConfig.range_m must be at least 0.5 m, got {self.range_m}.")


class Glancer:
    """Decides when to look aside; remembers the poses from which it has looked."""

    def __init__(self, config: GlanceConfig, camera: CameraModel) -> None:
        self.config = config
        self._half_view_rad = 0.5 * camera.hfov_rad
        # Nearer floor is below the image.
        nearest_m = camera.height_m / math.tan(0.5 * camera.vfov_rad)
        self._range_m = np.arange(_STEP_M, config.range_m, _STEP_M)
        self._bearing_rad = np.arange(_RAYS) * (math.tau / _RAYS)
        self._area_m2 = np.where(self._range_m >= nearest_m, self._range_m, 0.0) * _STEP_M * (math.tau / _RAYS)
        self.reset()

    def reset(self) -> None:
        """Forgets the last episode."""
        self._looks: list[Pose] = []
        self._aim_rad: float | None = None

    def next_turn(self, navmap: NavMap, pose: Pose) -> Action | None:
        """Returns a turn towards a heading that is worth a look; None without such a heading."""
        moved = bool(self._looks) and pose.distance_to(self._looks[-1]) > _SAME_PLACE_M
        self._looks.append(pose)
        if moved or (self._aim_rad is not None and abs(wrap_angle(self._aim_rad - pose.yaw_rad)) <= _SAME_HEADING_RAD):
            self._aim_rad = None
        if self._aim_rad is None:
            self._aim_rad = self._worth_a_look(navmap, pose)
        if self._aim_rad is None:
            return None
        return Action.TURN_LEFT if wrap_angle(self._aim_rad - pose.yaw_rad) > 0 else Action.TURN_RIGHT

    def _worth_a_look(self, navmap: NavMap, pose: Pose) -> float | None:
        """Returns the heading that would show most new ground; None: no heading shows enough."""
        hidden_m2 = self.hidden_area_m2(navmap, pose)
        headings_rad = [wrap_angle(pose.yaw_rad + turn * TURN_RAD) for turn in _TURNS]
        apart_rad = self._bearing_rad - np.array(headings_rad)[:, None]
        in_view = np.abs(np.arctan2(np.sin(apart_rad), np.cos(apart_rad))) <= self._half_view_rad
        best_gain_m2, best_rad = 0.0, None
        for turn, heading_rad, seen in zip(_TURNS, headings_rad, in_view, strict=True):
            gain_m2 = float(hidden_m2[seen].sum()) - 2 * abs(turn) * self.config.gain_per_turn_m2
            if gain_m2 > best_gain_m2 and not self._looked(pose, heading_rad):
                best_gain_m2, best_rad = gain_m2, heading_rad
        return best_rad

    def hidden_area_m2(self, navmap: NavMap, pose: Pose) -> Float64[np.ndarray, " bearings"]:
        """Returns, per bearing, the area of ground never in view that no known obstacle hides from the robot."""
        x_m = pose.x_m + self._range_m[None, :] * np.cos(self._bearing_rad)[:, None]
        y_m = pose.y_m + self._range_m[None, :] * np.sin(self._bearing_rad)[:, None]
        rows, cols = navmap.frame.cells(x_m, y_m)
        rows, cols = np.clip(rows, 0, navmap.frame.shape[0] - 1), np.clip(cols, 0, navmap.frame.shape[1] - 1)
        open_so_far = ~np.logical_or.accumulate(navmap.seen_obstacle[rows, cols], axis=1)
        seen = (navmap.frames_in_view[rows, cols] > 0).view(np.uint8)
        near_seen = cv2.dilate(seen, np.ones((1, 2 * _GAP_STEPS + 1), np.uint8))  # far floor is seen with gaps
        return np.asarray((open_so_far & (near_seen == 0)) @ self._area_m2)

    def _looked(self, pose: Pose, heading_rad: float) -> bool:
        return any(
            look.distance_to(pose) <= self.config.not_again_within_m
            and abs(wrap_angle(look.yaw_rad - heading_rad)) <= _SAME_HEADING_RAD
            for look in self._looks
        )
