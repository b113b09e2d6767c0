"""Where an item is built: draws lengths and looks, collects geoms, and finishes them into an `Item`.

A style is a function that takes a `Workbench` and puts geoms on it, in any frame whose +x is the front; `finish`
moves the result so that its origin is where `item.py` says. Lengths are metres throughout; boxes are given by the
ranges that they fill, `(low, high)` along each axis.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from sim.housegen import materials
from sim.housegen.furniture.item import Child, Geom, Item, Look, MeshShape, Mount, Pool, Surface
from sim.housegen.textures import TEXTURES

T = TypeVar("T")
Range = tuple[float, float]
Point = tuple[float, float, float]

_SIDES = ((-1, -1), (-1, 1), (1, -1), (1, 1))
MIN_HALF_M = 0.0005
"""Thinner geoms are made this thick (half): MuJoCo wants positive sizes."""


class Workbench:
    """One item in the making. `make` makes the children (cushions, sinks) that a style asks for."""

    def __init__(
        self,
        rng: np.random.Generator,
        pool: Pool,
        hints: Mapping[str, Any],
        make: Callable[..., Item],
    ) -> None:
        self.rng = rng
        self.pool: Pool = pool
        self.hints = hints
        self.mass_kg: float | None = None
        self.mount_height_m = 0.0
        self._make = make
        self._looks: dict[str, Look] = {}
        self._geoms: list[Geom] = []
        self._children: list[Child] = []
        self._surfaces: list[Surface] = []

    # ---- draws -------------------------------------------------------------------------------------------------

    def length(self, low_m: float, high_m: float, hint: str | None = None) -> float:
        """A length from the range in steps of 5 mm, or the caller's hint of that name as it is."""
        if hint is not None and self.hints.get(hint) is not None:
            return float(self.hints[hint])
        return round(200 * self.rng.uniform(low_m, high_m)) / 200

    def width(self, low_m: float, high_m: float) -> float:
        """Width along y; hint `width_m`."""
        return self.length(low_m, high_m, "width_m")

    def depth(self, low_m: float, high_m: float) -> float:
        """Depth along x; hint `depth_m`."""
        return self.length(low_m, high_m, "depth_m")

    def height(self, low_m: float, high_m: float) -> float:
        """Height along z; hint `height_m`."""
        return self.length(low_m, high_m, "height_m")

    def whole(self, low: int, high: int) -> int:
        """A whole number from low to high, both included."""
        return int(self.rng.integers(low, high + 1))

    def chance(self, probability: float) -> bool:
        """True with this probability."""
        return bool(self.rng.random() < probability)

    def choice(self, options: Sequence[T]) -> T:
        """One of the options."""
        return options[int(self.rng.integers(len(options)))]

    def flag(self, hint: str, probability: float) -> bool:
        """The caller's yes or no of that name, else drawn."""
        drawn = self.chance(probability)
        return bool(self.hints[hint]) if self.hints.get(hint) is not None else drawn

    def look(self, material: str) -> Look:
        """The item's look of this material: drawn once, the same at every call; hint `looks` fixes it."""
        if material not in self._looks:
            drawn = materials.look(material, self.rng, self.pool)
            self._looks[material] = (self.hints.get("looks") or {}).get(material, drawn)
        return self._looks[material]

    def new_look(self, material: str) -> Look:
        """Another look of this material at every call (book backs, cushions, clothes)."""
        return materials.look(material, self.rng, self.pool)

    # ---- geoms -------------------------------------------------------------------------------------------------

    def add(
        self, shape: str, size: Sequence[float], at: Point, rotation: NDArray, look: Look, *, solid: bool = True,
        mesh: MeshShape | None = None,
    ) -> None:  # fmt: skip
        """Any geom: half sizes, centre, rotation matrix (3, 3)."""
        half = tuple(round(max(float(s), MIN_HALF_M), 4) for s in size)
        self._geoms.append(Geom(shape, half, _rounded(at), look, euler_from_matrix(rotation), solid, mesh))  # type: ignore[arg-type]

    def box(
        self, x: Range, y: Range, z: Range, look: Look, *, solid: bool = True, tilt: float = 0.0, turn: float = 0.0,
        roll: float = 0.0,
    ) -> None:  # fmt: skip
        """The box that fills these ranges, then rolled about x, tilted about y (+: top forward), turned about z."""
        at = tuple(0.5 * (lo + hi) for lo, hi in (x, y, z))
        half = np.array([0.5 * abs(hi - lo) for lo, hi in (x, y, z)])
        rotation = matrix_from_euler(0.0, 0.0, turn) @ matrix_from_euler(roll, tilt, 0.0)
        if look.texture is not None:
            axes = _grain_axes(half, upright=TEXTURES[look.texture].upright)
            rotation, half = rotation @ axes, np.abs(axes.T @ half)
        self.add("box", tuple(half), at, rotation, look, solid=solid)  # type: ignore[arg-type]

    def cylinder(self, xy: tuple[float, float], z: Range, radius: float, look: Look, *, solid: bool = True) -> None:
        """An upright cylinder."""
        self.add("cylinder", (radius, 0.5 * (z[1] - z[0])), (*xy, 0.5 * (z[0] + z[1])), np.eye(3), look, solid=solid)

    def rod(
        self, a: Point, b: Point, radius: float, look: Look, *, solid: bool = True, round_ends: bool = False
    ) -> None:
        """A cylinder (or capsule) from a to b."""
        middle, half, rotation = _between(a, b)
        self.add("capsule" if round_ends else "cylinder", (radius, half), middle, rotation, look, solid=solid)

    def bar(self, a: Point, b: Point, wide: float, thick: float, look: Look, *, solid: bool = True) -> None:
        """A box from a to b, `wide` along y where it can and `thick` across; full lengths."""
        middle, half, rotation = _between(a, b)
        self.add("box", (0.5 * thick, 0.5 * wide, half), middle, rotation, look, solid=solid)

    def ball(self, at: Point, radius: float, look: Look, *, solid: bool = True) -> None:
        """A sphere."""
        self.add("sphere", (radius,), at, np.eye(3), look, solid=solid)

    def ellipsoid(
        self, at: Point, half: Point, look: Look, *, solid: bool = True, tilt: float = 0.0, turn: float = 0.0
    ) -> None:
        """An ellipsoid with these half axes, tilted about y, then turned about z."""
        rotation = matrix_from_euler(0.0, 0.0, turn) @ matrix_from_euler(0.0, tilt, 0.0)
        self.add("ellipsoid", half, at, rotation, look, solid=solid)

    def mesh(
        self, shape: MeshShape, at: Point, look: Look, *, solid: bool = True, roll: float = 0.0, tilt: float = 0.0,
        turn: float = 0.0,
    ) -> None:  # fmt: skip
        """A mesh, its origin at `at`, rolled about x, tilted about y, turned about z; its look loses its texture."""
        rotation = matrix_from_euler(0.0, 0.0, turn) @ matrix_from_euler(roll, tilt, 0.0)
        plain = dataclasses.replace(look, texture=None)
        self.add("mesh", (), at, rotation, plain, solid=solid, mesh=shape)

    def legs(
        self, x: Range, y: Range, z: Range, thick: float, look: Look, *, splay: float = 0.0, round_: bool = False
    ) -> None:
        """Four legs whose tops stand in the corners of the x, y rectangle; feet splayed outwards by `splay` metres."""
        for sx, sy in _SIDES:
            top = (x[0] if sx < 0 else x[1], y[0] if sy < 0 else y[1], z[1])
            foot = (top[0] + sx * splay, top[1] + sy * splay, z[0])
            if splay or round_:
                self.rod(foot, top, 0.5 * thick, look)
            else:
                inset = 0.5 * thick
                cx, cy = top[0] - sx * inset, top[1] - sy * inset
                self.box((cx - inset, cx + inset), (cy - inset, cy + inset), z, look)

    # ---- the rest ----------------------------------------------------------------------------------------------

    def top(self, x: Range, y: Range, z: float, kind: str = "top") -> None:
        """Declare a rectangle at height z where smaller things may stand."""
        centre = (0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), z)
        self._surfaces.append(Surface(centre, (0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])), kind))

    def make(self, category: str, **hints: Any) -> Item:
        """An item of another category out of the same pool."""
        return self._make(category, self.rng, pool=self.pool, **hints)

    def put(self, item: Item, at: Point, yaw: float = 0.0) -> None:
        """Put another item on this one; it keeps a label of its own."""
        self._children.append(Child(item, _rounded(at), round(yaw, 4)))

    def finish(self, category: str, style: str, mount: Mount, *, walk_over: bool = False) -> Item:
        """The item, its origin moved to the middle of the footprint, the wall's surface or the ceiling."""
        low, high = bounds(self._geoms, self._children)
        middle = 0.5 * (low + high)
        x = low[0] if mount == "wall" else middle[0]
        z = high[2] if mount == "ceiling" else low[2]
        shift = -np.array([x, middle[1], z])
        size = tuple(float(s) for s in np.round(high - low, 4))
        return Item(
            category=category, style=style, size_m=size, mount=mount,  # type: ignore[arg-type]
            geoms=tuple(dataclasses.replace(g, pos_m=_rounded(np.add(g.pos_m, shift))) for g in self._geoms),
            children=tuple(dataclasses.replace(c, pos_m=_rounded(np.add(c.pos_m, shift))) for c in self._children),
            surfaces=tuple(
                dataclasses.replace(s, centre_m=_rounded(np.add(s.centre_m, shift))) for s in self._surfaces
            ),
            mount_height_m=self.mount_height_m, mass_kg=self.mass_kg, walk_over=walk_over,
        )  # fmt: skip


def matrix_from_euler(x_rad: float, y_rad: float, z_rad: float) -> NDArray[np.float64]:
    """Rotation matrix (3, 3) of intrinsic rotations about x, y, z in that order (MuJoCo's default eulerseq)."""
    cx, cy, cz = math.cos(x_rad), math.cos(y_rad), math.cos(z_rad)
    sx, sy, sz = math.sin(x_rad), math.sin(y_rad), math.sin(z_rad)
    return np.array(
        [
            [cy * cz, -cy * sz, sy],
            [cx * sz + sx * sy * cz, cx * cz - sx * sy * sz, -sx * cy],
            [sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy],
        ]
    )


def euler_from_matrix(rotation: NDArray) -> tuple[float, float, float]:
    """Inverse of `matrix_from_euler`, rounded to 1e-4 rad."""
    y = math.asin(max(-1.0, min(1.0, float(rotation[0, 2]))))
    if abs(rotation[0, 2]) > 1.0 - 1e-9:
        x, z = math.atan2(rotation[2, 1], rotation[1, 1]), 0.0
    else:
        x, z = math.atan2(-rotation[1, 2], rotation[2, 2]), math.atan2(-rotation[0, 1], rotation[0, 0])
    return (round(x, 4) + 0.0, round(y, 4) + 0.0, round(z, 4) + 0.0)


def bounds(geoms: Sequence[Geom], children: Sequence[Child] = ()) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corner (3,) of the axis-aligned box round geoms and children, in their common frame."""
    lows, highs = [], []
    for geom in geoms:
        low, high = geom_bounds(geom)
        lows.append(low)
        highs.append(high)
    for child in children:
        turned = [_turned(g, child.yaw_rad) for g in child.item.geoms]
        low, high = bounds(turned, [_turned_child(c, child.yaw_rad) for c in child.item.children])
        lows.append(low + child.pos_m)
        highs.append(high + child.pos_m)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def geom_bounds(geom: Geom) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corner (3,) of one geom in the item frame."""
    rotation = matrix_from_euler(*geom.euler_rad)
    centre = np.asarray(geom.pos_m)
    if geom.mesh is not None:
        points = geom.mesh.vertices_m @ rotation.T + centre
        return points.min(axis=0), points.max(axis=0)
    reach = _reach(geom, rotation)
    return centre - reach, centre + reach


def _reach(geom: Geom, rotation: NDArray) -> NDArray[np.float64]:
    size = geom.size_m
    if geom.shape == "box":
        return np.abs(rotation) @ np.asarray(size)
    if geom.shape == "ellipsoid":
        return np.sqrt((rotation**2) @ (np.asarray(size) ** 2))
    if geom.shape == "sphere":
        return np.full(3, size[0])
    axis = np.abs(rotation[:, 2])
    if geom.shape == "capsule":
        return size[1] * axis + size[0]
    return size[1] * axis + size[0] * np.sqrt(np.maximum(0.0, 1.0 - axis**2))


def _turned(geom: Geom, yaw_rad: float) -> Geom:
    turn = matrix_from_euler(0.0, 0.0, yaw_rad)
    euler = euler_from_matrix(turn @ matrix_from_euler(*geom.euler_rad))
    return dataclasses.replace(geom, pos_m=tuple(turn @ geom.pos_m), euler_rad=euler)


def _turned_child(child: Child, yaw_rad: float) -> Child:
    turn = matrix_from_euler(0.0, 0.0, yaw_rad)
    return dataclasses.replace(child, pos_m=tuple(turn @ child.pos_m), yaw_rad=child.yaw_rad + yaw_rad)


def _between(a: Point, b: Point) -> tuple[Point, float, NDArray]:
    """Middle, half length and rotation of something whose local z runs from a to b and whose y stays level."""
    start, end = np.asarray(a, float), np.asarray(b, float)
    along = end - start
    length = float(np.linalg.norm(along))
    along /= length
    if abs(along[1]) > 0.999:
        rotation = np.column_stack([(1.0, 0.0, 0.0), np.cross(along, (1.0, 0.0, 0.0)), along])
    else:
        across = np.cross(along, (1.0, 0.0, 0.0)) if abs(along[2]) > 0.999 else np.cross((0.0, 0.0, 1.0), along)
        across /= np.linalg.norm(across)
        if across[1] < 0:
            across = -across
        rotation = np.column_stack([np.cross(across, along), across, along])
    middle = 0.5 * (start + end)
    return (float(middle[0]), float(middle[1]), float(middle[2])), 0.5 * length, rotation


def _grain_axes(half: NDArray, *, upright: bool) -> NDArray[np.float64]:
    """Rotation that lays a box's local z along its thinnest side and its local y along its longest.

    MuJoCo maps a 2d texture over a box's z faces at its true scale and stretches it over the others; the image's
    vertical, along which wood grain runs, follows local y; `upright` pictures keep it on the world's vertical.
    """
    order = np.argsort(half, kind="stable")
    if upright and order[0] != 2:
        front = 1 if half[0] > 2.5 * half[1] else 0
        order = np.array([front, 1 - front, 2])
    z, y = np.eye(3)[order[0]], np.eye(3)[order[2]]
    return np.column_stack([np.cross(y, z), y, z])


def _rounded(point: Sequence[float] | NDArray) -> Point:
    x, y, z = (round(float(v), 4) + 0.0 for v in point)
    return (x, y, z)
