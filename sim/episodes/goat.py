"""Chains as files of GOAT-Bench, and goals in words as files of HM3D-OVON: written, and those of GOAT-Bench read.

GOAT-Bench (Khanna et al. 2024) lists goals by category, each object with `lang_desc` and `image_goals`; an episode has
`tasks`, `[category, "object" | "description" | "image", object_id, number of the image]`. A goal in words is a category
of its own there. An object that is described twice is listed twice, and the labels of its entries differ.
HM3D-OVON (Yokoyama et al. 2024) has the files of ObjectNav with any words as categories.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

import msgspec

from sim.core.errors import EpisodeError
from sim.core.goals import MAX_GOALS, GoalKind, GoalSpec
from sim.core.reading import Count, Metres, Name, Number, read_gzip_json
from sim.episodes import habitat
from sim.episodes.episode import Episode
from sim.episodes.reachable_goals import GoalLister
from sim.task.objectnav import Task

_TASK_KINDS: Mapping[GoalKind, str] = MappingProxyType(
    {
        "category": "object", "words": "object", "description": "description", "instance": "image", "picture": "image",
    }
)  # fmt: skip
TWICE = "__"
"""Separates the label of an object and the number of its description, from the second on."""


def goat_house(task: Task, episodes: Sequence[Episode], scene_id: str, *, step_cells: int, most: int) -> dict[str, Any]:
    """Returns the content of GOAT-Bench's file of a house.

    Args:
        task: of the house.
        episodes: its chains; an episode with one goal is a chain of one.
        scene_id: of the house in Habitat.
        step_cells: distance of the view points, in cells of the free space.
        most: largest number of view points of an object.
    """
    goals, scene = _GoatGoals(task, step_cells, most), Path(scene_id).name
    entries = []
    for episode in episodes:
        tasks = [goals.task_of(goal, episode.start.floor_z_m) for goal in episode.specs]
        entries.append(_entry(episode, scene_id) | {"object_category": None, "tasks": tasks})
    listed = {f"{scene}_{category}": objects for category, objects in goals.by_category.items()}
    return {"goals": listed, "episodes": entries}


def ovon_house(task: Task, episodes: Sequence[Episode], scene_id: str, *, step_cells: int, most: int) -> dict[str, Any]:
    """Returns the content of HM3D-OVON's file of a house; the arguments are those of `goat_house`.

    The goal of an episode, the first one of a chain, is its category.
    """
    scene, listed = Path(scene_id).name, dict[str, list[dict[str, Any]]]()
    for episode in episodes:
        key = f"{scene}_{episode.goal}"
        if key not in listed:
            lister = GoalLister(task, max_view_points=most, step_cells=step_cells, floor_z_m=episode.start.floor_z_m)
            listed[key] = [
                {**entry, "object_id": entry["object_name"], "object_category": episode.goal}
                for entry in lister.of(episode.goal)[0]
            ]
    entries = [
        _entry(episode, scene_id) | {"object_category": episode.goal, "children_object_categories": []}
        for episode in episodes
    ]
    return {"goals_by_category": listed, "episodes": entries}


def read_goat(file: Path) -> list[Episode]:
    """Returns the chains in GOAT-Bench's file of a house.

    Raises:
        ConfigError: the file has another format.
        EpisodeError: a goal is not known here, or a picture is not listed.
    """
    content = read_gzip_json(file, _GoatFile, what="File of GOAT-Bench")
    listed = {(of.object_category, of.object_id): of for goals in content.goals.values() for of in goals}
    episodes = []
    for entry in content.episodes:
        goals: list[GoalSpec] = []
        asked: dict[frozenset[str], int] = {}
        for category, kind, object_id, number in entry.tasks:
            of, objects = listed.get((category, object_id or "")), _objects_of(content, category, kind, object_id)
            if kind == "image":
                if of is None or number is None or number >= len(of.image_goals):
                    raise EpisodeError(f"File of GOAT-Bench '{file}': '{object_id}' has no picture {number}.")
                goal = GoalSpec(next(iter(objects)), "picture", of.image_goals[number].camera)
            else:
                goal = GoalSpec.of(category if kind == "object" else (of and of.lang_desc) or "")
            goals.append(replace(goal, repeats=asked.get(objects)))
            asked.setdefault(objects, len(goals) - 1)
        start = habitat.from_agent_state(entry.start_position, entry.start_rotation)
        name, house = entry.info.stubborn_id or str(entry.episode_id), Path(entry.scene_id).stem
        episodes.append(Episode(name, house, goals[0].text, start, entry.info.geodesic_distance, tuple(goals)))
    return episodes


def _objects_of(content: _GoatFile, category: str, kind: str, object_id: str | None) -> frozenset[str]:
    """Returns the labels of the objects that a task asks for."""
    if kind != "object":
        return frozenset(((object_id or "").partition(TWICE)[0],))
    same = (of for goals in content.goals.values() for of in goals if of.object_category == category)
    return frozenset(of.object_id.partition(TWICE)[0] for of in same)


class _GoatGoals:
    """Collects the goals of the chains of one house."""

    def __init__(self, task: Task, step_cells: int, most: int) -> None:
        self._task, self._step_cells, self._most = task, step_cells, most
        self._listers: dict[float, GoalLister] = {}
        self.by_category: dict[str, list[dict[str, Any]]] = {}

    def task_of(self, goal: GoalSpec, floor_z_m: float) -> list[object]:
        """Returns the task of a goal, whose objects are listed."""
        kind = _TASK_KINDS[goal.kind]
        if kind == "object":
            self._list(goal.text, goal.text, floor_z_m)
            return [goal.text, kind, None, None]
        (instance,) = self._task.truth.instances(goal)
        category = f"{instance.category}_object"
        objects = self.by_category.setdefault(category, [])
        of_object = [entry for entry in objects if entry["object_id"].partition(TWICE)[0] == instance.name]
        for entry in of_object:
            if goal.kind != "description" or entry["lang_desc"] in (None, goal.told):
                entry["lang_desc"] = goal.told or entry["lang_desc"]
                return [category, kind, entry["object_id"], self._image(entry, goal)]
        (entry,) = self._entries(goal.text, category, floor_z_m)
        entry["object_id"] += f"{TWICE}{len(of_object) + 1}" * bool(of_object)
        entry["lang_desc"] = goal.told if goal.kind == "description" else None
        objects.append(entry)
        return [category, kind, entry["object_id"], self._image(entry, goal)]

    def _image(self, entry: dict[str, Any], goal: GoalSpec) -> int | None:
        """Adds the picture of a goal to its object; returns its number, None: the goal is no picture."""
        if goal.camera is None:
            return None
        entry["image_goals"].append(msgspec.to_builtins(habitat.ImageGoal.of(goal.camera)))
        return len(entry["image_goals"]) - 1

    def _list(self, text: str, category: str, floor_z_m: float) -> None:
        if category not in self.by_category:
            self.by_category[category] = self._entries(text, category, floor_z_m)

    def _entries(self, text: str, category: str, floor_z_m: float) -> list[dict[str, Any]]:
        if floor_z_m not in self._listers:
            self._listers[floor_z_m] = GoalLister(
                self._task, max_view_points=self._most, step_cells=self._step_cells, floor_z_m=floor_z_m
            )
        return [
            {
                **entry,
                "object_id": entry["object_name"],
                "object_category": category,
                "lang_desc": None,
                "image_goals": [],
                "children_object_categories": [],
            }
            for entry in self._listers[floor_z_m].of(text)[0]
        ]


def _entry(episode: Episode, scene_id: str) -> dict[str, Any]:
    state = habitat.to_agent_state(episode.start)
    return {
        "episode_id": episode.episode_id,
        "scene_id": scene_id,
        "scene_dataset_config": "default",
        "start_position": state["position"],
        "start_rotation": state["rotation"],
        "info": {"geodesic_distance": episode.shortest_path_m, "stubborn_id": episode.episode_id},
        "goals": [],
    }


_GoatTask = tuple[Name, Name, Name | None, Count | None]


class _GoatGoal(msgspec.Struct):
    object_id: Name
    object_category: Name
    lang_desc: str | None = None
    image_goals: list[habitat.ImageGoal] = msgspec.field(default_factory=list)


class _GoatInfo(msgspec.Struct):
    geodesic_distance: Number | None = None
    stubborn_id: str = ""


class _GoatEpisode(msgspec.Struct):
    episode_id: Name | int
    scene_id: Name
    start_position: tuple[Metres, Metres, Metres]
    start_rotation: tuple[Number, Number, Number, Number]
    tasks: Annotated[
        list[tuple[Name, Name, Name | None, Count | None]], msgspec.Meta(min_length=1, max_length=MAX_GOALS)
    ]
    info: _GoatInfo = msgspec.field(default_factory=_GoatInfo)


class _GoatFile(msgspec.Struct):
    goals: dict[str, list[_GoatGoal]]
    episodes: list[_GoatEpisode]
