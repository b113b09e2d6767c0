"""Chooses the next action on a route (paper: Path Planning Module, the short-term goal)."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float32, Float64

from sim.core.geometry.pose import Pose
from sim.core.interface import TURN_RAD, Action, wrap_angle
from stubborn.kernels.grids import bilinear, sweep
from stubborn.mapping.masks import connected
from stubborn.planning.planner import FreeSpace, PlanningConfig, Route


def next_action(route: Route, pose: Pose, config: PlanningConfig) -> Action:
    """Returns a turn towards the short-term goal when it is off the heading, else a forward."""
    turn_rad = short_term_turn(route, pose, config)
    if turn_rad > config.aligned_rad:
        return Action.TURN_LEFT
    return Action.TURN_RIGHT if turn_rad < -config.aligned_rad else Action.MOVE_FORWARD


def short_term_turn(route: Route, pose: Pose, config: PlanningConfig) -> float:
    """Returns the angle from the heading to the short-term goal, radians, positive to the left.

    Short-term goals lie on a ring one forward away, in the directions that the robot can turn to. Only short-term goals
    to which the straight path keeps the safety distance count, so that none is behind a thin wall. The one with the
    steepest descent is chosen.
    """
    turns_rad = np.arange(-5, 7) * TURN_RAD
    yaw_rad = pose.yaw_rad + turns_rad
    x_m, y_m = pose.x_m + config.ring_m * np.cos(yaw_rad), pose.y_m + config.ring_m * np.sin(yaw_rad)
    distance_m = bilinear(route.distance_m, *route.frame.origin_xy_m, route.frame.cell_m, x_m, y_m)
    clear, clearance_m = _sweep(route.goal.free, pose, yaw_rad, config.ring_m)
    distance_m[~clear] = np.inf
    missing_m = np.maximum(config.preferred_clearance_m - clearance_m, 0.0)
    turns = np.abs(turns_rad) / TURN_RAD
    cost_m = distance_m + config.turn_cost_m * turns + config.clearance_cost * missing_m
    best = int(np.argmin(cost_m))
    if distance_m[best] < route.length_m:
        return float(turns_rad[best])
    return wrap_angle(descent_direction(route, pose, config.ring_m) - pose.yaw_rad)


def trace(route: Route, pose: Pose, max_cells: int) -> list[tuple[int, int]]:
    """Returns the steepest descent from the robot's cell, at most `max_cells` cells long, as rows and columns.

    Steps go to the 8 neighbours; a diagonal step needs two passable cells next to it.
    """
    cells = [route.frame.cell(pose.x_m, pose.y_m)]
    while len(cells) <= max_cells:
        step = _lowest_neighbour(route.distance_m, *cells[-1])
        if step == cells[-1]:
            break
        cells.append(step)
    return cells


def route_end(route: Route, pose: Pose) -> tuple[int, int]:
    """Returns the goal cell at which a route ends, as row and column of its frame."""
    return trace(route, pose, max_cells=route.goal.cells.size)[-1]


def to_nearest_part(route: Route, pose: Pose) -> Route:
    """Returns the same route with only the connected part of the goal cells at which it ends."""
    cells = route.goal.cells
    row, col = route_end(route, pose)
    return replace(route, goal=replace(route.goal, cells=connected(cells, row, col, connectivity=8)))


def descent_direction(route: Route, pose: Pose, length_m: float) -> float:
    """Returns the world angle from the robot to the end of a steepest descent of `length_m`, cell by cell.

    It is used in passages that are too narrow for a straight forward.
    """
    row, col = trace(route, pose, max(1, round(length_m / route.frame.cell_m)))[-1]
    x_m, y_m = route.frame.centres(row, col)
    dx, dy = float(x_m) - pose.x_m, float(y_m) - pose.y_m
    return math.atan2(dy, dx) if math.hypot(dx, dy) > 1e-3 else pose.yaw_rad


def _sweep(
    free: FreeSpace, pose: Pose, yaw_rad: Float64[np.ndarray, " n"], length_m: float
) -> tuple[Bool[np.ndarray, " n"], Float32[np.ndarray, " n"]]:
    """Returns whether a straight move in each direction stays traversable, and its least clearance in metres.

    A robot that is already nearer than the safety distance may move away, but must not come nearer.
    """
    along_m = np.arange(1, 11)[:, None] * (length_m / 10)
    x_m, y_m = pose.x_m + along_m * np.cos(yaw_rad), pose.y_m + along_m * np.sin(yaw_rad)  # (10, directions)
    frame = free.frame
    least_m = np.float32(max(free.clearance_m[frame.cell(pose.x_m, pose.y_m)], frame.cell_m))
    return sweep(free.traversable, free.clearance_m, least_m, *frame.origin_xy_m, frame.cell_m, x_m, y_m)


def _lowest_neighbour(distance_m: Float32[np.ndarray, "rows cols"], row: int, col: int) -> tuple[int, int]:
    """Returns the neighbour with the least distance, or the cell itself when none is nearer."""
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
