"""Kinds of floor plans and of rooms, with the sizes that are drawn.

The sizes reach to the middle of the walls. They lie within the limits of `sim.world.plan_requirements`, which are
measured between the walls and name their sources.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

PlanKind = Literal["studio", "flat", "corridor", "lshape", "openplan", "greatroom", "split", "loop", "large", "estate"]
PLAN_KINDS: tuple[PlanKind, ...] = (
    "studio", "flat", "corridor", "lshape", "openplan", "greatroom", "split", "loop", "large", "estate",
)  # fmt: skip
"""Kinds of floor plans, smallest first."""

PLAN_AREA_M2: Mapping[PlanKind, tuple[float, float]] = MappingProxyType(
    {
        "studio": (50.0, 68.0),
        "flat": (62.0, 130.0),
        "corridor": (70.0, 155.0),
        "lshape": (95.0, 230.0),
        "openplan": (80.0, 200.0),
        "greatroom": (95.0, 165.0),
        "split": (110.0, 300.0),
        "loop": (90.0, 320.0),
        "large": (180.0, 400.0),
        "estate": (300.0, 800.0),
    }
)
"""Smallest and largest floor area of each kind of plan."""
MAX_ROOMS: Mapping[PlanKind, int] = MappingProxyType(
    {kind: {"loop": 26, "estate": 60}.get(kind, 18) for kind in PLAN_KINDS}
)
"""Largest number of rooms of a kind of plan, including hallways."""
MIN_ESTATE_ROOMS = 18
"""Smallest number of rooms of the kind `estate`, including hallways."""
HALLWAYS: Mapping[PlanKind, int] = MappingProxyType(
    {"studio": 1, "flat": 1, "corridor": 1, "lshape": 2, "openplan": 1, "large": 3}
)
"""Number of hallways that a kind of plan with rooms in rows along corridors may need."""
GAP = "slot"
"""Front of a column through which a branch corridor passes."""


@dataclass(frozen=True)
class RoomRule:
    """Limits on the size of a kind of room."""

    area_m2: tuple[float, float, float]
    """Smallest, usual, largest."""
    short_m: float
    """Smallest length of the shorter side."""
    aspect: float = 2.2
    """Largest ratio of the longer side to the shorter one."""
    windows: bool = True
    """Whether it gets windows."""
    long_m: float = 0.0
    """Smallest length of the longer side."""


ROOM_RULES: Mapping[str, RoomRule] = MappingProxyType(
    {
        "living_room": RoomRule((15.0, 24.0, 56.0), 3.5, 2.0),
        "kitchen": RoomRule((8.0, 12.0, 25.0), 2.4, 2.1),
        "dining_room": RoomRule((9.0, 14.0, 29.0), 2.7, 2.1),
        "studio": RoomRule((26.0, 34.0, 48.0), 4.4, 1.8),
        "bedroom": RoomRule((9.5, 14.5, 24.8), 2.7, 2.1),
        "bathroom": RoomRule((4.2, 5.5, 9.7), 1.75, 2.4),
        "office": RoomRule((8.0, 11.5, 21.5), 2.4, 2.1),
        "gym": RoomRule((13.0, 17.0, 27.0), 3.1, 2.1),
        "laundry": RoomRule((4.0, 5.5, 9.7), 1.75, 2.4, windows=False),
        "closet": RoomRule((3.4, 4.5, 8.7), 1.7, 2.4, windows=False),
        "stair_hall": RoomRule((13.0, 14.0, 17.0), 2.75, 2.1, long_m=4.75),
        "hallway": RoomRule((1.4, 10.0, 60.0), 1.1, 30.0, windows=False),
    }
)
"""Every kind of room; the names appear in `room_<kind>_<nn>`."""


@dataclass(frozen=True)
class Column:
    """A slice of a row of rooms along a corridor: one room, or one room behind another."""

    front: str
    """Kind of the room at the corridor, or `GAP`."""
    back: str | None = None
    """Kind of a room behind it, reached from a neighbouring column."""

    @property
    def usual_area_m2(self) -> float:
        """Sum of the usual areas of its rooms."""
        return sum(ROOM_RULES[kind].area_m2[1] for kind in (self.front, self.back) if kind)


def draw_plan_kind(rng: np.random.Generator, area_m2: float) -> PlanKind:
    """Returns a random kind of plan that suits the area."""
    fitting: list[PlanKind] = [kind for kind in PLAN_KINDS if PLAN_AREA_M2[kind][0] <= area_m2 <= PLAN_AREA_M2[kind][1]]
    return fitting[int(rng.integers(len(fitting)))]
