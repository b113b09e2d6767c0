"""Finds positions for items in one room: on the floor, on walls, on other items and on the ceiling.

`RoomLayout` (layout) records what a room contains and answers whether a position is free. It rejects whatever would
overlap another item, stand in a doorway or in front of a window, or divide the free floor of the room. The functions
of `floor`, `free_standing`, `on_walls` and `surfaces` search for positions and add items to a layout. The check of the
finished house (`sim.world.check`) then measures the same on the real geoms.
"""

from __future__ import annotations

from sim.homes.housegen.furnishing.placement.layout import RoomLayout
from sim.homes.housegen.furnishing.placement.records import Placement

__all__ = ["Placement", "RoomLayout"]
