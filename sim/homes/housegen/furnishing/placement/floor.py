"""Positions on the floor: against a wall, at a given pose, partly under another item, or in a row."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from sim.homes.housegen.floor_plan.rectangles import SIDES, Side
from sim.homes.housegen.furnishing.placement.layout import RoomLayout
from sim.homes.housegen.furnishing.placement.records import (
    Placement,
    boxes_touch,
    floor_placement,
    geom_boxes,
    zone_in_front,
)
from sim.homes.housegen.furnishing.placement.walls import WALL_GAP_M, Along
from sim.homes.housegen.furniture.item import Item
from sim.homes.housegen.mjcf.merging import collision_geoms

MAX_CHECKS = 16
"""Positions along the walls that are tested for walkability before the search for one item ends."""
TUCK_OUT_M, TUCK_STEP_M = 0.3, 0.04
SLIDE_STEP_M = 0.1


def put_against_wall(
    layout: RoomLayout,
    rng: np.random.Generator,
    item: Item,
    *,
    sides: Sequence[Side] | None = None,
    along: Along = "any",
    front_m: float = 0.6,
    beside_m: float = 0.0,
    gap_m: float = WALL_GAP_M,
    fits: Callable[[Placement], bool] = lambda _: True,
) -> Placement | None:
    """Puts an item with its back to a wall; returns None if it does not fit.

    Args:
        layout: the room.
        rng: decides between equally good positions.
        item: floor item.
        sides: walls allowed, tried in this order; all in random order when None.
        along: preferred position along the wall.
        front_m: length of the zone that is reserved in front of it.
        beside_m: wall that should stay free on either side (for nightstands, chairs).
        gap_m: distance between its back and the wall.
        fits: returns whether a position is suitable otherwise; it is called before the item is added.
    """
    order = list(sides) if sides is not None else [SIDES[i] for i in rng.permutation(4)]
    most_checks = layout.grid.checks + MAX_CHECKS
    for side in order:
        for at in layout.walls.positions(rng, side, item.size_m[1], along, beside_m):
            if layout.grid.checks >= most_checks:
                return None
            placement = layout.walls.placement(item, side, at, gap_m)
            if fits(placement) and _put_at_wall(layout, placement, side, front_m):
                return placement
    return None


def put_near(
    layout: RoomLayout,
    item: Item,
    side: Side,
    at: float,
    *,
    front_m: float,
    slide_m: float = 0.8,
    fits: Callable[[Placement], bool] = lambda _: True,
) -> Placement | None:
    """Puts an item against a wall at a position along it, or at most `slide_m` away from it, where `fits` allows it."""
    lo, hi = layout.inner.span(side)
    half = item.size_m[1] / 2
    for position in _shifted(at, slide_m):
        span = (position - half, position + half)
        free = any(a - 0.002 <= span[0] and span[1] <= b + 0.002 for a, b in layout.walls.free_stretches(side))
        if span[0] < lo - 0.002 or span[1] > hi + 0.002 or not free:
            continue
        placement = layout.walls.placement(item, side, position)
        if fits(placement) and _put_at_wall(layout, placement, side, front_m):
            return placement
    return None


def put_at(layout: RoomLayout, item: Item, x_m: float, y_m: float, yaw_rad: float) -> Placement | None:
    """Puts an item exactly at this pose; returns None if it does not fit."""
    placement = floor_placement(item, x_m, y_m, yaw_rad)
    return placement if layout.try_put(placement) else None


def put_partly_under(
    layout: RoomLayout, item: Item, host: Placement, x_m: float, y_m: float, yaw_rad: float
) -> Placement | None:
    """Puts an item partly under `host` (a chair under a table).

    It is moved back along its own -x, up to `TUCK_OUT_M`, until the two do not touch.
    """
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    host_boxes = geom_boxes(collision_geoms(host.item), host.placed)
    geoms = collision_geoms(item)
    for step in range(int(TUCK_OUT_M / TUCK_STEP_M) + 1):
        placement = floor_placement(item, x_m - c * TUCK_STEP_M * step, y_m - s * TUCK_STEP_M * step, yaw_rad)
        if boxes_touch(geom_boxes(geoms, placement.placed), host_boxes):
            continue
        return placement if layout.try_put(placement, ignore=host.rect) else None
    return None


def find_row_start(layout: RoomLayout, items: Sequence[Item], side: Side, front_m: float, gap_m: float) -> float | None:
    """Returns where a row of items can begin along a side, preferably in a corner; None if it does not fit."""
    length_m = sum(item.size_m[1] + gap_m for item in items)
    for lo, hi in sorted(layout.walls.free_stretches(side), key=lambda s: s[0] - s[1]):
        spare_m = hi - lo - length_m - 0.006
        if spare_m < 0:
            continue
        steps = np.arange(0.0, spare_m, 0.1).tolist()
        for shift_m in (0.0, spare_m, *steps[1:]):
            if _row_fits(layout, items, side, lo + 0.003 + shift_m, front_m, gap_m):
                return lo + 0.003 + shift_m
    return None


def lay_flat(layout: RoomLayout, item: Item, x_m: float, y_m: float, yaw_rad: float) -> bool:
    """Lays a flat item (a rug) on the floor; other items may stand on it, but no other flat item may overlap it."""
    placement = floor_placement(item, x_m, y_m, yaw_rad)
    flat = [p.rect for p in layout.placements if p.item.walk_over]
    if not layout.inner.contains(placement.rect.grown(0.03)) or any(placement.rect.overlaps(rect) for rect in flat):
        return False
    if layout.in_doorway(placement.rect, 0.25):
        return False
    layout.placements.append(placement)
    return True


def _put_at_wall(layout: RoomLayout, placement: Placement, side: Side, front_m: float) -> bool:
    """Puts an item against a wall and reserves the zone in front of it, if it fits and hides no window."""
    zones = [zone_in_front(placement.rect, side, front_m)] if front_m else []
    return not layout.walls.hides_window(placement) and layout.try_put(placement, zones)


def _shifted(at: float, most_m: float) -> Iterator[float]:
    """Yields a position and then positions on either side of it, farther and farther away."""
    yield at
    for step in range(1, int(most_m / SLIDE_STEP_M) + 1):
        for sign in (1.0, -1.0):
            yield at + sign * SLIDE_STEP_M * step


def _row_fits(
    layout: RoomLayout, items: Sequence[Item], side: Side, start: float, front_m: float, gap_m: float
) -> bool:
    """Returns whether a row of items fits along a side from the position `start` on."""
    at = start
    for item in items:
        placement = layout.walls.placement(item, side, at + item.size_m[1] / 2)
        at += item.size_m[1] + gap_m
        if (
            layout.walls.hides_window(placement)
            or not layout.is_clear(placement.rect, 0.0, item.size_m[2])
            or not layout.is_zone_free(zone_in_front(placement.rect, side, front_m))
            or layout.in_reserved_zone(placement.rect)
        ):
            return False
    return True
