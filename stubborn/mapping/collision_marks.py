"""What the robot learns by bumping: marks where a move failed, free ground where the body has been.

Paper: Mapping Module, the multi-scale collision map. A depth image misses thin legs, glass and whatever is nearer than
the camera's range; a failed move says that something is there, but not where exactly or how large it is. So two marks
are kept, one that is probably too large (pessimistic) and one that is probably too small (optimistic).
"""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.geometry.grid import GridFrame, cells_near_segment
from sim.geometry.pose import Pose
from sim.interface import FORWARD_M, Action, ConfigError
from stubborn.navmap import NavMap


@dataclass(frozen=True, kw_only=True)
class CollisionConfig:
    """Size and place of the marks."""

    wide_m: float = 0.25
    """Edge of the pessimistic square."""
    narrow_m: float = 0.15
    """Edge of the optimistic square."""
    near_edge_m: float = 0.15
    """From the robot's centre to the near edge of both squares."""
    failed_below_m: float = 0.20
    """A MOVE_FORWARD that moved less than this is a collision: a real body slides, so "unmoved" would miss most."""
    jitter_sigmas: float = 2.5
    """With a jittery gps a forward must fall short of a whole one by so many standard deviations too."""
    least_failed_m: float = 0.10
    """However jittery the gps, a forward that seems to have moved less than this is a collision."""
    trail_radius_m: float = 0.07
    """Half the width of the trail that the robot's centre leaves: a cell and its neighbours."""

    def __post_init__(self) -> None:
        if not 0.0 < self.narrow_m <= self.wide_m:
            raise ConfigError(f"CollisionConfig needs 0 < narrow_m <= wide_m, got {self.narrow_m} and {self.wide_m} m.")


def is_collision(action: Action | None, moved_m: float, failed_below_m: float) -> bool:
    """Whether the last action was a forward that did not get through."""
    return action is Action.MOVE_FORWARD and moved_m < failed_below_m


class Jitter:
    """How much the pose jumps while the robot stands: what a turn on the spot seems to have moved is noise of the gps.

    Between two readings with normal noise the distance has a Rayleigh distribution, whose median is 1.177 standard
    deviations; the median does not mind the turn that did push the robot aside.
    """

    _FEWEST = 3
    _MEDIAN_SIGMAS = math.sqrt(2.0 * math.log(2.0))

    def __init__(self) -> None:
        self._moved_m: list[float] = []

    def observe(self, action: Action | None, moved_m: float) -> None:
        """Take in how far the last action seems to have moved the robot."""
        if action in (Action.TURN_LEFT, Action.TURN_RIGHT):
            self._moved_m.append(moved_m)

    def std_m(self) -> float:
        """Standard deviation of a measured move along any direction; 0 until some turns were made."""
        if len(self._moved_m) < self._FEWEST:
            return 0.0
        return statistics.median(self._moved_m) / self._MEDIAN_SIGMAS

    def failed_below_m(self, config: CollisionConfig) -> float:
        """Below which distance a forward has failed: as configured, less where that would be within the jitter."""
        return max(
            min(config.failed_below_m, FORWARD_M - config.jitter_sigmas * self.std_m()),
            min(config.least_failed_m, config.failed_below_m),
        )


def square_ahead(
    frame: GridFrame, pose: Pose, edge_m: float, near_edge_m: float
) -> tuple[tuple[slice, slice], NDArray[np.bool_]]:
    """Cells whose centre lies in the square ahead of the robot, rotated with its heading.

    Every cell is tested on its own, so no heading leaves a hole. Returns the index of a small rectangle of `frame`
    and the mask inside it.
    """
    middle_xy_m = pose.ahead(near_edge_m + 0.5 * edge_m)
    patch = frame.patch(middle_xy_m[0], middle_xy_m[1], edge_m)
    x_m, y_m = patch.frame.mesh()
    cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    ahead_m = cos * (x_m - pose.x_m) + sin * (y_m - pose.y_m)
    left_m = -sin * (x_m - pose.x_m) + cos * (y_m - pose.y_m)
    inside = (ahead_m >= near_edge_m) & (ahead_m <= near_edge_m + edge_m) & (np.abs(left_m) <= 0.5 * edge_m)
    return patch.index, inside


def mark_collision(navmap: NavMap, pose: Pose, config: CollisionConfig) -> None:
    """Enter both marks in front of where the failed move ended."""
    for layer, edge_m in ((navmap.bumped_wide, config.wide_m), (navmap.bumped_narrow, config.narrow_m)):
        index, inside = square_ahead(navmap.frame, pose, edge_m, config.near_edge_m)
        layer[index] |= inside


def mark_visited(navmap: NavMap, before: Pose, now: Pose, robot_radius_m: float, config: CollisionConfig) -> None:
    """Enter what the body swept over from one pose to the next."""
    start, end = (before.x_m, before.y_m), (now.x_m, now.y_m)
    for layer, radius_m in ((navmap.visited, robot_radius_m), (navmap.trail, config.trail_radius_m)):
        index, inside = cells_near_segment(navmap.frame, start, end, radius_m)
        layer[index] |= inside
        navmap.grow_known(*index)
