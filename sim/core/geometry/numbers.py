"""Checks that the numbers of a configuration are numbers."""

from __future__ import annotations

import dataclasses
import math

from sim.core.errors import ConfigError

LARGEST = 1e9
"""Largest magnitude of a number in a configuration."""


def require_numbers(config: object) -> None:
    """Checks that the numbers in the fields of a dataclass are finite and at most `LARGEST`.

    Raises:
        ConfigError: a number is NaN, infinite or larger; the message names the field and the value.
    """
    for field in dataclasses.fields(config):  # type: ignore[arg-type]
        value = getattr(config, field.name)
        if isinstance(value, int | float) and not isinstance(value, bool) and not is_number(value):
            raise ConfigError(
                f"{type(config).__name__}.{field.name} must be a finite number of at most {LARGEST:g}, got {value}."
            )


def is_number(value: float) -> bool:
    """Returns whether a value is finite and its magnitude at most `LARGEST`."""
    return math.isfinite(value) and abs(value) <= LARGEST
