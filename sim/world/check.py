"""Is a house fit to be used? Faults found in a specification, each one sentence.

The check measures the compiled model, not what the generator believed: labels, interpenetration of solid geoms,
things without support, and whether the robot gets into every room and near every kind of thing.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sim.errors import HouseError
from sim.gl import mujoco
from sim.houses.house import Room, read_rooms
from sim.houses.labels import Labels, collidable_geoms, read_labels
from sim.interface import GOAL_CATEGORIES, SuccessRule
from sim.world.freespace import FreeSpace

MAX_OVERLAP_M = 0.01
"""Deepest interpenetration of two things that is let pass."""
SUPPORT_GAP_M = 0.02
"""A thing whose box comes no nearer than this to any other hangs in the air."""
SETTLE_S, SETTLE_STEP_S = 1.0, 0.004
"""How long movable things are watched."""
MAX_SETTLING_M, MAX_DRIFT_M_S = 0.002, 0.001
"""How far they may move meanwhile, and how fast they may be at its end."""
STRUCTURE = frozenset(("wall", "floor", "ceiling", "door", "window"))
"""Parts of the building: they may meet each other."""


def check_house(spec: mujoco.MjSpec) -> list[str]:
    """Everything wrong with a house; empty when nothing is."""
    try:
        model = spec.compile()
        labels = read_labels(model, ignore_prefix="")
    except (ValueError, HouseError) as error:
        return [f"it does not compile: {error}"]
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    faults = overlaps(model, data, labels) + floating(model, data, labels) + restless(model)
    return faults + unreachable(model, data, labels, read_rooms(model))


def overlaps(model: mujoco.MjModel, data: mujoco.MjData, labels: Labels) -> list[str]:
    """Pairs of things whose solid geoms run into each other by more than `MAX_OVERLAP_M`.

    Parts of the building may meet each other, and so may a thing and what is built into it (its nested bodies).
    """
    solid = np.flatnonzero(collidable_geoms(model))
    low, high = geom_boxes(model, data, solid)
    structure = np.array([_category(labels, geom) in STRUCTURE for geom in solid.tolist()])
    root = model.body_rootid[model.geom_bodyid[solid]]
    instance = labels.geom_instance[solid]
    worst: dict[tuple[str, str], float] = {}
    for i, j in _close_pairs(low, high, -MAX_OVERLAP_M):
        together = root[i] == root[j] and root[i] != 0
        if together or instance[i] == instance[j] or (structure[i] and structure[j]):
            continue
        a, b = int(solid[i]), int(solid[j])
        depth = -mujoco.mj_geomDistance(model, data, a, b, MAX_OVERLAP_M, None)
        if depth > MAX_OVERLAP_M:
            names = (_name(labels, a), _name(labels, b))
            worst[names] = max(worst.get(names, 0.0), depth)
    return [f"{a} and {b} run into each other by {100 * depth:.1f} cm" for (a, b), depth in worst.items()]


def floating(model: mujoco.MjModel, data: mujoco.MjData, labels: Labels) -> list[str]:
    """Things that neither stand on, nor hang from, nor lie in anything else."""
    geoms = np.arange(model.ngeom)
    low, high = geom_boxes(model, data, geoms)
    instance = labels.geom_instance
    held = set()
    for i, j in _close_pairs(low, high, SUPPORT_GAP_M):
        if instance[i] != instance[j]:
            held |= {int(instance[i]), int(instance[j])}
    return [
        f"{thing.name} touches nothing"
        for number, thing in enumerate(labels.instances)
        if number not in held and thing.category not in STRUCTURE
    ]


def restless(model: mujoco.MjModel) -> list[str]:
    """Movable things that do not stand where they were put: after a second they moved, or are still moving."""
    joints = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
    if not joints.size:
        return []
    model = copy.copy(model)
    model.opt.timestep, model.opt.cone = SETTLE_STEP_S, mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_MULTICCD)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=round(SETTLE_S / SETTLE_STEP_S))
    faults = []
    for joint in joints.tolist():
        q, v = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
        moved_m = float(np.linalg.norm(data.qpos[q : q + 3] - model.qpos0[q : q + 3]))
        speed_m_s = float(np.linalg.norm(data.qvel[v : v + 3]))
        if not (moved_m <= MAX_SETTLING_M and speed_m_s <= MAX_DRIFT_M_S):  # not: a NaN is a fault too
            name = model.body(model.jnt_bodyid[joint]).name
            faults.append(f"{name} does not stand: after {SETTLE_S:.0f} s it has moved {1000 * moved_m:.1f} mm")
    return faults


def unreachable(model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, rooms: Iterable[Room]) -> list[str]:
    """Rooms that the robot cannot enter, and goal categories none of whose things it can get near."""
    rooms = tuple(rooms)
    if not rooms:
        return ["it has no room sites"]
    space = FreeSpace(model, data, labels, rooms=rooms)
    x, y = _cell_centres(space)
    masks = {room.name: space.free & _room_mask(room, x, y) for room in rooms}
    start = max(masks.values(), key=lambda mask: int(mask.sum()))
    if not start.any():
        return ["no room has a place where the robot fits"]
    seed = np.zeros_like(space.free)
    seed[tuple(np.argwhere(start)[len(np.argwhere(start)) // 2])] = True
    joined = np.isfinite(space.geodesic(seed))
    faults = [f"the robot cannot enter {name}" for name, mask in masks.items() if not (mask & joined).any()]
    lost = [name for name, mask in masks.items() if mask.sum() > 200 and (mask & joined).sum() < 0.8 * mask.sum()]
    faults += [f"part of {name} is cut off" for name in lost]
    return faults + _unreachable_goals(model, data, labels, joined, x, y)


def _unreachable_goals(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    labels: Labels,
    joined: NDArray[np.bool_],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
) -> list[str]:
    """Goal categories of which no instance comes near enough to a place that the robot reaches."""
    rows, cols = np.nonzero(joined)
    px, py = x[cols], y[rows]
    faults = []
    for category in GOAL_CATEGORIES:
        things = labels.of_category(category)
        if things and not any(_near(model, data, thing.geom_ids, px, py) for thing in things):
            faults.append(f"the robot gets near no {category}")
    return faults


def _near(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Iterable[int], px: NDArray[np.float64], py: NDArray[np.float64]
) -> bool:
    low, high = geom_boxes(model, data, np.array(list(geoms)))
    dx = np.maximum(np.maximum(low[:, 0].min() - px, px - high[:, 0].max()), 0.0)
    dy = np.maximum(np.maximum(low[:, 1].min() - py, py - high[:, 1].max()), 0.0)
    return bool((np.hypot(dx, dy) < SuccessRule().distance_m - 0.1).any())


def geom_boxes(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corners (n, 3) of the world-aligned boxes around some geoms, metres."""
    centre, half = model.geom_aabb[geoms, :3], model.geom_aabb[geoms, 3:]
    rotation = data.geom_xmat[geoms].reshape(-1, 3, 3)
    middle = data.geom_xpos[geoms] + np.einsum("nij,nj->ni", rotation, centre)
    reach = np.einsum("nij,nj->ni", np.abs(rotation), half)
    return middle - reach, middle + reach


def _close_pairs(low: NDArray[np.float64], high: NDArray[np.float64], gap_m: float) -> Iterable[tuple[int, int]]:
    """Pairs i < j of boxes nearer than `gap_m` in every axis (overlapping by more than -gap_m, when negative)."""
    gap = np.full((len(low), len(low)), -np.inf)
    for axis in range(3):
        apart = low[:, None, axis] - high[None, :, axis]
        np.maximum(gap, np.maximum(apart, apart.T), out=gap)
    return zip(*(index.tolist() for index in np.nonzero(np.triu(gap < gap_m, 1))), strict=True)


def _room_mask(room: Room, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.bool_]:
    mask = np.zeros((len(y), len(x)), dtype=np.bool_)
    for (cx, cy, _), (hx, hy, _) in room.boxes:
        mask |= np.outer(np.abs(y - cy) <= hy, np.abs(x - cx) <= hx)
    return mask


def _cell_centres(space: FreeSpace) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    rows, cols = space.free.shape
    x0, y0 = space.frame.origin_xy_m
    return x0 + (np.arange(cols) + 0.5) * space.frame.cell_m, y0 + (np.arange(rows) + 0.5) * space.frame.cell_m


def _category(labels: Labels, geom: int) -> str:
    return labels.instances[labels.geom_instance[geom]].category


def _name(labels: Labels, geom: int) -> str:
    return labels.instances[labels.geom_instance[geom]].name
