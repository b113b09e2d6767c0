"""Other proportions for a finished item: sides stretched, heights moved against each other, left and right exchanged.

It works on the geoms of any style, so that a style shows in more proportions than its own sizes give. A height is
mapped by a continuous, piecewise linear function, and depth and width by one factor each: parts that touch still
touch, and geoms on the floor or on the wall stay there.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sim.homes.housegen.furniture.item import Child, Geom, Item, MeshShape, Surface
from sim.homes.housegen.furniture.shapes import named_mesh
from sim.homes.housegen.furniture.transforms import bounds, euler_from_matrix, matrix_from_euler

STRETCH = ((0.86, 0.86, 0.92), (1.14, 1.14, 1.08))
"""Smallest and largest factors of the depth, width and height of an item."""
LEVELS = (0.75, 1.3)
"""Smallest and largest factor of one of the three ranges of height, before the whole is scaled to its height."""
TALL_M = 1.6
"""Items of this height or more, and those on walls, get no higher: they must fit below ceilings and shelves."""
FIXED = frozenset(("sink", "appliances"))
"""Labels of children that fit into a hole of their parent, which therefore keeps its proportions."""
ONE_HANDED = frozenset(("shower", "sofa", "bathtub"))
"""Categories with a side that belongs to a corner of the room: they are not mirrored."""
_ROUND_M = 0.06
"""Radius from which an upright cylinder counts as a round part, which needs equal factors of depth and width."""
_ROOM_M = 0.1
"""Height of the highest part of an item above one of its tops from which that space is kept: for a screen."""
_SIDES = np.diag([1.0, -1.0, 1.0])


@dataclasses.dataclass(frozen=True)
class Warp:
    """A map of the item frame: factors of x and y, a piecewise linear function of z, and a mirror."""

    x: float
    y: float
    knots_m: NDArray[np.float64]  # (4,) heights, increasing, the first 0
    heights_m: NDArray[np.float64]  # (4,) the new heights
    mirrored: bool

    def points(self, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the images (n, 3) of points (n, 3)."""
        z = np.interp(points_m[:, 2], self.knots_m, self.heights_m)
        z += np.minimum(points_m[:, 2], 0.0) + np.maximum(points_m[:, 2] - self.knots_m[-1], 0.0)
        return np.column_stack([self.x * points_m[:, 0], (-self.y if self.mirrored else self.y) * points_m[:, 1], z])

    def point(self, point_m: tuple[float, float, float]) -> tuple[float, float, float]:
        """Returns the image of one point, rounded to 0.1 mm."""
        x, y, z = np.round(self.points(np.array([point_m]))[0], 4) + 0.0
        return (float(x), float(y), float(z))


def may_reshape(item: Item) -> bool:
    """Returns False for items that keep their shape: rugs, ceiling lamps, imported models, sinks in a hole."""
    if item.walk_over or item.mount == "ceiling" or item.collision_geoms:
        return False
    if any(child.item.category in FIXED for child in item.children):
        return False
    return all(geom.mesh is None or geom.mesh.texture_uv is None for geom in item.geoms)


def reshaped(item: Item, rng: np.random.Generator, hints: Mapping[str, object]) -> Item:
    """Returns the item in other proportions; sides that a hint determines keep their length."""
    warp = _draw(item, rng, hints)
    return _warped(item, warp, tuple(_child(child, warp) for child in item.children))


def fitted(item: Item, size_m: tuple[float, float, float]) -> Item:
    """Returns the item with the sides of its bounding box stretched to `size_m`: depth, width, height in metres.

    Its children are stretched with it, so that a sink still fills its hole. Round parts stay round: where depth and
    width are stretched by different factors, the size is met to within a few centimetres.
    """
    x, y, z = (max(new, 1e-3) / max(old, 1e-3) for new, old in zip(size_m, item.size_m, strict=True))
    return _scaled(item, x, y, z)


def _scaled(item: Item, x: float, y: float, z: float) -> Item:
    """Returns an item and its children with depth, width and height multiplied by factors."""
    knots = max(item.size_m[2], 1e-3) * np.array([0.0, 0.3, 0.6, 1.0])
    warp = Warp(x, y, knots, z * knots, mirrored=False)
    children = []
    for child in item.children:
        along, across = abs(math.cos(child.yaw_rad)), abs(math.sin(child.yaw_rad))
        own = _scaled(child.item, math.hypot(x * along, y * across), math.hypot(x * across, y * along), z)
        children.append(dataclasses.replace(_child(child, warp), item=own))
    return _warped(item, warp, tuple(children))


def _warped(item: Item, warp: Warp, children: tuple[Child, ...]) -> Item:
    """Returns the item with its geoms and surfaces mapped, and the children that it is given."""
    geoms = tuple(_geom(geom, warp) for geom in item.geoms)
    hits = tuple(_geom(geom, warp) for geom in item.collision_geoms)
    low, high = bounds(geoms, children)
    shift = -0.5 * (low + high)
    shift[0] = 0.0 if item.mount == "wall" else shift[0]
    shift[2] = -low[2]
    size = tuple(float(s) for s in np.round(high - low, 4))
    return dataclasses.replace(
        item, size_m=size, geoms=tuple(dataclasses.replace(g, pos_m=_moved(g.pos_m, shift)) for g in geoms),
        children=tuple(dataclasses.replace(c, pos_m=_moved(c.pos_m, shift)) for c in children),
        surfaces=tuple(_surface(s, warp, shift) for s in item.surfaces),
        collision_geoms=tuple(dataclasses.replace(g, pos_m=_moved(g.pos_m, shift)) for g in hits),
    )  # fmt: skip


def _draw(item: Item, rng: np.random.Generator, hints: Mapping[str, object]) -> Warp:
    hinted = [hints.get(name) is not None for name in ("depth_m", "width_m", "height_m")]
    x, y, z = np.where(hinted, 1.0, rng.uniform(*STRETCH, size=3))
    top = item.size_m[2]
    if any(geom.shape == "cylinder" and geom.size_m[0] > _ROUND_M and _upright(geom) for geom in item.geoms):
        x = y = x if hinted[0] else y
    if top > TALL_M or item.mount == "wall":
        z = min(z, 1.0)
    holds_screen = any(surface.kind == "top" and surface.centre_m[2] < top - _ROOM_M for surface in item.surfaces)
    if holds_screen:
        x, y, z = max(x, 1.0), max(y, 1.0), 1.0
    cuts = np.sort(rng.uniform(0.15, 0.85, size=2))
    knots = top * np.array([0.0, cuts[0], max(cuts[1], cuts[0] + 0.05), 1.0])
    parts = np.diff(knots) * (1.0 if holds_screen else rng.uniform(*LEVELS, size=3))
    heights = np.concatenate([[0.0], np.cumsum(parts) * z * top / parts.sum()])
    mirrored = bool(rng.random() < 0.5) and item.category not in ONE_HANDED
    return Warp(float(x), float(y), knots, heights, mirrored)


def _upright(geom: Geom) -> bool:
    return abs(geom.euler_rad[0]) + abs(geom.euler_rad[1]) < 0.01


def _geom(geom: Geom, warp: Warp) -> Geom:
    rotation, centre = matrix_from_euler(*geom.euler_rad), np.asarray(geom.pos_m)
    if geom.mesh is not None:
        return _mesh_geom(geom, geom.mesh, rotation, centre, warp)
    mirror = _SIDES if warp.mirrored else np.eye(3)
    half = np.array({"sphere": geom.size_m * 3, "capsule": (geom.size_m[0], *geom.size_m)}.get(geom.shape, geom.size_m))
    if geom.shape == "cylinder":
        half = np.array([geom.size_m[0], geom.size_m[0], geom.size_m[1]])
    ends = warp.points(np.vstack([centre + s * h * rotation[:, i] for i, h in enumerate(half) for s in (-1.0, 1.0)]))
    axes = 0.5 * (ends[1::2] - ends[::2])  # (3, 3), the images of the half axes, one a row
    lengths = np.linalg.norm(axes, axis=1)
    main = int(np.argmax(half)) if geom.shape in ("box", "ellipsoid") else 2
    turned = rotation if _axis_aligned(rotation) or geom.shape == "sphere" else _frame(rotation, axes, main, mirror)
    if _axis_aligned(rotation):
        turned = mirror @ rotation @ mirror
    middle = warp.points(centre[None])[0]
    middle = middle + (0.5 * (ends[1::2] + ends[::2]) - middle).sum(axis=0)
    x, y, z = np.round(middle, 4) + 0.0
    size = {
        "sphere": (lengths[2],),
        "cylinder": (math.sqrt(lengths[0] * lengths[1]), lengths[2]),
        "capsule": (math.sqrt(lengths[0] * lengths[1]), lengths[2]),
    }.get(geom.shape, tuple(lengths))
    return dataclasses.replace(
        geom,
        pos_m=(float(x), float(y), float(z)),
        euler_rad=euler_from_matrix(turned),
        size_m=tuple(max(round(float(s), 4), 0.0005) for s in size),
    )


def _frame(
    rotation: NDArray[np.float64], axes: NDArray[np.float64], main: int, mirror: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Returns the rotation nearest to the old one that turns axis `main` into the direction of its image."""
    old = mirror @ rotation @ mirror
    along = axes[main] / np.linalg.norm(axes[main])
    if along @ old[:, main] < 0.0:
        along = -along
    new, second, third = old.copy(), (main + 1) % 3, (main + 2) % 3
    across = old[:, second] - (old[:, second] @ along) * along
    new[:, main], new[:, second] = along, across / np.linalg.norm(across)
    new[:, third] = np.cross(new[:, main], new[:, second])
    return new


def _axis_aligned(rotation: NDArray[np.float64]) -> bool:
    return bool((np.abs(rotation).max(axis=0) > 0.9999).all())


def _mesh_geom(
    geom: Geom, mesh: MeshShape, rotation: NDArray[np.float64], centre: NDArray[np.float64], warp: Warp
) -> Geom:
    at = np.array(warp.point((float(centre[0]), float(centre[1]), float(centre[2]))))
    vertices = warp.points(mesh.vertices_m @ rotation.T + centre) - at
    faces = mesh.faces[:, ::-1] if warp.mirrored and len(mesh.faces) else mesh.faces
    kind = mesh.name.rsplit("_", 1)[0]
    made = named_mesh(kind, vertices, faces if len(faces) else ())
    if mesh.texture_uv is not None:
        made = dataclasses.replace(made, name=f"{made.name}_{mesh.name.rsplit('_', 1)[1]}", texture_uv=mesh.texture_uv)
    return dataclasses.replace(
        geom, mesh=made, euler_rad=(0.0, 0.0, 0.0), pos_m=(float(at[0]), float(at[1]), float(at[2]))
    )


def _child(child: Child, warp: Warp) -> Child:
    yaw = -child.yaw_rad if warp.mirrored else child.yaw_rad
    return dataclasses.replace(child, pos_m=warp.point(child.pos_m), yaw_rad=yaw)


def _surface(surface: Surface, warp: Warp, shift: NDArray[np.float64]) -> Surface:
    half = (round(warp.x * surface.half_size_m[0], 4), round(warp.y * surface.half_size_m[1], 4))
    return dataclasses.replace(surface, centre_m=_moved(warp.point(surface.centre_m), shift), half_size_m=half)


def _moved(point: tuple[float, float, float], shift: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = np.round(np.add(point, shift), 4) + 0.0
    return (float(x), float(y), float(z))
