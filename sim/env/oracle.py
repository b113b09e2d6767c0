"""Agents that follow the true shortest path with the same four actions and the same body.

The oracle heads for the goal of its episode. It is an upper bound: if it fails, the task, the free space or the robot
is wrong. A `Follower` heads for any destination, and is the oracle's way of driving. It finds its route by weighted A*
over steps of "turn, then drive ahead" on the headings of the robot (12 of them, and 0.25 m, by default), with the
geodesic distance as heuristic. It searches again if the robot is not where the route expects it; a step that was
blocked is not tried again. Where whole steps do not lead to the goal, as in a narrow gap between furniture, the route
also has steps that an obstacle ends.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.interface import Action, Observation
from sim.task.ground_truth import Target
from sim.task.objectnav import Task
from sim.world.freespace import CELL_M, FreeSpace
from sim.world.world import World

HEURISTIC_WEIGHT = 1.5
"""Weight of the heuristic: routes are slightly longer than the shortest one and are found many times faster."""
TURN_COST_M = 0.02
"""Cost of a turn, in metres of path."""
MARGIN_M = 0.05
"""A step that passes an obstacle with less clearance than this around the disc costs more."""
TIGHT_COST_M = 0.25
"""Additional cost of such a step, in metres of path."""
BLOCKED_COST_M = 0.5
"""Additional cost of a step that an obstacle ends."""
NODE_M = 0.05
"""Nodes with the same heading and the same multiples of this length in x and y are one node of a route."""
DRIFT_M = 0.03
"""The oracle searches a new route when the robot is farther than this from its position on the route."""
MAX_EXPANSIONS = 30_000

Node = tuple[float, float, int]
"""x and y in metres, and heading in turns from that of the start."""
Key = tuple[int, int, int]
"""x and y of a node in units of `NODE_M`, and its heading."""


class HasTask(Protocol):
    """The part of a `sim.env.scene.Scene` that the oracle reads."""

    @property
    def task(self) -> Task:
        """The running episode, with its world."""
        ...


class HasScene(Protocol):
    """The part of an `ObjectNavEnv` that the oracle reads."""

    @property
    def scene(self) -> HasTask:
        """The scene of the running episode."""
        ...


@dataclass(frozen=True, eq=False)
class Destination:
    """The places where a route may end."""

    space: FreeSpace
    """The free space of their storey."""
    cells: NDArray[np.bool_]
    """(rows, cols) the cells of these places."""
    distance_m: NDArray[np.float32]
    """(rows, cols) geodesic distance to the nearest of them; inf: no path."""
    reached: Callable[[float, float], bool]
    """Whether an exact position, x and y in metres, is one of them."""


class Oracle:
    """An `Agent` that reads the ground truth from its environment and ignores its observations."""

    def __init__(self, env: HasScene) -> None:
        self._env = env

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode; its goal is that of the task, because the text of a picture is ""."""
        del goal, seed
        task = self._env.scene.task
        self._start_yaw_rad, self._floor_z_m = task.start.yaw_rad, task.start.floor_z_m
        self.next_goal("")

    def next_goal(self, goal: str) -> None:
        """Heads for the next goal of a chain, which is that of the task too."""
        del goal
        task = self._env.scene.task
        self._goal = task.goal
        self._head_for(task, task.truth.target(self._goal, self._floor_z_m))

    def act(self, observation: Observation) -> Action:
        """Returns the next action of the route; STOP as soon as it succeeds."""
        del observation
        return self.choose()

    def choose(self) -> Action:
        """Returns the next action from where the robot is now."""
        action, task = self._follower.next_action(), self._env.scene.task
        pose = task.world.pose
        if action is Action.STOP and not task.truth.succeeds_now(self._goal, pose.x_m, pose.y_m, self._floor_z_m):
            # The robot pushed a door or an object.
            self._head_for(task, task.truth.target_now(self._goal, self._floor_z_m))
            action = self._follower.next_action()
        return Action.TURN_LEFT if action is None else action

    def _head_for(self, task: Task, target: Target) -> None:
        space = task.truth.space(self._floor_z_m)
        places = Destination(space, target.reached, target.distance_m, target.region.succeeds)
        self._follower = Follower(task.world, self._start_yaw_rad, places)


class Follower:
    """Follows the shortest path from where the robot is to a destination.

    Args:
        world: with the robot.
        start_yaw_rad: a heading of the robot, from which the others differ by whole turns.
        to: the destination.
    """

    def __init__(self, world: World, start_yaw_rad: float, to: Destination) -> None:
        self._world, self._start_yaw_rad = world, start_yaw_rad
        self._forward_m, self._turn_rad = world.config.drive.forward_m, world.config.drive.turn_rad
        self._headings = round(math.tau / self._turn_rad)
        self._reached = to.reached
        self._frame, self._distance_m = to.space.frame, to.distance_m
        free = to.space.free.astype(np.uint8)
        self._clearance_m = cv2.distanceTransform(free, cv2.DIST_L2, 5) * CELL_M  # 0: not free
        inner = cv2.erode(to.cells.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(np.bool_)
        self._goal_cells = inner if inner.any() else to.cells
        self._swept_m = np.zeros((self._headings, 0, 2))
        self._route: deque[tuple[Action, Node]] = deque()
        self._expected: Node | None = None
        self._blocked: set[Key] = set()

    def next_action(self) -> Action | None:
        """Returns the next action of the route; STOP at the destination, None where no step can lead to it."""
        here = self._here()
        if self._reached(*here[:2]):
            return Action.STOP
        if self._expected is not None and not _same(here, self._expected):
            self._blocked.add(_key(here))
            self._route.clear()
        if not self._route:
            actions, reached = self._search(here, whole=True)
            self._route.extend(actions if reached else self._search(here, whole=False)[0])
        if not self._route:
            return None
        action, self._expected = self._route.popleft()
        return action

    def _here(self) -> Node:
        pose = self._world.pose
        return pose.x_m, pose.y_m, round((pose.yaw_rad - self._start_yaw_rad) / self._turn_rad) % self._headings

    def _swept(self, heading: int) -> NDArray[np.float64]:
        """Returns the positions (headings, samples, 2) of a MOVE_FORWARD on each heading, relative to its start.

        The headings are turns away from the present one, since a gyro with an error makes turns of another angle.
        """
        yaws = self._world.pose.yaw_rad + (np.arange(self._headings) - heading) * self._turn_rad
        along = np.linspace(CELL_M, self._forward_m, round(self._forward_m / CELL_M))
        return along[None, :, None] * np.stack([np.cos(yaws), np.sin(yaws)], axis=1)[:, None, :]

    def _search(self, begin: Node, *, whole: bool) -> tuple[list[tuple[Action, Node]], bool]:
        """Returns the actions to a goal cell, or to the reachable node nearest to one, and whether it is a goal cell.

        Each action has its end node. With `whole`, obstacles end no step.
        """
        self._swept_m = self._swept(begin[2])
        came: dict[Key, Node] = {}
        cost = {_key(begin): 0.0}
        tie = itertools.count()
        queue: list[tuple[float, int, Node]] = [(0.0, next(tie), begin)]
        done: set[Key] = set()
        end, nearest_m, reached = begin, math.inf, False
        on_grid = bool(self._frame.inside(self._frame.to_cells([begin[:2]]))[0])  # all other nodes are
        while queue and len(done) < MAX_EXPANSIONS:
            node = heapq.heappop(queue)[2]
            if _key(node) in done:
                continue
            done.add(_key(node))
            if (on_grid or node is not begin) and self._goal_cells[tuple(self._frame.to_cells(node[:2]))]:
                end, reached = node, True
                break
            for step_m, after, left_m in self._steps(node, whole=whole):
                total_m = cost[_key(node)] + step_m
                if _key(after) in done or total_m >= cost.get(_key(after), math.inf):
                    continue
                cost[_key(after)], came[_key(after)] = total_m, node
                heapq.heappush(queue, (total_m + HEURISTIC_WEIGHT * left_m, next(tie), after))
                if left_m < nearest_m:
                    end, nearest_m = after, left_m
        nodes = [end]
        while nodes[-1] != begin:
            nodes.append(came[_key(nodes[-1])])
        steps = itertools.pairwise(nodes[::-1])
        return [action for node, after in steps for action in self._actions(node, after)], reached

    def _steps(self, node: Node, *, whole: bool) -> Iterator[tuple[float, Node, float]]:
        """Yields cost, end and remaining distance of each step from a node: a turn, then MOVE_FORWARD."""
        x, y, heading = node
        cells = self._frame.to_cells(self._swept_m + np.array([x, y]))  # (headings, samples, 2)
        row, col = np.clip(cells, 0, np.array(self._frame.shape) - 1).transpose(2, 0, 1)
        clearance_m = np.where(self._frame.inside(cells), self._clearance_m[row, col], 0.0)
        free = np.cumprod(clearance_m > 0.0, axis=1).sum(axis=1)  # samples before an obstacle
        samples = clearance_m.shape[1]
        for k in np.flatnonzero(free >= (samples if whole else 1)).tolist():
            last = free[k] - 1
            left_m = float(self._distance_m[row[k, last], col[k, last]])
            if not math.isfinite(left_m) or _key((x, y, k)) in self._blocked:
                continue
            step_m = self._forward_m + TURN_COST_M * abs(self._turns(heading, k))
            step_m += TIGHT_COST_M * (clearance_m[k, : last + 1].min() < MARGIN_M)
            step_m += BLOCKED_COST_M * (free[k] < samples)
            dx, dy = self._swept_m[k, last]
            yield step_m, (x + dx, y + dy, k), left_m

    def _turns(self, heading: int, to: int) -> int:
        """Returns the number of left turns from one heading to another; negative: right turns."""
        return (to - heading + self._headings // 2) % self._headings - self._headings // 2

    def _actions(self, node: Node, after: Node) -> Iterator[tuple[Action, Node]]:
        """Yields the turns and the MOVE_FORWARD from a node to the next, each with the node that it leads to."""
        turns = self._turns(node[2], after[2])
        turn, sign = (Action.TURN_LEFT, 1) if turns > 0 else (Action.TURN_RIGHT, -1)
        for i in range(1, abs(turns) + 1):
            yield turn, (node[0], node[1], (node[2] + sign * i) % self._headings)
        yield Action.MOVE_FORWARD, after


def _key(node: Node) -> Key:
    return round(node[0] / NODE_M), round(node[1] / NODE_M), node[2]


def _same(here: Node, expected: Node) -> bool:
    return here[2] == expected[2] and math.hypot(here[0] - expected[0], here[1] - expected[1]) <= DRIFT_M
