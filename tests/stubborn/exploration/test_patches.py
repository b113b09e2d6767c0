"""The map as an input of networks, and the goal categories in it."""

from dataclasses import dataclass

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, CameraModel, RobotModel
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.exploration.corners import CornerConfig, CornerExplorer
from stubborn.exploration.explorer import Explorer
from stubborn.exploration.patches import patch_around
from stubborn.mapping.mapper import Mapper, MappingConfig
from stubborn.mapping.navmap import NavMap
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA, Box, GridWorld, run_episode

FRAME = GridFrame.around_start(200, 0.05)
BED, CHAIR = GOAL_CATEGORIES.index("bed"), GOAL_CATEGORIES.index("chair")


def marked() -> NavMap:
    navmap = NavMap.empty(FRAME)
    row, col = FRAME.cell(1.02, -0.51)
    navmap.seen_obstacle[row, col] = True
    navmap.frames_in_view[row, col] = 1 << 16  # its two lowest bytes are 0
    navmap.goals_seen[row, col] = 1 << BED | 1 << CHAIR
    navmap.trail[FRAME.cell(0.0, 0.0)] = True
    return navmap


@pytest.mark.parametrize("pool", [1, 4, 7])
@pytest.mark.parametrize("at", [(0.0, 0.0), (0.33, -0.41)])
def test_a_mark_of_the_map_is_at_the_same_place_in_the_patch(pool: int, at: tuple[float, float]):
    patch = patch_around(marked(), Pose(*at, 0.3), cells=60, pool=pool)
    cell = patch.frame.cell(1.02, -0.51)
    for layer in (patch.obstacle, patch.seen, patch.goals != 0):
        assert np.argwhere(layer).tolist() == [list(cell)]
    assert np.argwhere(patch.trail).tolist() == [list(patch.frame.cell(0.0, 0.0))]
    assert patch.robot == patch.frame.cell(*at)


def test_walls_do_not_move_between_blocks_when_the_robot_does():
    one, other = (patch_around(marked(), Pose(x_m, 0.0, 0.0), cells=40, pool=4) for x_m in (0.0, 0.17))
    shift = round((other.frame.origin_xy_m[0] - one.frame.origin_xy_m[0]) / one.frame.cell_m)
    assert one.frame.cell(1.02, -0.51)[1] - other.frame.cell(1.02, -0.51)[1] == shift
    assert one.obstacle.sum() == other.obstacle.sum() == 1


def test_beyond_the_map_a_patch_is_empty():
    navmap = NavMap.empty(FRAME)
    navmap.frames_in_view[:] = 1
    patch = patch_around(navmap, Pose(4.6, 4.6, 0.0), cells=40, pool=4)
    rows, cols = np.nonzero(patch.seen)
    x_m, y_m = patch.frame.centres(rows, cols)
    assert 0 < patch.seen.sum() < patch.seen.size
    assert max(x_m.max(), y_m.max()) < 5.0


def test_channels_show_each_category_in_the_order_asked_for():
    patch = patch_around(marked(), Pose(0.0, 0.0, 0.0), cells=60, pool=1)
    channels = patch.channels()
    assert channels.shape == (4 + len(GOAL_CATEGORIES), 60, 60)
    assert [g for g in range(len(GOAL_CATEGORIES)) if channels[4 + g].any()] == sorted([BED, CHAIR])
    assert channels[3].sum() == 1
    assert channels[3][patch.robot] == 1
    order = np.roll(np.arange(len(GOAL_CATEGORIES)), 1).tolist()
    assert (patch.channels(order)[4 + (BED + 1) % len(order)] == channels[4 + BED]).all()


def test_goal_categories_are_entered_where_depth_saw_them():
    world = GridWorld([Box((2.0, 2.4), (-0.5, 0.5), category="bed")], (0.0, 0.0, 0.0), camera=SMALL_CAMERA)
    observation = world.observe("chair")
    navmap = NavMap.empty(FRAME)
    posteriors = GroundTruthSegmenter().posteriors(observation)
    (mapper := Mapper(SMALL_CAMERA, RobotModel(), MappingConfig())).add_goals(
        mapper.frame(navmap, Pose(0.0, 0.0, 0.0)), observation["depth"], posteriors
    )
    rows, cols = np.nonzero(navmap.goals_seen == 1 << BED)
    x_m, y_m = FRAME.centres(rows, cols)
    assert rows.size > 5
    assert (navmap.goals_seen != 0).sum() == rows.size
    assert 1.9 <= x_m.min() <= x_m.max() <= 2.5
    assert np.abs(y_m).max() <= 0.55
    unsure = np.zeros_like(posteriors)
    unsure[MPCAT40_ID["sofa"] - 1] = 0.5
    (mapper := Mapper(SMALL_CAMERA, RobotModel(), MappingConfig())).add_goals(
        mapper.frame(navmap, Pose(0.0, 0.0, 0.0)), observation["depth"], unsure
    )
    assert not (navmap.goals_seen & (1 << GOAL_CATEGORIES.index("sofa"))).any()


class _Reader(CornerExplorer):
    reads_semantics = True


@dataclass(frozen=True)
class _Made:
    """A configuration that makes explorers of one class."""

    kind: type[CornerExplorer]

    def make(self, camera: CameraModel) -> Explorer:
        return self.kind(CornerConfig())


@pytest.mark.parametrize("kind", [CornerExplorer, _Reader])
def test_only_an_explorer_that_reads_categories_gets_them(kind: type[CornerExplorer]):
    config = AgentConfig(explorer=_Made(kind))
    agent = StubbornAgent(camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter(), config=config)
    world = GridWorld([Box((2.0, 2.4), (-0.5, 0.5), category="bed")], (0.0, 0.0, 0.0), camera=SMALL_CAMERA)
    run_episode(world, agent, "chair", max_steps=3)
    assert agent.navmap.goals_seen.any() == (kind is _Reader)
