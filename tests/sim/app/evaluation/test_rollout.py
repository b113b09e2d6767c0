"""Each episode gives one line, even if the physics fail."""

from __future__ import annotations

import asyncio
import json
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import torch

from sim.app.commands.run import entry
from sim.app.evaluation.rollout import play_episode
from sim.core.geometry.pose import Pose
from sim.core.interface import Action, CameraModel
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.splits import write_split
from sim.sensors.noise import NoiseConfig, PoseNoise
from sim.task.result import RolloutResult
from tests.helpers.runners import Script
from tests.helpers.worlds import ledge, sofa_room

SMALL = CameraModel(width_px=64, height_px=48)
EPISODE = Episode("sofa_room_0", "sofa_room", "sofa", Pose(-1.0, 0.0, 0.0))


@pytest.fixture
def env(tmp_path) -> Iterator[ObjectNavEnv]:
    file = tmp_path / "sofa_room.xml"
    file.write_text(sofa_room().spec.to_xml())
    env = ObjectNavEnv(house=file, sensors=("depth",), camera=SMALL)
    yield env
    env.close()


def test_a_finished_episode_is_a_line_that_json_can_hold(env: ObjectNavEnv) -> None:
    line = play_episode(env, Script([Action.MOVE_FORWARD, Action.STOP]), EPISODE, seed=0)
    assert msgspec.convert(json.loads(json.dumps(msgspec.to_builtins(line), allow_nan=False)), RolloutResult) == line
    assert (line.end_reason, line.num_steps, line.success) == ("stop", 2, 0.0)
    assert line.path_length == pytest.approx(0.25, abs=0.01)


class Sure(Script):
    """A script that states a confidence."""

    def __init__(self, actions: list[Action], confidence: Any) -> None:
        super().__init__(actions)
        self.confidence = confidence

    def stop_confidence(self) -> Any:
        return self.confidence


@pytest.mark.parametrize(
    ("agent", "recorded"),
    [
        (Sure([Action.TURN_LEFT, Action.STOP], 0.25), 0.25),
        (Sure([Action.STOP], np.float32(1.0)), 1.0),
        (Sure([Action.STOP], None), None),
        (Script([Action.STOP]), None),
    ],
)
def test_a_line_records_how_sure_the_agent_was_when_it_stopped(env: ObjectNavEnv, agent: Any, recorded: Any) -> None:
    assert play_episode(env, agent, EPISODE, seed=0).stop_confidence == recorded


@pytest.mark.parametrize("stated", [1.5, -0.1, math.nan, "high"])
def test_a_confidence_that_is_no_share_ends_the_episode_as_an_error(env: ObjectNavEnv, stated: Any) -> None:
    line = play_episode(env, Sure([Action.STOP], stated), EPISODE, seed=0, name="x:mine")
    assert line.end_reason == "error"
    assert "'x:mine', step 1: stop_confidence() returned" in str(line.error)


class Aimed(Script):
    """A script that states for which place it stops."""

    def __init__(self, actions: list[Action], place: Any) -> None:
        super().__init__(actions)
        self.place = place

    def act(self, observation: Any) -> Action:
        self.last_pose = Pose(
            float(observation["gps"][0]), float(observation["gps"][1]), float(observation["compass"][0])
        )
        return super().act(observation)

    def stop_target_xy_m(self) -> Any:
        return self.place() if callable(self.place) else self.place


AHEAD_AND_STOP = [Action.MOVE_FORWARD, Action.TURN_LEFT, Action.STOP]


@pytest.mark.parametrize("stated", [(1.5, 0.5), [1.5, 0.5], np.array([1.5, 0.5], np.float32)])
def test_a_line_has_the_place_for_which_the_agent_stops_in_the_world(env: ObjectNavEnv, stated: Any) -> None:
    episode = replace(EPISODE, start=Pose(-1.0, 1.0, math.pi / 2))
    line = play_episode(env, Aimed(AHEAD_AND_STOP, stated), episode, seed=0)
    assert line.stop_target_xy_m == pytest.approx([-1.5, 2.5], abs=1e-5)  # 1.5 m along y, 0.5 m to the left
    assert line.stop_target_to_goal_m == pytest.approx(math.hypot(3.6, 1.7), abs=1e-3)  # corner at (2.1, 0.8)
    assert line.failure == "false_detection"


@pytest.mark.parametrize(
    ("agent", "end"),
    [
        (Script([Action.STOP]), "stop"),
        (Aimed([Action.STOP], None), "stop"),
        (Aimed([Action.TURN_LEFT] * 3, (1.0, 0.0)), "max_steps"),
    ],
)
def test_a_line_without_a_stop_or_a_place_says_so(env: ObjectNavEnv, agent: Any, end: str) -> None:
    env.task_config = replace(env.task_config, max_steps=3)
    line = play_episode(env, agent, EPISODE, seed=0)
    assert line.end_reason == end
    assert line.stop_target_xy_m is None
    assert line.stop_target_to_goal_m is None
    assert line.stop_target_category is None


def test_a_line_names_the_object_for_which_the_agent_stops(env: ObjectNavEnv) -> None:
    lines = [play_episode(env, Aimed([Action.STOP], place), EPISODE, seed=0) for place in ((3.4, 0.0), (-1.9, 0.0))]
    assert [line.stop_target_category for line in lines] == ["sofa", "wall"]


def test_the_place_of_an_agent_with_a_noisy_pose_is_where_it_saw_it_from_the_robot(tmp_path: Path) -> None:
    file = tmp_path / "sofa_room.xml"
    file.write_text(sofa_room().spec.to_xml())
    noise = NoiseConfig(pose=PoseNoise(gps_std_m=0.3, compass_std_rad=0.1))
    env = ObjectNavEnv(house=file, sensors=("depth",), camera=SMALL, noise=noise)
    agent = Aimed(AHEAD_AND_STOP, lambda: agent.last_pose.place_of(2.0, 1.0))
    line = play_episode(env, agent, EPISODE, seed=0)
    true = env.scene.world.pose
    env.close()
    assert agent.last_pose.distance_to(true.relative_to(EPISODE.start)) > 0.2
    assert line.stop_target_xy_m == pytest.approx(true.place_of(2.0, 1.0), abs=1e-5)


GRADIENT = torch.zeros(2, requires_grad=True)
"""It cannot be converted to numbers."""


@pytest.mark.parametrize(
    "stated", [1.5, "12", (1.0,), (1.0, 2.0, 3.0), (math.nan, 0.0), (0.0, 2e4), (None, 1.0), {1: 2}, GRADIENT]
)
def test_a_place_that_is_no_pair_of_numbers_ends_the_episode_as_an_error(env: ObjectNavEnv, stated: Any) -> None:
    line = play_episode(env, Aimed([Action.STOP], stated), EPISODE, seed=0, name="x:mine")
    assert line.end_reason == "error"
    assert "'x:mine', step 1: stop_target_xy_m() returned" in str(line.error)
    assert line.stop_target_xy_m is None


def test_a_stop_target_that_breaks_names_agent_and_step(env: ObjectNavEnv) -> None:
    line = play_episode(env, Aimed([Action.STOP], lambda: {}["sofa"]), EPISODE, seed=0, name="x:mine")
    assert "'x:mine', step 1: KeyError: 'sofa'" in str(line.error)


def test_a_state_that_is_not_finite_ends_the_episode_as_an_error_that_names_house_and_step(env: ObjectNavEnv) -> None:
    def break_it(step: int) -> None:
        if step == 2:
            env.scene.world.data.qvel[:] = np.nan

    line = play_episode(env, Script([Action.MOVE_FORWARD] * 5, break_it), EPISODE, seed=0)
    assert line.end_reason == "error"
    assert line.success == 0.0
    assert line.failure == "misc"
    assert "sofa_room" in str(line.error)
    assert "Step 3" in str(line.error)


def test_a_broken_episode_does_not_change_the_next_one(env: ObjectNavEnv) -> None:
    def break_it(step: int) -> None:
        if step == 1:
            env.scene.world.data.qvel[:] = np.nan

    actions = [Action.MOVE_FORWARD, Action.TURN_LEFT, Action.STOP]
    scripts = Script(actions), Script(actions, break_it), Script(actions)
    before, _, after = (play_episode(env, script, EPISODE, seed=0) for script in scripts)
    assert before.without_times() == after.without_times()


def test_a_fall_is_a_line_and_no_error(tmp_path) -> None:
    file = tmp_path / "ledge.xml"
    file.write_text(ledge(0.6).spec.to_xml())
    env = ObjectNavEnv(house=file, sensors=("depth",), camera=SMALL)
    episode = replace(EPISODE, house="ledge", goal="bed", start=Pose(-0.4, 0.0, 0.0))
    line = play_episode(env, Script([Action.MOVE_FORWARD] * 5), episode, seed=0)
    env.close()
    assert (line.end_reason, line.failure, line.num_steps) == ("fallen", "stairs", 2)
    assert line.error is None


class Answers:
    """An agent whose `act` returns the result of a function."""

    def __init__(self, answer: Callable[[], object]) -> None:
        self.answer = answer

    def reset(self, goal: str, seed: int) -> None:
        self.step = 0

    def act(self, observation: object) -> object:
        self.step += 1
        return Action.TURN_LEFT if self.step == 1 else self.answer()


class Mute(BaseException):
    """An error whose text cannot be made."""

    def __str__(self) -> str:
        raise ValueError


def fail(error: BaseException) -> None:
    raise error


class Signature:
    """An agent whose methods take other arguments."""

    def reset(self, goal: str, seed: int) -> None: ...

    def act(self) -> Action:
        return Action.STOP


@pytest.mark.costly
@pytest.mark.parametrize(
    ("agent", "message"),
    [
        (Answers(lambda: 7), "step 2: act() returned 7; an action is one of 0 STOP, 1 MOVE_FORWARD"),
        (Answers(lambda: None), "step 2: act() returned None"),
        (Answers(lambda: 1.5), "step 2: act() returned 1.5"),
        (Answers(lambda: np.zeros(3)), "step 2: act() returned array("),
        (Answers(lambda: sys.exit(3)), "step 2: SystemExit: 3"),
        (Answers(lambda: fail(GeneratorExit())), "step 2: GeneratorExit: no message"),
        (Answers(lambda: fail(asyncio.CancelledError("late"))), "step 2: CancelledError: late"),
        (Answers(lambda: fail(RuntimeError("x" * 10_000_000))), "xxx ... (10000000 characters)"),
        (Answers(lambda: fail(RuntimeError("a\udcffb\x1b"))), r"RuntimeError: a\udcffb\x1b"),
        (Answers(lambda: fail(Mute())), "step 2: Mute: its message cannot be read (ValueError)"),
        (Answers(lambda: {}["sofa"]), "step 2: KeyError: 'sofa'"),
        (Signature(), "step 1: TypeError: Signature.act() takes 1 positional argument"),
    ],
)
def test_an_agent_that_breaks_ends_its_episode_as_an_error_that_names_agent_and_step(
    agent: Any, message: str, env: ObjectNavEnv
) -> None:
    line = play_episode(env, agent, EPISODE, seed=0, name="my.agents:mine")
    assert line.end_reason == "error"
    assert line.error is not None
    assert line.error.startswith("Agent 'my.agents:mine', ")
    assert message in str(line.error)
    assert len(line.error) < 3000
    assert line.num_steps == (0 if isinstance(agent, Signature) else 1)
    assert play_episode(env, Script([Action.STOP]), EPISODE, seed=0).end_reason == "stop"


@pytest.mark.costly
@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_bad_house_start_or_agent_ends_one_episode_and_errors_can_be_run_again(
    workers: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, fault = tmp_path / "tiny", tmp_path / "fault"
    folder.mkdir()
    good = sofa_room().spec.to_xml()
    for name, text in (("good", good), ("noisy", good), ("torn", good[:200])):
        (folder / f"{name}.xml").write_text(text)
    (folder / "noisy.json").write_text('{"noise": {"preset": "psychic"}}')
    start, wall = Pose(-1.0, 0.0, 0.0), Pose(2.9, 2.9, 0.0)
    asked = [("good", start), ("torn", start), ("noisy", start), ("good", wall)]
    episodes = [Episode(f"e{i}", house, "sofa", pose) for i, (house, pose) in enumerate(asked)]
    write_split(folder, episodes, {house: {} for house, _ in asked}, version="1")
    monkeypatch.setenv("STUBBORN_TEST_FAULT", str(fault))
    fault.touch()
    command = ["--agent", "tests.helpers.runners:make_faulty", "--split", str(folder), "--episodes", "4"]
    command += ["--step-timeout", "0", "--workers", workers, "--semantics", "gt", "--out", str(tmp_path / "run")]

    def reasons() -> dict[str, str]:
        lines = [json.loads(line) for line in (tmp_path / "run" / "results.jsonl").read_text().splitlines()]
        return {line["episode_id"]: line.get("error", "") for line in lines}

    assert entry(command) == 1
    before = reasons()
    assert "Agent 'tests.helpers.runners:make_faulty', step 2: Faulty: it [bold]broke[/bold]" in before["e0"]
    assert "torn.xml" in before["e1"]
    assert "psychic" in before["e2"]
    assert "inside" in before["e3"]
    if workers == "2":
        return
    fault.unlink()
    assert entry(command) == 1
    assert reasons() == before  # nothing is run again without a request
    assert entry([*command, "--retry-errors"]) == 1
    assert reasons() == before | {"e0": ""}
    assert "Episodes that ended with an error and are run again: 4." in capsys.readouterr().out
