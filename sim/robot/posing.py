"""Moves the joints of an MJCF robot to given positions and leaves it in this pose, so that they can be deleted."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import ConfigError
from sim.gl import mujoco

_KINDS = {
    mujoco.mjtJoint.mjJNT_HINGE.value: "rad",
    mujoco.mjtJoint.mjJNT_SLIDE.value: "m",
}
"""Types of joints that can be posed, and the units of their positions."""
_TOLERANCE = 1e-6
"""A position may exceed the range of its joint by this much, since both are rounded."""


def pose_joints(spec: mujoco.MjSpec, pose: tuple[tuple[str, float], ...]) -> None:
    """Moves the bodies of a specification as its joints would move them.

    The joints stay, so that they must be deleted next. Orientations of bodies must be quaternions.

    Args:
        spec: changed in place.
        pose: names of joints and their positions as in `qpos`, rad or m.

    Raises:
        ConfigError: a joint does not exist, is neither a hinge nor a slide, or cannot be in this position.
    """
    positions = dict(pose)
    joints = {joint.name: joint for joint in spec.joints if joint.name}
    for name, position in positions.items():
        if name not in joints:
            known = [joint_name for joint_name, joint in joints.items() if _kind(joint) in _KINDS]
            raise ConfigError(
                f"it has no joint '{name}', which the sidecar names in joints. The hinges and slides are: "
                f"{', '.join(known) or 'none that has a name'}."
            )
        _require_position(spec, joints[name], position)
    for body in spec.bodies:
        for joint in body.joints:  # MuJoCo moves a body by its joints in this order
            if joint.name in positions:
                _move(body, joint, positions[joint.name] - _radians(spec, joint, joint.ref))


def _move(body: mujoco.MjsBody, joint: mujoco.MjsJoint, change: float) -> None:
    """Moves a body by a change of the position of one of its joints."""
    quat, axis = np.array(body.quat, float), np.array(joint.axis, float) / np.linalg.norm(joint.axis)
    if _kind(joint) == mujoco.mjtJoint.mjJNT_SLIDE:
        body.pos = body.pos + change * _rotated(axis, quat)
        return
    turn, turned = np.empty(4), np.empty(4)
    mujoco.mju_axisAngle2Quat(turn, axis, change)
    mujoco.mju_mulQuat(turned, quat / np.linalg.norm(quat), turn)
    body.pos = body.pos + _rotated(joint.pos, quat) - _rotated(joint.pos, turned)  # the anchor stays where it is
    body.quat = turned


def _rotated(vector: NDArray[np.float64], quat: NDArray[np.float64]) -> NDArray[np.float64]:
    rotated = np.empty(3)
    mujoco.mju_rotVecQuat(rotated, np.array(vector, float), quat / np.linalg.norm(quat))
    return rotated


def _require_position(spec: mujoco.MjSpec, joint: mujoco.MjsJoint, position: float) -> None:
    """Raises ConfigError if a joint cannot be in a position."""
    if _kind(joint) not in _KINDS:
        raise ConfigError(f"joint '{joint.name}', listed under \"joints\" in the sidecar, must be a hinge or a slide.")
    low, high = (_radians(spec, joint, limit) for limit in joint.range)
    limited = joint.limited == mujoco.mjtLimited.mjLIMITED_TRUE or (
        joint.limited == mujoco.mjtLimited.mjLIMITED_AUTO and low < high
    )
    if limited and not low - _TOLERANCE <= position <= high + _TOLERANCE:
        raise ConfigError(
            f"the position of its joint '{joint.name}' in the sidecar must lie in [{low:.4g}, {high:.4g}] "
            f"{_KINDS[_kind(joint)]}, got {position:g}."
        )


def _radians(spec: mujoco.MjSpec, joint: mujoco.MjsJoint, value: float) -> float:
    """Returns a position of a joint of the file in radians or metres."""
    in_degrees = spec.compiler.degree and _kind(joint) == mujoco.mjtJoint.mjJNT_HINGE
    return math.radians(value) if in_degrees else float(value)


def _kind(joint: mujoco.MjsJoint) -> int:
    return int(joint.type)
