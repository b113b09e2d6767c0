"""Groups of seats in living rooms: a sofa facing a screen, a reading corner, a circle of armchairs.

Each function puts its group into a room and returns its main item, or None if the room has no position for it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

from sim.homes.housegen.floor_plan.rectangles import OPPOSITE, SIDES, Side
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import put_against_wall, put_at, put_near
from sim.homes.housegen.furnishing.placement.free_standing import SeatSpot, put_in_middle
from sim.homes.housegen.furnishing.placement.surfaces import put_on_surface
from sim.homes.housegen.furnishing.placement.walls import WALL_GAP_M
from sim.homes.housegen.furnishing.steps import (
    hang_above,
    hang_screen,
    has_room_for_fire,
    keep_from_fire,
    lay_rug,
    place,
    place_beside,
    place_in_front,
    put_on_top,
)
from sim.homes.housegen.furniture.item import Item
from sim.world.room_arrangement import SCREEN_FRONT_M

VIEWING_M, FOCUS_DEPTH_M, BEHIND_M = (2.4, 3.2), 0.45, 0.9
"""Distance from a sofa to what it faces, the usual depth of that, and the least free floor behind a sofa."""


def sofa_group(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a sofa facing a screen or a fireplace, with a low table on a rug between them and armchairs at its ends.

    Where no wall opposite has room for either, two armchairs face the sofa.
    """
    sofa = _sofa_with_focus(layout, source)
    faces_seats = sofa is None
    for width_m in (None, 1.5) if sofa is None else ():
        item = source.make("sofa", width_m=width_m)
        sofa = _place_sofa(layout, source, item, _sides(layout, source)) if item is not None else None
        if sofa is not None:
            break
    if sofa is None:
        return None
    low_table = source.make("table", "coffee")
    if low_table is not None:
        layout.release_zones(sofa)
        table = place_in_front(layout, sofa, low_table, 0.4, facing=True)
        if table is not None:
            put_on_top(layout, source, table, ("objects", "plant", "objects"), (0.6, 0.3, 0.3))
    ahead_m = sofa.item.size_m[0] / 2 + 0.65
    x, y = sofa.to_world(ahead_m + 0.15, 0.0)
    for size_m in ((1.7, 2.5), (1.4, 2.0)):
        if lay_rug(layout, source, x, y, sofa.placed.yaw_rad, runner=False, size_m=size_m):
            break
    if not (faces_seats and _place_opposite(layout, source, sofa)):
        _place_armchairs(layout, source, sofa, ahead_m + 0.1)
    _place_side_table(layout, source, sofa)
    if not faces_seats and sofa.side is not None:
        ahead = OPPOSITE[sofa.side]
        to_wall_m = abs(layout.inner.line(ahead) - sofa.rect.line(ahead))
        layout.reserve(sofa, [sofa.rect.strip(ahead, sofa.rect.span(ahead), 0.0, to_wall_m)])
    if source.chance(0.5):
        hang_above(layout, source, sofa, "picture")
    return sofa


def _sofa_with_focus(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a sofa and the fireplace or the screen that it faces, a short sofa where no long one fits."""
    hearth_first = layout.kind == "living_room" and source.chance(0.35)
    for width_m in (None, None, 1.5):
        item = source.make("sofa", fresh=True, width_m=width_m)
        if item is None:
            return None
        for side in _sides(layout, source):
            before = layout.snapshot()
            sofa = _place_sofa(layout, source, item, [side])
            if sofa is not None and (
                (hearth_first and _place_hearth(layout, source, sofa)) or _place_screen(layout, source, sofa)
            ):
                return sofa
            layout.restore(before)
    return None


def _sides(layout: RoomLayout, source: FurnitureSource) -> list[Side]:
    """Returns the walls for a sofa: long ones first that have a long wall without a window opposite."""

    def score(side: Side) -> float:
        opposite = OPPOSITE[side]
        opposite_m = min(layout.walls.longest_stretch_m(opposite), 2.5)
        lo, hi = layout.inner.span(opposite)
        window = layout.walls.has_window(opposite, (0.5 * (lo + hi) - 0.6, 0.5 * (lo + hi) + 0.6))
        return layout.walls.longest_stretch_m(side) + opposite_m - 1.5 * window + source.uniform(0.0, 1.5)

    return sorted(SIDES, key=score, reverse=True)


def _place_sofa(layout: RoomLayout, source: FurnitureSource, item: Item, sides: Sequence[Side]) -> Placement | None:
    """Places a sofa in the middle of the first wall that fits; in a deep room away from it, nearer to what it faces."""
    for side in sides:
        depth_m = layout.inner.across_m(side)
        gap_m = depth_m - item.size_m[0] - FOCUS_DEPTH_M - source.uniform(*VIEWING_M)
        if gap_m < BEHIND_M or (depth_m < 5.5 and source.chance(0.6)):
            gap_m = WALL_GAP_M
        sofa = put_against_wall(layout, source.rng, item, sides=[side], along="middle", front_m=1.0, gap_m=gap_m)
        if sofa is not None:
            return sofa
    return None


def _place_hearth(layout: RoomLayout, source: FurnitureSource, sofa: Placement) -> bool:
    """Places a fireplace opposite the sofa, with a screen, a picture or a mirror above it."""
    hearth = source.make("fireplace")
    if hearth is None or sofa.side is None:
        return False
    side = OPPOSITE[sofa.side]
    clear = partial(has_room_for_fire, layout)
    placed = put_near(layout, hearth, side, 0.5 * sum(sofa.rect.span(side)), front_m=0.8, slide_m=0.6, fits=clear)
    if placed is None:
        return False
    keep_from_fire(layout, placed)
    screen = source.make("tv_monitor", "tv_wall")
    middle, bottom_m = 0.5 * sum(placed.rect.span(side)), max(1.1, hearth.size_m[2] + 0.12)
    if screen is None or not hang_screen(layout, source, screen, side, middle, bottom_m):
        hang_above(layout, source, placed, "picture" if source.chance(0.6) else "mirror")
    return True


def _place_opposite(layout: RoomLayout, source: FurnitureSource, sofa: Placement) -> bool:
    """Places two armchairs that face the sofa."""
    chair = source.make("chair", "arm")
    if chair is None:
        return False
    ahead_m = sofa.item.size_m[0] / 2 + 1.35 + chair.size_m[0] / 2
    across_m = chair.size_m[1] / 2 + 0.12
    spots = [sofa.to_world(ahead_m, sign * across_m) for sign in (1.0, -1.0)]
    return sum(put_at(layout, chair, x, y, sofa.placed.yaw_rad + math.pi) is not None for x, y in spots) > 0


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


def _place_screen(layout: RoomLayout, source: FurnitureSource, sofa: Placement) -> bool:
    """Places a screen opposite the sofa, not before a window: on a low cabinet, above it on the wall, or on a stand."""
    if sofa.side is None:
        return False
    side, before = OPPOSITE[sofa.side], layout.snapshot()
    middle = 0.5 * sum(sofa.rect.span(side))
    item = source.make("cabinet", "media", "sideboard")
    cabinet = put_near(layout, item, side, middle, front_m=0.5) if item is not None else None
    if cabinet is not None and layout.walls.has_window(side, cabinet.rect.span(side)):
        layout.restore(before)
        cabinet = None
    mounts = ["wall", "top"] if cabinet is None or source.chance(0.4) else ["top", "wall", "wall"]
    for mount in mounts:
        screen = source.make("tv_monitor", "tv_wall" if mount == "wall" else "tv")
        if screen is None or screen.mount != mount:
            continue
        if mount == "wall":
            bottom_m = max(0.85, (cabinet.item.size_m[2] + 0.12) if cabinet else 0.95)
            if hang_screen(layout, source, screen, side, 0.5 * sum((cabinet or sofa).rect.span(side)), bottom_m):
                return True
        elif cabinet is not None and put_on_surface(layout, source.rng, cabinet, screen, face=0.0, back=True):
            return True
    floor_screen = source.make("tv_monitor", "tv_floor")
    if floor_screen is None or floor_screen.mount != "floor":
        return False
    return put_near(layout, floor_screen, side, middle, front_m=SCREEN_FRONT_M) is not None


def reading_corner(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places an armchair in a corner with a small table and a lamp next to it."""
    unused = source.has_unused("chair", "arm")
    chair = place(layout, source, "chair", "arm", along="corner", front_m=0.5) if unused else None
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
    has_one = any(p.item.category == "sofa" or p.item.name == "coffee table" for p in layout.placements)
    low_table, chair = source.make("table", "side" if has_one else "coffee"), source.make("chair", "arm")
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
