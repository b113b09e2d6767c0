"""A body from elsewhere made fit to drive: on the same upright base, with the same kind of motors and touch."""

from __future__ import annotations

from typing import Any

from sim.errors import ConfigError, HouseError
from sim.gl import mujoco
from sim.robot.body import (
    HULL_MASK,
    HULL_PRIORITY,
    ROBOT_GROUP,
    add_joints,
    add_motor,
    add_touch,
    add_tyre,
    built_in_robot_spec,
)
from sim.robot.config import BodyConfig, RobotConfig, RobotFile
from sim.robot.foreign import Measured, foreign_body, measure, parts_of

THEIRS = "file/"
"""Begins the names that come out of the file, behind `PREFIX`."""


def robot_spec(config: RobotConfig) -> mujoco.MjSpec:
    """Our robot, or the one in the config's file, to be attached with the prefix `PREFIX` to the world body.

    Raises:
        HouseError: the file is not what it was when the config was made.
    """
    if config.file is None:
        return built_in_robot_spec(config)
    try:
        return _mounted(config, config.file)
    except ConfigError as error:
        raise HouseError(f"Robot '{config.file.path}': {error}") from None


def _mounted(config: RobotConfig, file: RobotFile) -> mujoco.MjSpec:
    measured = measure(file, config.wheels.radius_m)
    theirs, root = foreign_body(file)
    hull = _prepare(theirs, root, file, config, measured)
    spec = mujoco.MjSpec()
    spec.modelname = "robot"
    base = spec.worldbody.add_body(name="base", fuse=0)
    add_joints(base, config)
    x, y, z = measured.middle_m.tolist()
    frame = base.add_frame(pos=(-x, -y, config.wheels.radius_m - z))
    frame.attach_body(root, THEIRS, "")
    for name, wheel in zip(("left", "right"), measured.wheels, strict=True):
        motor = add_motor(spec, name, THEIRS + wheel.joint, config)
        motor.gear[0] = wheel.sign
    for number, part in enumerate(hull):
        add_touch(spec, f"touch_{number}", mujoco.mjtObj.mjOBJ_GEOM, THEIRS + part)
    return spec


def _prepare(
    spec: mujoco.MjSpec, root: mujoco.MjsBody, file: RobotFile, config: RobotConfig, measured: Measured
) -> list[str]:
    """Set who touches whom, put tyres on the wheels; returns the names of the hull's geoms."""
    wheels, casters, hull = parts_of(root, file)
    for geom in (geom for body in (root, *root.find_all("body")) for geom in body.geoms):
        geom.group = ROBOT_GROUP
    for geom in (*wheels, *casters):  # the base is held upright, and tyres are exact where cylinders are not
        geom.contype = geom.conaffinity = 0
    for number, geom in enumerate(hull):
        geom.name = geom.name or f"hull_{number}"
        _make_hull(geom, config.body)
    for side, wheel in zip(("left", "right"), measured.wheels, strict=True):
        joint = spec.joint(wheel.joint)
        joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
        joint.armature = config.wheels.armature_kg_m2
        joint.damping[:] = 0.0  # the motor holds the speed
        joint.frictionloss = 0.0
        add_tyre(joint.parent, side, config.wheels.radius_m, joint.pos)
    return [geom.name for geom in hull]


def _make_hull(geom: Any, body: BodyConfig) -> None:
    geom.contype, geom.conaffinity = HULL_MASK
    geom.margin, geom.gap = body.skin_m, 0.0
    geom.friction = (body.friction, 0.0, 0.0)
    geom.condim = 3
    geom.priority = HULL_PRIORITY
    geom.solref = (body.contact_time_s, 1.0)
