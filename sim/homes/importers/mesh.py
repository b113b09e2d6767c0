"""Reads a home from one GLB, glTF, OBJ or PLY file; its nodes are the objects.

The category of a node is that of the first rule of a table that its name matches. Without a table, or for other nodes,
the words of the node's and its material's name say it, as in `stubborn label`; then its size: large level plates are
floors, upright ones walls. A node that is the whole home is cut: its level triangles at the lowest level are the floor,
the others wall. The rest becomes objects. The result is also returned as a table for the user to edit.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError, HouseError
from sim.homes.housegen.mjcf.triangles import triangle_areas
from sim.homes.importers.floors import LEVEL_M, NoFloorError, find_levels, level_triangles
from sim.homes.importers.losses import Losses
from sim.homes.importers.mesh_house import MeshConfig, MeshHouse, MeshObject, Shape, build_house, require_few
from sim.homes.importers.obj import read_obj, used_files
from sim.homes.importers.surfaces import FORMATS, Y_UP, Surface, Up, parts_of, read_surfaces
from sim.houses.labels import VOID, categories_by_rules
from sim.houses.proposals import Proposal, category_by_size, category_of_name, rules_of

Axis = Literal["auto", "y", "z"]
MAX_HOUSES = 10_000
WHOLE_SHARE = 0.6
"""A node without a category is the whole home if it extends over this share of its plan along both axes."""
WHOLE_M = 1.5
"""Least height of such a node."""
LEVEL_SHARE = 0.2
"""Least share of the area of floors that is level and faces up; a slab on its edge has less."""
OTHER = "objects"


@dataclass(frozen=True)
class MeshScene:
    """A home, ready to be written."""

    house: MeshHouse
    table: Mapping[str, str]
    """The category of each node: `{"regex over node names": "category"}`."""


@dataclass(frozen=True, eq=False)
class _Node:
    name: str
    shape: Shape


MAX_SEARCHED = 100_000
"""Names that are looked at below a folder without meshes of its own."""


def find_files(path: Path) -> list[Path]:
    """Returns the meshes of a folder, else those of the folders in it, or the one file that is given, sorted.

    Raises:
        ConfigError: the folder has no such files, or two of them have one name.
    """
    if not path.is_dir():
        return [path]
    files = _meshes(path.iterdir()) or _meshes(itertools.islice(path.rglob("*"), MAX_SEARCHED))
    if not files:
        raise ConfigError(
            f"'{path}' has no file of a home, nor have the folders in it: {', '.join(f'.{kind}' for kind in FORMATS)}."
        )
    name, count = Counter(file.stem for file in files).most_common(1)[0]
    if count > 1:
        twins = ", ".join(f"'{file.relative_to(path)}'" for file in files if file.stem == name)
        raise ConfigError(f"'{path}' has {count} homes of the name '{name}': {twins}.")
    return files


def _meshes(files: Iterable[Path]) -> list[Path]:
    return sorted(file for file in files if file.suffix.lower().lstrip(".") in FORMATS and file.is_file())[:MAX_HOUSES]


def files_of(file: Path) -> list[Path]:
    """Returns the files that a mesh uses: materials and pictures of OBJ, buffers and pictures of glTF."""
    if file.suffix.lower() == ".obj":
        return list(used_files(file))
    return list(parts_of(file)) if file.suffix.lower() == ".gltf" else []


def import_mesh(file: Path, *, rules: Mapping[str, str], up: Axis, config: MeshConfig) -> MeshScene:
    """Returns the house of a file.

    Args:
        file: a GLB, glTF, OBJ or PLY file.
        rules: `{"regex over node names": "category"}`; nodes of the category `void` are left out.
        up: the axis that points up; `auto`: z in PLY files, y in others, and the other one if there is no level floor.
        config: options of the house.

    Raises:
        HouseError: the file is broken or does not contain a home; the message names it.
    """
    axes: tuple[Up, Up] = ("z", "y") if file.suffix.lower() == ".ply" else ("y", "z")
    usual, other = axes
    if up != "auto":
        return _import(file, rules, up, config)
    try:
        return _import(file, rules, usual, config)
    except NoFloorError as error:
        try:
            return _import(file, rules, other, config, change=f"{other} points up, not {usual}")
        except NoFloorError:
            raise error from None


def _import(file: Path, rules: Mapping[str, str], axis: Up, config: MeshConfig, *, change: str = "") -> MeshScene:
    """Returns the house of a file with this axis up; `change` goes to its report."""
    losses = Losses()
    if change:
        losses.changes[change] += 1
    try:
        surfaces = _read(file, axis, config.texture_px, losses)
        nodes = _nodes(surfaces)
        require_few(len(nodes))
        by_rule = categories_by_rules([node.name for node in nodes], rules)
        proposals = _proposals(nodes, by_rule)
        proposed = {proposal.name: proposal.category for proposal in proposals}
        objects = _objects(nodes, {**proposed, **by_rule}, losses)
        house = build_house(file.stem, str(file), objects, (), config, losses)
    except HouseError as error:
        said = str(error)
        raise type(error)(said if said.startswith("Mesh ") else f"Mesh '{file}': {said}") from None
    table = {**rules, **rules_of(proposals)}
    return MeshScene(house, table)


def _read(file: Path, up: Up, texture_px: int, losses: Losses) -> list[Surface]:
    """Returns the surfaces of a file in our frame."""
    if file.suffix.lower() != ".obj":
        return read_surfaces(file, up=up, texture_px=texture_px, losses=losses.changes)
    turn = np.eye(4)
    turn[:3, :3] = Y_UP if up == "y" else np.eye(3)
    return [surface.moved(turn) for surface in read_obj(file, texture_px=texture_px, losses=losses.changes)]


def _nodes(surfaces: Sequence[Surface]) -> list[_Node]:
    """Returns the nodes with their surfaces; the instances of a PLY file with `object_id` are nodes of their own."""
    parts: dict[str, list[Surface]] = {}
    for surface in surfaces:
        if surface.face_ids is None:
            parts.setdefault(surface.node, []).append(surface)
            continue
        for number in np.unique(surface.face_ids).tolist():
            piece = surface.part(surface.face_ids == number)
            parts.setdefault(f"{surface.node}_{number}", []).append(replace(piece, face_ids=None))
    return [_Node(name, Shape(tuple(surfaces))) for name, surfaces in parts.items()]


def _proposals(nodes: Sequence[_Node], by_rule: Mapping[str, str]) -> tuple[Proposal, ...]:
    """Returns a proposal for each node that no rule names: by its name, its material, else by its size."""
    named = {}
    for node in nodes:
        words = category_of_name(node.name) or next(filter(None, map(category_of_name, _materials(node))), None)
        if node.name not in by_rule and words is not None:
            named[node.name] = Proposal(node.name, words, "name")
    categories = {**{name: proposal.category for name, proposal in named.items()}, **by_rule}
    floors = [node.shape.corners_m for node in nodes if categories.get(node.name) == "floor"]
    everything = np.concatenate([node.shape.corners_m for node in nodes])
    size_m, lowest_m = np.ptp(everything.reshape(-1, 3), axis=0), _lowest_m(floors, everything)
    for node in nodes:
        if node.name in categories:
            continue
        points = node.shape.corners_m.reshape(-1, 3) - np.array([0.0, 0.0, lowest_m])
        category = category_by_size(points.min(axis=0), points.max(axis=0))
        if category is None and _is_whole(node, size_m):
            category = "wall"
        named[node.name] = Proposal(node.name, category or OTHER, "size" if category else "unknown")
    return tuple(named.values())


def _materials(node: _Node) -> list[str]:
    return list(dict.fromkeys(surface.material for surface in node.shape.surfaces if surface.material))


def _is_whole(node: _Node, home_m: NDArray[np.float64]) -> bool:
    """Returns whether a node extends over a home of this size (3,)."""
    size_m = np.ptp(node.shape.corners_m.reshape(-1, 3), axis=0)
    return bool((size_m[:2] >= WHOLE_SHARE * home_m[:2]).all() and size_m[2] >= WHOLE_M)


def _objects(nodes: Sequence[_Node], categories: Mapping[str, str], losses: Losses) -> list[MeshObject]:
    """Returns the objects of the nodes; without a floor, or with rugs only, one is cut out of the walls."""
    objects = []
    for node in nodes:
        category = categories[node.name]
        if category == VOID:
            losses.left_out[f"{node.name}: the table says void"] += 1
            continue
        objects.append(MeshObject(category, node.name, node.shape))
        losses.furniture[category] += 1
    if not objects:
        return objects
    floors, walls = ([item.corners_m for item in objects if item.category == name] for name in ("floor", "wall"))
    lowest_m = _lowest_m(floors, np.concatenate([item.corners_m for item in objects]))
    floor_m2, wall_m2 = (
        sum(triangle_areas(part[_is_level(part, lowest_m)]).sum() for part in parts) for parts in (floors, walls)
    )
    if floor_m2 >= wall_m2:
        return objects
    cut: list[MeshObject] = []
    for item in objects:
        cut += _cut(item, lowest_m) if item.category == "wall" else [item]
    losses.changes["No node is the floor; the level triangles of the walls at the lowest level became one."] += 1
    return cut


def _lowest_m(floors: Sequence[NDArray[np.float64]], everything: NDArray[np.float64]) -> float:
    """Returns the height of the lowest storey: that of the floors, unless they are too small, as a rug is.

    Raises:
        NoFloorError: no floor is level, for example because another axis points up.
    """
    named = np.concatenate([*floors, everything[:0]])
    try:
        return find_levels(named)[0]
    except NoFloorError:
        areas = triangle_areas(named)
        if areas[level_triangles(named)].sum() < LEVEL_SHARE * areas.sum():
            raise
    return find_levels(everything)[0]


def _is_level(corners_m: NDArray[np.float64], height_m: float) -> NDArray[np.bool_]:
    return level_triangles(corners_m) & (np.abs(corners_m[:, :, 2].mean(axis=1) - height_m) <= LEVEL_M)


def _cut(walls: MeshObject, lowest_m: float) -> list[MeshObject]:
    """Returns the floor and the rest of an object that is a whole home."""
    floor: list[Surface] = []
    rest: list[Surface] = []
    for surface in walls.shape.surfaces:
        level = _is_level(surface.corners_m, lowest_m)
        floor += [surface.part(level)] if level.any() else []
        rest += [surface.part(~level)] if not level.all() else []
    parts = (("floor", floor), ("wall", rest))
    return [replace(walls, category=name, shape=Shape(tuple(surfaces))) for name, surfaces in parts if surfaces]
