"""From placed items to a standalone MuJoCo specification that keeps the house format (contract, section 3)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.houses.furniture.item import Child, Geom, Item, Look, MeshShape
from sim.houses.furniture.shapes import MAX_VERTICES, named_mesh
from sim.houses.furniture.workbench import matrix_from_euler
from sim.houses.geometry import Rect
from sim.houses.materials import texture_file, texture_mapping

ASSETS_DIR = Path(__file__).resolve().parents[2] / "assets" / "mjcf_houses"
TEXTURE_DIR = "../textures"
"""Where a house file finds its textures, relative to itself."""
AMBIENT, HEADLIGHT = 0.36, 0.12
"""Light from everywhere, and from the camera: without some of both, walls that no lamp faces look black."""
REPEATED = frozenset(("lighting",))
"""Categories whose items a home has many times over, so that their meshes are written once."""
SLAT_HALF_M = 0.035
"""Narrower visual boxes lose their texture when they are joined with their like."""
_SEEN = "seen"
"""Default class of geoms that nothing touches."""
_SHAPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    "mesh": mujoco.mjtGeom.mjGEOM_MESH,
}


@dataclass(frozen=True)
class Placed:
    """An item at its place in the world: its origin, and the heading of its front."""

    item: Item
    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0
    yaw_rad: float = 0.0


@dataclass(frozen=True)
class RoomBox:
    """A room as the house file shows it: a name and the extent between its walls."""

    name: str
    rect: Rect


@dataclass(frozen=True)
class Lamp:
    """A light of the scene. With a `direction` it is the same everywhere, else it shines from `pos_m`."""

    pos_m: tuple[float, float, float]
    diffuse: tuple[float, float, float]
    direction: tuple[float, float, float] | None = None
    shadow: bool = False


class HouseBuilder:
    """Collects a house's parts in one `MjSpec`; equal looks and meshes are written once."""

    def __init__(self, name: str) -> None:
        self._spec = mujoco.MjSpec()
        self._spec.modelname = name
        self._spec.texturedir = TEXTURE_DIR
        # Only for compiling in memory: the directory a shipped house lies in. It is not written to the file.
        self._spec.modelfiledir = str(ASSETS_DIR / "val")
        light = self._spec.visual.headlight
        light.ambient, light.diffuse, light.specular = [AMBIENT] * 3, [HEADLIGHT] * 3, [0.0] * 3
        self._spec.default.geom.type = mujoco.mjtGeom.mjGEOM_BOX  # most are: shorter XML
        seen = self._spec.add_default(_SEEN, self._spec.default)
        seen.geom.contype = 0
        seen.geom.conaffinity = 0
        self._seen = seen
        self._counts: dict[str, int] = {}
        self._materials: dict[Look, str] = {}
        self._textures: set[str] = set()
        self._meshes: set[str] = set()

    @property
    def spec(self) -> mujoco.MjSpec:
        """The specification built so far."""
        return self._spec

    def add(self, placed: Placed) -> str:
        """Add an item and its children; returns the name that its body got."""
        at = (placed.x_m, placed.y_m, placed.z_m)
        return self._add_body(self._spec.worldbody, placed.item, at, placed.yaw_rad)

    def add_ground(self, rect: Rect) -> None:
        """The slab that wheels run on: invisible, its top at z = 0."""
        x, y = rect.centre
        self._spec.worldbody.add_geom(
            name=self._label("floor"), type=mujoco.mjtGeom.mjGEOM_BOX, group=3,
            size=[_r(rect.width_m / 2), _r(rect.depth_m / 2), 0.05], pos=[_r(x), _r(y), -0.05],
        )  # fmt: skip

    def add_room(self, room: RoomBox, height_m: float) -> None:
        """The site that tells where a room is."""
        x, y = room.rect.centre
        self._spec.worldbody.add_site(
            name=room.name, type=mujoco.mjtGeom.mjGEOM_BOX, group=4, pos=[_r(x), _r(y), _r(height_m / 2)],
            size=[_r(room.rect.width_m / 2), _r(room.rect.depth_m / 2), _r(height_m / 2)],
        )  # fmt: skip

    def add_lamp(self, lamp: Lamp) -> None:
        """A light; it is no thing to be seen, so it has no label."""
        light = self._spec.worldbody.add_light()
        light.pos = list(lamp.pos_m)
        light.diffuse = list(lamp.diffuse)
        light.ambient = [0.0, 0.0, 0.0]
        light.specular = [0.5 * v for v in lamp.diffuse]
        light.castshadow = lamp.shadow
        if lamp.direction is not None:
            light.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
            light.dir = list(lamp.direction)
        else:
            light.type = mujoco.mjtLightType.mjLIGHT_SPOT
            light.dir = [0.0, 0.0, -1.0]
            light.cutoff = 85.0
            light.exponent = 1.0
            light.attenuation = [1.0, 0.0, 0.06]

    def _label(self, category: str) -> str:
        number = self._counts.get(category, 0)
        self._counts[category] = number + 1
        return f"{category}_{number:02d}"

    def _add_body(self, parent: mujoco.MjsBody, item: Item, pos_m: tuple[float, float, float], yaw_rad: float) -> str:
        name = self._label(item.category)
        body = parent.add_body(name=name, pos=[_r(v) for v in pos_m], quat=_yaw_quat(yaw_rad))
        for geom in merged(item.geoms, rounds=item.category in REPEATED):
            self._add_geom(body, geom)
        for child in item.children:
            self._add_child(body, child)
        return name

    def _add_child(self, parent: mujoco.MjsBody, child: Child) -> None:
        self._add_body(parent, child.item, child.pos_m, child.yaw_rad)

    def _add_geom(self, body: mujoco.MjsBody, geom: Geom) -> None:
        kind = _SHAPES[geom.shape]
        # No default class for what is touched: the standard one.
        made = body.add_geom(type=kind) if geom.solid else body.add_geom(self._seen, type=kind)
        made.pos = [_r(v) for v in geom.pos_m]
        made.quat = _quat(geom.euler_rad)
        made.material = self._material(geom.look)
        if geom.mesh is not None:
            made.meshname = self._mesh(geom.mesh)
        else:
            made.size = [_r(v) for v in geom.size_m] + [0.0] * (3 - len(geom.size_m))

    def _material(self, look: Look) -> str:
        if look in self._materials:
            return self._materials[look]
        name = f"m{len(self._materials):02d}"
        self._materials[look] = name
        material = self._spec.add_material(
            name=name, rgba=[round(v, 3) for v in look.rgba], specular=look.specular, shininess=look.shininess,
            emission=look.emission,
        )  # fmt: skip
        if look.texture is not None:
            textures = list(material.textures)
            textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = self._texture(look.texture)
            material.textures = textures
            uniform, repeat = texture_mapping(look)
            material.texuniform = uniform
            material.texrepeat = [repeat, repeat]
        return name

    def _texture(self, name: str) -> str:
        if name not in self._textures:
            self._textures.add(name)
            self._spec.add_texture(name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, file=texture_file(name))
        return name

    def _mesh(self, mesh: MeshShape) -> str:
        if mesh.name not in self._meshes:
            self._meshes.add(mesh.name)
            made = self._spec.add_mesh(name=mesh.name)
            made.uservert = mesh.vertices_m.astype(float).ravel().tolist()
            if len(mesh.faces):
                made.userface = mesh.faces.astype(int).ravel().tolist()
        return mesh.name


def merged(geoms: Sequence[Geom], *, rounds: bool = False) -> list[Geom]:
    """The same geoms, but those of one look that are only seen joined into one mesh: fewer things to draw.

    A mesh shows no texture, so only plain geoms and slats too narrow to show their grain are joined; cylinders,
    whose meshes make long XML, only on request.
    """
    kept: list[Geom] = []
    groups: dict[Look, list[Geom]] = {}
    for geom in geoms:
        slat = geom.shape == "box" and sorted(geom.size_m)[1] < SLAT_HALF_M
        plain = geom.look.texture is None or slat
        joins = geom.shape == "box" or (rounds and geom.shape == "cylinder")
        if joins and plain and not geom.solid:
            groups.setdefault(replace(geom.look, texture=None), []).append(geom)
        else:
            kept.append(geom)
    for look, alike in groups.items():
        part: list[Geom] = []
        for geom in [*alike, None]:
            if geom is None or sum(len(_facets(g)[0]) for g in [*part, geom]) > MAX_VERTICES:
                kept += [_joined(part, look)] if len(part) > 1 else part
                part = []
            if geom is not None:
                part.append(geom)
    return kept


def _joined(geoms: Sequence[Geom], look: Look) -> Geom:
    """One visual mesh of some geoms, its origin in the middle of them."""
    points, faces, start = [], [], 0
    for geom in geoms:
        corners, triangles = _facets(geom)
        points.append(np.array(geom.pos_m) + corners @ matrix_from_euler(*geom.euler_rad).T)
        faces.append(triangles + start)
        start += len(corners)
    every = np.vstack(points)
    middle = np.round(0.5 * (every.min(axis=0) + every.max(axis=0)), 4)
    mesh = named_mesh("joined", every - middle, np.vstack(faces))
    return Geom("mesh", (), (float(middle[0]), float(middle[1]), float(middle[2])), look, solid=False, mesh=mesh)


def _facets(geom: Geom) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Corners (n, 3) in the geom's frame and triangles (m, 3) of a box, or of a coarse cylinder."""
    if geom.shape == "box":
        return _SIGNS * geom.size_m, _BOX_FACES
    radius, turns = geom.size_m[0], np.arange(_SEGMENTS) * (2 * np.pi / _SEGMENTS)
    ring = radius * np.column_stack([np.cos(turns), np.sin(turns)])
    levels = [(ring, -geom.size_m[1]), (ring, geom.size_m[1])]
    corners = np.vstack([np.column_stack([xy, np.full(_SEGMENTS, z)]) for xy, z in levels])
    faces = []
    for i in range(_SEGMENTS):
        a, b = i, (i + 1) % _SEGMENTS
        faces += [(a, b, b + _SEGMENTS), (a, b + _SEGMENTS, a + _SEGMENTS)]
    for i in range(1, _SEGMENTS - 1):
        faces += [(0, i + 1, i), (_SEGMENTS, _SEGMENTS + i, _SEGMENTS + i + 1)]
    return corners, np.array(faces, dtype=np.int32)


_SEGMENTS = 8
"""Corners of a round geom that became part of a mesh."""
_SIGNS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
_BOX_FACES = np.array(
    [
        tri
        for a, b, c, d in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        for tri in ((a, b, c), (a, c, d))
    ],
    dtype=np.int32,
)
"""Triangles of a box whose corners come in the order of `_SIGNS`, counter-clockwise from outside."""


def _r(value: float) -> float:
    """Rounded to 0.1 mm, without a negative zero: short, stable XML."""
    return round(float(value), 4) + 0.0


def _yaw_quat(yaw_rad: float) -> list[float]:
    return [round(math.cos(yaw_rad / 2), 6) + 0.0, 0.0, 0.0, round(math.sin(yaw_rad / 2), 6) + 0.0]


def _quat(euler_rad: tuple[float, float, float]) -> list[float]:
    """Unit quaternion (w, x, y, z) of intrinsic rotations about x, y, z in that order."""
    (cx, sx), (cy, sy), (cz, sz) = ((math.cos(a / 2), math.sin(a / 2)) for a in euler_rad)
    quat = (
        cx * cy * cz - sx * sy * sz,
        sx * cy * cz + cx * sy * sz,
        cx * sy * cz - sx * cy * sz,
        cx * cy * sz + sx * sy * cz,
    )
    return [round(v, 6) + 0.0 for v in quat]
