"""Positions on walls, in front of windows and on the ceiling."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from sim.homes.housegen.floor_plan.rectangles import INWARD_YAW_RAD, SIDES, Rect, Side, footprint
from sim.homes.housegen.furnishing.placement.layout import ROBOT_HEIGHT_M, RoomLayout
from sim.homes.housegen.furnishing.placement.records import Placement
from sim.homes.housegen.furnishing.placement.walls import Along
from sim.homes.housegen.furniture.item import Item
from sim.homes.housegen.mjcf.placed import PlacedItem
from sim.homes.housegen.structure.openings import Opening

SHALLOW_M = 0.12
"""Low wall items no deeper than this do not stand in the robot's path."""


def hang_on_wall(
    layout: RoomLayout,
    rng: np.random.Generator,
    item: Item,
    *,
    bottom_m: float | None = None,
    sides: Sequence[Side] | None = None,
    along: Along = "any",
    at: float | None = None,
    margin_m: float = 0.05,
    over_floor: bool = False,
    fits: Callable[[Placement], bool] = lambda _: True,
) -> Placement | None:
    """Hangs an item on a wall; returns None if it does not fit.

    Args:
        layout: the room.
        rng: decides between equally good positions.
        item: wall item.
        bottom_m: height of its origin; the item's usual height when None.
        sides: walls allowed, tried in this order; all in random order when None.
        along: preferred position along the wall.
        at: position along the only side given; any when None.
        margin_m: distance to other items.
        over_floor: nothing may stand below it.
        fits: returns whether a position is suitable otherwise; it is called before the item is added.
    """
    bottom_m = item.mount_height_m if bottom_m is None else bottom_m
    is_low = bottom_m < ROBOT_HEIGHT_M and item.size_m[0] > SHALLOW_M
    order = list(sides) if sides is not None else [SIDES[i] for i in rng.permutation(4)]
    for side in order:
        positions = [at] if at is not None else layout.walls.positions(rng, side, item.size_m[1], along, 0.1)
        for position in positions:
            placement = _on_wall(layout, item, side, position, bottom_m)
            free = is_wall_free(layout, item, side, position, bottom_m, margin_m=margin_m, over_floor=over_floor)
            if not free or not fits(placement) or (is_low and not _leaves_room(layout, placement.rect)):
                continue
            if is_low:
                layout.grid.occupy(placement.rect)
            layout.add(placement, 0.0 if over_floor else bottom_m, bottom_m + item.size_m[2])
            return placement
    return None


def is_wall_free(
    layout: RoomLayout,
    item: Item,
    side: Side,
    at: float,
    bottom_m: float,
    *,
    margin_m: float = 0.05,
    over_floor: bool = False,
) -> bool:
    """Returns whether no opening and no other item is where an item would hang on a wall."""
    top_m = bottom_m + item.size_m[2]
    span = (at - item.size_m[1] / 2, at + item.size_m[1] / 2)
    rect = layout.inner.strip(side, span, item.size_m[0])
    padded = layout.inner.strip(side, (span[0] - margin_m, span[1] + margin_m), item.size_m[0] + 0.02)
    if not layout.inner.contains(rect, 0.002) or layout.walls.meets_opening(side, span, bottom_m, top_m):
        return False
    lowest_m = 0.0 if over_floor else bottom_m - margin_m
    return top_m <= layout.ceiling_m - 0.03 and layout.is_clear(
        padded, lowest_m, top_m + margin_m, doorways=bottom_m < 2.0
    )


def _leaves_room(layout: RoomLayout, rect: Rect) -> bool:
    """Returns whether the robot can still pass and reach everything with a low item at a wall."""
    return not (layout.in_reserved_zone(rect) or layout.narrows_hallway(rect)) and layout.grid.stays_walkable(
        rect, [rect]
    )


def hang_before_window(layout: RoomLayout, item: Item, side: Side, window: Opening) -> bool:
    """Hangs a curtain or blind in front of a window, its top a little above it; returns False if it does not fit."""
    top_m = min(window.top_m + 0.14, layout.ceiling_m - 0.02)
    bottom_m = top_m - item.size_m[2]
    placement = _on_wall(layout, item, side, window.centre_m, bottom_m)
    rect = placement.rect
    if bottom_m < 0.01 or not layout.inner.contains(rect, 0.002) or not layout.is_clear(rect, bottom_m, top_m):
        return False
    layout.add(placement, bottom_m, bottom_m + item.size_m[2])
    return True


def _on_wall(layout: RoomLayout, item: Item, side: Side, at: float, bottom_m: float) -> Placement:
    """Returns the placement of an item on a wall, its middle at a position along it."""
    rect = layout.inner.strip(side, (at - item.size_m[1] / 2, at + item.size_m[1] / 2), item.size_m[0])
    x, y = layout.walls.point(side, at, 0.0)
    return Placement(PlacedItem(item, x, y, bottom_m, INWARD_YAW_RAD[side]), rect, side)


def hang_from_ceiling(layout: RoomLayout, item: Item, x_m: float, y_m: float) -> bool:
    """Hangs a lamp from the ceiling; returns False if something is in its place."""
    rect = footprint(x_m, y_m, item.size_m[0], item.size_m[1], 0.0)
    bottom_m = layout.ceiling_m - item.size_m[2]
    if not layout.is_clear(rect, bottom_m, layout.ceiling_m, doorways=False):
        return False
    layout.add(Placement(PlacedItem(item, x_m, y_m, layout.ceiling_m), rect), bottom_m, bottom_m + item.size_m[2])
    return True
