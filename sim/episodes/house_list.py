"""Reads and writes `houses.json`, the list of a split without house files, and has its houses made into a cache.

The list has the recipe and the checksum of each house. The simulator does not know how a house is made: a `HouseMaker`
does, which the entry point `stubborn.houses` of an installed package names. A house is made on first use, compared
with its checksum and kept as `<cache>/<version>/<split>/<house>.xml`, with the textures in
`<cache>/<version>/textures`: the same bytes in the same layout as a house that is shipped as a file.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.metadata
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Protocol

import msgspec

from sim.core.errors import ConfigError, HouseError
from sim.core.files import inside, write_atomically
from sim.core.paths import CACHE_VARIABLE, assets_dir, cache_dir
from sim.core.reading import Name, convert, read_bytes, read_json, sha256_of

LIST_FILE = "houses.json"
MAKER_GROUP = "stubborn.houses"
"""Group of the entry point whose object is a `HouseMaker`."""


class Recipe(Protocol):
    """Everything that is needed to make one house."""

    @property
    def name(self) -> str:
        """Name of the house."""
        ...

    def house_bytes(self) -> bytes:
        """Returns the content of the file of the house, which refers to textures in `../textures`.

        Raises:
            HouseError: the recipe gives no house.
        """
        ...

    def to_json(self) -> dict[str, object]:
        """Returns the recipe as a JSON object with the entry `name`."""
        ...


class HouseMaker(Protocol):
    """Makes houses from recipes."""

    def recipe(self, entry: Mapping[str, object], where: str) -> Recipe:
        """Returns the recipe of a JSON object.

        Raises:
            ConfigError: the object has another form; the message begins with `where`.
        """
        ...

    def versions(self) -> dict[str, str]:
        """Returns the versions of the code and of the packages on which a house depends."""
        ...


class _Entry(msgspec.Struct):
    """The fields that every entry of the file has in addition to its recipe."""

    name: Name
    sha256: Annotated[str, msgspec.Meta(pattern=r"^[0-9a-f]{64}\Z")]


class _List(msgspec.Struct):
    """The file."""

    version: Name
    made_with: dict[str, str]
    houses: list[dict[str, object]]


@dataclass(frozen=True)
class HouseList:
    """The content of a `houses.json`: recipes and checksums of the houses of one split."""

    split: str
    """Name of the split."""
    version: str
    """Version of the split."""
    recipes: Mapping[str, Recipe]
    """Recipes by name of the house, in their order."""
    sha256: Mapping[str, str]
    """Checksum of each house's file."""
    made_with: Mapping[str, str]
    """Versions of the generator and of the packages on which the checksums depend."""

    @property
    def paths(self) -> dict[str, Path]:
        """Path of each house in the cache; the file exists once the house was generated."""
        folder = inside(cache_dir(), self.version, what="version of the list of houses") / self.split
        return {name: inside(folder, f"{name}.xml", what="name of a listed house") for name in self.recipes}

    def fetch(self, name: str) -> Path:
        """Returns the file of a house; it is generated now if it does not exist or differs from the list.

        Several processes may fetch the same house at once.

        Raises:
            HouseError: the generated house differs from the list, or the cache cannot be written.
        """
        path = self.paths[name]
        if _sha256_of(path) == self.sha256[name]:
            return path
        content = self.recipes[name].house_bytes()
        made_sum = hashlib.sha256(content).hexdigest()
        if made_sum != self.sha256[name]:
            raise HouseError(self._mismatch(name, made_sum))
        try:
            copy_textures(path.parent.parent / "textures")
            write_atomically(path, content)
        except OSError as error:
            raise HouseError(
                f"House '{name}' cannot be kept in '{path.parent}': {error.strerror or error}. "
                f"Set {CACHE_VARIABLE} to a folder that can be written."
            ) from None
        return path

    def _mismatch(self, name: str, made_sum: str) -> str:
        """Returns the message for a house whose checksum differs, with the likely reason."""
        here = house_maker().versions()
        other = [
            f"{part} {listed_version} in the list and {here.get(part, 'unknown')} here"
            for part, listed_version in self.made_with.items()
            if here.get(part) != listed_version
        ]
        reason = "; ".join(other) or "the versions agree, so the generator's code or the processor's arithmetic differs"
        return (
            f"The generated house '{name}' of split '{self.split}' {self.version} differs from the list: "
            f"sha256 {made_sum} here, {self.sha256[name]} in the list. Likely reason: {reason}."
        )


@functools.cache
def house_maker() -> HouseMaker:
    """Returns what makes the houses of lists.

    Raises:
        HouseError: no installed package has the entry point.
    """
    for point in importlib.metadata.entry_points(group=MAKER_GROUP):
        return point.load()
    raise HouseError(
        f"No installed package makes houses (entry point '{MAKER_GROUP}'): install this project with "
        "`pip install stubborn-objectnav`, or `pip install -e .` in a clone."
    )


def has_house_list(folder: Path) -> bool:
    """Returns whether the folder of a split contains a `houses.json` instead of house files."""
    return (folder / LIST_FILE).is_file()


def read_house_list(folder: Path) -> HouseList:
    """Returns the house list in the folder of a split.

    Raises:
        ConfigError: the file does not have the form that `write_house_list` writes.
    """
    file = folder / LIST_FILE
    content = read_json(file, _List, what="House list")
    recipes, sums = list[Recipe](), dict[str, str]()
    for number, entry in enumerate(content.houses):
        where = f"House list '{file}', field 'houses[{number}]'"
        listed = convert(entry, _Entry, where=where)
        recipes.append(house_maker().recipe({key: entry[key] for key in entry if key != "sha256"}, where))
        sums[listed.name] = listed.sha256
    house_list = HouseList(
        folder.resolve().name,
        content.version,
        {recipe.name: recipe for recipe in recipes},
        sums,
        content.made_with,
    )
    if len(house_list.recipes) < len(recipes):
        raise ConfigError(f"House list '{file}' has two houses of one name; names must differ.")
    try:
        _ = house_list.paths
    except ConfigError as error:
        raise ConfigError(f"House list '{file}': {error}") from None
    return house_list


def write_house_list(folder: Path, houses: Sequence[tuple[Recipe, str]], *, version: str) -> None:
    """Writes the recipes and checksums of a split's houses; the same content gives the same bytes."""
    lines = [json.dumps(recipe.to_json() | {"sha256": sha256}) for recipe, sha256 in houses]
    head = json.dumps({"version": version, "made_with": house_maker().versions()})
    text = head[:-1] + ', "houses": [\n' + ",\n".join(lines) + "\n]}\n"
    write_atomically(folder / LIST_FILE, text)


def copy_textures(folder: Path) -> None:
    """Copies the shipped textures into a folder; files that are equal already are not written.

    Raises:
        OSError: the folder cannot be written.
    """
    for source in sorted((assets_dir() / "textures").iterdir()):
        content, target = source.read_bytes(), folder / source.name
        if not target.is_file() or read_bytes(target, what="Texture") != content:
            write_atomically(target, content)


def _sha256_of(path: Path) -> str | None:
    """Returns the checksum of a file; None where it cannot be read."""
    try:
        return sha256_of(path, what="House")
    except ConfigError:
        return None
