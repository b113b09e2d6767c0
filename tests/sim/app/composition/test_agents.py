"""Agents declare what they need: no true image reaches one that does not declare ground truth, and results say so."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from sim.app.commands.run import entry
from sim.app.composition.agents import SPECS, build_agent, find_agent, find_explorer
from sim.core.errors import ConfigError
from sim.core.interface import POSE_SENSORS, AgentSpec, CameraModel
from sim.env.objectnav import ObjectNavEnv
from stubborn.agent import StubbornAgent
from stubborn.detection.track_seeker import TrackSeeker
from stubborn.detection.verification import AcceptAll
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers import agents

SMALL = ("camera.width_px=160", "camera.height_px=120")


def run_episode(house: Path, out: Path, agent: str, semantics: str, *config: str) -> tuple[dict, set[str]]:
    """Runs one episode; returns its result line and the keys of the observations."""
    agents.SEEN.clear()
    options = ["--agent", agent, "--semantics", semantics, "--house", str(house), "--episodes", "1", "--out", str(out)]
    options += ["--step-timeout", "0"]  # in this process, which has the list of observations
    assert entry([*options, "--config", *SMALL, *config]) == 0
    (keys,) = {frozenset(keys) for keys in agents.SEEN}
    return json.loads((out / "results.jsonl").read_text()), set(keys)


@pytest.mark.costly
@pytest.mark.parametrize("semantics", ["gt", "noisy"])
@pytest.mark.parametrize(
    ("agent", "sensors"), [("tests.helpers.agents:make_spy", {"rgb", "depth"}), ("tests.helpers.agents:SPY", {"depth"})]
)
def test_no_true_image_reaches_an_agent_that_does_not_declare_it(
    house: Path, tmp_path: Path, agent: str, sensors: set[str], semantics: str
) -> None:
    line, keys = run_episode(house, tmp_path, agent, semantics)
    assert keys == sensors | set(POSE_SENSORS)
    assert line["uses_ground_truth"] is False
    assert line["semantics"] == semantics


def test_an_agent_that_declares_ground_truth_gets_it_and_its_results_say_so(house: Path, tmp_path: Path) -> None:
    line, keys = run_episode(house, tmp_path, "tests.helpers.agents:CHEAT", "gt")
    assert keys == {"semantic", *POSE_SENSORS}
    assert line["uses_ground_truth"] is True


def test_an_agent_gets_a_sensor_of_its_own(house: Path, tmp_path: Path) -> None:
    _, keys = run_episode(house, tmp_path, "tests.helpers.agents:FEELER", "gt")
    assert keys == {"depth", "ahead", *POSE_SENSORS}
    assert json.loads((tmp_path / "config.json").read_text())["config"]["sensors"] == ["depth", "ahead"]


def test_stubborn_plus_knows_the_tasks_limit_of_steps(house: Path) -> None:
    spec = SPECS["stubborn-plus"]
    env = ObjectNavEnv(house=house, max_steps=30, camera=CameraModel(width_px=160, height_px=120))
    parts = {"segmenter": GroundTruthSegmenter(), "verifier": AcceptAll(), "config": spec.config}
    agent = build_agent("stubborn-plus", spec, env, **parts)
    env.close()
    assert isinstance(agent, StubbornAgent)
    assert isinstance(agent.seeker, TrackSeeker)
    assert agent.seeker.verdicts.max_steps == 30


def test_a_sensor_of_its_own_is_no_back_door_to_the_truth() -> None:
    class Peeper(agents.Ahead):
        name, images = "peeper", ("semantic",)

    with pytest.raises(ConfigError, match="'peeper'"):
        AgentSpec(make=agents.make_spy, sensors=(Peeper(),))


@pytest.mark.parametrize("field", ["sensors", "words", "pictures"])
def test_one_name_is_not_a_tuple_of_names(field: str) -> None:
    wrong: dict[str, Any] = {field: "rgb"}
    with pytest.raises(ConfigError, match=f"AgentSpec.{field} must be a tuple of names, got 'rgb'"):
        AgentSpec(make=agents.make_spy, **wrong)


def test_ground_truth_cannot_be_asked_for_without_declaring_it() -> None:
    with pytest.raises(ConfigError, match=r"'semantic'.*uses_ground_truth=True"):
        AgentSpec(make=agents.make_spy, sensors=("semantic",))


def test_an_agents_own_option_is_set_from_the_command_line(house: Path, tmp_path: Path) -> None:
    line, _ = run_episode(house, tmp_path, "tests.helpers.agents:SPY", "gt", "agent.forwards=4")
    assert line["num_steps"] == 5
    assert json.loads((tmp_path / "config.json").read_text())["config"]["agent"] == {"prompt": "", "forwards": 4}


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("stuborn", "Did you mean 'stubborn'"),
        ("no.such_module:make", "no module 'no'"),
        ("tests/helpers/agents.py:SPY", "is a path; give the name of the module: 'tests.helpers.agents:SPY'."),
        ("./tests/helpers/agents:SPY", "'tests.helpers.agents:SPY'."),
        ("/no/agents.py:SPY", "'agents:SPY', in the folder '/no' or with it on PYTHONPATH."),
        ("setup.py:make", "'setup:make'."),
        ("tests.helpers.agents:none", "has no 'none'"),
        ("tests.helpers.agents:SPYY", "has no 'SPYY'. Did you mean 'SPY'?"),
        ("tests.helpers.agents:NUMBER", "AgentSpec"),
    ],
)
def test_an_agent_that_does_not_exist_is_refused(name: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        find_agent(name)


def test_an_explorer_with_a_similar_name_is_named() -> None:
    with pytest.raises(ConfigError, match="Did you mean 'informed-tour'"):
        find_explorer("informed-tuor")


@pytest.mark.parametrize(("name", "message"), [("NUMBER", "got 'int'"), ("SpyConfig", "got the class")])
def test_an_explorer_of_the_wrong_kind_is_refused(name: str, message: str) -> None:
    with pytest.raises(ConfigError, match=f"must be an object of a dataclass .*; {message}"):
        find_explorer(f"tests.helpers.agents:{name}")


@pytest.mark.costly
def test_a_factory_with_other_arguments_is_refused_in_one_sentence(
    house: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    options = ["--agent", "tests.helpers.agents:make_narrow", "--semantics", "gt", "--house", str(house)]
    assert entry([*options, "--episodes", "1", "--out", str(tmp_path)]) == 2
    assert "its factory is called with the arguments camera, robot, success" in capsys.readouterr().err


def test_every_agent_has_a_description_of_one_line() -> None:
    for name, spec in SPECS.items():
        assert 10 < len(spec.description) < 90, name
        assert "\n" not in spec.description


@pytest.mark.parametrize(
    ("module", "expected"),
    [
        ("import nowhere_at_all", "it imports 'nowhere_at_all', which is not installed ("),
        ("def make(:", "cannot be imported: SyntaxError"),
        ("raise SystemExit(3)", "cannot be imported: SystemExit: 3"),
        ("def other(): ...", "has no 'make'"),
        ("make = 7", "must be an AgentSpec or a factory, got int"),
        ("def make(camera): ...", "its factory is called with the arguments camera, robot"),
        (
            "class make:\n    def reset(self): ...\n    def act(self, observations): ...",
            "with Habitat's interface is given as --agent habitat:",
        ),
        ("def make(**_): return {}['sofa']", "cannot be built: KeyError: 'sofa'"),
        ("def make(**_): exit(4)", "cannot be built: SystemExit: 4"),
    ],
)
def test_an_agent_that_cannot_be_built_is_one_line_and_leaves_no_run_behind(
    module: str,
    expected: str,
    house: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "users_agent.py").write_text(module)
    sys.modules.pop("users_agent", None)
    options = ["--semantics", "gt", "--house", str(house), "--episodes", "1", "--out", str(tmp_path / "run")]
    assert entry([*options, "--agent", "users_agent:make", "--step-timeout", "0"]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ")
    assert expected in message
    assert message.count("\n") == 1
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("field", ["pose", "start", "motion", "model", "data"])
def test_a_sensor_that_declares_true_fields_needs_an_agent_that_declares_them(field: str) -> None:
    class Bearing(agents.Ahead):
        name, reads = "bearing", (field,)

    with pytest.raises(ConfigError, match=r"'bearing'.*uses_ground_truth=True"):
        AgentSpec(make=agents.make_spy, sensors=(Bearing(),))
    assert AgentSpec(make=agents.make_spy, sensors=(Bearing(),), uses_ground_truth=True).uses_ground_truth
