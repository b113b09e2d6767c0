"""The robot's body as MJCF: two driven wheels on springs, two casters, a hull of two cylinders.

Robot frame: origin on the floor below the middle of the wheel axis, +x ahead, +y left, +z up.

Collision masks (contype / conaffinity; two geoms collide when the contype of one shares a bit with the conaffinity of
the other):

=================== ============ =========================================================
geoms               masks        collide with
=================== ============ =========================================================
floor               1 / 0        wheels, casters, hull, movable
covering            8 / 0        wheels, casters
static              2 / 0        wheels, casters, hull, movable
movable             2 / 7        floor, static, movable, wheels, casters, hull
wheels, casters     0 / 11       floor, covering, static, movable
hull                4 / 3        floor, static, movable
=================== ============ =========================================================
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.pose import BodyPose
from sim.core.interface import wrap_angle
from sim.gl import mujoco
from sim.houses.labels import COVER_MASK, ROBOT_PREFIX, geoms_of
from sim.robot.config import RobotConfig

SIDES = ("left", "right")
PREFIX = ROBOT_PREFIX
"""Prefix of every name of the robot in a compiled world."""
ROBOT_GROUP = 5
"""Geom group of the robot, which no camera renders."""

FLOOR_MASK = (1, 0)
STATIC_MASK = (2, 0)
MOVABLE_MASK = (2, 7)
WHEEL_MASK = (0, 3 | COVER_MASK[0])
HULL_MASK = (4, 3)

_CASTER_PRIORITY = 1000
"""The casters have no friction; this priority overrides the friction of every floor."""
HULL_PRIORITY = 1000
"""The friction and stiffness of the hull override those of the geoms it touches."""
GRAVITY_M_S2 = 9.81
_NET_FORCE = 3
"""The `reduce` option of a contact sensor that gives one net wrench of all contacts in the world frame."""


def built_in_robot_spec(config: RobotConfig) -> mujoco.MjSpec:
    """Returns the default robot, to be attached to the world body with the prefix `PREFIX`."""
    spec = mujoco.MjSpec()
    spec.modelname = "robot"
    base = spec.worldbody.add_body(name="base", fuse=0)
    add_joints(base, config)
    _set_inertia(base, config)
    for name, side in (("left", 1.0), ("right", -1.0)):
        _add_wheel(base, name, side, config)
        add_motor(spec, name, f"{name}_wheel", config)
    for name, end in (("front", 1.0), ("rear", -1.0)):
        _add_caster(base, name, end, config)
    _add_hull(base, config)
    add_touch_sensor(spec, "touch", mujoco.mjtObj.mjOBJ_BODY, "hull")
    for name in SIDES:
        add_touch_sensor(spec, f"tread_{name}", mujoco.mjtObj.mjOBJ_GEOM, f"{name}_tyre")
    return spec


def add_joints(base: mujoco.MjsBody, config: RobotConfig) -> None:
    """Adds the joints of the base: a free joint, or three slides and a vertical hinge."""
    if config.base == "free":
        base.add_freejoint(name="free")
        return
    for name, axis in (("x", (1, 0, 0)), ("y", (0, 1, 0)), ("z", (0, 0, 1))):
        base.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    base.add_joint(name="yaw", type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0, 0, 1))


def _set_inertia(base: mujoco.MjsBody, config: RobotConfig) -> None:
    """Sets the mass without wheels and the inertia of a solid cylinder twice as high as its centre of mass."""
    body, wheels = config.body, config.wheels
    mass = body.mass_kg - 2.0 * wheels.mass_kg
    com_z = (body.mass_kg * body.com_height_m - 2.0 * wheels.mass_kg * wheels.radius_m) / mass
    across = mass * (3.0 * body.radius_m**2 + (2.0 * com_z) ** 2) / 12.0
    base.mass, base.ipos = mass, (0.0, 0.0, com_z)
    base.inertia = (across, across, 0.5 * mass * body.radius_m**2)
    base.explicitinertial = True


def _add_wheel(base: mujoco.MjsBody, name: str, side: float, config: RobotConfig) -> None:
    """Adds one wheel. Its tyre collides as a sphere, which has exact contacts with planes and boxes."""
    wheels = config.wheels
    radius = wheels.radius_m
    wheel = base.add_body(name=f"{name}_wheel", pos=(0.0, side * wheels.half_track_m, radius))
    if config.base == "free":
        _add_spring(wheel, name, config)
    wheel.add_joint(
        name=f"{name}_wheel", type=mujoco.mjtJoint.mjJNT_HINGE, axis=(0, 1, 0), armature=wheels.armature_kg_m2
    )
    spin = 0.5 * wheels.mass_kg * radius**2
    wheel.mass, wheel.ipos, wheel.inertia = wheels.mass_kg, (0.0, 0.0, 0.0), (0.5 * spin, spin, 0.5 * spin)
    wheel.explicitinertial = True
    add_tyre(wheel, name, radius)


def _add_spring(wheel: mujoco.MjsBody, name: str, config: RobotConfig) -> None:
    """Adds the vertical spring of a wheel, which presses it to the ground with its share of the robot's weight."""
    wheels = config.wheels
    load_n = (0.5 * wheels.load_share * config.body.mass_kg - wheels.mass_kg) * GRAVITY_M_S2
    wheel.add_joint(
        name=f"{name}_spring",
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=(0, 0, 1),
        stiffness=wheels.spring_n_m,
        damping=wheels.spring_damping_n_s_m,
        springref=-load_n / wheels.spring_n_m,
        range=(-wheels.spring_travel_m, wheels.spring_travel_m),
        limited=mujoco.mjtLimited.mjLIMITED_TRUE,
    )


def add_tyre(
    wheel: mujoco.MjsBody,
    name: str,
    radius_m: float,
    centre_m: Sequence[float] | NDArray[np.float64] = (0.0, 0.0, 0.0),
) -> mujoco.MjsGeom:
    """Adds the collision geom of a wheel and returns it. Its friction is 0: the larger one of the floor counts."""
    return wheel.add_geom(
        name=f"{name}_tyre",
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        size=(radius_m, 0, 0),
        pos=centre_m,
        mass=0.0,
        friction=(0.0, 0.0, 0.0),
        condim=3,
        solref=(0.005, 1.0),
        solmix=1e6,
        contype=WHEEL_MASK[0],
        conaffinity=WHEEL_MASK[1],
        group=ROBOT_GROUP,
        rgba=(0.1, 0.1, 0.1, 1.0),
    )


def add_motor(spec: mujoco.MjSpec, name: str, joint: str, config: RobotConfig) -> mujoco.MjsActuator:
    """Adds a motor `<name>_motor` that drives a wheel's joint at the commanded speed with limited torque."""
    wheels = config.wheels
    motor = spec.add_actuator(name=f"{name}_motor", trntype=mujoco.mjtTrn.mjTRN_JOINT, target=joint, forcelimited=1)
    motor.set_to_velocity(kv=wheels.motor_gain_nm_s)
    motor.forcerange = (-wheels.max_torque_nm, wheels.max_torque_nm)
    return motor


def _add_caster(base: mujoco.MjsBody, name: str, end: float, config: RobotConfig) -> None:
    """Adds one caster. With a planar base it does not collide, or it would lift the wheels at the edge of a rug."""
    wheels = config.wheels
    mask = WHEEL_MASK if config.base == "free" else (0, 0)
    base.add_geom(
        name=f"{name}_caster",
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        size=(wheels.caster_radius_m, 0, 0),
        pos=(end * wheels.caster_offset_m, 0.0, wheels.caster_radius_m + wheels.caster_gap_m),
        condim=1,
        priority=_CASTER_PRIORITY,
        contype=mask[0],
        conaffinity=mask[1],
        group=ROBOT_GROUP,
        rgba=(0.1, 0.1, 0.1, 1.0),
    )


def _add_hull(base: mujoco.MjsBody, config: RobotConfig) -> None:
    """Adds the two cylinders of the hull."""
    body = config.body
    hull = base.add_body(name="hull", fuse=0)  # its own body, so that one contact sensor measures both cylinders
    for name, bottom, top in (("lower", body.clearance_m, body.waist_m), ("upper", body.waist_m, body.height_m)):
        hull.add_geom(
            name=f"{name}_hull",
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=(body.radius_m - body.skin_m, 0.5 * (top - bottom) - body.skin_m, 0),
            margin=body.skin_m,
            pos=(0.0, 0.0, 0.5 * (top + bottom)),
            mass=0.0,
            friction=(body.friction, 0.0, 0.0),
            priority=HULL_PRIORITY,
            solref=(body.contact_time_s, 1.0),
            contype=HULL_MASK[0],
            conaffinity=HULL_MASK[1],
            group=ROBOT_GROUP,
            rgba=(0.8, 0.8, 0.85, 1.0),
        )


def add_touch_sensor(spec: mujoco.MjSpec, name: str, part_type: mujoco.mjtObj, part: str) -> None:
    """Adds a sensor of all contacts of a body or geom.

    `Body` reads all sensors with the name prefix `touch`, and those of the tyres, `tread_left` and `tread_right`.
    """
    fields = (1 << int(mujoco.mjtConDataField.mjCONDATA_FOUND)) | (1 << int(mujoco.mjtConDataField.mjCONDATA_FORCE))
    spec.add_sensor(
        name=name,
        type=mujoco.mjtSensor.mjSENS_CONTACT,
        objtype=part_type,
        objname=part,
        intprm=[fields, _NET_FORCE, 1],
    )


@dataclass(frozen=True)
class Body:
    """The robot's state and controls in a compiled world: views into the world's `MjData`."""

    planar: bool
    qpos: NDArray[np.float64]  # (4,) x, y, z, yaw or (7,) position and quaternion
    qvel: NDArray[np.float64]  # (4,) or (6,): a free joint's angular part is in the body's frame
    ctrl: NDArray[np.float64]  # (2,) left and right wheel, commanded rad/s
    touches: NDArray[np.float64]  # (parts, 4) for each touch sensor, as `touch` has it for the sum
    treads: NDArray[np.float64]  # (2, 4) the same of the left and of the right tyre
    hull_geoms: tuple[int, ...]
    wheel_qpos: tuple[NDArray[np.float64], NDArray[np.float64]]  # (1,) angle of the left and the right wheel, rad
    wheel_qvel: tuple[NDArray[np.float64], NDArray[np.float64]]  # (1,) the same, rad/s
    wheel_signs: tuple[float, float]
    """1 for a wheel with a positive joint velocity when the robot drives ahead, else -1."""
    tyre_geoms: tuple[int, ...]
    wheel_geoms: tuple[int, ...]
    """Tyres and casters; for a third-party body also its visual geoms."""

    @staticmethod
    def find(model: mujoco.MjModel, data: mujoco.MjData) -> Body:
        """Finds the parts of the robot by their names."""
        base = model.body(PREFIX + "base").id
        joint = model.body_jntadr[base]
        planar = model.body_jntnum[base] == 4
        q, v = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
        motors = [model.actuator(f"{PREFIX}{name}_motor").id for name in SIDES]
        wheels = [int(model.actuator_trnid[motor, 0]) for motor in motors]
        places = [(int(model.jnt_qposadr[wheel]), int(model.jnt_dofadr[wheel])) for wheel in wheels]
        sensors = [i for i in range(model.nsensor) if model.sensor(i).name.startswith(PREFIX + "touch")]
        touch = int(model.sensor_adr[sensors[0]])  # the sensors are consecutive
        tread = int(model.sensor(f"{PREFIX}tread_left").adr[0])
        geoms = np.flatnonzero(geoms_of(model, PREFIX)).tolist()
        hull = tuple(geom for geom in geoms if model.geom_contype[geom] == HULL_MASK[0])
        return Body(
            planar=bool(planar),
            qpos=data.qpos[q : q + (4 if planar else 7)],
            qvel=data.qvel[v : v + (4 if planar else 6)],
            ctrl=data.ctrl[motors[0] : motors[0] + 2],
            touches=data.sensordata[touch : touch + 4 * len(sensors)].reshape(-1, 4),
            treads=data.sensordata[tread : tread + 8].reshape(2, 4),
            hull_geoms=hull,
            tyre_geoms=tuple(geom for geom in geoms if model.geom(geom).name.endswith("_tyre")),
            wheel_qpos=(data.qpos[places[0][0] :][:1], data.qpos[places[1][0] :][:1]),
            wheel_qvel=(data.qvel[places[0][1] :][:1], data.qvel[places[1][1] :][:1]),
            wheel_signs=(float(model.actuator_gear[motors[0], 0]), float(model.actuator_gear[motors[1], 0])),
            wheel_geoms=tuple(geom for geom in geoms if geom not in hull),
        )

    @property
    def touch(self) -> NDArray[np.float64]:
        """Number of hull contacts, then the net force of the hull on other geoms in the world frame, N; (4,)."""
        return self.touches[0] if len(self.touches) == 1 else self.touches.sum(axis=0)

    def place(self, x_m: float, y_m: float, z_m: float, yaw_rad: float) -> None:
        """Writes a pose into the state; the caller must run `mj_forward`."""
        if self.planar:
            self.qpos[:] = (x_m, y_m, z_m, wrap_angle(yaw_rad))
        else:
            self.qpos[:] = (x_m, y_m, z_m, math.cos(0.5 * yaw_rad), 0.0, 0.0, math.sin(0.5 * yaw_rad))

    def state(self) -> tuple[float, float, float, float, float]:
        """Returns x, y (m), yaw (rad, not wrapped for a planar base), forward speed (m/s) and turn rate (rad/s)."""
        if self.planar:
            x, y, _, yaw = self.qpos.tolist()
            vx, vy, _, rate = self.qvel.tolist()
        else:
            x, y, _, *quat = self.qpos.tolist()
            vx, vy, _, _, _, rate = self.qvel.tolist()
            yaw = _yaw_of(quat)
        return x, y, yaw, math.cos(yaw) * vx + math.sin(yaw) * vy, rate

    def pose_above(self, floor_z_m: float) -> BodyPose:
        """Returns the pose of the robot frame on a floor of this height, as it is now."""
        x, y, z = self.qpos[:3].tolist()
        if self.planar:
            return BodyPose(x, y, wrap_angle(float(self.qpos[3])), floor_z_m, z - floor_z_m)
        qw, qx, qy, qz = self.qpos[3:7].tolist()
        pitch = math.asin(max(-1.0, min(1.0, 2.0 * (qw * qy - qx * qz))))
        roll = math.atan2(2.0 * (qw * qx + qy * qz), 1.0 - 2.0 * (qx * qx + qy * qy))
        return BodyPose(x, y, _yaw_of([qw, qx, qy, qz]), floor_z_m, z - floor_z_m, pitch, roll)

    def ahead_and_up(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Returns the body's x and z axes in the world."""
        if self.planar:
            yaw = float(self.qpos[3])
            return (math.cos(yaw), math.sin(yaw), 0.0), (0.0, 0.0, 1.0)
        w, x, y, z = self.qpos[3:7].tolist()
        ahead = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)
        return ahead, (2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y))

    @property
    def yaw_rad(self) -> float:
        """Heading; not wrapped for a planar base."""
        return float(self.qpos[3]) if self.planar else _yaw_of(self.qpos[3:7].tolist())

    @property
    def turn_rate_rad_s(self) -> float:
        """Turn rate about the robot's axis, counter-clockwise."""
        return float(self.qvel[-1])

    def wheel_angles(self) -> tuple[float, float]:
        """Returns the angles of the left and the right wheel, rad; they grow when the robot drives ahead."""
        (left, right), (a, b) = self.wheel_qpos, self.wheel_signs
        return a * left.item(), b * right.item()

    def wheel_speeds(self) -> tuple[float, float]:
        """Returns the turn rates of the left and the right wheel, rad/s."""
        (left, right), (a, b) = self.wheel_qvel, self.wheel_signs
        return a * left.item(), b * right.item()

    @property
    def z_m(self) -> float:
        """Height of the robot frame's origin."""
        return float(self.qpos[2])

    @property
    def tilt_rad(self) -> float:
        """Angle between the robot's axis and the vertical."""
        if self.planar:
            return 0.0
        _, qx, qy, _ = self.qpos[3:7]
        return math.acos(max(-1.0, min(1.0, 1.0 - 2.0 * float(qx * qx + qy * qy))))


def _yaw_of(quat: list[float]) -> float:
    w, x, y, z = quat
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
