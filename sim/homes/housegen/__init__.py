"""Generates furnished apartments in MJCF from seeds. `generate(seed)` returns a new one.

`generator` draws and checks a house. The folders are its steps: `floor_plan` (rooms), `structure` (openings, walls,
doors, windows, stairs), `furnishing` (chooses `furniture` and places it in rooms), `surfaces` (materials, textures,
light), `hazards`, `mjcf` (writes the specification), and `ground` (friction, rugs, thresholds). `upper_storey` repeats
some steps for a second storey. `imported` adds models that the user has installed, `traps` builds trap scenes, and
`splits` lists how each shipped house is generated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim.homes.housegen.config import HouseConfig
    from sim.homes.housegen.generator import generate

__all__ = ["HouseConfig", "generate"]


def __getattr__(name: str) -> Any:
    """Returns `generate` or `HouseConfig`, imported on first use: recipes and house lists need no furniture."""
    if name in __all__:
        from sim.homes.housegen import generator

        return getattr(generator, name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
