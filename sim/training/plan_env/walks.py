"""Walks through a plan: explorations, and searches for a goal that know the free space but not where the goal is."""

from __future__ import annotations

import math
from collections.abc import Iterator

import cv2
import numpy as np
from jaxtyping import Bool
from numpy.typing import NDArray

from sim.core.geometry.fast_marching import travel_times
from sim.core.geometry.grid import cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import MAX_STEPS, TURN_RAD, Action
from sim.homes.plans.plan import Plan
from sim.homes.plans.robot import PlanRobot
from sim.homes.plans.sight import PlanCamera
from sim.task.metrics import EXPLORED_SHARE
from stubborn.mapping.masks import connected
from stubborn.mapping.navmap import NavMap

REACHED_S = 0.4
"""A leg has ended this near its end, in seconds at one metre a second."""
BLIND_M = 1.5
"""A search treats floor this near the robot as seen; the camera does not see floor within 1.4 m."""
SPECK_CELLS = 5
"""Unseen floor is visited only if it contains a square of this many cells on a side."""


def explore(
    camera: PlanCamera, start: Pose, rng: np.random.Generator, *, most_steps: int, unseen_share: float
) -> Iterator[tuple[Pose, bool]]:
    """Yields the poses of a walk and whether the robot moved; between two of them the caller looks with the camera.

    A walk has `most_steps` actions; `unseen_share` of its legs lead to a place not seen before.
    """
    camera.reset()
    plan, robot = camera.plan, PlanRobot(camera.plan)
    robot.pose = start
    everywhere = reachable(plan, start)
    times: NDArray[np.float32] | None = None
    target, steps, moved = (0, 0), 0, True
    while steps < most_steps:
        yield robot.pose, moved
        steps += 1
        if times is None or _done(camera, times, target, robot.pose, rng):
            target, times = _leg(camera, everywhere, robot.pose, rng, unseen_share)
        turns = _best_turns(plan, times, robot.pose)
        action = Action.MOVE_FORWARD if turns == 0 else Action.TURN_LEFT if turns > 0 else Action.TURN_RIGHT
        moved = robot.move(action).moved_m > 0.0
        if action is Action.MOVE_FORWARD and not moved:
            times = None


def search(camera: PlanCamera, goal: str, start: Pose, rng: np.random.Generator) -> tuple[list[Pose], list[Action]]:
    """Returns the pose before each action, and the actions, of a search for a goal that ends with a STOP for it.

    The robot drives to the nearest floor that was not in view yet, along the shortest path of the plan, until the goal
    is in view as metrics count it; then to the nearest place where a STOP succeeds. A search that does not find the
    goal within `MAX_STEPS` actions has no STOP at its end.

    Args:
        camera: the camera of the plan; it forgets the cells that it has seen.
        goal: a goal of the plan.
        start: in the world, in free space.
        rng: draws the place to go to after the robot was stopped by something.
    """
    camera.reset()
    plan, robot, layers = camera.plan, PlanRobot(camera.plan), NavMap.empty(camera.plan.frame)
    robot.pose = start
    everywhere, stops = reachable(plan, start), plan.success_cells(goal)
    near = np.zeros(everywhere.shape, np.bool_)
    target, is_found = (0, 0), False
    times: NDArray[np.float32] | None = None
    poses: list[Pose] = []
    actions: list[Action] = []
    while len(actions) < MAX_STEPS:
        look = camera.look(robot.pose, goal, layers, robot.pose)
        if not is_found and look.goal_share >= EXPLORED_SHARE:
            is_found, times = True, _times_to(plan, stops & everywhere, everywhere, robot.pose)
        poses.append(robot.pose)
        index, inside = cells_near_segment(plan.frame, robot.pose.xy_m, robot.pose.xy_m, BLIND_M)
        near[index] |= inside
        if is_found and stops[_at(plan, robot.pose)]:
            actions.append(Action.STOP)
            break
        seen = camera.seen_floor | near
        if times is None or (not is_found and (seen[target] or float(times[_at(plan, robot.pose)]) < REACHED_S)):
            target = _nearest_unseen(everywhere, everywhere & ~seen, plan, robot.pose)
            times = _times_to(plan, _only(everywhere, target), everywhere, robot.pose)
        turns = _best_turns(plan, times, robot.pose)
        actions.append(Action.MOVE_FORWARD if turns == 0 else Action.TURN_LEFT if turns > 0 else Action.TURN_RIGHT)
        moved_m = robot.move(actions[-1]).moved_m
        if actions[-1] is Action.MOVE_FORWARD and moved_m == 0.0:
            target = _any_cell(everywhere, rng)
            times = _times_to(plan, _only(everywhere, target), everywhere, robot.pose)
            is_found = False  # it sees the goal again from where it can be reached
    return poses, actions


def _nearest_unseen(
    everywhere: Bool[np.ndarray, "rows cols"], unseen: Bool[np.ndarray, "rows cols"], plan: Plan, pose: Pose
) -> tuple[int, int]:
    """Returns the cell of unseen floor that is soonest reached; where only specks are left, the farthest cell."""
    here = _only(everywhere, _at(plan, pose))
    times = travel_times(here, everywhere | here, _speed(plan), plan.frame.cell_m)
    large = cv2.erode(unseen.astype(np.uint8), np.ones((SPECK_CELLS, SPECK_CELLS), np.uint8)) > 0
    priority = np.where(large, times, np.inf)
    if not np.isfinite(priority).any():
        priority = -np.where(np.isfinite(times), times, -np.inf)
    row, col = np.unravel_index(int(np.argmin(priority)), priority.shape)
    return int(row), int(col)


def _any_cell(cells: Bool[np.ndarray, "rows cols"], rng: np.random.Generator) -> tuple[int, int]:
    numbers = np.flatnonzero(cells)
    row, col = divmod(int(numbers[rng.integers(numbers.size)]), cells.shape[1])
    return row, col


def _only(like: Bool[np.ndarray, "rows cols"], cell: tuple[int, int]) -> Bool[np.ndarray, "rows cols"]:
    mask = np.zeros(like.shape, np.bool_)
    mask[cell] = True
    return mask


def _times_to(
    plan: Plan, goal: Bool[np.ndarray, "rows cols"], everywhere: Bool[np.ndarray, "rows cols"], pose: Pose
) -> NDArray[np.float32]:
    """Returns the travel times to `goal`, up to the robot's cell and one metre beyond; slower near obstacles."""
    return travel_times(goal, everywhere, _speed(plan), plan.frame.cell_m, until=_at(plan, pose), beyond_m=1.0)


def _speed(plan: Plan) -> NDArray[np.float32]:
    return np.clip(0.35 + 5.0 * plan.slack_m, 0.35, 1.0).astype(np.float32)


def _done(
    camera: PlanCamera, times: NDArray[np.float32], target: tuple[int, int], pose: Pose, rng: np.random.Generator
) -> bool:
    """Returns whether a leg has ended: it was reached, or its end came into view and the robot turns away early."""
    reached = float(times[_at(camera.plan, pose)]) < REACHED_S
    return reached or (bool(camera.seen_floor[target]) and rng.random() < 0.3)


def _leg(
    camera: PlanCamera,
    everywhere: Bool[np.ndarray, "rows cols"],
    pose: Pose,
    rng: np.random.Generator,
    unseen_share: float,
) -> tuple[tuple[int, int], NDArray[np.float32]]:
    """Returns the end of the next leg, a cell, and the travel times to it."""
    unseen = everywhere & ~camera.seen_floor
    eligible = unseen if rng.random() < unseen_share and np.count_nonzero(unseen) > 100 else everywhere
    cell = _any_cell(eligible, rng)
    return cell, _times_to(camera.plan, _only(everywhere, cell), everywhere, pose)


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
