"""Single steps of furnishing: choose an item for a use and put it somewhere in a room.

Each step returns the placement, or None (False) where the pool has no such item or the room has no position for it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Unpack

from sim.homes.housegen.floor_plan.rectangles import Side
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import find_row_start, lay_flat, put_against_wall, put_at, put_near
from sim.homes.housegen.furnishing.placement.on_walls import hang_on_wall, is_wall_free
from sim.homes.housegen.furnishing.placement.surfaces import put_on_surface
from sim.homes.housegen.furnishing.placement.walls import Along
from sim.homes.housegen.furniture.item import Hints, Item
from sim.world.room_arrangement import FROM_FIRE_M, SCREEN_FRONT_M

RUNNER_M = 1.0
"""Rugs narrower than this are runners."""
ROW_GAP_M, ROW_FRONT_M = 0.004, 0.6
"""Gap between the items of a row, and the floor kept free in front of them."""
BESIDE_M = 0.05
"""Gap between an item and the one that it is placed beside."""
_TOP_USES = {
    "dining": ("table",), "desk": ("office",), "coffee": ("low", "top"), "media": ("media",),
    "dresser": ("dresser", "top"),
    "nightstand": ("bedside",), "side": ("low", "bedside"), "console": ("entry", "top"), "bookcase": ("shelf",),
    "sideboard": ("top", "shelf", "media"),
}  # fmt: skip
"""Uses of small objects on the top of an item, by the use of the item."""
_WALL_USES = {"mirror": ("wall",), "towel": ("rail",)}
"""Uses of categories that also have styles which stand on the floor."""


def place(
    layout: RoomLayout, source: FurnitureSource, category: str, *uses: str, along: Along = "any", front_m: float = 0.6,
    tries: int = 2, fits: Callable[[Placement], bool] = lambda _: True, **hints: Unpack[Hints],
) -> Placement | None:  # fmt: skip
    """Places an item against a wall; tries another style when the first one does not fit.

    `fits` returns whether a position is suitable otherwise. A home without clutter has no objects.
    """
    if category == "objects" and source.clutter <= 0.0:
        return None
    for n in range(tries):
        item = source.make(category, *uses, fresh=n > 0, **hints)
        if item is None:
            return None
        if item.mount == "wall":
            placed = hang_on_wall(layout, source.rng, item, along=along, fits=fits)
        else:
            placed = put_against_wall(layout, source.rng, item, along=along, front_m=front_m, fits=fits)
        if placed is not None:
            return placed
    return None


def hang(layout: RoomLayout, source: FurnitureSource, category: str, *uses: str) -> Placement | None:
    """Hangs an item on any wall."""
    item = source.make(category, *(uses or _WALL_USES.get(category, ())))
    if item is None or item.mount != "wall":
        return None
    return hang_on_wall(layout, source.rng, item, over_floor=category == "clothes")


def hang_above(layout: RoomLayout, source: FurnitureSource, host: Placement, category: str) -> Placement | None:
    """Hangs an item on the wall right above an item that stands against it."""
    item = source.make(category, *_WALL_USES.get(category, ()))
    if item is None or item.mount != "wall":
        return None
    return hang_item_above(layout, source, host, item)


def has_wall_above(layout: RoomLayout, host: Placement, item: Item) -> bool:
    """Returns whether an item can hang on the wall right above another one, which need not be in the room yet."""
    return host.side is not None and is_wall_free(layout, item, host.side, *_above(host, item))


def hang_item_above(layout: RoomLayout, source: FurnitureSource, host: Placement, item: Item) -> Placement | None:
    """Hangs an item that exists on the wall right above another one, which stands against it."""
    if host.side is None:
        return None
    at, bottom_m = _above(host, item)
    return hang_on_wall(layout, source.rng, item, sides=[host.side], at=at, bottom_m=bottom_m)


def _above(host: Placement, item: Item) -> tuple[float, float]:
    """Returns the position along the wall and the height at which an item hangs above another one."""
    assert host.side is not None
    bottom_m = max(item.mount_height_m, host.placed.z_m + host.item.size_m[2] + 0.12)
    return 0.5 * sum(host.rect.span(host.side)), bottom_m


def hang_screen(
    layout: RoomLayout, source: FurnitureSource, screen: Item, side: Side, at: float, bottom_m: float | None = None
) -> Placement | None:
    """Hangs a screen at a position along a wall, and keeps the floor below and right in front of it free.

    Returns None if it does not fit or a seat stands there.
    """
    half = screen.size_m[1] / 2
    zone = layout.inner.strip(side, (at - half, at + half), screen.size_m[0] + SCREEN_FRONT_M)
    if any(p.item.category in ("chair", "sofa") and p.rect.overlaps(zone, 0.0) for p in layout.placements):
        return None
    placed = hang_on_wall(layout, source.rng, screen, sides=[side], at=at, bottom_m=bottom_m)
    if placed is not None:
        layout.reserve(placed, [zone])
    return placed


def has_room_for_fire(layout: RoomLayout, hearth: Placement) -> bool:
    """Returns whether no furniture stands near the place of a fireplace or a stove."""
    near = hearth.rect.grown(FROM_FIRE_M + 0.03)
    return not any(
        p.item.mount == "floor" and not p.item.walk_over and p.rect.overlaps(near, 0.0) for p in layout.placements
    )


def keep_from_fire(layout: RoomLayout, hearth: Placement) -> None:
    """Keeps later furniture away from a fireplace or a stove."""
    layout.reserve(hearth, [hearth.rect.grown(FROM_FIRE_M + 0.03)])


def place_beside(layout: RoomLayout, host: Placement, item: Item, towards: float) -> Placement | None:
    """Places an item next to another one at the same wall: `towards` is +1 or -1 along the side."""
    if host.side is None:
        return None
    lo, hi = host.rect.span(host.side)
    reach_m = item.size_m[1] / 2 + BESIDE_M
    placement = layout.walls.placement(item, host.side, hi + reach_m if towards > 0 else lo - reach_m)
    return placement if layout.try_put(placement) else None


def place_in_front(layout: RoomLayout, host: Placement, item: Item, gap_m: float, *, facing: bool) -> Placement | None:
    """Places an item in front of another one, turned towards it (`facing`) or in the same direction."""
    x, y = host.to_world(host.item.size_m[0] / 2 + gap_m + item.size_m[0] / 2, 0.0)
    yaw = host.placed.yaw_rad
    return put_at(layout, item, x, y, yaw + math.pi if facing else yaw)


def lay_rug(
    layout: RoomLayout,
    source: FurnitureSource,
    x_m: float,
    y_m: float,
    yaw_rad: float,
    *,
    runner: bool | None = None,
    size_m: tuple[float, float] | None = None,
) -> bool:
    """Lays a rug on the floor: a runner if `runner`, a wide rug if it is False, either one if it is None.

    `size_m` is its depth and width. Returns False if no item fits there.
    """
    depth_m, width_m = size_m or (None, None)
    for n in range(3):
        rug = source.make("floor", "rug", fresh=n > 0, depth_m=depth_m, width_m=width_m)
        if rug is None:
            return False
        if (runner is None or runner == (min(rug.size_m[:2]) < RUNNER_M)) and lay_flat(layout, rug, x_m, y_m, yaw_rad):
            return True
    return False


def put_on_top(
    layout: RoomLayout, source: FurnitureSource, host: Placement, categories: Sequence[str], chances: Sequence[float]
) -> None:
    """Puts small items on an item, each with its own probability, which also depends on the clutter."""
    uses = {
        "lighting": ("table",),
        "objects": (source.pick(top_uses(layout, source, host)), "top"),
        "plant": ("top",),
        "appliances": ("microwave",),
    }
    for category, probability in zip(categories, chances, strict=True):
        if source.clutter_chance(probability):
            item = source.make(category, *uses[category])
            if item is not None and item.mount == "top":
                put_on_surface(layout, source.rng, host, item)


def top_uses(layout: RoomLayout, source: FurnitureSource, host: Placement) -> tuple[str, ...]:
    """Returns the uses of small objects that suit the top of an item in a room."""
    if layout.kind == "bathroom":
        return ("bath",)
    uses = source.uses_of(host.item)
    if host.item.category == "counter" or (layout.kind == "kitchen" and "dining" not in uses):
        return ("kitchen",)
    for use, fitting in _TOP_USES.items():
        if use in uses:
            return fitting
    return ("entry", "top") if layout.kind == "hallway" else ("top", "shelf")


def place_row(layout: RoomLayout, source: FurnitureSource, items: Sequence[Item], side: Side) -> list[Placement]:
    """Places items side by side along a wall, in this order or in reverse; an empty list if not all fit."""
    forwards, backwards = list(items), list(reversed(items))
    for order in (forwards, backwards) if source.chance(0.5) else (backwards, forwards):
        at = find_row_start(layout, order, side, ROW_FRONT_M, ROW_GAP_M) if order else None
        if at is None:
            continue
        placed = []
        for item in order:
            spot = put_near(layout, item, side, at + item.size_m[1] / 2, front_m=ROW_FRONT_M, slide_m=0.0)
            if spot is not None:
                placed.append(spot)
            at += item.size_m[1] + ROW_GAP_M
        if placed:
            return placed
    return []
