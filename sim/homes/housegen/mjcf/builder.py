"""Builds a standalone MuJoCo specification in the house format (docs/houses.md) from placed items."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Generic, TypeVar

import numpy as np

from sim.core.paths import assets_dir
from sim.gl import mujoco
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.housegen.furniture.item import Geom, Item, Look, MeshShape
from sim.homes.housegen.furniture.transforms import bounds
from sim.homes.housegen.mjcf.appearance import facts_of
from sim.homes.housegen.mjcf.merging import assemble
from sim.homes.housegen.mjcf.movables import ROLLING_M, Movable, split_movable
from sim.homes.housegen.mjcf.placed import Hinge, Lamp, PlacedItem
from sim.homes.housegen.surfaces.materials import texture_file, texture_mapping

T = TypeVar("T")
TEXTURE_DIR = "../textures"
"""Folder of the textures, relative to the house file."""
AMBIENT, HEADLIGHT = 0.36, 0.12
"""Ambient light and light from the camera: without them, walls that no lamp faces look black."""
LEAF_KG_M2 = 8.0
"""Mass of a door leaf for its area: light inner doors with a core of cardboard or chipboard weigh 6 to 12 kg/m2."""
HINGE_DAMPING, HINGE_FRICTION_NM = 1.0, 1.0
"""Damping in N m s/rad, and friction: 1.2 N at the edge of the leaf move it. Accessible inner doors may need 22 N (ADA
Standards for Accessible Design, 404.2.9)."""
_HALF_WAY_M = 1e-9
_VISUAL, _VISUAL_MESH, _COLLISION = "seen", "skin", "hit"
"""Default classes of visual-only geoms, of visual-only meshes, and of collision-only geoms."""
_SHAPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    "mesh": mujoco.mjtGeom.mjGEOM_MESH,
}
MESH_UNIT_M = 1e-3
"""Mesh vertices are written as whole multiples of this length, which takes half the bytes of metres."""


class HouseBuilder:
    """A builder that collects the parts of a house in one `MjSpec`; equal looks and meshes are written once."""

    def __init__(self, name: str) -> None:
        """Begins an empty house with this name."""
        self._spec = mujoco.MjSpec()
        self._spec.modelname = name
        self._spec.texturedir = TEXTURE_DIR
        # Only for compiling in memory: the folder of a shipped house. It is not written to the file.
        self._spec.modelfiledir = str(assets_dir() / "val")
        light = self._spec.visual.headlight
        light.ambient, light.diffuse, light.specular = [AMBIENT] * 3, [HEADLIGHT] * 3, [0.0] * 3
        self._spec.default.geom.type = mujoco.mjtGeom.mjGEOM_BOX  # most are: shorter XML
        self._visual = self._spec.add_default(_VISUAL, self._spec.default)
        self._visual.geom.contype = 0
        self._visual.geom.conaffinity = 0
        self._visual_mesh = self._spec.add_default(_VISUAL_MESH, self._visual)
        self._visual_mesh.geom.type = mujoco.mjtGeom.mjGEOM_MESH
        self._collision = self._spec.add_default(_COLLISION, self._spec.default)
        self._collision.geom.group = 3
        self._spec.default.mesh.scale = [MESH_UNIT_M] * 3
        self._spec.default.mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL  # some show only their front
        self._assembly = _OncePerItem(assemble)
        self._split = _OncePerItem(split_movable)
        self._facts = _OncePerItem(lambda item: facts_of(item).text())
        self._frictions: dict[str, mujoco.MjsDefault] = {}
        self._counts: dict[str, int] = {}
        self._assets = AssetTable(self._spec)
        self.styles: dict[str, str] = {}
        """Style of each item by the name of its body, which is the label of its instance."""

    @property
    def spec(self) -> mujoco.MjSpec:
        """The specification built so far."""
        return self._spec

    def add(self, placed: PlacedItem) -> str:
        """Adds an item and its children; returns the name of its body."""
        at = (placed.x_m, placed.y_m, placed.z_m)
        name = self._add_body(self._spec.worldbody, placed.item, at, placed.yaw_rad)
        if placed.hinge is not None:
            self._hang(self._spec.body(name), placed.item, placed.hinge)
        return name

    def _hang(self, body: mujoco.MjsBody, leaf: Item, hinge: Hinge) -> None:
        """Hangs the body of a door leaf on its hinge; at the lower end of the joint's range it closes the doorway."""
        low, high = bounds(leaf.geoms)
        width_m, height_m = float(high[0] - low[0]), float(high[2] - low[2])
        mass_kg = LEAF_KG_M2 * width_m * height_m
        body.explicitinertial = True
        body.mass = _r(mass_kg)
        body.ipos = [_r(width_m / 2), 0.0, _r((low[2] + high[2]) / 2)]
        depth_m = float(high[1] - low[1])
        body.inertia = [
            _r(mass_kg / 12.0 * (a**2 + b**2))
            for a, b in ((depth_m, height_m), (width_m, height_m), (width_m, depth_m))
        ]
        body.add_joint(
            name=f"{body.name}_hinge", type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=[0.0, 0.0, 1.0 if hinge.turns_left else -1.0], limited=mujoco.mjtLimited.mjLIMITED_TRUE,
            range=[round(math.degrees(at - hinge.angle_rad), 2) for at in (0.0, hinge.widest_rad)],
            damping=HINGE_DAMPING, frictionloss=HINGE_FRICTION_NM,
        )  # fmt: skip

    def add_movable(self, placed: PlacedItem) -> None:
        """Adds an item so that the robot can push it, or those parts of it that are light and separate."""
        rest, movables = self._split(placed.item)
        if rest is not None:
            self.add(replace(placed, item=rest))
        for movable in movables:
            self.add_movable_body(movable, placed)

    def add_ground(self, rect: Rect, z_m: float = 0.0) -> None:
        """Adds an invisible slab that carries the wheels, its top at `z_m`."""
        x, y = rect.centre
        self._spec.worldbody.add_geom(
            name=self._label("floor"), type=mujoco.mjtGeom.mjGEOM_BOX, group=3,
            size=[_r(rect.width_m / 2), _r(rect.depth_m / 2), 0.05], pos=[_r(x), _r(y), _r(z_m - 0.05)],
        )  # fmt: skip

    def add_room(self, name: str, rect: Rect, height_m: float, z_m: float = 0.0) -> None:
        """Adds the site that marks a room, which extends between its walls, with its floor at `z_m`."""
        self.add_box_site(name, (rect.x0, rect.y0, z_m), (rect.x1, rect.y1, z_m + height_m))

    def add_box_site(self, name: str, low_m: Sequence[float], high_m: Sequence[float]) -> None:
        """Adds a site that marks the axis-aligned box between two corners; it is never rendered."""
        self._spec.worldbody.add_site(
            name=name, type=mujoco.mjtGeom.mjGEOM_BOX, group=4,
            pos=[_r((a + b) / 2) for a, b in zip(low_m, high_m, strict=True)],
            size=[_r((b - a) / 2) for a, b in zip(low_m, high_m, strict=True)],
        )  # fmt: skip

    def add_collision_geoms(self, body: str, geoms: Sequence[Geom]) -> None:
        """Adds geoms to a body that collide and are not rendered."""
        for geom in geoms:
            self._add_shape(self._spec.body(body).add_geom(self._collision, type=_SHAPES[geom.shape]), geom)

    def set_ambient(self, ambient: tuple[float, float, float]) -> None:
        """Sets the ambient light of the whole home."""
        self._spec.visual.headlight.ambient = list(ambient)

    def add_lamp(self, lamp: Lamp) -> None:
        """Adds a light; it has no label, because it is not visible itself."""
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

    def add_movable_body(self, movable: Movable, placed: PlacedItem) -> None:
        """Adds a body with a free joint at the pose of the item that it was part of."""
        name = self._label(movable.item.category)
        self._describe(name, movable.item)
        x, y = placed.to_world(*movable.offset_m)
        body = self._spec.worldbody.add_body(
            name=name, pos=[_r(v) for v in (x, y, placed.z_m)], quat=_quat((0.0, 0.0, placed.yaw_rad))
        )
        body.add_freejoint()
        body.explicitinertial = True
        body.mass, body.ipos, body.fullinertia = movable.mass_kg, list(movable.centre_m), list(movable.inertia_kg_m2)
        for geom in self._assembly(movable.item).visual:
            self._add_geom(body, geom)
        collision = self._movable_class(movable)
        for geom in movable.collision_geoms:
            self._add_shape(body.add_geom(collision, type=_SHAPES[geom.shape]), geom)

    def _movable_class(self, movable: Movable) -> mujoco.MjsDefault:
        """Returns the default class of the collision geoms of a movable; its friction overrides the floor's."""
        name = f"slides_{round(100 * movable.friction)}" + ("_rolls" if movable.rolls else "")
        if name not in self._frictions:
            made = self._spec.add_default(name, self._spec.default)
            made.geom.group, made.geom.priority = 3, 1
            made.geom.friction = [movable.friction, 0.005, ROLLING_M if movable.rolls else 0.0001]
            made.geom.condim = 6 if movable.rolls else 3
            self._frictions[name] = made
        return self._frictions[name]

    def _label(self, category: str) -> str:
        """Returns the next free name of a category."""
        number = self._counts.get(category, 0)
        self._counts[category] = number + 1
        return f"{category}_{number:02d}"

    def _describe(self, body: str, item: Item) -> None:
        """Notes the style of a body's item, and writes its facts into the file (`sim.houses.instance_facts`)."""
        self.styles[body] = item.style
        text = self._facts(item)
        if text:
            self._spec.add_text(name=body, data=text)

    def _add_body(self, parent: mujoco.MjsBody, item: Item, pos_m: tuple[float, float, float], yaw_rad: float) -> str:
        name = self._label(item.category)
        self._describe(name, item)
        body = parent.add_body(name=name, pos=[_r(v) for v in pos_m], quat=_quat((0.0, 0.0, yaw_rad)))
        parts = self._assembly(item)
        for geom in parts.visual:
            self._add_geom(body, geom)
        for geom in parts.collision_only:
            self._add_shape(body.add_geom(self._collision, type=_SHAPES[geom.shape]), geom)
        for child in item.children:
            self._add_body(body, child.item, child.pos_m, child.yaw_rad)
        return name

    def _add_geom(self, body: mujoco.MjsBody, geom: Geom) -> None:
        kind = _SHAPES[geom.shape]
        if geom.solid:
            made = body.add_geom(type=kind)  # no class: the standard one is for geoms that are rendered and collide
        else:
            made = body.add_geom(self._visual_mesh if geom.mesh is not None else self._visual, type=kind)
        made.material = self._assets.material(geom.look)
        self._add_shape(made, geom)

    def _add_shape(self, made: mujoco.MjsGeom, geom: Geom) -> None:
        made.pos = [_r(v) for v in geom.pos_m]
        made.quat = _quat(geom.euler_rad)
        if geom.mesh is not None:
            made.meshname = self._assets.mesh(geom.mesh)
        else:
            made.size = [_r(v) for v in geom.size_m] + [0.0] * (3 - len(geom.size_m))


class _OncePerItem(Generic[T]):
    """A function of an item that is computed once for each item object: a home shows most designs more than once."""

    def __init__(self, compute: Callable[[Item], T]) -> None:
        self._compute = compute
        self._known: dict[int, tuple[Item, T]] = {}  # keeps the items alive, so that no other one gets their identity

    def __call__(self, item: Item) -> T:
        if id(item) not in self._known:
            self._known[id(item)] = (item, self._compute(item))
        return self._known[id(item)][1]


def _r(value: float) -> float:
    """Returns a value rounded to 0.1 mm, without a negative zero, for short and stable XML.

    Values half-way between two roundings are common, and processors compute them with other last digits: they are
    rounded up on all.
    """
    return round(float(value) + _HALF_WAY_M, 4) + 0.0


def _quat(euler_rad: tuple[float, float, float]) -> list[float]:
    """Returns the unit quaternion (w, x, y, z) of intrinsic rotations about x, y, z in that order."""
    (cx, sx), (cy, sy), (cz, sz) = ((math.cos(a / 2), math.sin(a / 2)) for a in euler_rad)
    quat = (
        cx * cy * cz - sx * sy * sz,
        sx * cy * cz + cx * sy * sz,
        cx * sy * cz - sx * cy * sz,
        cx * cy * sz + sx * sy * cz,
    )
    return [round(v, 6) + 0.0 for v in quat]


class AssetTable:
    """The materials, textures and meshes of one specification."""

    def __init__(self, spec: mujoco.MjSpec) -> None:
        self._spec = spec
        self._materials: dict[Look, str] = {}
        self._textures: set[str] = set()
        self._meshes: dict[str, str] = {}

    def material(self, look: Look) -> str:
        """Returns the name of the material of a look."""
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

    def mesh(self, mesh: MeshShape) -> str:
        """Returns the name of a mesh in the file; it is short, because each geom of the mesh repeats it."""
        if mesh.name not in self._meshes:
            name = f"{mesh.name.split('_')[0]}{len(self._meshes)}"
            self._meshes[mesh.name] = name
            made = self._spec.add_mesh(name=name)
            made.uservert = np.rint(mesh.vertices_m / MESH_UNIT_M).ravel().tolist()
            if len(mesh.faces):
                made.userface = mesh.faces.astype(int).ravel().tolist()
            if mesh.texture_uv is not None:
                made.usertexcoord = mesh.texture_uv.ravel().tolist()
        return self._meshes[mesh.name]
