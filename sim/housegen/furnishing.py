"""What stands in each kind of room, and in which order it is put there: first what the room is for, then the rest."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

from sim.housegen.groups import (
    bed_group,
    desk_group,
    dining_group,
    hang,
    hang_over,
    lay_rug,
    place,
    put_things,
    row,
    sofa_group,
)
from sim.housegen.hallways import furnish_hall
from sim.housegen.kitchens import furnish_kitchen, kitchen_units
from sim.housegen.large_rooms import chat_circle, fill, middle_rug, reading_corner
from sim.housegen.placement import RoomSpace, Standing
from sim.housegen.rectangles import SIDES
from sim.housegen.selection import Kit

BOXED = frozenset(("bedroom", "closet", "studio"))
"""Rooms where suitcases and crates may stand; elsewhere it is bins and baskets."""


def furnish(space: RoomSpace, kit: Kit) -> None:
    """Fill a room by the rules of its kind, then hang curtains, pictures and a lamp."""
    RULES.get(space.kind, _other)(space, kit)
    fill(space, kit)
    _curtains(space, kit)
    _ceiling_lamp(space, kit)


def _bedroom(space: RoomSpace, kit: Kit) -> None:
    area = space.inner.area_m2
    bed_group(space, kit, large=area > 10.5)
    for front_m in (0.7, 0.45):
        if place(space, kit, "cabinet", "wardrobe", along="corner", front_m=front_m):
            break
    chest = place(space, kit, "chest_of_drawers", "dresser", front_m=0.55) if kit.chance(0.8) else None
    if chest is not None:
        put_things(space, kit, chest, ("objects", "plant", "objects", "lighting"), (0.6, 0.3, 0.4, 0.2))
        hang_over(space, kit, chest, *(("mirror",) if kit.chance(0.5) else ("picture",)))
    if area > 13 and kit.chance(0.5):
        desk_group(space, kit)
    if area > 13.5 and (area > 18 or kit.chance(0.6)) and reading_corner(space, kit) is None:
        place(space, kit, "seating", "plain", front_m=0.4)
    if kit.chance(0.35):
        hang(space, kit, "tv_monitor", "tv_wall")
    if kit.clutter_chance(0.5):
        place(space, kit, "clothes", "rack", "floor", along="corner", front_m=0.3)
    _extras(space, kit, plants=0.5, pictures=(0, 1))


def _living_room(space: RoomSpace, kit: Kit) -> None:
    area = space.inner.area_m2
    if kit.chance(0.7):
        hearth = place(space, kit, "fireplace", along="middle", front_m=0.8, tries=3)
        if hearth is not None:
            hang_over(space, kit, hearth, "picture" if kit.chance(0.6) else "mirror")
    sofa_group(space, kit)
    _second_groups(space, kit)
    if area > 20 or kit.chance(0.4):
        place(space, kit, "shelving", "bookcase", front_m=0.6)
    if area > 24:
        board = place(space, kit, "cabinet", "sideboard", front_m=0.6)
        if board is not None:
            put_things(space, kit, board, ("objects", "plant", "lighting", "objects"), (0.6, 0.4, 0.4, 0.4))
            hang_over(space, kit, board, "picture")
    place(space, kit, "lighting", "floor", along="corner", front_m=0.0)
    if kit.clutter_chance(0.3):
        place(space, kit, "cushion", "floor", along="corner", front_m=0.2)
    _extras(space, kit, plants=0.9, pictures=(1, 3))


def _second_groups(space: RoomSpace, kit: Kit) -> None:
    """What a living room has beside its sofa: one group more from 20 m2 on, two from 30."""
    area = space.inner.area_m2
    wanted = int(area > 20) + int(area > 30) + int(area > 40)
    free = [chat_circle, dining_group] if "dining_room" not in kit.home_rooms or area > 38 else [chat_circle]
    by_wall = [reading_corner, desk_group]
    groups = [free[n] for n in kit.rng.permutation(len(free)).tolist()]
    groups += [by_wall[n] for n in kit.rng.permutation(2).tolist()]
    for group in groups if area > 24 else reversed(groups):
        if wanted <= 0:
            break
        wanted -= group(space, kit) is not None
    if area > 20:
        middle_rug(space, kit)


def _kitchen(space: RoomSpace, kit: Kit) -> None:
    furnish_kitchen(space, kit)
    _extras(space, kit, plants=0.4, pictures=(0, 1))


def _dining_room(space: RoomSpace, kit: Kit) -> None:
    dining_group(space, kit)
    board = place(space, kit, "cabinet", "sideboard", "display", front_m=0.6)
    if board is not None:
        put_things(space, kit, board, ("objects", "plant", "lighting", "objects"), (0.7, 0.4, 0.3, 0.4))
        hang_over(space, kit, board, "picture")
    _extras(space, kit, plants=0.7, pictures=(0, 1))


def _studio(space: RoomSpace, kit: Kit) -> None:
    kitchen_units(space, kit)
    bed_group(space, kit, large=True)
    sofa_group(space, kit)
    place(space, kit, "cabinet", "wardrobe", along="corner", front_m=0.7)
    dining_group(space, kit, around_m=0.6)
    if kit.chance(0.5):
        place(space, kit, "shelving", "bookcase", front_m=0.6)
    place(space, kit, "chest_of_drawers", "dresser", front_m=0.6)
    _extras(space, kit, plants=1.0, pictures=(2, 3))


def _bathroom(space: RoomSpace, kit: Kit) -> None:
    """Tub or shower in a corner first, then toilet and basin, mirror above it, towels within reach."""
    area = space.inner.area_m2
    tub_first = kit.chance(0.5)
    wet = ("bathtub", "shower") if tub_first else ("shower", "bathtub")
    got = place(space, kit, wet[0], along="corner", front_m=0.5, tries=3)
    if got is None:
        place(space, kit, wet[1], along="corner", front_m=0.5, tries=2)
    place(space, kit, "toilet", front_m=0.5, tries=3)
    basin = _basin(space, kit)
    if got is not None and area > 7.5:
        place(space, kit, wet[1], along="corner", front_m=0.5, tries=2)
    if basin is not None and not hang_over(space, kit, basin, "mirror"):
        hang(space, kit, "mirror")
    for _ in range(1 + kit.chance(0.4)):
        hang(space, kit, "towel", "rail")
    if basin is not None and area > 9.5:
        second = _basin(space, kit)
        if second is not None:
            hang_over(space, kit, second, "mirror")
    if area > 5.5 and kit.chance(0.7):
        _bath_mat(space, kit, got or basin)
    if area > 7 and kit.chance(0.6):
        place(space, kit, "towel", "floor", front_m=0.3)
    if kit.chance(0.4):
        place(space, kit, "stool", "low", along="corner", front_m=0.2)
    if kit.clutter_chance(0.4):
        place(space, kit, "objects", "bin", along="corner", front_m=0.0)
    _extras(space, kit, plants=0.3, pictures=(0, int(area > 6)), lamp=False, boxes=False)


def _bath_mat(space: RoomSpace, kit: Kit, host: Standing | None) -> None:
    """A small rug before a tub, a shower or a basin."""
    if host is None:
        return
    ahead = host.placed.item.size_m[0] / 2 + 0.38
    yaw = host.placed.yaw_rad
    x, y = host.placed.x_m + ahead * math.cos(yaw), host.placed.y_m + ahead * math.sin(yaw)
    lay_rug(space, kit, x, y, yaw, size_m=(0.55, 0.85))


def _basin(space: RoomSpace, kit: Kit) -> Standing | None:
    """A basin on a cabinet of its own, or standing by itself."""
    uses = ("cabinet", "vanity") if kit.chance(0.55) else ("sink", "standing")
    return place(space, kit, *uses, front_m=0.6, tries=2) or place(space, kit, "sink", "standing", front_m=0.5, tries=2)


def _hallway(space: RoomSpace, kit: Kit) -> None:
    furnish_hall(space, kit)
    pictures = int(space.inner.long_m / 4.0)
    _extras(space, kit, plants=0.5, pictures=(min(1, pictures), min(3, 1 + pictures)), lamp=False)


def _office(space: RoomSpace, kit: Kit) -> None:
    desk_group(space, kit)
    if space.inner.area_m2 > 13:
        desk_group(space, kit)
    place(space, kit, "shelving", "bookcase", front_m=0.6)
    if kit.chance(0.5):
        place(space, kit, "cabinet", "sideboard", front_m=0.6)
    if kit.chance(0.4):
        place(space, kit, "chair", "arm", along="corner", front_m=0.4)
    if kit.chance(0.5):
        hang(space, kit, "board_panel")
    if kit.chance(0.7):
        middle_rug(space, kit)
    _extras(space, kit, plants=0.6, pictures=(0, 2))


def _gym(space: RoomSpace, kit: Kit) -> None:
    count = 2 + int(space.inner.area_m2 > 15) + int(space.inner.area_m2 > 20)
    seen: set[str] = set()
    for _ in range(4 * count):
        item = kit.make("gym_equipment")
        if item is None or item.style in seen:
            continue
        if item.mount == "floor" and not item.walk_over and space.against_wall(kit.rng, item, front_m=0.6):
            seen.add(item.style)
        if len(seen) >= count:
            break
    hang(space, kit, "mirror")
    place(space, kit, "seating", "plain", front_m=0.5)
    hang(space, kit, "towel", "rail")
    if kit.chance(0.5):
        hang(space, kit, "tv_monitor", "tv_wall")
    _extras(space, kit, plants=0.5, pictures=(1, 1))


def _laundry(space: RoomSpace, kit: Kit) -> None:
    washer = kit.make("appliances", "washing_machine")
    if washer is not None:
        machines = [washer, washer] if kit.chance(0.5) else [washer]
        for side in sorted(SIDES, key=lambda s: -space.wall_length(s)):
            if row(space, kit, machines, side, front_m=0.6):
                break
    place(space, kit, "counter", "run", width_m=1.0, with_sink=True, with_hob=False, front_m=0.6)
    place(space, kit, "shelving", "bookcase", front_m=0.5)
    place(space, kit, "clothes", "rack", "basket", front_m=0.4)
    _extras(space, kit, plants=0.1, pictures=(0, 0))


def _closet(space: RoomSpace, kit: Kit) -> None:
    place(space, kit, "clothes", "rack", front_m=0.5)
    place(space, kit, "chest_of_drawers", "dresser", front_m=0.5)
    place(space, kit, "shelving", "bookcase", front_m=0.5)
    if kit.chance(0.5):
        place(space, kit, "stool", "low", along="corner", front_m=0.2)
    if kit.clutter_chance(0.5):
        place(space, kit, "objects", "floor", along="corner", front_m=0.0)
    if kit.chance(0.5):
        hang(space, kit, "mirror")


def _other(space: RoomSpace, kit: Kit) -> None:
    _extras(space, kit, plants=0.5, pictures=(1, 1))


def _extras(
    space: RoomSpace,
    kit: Kit,
    *,
    plants: float,
    pictures: tuple[int, int],
    lamp: bool = True,
    boxes: bool = True,
) -> None:
    """Plants in corners, pictures on free wall, something on the floor: how much is the clutter's affair."""
    for chance in (plants, plants - 0.5):
        if kit.chance(max(0.0, chance)):
            place(space, kit, "plant", "floor", along="corner", front_m=0.0)
    for _ in range(int(kit.rng.integers(pictures[0], pictures[1] + 1))):
        hang(space, kit, "picture")
    if lamp and kit.chance(0.25):
        place(space, kit, "lighting", "floor", along="corner", front_m=0.0)
    if boxes and kit.clutter_chance(0.25):
        kind = "floor" if space.kind in BOXED else "bin"
        place(space, kit, "objects", kind, along="corner", front_m=0.0)


def _curtains(space: RoomSpace, kit: Kit) -> None:
    """The same curtains or blinds at every window of a room; long ones where nothing stands below."""
    drawn = kit.rng.random()
    looks = kit.window_looks()
    for side, window in space.windows():
        width, height = window.span[1] - window.span[0], window.top_m - window.bottom_m
        tries = [("blinds", width - 0.02, height - 0.02)]
        if space.kind not in ("bathroom", "laundry", "kitchen", "hallway") and drawn < 0.7:
            wide = math.ceil(5.0 * (width + 0.3)) / 5.0  # few widths: windows of nearly one size share a curtain
            tries = [("curtain", wide, 2.2), ("curtain", wide, math.ceil(5.0 * (height + 0.2)) / 5.0), *tries]
        if drawn > 0.88:
            return
        for category, wide, high in tries:
            item = kit.make(category, width_m=round(wide, 2), height_m=round(high, 2), looks=looks)
            if item is not None and item.mount == "wall" and space.dress_window(item, side, window):
                break


def _ceiling_lamp(space: RoomSpace, kit: Kit) -> None:
    lamp = kit.make("lighting", "ceiling")
    if lamp is None or lamp.mount != "ceiling":
        return
    count = max(1, int(space.inner.long_m / 4.5)) if space.kind == "hallway" else 1
    for n in range(count):
        x, y = space.inner.centre
        if count > 1:
            along = (n + 0.5) / count
            if space.inner.width_m > space.inner.depth_m:
                x = space.inner.x0 + along * space.inner.width_m
            else:
                y = space.inner.y0 + along * space.inner.depth_m
        space.on_ceiling(lamp, x, y)


RULES: Mapping[str, Callable[[RoomSpace, Kit], None]] = MappingProxyType(
    {
        "bedroom": _bedroom,
        "living_room": _living_room,
        "kitchen": _kitchen,
        "dining_room": _dining_room,
        "studio": _studio,
        "bathroom": _bathroom,
        "hallway": _hallway,
        "office": _office,
        "gym": _gym,
        "laundry": _laundry,
        "closet": _closet,
    }
)
"""How each kind of room is furnished."""
