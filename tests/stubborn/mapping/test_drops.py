"""Depth images of floors with an edge, computed by hand: where the map says that the floor is missing."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel, RobotModel
from stubborn.mapping.drops import DropConfig
from stubborn.mapping.mapper import Mapper, MappingConfig
from stubborn.mapping.navmap import NavMap

CAMERA = CameraModel()
FRAME = GridFrame.around_start(400, 0.05)


def floor_with_edge(ahead_m: float, drop_m: float, *, far_m: float = np.inf) -> np.ndarray:
    """Returns depth over a floor that is lower by `drop_m` from `ahead_m` to `far_m`, with a wall at 4.5 m."""
    v = np.arange(CAMERA.height_px)
    down = np.maximum((v + 0.5 - 0.5 * CAMERA.height_px) / CAMERA.focal_px, 1e-6)
    floor_m, lower_m = CAMERA.height_m / down, (CAMERA.height_m + drop_m) / down
    over = (floor_m >= ahead_m) & (floor_m < far_m)
    depth = np.where(over, np.minimum(lower_m, far_m), floor_m)
    depth = np.minimum(np.minimum(depth, 4.5), CAMERA.max_depth_m).astype(np.float32)
    return np.repeat(depth[:, None], CAMERA.width_px, axis=1)


def mapped(*frames: tuple[np.ndarray, Pose], config: DropConfig | None = None) -> NavMap:
    mapper = Mapper(CAMERA, RobotModel(), MappingConfig(drops=config or DropConfig()))
    navmap = NavMap.empty(FRAME)
    for depth, pose in frames:
        mapper.add_depth(mapper.frame(navmap, pose), depth)
    return navmap


def dropped(navmap: NavMap, x_m: float, y_m: float = 0.0) -> bool:
    return bool(navmap.seen_drop[navmap.frame.cell(x_m, y_m)])


START = Pose(0.0, 0.0, 0.0)


@pytest.mark.parametrize("drop_m", [0.18, 0.6, 2.7])
def test_the_floor_is_missing_from_the_edge_on_and_not_before_it(drop_m):
    navmap = mapped((floor_with_edge(2.0, drop_m), START))
    assert all(dropped(navmap, x) for x in (2.15, 2.4, 2.8))
    rows, cols = np.nonzero(navmap.seen_drop)
    x_m, _ = navmap.frame.centres(rows, cols)
    assert x_m.min() >= 1.95


def test_a_whole_floor_a_rug_and_a_threshold_are_not_drops():
    for drop_m in (0.0, 0.025, 0.05):
        assert not mapped((floor_with_edge(2.0, drop_m), START)).drop_evidence.any()


def test_the_option_switches_it_off():
    assert not mapped((floor_with_edge(2.0, 0.6), START), config=DropConfig(enabled=False)).seen_drop.any()


def test_unseen_ground_before_a_drop_in_the_lowest_row_counts_as_missing_until_floor_is_seen_there():
    frame = floor_with_edge(1.0, 0.6)
    navmap = mapped((frame, START))
    assert dropped(navmap, 1.0)
    assert dropped(navmap, 0.5)
    mapper = Mapper(CAMERA, RobotModel(), MappingConfig())
    back = Pose(-1.2, 0.0, 0.0)
    for _ in range(2):
        mapper.add_depth(mapper.frame(navmap, back), floor_with_edge(2.2, 0.6))
    assert not dropped(navmap, 0.5)
    assert dropped(navmap, 1.2)


def test_ground_that_was_driven_over_is_not_missing():
    mapper, navmap = Mapper(CAMERA, RobotModel(), MappingConfig()), NavMap.empty(FRAME)
    navmap.visited[navmap.frame.cell(0.0, 0.0)[0] - 3 : navmap.frame.cell(0.0, 0.0)[0] + 4, 195:215] = True
    mapper.add_depth(mapper.frame(navmap, START), floor_with_edge(1.0, 0.6))
    assert not navmap.seen_drop[navmap.visited].any()


def test_a_single_deep_pixel_is_noise():
    depth = floor_with_edge(9.0, 0.0)
    depth[400, 300] = depth[401, 301] = 4.9
    assert not mapped((depth, START)).drop_evidence.any()


def test_a_drop_beyond_the_edge_of_the_map_is_not_entered_on_its_other_side():
    mapper, navmap = Mapper(CAMERA, RobotModel(), MappingConfig()), NavMap.empty(GridFrame.around_start(200, 0.05))
    mapper.add_depth(mapper.frame(navmap, Pose(3.8, 0.0, 0.0)), floor_with_edge(2.0, 0.6))  # the map ends at x = 5 m
    x_m, _ = navmap.frame.centres(*np.nonzero(navmap.seen_drop))
    assert x_m.size == 0 or x_m.min() > 3.8
