"""What a piece of furniture is before it becomes MJCF: labelled geoms in a frame of its own.

Item frame: origin on the floor (or on the mounting point) under the middle of the footprint, +x out of the front,
+y to the left, +z up, metres. A bed's front is its foot end; whatever stands against a wall has its back at
smallest x. The yaw an item is placed with is the direction its front looks in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Shape = Literal["box", "cylinder", "sphere", "capsule", "ellipsoid", "mesh"]
Mount = Literal["floor", "wall", "ceiling", "top"]
"""Where an item's origin sits: on the floor, on a wall (x = 0 is the wall's surface), on the ceiling, on a top."""
Pool = Literal["train", "heldout", "wide"]
"""Which styles, sizes, colours and textures may be drawn: val and test houses use what train never shows.

Houses of `wide` show everything that train's do and styles of their own beside it: they are for training perception,
and no split has them, so that train's houses stay what they are when a style is added.
"""


@dataclass(frozen=True)
class Look:
    """How a surface looks: a texture from the catalogue tinted by a colour, or a plain colour."""

    rgba: tuple[float, float, float, float] = (0.7, 0.7, 0.7, 1.0)
    texture: str | None = None
    """Name of a texture in `sim.housegen.materials`; None for a plain colour."""
    repeat_m: float = 1.0
    """Edge length of one tile of the texture on the surface; 0: one picture over the whole face."""
    specular: float = 0.2
    shininess: float = 0.2
    emission: float = 0.0
    """Share of its colour that it gives off by itself: lamps, screens, daylight behind a window."""


@dataclass(frozen=True)
class MeshShape:
    """A small convex-ish triangle mesh, in the geom's frame; shared by name, so equal meshes need equal names."""

    name: str
    """Kind and hash of the content: the same name, the same mesh."""
    vertices_m: NDArray[np.float64]  # (n, 3)
    faces: NDArray[np.int32]  # (m, 3), counter-clockwise from outside; (0, 3): the convex hull of the vertices


@dataclass(frozen=True)
class Geom:
    """One primitive of an item. `size_m` holds MuJoCo's half sizes for `shape`; ignored for meshes."""

    shape: Shape
    size_m: tuple[float, ...]
    pos_m: tuple[float, float, float]
    look: Look
    euler_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Intrinsic rotations about x, y, z, applied in that order."""
    solid: bool = True
    """False: seen but not touched (handles, leaves, cloth folds)."""
    mesh: MeshShape | None = None


@dataclass(frozen=True)
class Surface:
    """A horizontal top where smaller things can be put: a rectangle in the item frame."""

    centre_m: tuple[float, float, float]
    half_size_m: tuple[float, float]
    kind: str = "top"
    """What belongs there: "top" (lamps, plants, books, screens), "seat" (cushions, clothes), "floor"."""


@dataclass(frozen=True)
class Child:
    """An item of its own label on or in another one: a cushion on a sofa, a sink in a counter."""

    item: Item
    pos_m: tuple[float, float, float]
    yaw_rad: float = 0.0


@dataclass(frozen=True)
class Item:
    """A piece of furniture; everything in `geoms` shares one label, `children` have labels of their own."""

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
    """Where a wall item's origin (the middle of its lower edge) usually is above the floor; 0 for other mounts."""
    mass_kg: float | None = None
    """Set where a light thing may be made movable (a chair, a stool, a ball); None: it stays where it is."""
    walk_over: bool = False
    """True: flat on the floor and only seen, so that other things may stand on it (a rug, a yoga mat)."""
