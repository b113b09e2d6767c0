"""The block of public rooms (living room, kitchen, dining room, studio) at the end of the main wing."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from sim.homes.housegen.floor_plan.draft import Draft
from sim.homes.housegen.floor_plan.plan import JoinKind, PlanError
from sim.homes.housegen.floor_plan.rectangles import Interval, Rect, shared_side
from sim.homes.housegen.floor_plan.rooms import ROOM_RULES, PlanKind

WIDTH_M = (3.6, 7.5)
"""Smallest and largest width of the block along the corridor."""

DIVISIONS = 8
"""Divisions of the block that are drawn until the corridor ends at one that is not the kitchen."""
DOOR_WALL_M = 1.199
"""Smallest length of a common wall, to the middle of the walls at its ends, that has a door."""


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
        area_m2 - sum(rect.area_m2 for rect in draft.rects),
        0.85 * sum(ROOM_RULES[room].area_m2[1] for room in public),
    )
    width_m = float(np.clip(wanted_m2 / depth_m, *WIDTH_M))
    block = Rect(x0, y0, x0 + round(width_m, 1), y1)
    for _ in range(DIVISIONS):
        order = list(public) if len(public) != 3 else ["living_room", "dining_room", "kitchen"]
        if rng.random() < 0.5:
            order.reverse()
        shares = np.array([ROOM_RULES[room].area_m2[1] * rng.uniform(0.85, 1.15) for room in order])
        if kind == "studio" or depth_m / width_m > 1.15 * len(order) / 2 or len(order) < 3:
            rects = _side_by_side(shares, block)
        else:
            rects = _two_deep(order, shares, block)
        doors = [room for room, rect in zip(order, rects, strict=True) if _has_door_to(draft.rects[hall], rect)]
        if doors not in ([], ["kitchen"]):
            break
    else:
        raise PlanError("the corridor ends between two public rooms, or at the kitchen")
    rooms = [draft.add(room, rect) for room, rect in zip(order, rects, strict=True)]
    _join_public(rng, draft, rooms, kind)
    _join_hall(rng, draft, hall, rooms, kind)


def _has_door_to(hall: Rect, room: Rect) -> bool:
    """Returns whether a corridor and a room share enough wall for a door."""
    shared = shared_side(hall, room)
    return shared is not None and shared[1][1] - shared[1][0] >= DOOR_WALL_M


def _side_by_side(shares: np.ndarray, block: Rect) -> list[Rect]:
    """Returns the block divided across its depth in proportion to the shares."""
    edges = block.y0 + np.round(np.cumsum(shares / shares.sum()) * block.depth_m * 20.0) / 20.0
    edges = [block.y0, *edges[:-1].tolist(), block.y1]
    return [Rect(block.x0, a, block.x1, b) for a, b in itertools.pairwise(edges)]


def _two_deep(order: Sequence[str], shares: np.ndarray, block: Rect) -> list[Rect]:
    """Returns three rectangles: the living room across one end of the block, the other two rooms in the rest."""
    living_at = list(order).index("living_room")
    living_m = float(shares[living_at] / shares.sum()) * block.depth_m
    if living_at == 0:
        cut = round((block.y0 + living_m) * 20) / 20
        living, rest = Rect(block.x0, block.y0, block.x1, cut), Rect(block.x0, cut, block.x1, block.y1)
    else:
        cut = round((block.y1 - living_m) * 20) / 20
        living, rest = Rect(block.x0, cut, block.x1, block.y1), Rect(block.x0, block.y0, block.x1, cut)
    first, second = (i for i in range(3) if i != living_at)
    part = float(shares[first] / (shares[first] + shares[second]))
    middle = round((rest.x0 + part * rest.width_m) * 20) / 20
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
        if not _has_door_to(draft.rects[hall], draft.rects[room]):
            continue
        draft.join(hall, room, "opening" if kind in ("openplan", "studio") or rng.random() < 0.5 else "door")
