"""Noise of the drive: floors and motors that differ from episode to episode; the motions follow from physics."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.errors import ConfigError
from sim.robot.conditions import NOMINAL, Conditions

_BOUNDS = (0.01, 10.0)


@dataclass(frozen=True, kw_only=True)
class ActuationNoise:
    """Ranges of an episode's conditions; every default is off.

    The driver controls the true pose, so moderate values cost time and a centimetre sideways; on floors with little
    friction the robot slides beyond its target or its wheels spin.
    """

    floor_friction_scale: tuple[float, float] = (1.0, 1.0)
    """Lowest and highest factor on the friction of the floors, sampled uniformly in its logarithm."""
    motor_gain_scale: tuple[float, float] = (1.0, 1.0)
    """Lowest and highest factor on the speed of a motor, sampled uniformly for each wheel."""

    def __post_init__(self) -> None:
        for name, value in (
            ("floor_friction_scale", self.floor_friction_scale),
            ("motor_gain_scale", self.motor_gain_scale),
        ):
            if not _is_range(value):
                raise ConfigError(
                    f"ActuationNoise.{name} must be (lowest, highest) with {_BOUNDS[0]} <= lowest <= highest "
                    f"<= {_BOUNDS[1]:g}, got {value!r}."
                )

    def draw(self, rng: np.random.Generator) -> Conditions:
        """Returns the conditions of an episode."""
        if self == ActuationNoise():
            return NOMINAL
        low, high = self.floor_friction_scale
        left, right = rng.uniform(*self.motor_gain_scale, 2).tolist()
        friction = math.exp(rng.uniform(math.log(low), math.log(high)))
        return Conditions(floor_friction_scale=friction, motor_gain_scale=(left, right))


def _is_range(value: object) -> bool:
    if not (isinstance(value, tuple) and len(value) == 2):
        return False
    if not all(isinstance(end, int | float) and not isinstance(end, bool) for end in value):
        return False
    return _BOUNDS[0] <= value[0] <= value[1] <= _BOUNDS[1]
