"""Kitchens: units along one wall or two, an island or a table to eat at, wherever there is room for it."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

from sim.housegen.furniture.item import Item, Look
from sim.housegen.groups import AISLE_M, breakfast_group, dining_group, put_things, row
from sim.housegen.placement import RoomSpace, Standing
from sim.housegen.rectangles import OPPOSITE, SIDES, Side
from sim.housegen.selection import Kit


@dataclass(frozen=True)
class Units:
    """The units of a kitchen so far."""

    looks: dict[str, Look]
    """Of all of them."""
    sides: list[Side]
    """Walls they stand against."""
    stood: list[Standing]


LONG_RUN_M = 3.2
"""Longest worktop along a second wall."""


def furnish_kitchen(space: RoomSpace, kit: Kit) -> None:
    """Units, then something in the middle of a large kitchen or a place to eat, then units on the walls still free."""
    area = space.inner.area_m2
    dining_elsewhere = "dining_room" in kit.home_rooms
    run = kitchen_units(space, kit)
    if area > 11:
        _second_run(space, kit, run)
    middle = _island(space, kit) if area > 12 and kit.chance(0.6 if dining_elsewhere else 0.35) else None
    if middle is None and area > 8:
        middle = dining_group(space, kit, around_m=0.55) or breakfast_group(space, kit)
    if middle is None or area > 17:
        _second_run(space, kit, run)


def kitchen_units(space: RoomSpace, kit: Kit) -> Units:
    """A run of units along the best wall (fridge, counter with sink, cooker, counter), cabinets above."""
    sides = sorted(SIDES, key=lambda side: -space.wall_length(side) + (0.5 if _has_window(space, side) else 0.0))
    looks = kit.looks("lacquer", "stone", "metal", "wood", "steel", "curtain", "masonry", "wicker")
    for side in sides:
        made = _kitchen_run(space, kit, side, min(space.wall_length(side) - 0.02, 5.0), looks)
        if made:
            _wall_cabinets(space, kit, side, made, looks)
            return Units(looks, [side], made)
    return Units(looks, [], [])


def _second_run(space: RoomSpace, kit: Kit, units: Units) -> None:
    """More worktop on another wall: round the corner from the first if it can be, for an L."""
    others: list[Side] = [side for side in SIDES if side not in units.sides]
    others.sort(key=lambda side: -space.wall_length(side) - (1.0 if OPPOSITE[side] not in units.sides else 0.0))
    counters = [unit for unit in units.stood if unit.placed.item.category == "counter"]
    for unit in counters:  # the end of a worktop may lie in the corner behind another one
        space.release(unit)
    for side, share in itertools.product(others, (0.85, 0.6, 0.4)):
        width = round(min(share * space.wall_length(side), LONG_RUN_M), 2)
        if width < 0.8:
            continue
        item = kit.make("counter", "run", width_m=width, with_sink=False, with_hob=False, looks=units.looks)
        run = row(space, kit, [item], side) if item else []
        if run:
            put_things(space, kit, run[0], ("appliances", "objects", "plant", "objects"), (0.4, 0.8, 0.2, 0.5))
            _wall_cabinets(space, kit, side, run, units.looks)
            units.sides.append(side)
            units.stood.extend(run)
            break
    for unit in counters:
        space.reserve(unit, AISLE_M)


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


def _island(space: RoomSpace, kit: Kit) -> Standing | None:
    """A free-standing counter with stools on one side."""
    for width_m in (None, 1.3):
        hints: dict[str, Any] = {"width_m": width_m} if width_m else {}
        island = kit.make("counter", "island", **hints)
        if island is None:
            return None
        front = island.size_m[0] / 2 + 0.4
        spots = [
            (side * front, y, 0.35) for side in (-1.0, 1.0) for y in (-0.3 * island.size_m[1], 0.3 * island.size_m[1])
        ]
        standing = space.in_middle(kit.rng, island, spots, around_m=0.9, apart_m=0.6)
        if standing is not None:
            break
    else:
        return None
    put_things(space, kit, standing, ("objects", "plant", "objects"), (0.7, 0.4, 0.3))
    _bar_stools(space, kit, standing)
    return standing


def _bar_stools(space: RoomSpace, kit: Kit, island: Standing) -> None:
    """Stools before an island, or behind it where there is no room before it."""
    stool = kit.make("stool", "bar")
    space.release(island)
    if stool is None:
        return
    depth, width = island.placed.item.size_m[:2]
    count = max(2, min(4, int(width / (stool.size_m[1] + 0.2))))
    yaw = island.placed.yaw_rad
    c, s = math.cos(yaw), math.sin(yaw)
    for sign in (1.0, -1.0):
        placed = 0
        for n in range(count):
            lx, ly = sign * (depth / 2 + stool.size_m[0] / 2 + 0.04), (n - 0.5 * (count - 1)) * width / count
            x, y = island.placed.x_m + c * lx - s * ly, island.placed.y_m + s * lx + c * ly
            placed += space.at(stool, x, y, yaw + (math.pi if sign > 0 else 0.0)) is not None
        if placed:
            return


def _has_window(space: RoomSpace, side: Side) -> bool:
    return any(where == side for where, _ in space.windows())
