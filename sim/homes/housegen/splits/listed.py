"""Makes the houses of lists (`sim.episodes.house_list`) from their recipes: the entry point `stubborn.houses`."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from typing import Annotated, Literal

import msgspec

from sim.core.reading import Count, Name, convert
from sim.homes.housegen.floor_plan.rooms import PlanKind
from sim.homes.housegen.splits.recipes import Recipe


class _Entry(msgspec.Struct, forbid_unknown_fields=True):
    """The recipe of a house in the file."""

    name: Name
    seed: Count
    pool: Literal["train", "heldout"]
    kind: PlanKind
    area_m2: Annotated[float, msgspec.Meta(gt=0.0, le=10_000.0)]
    rooms: tuple[Name, ...]
    movable: bool
    storeys: Literal[1, 2] = 1
    hazards: tuple[Name, ...] = ()


class GeneratedHouses:
    """The `HouseMaker` of this project's generator."""

    def recipe(self, entry: Mapping[str, object], where: str) -> Recipe:
        """Returns the recipe of a JSON object.

        Raises:
            ConfigError: the object has another form.
        """
        return Recipe(**msgspec.structs.asdict(convert(entry, _Entry, where=where)))

    def versions(self) -> dict[str, str]:
        """Returns the versions of the generator and of the packages on which a generated house depends."""
        from sim.homes.housegen.generator import GENERATOR_VERSION

        packages = ("mujoco", "numpy", "scipy", "opencv-python-headless")
        return {"generator": str(GENERATOR_VERSION), **{name: version(name) for name in packages}}


MAKER = GeneratedHouses()
