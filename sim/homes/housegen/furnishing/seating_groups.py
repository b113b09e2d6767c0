"""Groups of seats in living rooms: a sofa facing a screen, a reading corner, a circle of armchairs.

Each function puts its group into a room and returns its main item, or None if the room has no position for it.
"""

from __future__ import annotations

import math

from sim.homes.housegen.floor_plan.rectangles import OPPOSITE, SIDES, Side
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import put_against_wall, put_at, put_near
from sim.homes.housegen.furnishing.placement.free_standing import SeatSpot, put_in_middle
from sim.homes.housegen.furnishing.placement.on_walls import hang_on_wall
from sim.homes.housegen.furnishing.placement.surfaces import put_on_surface
from sim.homes.housegen.furnishing.placement.walls import WALL_GAP_M
from sim.homes.housegen.furnishing.steps import hang_above, lay_rug, place, place_beside, place_in_front, put_on_top
from sim.homes.housegen.furniture.item import Item


def sofa_group(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a sofa facing a screen, with a low table on a rug between them and armchairs at its ends."""
    item = source.make("sofa")
    if item is None:
        return None
    sofa = _place_sofa(layout, source, item)
    if sofa is None:
        return put_against_wall(layout, source.rng, item, front_m=0.6)
    _place_screen(layout, source, sofa)
    low_table = source.make("table", "coffee")
    if low_table is not None:
        layout.release_zones(sofa)
        table = place_in_front(layout, sofa, low_table, 0.4, facing=True)
        if table is not None:
            put_on_top(layout, source, table, ("objects", "plant", "objects"), (0.6, 0.3, 0.3))
    ahead_m = sofa.item.size_m[0] / 2 + 0.65
    if source.chance(0.8):
        size_m = (1.7, 2.5) if layout.inner.area_m2 > 18 else None
        x, y = sofa.to_world(ahead_m + 0.15, 0.0)
        lay_rug(layout, source, x, y, sofa.placed.yaw_rad, runner=False, size_m=size_m)
    _place_armchairs(layout, source, sofa, ahead_m + 0.1)
    _place_side_table(layout, source, sofa)
    if source.chance(0.5):
        hang_above(layout, source, sofa, "picture")
    return sofa


def _place_sofa(layout: RoomLayout, source: FurnitureSource, item: Item) -> Placement | None:
    """Places a sofa in the middle of a long wall with a long wall opposite, or away from it in a deep room."""

    def score(side: Side) -> float:
        opposite_m = min(layout.walls.longest_stretch_m(OPPOSITE[side]), 2.5)
        return layout.walls.longest_stretch_m(side) + opposite_m + source.uniform(0.0, 1.5)

    for side in sorted(SIDES, key=score, reverse=True):
        depth_m = layout.inner.width_m if side in ("east", "west") else layout.inner.depth_m
        spare_m = depth_m - 3.7
        gap_m = WALL_GAP_M if spare_m < 1.0 or source.chance(0.6) else min(spare_m, source.uniform(0.9, 1.4))
        sofa = put_against_wall(layout, source.rng, item, sides=[side], along="middle", front_m=1.0, gap_m=gap_m)
        if sofa is not None:
            return sofa
    return None


def _place_armchairs(layout: RoomLayout, source: FurnitureSource, sofa: Placement, ahead_m: float) -> None:
    """Places an armchair or an ottoman at one end or both ends of a sofa, turned to its middle."""
    seat = source.make("chair", "arm") if source.chance(0.75) else source.make("seating", "ottoman")
    if seat is None:
        return
    across_m = sofa.item.size_m[1] / 2 + seat.size_m[0] / 2 + 0.05
    for end in source.rng.permutation([1.0, -1.0]).tolist()[: 1 if source.chance(0.5) else 2]:
        x, y = sofa.to_world(ahead_m, end * across_m)
        put_at(layout, seat, x, y, sofa.placed.yaw_rad - end * math.pi / 2)


def _place_side_table(layout: RoomLayout, source: FurnitureSource, sofa: Placement) -> None:
    """Perhaps places a small table next to a sofa."""
    item = source.make("table", "side")
    if item is not None and source.chance(0.6) and sofa.side is not None:
        table = place_beside(layout, sofa, item, 1.0 if source.chance(0.5) else -1.0)
        if table is not None:
            put_on_top(layout, source, table, ("lighting", "plant"), (0.6, 0.3))


def _place_screen(layout: RoomLayout, source: FurnitureSource, sofa: Placement) -> None:
    """Places a screen opposite the sofa: on a low cabinet, on the wall above it, or on a stand of its own."""
    if sofa.side is None:
        return
    side = OPPOSITE[sofa.side]
    middle = 0.5 * sum(sofa.rect.span(side))
    item = source.make("cabinet", "media", "sideboard")
    cabinet = put_near(layout, item, side, middle, front_m=0.5) if item is not None else None
    mounts = ["wall", "top"] if cabinet is None or source.chance(0.4) else ["top", "wall", "wall"]
    for mount in mounts:
        screen = source.make("tv_monitor", "tv_wall" if mount == "wall" else "tv")
        if screen is None or screen.mount != mount:
            continue
        if mount == "wall" and _hang_screen(layout, source, screen, side, middle, cabinet):
            return
        if mount == "top" and _put_screen(layout, source, screen, cabinet):
            return
    floor_screen = source.make("tv_monitor", "tv_floor")
    if floor_screen is not None and floor_screen.mount == "floor":
        put_near(layout, floor_screen, side, middle, front_m=0.4, slide_m=1.5)


def _put_screen(layout: RoomLayout, source: FurnitureSource, screen: Item, cabinet: Placement | None) -> bool:
    """Puts a screen on the cabinet, at its rear edge, if there is one."""
    return cabinet is not None and put_on_surface(layout, source.rng, cabinet, screen, face=0.0, back=True)


def _hang_screen(
    layout: RoomLayout, source: FurnitureSource, screen: Item, side: Side, middle: float, cabinet: Placement | None
) -> bool:
    """Hangs a screen on a wall, above the cabinet if there is one."""
    at = middle if cabinet is None else 0.5 * sum(cabinet.rect.span(side))
    bottom_m = max(0.85, (cabinet.item.size_m[2] + 0.12) if cabinet else 0.95)
    return hang_on_wall(layout, source.rng, screen, sides=[side], at=at, bottom_m=bottom_m) is not None


def has_chair(source: FurnitureSource) -> bool:
    """Returns whether the pool has an armchair that the home has less than twice."""
    return source.has_unused("chair", "arm")


def reading_corner(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places an armchair in a corner with a small table and a lamp next to it."""
    chair = place(layout, source, "chair", "arm", along="corner", front_m=0.5) if has_chair(source) else None
    if chair is None:
        return None
    towards = 1.0 if source.chance(0.5) else -1.0
    item = source.make("table", "side")
    if item is not None:
        table = place_beside(layout, chair, item, towards) or place_beside(layout, chair, item, -towards)
        if table is not None:
            put_on_top(layout, source, table, ("lighting", "objects", "plant"), (0.6, 0.4, 0.3))
    lamp = source.make("lighting", "floor")
    if lamp is not None and source.chance(0.6):
        place_beside(layout, chair, lamp, -towards)
    return chair


def armchair_circle(
    layout: RoomLayout, source: FurnitureSource, *, near: tuple[float, float] | None = None
) -> Placement | None:
    """Places armchairs and an ottoman around a low table, away from the walls."""
    has_sofa = any(p.item.category == "sofa" for p in layout.placements)  # its low table stands in front of it
    low_table, chair = source.make("table", "side" if has_sofa else "coffee"), source.make("chair", "arm")
    if low_table is None or chair is None:
        return None
    ottoman = source.make("seating", "ottoman")
    items: list[Item] = [chair, chair, ottoman if ottoman is not None else chair]
    reach_m = 0.5 * max(low_table.size_m[:2]) + 0.4
    is_long = low_table.size_m[1] > 1.2 * low_table.size_m[0]
    turns = (math.pi / 2, -math.pi / 2, 0.0) if is_long else (0.6, -0.6, math.pi)
    seats: list[SeatSpot] = []
    for item, turn in zip(items, turns, strict=True):
        distance_m = reach_m + item.size_m[0] / 2
        seats.append((distance_m * math.cos(turn), distance_m * math.sin(turn), 0.55 * max(item.size_m[:2])))
    table = put_in_middle(layout, source.rng, low_table, seats, around_m=1.2, least=0.6, apart_m=0.8, near=near)
    if table is None:
        return None
    for item, (x, y, _), turn in zip(items, seats, turns, strict=True):
        put_at(layout, item, *table.to_world(x, y), table.placed.yaw_rad + turn + math.pi)
    put_on_top(layout, source, table, ("objects", "plant"), (0.6, 0.3))
    lay_rug(layout, source, table.placed.x_m, table.placed.y_m, table.placed.yaw_rad, runner=False)
    return table
