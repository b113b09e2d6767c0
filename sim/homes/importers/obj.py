"""Reads OBJ files by object and material.

Each `o` or `g` begins a node of its own. trimesh is not used here: with `split_objects=True` it keeps the names, but it
counts negative numbers of a face from the end of the whole file, takes `f 1 2 0` for a triangle, drops faces of two
corners without a word, loses opacity and the options of pictures, and names no line.
Materials may have a colour (`Kd`), an opacity (`d`) and a picture (`map_Kd`), which replaces the colour, from files of
the OBJ file's folder.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError, HouseError
from sim.core.pictures import decode_picture
from sim.core.reading import printable, read_bytes
from sim.homes.housegen.imported.scene_files import MAX_CORNERS
from sim.homes.housegen.imported.sources import Skipped, path_inside
from sim.homes.importers.surfaces import (
    FARTHEST_M,
    GREY,
    MAX_FILE_BYTES,
    MAX_TRIANGLES,
    WHITE,
    Paint,
    Surface,
    is_near,
    read_inside,
    resized,
)  # fmt: skip

MAX_MATERIALS = 10_000
PICTURE_OPTIONS = {
    "-blendu": 1, "-blendv": 1, "-bm": 1, "-boost": 1, "-cc": 1, "-clamp": 1, "-mm": 2, "-o": 3, "-s": 3, "-t": 3,
    "-texres": 1,
}  # fmt: skip
"""Options of `map_Kd`, with the largest number of their values."""
Corner = tuple[int, int]
"""Numbers of a vertex and of a texture coordinate, from 0; -1: none."""


@dataclass
class _Content:
    """The content of the lines that were read so far."""

    vertices: list[list[float]] = field(default_factory=list)
    uv: list[list[float]] = field(default_factory=list)
    faces: dict[tuple[str, str], list[tuple[Corner, Corner, Corner]]] = field(default_factory=dict)
    """Triangles by node and material."""
    paints: dict[str, Paint] = field(default_factory=dict)
    triangles: int = 0


def read_obj(file: Path, *, texture_px: int, losses: Counter[str]) -> list[Surface]:
    """Returns the surfaces of an OBJ file in its own frame.

    Args:
        file: the file.
        texture_px: larger pictures are reduced to this length of their longer side.
        losses: gets sentences on the losses.

    Raises:
        HouseError: the file cannot be read or is broken; the message names file and line.
    """
    where = f"Mesh '{printable(str(file))}'"
    text = read_bytes(file, what="Mesh", error=HouseError, most=MAX_FILE_BYTES).decode("utf-8", errors="replace")
    content = _Content()
    node, material = file.stem, ""
    for number, line in _whole_lines(text):
        words = line.split()
        if not words:
            continue
        try:
            if words[0] == "v":
                content.vertices.append(_vertex(words[1:4]))
            elif words[0] == "vt":
                content.uv.append([float(word) for word in [*words[1:3], "0", "0"][:2]])
            elif words[0] == "f":
                _add_face(content, node, material, words[1:])
            elif words[0] in ("o", "g") and len(words) > 1:
                node = " ".join(words[1:])
            elif words[0] == "usemtl":
                material = " ".join(words[1:])
            elif words[0] == "mtllib":
                for library in _libraries(file.parent, words[1:]):
                    _read_materials(file.parent, library, texture_px, content.paints, losses)
        except (ValueError, IndexError) as fault:
            raise HouseError(f"{where}, line {number}: '{printable(line)[:60]}' cannot be read: {fault}.") from None
    if not content.faces:
        raise HouseError(f"{where} has no triangles.")
    vertices = np.array(content.vertices, dtype=np.float64)
    all_uv = np.nan_to_num(np.array(content.uv, dtype=np.float64).reshape(-1, 2))
    surfaces = [_surface(content, vertices, all_uv, *key) for key in content.faces]
    near = [surface for surface in surfaces if is_near(surface.vertices_m, surface.node, losses)]
    if not near:
        raise HouseError(f"{where} has no triangles: each has a vertex that is not finite or beyond {FARTHEST_M:g} m.")
    return near


def _whole_lines(text: str) -> Iterator[tuple[int, str]]:
    """Yields each line with its number; one that ends with a backslash and is no comment goes on in the next one."""
    start, whole = 1, ""
    for number, line in enumerate(text.splitlines(), start=1):
        start = start if whole else number
        goes_on = line.endswith("\\") and not line.lstrip().startswith("#")
        whole += line.removesuffix("\\")
        if not goes_on:
            yield start, whole
            whole = ""
    yield start, whole


def _vertex(words: list[str]) -> list[float]:
    """Returns a vertex; raises ValueError if it is broken."""
    if len(words) < 3:
        raise ValueError("a vertex needs three coordinates")
    return [float(word) for word in words]


def _add_face(content: _Content, node: str, material: str, words: list[str]) -> None:
    """Adds a polygon as triangles; raises ValueError if it is broken."""
    corners = [_corner(content, word) for word in words[: MAX_CORNERS + 1]]
    if not 3 <= len(corners) <= MAX_CORNERS:
        raise ValueError(f"a face needs three vertices or more, at most {MAX_CORNERS:,}; it has {len(corners):,}")
    content.triangles += len(corners) - 2
    if content.triangles > MAX_TRIANGLES:
        raise ValueError(f"the file has more than {MAX_TRIANGLES:,} triangles")
    triangles = content.faces.setdefault((node, material), [])
    triangles += [(corners[0], corners[n], corners[n + 1]) for n in range(1, len(corners) - 1)]


def _corner(content: _Content, word: str) -> Corner:
    """Returns a corner of a face, `vertex/texture/normal`; negative numbers count from the end."""
    numbers = [int(part) if part else 0 for part in word.split("/")]
    vertex = numbers[0] - 1 if numbers[0] > 0 else len(content.vertices) + numbers[0]
    if not 0 <= vertex < len(content.vertices) or numbers[0] == 0:
        raise ValueError(f"vertex {numbers[0]} does not exist")
    uv = numbers[1] if len(numbers) > 1 else 0
    at = uv - 1 if uv > 0 else len(content.uv) + uv
    return vertex, at if uv and 0 <= at < len(content.uv) else -1


def _surface(
    content: _Content, vertices_m: NDArray[np.float64], all_uv: NDArray[np.float64], node: str, material: str
) -> Surface:
    """Returns the surface of a node and a material."""
    corners = np.array(content.faces[node, material], dtype=np.int64).reshape(-1, 2)
    used, faces = np.unique(corners, axis=0, return_inverse=True)
    paint = content.paints.get(material, Paint(GREY))
    if paint.picture is not None:
        shows = len(all_uv) > 0 and bool((used[:, 1] >= 0).all())
        paint = replace(paint, uv=all_uv[used[:, 1]]) if shows else Paint(GREY)  # no part of the picture belongs to it
    return Surface(node, material, vertices_m[used[:, 0]], faces.reshape(-1, 3).astype(np.int32), paint)


def _read_materials(folder: Path, name: str, texture_px: int, paints: dict[str, Paint], losses: Counter[str]) -> None:
    """Adds the materials of an MTL file; one that is missing is reported, one outside of the folder is refused."""
    content = _file_inside(folder, name, losses)
    if content is None:
        return
    current = ""
    for line in content.decode("utf-8", errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["newmtl"] and len(paints) < MAX_MATERIALS:
            current = " ".join(words[1:])
            paints[current] = Paint(GREY)
        elif words[:1] == ["Kd"] and current in paints and paints[current].picture is None:
            shares = _shares(words[1:4], losses)
            if len(shares) in (1, 3):  # the first alone is a grey
                r, g, b = shares * (3 // len(shares))
                paints[current] = replace(paints[current], rgba=(r, g, b, paints[current].rgba[3]))
        elif words[:1] == ["d"] and current in paints:
            for opacity in _shares(words[-1:], losses):
                paints[current] = replace(paints[current], rgba=(*paints[current].rgba[:3], opacity))
        elif words[:1] == ["map_Kd"] and current in paints and len(words) > 1:
            named = _picture_name(words[1:])
            picture = _pixels(_file_inside(folder, named, losses), named, texture_px, losses)
            if picture is not None:
                paints[current] = Paint((*WHITE[:3], paints[current].rgba[3]), picture=picture)


def _shares(words: list[str], losses: Counter[str]) -> list[float]:
    """Returns the numbers of a colour or an opacity, each in [0, 1]; none, and a loss, if one cannot be read."""
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = [math.nan]
    if any(map(math.isnan, values)):
        losses["A colour or an opacity of a material is not a number and was left out."] += 1
        return []
    return [min(max(value, 0.0), 1.0) for value in values]


def _picture_name(words: list[str]) -> str:
    """Returns the name of a picture, which may have spaces, without the options in front of it and their values."""
    first = 0
    while first < len(words) - 1 and words[first] in PICTURE_OPTIONS:
        first += 1
        most = first + PICTURE_OPTIONS[words[first - 1]]
        while first < min(most, len(words) - 1) and _is_value(words[first]):
            first += 1
    return " ".join(words[first:])


def _is_value(word: str) -> bool:
    return word in ("on", "off") or word.lstrip("+-").replace(".", "", 1).isdigit()


def used_files(file: Path) -> Iterator[Path]:
    """Yields the files of its folder that an OBJ file and its materials name, whether they exist or not."""
    for library in (name for words in _words_after("mtllib", file) for name in _libraries(file.parent, words)):
        materials = path_inside(file.parent, library)
        if materials is not None:
            yield materials
            pictures = (path_inside(file.parent, _picture_name(words)) for words in _words_after("map_Kd", materials))
            yield from (picture for picture in pictures if picture is not None)


def _libraries(folder: Path, words: list[str]) -> list[str]:
    """Returns the names of the files after `mtllib`: several files, or one whose name has spaces."""
    whole = " ".join(words)
    several = [path_inside(folder, word) for word in words]
    return words if all(path is not None and path.is_file() for path in several) else [whole]


def _words_after(key: str, file: Path) -> Iterator[list[str]]:
    """Yields the words after each `key` at the beginning of a line of a file; nothing if it cannot be read."""
    try:
        text = read_bytes(file, what="File", most=MAX_FILE_BYTES).decode("utf-8", errors="replace")
    except ConfigError:
        return
    for line in text.splitlines():
        words = line.split()
        if words[:1] == [key] and len(words) > 1:
            yield words[1:]


def _file_inside(folder: Path, name: str, losses: Counter[str]) -> bytes | None:
    """Returns a file of the folder or below it; None if it is missing.

    Raises:
        HouseError: it is outside of the folder.
    """
    try:
        return read_inside(folder, name)
    except Skipped:
        losses[f"The file '{printable(name)[:60]}' is missing; its colours were lost."] += 1
        return None


def _pixels(content: bytes | None, name: str, texture_px: int, losses: Counter[str]) -> NDArray[np.uint8] | None:
    """Returns the pixels (h, w, 3) of a picture, RGB, at most `texture_px` along its longer side.

    None: there is no picture, or it was refused, which is reported.
    """
    if content is None:
        return None
    try:
        picture = decode_picture(content, where=f"Picture '{printable(name)[:60]}'", error=HouseError)
    except HouseError as fault:
        losses[f"{fault} It was left out."] += 1
        return None
    return np.ascontiguousarray(resized(picture, texture_px)[..., ::-1])
