"""The agents state the place for which they stop, on the object that they took for the goal."""

from __future__ import annotations

import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import Agent, RobotModel, Segmenter, StatesTarget
from stubborn import agents
from stubborn.agent import StubbornAgent
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA, Box, GridWorld, boxes_from_plan, run_episode
from tests.stubborn.test_agents import TWO_ROOMS, Fickle

MIRRORED = boxes_from_plan(
    """
####################
#        #         #
#  tt    #     bb  #
#  tt    #     bb  #
#                  #
#                  #
#                  #
#        #         #
####################
""",
    0.3,
)
START = (3.6, 0.6, 0.5)


def make(name: str, segmenter: Segmenter) -> Agent:
    return agents.make(name, camera=SMALL_CAMERA, robot=RobotModel(), segmenter=segmenter)


def target_of(agent: Agent, ground: GridWorld) -> dict[str, float]:
    """Returns how far the place that the agent states after an episode for the bed is from the bed and the table."""
    trace = run_episode(ground, agent, "bed", max_steps=200)
    assert trace.stopped
    assert isinstance(agent, StatesTarget)
    place = agent.stop_target_xy_m()
    assert place is not None
    ground.x, ground.y = Pose(*ground.start).place_of(*place)
    return {category: ground.distance_to(category) for category in ("bed", "table")}


@pytest.mark.parametrize("name", ["stubborn", "stubborn-plus"])
@pytest.mark.parametrize("boxes", [TWO_ROOMS, MIRRORED])
def test_the_place_is_on_the_goal(name: str, boxes: list[Box]) -> None:
    apart = target_of(make(name, GroundTruthSegmenter()), GridWorld(boxes, START, camera=SMALL_CAMERA))
    assert apart["bed"] < 0.05
    assert apart["table"] > 1.0


def test_the_place_is_on_the_lookalike_at_which_an_agent_stops_wrongly() -> None:
    apart = target_of(make("single-frame", Fickle()), GridWorld(TWO_ROOMS, START, camera=SMALL_CAMERA))
    assert apart["table"] < 0.05
    assert apart["bed"] > 1.0


@pytest.mark.parametrize("from_viewpoint", [False, True])
def test_a_stop_in_reach_and_a_stop_from_a_viewpoint_state_a_place(from_viewpoint: bool) -> None:
    agent = make("stubborn", GroundTruthSegmenter())
    assert isinstance(agent, StubbornAgent)
    found, find = [], agent.seeker.in_reach
    agent.seeker.in_reach = lambda navmap, sighting: (
        None if from_viewpoint else found.append(find(navmap, sighting)) or found[-1]
    )
    assert target_of(agent, GridWorld(TWO_ROOMS, START, camera=SMALL_CAMERA))["bed"] < 0.05
    assert any(cell is not None for cell in found) != from_viewpoint


def test_an_agent_that_has_not_stopped_states_no_place() -> None:
    agent = make("stubborn", GroundTruthSegmenter())
    assert isinstance(agent, StubbornAgent)
    agent.act(GridWorld(TWO_ROOMS, START, camera=SMALL_CAMERA).observe("chair"))
    assert agent.stop_target_xy_m() is None


def test_the_random_agent_states_no_place() -> None:
    assert not isinstance(make("random", GroundTruthSegmenter()), StatesTarget)
