"""Sensors of habitat-lab for goals in words, under the names of HM3D-OVON and GOAT-Bench.

=====================  =======================  =======================================================================
observation            registered as            goal
=====================  =======================  =======================================================================
`clip_objectgoal`      `ClipObjectGoalSensor`   of the episode, or of a task of GOAT-Bench of the kind `object`
`goat_subtask_goal`    `GoatGoalSensor`         of the episode, or of the present task of GOAT-Bench of any kind
=====================  =======================  =======================================================================

There, a goal is the vector that an encoder of texts and pictures gives it, from a file. `cache` names such a file: an
`.npz` with a float vector by the text of the goal, or by `SCENE_OBJECT_NUMBER` of a picture. Without it, the
observation is the text; it is "" for a picture, and without a goal.
"""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from gym import spaces
from habitat.config.default_structured_configs import LabSensorConfig
from habitat.core.registry import registry
from habitat.core.simulator import Sensor, SensorTypes
from hydra.core.config_store import ConfigStore
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.reading import open_plain


@dataclass
class ClipObjectGoalSensorConfig(LabSensorConfig):
    """Configuration of `clip_objectgoal`."""

    type: str = "ClipObjectGoalSensor"
    cache: str = ""
    """File of the vectors; "": the observation is the text."""


@dataclass
class GoatGoalSensorConfig(ClipObjectGoalSensorConfig):
    """Configuration of `goat_subtask_goal`."""

    type: str = "GoatGoalSensor"


class Texts(spaces.Space):
    """The space of all texts, which the version of Gym that habitat-lab needs lacks."""

    def contains(self, x: object) -> bool:
        """Returns whether something is a text."""
        return isinstance(x, str)

    def sample(self) -> str:
        """Returns an empty text."""
        return ""


class ClipObjectGoalSensor(Sensor):
    """The goal in words, as a vector of `cache` or as text.

    Raises:
        ConfigError: the cache cannot be read, or has no vector of the goal.
    """

    cls_uuid: ClassVar[str] = "clip_objectgoal"
    kinds: ClassVar[tuple[str, ...]] = ("object",)
    """Kinds of GOAT-Bench's tasks that it shows."""

    def __init__(self, *_: Any, config: Any, **__: Any) -> None:
        self._file = config.cache
        self._vectors = read_vectors(Path(config.cache)) if config.cache else {}
        super().__init__(config=config)

    def _get_uuid(self, *_: Any, **__: Any) -> str:
        return self.cls_uuid

    def _get_sensor_type(self, *_: Any, **__: Any) -> Any:
        return SensorTypes.SEMANTIC if self._file else SensorTypes.TEXT

    def _get_observation_space(self, *_: Any, **__: Any) -> spaces.Space:
        if not self._file:
            return Texts()
        return spaces.Box(-np.inf, np.inf, next(iter(self._vectors.values())).shape, np.float32)

    def get_observation(self, *_: Any, episode: Any, task: Any, **__: Any) -> NDArray[np.float32] | str:
        """Returns the goal that is looked for now."""
        kind, key = goal_of(episode, task)
        if not self._file:
            return key if kind in self.kinds and kind != "image" else ""
        if kind not in self.kinds:
            return np.zeros_like(next(iter(self._vectors.values())))
        if key not in self._vectors:
            raise ConfigError(f"The cache '{self._file}' of {self.cls_uuid} has no vector of '{key}'.")
        return self._vectors[key]


class GoatGoalSensor(ClipObjectGoalSensor):
    """The goal of GOAT-Bench's present task; see `ClipObjectGoalSensor`."""

    cls_uuid: ClassVar[str] = "goat_subtask_goal"
    kinds: ClassVar[tuple[str, ...]] = ("object", "description", "image")


def goal_of(episode: Any, task: Any) -> tuple[str, str]:
    """Returns the kind and the key of the goal that is looked for now; both are "" after the last task of GOAT-Bench.

    Args:
        episode: of ObjectNav, or of GOAT-Bench: with `tasks`, and `goals` for each of them.
        task: with `active_subtask_idx` if the episode has tasks.
    """
    tasks = getattr(episode, "tasks", None)
    if tasks is None:
        return "object", episode.object_category
    number = task.active_subtask_idx
    if number >= len(tasks):
        return "", ""
    category, kind, object_id, picture = tasks[number]
    if kind == "object":
        return kind, category
    if kind == "image":
        return kind, f"{Path(episode.scene_id).name.split('.')[0]}_{object_id}_{picture}"
    (described,) = [goal["lang_desc"] for goal in episode.goals[number] if goal["object_id"] == object_id]
    return kind, described.lower()


def read_vectors(file: Path) -> Mapping[str, NDArray[np.float32]]:
    """Returns the vectors of a cache by goal.

    Raises:
        ConfigError: the file cannot be read, is empty, or its vectors have different lengths.
    """
    try:
        with open_plain(file, what="Cache of goals") as stream, np.load(stream, allow_pickle=False) as content:
            vectors = {key: np.asarray(content[key], np.float32) for key in content.files}
    except (OSError, EOFError, ValueError, AttributeError, TypeError, zipfile.BadZipFile, zlib.error) as error:
        raise ConfigError(f"The cache '{file}' cannot be read as .npz: {error}.") from None
    shapes = {vector.shape for vector in vectors.values()}
    if len(shapes) != 1 or len(next(iter(shapes))) != 1:
        raise ConfigError(f"The cache '{file}' must have vectors of one length, got the shapes {sorted(shapes)}.")
    return vectors


def register() -> None:
    """Registers the sensors and their configurations, unless a project has registered its own under these names."""
    for sensor, config, name in (
        (ClipObjectGoalSensor, ClipObjectGoalSensorConfig, "clip_objectgoal_sensor"),
        (GoatGoalSensor, GoatGoalSensorConfig, "goat_goal_sensor"),
    ):
        if registry.get_sensor(config.type) is not None:
            continue
        registry.register_sensor(sensor, name=config.type)
        ConfigStore.instance().store(
            package=f"habitat.task.lab_sensors.{name}", group="habitat/task/lab_sensors", name=name, node=config
        )
