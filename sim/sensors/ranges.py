"""Checks that the numbers of noise settings are in range."""

from __future__ import annotations

import math

from sim.core.errors import ConfigError


def require_range(config: object, low: float, high: float, *names: str) -> None:
    """Checks that fields of a dataclass are finite numbers in [low, high].

    Raises:
        ConfigError: a field is not; the message names the field, its bounds and the value.
    """
    for name in names:
        value = getattr(config, name)
        number = isinstance(value, int | float) and not isinstance(value, bool)
        if not (number and math.isfinite(value) and low <= value <= high):
            bounds = f">= {low:g}" if math.isinf(high) else f"in [{low:g}, {high:g}]"
            raise ConfigError(f"{type(config).__name__}.{name} must be a finite number {bounds}, got {value!r}.")


def require_whole(config: object, low: int, high: int, *names: str) -> None:
    """Checks that fields of a dataclass are integers in [low, high], as sizes of arrays must be.

    Raises:
        ConfigError: a field is not; the message names the field, its bounds and the value.
    """
    for name in names:
        value = getattr(config, name)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise ConfigError(
                f"{type(config).__name__}.{name} must be a whole number in [{low}, {high}], got {value!r}."
            )
