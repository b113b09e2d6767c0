import math

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel, ConfigError, RobotModel, Scores
from sim.sensors.depth_noise import NoisyDepth
from sim.sensors.noise import get_noise
from stubborn.mapping.mapper import Mapper, MappingConfig
from stubborn.mapping.navmap import NavMap
from stubborn.mapping.occupancy import OccupancyConfig, Surfaces
from tests.helpers.gridworld import Box, GridWorld

CAMERA = CameraModel()
FRAME = GridFrame.around_start(300, 0.05)
ROOM = [
    Box((3.0, 3.1), (-3.1, 3.1)),
    Box((-3.1, -3.0), (-3.1, 3.1)),
    Box((-3.1, 3.1), (3.0, 3.1)),
    Box((-3.1, 3.1), (-3.1, -3.0)),
]
TABLE = Box((1.2, 2.0), (-0.6, 0.6), (0.70, 0.75), "table")
CHAIR_ID = 3


class Noise:
    """The noise of one episode; its systematic error is the same in all frames."""

    def __init__(self, preset: str, seed: int) -> None:
        self._model, self._rng = NoisyDepth(get_noise(preset).depth, CAMERA), np.random.default_rng(seed)
        self._model.begin(np.zeros(1, np.float32))

    def added_to(self, depth: np.ndarray) -> np.ndarray:
        return self._model.apply({"depth": depth}, {"geom": np.zeros(depth.shape, np.int32)}, self._rng)["depth"]


def look_around(
    boxes: list[Box], preset: str, frames: int = 20, poses: list[tuple[float, float]] | None = None
) -> tuple[NavMap, np.ndarray]:
    """Returns the map after turns by 30 degrees at some places, and each cell's distance to the surfaces."""
    mapper, navmap, noise = Mapper(CAMERA, RobotModel(), MappingConfig()), NavMap.empty(FRAME), Noise(preset, 0)
    for i in range(frames):
        x_m, y_m = (poses or [(0.0, 0.0)])[i % len(poses or [0])]
        yaw_rad = math.radians(30.0 * i)
        depth, _ = GridWorld(boxes, (x_m, y_m, yaw_rad), camera=CAMERA).render()
        mapper.add_depth(mapper.frame(navmap, Pose(x_m, y_m, yaw_rad)), noise.added_to(depth))
    cell_x_m, cell_y_m = FRAME.mesh()
    gaps = [
        np.hypot(
            np.maximum(np.maximum(b.x[0] - cell_x_m, cell_x_m - b.x[1]), 0.0),
            np.maximum(np.maximum(b.y[0] - cell_y_m, cell_y_m - b.y[1]), 0.0),
        )
        for b in boxes
    ]
    return navmap, np.min(gaps, axis=0)


@pytest.mark.parametrize(
    ("preset", "within_m", "most_cells"), [("none", 0.04, 0), ("realsense", 0.30, 0), ("harsh", 0.60, 20)]
)
def test_noise_puts_no_obstacle_into_free_air_of_a_room_seen_from_within(preset: str, within_m: float, most_cells: int):
    """No filter removes the systematic error; at 5 m its standard deviation is 12 cm or 25 cm (`harsh`)."""
    navmap, gap_m = look_around([*ROOM, TABLE], preset, poses=[(0.0, 0.0), (-1.0, 0.6), (0.2, -1.5)])
    x_m, y_m = FRAME.mesh()
    air = (np.abs(x_m) < 3.0) & (np.abs(y_m) < 3.0) & (gap_m > within_m)
    assert (navmap.seen_obstacle & air).sum() <= most_cells
    assert (navmap.seen_at_eye_level & air).sum() <= most_cells


@pytest.mark.parametrize("preset", ["none", "realsense", "harsh"])
def test_walls_have_no_gaps_under_noise(preset: str):
    navmap, _ = look_around(ROOM, preset, frames=24)
    x_m, y_m = FRAME.mesh()
    for t_m in np.linspace(-2.4, 2.4, 50):
        for wall in ((x_m > 2.7) & (np.abs(y_m - t_m) <= 0.03), (y_m < -2.7) & (np.abs(x_m - t_m) <= 0.03)):
            assert navmap.seen_obstacle[wall].any()


@pytest.mark.parametrize(
    ("preset", "distance_m"), [("none", 1.0), ("none", 2.5), ("none", 4.0), ("realsense", 1.0), ("realsense", 2.5)]
)
def test_a_leg_of_two_centimetres_is_mapped(preset: str, distance_m: float):
    for offset_m in np.linspace(-0.3, 0.3, 7):
        leg = Box((distance_m, distance_m + 0.02), (offset_m - 0.01, offset_m + 0.01), (0.0, 0.45))
        depth, _ = GridWorld([leg, *ROOM[1:]], (0.0, 0.0, 0.0), camera=CAMERA).render()
        navmap, noise = NavMap.empty(FRAME), Noise(preset, 1)
        mapper = Mapper(CAMERA, RobotModel(), MappingConfig())
        for _ in range(3):
            mapper.add_depth(mapper.frame(navmap, Pose(0.0, 0.0, 0.0)), noise.added_to(depth))
        row, col = FRAME.cell(distance_m, offset_m)
        assert navmap.seen_obstacle[row - 1 : row + 2, col - 1 : col + 2].any()


def test_exact_depth_never_takes_an_obstacle_away_again():
    leg = Box((1.5, 1.52), (0.4, 0.42), (0.0, 0.45))
    places = [(0.02 * i - 1.0, 0.031 * i - 0.8) for i in range(24)]
    boxes = [*ROOM, TABLE, leg]
    seen = np.zeros(FRAME.shape, bool)
    mapper, navmap = Mapper(CAMERA, RobotModel(), MappingConfig()), NavMap.empty(FRAME)
    for i, (x_m, y_m) in enumerate(places * 3):
        yaw_rad = math.radians(10.0 * i)
        depth, _ = GridWorld(boxes, (x_m, y_m, yaw_rad), camera=CAMERA).render()
        mapper.add_depth(mapper.frame(navmap, Pose(x_m, y_m, yaw_rad)), depth)
        seen |= navmap.seen_obstacle
    assert (seen & ~navmap.seen_obstacle).sum() <= 0.01 * seen.sum()


def test_a_removed_object_is_forgotten_when_its_place_is_seen_to_be_empty():
    chair = Box((1.8, 2.2), (-0.2, 0.2), (0.0, 0.8), "chair")
    mapper, navmap, pose = Mapper(CAMERA, RobotModel(), MappingConfig()), NavMap.empty(FRAME), Pose(0.0, 0.0, 0.0)
    for boxes, frames, there in (([*ROOM, chair], 8, True), (ROOM, 10, False)):
        for _ in range(frames):
            mapper.add_depth(mapper.frame(navmap, pose), GridWorld(boxes, (0.0, 0.0, 0.0), camera=CAMERA).render()[0])
        assert navmap.seen_obstacle[FRAME.cell(1.8, 0.0)] == there


@pytest.mark.parametrize("z", [(0.0, 0.14), (0.70, 0.75)])
def test_an_object_that_rays_pass_above_or_below_is_not_cleared(z: tuple[float, float]):
    """A slab and a table top: rays pass above or below them, yet the band is not empty there."""
    slab = Box((1.8, 2.4), (-0.5, 0.5), z)
    mapper, navmap = Mapper(CAMERA, RobotModel(), MappingConfig()), NavMap.empty(FRAME)
    for x_m in np.linspace(0.4, -2.0, 40):
        depth, _ = GridWorld([*ROOM, slab], (x_m, 0.0, 0.0), camera=CAMERA).render()
        mapper.add_depth(mapper.frame(navmap, Pose(float(x_m), 0.0, 0.0)), depth)
    assert navmap.seen_obstacle[FRAME.cell(1.81, 0.0)]
    assert navmap.seen_obstacle[FRAME.cell(2.1, 0.0)]


@pytest.mark.parametrize("preset", ["realsense", "harsh"])
def test_target_pixels_at_the_rim_do_not_put_candidates_behind_or_before_the_target(preset: str):
    chair = Box((1.5, 1.9), (-0.25, 0.25), (0.0, 0.9), "chair")
    depth, semantic = GridWorld([*ROOM, chair], (0.0, 0.0, 0.0), camera=CAMERA).render()
    target = (semantic == CHAIR_ID).astype(np.float32)
    mapper, navmap, noise = Mapper(CAMERA, RobotModel(), MappingConfig()), NavMap.empty(FRAME), Noise(preset, 2)
    for step in range(20):
        seen = noise.added_to(depth)
        mapper.add_scores(mapper.frame(navmap, Pose(0.0, 0.0, 0.0)), seen, Scores(target, 1.0 - target), step)
    x_m, _ = FRAME.centres(*np.nonzero(navmap.score_max > 0.5))
    assert x_m.min() > 1.5 - 0.12
    assert x_m.max() < 1.9 + 0.12


def test_a_candidate_in_free_air_goes_when_the_target_is_seen_behind_it_and_only_then():
    chair = Box((2.4, 2.6), (-0.25, 0.25), (0.0, 0.9), "chair")
    navmap, mapper = NavMap.empty(FRAME), Mapper(CAMERA, RobotModel(), MappingConfig())
    before, beside, target = FRAME.cell(1.8, 0.0), FRAME.cell(1.8, 1.2), FRAME.cell(2.41, 0.0)
    for cell in (before, beside):
        navmap.score_max[cell] = 1.0
    depth, semantic = GridWorld([*ROOM, chair], (0.0, 0.0, 0.0), camera=CAMERA).render()
    for category_id, goes in ((99, False), (CHAIR_ID, True)):
        score = (semantic == category_id).astype(np.float32)
        mapper.add_scores(mapper.frame(navmap, Pose(0.0, 0.0, 0.0)), depth, Scores(score, 1.0 - score), 0)
        assert (navmap.score_max[before] == 0.0) == goes
        assert navmap.score_max[beside] == 1.0
    assert navmap.score_max[target] == 1.0


def test_exact_depth_is_left_as_it_is_and_noise_is_halved():
    depth, _ = GridWorld([*ROOM, TABLE], (0.0, 0.0, 0.3), camera=CAMERA).render()
    d = depth[240::2, ::2]
    surfaces = Surfaces.of(d, OccupancyConfig())
    np.testing.assert_array_equal(surfaces.depth, d)
    assert surfaces.confirmed(8).all()
    rough = (d + np.random.default_rng(0).normal(0.0, 0.01, d.shape) * d**2).astype(np.float32)
    smooth = Surfaces.of(rough, OccupancyConfig()).depth
    assert not Surfaces.of(rough, OccupancyConfig()).exact
    assert np.median(np.abs(smooth - d) / d**2) < 0.5 * np.median(np.abs(rough - d) / d**2)


def test_evidence_that_cannot_be_reached_is_refused():
    with pytest.raises(ConfigError, match="obstacle_from <= most"):
        OccupancyConfig(obstacle_from=11)
