"""Make the episodes of a split: beside its house files, or its list of houses, in Habitat's ObjectNav layout.

    python tools/make_episodes.py --split assets/mjcf_houses/val --episodes 1000 --workers 2
    python tools/make_episodes.py --split assets/mjcf_houses/train --episodes 2000 --view-points 2 --workers 2

The order goes round the houses; each house's next goal is the one that had the fewest turns so far, so that any first N
episodes are balanced. A start is uniform over the free space, 2 m to 30 m (geodesic) from the goal, its heading
uniform, and the robot has been set down there without touching anything. A goal counts only with an instance that can
be reached; the others are listed in `unreachable.json`. The same seed, houses and version give the same bytes.
"""

from __future__ import annotations

import collections
import functools
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim import cli
from sim.episodes.drawing import MAX_DISTANCE_M, MIN_DISTANCE_M, draw_start
from sim.episodes.reachable_goals import MAX_VIEW_POINTS, HouseGoals, survey
from sim.episodes.splits import Episode, write_split
from sim.errors import EpisodeError
from sim.evaluation.parallel import ordered_map
from sim.geometry.pose import Pose
from sim.housegen.house_list import has_house_list, read_house_list
from sim.housegen.split_recipes import SPLIT_VERSION
from sim.houses.load import load_house
from sim.interface import ConfigError
from sim.task.objectnav import Task
from sim.world.world import World

MAX_REDRAWS = 20
"""In a house too small for the distances no number of draws would do."""
Turn = tuple[int, str]
"""Number of an episode in its split, and its goal."""


@dataclass(frozen=True)
class Args:
    """Make the episodes of a split, beside its houses."""

    split: Path
    """Folder of the split: its houses are the .xml files in it, or those in its houses.json."""
    episodes: int = 100
    """How many episodes, over all houses."""
    seed: int = 0
    """Draws starts and headings."""
    version: str = SPLIT_VERSION
    """Version of the split."""
    view_points: int = MAX_VIEW_POINTS
    """Of each goal instance, at most."""
    workers: int = 1
    """Processes."""


def main(args: Args) -> int:
    """Write the split's episodes and say what was made.

    Raises:
        ConfigError, EpisodeError, HouseError: there are no houses, or one of them is of no use.
    """
    files = house_files(args.split)
    if args.episodes < 1 or args.view_points < 1 or args.workers < 1:
        raise ConfigError("--episodes, --view-points and --workers must be at least 1.")
    began_s = time.perf_counter()
    surveyed = ordered_map(functools.partial(_survey, args.split, args.view_points), list(files), workers=args.workers)
    goals: dict[str, HouseGoals] = {}
    for house, found in zip(files, surveyed, strict=True):
        goals[house] = found
        instances = sum(map(len, found.listed.values()))
        print(f"{house}: {len(found.listed)} goals, {instances} things to find, {len(found.unreachable)} out of reach")
    turns = take_turns({house: tuple(found.listed) for house, found in goals.items()}, args.episodes)
    episodes = draw_episodes(args, turns)
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
    """Names of the houses in a split's folder.

    Raises:
        ConfigError: there are none.
    """
    listed = has_house_list(folder)
    names = (
        tuple(read_house_list(folder).recipes) if listed else tuple(sorted(file.stem for file in folder.glob("*.xml")))
    )
    if not names:
        raise ConfigError(f"There are 0 houses in '{folder}' (tools/generate_houses.py makes some).")
    return names


def take_turns(goals_of: Mapping[str, Sequence[str]], count: int) -> list[tuple[str, str]]:
    """House and goal of each episode: round the houses, and to the goal that was asked for least.

    Raises:
        EpisodeError: a house has no goal that can be reached.
    """
    for house, goals in goals_of.items():
        if not goals:
            raise EpisodeError(f"House '{house}' has no goal that can be reached.")
    asked, asked_here = collections.Counter[str](), collections.Counter[tuple[str, str]]()
    turns: list[tuple[str, str]] = []
    houses = sorted(goals_of)
    for i in range(count):
        house = houses[i % len(houses)]
        goal = min(goals_of[house], key=lambda g: (asked[g], asked_here[house, g], goals_of[house].index(g)))
        asked[goal] += 1
        asked_here[house, goal] += 1
        turns.append((house, goal))
    return turns


def draw_episodes(args: Args, turns: Sequence[tuple[str, str]]) -> list[Episode]:
    """The episodes, in order; each has a random stream of its own, so none hangs on the others."""
    turns_in: dict[str, list[Turn]] = {house: [] for house in sorted({house for house, _ in turns})}
    for i, (house, goal) in enumerate(turns):
        turns_in[house].append((i, goal))
    digits = max(4, len(str(len(turns) - 1)))
    draw = functools.partial(_draw, args.split, args.seed, digits)
    drawn = ordered_map(draw, list(turns_in.items()), workers=args.workers)
    episodes: dict[int, Episode] = {}
    for house, found in zip(turns_in, drawn, strict=True):
        episodes |= dict(found)
        print(f"{house}: {len(found)} episodes", flush=True)
    return [episodes[i] for i in range(len(turns))]


def _task(folder: Path, house: str) -> Task:
    path = read_house_list(folder).fetch(house) if has_house_list(folder) else folder / f"{house}.xml"
    return Task(World(load_house(path)))


def _survey(folder: Path, view_points: int, house: str) -> HouseGoals:
    return survey(_task(folder, house), max_view_points=view_points)


def _draw(folder: Path, seed: int, digits: int, work: tuple[str, list[Turn]]) -> list[tuple[int, Episode]]:
    """The episodes of one house, each with its number."""
    house, turns = work
    task = _task(folder, house)
    episodes = []
    for i, goal in turns:
        start, distance_m = _draw_start(task, goal, np.random.default_rng([seed, i]))
        episodes.append((i, Episode(f"{folder.resolve().name}_{i:0{digits}d}", house, goal, start, distance_m)))
    return episodes


def _draw_start(task: Task, goal: str, rng: np.random.Generator) -> tuple[Pose, float | None]:
    """A start and its distance to the goal; drawn again where the way from within the cell is too short or too long."""
    start = draw_start(task, goal, rng)
    for _ in range(MAX_REDRAWS):
        distance_m = task.distance_from(goal, start)
        if distance_m is not None and MIN_DISTANCE_M <= distance_m <= MAX_DISTANCE_M:
            break
        start = draw_start(task, goal, rng)
    return start, task.distance_from(goal, start)


def _report(episodes: Sequence[Episode], goals: Mapping[str, HouseGoals], took_s: float) -> None:
    """Say what was made."""
    distances = np.array([episode.shortest_path_m for episode in episodes], dtype=np.float64)
    print(
        f"{len(episodes)} episodes in {len(goals)} houses, made in {took_s:.1f} s, {len(goals) / took_s:.2f} houses/s"
    )
    print(f"geodesic distance: {distances.min():.1f} to {distances.max():.1f} m, median {np.median(distances):.1f} m")
    asked = collections.Counter(episode.goal for episode in episodes)
    print("episodes by goal: " + ", ".join(f"{goal} {number}" for goal, number in sorted(asked.items())))
    for house, found in goals.items():
        if found.unreachable:
            print(f"{house}: cannot be reached, and so is no goal: {', '.join(found.unreachable)}")


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
