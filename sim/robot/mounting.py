"""Builds the specification of the configured robot: the default one, or a third-party body on its base and motors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from sim.core.errors import ConfigError, HouseError
from sim.gl import mujoco
from sim.houses.labels import RENDERED_GROUPS
from sim.robot.body import (
    HULL_MASK,
    HULL_PRIORITY,
    ROBOT_GROUP,
    SIDES,
    add_joints,
    add_motor,
    add_touch_sensor,
    add_tyre,
    built_in_robot_spec,
)
from sim.robot.config import BodyConfig, RobotConfig, RobotFile
from sim.robot.measurement import RobotMeasurements, Wheel, collision_geoms, measure, read_body, turn_to_x

_AXLE_KG = 0.01
"""Mass of the body of a side with several wheels, on which the motor acts."""
FILE_PREFIX = "file/"
"""Prefix of the names that come from the file, after `PREFIX`."""


def robot_spec(config: RobotConfig) -> mujoco.MjSpec:
    """Returns the robot of a config, to be attached to the world body with the prefix `PREFIX`.

    Raises:
        HouseError: the robot's file has changed since the config was made, and it cannot be used any more.
    """
    if config.file is None:
        return built_in_robot_spec(config)
    try:
        return _third_party_robot_spec(config, config.file)
    except ConfigError as error:
        raise HouseError(f"Robot '{config.file.path}': {error}") from None


def _third_party_robot_spec(config: RobotConfig, file: RobotFile) -> mujoco.MjSpec:
    measured = measure(file, config.wheels.radius_m)
    body_spec, root = read_body(file)
    hull = _prepare_body(body_spec, root, file, config, measured)
    spec = mujoco.MjSpec()
    spec.modelname = "robot"
    base = spec.worldbody.add_body(name="base", fuse=0)
    add_joints(base, config)
    x, y, z = measured.middle_m.tolist()
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, turn_to_x(file).ravel())
    frame = base.add_frame(pos=(-x, -y, config.wheels.radius_m - z), quat=quat)
    frame.attach_body(root, FILE_PREFIX, "")
    if not hull:
        _add_cylinder(base, config.body)
    for name, wheel, side in zip(SIDES, measured.wheels, measured.sides, strict=True):
        if file.skids:
            _add_axle(spec, base, name, side, config)
        else:
            motor = add_motor(spec, name, FILE_PREFIX + wheel.joint, config)
            motor.gear[0] = wheel.sign
    for number, part in enumerate([FILE_PREFIX + part for part in hull] or ["hull"]):
        add_touch_sensor(spec, f"touch_{number}", mujoco.mjtObj.mjOBJ_GEOM, part)
    for name in SIDES:
        tyre = f"{name}_tyre" if file.skids else f"{FILE_PREFIX}{name}_tyre"
        add_touch_sensor(spec, f"tread_{name}", mujoco.mjtObj.mjOBJ_GEOM, tyre)
    return spec


def _add_axle(
    spec: mujoco.MjSpec, base: mujoco.MjsBody, name: str, wheels: Sequence[Wheel], config: RobotConfig
) -> None:
    """Adds the tyre and the motor of a side with several wheels, and couples the wheels of the file to it.

    Such a robot turns about the middle of its wheels. Those in front of it scrub to one side and those behind it to the
    other, so that the force of the side acts in its middle, where the tyre is; the scrub itself is not simulated.
    """
    y_m = config.wheels.half_track_m if name == SIDES[0] else -config.wheels.half_track_m
    axle = base.add_body(name=f"{name}_axle", pos=(0.0, y_m, config.wheels.radius_m))
    axle.mass, axle.inertia, axle.explicitinertial = _AXLE_KG, (_AXLE_KG * config.wheels.radius_m**2,) * 3, True
    axle.add_joint(
        name=f"{name}_wheel",
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=(0, 1, 0),
        armature=config.wheels.armature_kg_m2,
    )
    add_tyre(axle, name, config.wheels.radius_m).rgba[3] = 0.0  # viewers show the wheels of the file
    add_motor(spec, name, f"{name}_wheel", config)
    for wheel in wheels:
        belt = spec.add_equality(type=mujoco.mjtEq.mjEQ_JOINT, name1=FILE_PREFIX + wheel.joint, name2=f"{name}_wheel")
        belt.data[:2] = 0.0, wheel.sign


def _add_cylinder(base: mujoco.MjsBody, body: BodyConfig) -> None:
    """Adds the upright cylinder that is the body of a robot without collision geoms."""
    bottom_m, top_m = body.clearance_m + body.skin_m, body.height_m - body.skin_m
    geom = base.add_geom(
        name="hull",
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=(body.radius_m - body.skin_m, 0.5 * (top_m - bottom_m), 0),
        pos=(0.0, 0.0, 0.5 * (top_m + bottom_m)),
        mass=0.0,
        group=ROBOT_GROUP,
        rgba=(0.0, 0.0, 0.0, 0.0),
    )
    _set_hull_contact(geom, body)


def _prepare_body(
    spec: mujoco.MjSpec, root: mujoco.MjsBody, file: RobotFile, config: RobotConfig, measured: RobotMeasurements
) -> list[str]:
    """Sets collision masks, adds tyres to the wheels and returns the names of the hull's geoms."""
    geoms = collision_geoms(root, file)
    _hide_doubles(root)
    for geom in (geom for body in (root, *root.find_all("body")) for geom in body.geoms):
        geom.group = ROBOT_GROUP
    for geom in (*geoms.wheels, *geoms.casters):  # the base is held upright; sphere contacts are exact, cylinders' not
        geom.contype = geom.conaffinity = 0
    for geom in geoms.hull:
        _set_hull_contact(geom, config.body)
    pairs = zip(SIDES, measured.wheels, strict=True)
    turning = (
        pairs
        if not file.skids
        else ((name, wheel) for name, side in zip(SIDES, measured.sides, strict=True) for wheel in side)
    )
    for side, wheel in turning:
        joint = spec.joint(wheel.joint)
        joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
        joint.armature = config.wheels.armature_kg_m2
        joint.damping[:] = joint.stiffness[:] = 0.0  # the motor controls the speed
        joint.frictionloss = 0.0
        if file.skids:
            joint.armature = _AXLE_KG * config.wheels.radius_m**2  # that of the motor is at the axle
            continue
        axis = np.array(joint.axis) / np.linalg.norm(joint.axis)
        tyre = add_tyre(joint.parent, side, config.wheels.radius_m, joint.pos + wheel.offset_m * axis)
        tyre.rgba[3] = 0.0  # viewers show the wheel of the file
    return [geom.name for geom in geoms.hull]


def _hide_doubles(root: mujoco.MjsBody) -> None:
    """Makes the geoms transparent that MuJoCo does not show, unless nothing else of the robot is visible.

    They are collision shapes next to the visual ones. `_prepare_body` gives all geoms one group.
    """
    geoms = [geom for body in (root, *root.find_all("body")) for geom in body.geoms]
    hidden = [geom for geom in geoms if geom.group >= RENDERED_GROUPS]
    for geom in hidden if len(hidden) < len(geoms) else ():
        geom.rgba[3] = 0.0
        geom.material = ""


def _set_hull_contact(geom: Any, body: BodyConfig) -> None:
    """Gives a geom the collision mask and the contact parameters of the default hull."""
    geom.contype, geom.conaffinity = HULL_MASK
    geom.margin, geom.gap = body.skin_m, 0.0
    geom.friction = (body.friction, 0.0, 0.0)
    geom.condim = 3
    geom.priority = HULL_PRIORITY
    geom.solref = (body.contact_time_s, 1.0)
