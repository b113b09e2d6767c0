"""The dense reward: progress to the goal on any route, minus the costs of steps and collisions."""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import Action, CameraModel, ConfigError
from sim.gym import ENV_ID, ProgressReward
from tests.helpers.worlds import sofa_room

SMALL = CameraModel(width_px=64, height_px=48)
FORWARD, LEFT, RIGHT, STOP = Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT, Action.STOP


@pytest.fixture(scope="module")
def options(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Returns options for a room of 6 x 6 m; the robot starts 2.1 m from the nearest place of a successful STOP."""
    file = tmp_path_factory.mktemp("house") / "sofa_room.xml"
    furnished = sofa_room()
    file.write_text(furnished.spec.to_xml())
    return {"house": file, "goal": "sofa", "start": Pose(-1.0, 0.0, 0.0), "camera": SMALL, "sensors": ()}


def rewards(options: dict[str, Any], actions: list[Action], **weights: float) -> list[float]:
    env = ProgressReward(gymnasium.make(ENV_ID, **options), **weights)
    env.reset(seed=0)
    rewards = [float(env.step(action)[1]) for action in actions]
    env.close()
    return rewards


def test_driving_to_the_goal_and_back_has_no_net_reward(options: dict[str, Any]) -> None:
    earned = rewards(options, [FORWARD] * 4 + [LEFT] * 6 + [FORWARD] * 4, per_step=0.0)
    assert earned[:4] == pytest.approx([0.25] * 4, abs=0.03)
    assert sum(earned[4:10]) == pytest.approx(0.0, abs=0.05)
    assert sum(earned) == pytest.approx(0.0, abs=0.05)


def test_a_stop_that_succeeds_earns_the_bonus_and_another_one_nothing(options: dict[str, Any]) -> None:
    weights = {"per_step": 0.01, "success": 5.0}
    assert rewards(options, [STOP], **weights) == pytest.approx([-0.01])
    near = options | {"start": Pose(1.0, 0.0, 0.0)}
    assert sum(rewards(near, [FORWARD, STOP], **weights)) == pytest.approx(5.0 - 0.02 + 0.1, abs=0.03)


def test_a_collision_costs_its_price(options: dict[str, Any]) -> None:
    at_the_wall = options | {"start": Pose(-2.7, 0.0, math.pi)}
    assert rewards(at_the_wall, [FORWARD] * 2, per_metre=0.0, per_step=0.0, per_collision=0.5)[-1] == -0.5


def test_a_step_without_a_path_counts_as_no_progress(options: dict[str, Any]) -> None:
    env = gymnasium.make(ENV_ID, **options)
    rewarded = ProgressReward(_GivenDistances(env, [3.0, None, 2.0, 1.5]), per_step=0.0)
    rewarded.reset(seed=0)
    assert [rewarded.step(LEFT)[1] for _ in range(3)] == [0.0, 0.0, 0.5]
    env.close()


def test_vectors_of_dense_rewards_are_made_by_gymnasium(options: dict[str, Any]) -> None:
    envs = gymnasium.make_vec(
        ENV_ID, num_envs=2, vectorization_mode=gymnasium.VectorizeMode.SYNC, wrappers=[ProgressReward], **options
    )
    envs.reset(seed=0)
    _, earned, *_ = envs.step(np.array([FORWARD, LEFT]))
    envs.close()
    np.testing.assert_allclose(earned, [0.24, -0.01], atol=0.04)


def test_an_environment_without_distances_and_weights_that_are_no_numbers_are_refused() -> None:
    with pytest.raises(ConfigError, match="'distance_to_goal'"):
        ProgressReward(gymnasium.make("CartPole-v1")).reset()
    with pytest.raises(ConfigError, match=r"ProgressReward\(per_metre=...\)"):
        ProgressReward(gymnasium.make("CartPole-v1"), per_metre=math.nan)


class _GivenDistances(gymnasium.Wrapper):
    """An environment that reports given distances."""

    def __init__(self, env: gymnasium.Env, distances: list[float | None]) -> None:
        super().__init__(env)
        self._distances = iter(distances)

    def reset(self, **options: Any) -> Any:
        observation, info = super().reset(**options)
        return observation, info | {"distance_to_goal": next(self._distances)}

    def step(self, action: Any) -> Any:
        *rest, info = super().step(action)
        return *rest, info | {"distance_to_goal": next(self._distances)}
