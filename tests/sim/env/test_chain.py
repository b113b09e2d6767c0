"""Chains in the environment, with the oracle, an agent without memory, and the mapping agent."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from sim.app.evaluation.rollout import play_episode
from sim.core.geometry.pose import Pose
from sim.core.goals import GoalSpec
from sim.core.interface import Action, CameraModel, Observation
from sim.env.objectnav import ObjectNavEnv
from sim.env.oracle import Oracle
from sim.env.progress import ProgressReward
from sim.episodes.episode import Episode
from tests.helpers.worlds import sofa_room, with_box, with_facts

SMALL = CameraModel(width_px=64, height_px=48)
GOALS = (GoalSpec("sofa", "category"), GoalSpec("the desk", "words"), GoalSpec("the sofa", "words", None, 0))
CHAIN = Episode("chain", "home", "sofa", Pose(0.0, 0.0, 0.0), None, GOALS)


@pytest.fixture(scope="module")
def env(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ObjectNavEnv]:
    """A room with a sofa at x = 2.5 m and a desk at x = -2.5 m."""
    house = with_box(sofa_room(), "table_00", centre_m=(-2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    file = tmp_path_factory.mktemp("chain") / "home.xml"
    file.write_text(with_facts(house, table_00="name: desk").spec.to_xml())
    env = ObjectNavEnv(house=file, camera=SMALL, sensors=("rgb", "goal"), max_steps=60)
    yield env
    env.close()


class Noted:
    """Notes the goals that it gets and the observations of them; drives like the oracle."""

    def __init__(self, env: ObjectNavEnv) -> None:
        self._oracle, self.calls, self.seen = Oracle(env), list[tuple[str, str]](), list[tuple[str, int]]()

    def reset(self, goal: str, seed: int) -> None:
        self.calls.append(("reset", goal))
        self._oracle.reset(goal, seed)

    def act(self, observation: Observation) -> Action:
        told = str(observation["goal"]), int(observation["objectgoal"][0])
        if told not in self.seen[-1:]:
            self.seen.append(told)
        return self._oracle.act(observation)


class Remembering(Noted):
    """The same with a memory."""

    def next_goal(self, goal: str) -> None:
        self.calls.append(("next", goal))
        self._oracle.next_goal(goal)


@pytest.mark.costly
@pytest.mark.parametrize(("agent", "call"), [(Noted, "reset"), (Remembering, "next")])
def test_an_agent_gets_each_goal_and_the_oracle_reaches_all(env: ObjectNavEnv, agent: type[Noted], call: str) -> None:
    driver = agent(env)
    result = play_episode(env, driver, CHAIN, seed=3)
    assert driver.calls == [("reset", "sofa"), (call, "the desk"), (call, "the sofa")]
    assert driver.seen == [("sofa", 5), ("the desk", -1), ("the sofa", -1)]
    assert result.goals is not None
    assert [goal.success for goal in result.goals] == [1.0, 1.0, 1.0]
    assert result.composite_success == 1.0
    assert result.num_steps == sum(goal.num_steps for goal in result.goals)


def test_a_step_that_ends_a_goal_is_rewarded_and_reports_it(env: ObjectNavEnv) -> None:
    wrapped = ProgressReward(env)
    _, info = wrapped.reset(options={"episode": CHAIN})
    assert (info["goal"], info["goal_number"], "ended_goal" in info) == ("sofa", 0, False)
    rewards = [wrapped.step(action)[1] for action in [Action.MOVE_FORWARD] * 5]
    assert rewards[0] == pytest.approx(0.24, abs=0.02)
    observation, reward, terminated, truncated, info = wrapped.step(Action.STOP)
    assert (terminated, truncated) == (False, False)
    assert reward == pytest.approx(2.49, abs=0.01)
    assert (info["goal"], info["goal_number"], observation["goal"]) == ("the desk", 1, "the desk")
    assert (info["ended_goal"]["success"], info["num_steps"]) == (1.0, 0)
    assert wrapped.step(Action.TURN_LEFT)[1] == pytest.approx(-0.01, abs=0.01)
    np.testing.assert_allclose(wrapped.step(Action.STOP)[0]["gps"], [1.25, 0.0], atol=0.02)
    *_, terminated, _, info = wrapped.step(Action.STOP)
    assert terminated
    assert [goal["success"] for goal in info["chain"]["goals"]] == [1.0, 0.0, 1.0]
    assert info["chain"]["success"] == pytest.approx(2 / 3)


@pytest.mark.costly
@pytest.mark.filterwarnings("error")
def test_gymnasiums_checker_accepts_the_environment_of_chains(tmp_path: Path) -> None:
    options = {"houses": ["val_00"], "camera": SMALL, "render_mode": "rgb_array"}
    env = gymnasium.make("sim.gym:stubborn/ObjectNavChain-v0", **options)
    check_env(env.unwrapped, skip_close_check=True)
    _, info = env.reset(seed=1)
    assert isinstance(env.unwrapped, ObjectNavEnv)
    assert env.unwrapped.episode.is_chain
    assert info["goal_number"] == 0
    env.close()
