"""The core of a ring of corridors: small rooms back to back, with a cross corridor or a courtyard between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.homes.housegen.floor_plan.draft import Draft
from sim.homes.housegen.floor_plan.frames import Frame
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.floor_plan.room_queue import WITHOUT_DAYLIGHT, RoomQueue
from sim.homes.housegen.floor_plan.rows import add_row, draw_length_m

PAIR_DEPTH_M = 4.4
"""Depth from which a core has two rows of rooms back to back."""


@dataclass(frozen=True)
class Core:
    """The core of a ring: its rectangle and the corridors along its north and south side."""

    rect: Rect
    north: int
    south: int
    corridor_m: float


def add_core(
    rng: np.random.Generator, draft: Draft, queue: RoomQueue, core: Core, scale: float, *, estate: bool
) -> None:
    """Fills the core of a ring with rooms.

    Raises:
        PlanError: no rooms fit.
    """
    middle_m = _middle_width_m(rng, core) if estate else 0.0
    if not middle_m:
        _add_pairs(rng, draft, queue, core, (core.rect.x0, core.rect.x1), scale)
        return
    at = round((core.rect.centre[0] - middle_m / 2 + float(rng.uniform(-0.8, 0.8))) * 20) / 20
    middle = Rect(at, core.rect.y0, round(at + middle_m, 3), core.rect.y1)
    if middle_m <= core.corridor_m:  # else the middle stays open: a courtyard
        hallway = draft.add("hallway", middle)
        draft.join(core.north, hallway, "open")
        draft.join(core.south, hallway, "open")
    for span in ((core.rect.x0, middle.x0), (middle.x1, core.rect.x1)):
        _add_pairs(rng, draft, queue, core, span, scale)


def _middle_width_m(rng: np.random.Generator, core: Core) -> float:
    """Returns the width of a cross corridor or of a courtyard across the whole depth in the middle of the core."""
    if rng.random() < 0.35 or core.rect.width_m < 9.0:
        return core.corridor_m
    return draw_length_m(rng, max(4.2, core.rect.depth_m / 1.6), min(0.6 * core.rect.width_m, 8.0))


def _add_pairs(
    rng: np.random.Generator, draft: Draft, queue: RoomQueue, core: Core, span: tuple[float, float], scale: float
) -> None:
    """Fills a part of the core: rooms at the north and at the south corridor, back to back where it is deep enough."""
    length_m, depth_m = span[1] - span[0], core.rect.depth_m
    south, north = Frame(span[0], core.rect.y0, "east"), Frame(span[1], core.rect.y1, "west")
    if depth_m < PAIR_DEPTH_M:
        frame, hall = (south, core.south) if rng.random() < 0.5 else (north, core.north)
        row = queue.fill_row(rng, length_m, depth_m, scale, kinds=WITHOUT_DAYLIGHT)
        add_row(rng, draft, hall, row, length_m, core.corridor_m, frame.left(0.0, 0.0))
        return
    cut_m = round(depth_m * float(rng.uniform(0.46, 0.54)) * 20) / 20
    for frame, hall, deep_m in ((south, core.south, cut_m), (north, core.north, depth_m - cut_m)):
        row = queue.fill_row(rng, length_m, deep_m, scale, kinds=WITHOUT_DAYLIGHT)
        add_row(rng, draft, hall, row, length_m, core.corridor_m, frame.left(0.0, 0.0))
