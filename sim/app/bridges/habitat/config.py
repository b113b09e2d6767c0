"""Habitat's configuration: one tree with attribute access, in the layouts of its old and new versions.

Agents read it. An environment takes from it the values that can be set (`SETTINGS`): the split, the number of steps and
the camera. All other values describe this project's task and change nothing.
"""

from __future__ import annotations

import functools
import logging
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sim.app.bridges.habitat_client import Config, add, merge, override, remove_other_actions, to_config
from sim.core.configuration import leaves_of
from sim.core.errors import ConfigError
from sim.core.interface import FORWARD_M, MAX_STEPS, TURN_RAD, Action, CameraModel, RobotModel, SuccessRule
from sim.core.reading import read_bytes

_LOG = logging.getLogger("habitat")
_MAX_BYTES = 1 << 20
_MAX_VALUES = 20_000
"""Largest number of values of a file; a value that aliases repeat counts each time."""
MAX_NAMED = 6
"""A warning names so many entries."""
_OLD, _NEW = "SIMULATOR.{}_SENSOR.{}", "habitat.simulator.agents.main_agent.sim_sensors.{}_sensor.{}"


def _places(field: str, *sensors: str) -> tuple[str, ...]:
    """Returns the paths of a field of cameras in both layouts."""
    old = [_OLD.format(sensor.upper(), field.upper()) for sensor in sensors]
    return (*old, *(_NEW.format(sensor, field) for sensor in sensors))


SETTINGS: Mapping[str, tuple[str, ...]] = {
    "split": ("DATASET.SPLIT", "habitat.dataset.split"),
    "max_steps": ("ENVIRONMENT.MAX_EPISODE_STEPS", "habitat.environment.max_episode_steps"),
    "width_px": _places("width", "rgb", "depth"),
    "height_px": _places("height", "rgb", "depth"),
    "hfov_deg": _places("hfov", "rgb", "depth"),
    "position": _places("position", "rgb", "depth"),
    "min_depth_m": _places("min_depth", "depth"),
    "max_depth_m": _places("max_depth", "depth"),
    "normalize_depth": _places("normalize_depth", "depth"),
}
"""The values that an environment takes from a configuration, with the paths of each in both layouts."""


def make_config(
    *,
    camera: CameraModel | None = None,
    robot: RobotModel | None = None,
    success: SuccessRule | None = None,
    max_steps: int = MAX_STEPS,
    split: str = "val",
) -> Config:
    """Returns the configuration of a task, in the old layout and, under `habitat`, in the new one.

    Args:
        camera, robot, success: models of the task; None: the defaults.
        max_steps: largest number of actions of an episode.
        split: name of the split.
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
    actions = [action.name for action in Action]
    task = {"type": "ObjectNav-v1", "success_distance": distance_m, "goal_sensor_uuid": "objectgoal"}
    measurements = {"distance_to_goal": {}, "success": {"success_distance": distance_m}}
    measurements |= {"spl": {}, "soft_spl": {}, "collisions": {}}
    steps, order = {"max_episode_steps": max_steps}, {"iterator_options": {"shuffle": False}}
    data = {"type": "ObjectNav-v1", "split": split}
    old = {
        "ENVIRONMENT": _upper(steps),
        "SIMULATOR": _upper(motion)
        | {"RGB_SENSOR": _upper(rgb), "DEPTH_SENSOR": _upper(depth)}
        | {"AGENT_0": _upper(body) | {"SENSORS": ["RGB_SENSOR", "DEPTH_SENSOR"]}},
        "TASK": _upper(task)
        | {"POSSIBLE_ACTIONS": actions, "MEASUREMENTS": [name.upper() for name in measurements]}
        | {"SENSORS": ["OBJECTGOAL_SENSOR", "COMPASS_SENSOR", "GPS_SENSOR"]},
        "DATASET": _upper(data),
    }
    sensors = {"rgb_sensor": rgb, "depth_sensor": depth}
    habitat = {
        "environment": steps | order,
        "simulator": motion | {"agents": {"main_agent": body | {"sim_sensors": sensors}}},
        "task": task | {"actions": {name.lower(): {} for name in actions}, "measurements": measurements},
        "dataset": data,
    }
    return to_config(old | {"habitat": habitat})


def get_config(
    config_paths: str | Sequence[str] | None = None, overrides: Sequence[object] | None = None, *_: object, **__: Any
) -> Config:
    """Returns the configuration of this project's task, changed by files and by overrides.

    Args:
        config_paths: YAML files of either layout; several are separated by commas. A relative path whose folder does
            not exist names a configuration that comes with Habitat: it changes nothing, and a warning is logged.
        overrides: texts `path=value`, or paths and values alternately.

    Raises:
        ConfigError: a file does not exist or cannot be read, or an override has another form.
    """
    config = make_config()
    paths = config_paths.split(",") if isinstance(config_paths, str) else [str(path) for path in config_paths or ()]
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
    removed = remove_other_actions(config)
    if removed:
        _LOG.warning("This robot has no action %s: removed from the configuration.", ", ".join(sorted(removed)))
    return config


def with_entries_of(config: Config, file: Path) -> Config:
    """Returns the configuration of a run with the entries that only a YAML file has; a warning names the others.

    Raises:
        ConfigError: the file cannot be read.
    """
    merged = config.clone()
    add(merged, _read_yaml(file))
    return merged


def settings_of(config: Mapping[str, object]) -> dict[str, object]:
    """Returns the entries of `SETTINGS` whose values differ from those of this project's task.

    The tree under `habitat`, which scripts of the new layout also give, will do.

    Raises:
        ConfigError: two paths of one setting have different values, such as the widths of RGB and depth, or the
            configuration has no section of either layout.
    """
    default, settings = make_config(), dict[str, object]()
    config = _whole(config, default)
    for name, paths in SETTINGS.items():
        values = {path: _at(config, path) for path in paths}
        changed = {path: value for path, value in values.items() if value not in (None, _at(default, path))}
        for path, value in changed.items():
            if settings.setdefault(name, value) != value:
                first = next(iter(changed))
                why = "all images have one camera" if "sensor" in path.lower() else "both layouts must agree"
                raise ConfigError(f"The configuration has {first}={settings[name]!r} and {path}={value!r}; {why}.")
    return settings


def log_ignored(config: Mapping[str, object]) -> None:
    """Logs the entries that change nothing: those with another value than this project's task, and unknown ones."""
    default = make_config()
    taken = {path for paths in SETTINGS.values() for path in paths}
    others, unknown = [], []
    for path, value in leaves_of(_whole(config, default)):
        here = _at(default, path)
        if path in taken or value == here:
            continue
        if here is None:
            unknown.append(path)
        else:
            others.append(f"{path}={value!r} (here {here!r})")
    for what, entries in (("have no effect", others), ("are unknown here", unknown)):
        if entries:
            more = f" and {len(entries) - MAX_NAMED} more" if len(entries) > MAX_NAMED else ""
            _warn_once(f"These entries of the configuration {what}: {', '.join(entries[:MAX_NAMED])}{more}.")


@functools.cache
def _warn_once(text: str) -> None:
    _LOG.warning("%s", text)


def _whole(config: Mapping[str, object], default: Config) -> Mapping[str, object]:
    """Returns a configuration, or that whose tree under `habitat` is given.

    Raises:
        ConfigError: it has no section of either layout.
    """
    if not config or any(section in config for section in default):
        return config
    if not any(section in config for section in default["habitat"]):
        raise ConfigError(
            f"The configuration needs one of the sections {', '.join(default)}, or those of `habitat` "
            f"({', '.join(default['habitat'])}); it has {', '.join(map(str, config))}."
        )
    return {"habitat": config}


def _upper(tree: Mapping[str, object]) -> dict[str, object]:
    return {name.upper(): value for name, value in tree.items()}


def _at(config: Mapping[str, object], path: str) -> Any:
    """Returns the value at a dotted path; None if the configuration has no such path."""
    value: Any = config
    for name in path.split("."):
        value = value.get(name) if isinstance(value, Mapping) else None
    return value


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
