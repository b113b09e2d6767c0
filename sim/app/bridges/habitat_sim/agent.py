"""The agent: its pose and the poses of its cameras, in Habitat's frame."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.app.bridges.habitat_sim.maths import (
    Quaternion,
    Vector3,
    quat_from_coeffs,
    quat_rotate_vector,
    quat_to_magnum,
    rotation_of,
)
from sim.app.bridges.habitat_sim.settings import AgentConfiguration, SensorSpec
from sim.core.geometry.pose import BodyPose, Pose, with_view, wrap_angle
from sim.episodes.habitat import from_agent_state, to_position, to_rotation
from sim.world.world import World

MOVED_M, MOVED_RAD = 1e-4, 1e-4
"""A pose that differs by less than this from that of the robot is that of the robot."""


@dataclass
class SixDOFPose:
    """The pose of a sensor in the world."""

    position: Any = field(default_factory=lambda: np.zeros(3, np.float32))
    rotation: Any = field(default_factory=lambda: quat_from_coeffs([0.0, 0.0, 0.0, 1.0]))


@dataclass
class AgentState:
    """The pose of an agent: the place on the floor under its middle, (3,), and its rotation, `np.quaternion`."""

    position: Any = field(default_factory=lambda: np.zeros(3, np.float32))
    rotation: Any = field(default_factory=lambda: quat_from_coeffs([0.0, 0.0, 0.0, 1.0]))
    sensor_states: dict[str, SixDOFPose] = field(default_factory=dict)
    velocity: Any = field(default_factory=lambda: np.zeros(3, np.float32))
    angular_velocity: Any = field(default_factory=lambda: np.zeros(3, np.float32))


class SensorNode:
    """The place of a sensor relative to the agent; `rotation` (magnum's) may be set, for example to tilt a camera."""

    def __init__(self, spec: SensorSpec) -> None:
        self._spec = spec
        self.reset()

    def reset(self) -> None:
        """Restores the pose of the sensor's specification."""
        x, y, z = np.asarray(self._spec.orientation, np.float64).tolist()
        axes = (Vector3.x_axis(), Vector3.y_axis(), Vector3.z_axis())
        by_x, by_y, by_z = (Quaternion.rotation(angle, axis) for angle, axis in zip((x, y, z), axes, strict=True))
        self.translation = Vector3(self._spec.position)
        self.rotation = by_z * by_y * by_x  # each turns about an axis of the agent, as in habitat-sim


class Sensor:
    """A camera of an agent."""

    def __init__(self, spec: SensorSpec) -> None:
        self.spec = spec
        self.node = SensorNode(spec)

    def specification(self) -> SensorSpec:
        """Returns what it was made from."""
        return self.spec


class Agent:
    """The robot in a world. It stands where physics put it, or where `set_state` put it last.

    A pose that was set takes effect in physics with the next action; until then cameras look from there. A pose that is
    set and set back, as `get_observations_at` does, leaves the physics untouched.
    """

    def __init__(self, config: AgentConfiguration) -> None:
        self.agent_config = config
        self.sensors = {spec.uuid: Sensor(spec) for spec in config.sensor_specifications}
        self.world: World
        self.settle: Callable[[], None]
        """Puts the robot where the agent was put, in physics."""
        self.put: Pose | None = None
        """The pose that was set since the last action, if it is not that of the robot."""
        self.initial_state = AgentState()
        """Where `reset` puts the agent."""

    def enter(self, world: World, settle: Callable[[], None]) -> None:
        """Moves into the world of a simulator."""
        self.world, self.settle, self.put = world, settle, None

    @property
    def pose(self) -> BodyPose | Pose:
        """The pose of the robot, or the one that was set."""
        return self.world.body_pose if self.put is None else self.put

    @property
    def state(self) -> AgentState:
        """The same as `get_state`."""
        return self.get_state()

    @state.setter
    def state(self, state: AgentState) -> None:
        self.set_state(state)

    def get_state(self) -> AgentState:
        """Returns the pose of the agent and of its sensors."""
        pose = self.pose
        position = np.array(to_position(pose.x_m, pose.y_m, pose.floor_z_m), np.float32)
        state = AgentState(position, quat_from_coeffs(to_rotation(pose.yaw_rad)))
        for uuid, sensor in self.sensors.items():
            offset = quat_rotate_vector(state.rotation, sensor.node.translation)
            state.sensor_states[uuid] = SixDOFPose(
                (position + offset).astype(np.float32), state.rotation * rotation_of(sensor.node.rotation)
            )
        return state

    def set_state(
        self, state: AgentState, reset_sensors: bool = True, infer_sensor_states: bool = True, is_initial: bool = False
    ) -> None:
        """Puts the agent somewhere; an upright pose with the rotation about the vertical axis is taken.

        Args:
            state: its position (3,) and rotation (`np.quaternion`, or xyzw).
            reset_sensors: also restore the poses of the sensors on the agent.
            infer_sensor_states: exists for scripts that give it; True.
            is_initial: also return there when the agent is reset.
        """
        if is_initial:
            self.initial_state = copy.deepcopy(state)
        rotation = rotation_of(state.rotation)
        position: list[float] = np.asarray(state.position, np.float64).tolist()
        pose = from_agent_state(position, [rotation.x, rotation.y, rotation.z, rotation.w])
        self.put = None if self._is_here(pose) else pose
        if reset_sensors:
            for sensor in self.sensors.values():
                sensor.node.reset()

    def _is_here(self, pose: Pose) -> bool:
        here = self.world.pose
        return (
            here.distance_to(pose) < MOVED_M
            and abs(here.floor_z_m - pose.floor_z_m) < 0.5
            and abs(wrap_angle(here.yaw_rad - pose.yaw_rad)) < MOVED_RAD
        )

    def reset(self) -> None:
        """Restores the initial pose of the agent, and the poses of the sensors."""
        self.set_state(self.initial_state)

    def eye(self, uuid: str, height_m: float) -> BodyPose:
        """Returns a robot's pose from which a camera at a height on its axis sees what a sensor sees.

        Args:
            uuid: of the sensor.
            height_m: of the camera that renders.
        """
        node = self.sensors[uuid].node
        right_m, up_m, back_m = node.translation.tolist()
        body = self.pose
        if not isinstance(body, BodyPose):
            body = BodyPose(body.x_m, body.y_m, body.yaw_rad, body.floor_z_m)
        eye_m = body.point(-back_m, -right_m, up_m)
        axes = _axes_of(node.rotation) @ body.axes  # rows: the camera's ahead, left, up
        return with_view(body, eye_m, axes, height_m)


def _axes_of(rotation: ArrayLike | Quaternion) -> NDArray[np.float64]:
    """Returns a rotation in Habitat's frame as rows (3, 3) ahead, left, up in the frame ahead, left, up of the body."""
    turned = quat_to_magnum(rotation_of(rotation))
    ahead, left, up = (
        np.asarray(turned.transform_vector(axis), np.float64)
        for axis in ((0.0, 0.0, -1.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    )
    return np.array([[-axis[2], -axis[0], axis[1]] for axis in (ahead, left, up)])
