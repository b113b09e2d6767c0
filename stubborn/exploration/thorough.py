"""Exploration of what the corners leave out; not in the paper.

The paper's explorer drives past open doors and turns back where all corners are closed. This one also looks around at
the start, looks aside where a turn shows much new ground (`stubborn.exploration.glance`), and visits ground that was
never in view (behind a door, a shelf) and places where the robot has never been (a bathroom seen from its door only).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sim.geometry.grid import Window
from sim.interface import CameraModel
from stubborn.exploration.corners import CornerConfig, CornerExplorer
from stubborn.exploration.explorer import Exploration, Ground, Search
from stubborn.exploration.glance import GlanceConfig, Glancer
from stubborn.exploration.places import LookAround, MapCells, Place, UnseenArea
from stubborn.mapping.masks import distance_to, large_parts
from stubborn.planning.planner import FreeSpace, Goal
from stubborn.planning.steering import to_nearest_part


@dataclass(frozen=True, kw_only=True)
class ThoroughConfig:
    """The corners, and the visits and turns between them."""

    corners: CornerConfig = field(default_factory=CornerConfig)
    """The paper's exploration, which comes before visits."""
    glance: GlanceConfig = field(default_factory=GlanceConfig)
    """Looks to the side."""
    look_around_turns: int = 11
    """Turns on the spot at the start and at places that were visited; 11 show everything around."""
    unseen_area_m2: tuple[float, ...] = (0.25, 0.05)
    """Least area of ground never in view that is visited, tried in this order; empty: none is."""
    unvisited_m: tuple[float, ...] = (1.5, 1.0, 0.6)
    """Least distance from the robot's trail of a place that is visited, tried in this order; empty: none is."""

    def make(self, camera: CameraModel) -> ThoroughExplorer:
        """Returns a new explorer with these parameters."""
        return ThoroughExplorer(self, camera)


class ThoroughExplorer:
    """Explores like `CornerExplorer`, but visits what is unseen or unvisited before it takes a substitute for a corner.

    A destination is kept until it is reached, also when a corner opens meanwhile.
    """

    def __init__(self, config: ThoroughConfig, camera: CameraModel) -> None:
        self.config = config
        self.corners = CornerExplorer(config.corners)
        self.glancer = Glancer(config.glance, camera)
        self.look_around = LookAround(config.look_around_turns)
        self.reset()

    def reset(self, seed: int = 0) -> None:
        """Forgets the last episode."""
        self.corners.reset()
        self.glancer.reset()
        self.look_around.begin()
        self.destination: Place | UnseenArea | None = None
        """The unseen area or unvisited place that is visited; None: the corners are explored."""

    def explore(self, ground: Ground) -> Exploration:
        """See `Explorer`."""
        turn = self.look_around.next_turn()
        if turn is None:
            turn = self.glancer.next_turn(ground.navmap, ground.pose)
        if turn is not None:
            return turn
        return (
            (yield from self._go_on(ground))
            or (yield from self.corners.to_corner(ground))
            or (yield from self._to_new_destination(ground))
            or (yield from self.corners.to_nearest_place(ground))
        )

    def _go_on(self, ground: Ground) -> Search:
        """Returns the route to the destination; None when there is none, or it is done with."""
        destination = self.destination or self.corners.place
        if self.destination is None:
            route = yield from self.corners.go_on(ground)
        else:
            route = yield from self.destination.head_for(ground)
            self.destination = None if route is None else self.destination
        if destination is not None and destination.reached:
            self.look_around.begin()
        return route

    def _to_new_destination(self, ground: Ground) -> Search:
        """Returns the route to an unseen area, else to an unvisited place; None when there is neither."""
        known = ground.navmap.known_window(self.config.corners.margin_cells)
        free = ground.free_space(known, costly=ground.unseen(known))
        return (yield from self._to_unseen(ground, known, free)) or (yield from self._to_unvisited(ground, known, free))

    def _to_unseen(self, ground: Ground, known: Window, free: FreeSpace) -> Search:
        """Returns the route to the nearest large part of the reachable ground that was never in view."""
        unseen = ground.unseen(known) & free.reachable
        for area_m2 in self.config.unseen_area_m2:
            route = yield Goal(free, large_parts(unseen, area_m2 / free.frame.cell_m**2))
            if route is not None:
                route = to_nearest_part(route, ground.pose)
                self.destination = UnseenArea(MapCells.of(route.goal.cells, known), self.config.corners.margin_cells)
                return route
        return None

    def _to_unvisited(self, ground: Ground, known: Window, free: FreeSpace) -> Search:
        """Returns the route to the place farthest from the trail in the nearest part of the unvisited ground."""
        config = self.config.corners
        trail_m = distance_to(ground.navmap.view(known).trail) * np.float32(free.frame.cell_m)
        for least_m in self.config.unvisited_m:
            nearest = yield Goal(free, free.reachable & (trail_m >= least_m))
            if nearest is None:
                continue
            far_m = np.where(to_nearest_part(nearest, ground.pose).goal.cells, trail_m, -np.inf)
            place = Place(MapCells.of(far_m == far_m.max(), known), config.margin_cells, config.arrived_m)
            route = yield from place.head_for(ground)
            if route is not None:
                self.destination = place
                return route
            if place.reached:
                self.look_around.begin()
        return None
