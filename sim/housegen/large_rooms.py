"""What a large room gets besides: seats in groups, shelves, consoles, rugs, plants, until its floor looks lived on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from sim.housegen.furniture.item import Item
from sim.housegen.groups import beside, desk_group, hang, hang_over, lay_rug, place, put_things
from sim.housegen.placement import RoomSpace, Standing
from sim.housegen.selection import Kit

Filler = Callable[[RoomSpace, Kit], object]
"""Adds something to a room; a false value where there is no place for it."""
PICTURE_PER_M2 = 0.02
"""Pictures a room may have more than its rule gives it."""


@dataclass(frozen=True)
class Filling:
    """How full a kind of room gets, and with what."""

    share: float
    """Part of the floor under furniture at middling clutter."""
    with_: tuple[Filler, ...]
    rounds: int = 2
    """How often the list is gone through."""


def fill(space: RoomSpace, kit: Kit) -> None:
    """Add to a furnished room until its kind's share of the floor is taken, the clutter a little more or less."""
    filling = FILLINGS.get(space.kind)
    if filling is None:
        return
    wanted = filling.share * (0.5 + 0.5 * kit.clutter)
    left = list(filling.with_)
    for _ in range(filling.rounds):
        order = [left[n] for n in kit.rng.permutation(len(left)).tolist()]
        for filler in order:
            if space.filled_share() >= wanted:
                return
            if not filler(space, kit):
                left.remove(filler)


def reading_corner(space: RoomSpace, kit: Kit) -> Standing | None:
    """An easy chair in a corner, a small table and a lamp beside it."""
    chair = place(space, kit, "chair", "arm", along="corner", front_m=0.5)
    if chair is None:
        return None
    side = 1.0 if kit.chance(0.5) else -1.0
    table = kit.make("table", "side")
    if table is not None:
        stand = beside(space, kit, chair, table, side) or beside(space, kit, chair, table, -side)
        if stand is not None:
            put_things(space, kit, stand, ("lighting", "objects", "plant"), (0.6, 0.4, 0.3))
    lamp = kit.make("lighting", "floor")
    if lamp is not None and kit.chance(0.6):
        beside(space, kit, chair, lamp, -side)
    return chair


def chat_circle(space: RoomSpace, kit: Kit) -> Standing | None:
    """Easy chairs and ottomans round a low table, away from the walls."""
    second = any(s.placed.item.category == "sofa" for s in space.standing)  # whose low table stands before it
    low, chair = kit.make("table", "side" if second else "coffee"), kit.make("chair", "arm")
    if low is None or chair is None:
        return None
    pouf = kit.make("seating", "ottoman")
    around: list[Item] = [chair, chair, pouf if pouf is not None else chair]
    reach = 0.5 * max(low.size_m[:2]) + 0.4
    turns = (math.pi / 2, -math.pi / 2, 0.0) if low.size_m[1] > 1.2 * low.size_m[0] else (0.6, -0.6, math.pi)
    seats = [
        (d * math.cos(turn), d * math.sin(turn), 0.55 * max(item.size_m[:2]))
        for item, turn in zip(around, turns, strict=True)
        for d in [reach + item.size_m[0] / 2]
    ]
    table = space.in_middle(kit.rng, low, seats, around_m=1.2, least=0.6, apart_m=0.8)
    if table is None:
        return None
    c, s = math.cos(table.placed.yaw_rad), math.sin(table.placed.yaw_rad)
    for item, (x, y, _), turn in zip(around, seats, turns, strict=True):
        yaw = table.placed.yaw_rad + turn + math.pi
        space.at(item, table.placed.x_m + c * x - s * y, table.placed.y_m + s * x + c * y, yaw)
    put_things(space, kit, table, ("objects", "plant"), (0.6, 0.3))
    lay_rug(space, kit, table.placed.x_m, table.placed.y_m, table.placed.yaw_rad, runner=False)
    return table


def console(space: RoomSpace, kit: Kit) -> Standing | None:
    """A narrow table or sideboard with things on it and something above it."""
    kind = ("table", "console") if kit.chance(0.6) else ("cabinet", "sideboard")
    board = place(space, kit, *kind, front_m=0.5)
    if board is not None:
        put_things(space, kit, board, ("objects", "plant", "lighting", "objects"), (0.6, 0.4, 0.4, 0.4))
        hang_over(space, kit, board, "mirror" if space.kind == "hallway" and kit.chance(0.5) else "picture")
    return board


def middle_rug(space: RoomSpace, kit: Kit) -> bool:
    """A large rug in the room's middle, where nothing flat lies yet."""
    along = 0.0 if space.inner.width_m < space.inner.depth_m else math.pi / 2
    size_m = (1.8, 2.6) if space.inner.area_m2 > 16 else None
    return lay_rug(space, kit, *space.inner.centre, along, runner=False, size_m=size_m)


def pictures(space: RoomSpace, kit: Kit) -> None:
    """More pictures for more wall."""
    for _ in range(int(PICTURE_PER_M2 * space.inner.area_m2 + kit.uniform(0.0, 1.0))):
        hang(space, kit, "picture")


def _piece(category: str, *uses: str, front_m: float = 0.5, corner: bool = False, most: int = 9) -> Filler:
    def put(space: RoomSpace, kit: Kit) -> Standing | None:
        alike = [s for s in space.standing if s.placed.item.category == category and s.placed.item.mount == "floor"]
        if len(alike) >= most:
            return None
        return place(space, kit, category, *uses, along="corner" if corner else "any", front_m=front_m)

    return put


def _chest(space: RoomSpace, kit: Kit) -> Standing | None:
    chest = place(space, kit, "chest_of_drawers", "dresser", front_m=0.6)
    if chest is not None:
        put_things(space, kit, chest, ("objects", "plant", "lighting"), (0.6, 0.4, 0.3))
        hang_over(space, kit, chest, "mirror" if kit.chance(0.5) else "picture")
    return chest


def _desk(space: RoomSpace, kit: Kit) -> Standing | None:
    return desk_group(space, kit)


def _machine(space: RoomSpace, kit: Kit) -> Standing | None:
    """Another machine, of a style that the gym has not, or only once where it is large; in its middle if there is."""
    there = [s.placed.item.style for s in space.standing if s.placed.item.category == "gym_equipment"]
    most = 2 if space.inner.area_m2 > 17 and len(there) > 3 else 1
    for _ in range(6):
        item = kit.make("gym_equipment")
        if item is not None and item.mount == "floor" and not item.walk_over and there.count(item.style) < most:
            found = space.in_middle(kit.rng, item, (), around_m=1.2, apart_m=0.5) if space.inner.short_m > 4.0 else None
            return found or space.against_wall(kit.rng, item, front_m=0.6)
    return None


def _towels(space: RoomSpace, kit: Kit) -> Standing | None:
    return place(space, kit, "towel", "floor", front_m=0.3)


_PLANT = _piece("plant", "floor", front_m=0.0, corner=True, most=2)
_LAMP = _piece("lighting", "floor", front_m=0.0, corner=True, most=2)
_BOOKS = _piece("shelving", "bookcase")
_BENCH = _piece("seating", "bench", front_m=0.4)
_PLAIN_BENCH = _piece("seating", "plain", front_m=0.4, most=1)
_OTTOMAN = _piece("seating", "ottoman", front_m=0.3, most=2)
_BOX = _piece("objects", "floor", front_m=0.0, corner=True, most=2)
_BIN = _piece("objects", "bin", front_m=0.0, corner=True, most=1)
_STOOL = _piece("stool", "low", front_m=0.2, corner=True, most=1)
_BASKET = _piece("clothes", "floor", front_m=0.2, corner=True, most=1)
_PIANO = _piece("furniture", "piano", front_m=0.7, most=1)
_SCREEN = _piece("furniture", "screen", front_m=0.2, most=1)
_WARDROBE = _piece("cabinet", "wardrobe", front_m=0.7, corner=True)
_SIDEBOARD = _piece("cabinet", "sideboard", "display", front_m=0.6)
_RACK = _piece("clothes", "rack", front_m=0.4, most=2)

FILLINGS: Mapping[str, Filling] = MappingProxyType(
    {
        "living_room": Filling(
            0.25,
            (
                reading_corner,
                chat_circle,
                console,
                _BOOKS,
                _PLANT,
                _PIANO,
                _LAMP,
                _OTTOMAN,
                middle_rug,
                pictures,
            ),
        ),
        "bedroom": Filling(
            0.26, (reading_corner, _chest, _desk, _PLAIN_BENCH, _PLANT, _WARDROBE, _BOOKS, _SCREEN, pictures)
        ),
        "kitchen": Filling(0.26, (_SIDEBOARD, _PLANT, _BIN, pictures)),
        "dining_room": Filling(0.24, (_SIDEBOARD, console, reading_corner, _PLANT, _PIANO, pictures)),
        "studio": Filling(0.30, (reading_corner, _BOOKS, _PLANT, console, _OTTOMAN)),
        "office": Filling(0.26, (_BOOKS, _desk, reading_corner, _PLANT, console, pictures, middle_rug)),
        "gym": Filling(0.26, (_machine, _machine, _PLAIN_BENCH, _PLANT, _OTTOMAN, _towels, pictures)),
        "bathroom": Filling(0.27, (_PLANT, _BIN, _towels, _STOOL, _BASKET), rounds=1),
        "laundry": Filling(0.27, (_BOOKS, _BASKET, _BIN), rounds=1),
        "closet": Filling(0.30, (_WARDROBE, _RACK, _chest, _BOX, _BOOKS, _OTTOMAN), rounds=1),
    }
)
"""What each kind of room is filled with."""
