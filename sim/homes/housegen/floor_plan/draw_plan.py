"""Draws one floor plan of a given kind and area."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from sim.homes.housegen.floor_plan.chain_plan import draw_chain
from sim.homes.housegen.floor_plan.draft import Draft, check_draft, finish_draft
from sim.homes.housegen.floor_plan.great_room import draw_great_room
from sim.homes.housegen.floor_plan.plan import FloorPlan, PlanError
from sim.homes.housegen.floor_plan.programme import draw_program
from sim.homes.housegen.floor_plan.public_rooms import add_public_block
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.floor_plan.ring_plan import draw_ring
from sim.homes.housegen.floor_plan.rooms import MAX_ROOMS, MIN_ESTATE_ROOMS, PlanKind
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
        draft, entry = _draw_new_kind(rng, kind, area_m2, required, corridor_m)
    else:
        draft, entry = _draw_rows(rng, kind, area_m2, required, corridor_m)
    _add_loops(rng, draft)
    check_draft(draft, area_m2)
    return finish_draft(rng, draft, kind, entry)


def _draw_new_kind(
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

    def above(s0: float, s1: float, t0: float, t1: float) -> Rect:
        return Rect(s0, corridor_m + t0, s1, corridor_m + t1)

    def below(s0: float, s1: float, t0: float, t1: float) -> Rect:
        return Rect(s0, -t1, s1, -t0)

    gaps = add_row(rng, draft, hall, upper, length_m, corridor_m, above)
    return hall, gaps + add_row(rng, draft, hall, lower, length_m, corridor_m, below)


def _add_branch(
    rng: np.random.Generator, draft: Draft, hall: int, gap: Rect, rows: TwoRows, corridor_m: float, scale: float
) -> None:
    """Adds a wing with a corridor that leaves the main one through `gap` and continues behind the row."""
    left, right = (Row(tuple(row), round(draw_length_m(rng, 3.4, 4.4) * _depth_scale(scale), 1), scale) for row in rows)
    length_m = draw_common_length_m(rng, left, right, corridor_m)
    up = gap.y0 > 0.0
    base, sign = (gap.y1, 1.0) if up else (gap.y0, -1.0)

    def along(s0: float, s1: float) -> tuple[float, float]:
        a, b = base + sign * s0, base + sign * s1
        return min(a, b), max(a, b)

    def on_left(s0: float, s1: float, t0: float, t1: float) -> Rect:
        y0, y1 = along(s0, s1)
        return Rect(gap.x0 - t1, y0, gap.x0 - t0, y1)

    def on_right(s0: float, s1: float, t0: float, t1: float) -> Rect:
        y0, y1 = along(s0, s1)
        return Rect(gap.x1 + t0, y0, gap.x1 + t1, y1)

    y0, y1 = along(0.0, length_m)
    corridor = draft.add("hallway", Rect(gap.x0, min(gap.y0, y0), gap.x1, max(gap.y1, y1)))
    draft.join(hall, corridor, "open")
    add_row(rng, draft, corridor, left, length_m, corridor_m, on_left)
    add_row(rng, draft, corridor, right, length_m, corridor_m, on_right)


def _add_loops(rng: np.random.Generator, draft: Draft) -> None:
    """Adds a few more doors, so that some homes have two routes between rooms."""
    for a in range(len(draft.kinds)):
        for b in range(a + 1, len(draft.kinds)):
            probability = EXTRA_DOORS.get(frozenset((draft.kinds[a], draft.kinds[b])), 0.0)
            if probability and draft.shared_m(a, b) > 1.6 and rng.random() < probability:
                draft.join(a, b, "door")
