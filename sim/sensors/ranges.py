"""Refuses values of a sensor's config that no sensor has."""

from __future__ import annotations

import math

from sim.errors import ConfigError


def require_range(config: object, low: float, high: float, *names: str) -> None:
    """Refuse fields of a config that are not numbers in [low, high].

    Raises:
        ConfigError: naming the field, its bounds and what was given.
    """
    for name in names:
        value = getattr(config, name)
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if not (number and math.isfinite(value) and low <= value <= high):
            bounds = f">= {low:g}" if math.isinf(high) else f"in [{low:g}, {high:g}]"
            raise ConfigError(f"{type(config).__name__}.{name} must be a finite number {bounds}, got {value!r}.")
