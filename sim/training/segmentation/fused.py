"""Fuses the predictions on all views of a house: the quality that an agent can reach after it has looked around.

The posteriors of all pixels in a voxel of `VOXEL_M` are averaged, and each of these pixels gets the most probable
category of its voxel. Pixels without a depth in the camera's range are left out, in the fused figure and in the one of
single views that it is compared with.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64

from sim.core.geometry.pose import BodyPose
from sim.core.interface import CameraModel
from sim.training.segmentation.evaluation import Iou, confusion
from stubborn.segmentation.rednet import CLASSES

VOXEL_M = 0.1
"""Edge of a voxel."""
EVERY_PX = 4
"""Every 4th pixel of the network's image in each direction is used."""


@dataclass
class FusedViews:
    """Pixels of many views by house: voxel, posterior and true class."""

    voxels: dict[str, list[Int64[np.ndarray, "n 3"]]] = field(default_factory=dict)
    posteriors: dict[str, list[np.ndarray]] = field(default_factory=dict)
    """(n, classes) float16, calibrated."""
    truth: dict[str, list[Int64[np.ndarray, " n"]]] = field(default_factory=dict)

    def add(
        self,
        record: Mapping[str, Any],
        posteriors: Float32[np.ndarray, "classes h w"],
        truth: Int64[np.ndarray, "h w"],
        depth_m: Float32[np.ndarray, "h w"],
        camera: CameraModel,
    ) -> None:
        """Adds one view. A view without a pose in its record is left out.

        Args:
            record: the record of the view, with `house` and `pose`.
            posteriors: probabilities of the whole image at the network's resolution.
            truth: class channels; negative ones do not count.
            depth_m: metres along the optical axis; 0: no return.
            camera: field of view, height above the floor and range of depth.
        """
        if "pose" not in record:
            return
        used = np.zeros(truth.shape, np.bool_)
        used[EVERY_PX // 2 :: EVERY_PX, EVERY_PX // 2 :: EVERY_PX] = True
        used &= (truth >= 0) & (depth_m > 0.0) & (depth_m < camera.max_depth_m)
        points_m = world_points(depth_m, used, record["pose"], camera)
        house = record["house"]
        self.voxels.setdefault(house, []).append(np.floor(points_m / VOXEL_M).astype(np.int64))
        self.posteriors.setdefault(house, []).append(posteriors[:, used].T.astype(np.float16))
        self.truth.setdefault(house, []).append(truth[used])

    def iou(self) -> tuple[Iou, Iou] | None:
        """Returns the intersection over union of single views and of fused ones; None if no view was added."""
        if not self.voxels:
            return None
        single, fused = np.zeros((CLASSES, CLASSES), np.int64), np.zeros((CLASSES, CLASSES), np.int64)
        for house, voxels in self.voxels.items():
            posteriors = np.concatenate(self.posteriors[house]).astype(np.float32)
            truth = np.concatenate(self.truth[house])
            single += confusion(posteriors.argmax(axis=1), truth)
            fused += confusion(fused_classes(np.concatenate(voxels), posteriors), truth)
        return Iou.of(single), Iou.of(fused)


def fused_classes(
    voxels: Int64[np.ndarray, "n 3"], posteriors: Float32[np.ndarray, "n classes"]
) -> Int64[np.ndarray, " n"]:
    """Returns the class channel of each pixel: that of the largest sum of posteriors in its voxel."""
    _, of_pixel = np.unique(voxels, axis=0, return_inverse=True)
    order = np.argsort(of_pixel, kind="stable")
    starts = np.flatnonzero(np.diff(of_pixel[order], prepend=-1))
    return np.add.reduceat(posteriors[order], starts, axis=0).argmax(axis=1)[of_pixel]


def world_points(
    depth_m: Float32[np.ndarray, "h w"], used: Bool[np.ndarray, "h w"], pose: Mapping[str, float], camera: CameraModel
) -> Float64[np.ndarray, "n 3"]:
    """Returns the positions in the world, in metres, of some pixels of a whole depth image.

    Args:
        depth_m: metres along the optical axis.
        used: the pixels.
        pose: `x_m`, `y_m`, `yaw_rad` and `floor_z_m` of the robot; those of a `BodyPose` if its body leans.
        camera: field of view and height above the floor.
    """
    height, width = depth_m.shape
    focal_px = 0.5 * width / math.tan(0.5 * camera.hfov_rad)
    rows, cols = np.nonzero(used)
    forward_m = depth_m[used].astype(np.float64)
    left_m = (0.5 * width - (cols + 0.5)) / focal_px * forward_m
    up_m = camera.height_m + (0.5 * height - (rows + 0.5)) / focal_px * forward_m
    body = BodyPose(**pose)
    return body.point(0.0, 0.0, 0.0) + np.stack([forward_m, left_m, up_m], axis=1) @ body.axes
