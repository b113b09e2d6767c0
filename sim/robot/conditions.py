"""Floor friction and motor gains that can differ between episodes in one world."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sim.errors import ConfigError


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """Factors on the values of a compiled world; `NOMINAL` changes nothing."""

    floor_friction_scale: float = 1.0
    """Factor on the sliding friction of all floors."""
    motor_gain_scale: tuple[float, float] = (1.0, 1.0)
    """Factors on the speeds of the left and the right motor: with 0.9 a wheel turns at 90 % of its command."""

    def __post_init__(self) -> None:
        for name, value in (
            ("floor_friction_scale", self.floor_friction_scale),
            ("motor_gain_scale", self.motor_gain_scale[0]),
            ("motor_gain_scale", self.motor_gain_scale[1]),
        ):
            if not (math.isfinite(value) and value > 0.0):
                raise ConfigError(f"Conditions.{name} must be finite and > 0, got {value}.")


NOMINAL = Conditions()
"""The conditions of the compiled world."""
