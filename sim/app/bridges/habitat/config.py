"""Habitat's configuration of a run: one tree with attribute access, in the layouts of its old and new versions.

Agents read it; to change it changes nothing.
"""

from __future__ import annotations

import contextlib
import logging
import math
from collections.abc import Iterator, Mapping, Sequence
from contextvars import ContextVar
from pathlib import Path

from sim.app.bridges.habitat_client import NOT_DECLARED, Config, add, merge, override, remove_other_actions, to_config
from sim.core.errors import ConfigError
from sim.core.interface import (  # fmt: skip
    FORWARD_M,
    LOOK_RAD,
    MAX_STEPS,
    MOVES,
    TURN_RAD,
    Action,
    CameraModel,
    RobotModel,
    SuccessRule,
)
from sim.core.reading import read_bytes

_LOG = logging.getLogger("habitat")
_LOOKS: ContextVar[bool] = ContextVar("_LOOKS", default=False)
_MAX_BYTES = 1 << 20
_MAX_VALUES = 20_000
"""Largest number of values of a file; a value that aliases repeat counts each time."""


def make_config(
    *,
    camera: CameraModel | None = None,
    robot: RobotModel | None = None,
    success: SuccessRule | None = None,
    max_steps: int = MAX_STEPS,
    looks: bool = False,
) -> Config:
    """Returns the configuration of a task, in the old layout and, under `habitat`, in the new one.

    Args:
        camera, robot, success: models of the task; None: the defaults.
        max_steps: largest number of actions of an episode.
        looks: whether the actions LOOK_UP and LOOK_DOWN are possible.
    """
    camera, robot = camera or CameraModel(), robot or RobotModel()
    distance_m = (success or SuccessRule()).distance_m
    rgb = {
        "width": camera.width_px,
        "height": camera.height_px,
        "hfov": round(math.degrees(camera.hfov_rad), 6),
        "position": [0, camera.height_m, 0],
    }
    depth = rgb | {"min_depth": camera.min_depth_m, "max_depth": camera.max_depth_m, "normalize_depth": True}
    body = {"height": robot.height_m, "radius": robot.radius_m}
    motion = {"forward_step_size": FORWARD_M, "turn_angle": round(math.degrees(TURN_RAD))}
    motion |= {"tilt_angle": round(math.degrees(LOOK_RAD))}
    actions = [action.name for action in (Action if looks else MOVES)]
    task = {"type": "ObjectNav-v1", "success_distance": distance_m, "goal_sensor_uuid": "objectgoal"}
    measurements = {"distance_to_goal": {}, "success": {"success_distance": distance_m}}
    measurements |= {"spl": {}, "soft_spl": {}, "collisions": {}}
    steps = {"max_episode_steps": max_steps, "max_episode_seconds": 10_000_000}
    order = {"cycle": True, "shuffle": False, "group_by_scene": False, "max_scene_repeat_steps": -1}
    order |= {"max_scene_repeat_episodes": -1, "num_episode_sample": -1, "step_repetition_range": 0.2}
    data = {"type": "ObjectNav-v1", "split": "val", "data_path": "", "scenes_dir": "", "content_scenes": ["*"]}
    engine = {"gpu_device_id": 0, "gpu_gpu": False, "allow_sliding": False, "enable_physics": True}
    old = {
        "SEED": 100,
        "ENVIRONMENT": _upper(steps) | {"ITERATOR_OPTIONS": _upper(order)},
        "SIMULATOR": _upper(motion)
        | {"RGB_SENSOR": _upper(rgb), "DEPTH_SENSOR": _upper(depth), "SEMANTIC_SENSOR": _upper(rgb)}
        | {"HABITAT_SIM_V0": _upper(engine)}
        | {"AGENT_0": _upper(body) | {"SENSORS": ["RGB_SENSOR", "DEPTH_SENSOR"]}},
        "TASK": _upper(task)
        | {"POSSIBLE_ACTIONS": actions, "MEASUREMENTS": [name.upper() for name in measurements]}
        | {"SENSORS": ["OBJECTGOAL_SENSOR", "COMPASS_SENSOR", "GPS_SENSOR"]}
        | {"SUCCESS": {"SUCCESS_DISTANCE": distance_m}},
        "DATASET": _upper(data),
    }
    sensors = {"rgb_sensor": rgb, "depth_sensor": depth, "semantic_sensor": rgb}
    habitat = {
        "seed": 100,
        "environment": steps | {"iterator_options": order},
        "simulator": motion | {"habitat_sim_v0": engine, "agents": {"main_agent": body | {"sim_sensors": sensors}}},
        "task": task | {"actions": {name.lower(): {} for name in actions}, "measurements": measurements},
        "dataset": data,
    }
    return to_config(old | {"habitat": habitat})


@contextlib.contextmanager
def keeping_looks(looks: bool) -> Iterator[None]:
    """Lets `get_config` keep LOOK_UP and LOOK_DOWN in the `with` block, where an agent that declares them is made."""
    token = _LOOKS.set(looks)
    try:
        yield
    finally:
        _LOOKS.reset(token)


def get_config(
    config_path: str | Sequence[str] | None = None,
    overrides: Sequence[object] | None = None,
    configs_dir: str | None = None,
    *,
    config_paths: str | Sequence[str] | None = None,
    opts: Sequence[object] | None = None,
) -> Config:
    """Returns the configuration of this project's task, changed by files and by overrides.

    Args:
        config_path: YAML files of either layout; several are separated by commas. A relative path whose folder does
            not exist names a configuration that comes with Habitat: it changes nothing, and a warning is logged.
        overrides: texts `path=value`, or paths and values alternately.
        configs_dir: exists for agents that give it.
        config_paths: the name of `config_path` until 2021.
        opts: the name of `overrides` until 2021.

    Raises:
        ConfigError: a file does not exist or cannot be read, or an override has another form.
    """
    overrides = opts if overrides is None else overrides
    config_path = config_paths if config_path is None else config_path
    config = make_config(looks=_LOOKS.get())
    known = list(config.TASK.POSSIBLE_ACTIONS)
    paths = config_path.split(",") if isinstance(config_path, str) else [str(path) for path in config_path or ()]
    for path in paths:
        if Path(path).is_file():
            merge(config, _read_yaml(Path(path)))
        elif Path(path).is_absolute() or (Path(path).parent.name and Path(path).parent.is_dir()):
            raise ConfigError(f"There is no configuration file '{path}' in its folder.")
        else:
            _LOG.warning("There is no configuration file '%s': the task of this project is used.", path)
    try:
        override(config, overrides)
    except ValueError as error:
        raise ConfigError(str(error)) from None
    removed = remove_other_actions(config, known)
    if removed:
        _LOG.warning(NOT_DECLARED, ", ".join(sorted(removed)))
    return config


def with_entries_of(config: Config, file: Path) -> Config:
    """Returns the configuration of a run with the entries that only a YAML file has; a warning names the others.

    Raises:
        ConfigError: the file cannot be read.
    """
    merged = config.clone()
    add(merged, _read_yaml(file))
    return merged


def _upper(tree: Mapping[str, object]) -> dict[str, object]:
    return {name.upper(): value for name, value in tree.items()}


def _read_yaml(file: Path) -> Mapping[str, object]:
    """Returns the content of a YAML file.

    Raises:
        ConfigError: the file cannot be read, is not a mapping, or is too large.
    """
    try:
        import yaml
    except ImportError:
        raise ConfigError(f"Configuration '{file}': reading YAML needs the package pyyaml (extra `habitat`).") from None
    content = read_bytes(file, what="Configuration", most=_MAX_BYTES)
    try:
        tree = yaml.safe_load(content)
        values = 0
        stack = [tree]
        while stack:
            value = stack.pop()
            values += 1
            if values > _MAX_VALUES:
                raise ConfigError(f"Configuration '{file}' has more than {_MAX_VALUES} values.")
            stack += value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else ()
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        if isinstance(error, ConfigError):
            raise
        raise ConfigError(f"Configuration '{file}' is not valid YAML: {' '.join(str(error).split())}") from None
    if tree is not None and not isinstance(tree, Mapping):
        raise ConfigError(f"Configuration '{file}' must be a mapping of names to values, got {type(tree).__name__}.")
    return tree or {}
