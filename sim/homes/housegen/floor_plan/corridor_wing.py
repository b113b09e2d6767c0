"""A wing: a corridor that leaves a room in any direction, with a row of rooms on either side and a room at its end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.homes.housegen.floor_plan.draft import Draft
from sim.homes.housegen.floor_plan.frames import Frame
from sim.homes.housegen.floor_plan.plan import JoinKind
from sim.homes.housegen.floor_plan.room_queue import RoomQueue
from sim.homes.housegen.floor_plan.rooms import ROOM_RULES
from sim.homes.housegen.floor_plan.rows import add_row, draw_length_m

END_ROOMS = ("living_room", "gym", "office", "bedroom")
"""Rooms that may lie at the end of a wing."""


@dataclass(frozen=True, kw_only=True)
class Wing:
    """The measures of a wing."""

    frame: Frame
    """Its origin is the middle of the corridor's first edge, s runs along the corridor."""
    before_m: float
    """Length of the corridor before the first room, through a row of other rooms for example."""
    length_m: float
    """Length of its rows."""
    depths_m: tuple[float, float]
    """Depth of the left and the right row."""
    corridor_m: float
    """Width of the corridor."""


def add_wing(
    rng: np.random.Generator,
    draft: Draft,
    queue: RoomQueue,
    wing: Wing,
    owner: int,
    scale: float,
    *,
    join: JoinKind = "open",
    end_room: bool = False,
) -> int:
    """Adds a wing with a corridor that leaves the room `owner`; returns the index of the corridor.

    Raises:
        PlanError: no rooms fit its rows.
    """
    half, whole_m = wing.corridor_m / 2, wing.before_m + wing.length_m
    hall = draft.add("hallway", wing.frame.rect(0.0, whole_m, -half, half))
    draft.join(owner, hall, join)
    maps = wing.frame.left(wing.before_m, half), wing.frame.right(wing.before_m, half)
    for depth_m, to_rect in zip(wing.depths_m, maps, strict=True):
        row = queue.fill_row(rng, wing.length_m, depth_m, scale)
        add_row(rng, draft, hall, row, wing.length_m, wing.corridor_m, to_rect)
    if end_room:
        kind = END_ROOMS[int(rng.integers(len(END_ROOMS)))]
        if not queue.add(kind):
            kind = "bedroom"
        across_m = wing.corridor_m + wing.depths_m[0]
        rule = ROOM_RULES[kind]
        deep_m = min(max(draw_length_m(rng, 3.8, 4.8), across_m / rule.aspect), rule.area_m2[2] / across_m - 0.05)
        room = draft.add(kind, wing.frame.rect(whole_m, whole_m + round(deep_m, 1), -half, half + wing.depths_m[0]))
        draft.join(hall, room, "door")
    return hall
