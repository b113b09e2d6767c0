"""Recipes of the houses of the shipped splits (seed, pool, kind of plan, size), and the version of these splits.

The tables here decide what is generated. `SPLITS` is for val, test, large, hazards and the test splits of the last two:
their houses use the held-out pool. `train_recipe` is for train. The houses of `LISTED` are not shipped as files:
`sim.episodes.house_list` reads and writes their recipes and checksums (`train/houses.json`) and generates them on first
use. Seeds of splits differ.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from sim.homes.housegen.floor_plan.rooms import PLAN_AREA_M2, PlanKind

if TYPE_CHECKING:  # loading a house needs no furniture
    from sim.homes.housegen.furniture.item import Pool
    from sim.homes.housegen.generator import GeneratedHouse, HouseConfig

SPLIT_VERSION = "4.0.0"
"""Version of all shipped splits; results contain it with a hash over houses and episodes. It is increased in

- the last number when a house or an episode changed without an effect on agents (a colour, the layout of a file);
- the middle number when houses or episodes changed so that results can no longer be compared;
- the first number when the format changed so that older code cannot read the files.

A change of the generator, new files of the splits and a new version belong in one commit; the hash shows the difference
if that was forgotten."""
TRAIN_HOUSES = 200
LISTED = ("train", "large-test")
"""Splits that ship as a list of recipes: `train` has many houses, and the houses of `large-test` are nearly as heavy as
those of `val` and `test` together, but are needed once in a project."""
MAX_TRAIN_SEEDS = 1_000
"""Seeds below this belong to train; a seed that gives no house is skipped."""


@dataclass(frozen=True)
class Recipe:
    """The recipe of one shipped house: everything that the generator needs."""

    name: str
    seed: int
    pool: Pool
    kind: PlanKind
    area_m2: float
    rooms: tuple[str, ...] = ()
    movable: bool = False
    """Whether its light furniture can be pushed."""
    storeys: int = 1
    """Number of storeys."""
    hazards: tuple[str, ...] = ()
    """Kinds of hazards placed in it (`sim.homes.housegen.hazards`)."""

    def make(self) -> GeneratedHouse:
        """Returns the generated house; the same bytes of XML every time.

        Raises:
            HouseError: no try within the bound gave a house without a fault.
        """
        from sim.homes.housegen.generator import generate_house

        return generate_house(self.seed, self.config())

    def config(self) -> HouseConfig:
        """Returns the requirements for the generator."""
        from sim.homes.housegen.generator import HouseConfig

        return HouseConfig(
            pool=self.pool,
            kind=self.kind,
            area_m2=self.area_m2,
            rooms=self.rooms,
            name=self.name,
            movable=self.movable,
            storeys=self.storeys,
            hazards=self.hazards,
            exact=False,
        )

    def house_bytes(self) -> bytes:
        """Returns the content of the house's file, which refers to textures in `../textures`.

        Raises:
            HouseError: the seed gives no house.
        """
        from sim.houses.writing import house_text

        return house_text(self.make().spec).encode("utf-8")

    def to_json(self) -> dict[str, object]:
        """Returns the recipe as a JSON object."""
        return {**asdict(self), "rooms": list(self.rooms), "hazards": list(self.hazards)}


def _is_movable(number: int) -> bool:
    """Returns whether a house has furniture that can be pushed: every third house of a split does."""
    return number % 3 == 1


_Shape = tuple[PlanKind, float, tuple[str, ...]]
"""Kind of plan, area in square metres, and required rooms beyond the usual ones."""

_VAL: tuple[_Shape, ...] = (
    ("flat", 98.0, ()),
    ("corridor", 140.0, ("office",)),
    ("lshape", 108.0, ("gym",)),
    ("flat", 64.0, ()),
    ("loop", 170.0, ("gym",)),
    ("corridor", 86.0, ()),
    ("openplan", 92.0, ("office",)),
    ("large", 205.0, ("laundry",)),
    ("lshape", 104.0, ()),
    ("studio", 60.0, ()),
    ("split", 230.0, ("gym", "laundry")),
    ("loop", 118.0, ("gym",)),
    ("flat", 78.0, ()),
    ("lshape", 190.0, ("gym", "office")),
    ("corridor", 112.0, ("gym",)),
    ("greatroom", 100.0, ()),
    ("large", 250.0, ("gym", "office", "laundry")),
    ("corridor", 74.0, ()),
    ("lshape", 106.0, ("laundry",)),
    ("lshape", 215.0, ("gym", "closet")),
    ("flat", 84.0, ()),
    ("split", 160.0, ("gym",)),
    ("corridor", 95.0, ("laundry",)),
    ("flat", 120.0, ("gym",)),
    ("loop", 240.0, ("gym", "office")),
    ("loop", 102.0, ()),
    ("split", 115.0, ()),
    ("flat", 70.0, ()),
    ("large", 185.0, ("gym",)),
    ("corridor", 119.0, ("office", "laundry")),
)

_TEST: tuple[_Shape, ...] = (
    ("corridor", 110.0, ("gym",)),
    ("flat", 72.0, ()),
    ("lshape", 150.0, ("laundry",)),
    ("loop", 104.0, ()),
    ("corridor", 88.0, ()),
    ("split", 175.0, ("gym",)),
    ("flat", 96.0, ("office",)),
    ("openplan", 114.0, ("laundry",)),
    ("large", 235.0, ("gym", "office")),
    ("corridor", 76.0, ()),
    ("flat", 62.0, ()),
    ("lshape", 116.0, ("gym",)),
    ("loop", 210.0, ("gym", "laundry")),
    ("corridor", 98.0, ()),
    ("lshape", 180.0, ("gym", "office")),
    ("flat", 90.0, ()),
    ("corridor", 118.0, ("gym",)),
    ("studio", 66.0, ()),
    ("lshape", 220.0, ("gym", "office")),
    ("loop", 112.0, ("gym",)),
    ("flat", 82.0, ("laundry",)),
    ("corridor", 145.0, ("gym", "laundry")),
    ("split", 245.0, ("gym", "office")),
    ("greatroom", 101.0, ()),
    ("lshape", 106.0, ()),
    ("lshape", 108.0, ("office",)),
    ("large", 250.0, ("gym", "laundry", "closet")),
    ("split", 120.0, ()),
    ("loop", 195.0, ("gym", "closet")),
    ("flat", 80.0, ()),
)

_LARGE: tuple[_Shape, ...] = (
    ("estate", 360.0, ("gym", "office", "laundry")),
    ("estate", 430.0, ("gym", "laundry")),
    ("estate", 440.0, ("stair_hall", "gym", "office", "laundry")),
    ("estate", 500.0, ("gym", "office", "laundry", "closet")),
    ("estate", 310.0, ("laundry",)),
    ("estate", 460.0, ("office", "gym")),
    ("estate", 400.0, ("stair_hall", "office", "laundry")),
    ("estate", 500.0, ("gym", "office", "laundry", "office")),
    ("estate", 340.0, ("gym",)),
    ("estate", 430.0, ("gym", "laundry", "closet")),
    ("estate", 450.0, ("stair_hall", "gym", "laundry")),
    ("estate", 420.0, ("office", "gym")),
    ("estate", 700.0, ("gym", "office", "laundry", "closet")),
    ("estate", 380.0, ("office", "laundry")),
    ("estate", 480.0, ("gym", "office", "laundry")),
    ("estate", 460.0, ("stair_hall", "gym", "office")),
    ("estate", 325.0, ("office",)),
    ("estate", 400.0, ("gym", "office", "laundry", "office")),
    ("estate", 440.0, ("gym", "office", "closet")),
    ("estate", 480.0, ("stair_hall", "gym", "office", "laundry")),
)

_HAZARDS: tuple[_Shape, ...] = (
    ("flat", 95.0, ()),
    ("loop", 150.0, ("gym",)),
    ("corridor", 130.0, ("office",)),
    ("greatroom", 140.0, ()),
    ("split", 170.0, ("gym", "laundry")),
    ("openplan", 110.0, ("office",)),
    ("lshape", 150.0, ("gym",)),
    ("loop", 195.0, ("office", "gym")),
    ("flat", 120.0, ("gym",)),
    ("corridor", 150.0, ("gym", "laundry")),
    ("greatroom", 160.0, ("gym",)),
    ("openplan", 160.0, ("gym",)),
    ("split", 130.0, ("office",)),
    ("lshape", 190.0, ("gym", "office")),
    ("flat", 82.0, ()),
)
HAZARD_KINDS = ("glass", "slab", "overhang", "legs", "scan", "loose", "door")
"""Families of hazards (`sim.homes.housegen.hazards.FAMILIES`) in the houses of the split `hazards`."""


def _heldout(split: str, first_seed: int, shapes: tuple[_Shape, ...]) -> tuple[Recipe, ...]:
    """Returns the recipes of a split of held-out houses."""
    return tuple(
        Recipe(
            f"{split.replace('-', '_')}_{n:02d}",
            first_seed + n,
            "heldout",
            kind,
            area_m2,
            rooms,
            movable=_is_movable(n),
            storeys=2 if "stair_hall" in rooms else 1,
            hazards=HAZARD_KINDS if split in ("hazards", "hazards-test") else (),
        )
        for n, (kind, area_m2, rooms) in enumerate(shapes)
    )


_TRAIN_SMALL: tuple[PlanKind, ...] = (
    "flat", "loop", "openplan", "corridor", "split", "greatroom", "lshape", "loop", "flat", "studio", "corridor",
)  # fmt: skip
_TRAIN_LARGE: tuple[PlanKind, ...] = ("large", "estate", "loop", "large", "split")
_TRAIN_ROOMS: tuple[tuple[str, ...], ...] = (
    ("gym",),
    ("office",),
    (),
    ("gym", "laundry"),
    ("office", "gym"),
    ("laundry",),
    ("gym", "closet"),
    ("office", "laundry"),
    ("gym",),
)
_SMALL_M2, _LARGE_M2 = (60.0, 250.0), (262.0, 400.0)
"""Areas of small and of large train houses, limited to those of their kind of plan."""
_SKEW = 1.8
"""Exponent that gives small homes more often than large ones."""
_ROOMY_M2 = 105.0
"""Smallest area with required rooms: in a smaller home a gym would take the place of the second bedroom."""
_GOLDEN = 0.6180339887
"""The fractional parts of its multiples fill [0, 1) evenly for any number of them (Kronecker sequence)."""


def train_recipe(seed: int) -> Recipe:
    """Returns the recipe of the train house of a seed; every fourth house is larger than 250 m2."""
    large = seed % 4 == 2
    kinds, (smallest, largest) = (_TRAIN_LARGE, _LARGE_M2) if large else (_TRAIN_SMALL, _SMALL_M2)
    kind = kinds[(seed // 4 if large else seed) % len(kinds)]
    low, high = max(smallest, PLAN_AREA_M2[kind][0]), min(largest, PLAN_AREA_M2[kind][1])
    area_m2 = round(low + (high - low) * (seed * _GOLDEN % 1.0) ** (1.0 if large else _SKEW), 0)
    rooms = _TRAIN_ROOMS[seed % len(_TRAIN_ROOMS)] if area_m2 >= _ROOMY_M2 else ()
    return Recipe(f"train_{seed:03d}", seed, "train", kind, area_m2, rooms, movable=_is_movable(seed))


SPLITS: Mapping[str, tuple[Recipe, ...]] = MappingProxyType(
    {
        "val": _heldout("val", 110_000, _VAL),
        "test": _heldout("test", 120_000, _TEST),
        "large": _heldout("large", 130_000, _LARGE),
        "hazards": _heldout("hazards", 140_000, _HAZARDS),
        "large-test": _heldout("large-test", 170_000, _LARGE),
        "hazards-test": _heldout("hazards-test", 160_000, _HAZARDS),
    }
)
"""Recipes of the houses by split, in the order of the episodes, without those of `train_recipe`.

The houses of val and test have 60 to 250 m2, a third of them more than 120 m2. All of `large` have more than 300 m2,
and 5 of them have two storeys. `large-test` and `hazards-test` have the sizes and rooms of `large` and `hazards` with
other seeds."""
