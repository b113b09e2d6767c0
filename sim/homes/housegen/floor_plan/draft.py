"""A floor plan while it is drawn: rooms are added one by one, checked at the end, then turned into a `FloorPlan`."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from sim.homes.housegen.floor_plan.plan import FloorPlan, Join, JoinKind, PlanError, Room
from sim.homes.housegen.floor_plan.rectangles import Rect, shared_m
from sim.homes.housegen.floor_plan.rooms import ROOM_RULES, PlanKind

MIN_GAP_M = 0.5
"""Smallest distance between two outer walls that face each other."""


@dataclass
class Draft:
    """Rooms and connections drawn so far."""

    kinds: list[str] = field(default_factory=list)
    rects: list[Rect] = field(default_factory=list)
    joins: list[Join] = field(default_factory=list)

    def add(self, kind: str, rect: Rect) -> int:
        """Adds a room; returns its index."""
        self.kinds.append(kind)
        self.rects.append(rect)
        return len(self.kinds) - 1

    def join(self, a: int, b: int, kind: JoinKind) -> None:
        """Connects two rooms, unless they are connected already."""
        if not any({a, b} == {join.a, join.b} for join in self.joins):
            self.joins.append(Join(a, b, kind))

    def shared_m(self, a: int, b: int) -> float:
        """Returns the length of wall that two rooms share."""
        return shared_m(self.rects[a], self.rects[b])


def check_draft(draft: Draft, area_m2: float) -> None:
    """Raises PlanError if rooms overlap, are too small or too long, or the total area is far from `area_m2`."""
    for i, (kind, rect) in enumerate(zip(draft.kinds, draft.rects, strict=True)):
        rule = ROOM_RULES[kind]
        if (
            rect.short_m < rule.short_m - 0.11
            or rect.long_m < rule.long_m - 0.01
            or rect.area_m2 < 0.9 * rule.area_m2[0]
        ):
            raise PlanError(f"{kind} of {rect.width_m:.1f} x {rect.depth_m:.1f} m is too small")
        if rect.long_m / rect.short_m > 1.15 * rule.aspect:
            raise PlanError(f"{kind} of {rect.width_m:.1f} x {rect.depth_m:.1f} m is too long")
        for other in draft.rects[:i]:
            if rect.overlaps(other, 0.01):
                raise PlanError(f"{kind} overlaps another room")
            if 0.01 < _gap_m(rect, other) < MIN_GAP_M:
                raise PlanError(f"{kind} faces another room at {_gap_m(rect, other):.2f} m")
    total_m2 = sum(rect.area_m2 for rect in draft.rects)
    if not 0.75 * area_m2 < total_m2 < 1.25 * area_m2:
        raise PlanError(f"rooms add up to {total_m2:.0f} m2 instead of {area_m2:.0f} m2")


def _gap_m(a: Rect, b: Rect) -> float:
    """Returns the width of the gap between two rectangles with sides that face each other, else 0."""
    dx, dy = max(a.x0 - b.x1, b.x0 - a.x1), max(a.y0 - b.y1, b.y0 - a.y1)
    return max(dx, dy) if min(dx, dy) < -0.01 else 0.0


def finish_draft(rng: np.random.Generator, draft: Draft, kind: PlanKind, hall: int) -> FloorPlan:
    """Returns the plan of a draft: mirrored and turned at random, its corner at the origin, its rooms named."""
    flip_x, flip_y, swap = (bool(rng.random() < 0.5) for _ in range(3))
    rects = [_turned(rect, flip_x, flip_y, swap) for rect in draft.rects]
    x0, y0 = min(r.x0 for r in rects), min(r.y0 for r in rects)
    counts: dict[str, int] = {}
    rooms = []
    for name, rect in zip(draft.kinds, rects, strict=True):
        number = counts.get(name, 0)
        counts[name] = number + 1
        moved = Rect(*(round(v, 3) for v in (rect.x0 - x0, rect.y0 - y0, rect.x1 - x0, rect.y1 - y0)))
        rooms.append(Room(f"room_{name}_{number:02d}", name, moved))
    return FloorPlan(kind, tuple(rooms), tuple(draft.joins), hall)


def _turned(rect: Rect, flip_x: bool, flip_y: bool, swap: bool) -> Rect:
    """Returns a rectangle mirrored along x or y, and with x and y swapped."""
    if flip_x:
        rect = replace(rect, x0=-rect.x1, x1=-rect.x0)
    if flip_y:
        rect = replace(rect, y0=-rect.y1, y1=-rect.y0)
    return Rect(rect.y0, rect.x0, rect.y1, rect.x1) if swap else rect
