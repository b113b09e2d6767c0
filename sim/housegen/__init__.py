"""Generates furnished apartments in MJCF from seeds. `generate(seed)` returns a new one.

The order of the work: floor_plan and openings, structure (walls, doors, windows), furnishing (by means of furniture and
placement), then mjcf writes the specification. `split_recipes` lists how each shipped house is generated; `house_list`
reads and writes `houses.json`, the list of a split whose houses are not shipped as files.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.housegen.generator import generate

__all__ = ["generate"]


def __getattr__(name: str) -> Any:
    """Returns `generate`, imported on first use: recipes and house lists need no furniture."""
    if name == "generate":
        from sim.housegen.generator import generate

        return generate
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
