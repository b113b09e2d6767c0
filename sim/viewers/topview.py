"""Draws the true floor plan with the robot's path: the map for agents that have none."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.env.objectnav import ObjectNavEnv
from sim.viewers.viewer import Colour

BLOCKED: Colour = (150, 150, 150)
FREE: Colour = (252, 252, 250)
SUCCEEDS: Colour = (205, 236, 196)
INSTANCE: Colour = (56, 158, 80)
PATH: Colour = (32, 84, 190)
STOPPED: Colour = (204, 65, 37)
ROBOT: Colour = (20, 20, 20)
_MARGIN_CELLS = 8


class TopView:
    """A `MapPainter` of the storey that the robot stands on, from above, with x to the right and y up."""

    legend = (
        ("free for the robot", FREE),
        ("blocked", BLOCKED),
        ("goal", INSTANCE),
        ("a stop counts here", SUCCEEDS),
        ("way so far", PATH),
        ("stopped by contact", STOPPED),
    )

    def __init__(self, env: ObjectNavEnv) -> None:
        self._env = env
        self._key: tuple[object, ...] = ()
        self._ground = np.zeros((1, 1, 3), np.uint8)

    def words(self) -> str:
        """Returns "": the agent's intention is not known."""
        return ""

    def paint(self, size_px: int) -> NDArray[np.uint8]:
        """Returns an RGB image (size_px, size_px, 3) with the house in the middle, as large as fits."""
        scene = self._env.scene
        world, task = scene.world, scene.task
        pose = world.pose
        key = (scene, task.goal, pose.floor_z_m, size_px)
        if key != self._key:
            self._key, self._ground = key, self._paint_ground(task.goal, pose.floor_z_m, size_px)
        image = self._ground.copy()
        trajectory = task.trajectory()
        path = self._pixels(trajectory.positions_m)
        cv2.polylines(image, [path.reshape(-1, 1, 2)], False, PATH, 2, cv2.LINE_AA)
        for u, v in self._pixels(trajectory.contacts[:, 1:]).tolist():
            cv2.circle(image, (u, v), 3, STOPPED, -1, cv2.LINE_AA)
        here_m = np.array([pose.x_m, pose.y_m])
        ahead_m = here_m + 0.36 * np.array([math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)])
        here, ahead = self._pixels(np.array([here_m, ahead_m])).tolist()
        radius_px = max(4, round(world.robot.radius_m * self._scale))
        cv2.circle(image, here, radius_px, (255, 255, 255), -1, cv2.LINE_AA)
        cv2.circle(image, here, radius_px, ROBOT, 2, cv2.LINE_AA)
        cv2.arrowedLine(image, here, ahead, ROBOT, 2, cv2.LINE_AA, tipLength=0.35)
        return image

    def _paint_ground(self, goal: str, floor_z_m: float, size_px: int) -> NDArray[np.uint8]:
        """Returns the picture without the robot, and stores its scale and offset."""
        truth = self._env.scene.task.truth
        space, target = truth.space(floor_z_m), truth.target(goal, floor_z_m)
        cells = np.where(space.free[..., None], np.array(FREE), np.array(BLOCKED)).astype(np.uint8)
        cells[target.reached] = SUCCEEDS
        rows, cols = (np.flatnonzero(space.free.any(axis=axis)) for axis in (1, 0))
        row, col = max(int(rows[0]) - _MARGIN_CELLS, 0), max(int(cols[0]) - _MARGIN_CELLS, 0)
        part = cells[row : int(rows[-1]) + 1 + _MARGIN_CELLS, col : int(cols[-1]) + 1 + _MARGIN_CELLS]
        px_cell = size_px / max(part.shape[:2])
        width, height = min(round(part.shape[1] * px_cell), size_px), min(round(part.shape[0] * px_cell), size_px)
        self._scale = px_cell / space.frame.cell_m
        self._corner_m = np.asarray(space.frame.origin_xy_m) + np.array([col, row]) * space.frame.cell_m
        self._offset_px = np.array([(size_px - width) // 2, (size_px + height) // 2])
        image = np.full((size_px, size_px, 3), BLOCKED, np.uint8)
        top, left = (size_px - height) // 2, (size_px - width) // 2
        enlarged = cv2.resize(part[::-1], (width, height), interpolation=cv2.INTER_NEAREST)
        image[top : top + height, left : left + width] = enlarged
        for footprint in target.region.footprints:
            for piece in footprint.parts:
                cv2.fillConvexPoly(image, self._pixels(piece.vertices_m), INSTANCE, cv2.LINE_AA)
        return image

    def _pixels(self, points_m: NDArray[np.floating]) -> NDArray[np.int32]:
        """Returns (n, 2) column and row of points (n, 2) in the world."""
        off = (np.asarray(points_m, np.float64) - self._corner_m) * self._scale * (1.0, -1.0)
        return (off + self._offset_px).round().astype(np.int32)
