"""Options are read once: no name is looked up and no verifier is built a second time."""

from __future__ import annotations

import pickle
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from sim.app.commands.run import entry
from sim.app.composition import setup as composition
from sim.app.composition import transfer
from sim.app.composition.seed_key import KEY_FILE, seed_key_of
from sim.app.composition.setup import resolve
from sim.app.options import RunOptions
from sim.core.configuration import as_json
from sim.core.errors import ConfigError
from sim.core.interface import AgentSpec, CameraModel, RobotModel
from stubborn import agents
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.detection.seeker import Seeker, SeekerParts, TargetSeekerConfig
from stubborn.segmentation.checkpoints import save_network
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from stubborn.segmentation.networks import NETWORKS
from stubborn.segmentation.rednet import RedNet

SMALL = ("camera.width_px=160", "camera.height_px=120", "task.max_steps=3")


@pytest.mark.costly
def test_each_name_of_a_run_is_looked_up_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[str] = []
    for name in ("find_agent", "find_explorer", "find_segmentation", "verifier_for"):
        original = getattr(composition, name)

        def counted(*args: object, name: str = name, original: object = original) -> object:
            calls.append(name)
            return original(*args)  # type: ignore[operator]

        monkeypatch.setattr(composition, name, counted)
    options = ["--agent", "stubborn", "--explorer", "frontier", "--semantics", "noisy", "--episodes", "1"]
    assert entry([*options, "--out", str(tmp_path), "--config", *SMALL]) == 0
    assert sorted(calls) == ["find_agent", "find_explorer", "find_segmentation", "verifier_for"]


@pytest.mark.parametrize(
    ("options", "imported"),
    [
        ({"agent": "stubborn-plus", "semantics": "rednet"}, []),
        ({"agent": "stubborn", "semantics": "gt", "explorer": "informed-tour"}, []),
        ({"agent": "process:true", "semantics": "gt"}, []),
        ({"agent": "tests.helpers.agents:SPY", "semantics": "gt", "config": ("agent.forwards=7",)}, ["find_agent"]),
        (
            {"explorer": "stubborn.agents:INFORMED_TOUR", "config": ("agent.explorer.replan_steps=3",)},
            ["find_explorer"],
        ),
        ({"agent": "habitat:tests.helpers.habitat_agents:Wanderer", "config": ("agent.stop_after=7",)}, ["find_agent"]),
        ({"semantics": "tests.helpers.segmentations:FLAT", "config": ("detector.level=0.4",)}, ["find_segmentation"]),
    ],
)
def test_a_setup_travels_by_value_and_only_code_of_users_is_imported_again(
    options: dict[str, Any], imported: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    setup = resolve(RunOptions(**options))
    content = pickle.dumps(setup)
    assert str(transfer.ROOT).encode() not in content  # another machine may have the package in another folder
    calls: list[str] = []

    def count(module: ModuleType, name: str) -> None:
        original = getattr(module, name)
        monkeypatch.setattr(module, name, lambda *arguments: (calls.append(name), original(*arguments))[1])

    for name in ("find_agent", "find_explorer", "find_segmentation"):
        count(composition, name)
        count(transfer, name)
    for name in ("resolve", "verifier_for", "load_robot"):
        count(composition, name)
    again = pickle.loads(content)
    assert calls == imported
    assert as_json(again.config) == as_json(setup.config)
    assert (again.options, again.settings, again.sensors) == (setup.options, setup.settings, setup.sensors)
    assert (again.spec.description, again.uses_ground_truth) == (setup.spec.description, setup.uses_ground_truth)


def test_a_configuration_that_cannot_travel_is_refused_in_one_line() -> None:
    @dataclass(frozen=True)
    class Local:
        size: int = 1

    spec = AgentSpec(make=StubbornAgent, config=Local())
    with pytest.raises(ConfigError, match="top level"):
        pickle.dumps(resolve(RunOptions(agent="stubborn", semantics="gt"), spec))


def test_an_agent_accepts_a_seeker_of_a_user() -> None:
    made: list[SeekerParts] = []

    @dataclass(frozen=True)
    class Mine:
        def make(self, parts: SeekerParts) -> Seeker:
            made.append(parts)
            return TargetSeekerConfig().make(parts)

    agent = agents.make(
        "stubborn",
        camera=CameraModel(),
        robot=RobotModel(),
        segmenter=GroundTruthSegmenter(),
        seeker=Mine(),
        max_steps=77,
    )
    assert isinstance(agent, StubbornAgent)
    assert [parts.max_steps for parts in made] == [77]
    assert made[0].planner is agent.planner


def test_presets_are_configurations_of_one_agent() -> None:
    for name, (description, config) in agents.PRESETS.items():
        assert type(config) is AgentConfig, name
        assert agents.SPECS[name].description == description
        assert agents.SPECS[name].make is StubbornAgent


def test_a_shard_takes_the_key_that_another_one_has_written_since_it_opened_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fcntl.flock", lambda *_: (tmp_path / KEY_FILE).write_text("of another shard"))
    options = RunOptions(out=tmp_path / "shard_1_of_2", shard="1/2")
    assert seed_key_of(options) == "of another shard"


def test_weights_without_a_calibration_are_named(tmp_path: Path) -> None:
    network = RedNet(NETWORKS["compact"])
    for name, header in (("raw", {}), ("fitted", {"temperature": 1.3})):
        save_network(tmp_path / f"{name}.safetensors", network, header)
    raw = RunOptions(weights=tmp_path / "raw.safetensors")
    assert "raw.safetensors' are not calibrated" in resolve(raw).missing_calibration
    for options in (
        RunOptions(weights=tmp_path / "fitted.safetensors"),
        replace(raw, config=("detector.temperature=1.5",)),
        RunOptions(),
        RunOptions(semantics="gt"),
        RunOptions(agent="random"),
    ):
        assert resolve(options).missing_calibration == ""
