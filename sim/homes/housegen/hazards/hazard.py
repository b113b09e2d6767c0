"""Data types of hazards: objects that block the robot although depth does not show them as obstacles."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.interface import CLIMB_M
from sim.homes.housegen.furniture.item import Geom, Item, Look, Pool
from sim.homes.housegen.furniture.transforms import bounds, matrix_from_euler
from sim.homes.housegen.hazards.floor_map import FloorMap
from sim.homes.housegen.mjcf.builder import HouseBuilder
from sim.homes.housegen.mjcf.merging import collision_geoms
from sim.homes.housegen.mjcf.movables import Movable, as_movable
from sim.homes.housegen.mjcf.placed import PlacedItem
from sim.homes.housegen.mjcf.triangles import facets
from sim.homes.housegen.structure.openings import HALF_WALL_M, Opening, OpeningKind
from sim.homes.housegen.surfaces.materials import look

ROBOT_HEIGHT_M = 0.88
"""Geoms between `CLIMB_M` and this height block the robot."""
SITE_HEIGHT_M = 2.0
UNSEEN = Look()
"""Look of geoms that are not rendered."""


@dataclass(frozen=True)
class Part:
    """One labelled object of a hazard."""

    placed: PlacedItem
    hidden: tuple[Geom, ...] = ()
    """Geoms in the item's frame that collide and are not rendered."""
    movable: Movable | None = None
    """Set for an object that the robot can push."""

    def footprints(self) -> list[NDArray[np.float64]]:
        """Returns the convex outlines (n, 2) in the world of all geoms that block the robot."""
        if self.movable is not None:
            geoms = list(self.movable.collision_geoms)
        else:
            geoms = [*collision_geoms(self.placed.item), *self.hidden]
        outlines = (_outline(geom, self.placed) for geom in geoms)
        return [outline for outline in outlines if outline is not None]


@dataclass(frozen=True)
class PlacedHazard:
    """The objects of one hazard at their places in a house."""

    kind: str
    """Family of the hazard, part of the name of its site."""
    parts: tuple[Part, ...]

    def footprints(self) -> list[NDArray[np.float64]]:
        """Returns the convex outlines (n, 2) in the world of all geoms that block the robot."""
        return [outline for part in self.parts for outline in part.footprints()]

    def add_to(self, builder: HouseBuilder, number: int) -> None:
        """Adds the objects and the site `hazard_<kind>_<number>` that marks their position."""
        for part in self.parts:
            if part.movable is not None:
                builder.add_movable_body(part.movable, part.placed)
            else:
                builder.add_collision_geoms(builder.add(part.placed), part.hidden)
        points = np.vstack([_corners(part) for part in self.parts])
        low, high = points.min(axis=0), points.max(axis=0)
        builder.add_box_site(f"hazard_{self.kind}_{number:02d}", (*low, 0.0), (*high, SITE_HEIGHT_M))


@dataclass(eq=False)
class Sketch:
    """A hazard that is being assembled around a pose: its origin lies on a path, its +x points along the path."""

    kind: str
    x_m: float
    y_m: float
    yaw_rad: float
    rng: np.random.Generator
    pool: Pool
    looks: Mapping[str, Look]
    """Looks that all hazards of a house share: `frame` and `dots`."""
    floor: FloorMap
    _parts: list[Part] = field(default_factory=list)

    def align(self) -> None:
        """Turns the sketch to the nearest direction of the walls."""
        self.yaw_rad = round(self.yaw_rad / (math.pi / 2)) * math.pi / 2

    def draw_opening(self, *kinds: OpeningKind, bare: bool = False) -> Opening | None:
        """Draws one of the house's openings of these kinds, if `bare` one without a leaf; None if there is none."""
        openings = [o for o in self.floor.openings if o.kind in kinds and not (bare and o.leaf is not None)]
        return openings[int(self.rng.integers(len(openings)))] if openings else None

    def move_into(self, opening: Opening, at_m: float | None = None) -> float:
        """Moves the sketch to a position along an opening, or to its middle; its +x then crosses the wall.

        Returns:
            The clear width of the opening, metres.
        """
        low, high = opening.clear_span()
        at_m = 0.5 * (low + high) if at_m is None else at_m
        self.x_m, self.y_m = opening.point(at_m)
        self.yaw_rad = (math.pi / 2 if opening.side in ("north", "south") else 0.0) + (
            math.pi if self.rng.random() < 0.5 else 0.0
        )
        return high - low

    def draw_hinge(self, width_m: float, angle_rad: float) -> tuple[tuple[float, float], float]:
        """Returns place (metres) and yaw, in the sketch's frame, of a door leaf that is open by an angle.

        The doorway is at the sketch. The hinge is at a random jamb, and the leaf opens to a random side.
        """
        hinge, into = (1 if self.rng.random() < 0.5 else -1), (1 if self.rng.random() < 0.5 else -1)
        # The closed leaf points along -hinge * y from its hinge; it opens towards into * x.
        closed = -hinge * math.pi / 2
        return (into * (HALF_WALL_M + 0.05), hinge * 0.5 * width_m), closed + hinge * into * angle_rad

    def add(
        self, category: str, visible: list[Geom], hidden: tuple[Geom, ...] = (), *,
        at: tuple[float, float] = (0.0, 0.0), yaw_rad: float = 0.0,
    ) -> None:  # fmt: skip
        """Adds an object that stays in place; its geoms are in its own frame."""
        self._parts.append(Part(self._place(_item(category, self.kind, visible), at, yaw_rad), hidden))

    def add_movable(
        self, category: str, geoms: list[Geom], mass_kg: float, friction: float, *,
        at: tuple[float, float] = (0.0, 0.0), yaw_rad: float = 0.0,
    ) -> None:  # fmt: skip
        """Adds an object that the robot can push."""
        item = _item(category, self.kind, geoms)
        movable = as_movable(item, mass_kg, friction)
        self._parts.append(Part(self._place(item, at, yaw_rad), movable=movable))

    def uniform(self, low: float, high: float) -> float:
        """Returns a random number between two others."""
        return float(self.rng.uniform(low, high))

    def look(self, material: str) -> Look:
        """Draws a look of a material from the pool of the house."""
        return look(material, self.rng, self.pool)

    def finish(self) -> PlacedHazard:
        """Returns the hazard."""
        return PlacedHazard(self.kind, tuple(self._parts))

    def _place(self, item: Item, at: tuple[float, float], yaw_rad: float) -> PlacedItem:
        here = PlacedItem(item, self.x_m, self.y_m, 0.0, self.yaw_rad)
        x, y = here.to_world(*at)
        return replace(here, x_m=round(x, 4), y_m=round(y, 4), yaw_rad=round(self.yaw_rad + yaw_rad, 4))


Design = Callable[[Sketch], bool]
"""Adds the objects of one kind of hazard to a sketch; returns False if it does not fit there."""


def box(
    x: tuple[float, float], y: tuple[float, float], z: tuple[float, float], look: Look, *, solid: bool = True
) -> Geom:
    """Returns the box with these ranges along each axis, metres."""
    half = tuple(round(0.5 * (b - a), 4) for a, b in (x, y, z))
    cx, cy, cz = (round(0.5 * (a + b), 4) for a, b in (x, y, z))
    return Geom("box", half, (cx, cy, cz), look, solid=solid)


def rod(a: tuple[float, float, float], b: tuple[float, float, float], radius_m: float, look: Look) -> Geom:
    """Returns the cylinder from `a` to `b`, points in metres."""
    (ax, ay, az), (dx, dy, dz) = a, (b[0] - a[0], b[1] - a[1], b[2] - a[2])
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    tilt, turn = math.acos(dz / length), math.atan2(dy, dx)
    # The axis is (sin tilt cos turn, sin tilt sin turn, cos tilt): intrinsic rotations about x, then y.
    about_y = math.asin(math.sin(tilt) * math.cos(turn))
    about_x = math.atan2(-math.sin(tilt) * math.sin(turn), math.cos(tilt))
    middle = (round(ax + dx / 2, 4), round(ay + dy / 2, 4), round(az + dz / 2, 4))
    return Geom("cylinder", (radius_m, round(length / 2, 4)), middle, look, (about_x, about_y, 0.0))


def post(x: float, y: float, z: tuple[float, float], radius_m: float, look: Look) -> Geom:
    """Returns the upright cylinder at (x, y) with this range of heights, metres."""
    return rod((x, y, z[0]), (x, y, z[1]), radius_m, look)


def _item(category: str, style: str, geoms: list[Geom]) -> Item:
    if not geoms:
        return Item(category, style, (0.0, 0.0, 0.0), ())
    low, high = bounds(geoms)
    size = tuple(round(2.0 * float(max(abs(a), abs(b))), 4) for a, b in zip(low[:2], high[:2], strict=True))
    return Item(category, style, (size[0], size[1], round(float(high[2]), 4)), tuple(geoms))


def _world_corners(geom: Geom, placed: PlacedItem) -> NDArray[np.float64]:
    """Returns the corners (n, 3) of a geom in the world."""
    turn = matrix_from_euler(0.0, 0.0, placed.yaw_rad)
    local = np.asarray(geom.pos_m) + facets(geom)[0] @ matrix_from_euler(*geom.euler_rad).T
    return local @ turn.T + np.array([placed.x_m, placed.y_m, placed.z_m])


def _outline(geom: Geom, placed: PlacedItem) -> NDArray[np.float64] | None:
    """Returns the convex outline (n, 2) of a geom; None for one that does not block the robot."""
    corners = _world_corners(geom, placed)
    if corners[:, 2].max() <= CLIMB_M or corners[:, 2].min() >= ROBOT_HEIGHT_M:
        return None
    return cv2.convexHull(corners[:, :2].astype(np.float32))[:, 0, :].astype(np.float64)


def _corners(part: Part) -> NDArray[np.float64]:
    """Returns the corners (n, 2) in plan of all geoms of a part."""
    return np.vstack([_world_corners(geom, part.placed)[:, :2] for geom in (*part.placed.item.geoms, *part.hidden)])
