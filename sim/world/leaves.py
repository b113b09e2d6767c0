"""Door leaves on hinges: which the robot must push, and how far they open then (docs/houses.md).

A leaf is a body labelled door with one upright, limited hinge, which closes the doorway at the lower end of its range.
Reference distances and starts use a leaf as the house file puts it, with one exception: a leaf that leaves too little
room beside it, but opens far enough, counts as pushed open, because the robot can open it where it meets it. From the
other side it could not pull it; `FreeSpace.largest_part` therefore leaves out the places behind such a leaf.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40_ID
from sim.gl import mujoco
from sim.houses.geoms import geom_polytope
from sim.houses.labels import Labels, collidable_geoms

PASS_M = 0.10
"""A robot passes beside a leaf without a push if the gap is wider than the robot by at least this much."""
MOVED_RAD = 0.002
"""A leaf that has turned by less than this has not moved."""
_UPRIGHT = 0.999


@dataclass(frozen=True)
class Leaf:
    """A door leaf on a hinge."""

    joint: int
    qpos: int
    """Address of its angle."""
    geoms: tuple[int, ...]
    """Its geoms that collide."""
    closed_rad: float
    widest_rad: float
    """Ends of its range."""
    width_m: float
    """Greatest distance in plan from the hinge to one of its corners."""

    def gap_m(self, angle_rad: float) -> float:
        """Returns the room beside the leaf at an angle of the joint."""
        opened = min(max(angle_rad - self.closed_rad, 0.0), math.pi)
        return 2.0 * self.width_m * math.sin(0.5 * opened)


def hinged_leaves(model: mujoco.MjModel, data: mujoco.MjData, labels: Labels) -> tuple[Leaf, ...]:
    """Returns the door leaves of a compiled house or world; kinematics of `data` must be computed."""
    leaves = []
    doors = (labels.geom_category == MPCAT40_ID["door"]) & collidable_geoms(model)
    for joint in np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE).tolist():
        body = int(model.jnt_bodyid[joint])
        geoms = np.flatnonzero(doors & (model.geom_bodyid == body)).tolist()
        upright = abs(float(data.xaxis[joint, 2])) > _UPRIGHT
        if not geoms or not upright or not model.jnt_limited[joint] or model.body_jntnum[body] != 1:
            continue
        corners = np.vstack([geom_polytope(model, data, geom).vertices_m[:, :2] for geom in geoms])
        width_m = float(np.hypot(*(corners - data.xanchor[joint, :2]).T).max())
        low, high = model.jnt_range[joint].tolist()
        leaves.append(Leaf(joint, int(model.jnt_qposadr[joint]), tuple(geoms), low, high, width_m))
    return tuple(leaves)


def pushed_open(
    model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, radius_m: float
) -> tuple[mujoco.MjData, tuple[int, ...]]:
    """Returns the state in which the leaves that a robot must push, and can, are wide open, and the geoms of these.

    The state is `data` itself if there is no such leaf, else a copy with its kinematics computed.

    Args:
        model: a compiled house or world.
        data: its state; kinematics must be computed.
        labels: of `model`.
        radius_m: of the robot.
    """
    need_m = 2.0 * radius_m + PASS_M
    pushed = [
        leaf
        for leaf in hinged_leaves(model, data, labels)
        if leaf.gap_m(float(data.qpos[leaf.qpos])) < need_m <= leaf.gap_m(leaf.widest_rad)
    ]
    if not pushed:
        return data, ()
    opened = mujoco.MjData(model)
    opened.qpos[:] = data.qpos
    for leaf in pushed:
        opened.qpos[leaf.qpos] = leaf.widest_rad
    mujoco.mj_kinematics(model, opened)
    return opened, tuple(geom for leaf in pushed for geom in leaf.geoms)


def moved(leaves: tuple[Leaf, ...], data: mujoco.MjData, at_rest: NDArray[np.float64]) -> bool:
    """Returns whether a leaf has turned since the state with the positions `at_rest` (nq,)."""
    return any(abs(float(data.qpos[leaf.qpos] - at_rest[leaf.qpos])) > MOVED_RAD for leaf in leaves)
