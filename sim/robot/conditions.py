"""Floor friction, and errors of motors, encoders and gyro, that can differ between episodes in one world."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sim.core.errors import ConfigError


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
        if not all(map(math.isfinite, (*self.motor_bias_rad_s, self.gyro_bias_rad_s))):
            raise ConfigError(
                "Conditions.motor_bias_rad_s and gyro_bias_rad_s must be finite, got "
                f"{self.motor_bias_rad_s} and {self.gyro_bias_rad_s}."
            )


NOMINAL = Conditions()
"""The conditions of the compiled world."""
