"""Reads scans of Habitat's data sets: HM3D and Matterport3D, one mesh for a house, with an instance for each triangle.

HM3D (https://aihabitat.org/datasets/hm3d-semantics/): `X.glb` or `X.basis.glb` is shown; `X.semantic.glb` has a colour
for each instance, in pictures or at vertices; `X.semantic.txt` names category and region of each colour.
Matterport3D in Habitat's form (https://niessner.github.io/Matterport/): `X.glb` is shown, `X_semantic.ply` has colours
of vertices and `object_id` of triangles, `X.house` has objects, categories and regions. Both are z up; other files are
recognized by the side to which most of the floor faces. The tests of this module do not use real scans.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from sim.core.errors import HouseError
from sim.core.reading import printable, read_text
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.importers.floors import PLAN_CELL_M, Plan, rasterized
from sim.homes.importers.habitat_names import UNKNOWN, category_of, category_of_label, kind_of_region
from sim.homes.importers.losses import Losses
from sim.homes.importers.mesh_house import MeshObject, RoomArea, Shape
from sim.homes.importers.surfaces import Y_UP, Surface, read_surfaces
from sim.homes.importers.visual import pixels_at

HM3D_HEADER = "HM3D Semantic Annotations"
MAX_OBJECTS = 100_000
NEAR_M = 0.2
"""A triangle of the shown mesh that is farther from all annotated ones has no instance."""
_INNER = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4]]) / np.array([[3], [6], [6], [6]])
"""Weights of the corners for four points of a triangle; the colours there vote on its instance."""
MIN_TURN_RAD = math.radians(1.0)


@dataclass(frozen=True)
class Annotation:
    """The annotation of an instance in a data set."""

    name: str
    category: str
    region: int


@dataclass(frozen=True)
class Scan:
    """The objects and rooms of a scan, in our frame before it is moved to z = 0."""

    objects: list[MeshObject]
    rooms: list[RoomArea]


def read_hm3d(file: Path, losses: Losses, texture_px: int) -> Scan:
    """Returns the objects of a scan of HM3D.

    Args:
        file: `X.semantic.txt`.
        losses: gets the parts without a category or an instance.
        texture_px: larger pictures are reduced to this size.

    Raises:
        HouseError: a file is missing or broken; the message names file and line.
    """
    stem = file.name.removesuffix(".semantic.txt")
    notes, colours = read_hm3d_text(file, losses)
    shown = next(
        (candidate for name in (f"{stem}.glb", f"{stem}.basis.glb") if (candidate := file.with_name(name)).is_file()),
        None,
    )
    if shown is None:
        raise HouseError(f"Scan '{file}': '{stem}.glb' or '{stem}.basis.glb' must be next to it.")
    labelled = read_surfaces(file.with_name(f"{stem}.semantic.glb"))
    ids = [_instances(surface, colours) for surface in labelled]
    surfaces = read_surfaces(shown, texture_px=texture_px, losses=losses.changes)
    return _scan(surfaces, labelled, ids, notes, {}, losses)


def read_mp3d(file: Path, losses: Losses, texture_px: int) -> Scan:
    """Returns the objects of a scan of Matterport3D; arguments and errors as for `read_hm3d`, with `X.house`."""
    stem = file.name.removesuffix(".house")
    notes, kinds = read_house_text(file)
    ply, glb = file.with_name(f"{stem}_semantic.ply"), file.with_name(f"{stem}.glb")
    labelled = read_surfaces(ply)
    if any(surface.face_ids is None for surface in labelled):
        raise HouseError(f"Mesh '{ply}': its faces must have the property 'object_id'.")
    ids = [surface.face_ids for surface in labelled if surface.face_ids is not None]
    surfaces = labelled
    if glb.is_file():
        surfaces = read_surfaces(glb, texture_px=texture_px, losses=losses.changes)
    return _scan(surfaces, labelled, ids, notes, kinds, losses)


def read_hm3d_text(file: Path, losses: Losses) -> tuple[dict[int, Annotation], dict[int, int]]:
    """Returns the annotations of instances, and the instance of each colour (red * 65536 + green * 256 + blue).

    Raises:
        HouseError: the file is broken; the message names the line.
    """
    what = f"Annotations '{file}'"
    lines = read_text(file, what="Annotations", error=HouseError).splitlines()
    if not lines or HM3D_HEADER not in lines[0]:
        raise HouseError(f"{what}, line 1: the line must be '{HM3D_HEADER}'.")
    notes: dict[int, Annotation] = {}
    colours: dict[int, int] = {}
    for number, line in enumerate(lines[1:], start=2):
        if not line.strip():
            continue
        try:
            ident, colour, name, region = next(csv.reader([line]))
            code, instance, of_region = int(colour, 16), _number(ident), _number(region)
        except (ValueError, csv.Error):
            raise HouseError(
                f"{what}, line {number}: expected 'id,RRGGBB,\"category\",region', got '{printable(line)[:80]}'."
            ) from None
        if len(notes) == MAX_OBJECTS:
            raise HouseError(f"{what} has more than {MAX_OBJECTS} objects.")
        if not 0 <= code < 1 << 24 or code in colours:
            raise HouseError(f"{what}, line {number}: the colour {printable(colour)} is not allowed or occurs twice.")
        colours[code] = instance
        notes[instance] = Annotation(name, _named(name, losses), of_region)
    return notes, colours


def _number(word: str) -> int:
    """Returns an identifier; raises ValueError if it is not a whole number, or has more digits than a file needs."""
    number = int(word)
    if abs(number) >= 1 << 31:
        raise ValueError(word)
    return number


def _named(name: str, losses: Losses) -> str:
    """Returns the category of a name; unknown ones are reported."""
    category = category_of(name)
    if category is None:
        losses.changes[f"'{printable(name)[:40]}' is in no table; it became {UNKNOWN}."] += 1
    return category or UNKNOWN


def read_house_text(file: Path) -> tuple[dict[int, Annotation], dict[int, str]]:
    """Returns the annotations of the objects of a .house file, and the kinds of its regions.

    Raises:
        HouseError: the file is broken; the message names the line.
    """
    what = f"House file '{file}'"
    lines = read_text(file, what="House file", error=HouseError).splitlines()
    if not lines or lines[0].split() != ["ASCII", "1.1"]:
        raise HouseError(f"{what}, line 1: the line must be 'ASCII 1.1'.")
    categories: dict[int, tuple[str, str]] = {}
    kinds: dict[int, str] = {}
    regions: list[tuple[int, int, int]] = []
    for number, line in enumerate(lines[1:], start=2):
        words = line.split()
        try:
            if words[:1] == ["C"]:
                categories[_number(words[1])] = (words[3].replace("#", " "), category_of_label(words[5]))
            elif words[:1] == ["R"]:
                kinds[_number(words[1])] = kind_of_region(words[5])
            elif words[:1] == ["O"]:
                regions.append((_number(words[1]), _number(words[2]), _number(words[3])))
        except (ValueError, IndexError):
            raise HouseError(f"{what}, line {number} is not a line of this format: '{printable(line)[:60]}'.") from None
        if max(len(regions), len(categories), len(kinds)) > MAX_OBJECTS:
            raise HouseError(f"{what} has more than {MAX_OBJECTS} objects.")
    unknown = ("no category", UNKNOWN)
    return {ident: Annotation(*categories.get(category, unknown), region) for ident, region, category in regions}, kinds


def _instances(surface: Surface, colours: Mapping[int, int]) -> NDArray[np.int64]:
    """Returns the instance of each triangle (m,) by a vote of the colours that it shows; -1: no instance."""
    paint, votes = surface.paint, []
    for weights in _INNER:
        if paint.picture is not None and paint.uv is not None:
            rgb = pixels_at(paint.picture, np.einsum("c,mcd->md", weights, paint.uv[surface.faces]))
        elif paint.vertex_rgb is not None:
            rgb = paint.vertex_rgb[surface.faces[:, int(weights.argmax())]]
        else:
            rgb = np.tile(np.rint(np.array(paint.rgba[:3]) * 255.0).astype(np.uint8), (len(surface.faces), 1))
        votes.append(rgb.astype(np.int64) @ np.array([65536, 256, 1]))
    known = np.array(sorted(colours), dtype=np.int64)
    if not len(known):
        return np.full(len(surface.faces), -1, dtype=np.int64)
    of_known = np.array([colours[code] for code in known.tolist()], dtype=np.int64)
    codes = np.stack(votes)  # (4, m)
    at = np.minimum(np.searchsorted(known, codes), len(known) - 1)
    ids = np.where(known[at] == codes, of_known[at], -1)
    counts = (ids[:, None] == ids[None]).sum(axis=1) - 10 * (ids < 0)
    return np.asarray(np.take_along_axis(ids, counts.argmax(axis=0)[None], axis=0)[0], dtype=np.int64)


def _scan(
    surfaces: Sequence[Surface], labelled: Sequence[Surface], ids: Sequence[NDArray[np.int64]],
    notes: Mapping[int, Annotation], kinds: Mapping[int, str], losses: Losses,
) -> Scan:  # fmt: skip
    """Returns the objects of a mesh; its triangles get the instances of the nearest annotated ones."""
    if surfaces is labelled:
        of_surface = list(ids)
    else:
        tree = KDTree(np.concatenate([surface.corners_m.mean(axis=1) for surface in labelled]))
        of_face = np.append(np.concatenate(ids), -1)
        of_surface = [
            of_face[tree.query(surface.corners_m.mean(axis=1), distance_upper_bound=NEAR_M)[1]] for surface in surfaces
        ]
    turn = _upright(surfaces, of_surface, notes)
    surfaces = [surface.moved(turn) for surface in surfaces]
    yaw = _yaw_of_walls(surfaces, of_surface, notes)
    back, quaternion = np.eye(4), (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
    back[:2, :2] = [[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]]
    objects = []
    floors: dict[int, list[NDArray[np.float64]]] = {}
    everything = np.unique(np.concatenate(of_surface)).tolist()
    for ident in everything:
        parts = [
            surface.part(of == ident) for surface, of in zip(surfaces, of_surface, strict=True) if (of == ident).any()
        ]
        note = notes.get(ident, Annotation("no instance", UNKNOWN, -1))
        if note.category == "floor":
            floors.setdefault(note.region, []).extend(part.corners_m for part in parts)
        losses.furniture[note.name] += 1
        shape = Shape(tuple(part.moved(back) for part in parts))
        objects.append(MeshObject(note.category, note.name, shape, quaternion=quaternion))
    without = set(notes) - set(everything)
    if without:
        losses.changes["An annotated object has no triangles."] += len(without)
    return Scan(objects, _rooms(floors, kinds))


def _upright(
    surfaces: Sequence[Surface], ids: Sequence[NDArray[np.int64]], notes: Mapping[int, Annotation]
) -> NDArray[np.float64]:
    """Returns the 4 x 4 matrix that turns the axis to which most of the floors and ceilings face upwards."""
    level = [ident for ident, note in notes.items() if note.category in ("floor", "ceiling")]
    facing = np.zeros(3)
    for surface, of in zip(surfaces, ids, strict=True):
        corners = surface.corners_m[np.isin(of, level)]
        facing += np.abs(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])).sum(axis=0)
    matrix = np.eye(4)
    if facing[1] > facing[2]:
        matrix[:3, :3] = Y_UP
    return matrix


def _yaw_of_walls(
    surfaces: Sequence[Surface], ids: Sequence[NDArray[np.int64]], notes: Mapping[int, Annotation]
) -> float:
    """Returns the angle, within 45 degrees, by which most of the walls are turned against the axes; 0 if it is small.

    The angle is that of the area-weighted mean of the directions, multiplied by four so that right angles agree.
    """
    walls, total = [ident for ident, note in notes.items() if note.category == "wall"], 0j
    for surface, of in zip(surfaces, ids, strict=True):
        corners = surface.corners_m[np.isin(of, walls)]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, :2]
        total += (np.linalg.norm(normal, axis=1) * np.exp(4j * np.arctan2(normal[:, 1], normal[:, 0]))).sum()
    yaw = float(np.angle(total)) / 4.0
    return yaw if abs(yaw) > MIN_TURN_RAD else 0.0


def _rooms(floors: Mapping[int, Sequence[NDArray[np.float64]]], kinds: Mapping[int, str]) -> list[RoomArea]:
    """Returns the rooms: the floors of each region."""
    rooms = []
    for region, parts in sorted(floors.items()):
        corners = np.concatenate(parts)
        low, high = corners.reshape(-1, 3).min(axis=0), corners.reshape(-1, 3).max(axis=0)
        origin = (float(low[0]), float(low[1]))
        shape = tuple(int(n) for n in np.ceil((high - low)[:2] / PLAN_CELL_M) + 1)
        if shape[0] * shape[1] > 4_000_000:
            continue
        rects: list[Rect] = Plan(origin, rasterized(corners, origin, shape)).rectangles(covered=0.97, most=30)
        z_m = float(np.median(corners[..., 2]))
        if sum(rect.area_m2 for rect in rects) >= 0.5:
            rooms.append(RoomArea(kinds.get(region, "room"), tuple(rects), z_m))
    return rooms
