"""The node of an agent: it assembles observations from topics, and publishes actions or velocities."""

from __future__ import annotations

import importlib
import json
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.app.bridges.ros2.loading import message_class, quality, started
from sim.app.viewers.ros.messages import depth_of, pose_of
from sim.app.viewers.ros.topics import COLOUR, DEPTH, TOPICS, Delivery
from sim.core.errors import AgentError, ConfigError
from sim.core.geometry.pose import Pose
from sim.core.goals import PICTURE_PX
from sim.core.interface import GOAL_CATEGORIES, GOAL_SENSORS, Action, CameraModel, Observation
from sim.core.reading import reason_of
from sim.env.discrete import SLOW_SHARE, Held

KEPT = 10
"""Number of stamps for which incomplete observations are kept."""
ACKNOWLEDGED_S = 5.0
"""Longest time in which the robot may confirm the place of a STOP."""
BLOCKED_S = 0.2
"""A robot whose bumper touches something and that does not follow its command for this time is blocked."""
STOP = "/stubborn/stop"
"""Service of the STOP."""


class Announced(NamedTuple):
    """An episode, or one goal of a chain, as the robot announces it on `/episode`."""

    run: str
    number: int
    goal_number: int
    goal: str
    seed: int
    stamp_ns: int
    over: bool
    picture: bool
    """Whether the goal is the picture on `/goal_image` with the same stamp."""

    def is_next_goal_of(self, last: Announced | None) -> bool:
        """Returns whether this is a further goal of the episode that was announced last."""
        return last is not None and (last.run, last.number) == (self.run, self.number)


@dataclass(frozen=True)
class _Input:
    """The topic of a sensor, and how its message becomes readings."""

    topic: str
    read: Callable[[Any], dict[str, NDArray]]


class AgentNode:
    """Collects the observations of a robot.

    Args:
        camera: the camera that the agent was built for; images of another size are refused.
        sensors: names of the sensors that the agent reads.
        stepped: whether the robot waits for an action after each observation.
        pose: topic of the pose: `/pose`, or `/odom` for a robot that has nothing but its odometry.
        ros_args: arguments after `--ros-args`.

    Raises:
        ConfigError: ROS 2 is missing, or a sensor has no topic with stamps.
    """

    def __init__(
        self, camera: CameraModel, sensors: Sequence[str], *, stepped: bool, pose: str = "/pose", ros_args: str = ""
    ) -> None:
        self._camera = camera
        inputs = self._inputs(pose)
        self._shows_goal, self._shows_picture = "goal" in sensors, "goal_picture" in sensors
        sensors = [name for name in sensors if name not in GOAL_SENSORS]
        missing = [name for name in sensors if name not in inputs]
        if missing:
            raise ConfigError(f"The sensor '{missing[0]}' has no topic; topics have {', '.join(inputs)}.")
        self._needed = {inputs[name].topic for name in (*sensors, "gps")}
        self._context = started(ros_args)
        self._node = importlib.import_module("rclpy.node").Node("stubborn_agent", context=self._context)
        executors = importlib.import_module("rclpy.executors")
        self._executor = executors.SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._readings: dict[int, dict[str, dict[str, NDArray]]] = {}
        """Readings by stamp (ns) and topic."""
        self.announced: Announced | None = None
        self._picture: tuple[int, NDArray[np.uint8]] | None = None
        """Stamp (ns) and the last picture of a goal."""
        self.odometry: tuple[int, Pose, float, float] | None = None
        """Stamp (ns), pose, speed (m/s) and turn rate (rad/s) of the last message of `/odom`."""
        self.touched = False
        self._wheels: tuple[tuple[Any, Callable[[Any], None]], ...] = ()
        """The subscriptions of `catch_up`, and what reads their messages."""
        self._listen({entry.topic: entry.read for entry in inputs.values()}, stepped)
        reliable = quality(Delivery.RELIABLE)
        make = self._node.create_publisher
        self._action = make(message_class("std_msgs/UInt8"), "/action", reliable)
        self._velocity = make(message_class("geometry_msgs/Twist"), "/cmd_vel", reliable)
        self._target = make(message_class("geometry_msgs/PointStamped"), "/stop_target", reliable)
        self._confidence = make(message_class("std_msgs/Float64"), "/stop_confidence", reliable)
        self._stop = self._node.create_client(importlib.import_module("std_srvs.srv").Trigger, STOP)

    def spin(self, within_s: float) -> None:
        """Handles one message, and waits for it at most for a time."""
        self._executor.spin_once(timeout_sec=within_s)

    def observation(self, after_ns: int) -> tuple[int, Observation] | None:
        """Returns stamp (ns) and readings of the newest complete observation after a stamp; None: there is none."""
        complete = [
            stamp for stamp, topics in self._readings.items() if stamp > after_ns and self._needed <= set(topics)
        ]
        if not complete or self.announced is None:
            return None
        shown = self.announced.picture and self._shows_picture
        if shown and (self._picture is None or self._picture[0] != self.announced.stamp_ns):
            return None
        readings: dict[str, Any] = {}
        for of_topic in self._readings[max(complete)].values():
            readings |= of_topic
        goal = self.announced.goal
        readings["objectgoal"] = np.array([GOAL_CATEGORIES.index(goal) if goal in GOAL_CATEGORIES else -1], np.int64)
        if self._shows_goal:
            readings["goal"] = goal
        if self._shows_picture:
            no_picture = np.zeros((PICTURE_PX, PICTURE_PX, 3), np.uint8)
            readings["goal_picture"] = self._picture[1] if shown and self._picture else no_picture
        return max(complete), readings

    def act(self, action: Action) -> None:
        """Publishes a discrete action, for a robot in stepped mode; waits for the robot if it is not known yet."""
        while self._action.get_subscription_count() == 0:
            self.spin(0.1)
        self._action.publish(message_class("std_msgs/UInt8")(data=int(action)))

    def state(self, target_xy_m: tuple[float, float] | None, confidence: float | None) -> None:
        """States the place and the confidence of the STOP that follows; returns when the robot has both."""
        if target_xy_m is not None:
            message = message_class("geometry_msgs/PointStamped")()
            message.header.frame_id = "start"
            message.point.x, message.point.y = map(float, target_xy_m)
            self._target.publish(message)
        if confidence is not None:
            self._confidence.publish(message_class("std_msgs/Float64")(data=float(confidence)))
        duration = importlib.import_module("rclpy.duration").Duration(seconds=ACKNOWLEDGED_S)
        for publisher in (self._target, self._confidence):
            publisher.wait_for_all_acked(duration)

    def stop(self) -> None:
        """Calls the service of the STOP.

        Raises:
            AgentError: the robot does not offer it, or does not answer.
        """
        if not self._stop.wait_for_service(timeout_sec=ACKNOWLEDGED_S):
            raise AgentError(f"No node offers the service '{STOP}'; remap it with --ros-args.")
        future = self._stop.call_async(self._stop.srv_type.Request())
        until = time.monotonic() + ACKNOWLEDGED_S
        while not future.done():
            if time.monotonic() > until:
                raise AgentError(f"The service '{STOP}' does not answer.")
            self.spin(0.1)

    def send(self, speed_m_s: float, rate_rad_s: float) -> None:
        """Publishes a velocity."""
        message = message_class("geometry_msgs/Twist")()
        message.linear.x, message.angular.z = float(speed_m_s), float(rate_rad_s)
        self._velocity.publish(message)

    def catch_up(self) -> None:
        """Reads all messages of `/odom` and `/bumper` that wait: more than one does after the agent has thought."""
        for subscription, read in self._wheels:
            while True:
                with subscription.handle:
                    taken = subscription.handle.take_message(subscription.msg_type, False)
                if taken is None:
                    break
                read(taken[0])

    def close(self) -> None:
        """Ends the node."""
        self._executor.shutdown(timeout_sec=1.0)
        self._node.destroy_node()
        self._context.try_shutdown()

    def _inputs(self, pose: str) -> dict[str, _Input]:
        located = _Input(pose, _odometry if pose == "/odom" else _located)
        return {
            "rgb": _Input(f"{COLOUR}/image_raw", self._colour),
            "depth": _Input(f"{DEPTH}/image_raw", self._depth),
            "imu": _Input("/imu", _inertia),
            "odometry": _Input("/odom", _odometry if pose == "/odom" else _odometry_alone),
            "gps": located,
            "compass": located,
        }

    def _listen(self, reads: dict[str, Callable[[Any], dict[str, NDArray]]], stepped: bool) -> None:
        def subscribe(topic: str, call: Callable[[Any], None], delivery: Delivery) -> Any:
            kind = message_class(TOPICS[topic].type)
            return self._node.create_subscription(kind, topic, call, quality(delivery))

        # First, so that a new episode is known before its first observation: the robot sends that one later.
        subscribe("/episode", self._announce, Delivery.LATCHED)
        if self._shows_picture:
            subscribe("/goal_image", self._show, Delivery.LATCHED)
        for topic in self._needed:
            subscribe(topic, self._keeping(topic, reads[topic]), Delivery.LATCHED if stepped else Delivery.STREAM)
        self._wheels = (
            ()
            if stepped
            else (
                (subscribe("/odom", self._drive, Delivery.RELIABLE), self._drive),
                (subscribe("/bumper", self._touch, Delivery.STREAM), self._touch),
            )
        )

    def _keeping(self, topic: str, read: Callable[[Any], dict[str, NDArray]]) -> Callable[[Any], None]:
        def keep(message: Any) -> None:
            self._readings.setdefault(_nanoseconds(message.header.stamp), {})[topic] = read(message)
            for stamp in sorted(self._readings)[:-KEPT]:
                del self._readings[stamp]

        return keep

    def _announce(self, message: Any) -> None:
        try:
            content = json.loads(message.data)
            stamp = content.get("stamp", {"sec": 0, "nanosec": 0})
            self.announced = Announced(
                content["run"],
                content["number"],
                content.get("goal_number", 0),
                content.get("goal", ""),
                content.get("seed", 0),
                stamp["sec"] * 10**9 + stamp["nanosec"],
                content.get("over", False),
                content.get("picture", False),
            )
        except (ValueError, KeyError, TypeError, AttributeError) as fault:
            raise AgentError(f"The message of /episode is not as docs/ros.md says: {reason_of(fault)}.") from None

    def _show(self, message: Any) -> None:
        self._picture = _nanoseconds(message.header.stamp), _rgb_of(message)

    def _drive(self, message: Any) -> None:
        stamp, twist = _nanoseconds(message.header.stamp), message.twist.twist
        self.odometry = stamp, pose_of(message.pose.pose), twist.linear.x, twist.angular.z

    def _touch(self, message: Any) -> None:
        self.touched = any(message.data)

    def _colour(self, message: Any) -> dict[str, NDArray]:
        self._require_size(message)
        return {"rgb": _rgb_of(message)}

    def _depth(self, message: Any) -> dict[str, NDArray]:
        self._require_size(message)
        rows = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
        row_bytes = message.width * (2 if message.encoding == "16UC1" else 4)
        return {"depth": depth_of(rows[:, :row_bytes].tobytes(), message.encoding, self._camera)}

    def _require_size(self, message: Any) -> None:
        camera = self._camera
        if (message.width, message.height) != (camera.width_px, camera.height_px):
            raise AgentError(
                f"An image has {message.width} x {message.height} pixels, the agent's camera {camera.width_px} x "
                f"{camera.height_px}: give --config camera.width_px={message.width} camera.height_px={message.height}."
            )


class Wheels:
    """Holds velocities for one period of `/odom` each, for `sim.env.discrete.ActionController`."""

    def __init__(self, node: AgentNode, begun: Announced) -> None:
        self._node, self._begun = node, begun
        self._slow_s = 0.0
        self.period_s = self._period_s()

    def hold(self, speed_m_s: float, rate_rad_s: float) -> Held:
        """Publishes a velocity and returns the state at the next message of `/odom`."""
        self._node.catch_up()
        before_ns = self.stamp_ns
        self._node.send(speed_m_s, rate_rad_s)
        self._next(before_ns)
        _, pose, speed, rate = self._odometry()
        asked, done = (speed_m_s, speed) if abs(speed_m_s) >= 0.05 else (rate_rad_s, rate)
        slow = self._node.touched and abs(asked) >= 0.05 and done * math.copysign(1.0, asked) < SLOW_SHARE * abs(asked)
        was_blocked = self._slow_s >= BLOCKED_S
        self._slow_s = self._slow_s + self.period_s if slow else 0.0
        blocked = self._slow_s >= BLOCKED_S
        return Held(pose.x_m, pose.y_m, pose.yaw_rad, blocked, blocked and not was_blocked, self._over)

    def at_rest(self) -> Held:
        """Returns the state now."""
        _, pose, _, _ = self._odometry()
        return Held(pose.x_m, pose.y_m, pose.yaw_rad, False, False, self._over)

    @property
    def stamp_ns(self) -> int:
        """Stamp of the last message of `/odom`."""
        return self._odometry()[0]

    @property
    def _over(self) -> bool:
        return self._node.announced != self._begun

    def _odometry(self) -> tuple[int, Pose, float, float]:
        """Returns the last odometry of this episode, and waits for the first one."""
        while self._node.odometry is None or self._node.odometry[0] < self._begun.stamp_ns:
            self._node.spin(0.1)
        return self._node.odometry

    def _next(self, before_ns: int) -> None:
        while self.stamp_ns <= before_ns and not self._over:
            self._node.spin(0.1)

    def _period_s(self) -> float:
        self._node.catch_up()
        first = self.stamp_ns
        self._next(first)
        second = self.stamp_ns
        return max(0.02, (second - first) * 1e-9)


def _nanoseconds(stamp: Any) -> int:
    return stamp.sec * 10**9 + stamp.nanosec


def _rgb_of(message: Any) -> NDArray[np.uint8]:
    """Returns the image (h, w, 3) of a message of colour.

    Raises:
        AgentError: its encoding is neither `rgb8` nor `bgr8`.
    """
    if message.encoding not in ("rgb8", "bgr8"):
        raise AgentError(f"Unsupported encoding '{message.encoding}' of colour; use rgb8 or bgr8.")
    image = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
    image = image[:, : 3 * message.width].reshape(message.height, message.width, 3)
    return np.ascontiguousarray(image if message.encoding == "rgb8" else image[:, :, ::-1])


def _pose_readings(pose: Pose) -> dict[str, NDArray]:
    return {"gps": np.array([pose.x_m, pose.y_m], np.float32), "compass": np.array([pose.yaw_rad], np.float32)}


def _located(message: Any) -> dict[str, NDArray]:
    return _pose_readings(pose_of(message.pose))


def _odometry(message: Any) -> dict[str, NDArray]:
    return _odometry_alone(message) | _pose_readings(pose_of(message.pose.pose))


def _odometry_alone(message: Any) -> dict[str, NDArray]:
    """Returns no `gps` and `compass`, which `/pose` has: the message that arrives last would win."""
    pose = pose_of(message.pose.pose)
    return {"odometry": np.array([pose.x_m, pose.y_m, pose.yaw_rad], np.float32)}


def _inertia(message: Any) -> dict[str, NDArray]:
    felt = [message.linear_acceleration, message.angular_velocity]
    return {"imu": np.array([getattr(vector, axis) for vector in felt for axis in "xyz"], np.float32)}
