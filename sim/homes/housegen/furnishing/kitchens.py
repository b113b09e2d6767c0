"""Kitchens: units along one or two walls, and an island or a table where there is room for one."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from sim.homes.housegen.floor_plan.rectangles import OPPOSITE, SIDES, Side
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.groups import breakfast_group, dining_group
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import put_against_wall, put_at
from sim.homes.housegen.furnishing.placement.free_standing import put_in_middle
from sim.homes.housegen.furnishing.placement.on_walls import hang_on_wall
from sim.homes.housegen.furnishing.steps import AISLE_M, place, place_row, put_on_top
from sim.homes.housegen.furniture.item import Hints, Item, Look

LONG_RUN_M = 3.2
"""Longest worktop along a second wall."""
CABINET_BOTTOM_M = 1.45
MIN_APPLIANCES = 2
"""Number of cookers, fridges, dishwashers and hobs that every kitchen has."""
FRIDGE_M = 1.3
"""All items except fridges are at most this high."""
LARGE_M = 0.45
"""Longest side of the smallest of them."""


@dataclass(frozen=True)
class Units:
    """The units of a kitchen so far."""

    looks: dict[str, Look]
    """Materials of all of them."""
    sides: list[Side]
    """Walls against which they are placed."""
    placed: list[Placement]


def furnish_kitchen(layout: RoomLayout, source: FurnitureSource) -> None:
    """Places units, then an island or a table in a large kitchen, then units at the walls that are still free."""
    area = layout.inner.area_m2
    dining_elsewhere = "dining_room" in source.home_rooms
    units = kitchen_units(layout, source)
    if area > 11:
        _add_second_run(layout, source, units)
    middle = _place_island(layout, source) if area > 12 and source.chance(0.6 if dining_elsewhere else 0.35) else None
    if middle is None and area > 8:
        middle = dining_group(layout, source, around_m=0.55) or breakfast_group(layout, source)
    if middle is None or area > 17:
        _add_second_run(layout, source, units)


def kitchen_units(layout: RoomLayout, source: FurnitureSource) -> Units:
    """Places a run of units along the longest wall (fridge, counter with sink, cooker, counter), cabinets above it."""

    def score(side: Side) -> float:
        has_window = any(where == side for where, _ in layout.walls.windows())
        return -layout.walls.longest_stretch_m(side) + (0.5 if has_window else 0.0)

    looks = source.looks("lacquer", "stone", "metal", "wood", "steel", "curtain", "masonry", "wicker")
    units = Units(looks, [], [])
    for side in sorted(SIDES, key=score):
        run = _place_run(layout, source, side, looks)
        if run:
            _hang_cabinets(layout, source, side, run, looks)
            units = Units(looks, [side], run)
            break
    _complete(layout, source, units)
    return units


def _complete(layout: RoomLayout, source: FurnitureSource, units: Units) -> None:
    """Places a short worktop with a sink, and large appliances, that a kitchen lacks after its first run."""
    if not any(unit.item.category == "counter" for unit in units.placed):
        for width_m in (1.6, 1.3, 1.0, 0.8):
            hints: Hints = {"width_m": width_m, "with_sink": True, "with_hob": width_m > 1.3, "looks": units.looks}
            counter = place(layout, source, "counter", "run", front_m=0.6, tries=1, **hints)
            if counter is not None and counter.side is not None:
                units.placed.append(counter)
                units.sides.append(counter.side)
                break
    has_fridge = any(p.item.category == "appliances" and p.item.size_m[2] > FRIDGE_M for p in layout.placements)
    for use in ("stove", "dishwasher") if has_fridge else ("fridge", "stove", "dishwasher"):
        if _large_appliances(layout) >= MIN_APPLIANCES:
            return
        place(layout, source, "appliances", use, along="corner", front_m=0.55, tries=3)


def _large_appliances(layout: RoomLayout) -> int:
    """Returns the number of cookers, fridges, dishwashers and hobs of a kitchen."""
    children = [child.item for placement in layout.placements for child in placement.item.children]
    items = [*(placement.item for placement in layout.placements), *children]
    return sum(item.category == "appliances" and max(item.size_m) > LARGE_M for item in items)


def _place_run(layout: RoomLayout, source: FurnitureSource, side: Side, looks: dict[str, Look]) -> list[Placement]:
    """Places units side by side at one wall, fewer and narrower ones where the wall is short."""
    free_m = min(layout.walls.longest_stretch_m(side) - 0.02, 5.0)
    fridge, cooker = source.make("appliances", "fridge"), source.make("appliances", "stove")
    for share in (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4):
        items = _run_items(source, fridge, cooker, share * free_m, looks)
        if not items:
            break
        run = place_row(layout, source, [item for item in items if item is not None], side)
        for unit in run:
            if unit.item.category == "counter":
                put_on_top(layout, source, unit, ("objects", "appliances", "objects", "plant"), (0.8, 0.3, 0.5, 0.2))
        if run:
            if len(items) == 1 and fridge is not None:
                put_against_wall(layout, source.rng, fridge, along="corner", front_m=0.6)
            return run
    return []


def _run_items(
    source: FurnitureSource, fridge: Item | None, cooker: Item | None, length_m: float, looks: dict[str, Look]
) -> list[Item | None]:
    """Returns the units of a run of this length; an empty list if it is too short."""

    def worktop(width_m: float, *, sink: bool, hob: bool) -> Item | None:
        return source.make("counter", "run", width_m=round(width_m, 2), with_sink=sink, with_hob=hob, looks=looks)

    rest_m = length_m - sum(item.size_m[1] + 0.005 for item in (fridge, cooker) if item is not None)
    if rest_m > 1.9:
        first_m = 0.6 * rest_m
        first = worktop(first_m, sink=True, hob=False)
        return [fridge, first, cooker, worktop(rest_m - first_m, sink=False, hob=False)]
    if rest_m > 0.95:
        return [fridge, worktop(rest_m, sink=True, hob=False), cooker]
    if length_m > 1.3:
        return [worktop(length_m, sink=True, hob=True)]
    return []


def _add_second_run(layout: RoomLayout, source: FurnitureSource, units: Units) -> None:
    """Adds a worktop at another wall, preferably one that forms an L with the first."""
    others: list[Side] = [side for side in SIDES if side not in units.sides]
    in_l = {side: OPPOSITE[side] not in units.sides for side in others}
    others.sort(key=lambda side: -layout.walls.longest_stretch_m(side) - (1.0 if in_l[side] else 0.0))
    counters = [unit for unit in units.placed if unit.item.category == "counter"]
    for unit in counters:  # the end of a worktop may lie in the corner behind another one
        layout.release_zones(unit)
    for side, share in itertools.product(others, (0.85, 0.6, 0.4)):
        width_m = round(min(share * layout.walls.longest_stretch_m(side), LONG_RUN_M), 2)
        if width_m < 0.8:
            continue
        item = source.make("counter", "run", width_m=width_m, with_sink=False, with_hob=False, looks=units.looks)
        run = place_row(layout, source, [item], side) if item else []
        if run:
            put_on_top(layout, source, run[0], ("appliances", "objects", "plant", "objects"), (0.4, 0.8, 0.2, 0.5))
            _hang_cabinets(layout, source, side, run, units.looks)
            units.sides.append(side)
            units.placed.extend(run)
            break
    for unit in counters:
        layout.reserve_zone(unit, AISLE_M)


def _hang_cabinets(
    layout: RoomLayout, source: FurnitureSource, side: Side, run: list[Placement], looks: dict[str, Look]
) -> None:
    """Hangs a cabinet above each low unit of a run, a narrower one where the unit's width does not fit."""
    for unit in run:
        if unit.item.size_m[2] > 1.2:
            continue
        width_m = min(unit.item.size_m[1], 2.0)
        lo, hi = unit.rect.span(side)
        for share in (1.0, 0.6, 0.4):
            cabinet = source.make("cabinet", "kitchen_wall", width_m=round(width_m * share, 2), looks=looks)
            if cabinet is None or cabinet.mount != "wall":
                return
            half = cabinet.size_m[1] / 2
            if any(
                hang_on_wall(layout, source.rng, cabinet, sides=[side], at=at, bottom_m=CABINET_BOTTOM_M, margin_m=0.0)
                for at in (0.5 * (lo + hi), lo + half, hi - half)
            ):
                break


def _place_island(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a free-standing counter with stools at one side."""
    for width_m in (None, 1.3):
        hints: Hints = {"width_m": width_m} if width_m else {}
        item = source.make("counter", "island", **hints)
        if item is None:
            return None
        front_m, across_m = item.size_m[0] / 2 + 0.4, 0.3 * item.size_m[1]
        seats = [(side * front_m, y, 0.35) for side in (-1.0, 1.0) for y in (-across_m, across_m)]
        island = put_in_middle(layout, source.rng, item, seats, around_m=0.9, apart_m=0.6)
        if island is not None:
            put_on_top(layout, source, island, ("objects", "plant", "objects"), (0.7, 0.4, 0.3))
            _place_bar_stools(layout, source, island)
            return island
    return None


def _place_bar_stools(layout: RoomLayout, source: FurnitureSource, island: Placement) -> None:
    """Places stools in front of an island, or behind it if they do not fit in front."""
    stool = source.make("stool", "bar")
    layout.release_zones(island)
    if stool is None:
        return
    depth, width = island.item.size_m[:2]
    count = max(2, min(4, int(width / (stool.size_m[1] + 0.2))))
    for sign in (1.0, -1.0):
        yaw = island.placed.yaw_rad + (math.pi if sign > 0 else 0.0)
        placed = 0
        for n in range(count):
            x, y = sign * (depth / 2 + stool.size_m[0] / 2 + 0.04), (n - 0.5 * (count - 1)) * width / count
            placed += put_at(layout, stool, *island.to_world(x, y), yaw) is not None
        if placed:
            return
