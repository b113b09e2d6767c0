"""Registers with habitat-lab when it is imported: the shipped splits as data sets, this project's measures, and the
sensors of goals in words (`sim.app.bridges.habitat_sim.goal_sensors`).

A data set `stubborn-val` has the goals of MP3D in their order, `stubborn-val-hm3d` only the six of HM3D. In a data set
of a split in words, `stubborn-words-seen`, the category of an episode is its words. The measures
`StubbornDistanceToGoal` and `StubbornSuccess` take the place of Habitat's `distance_to_goal` and `success`: the
distance is that to the nearest place where a STOP succeeds, by the rule of docs/task.md, in place of that to a listed
view point.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from habitat.config.default import get_config as lab_config
from habitat.config.read_write import read_write
from habitat.core.registry import registry
from habitat.datasets.object_nav.object_nav_dataset import ObjectNavDatasetV1
from habitat.tasks.nav.nav import DistanceToGoal, Success
from habitat.tasks.nav.object_nav_task import ObjectGoalNavEpisode

from sim.app.bridges.habitat.conversions import CATEGORIES
from sim.app.bridges.habitat_sim import goal_sensors
from sim.app.bridges.habitat_sim.scenes import shipped_split
from sim.core.errors import ConfigError
from sim.core.interface import MPCAT40_ID
from sim.core.paths import assets_dir
from sim.episodes.habitat import read_episodes, to_position, to_rotation
from sim.episodes.splits import Split, load_split, read_index, shipped_splits

ALL = "*"
NUMBERINGS = {"": "mp3d", "-hm3d": "hm3d"}
"""Ends of the names of data sets, and the numbering of goals that each has."""


def register() -> None:
    """Registers data sets and measures; a second call is harmless."""
    for split in shipped_splits():
        for ending in NUMBERINGS:
            _register(split, ending)
    goal_sensors.register()
    if registry.get_measure("StubbornSuccess") is None:
        registry.register_measure(_StubbornDistanceToGoal, name="StubbornDistanceToGoal")
        registry.register_measure(_StubbornSuccess, name="StubbornSuccess")


def _register(split: str, ending: str) -> str:
    """Registers the data set of a split, if it is not; returns its name."""
    name = f"stubborn-{split}{ending}"
    if registry.get_dataset(name) is None:
        registry.register_dataset(_dataset(split, NUMBERINGS[ending]), name=name)
    return name


def get_config(
    split: str = "val",
    overrides: Sequence[str] = (),
    *,
    base: str = "benchmark/nav/objectnav/objectnav_hm3d.yaml",
    rule: str = "stubborn",
    cache: str = "",
) -> Any:
    """Returns habitat-lab's configuration for a split; one in words has the sensor `clip_objectgoal`.

    Args:
        split: name of a shipped split, or the folder of another one; with `-hm3d` at the end, only the six goals of
            HM3D.
        overrides: changes such as `habitat.environment.max_episode_steps=100`.
        base: habitat-lab's configuration of the benchmark.
        rule: `stubborn`: distance and success by this project's rule; `view_points`: Habitat's, within 0.1 m of a
            listed view point.
        cache: for a split in words: file of the vectors of `clip_objectgoal`; "": its observation is the text.

    Raises:
        ConfigError: there is no such split or rule, or it has no cache or view points.
    """
    ending = max((end for end in NUMBERINGS if split.endswith(end)), key=len)
    name = split.removesuffix(ending)
    load_split(name)
    if rule not in ("stubborn", "view_points"):
        raise ConfigError(f"rule must be stubborn or view_points, got '{rule}'.")
    in_words = read_index(name).in_words
    if in_words and rule == "view_points":
        raise ConfigError(
            f"Split '{name}' lists no view points: use rule='stubborn', or `habitat dataset --format ovon`."
        )
    if cache and not in_words:
        raise ConfigError(f"Split '{name}' has no goals in words: leave out `cache`.")
    config = lab_config(base, list(overrides))
    with read_write(config):
        config.habitat.dataset.type = _register(name, ending)
        if rule == "stubborn":
            config.habitat.task.measurements.distance_to_goal.type = "StubbornDistanceToGoal"
            config.habitat.task.measurements.success.type = "StubbornSuccess"
        if in_words:
            sensors = config.habitat.task.lab_sensors
            sensors.pop("objectgoal_sensor", None)  # words have no number
            sensors.clip_objectgoal_sensor = goal_sensors.ClipObjectGoalSensorConfig(cache=cache)
    return config


def _dataset(split_name: str, numbering: str) -> type[ObjectNavDatasetV1]:
    """Returns the class of the data set of a split."""

    class StubbornDataset(ObjectNavDatasetV1):
        """The episodes of a split."""

        def __init__(self, config: Any = None) -> None:
            self.goals_by_category, self.episodes = {}, []
            if config is None:
                return
            shipped = split_name in shipped_splits()
            split, goals = (shipped_split if shipped else load_split)(split_name), CATEGORIES[numbering]
            folder = assets_dir() / split_name if shipped else Path(split_name)
            chosen = [str(house) for house in config.content_scenes]
            houses = split.houses if ALL in chosen else chosen
            if read_index(split_name).in_words:
                self.episodes = _in_words(split, houses)
                return
            own_ids = []
            for house in houses:
                file = folder / "content" / f"{house}.json.gz"
                if not file.is_file() and ALL in chosen:
                    continue
                if not file.is_file():
                    raise ConfigError(f"Split '{split_name}' has no episodes in a house '{house}'.")
                own_ids += [str(entry.episode_id) for entry in read_episodes(file)]
                self._load_from_file(str(file), None)
            places = {episode.episode_id: place for place, episode in enumerate(split.episodes)}
            for own_id, episode in zip(own_ids, self.episodes, strict=True):
                episode.episode_id = str(places[own_id])
                episode.info = {**(episode.info or {}), "stubborn_id": own_id}
                if not shipped:
                    episode.scene_id = str(split.house_paths[Path(episode.scene_id).stem])
            self.episodes = sorted(
                (episode for episode in self.episodes if episode.object_category in goals),
                key=lambda episode: int(episode.episode_id),
            )
            if not self.episodes:
                raise ConfigError(f"Split '{split_name}' has no episodes with a goal of {numbering} in these houses.")
            self.category_to_task_category_id = {goal: number for number, goal in enumerate(goals)}
            self.category_to_scene_annotation_category_id = {goal: MPCAT40_ID[goal] for goal in goals}

        @staticmethod
        def check_config_paths_exist(config: Any) -> bool:
            """Returns True: the split was found."""
            return True

        @classmethod
        def get_scenes_to_load(cls, config: Any) -> list[str]:
            """Returns the names of the houses."""
            return sorted({episode.house for episode in load_split(split_name).episodes})

    StubbornDataset.__name__ = f"Stubborn{Path(split_name).name.title().replace('-', '')}{numbering.title()}"
    StubbornDataset.__doc__ = f"The split '{split_name}' with the goals of {numbering}."
    return StubbornDataset


def _in_words(split: Split, houses: Sequence[str]) -> list[ObjectGoalNavEpisode]:
    """Returns the episodes with a single goal in words; the words are their category, and no view points are listed.

    Raises:
        ConfigError: there is none in these houses, or the split has no such house.
    """
    for house in houses:
        if house not in split.houses:
            raise ConfigError(f"Split '{split.name}' has no house '{house}'.")
    episodes = [
        ObjectGoalNavEpisode(
            episode_id=str(place),
            scene_id=str(split.house_paths[episode.house]),
            start_position=to_position(episode.start.x_m, episode.start.y_m, episode.start.floor_z_m),
            start_rotation=to_rotation(episode.start.yaw_rad),
            object_category=episode.goal,
            info={"geodesic_distance": episode.shortest_path_m, "stubborn_id": episode.episode_id},
            goals=[],
        )
        for place, episode in enumerate(split.episodes)
        if episode.house in houses and not episode.goals
    ]
    if not episodes:
        raise ConfigError(f"Split '{split.name}' has no episodes with a single goal in words in these houses.")
    return episodes


class _StubbornDistanceToGoal(DistanceToGoal):
    """The distance to the nearest place where a STOP succeeds, metres."""

    def reset_metric(self, episode: Any, *args: Any, **kwargs: Any) -> None:
        """Begins an episode."""
        self.update_metric(episode, *args, **kwargs)

    def update_metric(self, episode: Any, task: Any, *args: Any, **kwargs: Any) -> None:
        """Takes the distance from where the robot is; 0 after a STOP that succeeded."""
        if _succeeded(task, self._sim, episode):
            self._metric = 0.0
            return
        distance_m = self._sim.distance_to_goal_m(episode.object_category)
        self._metric = math.inf if distance_m is None else distance_m


class _StubbornSuccess(Success):
    """Whether STOP was called where it succeeds: a visible point of an instance is within 1 m."""

    def update_metric(self, episode: Any, task: Any, *args: Any, **kwargs: Any) -> None:
        """Takes whether a STOP was called and succeeds."""
        self._metric = float(_succeeded(task, self._sim, episode))


def _succeeded(task: Any, sim: Any, episode: Any) -> bool:
    """Returns whether a STOP was called, and where it succeeds."""
    return bool(getattr(task, "is_stop_called", False)) and sim.stop_succeeds(episode.object_category)


register()
