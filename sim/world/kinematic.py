"""Motion of a disc over free space without physics: the two kinds of motion that Habitat has.

`try_step` slides along what it meets, `try_step_no_sliding` ends there; both move a disc over the free space of
`sim.world.freespace`, as Habitat's functions of these names move a point over a navigation mesh.
"""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.pose import Pose
from sim.core.interface import Action, wrap_angle
from sim.robot.config import DriveConfig
from sim.robot.contacts import Contact
from sim.robot.drive import Motion
from sim.robot.profile import Trapezoid
from sim.world.freespace import FreeSpace

STEP_M = 0.005
"""Length of the pieces in which a motion is tried."""
SMOOTH_CELLS = 2.0
"""Standard deviation of the filter that takes the steps of cells out of the outline's direction."""
BLOCKED_M = 1e-5
"""A motion that is shorter than commanded by more than this was blocked, as Habitat counts collisions."""


class Glide:
    """Moves a disc over the free space of a storey."""

    def __init__(self, space: FreeSpace) -> None:
        self._frame = space.frame
        free = space.free.astype(np.uint8)
        inside = cv2.distanceTransform(free, cv2.DIST_L2, 5)
        outside = cv2.distanceTransform(1 - free, cv2.DIST_L2, 5)
        self._depth: NDArray[np.float32] = np.where(free, inside - 0.5, 0.5 - outside).astype(np.float32)  # in cells
        smooth = cv2.GaussianBlur(self._depth, (0, 0), SMOOTH_CELLS)
        self._uphill = np.stack(np.gradient(smooth)[::-1], axis=-1)  # (rows, cols, 2): x and y, away from obstacles
        self._outward_m = [share * space.frame.cell_m for share in (0.0, 0.25, 0.5, 0.75, 1.0)]

    def try_step(
        self, start_xy_m: tuple[float, float], end_xy_m: tuple[float, float], *, sliding: bool
    ) -> tuple[float, float]:
        """Returns where a straight motion ends: at its end, or where an obstacle ends it.

        With `sliding` the part of the motion along the obstacle goes on, as in Habitat with `allow_sliding`.
        """
        x, y = start_xy_m
        pieces = max(1, math.ceil(math.dist(start_xy_m, end_xy_m) / STEP_M))
        dx, dy = (end_xy_m[0] - x) / pieces, (end_xy_m[1] - y) / pieces
        for _ in range(pieces):
            if self._is_allowed(x, y, x + dx, y + dy):
                x, y = x + dx, y + dy
                continue
            if not sliding:
                break
            beside = self._beside(x, y, dx, dy)
            if beside is None:
                break
            x, y = beside
        return x, y

    def _beside(self, x: float, y: float, dx: float, dy: float) -> tuple[float, float] | None:
        """Returns where a blocked piece of a motion ends that slides along the obstacle; None: it is blocked there too.

        The outline of the free space has steps, since it consists of cells; the disc is moved around each.
        """
        nx, ny = self._away_from_obstacle(x, y)
        into = min(0.0, dx * nx + dy * ny)
        along_x, along_y = x + dx - into * nx, y + dy - into * ny
        for out_m in self._outward_m:
            end = along_x + out_m * nx, along_y + out_m * ny
            if self._is_allowed(x, y, *end):
                return end
        return None

    def _is_allowed(self, x0_m: float, y0_m: float, x1_m: float, y1_m: float) -> bool:
        """Returns whether a piece ends on a free cell, or leads out of an obstacle in which it began."""
        before, after = self._depth_at(x0_m, y0_m), self._depth_at(x1_m, y1_m)
        return after > 0.0 or (before <= 0.0 and after > before)

    def _depth_at(self, x_m: float, y_m: float) -> float:
        row, col = self._frame.cell(x_m, y_m)
        rows, cols = self._depth.shape
        return float(self._depth[row, col]) if 0 <= row < rows and 0 <= col < cols else -math.inf

    def _away_from_obstacle(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Returns the unit normal of the obstacle's outline nearest to a place, away from the obstacle."""
        row, col = self._frame.cell(x_m, y_m)
        rows, cols = self._depth.shape
        x, y = self._uphill[min(max(row, 0), rows - 1), min(max(col, 0), cols - 1)].tolist()
        size = math.hypot(x, y)
        return (x / size, y / size) if size > 1e-9 else (0.0, 0.0)


def performed(glide: Glide, pose: Pose, action: Action, drive: DriveConfig, *, sliding: bool) -> tuple[Pose, Motion]:
    """Returns the pose after an action without physics, and the action as it was carried out.

    Args:
        glide: of the storey of the robot.
        pose: of the robot.
        action: turns are exact.
        drive: lengths of the actions, and speeds, which give the durations that physics would take.
        sliding: whether a blocked motion slides.
    """
    if action == Action.MOVE_FORWARD:
        aim = pose.ahead(drive.forward_m)
        x_m, y_m = glide.try_step(pose.xy_m, aim, sliding=sliding)
        moved_m = math.dist(pose.xy_m, (x_m, y_m))
        blocked = moved_m + BLOCKED_M < drive.forward_m
        time_s = Trapezoid(moved_m, drive.speed_m_s, drive.acceleration_m_s2).duration_s
        place = (x_m, y_m, float(pose.floor_z_m))
        contacts = (Contact("", "", place, (0.0, 0.0, 0.0), 0.0, stopped=True),) if blocked else ()
        ended = "blocked" if blocked else "reached"
        return Pose(x_m, y_m, pose.yaw_rad, pose.floor_z_m), Motion(action, moved_m, 0.0, time_s, ended, contacts)
    turn_rad = {Action.STOP: 0.0, Action.TURN_LEFT: drive.turn_rad, Action.TURN_RIGHT: -drive.turn_rad}[action]
    time_s = Trapezoid(abs(turn_rad), drive.turn_speed_rad_s, drive.turn_acceleration_rad_s2).duration_s
    after = Pose(pose.x_m, pose.y_m, wrap_angle(pose.yaw_rad + turn_rad), pose.floor_z_m)
    return after, Motion(action, 0.0, turn_rad, time_s, "reached", ())
