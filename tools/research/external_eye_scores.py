"""Compares boxes of a detector with the objects of a view: silhouettes, matches, and shares with intervals.

A silhouette is the outline of the whole object, as if nothing hid it and the picture had no border. It says how much of
an object is visible. All boxes are (x0, y0, x1, y1) in pixels.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel
from sim.gl import mujoco
from sim.training.views.views import camera_to_world

Box = tuple[float, float, float, float]
MIN_IOU = 0.3
"""Smallest overlap of a detection with the object that it finds."""
RESAMPLES = 2000
_DRAWN_SCALE = 0.5
"""Scale at which silhouettes are drawn; they cover the picture and as much again on each side."""
_NEAR_M = 0.1
"""Points nearer to the camera, or behind it, are moved to this depth: such an object is cut by the border anyway."""


@dataclass(frozen=True)
class Truth:
    """One visible object of a view."""

    name: str
    category: str
    """Class of the detector."""
    box: Box
    counted: bool
    """Whether it is large enough and visible enough to count. A detection of another object is ignored."""
    visible_share: float = 1.0
    style: str = ""


@dataclass(frozen=True)
class Detection:
    """One box of the detector."""

    category: str
    box: Box
    score: float


def whole_px(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Sequence[int], pose: Pose, camera: CameraModel
) -> float:
    """Returns the area of the silhouette of some geoms, hidden parts and parts beyond the border included, in pixels.

    The outline of a mesh is exact; that of another geom is the convex hull of points on its surface. Thin parts are
    drawn up to two pixels too wide, so that furniture of wire seems a little less visible than it is.
    """
    size = int(3 * camera.width_px * _DRAWN_SCALE), int(3 * camera.height_px * _DRAWN_SCALE)
    canvas = np.zeros((size[1], size[0]), np.uint8)
    T_world_cam = camera_to_world(pose, camera)
    for geom in geoms:
        points, triangles = _surface(model, geom)
        world = points @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        seen = (world - T_world_cam[:3, 3]) @ T_world_cam[:3, :3]
        pixels = seen[:, :2] / np.maximum(seen[:, 2:], _NEAR_M) * camera.focal_px
        pixels = np.rint(pixels * _DRAWN_SCALE + 0.5 * np.array(size)).clip(-32_000, 32_000).astype(np.int32)
        if triangles is None:
            cv2.fillConvexPoly(canvas, cv2.convexHull(pixels), 1)
        else:
            for corners in pixels[triangles]:
                cv2.fillConvexPoly(canvas, corners, 1)
    return float(canvas.sum()) / _DRAWN_SCALE**2


def iou(a: Box, b: Box) -> float:
    """Returns the area that two boxes share, divided by the area that they cover together."""
    wide, high = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    shared = max(wide, 0.0) * max(high, 0.0)
    return shared / (_area(a) + _area(b) - shared)


def match(
    truths: Sequence[Truth], detections: Sequence[Detection], aliases: Mapping[str, tuple[str, ...]]
) -> tuple[list[bool], list[bool | None]]:
    """Matches the detections of a view with its objects of the same category, the highest score first.

    Args:
        truths: the objects.
        detections: the boxes.
        aliases: for a class of the detector, other categories that it may name: these are neither right nor wrong.

    Returns:
        Whether each object is found; whether each detection is right, None for one that is ignored because it shows an
        object that does not count.
    """
    found = [False] * len(truths)
    right: list[bool | None] = [False] * len(detections)
    for d in sorted(range(len(detections)), key=lambda d: -detections[d].score):
        box, category = detections[d].box, detections[d].category
        overlaps = [
            (truth.counted and truth.category == category, iou(truth.box, box), t)
            for t, truth in enumerate(truths)
            if not found[t] and truth.category in (category, *aliases.get(category, ()))
        ]
        counts, overlap, t = max((each for each in overlaps if each[1] >= MIN_IOU), default=(False, 0.0, -1))
        if counts:
            found[t] = True
        right[d] = True if counts else (None if overlap else False)
    return found, right


def share_with_interval(hits: Mapping[str, int], of: Mapping[str, int]) -> tuple[float, float, float]:
    """Returns a share over all houses and its 95 % interval, from a bootstrap over houses; nan where nothing counts.

    Args:
        hits: number of hits by house.
        of: number of trials by house.
    """
    houses = sorted(of)
    counts = np.array([(hits.get(house, 0), of[house]) for house in houses], np.float64).reshape(-1, 2)
    if counts[:, 1].sum() == 0:
        return float("nan"), float("nan"), float("nan")
    drawn = np.random.default_rng(0).integers(len(counts), size=(RESAMPLES, len(counts)))
    with np.errstate(invalid="ignore"):  # a resample without a trial
        hit, trials = counts[drawn].sum(axis=1).T
        low, high = np.nanpercentile(hit / trials, (2.5, 97.5))
    return float(counts[:, 0].sum() / counts[:, 1].sum()), float(low), float(high)


def paired_difference(
    before: Mapping[str, int], after: Mapping[str, int], of: Mapping[str, int]
) -> tuple[float, float, float]:
    """Returns the difference of two shares of the same trials and its 95 % interval, from a bootstrap over houses."""
    difference = {house: after.get(house, 0) - before.get(house, 0) for house in of}
    return share_with_interval(difference, of)


def _area(box: Box) -> float:
    return (box[2] - box[0]) * (box[3] - box[1])


def _surface(model: mujoco.MjModel, geom: int) -> tuple[NDArray[np.float64], NDArray[np.int32] | None]:
    """Returns points on a geom in its own frame (n, 3) in metres, and its triangles (m, 3); None for a convex geom."""
    kind = model.geom_type[geom]
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = int(model.geom_dataid[geom])
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        start, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
        return model.mesh_vert[first : first + count].astype(np.float64), model.mesh_face[start : start + faces]
    turn = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    half = model.geom_size[geom]
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        ring = np.stack([half[0] * np.cos(turn), half[0] * np.sin(turn)], axis=1)
        return np.concatenate([np.c_[ring, np.full(24, z)] for z in (-half[1], half[1])]), None
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        corners = np.stack(np.meshgrid(*[(-1.0, 1.0)] * 3), axis=-1).reshape(-1, 3)
        return corners * half, None
    tilt = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 9)[:, None]
    ball = np.stack([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt) + 0.0 * turn], axis=-1)
    ball = ball.reshape(-1, 3)
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return half[0] * ball + np.sign(ball[:, 2:]) * np.array([0.0, 0.0, half[1]]), None
    return ball * (half[0] if kind == mujoco.mjtGeom.mjGEOM_SPHERE else half), None
