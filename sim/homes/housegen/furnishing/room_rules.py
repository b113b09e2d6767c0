"""The rule of each kind of room: which furniture is placed, the most important first."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

from sim.homes.housegen.floor_plan.rectangles import OPPOSITE, SIDES
from sim.homes.housegen.furnishing.bathrooms import furnish_bathroom
from sim.homes.housegen.furnishing.filling import middle_rug
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.groups import bed_group, desk_group, dining_group
from sim.homes.housegen.furnishing.hallways import furnish_hallway
from sim.homes.housegen.furnishing.kitchens import furnish_kitchen, kitchen_units
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import put_against_wall
from sim.homes.housegen.furnishing.seating_groups import armchair_circle, reading_corner, sofa_group
from sim.homes.housegen.furnishing.steps import (
    hang,
    hang_above,
    hang_screen,
    has_room_for_fire,
    keep_from_fire,
    place,
    place_row,
    put_on_top,
)

BOXES_ON_FLOOR = frozenset(("bedroom", "closet", "studio"))
"""Rooms where suitcases and crates may stand; other rooms have bins and baskets."""
_DRESSER = ("chest_of_drawers", "dresser")


def _bedroom(layout: RoomLayout, source: FurnitureSource) -> None:
    area = layout.inner.area_m2
    wardrobe = _place_wardrobe(layout, source) if source.chance(0.3) else None
    bed = bed_group(layout, source, large=area > 10.5)
    if wardrobe is None:
        _place_wardrobe(layout, source)
    chest = place(layout, source, "chest_of_drawers", "dresser", front_m=0.55) if source.chance(0.8) else None
    if chest is not None:
        put_on_top(layout, source, chest, ("objects", "plant", "objects", "lighting"), (0.6, 0.3, 0.4, 0.2))
        hang_above(layout, source, chest, "mirror" if source.chance(0.5) else "picture")
    if area > 13 and source.chance(0.5):
        desk_group(layout, source)
    if area > 13.5 and (area > 18 or source.chance(0.6)) and reading_corner(layout, source) is None:
        place(layout, source, "seating", "plain", front_m=0.4)
    if source.chance(0.35) and bed is not None:
        _hang_screen(layout, source, bed)
    if source.clutter_chance(0.5):
        place(layout, source, "clothes", "rack", "floor", along="corner", front_m=0.3)
    _extras(layout, source, plants=0.5, pictures=(0, 1))


def _hang_screen(layout: RoomLayout, source: FurnitureSource, bed: Placement) -> None:
    """Hangs a screen on the wall that a bed faces, not far from its middle."""
    screen = source.make("tv_monitor", "tv_wall")
    if screen is None or screen.mount != "wall" or bed.side is None:
        return
    side, middle = OPPOSITE[bed.side], bed.rect.span(bed.side)
    for shift_m in (0.0, 0.4, -0.4, 0.8, -0.8):
        if hang_screen(layout, source, screen, side, 0.5 * sum(middle) + shift_m):
            return


def _place_wardrobe(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a wardrobe in a corner, a narrow one where no wide one fits, else a clothes rack."""
    for front_m in (0.7, 0.45):
        wardrobe = place(layout, source, "cabinet", "wardrobe", along="corner", front_m=front_m)
        if wardrobe is not None:
            return wardrobe
    for width_m in (1.0, 0.75):
        wardrobe = place(layout, source, "cabinet", "wardrobe", along="corner", front_m=0.45, width_m=width_m)
        if wardrobe is not None:
            return wardrobe
    racks = [source.make("clothes", "rack", fresh=True) for _ in range(3)]
    rack = next((rack for rack in racks if rack is not None and rack.name == "clothes rack"), None)
    return put_against_wall(layout, source.rng, rack, front_m=0.3) if rack is not None else None


def _living_room(layout: RoomLayout, source: FurnitureSource) -> None:
    area = layout.inner.area_m2
    if sofa_group(layout, source) is None:
        armchair_circle(layout, source)
    if source.chance(0.5) and not any(p.item.category == "fireplace" for p in layout.placements):
        clear = partial(has_room_for_fire, layout)
        hearth = place(layout, source, "fireplace", along="middle", front_m=0.8, tries=3, fits=clear)
        if hearth is not None:
            keep_from_fire(layout, hearth)
            hang_above(layout, source, hearth, "picture" if source.chance(0.6) else "mirror")
    _second_groups(layout, source)
    if area > 20 or source.chance(0.4):
        place(layout, source, "shelving", "bookcase", front_m=0.6)
    if area > 24:
        board = place(layout, source, "cabinet", "sideboard", front_m=0.6)
        if board is not None:
            put_on_top(layout, source, board, ("objects", "plant", "lighting", "objects"), (0.6, 0.4, 0.4, 0.4))
            hang_above(layout, source, board, "picture")
    place(layout, source, "lighting", "floor", along="corner", front_m=0.0)
    if source.clutter_chance(0.3):
        place(layout, source, "cushion", "floor", along="corner", front_m=0.2)
    _extras(layout, source, plants=0.9, pictures=(1, 3))


def _second_groups(layout: RoomLayout, source: FurnitureSource) -> None:
    """Places more groups in a large living room: one from 20 m2 on, two from 30, three from 40."""
    area = layout.inner.area_m2
    count = int(area > 20) + int(area > 30) + int(area > 40)
    free = [armchair_circle, dining_group] if "dining_room" not in source.home_rooms else [armchair_circle]
    by_wall = [reading_corner, desk_group]
    groups = [free[n] for n in source.rng.permutation(len(free)).tolist()]
    groups += [by_wall[n] for n in source.rng.permutation(2).tolist()]
    for group in groups if area > 24 else reversed(groups):
        if count <= 0:
            break
        count -= group(layout, source) is not None
    if area > 20:
        middle_rug(layout, source)


def _kitchen(layout: RoomLayout, source: FurnitureSource) -> None:
    furnish_kitchen(layout, source)
    _extras(layout, source, plants=0.4, pictures=(0, 1), lamp=False)


def _dining_room(layout: RoomLayout, source: FurnitureSource) -> None:
    dining_group(layout, source)
    board = place(layout, source, "cabinet", "sideboard", "display", front_m=0.6)
    if board is not None:
        put_on_top(layout, source, board, ("objects", "plant", "lighting", "objects"), (0.7, 0.4, 0.3, 0.4))
        hang_above(layout, source, board, "picture")
    _extras(layout, source, plants=0.7, pictures=(0, 1))


def _studio(layout: RoomLayout, source: FurnitureSource) -> None:
    kitchen_units(layout, source)
    bed_group(layout, source, large=True)
    sofa_group(layout, source)
    place(layout, source, "cabinet", "wardrobe", along="corner", front_m=0.7)
    dining_group(layout, source, around_m=0.6)
    if source.chance(0.5):
        place(layout, source, "shelving", "bookcase", front_m=0.6)
    place(layout, source, "chest_of_drawers", "dresser", front_m=0.6)
    _extras(layout, source, plants=1.0, pictures=(2, 3))


def _bathroom(layout: RoomLayout, source: FurnitureSource) -> None:
    furnish_bathroom(layout, source)
    _extras(layout, source, plants=0.0, pictures=(0, int(layout.inner.area_m2 > 6)), lamp=False, boxes=False)


def _hallway(layout: RoomLayout, source: FurnitureSource) -> None:
    furnish_hallway(layout, source)
    pictures = int(layout.inner.long_m / 4.0)
    _extras(layout, source, plants=0.5, pictures=(min(3, pictures), min(4, 1 + pictures)), lamp=False)


def _stair_hall(layout: RoomLayout, source: FurnitureSource) -> None:
    """Places coat hooks, a console or a chest, a bench and a plant around the stairs."""
    hang(layout, source, "clothes", "hooks")
    board = place(layout, source, *source.pick((("table", "console"), _DRESSER, ("cabinet", "sideboard"))), front_m=0.9)
    if board is not None:
        put_on_top(layout, source, board, ("objects", "plant", "lighting"), (0.6, 0.4, 0.4))
        hang_above(layout, source, board, "mirror")
    place(layout, source, "seating", "bench", front_m=0.7, tries=3)
    place(layout, source, "plant", "floor", along="corner", front_m=0.0)
    _extras(layout, source, plants=0.5, pictures=(1, 2), lamp=False)


def _office(layout: RoomLayout, source: FurnitureSource) -> None:
    desk_group(layout, source)
    if layout.inner.area_m2 > 13:
        desk_group(layout, source)
    books = place(layout, source, "shelving", "bookcase", front_m=0.6)
    if source.chance(0.5) or books is None:
        place(layout, source, "cabinet", "sideboard", front_m=0.6)
    if source.chance(0.4):
        place(layout, source, "chair", "arm", along="corner", front_m=0.4)
    if source.chance(0.5):
        hang(layout, source, "board_panel")
    if source.chance(0.7):
        middle_rug(layout, source)
    _extras(layout, source, plants=0.6, pictures=(0, 2))


def _gym(layout: RoomLayout, source: FurnitureSource) -> None:
    count = 2 + int(layout.inner.area_m2 > 15) + int(layout.inner.area_m2 > 20)
    seen: set[str] = set()
    for _ in range(4 * count):
        item = source.make("gym_equipment")
        if item is None or item.style in seen:
            continue
        if item.mount == "floor" and not item.walk_over and put_against_wall(layout, source.rng, item, front_m=0.6):
            seen.add(item.style)
        if len(seen) >= count:
            break
    hang(layout, source, "mirror")
    place(layout, source, "seating", "plain", front_m=0.5)
    hang(layout, source, "towel", "rail")
    if source.chance(0.5):
        hang(layout, source, "tv_monitor", "tv_wall")
    _extras(layout, source, plants=0.5, pictures=(1, 1))


def _laundry(layout: RoomLayout, source: FurnitureSource) -> None:
    washer = source.make("appliances", "washing_machine")
    if washer is not None:
        machines = [washer, washer] if source.chance(0.5) else [washer]
        for side in sorted(SIDES, key=lambda s: -layout.walls.longest_stretch_m(s)):
            if place_row(layout, source, machines, side):
                break
        else:
            place(layout, source, "appliances", "washing_machine", front_m=0.45, tries=3)
    sink = place(layout, source, "counter", "run", width_m=1.0, with_sink=True, with_hob=False, front_m=0.6)
    if sink is None:
        sink = place(layout, source, "sink", "standing", front_m=0.5)
    rack = place(layout, source, "clothes", "drying", front_m=0.4)
    if sink is None and rack is None:
        place(layout, source, "clothes", "floor", along="corner", front_m=0.0, tries=3)
    place(layout, source, "shelving", "laundry", front_m=0.5)
    _extras(layout, source, plants=0.1, pictures=(0, 0))


def _closet(layout: RoomLayout, source: FurnitureSource) -> None:
    """Places clothes racks, shelves with folded clothes and shoes, and a wardrobe or a chest."""
    pieces = [("clothes", "rack"), ("shelving", "linen"), source.pick((("cabinet", "wardrobe"), _DRESSER))]
    for n in source.rng.permutation(len(pieces)).tolist():
        place(layout, source, *pieces[n], front_m=0.5)
    if layout.inner.area_m2 > 6.0:
        place(layout, source, *source.pick(pieces), front_m=0.5)
    if not any(p.item.category in ("clothes", "shelving", "cabinet") for p in layout.placements):
        place(layout, source, "shelving", "linen", front_m=0.4, tries=3, width_m=0.7)
    if source.chance(0.5):
        place(layout, source, "stool", "low", along="corner", front_m=0.2)
    if source.clutter_chance(0.5):
        place(layout, source, "objects", "floor", along="corner", front_m=0.0)
    if source.chance(0.5):
        hang(layout, source, "mirror")


def _extras(
    layout: RoomLayout,
    source: FurnitureSource,
    *,
    plants: float,
    pictures: tuple[int, int],
    lamp: bool = True,
    boxes: bool = True,
) -> None:
    """Adds plants in corners, pictures, a lamp and a box or bin, each with its own probability."""
    for chance in (plants, plants - 0.5):
        if source.chance(max(0.0, chance)):
            place(layout, source, "plant", "floor", along="corner", front_m=0.0)
    for _ in range(int(source.rng.integers(pictures[0], pictures[1] + 1))):
        hang(layout, source, "picture")
    if lamp and source.chance(0.25):
        place(layout, source, "lighting", "floor", along="corner", front_m=0.0)
    if boxes and source.clutter_chance(0.25):
        kind = "floor" if layout.kind in BOXES_ON_FLOOR else "bin"
        place(layout, source, "objects", kind, along="corner", front_m=0.0)


RULES: Mapping[str, Callable[[RoomLayout, FurnitureSource], None]] = MappingProxyType(
    {
        "bedroom": _bedroom,
        "living_room": _living_room,
        "kitchen": _kitchen,
        "dining_room": _dining_room,
        "studio": _studio,
        "bathroom": _bathroom,
        "hallway": _hallway,
        "stair_hall": _stair_hall,
        "office": _office,
        "gym": _gym,
        "laundry": _laundry,
        "closet": _closet,
    }
)
"""Rules by kind of room."""
