"""The setting of a run, on which a replay of its actions depends: robot, camera, task and noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from sim.core.configuration import as_json, leaves_of, with_fields
from sim.core.errors import ConfigError
from sim.core.interface import CameraModel
from sim.robot.config import RobotConfig
from sim.sensors.noise import NOISE_PRESETS, NoiseConfig
from sim.task.config import TaskConfig

PartT = TypeVar("PartT")
PARTS = ("robot", "camera", "task", "noise")
OWN_NOISE = "own"
"""Name of noise that differs from all presets."""
MIN_TIMESTEP_S = 1e-4
"""A smaller time step would let the file of somebody else occupy this machine for days."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Robot, camera, task and noise of a run; the defaults are the standard of the benchmark."""

    robot: RobotConfig = field(default_factory=RobotConfig)
    camera: CameraModel = field(default_factory=CameraModel)
    task: TaskConfig = field(default_factory=TaskConfig)
    noise: NoiseConfig = field(default_factory=NoiseConfig)

    noise_name: str = "none"
    """Name of the preset that the recorded fields are those of, whatever the run called it; `own` for any other."""

    def changes(self) -> list[str]:
        """Returns a text for each field that differs from the standard: name, value, standard value."""
        standard = Setting()
        changes = []
        for part in ("robot", "camera", "task"):
            before = dict(leaves_of(as_json(getattr(standard, part)), f"{part}."))
            for path, value in leaves_of(as_json(getattr(self, part)), f"{part}."):
                if value != before.get(path):
                    changes.append(f"{path} is {value!r}, in the standard {before.get(path)!r}")
        if self.noise_name == OWN_NOISE:
            changes.append(f"noise differs from {', '.join(NOISE_PRESETS)}")
        return changes


def setting_of(config: Mapping[str, object], *, where: str) -> Setting:
    """Returns the setting that the configuration of a run records.

    Args:
        config: content of `config.json`.
        where: names the file for the error message.

    Raises:
        ConfigError: a part is missing, has a field that this version does not know, or a value that is not allowed. A
            field that it lacks has the standard value: with the same version of the physics, it did not exist.
    """
    tree = config.get("config")
    if not isinstance(tree, Mapping):
        raise ConfigError(f"{where}: its configuration has no field 'config'.")
    try:
        parts = {name: _part(getattr(Setting(), name), tree.get(name), name, where) for name in PARTS}
        setting = Setting(**parts, noise_name=_noise_name(parts["noise"]))
    except RecursionError:
        raise ConfigError(f"{where}: its configuration is nested too deeply.") from None
    if setting.robot.physics.timestep_s < MIN_TIMESTEP_S:
        raise ConfigError(f"{where}: robot.physics.timestep_s is below {MIN_TIMESTEP_S} s.")
    return setting


def _noise_name(noise: NoiseConfig) -> str:
    """Returns the preset that a noise is."""
    return next((name for name, preset in NOISE_PRESETS.items() if as_json(preset) == as_json(noise)), OWN_NOISE)


def _part(default: PartT, recorded: object, name: str, where: str) -> PartT:
    """Returns one part of a setting."""
    if not isinstance(recorded, Mapping):
        raise ConfigError(f"{where}: its configuration has no field 'config.{name}'.")
    if recorded.get("file") is not None:
        raise ConfigError(f"{where}: the robot is that of a file (--robot), which a submission does not contain.")
    values = dict(leaves_of(recorded))
    try:
        return with_fields(default, {path: value for path, value in values.items() if path != "file"})
    except ConfigError as error:
        raise ConfigError(f"{where}: {name} is not allowed in this version of the simulator: {error}") from None
