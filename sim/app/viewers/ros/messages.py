"""Builds ROS 2 messages, as dicts, from images, scans, poses and grids of this project.

Units and frames are those of REP-103: metres, radians, x forward, y left, z up; in optical frames z forward, x right,
y down. The frames are those of REP-105: `map` (the house) -> `odom` (the start pose, where the robot believes it to be)
-> `base_link` (on the floor below the robot's axis) -> `camera_link` -> `camera_optical_frame`, and `laser`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.sensors.scan import ScanConfig

Message = dict[str, object]
MAP, ODOM, BASE, CAMERA, OPTICAL, LASER = (
    "map", "odom", "base_link", "camera_link", "camera_optical_frame", "laser",
)  # fmt: skip
_TO_OPTICAL = {"x": -0.5, "y": 0.5, "z": -0.5, "w": 0.5}
"""Rotation of an optical frame in that of its camera."""
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


def depth_image(time_s: float, depth_m: NDArray[np.float32], camera: CameraModel) -> Message:
    """Returns `sensor_msgs/Image` of a depth image (h, w), in whole millimetres (`16UC1`).

    Pixels without a distance, and those at the limit of the camera's range or of the encoding or farther, are 0.
    """
    seen_m = np.where(depth_m < min(camera.max_depth_m, DEEPEST_M), depth_m, np.float32(0.0))
    return _image(time_s, np.rint(seen_m * np.float32(1000.0)).astype("<u2"), "16UC1")


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


def odometry(time_s: float, believed: Pose) -> Message:
    """Returns `nav_msgs/Odometry` of a robot at rest at a pose in the frame `odom`."""
    nothing = [0.0] * 36
    return {
        "header": header(time_s, ODOM),
        "child_frame_id": BASE,
        "pose": {"pose": _pose(believed), "covariance": nothing},
        "twist": {"twist": twist(0.0, 0.0), "covariance": nothing},
    }


def twist(speed_m_s: float, rate_rad_s: float) -> Message:
    """Returns `geometry_msgs/Twist` of a wheeled base."""
    return {"linear": {"x": speed_m_s, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": rate_rad_s}}


def transforms(
    time_s: float, true: Pose, believed: Pose, *, camera: CameraModel, camera_forward_m: float, laser_height_m: float
) -> Message:
    """Returns `tf2_msgs/TFMessage` with all frames.

    Args:
        time_s: of the message.
        true: pose of the robot in the house; its floor is the height of `odom`.
        believed: pose of the robot in the start frame, according to its sensors.
        camera: its height.
        camera_forward_m: distance of the camera ahead of the robot's axis.
        laser_height_m: height of the lidar.
    """
    return {
        "transforms": [
            _transform(time_s, MAP, ODOM, _pose(_origin(true, believed))),
            _transform(time_s, ODOM, BASE, _pose(believed)),
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
