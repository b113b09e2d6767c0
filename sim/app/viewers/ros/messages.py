"""Builds ROS 2 messages, as dicts, from images, scans, poses and grids of this project.

Units and frames are those of REP-103: metres, radians, x forward, y left, z up; in optical frames z forward, x right,
y down. The frames are those of REP-105: `map` (the house) -> `odom` (the start pose, as the robot's odometry believes)
-> `base_link` (on the floor below the robot's axis) -> `camera_link` -> `camera_optical_frame`, and `laser`.
The frame `start` is the true start pose; poses of the task's sensors `gps` and `compass` are in it.
"""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.sensors.scan import ScanConfig

Message = dict[str, object]
MAP, ODOM, START, BASE, CAMERA, OPTICAL, LASER = (
    "map", "odom", "start", "base_link", "camera_link", "camera_optical_frame", "laser",
)  # fmt: skip
DepthEncoding = Literal["16UC1", "32FC1"]
"""Encoding of a depth image: whole millimetres, or metres as float32."""
_TO_OPTICAL = {"x": -0.5, "y": 0.5, "z": -0.5, "w": 0.5}
"""Rotation of an optical frame in that of its camera."""
_UNTURNED = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
OCCUPIED, FREE, UNKNOWN = 100, 0, -1
"""Values of an occupancy grid."""

DEEPEST_M = 65.535
"""The largest distance of `16UC1`."""


def stamp(time_s: float) -> Message:
    """Returns a time as seconds and nanoseconds."""
    nanoseconds = round(time_s * 1e9)
    return {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}


def header(time_s: float, frame: str) -> Message:
    """Returns the header of a message in a frame."""
    return {"stamp": stamp(time_s), "frame_id": frame}


def colour_image(time_s: float, image: NDArray[np.uint8]) -> Message:
    """Returns `sensor_msgs/Image` of an RGB image (h, w, 3)."""
    return _image(time_s, image, "rgb8")


def depth_image(
    time_s: float, depth_m: NDArray[np.float32], camera: CameraModel, encoding: DepthEncoding = "16UC1"
) -> Message:
    """Returns `sensor_msgs/Image` of a depth image (h, w).

    With `16UC1`, in whole millimetres, pixels without a distance, and those at the limit of the camera's range or of
    the encoding or farther, are 0. With `32FC1`, in metres, the former are NaN and the latter +infinity (REP-117,
    REP-118).
    """
    if encoding == "32FC1":
        far = np.where(depth_m >= camera.max_depth_m, np.float32(np.inf), depth_m)
        return _image(time_s, np.where(depth_m <= 0.0, np.float32(np.nan), far).astype("<f4"), encoding)
    seen_m = np.where(depth_m < min(camera.max_depth_m, DEEPEST_M), depth_m, np.float32(0.0))
    return _image(time_s, np.rint(seen_m * np.float32(1000.0)).astype("<u2"), encoding)


def depth_of(content: bytes | memoryview, encoding: str, camera: CameraModel) -> NDArray[np.float32]:
    """Returns the depth image (h, w), metres, in the content of a message of `depth_image`.

    What has no distance is 0, and what is out of range `max_depth_m`. `16UC1` does not tell one from the other, so that
    both are 0.

    Raises:
        ConfigError: the encoding is unknown.
    """
    shape = camera.height_px, camera.width_px
    if encoding == "16UC1":
        read_m = np.frombuffer(content, "<u2").reshape(shape).astype(np.float32) / np.float32(1000.0)
        return np.minimum(read_m, np.float32(camera.max_depth_m))
    if encoding != "32FC1":
        raise ConfigError(f"Unsupported encoding '{encoding}' of depth; use 16UC1 or 32FC1.")
    read_m = np.frombuffer(content, "<f4").reshape(shape)
    return np.nan_to_num(np.minimum(read_m, np.float32(camera.max_depth_m)), nan=0.0)


def _image(time_s: float, image: NDArray, encoding: str) -> Message:
    height, width = image.shape[:2]
    content = np.ascontiguousarray(image).tobytes()
    return {
        "header": header(time_s, OPTICAL),
        "height": height,
        "width": width,
        "encoding": encoding,
        "is_bigendian": 0,
        "step": len(content) // height,
        "data": content,
    }


def camera_info(time_s: float, camera: CameraModel) -> Message:
    """Returns `sensor_msgs/CameraInfo`: a pinhole without distortion. The centre of the first pixel is at (0, 0)."""
    f, cx, cy = camera.focal_px, 0.5 * (camera.width_px - 1), 0.5 * (camera.height_px - 1)
    return {
        "header": header(time_s, OPTICAL),
        "height": camera.height_px,
        "width": camera.width_px,
        "distortion_model": "plumb_bob",
        "d": [0.0] * 5,
        "k": [f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0],
        "r": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        "p": [f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
        "binning_x": 0,
        "binning_y": 0,
        "roi": {"x_offset": 0, "y_offset": 0, "height": 0, "width": 0, "do_rectify": False},
    }


def laser_scan(time_s: float, distance_m: NDArray[np.float32], scan: ScanConfig) -> Message:
    """Returns `sensor_msgs/LaserScan` of a reading (rays,).

    As REP-117 asks, too near is -infinity and no return +infinity.
    """
    ranges = np.where(distance_m >= scan.max_range_m, np.inf, np.where(distance_m <= 0.0, -np.inf, distance_m))
    angles = scan.angles_rad
    return {
        "header": header(time_s, LASER),
        "angle_min": float(angles[0]),
        "angle_max": float(angles[-1]),
        "angle_increment": scan.step_rad,
        "time_increment": 0.0,
        "scan_time": 0.0,
        "range_min": scan.min_range_m,
        "range_max": scan.max_range_m,
        "ranges": ranges.tolist(),
        "intensities": [],
    }


def inertia(time_s: float, reading: NDArray[np.float32]) -> Message:
    """Returns `sensor_msgs/Imu` of a reading of the sensor `imu` (6,), which has no orientation."""
    acceleration, rate = reading[:3].astype(np.float64).tolist(), reading[3:].astype(np.float64).tolist()
    return {
        "header": header(time_s, BASE),
        "orientation": _UNTURNED,
        "orientation_covariance": [-1.0] + [0.0] * 8,
        "angular_velocity": dict(zip("xyz", rate, strict=True)),
        "angular_velocity_covariance": [0.0] * 9,
        "linear_acceleration": dict(zip("xyz", acceleration, strict=True)),
        "linear_acceleration_covariance": [0.0] * 9,
    }


def contacts(reading: NDArray[np.int8]) -> Message:
    """Returns `std_msgs/Int8MultiArray` of a reading of the sensor `bumper` (sectors,): the first is ahead."""
    layout = {"dim": [{"label": "sector", "size": len(reading), "stride": len(reading)}], "data_offset": 0}
    return {"layout": layout, "data": reading.tolist()}


def text(content: str) -> Message:
    """Returns `std_msgs/String`."""
    return {"data": content}


def odometry(time_s: float, believed: Pose, speed_m_s: float = 0.0, rate_rad_s: float = 0.0) -> Message:
    """Returns `nav_msgs/Odometry` of a robot at a pose in the frame `odom`, with its velocity in its own frame."""
    nothing = [0.0] * 36
    return {
        "header": header(time_s, ODOM),
        "child_frame_id": BASE,
        "pose": {"pose": _pose(believed), "covariance": nothing},
        "twist": {"twist": twist(speed_m_s, rate_rad_s), "covariance": nothing},
    }


def located(time_s: float, pose: Pose) -> Message:
    """Returns `geometry_msgs/PoseStamped` of a pose in the frame `start`."""
    return {"header": header(time_s, START), "pose": _pose(pose)}


def pose_of(message: Any) -> Pose:
    """Returns the pose on a floor in an object with the fields of `geometry_msgs/Pose`."""
    place, turn = message.position, message.orientation
    yaw_rad = math.atan2(2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y * turn.y + turn.z * turn.z))
    return Pose(place.x, place.y, yaw_rad, place.z)


def twist(speed_m_s: float, rate_rad_s: float) -> Message:
    """Returns `geometry_msgs/Twist` of a wheeled base."""
    return {"linear": {"x": speed_m_s, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": rate_rad_s}}


def moving_frames(time_s: float, believed: Pose, true: Pose | None) -> Message:
    """Returns `tf2_msgs/TFMessage` with the frames that move.

    Args:
        time_s: of the message.
        believed: pose of the robot in `odom`, by its odometry.
        true: pose of the robot in the house, whose floor is the height of `odom`; None: without the frame `map`.
    """
    frames = [] if true is None else [_transform(time_s, MAP, ODOM, _pose(_origin(true, believed)))]
    return {"transforms": [*frames, _transform(time_s, ODOM, BASE, _pose(believed))]}


def fixed_frames(time_s: float, camera: CameraModel, *, camera_forward_m: float, laser_height_m: float) -> Message:
    """Returns `tf2_msgs/TFMessage` with the frames that are fixed to the robot.

    Args:
        time_s: of the message.
        camera: its height.
        camera_forward_m: distance of the camera ahead of the robot's axis.
        laser_height_m: height of the lidar.
    """
    return {
        "transforms": [
            _transform(time_s, BASE, CAMERA, _pose(Pose(camera_forward_m, 0.0, 0.0, camera.height_m))),
            _transform(time_s, CAMERA, OPTICAL, _pose(Pose(0.0, 0.0, 0.0)) | {"orientation": _TO_OPTICAL}),
            _transform(time_s, BASE, LASER, _pose(Pose(0.0, 0.0, 0.0, laser_height_m))),
        ]
    }


def occupancy_grid(
    time_s: float, frame: GridFrame, occupied: NDArray[np.bool_], free: NDArray[np.bool_], floor_z_m: float
) -> Message:
    """Returns `nav_msgs/OccupancyGrid` of two masks (rows, cols); what is neither is unknown."""
    values = np.where(occupied, OCCUPIED, np.where(free, FREE, UNKNOWN)).astype(np.int8)
    rows, cols = frame.shape
    return {
        "header": header(time_s, MAP),
        "info": {
            "map_load_time": stamp(time_s),
            "resolution": frame.cell_m,
            "width": cols,
            "height": rows,
            "origin": _pose(Pose(*frame.origin_xy_m, 0.0, floor_z_m)),
        },
        "data": values.ravel().tolist(),
    }


def _origin(true: Pose, believed: Pose) -> Pose:
    """Returns the frame in which the robot, which is truly at `true`, is at `believed`."""
    yaw = true.yaw_rad - believed.yaw_rad
    cos, sin = math.cos(yaw), math.sin(yaw)
    x_m = true.x_m - (cos * believed.x_m - sin * believed.y_m)
    y_m = true.y_m - (sin * believed.x_m + cos * believed.y_m)
    return Pose(x_m, y_m, yaw, true.floor_z_m)


def _pose(pose: Pose) -> Message:
    """Returns `geometry_msgs/Pose` of a pose on a floor."""
    half = 0.5 * pose.yaw_rad
    return {
        "position": {"x": pose.x_m, "y": pose.y_m, "z": pose.floor_z_m},
        "orientation": {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)},
    }


def _transform(time_s: float, parent: str, child: str, pose: Message) -> Message:
    return {
        "header": header(time_s, parent),
        "child_frame_id": child,
        "transform": {"translation": pose["position"], "rotation": pose["orientation"]},
    }
