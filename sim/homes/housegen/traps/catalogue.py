"""All trap scenes by name, in the order of their episodes."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from sim.homes.housegen.traps import drops, glass, solid
from sim.homes.housegen.traps.trap import TrapMaker

TRAPS: Mapping[str, TrapMaker] = MappingProxyType(
    {
        maker.__name__: maker
        for maker in (
            solid.chair_legs,
            glass.glass_pane,
            glass.glass_door_ajar,
            solid.narrow_gap,
            solid.low_slab,
            solid.slippery_floor,
            solid.wedged_spawn,
            glass.furniture_u,
            glass.dead_end_corridor,
            glass.scan_artifact,
            solid.chair_in_doorway,
            glass.hanging_shelf,
            solid.mirror_holes,
            glass.glass_pocket,
            glass.glass_maze,
            solid.string_curtain,
            glass.glass_cell,
            glass.scan_forest,
            glass.glass_comb,
            drops.stairwell_edge,
            drops.sunken_area,
        )
    }
)
"""The first thirteen are the basic kinds of traps; six combine them; the last two have a drop."""
