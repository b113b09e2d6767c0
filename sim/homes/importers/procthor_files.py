"""The files of ProcTHOR (https://github.com/allenai/procthor): houses as JSON, and the database of their assets.

Unity's frame: x right, y up, z forward, left-handed, metres; rotations in degrees. Values without use are not read.
Every coordinate is limited, so that a broken house cannot ask for a grid of any size.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import Meta, Struct

from sim.core.errors import ConfigError, HouseError
from sim.core.reading import MAX_BYTES, Name, json_lines, parse_json, read_bytes, read_gzip_json, read_json

Coordinate = Annotated[float, Meta(ge=-300.0, le=300.0)]
Size = Annotated[float, Meta(gt=0.0, le=30.0)]
Degrees = Annotated[float, Meta(ge=-1e5, le=1e5)]
Colour = Annotated[float, Meta(ge=0.0, le=1.0)]


class Vector(Struct):
    """A point, or the sides of a box."""

    x: Coordinate
    z: Coordinate
    y: Coordinate = 0.0


class Turn(Struct):
    """Rotations about Unity's axes, applied in the order z, x, y."""

    x: Degrees = 0.0
    y: Degrees = 0.0
    z: Degrees = 0.0


class Rgb(Struct):
    """A colour; each part is from 0 to 1."""

    r: Colour
    g: Colour
    b: Colour


class Material(Struct):
    """The material of a floor or a wall."""

    name: str = ""
    color: Rgb | None = None


class Room(Struct):
    """A room: its floor up to the middle of its walls."""

    id: Name
    floorPolygon: Annotated[list[Vector], Meta(min_length=3, max_length=100)]
    roomType: Name = "Room"
    floorMaterial: Material | str | None = None


class Wall(Struct):
    """One side of a wall; `empty` marks an opening without a wall."""

    id: Name
    roomId: Name
    polygon: Annotated[list[Vector], Meta(min_length=4, max_length=100)]
    empty: bool = False
    material: Material | str | None = None


class Corners(Struct):
    """Two opposite corners."""

    min: Vector
    max: Vector


class Hole(Struct):
    """A door or a window: a hole in a wall, from one corner to the opposite one, along the wall and upwards.

    Houses of ProcTHOR's schema 0.0.1 have the corners as `boundingBox`; ProcTHOR's own upgrade to 1.0.0
    (procthor/utils/upgrade_house_version.py) makes `holePolygon` of them, too.
    """

    id: Name
    wall0: Name
    holePolygon: Annotated[list[Vector], Meta(min_length=2, max_length=2)] = []
    assetId: str = ""
    room0: str = ""
    openness: Annotated[float, Meta(ge=0.0, le=1.0)] | None = None
    boundingBox: Corners | None = None

    def __post_init__(self) -> None:
        if self.holePolygon:
            return
        if self.boundingBox is None:
            raise ValueError("a hole needs `holePolygon`, or `boundingBox` as in schema 0.0.1")
        self.holePolygon = [self.boundingBox.min, self.boundingBox.max]


class SceneObject(Struct):
    """An object with the objects on it or in it; `position` is the centre of its box."""

    id: Name
    assetId: str
    position: Vector
    rotation: Turn = msgspec.field(default_factory=Turn)
    kinematic: bool = False
    children: list[SceneObject] | None = None


class SourceHouse(Struct):
    """A house."""

    rooms: Annotated[list[Room], Meta(min_length=1, max_length=100)]
    walls: Annotated[list[Wall], Meta(max_length=5000)]
    doors: Annotated[list[Hole], Meta(max_length=1000)] = []
    windows: Annotated[list[Hole], Meta(max_length=1000)] = []
    objects: Annotated[list[SceneObject], Meta(max_length=5000)] = []


class Box(Struct):
    """The sides of an asset in its own frame, front along z."""

    x: Size
    y: Size
    z: Size


class _Asset(Struct):
    assetId: Name
    boundingBox: Any = None


@dataclass(frozen=True)
class Asset:
    """The type and the size of an asset."""

    kind: str
    """AI2-THOR's type, for example `ArmChair`."""
    size_m: tuple[float, float, float]
    """Width, height, depth: along Unity's x, y, z."""


@dataclass(frozen=True)
class Source:
    """A house that has not been parsed yet."""

    name: str
    where: str
    """File and line, for messages."""
    content: bytes
    share: float = 1.0
    """Share of the file that has been read up to this house."""


def read_houses(path: Path) -> Iterator[Source]:
    """Yields the houses of a file: one of a `.json` file, one for each line of a `.jsonl` file; both may be gzipped.

    Raises:
        ConfigError: the file cannot be read, or has another ending.
    """
    name = path.name.removesuffix(".gz")
    stem, what = name.rpartition(".")[0], "House file"
    if name.endswith(".jsonl"):
        for number, line, share in json_lines(path, what=what):
            yield Source(f"{stem}_{number:04d}", f"{what} '{path}', line {number}", line, share)
    elif name.endswith(".json"):
        yield Source(stem, f"{what} '{path}'", _content(path, what))
    else:
        raise ConfigError(f"'{path}': unsupported suffix; use .json, .jsonl, .json.gz or .jsonl.gz.")


def parse_house(source: Source) -> SourceHouse:
    """Returns the house of a source.

    Raises:
        HouseError: it is not JSON, lacks a field, or has a value that is not allowed.
    """
    return parse_json(source.content, SourceHouse, where=source.where, error=HouseError)


def read_assets(file: Path) -> Mapping[str, Asset]:
    """Returns the assets of a database (`asset-database.json`, which may be gzipped) by their names.

    Raises:
        ConfigError: the file cannot be read or has another content.
    """
    what = "Asset database"
    read = read_gzip_json if file.name.endswith(".gz") else read_json
    assets = {}
    for kind, listed in read(file, dict[str, list[_Asset]], what=what).items():
        for entry in listed:
            try:
                box = msgspec.convert(entry.boundingBox, Box)
            except msgspec.ValidationError:
                continue  # without a size; its objects are reported as left out
            assets[entry.assetId] = Asset(kind, (box.x, box.y, box.z))
    if not assets:
        raise ConfigError(f"{what} '{file}' has no asset with a size.")
    return assets


def find_assets(path: Path, chosen: Path | None) -> Path:
    """Returns the asset database: the one that was given, or the one next to the houses.

    Raises:
        ConfigError: it is missing.
    """
    if chosen is not None:
        return chosen
    for name in ("asset-database.json", "asset-database.json.gz"):
        if (path.parent / name).is_file():
            return path.parent / name
    raise ConfigError(
        f"The file asset-database.json (types and sizes of ProcTHOR's assets) is missing next to '{path}'. It is in "
        "the folder procthor/databases of ProcTHOR's repository; give its path with --assets."
    )


def _content(path: Path, what: str) -> bytes:
    """Returns the content of a file of one house."""
    if not path.name.endswith(".gz"):
        return read_bytes(path, what=what)
    content = bytearray()
    for entry in json_lines(path, what=what):
        content += entry.text
        if len(content) > MAX_BYTES:
            raise ConfigError(f"{what} '{path}' expands to more than {MAX_BYTES >> 20} MB.")
    return bytes(content)
