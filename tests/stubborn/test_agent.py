"""The whole agent in a world of boxes."""

import cv2
import numpy as np
import pytest

from sim.core.interface import Action, CameraModel, ConfigError, Observation, RobotModel, Scores, SegmenterSpec
from stubborn import agents
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.drawing import map_painter
from stubborn.planning.planner import PlanningConfig
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA, Box, GridWorld, Trace, boxes_from_plan, run_episode

APARTMENT = boxes_from_plan(
    """
################################################
#           #              #                   #
#  bbbbb    #              #        p          #
#  bbbbb                   #    ttttttt        #
#  bbbbb                        ttttttt        #
#  bbbbb    #                   ttttttt        #
#           #      cc      #                   #
#           #              #                   #
#####   #####              ########      #######
#                                              #
#                                              #
#                                              #
#                                              #
#########   ##########    ######################
#              #                   #           #
#              #                   #    u      #
#   kkk        #                               #
#                  gg                          #
#              #                   #           #
#              #                   #           #
################################################
""",
    0.25,
)


def run(
    boxes: list[Box],
    start: tuple[float, float, float],
    goal: str,
    max_steps: int = 400,
    robot: RobotModel = RobotModel(),  # noqa: B008 - frozen
) -> tuple[Trace, StubbornAgent]:
    agent = agents.make("stubborn", camera=SMALL_CAMERA, robot=robot, segmenter=GroundTruthSegmenter())
    assert isinstance(agent, StubbornAgent)
    world = GridWorld(boxes, start, camera=SMALL_CAMERA, robot=robot)
    return run_episode(world, agent, goal, max_steps=max_steps), agent


@pytest.mark.costly
@pytest.mark.parametrize("goal", ["bed", "picture", "cushion", "cabinet", "table"])
def test_it_finds_each_kind_of_object_and_stops_within_a_metre(goal: str):
    start = (10.0, 3.7, 1.9) if goal == "cabinet" else (1.2, 0.7, 1.9)
    trace, _ = run(APARTMENT, start, goal)
    assert trace.stopped
    assert trace.goal_distance_m < 1.0


def test_it_does_not_stop_in_front_of_the_wall_that_hides_the_target():
    plan = """
##################
#       #        #
#       #        #
#       #c       #
#       #        #
#       #        #
#                #
#                #
#                #
##################
"""
    trace, _ = run(boxes_from_plan(plan, 0.3), (2.0, 2.0, 0.0), "chair")
    assert trace.stopped
    assert trace.goal_distance_m < 1.0
    x, y, _ = trace.poses[-1]
    assert x > 8 * 0.3 or y < 4 * 0.3  # past the wall, or in its doorway


@pytest.mark.costly
def test_glass_is_hit_marked_and_passed():
    plan = """
####################
#                  #
#                  #
#        g         #
#        g         #
#        g      c  #
#        g         #
#        g         #
#                  #
####################
"""
    trace, agent = run(boxes_from_plan(plan, 0.3), (1.2, 1.35, 0.0), "chair")
    assert trace.stopped
    assert trace.goal_distance_m < 1.0
    assert 1 <= trace.collisions <= 12
    assert agent.navmap.pessimistic_marks.any()


@pytest.mark.costly
def test_with_a_wider_robot_it_keeps_farther_from_obstacles():
    trace, agent = run(APARTMENT, (1.2, 0.7, 1.9), "picture", robot=RobotModel(radius_m=0.30))
    assert trace.stopped
    assert trace.collisions <= 5  # with the distances of the default robot there are 115
    assert agent.config.planning.dilation_m == pytest.approx(0.27)
    assert AgentConfig().for_robot(RobotModel(radius_m=0.15)) == AgentConfig()


def test_walled_in_it_keeps_pushing_instead_of_freezing():
    cage = [Box((-0.5, 0.5), (0.19, 0.4)), Box((-0.5, 0.5), (-0.4, -0.19)), Box((0.19, 0.4), (-0.5, 0.5))]
    cage.append(Box((-0.4, -0.19), (-0.5, 0.5)))
    trace, _ = run(cage, (0.0, 0.0, 0.3), "chair", max_steps=80)
    assert not trace.stopped
    assert trace.actions.count(Action.MOVE_FORWARD) > 20
    assert {Action.TURN_LEFT, Action.TURN_RIGHT} & set(trace.actions)


@pytest.mark.costly
def test_the_same_house_turned_by_the_start_heading_is_still_solved():
    for yaw in np.arange(4) * np.pi / 2 + 0.2:
        trace, _ = run(APARTMENT, (4.0, 2.9, float(yaw)), "bed")
        assert trace.stopped
        assert trace.goal_distance_m < 1.0


def test_the_picture_of_a_map_shows_robot_target_and_legend_and_changes_nothing():
    trace, agent = run(APARTMENT, (1.2, 0.7, 1.9), "chair")
    assert trace.stopped
    assert trace.goal_distance_m < 1.0
    before = agent.navmap.seen_obstacle.copy()
    picture = map_painter.draw_map(agent, size_px=480)
    assert picture.dtype == np.uint8
    assert picture.shape[0] == 480
    assert picture.shape[1] > 480
    for colour in (map_painter.SEEN_OBSTACLE, map_painter.CANDIDATE, map_painter.TRAIL):
        assert (picture[:, :480] == colour).all(axis=2).any()
    assert map_painter.draw_map(agent).shape[0] == 720
    np.testing.assert_array_equal(agent.navmap.seen_obstacle, before)


def test_a_picture_can_be_drawn_before_the_first_step():
    agent = agents.make("stubborn", camera=CameraModel(), robot=RobotModel(), segmenter=GroundTruthSegmenter())
    assert isinstance(agent, StubbornAgent)
    assert map_painter.draw_map(agent).ndim == 3


class Smeared:
    """A segmenter whose outlines extend over the surroundings of the target."""

    def __init__(self, *, exact: bool) -> None:
        self.spec = SegmenterSpec(sensors=("semantic",), exact_outlines=exact)

    def scores(self, observation: Observation, goal: str) -> Scores:
        true = GroundTruthSegmenter().scores(observation, goal)
        target = np.asarray(cv2.dilate(true.target, np.ones((7, 7), np.uint8)), np.float32)
        return Scores(target, 1.0 - target)

    def posteriors(self, observation: Observation) -> np.ndarray:
        return GroundTruthSegmenter().posteriors(observation)


@pytest.mark.parametrize("exact", [True, False])
def test_a_segmenters_outline_counts_only_where_it_says_that_it_is_exact(exact: bool):
    world = GridWorld([Box((2.0, 3.0), (-1.0, 1.0), (0.0, 0.8), "bed")], (0.0, 0.0, 0.0), camera=SMALL_CAMERA)
    agent = agents.make("stubborn", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=Smeared(exact=exact))
    assert isinstance(agent, StubbornAgent)
    agent.reset("bed", 0)
    agent.act(world.observe("bed"))
    rows, cols = np.nonzero(agent.navmap.score_max > 0.5)
    _, y_m = agent.navmap.frame.centres(rows, cols)
    assert rows.size > 10
    assert (np.abs(y_m).max() > 1.1) == exact  # next to the bed


def test_a_clearance_beyond_the_computed_distances_is_refused():
    AgentConfig(planning=PlanningConfig(clearance_m=8.9))
    for name in ("clearance_m", "unseen_gap_m"):
        AgentConfig(planning=PlanningConfig(**{name: 8.9}))
        with pytest.raises(ConfigError, match=rf"{name}.* must be at most 8\.9 m"):
            AgentConfig(planning=PlanningConfig(**{name: 9.0}))


@pytest.mark.parametrize("side", [Action.TURN_LEFT, Action.TURN_RIGHT])
def test_the_untrap_mode_turns_to_one_side_until_no_drop_is_ahead(side: Action):
    agent = agents.make("stubborn", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter())
    assert isinstance(agent, StubbornAgent)
    world = GridWorld([Box((4.0, 4.2), (-4.0, 4.0))], (0.0, 0.0, 0.0), camera=SMALL_CAMERA)
    agent.reset("chair", 0)
    for _ in range(2):  # blocked turns begin the mode with a turn to the other side
        agent.untrap.observe(Action.TURN_LEFT if side is Action.TURN_RIGHT else Action.TURN_RIGHT, failed=True)
    row, col = agent.navmap.frame.cell(0.0, 0.0)
    agent.navmap.seen_drop[row - 10 : row + 11, col - 10 : col + 11] = True
    actions = []
    for step in range(6):
        if step == 5:
            agent.navmap.seen_drop[:] = False
        actions.append(agent.act(world.observe("chair")))
        world.step(actions[-1])
        assert map_painter.describe_intention(agent) == "gets unstuck"
    assert actions == [side] * 5 + [Action.MOVE_FORWARD]


def test_a_turn_for_a_better_view_is_not_described_as_getting_unstuck():
    agent = agents.make("stubborn-plus", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter())
    assert isinstance(agent, StubbornAgent)
    world = GridWorld([Box((4.0, 4.2), (-4.0, 4.0))], (0.0, 0.0, 0.0), camera=SMALL_CAMERA)
    agent.reset("chair", 0)
    assert agent.act(world.observe("chair")) in (Action.TURN_LEFT, Action.TURN_RIGHT)
    assert map_painter.describe_intention(agent) == "looks around"
