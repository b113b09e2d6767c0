"""Draws the true floor plan with the goal, the shortest path to it and the path that the robot has driven."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.env.objectnav import ObjectNavEnv
from sim.task.ground_truth import Target
from sim.viewers.viewer import Colour
from sim.world.freespace import FreeSpace
from sim.world.storeys import LEVEL_M

BLOCKED: Colour = (214, 214, 214)
OBSTACLE: Colour = (120, 124, 132)
FREE: Colour = (252, 252, 250)
SUCCEEDS: Colour = (205, 236, 196)
INSTANCE: Colour = (56, 158, 80)
PATH: Colour = (32, 84, 190)
SHORTEST: Colour = (240, 140, 20)
STOPPED: Colour = (204, 65, 37)
ROBOT: Colour = (20, 20, 20)
WHOLE_HOUSE_M = 14.0
"""A storey of at most this width and depth is shown whole, of a larger one where the robot can drive, and the goals."""
_MARGIN_CELLS = 8
_STEP_CELLS = np.array([[math.sqrt(2), 1, math.sqrt(2)], [1, np.inf, 1], [math.sqrt(2), 1, math.sqrt(2)]])
"""Length of a step to each neighbour of a cell; infinite for the cell itself."""


class TopView:
    """A `MapPainter` of the storey that the robot stands on, from above, with x to the right and y up."""

    legend = (
        ("goal", INSTANCE),
        ("a STOP counts", SUCCEEDS),
        ("shortest path", SHORTEST),
        ("driven path", PATH),
        ("collision", STOPPED),
        ("obstacle", OBSTACLE),
        ("too narrow", BLOCKED),
    )

    def __init__(self, env: ObjectNavEnv) -> None:
        self._env = env
        self._key: tuple[object, ...] = ()
        self._ground = np.zeros((1, 1, 3), np.uint8)

    def words(self) -> str:
        """Returns "": the agent's intention is not known."""
        return ""

    def paint(self, size_px: int) -> NDArray[np.uint8]:
        """Returns an RGB image (size_px, size_px, 3) with the house in the middle, as large as fits.

        Of a house larger than `WHOLE_HOUSE_M` it shows the part where the robot can drive, and the goal.
        """
        scene = self._env.scene
        world, task = scene.world, scene.task
        pose = world.pose
        key = (scene, task.goal, task.start, pose.floor_z_m, size_px)
        if key != self._key:
            self._key, self._ground = key, self._paint_ground(task.goal, pose.floor_z_m, size_px)
        image = self._ground.copy()
        trajectory = task.trajectory()
        path = self._pixels(trajectory.positions_m)
        cv2.polylines(image, [path.reshape(-1, 1, 2)], False, PATH, 2, cv2.LINE_AA)
        for u, v in self._pixels(trajectory.contacts[:, 1:]).tolist():
            cv2.circle(image, (u, v), 3, STOPPED, -1, cv2.LINE_AA)
        here_m = np.array([pose.x_m, pose.y_m])
        radius_px = max(6, round(world.robot.radius_m * self._scale))
        turned = pose.yaw_rad + np.array([0.0, 2.5, math.pi, -2.5])
        long_m = np.array([1.9, 1.25, 0.6, 1.25]) * radius_px / self._scale
        corners_m = here_m + long_m[:, None] * np.stack([np.cos(turned), np.sin(turned)], axis=1)
        pointer = self._pixels(corners_m)
        cv2.fillPoly(image, [pointer], ROBOT, cv2.LINE_AA)
        cv2.polylines(image, [pointer], True, (255, 255, 255), 1, cv2.LINE_AA)
        return image

    def _paint_ground(self, goal: str, floor_z_m: float, size_px: int) -> NDArray[np.uint8]:
        """Returns the picture without the robot, and stores its scale and offset."""
        truth = self._env.scene.task.truth
        space, target = truth.space(floor_z_m), truth.target(goal, floor_z_m)
        cells = np.where(space.free[..., None], np.array(FREE), np.array(BLOCKED)).astype(np.uint8)
        cells[target.reached] = SUCCEEDS
        rows, cols = shown_cells(space, target)
        row, col, part = rows.start, cols.start, cells[rows, cols]
        px_cell = size_px / max(part.shape[:2])
        width, height = min(round(part.shape[1] * px_cell), size_px), min(round(part.shape[0] * px_cell), size_px)
        self._scale = px_cell / space.frame.cell_m
        self._corner_m = np.asarray(space.frame.origin_xy_m) + np.array([col, row]) * space.frame.cell_m
        self._offset_px = np.array([(size_px - width) // 2, (size_px + height) // 2])
        image = np.full((size_px, size_px, 3), BLOCKED, np.uint8)
        top, left = (size_px - height) // 2, (size_px - width) // 2
        enlarged = cv2.resize(part[::-1], (width, height), interpolation=cv2.INTER_NEAREST)
        image[top : top + height, left : left + width] = enlarged
        for obstacle in space.obstacles:
            cv2.fillConvexPoly(image, self._pixels(obstacle.vertices_m), OBSTACLE, cv2.LINE_AA)
        for footprint in target.region.footprints:
            for piece in footprint.parts:
                cv2.fillConvexPoly(image, self._pixels(piece.vertices_m), INSTANCE, cv2.LINE_AA)
        start = self._env.scene.task.start
        if abs(start.floor_z_m - floor_z_m) < LEVEL_M:
            way = self._pixels(shortest_path_m(space, target, (start.x_m, start.y_m)))
            cv2.polylines(image, [way.reshape(-1, 1, 2)], False, SHORTEST, 2, cv2.LINE_AA)
            cv2.circle(image, way[0].tolist(), 4, SHORTEST, cv2.FILLED, cv2.LINE_AA)
        return image

    def _pixels(self, points_m: NDArray[np.floating]) -> NDArray[np.int32]:
        """Returns (n, 2) column and row of points (n, 2) in the world."""
        off = (np.asarray(points_m, np.float64) - self._corner_m) * self._scale * (1.0, -1.0)
        return (off + self._offset_px).round().astype(np.int32)


def shown_cells(space: FreeSpace, target: Target) -> tuple[slice, slice]:
    """Returns rows and columns of the part of a storey that the plan shows: all of it, or free space and goals."""
    if max(space.frame.shape) * space.frame.cell_m <= WHOLE_HOUSE_M:
        return slice(0, space.frame.shape[0]), slice(0, space.frame.shape[1])
    free = np.argwhere(space.free)
    pieces_m = [piece.vertices_m for footprint in target.region.footprints for piece in footprint.parts]
    goals = [space.frame.to_cells(vertices_m) for vertices_m in pieces_m]
    needed = np.vstack([free.min(axis=0), free.max(axis=0), *goals])
    low = np.maximum(needed.min(axis=0) - _MARGIN_CELLS, 0).tolist()
    high = np.minimum(needed.max(axis=0) + 1 + _MARGIN_CELLS, space.frame.shape).tolist()
    return slice(low[0], high[0]), slice(low[1], high[1])


def shortest_path_m(space: FreeSpace, target: Target, start_m: tuple[float, float]) -> NDArray[np.float64]:
    """Returns points (n, 2) of the shortest path from a position to where a STOP succeeds; one point without a path."""
    row, col = space.frame.to_cells(np.array(start_m)).tolist()
    inside = 0 <= row < space.frame.shape[0] and 0 <= col < space.frame.shape[1]
    if not inside or not np.isfinite(target.distance_m[row, col]):
        return np.array([start_m])
    cells = _descended(target.distance_m, row, col)
    x_m, y_m = space.frame.centres(cells[:, 0], cells[:, 1])
    return _pulled_taut(np.vstack([start_m, np.stack([x_m, y_m], axis=1)]), space)


def _descended(field_m: NDArray[np.float32], row: int, col: int) -> NDArray[np.int64]:
    """Returns the cells (n, 2) from one cell down a field of distances, always in the steepest of eight directions."""
    padded = np.pad(field_m, 1, constant_values=np.inf)
    cells = [(row, col)]
    while True:
        drop = (field_m[row, col] - padded[row : row + 3, col : col + 3]) / _STEP_CELLS
        down, right = np.unravel_index(int(np.argmax(drop)), (3, 3))
        if drop[down, right] <= 0.0:
            return np.array(cells)
        row, col = row + int(down) - 1, col + int(right) - 1
        cells.append((row, col))


def _pulled_taut(points_m: NDArray[np.float64], space: FreeSpace) -> NDArray[np.float64]:
    """Returns those points of a path that are needed, because the straight line past them leaves the free space."""
    kept, here = [0], 0
    while here < len(points_m) - 1:
        near, far = here + 1, len(points_m) - 1
        while near < far:  # the farthest point in a straight line, by halving
            middle = (near + far + 1) // 2
            near, far = (middle, far) if _is_free(space, points_m[here], points_m[middle]) else (near, middle - 1)
        kept.append(near)
        here = near
    return points_m[kept]


def _is_free(space: FreeSpace, begin_m: NDArray[np.float64], end_m: NDArray[np.float64]) -> bool:
    """Returns whether the robot can drive straight from one point to another."""
    samples = max(2, math.ceil(float(np.hypot(*(end_m - begin_m))) / space.frame.cell_m) * 2)
    along = np.linspace(0.0, 1.0, samples)[1:, None]  # the start itself may lie next to the free cells
    cells = space.frame.to_cells(begin_m + along * (end_m - begin_m))
    return bool(space.free[cells[:, 0], cells[:, 1]].all())
