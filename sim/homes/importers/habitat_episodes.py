"""Fits Habitat's own ObjectNav episodes to an imported house, and reports those that do not fit.

A start is put on the floor of the nearest storey and, where the robot would overlap something, moved to the nearest
free place. A goal of the files fits if the house has an instance of its category there. Distances are computed anew.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
from msgspec import Meta

from sim.core.errors import ConfigError, EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES
from sim.core.reading import Metres, Name, read_gzip_json
from sim.episodes import habitat
from sim.episodes.episode import Episode
from sim.episodes.house_episodes import HouseAsks, find_house_asks
from sim.episodes.reachable_goals import storeys_of
from sim.episodes.recipes import DEFAULT_RECIPE
from sim.homes.importers.habitat_names import category_of
from sim.task.objectnav import Task

MOVED_M = 0.5
"""A start is moved at most this far."""
SAME_PLACE_M = 0.5
"""Largest distance in plan of a goal's position from its instance."""
MAX_EPISODE_FILES = 10_000
_SUFFIXES = (".basis.glb", ".glb", ".scene_instance.json", ".ply", ".xml")


class Goal(msgspec.Struct):
    """A goal of an episode file, in Habitat's frame."""

    position: tuple[Metres, Metres, Metres]


class SourceFile(msgspec.Struct):
    """An episode file."""

    episodes: Annotated[list[habitat.EpisodeEntry], Meta(max_length=1_000_000)] = []
    goals_by_category: dict[Name, list[Goal]] = {}


@dataclass
class SceneEpisodes:
    """The episodes of one scene and its goals by category."""

    entries: list[habitat.EpisodeEntry] = field(default_factory=list)
    goals: dict[str, list[Goal]] = field(default_factory=dict)


@dataclass(frozen=True)
class Fitted:
    """The episodes of an imported house."""

    episodes: tuple[Episode, ...]
    asks: HouseAsks
    report: Mapping[str, int]
    """Counts, each by a sentence."""


def read_scenes(path: Path) -> dict[str, SceneEpisodes]:
    """Returns the episodes of a file, or of a folder with `content/*.json.gz`, by the name of their scene.

    Raises:
        ConfigError: the file does not exist, one has another format, or there are too many.
    """
    files = [path]
    if path.is_dir():
        files = sorted(itertools.chain(path.glob("content/*.json.gz"), path.glob("*.json.gz")))
        if len(files) > MAX_EPISODE_FILES:
            raise ConfigError(f"--episodes '{path}' has {len(files)} files; at most {MAX_EPISODE_FILES} are read.")
    if not files:
        raise ConfigError(f"--episodes '{path}' has no content/*.json.gz.")
    scenes: dict[str, SceneEpisodes] = {}
    seen: set[tuple[str, str | int]] = set()
    for file in files:
        content = read_gzip_json(file, SourceFile, what="Episode file")
        for entry in content.episodes:
            scene = scene_name(entry.scene_id)
            if (scene, entry.episode_id) not in seen:  # the index of a folder may repeat what its files have
                seen.add((scene, entry.episode_id))
                scenes.setdefault(scene, SceneEpisodes()).entries.append(entry)
        for key, goals in content.goals_by_category.items():
            suffix = next((suffix for suffix in _SUFFIXES if f"{suffix}_" in key), None)
            if suffix is not None:
                scene, _, name = key.partition(f"{suffix}_")
                scenes.setdefault(scene_name(scene), SceneEpisodes()).goals.setdefault(name, []).extend(goals)
    return scenes


def scene_name(scene_id: str) -> str:
    """Returns the name of the house of a scene: `hm3d/val/00800-x/x.basis.glb` is `x`."""
    name = scene_id.replace("\\", "/").rpartition("/")[2]
    return next((name.removesuffix(suffix) for suffix in _SUFFIXES if name.endswith(suffix)), name)


def fit_episodes(task: Task, scene: SceneEpisodes, lowered_m: float) -> Fitted:
    """Returns those episodes of a scene that fit a house.

    Args:
        task: in the house.
        scene: its episodes.
        lowered_m: by how much the import moved the house down.
    """
    asks, counts = find_house_asks(task, DEFAULT_RECIPE), Counter[str]()
    episodes = []
    for entry in scene.entries:
        episode = _fitted(task, entry, lowered_m, counts)
        if episode is not None:
            episodes.append(episode)
    for name, goals in scene.goals.items():
        counts.update(_match(task, name, goals, lowered_m))
    counts["Episodes that fit."] = len(episodes)
    return Fitted(tuple(episodes), asks, dict(counts))


def _fitted(task: Task, entry: habitat.EpisodeEntry, lowered_m: float, counts: Counter[str]) -> Episode | None:
    """Returns an episode in our frame, or None if it does not fit; `counts` gets the reason."""
    goal = _goal(entry.object_category)
    if goal is None or goal not in task.truth.goals():
        counts[f"Episode left out: the house has no {entry.object_category[:40]}."] += 1
        return None
    stated = habitat.from_agent_state(entry.start_position, entry.start_rotation)
    height_m = stated.floor_z_m - lowered_m
    floor_z_m = min(storeys_of(task), key=lambda z_m: abs(z_m - height_m))
    pose = _free_pose(task, replace(stated, floor_z_m=floor_z_m))
    if pose is None:
        counts["Episode left out: no free place is near its start."] += 1
        return None
    try:
        distance_m = task.distance_from(goal, pose)
        task.world.reset(pose)
    except EpisodeError:
        distance_m = None
    if distance_m is None:
        counts["Episode left out: its goal cannot be reached from its start."] += 1
        return None
    if (pose.x_m, pose.y_m) != (stated.x_m, stated.y_m):
        counts["A start was moved to a free place."] += 1
    name = f"{task.world.house.name}_{entry.episode_id}"
    return Episode(name, task.world.house.name, goal, pose, distance_m)


def _goal(name: str) -> str | None:
    """Returns the goal category of a name in an episode file, or None."""
    category = name if name in GOAL_CATEGORIES else category_of(name)
    return category if category in GOAL_CATEGORIES else None


def _free_pose(task: Task, pose: Pose) -> Pose | None:
    """Returns the pose at the nearest free place, or None if it is farther than `MOVED_M`."""
    space = task.truth.space(pose.floor_z_m)
    if space.is_free(pose.x_m, pose.y_m):
        return pose
    window = space.frame.index_of((pose.x_m, pose.y_m, pose.x_m, pose.y_m), MOVED_M)
    cells = np.argwhere(space.largest_part()[window]) + np.array([window[0].start, window[1].start])
    places = space.frame.to_metres(cells)
    away = np.hypot(places[:, 0] - pose.x_m, places[:, 1] - pose.y_m)
    for number in np.argsort(away, kind="stable")[:50].tolist():
        x, y = (round(float(value), 4) for value in places[number])
        if away[number] <= MOVED_M and space.is_free(x, y):
            return replace(pose, x_m=x, y_m=y)
    return None


def _match(task: Task, name: str, goals: Sequence[Goal], lowered_m: float) -> Iterator[str]:
    """Yields a sentence for each goal of a category: whether an instance of the house is there."""
    goal = _goal(name)
    for place in goals:
        x, y, z = habitat.from_position(place.position)
        floor_z_m = min(storeys_of(task), key=lambda z_m: (z_m > z - lowered_m, abs(z_m - (z - lowered_m))))
        known = goal is not None and goal in task.truth.goals()
        boxes = (
            [footprint.bounds_m for footprint in task.truth.region(goal, floor_z_m).footprints]
            if goal and known
            else []
        )
        gaps = [np.hypot(max(x0 - x, x - x1, 0.0), max(y0 - y, y - y1, 0.0)) for x0, y0, x1, y1 in boxes]
        near = min(gaps, default=np.inf) <= SAME_PLACE_M
        yield "Goals of the files that fit." if near else f"Goal without an instance at its place: {name[:40]}."
