"""The walls of one room with their openings, and the positions along them at which an item can be placed."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from sim.homes.housegen.floor_plan.rectangles import (
    INWARD_YAW_RAD,
    SIDES,
    Interval,
    Rect,
    Side,
    outward,
    side_point,
    subtract,
)
from sim.homes.housegen.furnishing.placement.records import Placement, floor_placement
from sim.homes.housegen.furniture.item import Item
from sim.homes.housegen.structure.openings import Opening

Along = Literal["any", "middle", "corner", "fitted"]
"""Preferred position along a wall: anywhere, as near its middle as possible, in a corner or at a door, or only in the
corner of the room that touches the right side of the item."""
WALL_GAP_M = 0.016
"""Distance between furniture and wall: room for the baseboard."""
NEVER_BELOW_WINDOWS = frozenset(("fireplace", "tv_monitor"))
"""Categories that stand in front of no window, however low they are."""
BEFORE_WINDOW_M = 0.45
"""An item nearer to a wall than this hides a window in it."""
LOW_M = 0.9
"""Furniture lower than this may stand in front of any window."""
HIGH_SILL_M = 1.4
"""A shower may have a window in the wall at its side if the sill is at least this high."""


class RoomWalls:
    """The four inner wall surfaces of a room, and the openings in them."""

    def __init__(self, inner: Rect) -> None:
        self.inner = inner
        self._openings: dict[Side, list[Opening]] = {side: [] for side in SIDES}

    def add_opening(self, side: Side, opening: Opening) -> None:
        """Adds an opening to a wall."""
        self._openings[side].append(opening)

    def windows(self) -> list[tuple[Side, Opening]]:
        """Returns the room's windows and the sides they are on."""
        return [(side, hole) for side in SIDES for hole in self._openings[side] if hole.kind == "window"]

    def gaps(self, side: Side) -> list[Interval]:
        """Returns the spans of the doors and passages of a side."""
        return [hole.span for hole in self._openings[side] if hole.kind != "window"]

    def free_stretches(self, side: Side) -> list[Interval]:
        """Returns the parts of a side that have no door and no passage."""
        return subtract(self.inner.span(side), self.gaps(side), 0.05)

    def longest_stretch_m(self, side: Side) -> float:
        """Returns the length of the longest part of a side without a door."""
        return max((hi - lo for lo, hi in self.free_stretches(side)), default=0.0)

    def positions(
        self, rng: np.random.Generator, side: Side, width_m: float, along: Along, beside_m: float
    ) -> list[float]:
        """Returns positions along a side for the centre of an item of this width, the best ones first.

        `beside_m` of wall on either side of the item stay free where the wall is long enough.
        """
        if along == "fitted":
            return self._in_corner(side, width_m)
        centre = 0.5 * sum(self.inner.span(side))
        scored: list[tuple[float, float]] = []
        for lo, hi in self.free_stretches(side):
            a, b = lo + width_m / 2 + beside_m, hi - width_m / 2 - beside_m
            if b < a:
                a, b = lo + width_m / 2, hi - width_m / 2
                if b < a:
                    continue
            count = max(1, min(24, int((b - a) / 0.1) + 1))
            for at in np.linspace(a, b, count) if count > 1 else [0.5 * (a + b)]:
                score = {"middle": abs(at - centre), "corner": min(at - lo, hi - at), "any": 0.0}[along]
                scored.append((score + float(rng.uniform(0.0, 0.4 if along != "any" else 1.0)), float(at)))
        return [at for _, at in sorted(scored)]

    def _in_corner(self, side: Side, width_m: float) -> list[float]:
        """Returns the position at which the right side of an item touches the next wall, if no door is there."""
        lo, hi = self.inner.span(side)
        reach_m = WALL_GAP_M + width_m / 2
        at = lo + reach_m if side in ("north", "west") else hi - reach_m
        span = (at - width_m / 2, at + width_m / 2)
        return [at] if any(a <= span[0] and span[1] <= b for a, b in self.free_stretches(side)) else []

    def point(self, side: Side, at: float, inward_m: float) -> tuple[float, float]:
        """Returns the point at a position along a side, `inward_m` into the room."""
        return side_point(side, at, self.inner.line(side) - outward(side) * inward_m)

    def placement(self, item: Item, side: Side, at: float, gap_m: float = WALL_GAP_M) -> Placement:
        """Returns the placement of a floor item with its back to a wall and its centre at a position along it."""
        x, y = self.point(side, at, item.size_m[0] / 2 + gap_m)
        return floor_placement(item, x, y, INWARD_YAW_RAD[side], side)

    def hides_window(self, placement: Placement) -> bool:
        """Returns whether an item would stand in front of a window, or beside it in a corner, and is too high."""
        item, rect = placement.item, placement.rect
        height_m = item.size_m[2]
        if item.category == "counter":  # a tap may stand in front of a window
            height_m = min(height_m, LOW_M)
        elif item.category in NEVER_BELOW_WINDOWS:
            height_m = math.inf
        for side in SIDES:
            near = side == placement.side or abs(rect.line(side) - self.inner.line(side)) < BEFORE_WINDOW_M
            for hole in self._openings[side] if near else ():
                if item.category == "shower" and side != placement.side and hole.bottom_m >= HIGH_SILL_M:
                    continue
                too_high = hole.kind == "window" and height_m > max(hole.bottom_m, LOW_M) + 0.05
                lo, hi = rect.span(side)
                if too_high and hi > hole.span[0] - 0.02 and lo < hole.span[1] + 0.02:
                    return True
        return False

    def has_window(self, side: Side, span: Interval) -> bool:
        """Returns whether a window is in a part of a wall."""
        return any(
            hole.kind == "window" and span[1] > hole.span[0] and span[0] < hole.span[1] for hole in self._openings[side]
        )

    def meets_opening(self, side: Side, span: Interval, bottom_m: float, top_m: float) -> bool:
        """Returns whether a part of a wall overlaps an opening or its frame."""
        return any(
            span[1] > hole.span[0] - 0.09 and span[0] < hole.span[1] + 0.09
            and top_m > hole.bottom_m - 0.06 and bottom_m < hole.top_m + 0.09
            for hole in self._openings[side]
        )  # fmt: skip
