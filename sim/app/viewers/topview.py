"""Draws the true floor plan with the goal, the shortest path to it and the path that the robot has driven."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.viewers.viewer import Colour
from sim.env.objectnav import ObjectNavEnv
from sim.task.ground_truth import Target
from sim.world.freespace import FreeSpace
from sim.world.storeys import LEVEL_M

BLOCKED: Colour = (226, 214, 196)
OUTSIDE: Colour = (240, 240, 238)
OBSTACLE: Colour = (62, 66, 77)
FREE: Colour = (252, 252, 250)
SUCCEEDS: Colour = (205, 236, 196)
INSTANCE: Colour = (56, 158, 80)
PATH: Colour = (32, 84, 190)
SHORTEST: Colour = (146, 64, 176)
STOPPED: Colour = (204, 45, 37)
ROBOT: Colour = (20, 20, 20)
_MARGIN_M = 0.2


class TopView:
    """A `MapPainter` of the storey that the robot stands on, from above.

    Colours that are also in the legend of the agent's map (`stubborn.drawing.map_painter`) have the same meaning there.

    Args:
        env: the environment of the episodes.
        heading_up: whether the heading of the start points up, as in the map of an agent; otherwise x points to the
            right and y up.
    """

    legend = (
        ("goal", INSTANCE),
        ("a STOP counts", SUCCEEDS),
        ("shortest path", SHORTEST),
        ("driven path", PATH),
        ("collision", STOPPED),
        ("obstacle", OBSTACLE),
        ("too narrow", BLOCKED),
    )

    def __init__(self, env: ObjectNavEnv, *, heading_up: bool = False) -> None:
        self._env, self._heading_up = env, heading_up
        self._key: tuple[object, ...] = ()
        self._ground = np.zeros((1, 1, 3), np.uint8)
        self._to_px = np.zeros((2, 3))
        """Affine transformation from metres to pixels."""

    def words(self) -> str:
        """Returns "": the agent's intention is not known."""
        return ""

    def paint(self, size_px: int) -> NDArray[np.uint8]:
        """Returns an RGB image (size_px, size_px, 3) with the whole storey in the middle, as large as fits."""
        return self.draw(size_px, size_px)

    def draw(self, width_px: int, height_px: int) -> NDArray[np.uint8]:
        """Returns an RGB image (height_px, width_px, 3) with the whole storey in the middle, as large as fits."""
        scene = self._env.scene
        world, task = scene.world, scene.task
        pose = world.pose
        key = (scene, task.goal, task.start, pose.floor_z_m, width_px, height_px)
        if key != self._key:
            self._key, self._ground = key, self._paint_ground(task.goal, pose.floor_z_m, (width_px, height_px))
        image = self._ground.copy()
        trajectory = task.trajectory()
        path = self.pixels(trajectory.positions_m)
        cv2.polylines(image, [path.reshape(-1, 1, 2)], False, PATH, 2, cv2.LINE_AA)
        for u, v in self.pixels(trajectory.contacts[:, 1:]).tolist():
            cv2.circle(image, (u, v), 3, STOPPED, -1, cv2.LINE_AA)
        here_m = np.array([pose.x_m, pose.y_m])
        radius_px = max(6, round(world.robot.radius_m * self._scale))
        turned = pose.yaw_rad + np.array([0.0, 2.5, math.pi, -2.5])
        long_m = np.array([1.9, 1.25, 0.6, 1.25]) * radius_px / self._scale
        corners_m = here_m + long_m[:, None] * np.stack([np.cos(turned), np.sin(turned)], axis=1)
        pointer = self.pixels(corners_m)
        cv2.fillPoly(image, [pointer], ROBOT, cv2.LINE_AA)
        cv2.polylines(image, [pointer], True, (255, 255, 255), 1, cv2.LINE_AA)
        return image

    @property
    def _scale(self) -> float:
        """Number of pixels per metre."""
        return float(np.hypot(*self._to_px[:, 0]))

    def _paint_ground(self, goal: str, floor_z_m: float, size_px: tuple[int, int]) -> NDArray[np.uint8]:
        """Returns the picture without the robot, and stores the transformation from metres to pixels."""
        task = self._env.scene.task
        truth, start = task.truth, task.start
        space, target = truth.space(floor_z_m), truth.target(goal, floor_z_m)
        turn_rad = 0.5 * math.pi - start.yaw_rad if self._heading_up else 0.0
        self._to_px = _fitted(whole_storey_m(space, target), turn_rad, size_px)
        cells = np.where(space.free[..., None], np.array(FREE), np.array(BLOCKED)).astype(np.uint8)
        cells[~space.free & ~_near_free(space)] = OUTSIDE
        cells[target.reached] = SUCCEEDS
        image = cv2.warpAffine(
            cells, self._from_cells(space), size_px, flags=cv2.INTER_NEAREST, borderValue=OUTSIDE
        ).astype(np.uint8)
        for obstacle in space.obstacles:
            cv2.fillConvexPoly(image, self.pixels(obstacle.vertices_m), OBSTACLE, cv2.LINE_AA)
        for footprint in target.region.footprints:
            for piece in footprint.parts:
                cv2.fillConvexPoly(image, self.pixels(piece.vertices_m), INSTANCE, cv2.LINE_AA)
        if abs(start.floor_z_m - floor_z_m) < LEVEL_M:
            path_m = space.path(target.distance_m, start.x_m, start.y_m)
            path_px = self.pixels(np.array([[start.x_m, start.y_m]]) if path_m is None else path_m)
            cv2.polylines(image, [path_px.reshape(-1, 1, 2)], False, SHORTEST, 2, cv2.LINE_AA)
            cv2.circle(image, path_px[0].tolist(), 4, SHORTEST, cv2.FILLED, cv2.LINE_AA)
        return image

    def _from_cells(self, space: FreeSpace) -> NDArray[np.float64]:
        """Returns the affine transformation (2, 3) from column and row of a cell to pixels."""
        cell_m, middle_m = space.frame.cell_m, np.asarray(space.frame.origin_xy_m) + 0.5 * space.frame.cell_m
        return np.column_stack([self._to_px[:, :2] * cell_m, self._to_px[:, :2] @ middle_m + self._to_px[:, 2]])

    def pixels(self, points_m: NDArray[np.floating]) -> NDArray[np.int32]:
        """Returns column and row (n, 2) of points (n, 2) in the world, in the picture that was drawn last."""
        return (np.asarray(points_m, np.float64) @ self._to_px[:, :2].T + self._to_px[:, 2]).round().astype(np.int32)


def whole_storey_m(space: FreeSpace, target: Target) -> NDArray[np.float64]:
    """Returns the convex hull (n, 2), in metres, of free space, obstacles and goals on a storey."""
    frame = space.frame
    free = frame.to_metres(np.argwhere(space.free))
    pieces = [piece for footprint in target.region.footprints for piece in footprint.parts]
    low = np.array(frame.origin_xy_m)
    high = low + np.array(frame.shape)[::-1] * frame.cell_m
    vertices = np.vstack([free, *(shape.vertices_m for shape in (*space.obstacles, *pieces))])
    vertices = np.clip(vertices, low, high) if len(vertices) else np.stack([low, high])  # a terrain may be huge
    return cv2.convexHull(vertices.astype(np.float32)).reshape(-1, 2).astype(np.float64)


def _near_free(space: FreeSpace) -> NDArray[np.bool_]:
    """Returns a mask (rows, cols) of the cells that the robot can cover while its centre is in free space."""
    reach = math.ceil(space.radius_m / space.frame.cell_m) + 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    return cv2.dilate(space.free.astype(np.uint8), kernel).astype(np.bool_)


def _fitted(points_m: NDArray[np.float64], turn_rad: float, size_px: tuple[int, int]) -> NDArray[np.float64]:
    """Returns the affine transformation (2, 3) from metres to pixels that turns points (n, 2) and fits them."""
    c, s = math.cos(turn_rad), math.sin(turn_rad)
    turned = points_m @ np.array([[c, s], [-s, c]])
    low, high = turned.min(axis=0) - _MARGIN_M, turned.max(axis=0) + _MARGIN_M
    scale = float(np.min(np.array(size_px) / (high - low)))
    linear = scale * np.array([[c, -s], [-s, -c]])
    middle = scale * 0.5 * (low + high) * (1.0, -1.0)
    return np.column_stack([linear, 0.5 * np.array(size_px) - middle])
