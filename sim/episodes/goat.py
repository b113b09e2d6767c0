"""Writes chains as files of GOAT-Bench, and goals in words as files of HM3D-OVON; `other_files` reads them.

GOAT-Bench (Khanna et al. 2024) lists goals by category, each object with `lang_desc` and `image_goals`; an episode has
`tasks`, `[category, "object" | "description" | "image", object_id, number of the image]`. A goal in words is a category
of its own there. An object that is described twice is listed twice, and the labels of its entries differ.
HM3D-OVON (Yokoyama et al. 2024) has the files of ObjectNav with any words as categories.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import msgspec

from sim.core.goals import GoalKind, GoalSpec
from sim.episodes import habitat
from sim.episodes.episode import Episode
from sim.episodes.other_files import TWICE
from sim.episodes.reachable_goals import GoalLister
from sim.task.objectnav import Task

_TASK_KINDS: Mapping[GoalKind, str] = MappingProxyType(
    {
        "category": "object", "words": "object", "description": "description", "instance": "image", "picture": "image",
    }
)  # fmt: skip


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
