"""Object layers against a projection of every pixel, one after the other."""

import math

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel, RobotModel, Scores
from stubborn.mapping.mapper import Mapper, MappingConfig
from stubborn.mapping.navmap import NavMap
from stubborn.mapping.object_layers import LatestFrame
from stubborn.mapping.occupancy import OccupancyConfig
from tests.helpers.gridworld import Box, GridWorld

CAMERA = CameraModel(width_px=160, height_px=120)
FULL = CameraModel()
FRAME = GridFrame.around_start(300, 0.05)
TOP_M = 2.2
POSES = (Pose(0.0, 0.0, 0.0), Pose(0.13, -0.27, math.radians(37.0)))


def frame_at(pose: Pose, distance_m: float, camera: CameraModel = CAMERA) -> np.ndarray:
    """Returns the depth of a wall across the view at x = `distance_m` that exceeds the height range of the layers."""
    world = GridWorld(
        [Box((distance_m, distance_m + 0.1), (-9.0, 9.0), (0.0, 3.0))],
        (pose.x_m, pose.y_m, pose.yaw_rad),
        camera=camera,
    )
    return world.render()[0]


def random_scores(seed: int) -> Scores:
    rng = np.random.default_rng(seed)
    target = rng.random((CAMERA.height_px, CAMERA.width_px), np.float32)
    return Scores(target * (target > 0.3), rng.random(target.shape, np.float32))


def brute_force(
    depth: np.ndarray, scores: Scores, pose: Pose, *, of_target_pixel: bool
) -> dict[tuple[int, int], tuple[float, float]]:
    """Returns the highest target score of each cell in view, and the highest other score (of the same pixel)."""
    found: dict[tuple[int, int], tuple[float, float]] = {}
    for v in range(CAMERA.height_px):
        for u in range(CAMERA.width_px):
            d = np.float64(depth[v, u])
            height = CAMERA.height_m + d * (0.5 * CAMERA.height_px - v - 0.5) / CAMERA.focal_px
            if not 0.5 <= d < 5.0 or height > TOP_M:
                continue
            left = d * (0.5 * CAMERA.width_px - u - 0.5) / CAMERA.focal_px
            x = pose.x_m + d * math.cos(pose.yaw_rad) - left * math.sin(pose.yaw_rad)
            y = pose.y_m + d * math.sin(pose.yaw_rad) + left * math.cos(pose.yaw_rad)
            here = float(scores.target[v, u]), float(scores.best_other[v, u])
            before = found.get(FRAME.cell(x, y), (0.0, 0.0))
            separate = max(before[0], here[0]), max(before[1], here[1])
            found[FRAME.cell(x, y)] = max(before, here) if of_target_pixel else separate
    return found


def layers_by_brute_force(frames: list, *, of_target_pixel: bool) -> dict[str, np.ndarray]:
    layers = {name: np.zeros(FRAME.shape) for name in ("frames_in_view", "score_sum", "score_max", "other_max")}
    for depth, scores, pose in frames:
        for cell, (target, other) in brute_force(depth, scores, pose, of_target_pixel=of_target_pixel).items():
            layers["frames_in_view"][cell] += 1
            layers["score_sum"][cell] += target
            layers["score_max"][cell] = max(layers["score_max"][cell], target)
            layers["other_max"][cell] = max(layers["other_max"][cell], other)
    return layers


@pytest.mark.costly
@pytest.mark.parametrize("of_target_pixel", [False, True])
@pytest.mark.parametrize("distance_m", [1.0, 2.5, 4.8])
def test_the_four_layers_equal_a_projection_of_every_pixel(distance_m: float, of_target_pixel: bool):
    frames = [(frame_at(pose, distance_m), random_scores(i), pose) for i, pose in enumerate(POSES)]
    navmap = NavMap.empty(FRAME)
    occupancy = OccupancyConfig(neighbours=0)  # lone pixels count
    config = MappingConfig(score_stride_px=1, occupancy=occupancy, other_of_target_pixel=of_target_pixel)
    mapper = Mapper(CAMERA, RobotModel(), config)
    for step, (depth, scores, pose) in enumerate(frames):
        mapper.add_scores(mapper.frame(navmap, pose), depth, scores, step)
    expected = layers_by_brute_force(frames, of_target_pixel=of_target_pixel)
    for name, layer in expected.items():
        ours = np.asarray(getattr(navmap, name), np.float64)
        differs = np.abs(ours - layer) > 1e-4
        # float32 may push a pixel on the edge between two cells to the other side
        assert differs.sum() <= 0.01 * (expected["frames_in_view"] > 0).sum(), name


@pytest.mark.parametrize("distance_m", [1.0, 2.5, 4.8])
@pytest.mark.parametrize("pose", POSES)
def test_a_target_on_a_wall_lands_within_a_cell_of_it(distance_m: float, pose: Pose):
    depth = frame_at(pose, distance_m, FULL)
    up = (0.5 * FULL.height_px - np.arange(FULL.height_px) - 0.5) / FULL.focal_px
    height_m = FULL.height_m + depth * up[:, None]
    target = (height_m > 0.3).astype(np.float32)  # all of the wall but its foot
    navmap = NavMap.empty(FRAME)
    (mapper := Mapper(FULL, RobotModel(), MappingConfig())).add_scores(
        mapper.frame(navmap, pose), depth, Scores(target, 1 - target), 0
    )
    x_m, _ = FRAME.centres(*np.nonzero(navmap.score_max > 0.5))
    assert x_m.size > 5
    assert np.abs(x_m - distance_m).max() <= 0.05 + 1e-6


def test_one_frames_score_takes_the_place_of_the_layers_where_it_looks():
    pose = POSES[0]
    depth = frame_at(pose, 2.0)
    yes = np.full(depth.shape, 0.8, np.float32)
    no = np.full(depth.shape, 0.1, np.float32)
    navmap = NavMap.empty(FRAME)
    mapper = Mapper(CAMERA, RobotModel(), MappingConfig(), LatestFrame(0.5))
    mapper.add_scores(mapper.frame(navmap, pose), depth, Scores(yes, no), 3)
    seen = navmap.score_max > 0.5
    assert seen.any()
    assert (navmap.found_step[seen] == 3).all()
    half = depth.copy()
    half[:, :80] = 0.0  # no return on the left
    mapper.add_scores(mapper.frame(navmap, pose), half, Scores(no, yes), 4)
    left, right = FRAME.cell(2.0, 0.3), FRAME.cell(2.0, -0.3)
    assert navmap.score_max[left] == pytest.approx(0.8)
    assert navmap.other_max[left] == pytest.approx(0.1)
    assert navmap.score_max[right] == pytest.approx(0.1)
    assert navmap.score_sum[right] == pytest.approx(0.1)
    assert navmap.other_max[right] == pytest.approx(0.8)
    assert navmap.frames_in_view[right] == 2
    mapper.add_scores(mapper.frame(navmap, pose), depth, Scores(yes, no), 9)
    assert navmap.found_step[right] == 9
    assert navmap.found_step[left] == 3


def test_frames_are_counted_and_candidates_found_in_episodes_of_a_million_steps():
    depth = frame_at(POSES[0], 2.0)
    yes, no = np.full(depth.shape, 0.8, np.float32), np.full(depth.shape, 0.1, np.float32)
    navmap, cell = NavMap.empty(FRAME), FRAME.cell(2.0, 0.3)
    navmap.frames_in_view[cell] = (1 << 16) - 1
    mapper = Mapper(CAMERA, RobotModel(), MappingConfig())
    mapper.add_scores(mapper.frame(navmap, POSES[0]), depth, Scores(yes, no), 40_000)
    assert navmap.found_step[cell] == 40_000
    assert navmap.frames_in_view[cell] == 1 << 16


def test_a_frame_without_the_target_clears_the_cells_in_view():
    pose = POSES[0]
    depth = frame_at(pose, 2.0)
    ones, zeros = np.ones_like(depth), np.zeros_like(depth)
    navmap = NavMap.empty(FRAME)
    mapper = Mapper(CAMERA, RobotModel(), MappingConfig(), LatestFrame(0.5))
    mapper.add_scores(mapper.frame(navmap, pose), depth, Scores(ones, zeros), 0)
    mapper.add_scores(mapper.frame(navmap, pose), depth, Scores(zeros, ones), 1)
    assert not (navmap.score_max > 0).any()
