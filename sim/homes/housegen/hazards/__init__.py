"""Hazards for generated houses: obstacles that depth cannot see, sees too late or takes for passable.

Each family is a module with designs; `draw_hazards` places them where shortest paths between rooms lead, so that every
room stays reachable. Sites named `hazard_<family>_<number>` mark their places (`sim.houses.hazards`).
"""

from __future__ import annotations

from sim.homes.housegen.hazards.hazard import PlacedHazard
from sim.homes.housegen.hazards.placement import FAMILIES, draw_hazards

__all__ = ["FAMILIES", "PlacedHazard", "draw_hazards"]
