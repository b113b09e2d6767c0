"""Reads scenes of Habitat's scene data sets (HSSD, ReplicaCAD and others): a stage with objects at their places.

Objects of one configuration and size share their shape. The category of an object is its class in the data set
(`semantic_id`), else its entry in a table, else the words of its name. If the nodes of a stage are not named after
parts of a building, the stage is divided by geometry: level triangles at the height of a floor are floor, those that
face down above are ceiling, all others are wall. An object with missing or broken files is left out and reported.
"""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError, HouseError
from sim.core.reading import printable, read_json
from sim.homes.importers.floors import LEVEL_M, PLAN_CELL_M, Plan, find_levels
from sim.homes.importers.habitat_files import (  # fmt: skip
    SCENE,
    Attributes,
    ObjectInstance,
    Region,
    SceneDataset,
    SceneInstance,
    Semantics,
    Template,
)
from sim.homes.importers.habitat_names import UNKNOWN, category_of
from sim.homes.importers.losses import Losses
from sim.homes.importers.mesh_house import STRUCTURE, MeshObject, RoomArea, Shape, require_few, rotation_matrix
from sim.homes.importers.surfaces import Y_UP, Surface, read_surfaces

PUSHED_KG = 15.0
"""Lighter objects that the source moves (`motion_type` dynamic) and that stand on the lowest floor can be pushed."""
STANDS_M = 0.05
ROOF_NORMAL = 0.9
MIN_CEILING_M = 1.8


@dataclass(frozen=True)
class Scene:
    """The objects and rooms of a scene, in our frame before it is moved to z = 0."""

    objects: list[MeshObject]
    rooms: list[RoomArea]


def read_scene(file: Path, dataset: SceneDataset, losses: Losses, texture_px: int) -> Scene:
    """Returns the objects of a scene.

    Args:
        file: the `.scene_instance.json`.
        dataset: to which it belongs.
        losses: gets the objects that were left out.
        texture_px: larger pictures are reduced to this size.

    Raises:
        HouseError: the scene or its stage is missing or broken; the message names file and place.
    """
    scene = read_json(file, SceneInstance, what="Scene", error=HouseError)
    require_few(len(scene.object_instances))
    try:
        semantics = dataset.semantics(scene, file.name.removesuffix(SCENE))
    except ConfigError as error:
        raise HouseError(str(error)) from None
    reader = _Reader(dataset, semantics, scene, losses, texture_px, f"Scene '{file}'")
    stage = reader.placed(scene.stage_instance, "stages")
    instances = []
    for entry in scene.object_instances:
        try:
            instances.append((entry, reader.placed(entry, "objects")))
        except HouseError as error:
            losses.left_out[f"{printable(entry.template_name)[:60]}: {error}"] += 1
    for entry in scene.articulated_object_instances:
        name = entry.get("template_name", "") if isinstance(entry, dict) else ""
        losses.left_out[f"{printable(str(name))[:60]}: it is articulated (URDF), which is not read"] += 1
    parts = _parts_of_stage(stage, [item for _, item in instances])
    floors = [part.corners_m for part in parts if part.category == "floor"]
    ground = find_levels(np.concatenate(floors))[0] if floors else 0.0
    objects = [reader.movable(instance, item, ground) for instance, item in instances]
    return Scene([*parts, *objects], [_room(region) for region in semantics.region_annotations])


def used_files(file: Path, dataset: SceneDataset) -> list[Path]:
    """Returns the meshes of a scene that exist, sorted; those of a broken scene are left out."""
    files: set[Path] = set()
    try:
        scene = read_json(file, SceneInstance, what="Scene", error=HouseError)
        names = {("objects", instance.template_name) for instance in scene.object_instances}
        for kind, name in {*names, ("stages", scene.stage_instance.template_name)}:
            with contextlib.suppress(HouseError):
                template = dataset.template(kind, name, str(file))
                files |= {
                    template_file
                    for template_file in (template.asset, template.file)
                    if template_file is not None and template_file.is_file()
                }
    except HouseError:
        return []
    return sorted(files)


class _Reader:
    """Reads the configurations and meshes of one scene, each once."""

    def __init__(
        self, dataset: SceneDataset, semantics: Semantics, scene: SceneInstance, losses: Losses, texture_px: int,
        where: str,
    ) -> None:  # fmt: skip
        self._dataset, self._scene, self._losses = dataset, scene, losses
        self._texture_px, self._where = texture_px, where
        self._classes = {entry.id: entry.name for entry in semantics.classes}
        self._templates: dict[tuple[str, str], Template] = {}
        self._meshes: dict[tuple[Path, float], list[Surface]] = {}
        self._shapes: dict[tuple[object, ...], Shape] = {}

    def placed(self, instance: ObjectInstance, kind: str) -> MeshObject:
        """Returns an object, or the whole stage as one; raises HouseError if one of its files is missing or broken."""
        key = (kind, instance.template_name)
        if key not in self._templates:
            self._templates[key] = self._dataset.template(kind, instance.template_name, self._where)
        template = self._templates[key]
        scale = tuple(instance.uniform_scale * factor for factor in instance.non_uniform_scale)
        shape = self._shape(template, scale)
        turn, quaternion = _rotation(instance.rotation, self._where)
        position = Y_UP @ np.asarray(instance.translation, dtype=np.float64)
        own = instance.translation_origin
        origin = self._scene.translation_origin if own in (None, "default", "unknown") else own
        if origin.lower() == "com" and kind == "objects":
            position = position - turn @ _centre(template.attributes, shape, scale)
        name = self._name(template)
        if kind == "objects":
            self._losses.furniture[printable(name)[:60]] += 1
        x, y, z = (float(value) for value in position)
        category = category_of(name) or UNKNOWN
        return MeshObject(category, name, shape, (x, y, z), quaternion, is_solid=template.attributes.is_collidable)

    def _name(self, template: Template) -> str:
        """Returns the name that says the category of an object."""
        name = self._classes.get(template.attributes.semantic_id) if template.attributes.semantic_id else None
        return name or self._dataset.category_of_id.get(template.name) or template.name

    def _shape(self, template: Template, scale: tuple[float, ...]) -> Shape:
        """Returns the surfaces of a mesh in our frame, turned and scaled by its configuration and its instance."""
        key = (template.name, template.asset, scale)
        if key not in self._shapes:
            attributes, mesh = template.attributes, (template.asset, template.attributes.units_to_meters)
            if mesh not in self._meshes:
                self._meshes[mesh] = read_surfaces(
                    mesh[0], unit_m=mesh[1], texture_px=self._texture_px, losses=self._losses.changes
                )
            factors = np.asarray(attributes.scale) * np.asarray(scale)
            if np.abs(factors).min() < 1e-9:
                raise HouseError(f"{self._where}: '{printable(template.name)}' has a scale of 0.")
            matrix = np.eye(4)
            matrix[:3, :3] = Y_UP @ _frame(attributes, self._where) @ np.diag(factors)
            self._shapes[key] = Shape(tuple(surface.moved(matrix) for surface in self._meshes[mesh]))
        return self._shapes[key]

    def movable(self, instance: ObjectInstance, item: MeshObject, ground_m: float) -> MeshObject:
        """Returns the object, with its mass if the robot can push it."""
        mass = self._templates["objects", instance.template_name].attributes.mass
        if instance.motion_type.lower() != "dynamic" or mass is None or not 0.0 < mass < PUSHED_KG:
            return item
        if abs(float(item.corners_m[..., 2].min()) - ground_m) > STANDS_M or item.category in STRUCTURE:
            self._losses.changes["An object that the source moves is fixed: it does not stand on the floor."] += 1
            return item
        return MeshObject(item.category, item.source, item.shape, item.position_m, item.quaternion, mass, item.is_solid)


def _rotation(rotation: Sequence[float], where: str) -> tuple[NDArray[np.float64], tuple[float, float, float, float]]:
    """Returns a rotation of Habitat's frame in ours, as a matrix and as a unit quaternion."""
    w, x, y, z = rotation
    length = float(np.linalg.norm(rotation))
    if length < 1e-6:
        raise HouseError(f"{where}: a rotation must be a quaternion that is not zero, got {list(rotation)}.")
    quaternion = (w / length, x / length, -z / length, y / length)
    return rotation_matrix(quaternion), quaternion


def _frame(attributes: Attributes, where: str) -> NDArray[np.float64]:
    """Returns the matrix (3, 3) that turns the upward axis of a mesh to y and its front to -z.

    Raises:
        HouseError: the two axes are not at a right angle.
    """
    up, front = np.asarray(attributes.up, dtype=np.float64), np.asarray(attributes.front, dtype=np.float64)
    lengths = float(np.linalg.norm(up)), float(np.linalg.norm(front))
    if min(lengths) < 1e-6 or abs(float(up @ front)) > 0.01 * lengths[0] * lengths[1]:
        raise HouseError(f"{where}: 'up' {attributes.up} and 'front' {attributes.front} are not at a right angle.")
    up, front = up / lengths[0], front / lengths[1]
    return np.stack([np.cross(front, up), up, -front])


def _centre(attributes: Attributes, shape: Shape, scale: Sequence[float]) -> NDArray[np.float64]:
    """Returns the centre of mass (3,) in the frame of a shape: that of the configuration, or of the box around it."""
    if attributes.COM is not None:
        factors = np.asarray(attributes.scale) * np.asarray(scale) * attributes.units_to_meters
        return np.asarray(Y_UP @ (np.asarray(attributes.COM) * factors), dtype=np.float64)
    corners = shape.corners_m.reshape(-1, 3)
    return np.asarray(0.5 * (corners.min(axis=0) + corners.max(axis=0)), dtype=np.float64)


# ---- stage and rooms -------------------------------------------------------------------------------------------------


def _parts_of_stage(stage: MeshObject, objects: Sequence[MeshObject]) -> list[MeshObject]:
    """Returns the parts of the building, in the world: by the names of nodes and materials, else by geometry."""
    surfaces = stage.surfaces_in_world
    named = [_category_of_part(surface) for surface in surfaces]
    if "floor" in named:
        return [
            MeshObject(category or "wall", surface.node, Shape((surface,)), is_solid=stage.is_solid)
            for surface, category in zip(surfaces, named, strict=True)
        ]
    parts: list[MeshObject] = []
    bottoms = np.array([item.corners_m[..., 2].min() for item in objects])
    levels = _floor_levels(np.concatenate([surface.corners_m for surface in surfaces]), bottoms)
    for surface, category in zip(surfaces, named, strict=True):
        if category is not None:
            parts.append(MeshObject(category, surface.node, Shape((surface,)), is_solid=stage.is_solid))
            continue
        kinds = _kinds(surface.corners_m, levels)
        for number, kind in enumerate(("wall", "floor", "ceiling")):
            if (kinds == number).any():
                shape = Shape((surface.part(kinds == number),))
                parts.append(MeshObject(kind, "stage", shape, is_solid=stage.is_solid))
    return parts


def _category_of_part(surface: Surface) -> str | None:
    """Returns the category of a surface of a stage by its names, if it is a part of a building."""
    for name in (surface.node, surface.material):
        category = category_of(name)
        if category in STRUCTURE:
            return category
    return None


def _floor_levels(corners_m: NDArray[np.float64], bottoms_m: NDArray[np.float64]) -> list[float]:
    """Returns the heights of floors: the lowest large level, and higher ones on which an object stands."""
    levels = find_levels(corners_m)
    return [
        level for number, level in enumerate(levels)
        if number == 0 or (len(bottoms_m) and float(np.abs(bottoms_m - level).min()) < STANDS_M)
    ]  # fmt: skip


def _kinds(corners_m: NDArray[np.float64], levels_m: Sequence[float]) -> NDArray[np.int64]:
    """Returns (m,) 0 for triangles of a wall, 1 of a floor, 2 of a ceiling."""
    normal = np.cross(corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0])
    upward = normal[:, 2] / np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    z = corners_m[:, :, 2].mean(axis=1)
    floor = (np.abs(upward) > ROOF_NORMAL) & (np.abs(z[:, None] - np.asarray(levels_m)).min(axis=1) <= LEVEL_M)
    below = np.asarray(levels_m)[np.maximum(np.searchsorted(levels_m, z) - 1, 0)]
    ceiling = (np.abs(upward) > ROOF_NORMAL) & ~floor & (z - below > MIN_CEILING_M)
    return np.where(floor, 1, np.where(ceiling, 2, 0))


def _room(region: Region) -> RoomArea:
    """Returns the room of a region."""
    polygon = np.array([[x, -z] for x, _, z in region.poly_loop])
    low = np.floor(polygon.min(axis=0) / PLAN_CELL_M)
    shape = np.ceil(polygon.max(axis=0) / PLAN_CELL_M - low).astype(int) + 1
    if int(shape[0]) * int(shape[1]) > 16_000_000:
        raise HouseError(f"the region '{printable(region.label)}' is larger than a house.")
    picture = np.zeros((int(shape[1]), int(shape[0])), dtype=np.uint8)
    at = np.rint((polygon / PLAN_CELL_M - low - 0.5) * 16.0).astype(np.int32)
    cv2.fillPoly(picture, [at[:, None]], (1,), shift=4)
    origin = (float(low[0] * PLAN_CELL_M), float(low[1] * PLAN_CELL_M))
    rects = Plan(origin, picture.T > 0).rectangles(covered=1.0, most=5_000)  # cut to the floor, then fewer
    return RoomArea(region.label, tuple(rects), region.floor_height, region.extrusion_height)
