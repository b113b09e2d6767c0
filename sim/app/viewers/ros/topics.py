"""The topics of a robot: type and quality of service of each, and the messages of one moment.

============================================  =========================  ==============================================
topic                                         type                       content
============================================  =========================  ==============================================
/camera/color/image_raw                       sensor_msgs/Image          colour as the agent saw it, `rgb8`
/camera/color/camera_info                     sensor_msgs/CameraInfo     its intrinsics
/camera/aligned_depth_to_color/image_raw      sensor_msgs/Image          depth, `16UC1` (mm) or `32FC1` (m)
/camera/aligned_depth_to_color/camera_info    sensor_msgs/CameraInfo     the same intrinsics
/scan                                         sensor_msgs/LaserScan      the lidar
/imu                                          sensor_msgs/Imu            accelerations and turn rates
/bumper                                       std_msgs/Int8MultiArray    1 for each sector of the hull with a contact
/odom                                         nav_msgs/Odometry          pose and velocity by wheels and gyro
/pose                                         geometry_msgs/PoseStamped  pose by `gps` and `compass`, frame `start`
/tf, /tf_static                               tf2_msgs/TFMessage         frames (`sim.app.viewers.ros.messages`)
/map                                          nav_msgs/OccupancyGrid     the true floor plan of the storey
/cmd_vel                                      geometry_msgs/Twist        the velocity that the robot is to have
/clock                                        rosgraph_msgs/Clock        simulated time
/goal                                         std_msgs/String            the goal, and each further one of a chain
/goal_image                                   sensor_msgs/Image          the picture of a goal, `rgb8`
/episode                                      std_msgs/String            JSON: number, goal and seed of the episode
/result                                       std_msgs/String            JSON: the result of the last episode
============================================  =========================  ==============================================
"""

from __future__ import annotations

import enum
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

from numpy.typing import NDArray

from sim.app.viewers.ros import messages
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.sensors.scan import ScanConfig


class Delivery(enum.Enum):
    """Quality of service: reliability, durability and depth of the history."""

    STREAM = ("best_effort", "volatile", 5)
    """The profile "sensor data" of ROS 2."""
    RELIABLE = ("reliable", "volatile", 100)
    LATCHED = ("reliable", "transient_local", 1)
    """A subscriber that comes late gets the last message."""

    @property
    def reliability(self) -> str:
        """Returns `reliable` or `best_effort`."""
        return self.value[0]

    @property
    def durability(self) -> str:
        """Returns `volatile` or `transient_local`."""
        return self.value[1]

    @property
    def depth(self) -> int:
        """Returns the number of messages that are kept for a subscriber."""
        return self.value[2]


class Topic(NamedTuple):
    """Type of the messages, as `package/Type`, and their quality of service."""

    type: str
    delivery: Delivery


COLOUR, DEPTH = "/camera/color", "/camera/aligned_depth_to_color"
"""Namespaces of the two images, as drivers of RGB-D cameras name them."""
TOPICS: Mapping[str, Topic] = MappingProxyType(
    {
        f"{COLOUR}/image_raw": Topic("sensor_msgs/Image", Delivery.STREAM),
        f"{COLOUR}/camera_info": Topic("sensor_msgs/CameraInfo", Delivery.STREAM),
        f"{DEPTH}/image_raw": Topic("sensor_msgs/Image", Delivery.STREAM),
        f"{DEPTH}/camera_info": Topic("sensor_msgs/CameraInfo", Delivery.STREAM),
        "/scan": Topic("sensor_msgs/LaserScan", Delivery.STREAM),
        "/imu": Topic("sensor_msgs/Imu", Delivery.STREAM),
        "/bumper": Topic("std_msgs/Int8MultiArray", Delivery.STREAM),
        "/odom": Topic("nav_msgs/Odometry", Delivery.RELIABLE),
        "/pose": Topic("geometry_msgs/PoseStamped", Delivery.RELIABLE),
        "/tf": Topic("tf2_msgs/TFMessage", Delivery.RELIABLE),
        "/tf_static": Topic("tf2_msgs/TFMessage", Delivery.LATCHED),
        "/map": Topic("nav_msgs/OccupancyGrid", Delivery.LATCHED),
        "/cmd_vel": Topic("geometry_msgs/Twist", Delivery.RELIABLE),
        "/clock": Topic("rosgraph_msgs/Clock", Delivery.STREAM),
        "/goal": Topic("std_msgs/String", Delivery.LATCHED),
        "/goal_image": Topic("sensor_msgs/Image", Delivery.LATCHED),
        "/episode": Topic("std_msgs/String", Delivery.LATCHED),
        "/result": Topic("std_msgs/String", Delivery.LATCHED),
    }
)


def offered_qos_profiles(delivery: Delivery) -> str:
    """Returns a quality of service as the metadata of a recording has it, YAML in the form of rosbag2."""
    reliability = {"reliable": 1, "best_effort": 2}[delivery.reliability]
    durability = {"transient_local": 1, "volatile": 2}[delivery.durability]
    forever = "{sec: 9223372036, nsec: 854775807}"
    lines = [
        "history: 1", f"depth: {delivery.depth}", f"reliability: {reliability}", f"durability: {durability}",
        f"deadline: {forever}", f"lifespan: {forever}", "liveliness: 1", f"liveliness_lease_duration: {forever}",
        "avoid_ros_namespace_conventions: false",
    ]  # fmt: skip
    return "- " + "\n  ".join(lines)


@dataclass(frozen=True, kw_only=True)
class RobotTopics:
    """Builds the messages of one robot."""

    camera: CameraModel
    camera_forward_m: float
    scan: ScanConfig
    depth_encoding: messages.DepthEncoding = "16UC1"

    def at_start(self, time_s: float) -> messages.Message:
        """Returns the frames that are fixed to the robot, for `/tf_static`."""
        forward_m, height_m = self.camera_forward_m, self.scan.height_m
        return messages.fixed_frames(time_s, self.camera, camera_forward_m=forward_m, laser_height_m=height_m)

    def at(
        self,
        time_s: float,
        readings: Mapping[str, NDArray],
        *,
        velocity: tuple[float, float] = (0.0, 0.0),
        true: Pose | None = None,
    ) -> Iterator[tuple[str, messages.Message]]:
        """Yields topic and message of each sensor with a reading, and the frames that move.

        Args:
            time_s: of the readings.
            readings: an observation (`sim.core.interface.Observation`) with `odometry`, `gps` and `compass`.
            velocity: forward speed (m/s) and turn rate (rad/s) by the robot's odometry.
            true: the robot's true pose; None: the frame `map` is left out.
        """
        x_m, y_m, yaw_rad = readings["odometry"].tolist()
        yield "/tf", messages.moving_frames(time_s, Pose(x_m, y_m, yaw_rad), true)
        yield "/odom", messages.odometry(time_s, Pose(x_m, y_m, yaw_rad), *velocity)
        x_m, y_m = readings["gps"].tolist()
        yield "/pose", messages.located(time_s, Pose(x_m, y_m, float(readings["compass"][0])))
        if "scan" in readings:
            yield "/scan", messages.laser_scan(time_s, readings["scan"], self.scan)
        if "imu" in readings:
            yield "/imu", messages.inertia(time_s, readings["imu"])
        if "bumper" in readings:
            yield "/bumper", messages.contacts(readings["bumper"])
        if "rgb" in readings:
            yield f"{COLOUR}/camera_info", messages.camera_info(time_s, self.camera)
            yield f"{COLOUR}/image_raw", messages.colour_image(time_s, readings["rgb"])
        if "depth" in readings:
            depth = messages.depth_image(time_s, readings["depth"], self.camera, self.depth_encoding)
            yield f"{DEPTH}/camera_info", messages.camera_info(time_s, self.camera)
            yield f"{DEPTH}/image_raw", depth
