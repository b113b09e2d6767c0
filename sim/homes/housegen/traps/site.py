"""Builds trap scenes: one hall with walls, and boxes, posts, glass and furniture in it.

The hall extends from (0, 0) to (length along x, width along y), its floor is at z = 0. All lengths are in metres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.core.errors import HouseError
from sim.gl import mujoco
from sim.homes.housegen.floor_plan.rectangles import Rect, frame_around
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.item import Geom, Item, Look
from sim.homes.housegen.mjcf.builder import HouseBuilder
from sim.homes.housegen.mjcf.movables import as_movable
from sim.homes.housegen.mjcf.placed import Lamp, PlacedItem
from sim.houses.house import House

CEILING_M = 2.5
WALL_M = 0.1
"""Thickness of walls."""
GLASS_M = 0.01
"""Thickness of panes."""
INVISIBLE_GROUP = 3
"""Group of geoms that collide but are not rendered."""
_FURNITURE_DRAWS, _WALL_GAP_M = 20, 0.01
"""Number of draws of a goal that fits into the hall, and its gap to the walls."""

PAINT = Look((0.86, 0.84, 0.79, 1.0))
BOARDS = Look((0.62, 0.50, 0.38, 1.0))
WHITE = Look((0.93, 0.93, 0.92, 1.0))
WOOD = Look((0.55, 0.38, 0.24, 1.0))
STEEL = Look((0.55, 0.56, 0.58, 1.0), specular=0.6)
FABRIC = Look((0.36, 0.42, 0.50, 1.0))
GLASS = Look((0.7, 0.85, 0.9, 0.3))

Span = tuple[float, float]
"""A coordinate and a larger one."""


@dataclass(frozen=True)
class Pit:
    """A place where the floor of a hall is lower, or opens to the storey below."""

    rect: Rect
    depth_m: float


class TrapSite:
    """A builder of one scene; every object is labelled with its category and a number."""

    def __init__(
        self,
        name: str,
        length_m: float,
        width_m: float,
        *,
        kind: str = "living_room",
        pit: Pit | None = None,
        seed: int = 0,
    ) -> None:
        """Begins a hall with a floor, walls, a ceiling and daylight.

        Args:
            name: the model's name.
            length_m: of the hall along x.
            width_m: of the hall along y.
            kind: of the room.
            pit: a place where the floor is lower.
            seed: of the furniture's style.
        """
        self.rect = Rect(0.0, 0.0, length_m, width_m)
        self.pit = pit
        self._builder = HouseBuilder(name)
        self._rng = np.random.default_rng(seed)
        self._hidden: list[str] = []
        around = self.rect.grown(WALL_M)
        for rect in frame_around(around, pit.rect) if pit else [around]:
            self._builder.add_ground(rect)
        self._builder.add_room(f"room_{kind}_00", self.rect, CEILING_M)
        self._add_shell()
        self._add_lights()

    @property
    def spec(self) -> mujoco.MjSpec:
        """The scene built so far."""
        return self._builder.spec

    @property
    def house(self) -> House:
        """The scene built so far, as a house."""
        return House(self.spec.modelname, self.spec)

    @property
    def hidden(self) -> tuple[str, ...]:
        """Names of the bodies that make the trap: depth does not show them, or too late, or as passable."""
        return tuple(self._hidden)

    def without_hidden(self) -> mujoco.MjSpec:
        """Returns the scene without its hidden bodies, and with a floor over its pit."""
        spec = self.spec.copy()
        for name in self._hidden:
            spec.delete(spec.body(name))
        if self.pit:
            (x, y), rect = self.pit.rect.centre, self.pit.rect
            half = [0.5 * rect.width_m, 0.5 * rect.depth_m, 0.05]
            spec.worldbody.add_geom(name="floor_99", type=mujoco.mjtGeom.mjGEOM_BOX, group=3, size=half,
                                    pos=[x, y, -0.05])  # fmt: skip
        return spec

    def hide(self, body: mujoco.MjsBody) -> mujoco.MjsBody:
        """Counts a body as a part of the trap; returns it."""
        self._hidden.append(body.name)
        return body

    def box(self, category: str, x: Span, y: Span, z: Span, look: Look, *, solid: bool = True) -> mujoco.MjsBody:
        """Adds a labelled box."""
        return self.add(category, [_box(x, y, z, look, solid=solid)])

    def wall(self, x: Span, y: Span) -> None:
        """Adds a wall from floor to ceiling."""
        self.box("wall", x, y, (0.0, CEILING_M), PAINT)

    def wall_across(self, x: float, *doorways: Span) -> None:
        """Adds a wall across the whole hall at `x`, open at the doorways (spans of y)."""
        y = 0.0
        for low, high in (*sorted(doorways), (self.rect.y1, self.rect.y1)):
            if low > y:
                self.wall((x - WALL_M / 2, x + WALL_M / 2), (y, low))
            if high > low:
                self.box("wall", (x - WALL_M / 2, x + WALL_M / 2), (low, high), (2.05, CEILING_M), PAINT)
            y = high

    def invisible_box(self, category: str, x: Span, y: Span, z: Span = (0.0, 2.0), *, yaw_rad: float = 0.0) -> None:
        """Adds a box that collides and is not rendered, turned about its centre."""
        for geom in self.hide(self.add(category, [_box(x, y, z, GLASS, yaw_rad=yaw_rad)])).geoms:
            geom.group = INVISIBLE_GROUP

    def pane(self, category: str, begin: tuple[float, float], end: tuple[float, float]) -> None:
        """Adds an upright invisible pane between two points."""
        length, yaw = math.dist(begin, end), math.atan2(end[1] - begin[1], end[0] - begin[0])
        x, y = 0.5 * (begin[0] + end[0]), 0.5 * (begin[1] + end[1])
        self.invisible_box(category, (x - length / 2, x + length / 2), (y - GLASS_M / 2, y + GLASS_M / 2), yaw_rad=yaw)

    def posts(
        self, category: str, places: list[tuple[float, float]], radius: float, z: Span, look: Look
    ) -> mujoco.MjsBody:
        """Adds one labelled object of several upright round posts."""
        half, middle = 0.5 * (z[1] - z[0]), 0.5 * (z[0] + z[1])
        return self.add(category, [Geom("cylinder", (radius, half), (x, y, middle), look) for x, y in places])

    def add(
        self, category: str, geoms: list[Geom], x: float = 0.0, y: float = 0.0, yaw_rad: float = 0.0
    ) -> mujoco.MjsBody:
        """Adds a labelled object of several geoms, given in the object's frame, at a pose."""
        item = Item(category, "trap", (0.0, 0.0, 0.0), tuple(geoms))
        return self.spec.body(self._builder.add(PlacedItem(item, x, y, 0.0, yaw_rad)))

    def movable_box(
        self, x: Span, y: Span, height_m: float, look: Look, *, mass_kg: float, friction: float
    ) -> mujoco.MjsBody:
        """Adds a box on the floor, of category "objects", that the robot can push."""
        (x0, x1), (y0, y1) = x, y
        half = (0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.5 * height_m)
        geom = Geom("box", half, (0.0, 0.0, half[2]), look)
        item = Item("objects", "trap", (0.0, 0.0, 0.0), (geom,))
        movable = as_movable(item, mass_kg, friction)
        self._builder.add_movable_body(movable, PlacedItem(item, 0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0, 0.0))
        return self.spec.bodies[-1]

    def goal_furniture(self, category: str, x: float, y: float) -> None:
        """Adds an item that faces the near end of the hall, at a place or as near to it as the walls allow.

        An item wider than the hall is drawn again.

        Raises:
            HouseError: no style of the category fits between the walls.
        """
        for _ in range(_FURNITURE_DRAWS):
            item = CATALOGUE.make_item(category, self._rng, pool="heldout")
            reach_x, reach_y = 0.5 * item.size_m[0] + _WALL_GAP_M, 0.5 * item.size_m[1] + _WALL_GAP_M
            if 2.0 * reach_y <= self.rect.depth_m:
                x, y = min(x, self.rect.x1 - reach_x), min(max(y, reach_y), self.rect.y1 - reach_y)
                self._builder.add(PlacedItem(item, x, y, item.mount_height_m, math.pi))
                return
        raise HouseError(f"No '{category}' fits into a hall {self.rect.depth_m:.2f} m wide.")

    def floor_slab(self, x: Span, y: Span, height_m: float, look: Look) -> mujoco.MjsBody:
        """Adds a slab of floor, for example a rug or a low sill."""
        return self.box("floor", x, y, (0.0, height_m), look)

    def _add_shell(self) -> None:
        (x0, x1), (y0, y1) = (self.rect.x0, self.rect.x1), (self.rect.y0, self.rect.y1)
        for rect in frame_around(self.rect, self.pit.rect) if self.pit else [self.rect]:
            self.box("floor", (rect.x0, rect.x1), (rect.y0, rect.y1), (-0.1, 0.0), BOARDS, solid=False)
        if self.pit:
            self._add_pit(self.pit)
        self.box("ceiling", (x0, x1), (y0, y1), (CEILING_M, CEILING_M + 0.05), WHITE, solid=False)
        for x in ((x0 - WALL_M, x0), (x1, x1 + WALL_M)):
            self.wall(x, (y0 - WALL_M, y1 + WALL_M))
        for y in ((y0 - WALL_M, y0), (y1, y1 + WALL_M)):
            self.wall((x0, x1), y)

    def _add_pit(self, pit: Pit) -> None:
        """Adds the lower floor and the walls around it, which stand back a little under the upper floor."""
        self._builder.add_ground(pit.rect, -pit.depth_m)
        hole, bottom_m = pit.rect.grown(0.02), -pit.depth_m
        self.box("floor", (hole.x0, hole.x1), (hole.y0, hole.y1), (bottom_m - 0.1, bottom_m), BOARDS, solid=False)
        for side in frame_around(hole.grown(WALL_M), hole):
            self.box("wall", (side.x0, side.x1), (side.y0, side.y1), (bottom_m - 0.1, -0.001), PAINT)

    def _add_lights(self) -> None:
        """Adds directional daylight from two sides."""
        for direction, strength in (((0.5, 0.4, -0.8), 0.42), ((-0.6, -0.3, -0.7), 0.24)):
            self._builder.add_lamp(Lamp((0.0, 0.0, CEILING_M), (strength, strength, strength), direction))


def _box(x: Span, y: Span, z: Span, look: Look, *, yaw_rad: float = 0.0, solid: bool = True) -> Geom:
    half = (0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0]), 0.5 * (z[1] - z[0]))
    middle = (0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), 0.5 * (z[0] + z[1]))
    return Geom("box", half, middle, look, (0.0, 0.0, yaw_rad), solid)
