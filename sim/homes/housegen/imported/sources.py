"""Reads installed models: catalogues of Sweet Home 3D (`.sh3f`), and folders of models with a table.

A source gives entries; nothing is unpacked to the disk. A file name that leads out of its zip or its folder is refused.
"""

from __future__ import annotations

import csv
import math
import posixpath
import re
import tomllib
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any, get_args

import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.reading import convert, open_plain, printable, read_bytes, read_text, reason_of
from sim.homes.housegen.furniture.item import Mount
from sim.homes.housegen.furniture.uses import fault_of_uses
from sim.homes.housegen.imported.labels import Label, Size, label_of, label_of_category

MAX_NUMBER = 1000.0
"""Largest number of an entry, apart from its size."""
MAX_FILE_BYTES = 200_000_000
"""Larger files in a zip are refused: a small zip can hold a very large file."""
SIZE_M = (0.02, 6.0)
"""Allowed lengths of the sides of a model."""
TABLES = ("models.csv", "models.toml")
_PROPERTY = re.compile(r"\s*([\w.]+)#(\d{1,9})\s*[=:]\s*(.*)")
_HEADER = re.compile(r"\s*(license|name)\s*[=:]\s*(.*)")
_COLUMNS = ("file", "category", "width_m", "depth_m", "height_m")


class Skipped(Exception):
    """One model cannot be used; the message is a short reason, which is counted."""


@dataclass(frozen=True)
class Entry:
    """One model of a source."""

    ident: str
    """Unique among all sources; split and file names depend on it."""
    name: str
    file: str
    """Its file in the zip or the folder."""
    origin: str
    """The file that it is from, for people."""
    label: Label
    size_m: Size
    elevation_m: float
    author: str
    licence: str
    read: Callable[[str], bytes] = field(repr=False)
    """Returns the content of a file by its path in the source; raises Skipped."""
    rotation: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))
    """Applied to the model's vertices; then y points up and z points to the front."""


Found = Entry | tuple[str, str]
"""An entry, or the name of a model that is left out with the reason."""


def read_source(folder: Path) -> Iterator[Found]:
    """Yields the models of a folder with `.sh3f` files, or with models and `models.csv` or `models.toml`.

    Raises:
        ConfigError: the folder has neither, or its table cannot be read.
    """
    if not folder.is_dir():
        raise ConfigError(f"--source '{folder}' must be an existing folder.")
    catalogues = sorted(folder.glob("*.sh3f"))
    table = next((folder / name for name in TABLES if (folder / name).is_file()), None)
    if not catalogues and table is None:
        raise ConfigError(f"--source '{folder}' must have a .sh3f file or one of: {', '.join(TABLES)}.")
    for catalogue in catalogues:
        yield from _sweet_home(catalogue)
    if table is not None:
        yield from _folder(folder, table)


# ---- Sweet Home 3D ---------------------------------------------------------------------------------------------------


def _sweet_home(file: Path) -> Iterator[Found]:
    try:
        archive = zipfile.ZipFile(open_plain(file, what="Catalogue"))
        text = _read_zip(archive, "PluginFurnitureCatalog.properties").decode("latin-1")
    except (zipfile.BadZipFile, OSError, ValueError, ConfigError, Skipped) as error:
        yield file.name, f"the file cannot be read ({error})"
        return
    header = {match[1]: match[2] for line in text.splitlines() if (match := _HEADER.fullmatch(line))}
    models: dict[int, dict[str, str]] = {}
    for line in text.splitlines():
        if match := _PROPERTY.fullmatch(line):
            models.setdefault(int(match[2]), {})[match[1]] = _unescaped(match[3].strip())
    for _, properties in sorted(models.items()):
        yield _sweet_home_entry(file, archive, properties, _unescaped(header.get("license", "")))


def _sweet_home_entry(file: Path, archive: zipfile.ZipFile, properties: Mapping[str, str], licence: str) -> Found:
    name = properties.get("name", "?")
    try:
        width, depth, height = (float(properties[key]) / 100.0 for key in ("width", "depth", "height"))
        elevation_m = float(properties.get("elevation", 0.0)) / 100.0
        turn = np.array(properties.get("modelRotation", "1 0 0 0 1 0 0 0 1").split(), dtype=float).reshape(3, 3)
        _finite(elevation_m, *turn.ravel())
        size_m = _allowed((depth, width, height))
        model = properties["model"].lstrip("/")
    except Skipped as reason:
        return name, str(reason)
    except (KeyError, ValueError) as error:
        return name, f"its entry cannot be read ({str(error)[:80]})"
    if properties.get("doorOrWindow") == "true":
        return name, "a door or a window"
    label = label_of(name, properties.get("category", ""), size_m, elevation_m)
    if label is None:
        return name, f"no category for it (group {properties.get('category', '')})"
    return Entry(
        ident=properties.get("id", f"{file.stem}#{model}"), name=name, file=model, origin=f"{file.stem}:{model}",
        label=label, size_m=size_m, elevation_m=elevation_m, author=properties.get("creator", ""),
        licence=properties.get("license", licence), read=lambda path: _read_zip(archive, path), rotation=turn,
    )  # fmt: skip


def _read_zip(archive: zipfile.ZipFile, path: str) -> bytes:
    inside = posixpath.normpath(path.replace("\\", "/"))
    if inside.startswith(("../", "/")) or inside == "..":
        raise Skipped(f"'{path}' leads out of the zip")
    try:
        info = archive.getinfo(inside)
        if info.file_size > MAX_FILE_BYTES:
            raise Skipped(f"'{path}' is larger than {MAX_FILE_BYTES // 1_000_000} MB")
        return archive.read(info)
    except KeyError:
        raise Skipped(f"the zip has no '{inside}'") from None
    except (zipfile.BadZipFile, OSError, RuntimeError, NotImplementedError, EOFError, ValueError) as error:
        raise Skipped(f"'{inside}' is broken ({error})") from None


def _unescaped(text: str) -> str:
    """Returns a value of a properties file, in which characters outside of ASCII are written as \\uXXXX."""
    text = re.sub(r"\\u([0-9a-fA-F]{4})", lambda match: chr(int(match[1], 16)), text)
    return text.encode("utf-16", errors="surrogatepass").decode("utf-16", errors="replace")  # joins pairs of surrogates


# ---- folders with a table --------------------------------------------------------------------------------------------


def _folder(folder: Path, table: Path) -> Iterator[Found]:
    try:
        rows = _rows(table)
    except (OSError, ValueError, csv.Error, RecursionError) as error:
        raise ConfigError(f"The table '{table}' cannot be read: {reason_of(error)}.") from None
    for row in rows:
        yield _row_entry(folder, row)


class _Table(msgspec.Struct):
    """A table in TOML."""

    model: list[dict[str, Any]] = []


def _rows(table: Path) -> list[dict[str, Any]]:
    text = read_text(table, what="The table")
    if table.suffix == ".toml":
        return convert(tomllib.loads(text), _Table, where=f"'{table.name}'").model
    return list(csv.DictReader(text.splitlines()))


def _row_entry(folder: Path, row: Mapping[str, Any]) -> Found:
    file = str(row.get("file") or "?")
    missing = [column for column in _COLUMNS if not row.get(column)]
    if missing:
        return file, f"its row has no {missing[0]}"
    try:
        size_m = _allowed((float(row["depth_m"]), float(row["width_m"]), float(row["height_m"])))
        front = math.radians(float(row.get("front_deg") or 0.0))
        elevation_m = float(row.get("elevation_m") or 0.0)
        _finite(front, elevation_m)
    except Skipped as reason:
        return file, str(reason)
    except (TypeError, ValueError, OverflowError) as error:
        return file, f"its row cannot be read ({str(error)[:80]})"
    mount = row.get("mount") or "floor"
    uses = row.get("uses") or ()
    uses = tuple(uses.split()) if isinstance(uses, str) else tuple(map(str, uses))
    label = label_of_category(str(row["category"]), uses, mount)
    if label is not None and (fault := fault_of_uses(label.category, uses)):
        return file, fault.removesuffix(".")
    if label is None or mount not in get_args(Mount):
        return file, f"no category '{row['category']}' in mpcat40, or no mount '{mount}'"
    c, s = math.cos(front), math.sin(front)
    return Entry(
        ident=f"{folder.resolve().name}#{file}", name=PurePosixPath(file).stem, file=file, origin=file, label=label,
        size_m=size_m, elevation_m=elevation_m, author=str(row.get("author") or ""),
        licence=str(row.get("license") or row.get("licence") or ""), read=lambda path: _read_file(folder, path),
        rotation=np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]]),
    )  # fmt: skip


def _read_file(folder: Path, path: str) -> bytes:
    file = path_inside(folder, path)
    if file is None:
        raise Skipped(f"'{printable(path)}' leads out of the folder")
    try:
        return read_bytes(file, what="Model", most=MAX_FILE_BYTES)
    except ConfigError as error:
        raise Skipped(str(error).rstrip(".")) from None


def path_inside(folder: Path, name: str) -> Path | None:
    """Returns the path of a named file in the folder or below it; None if it is elsewhere or has an invalid name."""
    base = folder.resolve()
    try:
        target = (base / name.replace("\\", "/")).resolve()
    except (OSError, ValueError, RuntimeError):
        return None
    return target if target.is_relative_to(base) else None


def _finite(*numbers: float) -> None:
    """Raises Skipped if a number is NaN or infinite, or a height that no house has."""
    if not all(abs(number) <= MAX_NUMBER for number in numbers):
        raise Skipped(f"a number is not finite or larger than {MAX_NUMBER:g}")


def _allowed(size_m: Size) -> Size:
    if not all(SIZE_M[0] <= side <= SIZE_M[1] for side in size_m):
        sides = " x ".join(f"{side:g}" for side in size_m)
        raise Skipped(f"a side is outside of {SIZE_M[0]:g}-{SIZE_M[1]:g} m (it is {sides} m large)")
    return size_m
