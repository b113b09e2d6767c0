"""Selects the starts of the episodes of a split, by the rules of `sim.episodes.recipes`.

A rule restricts the cells of the free space from which a start is sampled (`start_cells`), and tests that start
(`Lookout`). A goal that leaves too few cells is not used.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.pose import Pose
from sim.episodes.drawing import far_enough
from sim.episodes.recipes import EpisodeRecipe
from sim.houses.hazards import read_hazards
from sim.renderer.camera import Camera
from sim.task.metrics import EXPLORED_SHARE, goal_share
from sim.task.objectnav import Task
from sim.world.freespace import FreeSpace

MIN_START_M2 = 1.0
"""Smaller areas hold too few different starts for a rule."""
NEAR_PATH_M = 0.3
"""A path that comes this near to a hazard meets it: the robot's radius is 0.18 m, and its paths leave some margin."""
FARTHER_PATH_M = 1.0
"""If no path leads within `NEAR_PATH_M` of a hazard, one within this distance counts."""
VIEWS = 6
"""Headings of the camera around a start that are checked, 60 degrees apart; the camera's view is 79 degrees wide."""
EDGE_STRETCH = 2.5
"""An object covers up to 1 / cos(39.5 deg)^3 = 2.2 times as much of the frame at its edge as in its middle."""


def start_cells(
    task: Task, goal: str, floor_z_m: float, recipe: EpisodeRecipe, instances: int
) -> NDArray[np.bool_] | None:
    """Returns the cells (rows, cols) of the largest free space from which a goal may be asked for.

    Args:
        task: of the house.
        goal: a goal category that can be reached.
        floor_z_m: storey of the start.
        recipe: its rule and distances.
        instances: number of reachable instances on the storey.

    Returns:
        None where the rule leaves less than `MIN_START_M2`; the rule `any` leaves what there is.
    """
    space = task.truth.space(floor_z_m)
    distance_m = np.where(space.largest_part(), task.truth.target(goal, floor_z_m).distance_m, np.inf)
    limits_m = (recipe.min_distance_for(instances), recipe.max_distance_m)
    if recipe.rule == "any":
        return far_enough(distance_m, *limits_m)
    cells = np.isfinite(distance_m) & (distance_m >= limits_m[0]) & (distance_m <= limits_m[1])
    if recipe.rule == "hazard":
        cells = _past_a_hazard(task, space, distance_m, cells)
    return cells if _is_enough(cells, space) else None


def has_enough_starts(task: Task, goal: str, floor_z_m: float, recipe: EpisodeRecipe, instances: int) -> bool:
    """Returns whether enough places meet the rule and the distances of a recipe; arguments as for `start_cells`."""
    cells = start_cells(task, goal, floor_z_m, recipe, instances)
    if cells is None or recipe.rule != "any":
        return cells is not None
    space = task.truth.space(floor_z_m)
    distance_m = task.truth.target(goal, floor_z_m).distance_m
    return _is_enough(cells & (distance_m >= recipe.min_distance_for(instances)), space)


def quadrant_headings(number: int, house: int, seed: int) -> tuple[float, float]:
    """Returns the limits of the heading of an episode: a quarter of the circle around 0, 90, 180 or -90 degrees.

    Four episodes of a house in a row have the four quarters in random order, and so have four houses in a row.

    Args:
        number: of the episode in its house.
        house: number of the house in its split.
        seed: of the split.
    """
    order = np.random.default_rng([seed, number // 4]).permutation(4)
    middle = float((order[number % 4] + house) % 4) * 0.5 * math.pi
    return middle - 0.25 * math.pi, middle + 0.25 * math.pi


def leads_past(distance_m: NDArray[np.floating], marked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Returns the cells (rows, cols) whose shortest path, down a field of distances, passes a marked cell.

    Each cell is followed by its neighbour with the smallest distance, the source by itself. Doubling the length of the
    paths in each round needs as many rounds as the logarithm of the longest path.
    """
    rows, cols = distance_m.shape
    padded = np.pad(distance_m, 1, constant_values=np.inf)
    best_m, following = distance_m.copy(), np.arange(rows * cols).reshape(rows, cols)
    here = following.copy()
    for row, col in ((r, c) for r in (0, 1, 2) for c in (0, 1, 2) if (r, c) != (1, 1)):
        neighbour_m = padded[row : row + rows, col : col + cols]
        lower = neighbour_m < best_m
        best_m[lower] = neighbour_m[lower]
        following[lower] = here[lower] + (row - 1) * cols + (col - 1)
    passed, following = (marked & np.isfinite(distance_m)).ravel(), following.ravel()
    while True:
        passed = passed | passed[following]
        after = following[following]
        if np.array_equal(after, following):
            return passed.reshape(rows, cols) & np.isfinite(distance_m)
        following = after


class Lookout:
    """Returns whether a goal is visible from a start, by the rule of GT exploration.

    Args:
        task: of the house; its world is only read.
    """

    def __init__(self, task: Task) -> None:
        self._world = task.world
        self._camera = Camera(task.world.model, task.world.labels, camera=task.truth.camera)

    def sees(self, goal: str, pose: Pose, share: float = EXPLORED_SHARE) -> bool:
        """Returns whether the goal covers this share of the frame at a pose; objects are where they are now."""
        frame = self._camera.render(self._world.data, pose, ("semantic",))["semantic"]
        return goal_share(frame, goal) >= share

    def sees_around(self, goal: str, pose: Pose) -> bool:
        """Returns whether the goal may be visible from the place of a pose, in any direction."""
        turns = np.arange(VIEWS) * 2.0 * math.pi / VIEWS
        least = EXPLORED_SHARE / EDGE_STRETCH
        return any(self.sees(goal, replace(pose, yaw_rad=pose.yaw_rad + float(turn)), least) for turn in turns)

    def close(self) -> None:
        """Frees the renderer."""
        self._camera.close()


def _past_a_hazard(
    task: Task, space: FreeSpace, distance_m: NDArray[np.floating], cells: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Returns the cells whose shortest path leads past a hazard, as near as the house has enough such paths."""
    hazards = read_hazards(task.world.model)
    finite = np.argwhere(np.isfinite(distance_m))
    places_m = space.frame.to_metres(finite)
    nearest_m = np.full(distance_m.shape, np.inf)
    for hazard in hazards:
        at = tuple(finite.T)
        nearest_m[at] = np.minimum(nearest_m[at], hazard.distance_m(places_m))
    past = np.zeros_like(cells)
    for within_m in (NEAR_PATH_M, FARTHER_PATH_M):
        past = cells & leads_past(distance_m, nearest_m <= within_m)
        if _is_enough(past, space):
            break
    return past


def _is_enough(cells: NDArray[np.bool_], space: FreeSpace) -> bool:
    return int(np.count_nonzero(cells)) * space.frame.cell_m**2 >= MIN_START_M2
