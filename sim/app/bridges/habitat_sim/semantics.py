"""Habitat's semantic scene of a house: its storeys, rooms and labelled objects.

The object with index `i` has the id `CATEGORY_i`, and `i` is its value in images of semantic sensors; index 0 is what
has no label.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sim.app.bridges.habitat_sim.maths import Vector3, quat_from_coeffs
from sim.core.interface import MPCAT40_ID
from sim.core.reading import FARTHEST_M
from sim.houses.geoms import geom_polytope
from sim.houses.house import Room
from sim.houses.labels import VOID, Instance
from sim.world.standing import Standing, is_in, read_standing
from sim.world.world import World


class Box(np.ndarray):
    """The middle or the sizes of a box, (3,); scripts of different age read it as attribute or call it."""

    def __call__(self) -> NDArray[np.float64]:
        """Returns itself."""
        return np.asarray(self)


@dataclass(frozen=True)
class AxisAlignedBox:
    """A box in Habitat's frame, metres."""

    low: NDArray[np.float64]  # (3,)
    high: NDArray[np.float64]  # (3,)

    @property
    def center(self) -> Box:
        """The middle, (3,)."""
        return (0.5 * (self.low + self.high)).view(Box)

    @property
    def sizes(self) -> Box:
        """The sizes, (3,)."""
        return (self.high - self.low).view(Box)

    size = sizes

    @property
    def min(self) -> Vector3:
        """The lowest corner."""
        return Vector3(self.low)

    @property
    def max(self) -> Vector3:
        """The highest corner."""
        return Vector3(self.high)


@dataclass(frozen=True)
class OrientedBox:
    """The same box, as Habitat's class of boxes that may be turned."""

    aabb: AxisAlignedBox

    @property
    def center(self) -> NDArray[np.float64]:
        """The middle, (3,)."""
        return self.aabb.center()

    @property
    def sizes(self) -> NDArray[np.float64]:
        """The sizes, (3,)."""
        return self.aabb.sizes()

    @property
    def half_extents(self) -> NDArray[np.float64]:
        """Half of the sizes, (3,)."""
        return 0.5 * self.sizes

    @property
    def rotation(self) -> NDArray[np.float64]:
        """The rotation, xyzw: none."""
        return np.array([0.0, 0.0, 0.0, 1.0])

    @property
    def orientation(self) -> object:
        """The rotation as `np.quaternion`."""
        return quat_from_coeffs(self.rotation)


OBB = OrientedBox


@dataclass(frozen=True)
class Category:
    """A category of objects or rooms."""

    label: str
    number: int

    def name(self, mapping: str = "") -> str:
        """Returns the name; the category of an object is one of mpcat40, in underscores."""
        return self.label

    def index(self, mapping: str = "") -> int:
        """Returns the number: of an object that in mpcat40, of a room its place among the rooms."""
        return self.number


@dataclass(eq=False)
class SemanticObject:
    """A labelled object."""

    id: str
    semantic_id: int
    category: Category
    aabb: AxisAlignedBox
    name: str = ""
    """Name of the instance in the house file."""
    region: SemanticRegion | None = None

    @property
    def obb(self) -> OrientedBox:
        """The same box."""
        return OrientedBox(self.aabb)


@dataclass(eq=False)
class SemanticRegion:
    """A room."""

    id: str
    category: Category
    aabb: AxisAlignedBox
    objects: list[SemanticObject] = field(default_factory=list)
    level: SemanticLevel | None = None


@dataclass(eq=False)
class SemanticLevel:
    """A storey."""

    id: str
    floor_z_m: float
    aabb: AxisAlignedBox
    regions: list[SemanticRegion] = field(default_factory=list)
    objects: list[SemanticObject] = field(default_factory=list)


@dataclass(eq=False)
class SemanticScene:
    """A house."""

    aabb: AxisAlignedBox
    levels: list[SemanticLevel]
    regions: list[SemanticRegion]
    objects: list[SemanticObject]
    categories: list[Category]

    def get_regions_for_point(self, point: NDArray[np.float64]) -> list[int]:
        """Returns the indices of the rooms that hold a point (3,)."""
        return [
            index
            for index, region in enumerate(self.regions)
            if bool(((region.aabb.low <= point) & (point <= region.aabb.high)).all())
        ]


def semantic_scene(world: World) -> SemanticScene:
    """Returns the semantic scene of the present state of a world."""
    standing = read_standing(world.model, world.data, world.labels)
    boxes = [_box(*_extents(world, *pair)) for pair in zip(standing, world.labels.instances, strict=True)]
    nothing = AxisAlignedBox(np.zeros(3), np.zeros(3))
    objects = [SemanticObject(f"{VOID}_0", 0, Category(VOID, 0), nothing)]
    for index, (instance, box) in enumerate(zip(world.labels.instances, boxes, strict=True), start=1):
        category = Category(instance.category, MPCAT40_ID[instance.category])
        objects.append(SemanticObject(f"{instance.category}_{index}", index, category, box, instance.name))
    whole = _around(boxes) if boxes else nothing
    levels: dict[float, SemanticLevel] = {}
    regions = []
    for number, room in enumerate(world.rooms):
        box = _of_room(room)
        level = levels.setdefault(room.floor_z_m, SemanticLevel(str(len(levels)), room.floor_z_m, box))
        level.aabb = _around([level.aabb, box])
        region = SemanticRegion(f"{level.id}_{number}", Category(room.kind, number), box, level=level)
        for item, labelled in zip(standing, objects[1:], strict=True):
            if labelled.region is None and is_in(room, item):
                labelled.region = region
                region.objects.append(labelled)
                level.objects.append(labelled)
        level.regions.append(region)
        regions.append(region)
    categories = list({labelled.category.label: labelled.category for labelled in objects}.values())
    return SemanticScene(whole, list(levels.values()), regions, objects, categories)


def _of_room(room: Room) -> AxisAlignedBox:
    return _around([_box(np.subtract(centre, half), np.add(centre, half)) for centre, half in room.boxes])


def _around(boxes: list[AxisAlignedBox]) -> AxisAlignedBox:
    """Returns the box around boxes."""
    return AxisAlignedBox(np.min([box.low for box in boxes], axis=0), np.max([box.high for box in boxes], axis=0))


def _extents(world: World, item: Standing, instance: Instance) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and the highest corner of an instance; of a plane, of the rectangle that is rendered."""
    if (item.high - item.low).max() <= FARTHEST_M:
        return item.low, item.high
    shapes = [geom_polytope(world.model, world.data, geom, rendered=True) for geom in instance.geom_ids]
    corners = np.concatenate([shape.vertices_m for shape in shapes])
    return corners.min(axis=0), corners.max(axis=0)


def _box(low: NDArray[np.float64], high: NDArray[np.float64]) -> AxisAlignedBox:
    """Returns a box of the project's frame in Habitat's, where (x, y, z) is (x, z, -y)."""
    return AxisAlignedBox(np.array([low[0], low[2], -high[1]]), np.array([high[0], high[2], -low[1]]))
