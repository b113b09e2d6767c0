"""Data types of furniture before it is written as MJCF: geoms, surfaces and children in the frame of an item.

Item frame: origin on the floor (or on the mounting point) under the middle of the footprint, +x out of the front,
+y to the left, +z up, metres. The front of a bed is its foot end; the back of an item that stands against a wall is
at smallest x. When an item is placed, its yaw is the direction of its front.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

Shape = Literal["box", "cylinder", "sphere", "capsule", "ellipsoid", "mesh"]
Mount = Literal["floor", "wall", "ceiling", "top"]
"""The support on which the origin of an item lies: the floor, a wall (x = 0 is its surface), the ceiling, or a top."""
Pool = Literal["train", "heldout"]
"""The styles, sizes, colours and textures that may be drawn: `heldout` (val and test) shares none with `train`."""


class Hints(TypedDict, total=False):
    """What a room asks of an item; the tables of `Catalogue.make_item` explain each key. None: it asks for nothing."""

    use: str | None
    width_m: float | None
    depth_m: float | None
    height_m: float | None
    looks: Mapping[str, Look] | None
    with_sink: bool
    with_hob: bool
    cushions: int


@dataclass(frozen=True)
class Look:
    """The appearance of a surface: a texture tinted by a colour, or a plain colour."""

    rgba: tuple[float, float, float, float] = (0.7, 0.7, 0.7, 1.0)
    texture: str | None = None
    """Name of a texture in `sim.homes.housegen.surfaces.materials`; None for a plain colour."""
    repeat_m: float = 1.0
    """Edge length of one tile of the texture on the surface; 0: one image over the whole face."""
    specular: float = 0.2
    shininess: float = 0.2
    emission: float = 0.0
    """Share of the colour that the surface emits: lamps, screens, daylight behind a window."""
    material: str = field(default="", compare=False)
    """Key of `sim.homes.housegen.surfaces.materials.MATERIALS` from which it was drawn; "" for others."""


@dataclass(frozen=True)
class MeshShape:
    """A small triangle mesh in the frame of its geom. Meshes are shared by name: equal meshes need equal names."""

    name: str
    """Kind and hash of the content."""
    vertices_m: NDArray[np.float64]  # (n, 3)
    faces: NDArray[np.int32]  # (m, 3), counter-clockwise from outside; (0, 3): the convex hull of the vertices
    texture_uv: NDArray[np.float64] | None = None  # (n, 2)
    """Texture coordinates of the vertices, in widths and heights of the picture; None without a picture of its own."""


@dataclass(frozen=True)
class Geom:
    """A geom of an item. `size_m` holds the half sizes that MuJoCo uses for `shape`; it is ignored for meshes."""

    shape: Shape
    size_m: tuple[float, ...]
    pos_m: tuple[float, float, float]
    look: Look
    euler_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Intrinsic rotations about x, y, z, applied in that order."""
    solid: bool = True
    """False: a visual geom without collisions (handles, leaves, folds of cloth)."""
    mesh: MeshShape | None = None


@dataclass(frozen=True)
class Surface:
    """A horizontal rectangle in the item frame on which smaller objects can be placed."""

    centre_m: tuple[float, float, float]
    half_size_m: tuple[float, float]
    kind: str = "top"
    """Kind of objects for it: "top" (lamps, plants, books, screens), "seat" (cushions, clothes), "floor"."""


@dataclass(frozen=True)
class Child:
    """An item with its own label on or in another item: a cushion on a sofa, a sink in a counter."""

    item: Item
    pos_m: tuple[float, float, float]
    yaw_rad: float = 0.0


@dataclass(frozen=True)
class Item:
    """A piece of furniture. All `geoms` share one label; `children` have their own labels."""

    category: str
    """mpcat40 name with underscores."""
    style: str
    """Name of the style, unique within the category."""
    size_m: tuple[float, float, float]
    """Bounding box of geoms and children: depth along x, width along y, height along z."""
    geoms: Sequence[Geom]
    mount: Mount = "floor"
    children: Sequence[Child] = field(default_factory=tuple)
    surfaces: Sequence[Surface] = field(default_factory=tuple)
    mount_height_m: float = 0.0
    """Usual height of the origin of a wall item (the middle of its lower edge) above the floor; 0 for other mounts."""
    mass_kg: float | None = None
    """Set for light items that may be movable (a chair, a stool, a ball); None: the item is fixed."""
    walk_over: bool = False
    """True: flat on the floor and without collisions; other objects may stand on it (a rug, a yoga mat)."""
    collision_geoms: Sequence[Geom] = field(default_factory=tuple)
    """Geoms that collide and are not rendered, for an item without other solid geoms (an imported model)."""
    name: str = ""
    """Everyday name, finer than the category (`furniture/names.py`); "" stands for that of the style."""
