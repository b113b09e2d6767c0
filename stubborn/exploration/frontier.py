"""Frontier exploration: the robot goes to the nearest border between known free ground and unknown ground.

Reference: Yamauchi (1997), "A Frontier-Based Approach for Autonomous Exploration", CIRA. There a robot plans through
known ground only. Here a level camera cannot see the floor under and beside the robot, so that paths may cross unknown
ground at the planner's cost for it, and ground near the robot's own trail counts as known.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32

from sim.geometry.grid import Window, cells_near_segment
from sim.geometry.pose import Pose
from sim.interface import CameraModel, ConfigError
from stubborn.exploration.explorer import Exploration, Ground, Search
from stubborn.exploration.places import LookAround, MapCells
from stubborn.planning.planner import FreeSpace, Goal
from stubborn.planning.steering import to_nearest_part
from stubborn.raster import distance_to, large_parts


@dataclass(frozen=True, kw_only=True)
class FrontierConfig:
    """Which cells are a frontier, and when a frontier is done with."""

    least_length_m: float = 0.40
    """Shorter frontiers come last: the robot would hardly fit through."""
    own_known_m: float = 1.0
    """Ground this near the trail counts as known: it lies below the image, whose lowest row shows floor from 1.4 m on.
    With less the robot sweeps its own surroundings, with more it takes rooms behind walls for known."""
    arrived_m: float = 0.35
    """A frontier is reached within this length of path."""
    spent_m: float = 0.60
    """Around a place where a frontier was reached, the rest of it does not count any more."""
    look_around_turns: int = 0
    """Turns on the spot at the start and at each frontier reached; 11 show everything around, as in the reference."""
    margin_cells: int = 20
    """Margin around the known part of the map within which paths may run."""

    def __post_init__(self) -> None:
        if self.arrived_m <= 0 or self.spent_m < self.arrived_m:
            raise ConfigError(
                f"FrontierConfig needs 0 < arrived_m <= spent_m, got {self.arrived_m} and {self.spent_m} m."
            )

    def make(self, camera: CameraModel) -> FrontierExplorer:
        """Returns a new explorer with these parameters."""
        return FrontierExplorer(self)


def frontier_cells(
    known_free: Bool[np.ndarray, "rows cols"], open_unknown: Bool[np.ndarray, "rows cols"]
) -> Bool[np.ndarray, "rows cols"]:
    """Returns the known free cells with an unknown cell that is not blocked among their 8 neighbours."""
    near_unknown = cv2.dilate(np.ascontiguousarray(open_unknown).view(np.uint8), np.ones((3, 3), np.uint8))
    return known_free & (near_unknown > 0)


@dataclass(frozen=True)
class _Known:
    """The known part of the map at one step."""

    window: Window
    free: FreeSpace
    frontiers: Bool[np.ndarray, "rows cols"]
    spent: Bool[np.ndarray, "rows cols"]
    """Shares memory with the explorer's own mask."""
    trail_m: Float32[np.ndarray, "rows cols"]
    """Distance from the robot's trail."""

    @property
    def open_frontiers(self) -> Bool[np.ndarray, "rows cols"]:
        """The frontiers that are not spent."""
        return self.frontiers & ~self.spent


class FrontierExplorer:
    """Goes to the frontier with the shortest path, and keeps to it until it is reached or has become known."""

    def __init__(self, config: FrontierConfig) -> None:
        self.config = config
        self.look_around = LookAround(config.look_around_turns)
        self.reset()

    def reset(self, seed: int = 0) -> None:
        """Forgets the last episode."""
        self.look_around.begin()
        self._goal: MapCells | None = None
        self._spent = np.zeros((0, 0), np.bool_)  # on the whole map; made at the first step of an episode

    def explore(self, ground: Ground) -> Exploration:
        """See `Explorer`; the route to the frontier pursued, else to the nearest, else to ground far from the trail."""
        turn = self.look_around.next_turn()
        if turn is not None:
            return turn
        known = self._known(ground)
        return (
            (yield from self._go_on(known, ground.pose))
            or (yield from self._to_nearest(known, ground.pose))
            or (yield from self._to_least_visited(known))
        )

    def _known(self, ground: Ground) -> _Known:
        """Returns the frontiers of the known part of the map."""
        if self._spent.size == 0:
            self._spent = np.zeros(ground.navmap.frame.shape, np.bool_)
        window = ground.navmap.known_window(self.config.margin_cells)
        trail_m = distance_to(ground.navmap.view(window).trail) * np.float32(window.frame.cell_m)
        unknown = ground.unknown(window) & (trail_m > self.config.own_known_m)
        free = ground.free_space(window, costly=unknown)
        frontiers = frontier_cells(free.reachable & ~unknown, free.traversable & unknown)
        return _Known(window, free, frontiers, self._spent[window.index], trail_m)

    def _go_on(self, known: _Known, pose: Pose) -> Search:
        """Returns the route to the rest of the frontier pursued; None when it is done with."""
        if self._goal is None:
            return None
        route = yield Goal(known.free, self._goal.within(known.window) & known.open_frontiers)
        if route is None:
            self._goal = None
        elif route.length_m <= self.config.arrived_m:
            self._spend(known, pose)
            return None
        return route

    def _to_nearest(self, known: _Known, pose: Pose) -> Search:
        """Returns the route to the nearest open frontier: a long one, else any; None: there is none left."""
        open_frontiers = known.open_frontiers
        for least_m in (self.config.least_length_m, 0.0):
            parts = large_parts(open_frontiers, least_m / known.free.frame.cell_m)
            route = yield Goal(known.free, parts)
            while route is not None and route.length_m <= self.config.arrived_m:  # the robot is already there
                self._spend(known, pose)
                parts &= ~known.spent
                route = yield Goal(known.free, parts)
            if route is not None:
                route = to_nearest_part(route, pose)
                self._goal = MapCells.of(route.goal.cells, known.window)
                return route
        return None

    def _to_least_visited(self, known: _Known) -> Search:
        """Returns the route to the ground farthest from the trail, for when nothing unknown is left."""
        far_m = np.where(known.free.reachable, known.trail_m, -np.inf)
        route = yield Goal(known.free, far_m == far_m.max())
        return None if route is None or route.length_m <= self.config.arrived_m else route

    def _spend(self, known: _Known, pose: Pose) -> None:
        """Closes the frontiers around the robot, which has seen what they show."""
        index, disc = cells_near_segment(known.window.frame, pose.xy_m, pose.xy_m, self.config.spent_m)
        known.spent[index] |= disc
        if self._goal is not None:
            self.look_around.begin()
        self._goal = None
