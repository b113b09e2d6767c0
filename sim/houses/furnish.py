"""What stands in each kind of room, and in which order it is put there: first what the room is for, then the rest."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from sim.houses.fill import fill, runners
from sim.houses.furniture.item import Item, Look
from sim.houses.geometry import SIDES, Side
from sim.houses.groups import (
    bed_group,
    desk_group,
    dining_group,
    hang,
    hang_over,
    place,
    put_things,
    row,
    sofa_group,
)
from sim.houses.kit import Kit
from sim.houses.placement import RoomSpace, Standing


def furnish(space: RoomSpace, kit: Kit) -> None:
    """Fill a room by the rules of its kind, then hang curtains, pictures and a lamp."""
    RULES.get(space.kind, _other)(space, kit)
    fill(space, kit)
    _curtains(space, kit)
    _ceiling_lamp(space, kit)


def _bedroom(space: RoomSpace, kit: Kit) -> None:
    area = space.inner.area_m2
    bed_group(space, kit, large=area > 10.5)
    place(space, kit, "cabinet", "wardrobe", along="corner", front_m=0.7)
    chest = place(space, kit, "chest_of_drawers", "dresser", front_m=0.7) if kit.chance(0.8) else None
    if chest is not None:
        put_things(space, kit, chest, ("objects", "plant", "objects", "lighting"), (0.6, 0.3, 0.4, 0.2))
        hang_over(space, kit, chest, *(("mirror",) if kit.chance(0.5) else ("picture",)))
    if area > 13 and kit.chance(0.55):
        desk_group(space, kit)
    if area > 14 and kit.chance(0.5):
        place(space, kit, "chair", "arm", along="corner", front_m=0.4)
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
    if area > 20 or kit.chance(0.4):
        place(space, kit, "shelving", "bookcase", front_m=0.6)
    if area > 24:
        board = place(space, kit, "cabinet", "sideboard", front_m=0.6)
        if board is not None:
            put_things(space, kit, board, ("objects", "plant", "lighting", "objects"), (0.6, 0.4, 0.4, 0.4))
            hang_over(space, kit, board, "picture")
    if area > 30:
        place(space, kit, "chair", "arm", along="corner", front_m=0.5)
        place(space, kit, "seating", front_m=0.4)
    if area > 26 and kit.chance(0.4):
        desk_group(space, kit)
    place(space, kit, "lighting", "floor", along="corner", front_m=0.0)
    if kit.clutter_chance(0.3):
        place(space, kit, "cushion", "floor", along="corner", front_m=0.2)
    _extras(space, kit, plants=0.9, pictures=(1, 3))


def _kitchen(space: RoomSpace, kit: Kit) -> None:
    kitchen_units(space, kit)
    area = space.inner.area_m2
    dining_elsewhere = "dining_room" in kit.home_rooms
    if area > 13 and kit.chance(0.85 if dining_elsewhere else 0.4):
        _island(space, kit)
    elif area > 8 and (not dining_elsewhere or kit.chance(0.25)):
        dining_group(space, kit, around_m=0.65)
    _extras(space, kit, plants=0.4, pictures=(0, 1))


def kitchen_units(space: RoomSpace, kit: Kit) -> None:
    """A run of units along the best wall (fridge, counter with sink, cooker, counter), cabinets above."""
    sides = sorted(SIDES, key=lambda side: -space.wall_length(side) + (0.5 if _has_window(space, side) else 0.0))
    looks = kit.looks("lacquer", "stone", "metal", "wood", "steel")
    for side in sides:
        made = _kitchen_run(space, kit, side, min(space.wall_length(side) - 0.02, 5.0), looks)
        if made:
            _wall_cabinets(space, kit, side, made, looks)
            if space.inner.area_m2 > 9 and kit.chance(0.7):
                _second_run(space, kit, [other for other in sides if other != side], looks)
            return


def _second_run(space: RoomSpace, kit: Kit, sides: Sequence[Side], looks: dict[str, Look]) -> None:
    """More worktop on another wall."""
    for side in sides:
        for share in (0.85, 0.6, 0.4):
            width = round(min(share * space.wall_length(side), 2.4), 2)
            item = (
                kit.make("counter", "run", width_m=width, with_sink=False, with_hob=False, looks=looks)
                if width > 0.8
                else None
            )
            run = row(space, kit, [item], side) if item else []
            if run:
                put_things(space, kit, run[0], ("appliances", "objects", "plant", "objects"), (0.4, 0.8, 0.2, 0.5))
                _wall_cabinets(space, kit, side, run, looks)
                return


def _kitchen_run(space: RoomSpace, kit: Kit, side: Side, free_m: float, looks: dict[str, Look]) -> list[Standing]:
    """Units side by side on one wall, fewer and narrower ones where the wall is short."""
    fridge, cooker = kit.make("appliances", "fridge"), kit.make("appliances", "stove")

    def worktop(width_m: float, *, sink: bool, hob: bool) -> Item | None:
        return kit.make("counter", "run", width_m=round(width_m, 2), with_sink=sink, with_hob=hob, looks=looks)

    for share in (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4):
        fixed = sum(item.size_m[1] + 0.005 for item in (fridge, cooker) if item is not None)
        rest = share * free_m - fixed
        if rest > 1.9:
            left = 0.6 * rest
            wanted = [fridge, worktop(left, sink=True, hob=False), cooker, worktop(rest - left, sink=False, hob=False)]
        elif rest > 0.95:
            wanted = [fridge, worktop(rest, sink=True, hob=False), cooker]
        elif share * free_m > 1.3:
            wanted = [worktop(share * free_m, sink=True, hob=True)]
        else:
            break
        run = row(space, kit, [item for item in wanted if item is not None], side)
        for unit in run:
            if unit.placed.item.category == "counter":
                put_things(space, kit, unit, ("objects", "appliances", "objects", "plant"), (0.8, 0.3, 0.5, 0.2))
        if run:
            if len(wanted) == 1 and fridge is not None:
                space.against_wall(kit.rng, fridge, along="corner", front_m=0.6)
            return run
    return []


def _wall_cabinets(space: RoomSpace, kit: Kit, side: Side, run: list[Standing], looks: dict[str, Look]) -> None:
    for unit in run:
        if unit.placed.item.size_m[2] > 1.2:
            continue
        width = min(unit.placed.item.size_m[1], 2.0)
        lo, hi = unit.rect.span(side)
        for share in (1.0, 0.6, 0.4):
            cabinet = kit.make("cabinet", "kitchen_wall", width_m=round(width * share, 2), looks=looks)
            if cabinet is None or cabinet.mount != "wall":
                return
            half = cabinet.size_m[1] / 2
            spots = (0.5 * (lo + hi), lo + half, hi - half)
            if any(space.on_wall(kit.rng, cabinet, sides=[side], at=at, bottom_m=1.45, margin_m=0.0) for at in spots):
                break


def _island(space: RoomSpace, kit: Kit) -> None:
    """A free-standing counter with stools on one side."""
    island = kit.make("counter", "island")
    if island is None:
        dining_group(space, kit, around_m=0.65)
        return
    front = island.size_m[0] / 2 + 0.45
    spots = [(side * front, y, 0.4) for side in (-1.0, 1.0) for y in (-0.3 * island.size_m[1], 0.3 * island.size_m[1])]
    standing = space.in_middle(kit.rng, island, spots, around_m=0.9)
    if standing is None:
        dining_group(space, kit, around_m=0.65)
        return
    put_things(space, kit, standing, ("objects", "plant", "objects"), (0.7, 0.4, 0.3))
    stool = kit.make("stool", "bar")
    space.release(standing)
    if stool is None:
        return
    depth, width = island.size_m[:2]
    count = max(2, min(4, int(width / (stool.size_m[1] + 0.2))))
    yaw = standing.placed.yaw_rad
    c, s = math.cos(yaw), math.sin(yaw)
    for n in range(count):
        lx, ly = depth / 2 + stool.size_m[0] / 2 + 0.04, (n - 0.5 * (count - 1)) * width / count
        space.at(stool, standing.placed.x_m + c * lx - s * ly, standing.placed.y_m + s * lx + c * ly, yaw + math.pi)


def _dining_room(space: RoomSpace, kit: Kit) -> None:
    dining_group(space, kit)
    board = place(space, kit, "cabinet", "sideboard", "display", front_m=0.6)
    if board is not None:
        put_things(space, kit, board, ("objects", "plant", "lighting", "objects"), (0.7, 0.4, 0.3, 0.4))
        hang_over(space, kit, board, "picture")
    if kit.chance(0.3):
        place(space, kit, "counter", "island", front_m=0.7)
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
    if kit.chance(0.4):
        place(space, kit, "stool", "low", along="corner", front_m=0.2)
    if kit.clutter_chance(0.4):
        place(space, kit, "objects", "floor", "basket", along="corner", front_m=0.0)
    _extras(space, kit, plants=0.3, pictures=(0, 1), lamp=False)


def _basin(space: RoomSpace, kit: Kit) -> Standing | None:
    """A basin on a cabinet of its own, or standing by itself."""
    uses = ("cabinet", "vanity") if kit.chance(0.55) else ("sink", "standing")
    return place(space, kit, *uses, front_m=0.6, tries=2) or place(space, kit, "sink", "standing", front_m=0.5, tries=2)


def _hallway(space: RoomSpace, kit: Kit) -> None:
    wide = space.inner.short_m
    if wide > 1.15:
        if kit.chance(0.7):
            hang(space, kit, "clothes", "hooks", along="any")
        for _ in range(1 + int(space.inner.area_m2 > 12)):
            board = place(
                space, kit, *(("cabinet", "sideboard") if kit.chance(0.5) else ("table", "console")), front_m=0.45
            )
            if board is not None:
                put_things(space, kit, board, ("objects", "plant", "lighting"), (0.6, 0.4, 0.3))
                hang_over(space, kit, board, "mirror" if kit.chance(0.6) else "picture")
        if kit.chance(0.5):
            place(space, kit, "seating", "bench", front_m=0.45)
    if kit.chance(0.6):
        runners(space, kit)
    pictures = int(space.inner.long_m / 4.0)
    _extras(space, kit, plants=0.6, pictures=(min(1, pictures), min(3, 1 + pictures)))


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
    _extras(space, kit, plants=0.8, pictures=(0, 2))


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
    place(space, kit, "seating", "bench", front_m=0.5)
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
        place(space, kit, "objects", "floor", "box", along="corner", front_m=0.0)
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
    corner_plants: bool = True,
) -> None:
    """Plants in corners, pictures on free wall, something on the floor: how much is the clutter's affair."""
    for chance in (plants, plants - 0.5):
        if kit.chance(max(0.0, chance)):
            place(space, kit, "plant", "floor", along="corner", front_m=0.0)
    for _ in range(int(kit.rng.integers(pictures[0], pictures[1] + 1))):
        hang(space, kit, "picture")
    if lamp and kit.chance(0.25):
        place(space, kit, "lighting", "floor", along="corner", front_m=0.0)
    if kit.clutter_chance(0.25):
        place(space, kit, "objects", "floor", "box", "basket", along="corner", front_m=0.0)


def _curtains(space: RoomSpace, kit: Kit) -> None:
    """The same curtains or blinds at every window of a room; long ones where nothing stands below."""
    drawn = kit.rng.random()
    looks = kit.window_looks()
    for side, window in space.windows():
        width, height = window.span[1] - window.span[0], window.top_m - window.bottom_m
        tries = [("blinds", width - 0.02, height - 0.02)]
        if space.kind not in ("bathroom", "laundry", "kitchen", "hallway") and drawn < 0.7:
            tries = [("curtain", width + 0.4, 2.2), ("curtain", width + 0.4, height + 0.25), *tries]
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


def _has_window(space: RoomSpace, side: Side) -> bool:
    return any(where == side for where, _ in space.windows())


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
