"""The environment works with Gymnasium: vectors, wrappers, its checker, and an example."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import gymnasium
import numpy as np
import pytest

import sim.gym
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, CameraModel, ConfigError
from tests.helpers.worlds import ledge

ROOT = Path(__file__).resolve().parents[2]
ENV_ID = "stubborn/ObjectNav-v0"
SMALL = CameraModel(width_px=64, height_px=48)


@pytest.fixture
def options(house: Path) -> dict[str, Any]:
    return {"house": house, "goal": "sofa", "camera": SMALL, "render_mode": "rgb_array"}


@pytest.fixture
def env(options: dict[str, Any]) -> Iterator[gymnasium.Env]:
    env = gymnasium.make(ENV_ID, **options)
    yield env
    env.close()


def test_the_checker_of_stable_baselines_accepts_it(options: dict[str, Any]) -> None:
    checker = pytest.importorskip("stable_baselines3.common.env_checker", reason="the extra [train] is not installed")
    env = gymnasium.make(ENV_ID, **options)
    checker.check_env(env.unwrapped, warn=False)
    checker.check_env(sim.gym.ProgressReward(env), warn=False)
    env.close()


def test_a_configuration_may_be_a_dict_of_its_fields(house: Path) -> None:
    sizes = {"width_px": 32, "height_px": 24}
    env = gymnasium.make(ENV_ID, house=house, goal="sofa", camera=sizes, success={"distance_m": 0.5}, max_steps=9)
    observation, _ = env.reset(seed=0)
    assert observation["depth"].shape == (24, 32)
    assert env.unwrapped.task_config.success.distance_m == 0.5  # pyright: ignore[reportAttributeAccessIssue]
    env.close()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"camera": {"width": 32}}, r"'width'.*'width_px'.*?"),
        ({"camera": {"width_px": "wide"}}, "camera: 'width_px' cannot be 'wide'"),
        ({"camera": (64, 48)}, r"CameraModel.*\(64.*48\)"),
        ({"robot": "robot.xml"}, r"RobotConfig.*'robot.xml'"),
    ],
)
def test_an_invalid_configuration_is_refused_with_the_allowed_values(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        gymnasium.make(ENV_ID, **options)


@pytest.mark.costly
@pytest.mark.parametrize("vectorization_mode", ["sync", "async"])
def test_a_vector_of_two_equals_two_single_environments(options: dict[str, Any], vectorization_mode: str) -> None:
    seeds, actions = (3, 4), [(1, 2), (1, 1), (3, 1), (0, 1)]
    of_vector = {"vector_kwargs": {"context": "spawn"}} if vectorization_mode == "async" else {}
    envs = gymnasium.make_vec(ENV_ID, num_envs=2, vectorization_mode=vectorization_mode, **of_vector, **options)
    seen = [envs.reset(seed=seeds[0]), *(envs.step(np.array(both)) for both in actions)]
    envs.close()
    assert not np.array_equal(*seen[0][0]["depth"]), "each has a start of its own"
    for i, seed in enumerate(seeds):
        alone = gymnasium.make(ENV_ID, **options)
        for t, at_once in enumerate(seen):
            own = alone.step(actions[t - 1][i]) if t else alone.reset(seed=seed)
            for name, value in own[0].items():
                np.testing.assert_array_equal(at_once[0][name][i], value)
            for name, value in own[-1].items():
                assert at_once[-1][name][i] == value
        alone.close()


@pytest.mark.costly
def test_the_id_without_module_makes_async_vectors_with_gymnasiums_own_context(house: Path) -> None:
    """Runs in a process of its own, because other tests have rendered in this one."""
    code = (
        "import gymnasium, sim.gym\n"
        f"envs = gymnasium.make_vec('{ENV_ID}', num_envs=2, vectorization_mode='async', house=r'{house}', "
        "goal='sofa', sensors=('depth',))\n"
        "print(envs.reset(seed=0)[0]['depth'].shape, envs.step([1, 1])[1].tolist()); envs.close()"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False, timeout=60
    )
    assert answer.stdout.strip() == "(2, 480, 640) [0.0, 0.0]", answer.stderr


@pytest.mark.costly
def test_a_forked_worker_of_a_process_that_rendered_raises_and_does_not_hang(house: Path) -> None:
    code = (
        "import gymnasium, sim.gym\n"
        f"options = dict(house=r'{house}', goal='sofa', sensors=('depth',))\n"
        f"gymnasium.make('{ENV_ID}', **options).reset(seed=0)\n"
        f"envs = gymnasium.make_vec('{ENV_ID}', num_envs=1, vectorization_mode='async', "
        "vector_kwargs={'context': 'fork'}, **options)\n"
        "envs.reset(seed=0)"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False, timeout=60
    )
    assert "RenderError: OpenGL does not survive a fork" in answer.stderr


@pytest.mark.costly
def test_an_environment_that_a_fork_inherited_raises_and_does_not_hang(house: Path) -> None:
    code = (
        "import os, gymnasium, sim.gym\n"
        f"env = gymnasium.make('{ENV_ID}', house=r'{house}', goal='sofa', sensors=('depth',))\n"
        "env.reset(seed=0)\n"
        "for call in (lambda: env.step(1), lambda: env.reset(seed=1)):\n"
        "    if os.fork() == 0:\n"
        "        try:\n            call()\n"
        "        except Exception as error:\n            print(type(error).__name__, flush=True)\n"
        "        env.close()\n        os._exit(0)\n"
        "    os.wait()\n"
        "print(env.step(2)[3])"
    )
    answer = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False, timeout=60
    )
    assert answer.stdout.split() == ["RenderError", "RenderError", "False"], answer.stderr


def test_the_time_limit_of_gymnasium_truncates_and_the_task_continues_to_count(options: dict[str, Any]) -> None:
    env = gymnasium.make(ENV_ID, max_episode_steps=3, **options)
    env.reset(seed=0)
    steps = [env.step(Action.TURN_LEFT) for _ in range(3)]
    assert [truncated for _, _, _, truncated, _ in steps] == [False, False, True]
    assert steps[-1][4]["num_steps"] == 3
    assert steps[-1][4]["end_reason"] is None
    env.close()


def test_render_returns_the_colour_image(env: gymnasium.Env) -> None:
    observation, _ = env.reset(seed=0)
    np.testing.assert_array_equal(env.render(), observation["rgb"])
    observation, *_ = env.step(Action.TURN_LEFT)
    frame = env.render()
    np.testing.assert_array_equal(frame, observation["rgb"])
    assert np.std(np.asarray(frame)) > 1.0


def test_rendering_changes_no_observation(options: dict[str, Any]) -> None:
    runs = []
    for rendering in (False, True):
        env = gymnasium.make(ENV_ID, noise="realsense", **options)
        frames = [env.reset(seed=4)[0]]
        for action in (1, 2, 1, 1):
            if rendering:
                env.render()
            frames.append(env.step(action)[0])
        runs.append(frames)
        env.close()
    for plain, rendered in zip(*runs, strict=True):
        for name, value in plain.items():
            np.testing.assert_array_equal(value, rendered[name])


@pytest.mark.costly
def test_the_example_runs_both_agents_in_one_episode() -> None:
    from examples.gym_agents import run_episode

    ends = [run_episode(name, max_steps=4) for name in ("random", "stubborn")]
    assert ends[0]["episode_id"] == ends[1]["episode_id"]
    assert [end["num_steps"] for end in ends] == [end["episode"]["l"] for end in ends] == [4, 4]


@pytest.mark.costly
def test_the_example_of_ppo_trains_and_tries_its_policy(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("stable_baselines3", reason="the extra [train] is not installed")
    from examples import train_ppo

    monkeypatch.setattr(train_ppo, "STEPS_PER_UPDATE", 16)
    assert train_ppo.main(train_ppo.Args(steps=17, envs=1, max_steps=5, trials=1, out=tmp_path)) == 0
    curve = cv2.imread(str(tmp_path / "curve.png"))
    assert curve is not None
    assert curve.std() > 5
    rows = (tmp_path / "progress.csv").read_text().splitlines()
    assert rows[0].startswith("steps,minutes,steps_per_s,episodes,success")
    assert [row.split(",")[0] for row in rows[1:]] == ["16", "32"]
    assert (tmp_path / "policy.zip").stat().st_size > 0
    output = capsys.readouterr().out
    assert "success without exploration: " in output
    assert "untrained" not in output


@pytest.mark.costly
def test_the_example_of_ppo_says_that_a_short_training_has_not_changed_the_policy(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("stable_baselines3", reason="the extra [train] is not installed")
    from examples import train_ppo

    assert train_ppo.main(train_ppo.Args(minutes=1e-9, envs=1, max_steps=5, trials=0, out=tmp_path)) == 0
    assert "The training ended before its first row, which comes after 1,024 steps: the policy is untrained. " in (
        capsys.readouterr().out
    )


def test_the_example_of_ppo_sees_the_goal_from_the_robot_and_walls_as_near() -> None:
    pytest.importorskip("stable_baselines3", reason="the extra [train] is not installed")
    from examples import train_ppo

    start = Pose(3.0, 2.5, -np.pi / 2)  # the sofa is 2.4 m to the left, the wall 2.5 m ahead
    env = train_ppo.make_env(9, start=start)
    observation, _ = env.reset(seed=0)
    blocked, goal, scan = np.split(observation, [1, 4])  # by the names of the sensors
    np.testing.assert_allclose(goal, [2.4 / 5.0, 1.0, 0.0], atol=0.02)
    assert scan[7] == pytest.approx(2.5 / 5.0, abs=0.03)
    assert blocked == 0.0
    env.close()


def test_a_fall_terminates_the_episode(tmp_path: Path) -> None:
    file = tmp_path / "ledge.xml"
    file.write_text(ledge(0.6).spec.to_xml())
    env = gymnasium.make(ENV_ID, house=file, goal="bed", start=Pose(-0.4, 0.0, 0.0), sensors=("depth",))
    env.reset(seed=0)
    steps = [env.step(Action.MOVE_FORWARD) for _ in range(2)]
    assert [(terminated, truncated) for _, _, terminated, truncated, _ in steps] == [(False, False), (True, False)]
    assert (steps[1][4]["end_reason"], steps[1][1]) == ("fallen", 0.0)
    env.close()
