"""Plans of the kind `split`: the public rooms in the middle, a wing of private rooms on the left and on the right."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.homes.housegen.floor_plan.corridor_wing import Wing, add_wing
from sim.homes.housegen.floor_plan.draft import Draft
from sim.homes.housegen.floor_plan.frames import Frame
from sim.homes.housegen.floor_plan.rectangles import Rect, in_steps
from sim.homes.housegen.floor_plan.room_queue import RoomQueue
from sim.homes.housegen.floor_plan.rows import draw_depth_m, with_stairs_m

MAX_CORE_M2 = 88.0
"""Largest floor area of the public rooms."""


def draw_split(
    rng: np.random.Generator, area_m2: float, required: Sequence[str], corridor_m: float, scale: float
) -> tuple[Draft, int]:
    """Returns a draft and the index of the room with the front door, the living room.

    Raises:
        PlanError: the rooms do not fit.
    """
    draft = Draft()
    core_m2 = min(area_m2 * float(rng.uniform(0.34, 0.42)), MAX_CORE_M2)
    width_m = round(float(np.clip((core_m2 * rng.uniform(1.0, 1.3)) ** 0.5, 6.2, 11.0)), 1)
    depth_m = core_m2 / width_m
    living_m = round(max(depth_m * float(rng.uniform(0.52, 0.6)), width_m / 1.95), 1)
    back_m = round(max(depth_m - living_m, 2.8), 1)
    living = draft.add("living_room", Rect(0.0, 0.0, width_m, living_m))
    _add_back_rooms(rng, draft, living, back_m, with_dining=area_m2 > 105.0)
    queue = RoomQueue(rng, area_m2, 0.75 * (area_m2 - core_m2), required)
    for side in ("west", "east"):
        depths_m = (draw_depth_m(rng, 3.3, 3.9, scale), draw_depth_m(rng, 3.3, 3.9, scale))
        if side == "west":
            depths_m = (with_stairs_m(depths_m[0], required), depths_m[1])
        length_m = (area_m2 - sum(r.area_m2 for r in draft.rects)) / (sum(depths_m) + corridor_m)
        length_m = in_steps(length_m * (rng.uniform(0.44, 0.56) if side == "west" else 1.0))
        y_m = round(float(rng.uniform(corridor_m / 2 + 0.15, living_m - corridor_m / 2 - 0.15)), 2)
        frame = Frame(0.0 if side == "west" else width_m, y_m, side)
        wing = Wing(frame=frame, before_m=0.0, length_m=length_m, depths_m=depths_m, corridor_m=corridor_m)
        add_wing(rng, draft, queue, wing, living, scale, join="open" if rng.random() < 0.6 else "door")
    return draft, living


def _add_back_rooms(rng: np.random.Generator, draft: Draft, living: int, depth_m: float, *, with_dining: bool) -> None:
    """Adds the kitchen and the dining room behind the living room."""
    whole = draft.rects[living]
    y0, y1 = whole.y1, whole.y1 + depth_m
    if not with_dining:
        width_m = min(whole.width_m, 5.5)
        draft.join(living, draft.add("kitchen", Rect(0.0, y0, width_m, y1)), "opening")
        return
    cut_m = round(whole.width_m * float(rng.uniform(0.44, 0.56)), 1)
    names = ("kitchen", "dining_room") if rng.random() < 0.5 else ("dining_room", "kitchen")
    rooms = [
        draft.add(name, Rect(x0, y0, x1, y1))
        for name, (x0, x1) in zip(names, ((0.0, cut_m), (cut_m, whole.width_m)), strict=True)
    ]
    for name, room in zip(names, rooms, strict=True):
        draft.join(living, room, "partial" if name == "dining_room" else "opening")
    draft.join(rooms[0], rooms[1], "opening" if rng.random() < 0.7 else "door")
