"""Tests of floor plans: rooms do not overlap, and each is reachable from all others."""

from __future__ import annotations

import contextlib
import itertools
from collections import Counter

import numpy as np
import pytest
from scipy import ndimage

from sim.homes.housegen.floor_plan import FloorPlan, PlanError, draw_floor_plan
from sim.homes.housegen.floor_plan.rectangles import SIDES, Rect, shared_side, subtract
from sim.homes.housegen.floor_plan.rooms import (
    MAX_ROOMS,
    MIN_ESTATE_ROOMS,
    PLAN_AREA_M2,
    PLAN_KINDS,
    ROOM_RULES,
    PlanKind,
)
from sim.homes.housegen.structure.openings import JAMB_M, cut_openings, outer_spans
from tests.helpers.sampling import sample

CASES = [(kind, seed) for kind in PLAN_KINDS for seed in range(20)]


def plan_of(kind: PlanKind, seed: int) -> tuple[FloorPlan, float]:
    rng = np.random.default_rng(seed)
    area_m2 = float(rng.uniform(*PLAN_AREA_M2[kind]))
    return drawn(rng, kind, area_m2), area_m2


def drawn(rng: np.random.Generator, kind: PlanKind, area_m2: float, wanted: tuple[str, ...] = ()) -> FloorPlan:
    for _ in range(60):
        with contextlib.suppress(PlanError):
            return draw_floor_plan(rng, kind, area_m2, wanted)
    raise AssertionError(f"no plan for {kind} of {area_m2:.0f} m2")


@pytest.mark.parametrize(("kind", "seed"), sample(CASES, 30))
def test_rooms_keep_their_sizes_and_are_all_reachable_without_crossing_bathrooms(kind: PlanKind, seed: int) -> None:
    plan, area_m2 = plan_of(kind, seed)
    for a, b in itertools.combinations(plan.rooms, 2):
        assert not a.rect.overlaps(b.rect, 0.01), f"{a.name} overlaps {b.name}"
    for room in plan.rooms:
        assert room.rect.short_m >= ROOM_RULES[room.kind].short_m - 0.11
    assert 3 <= len(plan.rooms) <= MAX_ROOMS[kind]
    assert plan.area_m2 == pytest.approx(area_m2, rel=0.25)
    reached = {0}
    for _ in plan.rooms:
        reached |= {room for join in plan.joins if reached & {join.a, join.b} for room in (join.a, join.b)}
    assert len(reached) == len(plan.rooms)
    for join in plan.joins:
        kinds = {plan.rooms[join.a].kind, plan.rooms[join.b].kind}
        if "bathroom" in kinds:
            assert kinds - {"bathroom"} <= {"hallway", "bedroom", "closet", "laundry"}, kinds


@pytest.mark.parametrize(("kind", "seed"), sample(CASES, 30))
def test_doors_lie_in_the_wall_that_two_rooms_share_and_windows_in_outer_walls(kind: PlanKind, seed: int) -> None:
    plan, _ = plan_of(kind, seed)
    try:
        openings = cut_openings(np.random.default_rng(seed), plan)
    except PlanError:
        return  # the generator samples another plan
    rects = [room.rect for room in plan.rooms]
    for hole in openings:
        if hole.kind == "door":
            assert hole.b is not None
            lo, hi = hole.clear_span()
            assert 0.8 - 1e-6 <= hi - lo <= 1.0 + 1e-6
            shared = shared_side(rects[hole.a], rects[hole.b])
            assert shared is not None
            assert shared[0] == hole.side
            assert shared[1][0] <= lo - JAMB_M
            assert hi + JAMB_M <= shared[1][1]
        elif hole.kind in ("window", "entry"):
            spans = outer_spans(rects, hole.a, hole.side)
            assert any(lo <= hole.span[0] and hole.span[1] <= hi for lo, hi in spans)


SPECIAL_KINDS: tuple[PlanKind, ...] = ("greatroom", "split", "loop", "estate")
SPECIAL_CASES = [(kind, seed) for kind in SPECIAL_KINDS for seed in range(15)]


def has_long_cycle(plan: FloorPlan, length: int) -> bool:
    """Returns whether a cycle of rooms and doors has at least this many rooms.

    The ends of some door are then still connected without it, but by no path that is shorter.
    """
    neighbours: dict[int, set[int]] = {i: set() for i in range(len(plan.rooms))}
    for join in plan.joins:
        neighbours[join.a].add(join.b)
        neighbours[join.b].add(join.a)
    for join in plan.joins:
        distance, todo = {join.a: 0}, [join.a]
        for room in todo:
            for other in neighbours[room] - distance.keys():
                if {room, other} != {join.a, join.b}:
                    distance[other] = distance[room] + 1
                    todo.append(other)
        if distance.get(join.b, 0) + 1 >= length:
            return True
    return False


@pytest.mark.parametrize("seed", sample(range(15), 5))
@pytest.mark.parametrize("kind", ["loop", "estate"])
def test_loops_lead_round_a_core(kind: PlanKind, seed: int) -> None:
    plan, _ = plan_of(kind, seed)
    assert has_long_cycle(plan, 4), [(plan.rooms[j.a].name, plan.rooms[j.b].name) for j in plan.joins]


@pytest.mark.parametrize("seed", sample(range(15), 5))
def test_great_rooms_have_zones_without_doors_between_partial_walls(seed: int) -> None:
    plan, _ = plan_of("greatroom", seed)
    openings = [o for o in cut_openings(np.random.default_rng(seed), plan) if o.kind == "open"]
    zones = {room for o in openings for room in (o.a, o.b)}
    assert len(zones) >= 3
    for hole in openings:
        assert hole.b is not None
        shared = shared_side(plan.rooms[hole.a].rect, plan.rooms[hole.b].rect)
        assert shared is not None
        assert hole.span[0] - shared[1][0] > 0.3, "no part of the wall is left"
        assert shared[1][1] - hole.span[1] > 0.3, "no part of the wall is left"


@pytest.mark.parametrize("seed", sample(range(15), 5))
def test_the_bedrooms_of_a_split_home_lie_in_two_wings(seed: int) -> None:
    plan, _ = plan_of("split", seed)
    wings = [i for i, room in enumerate(plan.rooms) if room.kind == "hallway"]
    assert len(wings) == 2
    living = next(i for i, room in enumerate(plan.rooms) if room.kind == "living_room")
    for wing in wings:
        assert any({join.a, join.b} == {wing, living} for join in plan.joins)
        assert sum(wing in (join.a, join.b) for join in plan.joins) >= 3


@pytest.mark.parametrize("seed", sample(range(15), 5))
def test_an_estate_has_many_rooms_wings_and_a_stair_hall_that_is_wanted(seed: int) -> None:
    rng = np.random.default_rng(seed)
    plan = drawn(rng, "estate", 300.0 + 33.0 * seed, ("stair_hall", "gym"))
    counts = Counter(room.kind for room in plan.rooms)
    assert len(plan.rooms) >= MIN_ESTATE_ROOMS
    assert counts["hallway"] >= 5, "three sides of the ring and two wings"
    assert min(counts[kind] for kind in ("kitchen", "dining_room", "living_room", "gym", "bathroom")) >= 1
    stairs = plan.stair_hall()
    assert stairs is not None
    rect = plan.rooms[stairs].rect.grown(-0.06)
    assert rect.short_m >= 2.3
    assert rect.long_m >= 4.6
    assert any(stairs in (j.a, j.b) and "hallway" in (plan.rooms[j.a].kind, plan.rooms[j.b].kind) for j in plan.joins)


@pytest.mark.parametrize(("kind", "seed"), sample(SPECIAL_CASES, 20))
def test_front_doors_lead_outside(kind: PlanKind, seed: int) -> None:
    plan, _ = plan_of(kind, seed)
    try:
        openings = cut_openings(np.random.default_rng(seed), plan)
    except PlanError:
        return
    entry = next(o for o in openings if o.kind == "entry")
    x, y = plan.rooms[entry.a].rect.strip(entry.side, entry.span, 0.0, 0.5).centre
    bounds = plan.bounds.grown(1.0)
    inside = np.zeros((int(bounds.depth_m * 4), int(bounds.width_m * 4)), np.bool_)
    for room in plan.rooms:
        r = room.rect
        rows = slice(round((r.y0 - bounds.y0) * 4), round((r.y1 - bounds.y0) * 4))
        inside[rows, round((r.x0 - bounds.x0) * 4) : round((r.x1 - bounds.x0) * 4)] = True
    parts = np.asarray(ndimage.label(~inside)[0])  # type: ignore[index]
    assert parts[int((y - bounds.y0) * 4), int((x - bounds.x0) * 4)] == parts[0, 0], "it leads into a courtyard"


def test_shared_side_is_symmetric() -> None:
    a, b = Rect(0, 0, 2, 3), Rect(2, 1, 5, 4)
    assert shared_side(a, b) == ("east", (1, 3))
    assert shared_side(b, a) == ("west", (1, 3))
    assert shared_side(a, Rect(2, 3, 5, 4)) is None  # they only meet in a corner


def test_subtract_returns_the_parts_outside_the_holes() -> None:
    assert subtract((0.0, 10.0), [(2.0, 3.0), (8.0, 12.0)]) == [(0.0, 2.0), (3.0, 8.0)]
    assert subtract((0.0, 1.0), [(-1.0, 2.0)]) == []


def test_strips_are_inside_or_outside_of_their_side() -> None:
    rect = Rect(0, 0, 4, 3)
    for side in SIDES:
        span = rect.span(side)
        assert rect.contains(rect.strip(side, span, 0.5))
        assert not rect.overlaps(rect.strip(side, span, 0.0, 0.5))
