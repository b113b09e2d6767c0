"""House and robot, compiled once: where an action becomes a motion."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.errors import EpisodeError, PhysicsError
from sim.geometry.pose import Pose
from sim.gl import mujoco
from sim.houses.house import House
from sim.houses.labels import Labels
from sim.interface import MPCAT40_ID, Action, wrap_angle
from sim.robot.body import FLOOR_MASK, PREFIX, Body
from sim.robot.conditions import NOMINAL, Conditions
from sim.robot.config import RobotConfig
from sim.robot.contacts import ContactLog
from sim.robot.drive import Driver, Motion
from sim.world.compile import compose

SAME_STOREY_M = 1.0
"""Floors less than this apart belong to one storey."""
_FLOOR = MPCAT40_ID["floor"]


class World:
    """One house with one robot in it. Deterministic: after `reset`, nothing of what happened before is left."""

    def __init__(self, house: House, *, robot: RobotConfig | None = None) -> None:
        """Compile the house with a robot.

        Raises:
            HouseError: a visible geom has no label, or the house cannot be compiled with a robot in it.
        """
        self.house = house
        self.config = robot or RobotConfig()
        self.robot = self.config.model
        _keep_log_out_of_working_directory()
        self.model, self.labels, self.rooms = compose(house, self.config)
        self.data = mujoco.MjData(self.model)
        self._body = Body.find(self.model, self.data)
        log = ContactLog(self.model, self.data, self.labels, self._body.hull_geoms)
        self._driver = Driver(self.config, self.model, self.data, self._body, log)
        self._storeys_m = _storey_floors(self.model, self.labels)
        self._floors = _floor_geoms(self.model, self.labels)
        self._motors = [self.model.actuator(f"{PREFIX}{side}_motor").id for side in ("left", "right")]
        self._floor_friction = self.model.geom_friction[self._floors, 0].copy()
        self._motor_gain = self.model.actuator_gainprm[self._motors, 0].copy()

    @property
    def pose(self) -> Pose:
        """The robot's true pose; its floor is that of the storey it stands on."""
        x, y, yaw, _, _ = self._body.state()
        z = self._body.z_m
        return Pose(x, y, wrap_angle(yaw), min(self._storeys_m, key=lambda floor: abs(floor - z)))

    @property
    def camera_pose(self) -> Pose:
        """Where the camera is mounted, over the floor: the robot's pose, moved ahead by the mount."""
        pose, ahead_m = self.pose, self.config.camera_forward_m
        if ahead_m == 0.0:
            return pose
        x_m, y_m = pose.x_m + ahead_m * math.cos(pose.yaw_rad), pose.y_m + ahead_m * math.sin(pose.yaw_rad)
        return Pose(x_m, y_m, pose.yaw_rad, pose.floor_z_m)

    def reset(self, start: Pose, conditions: Conditions = NOMINAL) -> None:
        """Everything as the house's file has it but for `conditions`, the robot at rest on the floor at `start`.

        Raises:
            EpisodeError: the hull would overlap something there, or there is no floor.
        """
        mujoco.mj_resetData(self.model, self.data)
        self._set_conditions(conditions)
        self._place_on_floor(start)
        self._require_room(start)
        physics = self.config.physics
        mujoco.mj_step(self.model, self.data, nstep=round(physics.settle_s / physics.timestep_s))
        if not any(not geoms.isdisjoint(self._wheels) for geoms, _ in self._contacts()):
            raise EpisodeError(f"{self._where(start)}: there is no floor at z = {start.floor_z_m:.2f} m.")
        self._driver.reset(start.yaw_rad)

    def move(self, action: Action) -> Motion:
        """Carry one action out in physics, from rest to rest. STOP is a motion of zero.

        Raises:
            PhysicsError: NaN, an unstable state, a robot that tipped over or fell.
        """
        z_before = self._body.z_m
        motion = self._driver.run(Action(action))
        self._require_physical(z_before)
        return motion

    def _set_conditions(self, conditions: Conditions) -> None:
        """Change floors and motors, from what they were when the world was compiled."""
        self.model.geom_friction[self._floors, 0] = self._floor_friction * conditions.floor_friction_scale
        self.model.actuator_gainprm[self._motors, 0] = self._motor_gain * conditions.motor_gain_scale

    def _place_on_floor(self, start: Pose) -> None:
        """Put the wheels on the highest floor (a rug) under the start."""
        z = start.floor_z_m
        for _ in range(3):
            self._body.place(start.x_m, start.y_m, z, start.yaw_rad)
            mujoco.mj_forward(self.model, self.data)
            sunk = max((depth for geoms, depth in self._contacts() if not geoms.isdisjoint(self._wheels)), default=0.0)
            if sunk <= 0.0005:
                break
            z += sunk

    def _require_room(self, start: Pose) -> None:
        """Refuse a start where the hull is inside something."""
        hull = frozenset(self._body.hull_geoms)
        overlaps = [
            (depth, geoms - hull)
            for geoms, depth in self._contacts()
            if not geoms.isdisjoint(hull) and depth > self.config.physics.max_overlap_m
        ]
        if overlaps:
            depth, (geom,) = max(overlaps, key=lambda overlap: overlap[0])
            raise EpisodeError(
                f"{self._where(start)}: the robot (radius {self.robot.radius_m} m) would stand {depth * 100:.1f} cm "
                f"inside '{self._name(geom)}'."
            )

    def _contacts(self) -> list[tuple[frozenset[int], float]]:
        """Pairs of geoms that touch now and how deep they are in one another, the hull's skin included."""
        contacts = self.data.contact
        depths = (contacts.includemargin - contacts.dist).tolist()
        return [(frozenset(pair), depth) for pair, depth in zip(contacts.geom.tolist(), depths, strict=True)]

    @property
    def _wheels(self) -> frozenset[int]:
        return frozenset(self._body.wheel_geoms)

    def _name(self, geom: int) -> str:
        instance = int(self.labels.geom_instance[geom])
        return self.labels.instances[instance].name if instance >= 0 else self.model.geom(geom).name

    def _where(self, start: Pose) -> str:
        return (
            f"Start ({start.x_m:.2f}, {start.y_m:.2f}) m, {np.degrees(start.yaw_rad):.0f} deg "
            f"in house '{self.house.name}'"
        )

    def _require_physical(self, z_before: float) -> None:
        """Refuse to go on from a state that no robot could be in."""
        fault = self._fault(z_before)
        if fault:
            raise PhysicsError(f"House '{self.house.name}' at {self.data.time:.2f} s: {fault}")

    def _fault(self, z_before: float) -> str:
        """What is unphysical about the state, "" if nothing is."""
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


def _keep_log_out_of_working_directory() -> None:
    """MuJoCo would write MUJOCO_LOG.TXT where the user happens to stand."""
    config = mujoco.MjLogConfig.get()
    config.logto_file = False
    config.set()


def _storey_floors(model: mujoco.MjModel, labels: Labels) -> tuple[float, ...]:
    """Heights of the storeys' floors, lowest first; a rug or a threshold is no storey."""
    floors: list[float] = []
    for top in sorted(_floor_tops(model, labels).tolist()):
        if not floors or top - floors[-1] >= SAME_STOREY_M:
            floors.append(top)
    return tuple(floors) or (0.0,)


def _floor_tops(model: mujoco.MjModel, labels: Labels) -> NDArray[np.float64]:
    """Heights of the tops of all static floors that carry wheels."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    floors = _floor_geoms(model, labels)
    ids = floors[model.geom_bodyid[floors] == 0]
    rise = np.abs(data.geom_xmat[ids, 6:9] * model.geom_size[ids]).sum(axis=1)
    rise[model.geom_type[ids] == mujoco.mjtGeom.mjGEOM_PLANE] = 0.0
    return data.geom_xpos[ids, 2] + rise


def _floor_geoms(model: mujoco.MjModel, labels: Labels) -> NDArray[np.intp]:
    """Numbers of the geoms that carry wheels."""
    return np.flatnonzero((labels.geom_category == _FLOOR) & (model.geom_contype == FLOOR_MASK[0]))
