"""Frontier exploration: the robot goes to the nearest border between known free ground and unknown ground.

Reference: Yamauchi (1997), "A Frontier-Based Approach for Autonomous Exploration", CIRA. Its robot plans through known
ground only; here paths may cross unknown ground (`stubborn.exploration.frontiers`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel, ConfigError
from stubborn.exploration.explorer import Exploration, Ground, Search
from stubborn.exploration.frontiers import Frontiers, require_margin, spend_around
from stubborn.exploration.places import LookAround, MapCells
from stubborn.mapping.masks import large_parts
from stubborn.planning.planner import Goal
from stubborn.planning.steering import to_nearest_part


@dataclass(frozen=True, kw_only=True)
class FrontierConfig:
    """Defines which cells are a frontier, and when a frontier is finished."""

    least_length_m: float = 0.40
    """Shorter frontiers come last: the robot would hardly fit through."""
    own_known_m: float = 1.0
    """Ground within this distance of the trail counts as known: it lies below the image, which shows the floor from
    1.4 m on. With a smaller value the robot explores its own surroundings; with a larger value rooms behind walls
    count as known."""
    arrived_m: float = 0.35
    """A frontier counts as reached within this path length."""
    spent_m: float = 0.60
    """Within this distance of a place where a frontier was reached, no cell counts as a frontier any more."""
    look_around_turns: int = 0
    """Turns on the spot at the start and at each reached frontier; 11 show all surroundings, as in the reference."""
    margin_cells: int = 20
    """Margin around the known part of the map within which paths may run."""

    def __post_init__(self) -> None:
        require_margin("FrontierConfig", self.arrived_m, self.spent_m)
        if self.look_around_turns < 0:
            raise ConfigError(f"FrontierConfig.look_around_turns must be >= 0, got {self.look_around_turns}.")

    def make(self, camera: CameraModel) -> FrontierExplorer:
        """Returns a new explorer with these parameters."""
        return FrontierExplorer(self)


class FrontierExplorer:
    """Goes to the frontier with the shortest path, and pursues it until it is reached or has become known."""

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
        """Returns the route to the pursued frontier, else to the nearest, else to ground far from the trail."""
        turn = self.look_around.next_turn()
        if turn is not None:
            return turn
        if self._spent.size == 0:
            self._spent = np.zeros(ground.navmap.frame.shape, np.bool_)
        config = self.config
        known = Frontiers.of(ground, own_known_m=config.own_known_m, margin_cells=config.margin_cells)
        return (
            (yield from self._go_on(known, ground.pose))
            or (yield from self._to_nearest(known, ground.pose))
            or (yield from known.to_least_visited(config.arrived_m))
        )

    def _go_on(self, known: Frontiers, pose: Pose) -> Search:
        """Returns the route to the rest of the pursued frontier; None when it is finished."""
        if self._goal is None:
            return None
        route = yield Goal(known.free, self._goal.within(known.window) & known.cells & ~self._spent[known.window.index])
        if route is None:
            self._goal = None
        elif route.length_m <= self.config.arrived_m:
            self._spend(known, pose)
            return None
        return route

    def _to_nearest(self, known: Frontiers, pose: Pose) -> Search:
        """Returns the route to the nearest open frontier: a long one, else any; None: no frontier is left."""
        spent = self._spent[known.window.index]
        open_cells = known.cells & ~spent
        for least_m in (self.config.least_length_m, 0.0):
            parts = large_parts(open_cells, least_m / known.free.frame.cell_m)
            route = yield Goal(known.free, parts)
            while route is not None and route.length_m <= self.config.arrived_m:  # the robot is already there
                self._spend(known, pose)
                parts &= ~spent
                route = yield Goal(known.free, parts)
            if route is not None:
                route = to_nearest_part(route, pose)
                self._goal = MapCells.of(route.goal.cells, known.window)
                return route
        return None

    def _spend(self, known: Frontiers, pose: Pose) -> None:
        """Closes the frontiers around the robot, because the robot has seen what they show."""
        spend_around(self._spent, known.window, pose, self.config.spent_m)
        if self._goal is not None:
            self.look_around.begin()
        self._goal = None
