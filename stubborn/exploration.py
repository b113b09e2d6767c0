"""Where to look next: a corner of the local window until there is no way to it (paper: Exploration Planning Module)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.interface import ConfigError
from stubborn.grid import GridFrame, PlanarPose, cells_near_segment
from stubborn.navmap import NavMap
from stubborn.planning import Bumps, FreeSpace, Plan, Planner


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


class CornerExplorer:
    """Keeps to one corner of the window; takes the next one clockwise as soon as there is no way to it."""

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

    def route(self, view: NavMap, pose: PlanarPose) -> Route | None:
        """The way to the corner, to the next feasible one, or to the nearest place to it; None when walled in."""
        for bumps in self._maps:
            free = self.planner.free_space(view, pose, bumps)
            for turn in range(4):
                corner = (self.corner + turn) % 4
                plan = self._plan_to_corner(free, corner, pose)
                if plan is not None:
                    self.corner = corner
                    return Route(plan, free)
        return self._nearest_place(self.planner.free_space(view, pose, self._maps[0]), pose)

    def _plan_to_corner(self, free: FreeSpace, corner: int, pose: PlanarPose) -> Plan | None:
        """The way to a corner, None when it is infeasible."""
        xy_m = corner_xy_m(free.frame, corner, self.config.inset)
        goal = np.zeros(free.frame.shape, np.bool_)
        index, inside = cells_near_segment(free.frame, xy_m, xy_m, self.config.corner_radius_m)
        goal[index] = inside
        return self.planner.plan(free, goal, pose, farthest_m=self.config.farthest_way_m)

    def _nearest_place(self, free: FreeSpace, pose: PlanarPose) -> Route | None:
        """The way to the reachable cell nearest the corner; on arrival the turn comes to the next corner."""
        cell_x_m, cell_y_m = free.frame.mesh()
        for _ in range(4):
            x_m, y_m = corner_xy_m(free.frame, self.corner, self.config.inset)
            gap_m = np.where(free.reachable, np.hypot(cell_x_m - x_m, cell_y_m - y_m), np.inf)
            plan = self.planner.plan(free, gap_m == gap_m.min(), pose)
            if plan is not None and plan.length_m > self.config.arrived_m:
                return Route(plan, free)
            self.corner = (self.corner + 1) % 4
        return None


def nearest_corner(heading_rad: float) -> int:
    """The corner whose direction is nearest to a heading in the start frame."""
    offsets = [
        abs(math.remainder(math.atan2(sign_y, sign_x) - heading_rad, math.tau)) for sign_x, sign_y in CLOCKWISE_CORNERS
    ]
    return int(np.argmin(offsets))
