"""Make the episodes of a split: beside the house files of a folder, in Habitat's ObjectNav layout.

    python tools/make_episodes.py --split assets/mjcf_houses/val --episodes 100 --version 1.0.0

The order goes round the houses; each house's next goal is the one that had the fewest turns so far, so that any first N
episodes are balanced. A start is uniform over the free space, 2 m to 30 m (geodesic) from the goal, its heading
uniform, and the robot has been set down there without touching anything. A goal counts only with an instance that can
be reached; the others are listed. The same seed, houses and version give the same bytes.
"""

from __future__ import annotations

import collections
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tyro
from numpy.typing import NDArray

from sim import habitat
from sim.episodes import Episode, write_split
from sim.errors import EpisodeError, HouseError
from sim.goals import Footprint, GoalRegion
from sim.houses.house import Room
from sim.houses.load import load_house
from sim.pose import Pose
from sim.sampling import draw_start, far_enough
from sim.task import Task
from sim.world import World

VIEW_STEP_CELLS = 10
"""View points lie on a grid of this many cells of the free space: 0.25 m."""
MAX_VIEW_POINTS = 24
"""For each instance, spread evenly over those there are."""
_DECIMALS = 3


@dataclass(frozen=True)
class Args:
    """Options of the command."""

    split: Path
    """Folder of the split: its houses are the .xml files in it."""
    episodes: int = 100
    """How many episodes, over all houses."""
    seed: int = 0
    """Draws starts and headings."""
    version: str = "1.0.0"
    """Version of the split: raise it whenever a house or an episode changes."""


@dataclass(frozen=True)
class HouseGoals:
    """What one house has to look for."""

    listed: Mapping[str, list[habitat.Json]]
    """For each goal category that can be reached, Habitat's goals with their view points."""
    unreachable: tuple[str, ...]
    """Names of goal instances that no place of the free space reaches."""


def main(args: Args) -> int:
    """Write the split's episodes and say what was made."""
    files = sorted(args.split.glob("*.xml"))
    if not files or args.episodes < 1:
        print(f"make_episodes: {len(files)} houses in {args.split}, {args.episodes} episodes wanted.", file=sys.stderr)
        return 2
    began_s = time.perf_counter()
    try:
        goals = {file.stem: survey(Task(World(load_house(file)))) for file in files}
        turns = take_turns({house: tuple(found.listed) for house, found in goals.items()}, args.episodes)
        episodes = draw_episodes(args, turns)
    except (HouseError, EpisodeError) as error:
        print(f"make_episodes: {error}", file=sys.stderr)
        return 2
    write_split(args.split, episodes, {house: found.listed for house, found in goals.items()}, version=args.version)
    _report(episodes, goals, time.perf_counter() - began_s)
    return 0


def survey(task: Task) -> HouseGoals:
    """The goals of a house that a robot in its largest free space can reach, and those it cannot."""
    world, space = task.world, task.truth.space()
    inside = space.largest_part()
    listed: dict[str, list[habitat.Json]] = {}
    unreachable: list[str] = []
    for goal in task.truth.goals():
        target = task.truth.target(goal)
        reached = target.reached & inside
        enough_starts = far_enough(np.where(inside, target.distance_m, np.inf)).any()
        for footprint in target.region.footprints:
            views = view_points(target.region, footprint, space.frame.to_metres(_spread(reached)))
            if not len(views):
                views = view_points(target.region, footprint, space.frame.to_metres(np.argwhere(reached)))
            if len(views) and enough_starts:
                listed.setdefault(goal, []).append(_to_habitat(footprint, views, world.rooms))
            else:
                unreachable.append(footprint.instance.name)
    return HouseGoals(listed, tuple(unreachable))


def view_points(region: GoalRegion, footprint: Footprint, places_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, 2) some of the places from which an instance counts as found."""
    places_m = places_m[footprint.near(places_m, region.reach_m)]
    places_m = places_m[region.reaches(footprint, places_m)] if len(places_m) else places_m
    if len(places_m) <= MAX_VIEW_POINTS:
        return places_m
    return places_m[np.linspace(0, len(places_m) - 1, MAX_VIEW_POINTS).round().astype(np.int64)]


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
    episodes: dict[int, Episode] = {}
    digits = max(4, len(str(len(turns) - 1)))
    for house in sorted({house for house, _ in turns}):
        world = World(load_house(args.split / f"{house}.xml"))
        task = Task(world)
        for i, (_, goal) in enumerate(turns):
            if turns[i][0] == house:
                start = draw_start(world, task, goal, np.random.default_rng([args.seed, i]))
                distance_m = task.distance_from(goal, start)
                episodes[i] = Episode(f"{args.split.resolve().name}_{i:0{digits}d}", house, goal, start, distance_m)
    return [episodes[i] for i in range(len(turns))]


def _spread(mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """(n, 2) the True cells that lie on the coarse grid of view points."""
    cells = np.argwhere(mask)
    return cells[np.all(cells % VIEW_STEP_CELLS == VIEW_STEP_CELLS // 2, axis=1)]


def _to_habitat(footprint: Footprint, views_m: NDArray[np.float64], rooms: Iterable[Room]) -> habitat.Json:
    """One instance as an entry of Habitat's `goals_by_category`."""
    x0, y0, x1, y1 = footprint.bounds_m
    x, y, z = 0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * sum(footprint.z_m)
    room = next((room.name for room in rooms if room.contains(x, y)), None)
    poses = [Pose(vx, vy, float(np.arctan2(y - vy, x - vx)), footprint.floor_z_m) for vx, vy in views_m.tolist()]
    return {
        "position": _rounded(habitat.to_position(x, y, z)),
        "radius": None,
        "object_id": footprint.instance.name,
        "object_name": footprint.instance.name,
        "object_name_id": None,
        "object_category": footprint.instance.category,
        "room_id": room,
        "room_name": room,
        "view_points": [
            {"agent_state": {key: _rounded(value) for key, value in habitat.to_agent_state(pose).items()}, "iou": None}
            for pose in poses
        ],
    }


def _rounded(values: Sequence[float]) -> list[float]:
    return [round(value, _DECIMALS) + 0.0 for value in values]


def _report(episodes: Sequence[Episode], goals: Mapping[str, HouseGoals], took_s: float) -> None:
    """Say what was made."""
    distances = np.array([episode.shortest_path_m for episode in episodes], dtype=np.float64)
    print(f"{len(episodes)} episodes in {len(goals)} houses, made in {took_s:.1f} s")
    print(f"geodesic distance: {distances.min():.1f} to {distances.max():.1f} m, median {np.median(distances):.1f} m")
    asked = collections.Counter(episode.goal for episode in episodes)
    print("episodes by goal: " + ", ".join(f"{goal} {number}" for goal, number in sorted(asked.items())))
    for house, found in goals.items():
        if found.unreachable:
            print(f"{house}: cannot be reached, and so is no goal: {', '.join(found.unreachable)}")


if __name__ == "__main__":
    sys.exit(main(tyro.cli(Args, description=__doc__)))
