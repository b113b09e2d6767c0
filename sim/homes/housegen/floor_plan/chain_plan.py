"""Plans of the kind `loop` with a chain of rooms: corridor, living room, dining room and kitchen lead round a core."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.homes.housegen.floor_plan.draft import Draft
from sim.homes.housegen.floor_plan.frames import Frame
from sim.homes.housegen.floor_plan.rectangles import Rect, in_steps
from sim.homes.housegen.floor_plan.room_queue import RoomQueue, add_private_rows
from sim.homes.housegen.floor_plan.rows import add_row, draw_depth_m, draw_length_m, with_stairs_m

CORE_KINDS = frozenset(("bathroom", "closet", "laundry"))
"""Rooms of the core."""


def draw_chain(
    rng: np.random.Generator, area_m2: float, required: Sequence[str], corridor_m: float, scale: float
) -> tuple[Draft, int]:
    """Returns a draft and the index of its corridor.

    The corridor lies along the south side of the public rooms. The living room reaches from it to the north side of the
    home, the dining room and the kitchen lie behind the core, and a short second corridor leads from the kitchen back.

    Raises:
        PlanError: the rooms do not fit.
    """
    draft = Draft()
    deep_m = (with_stairs_m(draw_depth_m(rng, 3.3, 4.0, scale), required), draw_depth_m(rng, 3.3, 4.0, scale))
    core_m, back_m = draw_length_m(rng, 2.2, 2.7), draw_length_m(rng, 3.1, 3.7)
    living_m = draw_length_m(rng, 3.8, 4.6)
    most_m = living_m + corridor_m + draw_length_m(rng, 4.2, 6.4)
    length_m = area_m2 / (corridor_m + deep_m[0] + core_m + back_m)
    if length_m > most_m + 2.0:
        behind_m2 = area_m2 - most_m * (core_m + back_m)
        length_m = most_m + (behind_m2 - most_m * (corridor_m + deep_m[0])) / (corridor_m + deep_m[0] + deep_m[1])
    if length_m < most_m + 2.0:
        most_m = length_m
    length_m, most_m = in_steps(length_m), in_steps(most_m)
    hall = draft.add("hallway", Rect(0.0, 0.0, length_m, corridor_m))
    at = most_m - corridor_m
    _add_public_rooms(rng, draft, hall, (living_m, at, most_m), (corridor_m, corridor_m + core_m, back_m))
    queue = RoomQueue(rng, area_m2, 0.85 * (length_m * deep_m[0] + (length_m - most_m) * deep_m[1]), required)
    row = queue.fill_row(rng, at - living_m, core_m, 1.0, kinds=CORE_KINDS)
    to_rect = Frame(0.0, 0.0, "east").left(living_m, corridor_m)
    add_row(rng, draft, hall, row, at - living_m, corridor_m, to_rect)
    add_private_rows(rng, draft, hall, queue, (most_m, length_m), corridor_m, deep_m, scale)
    return draft, hall


def _add_public_rooms(
    rng: np.random.Generator, draft: Draft, hall: int, x_m: tuple[float, float, float], y_m: tuple[float, float, float]
) -> None:
    """Adds living room, dining room, kitchen and the second corridor.

    `x_m` are the ends of the living room, the core and the second corridor; `y_m` the ends of the first corridor and of
    the core, and the depth of the rooms behind the core.
    """
    (living_m, core_x, end_x), (low_y, core_y, back_m) = x_m, y_m
    living = draft.add("living_room", Rect(0.0, low_y, living_m, core_y + back_m))
    draft.join(hall, living, "opening" if rng.random() < 0.7 else "door")
    second = draft.add("hallway", Rect(core_x, low_y, end_x, core_y))
    draft.join(hall, second, "open")
    behind = [living]
    if end_x - living_m > 6.0:
        cut = in_steps(living_m + (end_x - living_m) * rng.uniform(0.46, 0.54))
        behind.append(draft.add("dining_room", Rect(living_m, core_y, cut, core_y + back_m)))
        draft.join(living, behind[-1], "partial")
        living_m = cut
    kitchen = draft.add("kitchen", Rect(living_m, core_y, end_x, core_y + back_m))
    draft.join(behind[-1], kitchen, "opening")
    draft.join(kitchen, second, "door")
