"""The upper storey of a home: some rooms of the ground storey again, around the stair hall, for other purposes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim.homes.housegen.floor_plan import FloorPlan, Join, PlanError
from sim.homes.housegen.floor_plan.plan import Room
from sim.homes.housegen.floor_plan.programme import may_add
from sim.homes.housegen.floor_plan.rectangles import Rect, frame_around
from sim.homes.housegen.floor_plan.rooms import ROOM_RULES
from sim.homes.housegen.furnishing import furnish
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import RoomLayout
from sim.homes.housegen.furniture.item import Pool
from sim.homes.housegen.mjcf.builder import HouseBuilder
from sim.homes.housegen.mjcf.placed import Lamp, PlacedItem
from sim.homes.housegen.structure.building import build_structure
from sim.homes.housegen.structure.openings import HALF_WALL_M, OUTER_WALL_M, Opening, cut_openings, plan_rule_faults
from sim.homes.housegen.structure.parts import StructureLooks
from sim.homes.housegen.structure.stairs import Flight, place_flight
from sim.homes.housegen.surfaces.lighting import draw_lamps
from sim.homes.housegen.surfaces.structure_looks import draw_structure_looks

STOREY_GAP_M = 0.25
"""Height from the lower ceiling to the upper floor."""
CEILINGS_M = (2.4, 2.45, 2.5)
"""Heights of ceilings: with more, the flight would be longer than the stair hall."""
ROOMS, AREA_M2 = (5, 10), 140.0
"""Smallest and largest number of rooms, without hallways, and the area at which no more are added."""
UPPER_TRIES = 20
"""Upper plans that are drawn for a ground plan."""
_PUBLIC = ("hallway", "stair_hall")
_PRIVATE = (
    "bedroom",
    "bathroom",
    "bedroom",
    "office",
    "bedroom",
    "closet",
    "gym",
    "bathroom",
    "laundry",
    "living_room",
)
_REPEATED = ("bedroom", "bathroom", "office", "closet")
"""Kinds of rooms of which there may be more than `_PRIVATE` names."""
_NEEDED = Counter({"bedroom": 2, "bathroom": 1})
"""Rooms that an upper storey has at least."""


@dataclass(frozen=True)
class Stairs:
    """The plan of an upper storey, and the stairs that lead to it."""

    lower: FloorPlan
    plan: FloorPlan
    lower_openings: tuple[Opening, ...]
    openings: tuple[Opening, ...]
    ceiling_m: float
    """Height of the ceiling of both storeys above their floors."""
    flight: Flight

    @property
    def floor_z_m(self) -> float:
        """Height of the upper floor."""
        return round(self.ceiling_m + STOREY_GAP_M, 3)


@dataclass(frozen=True)
class UpperStorey:
    """A furnished upper storey. Its items have heights above its own floor, its lamps above the ground."""

    stairs: Stairs
    structure: list[PlacedItem]
    layouts: list[RoomLayout]
    lamps: list[Lamp]

    def add_ground(self, builder: HouseBuilder) -> None:
        """Adds the slabs around the stairwell that carry wheels, and the sites of the rooms."""
        plan, z_m = self.stairs.plan, self.stairs.floor_z_m
        for rect in frame_around(plan.bounds.grown(OUTER_WALL_M), self.stairs.flight.well):
            builder.add_ground(rect, z_m)
        for room in plan.rooms:
            builder.add_room(room.name, room.rect.grown(-HALF_WALL_M), self.stairs.ceiling_m, z_m)


def draw_stairs(rng: np.random.Generator, ground: FloorPlan, openings: Sequence[Opening]) -> Stairs:
    """Returns the plan of an upper storey over a ground storey, and the stairs between.

    Raises:
        PlanError: the stairs do not fit, or there are too few rooms around the stair hall.
    """
    plan, above = _draw_sound_plan(rng, ground, openings)
    ceiling_m = CEILINGS_M[int(rng.integers(len(CEILINGS_M)))]
    hall = ground.stair_hall()
    assert hall is not None
    flight = place_flight(ground.rooms[hall].rect, openings, hall, ceiling_m + STOREY_GAP_M, ceiling_m)
    return Stairs(
        ground,
        plan,
        _without_windows_at(openings, hall, flight),
        _without_windows_at(above, 0, flight),
        ceiling_m,
        flight,
    )


def _draw_sound_plan(
    rng: np.random.Generator, ground: FloorPlan, openings: Sequence[Opening]
) -> tuple[FloorPlan, tuple[Opening, ...]]:
    """Returns an upper plan with its openings that violates no plan rule together with the ground storey.

    Raises:
        PlanError: none of the plans drawn does.
    """
    error = PlanError("no upper storey was drawn")
    for _ in range(UPPER_TRIES):
        try:
            plan, above = draw_upper_plan(rng, ground)
        except PlanError as fault:
            error = fault
            continue
        faults = plan_rule_faults(ground, openings, (plan, above))
        if not faults:
            return plan, above
        error = PlanError(f"upstairs, {faults[0]}")
    raise error


def draw_upper_storey(
    rng: np.random.Generator, stairs: Stairs, pool: Pool, source: FurnitureSource, ground_looks: StructureLooks
) -> UpperStorey:
    """Returns the furnished upper storey.

    Raises:
        FurnishError: a room did not get the furniture that it needs.
    """
    plan, ceiling_m, z_m = stairs.plan, stairs.ceiling_m, stairs.floor_z_m
    looks = draw_structure_looks(rng, plan, pool)
    looks = replace(ground_looks, walls=looks.walls, floors=looks.floors)
    hall = stairs.lower.rooms[stairs.lower.stair_hall() or 0].name
    structure = build_structure(plan, stairs.openings, ceiling_m, looks, floor_hole=stairs.flight.well)
    built = stairs.flight.items(z_m, ceiling_m, ground_looks.door, ground_looks.walls[hall])
    structure += [PlacedItem(item, z_m=-z_m) for item in built]
    layouts = [RoomLayout(i, room.kind, room.rect, stairs.openings, ceiling_m) for i, room in enumerate(plan.rooms)]
    for layout in layouts:
        if layout.kind == "stair_hall":
            stairs.flight.close_off(layout, upper=True)
        furnish(layout, source)
    lamps = _room_lamps(draw_lamps(rng, plan, ceiling_m, ground_looks.time), z_m)
    return UpperStorey(stairs, structure, layouts, lamps)


def draw_upper_plan(rng: np.random.Generator, ground: FloorPlan) -> tuple[FloorPlan, tuple[Opening, ...]]:
    """Returns the plan of the upper storey over a ground plan, and the openings in its walls; room 0 has the stairs.

    Raises:
        PlanError: the ground plan has no stair hall, or too few rooms are around it.
    """
    hall = ground.stair_hall()
    if hall is None:
        raise PlanError("the ground storey has no stair hall")
    chosen = _rooms_around(ground, hall)
    kinds = _draw_kinds(rng, ground, [ground.rooms[i] for i in chosen])
    kept = [(i, kind) for i, kind in zip(chosen, kinds, strict=True) if kind]
    kept = _without_dead_ends(ground, kept)
    index = {i: n for n, (i, _) in enumerate(kept)}
    joins = [_join(ground, join, index) for join in ground.joins if join.a in index and join.b in index]
    rooms = [ground.rooms[i] for i in index]
    plan = FloorPlan(ground.kind, _named(ground, rooms, [kind for _, kind in kept]), tuple(joins), 0)
    if not _all_joined(plan):
        raise PlanError("the rooms of the upper storey are not connected")
    if sum(kind not in _PUBLIC for _, kind in kept) < ROOMS[0]:
        raise PlanError("the upper storey has too few rooms")
    if missing := _NEEDED - Counter(kind for _, kind in kept):
        raise PlanError(f"the upper storey has no place for a {next(iter(missing))}")
    return plan, tuple(opening for opening in cut_openings(rng, plan) if opening.kind != "entry")


def lifted(placed: PlacedItem, z_m: float) -> PlacedItem:
    """Returns an item that is higher by `z_m`."""
    return replace(placed, z_m=round(placed.z_m + z_m, 4)) if z_m else placed


def _room_lamps(lamps: Sequence[Lamp], z_m: float) -> list[Lamp]:
    """Returns the lamps of rooms, higher by `z_m`; daylight is the same for both storeys."""
    return [
        replace(lamp, pos_m=(lamp.pos_m[0], lamp.pos_m[1], round(lamp.pos_m[2] + z_m, 2)))
        for lamp in lamps
        if lamp.direction is None
    ]


def _without_windows_at(openings: Sequence[Opening], room: int, flight: Flight) -> tuple[Opening, ...]:
    """Returns the openings without windows in the wall of the hall along which the stairs rise."""
    return tuple(o for o in openings if not (o.kind == "window" and o.a == room and o.side_of(room) == flight.wall))


def _rooms_around(plan: FloorPlan, hall: int) -> list[int]:
    """Returns the stair hall, the hallways near it and some of the rooms at them, nearest first."""
    chosen, queue = [hall], [hall]
    while queue:
        at = queue.pop(0)
        near = sorted(({join.a, join.b} - {at}).pop() for join in plan.joins if at in (join.a, join.b))
        for room in sorted(set(near) - set(chosen), key=lambda i: plan.rooms[i].kind != "hallway"):
            rooms = [plan.rooms[i] for i in chosen]
            enough = sum(r.kind not in _PUBLIC for r in rooms) >= ROOMS[0]
            full = len(rooms) >= ROOMS[1] or sum(r.rect.area_m2 for r in rooms) > AREA_M2
            too_many = enough or (at != hall and sum(r.kind == "hallway" for r in rooms) > 1)
            if full or (plan.rooms[room].kind == "hallway" and too_many):
                continue
            chosen.append(room)
            queue.append(room)
    return chosen


def _draw_kinds(rng: np.random.Generator, ground: FloorPlan, rooms: Sequence[Room]) -> list[str]:
    """Returns a kind for each room, "" for one that suits none; bedrooms and bathrooms come first."""
    counts = Counter(room.kind for room in ground.rooms)
    private_kinds = list(_PRIVATE)
    kinds = []
    for room in rooms:
        if room.kind in _PUBLIC:
            kinds.append(room.kind)
            continue
        fitting = [kind for kind in private_kinds if _fits(kind, room.rect) and may_add(counts, kind)]
        fitting = fitting or [kind for kind in _REPEATED if _fits(kind, room.rect) and may_add(counts, kind)]
        kind = fitting[int(rng.integers(min(2, len(fitting))))] if fitting else ""
        if kind in private_kinds:
            private_kinds.remove(kind)
        counts[kind] += 1
        kinds.append(kind)
    return kinds


def _fits(kind: str, rect: Rect) -> bool:
    rule = ROOM_RULES[kind]
    return (
        rule.area_m2[0] <= rect.area_m2 <= rule.area_m2[2]
        and rect.short_m >= rule.short_m
        and rect.long_m <= rule.aspect * rect.short_m
    )


def _without_dead_ends(ground: FloorPlan, kept: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """Returns the rooms of the upper storey without hallways that lead nowhere."""
    while True:
        there = {i for i, _ in kept}
        degree = Counter(i for join in ground.joins if {join.a, join.b} <= there for i in (join.a, join.b))
        rest = [(i, kind) for i, kind in kept if kind != "hallway" or degree[i] > 1]
        if len(rest) == len(kept):
            return rest
        kept = rest


def _named(ground: FloorPlan, rooms: Sequence[Room], kinds: Sequence[str]) -> tuple[Room, ...]:
    """Returns the rooms with their new kinds, and names that continue the numbers of the ground storey."""
    count = {kind: sum(room.kind == kind for room in ground.rooms) for kind in kinds}
    named = []
    for room, kind in zip(rooms, kinds, strict=True):
        named.append(Room(f"room_{kind}_{count[kind]:02d}", kind, room.rect))
        count[kind] += 1
    return tuple(named)


def _join(ground: FloorPlan, join: Join, index: dict[int, int]) -> Join:
    """Returns a connection of the upper storey: open between hallways, else a door, wide at the stair hall."""
    public = [ground.rooms[i].kind in _PUBLIC for i in (join.a, join.b)]
    return Join(index[join.a], index[join.b], join.kind if all(public) else "door")


def _all_joined(plan: FloorPlan) -> bool:
    seen, queue = {0}, [0]
    while queue:
        at = queue.pop()
        for join in plan.joins:
            if at in (join.a, join.b):
                queue += [other for other in (join.a, join.b) if other not in seen]
                seen |= {join.a, join.b}
    return len(seen) == len(plan.rooms)
