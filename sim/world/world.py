"""The simulated world: one house with one robot, compiled together; it turns actions into motions."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sim.core.errors import ConfigError, EpisodeError, PhysicsError
from sim.core.geometry.pose import BodyPose, Pose, with_view
from sim.core.interface import LOOK_RAD, MAX_TILT_RAD, Action, CameraModel, SuccessRule
from sim.gl import mujoco
from sim.houses.glass import clear_panes, picture_panes
from sim.houses.house import House
from sim.houses.labels import cover_geoms
from sim.robot.body import Body
from sim.robot.conditions import NOMINAL, Conditions
from sim.robot.config import RobotConfig
from sim.robot.contacts import ContactLog
from sim.robot.drive import Driver, Motion
from sim.robot.odometry import Odometry
from sim.robot.velocity import Velocity, VelocityDrive
from sim.world.compile import compile_world, world_key
from sim.world.freespace import FreeSpace
from sim.world.kinematic import Glide, performed
from sim.world.storeys import floor_geoms, floor_levels
from sim.world.support import FloorSupport

_PLACE_ATTEMPTS = 3
"""Number of times that `reset` lifts the wheels out of a floor that they overlap; each rug on a rug needs one more."""
_UPRIGHT_RAD = math.radians(2.3)
"""A body that leans less than this stands on one floor."""
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
        self.key = world_key(house, self.config)
        """Names the house and the robot in the user's cache (`sim.core.store`); None: they are not files."""
        self.model, self.labels, self.rooms = compile_world(house, self.config, key=self.key)
        self.data = mujoco.MjData(self.model)
        self.glass = picture_panes(self.model, self.labels) | clear_panes(self.model, self.labels)
        """(ngeom,) True for panes of windows."""
        self._body = Body.find(self.model, self.data)
        log = ContactLog(self.model, self.data, self.labels, self._body)
        self._odometry = Odometry(self.config, self.model, self.data, self._body)
        self._driver = Driver(self.config, self.model, self.data, self._body, self._odometry, log)
        self._velocity_drive = VelocityDrive(self.config, self.model, self.data, self._body, self._odometry, log)
        self.floor_levels_m = floor_levels(self.model, self.labels)
        """Heights of the levels of floors, from the lowest on."""
        self._floors = floor_geoms(self.model, self.labels)
        self._support = FloorSupport(self.model, self.data, self._floors, self.config)
        self._ground = np.concatenate([self._floors, np.flatnonzero(cover_geoms(self.model))])
        self._ground_friction = self.model.geom_friction[self._ground, 0].copy()
        self._stood_at_m = 0.0  # the height of the body when it was last upright after a motion
        self._start, self._conditions = Pose(0.0, 0.0, 0.0), NOMINAL
        self._glides: dict[float, Glide] = {}
        self.tilt_rad = 0.0
        """Tilt of the camera; positive: up."""
        self.camera_height_m = CameraModel().height_m
        """The camera tilts about this point on its axis above the floor."""

    @property
    def pose(self) -> Pose:
        """The robot's true pose; its `floor_z_m` is the height of the level of floors that the robot is on."""
        body = self.body_pose
        return Pose(body.x_m, body.y_m, body.yaw_rad, body.floor_z_m)

    @property
    def body_pose(self) -> BodyPose:
        """The same, with the lean of the body and the height of the robot frame above that floor."""
        z = self._body.z_m
        return self._body.pose_above(min(self.floor_levels_m, key=lambda floor: abs(floor - z)))

    @property
    def odometry(self) -> Pose:
        """The robot's pose by its own odometry, relative to the start of the episode; without physics, the true one."""
        return self._odometry.since_start if self._has_physics else self.pose.relative_to(self._start)

    @property
    def camera_pose(self) -> BodyPose:
        """The body's pose, moved ahead along its own axis to the point that is below an upright robot's camera.

        With a tilt, it is the pose of a body that leans so that the camera on its axis has the tilted view.
        """
        pose, ahead_m = self.body_pose, self.config.camera_forward_m
        if ahead_m != 0.0:
            x_m, y_m, z_m = pose.point(ahead_m, 0.0, 0.0).tolist()
            pose = replace(pose, x_m=x_m, y_m=y_m, rise_m=z_m - pose.floor_z_m)
        if self.tilt_rad == 0.0:
            return pose
        tilted = BodyPose(0.0, 0.0, 0.0, pitch_rad=-self.tilt_rad).axes @ pose.axes
        return with_view(pose, pose.point(0.0, 0.0, self.camera_height_m), tilted, self.camera_height_m)

    def reset(self, start: Pose, conditions: Conditions = NOMINAL) -> None:
        """Restores the state of the house's file, applies `conditions`, and puts the robot at rest at `start`.

        Raises:
            EpisodeError: the hull would overlap an object there, or the floor is missing.
        """
        self.restore()
        self.model.geom_friction[self._ground, 0] = self._ground_friction * conditions.floor_friction_scale
        self._conditions = conditions
        self.put(start)

    def restore(self) -> None:
        """Restores the state of the house's file; the robot is then at the origin, its camera level."""
        self.tilt_rad = 0.0
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)

    def put(self, start: Pose) -> None:
        """Puts the robot at rest at `start`, where it begins to count its motion; objects stay where they are.

        Raises:
            EpisodeError: the hull would overlap an object there, or the floor is missing.
        """
        self._start = start
        self._driver.brake()
        self._body.qvel[:] = 0.0
        self._place_on_floor(start)
        self._require_no_overlap(start)
        physics = self.config.physics
        mujoco.mj_step(self.model, self.data, nstep=round(physics.settle_s / physics.timestep_s))
        if not any(not geoms.isdisjoint(self._wheels) for geoms, _ in self._contacts()):
            raise EpisodeError(f"{self._describe(start)}: there is no floor at z = {start.floor_z_m:.2f} m.")
        self._note_floor()
        self._driver.reset(start.yaw_rad, self._conditions)
        self._velocity_drive.reset(self._conditions)

    def move(self, action: Action) -> Motion:
        """Performs one action in physics, from rest to rest. STOP and a look are motions of zero.

        `fell` of the motion is True when the robot is lower than before by more than a step, or when its centre of mass
        has left the hull of its supported wheels and casters: it has driven over an edge. A planar base cannot tip; it
        would stay on the edge with its hull, which a real robot does not do.

        Raises:
            PhysicsError: NaN, an unstable state, or a robot that tipped over without an edge.
        """
        if action in (Action.LOOK_UP, Action.LOOK_DOWN):
            turned = self.tilt_rad + (LOOK_RAD if action == Action.LOOK_UP else -LOOK_RAD)
            self.tilt_rad = max(-MAX_TILT_RAD, min(MAX_TILT_RAD, turned))
            return replace(self.move(Action.STOP), action=Action(action))
        if not self._has_physics:
            return self._glide(Action(action))
        z_before = self._body.z_m
        return self._checked(self._driver.run(Action(action)), z_before)

    def hold(self, command: Velocity, period_s: float) -> Motion:
        """Holds a velocity for a period (`sim.robot.velocity`); the robot need not be at rest before or after.

        `fell` and errors are those of `move`. An episode is driven either by `move` or by `hold`.

        Raises:
            ConfigError: `RobotConfig.motion` is without physics.
        """
        if not self._has_physics:
            raise ConfigError(f"Velocities need the motion 'contacts'; this robot has '{self.config.motion}'.")
        z_before = self._body.z_m
        return self._checked(self._velocity_drive.run(command, period_s), z_before)

    def free_space(self, floor_z_m: float = 0.0) -> FreeSpace:
        """Returns the free space of a storey in the current state; the robot is not an obstacle."""
        return FreeSpace(
            self.model,
            self.data,
            self.labels,
            rooms=self.rooms,
            robot=self.robot,
            rule=self.rule,
            floor_z_m=floor_z_m,
        )

    @property
    def _has_physics(self) -> bool:
        return self.config.motion == "contacts"

    def _glide(self, action: Action) -> Motion:
        """Performs one action without physics, over the free space as it was at the first one on a storey.

        The state is then that of a body at rest, which the sensor `imu` reads.
        """
        pose, rise_m = self.pose, self.body_pose.rise_m
        if pose.floor_z_m not in self._glides:
            self._glides[pose.floor_z_m] = Glide(self.free_space(pose.floor_z_m))
        glide, sliding = self._glides[pose.floor_z_m], self.config.motion == "sliding"
        after, motion = performed(glide, pose, action, self.config.drive, sliding=sliding)
        self._body.place(after.x_m, after.y_m, after.floor_z_m + rise_m, after.yaw_rad)
        mujoco.mj_forward(self.model, self.data)
        self.data.qacc[:] = 0.0  # those of wheels inside a rug, and of a body above the floor
        return motion

    def _checked(self, motion: Motion, z_before: float) -> Motion:
        """Returns the motion, with `fell` set; see `move`."""
        self._require_finite()
        if motion.action != Action.STOP and self._has_fallen(z_before):
            return replace(motion, fell=True)
        self._require_upright()
        self._note_floor()
        return motion

    def _note_floor(self) -> None:
        """Notes the height of an upright body: that of the floor that carries it."""
        if self._body.tilt_rad <= _UPRIGHT_RAD:
            self._stood_at_m = self._body.z_m

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

    def _has_fallen(self, z_before: float) -> bool:
        """Returns whether the robot is falling, or has fallen, from the floor on which it stood at `z_before`."""
        x, y, yaw, _, _ = self._body.state()
        z, physics = self._body.z_m, self.config.physics
        if z_before - z > physics.max_drop_m:
            return True
        if self._body.tilt_rad > physics.max_tilt_rad:  # the origin of a body that lies on its side is not at the floor
            return self._support.is_beyond_an_edge(x, y, self._stood_at_m, yaw)
        return not self._support.carries(x, y, z, yaw)

    def _require_finite(self) -> None:
        """Raises a PhysicsError when MuJoCo gave a warning, or a position is not finite."""
        warnings = self.data.warning
        for kind in np.flatnonzero(warnings.number).tolist():
            raise self._physics_error(mujoco.mju_warningText(kind, int(warnings.lastinfo[kind])))
        if not np.isfinite(self.data.qpos).all():
            raise self._physics_error("a position is not finite.")

    def _require_upright(self) -> None:
        """Raises a PhysicsError when the robot leans too much."""
        if self._body.tilt_rad > self.config.physics.max_tilt_rad:
            lean_deg = np.degrees(self._body.tilt_rad)
            raise self._physics_error(f"the robot tipped over, it leans {lean_deg:.0f} deg.")

    def _physics_error(self, fault: str) -> PhysicsError:
        return PhysicsError(f"House '{self.house.name}' at {self.data.time:.2f} s: {fault}")
