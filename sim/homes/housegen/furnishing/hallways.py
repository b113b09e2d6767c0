"""Hallways: furniture at intervals along the walls where the path next to it stays wide enough."""

from __future__ import annotations

import math

import numpy as np

from sim.homes.housegen.floor_plan.rectangles import Side
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import put_near
from sim.homes.housegen.furnishing.placement.walls import WALL_GAP_M
from sim.homes.housegen.furnishing.steps import hang, hang_above, lay_rug, put_on_top
from sim.homes.housegen.furniture.item import Item
from sim.world.room_arrangement import HALLWAY_PATH_M

INTERVAL_M = 2.4
"""Usual distance between two pieces of furniture."""
KINDS = (
    ("table", "console"), ("seating", "bench"), ("shelving", "bookcase"), ("plant", "floor"), ("cabinet", "sideboard"),
    ("table", "console"), ("plant", "floor"), ("seating", "plain"), ("chest_of_drawers", "dresser"),
    ("lighting", "floor"),
)  # fmt: skip
"""Category and use of the furniture of hallways."""
DECORATION = frozenset(("plant", "lighting", "picture", "floor"))
"""Categories without a use in a hallway; a hallway with only such items gets hooks, a mirror or a shelf."""
ON_WALLS = (("clothes", "hooks"), ("mirror", "wall"), ("shelving", "wall"))


def furnish_hallway(layout: RoomLayout, source: FurnitureSource) -> None:
    """Places coat hooks, furniture at intervals on either side, and runners."""
    if layout.inner.short_m > 1.15 and source.chance(0.7):
        hang(layout, source, "clothes", "hooks")
    _place_at_intervals(layout, source)
    if all(placement.item.category in DECORATION for placement in layout.placements):
        for uses in ON_WALLS:
            if hang(layout, source, *uses) is not None:
                break
    if source.chance(0.6):
        _lay_runners(layout, source)


def _lay_runners(layout: RoomLayout, source: FurnitureSource) -> None:
    """Lays rugs one after the other along a hallway."""
    wide = layout.inner.width_m > layout.inner.depth_m
    count = max(1, int(layout.inner.long_m / 4.0))
    for n in range(count):
        share = (n + 0.5) / count
        x = layout.inner.x0 + share * layout.inner.width_m if wide else layout.inner.centre[0]
        y = layout.inner.centre[1] if wide else layout.inner.y0 + share * layout.inner.depth_m
        lay_rug(layout, source, x, y, math.pi / 2 if wide else 0.0, runner=True, size_m=(0.75, 2.4))


def _place_at_intervals(layout: RoomLayout, source: FurnitureSource) -> None:
    """Places an item every few metres, on alternating sides, so that no two of the same category are neighbours."""
    sides: tuple[Side, Side] = ("south", "north") if layout.inner.width_m > layout.inner.depth_m else ("west", "east")
    lo, hi = layout.inner.span(sides[0])
    count = max(1, round((hi - lo) / INTERVAL_M * (0.7 + 0.5 * source.clutter)))
    kinds = [KINDS[n] for n in source.rng.permutation(len(KINDS)).tolist()]
    first = int(source.rng.integers(2))
    placed: list[str] = []
    for n, at in enumerate(np.linspace(lo, hi, 2 * count + 1)[1::2].tolist()):
        order = (sides[(n + first) % 2], sides[(n + first + 1) % 2])
        for tried, kind in enumerate(kinds):
            if kind[0] in placed[-2:]:
                continue
            if _place_near(layout, source, source.make(*kind), order, at) is not None:
                kinds.append(kinds.pop(tried))
                placed.append(kind[0])
                break


def _place_near(
    layout: RoomLayout, source: FurnitureSource, item: Item | None, sides: tuple[Side, Side], at: float
) -> Placement | None:
    """Places an item near a position along one of the sides, with small items on it, if the path stays free."""
    if item is None or item.mount != "floor" or layout.inner.short_m - item.size_m[0] - WALL_GAP_M < HALLWAY_PATH_M:
        return None
    for side in sides:
        placed = put_near(layout, item, side, at, front_m=HALLWAY_PATH_M)
        if placed is None:
            continue
        if item.category in ("table", "cabinet", "chest_of_drawers"):
            put_on_top(layout, source, placed, ("objects", "plant", "lighting"), (0.6, 0.4, 0.3))
            hang_above(layout, source, placed, "mirror" if source.chance(0.5) else "picture")
        return placed
    return None
