"""Habitat's `ShortestPathFollower`: drives to places by the task's actions, with ground truth."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.app.bridges.habitat.env import Simulator
from sim.app.bridges.habitat.shortest_path import Places, places_of
from sim.core.errors import ConfigError, EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, Action
from sim.env.oracle import Destination, Follower
from sim.task.ground_truth import GroundTruth


class ShortestPathFollower:
    """Drives to places by the task's actions, with ground truth, as demonstrations and training scripts do.

    Args:
        sim: `Env.sim`.
        goal_radius: path length to the place at which `get_next_action` stops, metres; less than a MOVE_FORWARD counts
            as that, since a place cannot be met more exactly.
        return_one_hot: True: actions are float32 (4,) with a one.
        stop_on_error: False: raise EpisodeError where no path leads to the place, in place of stopping.

    Raises:
        ConfigError: the radius is not positive.
    """

    def __init__(
        self, sim: Simulator, goal_radius: float, return_one_hot: bool = False, stop_on_error: bool = True
    ) -> None:
        if not goal_radius > 0.0:
            raise ConfigError(f"ShortestPathFollower needs a goal_radius > 0 m, got {goal_radius}.")
        self._sim = sim
        self._radius_m = max(float(goal_radius), FORWARD_M)
        self._return_one_hot = return_one_hot
        self._stop_on_error = stop_on_error
        self._follower: Follower | None = None
        self._heading_for: tuple[tuple[GroundTruth, Pose], Places] | None = None
        self._steps = 0

    def get_next_action(self, goal_pos: ArrayLike) -> int | NDArray[np.float32]:
        """Returns the next action on the shortest path to a place of Habitat's frame (3,); stop where it is reached.

        Raises:
            EpisodeError: no path leads there, and `stop_on_error` is False.
        """
        heading_for, steps = (self._sim.paths.episode, places_of(goal_pos)), self._sim.paths.steps
        begins_again = steps == 0 or steps < self._steps
        self._steps = steps
        if self._follower is None or self._heading_for != heading_for or begins_again:
            self._follower, self._heading_for = self._towards(goal_pos), heading_for
        action = self._follower.next_action()
        if action is None and not self._stop_on_error:
            raise EpisodeError(f"No path leads to {np.asarray(goal_pos).tolist()}.")
        number = int(Action.STOP if action is None else action)
        return np.eye(len(Action), dtype=np.float32)[number] if self._return_one_hot else number

    def _towards(self, goal_pos: ArrayLike) -> Follower:
        paths = self._sim.paths
        space, field, radius_m = paths.space, paths.field(goal_pos), self._radius_m
        left_m = np.maximum(field - radius_m, 0.0).astype(np.float32)
        near = Destination(
            space, field <= radius_m, left_m, lambda x_m, y_m: space.distance_at(field, x_m, y_m) <= radius_m
        )
        return Follower(self._sim.env, near)
