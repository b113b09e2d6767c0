"""Furniture for the middle of large rooms: seats, plants and gym machines where much floor is bare."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.free_standing import put_in_middle
from sim.homes.housegen.furnishing.seating_groups import armchair_circle
from sim.homes.housegen.furnishing.steps import lay_rug, put_on_top

Spot = tuple[float, float]
"""x and y of the middle of bare floor."""
BARE_M = 1.35
"""Radius of the largest circle of bare floor that a room may keep."""
MAX_GROUPS = 4


def fill_middle(layout: RoomLayout, source: FurnitureSource) -> None:
    """Places groups where a circle of bare floor is larger than `BARE_M`, as long as the room stays walkable."""
    additions = list(MIDDLES.get(layout.kind, ()))
    for _ in range(MAX_GROUPS):
        radius_m, spot = layout.grid.widest_free()
        if radius_m < BARE_M or not additions:
            return
        for n in source.rng.permutation(len(additions)).tolist():
            if additions[n](layout, source, spot):
                break
        else:
            return


def _seats(layout: RoomLayout, source: FurnitureSource, spot: Spot) -> Placement | None:
    return armchair_circle(layout, source, near=spot)


def _machine(layout: RoomLayout, source: FurnitureSource, spot: Spot) -> Placement | None:
    """Places a gym machine on the bare floor; a machine of a style that the room has already only if no other fits."""
    for n in range(4):
        item = source.make("gym_equipment", "machine" if source.chance(0.6) else "weights", fresh=n > 0)
        if item is not None and item.mount == "floor" and not item.walk_over:
            placed = put_in_middle(layout, source.rng, item, (), around_m=0.8, apart_m=0.6, near=spot)
            if placed is not None:
                return placed
    return None


def _bench(layout: RoomLayout, source: FurnitureSource, spot: Spot) -> Placement | None:
    """Places a bench or an ottoman on a rug."""
    return _alone(layout, source, spot, "seating", "plain" if source.chance(0.6) else "ottoman", rug=True)


def _plant(layout: RoomLayout, source: FurnitureSource, spot: Spot) -> Placement | None:
    return _alone(layout, source, spot, "plant", "floor", rug=False)


def _alone(
    layout: RoomLayout, source: FurnitureSource, spot: Spot, category: str, use: str, *, rug: bool
) -> Placement | None:
    """Places one item on bare floor if the home has a style of it less than twice."""
    if not source.has_unused(category, use):
        return None
    item = source.make(category, use)
    if item is None or item.mount != "floor":
        return None
    placed = put_in_middle(layout, source.rng, item, (), around_m=0.8, apart_m=0.65, near=spot)
    if placed is not None and rug:
        turn = 0.0 if layout.inner.width_m < layout.inner.depth_m else math.pi / 2
        lay_rug(layout, source, placed.placed.x_m, placed.placed.y_m, turn, runner=False)
    if placed is not None and item.surfaces:
        put_on_top(layout, source, placed, ("objects", "plant"), (0.6, 0.3))
    return placed


MIDDLES: Mapping[str, tuple[Callable[[RoomLayout, FurnitureSource, Spot], Placement | None], ...]] = MappingProxyType(
    {
        "living_room": (_seats, _bench),
        "bedroom": (_seats, _bench),
        "dining_room": (_seats, _plant),
        "studio": (_seats,),
        "office": (_seats,),
        "gym": (_machine, _machine, _bench),
        "hallway": (_bench, _plant),
    }
)
"""Furniture for the middle of large rooms, by kind of room."""
