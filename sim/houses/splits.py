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


_VAL: tuple[tuple[PlanKind, float, tuple[str, ...]], ...] = (
    ("flat", 95.0, ("gym",)),
    ("corridor", 140.0, ("office",)),
    ("lshape", 150.0, ("gym", "laundry")),
    ("openplan", 130.0, ()),
    ("studio", 62.0, ()),
    ("large", 200.0, ("gym", "laundry", "office")),
    ("flat", 115.0, ("office",)),
    ("openplan", 175.0, ("gym", "closet")),
    ("lshape", 190.0, ("laundry",)),
    ("corridor", 110.0, ("gym",)),
)

SPLITS: Mapping[str, tuple[Recipe, ...]] = MappingProxyType(
    {
        "val": tuple(
            Recipe(f"val_{n:02d}", 10_000 + n, "heldout", kind, area_m2, rooms, movable=_is_movable(n))
            for n, (kind, area_m2, rooms) in enumerate(_VAL)
        ),
    }
)
"""Recipes by split, in the order in which episodes go round the houses."""
