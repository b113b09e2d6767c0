"""Tests of floor plans: rooms do not overlap, and each is reachable from all others."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from sim.housegen.floor_plan import FloorPlan, PlanError, draw_floor_plan
from sim.housegen.openings import JAMB_M, cut_openings, outer_spans
from sim.housegen.rectangles import SIDES, Rect, shared_side, subtract
from sim.housegen.rooms import MAX_ROOMS, PLAN_AREA_M2, PLAN_KINDS, ROOM_RULES, PlanKind
from tests.helpers.sampling import sample

CASES = [(kind, seed) for kind in PLAN_KINDS for seed in range(20)]


def plan_of(kind: PlanKind, seed: int) -> tuple[FloorPlan, float]:
    rng = np.random.default_rng(seed)
    area_m2 = float(rng.uniform(*PLAN_AREA_M2[kind]))
    for _ in range(60):
        try:
            return draw_floor_plan(rng, kind, area_m2), area_m2
        except PlanError:
            continue
    raise AssertionError(f"no plan for {kind} of {area_m2:.0f} m2")


@pytest.mark.parametrize(("kind", "seed"), sample(CASES, 30))
def test_rooms_do_not_overlap_and_keep_their_sizes(kind: PlanKind, seed: int) -> None:
    plan, area_m2 = plan_of(kind, seed)
    for a, b in itertools.combinations(plan.rooms, 2):
        assert not a.rect.overlaps(b.rect, 0.01), f"{a.name} overlaps {b.name}"
    for room in plan.rooms:
        assert room.rect.short_m >= ROOM_RULES[room.kind].short_m - 0.11
    assert 3 <= len(plan.rooms) <= MAX_ROOMS
    assert plan.area_m2 == pytest.approx(area_m2, rel=0.25)


@pytest.mark.parametrize(("kind", "seed"), sample(CASES, 30))
def test_every_room_is_reachable_from_every_other(kind: PlanKind, seed: int) -> None:
    plan, _ = plan_of(kind, seed)
    reached, todo = {0}, [0]
    while todo:
        room = todo.pop()
        for join in plan.joins:
            if room in (join.a, join.b):
                other = join.a + join.b - room
                if other not in reached:
                    reached.add(other)
                    todo.append(other)
    assert len(reached) == len(plan.rooms)


@pytest.mark.parametrize(("kind", "seed"), sample(CASES, 30))
def test_bathrooms_are_connected_to_hallways_and_private_rooms_only(kind: PlanKind, seed: int) -> None:
    plan, _ = plan_of(kind, seed)
    for join in plan.joins:
        kinds = {plan.rooms[join.a].kind, plan.rooms[join.b].kind}
        if "bathroom" in kinds:
            assert kinds - {"bathroom"} <= {"hallway", "bedroom", "closet", "laundry"}, kinds


@pytest.mark.parametrize(("kind", "seed"), sample(CASES, 30))
def test_doors_are_wide_enough_and_lie_in_the_wall_that_two_rooms_share(kind: PlanKind, seed: int) -> None:
    plan, _ = plan_of(kind, seed)
    try:
        openings = cut_openings(np.random.default_rng(seed), plan)
    except PlanError:
        return  # the generator draws another plan
    for hole in openings:
        if hole.kind == "door":
            assert hole.b is not None
            lo, hi = hole.clear_span()
            assert 0.8 - 1e-6 <= hi - lo <= 1.0 + 1e-6
            shared = shared_side(plan.rooms[hole.a].rect, plan.rooms[hole.b].rect)
            assert shared is not None
            assert shared[0] == hole.side
            assert shared[1][0] <= lo - JAMB_M
            assert hi + JAMB_M <= shared[1][1]


@pytest.mark.parametrize(("kind", "seed"), sample(CASES, 30))
def test_windows_are_in_outer_walls(kind: PlanKind, seed: int) -> None:
    plan, _ = plan_of(kind, seed)
    try:
        openings = cut_openings(np.random.default_rng(seed), plan)
    except PlanError:
        return
    rects = [room.rect for room in plan.rooms]
    for hole in openings:
        if hole.kind in ("window", "entry"):
            spans = outer_spans(rects, hole.a, hole.side)
            assert any(lo <= hole.span[0] and hole.span[1] <= hi for lo, hi in spans)


def test_shared_side_is_symmetric() -> None:
    a, b = Rect(0, 0, 2, 3), Rect(2, 1, 5, 4)
    assert shared_side(a, b) == ("east", (1, 3))
    assert shared_side(b, a) == ("west", (1, 3))
    assert shared_side(a, Rect(2, 3, 5, 4)) is None  # they meet in a corner only


def test_subtract_returns_the_parts_outside_the_holes() -> None:
    assert subtract((0.0, 10.0), [(2.0, 3.0), (8.0, 12.0)]) == [(0.0, 2.0), (3.0, 8.0)]
    assert subtract((0.0, 1.0), [(-1.0, 2.0)]) == []


def test_strips_are_inside_or_outside_of_their_side() -> None:
    rect = Rect(0, 0, 4, 3)
    for side in SIDES:
        span = rect.span(side)
        assert rect.contains(rect.strip(side, span, 0.5))
        assert not rect.overlaps(rect.strip(side, span, 0.0, 0.5))
