"""Turns an item into few geoms: visual parts of the same look become one mesh, and few boxes collide in their place.

Each visual geom costs rendering time and each collision geom costs physics time. A chair of twenty rails and spindles
becomes one mesh for each look, and collides as a few boxes (`sim.homes.housegen.mjcf.collision`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim.homes.housegen.furniture.item import Geom, Item, Look, Mount
from sim.homes.housegen.furniture.transforms import matrix_from_euler
from sim.homes.housegen.mjcf.boxes import Box, geom_box
from sim.homes.housegen.mjcf.collision import collision_boxes
from sim.homes.housegen.mjcf.triangles import Facets, facets, mesh_shape
from sim.homes.housegen.surfaces.textures import mean_colour

SLAT_HALF_M, ROD_HALF_M = 0.045, 0.07
"""Textured boards and rods narrower than twice this lose their texture in a mesh: its grain would not be visible."""
MAX_JOINED_VERTICES = 400
BUILDING = frozenset(("wall", "floor", "ceiling", "door", "window", "column"))
"""Categories that keep their exact geoms, because lines of sight and free space depend on them."""


@dataclass(frozen=True)
class Assembly:
    """The geoms that an item becomes."""

    visual: tuple[Geom, ...]
    """Rendered geoms; those that are `solid` collide as well."""
    collision_only: tuple[Geom, ...]
    """Geoms that collide and are not rendered."""


def assemble(item: Item) -> Assembly:
    """Returns the smallest assembly that looks the same and collides nearly the same; children are left out."""
    parts = _Parts(item)
    if item.collision_geoms:
        return Assembly(tuple(_join(parts.visual_only, parts)), tuple(item.collision_geoms))
    exact = Assembly((*_join(parts.visual_only, parts), *parts.solid), ())
    if item.category in BUILDING or parts.boxes is None:
        return exact
    boxed = Assembly((*_join(parts.small, parts), *parts.rest), parts.boxes)
    return min(exact, boxed, key=lambda a: len(a.visual) + len(a.collision_only))


class _Parts:
    """The geoms of an item in the groups that are assembled, and the values computed for each group."""

    def __init__(self, item: Item) -> None:
        self.item = item
        self.visual_only = [geom for geom in item.geoms if not geom.solid]
        self.solid = [geom for geom in item.geoms if geom.solid]
        joinable = _joinable(item)
        ids = {id(geom) for geom in joinable}
        self.small = [replace(geom, solid=False) for geom in joinable]
        self.rest = [geom for geom in item.geoms if id(geom) not in ids]
        solid = [geom for geom in joinable if geom.solid]
        self.boxes = tuple(collision_boxes(solid, item)) if len(solid) > 1 and item.category not in BUILDING else None
        every = [*self.visual_only, *self.small]
        self.looks = {id(geom): _plain(geom) for geom in every}
        self._facets: dict[int, Facets] = {}
        self._blocks = [
            geom_box(geom)
            for geom in item.geoms
            if geom.shape == "box" and _is_axis_aligned(geom) and geom.look.rgba[3] == 1
        ]

    def facets(self, geom: Geom) -> Facets:
        """Returns the visible triangles of one of its geoms."""
        if id(geom) not in self._facets:
            self._facets[id(geom)] = _visible_facets(geom, self.item.mount, self._blocks)
        return self._facets[id(geom)]


def collision_geoms(item: Item) -> list[Geom]:
    """Returns the geoms with which an item collides; children are left out."""
    parts = assemble(item)
    return [*(geom for geom in parts.visual if geom.solid), *parts.collision_only]


def _joinable(item: Item) -> list[Geom]:
    """Returns the geoms that may become one mesh with others of their look: opaque, plain, and not the only one."""
    looks = [_plain(geom) for geom in item.geoms]
    return [geom for geom, look in zip(item.geoms, looks, strict=True) if look is not None and looks.count(look) > 1]


def _plain(geom: Geom) -> Look | None:
    """Returns the look of a geom as part of a mesh without texture; None if the texture must stay visible."""
    look = geom.look
    if look.rgba[3] < 1.0:
        return None
    if look.texture is None:
        return look
    if geom.mesh is not None or _width_m(geom) >= (SLAT_HALF_M if geom.shape == "box" else ROD_HALF_M):
        return None
    tone = mean_colour(look.texture)
    r, g, b = (round(a * b, 3) for a, b in zip(look.rgba, tone, strict=False))
    return replace(look, texture=None, rgba=(r, g, b, 1.0))


def _width_m(geom: Geom) -> float:
    """Returns half the width of a geom across its length."""
    if geom.shape == "ellipsoid":
        return max(geom.size_m)
    return sorted(geom.size_m)[1] if geom.shape == "box" else geom.size_m[0]


# ---- visual meshes -------------------------------------------------------------------------------------------------


def _join(geoms: Sequence[Geom], parts: _Parts) -> list[Geom]:
    """Returns geoms that look the same, those of each plain look joined into meshes."""
    kept: list[Geom] = []
    groups: dict[Look, list[tuple[Geom, Facets]]] = {}
    for geom in geoms:
        look = parts.looks[id(geom)]
        if look is None:
            kept.append(geom)
        else:
            groups.setdefault(look, []).append((geom, parts.facets(geom)))
    for look, alike in groups.items():
        part: list[tuple[Geom, Facets]] = []
        for one in alike:
            if part and sum(len(shape[0]) for _, shape in [*part, one]) > MAX_JOINED_VERTICES:
                kept.append(_mesh_of(part, look))
                part = []
            part.append(one)
        kept.append(_mesh_of(part, look))
    return kept


def _visible_facets(geom: Geom, mount: Mount, blocks: Sequence[Box]) -> Facets:
    """Returns a geom's triangles; for an axis-aligned box without the faces that another box or the mount hides."""
    corners, triangles = facets(geom)
    if geom.shape != "box" or not _is_axis_aligned(geom):
        return corners, triangles
    rotation, box = matrix_from_euler(*geom.euler_rad), geom_box(geom)
    visible = []
    for side, pair in enumerate(triangles.reshape(6, 2, 3)):  # -x, +x, -y, +y, -z, +z of the geom
        out = rotation[:, side // 2] * (1 if side % 2 else -1)
        axis = int(np.abs(out).argmax())
        if not _is_hidden(box, axis, out[axis] > 0, mount, blocks):
            visible.append(pair)
    return corners, (np.concatenate(visible) if visible else triangles)


def _is_hidden(box: Box, axis: int, upper: bool, mount: Mount, blocks: Sequence[Box]) -> bool:
    """Returns whether the upper or lower face of a box across an axis is hidden."""
    at, sign = (box[axis + 3], 1.0) if upper else (box[axis], -1.0)
    if sign * at > -0.002 and (mount, axis, upper) in _HIDDEN_BY_MOUNT:
        return True
    others = [i for i in range(3) if i != axis]
    return any(
        block[axis] < at + 0.0015 * sign < block[axis + 3]
        and all(block[i] < box[i] + 0.001 and box[i + 3] - 0.001 < block[i + 3] for i in others)
        for block in blocks
    )


_HIDDEN_BY_MOUNT = frozenset((("floor", 2, False), ("top", 2, False), ("wall", 0, False), ("ceiling", 2, True)))
"""Faces that lie on the surface an item is mounted on: mount, axis, True for the upper face."""


def _is_axis_aligned(geom: Geom) -> bool:
    """Returns whether a geom is turned by quarter turns only."""
    return all(abs(math.remainder(angle, math.pi / 2)) < 1e-3 for angle in geom.euler_rad)


def _mesh_of(parts: Sequence[tuple[Geom, Facets]], look: Look) -> Geom:
    """Returns one visual mesh of some geoms with its origin in their middle; a single geom stays as it is."""
    if len(parts) == 1:
        return parts[0][0]
    points, faces, start = [], [], 0
    for geom, (corners, triangles) in parts:
        points.append(np.array(geom.pos_m) + corners @ matrix_from_euler(*geom.euler_rad).T)
        faces.append(triangles + start)
        start += len(corners)
    every = np.vstack(points)
    middle = np.round(0.5 * (every.min(axis=0) + every.max(axis=0)) + 1e-9, 4)
    mesh = mesh_shape("j", every - middle, np.vstack(faces))
    return Geom("mesh", (), (float(middle[0]), float(middle[1]), float(middle[2])), look, solid=False, mesh=mesh)
