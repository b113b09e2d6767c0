"""Geometric channels against planes whose height and normal are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.core.interface import CameraModel, ConfigError
from stubborn.segmentation import geometry
from stubborn.segmentation.geometry import FORWARD, HEIGHT, INVERSE_DEPTH, RIGHT, UP, VALID, geometry_image
from stubborn.segmentation.inputs import INPUTS

CAMERAS = [CameraModel(), CameraModel(width_px=320, height_px=320, hfov_rad=math.radians(60.0), height_m=1.4)]


def rays(camera: CameraModel) -> tuple[np.ndarray, np.ndarray]:
    """Returns right and up of each pixel's ray for a forward component of 1."""
    row, col = np.mgrid[0 : camera.height_px, 0 : camera.width_px]
    return (col + 0.5 - camera.width_px / 2) / camera.focal_px, (camera.height_px / 2 - row - 0.5) / camera.focal_px


@pytest.mark.parametrize("camera", CAMERAS)
def test_a_floor_has_height_zero_and_points_up(camera: CameraModel) -> None:
    _, up = rays(camera)
    depth = np.where(up < 0, camera.height_m / np.maximum(-up, 1e-6), 9.0).clip(0, camera.max_depth_m)
    channels = geometry_image(depth.astype(np.float32), camera)
    seen = (depth < 0.9 * camera.max_depth_m) & (up < 0)
    assert np.abs(channels[seen, HEIGHT]).max() < 1e-3
    assert channels[seen, UP].min() > 0.999
    assert channels[seen, VALID].all()
    assert np.allclose(channels[seen, INVERSE_DEPTH], 1 / depth[seen], rtol=1e-4)


@pytest.mark.parametrize("camera", CAMERAS)
def test_an_oblique_wall_points_to_the_camera_and_has_its_height(camera: CameraModel) -> None:
    right, up = rays(camera)
    normal = np.array([-math.sin(0.5), 0.0, -math.cos(0.5)])  # right, up, forward
    depth = (-2.0 / (normal[0] * right + normal[2])).astype(np.float32)
    seen = (depth > 0.5) & (depth < 4.9)
    channels = geometry_image(np.where(seen, depth, 0).astype(np.float32), camera)
    inner = channels[10:-10, 60:-60][seen[10:-10, 60:-60]]
    assert np.abs(inner[:, [RIGHT, UP, FORWARD]] - normal).max() < 0.01
    expected = (camera.height_m + up * depth)[10:-10, 60:-60][seen[10:-10, 60:-60]]
    assert np.abs(inner[:, HEIGHT] - expected).max() < 1e-3


def test_pixels_without_a_return_and_beyond_the_range_are_not_valid() -> None:
    depth = np.full((480, 640), 2.0, np.float32)
    depth[:, :100], depth[:, 200:300] = 0.0, 5.0
    channels = geometry_image(depth, CameraModel())
    assert channels[:, :100].sum(axis=2).max() == pytest.approx(CameraModel().height_m)  # only a height, of the camera
    assert channels[0, 250, VALID] == 0.0
    assert channels[0, 250, INVERSE_DEPTH] == pytest.approx(0.2)
    assert channels[240, 400, FORWARD] == pytest.approx(-1.0)


def test_the_edge_of_an_object_does_not_bend_its_normal() -> None:
    depth = np.full((480, 640), 4.0, np.float32)
    depth[100:300, 200:400] = 1.5
    assert geometry_image(depth, CameraModel())[..., FORWARD].max() < -0.999


def test_mirroring_the_image_is_mirroring_the_channels() -> None:
    depth = np.random.default_rng(0).uniform(1.0, 4.0, (48, 64)).astype(np.float32)
    there = geometry.mirrored(geometry_image(depth, CameraModel()))
    here = geometry_image(np.ascontiguousarray(depth[:, ::-1]), CameraModel())
    assert np.abs(there - here)[..., :HEIGHT].max() == 0.0
    same = np.abs(there - here).max(axis=2) < 1e-4
    assert same.mean() > 0.95  # of two neighbours as near, the right one is taken


def test_a_zoomed_window_shows_its_objects_nearer_and_at_their_height() -> None:
    depth = np.full((48, 64), 3.0, np.float32)
    channels = geometry_image(depth, CameraModel())[:24, :32]
    near = INPUTS["geometry"].zoomed(channels, 64, 48, 2.0)
    assert near.shape == (48, 64, 6)
    assert near[..., INVERSE_DEPTH] == pytest.approx(2 / 3.0)
    assert near[0, 0, HEIGHT] == channels[0, 0, HEIGHT]
    assert INPUTS["depth"].zoomed(depth[:24, :32, None], 64, 48, 2.0) == pytest.approx(1.5)


def test_a_crop_and_an_infinite_range_are_refused() -> None:
    with pytest.raises(ConfigError, match=r"320.*480.*640.*480"):
        geometry_image(np.ones((480, 320), np.float32), CameraModel())
    with pytest.raises(ConfigError, match="finite number"):
        geometry_image(np.ones((48, 64), np.float32), CameraModel(max_depth_m=math.inf))


def test_depth_and_geometry_together_are_the_two_kinds_side_by_side() -> None:
    depth = np.random.default_rng(1).uniform(0.5, 5.0, (48, 64)).astype(np.float32)
    camera = CameraModel()
    one, other, both = (INPUTS[kind] for kind in ("depth", "geometry", "depth-geometry"))
    channels = both.of(depth, camera)
    changes = (
        lambda second, image: second.mirrored(image),
        lambda second, image: second.zoomed(image[8:32, 8:40], 64, 48, 2.0),
        lambda second, image: second.normalised(image, camera).transpose(1, 2, 0),
    )
    for change in changes:
        apart = [change(second, second.of(depth, camera)) for second in (one, other)]
        np.testing.assert_array_equal(change(both, channels), np.concatenate(apart, axis=2))
