"""Computes free space and routes over the map by fast marching (paper: Path Planning Module)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float32

from sim.core.geometry.fast_marching import travel_times
from sim.core.geometry.grid import GridFrame, cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, ConfigError
from stubborn.kernels.grids import distance_within, speeds
from stubborn.mapping.masks import connected, farther_than
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning.avoidance import ProvenGround


@dataclass(frozen=True, kw_only=True)
class PlanningConfig:
    """Safety distances, traversability costs and the choice of the next step.

    Distances to obstacles are those of a robot of radius 0.18 m; see `AgentConfig.for_robot`.
    """

    dilation_m: float = 0.15
    """Obstacles grow by this distance; the robot's centre stays outside the grown obstacles."""
    clearance_m: float = 0.30
    """The speed of the front is lower at cells nearer to an obstacle than this, so that routes keep clear of obstacles
    where there is space."""
    edge_speed: float = 0.35
    """Speed of the front at the edge of a dilated obstacle, rising to 1 at `clearance_m`; 1: no such cost."""
    unseen_speed: float = 0.4
    """Speed of the front over ground that was never in view, for routes on which unseen ground costs more: they may
    end at a wall, so that a detour over known ground pays."""
    unseen_gap_m: float = 0.20
    """Ground farther than this from all ground that was in view counts as unseen."""
    own_ground_m: float = 0.12
    """The ground within this distance of the robot's centre is free, even if the map shows an obstacle."""
    ring_m: float = FORWARD_M
    """Distance of the short-term goal: 5 cells, one forward."""
    turn_cost_m: float = 0.02
    """Cost of a turn of 30 degrees, in metres of path; it keeps the choice from alternating."""
    preferred_clearance_m: float = 0.24
    """A forward that comes nearer to an obstacle than this is chosen only if the other directions are worse."""
    clearance_cost: float = 1.5
    """Cost of each metre short of `preferred_clearance_m`, in metres of path."""
    aligned_rad: float = math.radians(15.0)
    """The robot turns when the angle from its heading to the short-term goal is larger than this, else it goes
    forward."""

    def __post_init__(self) -> None:
        for name in ("edge_speed", "unseen_speed"):
            if not 0.0 < getattr(self, name) <= 1.0:
                raise ConfigError(f"PlanningConfig.{name} must lie in (0, 1], got {getattr(self, name)}.")
        if not self.ring_m > 0.0:
            raise ConfigError(f"PlanningConfig.ring_m must be > 0 m, got {self.ring_m}.")
        for name in (
            *("dilation_m", "clearance_m", "unseen_gap_m", "own_ground_m", "turn_cost_m", "preferred_clearance_m"),
            *("clearance_cost", "aligned_rad"),
        ):
            if not getattr(self, name) >= 0.0:
                raise ConfigError(f"PlanningConfig.{name} must be >= 0, got {getattr(self, name)}.")

    def widened(self, by_m: float) -> PlanningConfig:
        """Returns the configuration of a robot with a radius that is larger by `by_m`."""
        names = ("dilation_m", "clearance_m", "preferred_clearance_m", "own_ground_m")
        return replace(self, **{name: getattr(self, name) + by_m for name in names})

    def reach_cells(self, cell_m: float) -> int:
        """Returns the distance to obstacles, in cells, beyond which no cost and no rule depends on it."""
        return math.ceil(max(self.dilation_m, self.clearance_m, self.preferred_clearance_m) / cell_m) + 2


@dataclass(frozen=True)
class FreeSpace:
    """The cells of one window of the map that the robot's centre may enter."""

    frame: GridFrame
    traversable: Bool[np.ndarray, "rows cols"]
    """True: outside dilated obstacles, or proven free by the robot's own trail."""
    clearance_m: Float32[np.ndarray, "rows cols"]
    """Distance from each cell's centre to that of the nearest obstacle cell, before dilation; cut off where large."""
    reachable: Bool[np.ndarray, "rows cols"]
    """True: traversable and connected to the robot's cell (4-neighbourhood)."""
    speed: Float32[np.ndarray, "rows cols"]
    """Speed of the front: 1 in open space, less near obstacles and, if requested, on unseen ground."""


@dataclass(frozen=True)
class Goal:
    """Cells to reach; it is enough to reach any of them."""

    free: FreeSpace
    """The free space to plan on."""
    cells: Bool[np.ndarray, "rows cols"]
    """A mask over the free space; cells that are not reachable do not count."""
    longest_m: float = math.inf
    """A longer route does not count."""
    marker_xy_m: tuple[float, float] | None = None
    """A point to mark in pictures of the map, such as the corner that the cells belong to."""


@dataclass(frozen=True)
class Route:
    """Distances to a goal; a path follows their descent."""

    goal: Goal
    """The goal; its cells are the reachable ones only."""
    distance_m: Float32[np.ndarray, "rows cols"]
    """Distance from each cell to the goal; slow ground counts as longer: a metre at speed 0.4 counts as 2.5 m. It is
    infinite where no path exists, and beyond the part of the field that was computed."""
    length_m: float
    """`distance_m` of the robot's cell."""

    @property
    def frame(self) -> GridFrame:
        """The frame of the free space."""
        return self.goal.free.frame


class Planner:
    """Plans on a window of the map."""

    def __init__(self, config: PlanningConfig, proven_ground: ProvenGround) -> None:
        """`proven_ground` returns the ground on which the robot's own motion overrules marks and obstacles."""
        self.config = config
        self.proven_ground = proven_ground
        self.own_ground_m = config.own_ground_m
        """The configured value, or less while the robot pushes on against the same surface."""

    def obstacles(self, view: NavMap, layer: CollisionLayer) -> Bool[np.ndarray, "rows cols"]:
        """Returns a new mask of depth obstacles, drops, and those marks of a layer that the body has not refuted."""
        blocked = view.collision_marks(layer) > self.proven_ground(view).body
        blocked |= view.seen_obstacle
        blocked |= view.seen_drop
        return blocked

    def unseen(self, view: NavMap) -> Bool[np.ndarray, "rows cols"]:
        """Returns the ground at some distance from all ground that was in view: distant floor is seen with gaps."""
        seen = (view.frames_in_view > 0) | view.visited
        return farther_than(seen, self.config.unseen_gap_m, view.frame.cell_m)

    def unknown(self, view: NavMap) -> Bool[np.ndarray, "rows cols"]:
        """Returns the ground that was never in view, up to the seen ground after its gaps were closed."""
        return ~farther_than(self.unseen(view), self.config.unseen_gap_m, view.frame.cell_m)

    def free_space(
        self, view: NavMap, pose: Pose, layer: CollisionLayer, costly: Bool[np.ndarray, "rows cols"] | None = None
    ) -> FreeSpace:
        """Returns the free space of a window with dilated obstacles; ground outside the window is not free.

        Routes avoid `costly` ground where the detour is not too long.
        """
        obstacles = self.obstacles(view, layer)
        own_index, own = cells_near_segment(view.frame, pose.xy_m, pose.xy_m, max(self.own_ground_m, view.frame.cell_m))
        # If an obstacle cell is under the robot, the obstacle covers only the edge of that cell.
        obstacles[own_index][own] = False
        cell_m = view.frame.cell_m
        clearance_m = distance_within(obstacles, self.config.reach_cells(cell_m)) * np.float32(cell_m)
        traversable = clearance_m > self.config.dilation_m + 1e-4
        traversable |= self.proven_ground(view).centre
        traversable[own_index] |= own
        row, col = view.frame.cell(pose.x_m, pose.y_m)
        reachable = connected(traversable, row, col, connectivity=4)
        speed = self._speed(clearance_m)
        if costly is not None:
            speed[costly] *= self.config.unseen_speed
        return FreeSpace(view.frame, traversable, clearance_m, reachable, speed)

    def route(self, goal: Goal, pose: Pose) -> Route | None:
        """Returns the route to the nearest goal cell by travel time.

        Returns None when no goal cell is connected to the robot, or the route is longer than `goal.longest_m`.
        """
        free = goal.free
        goal = replace(goal, cells=goal.cells & free.reachable)
        if not goal.cells.any():
            return None
        here = free.frame.cell(pose.x_m, pose.y_m)
        distance_m = travel_times(
            goal.cells,
            free.reachable,
            free.speed,
            free.frame.cell_m,
            goal.longest_m,
            until=here,
            beyond_m=2.0 * self.config.ring_m,
        )
        length_m = float(distance_m[here])
        return Route(goal, distance_m, length_m) if math.isfinite(length_m) else None

    def _speed(self, clearance_m: Float32[np.ndarray, "rows cols"]) -> Float32[np.ndarray, "rows cols"]:
        """Returns the speed of the front: 1 in open space and less near obstacles."""
        c = self.config
        numbers = c.dilation_m, max(c.clearance_m - c.dilation_m, 1e-6), c.edge_speed, 1.0 - c.edge_speed
        return speeds(clearance_m, *(np.float32(number) for number in numbers))
