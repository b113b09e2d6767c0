"""Walks through a plan that imitate an exploration: shortest paths to places that were not seen yet."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Protocol

import numpy as np
from jaxtyping import Bool
from numpy.typing import NDArray

from sim.geometry.fast_marching import travel_times
from sim.geometry.pose import Pose
from sim.interface import TURN_RAD, Action
from sim.plans.plan import Plan
from sim.plans.robot import PlanRobot
from sim.plans.sight import PlanCamera
from stubborn.raster import connected


class WalkConfig(Protocol):
    """The part of `sim.twin.potentials.SampleConfig` that a walk needs."""

    @property
    def most_steps(self) -> int:
        """Actions of a walk."""
        ...

    @property
    def unseen_share(self) -> float:
        """Share of the legs of a walk that lead to a place not seen before."""
        ...


def explore(
    camera: PlanCamera, start: Pose, rng: np.random.Generator, config: WalkConfig
) -> Iterator[tuple[Pose, bool]]:
    """Yields the poses of a walk and whether the robot moved; between two of them the caller looks with the camera."""
    camera.reset()
    plan, robot = camera.plan, PlanRobot(camera.plan)
    robot.pose = start
    everywhere = reachable(plan, start)
    times: NDArray[np.float32] | None = None
    target, steps, moved = (0, 0), 0, True
    while steps < config.most_steps:
        yield robot.pose, moved
        steps += 1
        if times is None or _done(camera, times, target, robot.pose, rng):
            target, times = _leg(camera, everywhere, robot.pose, rng, config)
        turns = _best_turns(plan, times, robot.pose)
        action = Action.MOVE_FORWARD if turns == 0 else Action.TURN_LEFT if turns > 0 else Action.TURN_RIGHT
        moved = robot.move(action).moved_m > 0.0
        if action is Action.MOVE_FORWARD and not moved:
            times = None


def _done(
    camera: PlanCamera, times: NDArray[np.float32], target: tuple[int, int], pose: Pose, rng: np.random.Generator
) -> bool:
    """Returns whether a leg has ended: it was reached, or its end came into view and the robot turns away early."""
    reached = float(times[_at(camera.plan, pose)]) < 0.4
    return reached or (bool(camera.seen_floor[target]) and rng.random() < 0.3)


def _leg(
    camera: PlanCamera,
    everywhere: Bool[np.ndarray, "rows cols"],
    pose: Pose,
    rng: np.random.Generator,
    config: WalkConfig,
) -> tuple[tuple[int, int], NDArray[np.float32]]:
    """Returns the end of the next leg, a cell, and the travel times to it."""
    unseen = everywhere & ~camera.seen_floor
    wanted = unseen if rng.random() < config.unseen_share and np.count_nonzero(unseen) > 100 else everywhere
    cells = np.flatnonzero(wanted)
    row, col = divmod(int(cells[rng.integers(cells.size)]), everywhere.shape[1])
    plan, goal = camera.plan, np.zeros(everywhere.shape, np.bool_)
    goal[row, col] = True
    speed = np.clip(0.35 + 5.0 * plan.slack_m, 0.35, 1.0).astype(np.float32)  # slower near obstacles
    times = travel_times(goal, everywhere, speed, plan.frame.cell_m, until=_at(plan, pose), beyond_m=1.0)
    return (row, col), times


def reachable(plan: Plan, start: Pose) -> Bool[np.ndarray, "rows cols"]:
    """Returns the free cells of a plan that are connected to the start."""
    return connected(plan.free, *_at(plan, start), connectivity=4)


def _best_turns(plan: Plan, times: NDArray[np.float32], pose: Pose) -> int:
    """Returns the number of turns to the left after which a forward leads nearest to the end of a leg."""
    best, best_cost = 0, math.inf
    for turns in range(-5, 7):
        yaw_rad = pose.yaw_rad + turns * TURN_RAD
        costs = [
            float(times[_at(plan, Pose(*Pose(pose.x_m, pose.y_m, yaw_rad).ahead(length_m), 0.0))])
            for length_m in (0.12, 0.25)
        ]
        cost = costs[1] + 0.02 * abs(turns) if math.isfinite(costs[0]) else math.inf
        if cost < best_cost:
            best, best_cost = turns, cost
    return best


def _at(plan: Plan, pose: Pose) -> tuple[int, int]:
    """Returns the cell of a pose, at the edge of the plan where it is off it."""
    row, col = plan.frame.cell(pose.x_m, pose.y_m)
    return min(max(row, 0), plan.frame.shape[0] - 1), min(max(col, 0), plan.frame.shape[1] - 1)
