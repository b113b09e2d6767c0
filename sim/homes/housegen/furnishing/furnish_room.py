"""Furnishes a room by the rule of its kind, again if a required piece is missing, then fills it and adds fittings."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from types import MappingProxyType

from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.furnishing.filling import fill_room
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import lay_flat, put_against_wall
from sim.homes.housegen.furnishing.placement.on_walls import hang_before_window, hang_from_ceiling, hang_on_wall
from sim.homes.housegen.furnishing.placement.surfaces import put_on_surface
from sim.homes.housegen.furnishing.room_rules import RULES
from sim.homes.housegen.furnishing.steps import top_uses
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
        "kitchen": ("box",),
    }
)
"""Uses of the small objects on the floor by kind of room; a room has each at most as often as it is listed."""
_FLAT_TRIES = 6


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
