"""An agent written for Habitat runs unchanged: names, arguments, observations, actions, one line on errors."""

from __future__ import annotations

import json
import math
import random
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from sim.app.bridges.habitat import stand_in
from sim.app.bridges.habitat.agents import HabitatAgent, spec_of
from sim.app.bridges.habitat.conversions import Conversion, to_action
from sim.app.bridges.habitat_client import HabitatActions
from sim.app.commands.run import entry
from sim.app.composition.agents import find_agent
from sim.app.composition.record import code_of
from sim.app.options import RunOptions
from sim.core.configuration import with_fields
from sim.core.errors import AgentError, ConfigError
from sim.core.interface import GOAL_CATEGORIES, Action, AgentSpec, CameraModel, RobotModel, SuccessRule
from tests.helpers import wording
from tests.helpers.habitat_agents import Configured, NoAgent, Placed, Wanderer, arguments

CAMERA = CameraModel(width_px=4, height_px=3)
SMALL = ("camera.width_px=64", "camera.height_px=48")
PUBLISHED = """
import argparse
import habitat
from habitat.core.simulator import Observations
from habitat.sims.habitat_simulator.actions import HabitatSimActions


class Forward(habitat.Agent):
    "Drives forward."

    def __init__(self, steps: int = 3):
        self.options = argparse.ArgumentParser().parse_args()
        self.steps = steps

    def reset(self) -> None:
        self.left = self.steps

    def act(self, observations: Observations):
        self.left -= 1
        return HabitatSimActions.MOVE_FORWARD if self.left >= 0 else "stop"


class Lost(Forward):
    def act(self, observations):
        return habitat.utils.visualizations
"""


@pytest.fixture(autouse=True)
def _no_stand_in_remains() -> Iterator[None]:
    yield
    stand_in.remove()


@pytest.fixture
def published(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The name of a module that imports `habitat`."""
    (tmp_path / "published_forward.py").write_text(PUBLISHED)
    monkeypatch.syspath_prepend(tmp_path)
    yield "published_forward"
    sys.modules.pop("published_forward", None)


def observation(goal: str = "bed") -> dict[str, Any]:
    return {
        "rgb": np.zeros((3, 4, 3), np.uint8),
        "depth": np.array([[0.0, 0.5, 2.75, 5.0]] * 3, np.float32),
        "gps": np.array([1.0, 2.0], np.float32),
        "compass": np.array([0.5], np.float32),
        "objectgoal": np.array([GOAL_CATEGORIES.index(goal)], np.int64),
    }


def build(declared: Any, **config: Any) -> HabitatAgent:
    """Returns the agent of a class, with some fields of its configuration."""
    spec = spec_of("habitat:mine:X", declared)
    parts = {"camera": CAMERA, "robot": RobotModel(), "success": SuccessRule(), "segmenter": None, "verifier": None}
    agent = spec.build("mine", max_steps=77, config=with_fields(spec.config, config), **parts)
    assert isinstance(agent, HabitatAgent)
    return agent


def test_observations_have_habitats_form() -> None:
    ours = observation()
    converted = Conversion(camera=CAMERA).observations(ours)
    assert converted["depth"].shape == (3, 4, 1)
    assert converted["depth"].dtype == np.float32
    np.testing.assert_allclose(converted["depth"][0, :, 0], [0.0, 0.0, 0.5, 1.0])
    np.testing.assert_array_equal(converted["gps"], np.array([1.0, -2.0], np.float32))
    np.testing.assert_allclose(np.degrees(converted["compass"]), [28.6], atol=1e-4)  # of 28.648 degrees
    assert converted["objectgoal"].tolist() == [GOAL_CATEGORIES.index("bed")]
    assert not any(np.shares_memory(converted[name], ours[name]) for name in ours)


def test_depth_may_stay_in_metres_and_goals_may_have_the_numbers_of_hm3d() -> None:
    converted = Conversion(camera=CAMERA, categories="hm3d", normalize_depth=False).observations(observation("sofa"))
    np.testing.assert_allclose(converted["depth"][0, :, 0], [0.5, 0.5, 2.75, 5.0])
    assert converted["objectgoal"].tolist() == [5]


@pytest.mark.parametrize(
    "chosen",
    [
        1, np.int64(1), np.array([1]), np.array(1), "move_forward", "MOVE_FORWARD", np.str_("MOVE_FORWARD"),
        {"action": 1}, {"action": "move_forward", "action_args": {}}, {"action": {"action": np.int32(1)}},
        {"action": ("move_forward",)}, HabitatActions().MOVE_FORWARD, HabitatActions()["move_forward"],
    ],
)  # fmt: skip
def test_an_action_is_understood_in_all_of_habitats_forms(chosen: Any) -> None:
    assert to_action(chosen) is Action.MOVE_FORWARD


@pytest.mark.parametrize(
    "chosen",
    [
        None, True, np.array([True]), torch.tensor(True), 1.0, math.nan, 6, -1, "forward", "", [], [1, 2], {},
        {"act": 1}, {"action": None},
        {"action": {"action": {"action": {"action": 1}}}}, np.array([1, 2]), np.array([0.5]), object(),
        {"action": ("velocity_control", "velocity_stop"), "action_args": {}}, b"\x01",
    ],
)  # fmt: skip
def test_anything_else_is_refused_in_a_line_that_lists_the_actions(chosen: Any) -> None:
    with pytest.raises(AgentError, match=r"0.*1.*move_forward.*2.*turn_left.*3.*turn_right"):
        to_action(chosen)


@pytest.mark.parametrize(
    ("chosen", "action"),
    [
        (4, Action.LOOK_UP),
        ("LOOK_UP", Action.LOOK_UP),
        (5, Action.LOOK_DOWN),
        ({"action": "look_down"}, Action.LOOK_DOWN),
    ],
)
def test_habitats_actions_4_and_5_tilt_the_camera(chosen: Any, action: Action) -> None:
    assert to_action(chosen) is action


def test_arguments_of_the_constructor_are_fields_of_the_configuration() -> None:
    agent = build(Wanderer, stop_after="7", **{"others.a": 1, "others.b": "text"}).agent
    assert (agent.stop_after, agent.keep, agent.others) == (7, 0.1, {"a": 1, "b": "text"})
    with pytest.raises(ConfigError, match="Did you mean 'stop_after'"):
        build(Wanderer, stop_afte=7)
    with pytest.raises(ConfigError, match="'stop_after' cannot be 'x'"):
        build(Wanderer, stop_after="x")


def test_arguments_by_place_keep_their_places() -> None:
    agent = build(Placed, second=5).agent
    assert (agent.first, agent.second) == (1, 5)


def test_a_required_configuration_is_that_of_the_run_and_other_required_arguments_are_asked_for() -> None:
    agent = build(Configured, distance=2).agent
    assert agent.distance == 2.0
    assert agent.task_config.ENVIRONMENT.MAX_EPISODE_STEPS == 77
    assert agent.task_config.habitat.simulator.agents.main_agent.sim_sensors.rgb_sensor.width == 4
    with pytest.raises(ConfigError, match=r"--config.*agent\.distance=VALUE"):
        build(Configured)


def test_a_configuration_has_the_entries_of_a_file_and_keeps_those_of_the_run(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text("MINE: {KEEP: 0.5}\nENVIRONMENT: {MAX_EPISODE_STEPS: 7}\n")
    config = build(Configured, distance=2, task_config=str(file)).agent.task_config
    assert (config.MINE.KEEP, config.ENVIRONMENT.MAX_EPISODE_STEPS) == (0.5, 77)
    assert "The run determines ENVIRONMENT.MAX_EPISODE_STEPS=77, not 7." in caplog.text
    with pytest.raises(ConfigError, match=r"none\.yaml"):
        build(Configured, distance=2, task_config=str(tmp_path / "none.yaml"))


def test_a_value_may_call_a_function_which_does_not_see_the_options_of_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["stubborn", "run", "--episodes", "3"])
    agent = build(Wanderer, **{"others.args": f"{arguments.__module__}:arguments()"}).agent
    assert agent.others == {"args": {"argv": []}}


def test_an_agent_specification_may_declare_ground_truth() -> None:
    make: Any = lambda **_: Wanderer()  # noqa: E731
    spec = AgentSpec(make=make, sensors=("semantic",), uses_ground_truth=True)
    wrapped = spec_of("habitat:mine:X", spec)
    assert (wrapped.sensors, wrapped.uses_ground_truth) == (("semantic",), True)
    converted = Conversion(camera=CAMERA).observations(observation() | {"semantic": np.full((3, 4), 11, np.uint8)})
    assert converted["semantic"].shape == (3, 4, 1)
    assert converted["semantic"].dtype == np.int32


@pytest.mark.parametrize(
    ("declared", "message"), [(3, "AgentSpec"), (NoAgent, "NoAgent"), (lambda categories: Wanderer(), "'categories'")]
)
def test_something_else_is_refused(declared: Any, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        build(declared)


def test_the_seed_fixes_the_draws_of_the_global_generators() -> None:
    agent, frames = build(Wanderer, keep=0.9), [observation()] * 20
    actions = []
    for _ in range(2):
        agent.reset("bed", 3)
        actions.append([agent.act(frame) for frame in frames])
    assert actions[0] == actions[1]
    assert len(set(actions[0])) == 2


@pytest.mark.parametrize("keeps", [False, True])
def test_the_next_goal_of_a_chain_is_given_or_the_agent_is_reset(keeps: bool) -> None:
    class Noted(Wanderer):
        calls: tuple[object, ...] = ()

        def reset(self) -> None:
            super().reset()
            self.calls = (*self.calls, random.random())

    class Remembering(Noted):
        def next_goal(self, goal: str) -> None:
            self.calls = (*self.calls, goal)

    inner = Remembering() if keeps else Noted()
    if not keeps:
        vars(inner)["next_goal"] = (1.0, 2.0)  # a place on the agent's map
    agent = HabitatAgent(inner, Conversion(camera=CameraModel(), categories="hm3d"))
    agent.reset("chair", 7)
    agent.next_goal("bed")
    first = inner.calls[0]
    assert inner.calls == (first, "bed" if keeps else first)
    with pytest.raises(AgentError, match="'table'"):
        agent.next_goal("table")


def test_the_stand_in_has_the_names_and_goes_away(published: str) -> None:
    assert "habitat" not in sys.modules
    spec = find_agent(f"habitat:{published}:Forward")
    assert spec.description == "Drives forward."
    import habitat  # type: ignore[import-not-found]

    assert habitat.core.agent.Agent is habitat.Agent
    with habitat.config.read_write(habitat.get_config()) as config:
        config.habitat.dataset.split = "test"
    with pytest.raises(AttributeError, match=r"'habitat\.Dataset'"):
        _ = habitat.Dataset
    stand_in.remove()
    assert "habitat" not in sys.modules


def test_an_installed_habitat_has_priority_and_a_mere_folder_has_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "habitat").mkdir()
    assert stand_in.install()
    stand_in.remove()
    (tmp_path / "habitat" / "__init__.py").touch()
    assert not stand_in.install()


@pytest.mark.parametrize(
    ("line", "named"),
    [
        ("from habitat.core.simulator import Sensor", r"'habitat\.core\.simulator\.Sensor'"),
        ("import habitat.datasets", r"'habitat\.datasets'"),
        ("import habitat\nx = habitat.Dataset", r"'habitat\.Dataset'"),
        ("import habitat_sim", "'habitat_sim'"),
        ("import argparse\nargparse.ArgumentParser().parse_args(['x'])", "SystemExit"),
    ],
)
def test_what_the_stand_in_lacks_is_named(published: str, tmp_path: Path, line: str, named: str) -> None:
    (tmp_path / "lacking_agent.py").write_text(line)
    with pytest.raises(ConfigError, match=named):
        find_agent("habitat:lacking_agent:X")


def test_the_modules_of_the_user_do_not_include_the_prefix() -> None:
    assert RunOptions(agent="habitat:pack.mod:X").own_modules == ["pack.mod"]
    with pytest.raises(ConfigError, match=wording.MUST_HAVE_THE_FORM_HABITAT_PACKAGE):
        find_agent("habitat:mod")


def run_of(published: str, house: Path, out: Path, *options: str) -> list[dict[str, Any]]:
    """Runs the published agent; returns the lines of the run, sorted."""
    common = ["--agent", f"habitat:{published}:Forward", "--house", str(house), "--out", str(out)]
    assert entry([*common, *options, "--config", "agent.steps=2", *SMALL]) == 0
    return sorted(
        map(json.loads, (out / "results.jsonl").read_text().splitlines()), key=lambda line: line["episode_id"]
    )


def test_a_run_announces_the_stand_in_hashes_the_agent_and_resumes(
    house: Path, tmp_path: Path, published: str, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run"
    run_of(published, house, out, "--episodes", "1", "--step-timeout", "0")
    assert stand_in.NOTE in " ".join(capsys.readouterr().out.split())
    lines = run_of(published, house, out, "--episodes", "2", "--step-timeout", "0")
    assert [(line["num_steps"], line["end_reason"]) for line in lines] == [(3, "stop"), (3, "stop")]
    record = json.loads((out / "config.json").read_text())
    assert record["config"]["agent"] == {"steps": 2, "categories": "mp3d", "normalize_depth": True, "looks": False}
    before = code_of(RunOptions(agent=f"habitat:{published}:Forward"))
    with (tmp_path / "published_forward.py").open("a") as file:
        file.write("# edited\n")
    assert code_of(RunOptions(agent=f"habitat:{published}:Forward")) != before == record["versions"]["code"]


@pytest.mark.slow
def test_workers_give_the_same_lines_and_videos(house: Path, tmp_path: Path, published: str) -> None:
    here = run_of(published, house, tmp_path / "here", "--episodes", "3", "--step-timeout", "0")
    apart = run_of(published, house, tmp_path / "apart", "--episodes", "3", "--workers", "2", "--video")
    for line in (*here, *apart):
        del line["wall_time_s"], line["steps_per_s"]
    assert here == apart
    assert len(list((tmp_path / "apart" / "videos").glob("*.mp4"))) == 3


def test_an_error_of_the_agent_is_one_line_of_its_episode(house: Path, tmp_path: Path, published: str) -> None:
    options = ["--agent", f"habitat:{published}:Lost", "--house", str(house), "--episodes", "1", "--out"]
    assert entry([*options, str(tmp_path / "run"), "--step-timeout", "0", "--config", *SMALL]) == 1
    (line,) = map(json.loads, (tmp_path / "run" / "results.jsonl").read_text().splitlines())
    assert line["end_reason"] == "error"
    assert "step 1: AttributeError: 'habitat.utils' is not part of the stand-in" in line["error"]


def test_a_goal_that_the_data_set_lacks_is_named() -> None:
    agent = build(Wanderer, categories="hm3d")
    with pytest.raises(AgentError, match=r"'table'.*hm3d"):
        agent.reset("table", 0)
