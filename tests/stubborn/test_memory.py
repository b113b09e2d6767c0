"""The mapping agent over a chain of goals: it drives straight to what it has seen, unless its memory is off."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.interface import Action, KeepsMemory, RobotModel
from stubborn import agents
from stubborn.agent import StubbornAgent
from stubborn.detection.track_seeker import TrackSeeker
from stubborn.mapping.navmap import NavMap
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA, GridWorld
from tests.stubborn.test_agent import APARTMENT


def chain(name: str, *goals: str, **options: Any) -> tuple[StubbornAgent, list[int], list[float]]:
    """Runs an agent over a chain; returns the agent, the steps of each goal, and the distance to it at its STOP."""
    agent = agents.make(
        name, camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter(), max_steps=400, **options
    )
    assert isinstance(agent, StubbornAgent)
    assert isinstance(agent, KeepsMemory)
    world, steps, distances_m = GridWorld(APARTMENT, (1.2, 0.7, 1.9), camera=SMALL_CAMERA), [], []
    agent.reset(goals[0], 0)
    for number, goal in enumerate(goals):
        if number:
            agent.next_goal(goal)
        steps.append(0)
        while steps[-1] < 400:
            action = agent.act(world.observe(goal))
            world.step(action)
            steps[-1] += 1
            if action is Action.STOP:
                break
        distances_m.append(world.distance_to(goal))
    return agent, steps, distances_m


@pytest.mark.costly
def test_the_second_visit_is_direct_with_memory_and_a_search_without() -> None:
    goals = ("bed", "picture", "bed")
    _, with_memory, ends = chain("stubborn-plus", *goals)
    _, without, other_ends = chain("stubborn-plus", *goals, memory=False)
    assert max(ends) < 1.0
    assert max(other_ends) < 1.0
    assert with_memory[:1] == without[:1]
    assert with_memory[2] < 0.8 * without[2]


def test_tracks_and_the_explored_ground_outlast_a_goal_and_decisions_do_not() -> None:
    agent, _, _ = chain("stubborn-plus", "bed")
    seeker, seen = agent.seeker, agent.navmap.frames_in_view > 0
    assert isinstance(seeker, TrackSeeker)
    tracks = seeker.evidence.tracks
    assert seeker.verdicts.accepted
    agent.next_goal("picture")
    assert seeker.evidence.tracks is tracks
    assert not seeker.verdicts.accepted
    assert (agent.goal, agent.step, seeker.goal) == ("picture", 0, "picture")
    np.testing.assert_array_equal(agent.navmap.frames_in_view > 0, seen)
    assert not agent.navmap.score_max.any()


def test_an_agent_without_memory_begins_with_nothing() -> None:
    agent, _, _ = chain("stubborn-plus", "bed", memory=False)
    assert agent.navmap.frames_in_view.any()
    agent.next_goal("picture")
    assert not agent.navmap.frames_in_view.any()
    assert agent.goal == "picture"


@pytest.mark.costly
@pytest.mark.parametrize("name", ["stubborn", "stubborn-iv"])
def test_other_agents_keep_the_map_and_find_the_next_goal(name: str) -> None:
    agent, _, ends = chain(name, "bed", "cabinet")
    assert max(ends) < 1.0
    assert agent.navmap.sided


def test_means_over_frames_are_those_of_the_new_goal() -> None:
    navmap = NavMap.empty(GridFrame.around_start(20, 0.05))
    navmap.grow_known(slice(5, 15), slice(5, 15))
    navmap.frames_in_view[6:9, 6:9], navmap.score_sum[6:9, 6:9], navmap.shown_x[7, 7] = 200, 150.0, 3.0
    navmap.forget_goal()
    assert navmap.frames_in_view[7, 7] == 1
    assert navmap.frames_in_view[12, 12] == 0
    assert navmap.score_sum[7, 7] == navmap.shown_x[7, 7] == 0.0
    assert navmap.view(navmap.frame.part(slice(0, 9), slice(0, 9))).sided
