import math

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40_ID, CameraModel, ConfigError, RobotModel, Scores
from stubborn.mapping.mapper import Mapper, MappingConfig, note_sighting
from stubborn.mapping.navmap import NavMap
from tests.helpers.gridworld import Box, GridWorld

CAMERA = CameraModel()
FRAME = GridFrame.around_start(400, 0.05)
EVERY_PIXEL = MappingConfig(obstacle_stride_px=1, score_stride_px=1)
SKEW = math.radians(37.0)


def wall_ahead(distance_m: float, yaw_rad: float = 0.0) -> np.ndarray:
    """Returns the exact depth image of a wall across the view."""
    world = GridWorld([Box((distance_m, distance_m + 0.1), (-9.0, 9.0))], (0.0, 0.0, yaw_rad), camera=CAMERA)
    return world.render()[0]


def mapped(depth: np.ndarray, pose: Pose, config: MappingConfig = EVERY_PIXEL) -> NavMap:
    navmap = NavMap.empty(FRAME)
    (mapper := Mapper(CAMERA, RobotModel(), config)).add_depth(mapper.frame(navmap, pose), depth)
    return navmap


def brute_force(depth: np.ndarray, pose: Pose, low_m: float, high_m: float) -> np.ndarray:
    """Returns the cells hit by pixels of a height band, computed pixel by pixel."""
    layer = np.zeros(FRAME.shape, bool)
    for v in range(0, CAMERA.height_px, 3):
        for u in range(0, CAMERA.width_px, 3):
            d = float(depth[v, u])
            height = CAMERA.height_m + d * (0.5 * CAMERA.height_px - v - 0.5) / CAMERA.focal_px
            if 0.5 <= d < 5.0 and low_m <= height <= high_m:
                left = d * (0.5 * CAMERA.width_px - u - 0.5) / CAMERA.focal_px
                x = pose.x_m + d * math.cos(pose.yaw_rad) - left * math.sin(pose.yaw_rad)
                y = pose.y_m + d * math.sin(pose.yaw_rad) + left * math.cos(pose.yaw_rad)
                layer[FRAME.cell(x, y)] = True
    return layer


@pytest.mark.parametrize("distance_m", [0.6, 4.8])
@pytest.mark.parametrize("yaw_rad", [0.0, SKEW])
def test_a_wall_lands_within_a_cell_of_where_it_is(distance_m: float, yaw_rad: float):
    navmap = mapped(wall_ahead(distance_m, yaw_rad), Pose(0.0, 0.0, yaw_rad))
    rows, cols = np.nonzero(navmap.seen_obstacle)
    x_m, _ = FRAME.centres(rows, cols)
    assert rows.size > 5
    assert np.abs(x_m - distance_m).max() <= 0.05


@pytest.mark.parametrize("distance_m", [1.0, 4.8])
def test_the_obstacle_layer_equals_a_brute_force_projection_of_pixels(distance_m: float):
    depth, pose = wall_ahead(distance_m, SKEW), Pose(0.21, -0.4, SKEW)
    fast, slow = mapped(depth, pose).seen_obstacle, brute_force(depth, pose, 0.10, 0.88)
    grown = np.zeros_like(fast)
    for dr in (-1, 0, 1):
        for dc in (-1, 0, 1):
            grown |= np.roll(fast, (dr, dc), (0, 1))
    assert not (slow & ~grown).any()  # float32 may push a point over a cell's edge, no farther
    assert fast.sum() <= 1.2 * slow.sum() + 10


@pytest.mark.parametrize(("climb_m", "obstacle"), [(0.012, True), (0.16, False)])
def test_what_the_robot_climbs_is_no_obstacle_in_its_map(climb_m: float, obstacle: bool):
    world = GridWorld([Box((2.0, 2.5), (-1.0, 1.0), (0.0, 0.15))], (0.0, 0.0, 0.0), camera=CAMERA)
    navmap, mapper = NavMap.empty(FRAME), Mapper(CAMERA, RobotModel(climb_m=climb_m), EVERY_PIXEL)
    mapper.add_depth(mapper.frame(navmap, Pose(0.0, 0.0, 0.0)), world.render()[0])
    assert navmap.seen_obstacle.any() == obstacle


@pytest.mark.parametrize("distance_m", [1.0, 4.8])
def test_every_second_pixel_gives_the_same_wall_without_gaps(distance_m: float):
    pose = Pose(0.0, 0.0, SKEW)
    depth = wall_ahead(distance_m, SKEW)
    full = mapped(depth, pose).seen_obstacle
    default = mapped(depth, pose, MappingConfig()).seen_obstacle
    assert default.sum() >= 0.97 * full.sum()


@pytest.mark.parametrize("distance_m", [1.0, 4.8])
def test_the_sides_of_a_post_land_where_they_are(distance_m: float):
    post = Box((distance_m, distance_m + 0.2), (0.10, 0.30))
    navmap = mapped(GridWorld([post], (0.0, 0.0, 0.0), camera=CAMERA).render()[0], Pose(0.0, 0.0, 0.0))
    _, y_m = FRAME.centres(*np.nonzero(navmap.seen_obstacle))
    assert y_m.min() == pytest.approx(0.10, abs=0.03)
    assert y_m.max() == pytest.approx(0.30, abs=0.03)


def test_no_return_and_the_end_of_the_range_put_nothing_on_the_map():
    depth = np.zeros((480, 640), np.float32)
    depth[:, 320:] = CAMERA.max_depth_m
    navmap = mapped(depth, Pose(0.0, 0.0, 0.0))
    assert not navmap.seen_obstacle.any()


@pytest.mark.parametrize(
    ("z", "obstacle", "eye_level"),
    [((0.0, 0.08), False, False), ((0.0, 0.14), True, False), ((0.95, 1.4), False, False), ((0.5, 1.2), True, True)],
)
def test_a_surface_between_step_and_robot_height_is_an_obstacle(z: tuple, obstacle: bool, eye_level: bool):
    world = GridWorld([Box((2.0, 2.2), (-0.5, 0.5), z)], (0.0, 0.0, 0.0), camera=CAMERA)
    navmap = mapped(world.render()[0], Pose(0.0, 0.0, 0.0))
    assert navmap.seen_obstacle.any() == obstacle
    assert navmap.seen_at_eye_level.any() == eye_level


def scored(world: GridWorld, category_id: int, navmap: NavMap, step: int = 0, pose: Pose | None = None):
    depth, semantic = world.render()
    target = (semantic == category_id).astype(np.float32)
    mapper = Mapper(world.camera, RobotModel(), MappingConfig(score_stride_px=2))
    return mapper.add_scores(
        mapper.frame(navmap, pose or Pose(0.0, 0.0, 0.0)), depth, Scores(target, 1.0 - target), step
    )


PICTURE_ID, WALL_ID = 6, 1


@pytest.mark.parametrize(("z", "found"), [((1.5, 1.9), True), ((2.25, 2.4), False), ((0.02, 0.2), True)])
def test_target_points_of_all_heights_up_to_two_metres_twenty_count(z: tuple, found: bool):
    wall = Box((3.0, 3.1), (-3.0, 3.0))
    picture = Box((2.96, 3.0), (-0.3, 0.3), z, "picture")
    navmap = NavMap.empty(FRAME)
    sighting = scored(GridWorld([wall, picture], (0.0, 0.0, 0.0), camera=CAMERA), PICTURE_ID, navmap)
    assert (navmap.score_max > 0.5).any() == found
    assert (sighting.distance_m.size > 0) == found
    if found:
        rows, cols = np.nonzero(navmap.score_max > 0.5)
        x_m, y_m = FRAME.centres(rows, cols)
        assert np.abs(x_m - 2.96).max() <= 0.08
        assert np.abs(y_m).max() <= 0.35
        assert sighting.distance_m.min() == pytest.approx(2.96, abs=0.05)


def test_the_object_layers_count_one_score_a_cell_and_frame():
    wall, picture = Box((2.0, 2.1), (-3.0, 3.0)), Box((1.97, 2.0), (-0.3, 0.3), (0.7, 1.1), "picture")
    world = GridWorld([wall, picture], (0.0, 0.0, 0.0), camera=CAMERA)
    navmap = NavMap.empty(FRAME)
    for step in range(3):
        scored(world, PICTURE_ID, navmap, step)
    target = navmap.score_max > 0.5
    assert (navmap.frames_in_view[target] == 3).all()
    np.testing.assert_array_equal(navmap.score_sum[target], 3.0)
    assert (navmap.found_step[target] == 0).all()
    assert (navmap.score_sum[~target] == 0.0).all()
    wall_cell = FRAME.cell(2.0, 1.0)
    assert navmap.frames_in_view[wall_cell] == 3
    assert navmap.other_max[wall_cell] == 1.0


def test_a_cell_takes_the_highest_score_of_its_pixels():
    depth = np.full((480, 640), 3.0, np.float32)
    target = np.full((480, 640), 0.1, np.float32)
    target[200:210] = 0.8
    navmap = NavMap.empty(FRAME)
    mapper = Mapper(CAMERA, RobotModel(), MappingConfig())
    mapper.add_scores(mapper.frame(navmap, Pose(0.0, 0.0, 0.0)), depth, Scores(target, target), 0)
    assert navmap.score_max[FRAME.cell(3.0, 0.0)] == pytest.approx(0.8)


@pytest.mark.parametrize("fraction", [2, 4, 8])
def test_scores_at_a_whole_fraction_of_the_image_are_projected_to_the_same_place(fraction: int):
    picture = Box((1.97, 2.0), (-0.4, 0.2), (0.7, 1.1), "picture")
    depth, semantic = GridWorld([picture], (0.0, 0.0, 0.0), camera=CAMERA).render()
    target = (semantic == PICTURE_ID).astype(np.float32)
    small = target[fraction // 2 :: fraction, fraction // 2 :: fraction]
    full, part = NavMap.empty(FRAME), NavMap.empty(FRAME)
    mapper = Mapper(CAMERA, RobotModel(), MappingConfig(score_stride_px=2))
    mapper.add_scores(mapper.frame(full, Pose(0.0, 0.0, 0.0)), depth, Scores(target, target), 0)
    mapper.add_scores(mapper.frame(part, Pose(0.0, 0.0, 0.0)), depth, Scores(small, small), 0)
    assert (part.score_max > 0.5).sum() >= 0.8 * (full.score_max > 0.5).sum() > 0
    assert not ((part.score_max > 0.5) & (full.score_max <= 0.5)).any()


@pytest.mark.parametrize(("fraction", "stride_px"), [(1, 4), (2, 4), (4, 8)])
def test_a_score_is_put_at_the_depth_of_its_own_pixel(fraction: int, stride_px: int):
    """Otherwise the rim of a near target would lie on the wall behind it."""
    picture, wall = Box((1.5, 1.6), (-0.41, 0.33), (0.2, 1.5), "picture"), Box((4.5, 4.6), (-9.0, 9.0))
    depth, semantic = GridWorld([picture, wall], (0.0, 0.0, 0.0), camera=CAMERA).render()
    middle = slice(fraction // 2, None, fraction)
    target = (semantic == PICTURE_ID).astype(np.float32)[middle, middle]
    navmap = NavMap.empty(FRAME)
    mapper = Mapper(CAMERA, RobotModel(), MappingConfig(score_stride_px=stride_px))
    mapper.add_scores(mapper.frame(navmap, Pose(0.0, 0.0, 0.0)), depth, Scores(target, 1.0 - target), 0)
    x_m, _ = FRAME.centres(*np.nonzero(navmap.score_max > 0.5))
    assert x_m.size > 0
    assert x_m.max() < 1.7


def test_scores_of_another_shape_are_refused_with_both_shapes():
    wrong = np.zeros((100, 100), np.float32)
    with pytest.raises(ConfigError, match="480 x 640 image, got 100 x 100"):
        (mapper := Mapper(CAMERA, RobotModel(), MappingConfig())).add_scores(
            mapper.frame(NavMap.empty(FRAME), Pose(0.0, 0.0, 0.0)),
            np.ones((480, 640), np.float32),
            Scores(wrong, wrong),
            0,
        )


def test_a_rim_of_the_target_does_not_count_and_its_inside_does():
    """A seam of the target's left edge has the depth of the door frame before it, as a noisy camera shows it."""
    depth = np.full((480, 640), 4.0, np.float32)
    target = np.zeros((480, 640), np.float32)
    target[200:280, 300:360] = 1.0
    depth[:, :303] = 1.0  # three columns of the target lie on the frame
    full = CameraModel()
    layers = {}
    for rim_px in (0, 3):
        navmap = NavMap.empty(FRAME)
        mapper = Mapper(full, RobotModel(), MappingConfig(score_stride_px=1))
        mapper.add_scores(
            mapper.frame(navmap, Pose(0.0, 0.0, 0.0)), depth, Scores(target, 1.0 - target), 0, rim_px=rim_px
        )
        layers[rim_px] = FRAME.centres(*np.nonzero(navmap.score_max > 0.5))[0]
    assert layers[0].min() < 1.1
    assert layers[3].min() > 3.9
    assert layers[3].size > 0


@pytest.mark.parametrize("noise_m", [0.0, 0.02])
def test_a_depth_image_is_exact_as_long_as_it_shows_no_noise(noise_m: float):
    depth, _ = GridWorld([Box((2.0, 2.1), (-3.0, 3.0))], (0.0, 0.0, 0.0), camera=CAMERA).render()
    noise = np.random.default_rng(0).normal(0.0, noise_m, depth.shape).astype(np.float32)
    mapper = Mapper(CAMERA, RobotModel(), MappingConfig())
    exact = mapper.add_depth(
        mapper.frame(NavMap.empty(FRAME), Pose(0.0, 0.0, 0.0)), np.where(depth > 0, depth + noise, 0)
    )
    assert exact == (noise_m == 0.0)


def test_a_sighting_is_noted_on_the_whole_map_from_any_window():
    maps, sightings = [], []
    for window in (FRAME.part(slice(None), slice(None)), FRAME.part(slice(150, 300), slice(180, 320))):
        navmap = NavMap.empty(FRAME)
        row, col = FRAME.cell(2.0, 1.0)
        rows, cols = np.array([row, row + 1]) - window.rows.start, np.array([col, col + 3]) - window.cols.start
        sightings.append(note_sighting(navmap, window, rows, cols, Pose(-1.0, -3.0, 0.3)))
        maps.append(navmap)
        assert navmap.shown_x[row, col] == pytest.approx(-0.6, abs=0.01)
        assert navmap.shown_y[row, col] == pytest.approx(-0.8, abs=0.01)
    for name in ("rows", "cols", "distance_m"):
        np.testing.assert_allclose(getattr(sightings[0], name), getattr(sightings[1], name), rtol=1e-6)
    np.testing.assert_allclose(maps[0].shown_x, maps[1].shown_x, rtol=1e-5)
    assert sightings[0].distance_m[0] == pytest.approx(5.0, abs=0.05)
    assert np.count_nonzero(maps[1].shown_y) == 2


def test_goals_beyond_the_edge_of_the_map_are_left_out_and_do_not_stop_the_agent():
    navmap = NavMap.empty(GridFrame.around_start(200, 0.05))  # ends 5 m from the start
    mapper, pose = Mapper(CAMERA, RobotModel(), MappingConfig()), Pose(3.5, 0.0, 0.0)
    depth = GridWorld([Box((6.0, 6.1), (-9.0, 9.0))], (3.5, 0.0, 0.0), camera=CAMERA).render()[0]
    posteriors = np.zeros((40, 120, 160), np.float32)
    posteriors[MPCAT40_ID["bed"] - 1] = 1.0
    mapper.add_goals(mapper.frame(navmap, pose), depth, posteriors)
    x_m, _ = navmap.frame.centres(*np.nonzero(navmap.goals_seen))
    assert x_m.size > 0
    assert x_m.min() > 3.5


def test_the_observation_stays_as_it_is_when_every_pixel_is_used():
    depth, scores = wall_ahead(2.0), Scores(np.ones((480, 640), np.float32), np.zeros((480, 640), np.float32))
    depth += np.random.default_rng(0).normal(0.0, 0.01, depth.shape).astype(np.float32)
    before = depth.copy()
    (mapper := Mapper(CAMERA, RobotModel(), EVERY_PIXEL)).add_scores(
        mapper.frame(NavMap.empty(FRAME), Pose(0, 0, 0)), depth, scores, 0, rim_px=0
    )
    np.testing.assert_array_equal(depth, before)
