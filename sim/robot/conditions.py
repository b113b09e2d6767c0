"""Floor friction, and errors of motors, encoders and gyro, of one episode: constants, and what varies in it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sim.core.errors import ConfigError

MAX_STD = 0.3
"""Largest standard deviation of an action's errors: three of them leave every scale positive."""


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """Factors on the values of a compiled world; `NOMINAL` changes nothing."""

    floor_friction_scale: float = 1.0
    """Factor on the sliding friction of all floors."""
    motor_gain_scale: tuple[float, float] = (1.0, 1.0)
    """Factors on the speeds of the left and the right motor: with 0.9 a wheel turns at 90 % of its command."""
    motor_bias_rad_s: tuple[float, float] = (0.0, 0.0)
    """Added to the commanded speed of the left and the right wheel while the robot moves."""
    motor_latency_s: float = 0.0
    """Delay of the commands, rounded to ticks of the controller."""
    encoder_scale: tuple[float, float] = (1.0, 1.0)
    """Measured by true distance of the left and the right wheel: the radius of a tyre is not exactly known."""
    gyro_scale: float = 1.0
    """Measured by true turn rate."""
    gyro_bias_rad_s: float = 0.0
    """Turn rate that the gyro measures at rest."""
    stop_std_m: float = 0.0
    """Standard deviation, from action to action, of the distance by which a forward stops too early or too late."""
    stop_std_rad: float = 0.0
    """The same of the heading that an action keeps or reaches; both errors are known to the odometry."""
    wheel_std: float = 0.0
    """The same of the relative error of the measured distance of both wheels, which the odometry does not know."""
    gyro_std: float = 0.0
    """The same of the relative error of the measured angle."""
    motor_std: float = 0.0
    """The same of the relative error of the speed of each motor."""
    seed: int = 0
    """The errors of the actions are drawn from it (`sim.robot.variation`)."""

    def __post_init__(self) -> None:
        for name, value in (
            ("floor_friction_scale", self.floor_friction_scale),
            ("motor_gain_scale", self.motor_gain_scale[0]),
            ("motor_gain_scale", self.motor_gain_scale[1]),
            ("encoder_scale", self.encoder_scale[0]),
            ("encoder_scale", self.encoder_scale[1]),
            ("gyro_scale", self.gyro_scale),
        ):
            if not (math.isfinite(value) and value > 0.0):
                raise ConfigError(f"Conditions.{name} must be finite and > 0, got {value}.")
        if not (math.isfinite(self.motor_latency_s) and self.motor_latency_s >= 0.0):
            raise ConfigError(f"Conditions.motor_latency_s must be finite and >= 0, got {self.motor_latency_s}.")
        for name in ("stop_std_m", "stop_std_rad", "wheel_std", "gyro_std", "motor_std"):
            if not 0.0 <= getattr(self, name) <= MAX_STD:
                raise ConfigError(f"Conditions.{name} must lie in [0, {MAX_STD}], got {getattr(self, name)}.")
        if not all(map(math.isfinite, (*self.motor_bias_rad_s, self.gyro_bias_rad_s))):
            raise ConfigError(
                "Conditions.motor_bias_rad_s and gyro_bias_rad_s must be finite, got "
                f"{self.motor_bias_rad_s} and {self.gyro_bias_rad_s}."
            )


NOMINAL = Conditions()
"""The conditions of the compiled world."""
