"""The floor area that the robot's camera has seen.

The floor of a storey is divided into square cells of `CELL_M`. A cell is seen when its centre projects into the image
at a depth within the camera's range, and the true segmentation of that pixel is floor. The floor is a plane at a known
height, so no depth image is needed: a pixel that is floor and in which the centre of a floor cell projects shows that
cell. A lower floor that is visible through a stairwell shows no cell, because the stairwell has no floor.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.convex import ConvexPolygon
from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import BodyPose, Pose, as_body_pose
from sim.core.interface import MPCAT40_ID, CameraModel
from sim.world.freespace import covered

CELL_M = 0.1
"""Edge of a cell of the floor."""
_SAME_FLOOR_M = 0.5
_TILTED_RAD = math.radians(10.0)
"""A body leans by less, and the floor that its camera then sees beyond the view of a level one is less than a cell."""
_FLOOR = MPCAT40_ID["floor"]


class SeenFloor:
    """The cells of the floor of one storey, and which of them the camera has seen.

    Args:
        frame: grid of the cells.
        floor: mask (rows, cols) of the cells that are floor.
        floor_z_m: height of the storey's floor; frames from another storey show nothing.
        camera: intrinsics, mount height and depth range.
    """

    def __init__(self, frame: GridFrame, floor: NDArray[np.bool_], floor_z_m: float, camera: CameraModel) -> None:
        self.frame = frame
        self._floor_z_m = floor_z_m
        self._camera = camera
        self.cells = np.zeros_like(floor)  # (rows, cols) True: seen
        self._waiting = floor.copy()  # (rows, cols) True: floor that was not seen yet
        self._count = 0
        self._side = math.tan(0.5 * camera.hfov_rad)
        self._rise = math.tan(0.5 * camera.vfov_rad)

    @property
    def area_m2(self) -> float:
        """The area of the cells seen so far."""
        return self._count * self.frame.cell_m**2

    def look(self, semantic: NDArray[np.uint8], camera_pose: Pose) -> None:
        """Counts the cells that one frame of true segmentation (h, w) shows for the first time."""
        if abs(camera_pose.floor_z_m - self._floor_z_m) > _SAME_FLOOR_M:
            return
        body, camera = as_body_pose(camera_pose), self._camera
        eye_m = body.point(0.0, 0.0, camera.height_m)
        window = self.frame.index_of(self._bounds(eye_m, body))
        waiting = self._waiting[window]
        x, y = self.frame.axes(window)
        to_x_m, to_y_m, to_z_m = (x - eye_m[0])[None, :], (y - eye_m[1])[:, None], self._floor_z_m - eye_m[2]
        ahead, left, up = (axis[0] * to_x_m + axis[1] * to_y_m + axis[2] * to_z_m for axis in body.axes)
        inside = waiting & (ahead > camera.min_depth_m) & (ahead <= camera.max_depth_m)
        inside &= (np.abs(left) < self._side * ahead) & (np.abs(up) < self._rise * ahead)
        rows, cols = np.nonzero(inside)
        pixels = self._pixels(ahead[rows, cols], left[rows, cols], up[rows, cols], semantic.shape)
        shown = semantic[pixels] == _FLOOR
        waiting[rows[shown], cols[shown]] = False
        self.cells[window][rows[shown], cols[shown]] = True
        self._count += int(np.count_nonzero(shown))

    def _bounds(self, eye_m: NDArray[np.float64], body: BodyPose) -> tuple[float, float, float, float]:
        """Returns the smallest and largest x and y of the floor in the camera's range; a leaning one sees no farther
        than a level one by its height, but one that looks down sees the floor beside and behind its eye."""
        c, s, far_m = math.cos(body.yaw_rad), math.sin(body.yaw_rad), self._camera.max_depth_m + self._camera.height_m
        near_m = 0.0 if abs(body.pitch_rad) < _TILTED_RAD else -far_m
        corners = [(ahead, side * abs(ahead) * self._side) for ahead in (near_m, far_m) for side in (-1.0, 1.0)]
        x = [eye_m[0] + c * ahead - s * sideways for ahead, sideways in corners]
        y = [eye_m[1] + s * ahead + c * sideways for ahead, sideways in corners]
        return min(x), min(y), max(x), max(y)

    def _pixels(
        self,
        ahead_m: NDArray[np.float64],
        left_m: NDArray[np.float64],
        up_m: NDArray[np.float64],
        shape: tuple[int, ...],
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Returns the rows and columns of the pixels that show some points, in an image of any resolution."""
        height, width = shape
        focal_px = self._camera.focal_px * width / self._camera.width_px
        rows = (0.5 * height - focal_px * up_m / ahead_m).astype(np.intp)
        cols = (0.5 * width - focal_px * left_m / ahead_m).astype(np.intp)
        return np.minimum(rows, height - 1), np.minimum(cols, width - 1)


def floor_cells(frame: GridFrame, floors: Sequence[ConvexPolygon] | None) -> tuple[GridFrame, NDArray[np.bool_]]:
    """Returns a grid of `CELL_M` that covers another grid, and the mask (rows, cols) of its cells that are floor.

    Args:
        frame: covers the storey.
        floors: outlines of its floors; None: all of it is floor.
    """
    rows, cols = (math.ceil(size * frame.cell_m / CELL_M) for size in frame.shape)
    coarse = GridFrame(origin_xy_m=frame.origin_xy_m, shape=(rows, cols), cell_m=CELL_M)
    return coarse, np.ones(coarse.shape, dtype=np.bool_) if floors is None else covered(coarse, floors)
