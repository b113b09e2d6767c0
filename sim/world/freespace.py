"""Where the robot's disc fits on one storey, and how far it is from place to place (contract, section 2).

Free is a place of the disc that touches no collidable geom between step height and robot height above the floor, on the
house's floor. Movable things count where they stand when the `FreeSpace` is made. Arrays are indexed [row, col] =
[y, x] on `frame`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import cv2
import numpy as np
import skfmm
from numpy.typing import NDArray

from sim.errors import HouseError
from sim.geometry.convex import ConvexPolygon, plan_polygon
from sim.geometry.grid import CELL_M, PlanFrame
from sim.gl import mujoco
from sim.houses.geoms import UNBOUNDED_M, geom_polytope, geoms_between
from sim.houses.house import Room
from sim.houses.labels import Labels, collidable_geoms, geoms_of
from sim.interface import MPCAT40_ID, RobotModel

if TYPE_CHECKING:
    from sim.world.world import World

STEP_HEIGHT_M = 0.03
"""What is lower passes under the robot, or is climbed."""
WALL_REACH_M = 0.25
"""How far around a room's box still counts as the house: doorways lie inside walls."""
FLOOR_STEP_M = 0.05
"""How far a floor may be above or below its storey's height and still be stood on."""
SAME_STOREY_M = 1.0
"""Floors less than this apart are one storey."""
OPEN_FLOOR_M = 10.0
"""How much of an endless floor without walls is charted, around the things on it or the origin."""
NEAREST_FREE_M = 0.3
"""How far from the next free cell a robot may be (it pushed something) and still have a distance."""


class FreeSpace:
    """One storey of one world, as it stood when this was made."""

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        labels: Labels,
        *,
        rooms: tuple[Room, ...] = (),
        robot: RobotModel | None = None,
        floor_z_m: float = 0.0,
        robot_prefix: str = "robot/",
    ) -> None:
        """Chart the storey whose floor is at `floor_z_m`; kinematics of `data` must be computed."""
        robot = robot or RobotModel()
        self.radius_m = robot.radius_m
        self.floor_z_m = floor_z_m
        candidates = collidable_geoms(model) & ~geoms_of(model, robot_prefix)
        heights = (floor_z_m + STEP_HEIGHT_M, floor_z_m + robot.height_m)
        self._obstacles = _polygons(model, data, np.flatnonzero(candidates), heights)
        self._ground = _ground(model, data, labels, floor_z_m)
        rooms = tuple(room for room in rooms if abs(room.floor_z_m - floor_z_m) < SAME_STOREY_M)
        self._extent = _extent(model, data, labels, rooms, self._ground, self._obstacles)
        self.frame = _frame_around(self._extent)
        self.free: NDArray[np.bool_] = self._chart(rooms)  # (rows, cols)

    @classmethod
    def from_world(cls, world: World, floor_z_m: float = 0.0) -> FreeSpace:
        """The free space of a world as it stands now, the robot left out."""
        return cls(world.model, world.data, world.labels, rooms=world.rooms, robot=world.robot, floor_z_m=floor_z_m)

    def is_free(self, x_m: float, y_m: float) -> bool:
        """Whether the disc fits at exactly this place."""
        here = np.array([[x_m, y_m]], dtype=np.float64)
        if not (_covers(self._extent, here) and (self._ground is None or _covers(self._ground, here))):
            return False
        return self.clearance(x_m, y_m, at_most_m=self.radius_m) >= self.radius_m

    def largest_part(self) -> NDArray[np.bool_]:
        """(rows, cols) the largest connected part of the free space: the house as a robot in it knows it."""
        _, parts, stats, _ = cv2.connectedComponentsWithStats(self.free.astype(np.uint8), connectivity=4)
        areas = stats[1:, cv2.CC_STAT_AREA]
        return np.asarray(parts) == 1 + int(areas.argmax()) if areas.size else np.zeros_like(self.free)

    def clearance(self, x_m: float, y_m: float, *, at_most_m: float = 1.0) -> float:
        """Metres from a place to the nearest obstacle in plan, at most `at_most_m`."""
        here = np.array([[x_m, y_m]], dtype=np.float64)
        nearest = at_most_m
        for polygon in self._obstacles:
            x0, y0, x1, y1 = polygon.bounds_m
            if max(x0 - x_m, x_m - x1, y0 - y_m, y_m - y1) < nearest:
                nearest = min(nearest, float(polygon.distance(here)[0]))
        return nearest

    def geodesic(self, sources: NDArray[np.bool_]) -> NDArray[np.float32]:
        """Shortest distance in free space from each cell to the nearest source cell, by fast marching.

        Args:
            sources: (rows, cols) mask; cells that are not free do not count.

        Returns:
            (rows, cols) metres; inf where there is no way, and where nothing is free.
        """
        distance = np.full(self.frame.shape, np.inf, dtype=np.float32)
        begin = sources & self.free
        if not begin.any():
            return distance
        reached = _joined_to(self.free, begin)
        distance[begin] = 0.0
        if np.array_equal(begin, reached):
            return distance
        window = _window_of(reached)
        front = np.ma.MaskedArray(np.where(begin[window], 0.0, 1.0), mask=~reached[window])
        marched = np.ma.filled(skfmm.distance(front, dx=self.frame.cell_m), np.inf)
        distance[window][reached[window]] = marched[reached[window]]
        return distance

    def distance_at(self, field: NDArray[np.float32], x_m: float, y_m: float) -> float:
        """A geodesic field at an exact place, bilinear where all four cells around it have a value.

        Elsewhere the best of the free cells near by plus the way there; inf when there is none within
        `NEAREST_FREE_M`.
        """
        u = (x_m - self.frame.origin_xy_m[0]) / self.frame.cell_m - 0.5
        v = (y_m - self.frame.origin_xy_m[1]) / self.frame.cell_m - 0.5
        col, row = math.floor(u), math.floor(v)
        if 0 <= row < self.frame.shape[0] - 1 and 0 <= col < self.frame.shape[1] - 1:
            corners = field[row : row + 2, col : col + 2].astype(np.float64)
            if np.all(np.isfinite(corners)):
                s, t = u - col, v - row
                return float(np.array([1.0 - t, t]) @ corners @ np.array([1.0 - s, s]))
        return self._nearest_distance(field, x_m, y_m)

    def _nearest_distance(self, field: NDArray[np.float32], x_m: float, y_m: float) -> float:
        """Distance by way of the nearest cells that have one, growing the neighbourhood until there are some."""
        for reach_m in (1.5 * self.frame.cell_m, 0.5 * NEAREST_FREE_M, NEAREST_FREE_M):
            window = self.frame.window((x_m, y_m, x_m, y_m), reach_m)
            x, y = self.frame.centres(window)
            way = np.hypot(x[None, :] - x_m, y[:, None] - y_m)
            total = np.where(way <= reach_m, field[window] + way, np.inf)
            if total.size and np.isfinite(total.min()):
                return float(total.min())
        return math.inf

    def _chart(self, rooms: tuple[Room, ...]) -> NDArray[np.bool_]:
        """(rows, cols) where the disc fits; with rooms, only what can be reached from inside one."""
        free = self._covered(self._extent)
        if self._ground is not None:
            free &= self._covered(self._ground)
        x, y = self.frame.centres()
        for polygon in self._obstacles:
            rows, cols = self.frame.window(polygon.bounds_m, self.radius_m)
            here = free[rows, cols]
            row, col = np.nonzero(here)
            if row.size:
                places = np.stack([x[cols][col], y[rows][row]], axis=1)
                here[row, col] = polygon.distance(places) >= self.radius_m
        if not rooms:
            return free
        inside = self._covered([rectangle for room in rooms for rectangle in _rectangles(room)])
        return _joined_to(free, free & inside)

    def _covered(self, polygons: Iterable[ConvexPolygon]) -> NDArray[np.bool_]:
        """(rows, cols) cells whose centre lies in some polygon."""
        covered = np.zeros(self.frame.shape, dtype=np.bool_)
        for polygon in polygons:
            window = self.frame.window(polygon.bounds_m)
            x, y = self.frame.centres(window)
            places = np.stack(np.broadcast_arrays(x[None, :], y[:, None]), axis=-1).reshape(-1, 2)
            covered[window] |= polygon.contains(places).reshape(len(y), len(x))
        return covered


def _joined_to(free: NDArray[np.bool_], begin: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The free cells that a path over cell edges joins to some cell of `begin`."""
    parts = np.asarray(cv2.connectedComponents(free.astype(np.uint8), connectivity=4)[1], dtype=np.int32)
    wanted = np.zeros(int(parts.max()) + 1, dtype=np.bool_)
    wanted[np.unique(parts[begin & free])] = True
    return wanted[parts]


def _covers(polygons: Iterable[ConvexPolygon], here: NDArray[np.float64]) -> bool:
    return any(bool(polygon.contains(here)[0]) for polygon in polygons)


def _polygons(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: NDArray[np.int64], heights_m: tuple[float, float]
) -> list[ConvexPolygon]:
    """Plan projections of geoms between two heights, of those that reach there."""
    near = geoms_between(model, data, geoms, *heights_m).tolist()
    polygons = (plan_polygon(geom_polytope(model, data, geom), *heights_m) for geom in near)
    return [polygon for polygon in polygons if polygon is not None]


def _ground(model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, floor_z_m: float) -> list[ConvexPolygon] | None:
    """What carries wheels on this storey; None: all places, since a plane has no end."""
    polygons: list[ConvexPolygon] = []
    for geom in np.flatnonzero((labels.geom_category == MPCAT40_ID["floor"]) & collidable_geoms(model)):
        body = geom_polytope(model, data, int(geom))
        if abs(float(body.vertices_m[:, 2].max()) - floor_z_m) > FLOOR_STEP_M:
            continue
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
            return None
        polygon = plan_polygon(body)
        if polygon is not None:
            polygons.append(polygon)
    return polygons


def _extent(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    labels: Labels,
    rooms: tuple[Room, ...],
    ground: list[ConvexPolygon] | None,
    obstacles: list[ConvexPolygon],
) -> list[ConvexPolygon]:
    """Where the house is: its rooms and the walls around them, else what its walls, floors or things enclose."""
    if rooms:
        return [rectangle for room in rooms for rectangle in _rectangles(room, WALL_REACH_M)]
    walls = np.flatnonzero(labels.geom_category == MPCAT40_ID["wall"])
    enclosing = _polygons(model, data, walls, (-math.inf, math.inf)) or ground or obstacles
    bounded = np.array([polygon.bounds_m for polygon in enclosing]).reshape(-1, 4)
    bounded = bounded[np.abs(bounded).max(axis=1, initial=0.0) < UNBOUNDED_M]
    if len(bounded) == 0:
        return [_rectangle(-OPEN_FLOOR_M, -OPEN_FLOOR_M, OPEN_FLOOR_M, OPEN_FLOOR_M)]
    margin = 0.0 if enclosing is not obstacles else OPEN_FLOOR_M
    return [_rectangle(*(bounded[:, :2].min(axis=0) - margin), *(bounded[:, 2:].max(axis=0) + margin))]


def _rectangles(room: Room, margin_m: float = 0.0) -> list[ConvexPolygon]:
    return [
        _rectangle(x - hx - margin_m, y - hy - margin_m, x + hx + margin_m, y + hy + margin_m)
        for (x, y, _), (hx, hy, _) in room.boxes
    ]


def _rectangle(x0: float, y0: float, x1: float, y1: float) -> ConvexPolygon:
    polygon = ConvexPolygon.around(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], dtype=np.float64))
    if polygon is None:
        raise HouseError(f"the rectangle from ({x0:.3f}, {y0:.3f}) to ({x1:.3f}, {y1:.3f}) m has no area.")
    return polygon


def _frame_around(extent: list[ConvexPolygon]) -> PlanFrame:
    """The grid that covers some polygons, its cells' corners at whole multiples of the cell."""
    bounds = np.array([polygon.bounds_m for polygon in extent])
    low = np.floor(bounds[:, :2].min(axis=0) / CELL_M)
    high = np.ceil(bounds[:, 2:].max(axis=0) / CELL_M)
    cols, rows = (high - low).astype(int).tolist()
    return PlanFrame(origin_xy_m=(float(low[0] * CELL_M), float(low[1] * CELL_M)), shape=(rows, cols))


def _window_of(mask: NDArray[np.bool_]) -> tuple[slice, slice]:
    """The smallest window that holds all True cells of a mask that has some."""
    rows, cols = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(cols[0]), int(cols[-1]) + 1)
