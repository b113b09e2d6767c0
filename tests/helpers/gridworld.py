"""A kinematic world of boxes with an exact depth camera, for fast tests of agents without physics.

Boxes stand on the floor or hang over it; the robot is a disc that moves by centimetres until it would touch a box.
Depth and semantic images are ray casts, exact to float precision: depth is the distance along the optical axis.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import (
    FORWARD_M,
    GOAL_CATEGORIES,
    MPCAT40_ID,
    TURN_RAD,
    Action,
    Agent,
    CameraModel,
    RobotModel,
    wrap_angle,
)

FLOOR_ID = MPCAT40_ID["floor"]
SMALL_CAMERA = CameraModel(width_px=160, height_px=120)


@dataclass(frozen=True)
class Box:
    """An axis-aligned box, metres."""

    x: tuple[float, float]
    y: tuple[float, float]
    z: tuple[float, float] = (0.0, 2.5)
    category: str = "wall"
    seen: bool = True
    """False: glass; it blocks, but the camera does not see it."""


LEGEND: Mapping[str, Box] = {
    "#": Box((0, 0), (0, 0), (0.0, 2.5), "wall"),
    "b": Box((0, 0), (0, 0), (0.0, 0.55), "bed"),
    "t": Box((0, 0), (0, 0), (0.0, 0.75), "table"),
    "c": Box((0, 0), (0, 0), (0.0, 0.45), "chair"),
    "u": Box((0, 0), (0, 0), (0.0, 0.15), "cushion"),
    "k": Box((0, 0), (0, 0), (0.0, 1.8), "cabinet"),
    "p": Box((0, 0), (0, 0), (1.3, 1.7), "picture"),
    "g": Box((0, 0), (0, 0), (0.0, 1.0), "objects", seen=False),
}
"""The meaning of each letter of a plan; x and y come from its place."""


def boxes_from_plan(plan: str, cell_m: float) -> list[Box]:
    """Returns the boxes of an ASCII plan, one for each run of equal letters in a line.

    The top line has the largest y, the first letter x = 0.
    """
    lines = [line for line in plan.strip("\n").splitlines()]
    boxes = []
    for i, line in enumerate(lines):
        y0 = (len(lines) - 1 - i) * cell_m
        start = 0
        while start < len(line):
            end = start
            while end < len(line) and line[end] == line[start]:
                end += 1
            if line[start] in LEGEND:
                kind = LEGEND[line[start]]
                boxes.append(Box((start * cell_m, end * cell_m), (y0, y0 + cell_m), kind.z, kind.category, kind.seen))
            start = end
    return boxes


class GridWorld:
    """Boxes, a robot and a camera; the observations are those of the interface, with the start pose as origin."""

    def __init__(
        self,
        boxes: list[Box],
        start: tuple[float, float, float],
        *,
        camera: CameraModel = SMALL_CAMERA,
        robot: RobotModel = RobotModel(),  # noqa: B008 - frozen
    ) -> None:
        self.boxes, self.camera, self.robot, self.start = boxes, camera, robot, start
        self.x, self.y, self.yaw = start
        u = np.arange(camera.width_px)
        v = np.arange(camera.height_px)
        self._left = (0.5 * camera.width_px - (u + 0.5)) / camera.focal_px
        self._up = (0.5 * camera.height_px - (v + 0.5)) / camera.focal_px
        self.collisions = 0

    def step(self, action: Action) -> None:
        if action is Action.MOVE_FORWARD:
            for _ in range(round(FORWARD_M / 0.01)):
                x, y = self.x + 0.01 * math.cos(self.yaw), self.y + 0.01 * math.sin(self.yaw)
                if self.touches(x, y):
                    self.collisions += 1
                    break
                self.x, self.y = x, y
        elif action is not Action.STOP:
            self.yaw = wrap_angle(self.yaw + (TURN_RAD if action is Action.TURN_LEFT else -TURN_RAD))

    def touches(self, x: float, y: float) -> bool:
        for box in self.boxes:
            if box.z[0] < self.robot.height_m and box.z[1] > 0.03:
                gap_x = max(box.x[0] - x, x - box.x[1], 0.0)
                gap_y = max(box.y[0] - y, y - box.y[1], 0.0)
                if math.hypot(gap_x, gap_y) < self.robot.radius_m:
                    return True
        return False

    def observe(self, goal: str = "chair") -> dict[str, NDArray]:
        depth, semantic = self.render()
        x0, y0, yaw0 = self.start
        dx, dy = self.x - x0, self.y - y0
        cos, sin = math.cos(yaw0), math.sin(yaw0)
        return {
            "depth": depth,
            "semantic": semantic,
            "gps": np.array([cos * dx + sin * dy, -sin * dx + cos * dy], np.float32),
            "compass": np.array([wrap_angle(self.yaw - yaw0)], np.float32),
            "objectgoal": np.array([GOAL_CATEGORIES.index(goal)], np.int64),
        }

    def render(self) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        """Returns depth as in `sim.core.interface` (0 near, maximum far) and mpcat40 ids."""
        camera = self.camera
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        ray_x, ray_y = cos - sin * self._left, sin + cos * self._left  # per metre of depth
        depth = np.full((camera.height_px, camera.width_px), np.inf)
        semantic = np.zeros(depth.shape, np.uint8)
        with np.errstate(divide="ignore"):
            floor = np.where(self._up < 0, camera.height_m / -self._up, np.inf)
        depth[:] = floor[:, None]
        semantic[np.isfinite(depth)] = FLOOR_ID
        for box in self.boxes:
            if box.seen:
                self._cast(box, ray_x, ray_y, depth, semantic)
        depth[depth < camera.min_depth_m] = 0.0
        return np.minimum(depth, camera.max_depth_m).astype(np.float32), semantic

    def _cast(self, box: Box, ray_x: NDArray, ray_y: NDArray, depth: NDArray, semantic: NDArray) -> None:
        with np.errstate(divide="ignore", invalid="ignore"):
            tx = np.sort(np.stack([(e - self.x) / ray_x for e in box.x]), axis=0)
            ty = np.sort(np.stack([(e - self.y) / ray_y for e in box.y]), axis=0)
        enter, leave = np.maximum(np.maximum(tx[0], ty[0]), 1e-6), np.minimum(tx[1], ty[1])
        cols = np.flatnonzero(enter < leave)
        if cols.size == 0:
            return
        enter, leave = enter[cols][None, :], leave[cols][None, :]
        up, h = self._up[:, None], self.camera.height_m
        with np.errstate(divide="ignore", invalid="ignore"):
            z_a, z_b = (box.z[0] - h) / up, (box.z[1] - h) / up
        t = np.maximum(enter, np.minimum(z_a, z_b))
        hit = t <= np.minimum(leave, np.maximum(z_a, z_b))
        nearer = hit & (t < depth[:, cols])
        depth[:, cols] = np.where(nearer, t, depth[:, cols])
        semantic[:, cols] = np.where(nearer, MPCAT40_ID[box.category], semantic[:, cols])

    def distance_to(self, category: str) -> float:
        """Returns the distance in plan from the robot's centre to the nearest box of a category."""
        gaps = [
            math.hypot(max(b.x[0] - self.x, self.x - b.x[1], 0.0), max(b.y[0] - self.y, self.y - b.y[1], 0.0))
            for b in self.boxes
            if b.category == category
        ]
        return min(gaps, default=math.inf)


@dataclass
class Trace:
    """The actions, poses and outcome of one episode."""

    actions: list[Action]
    poses: list[tuple[float, float, float]]
    stopped: bool
    goal_distance_m: float
    collisions: int


def run_episode(world: GridWorld, agent: Agent, goal: str, *, seed: int = 0, max_steps: int = 500) -> Trace:
    """Runs an agent until it stops or has taken all steps."""
    agent.reset(goal, seed)
    trace = Trace([], [(world.x, world.y, world.yaw)], False, math.inf, 0)
    for _ in range(max_steps):
        action = agent.act(world.observe(goal))
        trace.actions.append(action)
        world.step(action)
        trace.poses.append((world.x, world.y, world.yaw))
        if action is Action.STOP:
            trace.stopped = True
            break
    trace.goal_distance_m, trace.collisions = world.distance_to(goal), world.collisions
    return trace
