"""The recipes of the shipped houses: which seed, pool, shape and size each one has.

Val and test houses draw from the held-out pool. Seeds of the splits lie apart, so that no two houses share one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from sim.houses.furniture.item import Pool
from sim.houses.generator import GeneratedHouse, HouseConfig, generate_house
from sim.houses.rooms import PlanKind


@dataclass(frozen=True)
class Recipe:
    """How one shipped house is made."""

    name: str
    seed: int
    pool: Pool
    kind: PlanKind
    area_m2: float
    rooms: tuple[str, ...] = ()
    movable: bool = False
    """Its light furniture can be pushed."""

    def make(self) -> GeneratedHouse:
        """The house; the same bytes of XML every time.

        Raises:
            HouseError: no try within the bound gave a house without a fault.
        """
        config = HouseConfig(
            pool=self.pool, kind=self.kind, area_m2=self.area_m2, rooms=self.rooms, name=self.name, movable=self.movable
        )
        return generate_house(self.seed, config)


def _is_movable(number: int) -> bool:
    """Every third house of val and test has furniture that can be pushed."""
    return number % 3 == 1


_Shape = tuple[PlanKind, float, tuple[str, ...]]
"""Plan kind, area in square metres, and the rooms it must have beside the usual ones."""

_VAL: tuple[_Shape, ...] = (
    ("flat", 95.0, ("gym",)),
    ("corridor", 140.0, ("office",)),
    ("lshape", 130.0, ("gym", "laundry")),
    ("openplan", 130.0, ()),
    ("studio", 55.0, ()),
    ("large", 270.0, ("gym", "laundry", "office")),
    ("flat", 115.0, ("office",)),
    ("openplan", 150.0, ("gym", "closet")),
    ("lshape", 190.0, ("laundry",)),
    ("corridor", 260.0, ("gym",)),
    ("large", 320.0, ("office", "laundry")),
    ("flat", 75.0, ()),
    ("corridor", 150.0, ("office", "gym")),
    ("openplan", 220.0, ("laundry",)),
    ("large", 400.0, ("gym", "office", "laundry", "closet")),
    ("lshape", 120.0, ("gym",)),
    ("flat", 128.0, ("gym",)),
    ("large", 290.0, ("gym",)),
    ("openplan", 100.0, ("office",)),
    ("corridor", 210.0, ("laundry",)),
)

_TEST: tuple[_Shape, ...] = (
    ("lshape", 110.0, ("gym",)),
    ("flat", 125.0, ("office",)),
    ("corridor", 155.0, ("gym",)),
    ("large", 300.0, ("gym", "office")),
    ("openplan", 145.0, ("laundry",)),
    ("flat", 65.0, ()),
    ("corridor", 265.0, ("office", "gym")),
    ("studio", 50.0, ()),
    ("lshape", 200.0, ("gym", "office")),
    ("openplan", 185.0, ("closet",)),
    ("large", 360.0, ("gym", "laundry", "office")),
    ("flat", 90.0, ("gym",)),
    ("lshape", 140.0, ("laundry",)),
    ("corridor", 120.0, ()),
    ("openplan", 255.0, ("gym", "laundry")),
    ("flat", 130.0, ("gym", "office")),
    ("large", 390.0, ("gym", "laundry", "closet")),
    ("corridor", 268.0, ("laundry",)),
    ("lshape", 135.0, ("office",)),
    ("openplan", 80.0, ()),
)


def _heldout(split: str, first_seed: int, shapes: tuple[_Shape, ...]) -> tuple[Recipe, ...]:
    """The recipes of a split of held-out houses."""
    return tuple(
        Recipe(f"{split}_{n:02d}", first_seed + n, "heldout", kind, area_m2, rooms, movable=_is_movable(n))
        for n, (kind, area_m2, rooms) in enumerate(shapes)
    )


SPLITS: Mapping[str, tuple[Recipe, ...]] = MappingProxyType(
    {"val": _heldout("val", 10_000, _VAL), "test": _heldout("test", 20_000, _TEST)}
)
"""Recipes by split, in the order in which episodes go round the houses; a quarter of each is above 250 m2."""
