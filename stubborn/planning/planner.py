"""Ways over the map by fast marching, and the next action along one (paper: Path Planning Module)."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.geometry.grid import GridFrame, cells_near_segment
from sim.geometry.pose import Pose
from sim.interface import FORWARD_M, TURN_RAD, Action, ConfigError, wrap_angle
from stubborn.navmap import NavMap
from stubborn.planning.fast_marching import march
from stubborn.raster import connected, distance_to


class Bumps(enum.Enum):
    """Which collision marks count as obstacles."""

    NONE = enum.auto()
    OPTIMISTIC = enum.auto()
    PESSIMISTIC = enum.auto()


@dataclass(frozen=True, kw_only=True)
class PlanningConfig:
    """Safety distances and the choice of the next step."""

    dilation_m: float = 0.15
    """Obstacles grow by this much; the robot's centre stays out."""
    wary_m: float = 0.30
    """Nearer to an obstacle than this the march slows down, so that ways keep clear where there is room."""
    wary_speed: float = 0.35
    """Speed of the march at an obstacle's edge, growing to 1 at `wary_m`; 1 switches the slowing off."""
    unknown_speed: float = 0.4
    """Speed of the march over ground that was never in view, where the caller asks for wariness of it: a way through
    what is known is worth a detour, since the other may end at a wall."""
    unseen_gap_m: float = 0.20
    """Ground this far from anything that was in view counts as never in view."""
    own_ground_m: float = 0.12
    """Around its centre the robot's own ground is free, whatever the map says: it stands there."""
    ring_m: float = FORWARD_M
    """Distance of the short-term goal: 5 cells, one forward."""
    turn_cost_m: float = 0.02
    """What a turn of 30 degrees weighs against a shorter way; keeps the choice from swinging to and fro."""
    comfort_m: float = 0.24
    """A straight forward that comes nearer to an obstacle than this is taken only where others are worse."""
    comfort_cost: float = 1.5
    """What each metre short of `comfort_m` weighs, in metres of way."""
    aligned_rad: float = math.radians(15.0)
    """Turn when the short-term goal is farther off the heading than this, else go forward."""

    def __post_init__(self) -> None:
        if not 0.0 < self.wary_speed <= 1.0:
            raise ConfigError(f"PlanningConfig.wary_speed must lie in (0, 1], got {self.wary_speed}.")


@dataclass(frozen=True)
class FreeSpace:
    """Where the robot's centre may go, on one window of the map."""

    frame: GridFrame
    traversable: NDArray[np.bool_]
    """True: free of dilated obstacles, or proven free by the robot's own trail."""
    clearance_m: NDArray[np.float32]
    """Distance from each cell's centre to the nearest obstacle cell's, before dilation."""
    reachable: NDArray[np.bool_]
    """True: traversable and connected to the robot's cell (4-neighbourhood)."""
    speed: NDArray[np.float32]
    """Of the march: 1 in the open, less along obstacles and, if asked for, on unknown ground."""


@dataclass(frozen=True)
class Plan:
    """Distances to a goal."""

    frame: GridFrame
    goal: NDArray[np.bool_]
    """The cells to reach."""
    distance_m: NDArray[np.float32]
    """From each cell to the goal; infinite where there is no way, and where the march had no need to go."""
    length_m: float
    """From the robot's cell."""


class Planner:
    """Plans on a window of the map."""

    def __init__(self, config: PlanningConfig, *, trust_visited: bool) -> None:
        self.config = config
        self.trust_visited = trust_visited

    def obstacles(self, view: NavMap, bumps: Bumps) -> NDArray[np.bool_]:
        """Depth obstacles, and the collision marks asked for where the body has not proved them wrong; a new array."""
        if bumps is Bumps.NONE:
            return view.seen_obstacle.copy()
        marks = view.bumped_wide if bumps is Bumps.PESSIMISTIC else view.bumped_narrow
        return view.seen_obstacle | (marks & ~view.visited if self.trust_visited else marks)

    def unseen(self, view: NavMap) -> NDArray[np.bool_]:
        """Ground that is some way off everything that was in view: far floor is seen with gaps."""
        seen = (view.frames_in_view > 0) | view.visited
        return distance_to(seen) * view.frame.cell_m > self.config.unseen_gap_m

    def free_space(self, view: NavMap, pose: Pose, bumps: Bumps, unseen: NDArray[np.bool_] | None = None) -> FreeSpace:
        """Dilate the obstacles of a window; what lies outside the window is not free.

        Ways avoid `unseen` ground where they can without too long a detour; by default unknown is as good as known.
        """
        obstacles = self.obstacles(view, bumps)
        own_index, own = cells_near_segment(
            view.frame, pose.xy_m, pose.xy_m, max(self.config.own_ground_m, view.frame.cell_m)
        )
        # An obstacle cell under the robot is a cell that the obstacle only just enters.
        obstacles[own_index][own] = False
        clearance_m = distance_to(obstacles) * np.float32(view.frame.cell_m)
        traversable = clearance_m > self.config.dilation_m + 1e-4
        if self.trust_visited:
            traversable |= view.trail
        traversable[own_index] |= own
        row, col = view.frame.cell(pose.x_m, pose.y_m)
        reachable = connected(traversable, row, col, connectivity=4)
        speed = self._speed(clearance_m)
        if unseen is not None:
            speed[unseen] *= self.config.unknown_speed
        return FreeSpace(view.frame, traversable, clearance_m, reachable, speed)

    def plan(
        self, free: FreeSpace, goal: NDArray[np.bool_], pose: Pose, *, farthest_m: float = math.inf
    ) -> Plan | None:
        """March from the goal over the ground that is connected to the robot.

        None when no goal cell is connected, or the way is longer than `farthest_m`.
        """
        goal = goal & free.reachable
        if not goal.any():
            return None
        here = free.frame.cell(pose.x_m, pose.y_m)
        distance_m = march(
            goal,
            free.reachable,
            free.speed,
            free.frame.cell_m,
            farthest_m,
            until=here,
            beyond_m=2.0 * self.config.ring_m,
        )
        length_m = float(distance_m[here])
        return Plan(free.frame, goal, distance_m, length_m) if math.isfinite(length_m) else None

    def next_action(self, plan: Plan, free: FreeSpace, pose: Pose) -> Action:
        """The action along the plan: turn towards the short-term goal when it is off the heading, else forward."""
        turn_rad = self.short_term_turn(plan, free, pose)
        if turn_rad > self.config.aligned_rad:
            return Action.TURN_LEFT
        return Action.TURN_RIGHT if turn_rad < -self.config.aligned_rad else Action.MOVE_FORWARD

    def short_term_turn(self, plan: Plan, free: FreeSpace, pose: Pose) -> float:
        """Angle from the heading to the short-term goal, radians, positive to the left.

        Short-term goals lie on a ring one forward away, in the directions the robot can turn to. Of those whose
        straight way keeps the safety distance, so never through a wall however thin, the best descent wins.
        """
        turns_rad = np.arange(-5, 7) * TURN_RAD
        yaw_rad = pose.yaw_rad + turns_rad
        distance_m = _interpolate(
            plan.distance_m,
            plan.frame,
            pose.x_m + self.config.ring_m * np.cos(yaw_rad),
            pose.y_m + self.config.ring_m * np.sin(yaw_rad),
        )
        clear, clearance_m = self._sweep(free, pose, yaw_rad)
        distance_m[~clear] = np.inf
        discomfort_m = np.maximum(self.config.comfort_m - clearance_m, 0.0)
        turns = np.abs(turns_rad) / TURN_RAD
        cost_m = distance_m + self.config.turn_cost_m * turns + self.config.comfort_cost * discomfort_m
        best = int(np.argmin(cost_m))
        if distance_m[best] < plan.length_m:
            return float(turns_rad[best])
        return wrap_angle(descent_direction(plan, pose, self.config.ring_m) - pose.yaw_rad)

    def _sweep(
        self, free: FreeSpace, pose: Pose, yaw_rad: NDArray[np.floating]
    ) -> tuple[NDArray[np.bool_], NDArray[np.float32]]:
        """Whether a straight forward in each direction stays traversable, and its least clearance in metres.

        A robot that already stands nearer than the safety distance may leave, but not come nearer still.
        """
        along_m = np.arange(1, 11)[:, None] * (self.config.ring_m / 10)
        x_m, y_m = pose.x_m + along_m * np.cos(yaw_rad), pose.y_m + along_m * np.sin(yaw_rad)
        rows, cols = free.frame.cells(x_m, y_m)  # (10, directions)
        inside = free.frame.contains(rows, cols)
        rows, cols = np.clip(rows, 0, free.frame.shape[0] - 1), np.clip(cols, 0, free.frame.shape[1] - 1)
        here_m = free.clearance_m[free.frame.cell(pose.x_m, pose.y_m)]
        clearance_m = free.clearance_m[rows, cols]
        clear = free.traversable[rows, cols] | (clearance_m >= max(here_m, free.frame.cell_m))
        return np.asarray((clear & inside).all(axis=0)), clearance_m.min(axis=0)

    def _speed(self, clearance_m: NDArray[np.float32]) -> NDArray[np.float32]:
        """1 in the open, less along obstacles."""
        c = self.config
        share = (clearance_m - np.float32(c.dilation_m)) / np.float32(max(c.wary_m - c.dilation_m, 1e-6))
        return np.clip(c.wary_speed + (1.0 - c.wary_speed) * share, c.wary_speed, 1.0)


def trace(plan: Plan, pose: Pose, max_cells: int) -> list[tuple[int, int]]:
    """Steepest descent from the robot's cell, at most so many cells on, as rows and columns.

    Steps go to 8 neighbours, diagonally only past two passable cells.
    """
    cells = [plan.frame.cell(pose.x_m, pose.y_m)]
    while len(cells) <= max_cells:
        step = _lowest_neighbour(plan.distance_m, *cells[-1])
        if step == cells[-1]:
            break
        cells.append(step)
    return cells


def descent_direction(plan: Plan, pose: Pose, length_m: float) -> float:
    """World angle from the robot to where steepest descent, cell by cell, leads it within `length_m`.

    For ways too narrow for a straight forward.
    """
    row, col = trace(plan, pose, max(1, round(length_m / plan.frame.cell_m)))[-1]
    x_m, y_m = plan.frame.centres(row, col)
    dx, dy = float(x_m) - pose.x_m, float(y_m) - pose.y_m
    return math.atan2(dy, dx) if math.hypot(dx, dy) > 1e-3 else pose.yaw_rad


def _lowest_neighbour(distance_m: NDArray[np.float32], row: int, col: int) -> tuple[int, int]:
    rows, cols = distance_m.shape
    best, lowest_m = (row, col), distance_m[row, col]
    for dr in (-1, 0, 1):
        for dc in (-1, 0, 1):
            r, c = row + dr, col + dc
            if not (0 <= r < rows and 0 <= c < cols):
                continue
            cuts_corner = dr and dc and not (np.isfinite(distance_m[r, col]) and np.isfinite(distance_m[row, c]))
            if distance_m[r, c] < lowest_m and not cuts_corner:
                best, lowest_m = (r, c), distance_m[r, c]
    return best


def _interpolate(
    values: NDArray[np.float32], frame: GridFrame, x_m: NDArray[np.float64], y_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Bilinear values at points, over the finite ones of the four cells around; infinite where their cell's is."""
    fc = (x_m - frame.origin_xy_m[0]) / frame.cell_m - 0.5
    fr = (y_m - frame.origin_xy_m[1]) / frame.cell_m - 0.5
    c0, r0 = np.floor(fc).astype(int), np.floor(fr).astype(int)
    total, weight = np.zeros(len(x_m)), np.zeros(len(x_m))
    for dr in (0, 1):
        for dc in (0, 1):
            r = np.clip(r0 + dr, 0, frame.shape[0] - 1)
            c = np.clip(c0 + dc, 0, frame.shape[1] - 1)
            share = np.abs(1 - dr - (fr - r0)) * np.abs(1 - dc - (fc - c0))
            finite = np.isfinite(values[r, c])
            total += np.where(finite, share * np.where(finite, values[r, c], 0.0), 0.0)
            weight += np.where(finite, share, 0.0)
    rows, cols = frame.cells(x_m, y_m)
    known = frame.contains(rows, cols) & (weight > 1e-6)
    known[known] = np.isfinite(values[rows[known], cols[known]])
    return np.where(known, total / np.maximum(weight, 1e-9), np.inf)
