"""Kitchens: units along the walls by a plan of `kitchen_runs`, and an island or a table where there is room for one."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from sim.homes.housegen.floor_plan.rectangles import OPPOSITE
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.groups import breakfast_group, dining_group
from sim.homes.housegen.furnishing.kitchen_runs import Kind, Run, kitchen_plans
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import put_at
from sim.homes.housegen.furnishing.placement.free_standing import put_in_middle
from sim.homes.housegen.furnishing.placement.on_walls import hang_on_wall
from sim.homes.housegen.furnishing.steps import place, put_on_top
from sim.homes.housegen.furniture.item import Item, Look
from sim.world.arrangement import AISLE_M, MAX_TRIANGLE_M, MIN_TRIANGLE_M

WORKTOP_M = (0.62, 0.90)
"""Depth and height of every worktop of a home, so that neighbouring units have one continuous surface."""
CABINET_BOTTOM_M, CABINET_M = 1.45, (0.34, 0.70)
"""Height of the lower edge of wall cabinets, and their depth and height."""
HOOD_BOTTOM_M = 1.6
"""Height of the lower edge of a hood: 0.7 m above the cooker."""
LONGEST_RUN_M, LONGEST_STUDIO_RUN_M = 4.8, 3.6
NARROW_AISLE_M = 0.8
"""Depth of the floor kept free in front of a run where `AISLE_M` is not available."""
MAX_PLANS = 40
"""Plans that are tried for one kitchen with each depth of the aisle."""
_JITTER = 16


def furnish_kitchen(layout: RoomLayout, source: FurnitureSource) -> None:
    """Places the units, then an island or a table in a larger kitchen."""
    area = layout.inner.area_m2
    dining_elsewhere = "dining_room" in source.home_rooms
    kitchen_units(layout, source)
    island = _place_island(layout, source) if area > 11 and source.chance(0.8 if dining_elsewhere else 0.35) else None
    if area > 8 and not dining_elsewhere and (island is None or area > 20):
        if dining_group(layout, source, around_m=0.55) is None:
            breakfast_group(layout, source)
    elif island is None and area > 10 and breakfast_group(layout, source) is None:
        place(layout, source, "cabinet", "sideboard", front_m=0.8)


def kitchen_units(layout: RoomLayout, source: FurnitureSource) -> bool:
    """Places fridge, sink, cooker and worktops by the best plan that fits, with cabinets above; False if none fits."""
    appliances: dict[Kind, Item | None] = {
        "fridge": source.make("appliances", "fridge"),
        "cooker": source.make("appliances", "stove", height_m=WORKTOP_M[1]),
        "dishwasher": source.make("appliances", "dishwasher"),
    }
    looks = _looks(source)
    longest_m = LONGEST_STUDIO_RUN_M if layout.kind == "studio" else LONGEST_RUN_M
    widths: dict[Kind, float] = {kind: item.size_m[1] for kind, item in appliances.items() if item is not None}
    jitter = [source.uniform(0.0, 1.0) for _ in range(_JITTER)]
    plans = kitchen_plans(layout, widths, jitter, longest_m=longest_m)
    plans = [plan for plan in plans if _has_space(layout, plan, appliances)]
    for aisle_m in (AISLE_M, NARROW_AISLE_M):
        for plan in plans[:MAX_PLANS] + plans[-2:]:
            before = layout.snapshot()
            placed = _place_plan(layout, source, plan, appliances, looks, aisle_m)
            if placed:
                _finish(layout, source, placed, looks)
                return True
            layout.restore(before)
    return False


def _has_space(layout: RoomLayout, plan: Sequence[Run], appliances: dict[Kind, Item | None]) -> bool:
    """Returns whether all units of a plan lie in the room, on free floor, and its appliances before no window."""
    for run in plan:
        for kind, start_m, width_m in run.spans():
            item, span = appliances.get(kind), sorted((run.leg.at(start_m), run.leg.at(start_m + width_m)))
            if item is not None:
                placement = layout.walls.placement(item, run.leg.side, 0.5 * sum(span))
                if layout.walls.hides_window(placement):
                    return False
            rect = layout.inner.strip(run.leg.side, (span[0], span[1]), WORKTOP_M[0])
            if not layout.inner.contains(rect, 0.002) or not layout.is_clear(rect, 0.0, WORKTOP_M[1]):
                return False
    return True


def _looks(source: FurnitureSource) -> dict[str, Look]:
    """Returns the materials of all units of a home; in the train pool, all fronts are of wood or all are painted."""
    looks = source.looks("lacquer", "stone", "metal", "wood", "steel", "curtain", "wicker")
    if source.pool == "train":
        front = looks["wood" if source.chance(0.45) else "lacquer"]
        looks |= {"wood": front, "lacquer": front}
    return looks


def _place_plan(
    layout: RoomLayout,
    source: FurnitureSource,
    plan: Sequence[Run],
    appliances: dict[Kind, Item | None],
    looks: dict[str, Look],
    aisle_m: float,
) -> list[Placement]:
    """Places the units of a plan; an empty list if one of them does not fit or the work triangle misses its range."""
    placed: list[Placement] = []
    for run in plan:
        for kind, start_m, width_m in run.spans():
            item = appliances.get(kind) or _worktop(source, kind, width_m, looks)
            if item is None:
                return []
            placement = layout.walls.placement(item, run.leg.side, run.leg.at(start_m + item.size_m[1] / 2))
            open_from = max(start_m, run.leg.blind_m[0])
            open_to = min(start_m + item.size_m[1], run.leg.length_m - run.leg.blind_m[1])
            zones = []
            if open_to - open_from > 0.05:
                lo, hi = sorted((run.leg.at(open_from), run.leg.at(open_to)))
                zones = [placement.rect.strip(OPPOSITE[run.leg.side], (lo, hi), 0.0, aisle_m)]
            if layout.walls.hides_window(placement) or not layout.try_put(placement, zones):
                return []
            placed.append(placement)
    return placed if len(plan) == 1 or MIN_TRIANGLE_M <= _triangle_m(placed) <= MAX_TRIANGLE_M else []


def _triangle_m(units: Sequence[Placement]) -> float:
    """Returns the sum of the distances between the middles of the fronts of sink, cooker and fridge."""
    fronts = []
    for unit in units:
        across = {"fridge": 0.0, "cooker": 0.0}.get(unit.item.name)
        for child in unit.item.children:
            across = child.pos_m[1] if child.item.category == "sink" else across
        if across is not None:
            fronts.append(unit.to_world(unit.item.size_m[0] / 2, across))
    return sum(math.dist(a, b) for a, b in itertools.combinations(fronts, 2))


def _worktop(source: FurnitureSource, kind: Kind, width_m: float, looks: dict[str, Look]) -> Item | None:
    """Returns a worktop over cupboards, with a sink, a sink and a hob, or neither."""
    return source.make(
        "counter", "run", width_m=width_m, depth_m=WORKTOP_M[0], height_m=WORKTOP_M[1], looks=looks,
        with_sink=kind in ("sink", "sink_and_hob"), with_hob=kind == "sink_and_hob",
    )  # fmt: skip


def _finish(layout: RoomLayout, source: FurnitureSource, units: Sequence[Placement], looks: dict[str, Look]) -> None:
    """Hangs a hood over the cooker and cabinets over the worktops, and puts small items on these."""
    hood = source.make("appliances", "hood")
    for unit in units:
        hob = next((child.pos_m[1] for child in unit.item.children if child.item.name == "hob"), None)
        across_m = 0.0 if unit.item.name == "cooker" else hob
        if across_m is not None and hood is not None and unit.side is not None:
            x_m, y_m = unit.to_world(0.0, across_m)
            at = y_m if unit.side in ("east", "west") else x_m
            hang_on_wall(layout, source.rng, hood, sides=[unit.side], at=at, bottom_m=HOOD_BOTTOM_M, margin_m=0.0)
    for unit in units:
        if unit.item.category == "counter":
            put_on_top(layout, source, unit, ("objects", "appliances", "objects", "plant"), (0.8, 0.3, 0.5, 0.2))
        if unit.item.size_m[2] < CABINET_BOTTOM_M and unit.item.name != "cooker" and not _has(unit, "hob"):
            _hang_cabinets(layout, source, unit, looks)


def _has(unit: Placement, name: str) -> bool:
    return any(child.item.name == name for child in unit.item.children)


def _hang_cabinets(layout: RoomLayout, source: FurnitureSource, unit: Placement, looks: dict[str, Look]) -> None:
    """Hangs a cabinet above a low unit, a narrower one where the unit's width does not fit."""
    assert unit.side is not None
    lo, hi = unit.rect.span(unit.side)
    for share in (1.0, 0.6, 0.4):
        width_m = round(min(unit.item.size_m[1], 1.8) * share, 2)
        if width_m < 0.3:
            return
        cabinet = source.make(
            "cabinet", "kitchen_wall", width_m=width_m, depth_m=CABINET_M[0], height_m=CABINET_M[1], looks=looks
        )
        if cabinet is None or cabinet.mount != "wall":
            return
        half = cabinet.size_m[1] / 2
        for at in (0.5 * (lo + hi), lo + half, hi - half):
            if hang_on_wall(
                layout, source.rng, cabinet, sides=[unit.side], at=at, bottom_m=CABINET_BOTTOM_M, margin_m=0.0
            ):
                return


def _place_island(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a free-standing counter with stools at one side."""
    for width_m in (None, 1.3):
        item = source.make("counter", "island", width_m=width_m)
        if item is None:
            return None
        front_m, across_m = item.size_m[0] / 2 + 0.4, 0.3 * item.size_m[1]
        seats = [(side * front_m, y, 0.35) for side in (-1.0, 1.0) for y in (-across_m, across_m)]
        island = put_in_middle(layout, source.rng, item, seats, around_m=1.0, apart_m=AISLE_M)
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
