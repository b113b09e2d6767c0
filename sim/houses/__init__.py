"""Houses: generated, read, labelled and checked. `generate(seed)` gives a new one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.houses.generator import generate

__all__ = ["generate"]


def __getattr__(name: str) -> Any:
    """`generate`, imported when it is asked for: whoever only loads a house needs no furniture."""
    if name == "generate":
        from sim.houses.generator import generate

        return generate
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
