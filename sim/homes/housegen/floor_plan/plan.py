"""A finished floor plan: rooms, and the pairs of rooms that are connected."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.floor_plan.rooms import PlanKind

JoinKind = Literal["door", "opening", "partial", "open"]
"""A door of 0.8-1.0 m, a wide opening under a lintel, a wall that leaves a wide gap up to the ceiling, or no wall."""


class PlanError(ValueError):
    """An error raised when the rooms drawn do not fit together; another draw may succeed."""


@dataclass(frozen=True)
class Room:
    """A room; `rect` reaches to the middle of its walls."""

    name: str
    """`room_<kind>_<nn>`."""
    kind: str
    rect: Rect


@dataclass(frozen=True)
class Join:
    """A connection between two rooms through which one can walk; indices into `FloorPlan.rooms`."""

    a: int
    b: int
    kind: JoinKind


@dataclass(frozen=True)
class FloorPlan:
    """A floor plan: rooms and their connections."""

    kind: PlanKind
    rooms: tuple[Room, ...]
    joins: tuple[Join, ...]
    entry: int
    """Index of the room that gets the front door if it has an outer wall."""

    @property
    def area_m2(self) -> float:
        """Floor area to the middle of the walls."""
        return sum(room.rect.area_m2 for room in self.rooms)

    @property
    def bounds(self) -> Rect:
        """The rectangle around all rooms."""
        rects = [room.rect for room in self.rooms]
        return Rect(
            min(r.x0 for r in rects), min(r.y0 for r in rects), max(r.x1 for r in rects), max(r.y1 for r in rects)
        )

    def stair_hall(self) -> int | None:
        """Returns the index of the room that is meant for stairs; None without one."""
        return next((i for i, room in enumerate(self.rooms) if room.kind == "stair_hall"), None)
