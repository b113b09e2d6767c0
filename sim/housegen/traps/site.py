"""The workshop of trap scenes: one walled hall, and boxes, posts, glass and furniture put into it.

The hall reaches from (0, 0) to (length along x, width along y), its floor at z = 0. All lengths are metres.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sim.gl import mujoco
from sim.housegen.furniture import CATALOGUE
from sim.housegen.furniture.item import Geom, Item, Look
from sim.housegen.mjcf import HouseBuilder, Lamp, PlacedItem, RoomBox
from sim.housegen.rectangles import Rect

CEILING_M = 2.5
WALL_M = 0.1
"""Thickness of walls."""
GLASS_M = 0.01
"""Thickness of panes."""
INVISIBLE_GROUP = 3
"""Geoms of this group collide but no camera renders them."""

PAINT = Look((0.86, 0.84, 0.79, 1.0))
BOARDS = Look((0.62, 0.50, 0.38, 1.0))
WHITE = Look((0.93, 0.93, 0.92, 1.0))
WOOD = Look((0.55, 0.38, 0.24, 1.0))
STEEL = Look((0.55, 0.56, 0.58, 1.0), specular=0.6)
FABRIC = Look((0.36, 0.42, 0.50, 1.0))
GLASS = Look((0.7, 0.85, 0.9, 0.3))

Span = tuple[float, float]
"""From one coordinate to a larger one."""


class TrapSite:
    """Collects one scene; every thing gets the label of its category and a number."""

    def __init__(self, name: str, length_m: float, width_m: float, *, kind: str = "living_room") -> None:
        self.rect = Rect(0.0, 0.0, length_m, width_m)
        self._builder = HouseBuilder(name)
        self._rng = np.random.default_rng(0)
        self._builder.add_ground(self.rect.grown(WALL_M))
        self._builder.add_room(RoomBox(f"room_{kind}_00", self.rect), CEILING_M)
        self._shell()
        self._light()

    @property
    def spec(self) -> mujoco.MjSpec:
        """The scene as it stands."""
        return self._builder.spec

    def box(self, category: str, x: Span, y: Span, z: Span, look: Look, *, solid: bool = True) -> mujoco.MjsBody:
        """A labelled box."""
        return self._add(category, [_box(x, y, z, look, solid=solid)])

    def wall(self, x: Span, y: Span) -> None:
        """A wall from floor to ceiling."""
        self.box("wall", x, y, (0.0, CEILING_M), PAINT)

    def wall_across(self, x: float, *doorways: Span) -> None:
        """A wall across the whole hall at `x`, open where the doorways are (spans of y)."""
        y = 0.0
        for low, high in (*sorted(doorways), (self.rect.y1, self.rect.y1)):
            if low > y:
                self.wall((x - WALL_M / 2, x + WALL_M / 2), (y, low))
            if high > low:
                self.box("wall", (x - WALL_M / 2, x + WALL_M / 2), (low, high), (2.05, CEILING_M), PAINT)
            y = high

    def glass(self, category: str, x: Span, y: Span, z: Span = (0.0, 2.0), *, yaw_rad: float = 0.0) -> None:
        """A box that collides and that nobody sees, turned about its middle."""
        self._hide(self._add(category, [_box(x, y, z, GLASS, yaw_rad=yaw_rad)]))

    def pane(self, category: str, begin: tuple[float, float], end: tuple[float, float], z: Span = (0.0, 2.0)) -> None:
        """An upright invisible pane from one place to another."""
        length, yaw = math.dist(begin, end), math.atan2(end[1] - begin[1], end[0] - begin[0])
        x, y = 0.5 * (begin[0] + end[0]), 0.5 * (begin[1] + end[1])
        self.glass(category, (x - length / 2, x + length / 2), (y - GLASS_M / 2, y + GLASS_M / 2), z, yaw_rad=yaw)

    def posts(self, category: str, places: list[tuple[float, float]], radius: float, z: Span, look: Look) -> None:
        """One labelled thing of some upright round posts."""
        half, middle = 0.5 * (z[1] - z[0]), 0.5 * (z[0] + z[1])
        self._add(category, [Geom("cylinder", (radius, half), (x, y, middle), look) for x, y in places])

    def thing(self, category: str, geoms: list[Geom], x: float, y: float, yaw_rad: float = 0.0) -> mujoco.MjsBody:
        """A labelled thing of several geoms, in a frame of its own, at a place."""
        item = Item(category, "trap", (0.0, 0.0, 0.0), tuple(geoms))
        return self.spec.body(self._builder.add(PlacedItem(item, x, y, 0.0, yaw_rad)))

    def furniture(self, category: str, x: float, y: float, yaw_rad: float, **hints: Any) -> None:
        """A piece of the furniture that the houses have; its front looks along `yaw_rad`."""
        item = CATALOGUE.make_item(category, self._rng, pool="heldout", **hints)
        self._builder.add(PlacedItem(item, x, y, item.mount_height_m, yaw_rad))

    def slick(self, x: Span, y: Span, friction: float) -> None:
        """A patch of floor, 1 mm thick, with a friction of its own."""
        for geom in self.box("floor", x, y, (0.0, 0.001), Look((0.72, 0.80, 0.84, 1.0), specular=0.9)).geoms:
            geom.friction = [friction, 0.0, 0.0]

    def _shell(self) -> None:
        (x0, x1), (y0, y1) = (self.rect.x0, self.rect.x1), (self.rect.y0, self.rect.y1)
        self.box("floor", (x0, x1), (y0, y1), (-0.1, 0.0), BOARDS, solid=False)
        self.box("ceiling", (x0, x1), (y0, y1), (CEILING_M, CEILING_M + 0.05), WHITE, solid=False)
        for x in ((x0 - WALL_M, x0), (x1, x1 + WALL_M)):
            self.wall(x, (y0 - WALL_M, y1 + WALL_M))
        for y in ((y0 - WALL_M, y0), (y1, y1 + WALL_M)):
            self.wall((x0, x1), y)

    def _light(self) -> None:
        """Daylight from two sides, the same everywhere."""
        for direction, strength in (((0.5, 0.4, -0.8), 0.42), ((-0.6, -0.3, -0.7), 0.24)):
            self._builder.add_lamp(Lamp((0.0, 0.0, CEILING_M), (strength, strength, strength), direction))

    def _add(self, category: str, geoms: list[Geom]) -> mujoco.MjsBody:
        return self.thing(category, geoms, 0.0, 0.0)

    @staticmethod
    def _hide(body: mujoco.MjsBody) -> None:
        for geom in body.geoms:
            geom.group = INVISIBLE_GROUP


def _box(x: Span, y: Span, z: Span, look: Look, *, yaw_rad: float = 0.0, solid: bool = True) -> Geom:
    half = (0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0]), 0.5 * (z[1] - z[0]))
    middle = (0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), 0.5 * (z[0] + z[1]))
    return Geom("box", half, middle, look, (0.0, 0.0, yaw_rad), solid)
