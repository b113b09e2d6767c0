"""Writes how difficult the episodes of splits are, without an agent: sizes, distances, instances, goals in view.

    python -m tools.maintenance.split_report --splits val test large large-test --workers 2
    python -m tools.maintenance.split_report --splits large --episodes 60 --out /tmp/large.md
    python -m tools.maintenance.split_report --workers 2 --published --out docs/tables/splits.md

A row of the table has, for each split: medians (smallest to largest) over houses of floor area and rooms; medians over
episodes of the geodesic distance and of the number of reachable instances of the goal; the share of episodes whose goal
is in the first frame by the rule of GT exploration; the share of each quarter of the start headings, relative to the
direction in plan to the nearest instance. A second table counts the episodes of each goal category. With --published,
the figures that papers give for ObjectNav on scans stand below.
"""

from __future__ import annotations

import functools
import math
import statistics
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.app import cli
from sim.app.evaluation.parallel import ordered_map
from sim.core.errors import ConfigError
from sim.core.files import write_atomically
from sim.core.geometry.pose import Pose, wrap_angle
from sim.core.interface import GOAL_CATEGORIES
from sim.core.paths import assets_dir
from sim.episodes.episode import Episode
from sim.episodes.reachable_goals import storeys_of
from sim.episodes.splits import load_split, read_unreachable, shipped_splits
from sim.episodes.start_rules import Lookout
from sim.task.footprints import Footprint
from sim.task.objectnav import Task
from sim.world.world import World
from tools.maintenance.describe_houses import spread

HEADER = (
    "| split | houses | floor m2 | rooms | two storeys | episodes | distance m | instances of the goal "
    "| one instance % | seen at the start % | goal ahead, left, behind, right % |\n"
    "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n"
)

PUBLISHED = """
Published figures of ObjectNav on scans, for comparison. The papers give no distances to the goal.

| data | scenes | navigable m2 a scene | rooms a scene | val scenes | val episodes | goal categories |
|---|--:|--:|--:|--:|--:|--:|
| HM3D | 1,000 | 112 | 14 | 20 | 2,000 | 6 |
| MP3D | 90 | 338 | 23 | 11 | 2,195 | 21 |

Sources: Ramakrishnan et al. 2021, *Habitat-Matterport 3D Dataset* (112,500 m2 of navigable space in 1,000 scenes, 3.7
times that of MP3D); Yadav et al. 2022, *Habitat-Matterport 3D Semantics Dataset* (3,100 rooms in 216 scenes); Chang et
al. 2017, *Matterport3D* (2,056 rooms in 90 buildings); Habitat Challenges 2021 and 2022 (episodes and categories).
Scans span several storeys, and navigable area leaves out what furniture covers, so that areas compare only roughly.
"""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Options of the command."""

    splits: tuple[str, ...] = ("val", "test", "large", "hazards")
    """Shipped splits, or folders laid out like one."""
    episodes: cli.Count | None = None
    """The first N episodes of each split; by default all."""
    workers: cli.Count = 1
    """Number of processes."""
    published: bool = False
    """Add the published figures of other data."""
    out: cli.OutFile | None = None
    """Markdown file; it is only printed if not given."""


@dataclass(frozen=True)
class HouseDifficulty:
    """The figures of one house and of its episodes."""

    area_m2: float
    rooms: int
    storeys: int
    distances_m: tuple[float, ...]
    instances: tuple[int, ...]
    """Reachable instances of each episode's goal, on the storey of its start."""
    seen: tuple[bool, ...]
    """Whether the goal is in the first frame."""
    goals: tuple[str, ...]
    """Goal category of each episode."""
    quarters: tuple[int, ...]
    """Direction to the nearest instance from the start heading: 0 ahead, 1 left, 2 behind, 3 right."""


def main(args: Args) -> int:
    """Prints and writes the table."""
    figures = {name: difficulty_of(name, args) for name in args.splits}
    page = HEADER + "".join(_row(name, houses) for name, houses in figures.items()) + "\n" + _goals(figures)
    if args.published:
        page += PUBLISHED
    print(page)
    if args.out is not None:
        write_atomically(args.out, page)
    return 0


def difficulty_of(split: str, args: Args) -> list[HouseDifficulty]:
    """Returns the figures of each house of a split that has one of the first episodes."""
    episodes = load_split(split).episodes[: args.episodes]
    houses = sorted({episode.house for episode in episodes})
    work = [(house, tuple(episode for episode in episodes if episode.house == house)) for house in houses]
    return list(ordered_map(functools.partial(_measure, split), work, workers=args.workers))


def _measure(split_name: str, work: tuple[str, tuple[Episode, ...]]) -> HouseDifficulty:
    """Returns the figures of one house."""
    house, episodes = work
    split = load_split(split_name)
    folder = assets_dir() / split_name if split_name in shipped_splits() else Path(split_name)
    if any(episode.goal not in GOAL_CATEGORIES or episode.goals for episode in episodes):
        raise ConfigError(f"'{split_name}' has goals in words or pictures, or chains: its difficulty is not measured.")
    unreachable = set(read_unreachable(folder).get(house, ()))
    task = Task(World(split.load_house(house)))
    lookout, seen, quarters, instances = Lookout(task), [], [], []
    for episode in episodes:
        task.world.reset(episode.start)
        seen.append(lookout.sees(episode.goal, episode.start))
        footprints = task.truth.region(episode.goal, episode.start.floor_z_m).footprints
        reachable = [footprint for footprint in footprints if footprint.instance.name not in unreachable]
        instances.append(len(reachable))
        quarters.append(_quarter(episode.start, reachable))
    lookout.close()
    return HouseDifficulty(
        area_m2=sum(room.area_m2 for room in task.world.rooms),
        rooms=len(task.world.rooms),
        storeys=len(storeys_of(task)),
        distances_m=tuple(episode.shortest_path_m for episode in episodes if episode.shortest_path_m is not None),
        instances=tuple(instances),
        seen=tuple(seen),
        goals=tuple(episode.goal for episode in episodes),
        quarters=tuple(quarters),
    )


def _quarter(start: Pose, footprints: Sequence[Footprint]) -> int:
    """Returns the direction in plan to the nearest instance, seen from the heading, in quarters of a turn."""
    here = np.array([start.x_m, start.y_m])
    nearest = min(footprints, key=lambda footprint: float(footprint.boundary_m.query(here)[0]))
    x0, y0, x1, y1 = nearest.bounds_m
    bearing_rad = math.atan2(0.5 * (y0 + y1) - start.y_m, 0.5 * (x0 + x1) - start.x_m)
    return round(wrap_angle(bearing_rad - start.yaw_rad) / (0.5 * math.pi)) % 4


def _row(split: str, houses: Sequence[HouseDifficulty]) -> str:
    """Returns the row of a split."""
    distances_m = [distance for house in houses for distance in house.distances_m]
    instances = [count for house in houses for count in house.instances]
    seen = [value for house in houses for value in house.seen]
    quarters = [quarter for house in houses for quarter in house.quarters]
    cells = (
        Path(split).name,
        f"{len(houses)}",
        spread([house.area_m2 for house in houses]),
        spread([house.rooms for house in houses]),
        f"{sum(house.storeys > 1 for house in houses)}",
        f"{len(instances)}",
        f"{statistics.median(distances_m):.1f} ({min(distances_m):.1f}-{max(distances_m):.1f})" if distances_m else "-",
        spread(instances),
        _percent([count == 1 for count in instances]),
        _percent(seen),
        ", ".join(_percent([quarter == which for quarter in quarters]) for which in range(4)),
    )
    return f"| {' | '.join(cells)} |\n"


def _goals(figures: Mapping[str, Sequence[HouseDifficulty]]) -> str:
    """Returns the table of the episodes of each goal category, in the contract's order."""
    counts = {name: Counter(goal for house in houses for goal in house.goals) for name, houses in figures.items()}
    names = [Path(name).name for name in counts]
    lines = [f"| episodes of the goal | {' | '.join(names)} |", f"|---|{'--:|' * len(names)}"]
    lines += [
        f"| {goal} | {' | '.join(str(count[goal]) for count in counts.values())} |"
        for goal in GOAL_CATEGORIES
        if any(count[goal] for count in counts.values())
    ]
    return "\n".join(lines) + "\n"


def _percent(values: Sequence[bool]) -> str:
    return f"{100.0 * statistics.fmean(values):.0f}"


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
