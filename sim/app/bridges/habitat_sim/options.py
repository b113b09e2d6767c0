"""Options of the simulator for which Habitat's configuration has no entry."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, get_args

from sim.core.errors import ConfigError
from sim.renderer.profiles import get_profile
from sim.robot.config import MotionKind
from sim.sensors.noise import get_noise

VARIABLE = "STUBBORN_HABITAT"
"""Environment variable with options, such as `motion=sliding,noise=realsense`; `configure` has priority."""


@dataclass(frozen=True)
class Options:
    """Motion, noise and rendering of a simulator."""

    motion: MotionKind = "contacts"
    """`contacts`: physics. `no-sliding` and `sliding`: Habitat's kinematic motion over the robot's free space."""
    noise: str = "none"
    """Noise of cameras and drive, a preset of `sim.sensors.noise`. habitat-lab's gps and compass stay exact."""
    profile: str = "fast"
    """Rendering profile, `fast` or `good`."""
    detectors: str = ""
    """Address of `stubborn serve detectors`, to which each picture is sent with its truth."""

    def __post_init__(self) -> None:
        if self.motion not in get_args(MotionKind):
            raise ConfigError(f"motion must be one of {', '.join(get_args(MotionKind))}, got '{self.motion}'.")
        get_noise(self.noise)
        get_profile(self.profile)


_chosen: dict[str, str] = {}


def configure(**options: str) -> Options:
    """Sets options of each simulator that is made later in this process, and returns all of them.

    Args:
        options: fields of `Options`.

    Raises:
        ConfigError: an unknown option or value.
    """
    chosen = _options_of(_from_environment() | _chosen | options)
    _chosen.update(options)
    return chosen


def current_options() -> Options:
    """Returns the options of `configure`, else those of the environment variable.

    Raises:
        ConfigError: an unknown option or value.
    """
    return _options_of(_from_environment() | _chosen)


def _from_environment() -> dict[str, str]:
    pairs = [part.partition("=")[::2] for part in os.environ.get(VARIABLE, "").split(",") if part.strip()]
    return {name.strip(): value.strip() for name, value in pairs}


def _options_of(given: Mapping[str, Any]) -> Options:
    known = sorted(field.name for field in fields(Options))
    unknown = sorted(set(given) - set(known))
    if unknown:
        raise ConfigError(f"Unknown option '{unknown[0]}' of stubborn_habitat. Available: {', '.join(known)}.")
    return Options(**given)
