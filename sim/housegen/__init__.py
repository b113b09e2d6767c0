"""Procedural apartments: from a seed to a furnished house in MJCF. `generate(seed)` gives a new one.

Imports world (which checks the houses), houses, geometry and the base modules of `sim`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.housegen.generator import generate

__all__ = ["generate"]


def __getattr__(name: str) -> Any:
    """Returns `generate`, imported on first use: the recipes of shipped houses need no furniture."""
    if name == "generate":
        from sim.housegen.generator import generate

        return generate
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
