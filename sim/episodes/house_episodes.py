"""Draws the episodes of one house by the recipe of its split: the goals that it offers, and their starts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import wrap_angle
from sim.episodes import habitat
from sim.episodes.drawing import draw_start
from sim.episodes.reachable_goals import find_reachable_goals, storeys_of
from sim.episodes.recipes import EpisodeRecipe
from sim.episodes.start_rules import Lookout, has_enough_starts, quadrant_headings, start_cells
from sim.houses.sidecar import EMPTY_SIDECAR, Sidecar
from sim.task.objectnav import Task

MAX_REDRAWS = 20
"""Attempts to find a start at an allowed distance; a house can be too small for one."""
MAX_HIDDEN_REDRAWS = 60
"""Attempts to find a start from which the goal is not visible."""


class Ask(NamedTuple):
    """A goal that a house can ask for, on one of its storeys."""

    goal: str
    floor_z_m: float = 0.0
    instances: int = 1
    """Number of its reachable instances on the storey."""


@dataclass(frozen=True)
class HouseAsks:
    """The goals of a house and the episodes that it can have."""

    listed: Mapping[str, list[habitat.Goal]]
    """For each goal category with an instance that can be reached, Habitat's goals with their view points."""
    unreachable: tuple[str, ...]
    """Names of goal instances that cannot be reached from the largest free space of their storey."""
    asks: tuple[Ask, ...]
    """Goals with enough starts by the rule of the recipe, or the goals that the sidecar and its start allow."""
    most: int | None = None
    """Largest number of different episodes that the house can have; None: no limit."""


class DrawnStart(NamedTuple):
    """A start, and whether it meets the rule of its recipe."""

    pose: Pose
    distance_m: float | None
    meets_rule: bool


def find_house_asks(task: Task, recipe: EpisodeRecipe, fixed: Sidecar = EMPTY_SIDECAR) -> HouseAsks:
    """Returns the goals of all storeys of a house, and those that an episode can ask for by a recipe.

    A goal without enough starts, such as one that is near everywhere in a small home, is not asked for; where no goal
    of a house has enough, all can be, except with the rule `hidden`.

    Args:
        task: the task in the house.
        recipe: the recipe of the split.
        fixed: the sidecar of the house. Its goal is the only one; its start replaces the rule of the recipe.

    Raises:
        EpisodeError: the goal or the start of the sidecar is not possible.
    """
    listed: dict[str, list[habitat.Goal]] = {}
    unreachable: list[str] = []
    reachable: list[Ask] = []
    for floor_z_m in storeys_of(task):
        goals = find_reachable_goals(task, max_view_points=recipe.view_points, floor_z_m=floor_z_m)
        unreachable += goals.unreachable
        for goal, instances in goals.listed.items():
            listed.setdefault(goal, []).extend(instances)
            reachable.append(Ask(goal, floor_z_m, len(instances)))
    if fixed.goal is not None:
        reachable = [ask for ask in reachable if ask.goal == fixed.goal]
        listed = {goal: instances for goal, instances in listed.items() if goal == fixed.goal}
        _require(reachable, task, f"asks for '{fixed.goal}', but the robot can reach no instance of it")
    if fixed.start is not None:
        task.world.reset(fixed.start)
        asks = [ask for ask in reachable if _leads_to(task, ask, fixed.start)]
        _require(asks, task, "has a start from which no goal can be reached")
        return HouseAsks(listed, tuple(unreachable), tuple(asks), most=len(asks) * len(recipe.turns_rad))
    asks = [ask for ask in reachable if has_enough_starts(task, *ask[:2], recipe, ask.instances)]
    if recipe.rule != "hidden" and not asks:
        asks = reachable
    return HouseAsks(listed, tuple(unreachable), tuple(asks))


def _leads_to(task: Task, ask: Ask, start: Pose) -> bool:
    """Returns whether there is a path from a start to a goal on the same storey."""
    same_storey = abs(ask.floor_z_m - start.floor_z_m) < task.config.success.same_storey_m
    return same_storey and task.distance_from(ask.goal, start) is not None


def _require(asks: Sequence[Ask], task: Task, fault: str) -> None:
    """Raises EpisodeError if the sidecar of a house leaves no goal."""
    if not asks:
        raise EpisodeError(f"House '{task.world.house.name}': its sidecar {fault}.")


def turned_start(task: Task, ask: Ask, start: Pose, number: int, recipe: EpisodeRecipe) -> DrawnStart:
    """Returns the start that a sidecar fixes, with the heading of an episode.

    Args:
        task: the task in the house.
        ask: the goal of the episode.
        start: the start that the sidecar fixes.
        number: number of the episode among those with this goal; it selects one of the recipe's turns.
        recipe: the recipe of the split.

    Raises:
        EpisodeError: the robot has a contact at the start.
    """
    yaw_rad = round(wrap_angle(start.yaw_rad + recipe.turns_rad[number % len(recipe.turns_rad)]), 4)
    pose = replace(start, yaw_rad=yaw_rad)
    task.world.reset(pose)
    return DrawnStart(pose, task.distance_from(ask.goal, pose), meets_rule=True)


class StartDrawer:
    """Draws starts in one house by a recipe.

    Args:
        task: of the house.
        recipe: of the split.
        house: number of the house in its split.
        seed: of the split.
    """

    def __init__(self, task: Task, recipe: EpisodeRecipe, *, house: int, seed: int) -> None:
        self._task, self._recipe, self._house, self._seed = task, recipe, house, seed
        self._lookout = Lookout(task) if recipe.rule == "hidden" else None
        self._cells: dict[Ask, NDArray[np.bool_] | None] = {}

    def draw(self, ask: Ask, number: int, rng: np.random.Generator) -> DrawnStart:
        """Returns a start for a goal: within the limits of the distance for the exact place, not only for its cell.

        Args:
            ask: the goal.
            number: of the episode in the house.
            rng: source of randomness.

        Raises:
            EpisodeError: there is no place to start from.
        """
        if ask not in self._cells:
            self._cells[ask] = start_cells(self._task, *ask[:2], self._recipe, ask.instances)
        if self._lookout is not None:
            headings_rad = quadrant_headings(number, self._house, self._seed)
            return self._draw_hidden(self._lookout, ask, headings_rad, rng)
        for _ in range(MAX_REDRAWS):
            drawn = self._draw_once(ask, (-math.pi, math.pi), rng)
            if drawn.meets_rule:
                return drawn
        return self._draw_once(ask, (-math.pi, math.pi), rng)

    def close(self) -> None:
        """Frees the renderer."""
        if self._lookout is not None:
            self._lookout.close()

    def _draw_once(self, ask: Ask, headings_rad: tuple[float, float], rng: np.random.Generator) -> DrawnStart:
        """Returns any start in the allowed cells; it meets the rule if its exact distance is within the limits."""
        goal, floor_z_m, instances = ask
        cells = self._cells[ask]
        pose = draw_start(self._task, goal, rng, floor_z_m=floor_z_m, cells=cells, headings_rad=headings_rad)
        distance_m = self._task.distance_from(goal, pose)
        limits_m = (self._recipe.min_distance_for(instances), self._recipe.max_distance_m)
        within = distance_m is not None and limits_m[0] <= distance_m <= limits_m[1]
        return DrawnStart(pose, distance_m, within and (cells is not None))

    def _draw_hidden(
        self, lookout: Lookout, ask: Ask, headings_rad: tuple[float, float], rng: np.random.Generator
    ) -> DrawnStart:
        """Returns a start from which the goal is not visible in any direction, else one whose first frame lacks it."""
        second_best: DrawnStart | None = None
        for _ in range(MAX_HIDDEN_REDRAWS):
            drawn = self._draw_once(ask, headings_rad, rng)
            if not drawn.meets_rule or lookout.sees(ask.goal, drawn.pose):
                continue
            if not lookout.sees_around(ask.goal, drawn.pose):
                return drawn
            second_best = second_best or drawn._replace(meets_rule=False)
        if second_best is None:
            raise EpisodeError(
                f"House '{self._task.world.house.name}': '{ask.goal}' is visible in the first frame of all "
                f"{MAX_HIDDEN_REDRAWS} starts that were sampled."
            )
        return second_best
