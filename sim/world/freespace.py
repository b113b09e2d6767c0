"""Free space of the robot on one storey, and geodesic distances in it (docs/task.md).

A position is free when the robot's disc lies on floors of the house, so that no wheel can be beyond the edge of a
stairwell, and touches no obstacle (`sim.world.obstacles`). Movable objects count at their positions when the
`FreeSpace` is made; a door leaf that the robot must push, and can, counts as open (`sim.world.leaves`). Arrays are
indexed [row, col] = [y, x] on `frame`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.core.geometry.convex import ConvexPolygon, PolygonTable
from sim.core.geometry.convex_kernels import clear_near, mark_inside
from sim.core.geometry.descent_kernels import descend
from sim.core.geometry.fast_marching import distances
from sim.core.geometry.grid import GridFrame
from sim.core.interface import RobotModel, SuccessRule
from sim.core.store import kept, key_of
from sim.gl import mujoco
from sim.houses.house import Room
from sim.houses.labels import Labels
from sim.world.leaves import pushed_open
from sim.world.obstacles import obstacle_polygons
from sim.world.plan import floor_polygons, house_extent, polygons_between, room_rectangles

CELL_M = 0.025
"""Edge of a cell of the free space."""
MAX_CELLS = 25_000_000
"""Cells of the grid of a storey: 125 x 125 m. The largest house that ships has 2 million."""
NEAREST_FREE_M = 0.3
"""A position at most this far from a free cell still has a geodesic distance: the robot may have pushed an object."""
SEAM_M = 0.06
"""Narrower gaps between floors are not edges: a wheel crosses them."""
_RIM_POINTS = 32
"""Points on the rim of the disc that the exact test looks for a floor at."""


@dataclass(frozen=True)
class Storey:
    """The geometry of one storey in plan."""

    obstacles: PolygonTable
    unpushed: PolygonTable
    """Door leaves that the robot must push, as they are."""
    floors: PolygonTable | None
    """None: an infinite plane."""
    extent: PolygonTable
    """Covers the storey."""
    frame: GridFrame
    free: NDArray[np.bool_]  # (rows, cols) on `frame`


class FreeSpace:
    """The free space of one storey of one world, for the state in which it was made.

    `free` is the mask (rows, cols) of free cells on `frame`.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        labels: Labels,
        *,
        rooms: tuple[Room, ...] = (),
        robot: RobotModel | None = None,
        rule: SuccessRule | None = None,
        floor_z_m: float = 0.0,
        key: str | None = None,
    ) -> None:
        """Computes the free space of the storey with its floor at `floor_z_m`.

        Args:
            model: a compiled house or world.
            data: its state; kinematics must be computed.
            labels: of `model`.
            rooms: of all storeys; without rooms the walls, floors or obstacles bound the free space.
            robot: its radius, height and clearance count; the default robot when None.
            rule: says how far apart storeys are; the default rule when None.
            floor_z_m: height of the storey's floor.
            key: names the world and its state; the result is then kept in the user's cache (`sim.core.store`).
        """
        robot, rule = robot or RobotModel(), rule or SuccessRule()
        self.radius_m = robot.radius_m
        self.floor_z_m = floor_z_m

        def make() -> Storey:
            opened, leaves = pushed_open(model, data, labels, robot.radius_m)
            obstacles = obstacle_polygons(model, opened, labels, robot, floor_z_m)
            heights_m = (floor_z_m + robot.climb_m, floor_z_m + robot.height_m)
            unpushed = polygons_between(model, data, np.array(leaves, np.int64), heights_m) if leaves else []
            floors = floor_polygons(model, data, labels, floor_z_m)
            near = tuple(room for room in rooms if abs(room.floor_z_m - floor_z_m) < rule.same_storey_m)
            extent = house_extent(model, data, labels, near, floors, obstacles)
            frame = _frame_around(extent)
            free = _free_cells(frame, extent, floors, obstacles, near, robot.radius_m)
            table = PolygonTable.of
            on = None if floors is None else table(floors)
            return Storey(table(obstacles), table(unpushed), on, table(extent), frame, free)

        parts = None if key is None else key_of("storey", key, robot, rule, floor_z_m)
        self._storey = kept(parts, Storey, make)
        self.frame, self.free = self._storey.frame, self._storey.free

    @property
    def obstacles(self) -> tuple[ConvexPolygon, ...]:
        """Plan projections of the geoms that are obstacles for the robot."""
        return self._storey.obstacles.polygons

    @property
    def floors(self) -> tuple[ConvexPolygon, ...] | None:
        """Plan projections of the floors; None: an infinite plane."""
        return None if self._storey.floors is None else self._storey.floors.polygons

    def is_free(self, x_m: float, y_m: float) -> bool:
        """Returns whether the disc fits at exactly this position."""
        here = np.array([[x_m, y_m]], dtype=np.float64)
        if not _covers(self._storey.extent.polygons, here) or not self._stands_on_floor(x_m, y_m):
            return False
        return self.clearance(x_m, y_m, at_most_m=self.radius_m) >= self.radius_m

    def _stands_on_floor(self, x_m: float, y_m: float) -> bool:
        """Returns whether the floors carry the whole disc at exactly this position; seams are ignored."""
        if self.floors is None:
            return True
        angles = np.linspace(0.0, 2.0 * np.pi, _RIM_POINTS, endpoint=False)
        rim = np.array([[x_m, y_m]]) + self.radius_m * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        carried = {step: np.zeros(_RIM_POINTS, dtype=np.bool_) for step in _SEAM_STEPS}
        for polygon in self.floors:
            for step, places in carried.items():
                places |= polygon.contains(rim + np.array(step))
        here, east, west, north, south = carried.values()
        return _covers(self.floors, np.array([[x_m, y_m]])) and bool((here | (east & west) | (north & south)).all())

    def largest_part(self) -> NDArray[np.bool_]:
        """Returns the mask (rows, cols) of the largest connected part of the free space.

        Places that only a leaf connects to it which the robot would have to pull are not part of it.
        """
        free = self.free
        if unpushed := self._storey.unpushed.polygons:
            free = free.copy()
            _clear_near(self.frame, free, unpushed, self.radius_m)
        _, parts, stats, _ = cv2.connectedComponentsWithStats(free.astype(np.uint8), connectivity=4)
        areas = stats[1:, cv2.CC_STAT_AREA]
        return np.asarray(parts) == 1 + int(areas.argmax()) if areas.size else np.zeros_like(self.free)

    def clearance(self, x_m: float, y_m: float, *, at_most_m: float = 1.0) -> float:
        """Returns the distance in metres in plan to the nearest obstacle, at most `at_most_m`."""
        here = np.array([[x_m, y_m]], dtype=np.float64)
        nearest = at_most_m
        for polygon in self.obstacles:
            x0, y0, x1, y1 = polygon.bounds_m
            if max(x0 - x_m, x_m - x1, y0 - y_m, y_m - y1) < nearest:
                nearest = min(nearest, float(polygon.distance(here)[0]))
        return nearest

    def geodesic(self, sources: NDArray[np.bool_]) -> NDArray[np.float32]:
        """Returns the shortest distance in free space from each cell to the nearest source, by fast marching.

        Args:
            sources: mask (rows, cols); cells that are not free do not count.

        Returns:
            (rows, cols) metres; inf for cells without a path, and everywhere without a free source.
        """
        return distances(sources, self.free, self.frame.cell_m)

    def distance_at(self, field: NDArray[np.float32], x_m: float, y_m: float) -> float:
        """Returns the value of a geodesic field at an exact position, bilinear where all four cells are finite.

        Elsewhere it is the minimum, over the finite cells within `NEAREST_FREE_M`, of their value plus the distance to
        them; inf if no cell there is finite.
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
        """Returns the distance through the nearest finite cells; the neighbourhood grows until it has some."""
        for reach_m in (1.5 * self.frame.cell_m, 0.5 * NEAREST_FREE_M, NEAREST_FREE_M):
            window = self.frame.index_of((x_m, y_m, x_m, y_m), reach_m)
            x, y = self.frame.axes(window)
            to_cell = np.hypot(x[None, :] - x_m, y[:, None] - y_m)
            total = np.where(to_cell <= reach_m, field[window] + to_cell, np.inf)
            if total.size and np.isfinite(total.min()):
                return float(total.min())
        return math.inf

    def path(self, field: NDArray[np.float32], x_m: float, y_m: float) -> NDArray[np.float64] | None:
        """Returns the corners (k, 2) of the shortest path from a position to the sources of a geodesic field, metres.

        The path follows the field downhill from the nearest cell within `NEAREST_FREE_M` that has a path, and is then
        straightened within the free cells. None: no such cell.
        """
        window = self.frame.index_of((x_m, y_m, x_m, y_m), NEAREST_FREE_M)
        x, y = self.frame.axes(window)
        away_m = np.where(np.isfinite(field[window]), np.hypot(x[None, :] - x_m, y[:, None] - y_m), math.inf)
        if not math.isfinite(away_m.min(initial=math.inf)):
            return None
        row, col = np.unravel_index(int(away_m.argmin()), away_m.shape)
        cells = descend(field, int(row) + window[0].start, int(col) + window[1].start)
        places_m = np.vstack([(x_m, y_m), self.frame.to_metres(cells)])
        kept, here = [0], 0
        while here < len(places_m) - 1:
            ahead = len(places_m) - 1
            while ahead > here + 1 and not self._is_straight(places_m[here], places_m[ahead]):
                ahead = here + max(1, (ahead - here) // 2)
            while ahead + 1 < len(places_m) and self._is_straight(places_m[here], places_m[ahead + 1]):
                ahead += 1
            kept.append(ahead)
            here = ahead
        return places_m[kept]

    def _is_straight(self, begin_m: NDArray[np.float64], end_m: NDArray[np.float64]) -> bool:
        """Returns whether the cells on the straight line between two positions are free."""
        count = max(2, math.ceil(math.dist(begin_m, end_m) / (0.5 * self.frame.cell_m)))
        cells = self.frame.to_cells(np.linspace(begin_m, end_m, count))[1:]  # the start may lie next to a free cell
        rows, cols = np.clip(cells, 0, np.array(self.frame.shape) - 1).T  # nor on the grid
        return bool(self.free[rows, cols].all())


def _free_cells(
    frame: GridFrame,
    extent: list[ConvexPolygon],
    floors: list[ConvexPolygon] | None,
    obstacles: list[ConvexPolygon],
    rooms: tuple[Room, ...],
    radius_m: float,
) -> NDArray[np.bool_]:
    """Returns the mask (rows, cols) of free cells; with rooms, only those connected to the inside of a room."""
    free = covered(frame, extent)
    if floors is not None:
        free &= _away_from_edges(frame, covered(frame, floors), radius_m)
    _clear_near(frame, free, obstacles, radius_m)
    if not rooms:
        return free
    inside = covered(frame, [rectangle for room in rooms for rectangle in room_rectangles(room)])
    return connected_to(free, free & inside)


def _clear_near(frame: GridFrame, free: NDArray[np.bool_], obstacles: Iterable[ConvexPolygon], radius_m: float) -> None:
    """Clears the cells of a mask (rows, cols) at which the robot's disc would touch an obstacle."""
    x, y = frame.axes()
    for polygon in obstacles:
        rows, cols = frame.index_of(polygon.bounds_m, radius_m)
        shape = (polygon.vertices_m, polygon.normals, polygon.offsets_m)
        clear_near(free[rows, cols], x[cols], y[rows], *shape, radius_m)


def _away_from_edges(frame: GridFrame, floor: NDArray[np.bool_], radius_m: float) -> NDArray[np.bool_]:
    """Returns a mask (rows, cols) of the cells with their disc on the floor; seams and the grid's border count."""
    if floor.all():
        return floor
    seam, disc = (_disc(round(length_m / frame.cell_m)) for length_m in (0.5 * SEAM_M, radius_m))
    whole = cv2.morphologyEx(floor.astype(np.uint8), cv2.MORPH_CLOSE, seam)
    return floor & (cv2.erode(whole, disc, borderType=cv2.BORDER_CONSTANT, borderValue=1) > 0)


def covered(frame: GridFrame, polygons: Iterable[ConvexPolygon]) -> NDArray[np.bool_]:
    """Returns the mask (rows, cols) of cells with their centre in a polygon."""
    covered = np.zeros(frame.shape, dtype=np.bool_)
    for polygon in polygons:
        window = frame.index_of(polygon.bounds_m)
        x, y = frame.axes(window)
        mark_inside(covered[window], x, y, polygon.normals, polygon.offsets_m)
    return covered


_SEAM_STEPS = tuple((0.5 * SEAM_M * x, 0.5 * SEAM_M * y) for x, y in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)))


def _disc(radius_cells: int) -> NDArray[np.uint8]:
    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius_cells + 1,) * 2), np.uint8)


def connected_to(free: NDArray[np.bool_], begin: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Returns the free cells that are connected over cell edges to a cell of `begin`."""
    parts = np.asarray(cv2.connectedComponents(free.astype(np.uint8), connectivity=4)[1], dtype=np.int32)
    kept = np.zeros(int(parts.max()) + 1, dtype=np.bool_)
    kept[np.unique(parts[begin & free])] = True
    return kept[parts]


def _covers(polygons: Iterable[ConvexPolygon], here: NDArray[np.float64]) -> bool:
    return any(bool(polygon.contains(here)[0]) for polygon in polygons)


def _frame_around(extent: list[ConvexPolygon]) -> GridFrame:
    """Returns the grid that covers the polygons; its cell corners are at whole multiples of the cell size."""
    bounds = np.array([polygon.bounds_m for polygon in extent])
    low = np.floor(bounds[:, :2].min(axis=0) / CELL_M)
    high = np.ceil(bounds[:, 2:].max(axis=0) / CELL_M)
    cols, rows = (high - low).astype(int).tolist()
    if rows * cols > MAX_CELLS:
        raise HouseError(
            f"A storey of {cols * CELL_M:.0f} x {rows * CELL_M:.0f} m is too large: its free space is computed for at "
            f"most {MAX_CELLS * CELL_M**2:.0f} m2."
        )
    return GridFrame(origin_xy_m=(float(low[0] * CELL_M), float(low[1] * CELL_M)), shape=(rows, cols), cell_m=CELL_M)
