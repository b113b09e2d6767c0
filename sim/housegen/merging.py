"""An item as it is drawn and as it is touched: parts of one look become one mesh, small parts are touched as boxes.

What a camera draws and what a body touches cost by the piece. A chair of twenty rails and spindles is drawn as one
mesh a look, and touched as its seat, its back and its arms: no gap is closed that the robot could get into.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim.housegen.furniture.item import Geom, Item, Look, Mount, Surface
from sim.housegen.furniture.workbench import geom_bounds, matrix_from_euler
from sim.housegen.textures import TEXTURES
from sim.housegen.triangles import Facets, facets, mesh_shape

SLAT_HALF_M, ROD_HALF_M = 0.045, 0.07
"""Textured boards and rods narrower than twice this lose their texture when they are joined: nobody sees its grain."""
BYTES_PER_GEOM = 300
"""What a geom less may cost in the house's file."""
MAX_JOINED_VERTICES = 400
SMALL_ITEM_M = 0.8
"""Things no wider than this are touched as blocks under their largest plate: the robot is 0.88 m high."""
OVERHANG_M = 0.05
"""How far legs may stand out from under the plate they carry."""
MAX_FILLED_M3 = 0.012
"""Volume that one box may fill between two parts it stands for."""
MAX_FILLED_M2 = 0.02
"""Floor area that it may cover between them."""
ROBOT_HEIGHT_M = 0.85
"""A plate below this stops the robot, whatever is under it."""
ABOVE_SURFACE_M = 0.4
"""Over a top that things stand on, so much is left free."""
BLOCKS = frozenset(("sink",))
"""Open things that the robot cannot get into: one box."""
BUILDING = frozenset(("wall", "floor", "ceiling", "door", "window", "column"))
"""Lines of sight and places of the robot hang on their exact geoms."""

Box = tuple[float, float, float, float, float, float]
"""Lowest x, y, z, then highest; plain numbers, since thousands of pairs are tried."""


@dataclass(frozen=True)
class Assembly:
    """The geoms that an item becomes."""

    drawn: tuple[Geom, ...]
    """Seen; those that are `solid` are touched as well."""
    touched: tuple[Geom, ...]
    """Touched and not seen."""

    @property
    def solid(self) -> tuple[Geom, ...]:
        """Everything that is touched."""
        return (*(geom for geom in self.drawn if geom.solid), *self.touched)


def assemble(item: Item, bytes_per_geom: int = BYTES_PER_GEOM) -> Assembly:
    """The item in as few geoms as look and feel the same; its children are items of their own.

    Args:
        item: what is built.
        bytes_per_geom: by how much one geom less may lengthen the file; more for what a house has several times.
    """
    seen = [geom for geom in item.geoms if not geom.solid]
    solid = [geom for geom in item.geoms if geom.solid]
    light = Assembly((*_join(seen, item, bytes_per_geom), *solid), ())
    small = _joinable(item)
    if item.category in BUILDING or sum(geom.solid for geom in small) < 2:
        return light
    rest = [geom for geom in item.geoms if not any(geom is other for other in small)]
    shown = _join([replace(geom, solid=False) for geom in small], item, bytes_per_geom)
    whole = Assembly((*shown, *rest), tuple(collision_boxes([geom for geom in small if geom.solid], item)))
    return min(light, whole, key=lambda a: len(a.drawn) + len(a.touched))


def possible_collision_geoms(item: Item) -> list[Geom]:
    """Every shape that may be touched of an item, however it is assembled; children left out."""
    solid = [geom for geom in item.geoms if geom.solid]
    return (
        solid + collision_boxes(solid, item) + collision_boxes([geom for geom in _joinable(item) if geom.solid], item)
    )


def _joinable(item: Item) -> list[Geom]:
    """Parts that may become one mesh with others of their look: neither textured nor transparent nor alone of it."""
    looks = [_plain(geom) for geom in item.geoms]
    return [geom for geom, look in zip(item.geoms, looks, strict=True) if look is not None and looks.count(look) > 1]


def _plain(geom: Geom) -> Look | None:
    """The look of a geom as part of a mesh, which shows no texture; None where that would be missed."""
    look = geom.look
    if look.rgba[3] < 1.0:
        return None
    if look.texture is None:
        return look
    if geom.mesh is not None or _width_m(geom) >= (SLAT_HALF_M if geom.shape == "box" else ROD_HALF_M):
        return None
    tone = _mean_colour(look.texture)
    r, g, b = (round(a * b, 3) for a, b in zip(look.rgba, tone, strict=False))
    return replace(look, texture=None, rgba=(r, g, b, 1.0))


def written_bytes(geom: Geom) -> int:
    """About how much longer a geom makes the file as part of a mesh than by itself."""
    if geom.shape == "box":
        return 84
    if geom.mesh is not None and len(geom.mesh.faces):
        return 0
    corners, triangles = facets(geom)
    return 13 * len(corners) + 9 * len(triangles) - 110


def _width_m(geom: Geom) -> float:
    """Half of what it measures across."""
    if geom.shape == "ellipsoid":
        return max(geom.size_m)
    return sorted(geom.size_m)[1] if geom.shape == "box" else geom.size_m[0]


@functools.cache
def _mean_colour(texture: str) -> tuple[float, float, float]:
    r, g, b = TEXTURES[texture].pixels().reshape(-1, 3).mean(axis=0) / 255.0
    return float(r), float(g), float(b)


# ---- drawn ---------------------------------------------------------------------------------------------------------


def _join(geoms: Sequence[Geom], item: Item, bytes_per_geom: int) -> list[Geom]:
    """The same picture with the geoms of each plain look in one mesh."""
    kept: list[Geom] = []
    groups: dict[Look, list[tuple[Geom, Facets]]] = {}
    blocks = [
        _bounds(geom) for geom in item.geoms if geom.shape == "box" and _is_square(geom) and geom.look.rgba[3] == 1
    ]
    for geom in geoms:
        look = _plain(geom)
        if look is None or written_bytes(geom) > bytes_per_geom:
            kept.append(geom)
        else:
            groups.setdefault(look, []).append((geom, _seen_facets(geom, item.mount, blocks)))
    for look, alike in groups.items():
        part: list[tuple[Geom, Facets]] = []
        for one in alike:
            if part and sum(len(shape[0]) for _, shape in [*part, one]) > MAX_JOINED_VERTICES:
                kept.append(_mesh_of(part, look))
                part = []
            part.append(one)
        kept.append(_mesh_of(part, look))
    return kept


def _seen_facets(geom: Geom, mount: Mount, blocks: Sequence[Box]) -> Facets:
    """A geom's triangles; of an upright box without the faces that lie on another block, the floor or the wall."""
    corners, triangles = facets(geom)
    if geom.shape != "box" or not _is_square(geom):
        return corners, triangles
    rotation, box = matrix_from_euler(*geom.euler_rad), _bounds(geom)
    shown = []
    for side, pair in enumerate(triangles.reshape(6, 2, 3)):  # -x, +x, -y, +y, -z, +z of the geom
        out = rotation[:, side // 2] * (1 if side % 2 else -1)
        axis = int(np.abs(out).argmax())
        if not _is_buried(box, axis, out[axis] > 0, mount, blocks):
            shown.append(pair)
    return corners, (np.concatenate(shown) if shown else triangles)


def _is_buried(box: Box, axis: int, upper: bool, mount: Mount, blocks: Sequence[Box]) -> bool:
    """Whether the upper or lower face of a box across an axis cannot be seen."""
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
"""Which faces lie on what an item is mounted on: mount, axis, upper face or lower."""


def _is_square(geom: Geom) -> bool:
    """Whether a geom is turned by nothing but quarter turns."""
    return all(abs(math.remainder(angle, math.pi / 2)) < 1e-3 for angle in geom.euler_rad)


def _mesh_of(parts: Sequence[tuple[Geom, Facets]], look: Look) -> Geom:
    """One visual mesh of some geoms, its origin in the middle of them; a single geom as it was."""
    if len(parts) == 1:
        return parts[0][0]
    points, faces, start = [], [], 0
    for geom, (corners, triangles) in parts:
        points.append(np.array(geom.pos_m) + corners @ matrix_from_euler(*geom.euler_rad).T)
        faces.append(triangles + start)
        start += len(corners)
    every = np.vstack(points)
    middle = np.round(0.5 * (every.min(axis=0) + every.max(axis=0)), 4)
    mesh = mesh_shape("j", every - middle, np.vstack(faces))
    return Geom("mesh", (), (float(middle[0]), float(middle[1]), float(middle[2])), look, solid=False, mesh=mesh)


# ---- touched -------------------------------------------------------------------------------------------------------


def collision_boxes(solid: Sequence[Geom], item: Item) -> list[Geom]:
    """What is touched in place of some solid parts of an item: fewer shapes that the robot cannot tell from them."""
    if not solid:
        return []
    parts: list[tuple[Box, Geom | None]] = [(_bounds(geom), geom) for geom in solid]
    if item.category in BLOCKS:
        return [_box_geom(functools.reduce(_union, (box for box, _ in parts)))]
    parts = _under_plate(parts, item)
    out_of_reach = item.mount != "floor"
    while (pair := _best_pair(parts, item.surfaces, out_of_reach)) is not None:
        i, j = pair
        joined = _union(parts[i][0], parts[j][0])
        parts = [part for n, part in enumerate(parts) if n not in pair] + [(joined, None)]
    return [geom if geom is not None else _box_geom(box) for box, geom in parts]


def _under_plate(parts: list[tuple[Box, Geom | None]], item: Item) -> list[tuple[Box, Geom | None]]:
    """Legs and rails under the largest plate of a small thing become one block with it."""
    if max(item.size_m[:2]) > SMALL_ITEM_M:
        return parts
    top = max((geom for geom in item.geoms if geom.solid), key=lambda geom: _plan_m2(_bounds(geom)))
    x0, y0, z0, x1, y1, z1 = _bounds(top)
    shelves = any(0.03 < surface.centre_m[2] < z1 - 0.02 for surface in item.surfaces)
    if shelves or top.shape in ("sphere", "ellipsoid") or z1 < 0.1 or z0 > ROBOT_HEIGHT_M:
        return parts

    def carries(box: Box) -> bool:
        low = box[0] >= x0 - OVERHANG_M and box[1] >= y0 - OVERHANG_M
        return low and box[3] <= x1 + OVERHANG_M and box[4] <= y1 + OVERHANG_M and box[5] <= z1

    under = [part for part in parts if carries(part[0])]
    if len(under) < 2:
        return parts
    block = functools.reduce(_union, (box for box, _ in under))
    return [part for part in parts if not carries(part[0])] + [(block, _drum(block, top))]


def _drum(block: Box, plate: Geom) -> Geom | None:
    """A cylinder in the block, where what it carries is round."""
    if plate.shape != "cylinder" or abs(plate.euler_rad[0]) + abs(plate.euler_rad[1]) > 0.01:
        return None
    box = _box_geom(block)
    return replace(box, shape="cylinder", size_m=(max(box.size_m[:2]), box.size_m[2]))


def _best_pair(
    parts: Sequence[tuple[Box, Geom | None]], surfaces: Sequence[Surface], out_of_reach: bool
) -> tuple[int, int] | None:
    """The two parts between which one box fills least; None where every one would fill too much.

    What hangs, or stands on something, may be filled as far as nothing stands on it.
    """
    best, pair = math.inf if out_of_reach else MAX_FILLED_M3, None
    for i, j in itertools.combinations(range(len(parts)), 2):
        a, b = parts[i][0], parts[j][0]
        joined = _union(a, b)
        filled_m3 = _volume_m3(joined) - _volume_m3(a) - _volume_m3(b)
        filled_m2 = _plan_m2(joined) - _plan_m2(a) - _plan_m2(b) + _plan_m2(_overlap(a, b))
        if (
            filled_m3 < best
            and (out_of_reach or filled_m2 < MAX_FILLED_M2)
            and not _covers_a_top(joined, (a, b), surfaces)
        ):
            best, pair = filled_m3, (i, j)
    return pair


def _covers_a_top(joined: Box, parts: tuple[Box, Box], surfaces: Sequence[Surface]) -> bool:
    """Whether a box takes room above a surface that its parts left free."""
    for surface in surfaces:
        (x, y, z), (hx, hy) = surface.centre_m, surface.half_size_m
        room = (x - hx, y - hy, z + 0.005, x + hx, y + hy, z + ABOVE_SURFACE_M)
        if _volume_m3(_overlap(joined, room)) > sum(_volume_m3(_overlap(part, room)) for part in parts) + 1e-5:
            return True
    return False


def _bounds(geom: Geom) -> Box:
    (x0, y0, z0), (x1, y1, z1) = (corner.tolist() for corner in geom_bounds(geom))
    return x0, y0, z0, x1, y1, z1


def _union(a: Box, b: Box) -> Box:
    return (
        min(a[0], b[0]), min(a[1], b[1]), min(a[2], b[2]),
        max(a[3], b[3]), max(a[4], b[4]), max(a[5], b[5]),
    )  # fmt: skip


def _overlap(a: Box, b: Box) -> Box:
    x, y, z = max(a[0], b[0]), max(a[1], b[1]), max(a[2], b[2])
    return x, y, z, max(x, min(a[3], b[3])), max(y, min(a[4], b[4])), max(z, min(a[5], b[5]))


def _plan_m2(box: Box) -> float:
    return (box[3] - box[0]) * (box[4] - box[1])


def _volume_m3(box: Box) -> float:
    return _plan_m2(box) * (box[5] - box[2])


def _box_geom(box: Box) -> Geom:
    x, y, z = (round(0.5 * (box[i] + box[i + 3]), 4) for i in range(3))
    half = tuple(round(0.5 * (box[i + 3] - box[i]), 4) for i in range(3))
    return Geom("box", half, (x, y, z), Look())
