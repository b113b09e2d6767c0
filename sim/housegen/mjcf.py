"""From placed items to a standalone MuJoCo specification that keeps the house format (contract, section 3)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sim.gl import mujoco
from sim.housegen.furniture.item import Geom, Item, Look, MeshShape
from sim.housegen.materials import texture_file, texture_mapping
from sim.housegen.merging import BYTES_PER_GEOM, Assembly, assemble
from sim.housegen.movables import ROLLING_M, Movable, split_movable
from sim.housegen.rectangles import Rect
from sim.paths import assets_dir

ASSETS_DIR = Path(__file__).resolve().parents[2] / "assets" / "mjcf_houses"
TEXTURE_DIR = "../textures"
"""Where a house file finds its textures, relative to itself."""
AMBIENT, HEADLIGHT = 0.36, 0.12
"""Light from everywhere, and from the camera: without some of both, walls that no lamp faces look black."""
MESH_UNIT_M = 5e-4
"""Vertices are written in whole units of this: half the bytes of metres."""
_SEEN, _SKIN, _TOUCHED = "seen", "skin", "hit"
"""Default classes of geoms that nothing touches, of meshes among them, and of geoms that nobody sees."""
_SHAPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    "mesh": mujoco.mjtGeom.mjGEOM_MESH,
}


@dataclass(frozen=True)
class PlacedItem:
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

    def __init__(self, name: str, *, bytes_per_geom: int = BYTES_PER_GEOM) -> None:
        self._bytes_per_geom = bytes_per_geom
        self._spec = mujoco.MjSpec()
        self._spec.modelname = name
        self._spec.texturedir = TEXTURE_DIR
        # Only for compiling in memory: the directory a shipped house lies in. It is not written to the file.
        self._spec.modelfiledir = str(assets_dir() / "val")
        light = self._spec.visual.headlight
        light.ambient, light.diffuse, light.specular = [AMBIENT] * 3, [HEADLIGHT] * 3, [0.0] * 3
        self._spec.default.geom.type = mujoco.mjtGeom.mjGEOM_BOX  # most are: shorter XML
        seen = self._spec.add_default(_SEEN, self._spec.default)
        seen.geom.contype = 0
        seen.geom.conaffinity = 0
        self._seen = seen
        self._skin = self._spec.add_default(_SKIN, seen)
        self._skin.geom.type = mujoco.mjtGeom.mjGEOM_MESH
        self._touched = self._spec.add_default(_TOUCHED, self._spec.default)
        self._touched.geom.group = 3
        self._spec.default.mesh.scale = [MESH_UNIT_M] * 3
        self._spec.default.mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL  # some show only their front
        self._copies: dict[int, int] = {}
        self._assemblies: dict[int, tuple[Item, Assembly]] = {}
        self._frictions: dict[str, mujoco.MjsDefault] = {}
        self._loosened: dict[int, tuple[Item, tuple[Item | None, tuple[Movable, ...]]]] = {}
        self._counts: dict[str, int] = {}
        self._materials: dict[Look, str] = {}
        self._textures: set[str] = set()
        self._meshes: dict[str, str] = {}

    @property
    def spec(self) -> mujoco.MjSpec:
        """The specification built so far."""
        return self._spec

    def expect(self, things: Sequence[PlacedItem]) -> None:
        """Be told what will be added: what occurs often may have meshes of its own."""
        for placed in things:
            self._count(placed.item)

    def add(self, placed: PlacedItem) -> str:
        """Add an item and its children; returns the name that its body got."""
        at = (placed.x_m, placed.y_m, placed.z_m)
        return self._add_body(self._spec.worldbody, placed.item, at, placed.yaw_rad)

    def _count(self, item: Item) -> None:
        self._copies[id(item)] = self._copies.get(id(item), 0) + 1
        for child in item.children:
            self._count(child.item)

    def add_movable(self, placed: PlacedItem) -> None:
        """Add an item so that the robot can push it, or what of it is light and free."""
        rest, movables = self._loosen(placed.item)
        if rest is not None:
            self.add(replace(placed, item=rest))
        for thing in movables:
            self._add_movable(thing, placed)

    def _loosen(self, item: Item) -> tuple[Item | None, tuple[Movable, ...]]:
        """What of it stays and what moves; worked out once for each design."""
        if id(item) not in self._loosened:
            self._loosened[id(item)] = (item, split_movable(item))
            rest, movables = self._loosened[id(item)][1]
            for part in (rest, *(thing.item for thing in movables)):
                if part is not None:
                    self._copies[id(part)] = self._copies.get(id(item), 1)
        return self._loosened[id(item)][1]

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

    def _add_movable(self, thing: Movable, placed: PlacedItem) -> None:
        name = self._label(thing.item.category)
        c, s = math.cos(placed.yaw_rad), math.sin(placed.yaw_rad)
        x, y = placed.x_m + c * thing.at_m[0] - s * thing.at_m[1], placed.y_m + s * thing.at_m[0] + c * thing.at_m[1]
        body = self._spec.worldbody.add_body(
            name=name, pos=[_r(v) for v in (x, y, placed.z_m)], quat=_yaw_quat(placed.yaw_rad)
        )
        body.add_freejoint()
        body.explicitinertial = True
        body.mass, body.ipos, body.fullinertia = thing.mass_kg, list(thing.centre_m), list(thing.inertia_kg_m2)
        for geom in self._assembly(thing.item).drawn:
            self._add_geom(body, geom)
        slides = self._slides(thing)
        for geom in thing.touched:
            self._add_shape(body.add_geom(slides, type=_SHAPES[geom.shape]), geom)

    def _slides(self, thing: Movable) -> mujoco.MjsDefault:
        """Default class of what touches like this thing; its friction wins over the floor's."""
        name = f"slides_{round(100 * thing.friction)}" + ("_rolls" if thing.rolls else "")
        if name not in self._frictions:
            made = self._spec.add_default(name, self._spec.default)
            made.geom.group, made.geom.priority = 3, 1
            made.geom.friction = [thing.friction, 0.005, ROLLING_M if thing.rolls else 0.0001]
            made.geom.condim = 6 if thing.rolls else 3
            self._frictions[name] = made
        return self._frictions[name]

    def _label(self, category: str) -> str:
        number = self._counts.get(category, 0)
        self._counts[category] = number + 1
        return f"{category}_{number:02d}"

    def _add_body(self, parent: mujoco.MjsBody, item: Item, pos_m: tuple[float, float, float], yaw_rad: float) -> str:
        name = self._label(item.category)
        body = parent.add_body(name=name, pos=[_r(v) for v in pos_m], quat=_yaw_quat(yaw_rad))
        parts = self._assembly(item)
        for geom in parts.drawn:
            self._add_geom(body, geom)
        for geom in parts.touched:
            self._add_shape(body.add_geom(self._touched, type=_SHAPES[geom.shape]), geom)
        for child in item.children:
            self._add_body(body, child.item, child.pos_m, child.yaw_rad)
        return name

    def _assembly(self, item: Item) -> Assembly:
        """The item's parts; worked out once for each design."""
        if id(item) not in self._assemblies:
            self._assemblies[id(item)] = (item, assemble(item, self._bytes_per_geom * self._copies.get(id(item), 1)))
        return self._assemblies[id(item)][1]

    def _add_geom(self, body: mujoco.MjsBody, geom: Geom) -> None:
        kind = _SHAPES[geom.shape]
        if geom.solid:
            made = body.add_geom(type=kind)  # of no class: the standard one is for what is seen and touched
        else:
            made = body.add_geom(self._skin if geom.mesh is not None else self._seen, type=kind)
        made.material = self._material(geom.look)
        self._add_shape(made, geom)

    def _add_shape(self, made: mujoco.MjsGeom, geom: Geom) -> None:
        made.pos = [_r(v) for v in geom.pos_m]
        made.quat = _quat(geom.euler_rad)
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
        """Name of the mesh in the file: short, since each of its geoms repeats it."""
        if mesh.name not in self._meshes:
            name = f"{mesh.name.split('_')[0]}{len(self._meshes)}"
            self._meshes[mesh.name] = name
            made = self._spec.add_mesh(name=name)
            made.uservert = np.rint(mesh.vertices_m / MESH_UNIT_M).ravel().tolist()
            if len(mesh.faces):
                made.userface = mesh.faces.astype(int).ravel().tolist()
        return self._meshes[mesh.name]


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
