"""What a large room gets besides: seats in groups, shelves, consoles, rugs, plants, until its floor looks lived on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from sim.houses.furniture.item import Item
from sim.houses.groups import beside, desk_group, dining_group, hang, hang_over, lay_rug, place, put_things
from sim.houses.kit import Kit
from sim.houses.placement import RoomSpace, Standing

Filler = Callable[[RoomSpace, Kit], object]
"""Adds something to a room; a false value where there is no place for it."""
PICTURE_PER_M2 = 0.04
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
    low, chair = kit.make("table", "coffee"), kit.make("chair", "arm")
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
    table = space.in_middle(kit.rng, low, seats, around_m=1.2)
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


def middle_rug(space: RoomSpace, kit: Kit) -> None:
    """A rug where the floor is free."""
    along = math.pi / 2 if space.inner.width_m > space.inner.depth_m else 0.0
    lay_rug(space, kit, *space.inner.centre, along, runner=False)


def runners(space: RoomSpace, kit: Kit) -> None:
    """Rugs one behind the other along a corridor."""
    wide = space.inner.width_m > space.inner.depth_m
    count = max(1, int(space.inner.long_m / 4.5))
    for n in range(count):
        share = (n + 0.5) / count
        x = space.inner.x0 + share * space.inner.width_m if wide else space.inner.centre[0]
        y = space.inner.centre[1] if wide else space.inner.y0 + share * space.inner.depth_m
        lay_rug(space, kit, x, y, math.pi / 2 if wide else 0.0, runner=True)


def pictures(space: RoomSpace, kit: Kit) -> None:
    """More pictures for more wall."""
    for _ in range(int(PICTURE_PER_M2 * space.inner.area_m2 + kit.uniform(0.0, 1.0))):
        hang(space, kit, "picture")


def _piece(category: str, *uses: str, front_m: float = 0.5, corner: bool = False) -> Filler:
    def put(space: RoomSpace, kit: Kit) -> Standing | None:
        return place(space, kit, category, *uses, along="corner" if corner else "any", front_m=front_m)

    return put


def _chest(space: RoomSpace, kit: Kit) -> Standing | None:
    chest = place(space, kit, "chest_of_drawers", "dresser", front_m=0.6)
    if chest is not None:
        put_things(space, kit, chest, ("objects", "plant", "lighting"), (0.6, 0.4, 0.3))
        hang_over(space, kit, chest, "mirror" if kit.chance(0.5) else "picture")
    return chest


def _dining(space: RoomSpace, kit: Kit) -> Standing | None:
    return dining_group(space, kit, around_m=0.7) if not _has(space, ("table",), 0.9) else None


def _desk(space: RoomSpace, kit: Kit) -> Standing | None:
    return desk_group(space, kit)


def _machine(space: RoomSpace, kit: Kit) -> Standing | None:
    """Another machine, of a style that the gym has not."""
    there = {s.placed.item.style for s in space.standing}
    for _ in range(6):
        item = kit.make("gym_equipment")
        if item is not None and item.mount == "floor" and not item.walk_over and item.style not in there:
            return space.against_wall(kit.rng, item, front_m=0.6)
    return None


def _has(space: RoomSpace, categories: Sequence[str], wide_m: float) -> bool:
    """Whether a piece of such a category, at least so wide, stands in the room."""
    return any(
        s.placed.item.category in categories and min(s.placed.item.size_m[:2]) >= 0.75 * wide_m for s in space.standing
    )


_PLANT = _piece("plant", "floor", front_m=0.0, corner=True)
_LAMP = _piece("lighting", "floor", front_m=0.0, corner=True)
_BOOKS = _piece("shelving", "bookcase")
_BENCH = _piece("seating", "bench", front_m=0.4)
_OTTOMAN = _piece("seating", "ottoman", front_m=0.3)
_BOX = _piece("objects", "floor", front_m=0.0, corner=True)
_PIANO = _piece("furniture", "piano", front_m=0.7)
_SCREEN = _piece("furniture", "screen", front_m=0.2)
_WARDROBE = _piece("cabinet", "wardrobe", front_m=0.7, corner=True)
_SIDEBOARD = _piece("cabinet", "sideboard", "display", front_m=0.6)
_RACK = _piece("clothes", "rack", front_m=0.4)

FILLINGS: Mapping[str, Filling] = MappingProxyType(
    {
        "living_room": Filling(
            0.25, (reading_corner, chat_circle, console, _BOOKS, _BOOKS, _PLANT, _PIANO, _LAMP, _OTTOMAN, pictures)
        ),
        "bedroom": Filling(0.27, (reading_corner, _chest, _desk, _BENCH, _PLANT, _WARDROBE, _BOOKS, _SCREEN, pictures)),
        "kitchen": Filling(0.26, (_dining, _SIDEBOARD, _PLANT, _BENCH, console, pictures)),
        "dining_room": Filling(0.24, (_SIDEBOARD, console, reading_corner, _PLANT, _BENCH, _PIANO, pictures)),
        "studio": Filling(0.30, (reading_corner, _BOOKS, _PLANT, console, _OTTOMAN)),
        "office": Filling(0.26, (_BOOKS, _desk, reading_corner, _PLANT, console, pictures, middle_rug)),
        "gym": Filling(0.24, (_machine, _machine, _BENCH, _PLANT, _OTTOMAN, pictures)),
        "hallway": Filling(0.13, (console, _BENCH, _PLANT, _BOOKS, _chest, reading_corner, pictures), rounds=3),
        "bathroom": Filling(0.27, (_PLANT, _BOX, _chest, _BENCH), rounds=1),
        "laundry": Filling(0.27, (_RACK, _BOOKS, _BOX, _PLANT), rounds=1),
        "closet": Filling(0.30, (_WARDROBE, _RACK, _chest, _BOX, _BOOKS, _OTTOMAN), rounds=1),
    }
)
"""What each kind of room is filled with."""
