"""Noise of the drive: floors, motors, encoders and gyros that differ from episode to episode and from action to action.

The motions follow from physics: errors of motors show where the controller cannot correct them in time, errors of
encoders and gyro in every motion, since the controller knows nothing else. An episode has the errors of one robot;
those of its actions vary around them (`sim.robot.variation`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.core.errors import ConfigError
from sim.robot.conditions import MAX_STD, NOMINAL, Conditions

_BOUNDS = (0.01, 10.0)
VARIATIONS = ("stop_std_m", "stop_std_rad", "wheel_std", "gyro_std", "motor_std")
"""Fields of `Conditions` that vary from action to action, copied from those of the same names."""


@dataclass(frozen=True, kw_only=True)
class ActuationNoise:
    """Ranges of an episode's conditions (`sim.robot.conditions`); every default is off."""

    floor_friction_scale: tuple[float, float] = (1.0, 1.0)
    """Lowest and highest factor on the friction of the floors, sampled uniformly in its logarithm."""
    motor_gain_scale: tuple[float, float] = (1.0, 1.0)
    """Lowest and highest factor on the speed of a motor, sampled uniformly for each wheel."""
    motor_bias_rad_s: float = 0.0
    """Largest speed that is added to a wheel's command, sampled uniformly for each wheel with either sign."""
    motor_latency_s: float = 0.0
    """Largest delay of the commands, sampled uniformly."""
    encoder_scale: tuple[float, float] = (1.0, 1.0)
    """Lowest and highest factor on the measured distance of both wheels, sampled uniformly."""
    encoder_mismatch: float = 0.0
    """Largest relative difference of the two wheels; without a gyro it bends the path."""
    gyro_scale: tuple[float, float] = (1.0, 1.0)
    """Lowest and highest factor on the measured angle, sampled uniformly."""
    gyro_bias_rad_s: float = 0.0
    """Largest turn rate that the gyro measures at rest, sampled uniformly with either sign."""
    stop_std_m: float = 0.0
    """Standard deviation, from action to action, of where a forward stops by its own odometry."""
    stop_std_rad: float = 0.0
    """The same of the heading that an action keeps or reaches."""
    wheel_std: float = 0.0
    """The same of the measured by the true distance."""
    gyro_std: float = 0.0
    """The same of the measured by the true angle."""
    motor_std: float = 0.0
    """The same of the speed of each motor by its command."""

    def __post_init__(self) -> None:
        for name, value in (
            ("floor_friction_scale", self.floor_friction_scale),
            ("motor_gain_scale", self.motor_gain_scale),
            ("encoder_scale", self.encoder_scale),
            ("gyro_scale", self.gyro_scale),
        ):
            if not _is_range(value):
                raise ConfigError(
                    f"ActuationNoise.{name} must be (lowest, highest) with {_BOUNDS[0]} <= lowest <= highest "
                    f"<= {_BOUNDS[1]:g}, got {value!r}."
                )
        for name, value, most in (
            ("motor_bias_rad_s", self.motor_bias_rad_s, 10.0),
            ("motor_latency_s", self.motor_latency_s, 0.2),
            ("encoder_mismatch", self.encoder_mismatch, 0.5),
            ("gyro_bias_rad_s", self.gyro_bias_rad_s, 1.0),
            *((name, getattr(self, name), MAX_STD) for name in VARIATIONS),
        ):
            if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value <= most:
                raise ConfigError(f"ActuationNoise.{name} must be a number in [0, {most:g}], got {value!r}.")

    def draw(self, rng: np.random.Generator) -> Conditions:
        """Returns the conditions of an episode."""
        if self == ActuationNoise():
            return NOMINAL
        low, high = self.floor_friction_scale
        left, right = rng.uniform(*self.motor_gain_scale, 2).tolist()
        friction = math.exp(rng.uniform(math.log(low), math.log(high)))
        bias = self.motor_bias_rad_s * rng.uniform(-1.0, 1.0, 2)
        latency_s = rng.uniform(0.0, self.motor_latency_s)
        encoder, mismatch = rng.uniform(*self.encoder_scale), 0.5 * self.encoder_mismatch * rng.uniform(-1.0, 1.0)
        return Conditions(
            floor_friction_scale=friction,
            motor_gain_scale=(left, right),
            motor_bias_rad_s=(float(bias[0]), float(bias[1])),
            motor_latency_s=latency_s,
            encoder_scale=(encoder * (1.0 - mismatch), encoder * (1.0 + mismatch)),
            gyro_scale=rng.uniform(*self.gyro_scale),
            gyro_bias_rad_s=self.gyro_bias_rad_s * rng.uniform(-1.0, 1.0),
            seed=int(rng.integers(2**32)),
            **{name: getattr(self, name) for name in VARIATIONS},
        )


def _is_range(value: object) -> bool:
    if not (isinstance(value, tuple) and len(value) == 2):
        return False
    if not all(isinstance(end, int | float) and not isinstance(end, bool) for end in value):
        return False
    return _BOUNDS[0] <= value[0] <= value[1] <= _BOUNDS[1]
