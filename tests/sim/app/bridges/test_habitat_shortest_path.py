"""Habitat's shortest paths: distances and routes around walls, in Habitat's frame, with the task's actions."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from sim.app.bridges.habitat import Env, ShortestPathFollower
from sim.core.errors import ConfigError, EpisodeError
from sim.core.geometry.pose import Pose
from sim.episodes.episode import Episode
from sim.episodes.splits import write_split
from tests.helpers.worlds import room, with_box

CAMERA = {"width_px": 64, "height_px": 48}


@pytest.fixture
def env(tmp_path: Path) -> Iterator[Env]:
    """A room of 8 x 6 m that a wall divides but for 1.2 m at its upper end; the robot starts on the left."""
    house = with_box(room(8, 6), "wall_10", centre_m=(0.0, -0.6, 1.25), half_m=(0.05, 2.4, 1.25))
    house = with_box(house, "bed_00", centre_m=(3.3, -2.0, 0.25), half_m=(0.5, 0.8, 0.25))
    folder = tmp_path / "walls"
    folder.mkdir()
    (folder / "walled.xml").write_text(house.spec.to_xml())
    starts = (Pose(-2.0, -2.0, 0.0), Pose(-2.0, -2.0, math.pi / 2))
    episodes = [Episode(f"e{i}", "walled", "bed", start) for i, start in enumerate(starts)]
    write_split(folder, episodes, {"walled": {}}, version="1")
    with Env(split=folder, camera=CAMERA, sensors=("depth",)) as env:
        env.reset()
        yield env


def test_distances_lead_around_walls_to_the_nearest_of_the_places(env: Env) -> None:
    here = env.sim.get_agent_state().position
    beyond, above = [2.0, 0.0, 2.0], [-2.0, 0.0, 0.0]
    around_m = 2 * math.hypot(2.0, 3.98)  # past the end of the wall at (0, 1.8), with the robot's radius of 0.18 m
    assert around_m < env.sim.geodesic_distance(here, beyond) < around_m + 0.3
    assert env.sim.geodesic_distance(here, [beyond]) == env.sim.geodesic_distance(here, beyond)
    assert env.sim.geodesic_distance(here, [beyond, above]) == pytest.approx(2.0, abs=0.03)
    assert env.sim.geodesic_distance(here, above, env.current_episode) == pytest.approx(2.0, abs=0.03)
    assert env.sim.geodesic_distance(here, here) < 0.05


@pytest.mark.parametrize("place", [[-2.0, 3.0, 0.0], [30.0, 0.0, 0.0]])
def test_another_storey_and_the_outside_have_no_path(env: Env, place: list[float]) -> None:
    here = env.sim.get_agent_state().position
    assert math.isinf(env.sim.geodesic_distance(here, place))
    assert math.isinf(env.sim.geodesic_distance(place, here))


@pytest.mark.parametrize("place", [[1.0, 2.0], [], [[0.0, math.nan, 1.0]], "here"])
def test_what_is_no_position_is_refused(env: Env, place: object) -> None:
    with pytest.raises(ConfigError, match=r"Positions are \(3,\) or \(n, 3\)"):
        env.sim.geodesic_distance([0.0, 0.0, 0.0], place)  # type: ignore[arg-type]


def test_the_follower_drives_to_a_place_on_the_shortest_path_and_stops(env: Env) -> None:
    follower = ShortestPathFollower(env.sim, 0.25)
    goal = np.array([2.0, 0.0, 0.0])
    for _ in range(2):  # two episodes in turn with the same goal
        start = env.sim.get_agent_state().position
        shortest_m, driven_m = env.sim.geodesic_distance(start, goal), 0.0
        while (action := follower.get_next_action(goal)) != 0:
            before = env.sim.get_agent_state().position
            env.step(action)
            driven_m += float(np.linalg.norm(env.sim.get_agent_state().position - before))
            assert not env.sim.previous_step_collided
        assert env.sim.geodesic_distance(env.sim.get_agent_state().position, goal) <= 0.25
        assert driven_m < 1.1 * shortest_m
        env.reset()


def test_the_follower_begins_anew_when_an_episode_does(env: Env) -> None:
    follower, ahead, actions = ShortestPathFollower(env.sim, 0.25), [-0.6, 0.0, 2.0], []
    for _ in range(3):
        env.rewind()
        env.reset()
        for _ in range(2):
            actions.append(follower.get_next_action(ahead))
            env.step(actions[-1])
    assert actions == [1] * 6


def test_actions_can_be_one_hot_and_a_place_without_a_path_stops_or_is_an_error(env: Env) -> None:
    one_hot = ShortestPathFollower(env.sim, 0.5, return_one_hot=True)
    assert np.array_equal(one_hot.get_next_action(env.sim.get_agent_state().position), [1, 0, 0, 0])
    assert np.array_equal(one_hot.get_next_action([-1.0, 0.0, 2.0]), [0, 1, 0, 0])
    assert ShortestPathFollower(env.sim, 0.5).get_next_action([30.0, 0.0, 0.0]) == 0
    with pytest.raises(EpisodeError, match=r"\[30.0.*0.0.*0.0\]"):
        ShortestPathFollower(env.sim, 0.5, stop_on_error=False).get_next_action([30.0, 0.0, 0.0])


def test_a_radius_below_a_step_counts_as_a_step_and_none_is_refused(env: Env) -> None:
    assert ShortestPathFollower(env.sim, 0.1).get_next_action([-1.76, 0.0, 2.0]) == 0
    with pytest.raises(ConfigError, match=r"goal_radius > 0 m, got 0\.0"):
        ShortestPathFollower(env.sim, 0.0)
