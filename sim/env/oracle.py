"""The agent that knows everything: follows the true shortest path with the same four actions and the same body.

It says what is possible: an oracle that fails means that the task, the free space or the robot is wrong. A plan is
found by weighted A* over steps of "turn, then go 0.25 m" on the 12 headings, the geodesic distance as heuristic. It
is made again when the robot is not where the plan has it; a step that was blocked is not tried again.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections import deque
from collections.abc import Iterator
from typing import Protocol

import cv2
import numpy as np

from sim.interface import FORWARD_M, TURN_RAD, Action, Observation
from sim.task.objectnav import Stage
from sim.world.freespace import CELL_M

HEADINGS = round(math.tau / TURN_RAD)
GREED = 1.5
"""Weight of the heuristic: a little longer than the best plan, found many times sooner."""
TURN_COST_M = 0.02
"""What a turn costs in metres of way."""
MARGIN_M = 0.05
"""Room beside the disc below which a step costs more ..."""
TIGHT_COST_M = 0.25
"""... by this much."""
NODE_M = 0.05
"""How near two places are that a plan does not tell apart."""
DRIFT_M = 0.03
"""A plan is made again when the robot is farther than this from where the plan has it."""
MAX_EXPANSIONS = 30_000

Node = tuple[float, float, int]
"""x, y and heading, in turns from the start's."""
Key = tuple[int, int, int]
"""Nodes within 5 cm and with one heading count as one."""


class HasStage(Protocol):
    """The environment, as far as the oracle looks into it."""

    @property
    def scene(self) -> Stage:
        """World and task of the running episode."""
        ...


class Oracle:
    """An `Agent` that reads the truth from the environment it acts in, and ignores its observations."""

    def __init__(self, env: HasStage) -> None:
        self._env = env

    def reset(self, goal: str, seed: int) -> None:
        """Start a new episode: chart where to go."""
        task = self._env.scene.task
        floor_z_m = task.start.floor_z_m
        space, target = task.truth.space(floor_z_m), task.truth.target(goal, floor_z_m)
        self._frame, self._region, self._distance_m = space.frame, target.region, target.distance_m
        self._room_m = cv2.distanceTransform(space.free.astype(np.uint8), cv2.DIST_L2, 5) * CELL_M  # 0: not free
        inner = cv2.erode(target.reached.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(np.bool_)
        self._goal_cells = inner if inner.any() else target.reached
        yaws = task.start.yaw_rad + np.arange(HEADINGS) * TURN_RAD
        along = np.linspace(CELL_M, FORWARD_M, round(FORWARD_M / CELL_M))
        self._swept_m = along[None, :, None] * np.stack([np.cos(yaws), np.sin(yaws)], axis=1)[:, None, :]
        self._plan: deque[tuple[Action, Node]] = deque()
        self._expected: Node | None = None
        self._blocked: set[Key] = set()

    def act(self, observation: Observation) -> Action:
        """The next action of the plan; STOP as soon as it would succeed."""
        del observation
        here = self._here()
        if self._region.succeeds(*here[:2]):
            return Action.STOP
        if self._expected is not None and not _same(here, self._expected):
            self._blocked.add(_key(here))
            self._plan.clear()
        if not self._plan:
            self._plan.extend(self._search(here))
        if not self._plan:
            return Action.TURN_LEFT
        action, self._expected = self._plan.popleft()
        return action

    def _here(self) -> Node:
        pose = self._env.scene.world.pose
        turned = (pose.yaw_rad - self._env.scene.task.start.yaw_rad) / TURN_RAD
        return pose.x_m, pose.y_m, round(turned) % HEADINGS

    def _search(self, begin: Node) -> list[tuple[Action, Node]]:
        """Actions, and where each leads, to a place that counts; to the nearest that can be reached if none does."""
        came: dict[Key, Node] = {}
        cost = {_key(begin): 0.0}
        tie = itertools.count()
        queue: list[tuple[float, int, Node]] = [(0.0, next(tie), begin)]
        done: set[Key] = set()
        end, nearest_m = begin, math.inf
        while queue and len(done) < MAX_EXPANSIONS:
            node = heapq.heappop(queue)[2]
            if _key(node) in done:
                continue
            done.add(_key(node))
            if self._goal_cells[tuple(self._frame.to_cells(node[:2]))]:
                end = node
                break
            for step_m, after, left_m in self._steps(node):
                total_m = cost[_key(node)] + step_m
                if _key(after) in done or total_m >= cost.get(_key(after), math.inf):
                    continue
                cost[_key(after)], came[_key(after)] = total_m, node
                heapq.heappush(queue, (total_m + GREED * left_m, next(tie), after))
                if left_m < nearest_m:
                    end, nearest_m = after, left_m
        nodes = [end]
        while nodes[-1] != begin:
            nodes.append(came[_key(nodes[-1])])
        return [action for node, after in itertools.pairwise(nodes[::-1]) for action in _actions(node, after)]

    def _steps(self, node: Node) -> Iterator[tuple[float, Node, float]]:
        """Cost, end and distance left of each way to turn and then go from a node."""
        x, y, heading = node
        cells = self._frame.to_cells(self._swept_m + np.array([x, y]))  # (headings, samples, 2)
        inside = self._frame.inside(cells).all(axis=1)
        row, col = np.clip(cells, 0, np.array(self._frame.shape) - 1).transpose(2, 0, 1)
        room_m = self._room_m[row, col].min(axis=1)
        left_m = self._distance_m[row[:, -1], col[:, -1]]
        for k in np.flatnonzero(inside & (room_m > 0.0) & np.isfinite(left_m)).tolist():
            if _key((x, y, k)) in self._blocked:
                continue
            step_m = FORWARD_M + TURN_COST_M * abs(_turns(heading, k)) + TIGHT_COST_M * (room_m[k] < MARGIN_M)
            dx, dy = self._swept_m[k, -1]
            yield step_m, (x + dx, y + dy, k), float(left_m[k])


def _key(node: Node) -> Key:
    return round(node[0] / NODE_M), round(node[1] / NODE_M), node[2]


def _turns(heading: int, to: int) -> int:
    """Left turns from one heading to another; negative: right."""
    return (to - heading + HEADINGS // 2) % HEADINGS - HEADINGS // 2


def _same(here: Node, expected: Node) -> bool:
    return here[2] == expected[2] and math.hypot(here[0] - expected[0], here[1] - expected[1]) <= DRIFT_M


def _actions(node: Node, after: Node) -> Iterator[tuple[Action, Node]]:
    """The turns and the forward that lead from a node to the next, and where each leads."""
    turns = _turns(node[2], after[2])
    turn, sign = (Action.TURN_LEFT, 1) if turns > 0 else (Action.TURN_RIGHT, -1)
    for i in range(1, abs(turns) + 1):
        yield turn, (node[0], node[1], (node[2] + sign * i) % HEADINGS)
    yield Action.MOVE_FORWARD, after
