"""Habitat's `PathFinder` over the free space of the robot: snapping, shortest paths, motion without physics, maps.

Each storey has a free space of its own (`sim.world.freespace`); the robot cannot climb stairs, so no path leads from
one to another. Positions are (3,) in Habitat's frame, metres.
"""

from __future__ import annotations

import functools
import math
import numbers
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.app.bridges.habitat_sim.maths import Vector3
from sim.app.bridges.habitat_sim.settings import NavMeshSettings
from sim.core.errors import ConfigError
from sim.core.geometry.grid import GridFrame
from sim.core.interface import Action
from sim.env.oracle import Destination, Follower
from sim.episodes.habitat import from_position, to_position
from sim.task.ground_truth import GroundTruth
from sim.world.freespace import NEAREST_FREE_M, FreeSpace
from sim.world.kinematic import Glide
from sim.world.storeys import storey_floors

MARGIN_M = 0.15
"""Margin of the box that contains the free space."""
SNAP_M = 2.0
"""A point farther than this from the free space snaps to nothing, as with Habitat's navigation meshes."""


class GreedyFollowerError(Exception):
    """No path leads to the goal of a follower."""


class MultiGoalShortestPath:
    """A question to `PathFinder.find_path`, and its answer.

    Distances to the last ends are kept, so that the same object answers for other starts at once.
    """

    def __init__(self) -> None:
        self.requested_start: Any = None
        self.geodesic_distance = math.inf
        """Length of the path to the nearest end, metres; inf: there is none."""
        self._ends: NDArray[np.float64] = np.zeros((0, 3))
        self.kept: dict[Any, Any] = {}
        self.trace: Callable[[], list[Vector3]] | None = None
        """Returns the corners of the path; None: there is none."""

    @property
    def requested_ends(self) -> NDArray[np.float64]:
        """The ends (n, 3)."""
        return self._ends

    @requested_ends.setter
    def requested_ends(self, ends: ArrayLike) -> None:
        self._ends = np.asarray(ends, np.float64).reshape(-1, 3)
        self.kept = {}

    @property
    def points(self) -> list[Vector3]:
        """The corners of the path, start and end included; empty without a path."""
        return [] if self.trace is None else self.trace()

    @property
    def closest_end_point_index(self) -> int:
        """The number of the end that the path leads to; -1 without a path."""
        corners = self.points
        if not corners:
            return -1
        away = self._ends - np.asarray(corners[-1], np.float64)
        return int(np.argmin(np.linalg.norm(away, axis=1)))


class ShortestPath(MultiGoalShortestPath):
    """The same with one end."""

    @property
    def requested_end(self) -> NDArray[np.float64]:
        """The end (3,)."""
        return self._ends[0]

    @requested_end.setter
    def requested_end(self, end: ArrayLike) -> None:
        self.requested_ends = np.asarray(end, np.float64).reshape(1, 3)


@dataclass
class HitRecord:
    """The obstacle nearest to a point."""

    hit_pos: Vector3
    hit_normal: Vector3
    hit_dist: float


class Storey:
    """The free space of one storey."""

    def __init__(self, space: FreeSpace) -> None:
        self.space = space
        self.floor_z_m = space.floor_z_m

    @functools.cached_property
    def glide(self) -> Glide:
        """Moves a disc over it."""
        return Glide(self.space)

    @functools.cached_property
    def parts(self) -> NDArray[np.int32]:
        """(rows, cols) the number of the connected part of each cell, from 1; 0 where it is not free."""
        parts = cv2.connectedComponents(self.space.free.astype(np.uint8), connectivity=4)[1]
        return np.asarray(parts, np.int32)

    @property
    def part_count(self) -> int:
        """The number of connected parts."""
        return int(self.parts.max())

    def nearest(self, x_m: float, y_m: float, within_m: float, part: int = 0) -> tuple[float, float] | None:
        """Returns the nearest point on a free cell, of the connected part with a number unless it is 0.

        That is the point itself if it lies on one.
        """
        frame, cells = self.space.frame, self.parts == part if part else self.space.free
        if self.holds(x_m, y_m) and cells[frame.cell(x_m, y_m)]:
            return x_m, y_m
        return _nearest_cell(frame, cells, x_m, y_m, within_m)

    def holds(self, x_m: float, y_m: float) -> bool:
        """Returns whether a point lies on the grid of the storey; NaN does not."""
        row, col = self.space.frame.cell(x_m, y_m) if math.isfinite(x_m) and math.isfinite(y_m) else (-1, -1)
        return 0 <= row < self.space.free.shape[0] and 0 <= col < self.space.free.shape[1]


def _nearest_cell(
    frame: GridFrame, cells: NDArray[np.bool_], x_m: float, y_m: float, within_m: float
) -> tuple[float, float] | None:
    """Returns the middle of the nearest cell that is True; None: there is none within a distance."""
    window = frame.index_of((x_m, y_m, x_m, y_m), within_m)
    x, y = frame.axes(window)
    away_m = np.where(cells[window], np.hypot(x[None, :] - x_m, y[:, None] - y_m), math.inf)
    if away_m.min(initial=math.inf) > within_m:
        return None
    row, col = np.unravel_index(int(away_m.argmin()), away_m.shape)
    return float(x[col]), float(y[row])


class PathFinder:
    """Free space of a house, as Habitat's class of this name offers it."""

    def __init__(self, truth: GroundTruth | None = None, seed: int = 0) -> None:
        self._truth = truth
        self._storeys: list[Storey] | None = None
        self._rng = np.random.default_rng(seed)
        self.nav_mesh_settings = NavMeshSettings()

    @property
    def is_loaded(self) -> bool:
        """Whether there is a house."""
        return self._truth is not None

    @property
    def storeys(self) -> list[Storey]:
        """The storeys, from the lowest on; those without free space are left out."""
        if self._storeys is None:
            if self._truth is None:
                raise ValueError("This PathFinder has no house: use that of a simulator.")
            floors_m = storey_floors(self._truth.world.floor_levels_m, self._truth.success.same_storey_m)
            spaces = (self._truth.space(floor_z_m) for floor_z_m in floors_m)
            self._storeys = [Storey(space) for space in spaces if space.free.any()]
        return self._storeys

    def seed(self, seed: int) -> None:
        """Seeds the random points."""
        self._rng = np.random.default_rng(seed)

    @property
    def navigable_area(self) -> float:
        """The area of the places where the middle of the robot can be, square metres."""
        return sum(float(storey.space.free.sum()) * storey.space.frame.cell_m**2 for storey in self.storeys)

    def get_bounds(self) -> tuple[Vector3, Vector3]:
        """Returns the corners of the box around the free space of all storeys.

        It has a margin of 0.15 m: contact can bring the robot some millimetres out of the cells of the free space, and
        habitat-lab's map must contain it there.
        """
        x0, y0, x1, y1 = np.array([_bounds_m(storey.space) for storey in self.storeys]).T
        x0, y0, x1, y1 = x0 - MARGIN_M, y0 - MARGIN_M, x1 + MARGIN_M, y1 + MARGIN_M
        floors = [storey.floor_z_m for storey in self.storeys]
        low = to_position(float(x0.min()), float(y1.max()), min(floors))
        high = to_position(float(x1.max()), float(y0.min()), max(floors) + 2.5)
        return Vector3(low), Vector3(high)

    def get_topdown_view(self, meters_per_pixel: float, height: float, eps: float = 0.5) -> NDArray[np.bool_]:
        """Returns a map (z, x) of the box of `get_bounds`, True where the middle of the robot can be.

        Args:
            meters_per_pixel: edge of a pixel.
            height: height of the storey.
            eps: largest distance from it to the storey's floor, metres.
        """
        low, high = self.get_bounds()
        width, depth = (max(1, int((high - low)[axis] / meters_per_pixel)) for axis in (0, 2))
        storey = self._storey_at(height, eps)
        if storey is None:
            return np.zeros((depth, width), np.bool_)
        x = low.x + (np.arange(width) + 0.5) * meters_per_pixel
        y = -(low.z + (np.arange(depth) + 0.5) * meters_per_pixel)
        rows, cols = storey.space.frame.cells(*np.broadcast_arrays(x[None, :], y[:, None]))
        known = storey.space.frame.contains(rows, cols)
        return known & storey.space.free[np.where(known, rows, 0), np.where(known, cols, 0)]

    def is_navigable(self, pt: ArrayLike, max_y_delta: float = 0.5) -> bool:
        """Returns whether the middle of the robot can be at a point, at most `max_y_delta` above or below a floor."""
        if not np.isfinite(np.asarray(pt, np.float64)).all():
            return False
        x_m, y_m, z_m = from_position(_three(pt))
        storey = self._storey_at(z_m, max_y_delta)
        return storey is not None and storey.nearest(x_m, y_m, 0.0) is not None

    def snap_point(self, point: ArrayLike, island_index: int = -1) -> Vector3:
        """Returns the nearest point where the middle of the robot can be; NaN if none is within 2 m.

        Args:
            point: (3,).
            island_index: number of the connected part, see `get_island`; -1: any.
        """
        x_m, y_m, z_m = from_position(_three(point))
        found = self.snapped(x_m, y_m, z_m, island_index)
        return Vector3(np.nan) if found is None else Vector3(to_position(*found[1], found[0].floor_z_m))

    def snapped(
        self, x_m: float, y_m: float, z_m: float, island: int = -1
    ) -> tuple[Storey, tuple[float, float]] | None:
        """Returns the storey and the nearest point on it; None: there is none, or a coordinate is not finite."""
        if not all(map(math.isfinite, (x_m, y_m, z_m))):
            return None
        storey, (on, part) = self._storey_at(z_m, SNAP_M), self._part(island)
        if storey is None or on not in (None, storey):
            return None
        for within_m in (NEAREST_FREE_M, SNAP_M):
            place = storey.nearest(x_m, y_m, within_m, part)
            if place is not None:
                return storey, place
        return None

    def find_path(self, path: MultiGoalShortestPath) -> bool:
        """Answers a question; returns whether there is a path."""
        path.trace, path.geodesic_distance = None, math.inf
        start = self.snapped(*from_position(_three(path.requested_start)))
        if start is None:
            return False
        storey, place = start
        if storey not in path.kept:
            path.kept[storey] = self.distances(storey, path.requested_ends)
        distance_m: NDArray[np.float32] = path.kept[storey]
        path.geodesic_distance = storey.space.distance_at(distance_m, *place)
        if not math.isfinite(path.geodesic_distance):
            return False

        def trace() -> list[Vector3]:
            corners_m = storey.space.path(distance_m, *place)
            corners_m = np.zeros((0, 2)) if corners_m is None else corners_m
            return [Vector3(to_position(x_m, y_m, storey.floor_z_m)) for x_m, y_m in corners_m.tolist()]

        path.trace = trace
        return True

    def distances(self, storey: Storey, ends: NDArray[np.float64]) -> NDArray[np.float32]:
        """Returns the distance of each cell (rows, cols) of a storey to the nearest of ends (n, 3)."""
        sources = np.zeros(storey.space.free.shape, np.bool_)
        for end in ends:
            found = self.snapped(*from_position(_three(end)))
            if found is not None and found[0] is storey:
                sources[storey.space.frame.cell(*found[1])] = True
        return storey.space.geodesic(sources)

    def try_step(self, start: ArrayLike, end: ArrayLike) -> Vector3:
        """Returns where a motion ends that slides along obstacles, without physics."""
        return self._stepped(start, end, sliding=True)

    def try_step_no_sliding(self, start: ArrayLike, end: ArrayLike) -> Vector3:
        """Returns where a motion ends that stops at obstacles, without physics."""
        return self._stepped(start, end, sliding=False)

    def _stepped(self, start: ArrayLike, end: ArrayLike, *, sliding: bool) -> Vector3:
        x_m, y_m, z_m = from_position(_three(start))
        storey = self._storey_at(z_m, SNAP_M)
        if storey is None:
            return Vector3(start)
        to_x_m, to_y_m, _ = from_position(_three(end))
        if not np.isfinite((x_m, y_m, to_x_m, to_y_m)).all():
            return Vector3(start)
        x_m, y_m = storey.glide.try_step((x_m, y_m), (to_x_m, to_y_m), sliding=sliding)
        return Vector3(to_position(x_m, y_m, z_m))

    def get_random_navigable_point(self, max_tries: int = 10, island_index: int = -1) -> Vector3:
        """Returns a random point where the middle of the robot can be; `island_index` is as for `snap_point`."""
        storey, part = self._part(island_index)
        if storey is None:
            free = [int(storey.space.free.sum()) for storey in self.storeys]
            storey = self.storeys[int(self._rng.choice(len(free), p=np.array(free) / sum(free)))]
        cells = np.argwhere(storey.parts == part if part else storey.space.free)
        x_m, y_m = storey.space.frame.to_metres(cells[self._rng.integers(len(cells))]).tolist()
        return Vector3(to_position(x_m, y_m, storey.floor_z_m))

    def get_random_navigable_point_near(
        self, circle_center: ArrayLike, radius: float, max_tries: int = 100, island_index: int = -1
    ) -> Vector3:
        """Returns such a point within a radius of another; NaN if there is none."""
        x_m, y_m, z_m = from_position(_three(circle_center))
        storey, (on, part) = self._storey_at(z_m, SNAP_M), self._part(island_index)
        if storey is not None and on in (None, storey):
            places = storey.space.frame.to_metres(np.argwhere(storey.parts == part if part else storey.space.free))
            places = places[np.hypot(*(places - (x_m, y_m)).T) <= radius]
            if len(places):
                x_m, y_m = places[self._rng.integers(len(places))].tolist()
                return Vector3(to_position(x_m, y_m, storey.floor_z_m))
        return Vector3(np.nan)

    def distance_to_closest_obstacle(self, pt: ArrayLike, max_search_radius: float = 2.0) -> float:
        """Returns how far the middle of the robot can move from a point before something blocks it."""
        return self.closest_obstacle_surface_point(pt, max_search_radius).hit_dist

    def closest_obstacle_surface_point(self, pt: ArrayLike, max_search_radius: float = 2.0) -> HitRecord:
        """Returns the nearest place where the middle of the robot cannot be; it is inf away from outside the house."""
        x_m, y_m, z_m = from_position(_three(pt))
        storey = self._storey_at(z_m, SNAP_M)
        if storey is None or not storey.holds(x_m, y_m):
            return HitRecord(Vector3(pt), Vector3(), math.inf)
        found = _nearest_cell(storey.space.frame, ~storey.space.free, x_m, y_m, max_search_radius)
        if found is None:
            return HitRecord(Vector3(pt), Vector3(), max_search_radius)
        hit = Vector3(to_position(*found, z_m))
        away = Vector3(Vector3(pt) - hit)
        return HitRecord(hit, Vector3(away / max(away.length(), 1e-9)), math.dist(found, (x_m, y_m)))

    @property
    def num_islands(self) -> int:
        """The number of connected parts of the free space."""
        return sum(storey.part_count for storey in self.storeys)

    def get_island(self, point: ArrayLike) -> int:
        """Returns the number of the connected part that holds a point; -1: none."""
        first = 0
        found = self.snapped(*from_position(_three(point)))
        for storey in self.storeys:
            if found is not None and storey is found[0]:
                return first + int(storey.parts[storey.space.frame.cell(*found[1])]) - 1
            first += storey.part_count
        return -1

    def island_radius(self, pt: ArrayLike | int) -> float:
        """Returns the radius of the circle around the connected part with a number, or of the one that holds a point.

        0: there is none.
        """
        index = int(pt) if isinstance(pt, numbers.Integral) else self.get_island(pt)
        if index < 0:
            return 0.0
        storey, part = self._part(index)
        assert storey is not None
        cells = np.argwhere(storey.parts == part)
        middle = 0.5 * (cells.min(axis=0) + cells.max(axis=0))
        return float(np.hypot(*(cells - middle).T).max()) * storey.space.frame.cell_m

    def island_area(self, island_index: int = -1) -> float:
        """Returns the area of the connected part with a number, square metres; -1: of all."""
        storey, part = self._part(island_index)
        return (
            self.navigable_area
            if storey is None
            else float((storey.parts == part).sum()) * storey.space.frame.cell_m**2
        )

    def _part(self, island: int) -> tuple[Storey | None, int]:
        """Returns the storey of an island and the number of its part there; None and 0 for a negative number.

        Raises:
            ConfigError: there is no such island.
        """
        index = island
        for storey in self.storeys if island >= 0 else ():
            if index < storey.part_count:
                return storey, index + 1
            index -= storey.part_count
        if island >= 0:
            raise ConfigError(f"There is no island {island}: the free space has {self.num_islands}.")
        return None, 0

    def load_nav_mesh(self, path: str) -> bool:
        """Returns False: the free space is computed from the house, and no file of a mesh is read."""
        return False

    def _storey_at(self, height_m: float, within_m: float) -> Storey | None:
        """Returns the storey whose floor is nearest to a height."""
        near = min(self.storeys, key=lambda storey: abs(storey.floor_z_m - height_m), default=None)
        return near if near is not None and abs(near.floor_z_m - height_m) <= within_m else None


class GreedyGeodesicFollower:
    """Habitat's follower of shortest paths, by this project's oracle: its next action is the best one from here.

    Args:
        pathfinder: of the simulator.
        agent: the agent that moves.
        goal_radius: distance to the goal at which it stops, metres; less than a forward counts as that.
        stop_key: what `next_action_along` returns at the goal; likewise the others.
    """

    def __init__(
        self, pathfinder: PathFinder, agent: Any, goal_radius: float | None = None, *, stop_key: Any = None,
        forward_key: Any = None, left_key: Any = None, right_key: Any = None, **_: Any,
    ) -> None:  # fmt: skip
        self._pathfinder, self._agent = pathfinder, agent
        self._radius_m = max(goal_radius or 0.0, agent.world.config.drive.forward_m)
        self._keys = {
            Action.STOP: stop_key,
            Action.MOVE_FORWARD: "move_forward" if forward_key is None else forward_key,
            Action.TURN_LEFT: "turn_left" if left_key is None else left_key,
            Action.TURN_RIGHT: "turn_right" if right_key is None else right_key,
        }
        self.reset()

    def reset(self) -> None:
        """Forgets the last goal."""
        self._goal: tuple[float, ...] | None = None
        self._follower: Follower | None = None

    def next_action_along(self, goal_pos: ArrayLike) -> Any:
        """Returns the key of the next action on the shortest path to a goal (3,).

        Raises:
            GreedyFollowerError: no path leads there.
        """
        goal = _three(goal_pos)
        self._agent.settle()
        if self._follower is None or goal != self._goal:
            self._goal, self._follower = goal, self._towards(goal)
        action = self._follower.next_action()
        if action is None:
            raise GreedyFollowerError(f"No path leads to {list(goal)}.")
        return self._keys[action]

    def _towards(self, goal: tuple[float, float, float]) -> Follower:
        start = self._pathfinder.snapped(*from_position(_three(self._agent.state.position)))
        if start is None:
            raise GreedyFollowerError(f"The agent at {self._agent.state.position.tolist()} is not on the free space.")
        storey = start[0]
        distance_m = self._pathfinder.distances(storey, np.array([goal]))
        space, radius_m = storey.space, self._radius_m
        left_m = np.maximum(distance_m - radius_m, 0.0).astype(np.float32)
        near = Destination(
            space, distance_m <= radius_m, left_m, lambda x, y: space.distance_at(distance_m, x, y) <= radius_m
        )
        return Follower(self._agent.world, self._agent.world.pose.yaw_rad, near)


def _bounds_m(space: FreeSpace) -> tuple[float, float, float, float]:
    """Returns the smallest and largest x and y of the free cells."""
    rows, cols = np.flatnonzero(space.free.any(axis=1)), np.flatnonzero(space.free.any(axis=0))
    (x0, y0), cell_m = space.frame.origin_xy_m, space.frame.cell_m
    return x0 + cols[0] * cell_m, y0 + rows[0] * cell_m, x0 + (cols[-1] + 1) * cell_m, y0 + (rows[-1] + 1) * cell_m


def _three(position: ArrayLike) -> tuple[float, float, float]:
    x, y, z = np.asarray(position, np.float64).reshape(3).tolist()
    return x, y, z
