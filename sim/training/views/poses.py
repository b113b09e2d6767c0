"""Poses of the camera for labelled views: anywhere, along shortest paths, and sequences along such paths."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, TURN_RAD, wrap_angle
from sim.world.freespace import FreeSpace

VIEWS_PER_PATH = 12
"""Largest number of views along one path, where they are not a sequence."""
MAX_TRIES = 40
"""Paths that may be too short for a sequence, and attempts for each view, before a house is refused."""


def mixed_poses(
    space: FreeSpace, cells: NDArray[np.intp], rng: np.random.Generator
) -> Iterator[tuple[Pose, dict[str, Any]]]:
    """Yields poses and their entries in a record, without end, along a path and anywhere in turn."""
    while True:
        along = list(path_poses(space, cells, rng))
        picked = np.sort(rng.permutation(len(along))[:VIEWS_PER_PATH])
        for i in picked.tolist():
            yield along[i], {"pose_kind": "path"}
            yield any_pose(space, cells, rng), {"pose_kind": "anywhere"}


def sequence_poses(
    space: FreeSpace, cells: NDArray[np.intp], rng: np.random.Generator, length: int, house: str
) -> Iterator[tuple[Pose, dict[str, Any]]]:
    """Yields the poses of sequences of one length without end: the first ones of paths that are long enough."""
    number = tries = 0
    while tries < MAX_TRIES:
        along = list(path_poses(space, cells, rng))
        tries += 1
        if len(along) < length:
            continue
        for frame, pose in enumerate(along[:length]):
            yield pose, {"pose_kind": "sequence", "sequence": number, "frame": frame}
        number, tries = number + 1, 0
    raise HouseError(f"House '{house}': no path of {length} views in {tries} tries; take shorter sequences.")


def any_pose(space: FreeSpace, cells: NDArray[np.intp], rng: np.random.Generator) -> Pose:
    """Returns a pose in one of the cells (n, 2), in any direction."""
    x_m, y_m = space.frame.to_metres(cells[rng.integers(len(cells))])
    return Pose(float(x_m), float(y_m), float(rng.uniform(-math.pi, math.pi)), space.floor_z_m)


def path_poses(space: FreeSpace, cells: NDArray[np.intp], rng: np.random.Generator) -> Iterator[Pose]:
    """Yields the poses of a robot on the shortest path between two positions, after each forward and each turn."""
    goal = np.zeros(space.frame.shape, np.bool_)
    goal[tuple(cells[rng.integers(len(cells))])] = True
    left_m = space.geodesic(goal)
    here = any_pose(space, cells, rng)
    first_yaw = here.yaw_rad
    yield here
    while (after := _step(space, left_m, here, first_yaw)) is not None:
        turns = round(wrap_angle(after.yaw_rad - here.yaw_rad) / TURN_RAD)
        for i in range(1, abs(turns) + 1):
            yaw = wrap_angle(here.yaw_rad + math.copysign(i, turns) * TURN_RAD)
            yield Pose(here.x_m, here.y_m, yaw, here.floor_z_m)
        yield after
        here = after


def _step(space: FreeSpace, left_m: NDArray[np.float32], here: Pose, first_yaw: float) -> Pose | None:
    """Returns the pose after the forward that comes nearest to the goal; None if no forward comes nearer."""
    yaws = first_yaw + TURN_RAD * np.arange(round(math.tau / TURN_RAD))
    ends = np.stack([here.x_m + FORWARD_M * np.cos(yaws), here.y_m + FORWARD_M * np.sin(yaws)], axis=1)
    cells = space.frame.to_cells(ends)
    inside = space.frame.inside(cells)
    row, col = np.clip(cells, 0, np.array(space.frame.shape) - 1).T
    remaining = np.where(inside, left_m[row, col], np.inf)
    best = int(np.argmin(remaining))
    row0, col0 = space.frame.to_cells(np.array([here.x_m, here.y_m]))
    if not remaining[best] < left_m[row0, col0] - 0.5 * FORWARD_M:
        return None
    return Pose(float(ends[best, 0]), float(ends[best, 1]), wrap_angle(float(yaws[best])), here.floor_z_m)
