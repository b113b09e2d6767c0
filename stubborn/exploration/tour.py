"""Explores by a tour over all unseen areas, in the order that shows most of them soonest; this is not in the paper.

Two kinds of ground are left to see: unknown ground behind frontiers, and ground that was seen only from afar, where a
small object covers too little of the image to be noticed. Each frontier, and each part of the ground seen from afar, is
a stop of the tour with a weight, the area that it would show. The order minimizes the sum of weight times path length
until the stop (the minimum latency problem; Blum et al. 1994), which is the expected path until an object is seen if
its place is equally likely everywhere. Predicted potentials of the frontiers (`stubborn.exploration.potentials`) can
weight the stops by how likely the goal is there. The nearest stop does not always come first. On its path the robot
looks aside where a turn shows much (`stubborn.exploration.glance`).
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int

from sim.core.geometry.fast_marching import travel_times
from sim.core.geometry.grid import cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import TURN_RAD, CameraModel, ConfigError, wrap_angle
from stubborn.exploration.explorer import Exploration, Ground, Search
from stubborn.exploration.frontiers import Frontiers, require_margin, spend_around
from stubborn.exploration.glance import GlanceConfig, Glancer
from stubborn.exploration.patches import or_of_blocks
from stubborn.exploration.places import MapCells
from stubborn.exploration.potentials import PotentialConfig, Potentials
from stubborn.mapping.collision_marks import pushed_without_moving
from stubborn.mapping.masks import farther_than, numbered_parts
from stubborn.mapping.navmap import CollisionLayer
from stubborn.planning.planner import Goal

_INSPECTED_GAP_M = 0.2
"""Ground within this distance of inspected ground is inspected too: distant floor is seen with gaps."""


Chooser = Callable[[Ground, Float64[np.ndarray, "stops 2"], int], int]
"""Chooses one of several stops, instead of the tour: map and pose, the middle of each stop (x and y in metres), and the
number of the stop that the tour would choose. Returns the number of a stop."""


@dataclass(frozen=True, kw_only=True)
class TourConfig:
    """The stops of the tour and their weights."""

    glance: GlanceConfig = field(default_factory=GlanceConfig)
    """Parameters of the looks to the side."""
    potentials: PotentialConfig | None = None
    """Predicted potentials that weight the frontiers; None: only their area counts."""
    potential_floor: float = 0.05
    """The weight of a frontier is multiplied by a power of (this + its highest potential), and the weight of other
    ground by the same power of this."""
    potential_power: float = 2.0
    """The exponent of that power. With a larger exponent the best frontier comes earlier."""
    least_length_m: float = 0.40
    """Shorter frontiers are stops only if longer ones are missing."""
    own_known_m: float = 1.0
    """Ground within this distance of the trail counts as known (see `FrontierConfig.own_known_m`)."""
    gain_radius_m: float = 2.0
    """A frontier would show the unknown ground within this path length behind it."""
    near_m: float = 2.5
    """Ground that was in view within this distance counts as inspected; 0: all ground that was in view counts."""
    far_weight: float = 0.3
    """Weight of ground that was in view from afar only; unknown ground has weight 1."""
    least_far_m2: float = 0.5
    """Smaller parts of such ground do not become stops."""
    stop_m: float = 0.5
    """Path length that each stop costs in addition to the path to it: the turns on the spot."""
    turn_m: float = 0.15
    """Path length that a turn of 30 degrees towards the first stop costs."""
    most_stops: int = 6
    """Largest number of stops that are put in order: those with the most weight per path length."""
    replan_steps: int = 8
    """The order is computed again when a stop is finished, and after this many steps if they showed new ground. Without
    the second condition two stops that are about equally good would send the robot back and forth."""
    news_m2: float = 0.5
    """Areas smaller than this do not count as new ground."""
    keep_steps: int = 80
    """A stop is pursued for at most this many steps."""
    arrived_m: float = 0.35
    """A stop counts as reached within this path length."""
    spent_m: float = 0.60
    """Within this distance of a place where a stop was reached, nothing counts as left to see any more."""
    unmarked_steps: int = 40
    """If collision marks close all paths to the areas that are left to see, the robot takes routes over the marks. No
    new route of this kind begins after this many steps on such routes."""
    regain_m2: float = 2.0
    """When this much more ground has been seen, the steps and pushes on such routes are counted from 0 again."""
    most_pushes: int = 2
    """After this many forwards on such a route that did not move the robot, the marks count again."""
    margin_cells: int = 20
    """Margin around the known part of the map within which paths may run."""
    unknown_speed: float = 0.15
    """Between stops a metre of unknown ground counts as 1 / `unknown_speed` metres: it may turn out blocked. The
    planner's value, 0.4, led to longer paths in runs with contacts."""
    block_cells: int = 4
    """Path lengths between stops are computed on blocks of this many cells in each direction."""

    def __post_init__(self) -> None:
        if self.block_cells < 1 or self.potential_floor < 0.0 or self.potential_power < 0.0:
            raise ConfigError(
                "TourConfig needs block_cells >= 1, potential_floor and potential_power >= 0, got "
                f"{self.block_cells}, {self.potential_floor} and {self.potential_power}."
            )
        if not 0.0 < self.unknown_speed <= 1.0:
            raise ConfigError(f"TourConfig.unknown_speed must lie in (0, 1], got {self.unknown_speed}.")
        if not 1 <= self.most_stops <= 8:
            raise ConfigError(f"TourConfig.most_stops must be 1 to 8, got {self.most_stops}.")
        require_margin("TourConfig", self.arrived_m, self.spent_m)

    def make(self, camera: CameraModel) -> TourExplorer:
        """Returns a new explorer with these parameters.

        Raises:
            ConfigError: the weights of the potentials do not exist or are of another network.
        """
        known = None if self.potentials is None else Potentials(self.potentials, self.potentials.predictor())
        return TourExplorer(self, camera) if known is None else InformedTourExplorer(self, camera, known)


INFORMED_TOUR = TourConfig(potentials=PotentialConfig())
"""A tour that weights its stops by predicted potentials; `stubborn-plus` explores with it."""


@dataclass(frozen=True)
class _Remaining:
    """The areas that are left to see in the known part of the map at one step."""

    known: Frontiers
    layer: CollisionLayer
    """The collision layer of the free space."""
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
    """A stop of the tour: cells of the known part of the map."""

    rows: Int[np.ndarray, " n"]
    cols: Int[np.ndarray, " n"]
    weight: float

    def middle_xy_m(self, known: Frontiers) -> tuple[float, float]:
        """Returns the place of the cell nearest to the mean of all cells."""
        off_cells = np.hypot(self.rows - self.rows.mean(), self.cols - self.cols.mean())
        x_m, y_m = known.free.frame.centres(*(int(cells[off_cells.argmin()]) for cells in (self.rows, self.cols)))
        return float(x_m), float(y_m)


class _Paths:
    """Path lengths in the free space, on blocks of cells, which is exact enough to order the stops."""

    def __init__(self, known: Frontiers, block_cells: int, unknown_speed: float) -> None:
        free = known.free
        self.block_cells, self.block_m = block_cells, block_cells * free.frame.cell_m
        self.reachable = or_of_blocks(free.reachable, block_cells)
        self.unknown = or_of_blocks(free.reachable & known.unknown, block_cells)
        self.speed = np.ones(self.reachable.shape, np.float32)
        slow = self.unknown & ~or_of_blocks(free.reachable & ~known.unknown, block_cells)
        self.speed[slow] = unknown_speed

    def from_cells(
        self, rows: Int[np.ndarray, " n"], cols: Int[np.ndarray, " n"]
    ) -> Float32[np.ndarray, "block_rows block_cols"]:
        """Returns the path length from the nearest of some cells to each block."""
        return travel_times(self._blocks(rows, cols), self.reachable, self.speed, self.block_m)

    def nearest_m(self, field_m: Float32[np.ndarray, "block_rows block_cols"], stop: _Stop) -> float:
        """Returns the smallest value of a field in a stop."""
        return float(field_m[stop.rows // self.block_cells, stop.cols // self.block_cells].min())

    def unknown_m2(self, rows: Int[np.ndarray, " n"], cols: Int[np.ndarray, " n"], within_m: float) -> float:
        """Returns the area of the unknown ground within a path length, through unknown ground, of some cells."""
        start, even = self._blocks(rows, cols), np.ones_like(self.speed)
        path_m = travel_times(start, self.unknown | start, even, self.block_m, within_m)
        return float(np.count_nonzero(np.isfinite(path_m) & self.unknown)) * self.block_m**2

    def _blocks(
        self, rows: Int[np.ndarray, " n"], cols: Int[np.ndarray, " n"]
    ) -> Bool[np.ndarray, "block_rows block_cols"]:
        blocks = np.zeros(self.reachable.shape, np.bool_)
        blocks[rows // self.block_cells, cols // self.block_cells] = True
        return blocks


class TourExplorer:
    """Heads for the first stop of the best tour, and pursues it for some steps."""

    def __init__(self, config: TourConfig, camera: CameraModel) -> None:
        self.config = config
        self.glancer = Glancer(config.glance, camera)
        self.chooser: Chooser | None = None
        """Chooses among the stops; None: the tour does."""
        self.reset()

    def reset(self, seed: int = 0) -> None:
        """Forgets the last episode."""
        self.glancer.reset()
        self._goal: MapCells | None = None  # the pursued stop
        self._layer: CollisionLayer | None = None  # the layer on which the route to it was planned
        self._age_steps = 0
        self._goal_from_m2 = 0.0  # the ground seen when the goal was chosen
        self._unmarked_steps = 0  # on routes over collision marks, since `_unmarked_from_m2` was set
        self._unmarked_from_m2 = 0.0
        self._unmarked_pose: Pose | None = None  # at the last step of such a route
        self._pushes = 0  # forwards on such routes that did not move the robot
        self._spent = np.zeros((0, 0), np.bool_)  # on the whole map, as the next two; made at an episode's first step
        self._inspected = self._spent
        self._frames = np.zeros((0, 0), np.uint32)

    def explore(self, ground: Ground) -> Exploration:
        """Returns the route to the pursued stop, else to the first of a new tour, else far from the trail.

        If nothing is left to see in the free space of the preferred collision layer, a mark may close a passage:
        the tour is planned on the next layer and finally, for some steps, without collision marks.
        """
        self._note_view(ground)
        turn = self.glancer.next_turn(ground.navmap, ground.pose)
        if turn is not None:
            return turn
        by_layer: dict[CollisionLayer, _Remaining] = {}

        def remaining_on(layer: CollisionLayer) -> _Remaining:
            if layer not in by_layer:
                by_layer[layer] = self._find_remaining(ground, layer)
            return by_layer[layer]

        if self._goal is not None and self._layer is not None:
            route = yield from self._go_on(self._goal, remaining_on(self._layer), ground)
            if route is not None:
                return route
        for layer in self._layers(ground):
            route = yield from self._to_first_stop(remaining_on(layer), ground)
            if route is not None:
                return route
        for layer in ground.layers:
            route = yield from remaining_on(layer).known.to_least_visited(self.config.arrived_m)
            if route is not None:
                return route
        return None

    def _note_view(self, ground: Ground) -> None:
        """Enters the ground that the last frame showed near the robot into the inspected ground."""
        navmap = ground.navmap
        if self._spent.size == 0:
            self._spent, self._inspected = (np.zeros(navmap.frame.shape, np.bool_) for _ in range(2))
            self._frames = np.zeros(navmap.frame.shape, np.uint32)
        known, xy_m = navmap.known_window(0), ground.pose.xy_m
        frames, before = navmap.frames_in_view[known.index], self._frames[known.index]
        index, near = cells_near_segment(known.frame, xy_m, xy_m, max(self.config.near_m, navmap.frame.cell_m))
        self._inspected[known.index][index] |= near & (frames[index] != before[index])
        before[:] = frames

    def _layers(self, ground: Ground) -> tuple[CollisionLayer, ...]:
        """Returns the collision layers to plan a tour on, in order of preference."""
        seen_m2 = ground.navmap.seen_area_m2()
        if seen_m2 >= self._unmarked_from_m2 + self.config.regain_m2:
            self._unmarked_from_m2, self._unmarked_steps, self._pushes = seen_m2, 0, 0
        closed = self._unmarked_steps > self.config.unmarked_steps or self._pushes >= self.config.most_pushes
        return ground.layers if closed else (*ground.layers, CollisionLayer.NONE)

    def _find_remaining(self, ground: Ground, layer: CollisionLayer) -> _Remaining:
        """Returns the areas that are left to see in the known part of the map and are reachable on a layer."""
        config = self.config
        known = Frontiers.of(ground, own_known_m=config.own_known_m, margin_cells=config.margin_cells, layer=layer)
        far = np.zeros_like(known.cells)
        if config.near_m > 0.0:
            far = farther_than(self._inspected[known.window.index], _INSPECTED_GAP_M, known.window.frame.cell_m)
            far &= known.free.reachable & ~known.unknown & known.off_trail
        return _Remaining(known, layer, far, self._spent[known.window.index])

    def _go_on(self, goal: MapCells, remaining: _Remaining, ground: Ground) -> Search:
        """Returns the route to the rest of the pursued stop; None when it is finished, or a new tour is due."""
        self._age_steps += 1
        if self._layer is CollisionLayer.NONE and self._pushes_on(ground.pose):
            return None
        news = ground.navmap.seen_area_m2() - self._goal_from_m2 >= self.config.news_m2
        longest_steps = self.config.replan_steps if news else self.config.keep_steps
        if self._age_steps > longest_steps:
            return None
        route = yield Goal(remaining.known.free, goal.within(remaining.known.window) & remaining.cells)
        if route is not None and route.length_m <= self.config.arrived_m:
            self._spend(remaining, ground.pose)
            return None
        return route

    def _pushes_on(self, pose: Pose) -> bool:
        """Counts a step of a route over collision marks; returns True when the robot pushes without moving."""
        before, self._unmarked_pose = self._unmarked_pose, pose
        self._unmarked_steps += 1
        self._pushes += before is not None and pushed_without_moving(before, pose)
        return self._pushes >= self.config.most_pushes

    def _to_first_stop(self, remaining: _Remaining, ground: Ground) -> Search:
        """Returns the route to the first stop of the best tour; None when no stop can be reached."""
        known, pose = remaining.known, ground.pose
        paths = _Paths(known, self.config.block_cells, self.config.unknown_speed)
        factor = self._factor(ground, known)
        while True:
            stops = self._stops(remaining, paths, factor)
            if not stops:
                self._goal = None
                return None
            number = self._first(known, paths, stops, pose)
            if self.chooser is not None and len(stops) > 1:
                number = self.chooser(ground, np.array([stop.middle_xy_m(known) for stop in stops]), number)
            stop = stops[number]
            cells = np.zeros(known.free.frame.shape, np.bool_)
            cells[stop.rows, stop.cols] = True
            route = yield Goal(known.free, cells)
            if route is not None and route.length_m > self.config.arrived_m:
                self._goal, self._layer, self._age_steps = MapCells.of(cells, known.window), remaining.layer, 0
                self._goal_from_m2 = ground.navmap.seen_area_m2()
                self._unmarked_pose = pose
                return route
            remaining.spent[cells] |= route is None
            if route is not None:
                self._spend(remaining, pose)
                remaining.spent[known.free.frame.cell(pose.x_m, pose.y_m)] = True

    def _factor(self, ground: Ground, known: Frontiers) -> Float32[np.ndarray, "rows cols"] | None:
        """Returns the factor of each frontier cell for the weight of its stop; None: all are 1."""
        return None

    def _stops(
        self, remaining: _Remaining, paths: _Paths, factor: Float32[np.ndarray, "rows cols"] | None
    ) -> list[_Stop]:
        """Returns the stops that can be reached."""
        config, known, cell_m = self.config, remaining.known, remaining.known.free.frame.cell_m
        frontiers = [
            _Stop(
                rows,
                cols,
                paths.unknown_m2(rows, cols, config.gain_radius_m)
                * (1.0 if factor is None else float(factor[rows, cols].max())),
            )
            for rows, cols in _parts(known.cells & ~remaining.spent, 1.0)
        ]
        long = [stop for stop in frontiers if stop.rows.size * cell_m >= config.least_length_m]
        per_m2 = config.far_weight * (1.0 if factor is None else config.potential_floor**config.potential_power)
        far = [
            _Stop(rows, cols, per_m2 * rows.size * cell_m**2)
            for rows, cols in _parts(remaining.far & ~remaining.spent, config.least_far_m2 / cell_m**2)
        ]
        return long + far or frontiers

    def _first(self, known: Frontiers, paths: _Paths, stops: list[_Stop], pose: Pose) -> int:
        """Returns the index of the stop with which the best tour begins."""
        row, col = known.free.frame.cell(pose.x_m, pose.y_m)
        weight = np.array([stop.weight for stop in stops]) + 1e-6
        from_here_m = paths.from_cells(np.array([row]), np.array([col]))
        to_m = np.array([paths.nearest_m(from_here_m, stop) for stop in stops])
        to_m += self.config.turn_m * np.array([self._turns(known, stop, pose) for stop in stops])
        best = np.argsort(-weight / (to_m + self.config.stop_m), kind="stable")[: self.config.most_stops]
        best = best[np.isfinite(to_m[best])]
        if best.size < 2:
            return int(best[0]) if best.size else 0
        between_m = np.zeros((best.size, best.size))
        for i, one in enumerate(best[:-1].tolist()):
            field_m = paths.from_cells(stops[one].rows, stops[one].cols)
            for j in range(i + 1, best.size):
                between_m[i, j] = between_m[j, i] = paths.nearest_m(field_m, stops[int(best[j])])
        return int(best[first_of_best_order(weight[best], to_m[best], between_m, self.config.stop_m)])

    def _turns(self, known: Frontiers, stop: _Stop, pose: Pose) -> float:
        """Returns the number of turns from the heading to the middle of a stop."""
        x_m, y_m = known.free.frame.centres(stop.rows.mean(), stop.cols.mean())
        return abs(wrap_angle(math.atan2(float(y_m) - pose.y_m, float(x_m) - pose.x_m) - pose.yaw_rad)) / TURN_RAD

    def _spend(self, remaining: _Remaining, pose: Pose) -> None:
        """Closes the stops around the robot, because the robot has seen what they show."""
        spend_around(self._spent, remaining.known.window, pose, self.config.spent_m)
        self._goal = None


class InformedTourExplorer(TourExplorer):
    """A tour that also weights its frontiers by predicted potentials."""

    reads_semantics: Literal[True] = True

    def __init__(self, config: TourConfig, camera: CameraModel, potentials: Potentials) -> None:
        self.potentials = potentials
        super().__init__(config, camera)

    def reset(self, seed: int = 0) -> None:
        """Forgets the last episode; the random choices of the controls come from `seed`."""
        super().reset(seed)
        self.potentials.reset(seed)

    def _factor(self, ground: Ground, known: Frontiers) -> Float32[np.ndarray, "rows cols"]:
        """Returns the factor of each frontier cell for the weight of its stop."""
        if not known.cells.any():
            return np.zeros(known.cells.shape, np.float32)  # no stop reads it
        potential = np.maximum(self.potentials.of(ground, known.free.frame, known.cells), 0.0)
        return (np.float32(self.config.potential_floor) + potential) ** np.float32(self.config.potential_power)


def first_of_best_order(
    weight: Float64[np.ndarray, " n"],
    to_m: Float64[np.ndarray, " n"],
    between_m: Float64[np.ndarray, "n n"],
    stop_m: float,
) -> int:
    """Returns the first stop of the order with the smallest sum of weight times path length until the stop.

    Args:
        weight: weight of each stop.
        to_m: path length from the robot to each stop.
        between_m: path length between two stops; a path that is infinite counts as 100 m.
        stop_m: additional path length that each stop costs.
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


def _parts(
    mask: Bool[np.ndarray, "rows cols"], least_cells: float
) -> list[tuple[Int[np.ndarray, " n"], Int[np.ndarray, " n"]]]:
    """Returns the rows and columns of the 8-connected parts of a mask with at least this many cells."""
    numbers, sizes = numbered_parts(mask)
    rows, cols = np.nonzero(mask)
    order = np.argsort(numbers[rows, cols], kind="stable")
    ends = np.cumsum(sizes[1:])[:-1]
    parts = zip(np.split(rows[order], ends), np.split(cols[order], ends), strict=True)
    return [(rows, cols) for rows, cols in parts if rows.size >= max(least_cells, 1)]
