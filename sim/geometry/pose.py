"""Poses of the robot on a floor, in the world and relative to where an episode started."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Pose:
    """Where the robot stands: its centre in plan, its heading and the height of the floor under it."""

    x_m: float
    y_m: float
    yaw_rad: float
    floor_z_m: float = 0.0

    def relative_to(self, start: Pose) -> Pose:
        """This pose in the start's frame: x forward, y left, yaw in (-pi, pi]."""
        dx, dy = self.x_m - start.x_m, self.y_m - start.y_m
        c, s = math.cos(start.yaw_rad), math.sin(start.yaw_rad)
        return Pose(
            c * dx + s * dy,
            -s * dx + c * dy,
            wrap_angle(self.yaw_rad - start.yaw_rad),
            self.floor_z_m - start.floor_z_m,
        )

    def distance_to(self, other: Pose) -> float:
        """Distance in plan, metres."""
        return math.hypot(self.x_m - other.x_m, self.y_m - other.y_m)


def wrap_angle(angle_rad: float) -> float:
    """Returns the same angle in (-pi, pi]."""
    wrapped = math.remainder(angle_rad, math.tau)
    return math.pi if wrapped == -math.pi else wrapped
