"""Frames in which rows of rooms are drawn: along a corridor and away from it, in any of the four directions."""

from __future__ import annotations

from dataclasses import dataclass

from sim.homes.housegen.floor_plan.rectangles import Rect, Side
from sim.homes.housegen.floor_plan.rows import ToRect


@dataclass(frozen=True)
class Frame:
    """A frame with its origin at (x, y): s runs in the direction of `side`, t to the left of it, in metres."""

    x: float
    y: float
    side: Side

    def rect(self, s0: float, s1: float, t0: float, t1: float) -> Rect:
        """Returns the rectangle between two corners of the frame in the frame of the plan."""
        (ax, ay), (bx, by) = self._point(s0, t0), self._point(s1, t1)
        return Rect(min(ax, bx), min(ay, by), max(ax, bx), max(ay, by))

    def left(self, first_s: float = 0.0, first_t: float = 0.0) -> ToRect:
        """Returns the map for a row to the left that begins at (`first_s`, `first_t`)."""
        return lambda s0, s1, t0, t1: self.rect(first_s + s0, first_s + s1, first_t + t0, first_t + t1)

    def right(self, first_s: float = 0.0, first_t: float = 0.0) -> ToRect:
        """Returns the map for a row to the right that begins at (`first_s`, -`first_t`)."""
        return lambda s0, s1, t0, t1: self.rect(first_s + s0, first_s + s1, -first_t - t1, -first_t - t0)

    def _point(self, s: float, t: float) -> tuple[float, float]:
        if self.side == "east":
            return self.x + s, self.y + t
        if self.side == "north":
            return self.x - t, self.y + s
        if self.side == "west":
            return self.x - s, self.y - t
        return self.x + t, self.y - s
