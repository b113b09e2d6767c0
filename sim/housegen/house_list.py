"""Houses shipped as a list of recipes and checksums: each is made into a cache when it is first needed.

A split's folder with a `houses.json` holds no house files. A house is generated from its recipe, compared with the
checksum of the list, and kept as `<cache>/<version>/<split>/<house>.xml`, the textures beside its split in
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
from typing import Any

from sim.errors import ConfigError, HouseError
from sim.files import write_atomically
from sim.housegen.split_recipes import Recipe
from sim.paths import assets_dir

LIST_FILE = "houses.json"
CACHE_VARIABLE = "STUBBORN_CACHE_DIR"


@dataclass(frozen=True)
class HouseList:
    """The houses of one split that lie in no file, or not yet."""

    split: str
    version: str
    """Of the split."""
    recipes: Mapping[str, Recipe]
    """By name of the house, in their order."""
    sha256: Mapping[str, str]
    """Of each house's file."""
    made_with: Mapping[str, str]
    """Versions of what the checksums hang on."""

    @property
    def paths(self) -> dict[str, Path]:
        """Where each house lies once it is made."""
        folder = cache_dir() / self.version / self.split
        return {name: folder / f"{name}.xml" for name in self.recipes}

    def fetch(self, name: str) -> Path:
        """The file of a house, made now if it is not there or not what the list says.

        Several processes may fetch the same house at once.

        Raises:
            HouseError: the house comes out different here, or there is no place to keep it.
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
        here = versions_here()
        other = [
            f"{part} {there} there and {here.get(part, 'unknown')} here"
            for part, there in self.made_with.items()
            if here.get(part) != there
        ]
        reason = "; ".join(other) or "the versions agree, so the generator's code or the processor's arithmetic differs"
        return (
            f"House '{name}' of split '{self.split}' {self.version} comes out different from the one in the list: "
            f"sha256 {found} here, {self.sha256[name]} listed. Likely reason: {reason}."
        )


def cache_dir() -> Path:
    """Where houses are kept that were made on this machine."""
    chosen = os.environ.get(CACHE_VARIABLE)
    if chosen:
        return Path(chosen).expanduser()
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "stubborn-objectnav"


def house_bytes(recipe: Recipe) -> bytes:
    """The file of a house, its textures in the folder `../textures`.

    Raises:
        HouseError: the seed gives no house.
    """
    from sim.houses.writing import house_text

    return house_text(recipe.make().spec).encode("utf-8")


def versions_here() -> dict[str, str]:
    """Versions of what a generated house hangs on."""
    from sim.housegen.generator import GENERATOR_VERSION

    return {
        "generator": str(GENERATOR_VERSION),
        **{name: package_version(name) for name in ("mujoco", "numpy", "scipy", "opencv-python-headless")},
    }


def has_house_list(folder: Path) -> bool:
    """Whether a split's folder lists its houses in place of holding them."""
    return (folder / LIST_FILE).is_file()


def read_house_list(folder: Path) -> HouseList:
    """The list in a split's folder.

    Raises:
        ConfigError: it is not what `write_house_list` writes.
    """
    file = folder / LIST_FILE
    try:
        content: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        recipes = [Recipe.from_json(entry) for entry in content["houses"]]
        sha256 = {entry["name"]: str(entry["sha256"]) for entry in content["houses"]}
        return HouseList(
            folder.resolve().name,
            str(content["version"]),
            {recipe.name: recipe for recipe in recipes},
            sha256,
            {str(part): str(there) for part, there in content["made_with"].items()},
        )
    except (AttributeError, KeyError, TypeError, ValueError, OSError) as error:
        raise ConfigError(
            f"House list '{file}' cannot be read: {error!r}. tools/generate_houses.py makes it."
        ) from None


def write_house_list(folder: Path, houses: Sequence[tuple[Recipe, str]], *, version: str) -> None:
    """Write the recipes and checksums of a split's houses; the same content gives the same bytes."""
    lines = [json.dumps(recipe.to_json() | {"sha256": sha256}) for recipe, sha256 in houses]
    head = json.dumps({"version": version, "made_with": versions_here()})
    text = head[:-1] + ', "houses": [\n' + ",\n".join(lines) + "\n]}\n"
    (folder / LIST_FILE).write_text(text, encoding="utf-8")


def copy_textures(folder: Path) -> None:
    """Make a folder of textures like the shipped one; what is there and equal is left alone.

    Raises:
        OSError: it cannot be written.
    """
    for source in sorted((assets_dir() / "textures").iterdir()):
        content, there = source.read_bytes(), folder / source.name
        if not there.is_file() or there.read_bytes() != content:
            write_atomically(there, content)


def _sha256_of(path: Path) -> str | None:
    """Checksum of a file; None where there is none to read."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return None
