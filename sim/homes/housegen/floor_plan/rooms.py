"""Kinds of rooms with their sizes, and the choice of rooms for a home of a given plan kind and area.

Room sizes follow what European building guides call usual (Neufert, Architects' Data, 4th ed., chapter "Dwellings"):
a single bedroom from 9 m2, a double from 12 m2, bathrooms 3.5-10 m2, corridors 1.1-1.6 m wide.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
        "corridor": (70.0, 270.0),
        "lshape": (95.0, 230.0),
        "openplan": (80.0, 260.0),
        "greatroom": (90.0, 260.0),
        "split": (110.0, 320.0),
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
    grows: bool = True
    """Whether it is larger in large homes."""
    long_m: float = 0.0
    """Smallest length of the longer side."""


ROOM_RULES: Mapping[str, RoomRule] = MappingProxyType(
    {
        "living_room": RoomRule((15.0, 24.0, 60.0), 3.5, 2.0),
        "kitchen": RoomRule((8.0, 13.0, 26.0), 2.4),
        "dining_room": RoomRule((9.0, 14.0, 28.0), 2.7),
        "studio": RoomRule((26.0, 34.0, 48.0), 4.4, 1.8),
        "bedroom": RoomRule((9.5, 14.5, 27.0), 2.7),
        "bathroom": RoomRule((4.2, 6.5, 15.0), 1.75, 2.6, grows=False),
        "office": RoomRule((8.0, 11.5, 22.0), 2.4),
        "gym": RoomRule((13.0, 18.0, 32.0), 3.1),
        "laundry": RoomRule((4.0, 5.5, 13.0), 1.75, 2.6, windows=False, grows=False),
        "closet": RoomRule((3.4, 4.5, 11.0), 1.7, 2.6, windows=False, grows=False),
        "stair_hall": RoomRule((13.1, 15.0, 26.0), 2.75, 2.2, grows=False, long_m=4.75),
        "hallway": RoomRule((2.0, 10.0, 60.0), 1.1, 30.0, windows=False),
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


@dataclass(frozen=True)
class Program:
    """The rooms of a home: public rooms, and groups of columns of private rooms that stay side by side."""

    public: tuple[str, ...]
    private: tuple[tuple[Column, ...], ...]

    @property
    def usual_area_m2(self) -> float:
        """Sum of the usual areas of all its rooms."""
        columns = [column for group in self.private for column in group]
        return sum(ROOM_RULES[kind].area_m2[1] for kind in self.public) + sum(c.usual_area_m2 for c in columns)


def draw_plan_kind(rng: np.random.Generator, area_m2: float) -> PlanKind:
    """Returns a random kind of plan that suits the area."""
    fitting: list[PlanKind] = [kind for kind in PLAN_KINDS if PLAN_AREA_M2[kind][0] <= area_m2 <= PLAN_AREA_M2[kind][1]]
    return fitting[int(rng.integers(len(fitting)))]


def draw_program(rng: np.random.Generator, kind: PlanKind, area_m2: float, required: Sequence[str] = ()) -> Program:
    """Returns the rooms of a home of this plan kind and area; larger homes have more of the rarer rooms.

    The private rooms `required` are added first, to the extent that the area allows.
    """
    if kind == "studio":
        extra = "laundry" if rng.random() < 0.4 else "closet"
        return Program(("studio",), ((Column("bathroom"),), (Column(extra),)))
    public = ["living_room", "kitchen"]
    if area_m2 > 150 or (area_m2 > 80 and rng.random() < 0.6):
        public.append("dining_room")
    rest_m2 = 0.84 * area_m2 - sum(ROOM_RULES[room].area_m2[1] for room in public) * (
        1.25 if kind == "openplan" else 1.0
    )
    groups: list[tuple[Column, ...]] = [(Column("bathroom"),)]
    candidates = [(Column(room),) for room in required] + _candidates(rng, area_m2, required)
    rest_m2 -= 6.5
    rooms = len(public) + 1
    for group in candidates:
        need = sum(column.usual_area_m2 for column in group)
        count = sum(1 + (column.back is not None) for column in group)
        if need <= rest_m2 + 4.0 and rooms + count <= MAX_ROOMS[kind] - HALLWAYS[kind]:
            groups.append(group)
            rest_m2 -= need
            rooms += count
    return Program(tuple(public), tuple(groups))


def _candidates(rng: np.random.Generator, area_m2: float, required: Sequence[str]) -> list[tuple[Column, ...]]:
    """Returns private rooms in the order in which they are added while area is left."""
    ensuite = (Column("bedroom"), Column("closet", "bathroom"))
    beside = (Column("bedroom"), Column("bathroom", "closet"))
    bedroom = (Column("bedroom"),)
    first = ensuite if area_m2 > 85 and rng.random() < 0.6 else bedroom
    second = beside if area_m2 > 130 and rng.random() < 0.5 else bedroom
    rare = [(Column(kind),) for kind in rng.permutation(["office", "gym", "laundry"]).tolist()]
    rooms = [first, rare[0], second, rare[1], bedroom, rare[2]]
    if area_m2 < 105 and rng.random() < 0.5:
        rooms = [first, second, *rare]
    rooms = [group for group in rooms if group[0].front not in required]
    rooms += [ensuite, bedroom, (Column("office"),), beside, (Column("closet"),), bedroom]
    return rooms
