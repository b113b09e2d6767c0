"""The workbench on which a style builds an item: it draws lengths and looks and collects geoms.

A style is a function that adds geoms to a `Workbench`, in any frame with +x to the front; `finish` moves the origin to
the place that `item.py` defines. All lengths are in metres. Boxes are given by their ranges, `(low, high)` along each
axis.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Sequence
from typing import TypeVar, Unpack

import numpy as np
from numpy.typing import NDArray

from sim.homes.housegen.furniture.item import Child, Geom, Hints, Item, Look, MeshShape, Mount, Pool, Shape, Surface
from sim.homes.housegen.furniture.transforms import (
    bounds,
    euler_from_matrix,
    matrix_from_euler,
    roll_tilt_turn,
    rounded_point,
)
from sim.homes.housegen.surfaces import materials
from sim.homes.housegen.surfaces.textures import TEXTURES

T = TypeVar("T")
Range = tuple[float, float]
Point = tuple[float, float, float]

CORNERS = ((-1, -1), (-1, 1), (1, -1), (1, 1))
"""The signs of x and y at the corners of a rectangle around the origin."""
MIN_HALF_M = 0.0005
"""Smallest half size of a geom, since MuJoCo requires positive sizes."""


class Workbench:
    """The state of one item while it is built. `make` builds the children (cushions, sinks) that a style needs."""

    def __init__(self, rng: np.random.Generator, pool: Pool, hints: Hints, make: Callable[..., Item]) -> None:
        self.rng = rng
        self.pool: Pool = pool
        self.hints = hints
        self.mass_kg: float | None = None
        self.mount_height_m = 0.0
        self._make = make
        self._looks: dict[str, Look] = {}
        self._geoms: list[Geom] = []
        self._collision_geoms: list[Geom] = []
        self._children: list[Child] = []
        self._surfaces: list[Surface] = []

    # ---- random draws ------------------------------------------------------------------------------------------

    def length(self, low_m: float, high_m: float, hint: str | None = None) -> float:
        """Returns the caller's hint of that name, or draws a length from the range in steps of 5 mm."""
        if hint is not None and self.hints.get(hint) is not None:
            return float(self.hints[hint])
        return round(200 * self.rng.uniform(low_m, high_m)) / 200

    def width(self, low_m: float, high_m: float) -> float:
        """Returns a width along y; hint `width_m`."""
        return self.length(low_m, high_m, "width_m")

    def depth(self, low_m: float, high_m: float) -> float:
        """Returns a depth along x; hint `depth_m`."""
        return self.length(low_m, high_m, "depth_m")

    def height(self, low_m: float, high_m: float) -> float:
        """Returns a height along z; hint `height_m`."""
        return self.length(low_m, high_m, "height_m")

    def whole(self, low: int, high: int) -> int:
        """Draws an integer from low to high, both included."""
        return int(self.rng.integers(low, high + 1))

    def chance(self, probability: float) -> bool:
        """Returns True with this probability."""
        return bool(self.rng.random() < probability)

    def choice(self, options: Sequence[T]) -> T:
        """Draws one of the options."""
        return options[int(self.rng.integers(len(options)))]

    def flag(self, hint: str, probability: float) -> bool:
        """Returns the caller's boolean hint of that name, or True with this probability."""
        drawn = self.chance(probability)
        return bool(self.hints[hint]) if self.hints.get(hint) is not None else drawn

    def look(self, material: str) -> Look:
        """Returns the item's look of this material: drawn once, the same at every call; hint `looks` determines it."""
        if material not in self._looks:
            drawn = materials.look(material, self.rng, self.pool)
            self._looks[material] = (self.hints.get("looks") or {}).get(material, drawn)
        return self._looks[material]

    def new_look(self, material: str) -> Look:
        """Draws another look of this material at every call (book spines, cushions, clothes)."""
        return materials.look(material, self.rng, self.pool)

    # ---- geoms -------------------------------------------------------------------------------------------------

    def add(
        self, shape: Shape, size: Sequence[float], at: Point, rotation: NDArray, look: Look, *, solid: bool = True,
        mesh: MeshShape | None = None,
    ) -> None:  # fmt: skip
        """Adds a geom of any shape: half sizes, centre, rotation matrix (3, 3)."""
        half = tuple(round(max(float(s), MIN_HALF_M), 4) for s in size)
        self._geoms.append(Geom(shape, half, rounded_point(at), look, euler_from_matrix(rotation), solid, mesh))

    def box(
        self, x: Range, y: Range, z: Range, look: Look, *, solid: bool = True, tilt: float = 0.0, turn: float = 0.0,
        roll: float = 0.0,
    ) -> None:  # fmt: skip
        """Adds the box with these ranges, rolled about x, then tilted about y (+: top forward), then turned about z."""
        at = tuple(0.5 * (lo + hi) for lo, hi in (x, y, z))
        half = np.array([0.5 * abs(hi - lo) for lo, hi in (x, y, z)])
        rotation = roll_tilt_turn(roll, tilt, turn)
        if look.texture is not None:
            axes = _grain_axes(half, upright=TEXTURES[look.texture].upright)
            rotation, half = rotation @ axes, np.abs(axes.T @ half)
        self.add("box", tuple(half), at, rotation, look, solid=solid)  # type: ignore[arg-type]

    def cylinder(self, xy: tuple[float, float], z: Range, radius: float, look: Look, *, solid: bool = True) -> None:
        """Adds an upright cylinder."""
        self.add("cylinder", (radius, 0.5 * (z[1] - z[0])), (*xy, 0.5 * (z[0] + z[1])), np.eye(3), look, solid=solid)

    def rod(
        self, a: Point, b: Point, radius: float, look: Look, *, solid: bool = True, round_ends: bool = False
    ) -> None:
        """Adds a cylinder (or a capsule) from a to b."""
        middle, half, rotation = _between(a, b)
        self.add("capsule" if round_ends else "cylinder", (radius, half), middle, rotation, look, solid=solid)

    def rod_x(
        self, yz: tuple[float, float], x: Range, radius: float, look: Look, *, solid: bool = True,
        round_ends: bool = False,
    ) -> None:  # fmt: skip
        """Adds a cylinder (or a capsule) along x."""
        self.rod((x[0], *yz), (x[1], *yz), radius, look, solid=solid, round_ends=round_ends)

    def rod_y(
        self, xz: tuple[float, float], y: Range, radius: float, look: Look, *, solid: bool = True,
        round_ends: bool = False,
    ) -> None:  # fmt: skip
        """Adds a cylinder (or a capsule) along y."""
        self.rod((xz[0], y[0], xz[1]), (xz[0], y[1], xz[1]), radius, look, solid=solid, round_ends=round_ends)

    def bent_rod(self, path: Sequence[Point], radius: float, look: Look) -> None:
        """Adds a capsule from each point of a path to the next."""
        for a, b in itertools.pairwise(path):
            self.rod(a, b, radius, look, round_ends=True)

    def bar(self, a: Point, b: Point, wide: float, thick: float, look: Look, *, solid: bool = True) -> None:
        """Adds a box from a to b, `wide` as nearly along y as possible and `thick` across; full lengths."""
        middle, half, rotation = _between(a, b)
        self.add("box", (0.5 * thick, 0.5 * wide, half), middle, rotation, look, solid=solid)

    def ball(self, at: Point, radius: float, look: Look, *, solid: bool = True) -> None:
        """Adds a sphere."""
        self.add("sphere", (radius,), at, np.eye(3), look, solid=solid)

    def ellipsoid(self, at: Point, half: Point, look: Look, *, solid: bool = True, tilt: float = 0.0) -> None:
        """Adds an ellipsoid with these half axes, tilted about y."""
        self.add("ellipsoid", half, at, matrix_from_euler(0.0, tilt, 0.0), look, solid=solid)

    def mesh(
        self, shape: MeshShape, at: Point, look: Look, *, solid: bool = True, roll: float = 0.0, tilt: float = 0.0,
        turn: float = 0.0,
    ) -> None:  # fmt: skip
        """Adds a mesh without texture, its origin at `at`, rolled about x, then tilted about y, then turned about z."""
        rotation = roll_tilt_turn(roll, tilt, turn)
        plain = dataclasses.replace(look, texture=None)
        self.add("mesh", (), at, rotation, plain, solid=solid, mesh=shape)

    def legs(
        self, x: Range, y: Range, z: Range, thick: float, look: Look, *, splay: float = 0.0, round_: bool = False
    ) -> None:
        """Adds four legs with tops in the corners of the x, y rectangle and feet `splay` metres further out."""
        for sx, sy in CORNERS:
            top = (x[0] if sx < 0 else x[1], y[0] if sy < 0 else y[1], z[1])
            foot = (top[0] + sx * splay, top[1] + sy * splay, z[0])
            if splay or round_:
                self.rod(foot, top, 0.5 * thick, look)
            else:
                inset = 0.5 * thick
                cx, cy = top[0] - sx * inset, top[1] - sy * inset
                self.box((cx - inset, cx + inset), (cy - inset, cy + inset), z, look)

    def hidden_box(self, x: Range, y: Range, z: Range) -> None:
        """Adds a box that collides and is not rendered; an item that has one has no other collision geoms."""
        at = tuple(0.5 * (lo + hi) for lo, hi in (x, y, z))
        half = tuple(round(max(0.5 * (hi - lo), MIN_HALF_M), 4) for lo, hi in (x, y, z))
        self._collision_geoms.append(Geom("box", half, rounded_point(at), Look()))

    # ---- surfaces, children and the result ---------------------------------------------------------------------

    def top(self, x: Range, y: Range, z: float, kind: str = "top") -> None:
        """Declares a rectangle at height z on which smaller objects may stand."""
        centre = (0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), z)
        self._surfaces.append(Surface(centre, (0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])), kind))

    def make(self, category: str, **hints: Unpack[Hints]) -> Item:
        """Builds an item of another category from the same pool."""
        return self._make(category, self.rng, pool=self.pool, **hints)

    def put(self, item: Item, at: Point, yaw: float = 0.0) -> None:
        """Adds another item as a child, with its own label."""
        self._children.append(Child(item, rounded_point(at), round(yaw, 4)))

    def finish(self, category: str, style: str, mount: Mount, *, walk_over: bool = False) -> Item:
        """Returns the item with its origin at the middle of the footprint, the surface of the wall, or the ceiling."""
        low, high = bounds(self._geoms, self._children)
        middle = 0.5 * (low + high)
        x = low[0] if mount == "wall" else middle[0]
        z = high[2] if mount == "ceiling" else low[2]
        shift = -np.array([x, middle[1], z])
        size = tuple(float(s) for s in np.round(high - low, 4))
        return Item(
            category=category, style=style, size_m=size, mount=mount,  # type: ignore[arg-type]
            geoms=tuple(dataclasses.replace(g, pos_m=rounded_point(np.add(g.pos_m, shift))) for g in self._geoms),
            children=tuple(dataclasses.replace(c, pos_m=rounded_point(np.add(c.pos_m, shift))) for c in self._children),
            surfaces=tuple(
                dataclasses.replace(s, centre_m=rounded_point(np.add(s.centre_m, shift))) for s in self._surfaces
            ),
            mount_height_m=self.mount_height_m, mass_kg=self.mass_kg, walk_over=walk_over,
            collision_geoms=tuple(
                dataclasses.replace(g, pos_m=rounded_point(np.add(g.pos_m, shift))) for g in self._collision_geoms
            ),
        )  # fmt: skip


def _between(a: Point, b: Point) -> tuple[Point, float, NDArray]:
    """Returns middle, half length and rotation of a geom: its local z runs from a to b, its local y is level."""
    start, end = np.asarray(a, float), np.asarray(b, float)
    along = end - start
    length = float(np.linalg.norm(along))
    if length == 0.0:
        raise ValueError("A rod or a bar needs two different ends.")
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
    """Returns the rotation that puts the local z of a box along its thinnest side and its local y along its longest.

    MuJoCo maps a 2d texture to the z faces of a box at its true scale and stretches it over the other faces. The
    vertical of the image, along which wood grain runs, follows local y; `upright` images keep it vertical.
    """
    order = np.argsort(half, kind="stable")
    if upright and order[0] != 2:
        front = 1 if half[0] > 2.5 * half[1] else 0
        order = np.array([front, 1 - front, 2])
    z, y = np.eye(3)[order[0]], np.eye(3)[order[2]]
    return np.column_stack([np.cross(y, z), y, z])
