"""The definitions of the standard ROS 2 messages that a recording has, as its schemas need them.

The fields are those of the packages `builtin_interfaces`, `std_msgs`, `geometry_msgs`, `sensor_msgs`, `nav_msgs`,
`rosgraph_msgs` and `tf2_msgs` of ROS 2 (Humble to Kilted); a test compares their hashes with those of the package
`rosbags`.
"""

from __future__ import annotations

from types import MappingProxyType

_SEPARATOR = "=" * 80
_FIELDS = {
    "builtin_interfaces/Time": "int32 sec; uint32 nanosec",
    "rosgraph_msgs/Clock": "builtin_interfaces/Time clock",
    "std_msgs/Header": "builtin_interfaces/Time stamp; string frame_id",
    "std_msgs/String": "string data",
    "std_msgs/MultiArrayDimension": "string label; uint32 size; uint32 stride",
    "std_msgs/MultiArrayLayout": "std_msgs/MultiArrayDimension[] dim; uint32 data_offset",
    "std_msgs/Int8MultiArray": "std_msgs/MultiArrayLayout layout; int8[] data",
    "geometry_msgs/Vector3": "float64 x; float64 y; float64 z",
    "geometry_msgs/Point": "float64 x; float64 y; float64 z",
    "geometry_msgs/Quaternion": "float64 x 0; float64 y 0; float64 z 0; float64 w 1",
    "geometry_msgs/Pose": "geometry_msgs/Point position; geometry_msgs/Quaternion orientation",
    "geometry_msgs/PoseStamped": "std_msgs/Header header; geometry_msgs/Pose pose",
    "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose; float64[36] covariance",
    "geometry_msgs/Twist": "geometry_msgs/Vector3 linear; geometry_msgs/Vector3 angular",
    "geometry_msgs/TwistWithCovariance": "geometry_msgs/Twist twist; float64[36] covariance",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation; geometry_msgs/Quaternion rotation",
    "geometry_msgs/TransformStamped":
        "std_msgs/Header header; string child_frame_id; geometry_msgs/Transform transform",
    "sensor_msgs/Image":
        "std_msgs/Header header; uint32 height; uint32 width; string encoding; uint8 is_bigendian; uint32 step; "
        "uint8[] data",
    "sensor_msgs/RegionOfInterest": "uint32 x_offset; uint32 y_offset; uint32 height; uint32 width; bool do_rectify",
    "sensor_msgs/CameraInfo":
        "std_msgs/Header header; uint32 height; uint32 width; string distortion_model; float64[] d; float64[9] k; "
        "float64[9] r; float64[12] p; uint32 binning_x; uint32 binning_y; sensor_msgs/RegionOfInterest roi",
    "sensor_msgs/Imu":
        "std_msgs/Header header; geometry_msgs/Quaternion orientation; float64[9] orientation_covariance; "
        "geometry_msgs/Vector3 angular_velocity; float64[9] angular_velocity_covariance; "
        "geometry_msgs/Vector3 linear_acceleration; float64[9] linear_acceleration_covariance",
    "sensor_msgs/LaserScan":
        "std_msgs/Header header; float32 angle_min; float32 angle_max; float32 angle_increment; "
        "float32 time_increment; float32 scan_time; float32 range_min; float32 range_max; float32[] ranges; "
        "float32[] intensities",
    "nav_msgs/MapMetaData":
        "builtin_interfaces/Time map_load_time; float32 resolution; uint32 width; uint32 height; "
        "geometry_msgs/Pose origin",
    "nav_msgs/OccupancyGrid": "std_msgs/Header header; nav_msgs/MapMetaData info; int8[] data",
    "nav_msgs/Odometry":
        "std_msgs/Header header; string child_frame_id; geometry_msgs/PoseWithCovariance pose; "
        "geometry_msgs/TwistWithCovariance twist",
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms",
}  # fmt: skip
FIELDS = MappingProxyType({name: tuple(fields.split("; ")) for name, fields in _FIELDS.items()})
"""The fields of each type, `package/Type`: type, name and default value."""


def definition(name: str) -> str:
    """Returns the definition of a type with those of all types that it contains, as a schema `ros2msg` has it.

    Args:
        name: a key of `FIELDS`.
    """
    parts = ["\n".join(FIELDS[name])]
    parts += [f"MSG: {kind}\n" + "\n".join(FIELDS[kind]) for kind in _contained(name)]
    return f"\n{_SEPARATOR}\n".join(parts) + "\n"


def _contained(name: str) -> list[str]:
    """Returns the types that a type contains, at any depth, each once."""
    kinds: dict[str, None] = {}
    for field in FIELDS[name]:
        kind = field.split()[0].partition("[")[0]
        if kind in FIELDS:
            kinds |= dict.fromkeys([kind, *_contained(kind)])
    return list(kinds)
