"""Poses of the robot on a floor, in the world and relative to the pose at which an episode started."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Pose:
    """The robot's centre in plan, its heading and the height of the floor under it.

    In the world, or in the start frame of an episode: x forward and y left of the start pose.
    """

    x_m: float
    y_m: float
    yaw_rad: float
    floor_z_m: float = 0.0

    @property
    def xy_m(self) -> tuple[float, float]:
        """The robot's centre in plan."""
        return self.x_m, self.y_m

    def ahead(self, distance_m: float) -> tuple[float, float]:
        """Returns the x and y of the point that far in front of the robot."""
        return self.x_m + distance_m * math.cos(self.yaw_rad), self.y_m + distance_m * math.sin(self.yaw_rad)

    def place_of(self, forward_m: float, left_m: float) -> tuple[float, float]:
        """Returns the x and y of a point given relative to this pose, as by `relative_to`."""
        c, s = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return self.x_m + c * forward_m - s * left_m, self.y_m + s * forward_m + c * left_m

    def relative_to(self, start: Pose) -> Pose:
        """Returns this pose in the start's frame: x forward, y left, yaw in (-pi, pi]."""
        dx, dy = self.x_m - start.x_m, self.y_m - start.y_m
        c, s = math.cos(start.yaw_rad), math.sin(start.yaw_rad)
        return Pose(
            c * dx + s * dy,
            -s * dx + c * dy,
            wrap_angle(self.yaw_rad - start.yaw_rad),
            self.floor_z_m - start.floor_z_m,
        )

    def distance_to(self, other: Pose) -> float:
        """Returns the distance in plan, metres."""
        return math.hypot(self.x_m - other.x_m, self.y_m - other.y_m)


@dataclass(frozen=True)
class BodyPose(Pose):
    """The pose of a body that leans: yaw, then pitch about its y axis (left), then roll about its x axis (REP-103).

    The rotation is Rz(yaw) Ry(pitch) Rx(roll). A body with a positive pitch looks down, one with a positive roll leans
    to the right.
    """

    rise_m: float = 0.0
    """Height of the origin of the robot frame above `floor_z_m`."""
    pitch_rad: float = 0.0
    roll_rad: float = 0.0

    @property
    def axes(self) -> NDArray[np.float64]:
        """(3, 3) the body's axes in the world as rows: ahead, left, up."""
        (cy, sy), (cp, sp), (cr, sr) = (
            (math.cos(angle), math.sin(angle)) for angle in (self.yaw_rad, self.pitch_rad, self.roll_rad)
        )
        return np.array(
            [
                [cy * cp, sy * cp, -sp],
                [cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr],
                [cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr],
            ]
        )

    def point(self, forward_m: float, left_m: float, up_m: float) -> NDArray[np.float64]:
        """Returns (3,) the position in the world of a point that is fixed to the body."""
        origin = np.array([self.x_m, self.y_m, self.floor_z_m + self.rise_m])
        return origin + np.array([forward_m, left_m, up_m]) @ self.axes


def with_view(pose: Pose, eye_m: NDArray[np.float64], axes: NDArray[np.float64], height_m: float) -> BodyPose:
    """Returns the pose of a body from which a camera at a height on its axis has this place and direction.

    Args:
        pose: its floor counts.
        eye_m: (3,) optical centre in the world.
        axes: (3, 3) ahead, left and up of the camera in the world, as rows.
        height_m: of the camera on the body's axis.
    """
    ahead, left, up = axes
    x_m, y_m, z_m = (eye_m - height_m * up).tolist()
    return BodyPose(
        x_m,
        y_m,
        math.atan2(ahead[1], ahead[0]),
        pose.floor_z_m,
        z_m - pose.floor_z_m,
        math.asin(max(-1.0, min(1.0, -ahead[2]))),
        math.atan2(left[2], up[2]),
    )


def as_body_pose(pose: Pose) -> BodyPose:
    """Returns the pose of a body; one without a lean stands upright on its floor."""
    if isinstance(pose, BodyPose):
        return pose
    return BodyPose(pose.x_m, pose.y_m, pose.yaw_rad, pose.floor_z_m)


def wrap_angle(angle_rad: float) -> float:
    """Returns the same angle in (-pi, pi]."""
    wrapped = math.remainder(angle_rad, math.tau)
    return math.pi if wrapped == -math.pi else wrapped
