"""The agent's compiled loops compute what NumPy computes, to the last bit: the agent's path depends on it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.geometry.grid import GridFrame
from sim.geometry.pose import Pose
from sim.interface import CameraModel
from stubborn.grid_kernels import bilinear, distance_within
from stubborn.mapping.object_layers import FrameScores
from stubborn.mapping.occupancy import OccupancyConfig, Surfaces
from stubborn.mapping.projection import Rays, sight_window_cells
from stubborn.raster import distance_to

CAMERA = CameraModel()


def depth_image(rng: np.random.Generator, noise_m: float) -> NDArray[np.float32]:
    """Returns 120 x 160 pixels of slanted patches with holes."""
    patches = np.kron(rng.uniform(0.4, 5.2, (6, 8)), np.ones((20, 20))) * np.linspace(0.9, 1.1, 160)
    depth = patches + rng.normal(0.0, 1.0, patches.shape) * noise_m
    depth[rng.random(depth.shape) < 0.05] = 0.0
    return np.clip(depth, 0.0, 5.0).astype(np.float32)


def smoothed(depth: NDArray[np.float32], jump_1_m: float) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """Returns each pixel's mean with its neighbours on one surface, less the pixel, and their number."""
    everything, first, last = slice(None), slice(None, -1), slice(1, None)
    pairs = (((last, everything), (first, everything)), ((everything, last), (everything, first)),
             ((last, last), (first, first)), ((last, first), (first, last)))  # fmt: skip
    scaled, total, count = depth * np.float32(jump_1_m), depth.copy(), np.zeros(depth.shape, np.uint8)
    for ahead, behind in pairs:
        gap = depth[behind] - depth[ahead]
        same = np.abs(gap) < scaled[ahead] * depth[behind]
        count[ahead] += same
        count[behind] += same
        total[ahead] += gap * same
        total[behind] -= gap * same
    return np.divide(total - depth, count + np.float32(1.0), dtype=np.float32), count


@pytest.mark.parametrize("seed", range(3))
def test_a_noisy_image_is_smoothed_along_surfaces_only(seed: int) -> None:
    depth, config = depth_image(np.random.default_rng(seed), noise_m=0.02), OccupancyConfig()
    change, count = smoothed(depth, config.jump_1_m)
    surfaces = Surfaces.of(depth, config)
    assert surfaces.neighbours is not None
    assert np.array_equal(surfaces.neighbours, count)
    assert np.array_equal(surfaces.depth, change + depth)
    assert np.array_equal(surfaces.confirmed(3), count >= 3)


def test_an_exact_image_is_left_alone_and_all_of_it_counts() -> None:
    depth = depth_image(np.random.default_rng(0), noise_m=0.0)
    surfaces = Surfaces.of(depth, OccupancyConfig())
    assert surfaces.exact
    assert surfaces.depth is depth
    assert surfaces.confirmed(8).all()


def test_pixels_are_projected_as_float32_arithmetic_has_it() -> None:
    rng = np.random.default_rng(1)
    rays = Rays(CAMERA, 2, 4)
    depth, pose = depth_image(rng, noise_m=0.01), Pose(0.31, -0.77, 0.6)
    confirmed = rng.random(depth.shape) < 0.9
    window = GridFrame.around_start(600, 0.05).window_at(pose.x_m, pose.y_m, sight_window_cells(CAMERA, 0.05))
    points = rays.project(depth, confirmed, pose, window)
    valid = confirmed & (depth >= CAMERA.min_depth_m) & (depth < CAMERA.max_depth_m)
    cos, sin, frame = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad), window.frame
    x = depth * ((cos - sin * rays.left) / 0.05).astype(np.float32) + np.float32(
        (pose.x_m - frame.origin_xy_m[0]) / 0.05
    )
    y = depth * ((sin + cos * rays.left) / 0.05).astype(np.float32) + np.float32(
        (pose.y_m - frame.origin_xy_m[1]) / 0.05
    )
    assert np.array_equal(points.valid, valid)
    assert np.array_equal(points.cols, x[valid].astype(np.int32))
    assert np.array_equal(points.rows, y[valid].astype(np.int32))
    assert np.array_equal(points.height_m, (depth * rays.up[:, None] + np.float32(CAMERA.height_m))[valid])


@pytest.mark.parametrize("hits", [0.0, 0.2])
def test_a_cell_has_the_other_score_of_the_pixel_with_its_highest_target_score(hits: float) -> None:
    rng = np.random.default_rng(2)
    flat = rng.integers(0, 40, 200).astype(np.int32)
    target, other = (rng.random((2, 200)) * (rng.random((2, 200)) < [[hits], [1.0]])).astype(np.float32)
    frame = FrameScores((5, 8), flat, target, other)
    for cell in range(40):
        here = np.flatnonzero(flat == cell)
        highest = target[here].max(initial=0.0)
        speaking = here[target[here] == highest]
        assert frame.in_view.reshape(-1)[cell] == bool(here.size)
        assert frame.other.reshape(-1)[cell] == other[speaking].max(initial=0.0)
        if frame.target is not None:
            assert frame.target.reshape(-1)[cell] == highest
    assert (frame.target is None) == (hits == 0.0)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.05])
def test_distances_within_a_reach_are_exact_and_others_are_the_reach(share: float) -> None:
    mask = np.random.default_rng(3).random((40, 70)) < share
    exact, found = distance_to(mask), distance_within(mask, 6)
    near = exact <= 6.0
    assert found[near] == pytest.approx(exact[near], rel=1e-6)
    assert (found[~near] == 6.0).all()


def test_a_point_amid_cells_has_their_mean_and_one_off_the_grid_has_none() -> None:
    values = np.array([[1.0, 2.0], [3.0, np.inf]], np.float32)
    x_m, y_m = np.array([0.05, 0.03, 0.099, 0.2]), np.array([0.049, 0.03, 0.099, 0.03])
    found = bilinear(values, 0.0, 0.0, 0.05, x_m, y_m)
    assert found[0] == pytest.approx((0.52 / 2 * 1 + 0.52 / 2 * 2 + 0.48 / 2 * 3) / (1 - 0.48 / 2))
    assert found[1] == pytest.approx((0.9 * 0.9 * 1 + 0.9 * 0.1 * 2 + 0.1 * 0.9 * 3) / (1 - 0.1 * 0.1))
    assert np.isinf(found[2:]).all()
