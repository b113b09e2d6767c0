"""Recorded runs are verified equal, and forged or damaged submissions are refused or marked by the right sentence."""

from __future__ import annotations

import copy
import gzip
import json
import os
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.analysis.comparison import read_run
from sim.commands import leaderboard, submit, verify
from sim.configuration import as_json
from sim.errors import ConfigError
from sim.sensors.actuation_noise import ActuationNoise
from sim.submissions.contents import MAX_FILE_BYTES, read_submission
from sim.submissions.packing import About, pack
from sim.submissions.verdicts import Verdict
from sim.submissions.verification import Checked, Choices, check, verdicts
from tests.helpers.submissions import content_of, recorded, tiny_split, written

Edit = Callable[[dict[str, Any]], None]
RUNS = {"oracle": ("oracle", "none"), "random": ("random", "harsh"), "process": ("process", "realsense")}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a split, and a recorded run and a submission of each of `RUNS`; the last two have noise."""
    folder = tmp_path_factory.mktemp("submissions")
    split = tiny_split(folder)
    for name, (agent, noise) in RUNS.items():
        recorded(split, folder / name, agent, "--noise", noise)
        words = submit.Args(run=folder / name, name=f"The {name}", authors=("A. Author",), links=("https://x.org/a",))
        assert submit.main(words) == 0
    return folder


def checked(folder: Path, file: Path, **changes: Any) -> tuple[Checked, Choices]:
    choices = replace(Choices(split=folder / "tiny", draw_seed=1, frames=0.0, nonstandard=True), **changes)
    return check(file, choices, verify.truth_of_agents()), choices


def judged(folder: Path, file: Path, **changes: Any) -> list[Verdict]:
    return [verdict for verdict, _ in verdicts(*checked(folder, file, **changes))]


@pytest.mark.parametrize("name", RUNS)
def test_a_recorded_run_is_verified_equal_with_its_frames(folder: Path, name: str) -> None:
    found = judged(folder, folder / f"{name}.json.gz", frames=1.0)
    assert [(each.judgement, each.framed, each.text) for each in found] == [("equal", True, "")] * 3
    assert {each.result.end_reason for each in read_submission(folder / f"{name}.json.gz").episodes} <= {
        "stop", "max_steps",
    }  # fmt: skip


def test_the_runs_have_successes_failures_and_collisions(folder: Path) -> None:
    """Else equal numbers would say little."""
    results = [each.result for name in RUNS for each in read_submission(folder / f"{name}.json.gz").episodes]
    assert {bool(each.success) for each in results} == {True, False}
    assert sum(float(each.collisions or 0) for each in results) > 0


def test_a_submission_is_small_and_names_no_folder_of_the_user(folder: Path) -> None:
    file = folder / "random.json.gz"
    assert file.stat().st_size < 6_000
    assert str(folder) not in json.dumps(content_of(file)["manifest"])
    assert "out" not in content_of(file)["config"]


# Contradictions and damage: refused before anything is replayed


def _manifest(**changes: Any) -> Edit:
    return lambda content: content["manifest"].update(changes)


def _inputs(**changes: Any) -> Edit:
    return lambda content: content["manifest"]["inputs"].update(changes)


def _result(**changes: Any) -> Edit:
    return lambda content: content["episodes"][0]["result"].update(changes)


def _all_results(**changes: Any) -> Edit:
    def edit(content: dict[str, Any]) -> None:
        for each in content["episodes"]:
            each["result"].update(changes)

    return edit


def _tree(part: str, **changes: Any) -> Edit:
    def edit(content: dict[str, Any]) -> None:
        node = content["config"]["config"]
        for name in part.split(".") if part else ():
            node = node[name]
        node.update(changes)

    return edit


def _config(**changes: Any) -> Edit:
    return lambda content: content["config"].update(changes)


def _actions(change: Callable[[str], str], *, counted: bool = False) -> Edit:
    def edit(content: dict[str, Any]) -> None:
        each = content["episodes"][0]
        each["actions"] = change(each["actions"])
        if counted:
            each["result"]["num_steps"] = len(each["actions"])

    return edit


def _all(*edits: Edit) -> Edit:
    def edit(content: dict[str, Any]) -> None:
        for each in edits:
            each(content)

    return edit


def _deep(content: dict[str, Any]) -> None:
    nested: Any = 1
    for _ in range(900):
        nested = [nested]
    content["config"]["extra"] = nested


def _split(**changes: Any) -> Edit:
    return lambda content: content["manifest"]["split"].update(changes)


REFUSED: dict[str, tuple[Edit, str]] = {
    "other format": (lambda c: c.update(format="stubborn-submission-9"), "field 'format'"),
    "unknown field": (_manifest(rank=1), "unknown field 'rank'|unknown field rank"),
    "no episodes": (lambda c: c.update(episodes=[]), "field 'episodes'"),
    "an episode twice": (lambda c: c["episodes"].append(copy.deepcopy(c["episodes"][0])), "2 times; each counts once"),
    "an episode of no split": (_result(episode_id="tiny_9999"), "the split 'tiny' has no such episode"),
    "another goal": (_result(goal="bed"), "its result has goal 'bed', the split has 'sofa'"),
    "another house": (_result(house="palace"), "its result has house 'palace'"),
    "another split": (_split(sha256="0" * 64), "was made on the split 'tiny' 1 with sha256 000000000000"),
    "an action that does not exist": (_actions(lambda a: "7" + a[1:]), "actions'"),
    "actions after STOP": (_actions(lambda a: a + "11", counted=True), "has actions after STOP"),
    "too many actions": (_actions(lambda a: "1" * 26, counted=True), "has 26 actions; the task allows 25"),
    "fewer actions than counted": (_actions(lambda a: a[1:]), "actions, and its result counts"),
    "another version of the physics": (_manifest(physics=0), "physics of version 0, this is version"),
    "no version of the physics": (lambda c: c["manifest"].pop("physics"), "missing required field physics"),
    "a script as link": (_manifest(links=["javascript:alert(1)"]), "links"),
    "a link that ends a Markdown link": (_manifest(links=["https://x.org/a)<b>"]), "links"),
    "a name with control characters": (_manifest(name="a\x1b[2J"), "name"),
    "a name that is a formula": (_manifest(name="=1+1"), "name"),
    "a long description": (_manifest(description="a" * 3000), "description"),
    "truth in the lines only": (_inputs(uses_ground_truth=False), "uses_ground_truth True, the manifest has False"),
    "an agent that knows the truth": (
        _all(
            _inputs(uses_ground_truth=False, semantics="rednet"),
            _all_results(uses_ground_truth=False, semantics="rednet"),
            _config(semantics="rednet"),
        ),
        "declares no ground truth, and its agent 'oracle' uses it",
    ),
    "a true image among the sensors": (
        _all(
            _inputs(uses_ground_truth=False, semantics="rednet", agent="mine:NAME", sensors=["semantic"]),
            _all_results(uses_ground_truth=False, semantics="rednet", agent="mine:NAME"),
            _config(semantics="rednet", agent="mine:NAME"),
            _tree("", sensors=["semantic"]),
        ),
        "declares no ground truth, and its configuration gives the agent 'semantic'",
    ),
    "a true segmentation": (
        _all(
            _inputs(uses_ground_truth=False, semantics="mine:NAME", agent="mine:NAME"),
            _all_results(uses_ground_truth=False, semantics="mine:NAME", agent="mine:NAME"),
            _config(semantics="mine:NAME", agent="mine:NAME", segmentation={"name": "mine", "truth": ["semantic"]}),
        ),
        "gives the agent 'semantic'",
    ),
    "another segmentation": (
        _inputs(semantics="rednet"),
        "declares semantics 'rednet', and its configuration has 'gt'",
    ),
    "other sensors": (_inputs(sensors=["rgb"]), r"declares sensors \('rgb',\)"),
    "noise that was not there": (_inputs(noise="harsh"), "declares noise 'harsh', and its configuration has 'none'"),
    "a process that was not there": (_inputs(isolated=True), "declares isolated True for the agent 'oracle'"),
    "another seed": (_all(_manifest(seed=5), _all_results(seed=5)), "the seed is 5, in its configuration 0"),
    "a robot of a file": (_tree("robot", file={"path": "/etc/passwd"}), "the robot is that of a file"),
    "a robot with an unknown field": (_tree("robot.drive", turbo=True), "There is no field"),
    "a robot that lacks a field": (
        lambda c: c["config"]["config"]["robot"]["drive"].pop("tick_s"),
        "lacks 'drive.tick_s'; it is of another version",
    ),
    "a robot that cannot be": (_tree("robot.body", radius_m=-1.0), "radius_m"),
    "a time step for days": (_tree("robot.physics", timestep_s=1e-5), "timestep_s is below"),
    "no task": (lambda c: c["config"]["config"].pop("task"), "has no field 'config.task'"),
    "no configuration": (lambda c: c["config"].pop("config"), "has no field 'config'"),
    "a configuration that is a list": (lambda c: c.update(config=[1]), "field 'config',"),
    "a configuration that is too large": (_config(extra="x" * (2 << 20)), "at most 1048576"),
    "a configuration that is deep": (_deep, "nested too deeply|JSON"),
    "an infinite number": (_result(path_length=float("inf")), "not JSON"),
    "a success of 2": (_result(success=2.0), "success"),
    "an error that succeeds": (_result(end_reason="error"), "ended with an error and cannot be a success"),
    "a place on the moon": (lambda c: c["episodes"][0].update(places_m=[[4e8, 0.0]]), "places_m"),
}


@pytest.mark.parametrize("forgery", REFUSED)
def test_a_contradiction_is_refused_by_one_sentence(folder: Path, tmp_path: Path, forgery: str) -> None:
    edit, sentence = REFUSED[forgery]
    content = content_of(folder / "oracle.json.gz")
    edit(content)
    with pytest.raises(ConfigError, match=sentence) as refused:
        checked(folder, written(tmp_path / "forged.json.gz", content))
    assert "\n" not in str(refused.value)


def _bomb(good: bytes) -> bytes:
    return gzip.compress(b" " * (65 << 20), 1)


DAMAGED: dict[str, tuple[Callable[[bytes], bytes], str]] = {
    "truncated": (lambda good: good[: len(good) // 2], "cannot be read"),
    "empty": (lambda good: b"", "cannot be read|is empty"),
    "not gzip": (lambda good: b"PK\x03\x04" + good, "cannot be read"),
    "a changed byte": (lambda good: good[:-6] + bytes([good[-6] ^ 1]) + good[-5:], "cannot be read"),
    "no JSON": (lambda good: gzip.compress(b"{'a': 1}"), "is not JSON"),
    "a bomb": (_bomb, "expands to more than 64 MB"),
    "too large": (lambda good: bytes(MAX_FILE_BYTES + 1), "is too large"),
    "a list": (lambda good: gzip.compress(b"[]"), "expected object"),
}


@pytest.mark.parametrize("damage", DAMAGED)
def test_a_damaged_file_is_refused_by_one_sentence(
    folder: Path, tmp_path: Path, damage: str, capsys: pytest.CaptureFixture[str]
) -> None:
    change, sentence = DAMAGED[damage]
    file = tmp_path / "damaged.json.gz"
    file.write_bytes(change((folder / "oracle.json.gz").read_bytes()))
    with pytest.raises(ConfigError, match=sentence):
        checked(folder, file)


def test_a_pipe_and_a_folder_are_refused_without_waiting(folder: Path, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.json.gz")
    for name in ("pipe.json.gz", "."):
        with pytest.raises(ConfigError, match=r"cannot be read"):
            checked(folder, tmp_path / name)


def test_bytes_changed_at_random_give_an_error_of_ours_or_a_submission(folder: Path, tmp_path: Path) -> None:
    good = gzip.decompress((folder / "random.json.gz").read_bytes())
    rng = np.random.default_rng(0)
    for _ in range(150):
        changed = bytearray(good)
        for place in rng.integers(len(good), size=int(rng.integers(1, 5))).tolist():
            changed[place] = int(rng.integers(256))
        file = tmp_path / "changed.json.gz"
        file.write_bytes(gzip.compress(bytes(changed), 1))
        try:
            submission = read_submission(file)
            submission.config_tree(where="x")
        except ConfigError:
            continue


def test_a_split_that_does_not_ship_is_never_a_path_of_the_file(folder: Path, tmp_path: Path) -> None:
    content = content_of(folder / "oracle.json.gz")
    for name in ("tiny", str(folder / "tiny"), "../../etc"):
        _split(name=name)(content)
        with pytest.raises(ConfigError, match="which does not ship; give its folder with --split"):
            checked(folder, written(tmp_path / "forged.json.gz", content), split=None)


def test_another_robot_or_camera_is_refused_unless_asked_for(folder: Path) -> None:
    with pytest.raises(ConfigError, match=r"not made with the standard .*: camera.width_px is 96, in the standard 640"):
        checked(folder, folder / "oracle.json.gz", nonstandard=False)


# Lies that only a replay finds


def _swapped(content: dict[str, Any]) -> None:
    first, second = content["episodes"][:2]
    for name in ("actions", "places_m"):
        first[name], second[name] = second[name], first[name]
    for each in (first, second):
        each["result"]["num_steps"] = len(each["actions"])


def _without_noise(content: dict[str, Any]) -> None:
    noise = content["config"]["config"]["noise"]
    noise["actuation"] = as_json(ActuationNoise())
    content["manifest"]["inputs"]["noise"] = "own"


def _turned(actions: str) -> str:
    return actions.replace("2", "3", 1) if "2" in actions else actions.replace("3", "2", 1)


LIES: dict[str, tuple[str, Edit, str]] = {
    "a success": ("random", _result(success=1.0, end_reason="stop"), "success 1, in the replay 0"),
    "a failure": ("oracle", _result(success=0.0), "success 0, in the replay 1"),
    "a higher SPL": ("oracle", _result(spl=0.999999, path_length=1.0), "spl"),
    "fewer collisions": ("random", _result(collisions=-1), "collisions -1"),
    "a shorter distance": ("random", _result(distance_to_goal=0.1), "distance_to_goal 0.1, in the replay"),
    "no shortest path": ("oracle", _result(shortest_path=None), "shortest_path None"),
    "another end": ("oracle", _result(end_reason="max_steps"), "end_reason max_steps, in the replay stop"),
    "other actions": ("oracle", _actions(_turned), "The replay leaves the recorded path before action"),
    "actions of another episode": ("oracle", _swapped, "in the replay"),
    "no STOP": ("oracle", _actions(lambda a: a[:-1], counted=True), "the episode has not ended after its"),
    "another robot": ("oracle", _tree("robot.drive", forward_m=0.2), "leaves the recorded path"),
    "another success rule": ("oracle", _tree("task.success", distance_m=0.3), "shortest_path"),
    "another seed": (
        "random",
        _all(_manifest(seed=5), _all_results(seed=5), _config(seed=5)),
        "leaves the recorded path|path_length",
    ),
    "noise that was there": ("random", _without_noise, "leaves the recorded path|path_length"),
}


@pytest.mark.parametrize("lie", LIES)
def test_a_replay_finds_a_lie(folder: Path, tmp_path: Path, lie: str) -> None:
    name, edit, sentence = LIES[lie]
    content = content_of(folder / f"{name}.json.gz")
    edit(content)
    content["episodes"] = content["episodes"][:2]
    first, *_ = judged(folder, written(tmp_path / "forged.json.gz", content))
    assert first.judgement == "different"
    assert re.search(sentence, first.text), first.text


def test_a_result_that_no_action_can_have_made_is_told_from_changed_actions(folder: Path, tmp_path: Path) -> None:
    content = content_of(folder / "oracle.json.gz")
    _result(spl=0.5)(content)
    first, second, third = judged(folder, written(tmp_path / "forged.json.gz", content))
    assert "The actions lead along the recorded path, so the result itself was changed" in first.text
    assert (second.judgement, third.judgement) == ("equal", "equal")


@pytest.mark.parametrize(
    ("off_m", "judgement"), [(1e-4, "within tolerance"), (0.008, "within tolerance"), (0.02, "different")]
)
def test_lengths_may_differ_by_the_tolerance(folder: Path, tmp_path: Path, off_m: float, judgement: str) -> None:
    content = content_of(folder / "random.json.gz")
    content["episodes"] = content["episodes"][:1]
    content["episodes"][0]["result"]["path_length"] += off_m
    (found,) = judged(folder, written(tmp_path / "near.json.gz", content))
    assert found.judgement == judgement
    assert found.largest == pytest.approx(off_m)


@pytest.mark.parametrize(
    "change", [{"gt_explored": False, "first_seen_step": None}, {"first_seen_step": 20}, {"area_seen_m2": 99.0}]
)
def test_what_was_seen_is_checked_where_frames_are_rendered(
    folder: Path, tmp_path: Path, change: dict[str, Any]
) -> None:
    content = content_of(folder / "oracle.json.gz")
    content["episodes"] = content["episodes"][:1]
    _result(**change)(content)
    file = written(tmp_path / "forged.json.gz", content)
    assert [each.judgement for each in judged(folder, file, frames=1.0)] == ["different"]
    assert [each.judgement for each in judged(folder, file, frames=0.0)] == ["equal"]


def test_an_episode_that_ended_with_an_error_is_a_failure_and_is_not_replayed(folder: Path, tmp_path: Path) -> None:
    content = content_of(folder / "random.json.gz")
    content["episodes"] = content["episodes"][:1]
    _all(_result(end_reason="error", success=0.0, spl=0.0, soft_spl=0.0), _actions(lambda a: ""))(content)
    assert [each.judgement for each in judged(folder, written(tmp_path / "e.json.gz", content))] == ["error"]


# The commands


def test_the_exit_status_says_whether_the_results_hold(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options: dict[str, Any] = {"split": folder / "tiny", "nonstandard": True, "draw_seed": 3}
    report = tmp_path / "report.json"
    assert verify.main(verify.Args(file=folder / "oracle.json.gz", report=report, **options)) == 0
    printed = capsys.readouterr().out
    for part in (
        "all 3 episodes of tiny",
        "3 equal",
        "Frames of 1",
        "an hour a core",
        "Verified: ",
        "proved by no replay",
    ):
        assert part in printed
    assert json.loads(report.read_text())["equal"] == 3
    content = content_of(folder / "oracle.json.gz")
    content["episodes"][1]["result"]["success"] = 0.0
    assert verify.main(verify.Args(file=written(tmp_path / "forged.json.gz", content), **options)) == 1
    assert "NOT VERIFIED: 1 episodes are different" in capsys.readouterr().out


def test_a_run_without_its_actions_is_refused_with_the_command_that_records(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder / "oracle", tmp_path / "run")
    shutil.rmtree(tmp_path / "run" / "trajectories")
    with pytest.raises(ConfigError, match=r"Record them: stubborn run --agent oracle .*--record --out .*run_recorded"):
        pack(read_run(tmp_path / "run"), About(name="x", authors=()))


def test_actions_of_another_run_are_not_packed(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder / "oracle", tmp_path / "run")
    shutil.copy(folder / "random" / "trajectories" / "tiny_0000.npz", tmp_path / "run" / "trajectories")
    with pytest.raises(ConfigError, match="is of another result than its line"):
        pack(read_run(tmp_path / "run"), About(name="x", authors=()))


@pytest.mark.parametrize(("field", "value"), [("house", "a.xml"), ("physics", 0)])
def test_a_run_that_cannot_be_replayed_is_not_packed(folder: Path, field: str, value: Any) -> None:
    run = read_run(folder / "oracle")
    with pytest.raises(ConfigError, match=r"a submission needs a split|physics of version 0"):
        pack(replace(run, config={**run.config, field: value}), About(name="x", authors=()))


def test_the_leaderboard_has_the_rows_that_hold(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sim.submissions.setting.Setting.changes", lambda setting: [])  # the images are small
    (tmp_path / "submissions").mkdir()
    content = content_of(folder / "random.json.gz")
    content["manifest"] |= {"name": "Our <b>agent</b> [x](y) | z", "authors": ["A. *Author*"]}
    written(tmp_path / "submissions" / "good.json.gz", content)
    content["episodes"][0]["result"]["success"] = 1.0
    written(tmp_path / "submissions" / "forged.json.gz", content)
    content = content_of(folder / "oracle.json.gz")
    content["episodes"] = content["episodes"][1:]
    written(tmp_path / "submissions" / "chosen.json.gz", content)
    (tmp_path / "submissions" / "broken.json.gz").write_bytes(b"x")
    args = leaderboard.Args(folder=tmp_path, splits=(folder / "tiny",))
    assert leaderboard.main(args) == 1
    printed = capsys.readouterr().out
    for part in (
        "forged.json.gz: 1 episodes are different", "chosen.json.gz: its episodes were chosen by the authors",
        "broken.json.gz: Submission ",
    ):  # fmt: skip
        assert f"Left out: {part}" in printed
    table = (tmp_path / "table.md").read_text()
    assert r"Our &lt;b&gt;agent&lt;/b&gt; \[x\]\(y\)" in table
    assert "| equal |" in table
    assert len([line for line in table.splitlines() if line.startswith("| ")]) == 3
    assert "success" in (tmp_path / "table.csv").read_text()
    monkeypatch.setattr(leaderboard, "verify", lambda file, choices: pytest.fail("a current report was made again"))
    for name in ("forged", "chosen", "broken"):
        (tmp_path / "submissions" / f"{name}.json.gz").unlink()
    assert leaderboard.main(args) == 0
