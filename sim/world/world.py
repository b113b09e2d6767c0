"""The simulated world: one house with one robot, compiled together; it turns actions into motions."""

from __future__ import annotations

import math

import numpy as np

from sim.errors import EpisodeError, PhysicsError
from sim.geometry.pose import Pose
from sim.gl import mujoco
from sim.houses.house import House
from sim.interface import Action, SuccessRule, wrap_angle
from sim.robot.body import PREFIX, Body
from sim.robot.conditions import NOMINAL, Conditions
from sim.robot.config import RobotConfig
from sim.robot.contacts import ContactLog
from sim.robot.drive import Driver, Motion
from sim.world.compile import compile_world
from sim.world.storeys import floor_geoms, storey_floors

_PLACE_ATTEMPTS = 3
"""How often `reset` lifts the wheels out of a floor that they overlap; each rug on a rug needs one more."""
_FLOOR_CONTACT_M = 0.0005
"""Wheels that overlap the floor by at most this stand on it."""


class World:
    """One house with one robot in it. It is deterministic: `reset` removes every trace of earlier episodes."""

    def __init__(self, house: House, *, robot: RobotConfig | None = None, rule: SuccessRule | None = None) -> None:
        """Compiles the house with a robot.

        Args:
            house: it is not changed.
            robot: the default robot when None.
            rule: says how far apart storeys are; the default rule when None.

        Raises:
            HouseError: a visible geom has no label, or the house cannot be compiled with a robot in it.
        """
        self.house = house
        self.config = robot or RobotConfig()
        self.robot = self.config.model
        self.rule = rule or SuccessRule()
        _disable_log_file()
        self.model, self.labels, self.rooms = compile_world(house, self.config)
        self.data = mujoco.MjData(self.model)
        self._body = Body.find(self.model, self.data)
        log = ContactLog(self.model, self.data, self.labels, self._body.hull_geoms)
        self._driver = Driver(self.config, self.model, self.data, self._body, log)
        self._storeys_m = storey_floors(self.model, self.labels, self.rule.same_storey_m)
        self._floors = floor_geoms(self.model, self.labels)
        self._motors = [self.model.actuator(f"{PREFIX}{side}_motor").id for side in ("left", "right")]
        self._floor_friction = self.model.geom_friction[self._floors, 0].copy()
        self._motor_gain = self.model.actuator_gainprm[self._motors, 0].copy()

    @property
    def pose(self) -> Pose:
        """The robot's true pose; its `floor_z_m` is the floor height of the robot's storey."""
        x, y, yaw, _, _ = self._body.state()
        z = self._body.z_m
        return Pose(x, y, wrap_angle(yaw), min(self._storeys_m, key=lambda floor: abs(floor - z)))

    @property
    def camera_pose(self) -> Pose:
        """The robot's pose, moved ahead to the point on the floor below the camera."""
        pose, ahead_m = self.pose, self.config.camera_forward_m
        if ahead_m == 0.0:
            return pose
        x_m, y_m = pose.x_m + ahead_m * math.cos(pose.yaw_rad), pose.y_m + ahead_m * math.sin(pose.yaw_rad)
        return Pose(x_m, y_m, pose.yaw_rad, pose.floor_z_m)

    def reset(self, start: Pose, conditions: Conditions = NOMINAL) -> None:
        """Restores the state of the house's file, applies `conditions`, and puts the robot at rest at `start`.

        Raises:
            EpisodeError: the hull would overlap an object there, or there is no floor.
        """
        mujoco.mj_resetData(self.model, self.data)
        self._set_conditions(conditions)
        self._place_on_floor(start)
        self._require_no_overlap(start)
        physics = self.config.physics
        mujoco.mj_step(self.model, self.data, nstep=round(physics.settle_s / physics.timestep_s))
        if not any(not geoms.isdisjoint(self._wheels) for geoms, _ in self._contacts()):
            raise EpisodeError(f"{self._describe(start)}: there is no floor at z = {start.floor_z_m:.2f} m.")
        self._driver.reset(start.yaw_rad)

    def move(self, action: Action) -> Motion:
        """Performs one action in physics, from rest to rest. STOP is a motion of zero.

        Raises:
            PhysicsError: NaN, an unstable state, a robot that tipped over or fell.
        """
        z_before = self._body.z_m
        motion = self._driver.run(Action(action))
        self._require_physical(z_before)
        return motion

    def _set_conditions(self, conditions: Conditions) -> None:
        """Scales floor friction and motor gains, relative to their values in the compiled world."""
        self.model.geom_friction[self._floors, 0] = self._floor_friction * conditions.floor_friction_scale
        self.model.actuator_gainprm[self._motors, 0] = self._motor_gain * conditions.motor_gain_scale

    def _place_on_floor(self, start: Pose) -> None:
        """Puts the wheels on the highest floor (for example a rug) at the start."""
        z = start.floor_z_m
        for _ in range(_PLACE_ATTEMPTS):
            self._body.place(start.x_m, start.y_m, z, start.yaw_rad)
            mujoco.mj_forward(self.model, self.data)
            depth = max((depth for geoms, depth in self._contacts() if not geoms.isdisjoint(self._wheels)), default=0.0)
            if depth <= _FLOOR_CONTACT_M:
                break
            z += depth

    def _require_no_overlap(self, start: Pose) -> None:
        """Raises an EpisodeError when the hull overlaps another geom at the start."""
        hull = frozenset(self._body.hull_geoms)
        overlaps = [
            (depth, geoms - hull)
            for geoms, depth in self._contacts()
            if not geoms.isdisjoint(hull) and depth > self.config.physics.max_overlap_m
        ]
        if overlaps:
            depth, (geom,) = max(overlaps, key=lambda overlap: overlap[0])
            raise EpisodeError(
                f"{self._describe(start)}: the robot (radius {self.robot.radius_m} m) would stand {depth * 100:.1f} cm "
                f"inside '{self._name(geom)}'."
            )

    def _contacts(self) -> list[tuple[frozenset[int], float]]:
        """Returns the pairs of geoms in contact and their depth of overlap in metres, the hull's skin included."""
        contacts = self.data.contact
        depths = (contacts.includemargin - contacts.dist).tolist()
        return [(frozenset(pair), depth) for pair, depth in zip(contacts.geom.tolist(), depths, strict=True)]

    @property
    def _wheels(self) -> frozenset[int]:
        return frozenset(self._body.wheel_geoms)

    def _name(self, geom: int) -> str:
        instance = int(self.labels.geom_instance[geom])
        return self.labels.instances[instance].name if instance >= 0 else self.model.geom(geom).name

    def _describe(self, start: Pose) -> str:
        return (
            f"Start ({start.x_m:.2f}, {start.y_m:.2f}) m, {np.degrees(start.yaw_rad):.0f} deg "
            f"in house '{self.house.name}'"
        )

    def _require_physical(self, z_before: float) -> None:
        """Raises a PhysicsError when the state after an action is not physical."""
        fault = self._fault(z_before)
        if fault:
            raise PhysicsError(f"House '{self.house.name}' at {self.data.time:.2f} s: {fault}")

    def _fault(self, z_before: float) -> str:
        """Returns a sentence about an unphysical state; "" for a physical one."""
        physics = self.config.physics
        for kind, warning in enumerate(self.data.warning):
            if warning.number:
                return mujoco.mju_warningText(kind, int(warning.lastinfo))
        if not np.isfinite(self.data.qpos).all():
            return "a position is not finite."
        if self._body.tilt_rad > physics.max_tilt_rad:
            return f"the robot tipped over, it leans {np.degrees(self._body.tilt_rad):.0f} deg."
        fallen_m = z_before - self._body.z_m
        if fallen_m > physics.max_drop_m:
            return f"the robot fell {fallen_m:.2f} m."
        return ""


def _disable_log_file() -> None:
    """Stops MuJoCo from writing MUJOCO_LOG.TXT into the working directory."""
    config = mujoco.MjLogConfig.get()
    config.logto_file = False
    config.set()
