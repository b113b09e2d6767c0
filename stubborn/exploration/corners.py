"""Exploration towards the corners of the local window (paper: Exploration Planning Module)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.core.geometry.grid import GridFrame, cells_near_segment
from sim.core.interface import CameraModel, ConfigError
from stubborn.exploration.explorer import Exploration, Ground, Search
from stubborn.exploration.places import MapCells, Place
from stubborn.planning.planner import FreeSpace, Goal


@dataclass(frozen=True, kw_only=True)
class CornerConfig:
    """The places of the corners, and the rules by which a corner is given up."""

    inset: float = 0.10
    """Distance of the corners from the edge of the window, as a share of the edge's length."""
    corner_radius_m: float = 0.50
    """Any cell within this distance of a corner counts as the corner, so that a chair on the corner does not close
    it."""
    longest_path_m: float = 12.0
    """A corner with a longer path counts as infeasible."""
    first_corner: int = 0
    """The corner that comes first: 0 ahead left, 1 ahead right, 2 behind right, 3 behind left of the start heading."""
    regain_m2: float = 2.0
    """A corner that was given up is tried again when this much more ground has been in view."""
    margin_cells: int = 20
    """Margin around the known part of the map within which the route to a substitute place may run."""
    arrived_m: float = 0.35
    """A substitute place for an infeasible corner counts as reached within this path length."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.inset < 0.5:
            raise ConfigError(f"CornerConfig.inset must lie in [0, 0.5), got {self.inset}.")
        if self.first_corner not in range(4):
            raise ConfigError(f"CornerConfig.first_corner must be 0, 1, 2 or 3, got {self.first_corner}.")

    def make(self, camera: CameraModel) -> CornerExplorer:
        """Returns a new explorer with these parameters."""
        return CornerExplorer(self)


CLOCKWISE_CORNERS: tuple[tuple[int, int], ...] = ((1, 1), (1, -1), (-1, -1), (-1, 1))
"""Sign of (x, y) from the window's middle, clockwise seen from above: x is forward, y is left of the start."""


def corner_xy_m(frame: GridFrame, corner: int, inset: float) -> tuple[float, float]:
    """Returns the position of a corner of a window."""
    sign_x, sign_y = CLOCKWISE_CORNERS[corner]
    height_m, width_m = frame.shape[0] * frame.cell_m, frame.shape[1] * frame.cell_m
    return (
        frame.origin_xy_m[0] + width_m * (0.5 + sign_x * (0.5 - inset)),
        frame.origin_xy_m[1] + height_m * (0.5 + sign_y * (0.5 - inset)),
    )


class CornerExplorer:
    """Pursues one corner of the window, and the next one clockwise as soon as no path leads to it.

    The window moves with the robot, so that a corner which is infeasible now may be feasible after the next step. To
    keep the robot from alternating between two such places, a corner that was given up counts as infeasible until new
    ground has been seen. When all four are infeasible, it goes to the reachable cell nearest the corner and then tries
    again.
    """

    def __init__(self, config: CornerConfig) -> None:
        self.config = config
        self.reset()

    def reset(self, seed: int = 0) -> None:
        """Forgets the last episode."""
        self.corner = self.config.first_corner
        """Index of the corner that is pursued."""
        self.place: Place | None = None
        """The substitute place for an infeasible corner; None: a corner is pursued."""
        self._wanted_m2 = [0.0] * 4  # per corner, the area that must have been seen before it is tried again

    def explore(self, ground: Ground) -> Exploration:
        """See `Explorer`."""
        return (
            (yield from self.go_on(ground))
            or (yield from self.to_corner(ground))
            or (yield from self.to_nearest_place(ground))
        )

    def go_on(self, ground: Ground) -> Search:
        """Returns the route to the substitute place; None if the place does not exist or has been reached."""
        if self.place is None:
            return None
        route = yield from self.place.head_for(ground)
        if route is None:
            self.place = None
        return route

    def to_corner(self, ground: Ground) -> Search:
        """Returns the route to the corner or, clockwise, to the next feasible one; None when no corner is feasible."""
        seen_m2 = ground.navmap.seen_area_m2()
        open_corners = [(self.corner + turn) % 4 for turn in range(4)]
        open_corners = [corner for corner in open_corners if seen_m2 >= self._wanted_m2[corner]]
        for layer in ground.layers if open_corners else ():
            free = ground.free_space(layer=layer)
            for tried, corner in enumerate(open_corners):
                route = yield self._corner_goal(free, corner)
                if route is not None:
                    self._give_up(open_corners[:tried], seen_m2)
                    self.corner = corner
                    return route
        self._give_up(open_corners, seen_m2)
        return None

    def to_nearest_place(self, ground: Ground) -> Search:
        """Returns the route to the reachable cell nearest the corner; places that are already reached are skipped."""
        free = ground.free_space()
        cell_x_m, cell_y_m = free.frame.mesh()
        for _ in range(4):
            x_m, y_m = corner_xy_m(free.frame, self.corner, self.config.inset)
            self.corner = (self.corner + 1) % 4
            gap_m = np.where(free.reachable, np.hypot(cell_x_m - x_m, cell_y_m - y_m), np.inf)
            nearest = gap_m == gap_m.min()
            route = yield Goal(free, nearest)
            if route is not None and route.length_m > self.config.arrived_m:
                cells = MapCells.of(nearest, ground.window)
                self.place = Place(cells, self.config.margin_cells, self.config.arrived_m)
                return route
        return None

    def _corner_goal(self, free: FreeSpace, corner: int) -> Goal:
        """Returns the cells around a corner as a goal."""
        xy_m = corner_xy_m(free.frame, corner, self.config.inset)
        cells = np.zeros(free.frame.shape, np.bool_)
        index, inside = cells_near_segment(free.frame, xy_m, xy_m, self.config.corner_radius_m)
        cells[index] = inside
        return Goal(free, cells, longest_m=self.config.longest_path_m, marker_xy_m=xy_m)

    def _give_up(self, corners: list[int], seen_m2: float) -> None:
        """Closes corners until new ground has been seen."""
        for corner in corners:
            self._wanted_m2[corner] = seen_m2 + self.config.regain_m2
