"""The parts of the robot on ROS 2 that need no ROS; tests/ros2 tries the nodes."""

from __future__ import annotations

import importlib.util
import inspect
import math
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import pytest

from sim.app import cli
from sim.app.bridges.ros2.observer import AgentNode, Announced
from sim.app.bridges.ros2.requests import Pace, Requests
from sim.app.bridges.ros2.robot import NodeDriver, RosConfig, run_driven, run_stepped
from sim.app.commands.ros import agent, robot
from sim.app.composition.ros_agent import RobotAgent, build_apart
from sim.app.composition.runner import Play
from sim.app.composition.setup import resolve
from sim.app.options import RunOptions
from sim.core.errors import AgentError, ConfigError
from sim.core.interface import Action

without_ros = pytest.mark.skipif(importlib.util.find_spec("rclpy") is not None, reason="there is ROS 2")


@without_ros
@pytest.mark.parametrize("command", [robot, agent])
def test_without_ros_one_line_says_what_to_install(command: object, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.run(command.Args, command.main, []) == 2  # type: ignore[attr-defined]
    said = capsys.readouterr().err.strip()
    assert len(said.splitlines()) == 1
    assert "needs rclpy" in said
    assert "ros setup" in said


@pytest.mark.parametrize(
    ("option", "said"),
    [("words", "agent 'cloned' takes categories only"), ("pictures", "agent 'cloned' takes no pictures")],
)
def test_an_agent_that_does_not_take_a_kind_of_goal_is_refused_before_ros_is_loaded(
    monkeypatch: pytest.MonkeyPatch, option: str, said: str
) -> None:
    monkeypatch.setattr(agent, "require_ros", lambda: pytest.fail("ROS was loaded"))
    with pytest.raises(ConfigError, match=f"--{option}: {said}"):
        agent.main(replace(agent.Args(agent="cloned"), **{option: True}))


@pytest.mark.parametrize(
    ("name", "goal", "said"),
    [
        ("tests.helpers.ros_agents:TURNER", "the red chair", "'the red chair' is in words: agent .* does not take it"),
        ("random", "the red chair", "'the red chair' is in words: give --words"),
        ("tests.helpers.ros_agents:TURNER", "", "goal is a picture: agent .* does not take it"),
        ("stubborn-plus", "", "goal is a picture: give --pictures"),
    ],
)
def test_a_goal_without_its_option_names_the_remedy_or_that_there_is_none(name: str, goal: str, said: str) -> None:
    announced = Announced("run", 1, 0, goal, 0, 0, over=False, picture=not goal)
    node = SimpleNamespace(announced=announced)
    driving = RobotAgent(resolve(RunOptions(agent=name)), cast(AgentNode, node), stepped=True)
    with pytest.raises(AgentError, match=said):
        driving.run(once=True)


@pytest.mark.parametrize("play", [run_stepped, run_driven])
def test_what_runs_an_episode_has_the_parameters_that_a_run_gives_and_no_others(play: Callable[..., Any]) -> None:
    given = list(inspect.signature(Play.__call__).parameters.values())[1:]
    assert list(inspect.signature(play).parameters.values()) == given


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_command_that_is_not_finite_is_refused_and_the_last_one_holds(bad: float) -> None:
    requests = Requests()
    requests.command(0.3, -0.2, 1.0)
    requests.command(bad, 0.0, 1.1)
    requests.command(0.0, bad, 1.1)
    assert requests.velocity(1.2, timeout_s=0.5) == (0.3, -0.2)
    assert (requests.counts.commands, requests.counts.refused_commands) == (3, 2)


def test_a_command_ends_after_its_timeout() -> None:
    requests = Requests()
    assert requests.velocity(0.0, timeout_s=0.5) == (0.0, 0.0)
    requests.command(0.3, 0.1, 1.0)
    assert requests.velocity(1.5, timeout_s=0.5) == (0.3, 0.1)
    assert requests.velocity(1.51, timeout_s=0.5) == (0.0, 0.0)


def test_actions_come_in_order_and_those_for_an_earlier_observation_are_refused() -> None:
    requests = Requests()
    for number in (1, 2, 9):
        requests.act(number)
    assert [requests.action(0.0), requests.action(0.0), requests.action(0.0)] == [
        Action.MOVE_FORWARD, Action.TURN_LEFT, None,
    ]  # fmt: skip
    requests.act(3)
    requests.discard_actions()
    assert requests.action(0.0) is None
    assert (requests.counts.commands, requests.counts.refused_commands) == (4, 2)


def running() -> Requests:
    """Returns the requests during an episode."""
    requests = Requests()
    requests.begin()
    return requests


def test_requests_between_two_episodes_are_refused_with_the_reason() -> None:
    requests = Requests()
    assert requests.raise_flag("next_episode") == "No episode is running."
    requests.begin()
    assert requests.raise_flag("next_episode") is None
    requests.end()
    assert requests.raise_flag("stop") == "No episode is running."
    assert [requests.asked("next_episode"), requests.asked("stop")] == [True, False]


def test_a_new_episode_forgets_requests_and_keeps_the_pause() -> None:
    requests = running()
    requests.command(0.3, 0.1, 1.0)
    requests.act(1)
    requests.raise_flag("stop")
    requests.stop_target, requests.stop_confidence = (1.0, 2.0), 0.5
    requests.pause(True)
    requests.begin()
    assert requests.velocity(1.0, 0.5) == (0.0, 0.0)
    assert requests.action(0.0) is None
    assert (requests.stop_target, requests.stop_confidence, requests.counts.commands) == (None, None, 0)
    assert requests.paused
    assert not requests.take("stop")


def test_a_flag_ends_a_wait_and_is_taken_once() -> None:
    requests = running()
    requests.raise_flag("reset")
    begin_s = time.monotonic()
    requests.wait(5.0)
    assert time.monotonic() - begin_s < 1.0
    assert [requests.take("reset"), requests.take("reset")] == [True, False]


def test_a_step_stays_until_an_action_has_come_and_ends_with_the_pause() -> None:
    requests = running()
    assert requests.raise_flag("step") == "Time is not paused."
    assert not requests.asked("step")
    requests.pause(True)
    requests.raise_flag("step")
    begin_s = time.monotonic()
    assert requests.action(0.2) is None
    assert time.monotonic() - begin_s > 0.15  # it waited
    assert requests.asked("step")
    requests.pause(False)
    assert not requests.asked("step")


@pytest.mark.parametrize("flag", ["stop", "step"])
def test_a_paused_agent_stops_and_steps(flag: str) -> None:
    requests, clock = running(), []
    robot: Any = SimpleNamespace(
        node=SimpleNamespace(requests=requests), publish=lambda _: None, repeat_clock=lambda: clock.append(1)
    )
    driver = NodeDriver(robot)
    requests.pause(True)
    requests.raise_flag(flag)
    later = threading.Timer(0.3, requests.act, [2])
    later.start()
    assert driver.act({}) is (Action.STOP if flag == "stop" else Action.TURN_LEFT)
    later.join()
    assert len(clock) < 20
    assert not requests.asked(flag)


def test_the_pace_keeps_the_mean_rate_and_starts_anew_after_a_delay() -> None:
    now = [10.0]
    pace = Pace(0.02, speed=0.5, now=lambda: now[0])
    assert not pace.begin()
    assert pace.remaining_s() == pytest.approx(0.04)
    now[0] += 0.05  # late by less than a period: the next one is early
    assert pace.remaining_s() == 0.0
    assert not pace.begin()
    assert pace.remaining_s() == pytest.approx(0.03)
    now[0] += 0.08
    assert pace.begin()
    assert pace.remaining_s() == pytest.approx(0.04)
    assert Pace(0.02, speed=0.0).remaining_s() == 0.0


def test_options_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(ConfigError, match="time does not stand still"):
        RosConfig(stepped=True, wall_time=True)
    with pytest.raises(ConfigError, match="rate_hz > 0"):
        RosConfig(rate_hz=0.0)


@pytest.mark.parametrize(
    ("options", "named"),
    [({"agent": "oracle"}, "'oracle'"), ({"agent": "stubborn", "semantics": "gt"}, "--semantics gt")],
)
def test_an_agent_that_reads_ground_truth_cannot_drive_a_robot(options: dict[str, str], named: str) -> None:
    with pytest.raises(ConfigError, match=f"{named}.* reads ground truth, which a robot does not have"):
        build_apart(resolve(RunOptions(**options)))  # type: ignore[arg-type]
