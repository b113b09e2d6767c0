"""Draws one floor plan of a given kind and area."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sim.homes.housegen.floor_plan.chain_plan import draw_chain
from sim.homes.housegen.floor_plan.draft import Draft, check_draft, finish_draft
from sim.homes.housegen.floor_plan.frames import Frame
from sim.homes.housegen.floor_plan.great_room import draw_great_room
from sim.homes.housegen.floor_plan.plan import FloorPlan, JoinKind, PlanError
from sim.homes.housegen.floor_plan.programme import draw_program
from sim.homes.housegen.floor_plan.rectangles import Interval, Rect, divided, in_steps, shared_m
from sim.homes.housegen.floor_plan.ring_plan import draw_ring
from sim.homes.housegen.floor_plan.rooms import MAX_ROOMS, MIN_ESTATE_ROOMS, ROOM_RULES, PlanKind
from sim.homes.housegen.floor_plan.rows import Row, add_row, draw_common_length_m, draw_length_m, with_stairs_m
from sim.homes.housegen.floor_plan.split_plan import draw_split
from sim.homes.housegen.floor_plan.wings import TwoRows, draw_wings
from sim.world.plan_requirements import NEEDED_ROOMS

CORRIDOR_M = ((250.0, (1.4, 1.7)), (120.0, (1.25, 1.5)), (0.0, (1.2, 1.4)))
"""Range of the corridor's width by the smallest floor area: long corridors need room for furniture at their walls."""
EXTRA_DOORS = {
    frozenset(("living_room", "office")): 0.4,
    frozenset(("living_room", "dining_room")): 0.8,
    frozenset(("kitchen", "laundry")): 0.6,
    frozenset(("bedroom", "bathroom")): 0.25,
    frozenset(("kitchen", "dining_room")): 0.8,
}
"""Probability that two neighbouring rooms get a door, by their kinds."""
WIDTH_M = (3.6, 7.5)
"""Smallest and largest width of the block along the corridor."""
DIVISIONS = 8
"""Divisions of the block that are drawn until the corridor ends at one that is not the kitchen."""
DOOR_WALL_M = 1.199
"""Smallest length of a common wall, to the middle of the walls at its ends, that has a door."""


def draw_floor_plan(
    rng: np.random.Generator, kind: PlanKind, area_m2: float, required: Sequence[str] = ()
) -> FloorPlan:
    """Returns a plan of this kind and about this area, with the private rooms `required`.

    Raises:
        PlanError: the drawn rooms do not fit together, or the area is off by more than a quarter.
    """
    low_m, high_m = next(widths for above_m2, widths in CORRIDOR_M if area_m2 >= above_m2)
    corridor_m = draw_length_m(rng, low_m, high_m)
    if kind in ("greatroom", "split", "loop", "estate"):
        draft, entry = _draw_special_kind(rng, kind, area_m2, required, corridor_m)
    else:
        draft, entry = _draw_rows(rng, kind, area_m2, required, corridor_m)
    _add_loops(rng, draft)
    check_draft(draft, area_m2)
    return finish_draft(rng, draft, kind, entry)


def _draw_special_kind(
    rng: np.random.Generator, kind: PlanKind, area_m2: float, required: Sequence[str], corridor_m: float
) -> tuple[Draft, int]:
    """Returns a draft of a kind with rooms outside of the rows along corridors, and the room with the front door.

    Raises:
        PlanError: the rooms do not fit, or a required room, or one that every home needs, is missing.
    """
    scale = float(np.clip(rng.uniform(0.95, 1.1) + (area_m2 - 150.0) / 1000.0, 0.95, 1.35))
    if kind == "greatroom":
        draft, entry = draw_great_room(rng, area_m2, required, corridor_m, scale)
    elif kind == "split":
        draft, entry = draw_split(rng, area_m2, required, corridor_m, scale)
    elif kind == "loop" and rng.random() < (170.0 - area_m2) / 40.0 + 0.5:
        draft, entry = draw_chain(rng, area_m2, required, corridor_m, scale)
    else:
        draft, entry = draw_ring(rng, area_m2, required, corridor_m, scale, estate=kind == "estate")
    missing = Counter(required) | Counter(NEEDED_ROOMS)
    missing.subtract(draft.kinds)
    if lacking := [room for room, count in missing.items() if count > 0]:
        raise PlanError(f"no place for {lacking[0]}")
    fewest = MIN_ESTATE_ROOMS if kind == "estate" else 0
    if not fewest <= len(draft.kinds) <= MAX_ROOMS[kind]:
        raise PlanError(f"{len(draft.kinds)} rooms")
    return draft, entry


def _draw_rows(
    rng: np.random.Generator, kind: PlanKind, area_m2: float, required: Sequence[str], corridor_m: float
) -> tuple[Draft, int]:
    """Returns a draft of a kind with rooms in rows along corridors, and the index of its main corridor.

    Raises:
        PlanError: the rooms do not fit.
    """
    program = draw_program(rng, kind, area_m2, required)
    draft = Draft()
    scale = float(np.clip(0.85 * area_m2 / program.usual_area_m2, 0.85, 1.7))
    public_at_end = kind in ("studio", "flat", "openplan", "large") or (kind == "lshape" and rng.random() < 0.6)
    main, branches = draw_wings(rng, kind, program, public_at_end)
    depths_m = (draw_length_m(rng, 3.5, 4.3) * _depth_scale(scale), draw_length_m(rng, 3.5, 4.3) * _depth_scale(scale))
    depths_m = (with_stairs_m(depths_m[0], required), depths_m[1])
    if kind == "studio":
        depths_m = (draw_length_m(rng, 2.3, 2.9), draw_length_m(rng, 2.0, 2.6))
    upper, lower = (Row(tuple(columns), round(depth, 1), scale) for columns, depth in zip(main, depths_m, strict=True))
    hall, gaps = _add_main_wing(rng, draft, upper, lower, corridor_m)
    for gap, branch in zip(gaps, branches, strict=True):
        _add_branch(rng, draft, hall, gap, branch, corridor_m, scale)
    if public_at_end:
        across_m = (-lower.depth_m if lower.columns else 0.0, corridor_m + (upper.depth_m if upper.columns else 0.0))
        add_public_block(rng, draft, hall, program.public, across_m, area_m2, kind)
    return draft, hall


def _depth_scale(scale: float) -> float:
    """Returns by how much rows are deeper when rooms are larger."""
    return float(np.clip(scale**0.5, 0.9, 1.1))


def _add_main_wing(
    rng: np.random.Generator, draft: Draft, upper: Row, lower: Row, corridor_m: float
) -> tuple[int, list[Rect]]:
    """Adds the main corridor and its two rows; returns the corridor's index and the gaps left for branches."""
    length_m = draw_common_length_m(rng, upper, lower, corridor_m)
    hall = draft.add("hallway", Rect(0.0, 0.0, length_m, corridor_m))
    frame = Frame(0.0, 0.0, "east")
    gaps = add_row(rng, draft, hall, upper, length_m, corridor_m, frame.left(0.0, corridor_m))
    return hall, gaps + add_row(rng, draft, hall, lower, length_m, corridor_m, frame.right())


def _add_branch(
    rng: np.random.Generator, draft: Draft, hall: int, gap: Rect, rows: TwoRows, corridor_m: float, scale: float
) -> None:
    """Adds a wing with a corridor that leaves the main one through `gap` and continues behind the row."""
    left, right = (Row(tuple(row), round(draw_length_m(rng, 3.4, 4.4) * _depth_scale(scale), 1), scale) for row in rows)
    length_m = draw_common_length_m(rng, left, right, corridor_m)
    if gap.y0 > 0.0:
        whole = replace(gap, y1=gap.y1 + length_m)
        to_west, to_east = Frame(gap.x0, gap.y1, "north").left(), Frame(gap.x1, gap.y1, "north").right()
    else:
        whole = replace(gap, y0=gap.y0 - length_m)
        to_west, to_east = Frame(gap.x0, gap.y0, "south").right(), Frame(gap.x1, gap.y0, "south").left()
    corridor = draft.add("hallway", whole)
    draft.join(hall, corridor, "open")
    add_row(rng, draft, corridor, left, length_m, corridor_m, to_west)
    add_row(rng, draft, corridor, right, length_m, corridor_m, to_east)


def _add_loops(rng: np.random.Generator, draft: Draft) -> None:
    """Adds a few more doors, so that some homes have two routes between rooms."""
    for a in range(len(draft.kinds)):
        for b in range(a + 1, len(draft.kinds)):
            probability = EXTRA_DOORS.get(frozenset((draft.kinds[a], draft.kinds[b])), 0.0)
            if probability and draft.shared_m(a, b) > 1.6 and rng.random() < probability:
                draft.join(a, b, "door")


def add_public_block(
    rng: np.random.Generator,
    draft: Draft,
    hall: int,
    public: Sequence[str],
    across_m: Interval,
    area_m2: float,
    kind: PlanKind,
) -> None:
    """Adds the public rooms at the far end of the corridor, across the whole depth of the main wing, `across_m` in y.

    Raises:
        PlanError: the corridor ends between two of them, or at the kitchen.
    """
    x0, (y0, y1) = draft.rects[hall].x1, across_m
    depth_m = y1 - y0
    wanted_m2 = max(
        area_m2 - sum(rect.area_m2 for rect in draft.rects), 0.85 * sum(ROOM_RULES[room].area_m2[1] for room in public)
    )
    width_m = float(np.clip(wanted_m2 / depth_m, *WIDTH_M))
    block = Rect(x0, y0, x0 + round(width_m, 1), y1)
    for _ in range(DIVISIONS):
        order = list(public) if len(public) != 3 else ["living_room", "dining_room", "kitchen"]
        if rng.random() < 0.5:
            order.reverse()
        shares = np.array([ROOM_RULES[room].area_m2[1] * rng.uniform(0.85, 1.15) for room in order])
        if kind == "studio" or depth_m / width_m > 1.15 * len(order) / 2 or len(order) < 3:
            rects = [Rect(block.x0, a, block.x1, b) for a, b in divided((block.y0, block.y1), shares)]
        else:
            rects = _two_deep(order, shares, block)
        doors = [
            room for room, rect in zip(order, rects, strict=True) if shared_m(draft.rects[hall], rect) >= DOOR_WALL_M
        ]
        if doors not in ([], ["kitchen"]):
            break
    else:
        raise PlanError("the corridor ends between two public rooms, or at the kitchen")
    rooms = [draft.add(room, rect) for room, rect in zip(order, rects, strict=True)]
    _join_public(rng, draft, rooms, kind)
    _join_hall(rng, draft, hall, rooms, kind)


def _two_deep(order: Sequence[str], shares: np.ndarray, block: Rect) -> list[Rect]:
    """Returns three rectangles: the living room across one end of the block, the other two rooms in the rest."""
    living_at = list(order).index("living_room")
    living_m = shares[living_at] / shares.sum() * block.depth_m
    if living_at == 0:
        cut = in_steps(block.y0 + living_m)
        living, rest = Rect(block.x0, block.y0, block.x1, cut), Rect(block.x0, cut, block.x1, block.y1)
    else:
        cut = in_steps(block.y1 - living_m)
        living, rest = Rect(block.x0, cut, block.x1, block.y1), Rect(block.x0, block.y0, block.x1, cut)
    first, second = (i for i in range(3) if i != living_at)
    middle = in_steps(rest.x0 + shares[first] / (shares[first] + shares[second]) * rest.width_m)
    rects = {
        living_at: living,
        first: Rect(rest.x0, rest.y0, middle, rest.y1),
        second: Rect(middle, rest.y0, rest.x1, rest.y1),
    }
    return [rects[i] for i in range(3)]


def _join_public(rng: np.random.Generator, draft: Draft, rooms: Sequence[int], kind: PlanKind) -> None:
    """Connects the public rooms with each other."""
    wide: JoinKind = "open" if kind == "openplan" else "opening"
    for a, b in itertools.combinations(rooms, 2):
        if draft.shared_m(a, b) > 1.6:
            # Where three rooms meet, one wall must stay; without it a single post would remain in the middle.
            third = len(rooms) == 3 and "living_room" not in (draft.kinds[a], draft.kinds[b])
            join: JoinKind = "opening" if third and wide == "open" else wide
            draft.join(a, b, join if kind == "openplan" or rng.random() < 0.75 else "door")


def _join_hall(rng: np.random.Generator, draft: Draft, hall: int, rooms: Sequence[int], kind: PlanKind) -> None:
    """Connects the corridor with the public rooms that it touches."""
    for room in rooms:
        if draft.shared_m(hall, room) >= DOOR_WALL_M:
            draft.join(hall, room, "opening" if kind in ("openplan", "studio") or rng.random() < 0.5 else "door")
