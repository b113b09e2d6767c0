"""Where to look next: a corner of the local window until there is no way to it (paper: Exploration Planning Module)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sim.geometry.grid import GridFrame, Window, cells_near_segment
from sim.geometry.pose import Pose
from sim.interface import ConfigError
from stubborn.navmap import NavMap
from stubborn.planning.planner import Bumps, FreeSpace, Plan, Planner, trace
from stubborn.raster import connected, distance_to, large_parts


@dataclass(frozen=True, kw_only=True)
class ExplorationConfig:
    """The corners and when one is given up."""

    inset: float = 0.10
    """Corners lie this share of the window's edge inside it."""
    corner_radius_m: float = 0.50
    """Any cell this near a corner will do: a chair that happens to stand on it must not close it."""
    farthest_way_m: float = 12.0
    """A corner with a longer way counts as infeasible."""
    first_corner: int = 0
    """Which corner comes first: 0 ahead left, 1 ahead right, 2 behind right, 3 behind left of the start heading."""
    look_around_turns: int = 0
    """Turns on the spot at the start and where a place is visited for its own sake; 11 show everything around."""
    unseen_area_m2: tuple[float, ...] = ()
    """Least area of ground never in view that is worth an errand, first and later; empty: none is (the paper)."""
    unvisited_m: tuple[float, ...] = ()
    """Least distance from the robot's trail that is worth an errand, first and later; empty: none is (the paper)."""
    regain_m2: float = 2.0
    """A corner given up is tried again when this much more ground has been in view."""
    margin_cells: int = 20
    """Ground around the known part of the map on which errands may run."""
    arrived_m: float = 0.35
    """A place that stands in for an infeasible corner is reached within this distance."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.inset < 0.5:
            raise ConfigError(f"ExplorationConfig.inset must lie in [0, 0.5), got {self.inset}.")
        if self.first_corner not in range(4):
            raise ConfigError(f"ExplorationConfig.first_corner must be 0, 1, 2 or 3, got {self.first_corner}.")


@dataclass(frozen=True)
class Route:
    """A plan and the free space that it was made on."""

    plan: Plan
    free: FreeSpace


class Explorer(Protocol):
    """Chooses where to go while there is no candidate."""

    def reset(self) -> None:
        """Forget the last episode."""
        ...

    def looks_around(self) -> bool:
        """Whether the next step of exploring is a turn on the spot rather than a route; counts the turns."""
        ...

    def route(self, navmap: NavMap, window: Window, pose: Pose) -> Route | None:
        """The way to go on exploring; None when the robot is walled in."""
        ...

    def goal_xy_m(self, frame: GridFrame) -> tuple[float, float] | None:
        """The point that the last route on this frame stood for, for pictures; None: its own end."""
        ...


CLOCKWISE_CORNERS: tuple[tuple[int, int], ...] = ((1, 1), (1, -1), (-1, -1), (-1, 1))
"""Sign of (x, y) from the window's middle, clockwise seen from above: x is forward, y is left of the start."""


def corner_xy_m(frame: GridFrame, corner: int, inset: float) -> tuple[float, float]:
    """World position of a corner goal of a window."""
    sign_x, sign_y = CLOCKWISE_CORNERS[corner]
    height_m, width_m = frame.shape[0] * frame.cell_m, frame.shape[1] * frame.cell_m
    return (
        frame.origin_xy_m[0] + width_m * (0.5 + sign_x * (0.5 - inset)),
        frame.origin_xy_m[1] + height_m * (0.5 + sign_y * (0.5 - inset)),
    )


@dataclass
class _Errand:
    """A place that is headed for when no corner can be."""

    cells: tuple[NDArray[np.intp], NDArray[np.intp]]
    """Rows and columns on the whole map; any of them will do."""
    to_look: bool
    """True: done as soon as all of it was in view. False: done on arrival."""


class CornerExplorer:
    """Keeps to one corner of the window; takes the next one clockwise as soon as there is no way to it.

    The window moves with the robot, and what is infeasible here may be feasible a step further on. So that the robot
    does not swing between two such places, a corner given up counts as infeasible until new ground has been seen.
    When all four are infeasible it goes on an errand and sees it through: to the reachable place nearest the corner.
    Errands that the paper does not have can be put before that one: to the nearest reachable ground that was never in
    view (behind a door, a shelf), and to where it has never been (a bathroom seen from its door only), where it looks
    around.
    """

    def __init__(self, config: ExplorationConfig, planner: Planner, *, averse: bool, bumps: bool) -> None:
        """`averse` explores on the pessimistic map, `bumps` says whether collision marks are kept at all."""
        self.config = config
        self.planner = planner
        first = Bumps.PESSIMISTIC if averse else Bumps.OPTIMISTIC
        self._maps = ((first, Bumps.OPTIMISTIC) if averse else (first,)) if bumps else (Bumps.NONE,)
        self.reset()

    def reset(self) -> None:
        """Forget the last episode."""
        self.corner = self.config.first_corner
        """Index of the corner that is pursued."""
        self._wanted_m2 = [0.0] * 4  # per corner, how much must have been seen before it is tried again
        self._errand: _Errand | None = None
        self._turns_left = self.config.look_around_turns

    @property
    def on_errand(self) -> bool:
        """Whether the last route led elsewhere than to a corner."""
        return self._errand is not None

    def goal_xy_m(self, frame: GridFrame) -> tuple[float, float] | None:
        """The corner; None when the last route led elsewhere."""
        return None if self.on_errand else corner_xy_m(frame, self.corner, self.config.inset)

    def looks_around(self) -> bool:
        """Whether the next step of exploring is a turn on the spot rather than a route; counts the turns."""
        self._turns_left -= 1
        return self._turns_left >= 0

    def route(self, navmap: NavMap, window: Window, pose: Pose) -> Route | None:
        """The way to go on exploring; None when the robot is walled in."""
        whole = navmap.known_window(self.config.margin_cells)
        if self._errand is not None:
            route = self._follow_errand(navmap, whole, pose)
            if route is not None:
                return route
        return self._corner_route(navmap, window, pose) or self._new_errand(navmap, window, whole, pose)

    def _corner_route(self, navmap: NavMap, window: Window, pose: Pose) -> Route | None:
        """The way to the corner or, clockwise, to the next feasible one."""
        seen_m2 = navmap.seen_area_m2()
        view = navmap.view(window)
        open_corners = [(self.corner + turn) % 4 for turn in range(4)]
        open_corners = [corner for corner in open_corners if seen_m2 >= self._wanted_m2[corner]]
        for bumps in self._maps if open_corners else ():
            free = self.planner.free_space(view, pose, bumps)
            for tried, corner in enumerate(open_corners):
                plan = self._plan_to_corner(free, corner, pose)
                if plan is not None:
                    self._give_up(open_corners[:tried], seen_m2)
                    self.corner = corner
                    return Route(plan, free)
        self._give_up(open_corners, seen_m2)
        return None

    def _give_up(self, corners: list[int], seen_m2: float) -> None:
        for corner in corners:
            self._wanted_m2[corner] = seen_m2 + self.config.regain_m2

    def _plan_to_corner(self, free: FreeSpace, corner: int, pose: Pose) -> Plan | None:
        """The way to a corner, None when it is infeasible."""
        xy_m = corner_xy_m(free.frame, corner, self.config.inset)
        goal = np.zeros(free.frame.shape, np.bool_)
        index, inside = cells_near_segment(free.frame, xy_m, xy_m, self.config.corner_radius_m)
        goal[index] = inside
        return self.planner.plan(free, goal, pose, farthest_m=self.config.farthest_way_m)

    def _new_errand(self, navmap: NavMap, window: Window, whole: Window, pose: Pose) -> Route | None:
        """Choose a place and the way to it."""
        view = navmap.view(whole)
        unseen = self.planner.unseen(view)
        free = self.planner.free_space(view, pose, self._maps[0], unseen)
        cell_area_m2 = free.frame.cell_m**2
        for area_m2 in self.config.unseen_area_m2:
            route = self._to_nearest_part(free, large_parts(unseen & free.reachable, area_m2 / cell_area_m2), pose)
            if route is not None:
                self._errand = _Errand(_on_whole_map(np.nonzero(route.plan.goal), whole), to_look=True)
                return route
        trail_m = distance_to(view.trail) * np.float32(free.frame.cell_m)
        for least_m in self.config.unvisited_m:
            route = self._to_nearest_part(free, free.reachable & (trail_m >= least_m), pose)
            if route is not None:
                far_m = np.where(route.plan.goal, trail_m, -np.inf)
                self._errand = _Errand(_on_whole_map(np.nonzero(far_m == far_m.max()), whole), to_look=False)
                route = self._follow_errand(navmap, whole, pose)
                if route is not None:
                    return route
        return self._nearest_place(navmap, window, pose)

    def _to_nearest_part(self, free: FreeSpace, places: NDArray[np.bool_], pose: Pose) -> Route | None:
        """The way to that connected part of some places which is nearest; the plan's goal is the whole part."""
        plan = self.planner.plan(free, places, pose)
        if plan is None:
            return None
        row, col = trace(plan, pose, max_cells=places.size)[-1]
        return Route(replace(plan, goal=connected(plan.goal, row, col, connectivity=8)), free)

    def _nearest_place(self, navmap: NavMap, window: Window, pose: Pose) -> Route | None:
        """The way to the reachable cell nearest the corner; one where the robot stands already is passed over."""
        free = self.planner.free_space(navmap.view(window), pose, self._maps[0])
        cell_x_m, cell_y_m = free.frame.mesh()
        for _ in range(4):
            x_m, y_m = corner_xy_m(free.frame, self.corner, self.config.inset)
            self.corner = (self.corner + 1) % 4
            gap_m = np.where(free.reachable, np.hypot(cell_x_m - x_m, cell_y_m - y_m), np.inf)
            place = gap_m == gap_m.min()
            plan = self.planner.plan(free, place, pose)
            if plan is not None and plan.length_m > self.config.arrived_m:
                self._errand = _Errand(_on_whole_map(np.nonzero(place), window), to_look=False)
                return Route(plan, free)
        return None

    def _follow_errand(self, navmap: NavMap, whole: Window, pose: Pose) -> Route | None:
        """The way on; None when the errand is done or has become impossible."""
        errand, self._errand = self._errand, None
        if errand is None:
            return None
        view = navmap.view(whole)
        goal = np.zeros(whole.frame.shape, np.bool_)
        rows, cols = errand.cells[0] - whole.rows.start, errand.cells[1] - whole.cols.start
        inside = whole.frame.contains(rows, cols)
        goal[rows[inside], cols[inside]] = True
        unseen = self.planner.unseen(view)
        if errand.to_look:
            goal &= unseen
        free = self.planner.free_space(view, pose, self._maps[0], unseen)
        plan = self.planner.plan(free, goal, pose)
        if plan is None:
            return None
        if not errand.to_look and plan.length_m <= self.config.arrived_m:
            self._turns_left = self.config.look_around_turns
            return None
        self._errand = errand
        return Route(plan, free)


def _on_whole_map(cells: tuple[NDArray[np.intp], ...], part: Window) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    rows, cols = cells
    return rows + part.rows.start, cols + part.cols.start


def nearest_corner(heading_rad: float) -> int:
    """The corner whose direction is nearest to a heading in the start frame."""
    offsets = [
        abs(math.remainder(math.atan2(sign_y, sign_x) - heading_rad, math.tau)) for sign_x, sign_y in CLOCKWISE_CORNERS
    ]
    return int(np.argmin(offsets))
