"""Generates the episodes of a split, beside its house files or its list of houses, in Habitat's ObjectNav layout.

    python tools/make_episodes.py --split assets/mjcf_houses/val --episodes 1000 --workers 2
    python tools/make_episodes.py --split assets/mjcf_houses/train --episodes 2000 --view-points 2 --workers 2

The order goes round the houses; the next goal of a house is the one with the fewest episodes so far, so that the first
N episodes are balanced for any N. A start is uniform over the free space, 2 m to 30 m (geodesic) from the goal, its
heading uniform, and the robot has been placed there without contact. Goals are categories with an instance that can be
reached; instances that cannot are listed in `unreachable.json`. The same seed, houses, version and success rule give
the same bytes.
"""

from __future__ import annotations

import collections
import functools
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim import cli
from sim.episodes.drawing import MAX_DISTANCE_M, MIN_DISTANCE_M, draw_start
from sim.episodes.reachable_goals import MAX_VIEW_POINTS, HouseGoals, find_reachable_goals
from sim.episodes.splits import Episode, write_split
from sim.errors import EpisodeError
from sim.evaluation.parallel import ordered_map
from sim.geometry.pose import Pose
from sim.housegen.house_list import has_house_list, read_house_list
from sim.housegen.split_recipes import SPLIT_VERSION
from sim.houses.load import load_house
from sim.interface import ConfigError, SuccessRule
from sim.task.config import TaskConfig
from sim.task.objectnav import Task
from sim.world.world import World

MAX_REDRAWS = 20
"""Attempts to find a start at an allowed distance; a house can be too small for one."""
NumberedGoal = tuple[int, str]
"""Number of an episode in its split, and its goal."""


@dataclass(frozen=True)
class Args:
    """Generate the episodes of a split, beside its houses."""

    split: Path
    """Folder of the split; its houses are its .xml files, or those in its houses.json."""
    episodes: int = 100
    """Number of episodes of all houses."""
    seed: int = 0
    """Seed of starts and headings."""
    version: str = SPLIT_VERSION
    """Version of the split."""
    view_points: int = MAX_VIEW_POINTS
    """Largest number of view points of a goal instance."""
    workers: int = 1
    """Number of processes."""
    success: SuccessRule = field(default_factory=SuccessRule)
    """When a STOP succeeds: distances, view points and unreachable goals depend on it."""


def main(args: Args) -> int:
    """Writes the episodes of the split and prints statistics.

    Raises:
        ConfigError, EpisodeError, HouseError: there are no houses, or a house cannot be used.
    """
    files = house_files(args.split)
    if args.episodes < 1 or args.view_points < 1 or args.workers < 1:
        raise ConfigError("--episodes, --view-points and --workers must be at least 1.")
    began_s = time.perf_counter()
    find_goals = functools.partial(_find_goals, args)
    goals_found = ordered_map(find_goals, list(files), workers=args.workers)
    goals: dict[str, HouseGoals] = {}
    for house, found in zip(files, goals_found, strict=True):
        goals[house] = found
        instances = sum(map(len, found.listed.values()))
        print(f"{house}: {len(found.listed)} goals, {instances} instances, {len(found.unreachable)} unreachable")
    order = balanced_goals({house: tuple(found.listed) for house, found in goals.items()}, args.episodes)
    episodes = draw_episodes(args, order)
    write_split(
        args.split,
        episodes,
        {house: found.listed for house, found in goals.items()},
        version=args.version,
        unreachable={house: found.unreachable for house, found in goals.items()},
    )
    _report(episodes, goals, time.perf_counter() - began_s)
    return 0


def house_files(folder: Path) -> tuple[str, ...]:
    """Returns the names of the houses in the folder of a split.

    Raises:
        ConfigError: there are no houses.
    """
    listed = has_house_list(folder)
    names = (
        tuple(read_house_list(folder).recipes) if listed else tuple(sorted(file.stem for file in folder.glob("*.xml")))
    )
    if not names:
        raise ConfigError(f"There are 0 houses in '{folder}' (tools/generate_houses.py makes some).")
    return names


def balanced_goals(goals_of: Mapping[str, Sequence[str]], count: int) -> list[tuple[str, str]]:
    """Returns house and goal of each episode: the houses in turn, and the goal with the fewest episodes so far.

    Raises:
        EpisodeError: a house has no goal that can be reached.
    """
    for house, goals in goals_of.items():
        if not goals:
            raise EpisodeError(f"House '{house}' has no goal that can be reached.")
    asked, asked_here = collections.Counter[str](), collections.Counter[tuple[str, str]]()
    order: list[tuple[str, str]] = []
    houses = sorted(goals_of)
    for i in range(count):
        house = houses[i % len(houses)]
        goal = min(goals_of[house], key=lambda g: (asked[g], asked_here[house, g], goals_of[house].index(g)))
        asked[goal] += 1
        asked_here[house, goal] += 1
        order.append((house, goal))
    return order


def draw_episodes(args: Args, order: Sequence[tuple[str, str]]) -> list[Episode]:
    """Returns the episodes, in order; each has a random stream of its own, so that it does not depend on the others."""
    goals_in: dict[str, list[NumberedGoal]] = {house: [] for house in sorted({house for house, _ in order})}
    for i, (house, goal) in enumerate(order):
        goals_in[house].append((i, goal))
    digits = max(4, len(str(len(order) - 1)))
    draw = functools.partial(_draw, args, digits)
    drawn = ordered_map(draw, list(goals_in.items()), workers=args.workers)
    episodes: dict[int, Episode] = {}
    for house, found in zip(goals_in, drawn, strict=True):
        episodes |= dict(found)
        print(f"{house}: {len(found)} episodes", flush=True)
    return [episodes[i] for i in range(len(order))]


def _task(args: Args, house: str) -> Task:
    folder = args.split
    path = read_house_list(folder).fetch(house) if has_house_list(folder) else folder / f"{house}.xml"
    return Task(World(load_house(path), rule=args.success), TaskConfig(success=args.success))


def _find_goals(args: Args, house: str) -> HouseGoals:
    return find_reachable_goals(_task(args, house), max_view_points=args.view_points)


def _draw(args: Args, digits: int, work: tuple[str, list[NumberedGoal]]) -> list[tuple[int, Episode]]:
    """Returns the episodes of one house, each with its number."""
    house, numbered_goals = work
    task = _task(args, house)
    episodes = []
    for i, goal in numbered_goals:
        start, distance_m = _draw_start(task, goal, np.random.default_rng([args.seed, i]))
        episodes.append((i, Episode(f"{args.split.resolve().name}_{i:0{digits}d}", house, goal, start, distance_m)))
    return episodes


def _draw_start(task: Task, goal: str, rng: np.random.Generator) -> tuple[Pose, float | None]:
    """Returns a start and its distance to the goal, within the limits for the exact start, not only for its cell."""
    start = draw_start(task, goal, rng)
    for _ in range(MAX_REDRAWS):
        distance_m = task.distance_from(goal, start)
        if distance_m is not None and MIN_DISTANCE_M <= distance_m <= MAX_DISTANCE_M:
            break
        start = draw_start(task, goal, rng)
    return start, task.distance_from(goal, start)


def _report(episodes: Sequence[Episode], goals: Mapping[str, HouseGoals], took_s: float) -> None:
    """Prints statistics of the episodes."""
    distances = np.array([episode.shortest_path_m for episode in episodes], dtype=np.float64)
    print(
        f"{len(episodes)} episodes in {len(goals)} houses, made in {took_s:.1f} s, {len(goals) / took_s:.2f} houses/s"
    )
    print(f"geodesic distance: {distances.min():.1f} to {distances.max():.1f} m, median {np.median(distances):.1f} m")
    asked = collections.Counter(episode.goal for episode in episodes)
    print("episodes by goal: " + ", ".join(f"{goal} {number}" for goal, number in sorted(asked.items())))
    for house, found in goals.items():
        if found.unreachable:
            print(f"{house}: cannot be reached and is no goal: {', '.join(found.unreachable)}")


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
