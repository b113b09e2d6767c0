"""Finds the hazards of a house that lie on the shortest path of an episode (`sim.houses.hazards`)."""

from __future__ import annotations

import numpy as np

from sim.geometry.pose import Pose
from sim.houses.hazards import Hazard, nearest_hazard_m, read_hazards, steepest_path
from sim.task.objectnav import Task

NEAR_PATH_M = 0.3
"""A path that comes this near to a hazard meets it: the robot's radius is 0.18 m, and its paths leave some margin."""


def hazards_on_path(task: Task, goal: str, start: Pose, within_m: float = NEAR_PATH_M) -> tuple[Hazard, ...]:
    """Returns the hazards to which the shortest path from a start to a goal comes near; none without a path.

    Raises:
        EpisodeError: there is no such goal category, or the house has no instance of it.
    """
    space = task.truth.space(start.floor_z_m)
    field_m = task.truth.target(goal, start.floor_z_m).distance_m
    cell = space.frame.cell(start.x_m, start.y_m)
    if not np.isfinite(field_m[cell]):
        return ()
    path_m = space.frame.to_metres(steepest_path(field_m, cell))
    hazards = read_hazards(task.world.model)
    return tuple(hazard for hazard in hazards if nearest_hazard_m([hazard], path_m) <= within_m)
