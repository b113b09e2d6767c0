"""Builds a house of this project from objects of triangles: visual meshes, collision geoms, flat floors, rooms.

Objects get labels as names (`chair_03`), so that the house needs no label rules. Objects that share a shape share its
meshes and collision geoms. Floors collide as flat boxes at the level of their storey, and their visual meshes are made
flat there; ceilings do not collide. The lowest storey comes to z = 0.
"""

from __future__ import annotations

import itertools
import math
import re
import struct
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.core.reading import reason_of
from sim.gl import mujoco
from sim.homes.housegen.floor_plan.rectangles import Rect
from sim.homes.importers.collision import collision_boxes, convex_parts
from sim.homes.importers.floors import LEVEL_M, Storey, find_levels, level_triangles, make_storeys
from sim.homes.importers.losses import Losses
from sim.homes.importers.surfaces import MAX_TRIANGLES, Surface, resized
from sim.homes.importers.visual import Skin, make_skins

Collision = Literal["boxes", "convex"]
STRUCTURE = frozenset(("wall", "floor", "ceiling", "door", "window", "stairs", "railing", "column", "beam", "curtain"))
"""Closed outlines of these categories are not filled: a room inside of walls is free."""
FLAT_M = 0.02
"""Objects that are lower than this above the floor are part of it: rugs do not collide."""
COVER_M = 0.004
"""Largest height of a rug above its floor, with which it hides the floor."""
MIN_VERTICES = 4
"""MuJoCo refuses meshes with fewer; a single triangle gets its last corner again."""
MIN_TRIANGLES = 24
MAX_OBJECTS = 5_000
"""Objects of a house."""
TEXTURE_BYTES = 192 << 20
"""Pictures of a house are reduced until they fit."""
ROOM_M = 2.5
"""Default height of rooms."""
FLOOR_DEPTH_M = 0.1
_KIND = re.compile(r"[^a-z]+")


@dataclass(frozen=True, kw_only=True)
class MeshConfig:
    """Options for building a house from meshes."""

    collision: Collision = "boxes"
    """`boxes` of a grid of 5 cm, or `convex` parts by CoACD, which take longer."""
    triangles: int = 100_000
    """About the largest number of visual triangles of a house."""
    texture_px: int = 1024
    """Largest side of a picture."""


@dataclass(frozen=True, eq=False)
class Shape:
    """The surfaces of an object in its own frame, metres, z up; several objects may share it."""

    surfaces: tuple[Surface, ...]

    @property
    def corners_m(self) -> NDArray[np.float64]:
        """All triangles (m, 3, 3)."""
        return np.concatenate([surface.corners_m for surface in self.surfaces])

    @property
    def area_m2(self) -> float:
        """Area of all triangles."""
        return sum(surface.area_m2 for surface in self.surfaces)


@dataclass(frozen=True, eq=False)
class MeshObject:
    """An object of a house."""

    category: str
    """mpcat40 name."""
    source: str
    """Its type in the source, for the report."""
    shape: Shape
    position_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    """w, x, y, z."""
    mass_kg: float | None = None
    """Mass of an object that can be pushed; None: it is fixed."""
    is_solid: bool = True
    """Whether it collides."""

    @property
    def corners_m(self) -> NDArray[np.float64]:
        """All triangles (m, 3, 3) in the world."""
        return self.shape.corners_m @ rotation_matrix(self.quaternion).T + np.asarray(self.position_m)

    @property
    def surfaces_in_world(self) -> list[Surface]:
        """Its surfaces, moved to its place."""
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = rotation_matrix(self.quaternion), self.position_m
        return [surface.moved(pose) for surface in self.shape.surfaces]


def rotation_matrix(quaternion: Sequence[float]) -> NDArray[np.float64]:
    """Returns the matrix (3, 3) of a unit quaternion w, x, y, z."""
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, np.asarray(quaternion, dtype=np.float64))
    return turn.reshape(3, 3)


@dataclass(frozen=True)
class RoomArea:
    """A room: rectangles in plan, or None for the whole floor of its storey."""

    kind: str
    rects: tuple[Rect, ...]
    z_m: float
    """Height of its floor in the source; the nearest storey counts."""
    height_m: float = ROOM_M


@dataclass(frozen=True)
class MeshHouse:
    """A house, ready to be written."""

    files: Mapping[str, bytes | str]
    """Content by name in the folder of the split."""
    report: Mapping[str, Any]


def build_house(
    name: str, source: str, objects: Sequence[MeshObject], rooms: Sequence[RoomArea], config: MeshConfig,
    losses: Losses, *, ambient: float | None = None,
) -> MeshHouse:  # fmt: skip
    """Returns the files of a house and its report.

    Args:
        name: of the house.
        source: file of the source, for the report.
        objects: everything, in our frame.
        rooms: empty: each storey is one room.
        config: options.
        losses: gets the changes.
        ambient: light from all sides, for pictures that were taken with their light; None: as `load_house` adds it.

    Raises:
        HouseError: the floor is missing, or MuJoCo cannot build the house; the message does not name the house.
    """
    require_few(len(objects))
    triangles = sum(len(surface.faces) for item in objects for surface in item.shape.surfaces)
    if triangles > MAX_TRIANGLES:
        raise HouseError(f"it shows {triangles:,} triangles; at most {MAX_TRIANGLES:,} are allowed.")
    floors = _together([item for item in objects if item.category == "floor"])
    levels = find_levels(floors)
    solids = [item for item in objects if item.is_solid and item.category not in ("floor", "ceiling")]
    storeys = make_storeys(levels, floors, _together([item for item in solids if item.category not in STRUCTURE]))
    builder = _Builder(name, config, levels, losses)
    if ambient is not None:
        builder.set_ambient(ambient)
    builder.add_floors(storeys)
    builder.add_objects(objects)
    top_m = max(float(item.corners_m[..., 2].max()) for item in objects) - levels[-1]
    areas_m2 = builder.add_rooms(rooms or _whole_storeys(storeys, top_m), storeys)
    report = {
        "house": name, "source": source, "rooms": len(areas_m2), "area_m2": round(sum(areas_m2), 2),
        "storeys": len(levels),
        "lowered_m": round(levels[0], 4), "triangles": builder.triangles, "collision_geoms": builder.collision_geoms,
        "texture_mb": round(builder.texture_bytes / 1e6, 1), **losses.as_json(),
    }  # fmt: skip
    return MeshHouse(builder.files(), report)


def require_few(objects: int) -> None:
    """Raises HouseError if a house has more than `MAX_OBJECTS` objects."""
    if objects > MAX_OBJECTS:
        raise HouseError(f"it has {objects:,} objects; at most {MAX_OBJECTS:,} are allowed.")


def _together(objects: Sequence[MeshObject]) -> NDArray[np.float64]:
    """Returns the triangles (m, 3, 3) of several objects in the world."""
    return np.concatenate([item.corners_m for item in objects]) if objects else np.zeros((0, 3, 3))


def _whole_storeys(storeys: Sequence[Storey], top_m: float) -> list[RoomArea]:
    """Returns a room for each storey."""
    heights = [b.z_m - a.z_m for a, b in itertools.pairwise(storeys)] + [top_m]
    return [
        RoomArea("room", tuple(storey.floor.rectangles(covered=0.99)), storey.z_m, min(max(height, 1.8), 4.0))
        for storey, height in zip(storeys, heights, strict=True)
    ]


@dataclass(frozen=True)
class _Parts:
    """The parts of a shape in the house: names of its visual meshes with their materials, and its collision geoms."""

    skins: tuple[tuple[str, str], ...]
    triangles: int
    boxes_m: NDArray[np.float64]  # (n, 6)
    hulls: tuple[str, ...]
    """Names of convex meshes."""

    @property
    def solids(self) -> int:
        """Number of collision geoms."""
        return len(self.boxes_m) + len(self.hulls)


class _Builder:
    """Collects the parts of a house in one `MjSpec` with its files."""

    def __init__(self, name: str, config: MeshConfig, levels_m: Sequence[float], losses: Losses) -> None:
        self._name, self._config, self._losses = name, config, losses
        self._levels_m, self._down_m = levels_m, levels_m[0]
        self._files: dict[str, bytes] = {}
        self._counts = Counter[str]()
        self._materials: dict[tuple[object, ...], str] = {}
        self._textures: dict[int, str] = {}
        self._kept: list[NDArray[np.uint8] | None] = []  # so that no other picture gets the same identity
        self._parts: dict[tuple[int, str, bool], tuple[Shape, _Parts]] = {}
        self._texture_px, self._meshes = config.texture_px, 0
        self.triangles = self.collision_geoms = self.texture_bytes = 0
        self.spec = mujoco.MjSpec()
        self.spec.modelname = name
        self._visual = self.spec.add_default("seen", self.spec.default)
        self._visual.geom.type = mujoco.mjtGeom.mjGEOM_MESH
        self._visual.geom.contype = self._visual.geom.conaffinity = 0
        self._visual.geom.mass = 0.0
        self._hit = self.spec.add_default("hit", self.spec.default)
        self._hit.geom.type, self._hit.geom.group = mujoco.mjtGeom.mjGEOM_BOX, 3
        self.spec.default.mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL  # scans are open surfaces

    def set_ambient(self, ambient: float) -> None:
        """Sets light from all sides."""
        light = self.spec.visual.headlight
        light.ambient, light.diffuse, light.specular = [ambient] * 3, [1.0 - ambient] * 3, [0.0] * 3

    def files(self) -> dict[str, bytes | str]:
        """Returns the files of the house; raises HouseError if MuJoCo cannot build it."""
        self.spec.assets = dict(self._files)
        try:
            self.spec.compile()
            text = self.spec.to_xml()
        except (ValueError, MemoryError) as error:
            raise HouseError(f"MuJoCo cannot build it: {reason_of(error)}.") from None
        return {f"{self._name}.xml": text, **self._files}

    def add_floors(self, storeys: Sequence[Storey]) -> None:
        """Adds the boxes that carry the wheels."""
        for storey in storeys:
            for rect in storey.floor.rectangles(covered=1.0, most=100_000):
                x, y = rect.centre
                self.spec.worldbody.add_geom(
                    self._hit, name=self._label("floor"),
                    pos=_rounded(x, y, storey.z_m - self._down_m - FLOOR_DEPTH_M / 2),
                    size=_rounded(rect.width_m / 2, rect.depth_m / 2, FLOOR_DEPTH_M / 2),
                )  # fmt: skip

    def add_rooms(self, rooms: Sequence[RoomArea], storeys: Sequence[Storey]) -> list[float]:
        """Adds the sites of rooms; returns the area of each, m2."""
        rooms_found, counts = [], Counter[str]()
        for room in rooms:
            storey = min(storeys, key=lambda level: abs(level.z_m - room.z_m))
            rects = storey.floor.within(room.rects)
            kind = _KIND.sub("_", room.kind.lower()).strip("_") or "room"
            for part, rect in enumerate(rects):
                x, y = rect.centre
                name = f"room_{kind}_{counts[kind]:02d}" + (f"_{part}" if part else "")
                self.spec.worldbody.add_site(
                    name=name, type=mujoco.mjtGeom.mjGEOM_BOX, group=4,
                    pos=_rounded(x, y, storey.z_m - self._down_m + room.height_m / 2),
                    size=_rounded(rect.width_m / 2, rect.depth_m / 2, room.height_m / 2),
                )  # fmt: skip
            if rects:
                counts[kind] += 1
                rooms_found.append(sum(rect.area_m2 for rect in rects))
        return rooms_found

    def add_objects(self, objects: Sequence[MeshObject]) -> None:
        """Adds all objects."""
        objects = [self._flattened(item) if item.category == "floor" else item for item in objects]
        self._texture_px = _texture_px(objects, self._config.texture_px)
        budgets = self._budgets(objects)
        for item in objects:
            self._add_object(item, budgets[id(item.shape)])

    def _flattened(self, item: MeshObject) -> MeshObject:
        """Returns a floor in the world; vertices near a storey are moved to its level, those of rugs just above it."""
        made, most_m = [], 0.0
        for surface in item.surfaces_in_world:
            vertices = surface.vertices_m.copy()
            used = np.zeros(len(vertices), dtype=np.bool_)
            used[surface.faces[level_triangles(surface.corners_m)]] = True
            for level in self._levels_m:
                above = vertices[:, 2] - level
                near = used & (np.abs(above) <= LEVEL_M)
                if near.any():
                    most_m = max(most_m, float(np.abs(above[near]).max()))
                    vertices[near, 2] = level + np.clip(np.median(above[near]), 0.0, COVER_M)
            made.append(replace(surface, vertices_m=vertices))
        if most_m > 0.01:
            self._losses.changes["A floor was uneven and was made flat."] += 1
        return replace(item, shape=Shape(tuple(made)), position_m=(0.0, 0.0, 0.0), quaternion=(1.0, 0.0, 0.0, 0.0))

    def _budgets(self, objects: Sequence[MeshObject]) -> dict[int, int]:
        """Returns the number of triangles of each shape: all of them, or shares by number and area."""
        copies = Counter(id(item.shape) for item in objects)
        shapes = {id(item.shape): item.shape for item in objects}
        counts = {key: sum(len(surface.faces) for surface in shape.surfaces) for key, shape in shapes.items()}
        total, most = sum(counts[key] * copies[key] for key in shapes), self._config.triangles
        if total <= most:
            return counts
        weights = {key: math.sqrt(counts[key] * max(shape.area_m2, 1e-6)) for key, shape in shapes.items()}
        share = most / sum(weights[key] * copies[key] for key in shapes)
        self._losses.changes[f"Triangles were reduced to about {most}."] += 1
        return {key: max(MIN_TRIANGLES, int(weights[key] * share)) for key in shapes}

    def _add_object(self, item: MeshObject, budget: int) -> None:
        parts = self._parts_of(item, budget)
        if not parts.skins:
            self._losses.left_out[f"{item.source}: it has no area"] += 1
            return
        x, y, z = item.position_m
        body = self.spec.worldbody.add_body(
            name=self._label(item.category), pos=_rounded(x, y, z - self._down_m), quat=list(item.quaternion)
        )
        for mesh, material in parts.skins:
            body.add_geom(self._visual, meshname=mesh, material=material)
        self.triangles += parts.triangles
        if item.mass_kg is not None and parts.solids:
            body.add_freejoint()
            self._losses.changes["An object can be pushed."] += 1
        made = [body.add_geom(self._hit, pos=_rounded(*(0.5 * (box[:3] + box[3:]))),
                              size=_rounded(*(0.5 * (box[3:] - box[:3])))) for box in parts.boxes_m]  # fmt: skip
        made += [body.add_geom(self._hit, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name) for name in parts.hulls]
        self.collision_geoms += len(made)
        if item.mass_kg is not None:
            for geom in made:
                geom.mass = item.mass_kg / len(made)

    def _parts_of(self, item: MeshObject, budget: int) -> _Parts:
        """Returns the parts of the shape of an object; computed once for objects of one shape that collide alike."""
        collides = item.is_solid and item.category not in ("floor", "ceiling") and not self._is_flat(item)
        key = (id(item.shape), item.category, collides)
        if key not in self._parts:
            self._parts[key] = (item.shape, self._made_parts(item, budget, collides=collides))
        return self._parts[key][1]

    def _made_parts(self, item: MeshObject, budget: int, *, collides: bool) -> _Parts:
        skins = [skin for skin in make_skins(item.shape.surfaces, budget, self._texture_px) if len(skin.faces)]
        names = tuple((self._add_mesh(skin), self._material(skin)) for skin in skins)
        triangles = sum(len(skin.faces) for skin in skins)
        boxes, hulls = np.zeros((0, 6)), ()
        if skins and collides:
            if self._config.collision == "convex":
                hulls = tuple(self._add_hull(points) for points in convex_parts(item.shape.surfaces))
            else:
                boxes = collision_boxes(item.shape.corners_m, is_filled=item.category not in STRUCTURE)
        return _Parts(names, triangles, boxes, hulls)

    def _is_flat(self, item: MeshObject) -> bool:
        """Returns whether an object lies flat on a floor, as a rug does."""
        z = item.corners_m[..., 2]
        return any(level - LEVEL_M <= z.min() and z.max() <= level + FLAT_M for level in self._levels_m)

    def _add_mesh(self, skin: Skin) -> str:
        count = len(skin.vertices_m)
        normals = np.zeros((0, 3)) if skin.normals is None else skin.normals
        # MuJoCo's texture coordinates point down; its own reader of OBJ files turns them too.
        uv = np.zeros((0, 2)) if skin.uv is None else np.stack([skin.uv[:, 0], 1.0 - skin.uv[:, 1]], axis=1)
        more = max(0, MIN_VERTICES - count)
        rows = [np.concatenate([array, array[-1:].repeat(more, axis=0)]) for array in (skin.vertices_m, normals, uv)]
        content = struct.pack("<4i", *map(len, rows), len(skin.faces))
        content += b"".join(array.astype("<f4").tobytes() for array in rows)
        return self._put_mesh(content + skin.faces.astype("<i4").tobytes())

    def _add_hull(self, points: NDArray[np.float64]) -> str:
        # MuJoCo computes the convex hull of the vertices; a mesh needs one triangle.
        content = struct.pack("<4i", len(points), 0, 0, 1) + points.astype("<f4").tobytes()
        return self._put_mesh(content + np.array([0, 1, 2], "<i4").tobytes())

    def _put_mesh(self, content: bytes) -> str:
        name = f"m{self._meshes:04d}"
        self._meshes += 1
        file = f"{self._name}_files/{name}.msh"
        self._files[file] = content
        self.spec.add_mesh(name=name, file=file)
        return name

    def _material(self, skin: Skin) -> str:
        """Returns the name of a material of a colour and a picture; equal ones are written once."""
        key = (id(skin.picture), skin.rgba)
        if key not in self._materials:
            name = f"look_{len(self._materials):04d}"
            made = self.spec.add_material(name=name, rgba=[round(v, 4) for v in skin.rgba], specular=0.0, shininess=0.0)
            if skin.picture is not None:
                made.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = self._texture(skin.picture)
            self._materials[key] = name
            self._kept.append(skin.picture)
        return self._materials[key]

    def _texture(self, picture: NDArray[np.uint8]) -> str:
        """Returns the name of the texture of a picture."""
        if id(picture) not in self._textures:
            small = resized(picture, self._texture_px)
            name = f"t{len(self._textures):04d}"
            file = f"{self._name}_files/{name}.png"
            self._files[file] = cv2.imencode(".png", small[..., ::-1])[1].tobytes()
            self.spec.add_texture(name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, file=file)
            self.texture_bytes += small.nbytes
            self._textures[id(picture)] = name
        return self._textures[id(picture)]

    def _label(self, category: str) -> str:
        number = self._counts[category]
        self._counts[category] += 1
        return f"{category}_{number:02d}"


def _texture_px(objects: Sequence[MeshObject], most_px: int) -> int:
    """Returns the largest side of pictures with which all of them fit into `TEXTURE_BYTES`."""
    pictures = {
        id(surface.paint.picture): surface.paint.picture for item in objects for surface in item.shape.surfaces
        if surface.paint.picture is not None
    }  # fmt: skip
    while most_px > 64 and sum(_bytes(picture, most_px) for picture in pictures.values()) > TEXTURE_BYTES:
        most_px //= 2
    return most_px


def _bytes(picture: NDArray[np.uint8], most_px: int) -> float:
    return picture.nbytes * min(1.0, most_px / max(picture.shape[:2])) ** 2


def _rounded(*values: float) -> list[float]:
    """Returns values rounded to 0.1 mm, without a negative zero."""
    return [round(float(value), 4) + 0.0 for value in values]
