"""Small objects of a furnished room: on tops, on the walls of bathrooms, and on the floor next to walls and furniture.

Their number depends on `FurnitureSource.clutter`: 0 gives no objects, 1 many. Objects on tops and flat objects on
the floor do not collide; shoes, bags, toys and boxes do. They are placed at walls, where the room stays walkable.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import lay_flat, put_against_wall
from sim.homes.housegen.furnishing.placement.on_walls import hang_on_wall
from sim.homes.housegen.furnishing.placement.surfaces import put_on_surface
from sim.homes.housegen.furnishing.steps import top_uses
from sim.homes.housegen.furniture.item import Item

PER_TOP, PER_TOP_M2, MAX_ON_TOP = 1.0, 4.0, 7
"""Objects on a top at clutter 1: on any, more by its area in square metres, and the largest number."""
FLOOR_PER_M2, MAX_ON_FLOOR = 0.3, 6
"""Small objects on the floor of a room at clutter 1 by its area in square metres, and the largest number."""
ON_FLOOR: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "hallway": ("shoes", "shoes", "bag"),
        "bedroom": ("shoes", "bag", "flat", "toy", "box"),
        "living_room": ("toy", "toy", "flat", "cable", "bag"),
        "studio": ("shoes", "bag", "flat", "cable"),
        "office": ("cable", "flat", "bag", "box"),
        "closet": ("shoes", "shoes", "bag", "box"),
        "laundry": ("box", "shoes"),
        "gym": ("bag", "shoes"),
        "dining_room": ("toy", "bag"),
        "kitchen": ("bag", "box"),
    }
)
"""Uses of the small objects on the floor by kind of room; a room has each at most as often as it is listed."""
_FLAT_TRIES = 6


def add_clutter(layout: RoomLayout, source: FurnitureSource) -> None:
    """Puts small objects on the tops, walls and floor of a furnished room."""
    if source.clutter <= 0.0:
        return
    for host in list(layout.placements):
        if host.item.mount == "floor":
            _fill_tops(layout, source, host)
    if layout.kind == "bathroom":
        _equip_bathroom(layout, source)
    uses = ON_FLOOR.get(layout.kind)
    if uses is None:
        return
    count = source.clutter * min(FLOOR_PER_M2 * layout.inner.area_m2, MAX_ON_FLOOR)
    left = list(uses)
    for _ in range(min(int(count + source.uniform(0.0, 1.0)), len(left))):
        use = source.pick(tuple(left))
        left.remove(use)
        _put_on_floor(layout, source, use)


def _fill_tops(layout: RoomLayout, source: FurnitureSource, host: Placement) -> None:
    """Puts small objects that suit an item on each of its tops; on both sides of the objects there."""
    for number, surface in enumerate(host.item.surfaces):
        if surface.kind != "top":
            continue
        area_m2 = 4.0 * surface.half_size_m[0] * surface.half_size_m[1]
        count = source.clutter * min(PER_TOP + PER_TOP_M2 * area_m2, MAX_ON_TOP)
        for _ in range(int(count + source.uniform(0.0, 1.0))):
            item = source.make("objects", source.pick(top_uses(layout, source, host)))
            if item is not None and item.mount == "top":
                face = source.uniform(-0.35, 0.35) + (math.pi if host.side is None and source.chance(0.5) else 0.0)
                put_on_surface(layout, source.rng, host, item, face=face, number=number)


def _equip_bathroom(layout: RoomLayout, source: FurnitureSource) -> None:
    """Hangs toilet paper next to the toilet, and perhaps a rack of bottles."""
    for toilet in [p for p in layout.placements if p.item.category == "toilet"]:
        paper = source.make("objects", "toilet_paper")
        if paper is None or toilet.side is None or not source.clutter_chance(0.7):
            continue
        lo, hi = toilet.rect.span(toilet.side)
        for at in (hi + 0.2, lo - 0.2):
            if hang_on_wall(layout, source.rng, paper, sides=[toilet.side], at=at):
                break
    if source.clutter_chance(0.5):
        rack = source.make("objects", "bath_wall")
        if rack is not None and rack.mount == "wall":
            hang_on_wall(layout, source.rng, rack)


def _put_on_floor(layout: RoomLayout, source: FurnitureSource, use: str) -> None:
    """Puts a small object on the floor: flat ones next to furniture, the others at a wall."""
    item = source.make("objects", use)
    if item is None or item.mount != "floor":
        return
    if item.walk_over:
        _lay_beside(layout, source, item)
    else:
        put_against_wall(layout, source.rng, item, along="any", front_m=0.0, gap_m=source.uniform(0.01, 0.06))


def _lay_beside(layout: RoomLayout, source: FurnitureSource, item: Item) -> None:
    """Lays a flat object on free floor next to a piece of furniture."""
    hosts = [
        p for p in layout.placements if p.item.mount == "floor" and not p.item.walk_over and p.item.size_m[2] > 0.3
    ]
    reach_m = 0.5 * max(item.size_m[:2])
    for _ in range(_FLAT_TRIES if hosts else 0):
        rect, gap_m = source.pick(hosts).rect, reach_m + source.uniform(0.03, 0.3)
        (cx, cy), angle = rect.centre, source.uniform(-math.pi, math.pi)
        x = min(max(cx + 9.0 * math.cos(angle), rect.x0 - gap_m), rect.x1 + gap_m)
        y = min(max(cy + 9.0 * math.sin(angle), rect.y0 - gap_m), rect.y1 + gap_m)
        free = Rect(x - reach_m, y - reach_m, x + reach_m, y + reach_m)
        if layout.is_clear(free, 0.0, 0.05) and lay_flat(layout, item, x, y, source.uniform(-math.pi, math.pi)):
            return
