"""The environment in which the global policy of semexp is trained, and the code that it shares with the explorer."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from sim.core.errors import ConfigError
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES
from sim.homes.plans.episode import PlanEpisode
from sim.homes.plans.export import export_plans
from sim.homes.plans.plan import read_plan, write_plan
from sim.homes.plans.sight import PlanCamera
from sim.training.plan_env.env import PlanEnv, PlanEnvConfig
from sim.training.semexp.env import FAST, RewardConfig, SemExpEnv
from sim.training.semexp.options import Args
from sim.training.semexp.trainer import Run
from stubborn.agent import AgentConfig
from stubborn.exploration.semexp import SemExpConfig, SemExpExplorer
from stubborn.exploration.semexp_input import PolicyInput
from tests.helpers.plan_agent import PlanAgent, explore_until_sight
from tests.helpers.worlds import bed_behind_a_wall, with_box


@pytest.fixture(scope="module")
def plans(tmp_path_factory) -> Path:
    """Returns a folder with the plan of two rooms in a row, with a bed in the second one and a sofa in the first."""
    folder = tmp_path_factory.mktemp("plans")
    house = with_box(bed_behind_a_wall(), "sofa_00", centre_m=(-2.0, -1.8, 0.3), half_m=(0.9, 0.4, 0.3))
    (plan,) = export_plans(house, {})
    write_plan(folder / "flat.npz", plan)
    return folder


START = {"plan": 0, "goal": "bed", "start": Pose(-3.0, 1.0, 0.0)}
PLACES = ((0.5, 0.96), (0.3, 0.43), (0.57, 0.63))
"""Goals as shares of the local map: 5.5 m ahead of the start, behind it on the right, and near."""


def action(place: tuple[float, float]) -> np.ndarray:
    """Returns the action whose sigmoid is a goal."""
    share = np.array(place)
    return np.log(share / (1.0 - share)).astype(np.float32)


def test_the_environment_keeps_gymnasiums_contract(plans: Path):
    check_env(SemExpEnv(plans), skip_render_check=True)


def test_there_is_no_observation_before_the_first_episode(plans: Path):
    with pytest.raises(gymnasium.error.ResetNeeded, match="Call reset"):
        _ = SemExpEnv(plans).given


def test_the_reward_of_an_episode_is_the_path_to_the_target_the_floor_seen_and_the_steps(plans: Path):
    env = SemExpEnv(plans)
    env.reset(seed=0, options=START)
    first_m, before_m2 = env.episode.distance_m(), env.episode.camera.area_seen_m2
    total, terminated, cell, info = 0.0, False, action((0.17, 0.9)), {}
    for _ in range(12):
        _, reward, terminated, _, info = env.step(cell)
        total += reward
        if terminated:
            break
    assert terminated
    assert info["first_seen_step"] == info["num_steps"] > 0
    seen_m2 = env.episode.camera.area_seen_m2 - before_m2
    assert total == pytest.approx(0.1 * first_m + 0.02 * seen_m2 - 0.01 * info["num_steps"])
    plain = SemExpEnv(plans, reward=RewardConfig(per_m2=0.0, per_step=0.0, rest_at_sight=False))
    plain.reset(seed=0, options=START)
    before = plain.episode.distance_m()
    assert plain.step(cell)[1] == pytest.approx(0.1 * (before - plain.episode.distance_m()))


@pytest.mark.costly
def test_the_policy_gets_the_same_input_in_training_and_in_episodes(plans: Path):
    """The agent follows the first goal of a policy, then the environment gets the same goal; both see the same map."""
    given: list[PolicyInput] = []

    def policy(seen: PolicyInput) -> tuple[np.ndarray, np.ndarray]:
        given.append(seen)
        return action(PLACES[len(given) % 3]), np.zeros(2)

    exact = replace(FAST, plan_every=1, plan_pool=1, sight=PlanEnvConfig().sight, goal_steps=4)
    explorer = SemExpExplorer(SemExpConfig(goal_steps=4), policy)
    start = Pose(-3.0, 1.0, 3.0)  # looks away from the bed
    episode = PlanEpisode(PlanCamera(read_plan(plans / "flat.npz")), "bed", start)
    agent = PlanAgent(AgentConfig(), episode)
    agent.explorer = explorer
    explore_until_sight(agent, episode)
    env = SemExpEnv(plans, exact)
    seen, _ = env.reset(seed=0, options={**START, "start": start})
    for number, expected in enumerate(given[:6], 1):
        np.testing.assert_array_equal(seen["geometry"], expected.geometry)
        np.testing.assert_array_equal(seen["goals"], expected.goals)
        assert seen["heading"] == expected.heading
        assert seen["goal"] == expected.goal == GOAL_CATEGORIES.index("bed")
        assert env.given.frame == expected.frame
        seen = env.step(action(PLACES[number % 3]))[0]
    assert len(given) >= 6
    assert seen["goals"].any()


def test_a_step_ends_where_the_goal_is_reached(plans: Path):
    used = []
    for arrived_m in (None, 0.35):
        env = PlanEnv(plans, PlanEnvConfig(actions="goal", arrived_m=arrived_m))
        env.reset(seed=0, options=START)
        used.append(env.step(np.array([0.5, 0.6]))[4]["num_steps"])
    assert used[0] == 25
    assert 2 <= used[1] <= 6


def test_a_robot_that_is_at_its_goal_pushes_on_for_one_action(plans: Path):
    env = PlanEnv(plans, PlanEnvConfig(actions="goal", arrived_m=0.35))
    env.reset(seed=0, options=START)
    for steps in (1, 2):
        assert env.step(np.array([0.5, 0.5]))[4]["num_steps"] == steps
    assert env.episode.pose.yaw_rad > 0.4
    assert env.episode.path_length_m > 0.2


def test_planning_on_pooled_cells_drives_to_the_same_place(plans: Path):
    ends = []
    for pool in (1, 2, 3):
        env = PlanEnv(plans, PlanEnvConfig(actions="goal", plan_pool=pool))
        env.reset(seed=0, options=START)
        info = env.step(np.array([0.25, 0.75]))[4]
        assert info["collisions"] <= 1
        ends.append(env.episode.pose.xy_m)
    assert np.abs(np.array(ends) - ends[0]).max() < 1.0
    assert len(set(ends)) > 1
    with pytest.raises(ConfigError, match="plan_pool must be >= 1 and divide window_cells and map_cells, got 7"):
        PlanEnvConfig(plan_pool=7)


def test_environments_can_share_the_plans(plans: Path):
    reads = []

    def read(file: Path):
        reads.append(file)
        return read_plan(file)

    env = SemExpEnv(plans, read=read)
    env.reset(seed=0)
    env.reset(seed=1)
    assert len(reads) == 1


@pytest.mark.costly
def test_a_run_takes_any_seed_and_goes_on_where_one_ended_before_its_first_row(plans: Path, tmp_path: Path):
    (tmp_path / "train.csv").write_text("goals,steps,episodes\n")
    Run(
        Args(plans=(plans,), out=tmp_path, goals=1, envs=2, rollout=2, batch=2, seed=2**63 - 1), [*plans.glob("*.npz")]
    ).train()
    assert (tmp_path / "curve.png").read_bytes()[:4] == b"\x89PNG"
    assert (tmp_path / "semexp.safetensors").is_file()
