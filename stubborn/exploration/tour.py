"""Exploration by a tour over all that is left to see, in the order that shows most of it soonest; not in the paper.

Two kinds of ground are left to see: unknown ground behind frontiers, and ground that was only seen from afar, where a
small object covers too little of the image to be noticed. Each frontier, and each part of the ground seen from afar, is
a stop of the tour with a weight, the area that it would show. The order minimizes the sum of weight times path length
until the stop (the minimum latency problem; Blum et al. 1994), which is the expected path until an object is seen whose
place is equally likely everywhere. The nearest stop comes first only if it is worth it. In passing, the robot looks
aside where a turn shows much (`stubborn.exploration.glance`).
"""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int

from sim.geometry.fast_marching import travel_times
from sim.geometry.grid import cells_near_segment
from sim.geometry.pose import Pose
from sim.interface import TURN_RAD, CameraModel, ConfigError, wrap_angle
from stubborn.exploration.explorer import Exploration, Ground, Search
from stubborn.exploration.frontiers import Frontiers, spend_around
from stubborn.exploration.glance import GlanceConfig, Glancer
from stubborn.exploration.places import MapCells
from stubborn.planning.planner import Goal
from stubborn.raster import distance_to, numbered_parts


@dataclass(frozen=True, kw_only=True)
class TourConfig:
    """The stops of the tour and their weights."""

    glance: GlanceConfig = field(default_factory=GlanceConfig)
    """Looks to the side."""
    least_length_m: float = 0.40
    """Shorter frontiers are no stops while there are others."""
    own_known_m: float = 1.0
    """Ground this near the trail counts as known (see `FrontierConfig.own_known_m`)."""
    gain_radius_m: float = 2.0
    """Unknown ground within this path length behind a frontier is what the frontier would show."""
    near_m: float = 2.5
    """Ground that was in view within this distance counts as inspected; 0: all ground in view does."""
    far_weight: float = 0.3
    """Weight of ground that was in view from afar only; unknown ground has weight 1."""
    least_far_m2: float = 0.5
    """Smaller parts of such ground are no stops."""
    stop_m: float = 0.5
    """Path length that each stop costs besides the path to it: the turns on the spot."""
    turn_m: float = 0.15
    """Path length that a turn of 30 degrees towards the first stop costs."""
    most_stops: int = 6
    """Largest number of stops that are put in order: those with most weight for their path."""
    replan_steps: int = 8
    """The order is computed again after this many steps, and when a stop is done with."""
    arrived_m: float = 0.35
    """A stop is reached within this length of path."""
    spent_m: float = 0.60
    """Around a place where a stop was reached, the rest of it does not count any more."""
    margin_cells: int = 20
    """Margin around the known part of the map within which paths may run."""

    def __post_init__(self) -> None:
        if not 1 <= self.most_stops <= 8:
            raise ConfigError(f"TourConfig.most_stops must be 1 to 8, got {self.most_stops}.")
        if self.arrived_m <= 0 or self.spent_m < self.arrived_m:
            raise ConfigError(f"TourConfig needs 0 < arrived_m <= spent_m, got {self.arrived_m} and {self.spent_m} m.")

    def make(self, camera: CameraModel) -> TourExplorer:
        """Returns a new explorer with these parameters."""
        return TourExplorer(self, camera)


@dataclass(frozen=True)
class _Left:
    """What is left to see in the known part of the map at one step."""

    known: Frontiers
    far: Bool[np.ndarray, "rows cols"]
    """Reachable ground that was seen from afar only."""
    spent: Bool[np.ndarray, "rows cols"]
    """Shares memory with the explorer's own mask."""

    @property
    def cells(self) -> Bool[np.ndarray, "rows cols"]:
        """The cells of all stops."""
        return (self.known.cells | self.far) & ~self.spent


@dataclass(frozen=True)
class _Stop:
    """A stop of the tour."""

    cells: Bool[np.ndarray, "rows cols"]
    weight_m2: float


class TourExplorer:
    """Heads for the first stop of the best tour, and keeps to it for some steps."""

    def __init__(self, config: TourConfig, camera: CameraModel) -> None:
        self.config = config
        self.glancer = Glancer(config.glance, camera)
        self.reset()

    def reset(self, seed: int = 0) -> None:
        """Forgets the last episode."""
        self.glancer.reset()
        self._goal: MapCells | None = None
        self._age_steps = 0
        self._spent = np.zeros((0, 0), np.bool_)  # on the whole map, as the next two; made at an episode's first step
        self._inspected = self._spent
        self._frames = np.zeros((0, 0), np.uint16)

    def explore(self, ground: Ground) -> Exploration:
        """See `Explorer`; the route to the stop pursued, else to the first of a new tour, else far from the trail."""
        self._note_view(ground)
        turn = self.glancer.next_turn(ground.navmap, ground.pose)
        if turn is not None:
            return turn
        left = self._left(ground)
        return (
            (yield from self._go_on(left, ground.pose))
            or (yield from self._to_first_stop(left, ground.pose))
            or (yield from left.known.to_least_visited(self.config.arrived_m))
        )

    def _note_view(self, ground: Ground) -> None:
        """Enters the ground that the last frame showed near the robot into the inspected ground."""
        navmap = ground.navmap
        if self._spent.size == 0:
            self._spent, self._inspected = (np.zeros(navmap.frame.shape, np.bool_) for _ in range(2))
            self._frames = np.zeros(navmap.frame.shape, np.uint16)
        xy_m = ground.pose.xy_m
        index, near = cells_near_segment(navmap.frame, xy_m, xy_m, max(self.config.near_m, navmap.frame.cell_m))
        frames = navmap.frames_in_view[index]
        self._inspected[index] |= near & (frames != self._frames[index])
        self._frames[index] = frames

    def _left(self, ground: Ground) -> _Left:
        """Returns what is left to see in the known part of the map."""
        config = self.config
        known = Frontiers.of(ground, own_known_m=config.own_known_m, margin_cells=config.margin_cells)
        far = np.zeros_like(known.cells)
        if config.near_m > 0.0:
            inspected_m = distance_to(self._inspected[known.window.index]) * np.float32(known.window.frame.cell_m)
            far = known.free.reachable & ~known.unknown & (inspected_m > 0.2) & (known.trail_m > config.own_known_m)
        return _Left(known, far, self._spent[known.window.index])

    def _go_on(self, left: _Left, pose: Pose) -> Search:
        """Returns the route to the rest of the stop pursued; None when it is done with, or after some steps."""
        self._age_steps += 1
        if self._goal is None or self._age_steps > self.config.replan_steps:
            return None
        route = yield Goal(left.known.free, self._goal.within(left.known.window) & left.cells)
        if route is not None and route.length_m <= self.config.arrived_m:
            self._spend(left, pose)
            return None
        return route

    def _to_first_stop(self, left: _Left, pose: Pose) -> Search:
        """Returns the route to the first stop of the best tour; None when no stop can be reached."""
        known = left.known
        while True:
            stops = self._stops(left)
            if not stops:
                self._goal = None
                return None
            stop = stops[self._first(known, stops, pose)]
            route = yield Goal(known.free, stop.cells)
            if route is not None and route.length_m > self.config.arrived_m:
                self._goal, self._age_steps = MapCells.of(stop.cells, known.window), 0
                return route
            left.spent[stop.cells] |= route is None
            if route is not None:
                self._spend(left, pose)
                left.spent[known.free.frame.cell(pose.x_m, pose.y_m)] = True

    def _stops(self, left: _Left) -> list[_Stop]:
        """Returns the stops that can be reached."""
        config, known, cell_m = self.config, left.known, left.known.free.frame.cell_m
        frontiers = [_Stop(cells, self._shown_m2(known, cells)) for cells in _parts(known.cells & ~left.spent, 1.0)]
        long = [stop for stop in frontiers if np.count_nonzero(stop.cells) * cell_m >= config.least_length_m]
        far = [
            _Stop(cells, config.far_weight * float(np.count_nonzero(cells)) * cell_m**2)
            for cells in _parts(left.far & ~left.spent, config.least_far_m2 / cell_m**2)
        ]
        return long + far or frontiers

    def _shown_m2(self, known: Frontiers, frontier: Bool[np.ndarray, "rows cols"]) -> float:
        """Returns the area of the unknown ground within some path length behind a frontier."""
        cell_m, open_ground = known.free.frame.cell_m, known.unknown & known.free.reachable
        speed = np.ones(frontier.shape, np.float32)
        path_m = travel_times(frontier, open_ground | frontier, speed, cell_m, self.config.gain_radius_m)
        return float(np.count_nonzero(np.isfinite(path_m) & open_ground)) * cell_m**2

    def _first(self, known: Frontiers, stops: list[_Stop], pose: Pose) -> int:
        """Returns the index of the stop with which the best tour begins."""
        here = np.zeros(known.free.frame.shape, np.bool_)
        here[known.free.frame.cell(pose.x_m, pose.y_m)] = True
        weight = np.array([stop.weight_m2 for stop in stops]) + 1e-3
        from_here_m = self._from(known, here)
        to_m = np.array([_nearest_m(from_here_m, stop.cells) for stop in stops])
        to_m += self.config.turn_m * np.array([self._turns(known, stop, pose) for stop in stops])
        best = np.argsort(-weight / (to_m + self.config.stop_m), kind="stable")[: self.config.most_stops]
        best = best[np.isfinite(to_m[best])]
        if best.size < 2:
            return int(best[0]) if best.size else 0
        between_m = np.zeros((best.size, best.size))
        for i, one in enumerate(best[:-1].tolist()):
            field_m = self._from(known, stops[one].cells)
            for j in range(i + 1, best.size):
                between_m[i, j] = between_m[j, i] = _nearest_m(field_m, stops[int(best[j])].cells)
        return int(best[first_of_best_order(weight[best], to_m[best], between_m, self.config.stop_m)])

    def _from(self, known: Frontiers, cells: Bool[np.ndarray, "rows cols"]) -> Float32[np.ndarray, "rows cols"]:
        """Returns the travel time from some cells to all others."""
        return travel_times(cells, known.free.reachable, known.free.speed, known.free.frame.cell_m)

    def _turns(self, known: Frontiers, stop: _Stop, pose: Pose) -> float:
        """Returns the number of turns from the heading to the middle of a stop."""
        rows, cols = np.nonzero(stop.cells)
        x_m, y_m = known.free.frame.centres(rows.mean(), cols.mean())
        return abs(wrap_angle(math.atan2(float(y_m) - pose.y_m, float(x_m) - pose.x_m) - pose.yaw_rad)) / TURN_RAD

    def _spend(self, left: _Left, pose: Pose) -> None:
        """Closes the stops around the robot, which has seen what they show."""
        spend_around(self._spent, left.known.window, pose, self.config.spent_m)
        self._goal = None


def first_of_best_order(
    weight: Float64[np.ndarray, " n"],
    to_m: Float64[np.ndarray, " n"],
    between_m: Float64[np.ndarray, "n n"],
    stop_m: float,
) -> int:
    """Returns the first stop of the order with the least sum of weight times path length until the stop.

    Args:
        weight: of each stop.
        to_m: path length from the robot to each stop.
        between_m: path length between two stops; a path that is infinite counts as 100 m.
        stop_m: path length that each stop costs besides.
    """
    orders = _orders(len(weight))
    to_m, between_m = (np.where(np.isfinite(length), length, 100.0) for length in (to_m, between_m))
    legs_m = np.concatenate((to_m[orders[:, :1]], between_m[orders[:, :-1], orders[:, 1:]]), axis=1) + stop_m
    latency = (weight[orders] * np.cumsum(legs_m, axis=1)).sum(axis=1)
    return int(orders[int(np.argmin(latency)), 0])


@functools.cache
def _orders(count: int) -> Int[np.ndarray, "orders n"]:
    """Returns all orders of some stops."""
    return np.array(list(itertools.permutations(range(count))), np.intp)


def _parts(mask: Bool[np.ndarray, "rows cols"], least_cells: float) -> list[Bool[np.ndarray, "rows cols"]]:
    """Returns the 8-connected parts of a mask with at least this many cells."""
    labels, sizes = numbered_parts(mask)
    return [labels == part for part in range(1, len(sizes)) if sizes[part] >= least_cells]


def _nearest_m(field_m: Float32[np.ndarray, "rows cols"], cells: Bool[np.ndarray, "rows cols"]) -> float:
    """Returns the least value of a field in some cells."""
    return float(field_m[cells].min())
