"""Reads houses of MolmoSpaces (https://github.com/allenai/molmospaces): MJCF files with metadata of their objects.

A house is `<name>.xml`, with `<name>_metadata.json`, and meshes next to it; `<name>_ceiling.xml`, where it exists, is
the same house with ceilings and is used in its place. The metadata names the category of each object by its root body,
`<word>_<hash>_<count>_<body>_<room>`. Of the geometry only the floors of the rooms are interpreted: they become sites.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated

import numpy as np
from msgspec import Meta, Struct
from numpy.typing import NDArray

from sim.core.errors import ConfigError, HouseError
from sim.core.reading import Name, read_json
from sim.gl import mujoco
from sim.homes.importers.rectilinear import rectangles_of_triangles
from sim.homes.importers.scenes import Scene, add_room, floor_height, lower
from sim.houses.foreign import remove_unsupported
from sim.houses.geoms import data_at_rest, mesh_triangles
from sim.houses.labels import read_labels
from sim.houses.load import compiled
from sim.houses.mjcf import read_spec
from sim.houses.packing import gather_files, text_of
from sim.houses.proposals import category_of_name, geom_box, void_objects
from sim.houses.taxonomies import entries

METADATA = "_metadata.json"
CEILING = "_ceiling"
MAX_HOUSES = 100_000
STRUCTURE = {r"^floor$": "floor", r"^room_\d+$": "floor", r"^wall_[\d_]+$": "wall", r"(?i)ceiling": "ceiling"}
"""Label rules for the names of all houses."""
CEILING_M = 2.5
"""Height of rooms without walls."""
OPEN_RAD = math.pi / 2
"""Largest angle by which a door is opened."""
_OBJECT = re.compile(r"(?P<word>.+?)_(?P<hash>[0-9a-f]+)_\d+_(?P<body>\d+)_\d+")
_ROOM_BODY = re.compile(r"room_\d+")
_WALL_BODY = re.compile(r"wall_[\d_]+")


class _Object(Struct):
    category: Name


class _Metadata(Struct):
    objects: Annotated[dict[str, _Object], Meta(max_length=100_000)]


def find_houses(path: Path) -> list[Path]:
    """Returns the house files of a folder that have metadata, or the one file that is given, sorted.

    Raises:
        ConfigError: the folder has no houses.
    """
    if path.suffix == ".xml":
        files = [path]
    else:
        names = sorted(path.glob(f"*{METADATA}"))[:MAX_HOUSES]
        stems = [file.name.removesuffix(METADATA) for file in names]
        files = [path / f"{stem}.xml" for stem in stems if (path / f"{stem}.xml").is_file()]
    if not files:
        raise ConfigError(f"'{path}' has no house of MolmoSpaces: <name>.xml with <name>{METADATA}.")
    return [_with_ceiling(file) for file in files]


def name_of(file: Path) -> str:
    """Returns the name of the house of a file."""
    return file.stem.removesuffix(CEILING)


def metadata_file(file: Path) -> Path:
    """Returns the path of the metadata of a house file."""
    return file.with_name(f"{name_of(file)}{METADATA}")


def import_scene(file: Path, *, doors: str, root: Path | None = None, texture_px: int | None = None) -> Scene:
    """Returns the files of a house for a split, its label rules and its report.

    Args:
        file: the house file.
        doors: "open": hinged doors are turned to the end of their range, at most to a right angle; "as-is".
        root: another folder that the house may use.
        texture_px: longest side of the textures; larger ones are reduced.

    Raises:
        HouseError: the house or its metadata are missing or broken; the message names the file.
    """
    objects = read_json(metadata_file(file), _Metadata, what="Metadata", error=HouseError).objects
    name, changes = name_of(file), Counter[str]()
    try:
        spec = read_spec(file, root=root, texture_px=texture_px)
        files = gather_files(spec, file.resolve().parent, texture_px=texture_px)
        categories = _categories(objects, changes)
        if doors == "open":
            _open_doors(spec, {name for name, category in categories.items() if category == "door"}, changes)
        changes.update(remove_unsupported(spec))
        rules = {**rules_of(categories), **STRUCTURE}
        model = compiled(spec)
        raised_m = floor_height(model)
        if raised_m:
            lower(spec, raised_m)
            changes[f"The floor was at z = {raised_m:.3f} m; the house was moved to z = 0."] += 1
            model = compiled(spec)
        rooms = _add_rooms(spec, model)
        rules |= _rules_of_others(model, rules, changes)
        text = text_of(spec)
    except HouseError as error:
        raise HouseError(f"House '{file}': {error}") from None
    counts = Counter(item.category for item in objects.values())
    report = {
        "house": name, "source": str(file), "rooms": len(rooms), "area_m2": round(sum(rooms), 2),
        "furniture": dict(counts.most_common()), "boxes": {}, "left_out": {}, "changes": dict(changes), "moved_m": 0.0,
    }  # fmt: skip
    return Scene(name, text, files, rules, report)


def rules_of(categories: Mapping[str, str]) -> dict[str, str]:
    """Returns label rules for objects: one for all houses where the name says the type, else one for the name.

    Args:
        categories: mpcat40 category by name of the root body.
    """
    rules: dict[str, str] = {}
    by_word = {kind.lower(): entry.category for kind, entry in entries("ai2thor").items()}
    for name, category in categories.items():
        match = _OBJECT.fullmatch(name)
        if match is not None and by_word.get(match["word"]) == category:
            rules[rf"^{re.escape(match['word'])}_[0-9a-f]+_\d+_{match['body']}_\d+$"] = category
        else:
            rules[f"^{re.escape(name)}$"] = category
    return dict(sorted(rules.items(), key=lambda rule: r"[0-9a-f]+" in rule[0]))


def _categories(objects: Mapping[str, _Object], changes: Counter[str]) -> dict[str, str]:
    """Returns the mpcat40 category of each object."""
    categories = {}
    for name, item in objects.items():
        entry = entries("ai2thor").get(item.category)
        category = entry.category if entry is not None else category_of_name(item.category)
        if category is None:
            category = "objects"
            changes[f"The type {item.category} is not in the table; it became objects."] += 1
        categories[name] = category
    return categories


def _open_doors(spec: mujoco.MjSpec, doors: set[str], changes: Counter[str]) -> None:
    """Turns the leaves of doors about their hinges."""
    for joint in spec.joints:
        if joint.type != mujoco.mjtJoint.mjJNT_HINGE or not doors & set(_names_above(joint.parent)):
            continue
        angles = np.asarray(joint.range, dtype=np.float64)
        if spec.compiler.degree:
            angles = np.radians(angles)
        angle = float(np.clip(angles[np.argmax(np.abs(angles))], -OPEN_RAD, OPEN_RAD))
        axis = np.asarray(joint.axis, dtype=np.float64)
        if abs(angle) < 0.1 or not np.linalg.norm(axis):
            changes["A door has a hinge without a range; it stays closed."] += 1
            continue
        _turn(joint.parent, np.asarray(joint.pos), axis / np.linalg.norm(axis), angle)
        changes["A hinged door was opened."] += 1


def _names_above(body: mujoco.MjsBody) -> Iterator[str]:
    """Yields the names of a body and of those that it is in."""
    while body is not None and body.name != "world":
        yield body.name
        body = body.parent


def _turn(body: mujoco.MjsBody, pivot: NDArray[np.float64], axis: NDArray[np.float64], angle: float) -> None:
    """Turns a body about an axis through a point, both in its own frame."""
    turn, turned, moved, total = np.empty(4), np.empty(3), np.empty(3), np.empty(4)
    mujoco.mju_axisAngle2Quat(turn, axis, angle)
    own = np.asarray(body.quat, dtype=np.float64)
    mujoco.mju_rotVecQuat(turned, pivot.astype(np.float64), turn)
    mujoco.mju_rotVecQuat(moved, pivot - turned, own)
    mujoco.mju_mulQuat(total, own, turn)
    body.pos, body.quat = (np.asarray(body.pos) + moved).tolist(), total.tolist()


def _add_rooms(spec: mujoco.MjSpec, model: mujoco.MjModel) -> list[float]:
    """Adds the sites of the rooms, from the meshes of their floors; returns the area of each in m2."""
    data = data_at_rest(model)
    walls = [geom for geom in range(model.ngeom) if _WALL_BODY.fullmatch(model.body(model.geom_bodyid[geom]).name)]
    top_m = max((float(geom_box(model, data, geom)[1][2]) for geom in walls), default=CEILING_M)
    areas = []
    for body in range(1, model.nbody):
        if not _ROOM_BODY.fullmatch(model.body(body).name):
            continue
        geoms = np.flatnonzero((model.geom_bodyid == body) & (model.geom_type == mujoco.mjtGeom.mjGEOM_MESH))
        triangles_m = [mesh_triangles(model, data, int(geom))[:, :, :2] for geom in geoms]
        rects = rectangles_of_triangles(np.vstack(triangles_m)) if triangles_m else []
        for part, rect in enumerate(rects):
            name = f"room_room_{len(areas):02d}" + (f"_{part}" if part else "")
            add_room(spec, name, rect, top_m)
        if rects:
            areas.append(sum(rect.area_m2 for rect in rects))
    return areas


def _rules_of_others(model: mujoco.MjModel, rules: Mapping[str, str], changes: Counter[str]) -> dict[str, str]:
    """Returns rules for visible objects that the metadata does not name, from the words in their names."""
    labels, assigned = read_labels(model, rules=rules, ignore_prefix=""), {}
    for name in void_objects(model, labels):
        category = category_of_name(name)
        if category is not None:
            assigned[f"^{re.escape(name)}$"] = category
        changes[f"An object is not in the metadata; its name says {category or 'nothing'}."] += 1
    return assigned


def _with_ceiling(file: Path) -> Path:
    other = file.with_name(f"{file.stem}{CEILING}.xml")
    return other if other.is_file() else file
