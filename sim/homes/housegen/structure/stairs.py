"""A straight flight of stairs along a wall of the stair hall, the stairwell above it, and its railing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sim.homes.housegen.floor_plan import PlanError
from sim.homes.housegen.floor_plan.rectangles import OPPOSITE, Rect, Side, frame_around, outward
from sim.homes.housegen.furnishing.placement import RoomLayout
from sim.homes.housegen.furniture.item import Geom, Item, Look
from sim.homes.housegen.structure.openings import HALF_WALL_M, Opening
from sim.homes.housegen.structure.parts import oriented_box, structure_item

RISER_M, TREAD_M = 0.19, 0.25
"""Largest height of a step, and its depth. The robot's body meets the first riser: it cannot climb."""
WIDTH_M = 0.95
HEADROOM_M = 2.0
"""Free height above the steps: the stairwell begins where the ceiling would be lower."""
LANDING_M = (0.75, 1.1)
"""Smallest and largest depth of the upper floor beyond the last step."""
PASSAGE_M = 0.9
"""Depth of the floor before either end of the stairs on which nothing stands."""
FOOT_M = 0.2
"""Smallest distance of the first step from the wall before it."""
_RAIL_M, _RAIL_HEIGHTS_M = 0.04, (0.14, 0.52, 0.92)
_POST_EVERY_M = 1.1


@dataclass(frozen=True)
class Flight:
    """A flight of stairs in plan."""

    wall: Side
    """Side of the hall along which it lies."""
    up: Side
    """Direction in which it rises."""
    steps: tuple[Rect, ...]
    """The steps from the lowest to the highest; the upper floor is one riser above the last."""
    riser_m: float
    well: Rect
    """The hole in the upper floor; its edge on the side `up` is open, a railing stands on its other free edges."""

    def items(self, rise_m: float, ceiling_m: float, wood: Look, wall: Look) -> list[Item]:
        """Returns the steps, the railing on the upper floor at `rise_m`, and the cut edges of floor and ceiling."""
        steps = [
            oriented_box((r.x0, r.x1, r.y0, r.y1, 0.0, round(n * self.riser_m, 4)), wood)
            for n, r in enumerate(self.steps, 1)
        ]
        rails = [box for line in self._rail_lines() for box in _railing(line, rise_m, wood)]
        return [
            structure_item("stairs", "flight", steps),
            structure_item("railing", "posts", rails),
            structure_item("wall", "well", self._cheeks(rise_m, ceiling_m, wall)),
        ]

    def close_off(self, hall: RoomLayout, *, upper: bool) -> None:
        """Keeps items of the stair hall of one storey off the stairs, the stairwell and the floor before them."""
        low, high = self.steps[0], self.steps[-1]
        flight = Rect(min(low.x0, high.x0), min(low.y0, high.y0), max(low.x1, high.x1), max(low.y1, high.y1))
        taken, side = (self.well.grown(_RAIL_M), self.up) if upper else (flight, OPPOSITE[self.up])
        hall.close_off(taken, taken.strip(side, taken.span(side), 0.0, PASSAGE_M))

    def _rail_lines(self) -> list[Rect]:
        """Returns the thin rectangles of the upper floor on which the railing stands."""
        beside, behind = OPPOSITE[self.wall], OPPOSITE[self.up]
        return [self.well.strip(side, self.well.span(side), 0.0, _RAIL_M) for side in (beside, behind)]

    def _cheeks(self, rise_m: float, ceiling_m: float, look: Look) -> list[Geom]:
        boxes = []
        for rect in frame_around(self.well.grown(0.04), self.well):
            boxes.append(oriented_box((rect.x0, rect.x1, rect.y0, rect.y1, ceiling_m + 0.06, rise_m - 0.1), look))
        strip = self.well.strip(self.wall, self.well.span(self.wall), 0.003, 0.04)  # covers the cut edge of the floor
        boxes.append(oriented_box((strip.x0, strip.x1, strip.y0, strip.y1, ceiling_m, rise_m), look))
        return boxes


def place_flight(hall: Rect, openings: Sequence[Opening], room: int, rise_m: float, ceiling_m: float) -> Flight:
    """Returns a flight along a long wall of the hall without a doorway.

    Args:
        hall: rectangle of the room, to the middle of its walls.
        openings: of both storeys.
        room: index of the hall in the openings.
        rise_m: height of the upper floor.
        ceiling_m: height of the lower ceiling.

    Raises:
        PlanError: it does not fit.
    """
    inner = hall.grown(-HALF_WALL_M)
    along_x = inner.width_m >= inner.depth_m
    doors = {o.side_of(room) for o in openings if room in (o.a, o.b) and o.kind != "window"}
    long_sides: tuple[Side, Side] = ("north", "south") if along_x else ("east", "west")
    walls: list[Side] = [side for side in long_sides if side not in doors]
    count = math.ceil(rise_m / RISER_M)
    run_m = (count - 1) * TREAD_M
    spare_m = inner.long_m - run_m - FOOT_M
    if not walls or spare_m < LANDING_M[0] or inner.short_m < WIDTH_M + 1.2:
        raise PlanError("the stairs do not fit into the stair hall")
    ends: tuple[Side, Side] = ("east", "west") if along_x else ("north", "south")
    up = ends[1] if OPPOSITE[ends[1]] in doors and OPPOSITE[ends[0]] not in doors else ends[0]
    landing_m = min(LANDING_M[1], spare_m)
    strip = inner.strip(walls[0], inner.span(walls[0]), WIDTH_M)
    sign = outward(up)
    top = inner.line(up) - sign * landing_m

    def piece(first: float, last: float) -> Rect:
        lo, hi = sorted((round(top - sign * first, 4), round(top - sign * last, 4)))
        return Rect(lo, strip.y0, hi, strip.y1) if along_x else Rect(strip.x0, lo, strip.x1, hi)

    steps = [piece((count - 1 - n) * TREAD_M, (count - 2 - n) * TREAD_M) for n in range(count - 1)]
    riser_m = rise_m / count
    covered = sum(ceiling_m - n * riser_m >= HEADROOM_M for n in range(1, count))
    well = piece(run_m - covered * TREAD_M, 0.0)
    return Flight(walls[0], up, tuple(steps), riser_m, well)


def _railing(line: Rect, z_m: float, look: Look) -> list[Geom]:
    """Returns posts and rails along a thin rectangle of the upper floor."""
    long_x = line.width_m >= line.depth_m
    count = max(2, 1 + math.ceil(line.long_m / _POST_EVERY_M))
    geoms = []
    for n in range(count):
        share = n / (count - 1)
        at = (line.x0 if long_x else line.y0) + _RAIL_M / 2 + share * (line.long_m - _RAIL_M)
        a, b = at - _RAIL_M / 2, at + _RAIL_M / 2
        box = (a, b, line.y0, line.y1) if long_x else (line.x0, line.x1, a, b)
        geoms.append(oriented_box((*box, z_m, z_m + _RAIL_HEIGHTS_M[-1]), look))
    geoms += [
        oriented_box((line.x0, line.x1, line.y0, line.y1, z_m + height, z_m + height + _RAIL_M), look)
        for height in _RAIL_HEIGHTS_M
    ]
    return geoms
