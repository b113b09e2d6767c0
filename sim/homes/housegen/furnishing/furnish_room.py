"""Furnishes a room by the rule of its kind, again if a required piece is missing, then fills it and adds fittings."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

from sim.homes.housegen.furnishing.clutter import add_clutter
from sim.homes.housegen.furnishing.filling import fill_room
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import RoomLayout
from sim.homes.housegen.furnishing.placement.on_walls import hang_before_window, hang_from_ceiling
from sim.homes.housegen.furnishing.room_rules import RULES
from sim.homes.housegen.furniture.item import Item
from sim.world.room_requirements import Piece, missing_pieces

MAX_TRIES = 12
"""Largest number of times that one room is furnished."""
ROUNDING_M, ROUNDING_M2 = 0.02, 0.05
"""Margins for lengths and areas, which the check of the finished house measures again on the geoms."""

FLAT_LAMPS = frozenset(("bathroom", "kitchen", "hallway", "stair_hall", "laundry", "closet", "gym", "office"))
"""Rooms without a chandelier."""
BESIDE_MIDDLE_M = ((0.0, 0.0), (0.8, 0.0), (-0.8, 0.0), (0.0, 0.8), (0.0, -0.8))
"""Places of a lamp from the middle of the ceiling, in the order in which they are tried."""


class FurnishError(Exception):
    """A room that lacks a required piece of furniture after all tries."""


def furnish(layout: RoomLayout, source: FurnitureSource) -> None:
    """Furnishes a room by the rule of its kind, then fills it and adds curtains and a lamp.

    A room in which a required piece found no position is emptied and furnished again, up to `MAX_TRIES` times.

    Raises:
        FurnishError: a required piece is still missing after the last try.
    """
    source.enter(layout)
    empty, missing = layout.snapshot(), [""]
    for _ in range(MAX_TRIES):
        RULES[layout.kind](layout, source)
        missing = missing_pieces(layout.kind, layout.inner.area_m2 + ROUNDING_M2, list(_pieces(layout)))
        if not missing:
            break
        layout.restore(empty)
    else:
        raise FurnishError(f"a {layout.kind} of {layout.inner.area_m2:.1f} m2 {', '.join(missing)}")
    fill_room(layout, source)
    _hang_curtains(layout, source)
    _hang_ceiling_lamps(layout, source)
    add_clutter(layout, source)


def _pieces(layout: RoomLayout) -> Iterator[Piece]:
    """Yields the instances of a room, with those on and in other items."""
    waiting: list[Item] = [placement.item for placement in layout.placements]
    while waiting:
        item = waiting.pop()
        yield Piece(item.category, max(item.size_m) - ROUNDING_M, item.name)
        waiting += [child.item for child in item.children]


def _hang_curtains(layout: RoomLayout, source: FurnitureSource) -> None:
    """Hangs the same curtains or blinds at every window of a room; long curtains where the floor below is free."""
    style = source.rng.random()
    looks = source.window_looks()
    for side, window in layout.walls.windows():
        width, height = window.span[1] - window.span[0], window.top_m - window.bottom_m
        tries = [("blinds", width - 0.02, height - 0.02)]
        if layout.kind not in ("bathroom", "laundry", "kitchen", "hallway") and style < 0.7:
            wide = math.ceil(5.0 * (width + 0.3)) / 5.0  # few widths: windows of nearly one size share a curtain
            tries = [("curtain", wide, 2.2), ("curtain", wide, math.ceil(5.0 * (height + 0.2)) / 5.0), *tries]
        if style > 0.88:
            return
        for category, wide, high in tries:
            item = source.make(category, width_m=round(wide, 2), height_m=round(high, 2), looks=looks)
            if item is not None and item.mount == "wall" and hang_before_window(layout, item, side, window):
                break


def _hang_ceiling_lamps(layout: RoomLayout, source: FurnitureSource) -> None:
    """Hangs a lamp from the middle of the ceiling, several along a hallway.

    Of the three designs of a home, a flat one hangs in rooms to work and walk in, and where the first one would hang
    into furniture, such as a bed with a canopy; a lamp that is in the way everywhere hangs beside the middle.
    """
    designs = [source.make("lighting", "ceiling") for _ in range(3)]
    lamps = [lamp for lamp in designs if lamp is not None and lamp.mount == "ceiling"]
    if not lamps:
        return
    lamp = lamps[0]
    if layout.kind in FLAT_LAMPS:
        lamp = min(lamps, key=lambda lamp: (lamp.name not in ("ceiling lamp", "spotlights"), lamp.size_m[2]))
    count = max(1, int(layout.inner.long_m / 4.5)) if layout.kind == "hallway" else 1
    for n in range(count):
        x, y = layout.inner.centre
        if count > 1:
            along = (n + 0.5) / count
            if layout.inner.width_m > layout.inner.depth_m:
                x = layout.inner.x0 + along * layout.inner.width_m
            else:
                y = layout.inner.y0 + along * layout.inner.depth_m
        flatter = sorted(lamps, key=lambda lamp: lamp.size_m[2])
        for (dx, dy), design in itertools.product(BESIDE_MIDDLE_M, (lamp, *flatter)):
            if hang_from_ceiling(layout, design, x + dx, y + dy):
                break
