"""The agent's compiled loops equal NumPy to the last bit, because the agent's path depends on it."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from sim.core.geometry.grid import GridFrame, Window
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, CameraModel, ConfigError
from stubborn.kernels.frames import enter_bits, shows_no_noise
from stubborn.kernels.grids import bilinear, distance_within
from stubborn.mapping.masks import connected, distance_to, farther_than
from stubborn.mapping.navmap import NavMap
from stubborn.mapping.occupancy import Occupancy, OccupancyConfig, SightLines, Surfaces
from stubborn.mapping.projection import Rays, in_range, sight_window_cells
from stubborn.segmentation.ground_truth import GroundTruthSegmenter

CAMERA = CameraModel()
POSE = Pose(0.31, -0.77, 0.6)


def depth_image(rng: np.random.Generator, noise_m: float) -> NDArray[np.float32]:
    """Returns 120 x 160 pixels of slanted patches with holes."""
    patches = np.kron(rng.uniform(0.4, 5.2, (6, 8)), np.ones((20, 20))) * np.linspace(0.9, 1.1, 160)
    depth = patches + rng.normal(0.0, 1.0, patches.shape) * noise_m
    depth[rng.random(depth.shape) < 0.05] = 0.0
    return np.clip(depth, 0.0, 5.0).astype(np.float32)


def sight_window() -> Window:
    """Returns a window that holds all cells that the camera sees from `POSE`."""
    return GridFrame.around_start(600, 0.05).window_at(POSE.x_m, POSE.y_m, sight_window_cells(CAMERA, 0.05))


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


def test_pixels_are_projected_as_float32_arithmetic_has_it() -> None:
    rng = np.random.default_rng(1)
    rays, pose, window = Rays(CAMERA, 2, 4), POSE, sight_window()
    depth = depth_image(rng, noise_m=0.01)
    confirmed = rng.random(depth.shape) < 0.9
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


@pytest.mark.parametrize("pixels", [0, 1, 2, 3, 4, 31, 32])
def test_an_image_shows_no_noise_where_the_median_change_is_less_than_the_limit(pixels: int) -> None:
    rng = np.random.default_rng(pixels)
    for _ in range(50):
        depth = rng.uniform(0.5, 5.0, (16, 32)).astype(np.float32)
        change = rng.normal(0.0, 1e-3, (4, 8)).astype(np.float32)
        count = np.zeros((4, 8), np.uint8)
        count.reshape(-1)[rng.permutation(32)[:pixels]] = 3
        some = count > 0
        rough = np.abs(change[some]) / np.square(depth[::4, ::4][some])
        median = np.median(rough) if pixels else np.float32(np.inf)
        for limit in (median, np.nextafter(median, np.float32(0.0)), np.nextafter(median, np.float32(1.0))):
            assert shows_no_noise(depth, 4, change, count, np.float32(limit)) == (median < np.float32(limit))


def test_points_are_counted_in_the_cells_that_they_are_projected_to() -> None:
    rng = np.random.default_rng(4)
    rays, window = Rays(CAMERA, 2, 4), sight_window()
    depth = depth_image(rng, noise_m=0.01)
    confirmed = rng.random(depth.shape) < 0.9
    counted = rays.count_obstacles(depth, confirmed, POSE, window, band_m=(0.1, 0.88), eye_level_halfwidth_m=0.06)
    points = rays.project(depth, confirmed, POSE, window)
    in_band = (points.height_m >= 0.1) & (points.height_m <= 0.88)
    at_eye_level = np.abs(points.height_m - CAMERA.height_m) <= 0.06
    for count, which in zip(counted, (in_band, at_eye_level), strict=True):
        flat = points.rows[which] * window.frame.shape[1] + points.cols[which]
        expected = np.bincount(flat, minlength=count.size).reshape(count.shape)
        assert expected.max() > 2
        assert np.array_equal(count, np.minimum(expected, 2))
    rows, cols = in_range(CAMERA, POSE, window.frame)
    assert not any(np.delete(np.delete(count, rows, 0), cols, 1).any() for count in counted)


def test_pixels_have_the_cells_that_they_are_projected_to() -> None:
    rays, window = Rays(CAMERA, 2, 4), sight_window()
    depth = depth_image(np.random.default_rng(5), noise_m=0.01)
    points = rays.project(depth, np.ones(depth.shape, np.bool_), POSE, window)
    cells = rays.cells_below(depth, POSE, window, 1.2)
    low = points.height_m <= 1.2
    expected_rows, expected_cols = (np.full(depth.shape, -1, np.int32) for _ in range(2))
    expected_rows[points.valid], expected_cols[points.valid] = (
        np.where(low, points.rows, -1),
        np.where(low, points.cols, -1),
    )
    assert np.array_equal(cells.rows, expected_rows)
    assert np.array_equal(cells.cols, expected_cols)
    assert cells.span == tuple(slice(at.min(), at.max() + 1) for at in (points.rows, points.cols))
    assert rays.cells_below(np.zeros_like(depth), POSE, window, 1.2).span is None


def seen_past(sight: SightLines, frame: GridFrame, rows: NDArray, cols: NDArray, drop_m: float) -> NDArray[np.bool_]:
    """Returns the result of `SightLines.passes` with a margin of 5 cm."""
    x_m, y_m = frame.centres(rows, cols)
    cos, sin = math.cos(sight.pose.yaw_rad), math.sin(sight.pose.yaw_rad)
    dx, dy = x_m - sight.pose.x_m, y_m - sight.pose.y_m
    ahead_m, left_m = cos * dx + sin * dy, cos * dy - sin * dx
    passed = np.zeros(ahead_m.shape, np.bool_)
    near = np.flatnonzero((ahead_m > CAMERA.min_depth_m) & (ahead_m + 0.05 < CAMERA.max_depth_m))
    ahead_m, left_m = ahead_m[near], left_m[near]
    row = np.ceil((sight.up[0] + drop_m / ahead_m) / (sight.up[0] - sight.up[1])).astype(np.intp)
    side_m = frame.cell_m * math.sqrt(0.5) * np.array([[-1.0], [0.0], [1.0]])
    column_step = sight.left[0] - sight.left[1]
    columns = np.rint((sight.left[0] - (left_m + side_m) / ahead_m) / column_step).astype(np.intp)
    inside = (row < sight.up.size) & (columns.min(axis=0) >= 0) & (columns.max(axis=0) < sight.left.size)
    near, ahead_m, row, columns = near[inside], ahead_m[inside], row[inside], columns[:, inside]
    passed[near] = sight.nearest_m[row, columns].min(axis=0) > ahead_m + 0.05
    return passed


def test_a_frame_sees_past_the_cells_before_its_nearest_surfaces() -> None:
    rays, frame = Rays(CAMERA, 2, 4), sight_window().frame
    depth = np.maximum(depth_image(np.random.default_rng(6), noise_m=0.0), np.float32(2.5))
    sight = SightLines.of_frame(depth, rays.up, rays.left, POSE, rise_m=0.0)
    first = np.count_nonzero(rays.up > 0.0)
    assert np.array_equal(sight.nearest_m, np.minimum.accumulate(depth[first:], axis=0))
    rows, cols = (index.reshape(-1) for index in np.indices(frame.shape))
    passed = sight.passes(frame, rows, cols, 0.78, (CAMERA.min_depth_m, CAMERA.max_depth_m), 0.05)
    assert np.array_equal(passed, seen_past(sight, frame, rows, cols, 0.78))
    assert passed.sum() > 100


@pytest.mark.parametrize("single", [0, 1, 2])
def test_evidence_grows_where_points_are_and_falls_where_the_frame_sees_past(single: int) -> None:
    rng = np.random.default_rng(7)
    rays, window, config = Rays(CAMERA, 2, 4), sight_window(), OccupancyConfig()
    shape = window.frame.shape
    view = NavMap.empty(window.frame)
    view.obstacle_evidence[:] = rng.integers(0, config.most + 1, shape) * (rng.random(shape) < 0.5)
    view.seen_obstacle[:] = view.obstacle_evidence >= config.obstacle_from
    view.seen_at_eye_level[:] = (view.obstacle_evidence > 0) & (rng.random(shape) < 0.5)
    part = in_range(CAMERA, POSE, window.frame)
    solid, tall = np.zeros((2, *shape), np.uint8)
    for count in (solid, tall):
        count[part] = rng.integers(0, 3, count[part].shape) * (rng.random(count[part].shape) < 0.3)
    depth = np.maximum(depth_image(rng, noise_m=0.0), np.float32(2.5))
    sight = SightLines.of_frame(depth, rays.up, rays.left, POSE, rise_m=0.0)
    evidence, eye_level = view.obstacle_evidence.copy(), view.seen_at_eye_level.copy()
    of_count = np.array([0, single, config.hit])
    rows, cols = (index.reshape(-1) for index in np.indices(shape))
    passed = seen_past(sight, window.frame, rows, cols, CAMERA.height_m - 0.1).reshape(shape)
    eye_level |= of_count[tall] > 0
    changed = (of_count[solid] > 0) | (evidence > 0)
    lost = config.miss * (passed & (of_count[solid] == 0))
    assert ((lost > 0) & (evidence > 0)).sum() > 100
    evidence = np.minimum(np.maximum(evidence - lost, 0) + of_count[solid], config.most)
    eye_level[changed & (evidence == 0)] = False
    Occupancy(CAMERA, config, 0.1).add(view, part, solid, tall, sight, single)
    assert np.array_equal(view.obstacle_evidence, evidence)
    assert np.array_equal(view.seen_obstacle, evidence >= config.obstacle_from)
    assert np.array_equal(view.seen_at_eye_level, eye_level)


def test_the_ground_truth_scores_the_goal_and_all_other_categories_but_void() -> None:
    semantic = np.random.default_rng(8).integers(0, 41, (6, 9)).astype(np.uint8)
    semantic[0, 0] = MPCAT40_ID["chair"]
    target, other = GroundTruthSegmenter().scores({"semantic": semantic}, "chair")
    is_chair = semantic == MPCAT40_ID["chair"]
    assert target.dtype == other.dtype == np.float32
    assert np.array_equal(target, is_chair)
    assert np.array_equal(other, (semantic != 0) & ~is_chair)
    for goal in ("void", "unicorn"):
        with pytest.raises(ConfigError, match=f"no category '{goal}'. Available: wall, floor, "):
            GroundTruthSegmenter().scores({"semantic": semantic}, goal)


@pytest.mark.parametrize("share", [0.0, 0.001, 0.05])
def test_distances_within_a_reach_are_exact_and_others_are_the_reach(share: float) -> None:
    mask = np.random.default_rng(3).random((40, 70)) < share
    exact, found = distance_to(mask), distance_within(mask, 6)
    near = exact <= 6.0
    assert found[near] == pytest.approx(exact[near], rel=1e-6)
    assert (found[~near] == 6.0).all()


@pytest.mark.parametrize("share", [0.0, 0.001, 0.05])
@pytest.mark.parametrize("distance_m", [0.15, 0.2, 0.6, 1.0])
def test_cells_farther_than_a_distance_are_those_of_the_exact_distances(share: float, distance_m: float) -> None:
    mask = np.random.default_rng(3).random((60, 70)) < share
    assert np.array_equal(farther_than(mask, distance_m, 0.05), distance_to(mask) * 0.05 > distance_m)


def test_a_distance_beyond_the_computed_ones_is_refused_with_the_limit() -> None:
    mask = np.ones((2, 2), np.bool_)
    assert not farther_than(mask, 8.9, 0.05).any()
    with pytest.raises(ConfigError, match=r"own_known_m.*8\.9.*0\.05.*9"):
        farther_than(mask, 9.0, 0.05)


def test_exact_posteriors_are_one_for_the_category_and_zero_for_void() -> None:
    semantic = np.random.default_rng(4).integers(0, 41, (24, 32), np.uint8)
    semantic[2, 2] = 0
    posteriors = GroundTruthSegmenter().posteriors({"semantic": semantic})
    middle = semantic[2::4, 2::4]
    assert np.array_equal(posteriors, middle == np.arange(1, 41)[:, None, None])


def test_exact_posteriors_are_made_once_for_each_frame() -> None:
    segmenter, frames = GroundTruthSegmenter(), [np.full((8, 8), category, np.uint8) for category in (3, 5)]
    first = segmenter.posteriors({"semantic": frames[0]})
    assert segmenter.posteriors({"semantic": frames[0]}) is first
    second = segmenter.posteriors({"semantic": frames[1]})
    assert (first[2].all(), second[2].any(), second[4].all()) == (True, False, True)


def test_bits_are_added_to_those_of_a_cell_where_they_count() -> None:
    seen = np.array([[1, 2]], np.uint32)
    rows, cols = np.zeros(3, np.int32), np.array([0, 0, 1], np.int32)
    enter_bits(seen, rows, cols, np.array([4, 8, 16], np.uint32), np.array([True, True, False]))
    assert seen.tolist() == [[13, 2]]


def test_a_reach_whose_square_is_no_short_number_is_refused() -> None:
    with pytest.raises(ValueError, match="at most 180 cells"):
        distance_within(np.ones((2, 2), np.bool_), 181)


@pytest.mark.parametrize("connectivity", [4, 8])
def test_the_part_of_a_cell_is_the_one_that_opencv_numbers_like_it(connectivity: int) -> None:
    rng = np.random.default_rng(10)
    for mask in (rng.random((30, 40)) < 0.55, (rng.random((40, 30)) < 0.55).T, np.ones((3, 1), np.bool_)):
        given = mask.copy()
        _, parts = cv2.connectedComponents(np.ascontiguousarray(mask).view(np.uint8), connectivity=connectivity)
        for row, col in zip(*(rng.integers(0, n, 20) for n in mask.shape), strict=True):
            expected = (parts == parts[row, col]) & mask[row, col]
            assert np.array_equal(connected(mask, row, col, connectivity=connectivity), expected)
        assert np.array_equal(mask, given)


def test_a_point_between_cells_has_their_mean_and_one_off_the_grid_has_no_value() -> None:
    values = np.array([[1.0, 2.0], [3.0, np.inf]], np.float32)
    x_m, y_m = np.array([0.05, 0.03, 0.099, 0.2]), np.array([0.049, 0.03, 0.099, 0.03])
    found = bilinear(values, 0.0, 0.0, 0.05, x_m, y_m)
    assert found[0] == pytest.approx((0.52 / 2 * 1 + 0.52 / 2 * 2 + 0.48 / 2 * 3) / (1 - 0.48 / 2))
    assert found[1] == pytest.approx((0.9 * 0.9 * 1 + 0.9 * 0.1 * 2 + 0.1 * 0.9 * 3) / (1 - 0.1 * 0.1))
    assert np.isinf(found[2:]).all()
