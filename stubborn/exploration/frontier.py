"""Frontier exploration: always to the nearest border between known free ground and unknown.

Reference: Yamauchi (1997), "A Frontier-Based Approach for Autonomous Exploration", CIRA. There a robot plans through
known ground only. Here a level camera cannot see the floor under and beside the robot, so ways may cross unknown
ground, at the planner's price for it, and ground near the robot's own trail counts as known.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.geometry.grid import GridFrame, Window, cells_near_segment
from sim.geometry.pose import Pose
from sim.interface import ConfigError
from stubborn.exploration.corners import Route
from stubborn.navmap import NavMap
from stubborn.planning.planner import Bumps, FreeSpace, Planner, trace
from stubborn.raster import connected, distance_to, large_parts


@dataclass(frozen=True, kw_only=True)
class FrontierConfig:
    """What counts as a frontier and when it is done with."""

    least_length_m: float = 0.40
    """Shorter frontiers are left for when there is no other: the robot would hardly fit through."""
    own_known_m: float = 1.0
    """Ground this near the trail counts as known: it lies below the image, whose lowest row shows floor from 1.4 m on.
    Less makes the robot sweep its own surroundings, more declares rooms behind walls known."""
    arrived_m: float = 0.35
    """A frontier is reached within this length of way."""
    spent_m: float = 0.60
    """Around a place where a frontier was reached, what is left of it does not count any more."""
    look_around_turns: int = 0
    """Turns on the spot at the start and at each frontier reached; 11 are the reference's sweep of all around."""
    margin_cells: int = 20
    """Ground around the known part of the map on which ways may run."""

    def __post_init__(self) -> None:
        if self.arrived_m <= 0 or self.spent_m < self.arrived_m:
            raise ConfigError(
                f"FrontierConfig needs 0 < arrived_m <= spent_m, got {self.arrived_m} and {self.spent_m} m."
            )


def frontier_cells(known_free: NDArray[np.bool_], open_unknown: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Known free cells with an unknown, not blocked one among their 8 neighbours."""
    near_unknown = cv2.dilate(np.ascontiguousarray(open_unknown).view(np.uint8), np.ones((3, 3), np.uint8))
    return known_free & (near_unknown > 0)


class FrontierExplorer:
    """Goes to the nearest frontier by way, and keeps to it until it is reached or has become known."""

    def __init__(self, config: FrontierConfig, planner: Planner, *, averse: bool, bumps: bool) -> None:
        """`averse` explores on the pessimistic map, `bumps` says whether collision marks are kept at all."""
        self.config = config
        self.planner = planner
        self._bumps = (Bumps.PESSIMISTIC if averse else Bumps.OPTIMISTIC) if bumps else Bumps.NONE
        self.reset()

    def reset(self) -> None:
        """Forget the last episode."""
        self._goal: tuple[NDArray[np.intp], NDArray[np.intp]] | None = None  # rows and columns on the whole map
        self._spent: NDArray[np.bool_] | None = None  # on the whole map
        self._turns_left = self.config.look_around_turns

    def looks_around(self) -> bool:
        """Whether the next step of exploring is a turn on the spot rather than a route; counts the turns."""
        self._turns_left -= 1
        return self._turns_left >= 0

    def goal_xy_m(self, frame: GridFrame) -> tuple[float, float] | None:
        """None: what is headed for is the end of the route itself."""
        return None

    def route(self, navmap: NavMap, window: Window, pose: Pose) -> Route | None:
        """The way to the frontier pursued, else to the nearest, else to where the robot was least; None: walled in."""
        whole = navmap.known_window(self.config.margin_cells)
        view = navmap.view(whole)
        if self._spent is None:
            self._spent = np.zeros(navmap.frame.shape, np.bool_)
        trail_m = distance_to(view.trail) * np.float32(view.frame.cell_m)
        unknown = self._unknown(view) & (trail_m > self.config.own_known_m)
        free = self.planner.free_space(view, pose, self._bumps, unknown)
        frontiers = frontier_cells(free.reachable & ~unknown, free.traversable & unknown)
        return (
            self._go_on(free, frontiers & ~self._spent[whole.index], whole, pose)
            or self._to_nearest(free, frontiers, whole, pose)
            or self._to_least_visited(free, trail_m, pose)
        )

    def _unknown(self, view: NavMap) -> NDArray[np.bool_]:
        """Ground never in view, gaps within what was seen closed: far floor is seen with gaps."""
        gap_cells = self.planner.config.unseen_gap_m / view.frame.cell_m
        return distance_to(self.planner.unseen(view)) <= gap_cells

    def _go_on(self, free: FreeSpace, frontiers: NDArray[np.bool_], whole: Window, pose: Pose) -> Route | None:
        """The way to what is left of the frontier pursued; None when it is done with."""
        if self._goal is None:
            return None
        rows, cols = self._goal[0] - whole.rows.start, self._goal[1] - whole.cols.start
        goal = np.zeros_like(frontiers)
        goal[rows, cols] = frontiers[rows, cols]  # the known window never shrinks, so they lie in it
        plan = self.planner.plan(free, goal, pose)
        if plan is None:
            self._goal = None
            return None
        if plan.length_m <= self.config.arrived_m:
            self._spend(whole, pose)
            return None
        return Route(plan, free)

    def _to_nearest(self, free: FreeSpace, frontiers: NDArray[np.bool_], whole: Window, pose: Pose) -> Route | None:
        """The way to the nearest frontier that is not spent: a long one, else any; None: there is none left."""
        assert self._spent is not None
        unspent = frontiers & ~self._spent[whole.index]
        for least_m in (self.config.least_length_m, 0.0):
            route = self._to_nearest_part(free, large_parts(unspent, least_m / free.frame.cell_m), whole, pose)
            if route is not None:
                return route
        return None

    def _to_nearest_part(self, free: FreeSpace, places: NDArray[np.bool_], whole: Window, pose: Pose) -> Route | None:
        """The way to that connected part of some places which is nearest, and from now on pursue it."""
        plan = self.planner.plan(free, places, pose)
        if plan is None:
            return None
        if plan.length_m <= self.config.arrived_m:  # it stands at this one already
            self._spend(whole, pose)
            assert self._spent is not None
            return self._to_nearest_part(free, places & ~self._spent[whole.index], whole, pose)
        row, col = trace(plan, pose, max_cells=places.size)[-1]
        plan = replace(plan, goal=connected(plan.goal, row, col, connectivity=8))
        rows, cols = np.nonzero(plan.goal)
        self._goal = rows + whole.rows.start, cols + whole.cols.start
        return Route(plan, free)

    def _spend(self, whole: Window, pose: Pose) -> None:
        """The robot is where it could see what there is to see of a frontier."""
        assert self._spent is not None
        index, disc = cells_near_segment(whole.frame, pose.xy_m, pose.xy_m, self.config.spent_m)
        self._spent[whole.index][index] |= disc
        if self._goal is not None:
            self._turns_left = self.config.look_around_turns
        self._goal = None

    def _to_least_visited(self, free: FreeSpace, trail_m: NDArray[np.float32], pose: Pose) -> Route | None:
        """Where nothing unknown is left it does not freeze: the way to the ground farthest from the trail."""
        far_m = np.where(free.reachable, trail_m, -np.inf)
        plan = self.planner.plan(free, far_m == far_m.max(), pose)
        return None if plan is None or plan.length_m <= self.config.arrived_m else Route(plan, free)
