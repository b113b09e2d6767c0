"""The node of a simulated robot: its publishers, subscriptions and services. A thread of its own serves other nodes.

============================  ==========================  ============================================================
subscription or service       type                        meaning
============================  ==========================  ============================================================
/cmd_vel, /cmd_vel_stamped    Twist, TwistStamped         velocity of the base
/action                       std_msgs/UInt8              in stepped mode: 0 STOP, 1 forward, 2 left, 3 right
/stop_target                  geometry_msgs/PointStamped  place for which the next STOP is, in the frame `start`
/stop_confidence              std_msgs/Float64            confidence of the next STOP, in [0, 1]
~/stop                        std_srvs/Trigger            the STOP of ObjectNav, where the robot is
~/pause                       std_srvs/SetBool            stops or starts simulated time
~/step                        std_srvs/Trigger            one period while time is paused
~/reset                       std_srvs/Trigger            starts the episode again, which then counts as an error
~/next_episode                std_srvs/Trigger            gives the episode up, which then counts as an error
============================  ==========================  ============================================================
"""

from __future__ import annotations

import importlib
import logging
import math
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from sim.app.bridges.ros2.loading import filled, has_frames, message_class, quality, started
from sim.app.bridges.ros2.requests import Requests
from sim.app.viewers.ros.messages import Message
from sim.app.viewers.ros.topics import TOPICS, Delivery

_log = logging.getLogger(__name__)
NAME = "stubborn"
_FRAMES = "tf2_msgs/TFMessage"
COMMANDS_KEPT = 10_000
"""Number of velocities or actions that wait to be read."""
ACKNOWLEDGED_S = 1.0
"""Longest time in which subscribers may confirm that an episode begins or ends."""
ACKNOWLEDGED_STEPPED_S = 10.0
"""The same in stepped mode, where an agent that learned of a goal after its observation would act for the last goal."""


class RobotNode:
    """Publishes messages by topic and collects the requests of other nodes.

    Args:
        ros_args: arguments after `--ros-args`: remappings, parameters, qualities of service.
        parameters: the run's options, which other nodes can read.
        stepped: whether each observation waits for an action; all topics are then reliable and latched, so that no
            message is lost and an agent that starts late gets the present observation.

    Raises:
        ConfigError: ROS 2 is missing, or does not take the arguments.
    """

    def __init__(
        self, *, ros_args: str = "", parameters: Mapping[str, Any] | None = None, stepped: bool = False
    ) -> None:
        self.requests = Requests()
        self.now_s = 0.0
        """Time of the last observation."""
        self._stepped = stepped
        self._context = started(ros_args)
        self._node = importlib.import_module("rclpy.node").Node(NAME, context=self._context)
        self._declare(parameters or {})
        self._publishers: dict[str, Any] = {}
        self._listen()
        executors = importlib.import_module("rclpy.executors")
        self._executor = executors.SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._serve, name="ros", daemon=True)
        self._thread.start()

    def advertise(self, topics: Iterable[str]) -> None:
        """Makes the publishers of topics, so that subscribers find them before the first message."""
        for topic in topics:
            if has_frames() or TOPICS[topic].type != _FRAMES:
                self._publisher(topic)

    def publish(self, topic: str, message: Message) -> None:
        """Publishes a message of `sim.app.viewers.ros.messages`; a failure is counted, and changes nothing else."""
        kind = TOPICS[topic].type
        if kind == _FRAMES and not has_frames():
            return
        counts = self.requests.counts
        try:
            self._publisher(topic).publish(filled(kind, message))
            counts.messages += 1
        except Exception as error:  # RCLError and others: a peer that has gone must not stop the simulation
            counts.failed_messages += 1
            if counts.failed_messages == 1:
                _log.warning("A message of %s could not be published: %s", topic, error)

    def drivers(self) -> int:
        """Returns the number of publishers of velocities and actions."""
        return sum(self._node.count_publishers(self._node.resolve_topic_name(name)) for name in _COMMANDS)

    def await_readers(self, topic: str) -> None:
        """Waits until all subscribers have the last message of a topic, for a short time at most."""
        longest_s = ACKNOWLEDGED_STEPPED_S if self._stepped else ACKNOWLEDGED_S
        duration = importlib.import_module("rclpy.duration").Duration(seconds=longest_s)
        self._publisher(topic).wait_for_all_acked(duration)

    def close(self) -> None:
        """Ends the node, after subscribers have got the last result."""
        for topic in ("/result", "/episode"):
            self.await_readers(topic)
        self._executor.shutdown(timeout_sec=ACKNOWLEDGED_S)
        self._thread.join(ACKNOWLEDGED_S)
        self._node.destroy_node()
        self._context.try_shutdown()

    def _serve(self) -> None:
        """Handles what arrives until the node is closed; the error of one message does not end it."""
        shutdown = importlib.import_module("rclpy.executors").ShutdownException
        external = importlib.import_module("rclpy.executors").ExternalShutdownException
        while self._context.ok():
            try:
                self._executor.spin_once()
            except (shutdown, external):
                return
            except Exception as error:
                if not self._context.ok():
                    return
                _log.warning("A request could not be handled: %s", error)
                time.sleep(0.01)

    def _declare(self, parameters: Mapping[str, Any]) -> None:
        descriptor = importlib.import_module("rcl_interfaces.msg").ParameterDescriptor
        for name, value in parameters.items():
            self._node.declare_parameter(
                name, value, descriptor(read_only=True, dynamic_typing=True), ignore_override=True
            )

    def _publisher(self, topic: str) -> Any:
        """Returns the publisher of a topic, whose quality of service `qos_overrides` parameters change."""
        if topic not in self._publishers:
            kind, delivery = TOPICS[topic]
            if self._stepped and topic != "/clock":
                delivery = Delivery.LATCHED
            overriding = importlib.import_module("rclpy.qos_overriding_options").QoSOverridingOptions
            self._publishers[topic] = self._node.create_publisher(
                message_class(kind), topic, quality(delivery), qos_overriding_options=overriding.with_default_policies()
            )
        return self._publishers[topic]

    def _listen(self) -> None:
        node, requests = self._node, self.requests

        def moved(message: Any) -> None:
            requests.command(message.linear.x, message.angular.z, self.now_s)

        def aimed(message: Any) -> None:
            if math.isfinite(message.point.x) and math.isfinite(message.point.y):
                requests.stop_target = message.point.x, message.point.y

        def sure(message: Any) -> None:
            requests.stop_confidence = message.data if 0.0 <= message.data <= 1.0 else None

        # Place and confidence first: where they and the action of their STOP wait together, they are read first.
        for kind, topic, call in (
            ("geometry_msgs/PointStamped", "/stop_target", aimed),
            ("std_msgs/Float64", "/stop_confidence", sure),
            ("geometry_msgs/Twist", "/cmd_vel", moved),
            ("geometry_msgs/TwistStamped", "/cmd_vel_stamped", lambda message: moved(message.twist)),
            ("std_msgs/UInt8", "/action", lambda message: requests.act(message.data)),
        ):
            self._subscribe(kind, topic, call)
        services = importlib.import_module("std_srvs.srv")
        for name in ("stop", "step", "reset", "next_episode"):
            node.create_service(services.Trigger, f"~/{name}", self._flagging(name))
        node.create_service(services.SetBool, "~/pause", self._pausing)

    def _subscribe(self, kind: str, topic: str, call: Callable[[Any], None]) -> None:
        """Subscribes to a topic; all messages that wait are read at once, so that a flood delays no newer one."""

        def read(message: Any) -> None:
            call(message)
            for _ in range(COMMANDS_KEPT):
                with subscription.handle:
                    taken = subscription.handle.take_message(subscription.msg_type, False)
                if taken is None:
                    return
                call(taken[0])

        kept = quality(Delivery.RELIABLE, depth=COMMANDS_KEPT)
        subscription = self._node.create_subscription(message_class(kind), topic, read, kept)

    def _flagging(self, name: str) -> Callable[[Any, Any], Any]:
        def call(request: Any, response: Any) -> Any:
            del request
            refusal = self.requests.raise_flag(name)
            response.success, response.message = refusal is None, refusal or ""
            return response

        return call

    def _pausing(self, request: Any, response: Any) -> Any:
        self.requests.pause(request.data)
        response.success = True
        return response


_COMMANDS = ("/cmd_vel", "/cmd_vel_stamped", "/action")
