"""Finds ROS 2 in this Python, and turns the messages of `sim.app.viewers.ros.messages` into those of `rclpy`.

ROS 2 is a ROS installation whose setup file was sourced, or the wheels of the extra `ros2`. Nothing here is imported
before a node is made, so that this project needs neither.
"""

from __future__ import annotations

import array
import functools
import importlib
import importlib.metadata
import importlib.util
import os
import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sim.core.errors import ConfigError
from sim.core.invocation import command, program

FILES = Path(__file__).parent / "files"
KILTED = 9
"""Version of `rclpy` in ROS 2 Kilted."""
_ARRAY_CODES = {"uint8": "B", "int8": "b", "float": "f", "double": "d"}
"""Types of elements whose sequences `rclpy` takes as arrays without a test of each element."""


def require_ros() -> None:
    """Raises ConfigError where this Python has no ROS 2."""
    if importlib.util.find_spec("rclpy") is not None:
        return
    wheels = f"`{command('ros', 'setup')}` makes an environment with it"
    if sys.version_info[:2] != (3, 11):
        wheels = f"there are wheels for Python 3.11 only, in which {wheels}"
    raise ConfigError(
        f"{program()} needs rclpy: source the setup file of a ROS 2 installation for this Python, or {wheels}."
    )


def has_frames() -> bool:
    """Returns whether `tf2_msgs` is there, which the wheels lack."""
    return importlib.util.find_spec("tf2_msgs") is not None


@functools.cache
def message_class(kind: str) -> Any:
    """Returns the class of a message, such as `sensor_msgs/Image`."""
    package, name = kind.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def filled(kind: str, content: Mapping[str, Any]) -> Any:
    """Returns a message of `rclpy` with the content of a dict that has all fields."""
    made = message_class(kind)()
    for name, field in made.get_fields_and_field_types().items():
        setattr(made, name, _value(field, content[name]))
    return made


def _value(field: str, content: Any) -> Any:
    """Returns the value of a field of a type such as `double`, `sequence<uint8>` or `std_msgs/Header`."""
    element = field.removeprefix("sequence<").removesuffix(">")
    if element in _ARRAY_CODES and element != field:
        return array.array(_ARRAY_CODES[element], content)
    if "/" not in element:
        return content
    if element != field:
        return [filled(element, each) for each in content]
    return filled(element, content)


def started(ros_args: str) -> Any:
    """Returns a context of `rclpy`, which leaves signals to this process.

    Args:
        ros_args: arguments after `--ros-args`, as one text.

    Raises:
        ConfigError: ROS 2 is missing, or does not take the arguments.
    """
    require_ros()
    _share_memory()
    rclpy, signals = importlib.import_module("rclpy"), importlib.import_module("rclpy.signals")
    words = ["--ros-args", *shlex.split(ros_args)] if ros_args else []
    context = rclpy.Context()
    try:
        rclpy.init(args=words, context=context, signal_handler_options=signals.SignalHandlerOptions.NO)
    except Exception as error:  # of several private classes
        reason = " ".join(str(error).split())
        raise ConfigError(f"ROS 2 does not start with --ros-args '{ros_args}': {reason}") from None
    return context


def _share_memory() -> None:
    """Gives Fast DDS shared memory for images, unless the user has a profile of their own."""
    names = "FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE"  # of ROS 2 Kilted and later, and before
    if not any(name in os.environ for name in names):
        is_new = int(importlib.metadata.version("rclpy").split(".")[0]) >= KILTED
        os.environ[names[0] if is_new else names[1]] = str(FILES / "fastdds.xml")


def overrides(ros_args: str) -> dict[str, Any]:
    """Returns the parameters that `--ros-args` gives a node, with `-p` or in a file.

    Raises:
        ConfigError: see `started`.
    """
    context = started(ros_args)
    node = importlib.import_module("rclpy.node").Node(
        "stubborn",
        context=context,
        automatically_declare_parameters_from_overrides=True,
        start_parameter_services=False,
    )
    try:
        given = {name: parameter.value for name, parameter in node.get_parameters_by_prefix("").items()}
    finally:
        node.destroy_node()
        context.shutdown()
    return {
        name: value
        for name, value in given.items()
        if not name.startswith(("use_sim_time", "qos_overrides", "start_type"))
    }


def quality(delivery: Any, *, depth: int | None = None) -> Any:
    """Returns the profile of `rclpy` for a `Delivery`."""
    qos = importlib.import_module("rclpy.qos")
    return qos.QoSProfile(
        history=qos.HistoryPolicy.KEEP_LAST,
        depth=depth or delivery.depth,
        reliability=getattr(qos.ReliabilityPolicy, delivery.reliability.upper()),
        durability=getattr(qos.DurabilityPolicy, delivery.durability.upper()),
    )
