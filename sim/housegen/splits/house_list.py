"""Reads and writes `houses.json`, the list of a split without house files, and generates its houses into a cache.

The list has the recipe (`sim.housegen.splits.recipes.Recipe`) and the checksum of each house. A house is generated on
first use, compared with its checksum and kept as `<cache>/<version>/<split>/<house>.xml`, with the textures in
`<cache>/<version>/textures`: the same bytes in the same layout as a house that is shipped as a file. The cache is
`$STUBBORN_CACHE_DIR`, else `stubborn-objectnav` in `$XDG_CACHE_HOME`, else in `~/.cache` (XDG Base Directory
Specification 0.8). It may be deleted at any time.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version as package_version
from pathlib import Path
from typing import Annotated, Literal

import msgspec

from sim.errors import ConfigError, HouseError
from sim.files import inside, write_atomically
from sim.housegen.floor_plan.rooms import PlanKind
from sim.housegen.splits.recipes import Recipe
from sim.paths import assets_dir
from sim.reading import Count, Name, read_bytes, read_json, sha256_of

LIST_FILE = "houses.json"
CACHE_VARIABLE = "STUBBORN_CACHE_DIR"


class _Entry(msgspec.Struct, forbid_unknown_fields=True):
    """A house of the file: its recipe and its checksum."""

    name: Name
    seed: Count
    pool: Literal["train", "heldout", "wide"]
    kind: PlanKind
    area_m2: Annotated[float, msgspec.Meta(gt=0.0, le=10_000.0)]
    rooms: tuple[Name, ...]
    movable: bool
    sha256: Annotated[str, msgspec.Meta(pattern=r"^[0-9a-f]{64}\Z")]
    storeys: Literal[1, 2] = 1
    hazards: tuple[Name, ...] = ()


class _List(msgspec.Struct):
    """The file."""

    version: Name
    made_with: dict[str, str]
    houses: list[_Entry]


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
        content = house_bytes(self.recipes[name])
        found = hashlib.sha256(content).hexdigest()
        if found != self.sha256[name]:
            raise HouseError(self._mismatch(name, found))
        try:
            copy_textures(path.parent.parent / "textures")
            write_atomically(path, content)
        except OSError as error:
            raise HouseError(
                f"House '{name}' cannot be kept in '{path.parent}': {error.strerror or error}. "
                f"Set {CACHE_VARIABLE} to a folder that can be written."
            ) from None
        return path

    def _mismatch(self, name: str, found: str) -> str:
        """Returns the message for a house whose checksum differs, with the likely reason."""
        here = versions_here()
        other = [
            f"{part} {there} in the list and {here.get(part, 'unknown')} here"
            for part, there in self.made_with.items()
            if here.get(part) != there
        ]
        reason = "; ".join(other) or "the versions agree, so the generator's code or the processor's arithmetic differs"
        return (
            f"The generated house '{name}' of split '{self.split}' {self.version} differs from the list: "
            f"sha256 {found} here, {self.sha256[name]} in the list. Likely reason: {reason}."
        )


def cache_dir() -> Path:
    """Returns the folder that keeps the houses generated on this machine."""
    chosen = os.environ.get(CACHE_VARIABLE)
    if chosen:
        return Path(chosen).expanduser()
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "stubborn-objectnav"


def house_bytes(recipe: Recipe) -> bytes:
    """Returns the content of the file of a house, which refers to textures in `../textures`.

    Raises:
        HouseError: the seed gives no house.
    """
    from sim.houses.writing import house_text

    return house_text(recipe.make().spec).encode("utf-8")


def versions_here() -> dict[str, str]:
    """Returns the versions of the generator and of the packages on which a generated house depends."""
    from sim.housegen.generator import GENERATOR_VERSION

    return {
        "generator": str(GENERATOR_VERSION),
        **{name: package_version(name) for name in ("mujoco", "numpy", "scipy", "opencv-python-headless")},
    }


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
    recipes = [Recipe.from_json(msgspec.structs.asdict(entry)) for entry in content.houses]
    found = HouseList(
        folder.resolve().name,
        content.version,
        {recipe.name: recipe for recipe in recipes},
        {entry.name: entry.sha256 for entry in content.houses},
        content.made_with,
    )
    if len(found.recipes) < len(recipes):
        raise ConfigError(f"House list '{file}' has two houses of one name; names must differ.")
    try:
        _ = found.paths
    except ConfigError as error:
        raise ConfigError(f"House list '{file}': {error}") from None
    return found


def write_house_list(folder: Path, houses: Sequence[tuple[Recipe, str]], *, version: str) -> None:
    """Writes the recipes and checksums of a split's houses; the same content gives the same bytes."""
    lines = [json.dumps(recipe.to_json() | {"sha256": sha256}) for recipe, sha256 in houses]
    head = json.dumps({"version": version, "made_with": versions_here()})
    text = head[:-1] + ', "houses": [\n' + ",\n".join(lines) + "\n]}\n"
    write_atomically(folder / LIST_FILE, text)


def copy_textures(folder: Path) -> None:
    """Copies the shipped textures into a folder; files that are equal already are not written.

    Raises:
        OSError: the folder cannot be written.
    """
    for source in sorted((assets_dir() / "textures").iterdir()):
        content, there = source.read_bytes(), folder / source.name
        if not there.is_file() or read_bytes(there, what="Texture") != content:
            write_atomically(there, content)


def _sha256_of(path: Path) -> str | None:
    """Returns the checksum of a file; None where it cannot be read."""
    try:
        return sha256_of(path, what="House")
    except ConfigError:
        return None
