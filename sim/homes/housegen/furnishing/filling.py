"""Adds furniture to rooms that have much free floor: groups of seats, shelves, consoles, rugs, plants."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.groups import desk_group
from sim.homes.housegen.furnishing.middles import fill_middle
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import put_against_wall
from sim.homes.housegen.furnishing.placement.free_standing import put_in_middle
from sim.homes.housegen.furnishing.seating_groups import armchair_circle, reading_corner
from sim.homes.housegen.furnishing.steps import hang, hang_above, lay_rug, place, put_on_top

Addition = Callable[[RoomLayout, FurnitureSource], object]
"""Adds something to a room; returns a false value where it found no position."""
PICTURES_PER_M2 = 0.02
"""Pictures by floor area that a room gets beyond those of its rule."""


@dataclass(frozen=True)
class FillRule:
    """The furniture that is added to a kind of room, and the amount of it."""

    share: float
    """Share of the floor under furniture at clutter 1; half of it at clutter 0."""
    additions: tuple[Addition, ...]
    rounds: int = 2
    """Number of times that each addition is tried."""


def fill_room(layout: RoomLayout, source: FurnitureSource) -> None:
    """Adds furniture to a room until it covers the share of the floor that the rule of its kind wants."""
    rule = FILL_RULES.get(layout.kind)
    if rule is None:
        fill_middle(layout, source)
        return
    share = rule.share * (0.5 + 0.5 * source.clutter)
    fill_middle(layout, source)
    additions = list(rule.additions)
    for _ in range(rule.rounds):
        order = [additions[n] for n in source.rng.permutation(len(additions)).tolist()]
        for add in order:
            if layout.filled_share() >= share:
                return
            if not add(layout, source):
                additions.remove(add)


def console(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a narrow table or sideboard with small items on it and a picture above it."""
    kinds = [kind for kind in (("table", "console"), ("cabinet", "sideboard")) if source.has_unused(*kind)]
    if not kinds:
        return None
    kind = source.pick(kinds)
    board = place(layout, source, *kind, front_m=0.5)
    if board is not None:
        put_on_top(layout, source, board, ("objects", "plant", "lighting", "objects"), (0.6, 0.4, 0.4, 0.4))
        hang_above(layout, source, board, "picture")
    return board


def middle_rug(layout: RoomLayout, source: FurnitureSource) -> bool:
    """Lays a large rug in the middle of a room; returns False if another rug lies there."""
    along = 0.0 if layout.inner.width_m < layout.inner.depth_m else math.pi / 2
    size_m = (1.8, 2.6) if layout.inner.area_m2 > 16 else None
    return lay_rug(layout, source, *layout.inner.centre, along, runner=False, size_m=size_m)


def pictures(layout: RoomLayout, source: FurnitureSource) -> None:
    """Hangs pictures in proportion to the floor area."""
    for _ in range(int(PICTURES_PER_M2 * layout.inner.area_m2 + source.uniform(0.0, 1.0))):
        hang(layout, source, "picture")


def _piece(category: str, *uses: str, front_m: float = 0.5, corner: bool = False, most: int = 9) -> Addition:
    """Returns the addition of one item for one of some uses; a room has at most `most` floor items of its category."""

    def put(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
        alike = [p for p in layout.placements if p.item.category == category and p.item.mount == "floor"]
        if len(alike) >= most or not source.has_unused(category, *uses):
            return None
        return place(layout, source, category, *uses, along="corner" if corner else "any", front_m=front_m)

    return put


def _chest(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a chest of drawers with small items on it and a mirror or picture above it."""
    if not source.has_unused("chest_of_drawers", "dresser"):
        return None
    chest = place(layout, source, "chest_of_drawers", "dresser", front_m=0.6)
    if chest is not None:
        put_on_top(layout, source, chest, ("objects", "plant", "lighting"), (0.6, 0.4, 0.3))
        hang_above(layout, source, chest, "mirror" if source.chance(0.5) else "picture")
    return chest


def _machine(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places gym equipment of a style that the room does not have yet, or has once if it is large."""
    styles = [p.item.style for p in layout.placements if p.item.category == "gym_equipment"]
    most = 2 if layout.inner.area_m2 > 17 and len(styles) > 3 else 1
    for _ in range(6):
        item = source.make("gym_equipment")
        if item is None or item.mount != "floor" or item.walk_over or styles.count(item.style) >= most:
            continue
        placed = None
        if layout.inner.short_m > 4.0:
            placed = put_in_middle(layout, source.rng, item, (), around_m=1.2, apart_m=0.5)
        return placed or put_against_wall(layout, source.rng, item, front_m=0.6)
    return None


_PLANT = _piece("plant", "floor", front_m=0.0, corner=True, most=2)
_LAMP = _piece("lighting", "floor", front_m=0.0, corner=True, most=2)
_BOOKS = _piece("shelving", "bookcase")
_LINEN = _piece("shelving", "linen", most=3)
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
_TOWELS = _piece("towel", "floor", front_m=0.3)
_RACK = _piece("clothes", "rack", front_m=0.4, most=2)

FILL_RULES: Mapping[str, FillRule] = MappingProxyType(
    {
        "living_room": FillRule(
            0.25,
            (
                reading_corner,
                armchair_circle,
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
        "bedroom": FillRule(
            0.26, (reading_corner, _chest, desk_group, _PLAIN_BENCH, _PLANT, _WARDROBE, _BOOKS, _SCREEN, pictures)
        ),
        "kitchen": FillRule(0.26, (_SIDEBOARD, _PLANT, _BIN, pictures)),
        "dining_room": FillRule(0.24, (_SIDEBOARD, console, reading_corner, _PLANT, _PIANO, pictures)),
        "studio": FillRule(0.30, (reading_corner, _BOOKS, _PLANT, console, _OTTOMAN)),
        "office": FillRule(0.26, (_BOOKS, desk_group, reading_corner, _PLANT, console, pictures, middle_rug)),
        "gym": FillRule(0.26, (_machine, _machine, _PLAIN_BENCH, _PLANT, _OTTOMAN, _TOWELS, pictures)),
        "bathroom": FillRule(0.27, (_BIN, _TOWELS, _STOOL, _BASKET), rounds=1),
        "laundry": FillRule(0.27, (_BASKET, _BIN), rounds=1),
        "closet": FillRule(0.30, (_WARDROBE, _RACK, _chest, _BOX, _LINEN, _OTTOMAN), rounds=1),
    }
)
"""Rules by kind of room; the other kinds get no further items."""
