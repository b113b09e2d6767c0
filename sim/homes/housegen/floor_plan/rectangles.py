"""Axis-aligned rectangles in plan, the shape of rooms, furniture footprints and keep-out zones.

World axes, metres. A side of a rectangle is named after the direction of its outward normal: "east" +x, "north" +y,
"west" -x, "south" -y. Positions along a side are coordinates of the world axis parallel to it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Side = Literal["east", "north", "west", "south"]
SIDES: tuple[Side, ...] = ("east", "north", "west", "south")

OPPOSITE: dict[Side, Side] = {"east": "west", "west": "east", "north": "south", "south": "north"}
INWARD_YAW_RAD: dict[Side, float] = {"east": math.pi, "north": -math.pi / 2, "west": 0.0, "south": math.pi / 2}
"""Heading of an item with its back at a side and its front towards the inside of the rectangle."""

Interval = tuple[float, float]
EPS_M = 1e-6
_STEPS_PER_M = 20.0
"""Walls of a drawn plan are at multiples of 5 cm."""


@dataclass(frozen=True)
class Rect:
    """A rectangle from (x0, y0) to (x1, y1), metres."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def width_m(self) -> float:
        """Extent along x."""
        return self.x1 - self.x0

    @property
    def depth_m(self) -> float:
        """Extent along y."""
        return self.y1 - self.y0

    @property
    def area_m2(self) -> float:
        """The area; 0 for a rectangle with a negative side."""
        return max(self.width_m, 0.0) * max(self.depth_m, 0.0)

    @property
    def short_m(self) -> float:
        """The shorter side."""
        return min(self.width_m, self.depth_m)

    @property
    def long_m(self) -> float:
        """The longer side."""
        return max(self.width_m, self.depth_m)

    @property
    def centre(self) -> tuple[float, float]:
        """The centre (x, y)."""
        return 0.5 * (self.x0 + self.x1), 0.5 * (self.y0 + self.y1)

    def grown(self, margin_m: float) -> Rect:
        """Returns the rectangle with every side moved outwards by `margin_m` (inwards when negative)."""
        return Rect(self.x0 - margin_m, self.y0 - margin_m, self.x1 + margin_m, self.y1 + margin_m)

    def overlaps(self, other: Rect, slack_m: float = EPS_M) -> bool:
        """Returns whether both share more than `slack_m` in x and in y."""
        return (
            min(self.x1, other.x1) - max(self.x0, other.x0) > slack_m
            and min(self.y1, other.y1) - max(self.y0, other.y0) > slack_m
        )

    def contains(self, other: Rect, slack_m: float = EPS_M) -> bool:
        """Returns whether `other` lies inside, up to `slack_m`."""
        return (
            other.x0 >= self.x0 - slack_m
            and other.y0 >= self.y0 - slack_m
            and other.x1 <= self.x1 + slack_m
            and other.y1 <= self.y1 + slack_m
        )

    def distance_to(self, x_m: float, y_m: float) -> float:
        """Returns the distance from a point to the rectangle, 0 inside."""
        return math.hypot(max(self.x0 - x_m, 0.0, x_m - self.x1), max(self.y0 - y_m, 0.0, y_m - self.y1))

    def line(self, side: Side) -> float:
        """Returns the world coordinate of a side: x for east and west, y for north and south."""
        return {"east": self.x1, "north": self.y1, "west": self.x0, "south": self.y0}[side]

    def span(self, side: Side) -> Interval:
        """Returns the interval of a side: in y for east and west, in x for north and south."""
        return (self.y0, self.y1) if side in ("east", "west") else (self.x0, self.x1)

    def across_m(self, side: Side) -> float:
        """Returns the extent from a side to the opposite one."""
        return self.width_m if side in ("east", "west") else self.depth_m

    def strip(self, side: Side, span: Interval, inward_m: float, outward_m: float = 0.0) -> Rect:
        """Returns the rectangle along `span` of a side, from `inward_m` inside to `outward_m` outside."""
        line, sign = self.line(side), outward(side)
        a, b = sorted((line - sign * inward_m, line + sign * outward_m))
        return Rect(a, span[0], b, span[1]) if side in ("east", "west") else Rect(span[0], a, span[1], b)


def outward(side: Side) -> float:
    """Returns the direction of a side's outward normal along its world axis: +1 for east and north, else -1."""
    return 1.0 if side in ("east", "north") else -1.0


def side_point(side: Side, along_m: float, across_m: float) -> tuple[float, float]:
    """Returns the point (x, y) with these coordinates along the world axes parallel and normal to a side."""
    return (across_m, along_m) if side in ("east", "west") else (along_m, across_m)


def frame_around(outer: Rect, hole: Rect) -> list[Rect]:
    """Returns the non-empty rectangles that cover `outer` without `hole`; two of them are as deep as `outer`."""
    west, east = Rect(outer.x0, outer.y0, hole.x0, outer.y1), Rect(hole.x1, outer.y0, outer.x1, outer.y1)
    south, north = Rect(hole.x0, outer.y0, hole.x1, hole.y0), Rect(hole.x0, hole.y1, hole.x1, outer.y1)
    return [rect for rect in (west, east, south, north) if rect.width_m > EPS_M and rect.depth_m > EPS_M]


def shared_side(a: Rect, b: Rect) -> tuple[Side, Interval] | None:
    """Returns the side of `a` on which `b` lies and the interval that both share; None if they do not touch."""
    if max(a.x0, b.x0) - min(a.x1, b.x1) > EPS_M or max(a.y0, b.y0) - min(a.y1, b.y1) > EPS_M:
        return None  # apart
    for side in SIDES:
        if abs(a.line(side) - b.line(OPPOSITE[side])) < EPS_M:
            lo, hi = max(a.span(side)[0], b.span(side)[0]), min(a.span(side)[1], b.span(side)[1])
            if hi - lo > EPS_M:
                return side, (lo, hi)
    return None


def shared_m(a: Rect, b: Rect) -> float:
    """Returns the length of the side that two rectangles share, 0 if they do not touch."""
    shared = shared_side(a, b)
    return shared[1][1] - shared[1][0] if shared else 0.0


def subtract(span: Interval, holes: Sequence[Interval], shortest_m: float = EPS_M) -> list[Interval]:
    """Returns the parts of `span` outside the `holes`, in order, without parts of at most `shortest_m`."""
    pieces, at = [], span[0]
    for lo, hi in sorted(holes):
        if min(lo, span[1]) - at > shortest_m:
            pieces.append((at, min(lo, span[1])))
        at = max(at, hi)
    if span[1] - at > shortest_m:
        pieces.append((at, span[1]))
    return pieces


def in_steps(length_m: float) -> float:
    """Returns a length rounded to 5 cm."""
    return round(float(length_m) * _STEPS_PER_M) / _STEPS_PER_M


def divided(span: Interval, shares: NDArray[np.float64]) -> list[Interval]:
    """Returns the parts of a span, as long as their shares in steps of 5 cm, in order."""
    ends = np.cumsum(shares / shares.sum())[:-1]
    cuts = span[0] + np.round(ends * (span[1] - span[0]) * _STEPS_PER_M) / _STEPS_PER_M
    return list(itertools.pairwise([span[0], *cuts.tolist(), span[1]]))


def rotated_extent(size_x_m: float, size_y_m: float, yaw_rad: float) -> tuple[float, float]:
    """Returns the extents along x and y of a box of these sides turned by `yaw_rad`."""
    c, s = abs(math.cos(yaw_rad)), abs(math.sin(yaw_rad))
    return size_x_m * c + size_y_m * s, size_x_m * s + size_y_m * c


def footprint(x_m: float, y_m: float, size_x_m: float, size_y_m: float, yaw_rad: float) -> Rect:
    """Returns the bounding rectangle of a box of these sides, centred at (x, y) and turned by `yaw_rad`."""
    ex, ey = rotated_extent(size_x_m, size_y_m, yaw_rad)
    return Rect(x_m - ex / 2, y_m - ey / 2, x_m + ex / 2, y_m + ey / 2)
