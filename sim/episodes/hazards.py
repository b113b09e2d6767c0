"""Tells whether the shortest path of an episode leads past a hazard of its house (`sim.houses.hazards`)."""

from __future__ import annotations

import numpy as np

from sim.geometry.pose import Pose
from sim.houses.hazards import nearest_hazard_m, read_hazards, steepest_path
from sim.task.objectnav import Task

NEAR_PATH_M = 0.3
"""A path that comes this near to a hazard meets it: the robot's radius is 0.18 m, and its paths leave some margin."""


def path_meets_hazard(task: Task, goal: str, start: Pose, within_m: float = NEAR_PATH_M) -> bool:
    """Returns whether the shortest path from a start to a goal comes near to a hazard; False without a path.

    Raises:
        EpisodeError: there is no such goal category, or the house has no instance of it.
    """
    space = task.truth.space(start.floor_z_m)
    field_m = task.truth.target(goal, start.floor_z_m).distance_m
    cell = tuple(space.frame.to_cells(np.array([start.x_m, start.y_m])).tolist())
    if not np.isfinite(field_m[cell]):
        return False
    path_m = space.frame.to_metres(steepest_path(field_m, cell))
    return nearest_hazard_m(read_hazards(task.world.model), path_m) <= within_m
