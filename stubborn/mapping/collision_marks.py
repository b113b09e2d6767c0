"""Marks on the map where a move failed, and the ground that the body has driven over.

Paper: Mapping Module, the multi-scale collision map. A depth image misses thin legs, glass and surfaces nearer than the
camera's range. A failed move shows that an obstacle is there, but not its exact place or size. Therefore two marks are
kept: one is probably too large (pessimistic) and one is probably too small (optimistic).
"""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from sim.core.geometry.grid import GridFrame, cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, TURN_RAD, Action, ConfigError, wrap_angle
from stubborn.mapping.navmap import CollisionLayer, NavMap

STAYED_M = 0.4 * FORWARD_M
"""A robot that moved less than this in a step stayed where it was."""


@dataclass(frozen=True, kw_only=True)
class CollisionConfig:
    """Size and place of the marks, and the rule for a failed move."""

    wide_m: float = 0.25
    """Edge of the pessimistic square."""
    narrow_m: float = 0.15
    """Edge of the optimistic square."""
    near_edge_m: float = 0.15
    """Distance from the robot's centre to the near edge of both squares."""
    failed_below_m: float = 0.20
    """A MOVE_FORWARD that moved less than this is a collision. A real body slides, so that 0 would miss most."""
    jitter_sigmas: float = 2.5
    """With a noisy gps, a failed forward must also be shorter than a whole one by this many standard deviations."""
    least_failed_m: float = 0.10
    """A forward that seems to have moved less than this is always a collision, even if the gps is noisy."""
    trail_radius_m: float = 0.07
    """Half the width of the trail that the robot's centre leaves: a cell and its neighbours."""

    def __post_init__(self) -> None:
        if not 0.0 < self.narrow_m <= self.wide_m:
            raise ConfigError(f"CollisionConfig needs 0 < narrow_m <= wide_m, got {self.narrow_m} and {self.wide_m} m.")


def is_collision(action: Action | None, moved_m: float, failed_below_m: float) -> bool:
    """Returns whether the last action was a forward that was blocked."""
    return action is Action.MOVE_FORWARD and moved_m < failed_below_m


def pushed_without_moving(before: Pose, now: Pose) -> bool:
    """Returns whether a step between two poses neither moved nor turned the robot: something blocked a forward."""
    turned_rad = abs(wrap_angle(now.yaw_rad - before.yaw_rad))
    return now.distance_to(before) < STAYED_M and turned_rad < TURN_RAD / 2


class GpsNoise:
    """Estimates the noise of the gps from turns on the spot, during which the robot does not move.

    The distance between two readings with normal noise has a Rayleigh distribution with a median of 1.177 standard
    deviations. The median is robust against single turns in which the robot was pushed aside.
    """

    _FEWEST = 3
    _MEDIAN_SIGMAS = math.sqrt(2.0 * math.log(2.0))

    def __init__(self) -> None:
        self._moved_m: list[float] = []

    def observe(self, action: Action | None, moved_m: float) -> None:
        """Notes the distance that the last action seems to have moved the robot."""
        if action in (Action.TURN_LEFT, Action.TURN_RIGHT):
            self._moved_m.append(moved_m)

    def std_m(self) -> float:
        """Returns the standard deviation of a measured move in any direction; 0 until some turns were made."""
        if len(self._moved_m) < self._FEWEST:
            return 0.0
        return statistics.median(self._moved_m) / self._MEDIAN_SIGMAS

    def failed_below_m(self, config: CollisionConfig) -> float:
        """Returns the distance below which a forward has failed: the configured one, or less with larger noise."""
        return max(
            min(config.failed_below_m, FORWARD_M - config.jitter_sigmas * self.std_m()),
            min(config.least_failed_m, config.failed_below_m),
        )


def square_ahead(
    frame: GridFrame, pose: Pose, edge_m: float, near_edge_m: float
) -> tuple[tuple[slice, slice], Bool[np.ndarray, "rows cols"]]:
    """Returns the cells with their centre in a square ahead of the robot, which is rotated with its heading.

    The result is the index of a small rectangle of `frame` and the mask inside it. Every cell is tested on its own, so
    that no heading leaves a hole.
    """
    middle_xy_m = pose.ahead(near_edge_m + 0.5 * edge_m)
    patch = frame.patch(middle_xy_m[:1], middle_xy_m[1:], edge_m)
    x_m, y_m = patch.frame.mesh()
    cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    ahead_m = cos * (x_m - pose.x_m) + sin * (y_m - pose.y_m)
    left_m = -sin * (x_m - pose.x_m) + cos * (y_m - pose.y_m)
    inside = (ahead_m >= near_edge_m) & (ahead_m <= near_edge_m + edge_m) & (np.abs(left_m) <= 0.5 * edge_m)
    return patch.index, inside


def mark_collision(navmap: NavMap, pose: Pose, layers: tuple[CollisionLayer, ...], config: CollisionConfig) -> None:
    """Enters a mark into each of some layers, in front of the pose at which the failed move ended."""
    edges_m = {CollisionLayer.PESSIMISTIC: config.wide_m, CollisionLayer.OPTIMISTIC: config.narrow_m}
    for layer in layers:
        index, inside = square_ahead(navmap.frame, pose, edges_m[layer], config.near_edge_m)
        navmap.collision_marks(layer)[index] |= inside


def mark_visited(navmap: NavMap, before: Pose, now: Pose, robot_radius_m: float, config: CollisionConfig) -> None:
    """Enters the ground that the body swept from one pose to the next."""
    start, end = (before.x_m, before.y_m), (now.x_m, now.y_m)
    for layer, radius_m in ((navmap.visited, robot_radius_m), (navmap.trail, config.trail_radius_m)):
        index, inside = cells_near_segment(navmap.frame, start, end, radius_m)
        layer[index] |= inside
        navmap.grow_known(*index)
