"""Writes a split as Habitat's ObjectNav files, or as those of HM3D-OVON or GOAT-Bench, with dense view points.

    stubborn habitat dataset --split val --out data/datasets/objectnav/stubborn/v1/val
    stubborn habitat dataset --split words-seen --format ovon --out data/datasets/ovon/stubborn/v1/val_seen
    stubborn habitat dataset --split chains-val --format goat --out data/datasets/goat_bench/stubborn/v1/val_seen

habitat-lab's own class of data sets reads them (`habitat.dataset.data_path=.../{split}/{split}.json.gz`). The view
points of a goal are the places on a grid of 0.1 m where a STOP succeeds for it, so that Habitat's rule, at most 0.1 m
from a view point, accepts nearly the same places as that of docs/task.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from sim.app import cli
from sim.app.bridges.habitat.conversions import CATEGORIES
from sim.app.evaluation.parallel import ordered_map
from sim.core.errors import ConfigError
from sim.core.files import write_together
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID
from sim.core.vocabulary import counted
from sim.episodes import habitat
from sim.episodes.goat import goat_house, ovon_house
from sim.episodes.reachable_goals import find_reachable_goals
from sim.episodes.splits import Split, load_split, shipped_splits
from sim.task.objectnav import Task
from sim.world.world import World

STEP_CELLS = 4
"""Distance of the view points, in cells of the free space (0.025 m)."""
MAX_VIEW_POINTS = 100_000
CATEGORIES_OF = {"v1": CATEGORIES["mp3d"], "v2": CATEGORIES["hm3d"]}
"""The goal categories of each format of ObjectNav."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write a split as Habitat's ObjectNav files."""

    out: cli.OutFolder
    """Folder for the files; its name is that of the split for Habitat."""
    split: str = "val"
    """A shipped split, or a folder laid out like one."""
    format: Literal["v1", "v2", "ovon", "goat"] = "v1"
    """v1: goals of MP3D (21 categories); v2: those of HM3D (6); ovon: goals in words; goat: chains of goals."""
    workers: cli.Count = 1
    """Number of processes."""


def main(args: Args) -> int:
    """Writes the files; returns the exit status."""
    split = load_split(args.split)
    require_format(args.format, split)
    houses = [house for house in split.houses if any(episode.house == house for episode in split.episodes)]
    jobs = [(args.split, house, args.format) for house in houses]
    index = _tables(args.format) if args.format in CATEGORIES_OF else {"goals": {}} if args.format == "goat" else {}
    index_file = args.out / f"{args.out.name}.json.gz"
    files: dict[Path, bytes | str] = {index_file: habitat.zipped_json({**index, "episodes": []})}
    episodes = points = 0
    for house, content in zip(houses, ordered_map(_content, jobs, workers=args.workers), strict=True):
        files[args.out / "content" / f"{house}.json.gz"] = habitat.zipped_json(content)
        episodes += len(content["episodes"])
        if args.format in CATEGORIES_OF:
            points += sum(len(goal["view_points"]) for goals in content["goals_by_category"].values() for goal in goals)
    write_together(files)
    size = sum(file.stat().st_size for file in files) / 1e6
    counts = [counted(len(houses), "house"), counted(episodes, "episode")]
    counts += [counted(points, "view point")] if args.format in CATEGORIES_OF else []
    print(f"{args.out}: {', '.join(counts)}, {size:.1f} MB.")
    return 0


def require_format(name: str, split: Split) -> None:
    """Raises ConfigError if a format cannot hold the goals of a split."""
    specs = [spec for episode in split.episodes for spec in episode.specs]
    kinds = {spec.kind for spec in specs}
    chains_or_pictures = bool(kinds & {"picture", "instance"}) or len(specs) > len(split.episodes)
    if chains_or_pictures and name != "goat":
        raise ConfigError(f"'{split.name}' has chains or pictures, which {name} cannot hold: give --format goat.")
    if kinds - {"category"} and name in CATEGORIES_OF:
        raise ConfigError(f"'{split.name}' has goals in words, which {name} cannot hold: give --format ovon or goat.")


def _tables(format_name: str) -> dict[str, Any]:
    """Returns the numbers of the goal categories of a format of ObjectNav."""
    goals = CATEGORIES_OF[format_name]
    return {
        "category_to_task_category_id": {goal: number for number, goal in enumerate(goals)},
        "category_to_mp3d_category_id": {goal: MPCAT40_ID[goal] for goal in goals},
    }


def _content(job: tuple[str, str, str]) -> dict[str, Any]:
    """Returns the content of the file of a house: its episodes and goals in a format."""
    name, house, format_name = job
    split = load_split(name)
    task = Task(World(split.load_house(house)))
    scene = _scene_of(name, split, house)
    if format_name not in CATEGORIES_OF:
        episodes = [episode for episode in split.episodes if episode.house == house]
        write = goat_house if format_name == "goat" else ovon_house
        return write(task, episodes, scene, step_cells=STEP_CELLS, most=MAX_VIEW_POINTS)
    goals = CATEGORIES_OF[format_name]
    numbered = [(number, episode) for number, episode in enumerate(split.episodes) if episode.house == house]
    listed = _goals(task, sorted({episode.start.floor_z_m for _, episode in numbered}))
    return {
        **_tables(format_name),
        "goals_by_category": {habitat.goals_key(house, goal): listed[goal] for goal in listed if goal in goals},
        "episodes": [
            {
                "episode_id": str(number),
                "scene_id": scene,
                "scene_dataset_config": "default",
                **_start(episode.start),
                "object_category": episode.goal,
                "info": {"geodesic_distance": episode.shortest_path_m, "stubborn_id": episode.episode_id},
                "goals": [],
            }
            for number, episode in numbered
            if episode.goal in goals
        ],
    }


def _scene_of(name: str, split: Split, house: str) -> str:
    """Returns the scene of a house: with the shipped split that holds its file, or the path of a file of the user."""
    file = split.house_paths[house].resolve()
    return f"stubborn/{file.parent.name}/{house}.xml" if name in shipped_splits() else str(file)


def _start(start: Pose) -> dict[str, list[float]]:
    state = habitat.to_agent_state(start)
    return {"start_position": state["position"], "start_rotation": state["rotation"]}


def _goals(task: Task, floors_m: Sequence[float]) -> dict[str, list[habitat.Goal]]:
    """Returns the goals on some storeys of a house with all their view points."""
    listed: dict[str, list[habitat.Goal]] = {}
    for floor_z_m in floors_m:
        found = find_reachable_goals(
            task, max_view_points=MAX_VIEW_POINTS, step_cells=STEP_CELLS, floor_z_m=floor_z_m
        ).listed
        for goal, entries in found.items():
            listed.setdefault(goal, []).extend(entries)
    return listed
