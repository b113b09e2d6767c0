"""What differs between episodes in one world: how slippery the floors are and how strong each motor is."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sim.errors import ConfigError


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """Factors on the world as its files have it; `NOMINAL` changes nothing."""

    floor_friction_scale: float = 1.0
    """On the sliding friction of everything labelled floor."""
    motor_gain_scale: tuple[float, float] = (1.0, 1.0)
    """On the speed that the left and the right motor aim at: at 0.9 a wheel turns at 90 % of what was commanded."""

    def __post_init__(self) -> None:
        for name, value in (
            ("floor_friction_scale", self.floor_friction_scale),
            ("motor_gain_scale", self.motor_gain_scale[0]),
            ("motor_gain_scale", self.motor_gain_scale[1]),
        ):
            if not (math.isfinite(value) and value > 0.0):
                raise ConfigError(f"Conditions.{name} must be finite and > 0, got {value}.")


NOMINAL = Conditions()
