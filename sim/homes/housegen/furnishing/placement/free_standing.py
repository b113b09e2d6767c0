"""Positions away from the walls, for items with seats that must be usable: dining tables, kitchen islands."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from sim.homes.housegen.floor_plan.rectangles import Rect, rotated_extent
from sim.homes.housegen.furnishing.placement.layout import ROBOT_HEIGHT_M, RoomLayout
from sim.homes.housegen.furnishing.placement.records import Placement, floor_placement
from sim.homes.housegen.furniture.item import Item

GRID_M = 0.3
"""Distance between the positions that are tried all over a room."""
RANDOM_POSES = 12

SeatSpot = tuple[float, float, float]
"""x, y in the item's frame, and the radius of the free floor required there."""


def put_in_middle(
    layout: RoomLayout,
    rng: np.random.Generator,
    item: Item,
    seats: Sequence[SeatSpot],
    *,
    around_m: float,
    least: float = 0.0,
    apart_m: float,
    near: tuple[float, float] | None = None,
) -> Placement | None:
    """Puts an item where most of its seats can be used, preferably near the middle of the room.

    Args:
        layout: the room.
        rng: decides between positions.
        item: floor item.
        seats: free floor required around the item.
        around_m: preferred distance from the walls.
        least: share of the seats that must be usable; two of them must be in any case.
        apart_m: smallest distance from walls and other items.
        near: point to which it should be near; the middle of the room when None.
    """
    required = max(min(2, len(seats)), least * len(seats))
    best: tuple[int, Placement] | None = None
    poses = _candidate_poses(layout, rng, item, around_m) if near is None else _poses_near(layout, near)
    for x, y, yaw in poses:
        placement = floor_placement(item, x, y, yaw)
        around = placement.rect.grown(apart_m)
        if not layout.inner.contains(around, 0.01) or not layout.is_clear(around, 0.0, item.size_m[2]):
            continue
        usable = sum(_is_seat_free(layout, placement, seat) for seat in seats)
        if usable < required or (best is not None and usable <= best[0]):
            continue
        rect = placement.rect
        if layout.in_reserved_zone(rect) or not layout.grid.stays_walkable(rect, [rect]):
            continue
        best = (usable, placement)
        if usable == len(seats):
            break
    return best[1] if best is not None and layout.try_put(best[1]) else None


def _candidate_poses(
    layout: RoomLayout, rng: np.random.Generator, item: Item, around_m: float
) -> Iterator[tuple[float, float, float]]:
    """Yields positions and headings away from the walls: a few near the middle, then a grid over the whole room."""
    inner = layout.inner
    longer = 0.0 if inner.depth_m > inner.width_m else math.pi / 2
    cx, cy = inner.centre
    for n in range(RANDOM_POSES):
        yaw = longer if n % 4 else longer - math.pi / 2
        ex, ey = rotated_extent(item.size_m[0], item.size_m[1], yaw)
        free_x, free_y = (
            max(0.0, size / 2 - extent / 2 - around_m) * min(1.0, n / RANDOM_POSES)
            for size, extent in ((inner.width_m, ex), (inner.depth_m, ey))
        )
        yield cx + float(rng.uniform(-1, 1)) * free_x, cy + float(rng.uniform(-1, 1)) * free_y, yaw
    xs = np.arange(inner.x0 + 0.6, inner.x1 - 0.5, GRID_M)
    ys = np.arange(inner.y0 + 0.6, inner.y1 - 0.5, GRID_M)
    points = sorted((abs(float(x) - cx) + abs(float(y) - cy), float(x), float(y)) for x in xs for y in ys)
    for yaw in (longer, longer - math.pi / 2):
        for _, x, y in points:
            yield x, y, yaw


def _poses_near(layout: RoomLayout, near: tuple[float, float]) -> Iterator[tuple[float, float, float]]:
    """Yields positions at and around a point, in both directions of the room."""
    longer = 0.0 if layout.inner.depth_m > layout.inner.width_m else math.pi / 2
    steps = (0.0, 0.3, -0.3, 0.6, -0.6)
    offsets = sorted(((dx, dy) for dx in steps for dy in steps), key=lambda d: abs(d[0]) + abs(d[1]))
    for yaw in (longer, longer - math.pi / 2):
        for dx, dy in offsets:
            yield near[0] + dx, near[1] + dy, yaw


def _is_seat_free(layout: RoomLayout, host: Placement, seat: SeatSpot) -> bool:
    """Returns whether the floor around a seat of an item is free."""
    x, y = host.to_world(seat[0], seat[1])
    area = Rect(x - seat[2], y - seat[2], x + seat[2], y + seat[2])
    return (
        layout.inner.contains(area) and layout.is_clear(area, 0.0, ROBOT_HEIGHT_M) and not layout.in_reserved_zone(area)
    )
