"""Random episodes: a start in free space from which a goal can be reached, and where the robot fits in physics."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.goals import NO_GOAL
from sim.core.interface import wrap_angle
from sim.episodes.episode import Episode
from sim.task.objectnav import Task
from sim.world.world import World

MIN_DISTANCE_M = 2.0
"""Least geodesic distance from start to goal, if the house is large enough for it."""
MAX_DISTANCE_M = 30.0
"""Largest geodesic distance: 120 forwards and the turns between them are well below 500 steps."""
MAX_TRIES = 50
"""Attempts to find a start where the robot fits."""
_ROUND_M = 4
"""Decimals of a random start, so that files stay short."""


def sample_episode(
    task: Task,
    house: str,
    rng: np.random.Generator,
    *,
    goal: str | None = None,
    start: Pose | None = None,
    episode_id: str = "drawn",
) -> Episode:
    """Returns an episode in the world of a task; a goal or start that is not given is random.

    Raises:
        EpisodeError: the goal is not in the house or cannot be reached, or the robot does not fit at the start.
    """
    world = task.world
    if start is not None:
        world.reset(start)
    goals = (goal,) if goal is not None else tuple(rng.permutation(np.array(task.truth.require_goals())).tolist())
    refusals = []
    for candidate in goals:
        try:
            begin = start or draw_start(task, candidate, rng)
            distance_m = task.distance_from(candidate, begin)
        except EpisodeError as error:
            refusals.append(error)
            continue
        if distance_m is not None:
            return Episode(episode_id, house, candidate, begin, distance_m)
        refusals.append(task.unreachable_error(candidate, begin))
    raise refusals[0]


def sample_drive(
    task: Task, house: str, rng: np.random.Generator, *, start: Pose | None = None, episode_id: str = "drawn"
) -> Episode:
    """Returns an episode without a goal, in which a person drives around; a start that is not given is random.

    Raises:
        EpisodeError: the robot does not fit at the start, or there is no place for it.
    """
    if start is not None:
        task.world.reset(start)
    begin = start or draw_start(task, NO_GOAL.text, rng, cells=task.truth.space().largest_part())
    return Episode(episode_id, house, NO_GOAL.text, begin, goals=(NO_GOAL,))


def draw_start(
    task: Task,
    goal: str,
    rng: np.random.Generator,
    *,
    floor_z_m: float = 0.0,
    cells: NDArray[np.bool_] | None = None,
    headings_rad: tuple[float, float] = (-np.pi, np.pi),
) -> Pose:
    """Returns a pose, uniform over the cells of the largest connected free space that are far enough from the goal.

    Args:
        task: of the house.
        goal: the goal category.
        rng: source of randomness.
        floor_z_m: height of the floor of the start's storey.
        cells: mask (rows, cols) of other cells to draw from.
        headings_rad: limits of the heading.

    Raises:
        EpisodeError: the goal is not in the house, or there is no place to start from.
    """
    space = task.truth.space(floor_z_m)
    if cells is None:
        distance_m = task.truth.target(goal, floor_z_m).distance_m
        cells = far_enough(np.where(space.largest_part(), distance_m, np.inf))
    allowed = np.argwhere(cells)
    for _ in range(MAX_TRIES if len(allowed) else 0):
        x_m, y_m = (
            space.frame.to_metres(allowed[rng.integers(len(allowed))]) + rng.uniform(-0.5, 0.5, 2) * space.frame.cell_m
        )
        start = Pose(
            round(float(x_m), _ROUND_M),
            round(float(y_m), _ROUND_M),
            round(wrap_angle(float(rng.uniform(*headings_rad))), _ROUND_M),
            floor_z_m,
        )
        if space.is_free(start.x_m, start.y_m) and _fits(task.world, start):
            return start
    if goal == NO_GOAL.text:
        raise EpisodeError(f"House '{task.world.house.name}' has no place to start from.")
    if not task.truth.region(goal, floor_z_m).footprints:
        raise EpisodeError(
            f"House '{task.world.house.name}' has '{goal}' on another storey only; the search starts on the one at z = "
            f"{floor_z_m:g} m."
        )
    raise EpisodeError(
        f"House '{task.world.house.name}': no place to start a search for '{goal}' from; no instance can be reached."
    )


def far_enough(
    distance_m: NDArray[np.floating], min_m: float = MIN_DISTANCE_M, max_m: float = MAX_DISTANCE_M
) -> NDArray[np.bool_]:
    """Returns (rows, cols) the cells that are far enough from a goal.

    These are the cells with a distance between two limits; in a house without such a cell, those farther than half the
    largest distance.
    """
    reachable = np.isfinite(distance_m)
    far = reachable & (distance_m >= min_m) & (distance_m <= max_m)
    if far.any() or not reachable.any():
        return far
    return reachable & (distance_m >= 0.5 * distance_m[reachable].max())


def _fits(world: World, start: Pose) -> bool:
    try:
        world.reset(start)
    except EpisodeError:
        return False
    return True
