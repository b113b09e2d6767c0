"""One tree of settings: every field can be set, config.json holds all of it, and a run with another tree is refused."""

from __future__ import annotations

import json
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest

from sim.app import cli
from sim.app.analysis.comparison import Run
from sim.app.analysis.report.drawings import split_of
from sim.app.analysis.report.facts import command_of
from sim.app.commands.run import entry
from sim.app.composition.record import error_result, record_of
from sim.app.composition.setup import resolve
from sim.app.evaluation.config_fields import run_differences
from sim.app.options import RunOptions
from sim.core.configuration import as_json, field_paths, with_fields
from sim.core.errors import ConfigError
from sim.core.geometry.pose import Pose
from sim.episodes.episode import Episode
from sim.episodes.splits import one_house
from stubborn import detection, exploration
from stubborn.detection.verification import FittedVerifier
from tests.helpers.worlds import sofa_room

SPLIT = {"name": "val", "version": "1", "sha256": "0"}


def test_presets_then_the_file_then_the_command_line(tmp_path: Path) -> None:
    file = tmp_path / "settings.toml"
    file.write_text("[task]\nmax_steps = 300\n[task.success]\ndistance_m = 0.5\n[camera]\nwidth_px = 320\n")
    options = RunOptions(semantics="gt", noise="harsh", config_file=file, config=("camera.width_px=160",))
    config = resolve(options).config
    assert (config.task.max_steps, config.task.success.distance_m) == (300, 0.5)
    assert config.camera.width_px == 160
    assert config.noise.depth.axial_m == 0.003
    assert with_fields(config, {"noise.depth.axial_m": 0.0}).noise.depth.axial_1_m == config.noise.depth.axial_1_m


@pytest.mark.parametrize("value", ['"loader:main()"', '["a", "loader:main()"]'])
def test_a_settings_file_calls_no_function_and_the_command_line_may(
    value: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    called = tmp_path / "called"
    (tmp_path / "loader.py").write_text(f"import pathlib\npathlib.Path({str(called)!r}).touch()\nmain = str\n")
    (tmp_path / "mine.py").write_text(
        "class Agent:\n def __init__(self, checkpoint): ...\n def reset(self): ...\n def act(self, seen): ...\n"
    )
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "settings.toml"
    file.write_text(f"[agent]\ncheckpoint = {value}\n")
    options = RunOptions(agent="habitat:mine:Agent", semantics="gt", config_file=file)
    with pytest.raises(ConfigError, match=r"a file must not run code\. Give it on the command line"):
        resolve(options)
    assert not called.exists()
    given = resolve(replace(options, config_file=None, config=("agent.checkpoint=loader:main()",)))
    assert given.settings == {"agent.checkpoint": "loader:main()"}


@pytest.mark.parametrize("agent", ["stubborn", "stubborn-plus", "frontier", "random", "oracle"])
@pytest.mark.parametrize("semantics", ["gt", "noisy", "rednet"])
def test_every_field_of_every_agent_can_be_set_to_its_own_value(agent: str, semantics: str) -> None:
    config = resolve(RunOptions(agent=agent, semantics=semantics)).config
    content = as_json(config)
    json.dumps(content, allow_nan=False)

    def value(path: str) -> object:
        node = content
        for name in path.split("."):
            node = node[name]
        return node

    paths = [path for path in field_paths(config) if path != "robot.file" and not path.startswith("robot.file.")]
    assert len(paths) > 40
    assert with_fields(config, {path: value(path) for path in paths}) == config


@pytest.mark.parametrize(
    ("assignment", "expected"),
    [
        ("agent.planing.dilation_m=0.1", "Did you mean 'planning'"),
        ("agent.planning.dilation_m=wide", "'agent.planning.dilation_m' cannot be 'wide'"),
        ("task.max_steps=0", "max_steps"),
        ("task.success.distance_m=-1", "distance_m"),
        ("sensors=[]", "needs depth"),
        ('sensors=["depth", "imu", "semantic"]', "'semantic' is ground truth"),
        ("detector.weights=none", "'detector' has no fields here"),
    ],
)
def test_a_setting_that_does_not_exist_or_is_not_allowed_is_one_line(
    assignment: str, expected: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert entry(["--semantics", "gt", "--config", assignment, "--out", str(tmp_path / "run")]) == 2
    message = capsys.readouterr().err
    assert expected in message
    assert message.count("\n") == 1
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(("config", "bar"), [((), 0.5), (("verification.least_probability=0.6",), 0.6)])
def test_the_bar_of_the_fit_holds_unless_another_one_is_set(config: tuple[str, ...], bar: float) -> None:
    options = RunOptions(semantics="rednet", config=config)
    verifier = resolve(options).verifier
    assert isinstance(verifier, FittedVerifier)
    assert verifier.least_probability == bar
    assert resolve(options).config.verification.least_probability == bar


@pytest.mark.parametrize(
    ("semantics", "method"), [("gt", "naive-bayes"), ("rednet", "naive-bayes"), ("rednet", "none")]
)
def test_the_recorded_bar_is_one_half_for_every_segmentation_and_method(semantics: str, method: str) -> None:
    options = RunOptions(semantics=semantics, verification=method)
    assert resolve(options).config.verification.least_probability == 0.5


def test_the_record_holds_the_whole_tree_and_the_checksums_of_files() -> None:
    options = RunOptions(semantics="rednet", config=("agent.planning.dilation_m=0.1",))
    record = record_of(resolve(options), SPLIT)
    assert set(record["config"]) == {
        "agent", "detector", "verification", "robot", "camera", "cameras", "sensors", "scan", "profile", "noise",
        "task",
    }  # fmt: skip
    assert record["config"]["agent"]["planning"]["dilation_m"] == 0.1
    assert len(record["files_sha256"]["weights"]) == 64
    assert record["split_identity"] == SPLIT


def test_the_record_has_a_checksum_of_each_file_that_the_agent_reads(tmp_path: Path) -> None:
    weights = Path(str(exploration.__file__)).parent / "weights" / "poni.safetensors"
    fusion = Path(str(detection.__file__)).parent / "fusions" / "rednet.json"
    changed = tmp_path / "fusion.json"
    changed.write_bytes(fusion.read_bytes() + b"\n")

    def checksums(fusion: Path) -> dict[str, str]:
        settings = (f"agent.seeker.tracks.evidence.fusion={fusion}", f"agent.explorer.weights={weights}")
        options = RunOptions(agent="stubborn-plus", semantics="gt", explorer="poni", config=settings)
        return record_of(resolve(options), SPLIT)["files_sha256"]

    before, after = checksums(fusion), checksums(changed)
    assert set(before) == {"agent.seeker.tracks.evidence.fusion", "agent.explorer.weights"}
    assert [name for name in before if before[name] != after[name]] == ["agent.seeker.tracks.evidence.fusion"]


def test_the_houses_of_a_record_are_found_from_any_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "sofa_room.xml").write_text(sofa_room().spec.to_xml())
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    options = RunOptions(agent="random", semantics="gt", house=Path("sofa_room.xml"))
    record = record_of(resolve(options), one_house("sofa_room.xml").identity)
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert split_of(Run(tmp_path / "run", record, {})).houses == ("sofa_room",)
    before = cast(Any, {**record, "house": "sofa_room.xml"})  # as older versions wrote it
    assert run_differences(before, record, resumed=True) == []
    others = cast(Any, {**before, "split_identity": {**(record["split_identity"] or {}), "sha256": "1"}})
    assert "house" in [path for path, *_ in run_differences(others, record, resumed=True)]


@pytest.mark.costly
def test_a_run_is_resumed_only_with_the_same_tree(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--agent", "random", "--semantics", "gt", "--episodes", "1", "--out", str(tmp_path)]
    settings = ["--config", "task.max_steps=3", "camera.width_px=160", "camera.height_px=120"]
    assert entry([*options, *settings]) == 0
    assert entry([*options, *settings]) == 0
    capsys.readouterr()
    assert entry([*options, "--config", "task.max_steps=4", *settings[2:]]) == 2
    assert "config.task.max_steps = 3, this run has 4" in capsys.readouterr().err


def test_the_command_that_a_report_prints_repeats_the_settings(tmp_path: Path) -> None:
    settings = ("task.max_steps=3", "camera.width_px=160", "camera.height_px=120", "agent.cell_m=0.1")
    options = RunOptions(semantics="gt", explorer="frontier", seed=3, config=settings)
    command = command_of(record_of(resolve(options), SPLIT))
    parsed = cli.parse(RunOptions, shlex.split(command)[2:])
    assert resolve(parsed).config == resolve(options).config
    assert (parsed.seed, parsed.explorer, parsed.semantics) == (3, "frontier", "gt")


def test_the_command_that_a_report_prints_has_the_options_that_are_not_the_default() -> None:
    chosen = {"seed_key": "k", "noise": "harsh", "motion": "sliding", "shard": "1/2", "workers": 2, "rerun_save": True}
    record = {"agent": "random", "semantics": "gt", "split": "val", "episodes": 5, "profile": "fast", "seed": 0}
    record |= chosen | {"executor": "ray", "view": True, "only": []}
    words = shlex.split(command_of(cast(Any, record)))[2:]
    assert cli.parse(RunOptions, words) == RunOptions(agent="random", semantics="gt", **cast(Any, chosen))
    assert not {"--profile", "--seed"} & set(words)


def test_the_command_that_a_report_prints_names_the_chosen_episodes() -> None:
    options = RunOptions(semantics="gt", only=("val_0003", "val_0001"), episodes=2)
    command = command_of(record_of(resolve(options), SPLIT))
    assert cli.parse(RunOptions, shlex.split(command)[2:]).only == options.only
    assert "--episodes" not in command


def test_the_command_that_a_report_prints_has_the_replicates_and_the_files() -> None:
    options = RunOptions(semantics="gt", replicates=5, episodes=8, record=True, mcap=True)
    recorded = record_of(resolve(replace(options, episodes=40)), SPLIT)  # as `stubborn run` counts them
    parsed = cli.parse(RunOptions, shlex.split(command_of(recorded))[2:])
    assert (parsed.replicates, parsed.episodes) == (5, 8)
    assert (parsed.record, parsed.mcap, parsed.video) == (True, True, False)


def test_the_line_of_an_episode_that_could_not_begin_has_the_entries_of_every_other(tmp_path: Path) -> None:
    house, out = tmp_path / "sofa_room.xml", tmp_path / "run"
    house.write_text(sofa_room().spec.to_xml())
    options = ["--agent", "random", "--house", str(house), "--episodes", "1", "--config", "task.max_steps=3"]
    assert entry([*options, "--out", str(out)]) == 0
    line = json.loads((out / "results.jsonl").read_text())
    episode = Episode("sofa_room_0000", "sofa_room", "sofa", Pose(0.0, 0.0, 0.0), 2.0)
    broken = error_result(resolve(RunOptions(agent="random", house=house)), episode, "no floor")
    assert set(broken.as_json()) == {*line, "error"}


def test_a_long_text_among_the_options_of_an_agent_is_no_file() -> None:
    prompt = "Find the object, then stop. " * 20 + "Do not say where it is.txt"
    options = RunOptions(agent="tests.helpers.agents:SPY", semantics="gt", config=(f"agent.prompt={prompt}",))
    assert record_of(resolve(options), SPLIT)["config"]["agent"]["prompt"] == prompt


def test_the_command_that_a_report_prints_quotes_a_name_that_looks_like_a_number() -> None:
    options = RunOptions(agent="vlm", semantics="gt", config=('agent.model="7"', "agent.url=http://localhost:1"))
    command = command_of(record_of(resolve(options), SPLIT))
    assert resolve(cli.parse(RunOptions, shlex.split(command)[2:])).config == resolve(options).config
