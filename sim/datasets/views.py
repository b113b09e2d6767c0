"""Labelled views for training a segmentation network: sampling of poses, rejection of bare walls, metadata.

Half of the views are from random free positions in random directions; the other half are along shortest paths between
two positions of the house, on the 30 deg grid of headings of an exploring robot.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.env.scene import Scene
from sim.errors import EpisodeError, HouseError
from sim.geometry.pose import Pose
from sim.interface import FORWARD_M, MPCAT40_ID, TURN_RAD, CameraModel, wrap_angle
from sim.world.freespace import FreeSpace

BARE_SHARE = 0.97
"""A view is rejected if wall, floor, ceiling and void cover more than this share and its median depth is small."""
BARE_DEPTH_M = 1.2
"""Median depth below which such a view is rejected: a near wall holds no information."""
VIEWS_PER_PATH = 12
"""Largest number of views along one path."""
_MAX_TRIES = 40
_STRUCTURE = np.isin(np.arange(256), [MPCAT40_ID[name] for name in ("void", "wall", "floor", "ceiling")])


@dataclass(frozen=True)
class View:
    """One labelled view."""

    key: str
    rgb: NDArray[np.uint8]
    """(h, w, 3)"""
    depth_mm: NDArray[np.uint16]
    """(h, w) millimetres along the optical axis; 0: no return or below the camera's range; its maximum: beyond it."""
    semantic: NDArray[np.uint8]
    """(h, w) mpcat40 id"""
    record: dict[str, Any]
    """House, pose, intrinsics, profile and versions; JSON types."""


def sample_views(
    scene: Scene, rng: np.random.Generator, count: int, *, stem: str, record: dict[str, Any], block_px: int = 1
) -> Iterator[View]:
    """Yields views of one house; the same generator state gives the same views.

    Args:
        scene: the house; the robot is not rendered.
        rng: generator of the poses.
        count: number of views.
        stem: the keys are `<stem>_<number>`.
        record: entries of each view's record.
        block_px: factor by which views are reduced: colour is averaged, depth and labels take the middle pixel.

    Raises:
        HouseError: the house has no free position, or shows only bare walls.
    """
    space = scene.task.truth.space(0.0)
    cells = np.argwhere(space.largest_part())
    name = scene.world.house.name
    if len(cells) == 0:
        raise HouseError(f"House '{name}': the robot fits nowhere, so there is no view of it.")
    _start_world(scene, space, cells, rng)
    poses = _poses(space, cells, rng)
    taken = tries = 0
    while taken < count:
        if tries >= _MAX_TRIES * count:
            raise HouseError(f"House '{name}': {taken} of {count} views after {tries} tries; it shows only bare walls.")
        tries += 1
        pose, kind = next(poses)
        images = scene.camera.render(scene.world.data, pose, ("depth", "semantic"))
        if is_bare(images["semantic"], images["depth"]):
            continue
        images |= scene.camera.render(scene.world.data, pose, ("rgb",))
        yield _view(f"{stem}_{taken:05d}", images, pose, scene.camera.camera, block_px, record | {"pose_kind": kind})
        taken += 1


def is_bare(semantic: NDArray[np.uint8], depth: NDArray[np.float32]) -> bool:
    """Returns whether a view shows only near bare walls; it tests every fourth pixel in each direction.

    A pixel without return counts as near, as a surface right in front of the camera has no return.
    """
    structure = _STRUCTURE[semantic[::4, ::4]].mean()
    return bool(structure > BARE_SHARE and np.median(depth[::4, ::4]) < BARE_DEPTH_M)


def intrinsics(camera: CameraModel, block_px: int) -> dict[str, float]:
    """Returns the pinhole intrinsics of a reduced view; pixel centres are at half pixels."""
    focal_px = camera.focal_px / block_px
    return {
        "width_px": camera.width_px // block_px,
        "height_px": camera.height_px // block_px,
        "fx_px": focal_px,
        "fy_px": focal_px,
        "cx_px": 0.5 * camera.width_px / block_px,
        "cy_px": 0.5 * camera.height_px / block_px,
    }


def reduce_image(image: NDArray, block_px: int) -> NDArray:
    """Returns an image with one pixel for each block: the mean of colour (h, w, 3), else the middle pixel (h, w)."""
    if block_px == 1:
        return image
    height, width = image.shape[:2]
    if image.ndim == 3:
        return cv2.resize(image, (width // block_px, height // block_px), interpolation=cv2.INTER_AREA)
    middle = block_px // 2
    return np.ascontiguousarray(image[middle::block_px, middle::block_px])


def _view(
    key: str, images: dict[str, NDArray], pose: Pose, camera: CameraModel, block_px: int, record: dict[str, Any]
) -> View:
    depth_mm = np.rint(reduce_image(images["depth"], block_px) * 1000.0).astype(np.uint16)
    camera_entry = {"intrinsics": intrinsics(camera, block_px), "camera_height_m": camera.height_m}
    pose_entry = {name: round(value, 4) for name, value in asdict(pose).items()}
    return View(
        key,
        reduce_image(images["rgb"], block_px),
        depth_mm,
        reduce_image(images["semantic"], block_px),
        {"key": key, "pose": pose_entry, **camera_entry, **record},
    )


def _poses(space: FreeSpace, cells: NDArray[np.intp], rng: np.random.Generator) -> Iterator[tuple[Pose, str]]:
    """Yields poses without end, along a path and anywhere in turn."""
    while True:
        along = list(_path_poses(space, cells, rng))
        picked = np.sort(rng.permutation(len(along))[:VIEWS_PER_PATH])
        for i in picked.tolist():
            yield along[i], "path"
            yield _any_pose(space, cells, rng), "anywhere"


def _start_world(scene: Scene, space: FreeSpace, cells: NDArray[np.intp], rng: np.random.Generator) -> None:
    """Starts the world at a random free position where the body fits, so that movable objects come to rest."""
    for _ in range(_MAX_TRIES):
        try:
            scene.world.reset(_any_pose(space, cells, rng))
        except EpisodeError:
            continue
        return
    raise HouseError(f"House '{scene.world.house.name}': the robot fits at none of {_MAX_TRIES} free places.")


def _any_pose(space: FreeSpace, cells: NDArray[np.intp], rng: np.random.Generator) -> Pose:
    x_m, y_m = space.frame.to_metres(cells[rng.integers(len(cells))])
    return Pose(float(x_m), float(y_m), float(rng.uniform(-math.pi, math.pi)), space.floor_z_m)


def _path_poses(space: FreeSpace, cells: NDArray[np.intp], rng: np.random.Generator) -> Iterator[Pose]:
    """Yields the poses of a robot on the shortest path between two positions, after each forward and each turn."""
    goal = np.zeros(space.frame.shape, np.bool_)
    goal[tuple(cells[rng.integers(len(cells))])] = True
    left_m = space.geodesic(goal)
    here = _any_pose(space, cells, rng)
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
    """Returns the pose after the forward that comes nearest to the goal; None where no forward comes nearer."""
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
