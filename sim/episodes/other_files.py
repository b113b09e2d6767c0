"""Reads the episodes in files of GOAT-Bench and HM3D-OVON (`sim.episodes.goat` describes and writes them)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import msgspec

from sim.core.errors import EpisodeError
from sim.core.goals import MAX_GOALS, GoalSpec
from sim.core.reading import Count, Metres, Name, Number, parse_json, read_gzip_json
from sim.episodes import habitat
from sim.episodes.episode import Episode

TWICE = "__"
"""Separates the label of an object and the number of its description, from the second on."""


def read_others(file: Path) -> tuple[list[Episode], set[Path]]:
    """Returns the episodes in the file of a house, and their scenes; the file is one of GOAT-Bench or HM3D-OVON.

    Files of the ObjectNav challenges are read as those of HM3D-OVON; a file of GOAT-Bench holds chains.

    Raises:
        ConfigError: the file has another format.
        EpisodeError: a goal is not known here, a picture is not listed, or an episode of HM3D-OVON has
            `children_object_categories`, which widen its goal.
    """
    text = bytes(read_gzip_json(file, msgspec.Raw, what="Episode file"))
    if parse_json(text, _Format, where=f"Episode file '{file}'").goals is msgspec.UNSET:
        ovon = parse_json(text, _OvonFile, where=f"File of HM3D-OVON '{file}'")
        return _from_ovon(ovon, file), _scenes_of(ovon.episodes)
    goat = parse_json(text, _GoatFile, where=f"File of GOAT-Bench '{file}'")
    return _from_goat(goat, file), _scenes_of(goat.episodes)


def _from_ovon(content: _OvonFile, file: Path) -> list[Episode]:
    episodes = []
    for entry in content.episodes:
        if entry.children_object_categories:
            raise EpisodeError(
                f"File of HM3D-OVON '{file}', episode '{entry.episode_id}': children_object_categories must be empty; "
                "a more general word, such as 'a seat', names several categories."
            )
        start = habitat.from_agent_state(entry.start_position, entry.start_rotation)
        goal, distance_m = entry.object_category, entry.info.geodesic_distance
        episodes.append(Episode(_id_of(entry), _house_of(entry), goal, start, distance_m))
    return episodes


def _from_goat(content: _GoatFile, file: Path) -> list[Episode]:
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
        episodes.append(
            Episode(_id_of(entry), _house_of(entry), goals[0].text, start, entry.info.geodesic_distance, tuple(goals))
        )
    return episodes


def _objects_of(content: _GoatFile, category: str, kind: str, object_id: str | None) -> frozenset[str]:
    """Returns the labels of the objects that a task asks for."""
    if kind != "object":
        return frozenset(((object_id or "").partition(TWICE)[0],))
    same = (of for goals in content.goals.values() for of in goals if of.object_category == category)
    return frozenset(of.object_id.partition(TWICE)[0] for of in same)


def _scenes_of(entries: Sequence[_Entry]) -> set[Path]:
    return {Path(entry.scene_id) for entry in entries}


def _house_of(entry: _Entry) -> str:
    return Path(entry.scene_id).stem


def _id_of(entry: _Entry) -> str:
    """Returns the id of an episode; other projects number the episodes of each house from 0."""
    return entry.info.stubborn_id or f"{_house_of(entry)}_{entry.episode_id}"


class _GoatGoal(msgspec.Struct):
    object_id: Name
    object_category: Name
    lang_desc: str | None = None
    image_goals: list[habitat.ImageGoal] = msgspec.field(default_factory=list)


class _Info(msgspec.Struct):
    geodesic_distance: Number | None = None
    stubborn_id: str = ""


class _Entry(msgspec.Struct, kw_only=True):
    episode_id: Name | int
    scene_id: Name
    start_position: tuple[Metres, Metres, Metres]
    start_rotation: tuple[Number, Number, Number, Number]
    info: _Info = msgspec.field(default_factory=_Info)


class _GoatEpisode(_Entry, kw_only=True):
    tasks: Annotated[
        list[tuple[Name, Name, Name | None, Count | None]], msgspec.Meta(min_length=1, max_length=MAX_GOALS)
    ]


class _OvonEpisode(_Entry, kw_only=True):
    object_category: Name
    children_object_categories: list[Name] = msgspec.field(default_factory=list)


class _GoatFile(msgspec.Struct):
    goals: dict[str, list[_GoatGoal]]
    episodes: list[_GoatEpisode]


class _OvonFile(msgspec.Struct):
    episodes: list[_OvonEpisode]


class _Format(msgspec.Struct):
    """What tells the formats apart: only files of GOAT-Bench have `goals`."""

    goals: msgspec.Raw | msgspec.UnsetType = msgspec.UNSET
