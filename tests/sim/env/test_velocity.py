"""The environment driven by velocities: limits of the base, collisions, time, and discrete actions performed by it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import sim.gym
import stubborn
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, CameraModel, ConfigError
from sim.env.discrete import DiscreteActions, stopping_velocity
from sim.env.objectnav import ObjectNavEnv
from sim.env.velocity import ObjectNavVelocityEnv
from sim.houses.house import House
from sim.robot.config import DriveConfig, RobotConfig
from sim.robot.velocity import Velocity
from sim.task.config import TaskConfig
from sim.task.metrics import TRAPPED_WINDOW_STEPS, stayed_near
from sim.task.trajectory import by_action
from sim.world.world import World
from stubborn import GroundTruthSegmenter
from tests.helpers import wording
from tests.helpers.worlds import sofa_room, with_box, with_movable

SMALL = CameraModel(width_px=64, height_px=48)
START = Pose(-1.5, 1.0, 0.0)
STAND, AHEAD, BACK = (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), (-0.5, 0.0, 0.0)


def make(tmp_path: Path, house: House | None = None, **options: Any) -> ObjectNavVelocityEnv:
    file = tmp_path / "house.xml"
    file.write_text((house or sofa_room()).spec.to_xml())
    return ObjectNavVelocityEnv(house=file, goal="sofa", **{"camera": SMALL, "sensors": (), "start": START, **options})


@pytest.fixture
def env(tmp_path: Path) -> Iterator[ObjectNavVelocityEnv]:
    env = make(tmp_path)
    env.reset(seed=0)
    yield env
    env.close()


def drive(env: ObjectNavVelocityEnv, command: tuple[float, float, float], periods: int) -> list[dict[str, Any]]:
    """Holds a command; returns the info of each period, with the pose in the start frame."""
    infos = []
    for _ in range(periods):
        observation, _, _, _, info = env.step(np.array(command, np.float32))
        infos.append(info | {"xy": observation["gps"].copy(), "yaw": float(observation["compass"][0])})
    return infos


@pytest.mark.filterwarnings("ignore:.*recommend using a symmetric and normalized space")  # it is in m/s and rad/s
@pytest.mark.filterwarnings("error")
def test_gymnasiums_checker_accepts_it(house: Path) -> None:
    env = gymnasium.make(sim.gym.VELOCITY_ENV_ID, house=house, goal="sofa", camera=SMALL, render_mode="rgb_array")
    check_env(env.unwrapped)
    env.close()


def test_ppo_of_stable_baselines_learns_in_it(house: Path) -> None:
    stable_baselines3 = pytest.importorskip("stable_baselines3", reason="the extra [train] is not installed")
    from stable_baselines3.common.env_checker import check_env as check_for_training

    env = gymnasium.make(
        sim.gym.VELOCITY_ENV_ID, house=house, goal="sofa", camera=SMALL, sensors=("scan",), time_limit_s=2.0
    )
    env = gymnasium.wrappers.RescaleAction(sim.gym.ProgressReward(env), np.float32(-1.0), np.float32(1.0))
    check_for_training(env)
    model = stable_baselines3.PPO("MultiInputPolicy", env, n_steps=32, batch_size=16, n_epochs=1, seed=0, device="cpu")
    model.learn(64)
    assert model.num_timesteps == 64
    env.close()


def test_speed_and_acceleration_stay_within_the_limits_of_the_base(env: ObjectNavVelocityEnv) -> None:
    moved = np.diff([0.0, *(info["xy"][0] for info in drive(env, AHEAD, 14) + drive(env, STAND, 6))])
    speeds = moved / env.period_s
    assert 0.47 < speeds.max() < 0.505
    assert np.abs(np.diff(speeds) / env.period_s).max() < 1.1
    assert speeds[:6] == pytest.approx([0.05, 0.15, 0.25, 0.35, 0.45, 0.495], abs=0.01)
    assert abs(speeds[-1]) < 0.002
    turned = np.diff([0.0, *(info["yaw"] for info in drive(env, (0.0, 1.8, 0.0), 8))])
    assert 1.7 < turned.max() / env.period_s < 1.82


def test_commands_beyond_the_limits_are_clipped(env: ObjectNavVelocityEnv) -> None:
    fast = drive(env, (9.0, 0.0, 0.0), 8)[-1]["xy"][0]
    env.reset(seed=0)
    assert drive(env, AHEAD, 8)[-1]["xy"][0] == fast


def test_a_collision_is_counted_once_when_a_contact_begins_to_block(tmp_path: Path) -> None:
    house = with_box(sofa_room(), "cabinet_00", centre_m=(-0.5, 1.0, 0.5), half_m=(0.1, 0.5, 0.5))
    env = make(tmp_path, house)
    env.reset(seed=0)
    infos = drive(env, AHEAD, 30)
    assert [info["collided"] for info in infos].count(True) == 1
    first = [info["collided"] for info in infos].index(True)
    assert [info["blocked"] for info in infos] == [False] * first + [True] * (30 - first)
    assert infos[-1]["collisions"] == 1
    assert infos[-1]["xy"][0] == pytest.approx(0.9 - 0.18, abs=0.005)
    assert not drive(env, BACK, 5)[-1]["blocked"]
    assert drive(env, AHEAD, 20)[-1]["collisions"] == 2
    env.close()


@pytest.mark.costly
@pytest.mark.parametrize(("seed", "steps"), [(1, 60), (2, 90)])
def test_a_robot_that_swings_at_furniture_with_slipping_wheels_has_one_collision(seed: int, steps: int) -> None:
    env = ObjectNavVelocityEnv(split="val", sensors=(), time_limit_s=30.0)
    env.reset(seed=seed)
    info = drive(env, AHEAD, steps)[-1]
    assert (info["collisions"], info["blocked"]) == (1, True)
    env.close()


@pytest.mark.parametrize("command", [Velocity(0.5, 0.0), Velocity(-0.5, 0.0)])
def test_only_commands_that_push_by_the_robots_configuration_are_blocked(command: Velocity) -> None:
    house = with_box(sofa_room(), "cabinet_00", centre_m=(-1.0, 1.0, 0.5), half_m=(0.1, 0.5, 0.5))
    house = with_box(house, "cabinet_01", centre_m=(-2.0, 1.0, 0.5), half_m=(0.1, 0.5, 0.5))
    ended = {}
    for pushing_m_s in (DriveConfig.pushing_m_s, 0.6):
        world = World(house, robot=RobotConfig(drive=DriveConfig(pushing_m_s=pushing_m_s)))
        world.reset(START)
        ended[pushing_m_s] = [world.hold(command, 0.1).ended for _ in range(15)][-1]
    assert ended == {DriveConfig.pushing_m_s: "blocked", 0.6: "reached"}


def test_a_light_chair_that_is_pushed_is_no_collision(tmp_path: Path) -> None:
    env = make(tmp_path, with_movable(sofa_room(), "chair_00", xy_m=(-0.8, 1.0), mass_kg=2.0, friction=0.2))
    env.reset(seed=0)
    last = drive(env, AHEAD, 30)[-1]
    assert last["xy"][0] > 0.8
    assert (last["collisions"], last["touches"] > 0) == (0, True)
    env.close()


def test_a_round_body_that_turns_at_a_wall_does_not_collide_again(tmp_path: Path) -> None:
    house = with_box(sofa_room(), "cabinet_00", centre_m=(-1.0, 1.0, 0.5), half_m=(0.1, 0.5, 0.5))
    env = make(tmp_path, house)
    env.reset(seed=0)
    assert drive(env, AHEAD, 15)[-1]["collisions"] == 1
    turning = drive(env, (0.0, 1.8, 0.0), 10)
    assert (turning[-1]["collisions"], turning[0]["touches"] > 0) == (1, True)
    assert turning[-1]["yaw"] > 1.0
    env.close()


def test_an_episode_ends_after_its_time_limit(tmp_path: Path) -> None:
    env = make(tmp_path, time_limit_s=0.55, period_s=0.2)
    env.reset(seed=0)
    assert [env.step(np.zeros(3, np.float32))[3] for _ in range(3)] == [False, False, True]
    info = env._info(collided=False)
    assert (info["end_reason"], info["num_steps"], info["simulated_s"]) == ("time_limit", 3, pytest.approx(0.6))
    env.close()
    assert make(tmp_path).task_config.max_steps == 6000
    equal = make(tmp_path, period_s=0.1, time_limit_s=2.0, task=TaskConfig(max_steps=20))  # as `stubborn ros`
    assert equal.task_config.max_steps == 20


def test_stop_ends_the_episode_where_the_robot_is(env: ObjectNavVelocityEnv) -> None:
    drive(env, AHEAD, 5)
    before = env.scene.world.pose
    _, reward, terminated, _, info = env.step(np.array([0.5, 0.0, 1.0], np.float32))
    assert (terminated, reward, info["success"], info["end_reason"]) == (True, 0.0, 0.0, "stop")
    assert env.scene.world.pose == before


def test_what_is_not_allowed_is_refused(env: ObjectNavVelocityEnv, tmp_path: Path) -> None:
    wrongs: tuple[dict[str, Any], ...] = (
        {"period_s": 0.05},
        {"period_s": 0.0},
        {"time_limit_s": math.inf},
        {"max_steps": 5},
        {"task": {"max_steps": 5}},
        {"task": TaskConfig(max_steps=5)},
    )
    for wrong in wrongs:
        with pytest.raises(ConfigError, match=r"period_s|time_limit_s"):
            make(tmp_path, **wrong)
    assert make(tmp_path, period_s=0.5).metadata["render_fps"] == 2
    others: tuple[tuple[dict[str, Any], str], ...] = (
        ({"look": True}, "look=True adds"),
        ({"robot": {"motion": "sliding"}}, "'sliding'"),
    )
    for options, message in others:
        with pytest.raises(ConfigError, match=message):
            make(tmp_path, **options)
    for action in ((0.1, 0.0), (np.nan, 0.0, 0.0)):
        with pytest.raises(ConfigError, match=wording.AN_ACTION_IS_THREE_FINITE_NUMBERS):
            env.step(np.array(action))
    foreign: tuple[Any, ...] = (
        "abc", ("0.1", "0", "0"), {"speed": 1}, None, 1j, (1j, 0, 0), (10**400, 0, 0), [[1, 2], [3]], object(),
        (None, 0, 0), ("\ud800", 0, 0), np.array(["1", "2", "3"]), np.array([1, 2, 3], "datetime64[s]"), ([1], 2, 3),
    )  # fmt: skip
    for action in foreign:
        with pytest.raises(ConfigError, match=wording.AN_ACTION_IS_THREE_FINITE_NUMBERS):
            env.step(action)
    with pytest.raises(ConfigError, match="needs an ObjectNavVelocityEnv, got ObjectNavEnv"):
        DiscreteActions(ObjectNavEnv())


def test_windows_of_actions_are_as_long_in_time() -> None:
    still = [(0.0, 0.0)] * (12 * TRAPPED_WINDOW_STEPS)
    assert not stayed_near(still, 12)
    assert stayed_near([*still, (0.5, 0.0)], 12)
    assert not stayed_near([*still, (1.5, 0.0)], 12)


def test_a_trajectory_by_action_keeps_its_end_and_its_collisions(env: ObjectNavVelocityEnv) -> None:
    drive(env, AHEAD, 25)
    fine = env.scene.task.trajectory()
    coarse = by_action(fine, 12)
    assert (coarse.num_steps, len(coarse.poses), len(coarse.goal_share)) == (3, 4, 4)
    assert (coarse.poses[[0, -1]] == fine.poses[[0, -1]]).all()
    assert (coarse.poses[1:] == fine.poses[[1, 13, 25]]).all()
    assert by_action(fine, 1) is fine


def test_a_base_that_follows_the_stopping_velocity_never_passes_its_goal() -> None:
    for goal, start, acceleration in ((0.25, 0.0, 1.0), (0.25, 0.4, 1.0), (-0.5, 0.0, 6.0), (0.03, 0.1, 1.0)):
        at, velocity = 0.0, start
        for _ in range(100):
            command = stopping_velocity(goal - at, velocity, acceleration, 0.1)
            change = max(-acceleration * 0.1, min(acceleration * 0.1, command - velocity))
            at += (velocity + change) * 0.1 - 0.5 * change * abs(change) / acceleration
            velocity += change
            assert abs(at) <= abs(goal) + 1e-9
        assert at == pytest.approx(goal, abs=1e-3)


def test_discrete_actions_end_at_the_same_places_as_in_the_discrete_environment(tmp_path: Path) -> None:
    actions = [Action.MOVE_FORWARD, Action.TURN_RIGHT, Action.MOVE_FORWARD, Action.TURN_LEFT, Action.TURN_LEFT]
    by_velocity, moves = (
        DiscreteActions(make(tmp_path)),
        ObjectNavEnv(house=tmp_path / "house.xml", goal="sofa", camera=SMALL, sensors=(), start=START),
    )
    by_velocity.reset(seed=0)
    moves.reset(seed=0)
    for action in actions * 2:
        mine, _, _, _, info = by_velocity.step(action)
        theirs, *_ = moves.step(action)
        np.testing.assert_allclose(mine["gps"], theirs["gps"], atol=0.015)
        np.testing.assert_allclose(mine["compass"], theirs["compass"], atol=math.radians(1.5))
        assert not info["collided"]
        assert info["simulated_s"] < 1.2 * len(actions) * 2
    by_velocity.close()
    moves.close()


def test_a_blocked_discrete_action_ends_and_the_next_one_is_exact(tmp_path: Path) -> None:
    house = with_box(sofa_room(), "cabinet_00", centre_m=(-1.1, 1.0, 0.5), half_m=(0.1, 0.5, 0.5))
    env = DiscreteActions(make(tmp_path, house))
    assert isinstance(env.action_space, gymnasium.spaces.Discrete)
    assert env.action_space.n == 4
    env.reset(seed=0)
    with pytest.raises(ConfigError, match="3 TURN_RIGHT; got 4"):
        env.step(4)
    for number in (1, 2):
        observation, _, _, _, info = env.step(Action.MOVE_FORWARD)
        assert (info["collided"], info["collisions"]) == (True, number)
        assert observation["gps"][0] < 0.13
    for _ in range(3):
        observation, _, _, _, info = env.step(Action.TURN_LEFT)
    assert not info["collided"]
    assert float(observation["compass"][0]) == pytest.approx(math.pi / 2, abs=math.radians(1.0))
    env.close()


def test_an_agent_of_discrete_actions_finds_its_goal(tmp_path: Path) -> None:
    env = make(tmp_path, camera=CameraModel(width_px=160, height_px=120), sensors=("depth", "semantic"))
    agent = stubborn.make("stubborn", camera=env.camera_model, robot=env.robot_model, segmenter=GroundTruthSegmenter())
    actions = DiscreteActions(env)
    observation, info = actions.reset(seed=0)
    agent.reset(info["goal"], seed=0)
    terminated = truncated = False
    while not (terminated or truncated):
        observation, _, terminated, truncated, info = actions.step(agent.act(observation))
    assert (info["success"], info["end_reason"]) == (1.0, "stop")
    assert info["simulated_s"] < 60.0
    env.close()
