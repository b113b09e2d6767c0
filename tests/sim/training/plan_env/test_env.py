"""The 2-D environment."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from sim.core.errors import ConfigError, EpisodeError
from sim.core.geometry.pose import Pose
from sim.core.interface import Action
from sim.homes.plans.episode import PlanEpisode
from sim.homes.plans.export import export_plans
from sim.homes.plans.plan import read_plan, write_plan
from sim.homes.plans.sight import PlanCamera, SightConfig
from sim.training.plan_env.env import LAYERS, PlanEnv, PlanEnvConfig
from tests.helpers import wording
from tests.helpers.worlds import bed_behind_a_wall, room, with_box


@pytest.fixture(scope="module")
def plans(tmp_path_factory) -> Path:
    """Returns a folder with the plan of two rooms in a row, with a bed in the second one."""
    folder = tmp_path_factory.mktemp("plans")
    (plan,) = export_plans(bed_behind_a_wall(), {})
    write_plan(folder / "flat.npz", plan)
    return folder


START = {"plan": 0, "goal": "bed", "start": Pose(-3.0, 1.0, 3.0)}


def test_the_environment_never_imports_mujoco():
    code = "import sys, sim.training.plan_env.env; print('mujoco' in sys.modules)"
    assert subprocess.check_output([sys.executable, "-c", code], text=True).strip() == "False"


@pytest.mark.costly
@pytest.mark.parametrize("actions", ["primitive", "goal"])
def test_the_environment_keeps_gymnasiums_contract(plans, actions):
    check_env(PlanEnv(plans, PlanEnvConfig(actions=actions, goal_steps=5)), skip_render_check=True)


def test_reward_is_the_progress_and_a_stop_at_the_goal_succeeds(plans):
    env = PlanEnv(plans)
    observation, info = env.reset(seed=0, options=START)
    assert observation["layers"][LAYERS.index("visited")].sum() == pytest.approx(np.pi * 3.6**2, rel=0.1)
    total, first_m = 0.0, env.episode.distance_m()
    assert info["shortest_path"] == pytest.approx(first_m)
    for action in [Action.TURN_RIGHT] * 5 + [Action.MOVE_FORWARD] * 8:
        _, reward, terminated, truncated, info = env.step(action)
        total += reward
        assert (terminated, truncated) == (False, False)
    assert total == pytest.approx(first_m - env.episode.distance_m())
    assert total > 1.0
    _, _, terminated, _, info = env.step(Action.STOP)
    assert terminated
    assert info["success"] == 0.0
    env.reset(options={**START, "start": Pose(1.6, 0.6, 0.0)})
    with pytest.raises(ConfigError, match="3 TURN_RIGHT; got 4"):
        env.step(4)
    assert env.step(Action.STOP)[4]["success"] == 1.0


def test_the_folder_of_plans_may_be_text(plans):
    assert PlanEnv(str(plans)).files == PlanEnv(plans).files != []


def test_a_goal_is_driven_to_around_a_wall_and_the_episode_ends_at_sight(plans):
    env = PlanEnv(plans, PlanEnvConfig(actions="goal", ends_at_sight=True))
    env.reset(seed=0, options=START)
    cos, sin, steps, terminated, info = np.cos(3.0), np.sin(3.0), 0, False, {}
    while not terminated and steps < 8:
        x_m, y_m = 5.0, -1.5  # south-east in the world; the window is 12 m wide and has the start's heading of 3 rad
        goal = 0.5 + np.array([cos * y_m - sin * x_m, cos * x_m + sin * y_m]) / 12.0
        _, _, terminated, _, info = env.step(goal.astype(np.float32))
        steps += 1
    assert terminated
    assert info["first_seen_step"] == info["num_steps"] <= 75
    assert info["collisions"] <= 2


def test_the_same_seed_gives_the_same_episode_and_no_state_survives_a_reset(plans):
    frames = []
    env = PlanEnv(plans)
    for _ in range(2):
        first, _ = env.reset(seed=5)
        for action in (1, 1, 2, 1):
            last = env.step(action)[0]
        frames.append((first, last))
    for one, other in zip(*frames, strict=True):
        for key, value in one.items():
            np.testing.assert_array_equal(value, other[key])


def test_a_start_is_sampled_for_the_goal_and_a_goal_for_the_start(tmp_path):
    house = with_box(room(9, 5), "bed_00", centre_m=(3.4, 1.2, 0.3), half_m=(0.9, 0.9, 0.3))
    house = with_box(house, "sofa_00", centre_m=(-3.4, -1.8, 0.3), half_m=(0.9, 0.4, 0.3))
    (plan,) = export_plans(house, {})
    write_plan(tmp_path / "flat.npz", plan)
    env = PlanEnv(tmp_path)
    for seed in range(12):
        for goal in ("bed", "sofa"):
            info = env.reset(seed=seed, options={"goal": goal})[1]
            assert (info["goal"], info["shortest_path"] >= 1.95) == (goal, True)
        assert env.reset(seed=seed, options={"start": Pose(1.9, 0.8, 0.0)})[1]["goal"] == "sofa"  # the bed is in reach
    write_plan(tmp_path / "bare.npz", replace(plan, name="bare", succeeds=np.zeros_like(plan.succeeds)))
    both = PlanEnv(tmp_path)
    for seed in range(4):
        assert both.reset(seed=seed, options={"goal": "bed"})[1]["house"] == plan.name
    with pytest.raises(EpisodeError, match=r"2.*'chair'"):
        both.reset(options={"goal": "chair"})
    with pytest.raises(ConfigError, match=r"options\['start'\] needs options\['plan'\]"):
        both.reset(options={"start": Pose(1.9, 0.8, 0.0)})
    with pytest.raises(ConfigError, match=wording.MUST_BE_A_POSE_GOT_TUPLE):
        both.reset(options={"plan": 0, "start": (1.9, 0.8, 0.0)})
    with pytest.raises(ConfigError, match="must be 0 to 1, got 'bare'"):
        both.reset(options={"plan": "bare"})
    with pytest.raises(EpisodeError, match="'chair'"):
        env.reset(options={"goal": "chair"})
    with pytest.raises(EpisodeError, match=r"goal.*\(90, 0\)"):
        env.reset(options={"start": Pose(90.0, 0.0, 0.0)})
    with pytest.raises(EpisodeError, match=r"start \(90, 0\)"):
        env.reset(options={"start": Pose(90.0, 0.0, 0.0), "goal": "bed"})


def test_properties_that_reset_creates_are_refused_before_reset(plans):
    env = PlanEnv(plans)
    for name in ("episode", "navmap", "window"):
        with pytest.raises(gymnasium.error.ResetNeeded, match="Call reset"):
            getattr(env, name)
    with pytest.raises(gymnasium.error.ResetNeeded, match="Call reset"):
        env.step(Action.MOVE_FORWARD)
    with pytest.raises(ConfigError, match=wording.THE_OPTIONS_PLAN_GOAL_AND_START_GOT_GAOL_SEED):
        env.reset(options={"gaol": "bed", "seed": 1, "plan": 0})
    with pytest.raises(ConfigError, match="must be 0 to 0, got 1"):
        env.reset(options={"plan": 1})


def test_errors_list_the_names_that_exist(plans):
    with pytest.raises(ConfigError, match="No plan in"):
        PlanEnv(plans / "nowhere")
    with pytest.raises(EpisodeError, match="'sofa'"):
        PlanEpisode(PlanCamera(read_plan(plans / "flat.npz")), "sofa", START["start"])


def test_options_that_a_plan_cannot_follow_are_refused():
    with pytest.raises(ConfigError, match=r"PlanEnvConfig\.actions.*'primitive'.*'goal'.*'goals'"):
        PlanEnvConfig(actions="goals")  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match="stride_px must be >= 1, got 0"):
        SightConfig(stride_px=0)
