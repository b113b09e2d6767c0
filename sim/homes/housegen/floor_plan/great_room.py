"""Plans of the kind `greatroom`: several zones of one great room, separated by partial walls, next to a corridor."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from sim.homes.housegen.floor_plan.draft import Draft
from sim.homes.housegen.floor_plan.plan import PlanError
from sim.homes.housegen.floor_plan.rectangles import Rect, divided, in_steps
from sim.homes.housegen.floor_plan.room_queue import RoomQueue, add_private_rows
from sim.homes.housegen.floor_plan.rooms import ROOM_RULES
from sim.homes.housegen.floor_plan.rows import draw_depth_m, with_stairs_m

MIN_SHARED_M = 1.7
"""Shortest wall between two zones that gets an opening."""


def draw_great_room(
    rng: np.random.Generator, area_m2: float, required: Sequence[str], corridor_m: float, scale: float
) -> tuple[Draft, int]:
    """Returns a draft and the index of its corridor.

    Raises:
        PlanError: the rooms do not fit.
    """
    draft = Draft()
    deep_m = (with_stairs_m(draw_depth_m(rng, 3.4, 4.1, scale), required), draw_depth_m(rng, 3.4, 4.1, scale))
    block_m = draw_depth_m(rng, 6.8, 7.8, scale)
    share = float(rng.uniform(0.6, 0.8)) if area_m2 > 100.0 else 1.0
    length_m = in_steps(area_m2 / (corridor_m + deep_m[0] + share * block_m + (1.0 - share) * deep_m[1]))
    great_m = in_steps(share * length_m)
    hall = draft.add("hallway", Rect(0.0, 0.0, length_m, corridor_m))
    zones = _add_zones(rng, draft, Rect(0.0, corridor_m, great_m, corridor_m + block_m))
    _join_zones(rng, draft, hall, zones)
    queue = RoomQueue(rng, area_m2, 0.85 * (length_m * deep_m[0] + (length_m - great_m) * deep_m[1]), required)
    add_private_rows(rng, draft, hall, queue, (great_m, length_m), corridor_m, deep_m, scale)
    return draft, hall


def _add_zones(rng: np.random.Generator, draft: Draft, block: Rect) -> list[int]:
    """Adds the zones of the great room in two rows, the living room at the corridor; returns their indices."""
    extra = int(block.area_m2 > 70.0) + int(block.area_m2 > 100.0)
    more = ["office", "living_room"]
    if extra == 2 and rng.random() < 0.4:
        more.reverse()
    back = ["kitchen", "dining_room"] if extra < 2 else ["kitchen", "dining_room", more[1]]
    front = ["living_room"] if extra < 1 else ["living_room", more[0]]
    weight = [sum(ROOM_RULES[kind].area_m2[1] for kind in row) for row in (front, back)]
    cut = in_steps(block.y0 + block.depth_m * np.clip(weight[0] / sum(weight), 0.52, 0.56))
    zones = []
    for row, (y0, y1) in ((front, (block.y0, cut)), (back, (cut, block.y1))):
        order = [row[i] for i in rng.permutation(len(row))]
        sizes = np.array([ROOM_RULES[kind].area_m2[1] ** 0.7 * rng.uniform(0.95, 1.05) for kind in order])
        spans = divided((block.x0, block.x1), sizes)
        zones += [draft.add(kind, Rect(x0, y0, x1, y1)) for kind, (x0, x1) in zip(order, spans, strict=True)]
    return zones


def _join_zones(rng: np.random.Generator, draft: Draft, hall: int, zones: Sequence[int]) -> None:
    """Connects neighbouring zones by partial walls, and one or two of them with the corridor."""
    for a, b in itertools.combinations(zones, 2):
        if draft.shared_m(a, b) > MIN_SHARED_M:
            draft.join(a, b, "partial")
    beside = [zone for zone in zones if draft.shared_m(hall, zone) > MIN_SHARED_M]
    if not beside:
        raise PlanError("the corridor touches no zone of the great room")
    for zone in beside:
        draft.join(hall, zone, "partial" if rng.random() < 0.6 else "opening")
