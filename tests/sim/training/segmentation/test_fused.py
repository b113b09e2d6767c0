"""Fused views: positions of pixels in the world, and the category of a voxel."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.core.geometry.pose import BodyPose
from sim.core.interface import CameraModel
from sim.training.segmentation.fused import FusedViews, fused_classes, world_points
from stubborn.segmentation.rednet import CLASSES

CAMERA = CameraModel(width_px=80, height_px=60)


def test_the_middle_of_the_image_lies_ahead_of_the_robot_at_the_height_of_the_camera() -> None:
    depth_m, used = np.full((60, 80), 2.0, np.float32), np.zeros((60, 80), np.bool_)
    used[29:31, 39:41] = True
    pose = {"x_m": 1.0, "y_m": 2.0, "yaw_rad": math.pi / 2, "floor_z_m": 3.0}
    points_m = world_points(depth_m, used, pose, CAMERA)
    assert points_m.mean(axis=0) == pytest.approx([1.0, 4.0, 3.0 + CAMERA.height_m])
    used[:] = False
    used[0, 0] = True  # up and left, which is towards -x for a robot that looks along +y
    ((x_m, _, z_m),) = world_points(depth_m, used, pose, CAMERA)
    assert x_m < 1.0 - 1.5
    assert z_m > 3.0 + CAMERA.height_m + 1.0


def test_a_body_that_leans_moves_the_pixels_of_its_camera() -> None:
    depth_m, used = np.full((60, 80), 2.0, np.float32), np.zeros((60, 80), np.bool_)
    used[29:31, 39:41] = True
    pose = {"x_m": 0.0, "y_m": 0.0, "yaw_rad": 0.0, "floor_z_m": 0.0, "rise_m": 0.0, "pitch_rad": 0.1, "roll_rad": 0.0}
    x_m, y_m, z_m = world_points(depth_m, used, pose, CAMERA).mean(axis=0)
    body = BodyPose(**pose)
    assert (x_m, y_m, z_m) == pytest.approx(body.point(2.0, 0.0, CAMERA.height_m))
    assert z_m < CAMERA.height_m - 0.15  # a positive pitch looks down


def test_all_pixels_of_a_voxel_get_its_most_probable_category() -> None:
    voxels = np.array([[0, 0, 0], [5, 0, 1], [0, 0, 0], [0, 0, 0], [5, 0, 1]])
    posteriors = np.zeros((5, 3), np.float32)
    posteriors[[0, 2, 3], [1, 0, 0]] = 1.0, 0.4, 0.5
    posteriors[[1, 4], [2, 2]] = 0.3, 0.1
    assert fused_classes(voxels, posteriors).tolist() == [1, 2, 1, 1, 2]


def test_a_surface_that_most_views_recognise_is_right_in_all_of_them() -> None:
    seen = FusedViews()
    depth_m, truth = np.full((60, 80), 2.0, np.float32), np.full((60, 80), 4)
    truth[:, :40] = 7
    for number in range(3):
        posteriors = np.zeros((CLASSES, 60, 80), np.float32)
        posteriors[4, :, 40:], posteriors[7, :, :40] = 0.9, 0.9
        if number == 1:
            posteriors = np.roll(posteriors, 1, axis=0)  # one view of three is wrong everywhere
        record = {"house": "a", "pose": {"x_m": 0.0, "y_m": 0.0, "yaw_rad": 0.0, "floor_z_m": 0.0}}
        seen.add(record, posteriors, truth, depth_m, CAMERA)
    figures = seen.iou()
    assert figures is not None
    assert figures[0].accuracy == pytest.approx(2 / 3)
    assert figures[1].accuracy > 0.95  # a voxel between the two halves holds pixels of both


def test_pixels_without_depth_and_views_without_a_pose_do_not_count() -> None:
    seen, posteriors = FusedViews(), np.ones((CLASSES, 60, 80), np.float32)
    truth, near = np.zeros((60, 80), np.int64), np.zeros((60, 80), np.float32)
    seen.add({"house": "a"}, posteriors, truth, near + 1.0, CAMERA)
    assert seen.iou() is None
    seen.add({"house": "a", "pose": {"x_m": 0.0, "y_m": 0.0, "yaw_rad": 0.0}}, posteriors, truth, near, CAMERA)
    assert sum(map(len, seen.truth["a"])) == 0
