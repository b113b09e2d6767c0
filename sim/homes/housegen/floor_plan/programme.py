"""The rooms of a home by its floor area: their numbers, and the columns of rooms that lie side by side."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from sim.homes.housegen.floor_plan.rooms import HALLWAYS, MAX_ROOMS, ROOM_RULES, Column, PlanKind
from sim.world import plan_requirements

Group = tuple[Column, ...]
"""Columns that stay side by side."""

_AREAS_M2 = (50.0, 70.0, 95.0, 130.0, 180.0, 250.0, 350.0, 500.0, 800.0)
_NUMBERS: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {
        "bedroom": (1.0, 1.8, 2.5, 3.1, 3.6, 4.4, 5.6, 7.2, 10.0),
        "bathroom": (1.0, 1.0, 1.4, 2.0, 2.3, 3.0, 4.0, 5.2, 7.5),
        "closet": (0.2, 0.4, 0.7, 1.0, 1.5, 2.3, 3.2, 4.5, 7.0),
        "office": (0.1, 0.3, 0.5, 0.7, 0.9, 1.2, 1.6, 2.2, 3.4),
        "laundry": (0.1, 0.2, 0.4, 0.7, 0.8, 0.9, 1.0, 1.0, 1.0),
        "gym": (0.0, 0.0, 0.1, 0.2, 0.35, 0.6, 0.8, 1.0, 1.0),
    }
)
"""Mean number of private rooms by kind at the floor areas `_AREAS_M2`."""
_PAIRS = (("bathroom", "bathroom"), ("bathroom", "closet"), ("closet", "bathroom"), ("laundry", "bathroom"))
"""Small rooms one behind another (front, back), next to a bedroom that owns the one behind."""
_ALONE = 0.15
"""Probability that no further small rooms lie one behind another."""
_PUBLIC_M2 = 90.0
"""Floor area at which half of the homes have a dining room."""


@dataclass(frozen=True)
class Program:
    """The rooms of a home: public rooms, and groups of columns of private rooms that stay side by side."""

    public: tuple[str, ...]
    private: tuple[Group, ...]

    @property
    def usual_area_m2(self) -> float:
        """Sum of the usual areas of all its rooms."""
        return _usual_m2(self.public) + sum(column.usual_area_m2 for group in self.private for column in group)


def draw_program(rng: np.random.Generator, kind: PlanKind, area_m2: float, required: Sequence[str] = ()) -> Program:
    """Returns the rooms of a home of this plan kind and area, among them the private rooms `required`."""
    if kind == "studio":
        extra = "laundry" if rng.random() < 0.4 else "closet"
        return Program(("studio",), ((Column("bathroom"),), (Column(extra),)))
    public = ["living_room", "kitchen"]
    if (
        "dining_room" in required
        or area_m2 > 1.4 * _PUBLIC_M2
        or rng.random() < 0.5 + (area_m2 - _PUBLIC_M2) / _PUBLIC_M2
    ):
        public.append("dining_room")
    required = [room for room in required if room != "dining_room"]
    private_m2 = 0.84 * area_m2 - _usual_m2(public)
    most = MAX_ROOMS[kind] - HALLWAYS[kind] - len(public)
    counts = draw_numbers(rng, area_m2, private_m2, required, most)
    return Program(tuple(public), tuple(draw_groups(rng, counts)))


def draw_numbers(
    rng: np.random.Generator, area_m2: float, private_m2: float, required: Sequence[str] = (), most: int = 60
) -> Counter[str]:
    """Returns the numbers of private rooms by kind for a home.

    Args:
        rng: source of the numbers.
        area_m2: floor area of the home, which decides how many rooms of a kind are usual.
        private_m2: area of the private rooms; rooms are left out or added until their usual areas add up to about it.
        required: kinds of rooms that the home has at least, as often as they are named.
        most: largest number of rooms.
    """
    least = Counter(required) | Counter(("bedroom", "bathroom"))
    beds = max((number for from_m2, number in plan_requirements.BEDROOMS_FROM_M2 if area_m2 >= from_m2), default=1)
    for kind, more in plan_requirements.MORE_THAN_BEDROOMS.items():
        beds = max(beds, least[kind] - more)
    least["bedroom"] = max(least["bedroom"], beds)
    counts = Counter(least)
    for kind, means in _NUMBERS.items():
        mean = float(np.interp(area_m2, _AREAS_M2, means))
        counts[kind] = max(counts[kind], int(mean + rng.random()))
    while _usual_m2(counts.elements()) > private_m2 + 4.0 or counts.total() > most:
        spare = [kind for kind in _NUMBERS if counts[kind] > least[kind]]
        if not spare:
            break
        others = [kind for kind in spare if kind != "bedroom"]
        counts["bedroom" if not others else others[int(rng.integers(len(others)))]] -= 1
    while counts.total() < most:
        more = [kind for kind in ("bedroom", "office", "closet", "bathroom") if may_add(counts, kind)]
        kind = more[int(rng.integers(len(more)))]
        if _usual_m2(counts.elements()) + ROOM_RULES[kind].area_m2[1] > 0.95 * private_m2:
            break
        counts[kind] += 1
    for kind, more_than_beds in plan_requirements.MORE_THAN_BEDROOMS.items():
        counts[kind] = max(least[kind], min(counts[kind], counts["bedroom"] + more_than_beds))
    return counts


def may_add(counts: Mapping[str, int], kind: str) -> bool:
    """Returns whether a home with these rooms may have a further one of a kind."""
    number, beds = counts.get(kind, 0) + 1, counts.get("bedroom", 0)
    if kind in plan_requirements.MORE_THAN_BEDROOMS:
        return number <= beds + plan_requirements.MORE_THAN_BEDROOMS[kind]
    return number <= plan_requirements.MAX_ROOMS.get(kind, number)


def draw_groups(rng: np.random.Generator, counts: Mapping[str, int]) -> list[Group]:
    """Returns the rooms of a home in groups.

    Small rooms lie one behind another: a bathroom or walk-in closet behind belongs to the bedroom beside it. At least
    one bathroom lies at the corridor.
    """
    rest = Counter(counts)
    groups: list[Group] = []
    while rest["bedroom"] > 0:
        at_hall = any(column.front == "bathroom" for group in groups for column in group)
        fitting = [
            pair
            for pair in _PAIRS
            if Counter(pair) <= rest and (at_hall or pair[0] == "bathroom" or rest["bathroom"] > 1)
        ]
        if not fitting or rng.random() < _ALONE:
            break
        pair = fitting[int(rng.integers(len(fitting)))]
        groups.append((Column("bedroom"), Column(*pair)))
        rest.subtract(("bedroom", *pair))
    return groups + [(Column(kind),) for kind in rest.elements()]


def _usual_m2(kinds: Iterable[str]) -> float:
    """Returns the sum of the usual areas of some rooms."""
    return sum(ROOM_RULES[kind].area_m2[1] for kind in kinds)
