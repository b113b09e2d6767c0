"""The setting of a run, on which a replay of its actions depends: robot, camera, task and noise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from sim.configuration import as_json, with_fields
from sim.errors import ConfigError
from sim.interface import CameraModel
from sim.robot.config import RobotConfig
from sim.sensors.noise import NOISE_PRESETS, NoiseConfig
from sim.task.config import TaskConfig

OWN_NOISE = "own"
"""Name of noise that is none of the presets."""
LEAST_TIMESTEP_S = 1e-4
"""A smaller time step would let the file of somebody else occupy this machine for days."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Robot, camera, task and noise of a run; the defaults are the standard of the benchmark."""

    robot: RobotConfig = field(default_factory=RobotConfig)
    camera: CameraModel = field(default_factory=CameraModel)
    task: TaskConfig = field(default_factory=TaskConfig)
    noise: NoiseConfig = field(default_factory=NoiseConfig)

    @property
    def noise_name(self) -> str:
        """Name of the preset that the noise is equal to, whatever the run called it; `own` for any other."""
        return next((name for name, preset in NOISE_PRESETS.items() if preset == self.noise), OWN_NOISE)

    def changes(self) -> list[str]:
        """Returns a text for each field that differs from the standard: name, value, standard value."""
        standard = Setting()
        found = []
        for part in ("robot", "camera", "task"):
            before = dict(_flat(as_json(getattr(standard, part)), part))
            for path, value in _flat(as_json(getattr(self, part)), part):
                if value != before.get(path):
                    found.append(f"{path} is {value!r}, in the standard {before.get(path)!r}")
        if self.noise_name == OWN_NOISE:
            found.append(f"noise is none of {', '.join(NOISE_PRESETS)}")
        return found


def setting_of(config: Mapping[str, Any], *, where: str) -> Setting:
    """Returns the setting that the configuration of a run records.

    Args:
        config: content of `config.json`.
        where: names the file for the error message.

    Raises:
        ConfigError: a part is missing, its fields are not exactly those of this version, or a value is not allowed.
    """
    tree = config.get("config")
    if not isinstance(tree, Mapping):
        raise ConfigError(f"{where}: its configuration has no field 'config'.")
    parts = {each.name: _part(getattr(Setting(), each.name), tree.get(each.name), each.name, where)
             for each in fields(Setting)}  # fmt: skip
    setting = Setting(**parts)
    if setting.robot.physics.timestep_s < LEAST_TIMESTEP_S:
        raise ConfigError(f"{where}: robot.physics.timestep_s is below {LEAST_TIMESTEP_S} s.")
    return setting


def _part(default: Any, given: Any, name: str, where: str) -> Any:
    """Returns one part of a setting."""
    if not isinstance(given, Mapping):
        raise ConfigError(f"{where}: its configuration has no field 'config.{name}'.")
    if given.get("file") is not None:
        raise ConfigError(f"{where}: the robot is that of a file (--robot), which a submission does not contain.")
    values = dict(_flat(given, ""))
    lacking = [path for path, _ in _flat(as_json(default), "") if path not in values]
    if lacking:
        raise ConfigError(f"{where}: {name} lacks '{lacking[0]}'; it is of another version of the simulator.")
    try:
        return with_fields(default, {path: value for path, value in values.items() if path != "file"})
    except ConfigError as error:
        raise ConfigError(f"{where}: {name} is not allowed in this version of the simulator: {error}") from None


def _flat(content: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    """Yields path and value of each field of nested objects."""
    for key, value in content.items():
        path = f"{prefix}.{key}" if prefix else str(key)
        if isinstance(value, Mapping):
            yield from _flat(value, path)
        else:
            yield path, value
