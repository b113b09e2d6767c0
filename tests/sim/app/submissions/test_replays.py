"""Recorded runs are verified equal, and what no check can see a replay finds."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sim.app.analysis.comparison import read_run
from sim.app.commands import submit
from sim.app.submissions import replay
from sim.app.submissions.contents import read_submission
from sim.app.submissions.packing import About, pack
from sim.core.configuration import as_json
from sim.core.errors import HouseError, RenderError
from sim.sensors.actuation_noise import ActuationNoise
from tests.helpers.submissions import (
    RUNS,
    Edit,
    checked,
    content_of,
    in_actions,
    in_all_results,
    in_config,
    in_first_result,
    in_manifest,
    in_tree,
    judged,
    recorded,
    together,
    written,
)


@pytest.mark.costly
@pytest.mark.parametrize("name", RUNS)
def test_a_recorded_run_is_verified_equal_with_its_frames(folder: Path, name: str) -> None:
    verdicts = judged(folder, folder / f"{name}.json.gz", frames=1.0)
    assert [(verdict.judgement, verdict.framed, verdict.text) for verdict in verdicts] == [("equal", True, "")] * 3
    assert {entry.result.end_reason for entry in read_submission(folder / f"{name}.json.gz").episodes} <= {
        "stop", "max_steps",
    }  # fmt: skip


@pytest.mark.costly
@pytest.mark.parametrize(("name", "known"), [("oracle", "oracle"), ("random", ""), ("process", "")])
def test_actions_of_the_oracle_are_known(folder: Path, name: str, known: str) -> None:
    verdicts = judged(folder, folder / f"{name}.json.gz")
    assert [verdict.known_path for verdict in verdicts] == [known] * 3


@pytest.mark.costly
def test_replicates_are_verified_equal_and_cover_the_split(folder: Path, tmp_path: Path) -> None:
    run = recorded(folder / "tiny", tmp_path / "run", "oracle", "--replicates", "2", "--seed-key", "key")
    assert submit.main(submit.Args(run=run, name="Replicates", authors=("A. Author",))) == 0
    file = run.with_name("run.json.gz")
    assert [verdict.judgement for verdict in judged(folder, file)] == ["equal"] * 6
    assert checked(folder, file)[0].covers == "all 3 episodes, 2 replicates of each"
    content = content_of(file)
    content["episodes"].pop(0)
    assert not checked(folder, written(file, content))[0].is_first


def test_the_runs_have_successes_failures_and_collisions(folder: Path) -> None:
    """Else equal numbers would say little."""
    results = [entry.result for name in RUNS for entry in read_submission(folder / f"{name}.json.gz").episodes]
    assert {bool(result.success) for result in results} == {True, False}
    assert sum(float(result.collisions or 0) for result in results) > 0


def test_a_submission_is_small_and_names_no_folder_of_the_user(folder: Path) -> None:
    file = folder / "random.json.gz"
    assert file.stat().st_size < 6_000
    assert str(folder) not in json.dumps(content_of(file)["manifest"])
    assert "out" not in content_of(file)["config"]
    run = read_run(folder / "random")
    tree = run.config["config"] | {"detector": {"weights": "/home/me/mine.safetensors"}}
    packed = pack(replace(run, config={**run.config, "config": tree}), About(name="x", authors=()))
    assert b'"detector": {"weights": "mine.safetensors"}' in bytes(packed.config)


def _swapped(content: dict[str, Any]) -> None:
    first, second = content["episodes"][:2]
    for name in ("actions", "places_m"):
        first[name], second[name] = second[name], first[name]
    for episode in (first, second):
        episode["result"]["num_steps"] = len(episode["actions"])


def _without_noise(content: dict[str, Any]) -> None:
    noise = content["config"]["config"]["noise"]
    noise["actuation"] = as_json(ActuationNoise())
    content["manifest"]["inputs"]["noise"] = "own"


def _claimed(content: dict[str, Any]) -> None:
    """Makes the first episode a success that does not contradict itself."""
    first = content["episodes"][0]
    result, first["actions"] = first["result"], first["actions"][:-1] + "0"
    share = result["shortest_path"] / max(result["shortest_path"], result["path_length"])
    result.update(success=1.0, spl=share, end_reason="stop", failure=None)


def _shorter(content: dict[str, Any]) -> None:
    """Makes the path of the first episode the shortest one."""
    result = content["episodes"][0]["result"]
    result.update(spl=1.0, path_length=result["shortest_path"])


def _turned(actions: str) -> str:
    return actions.replace("2", "3", 1) if "2" in actions else actions.replace("3", "2", 1)


LIES: dict[str, tuple[str, Edit, str]] = {
    "a success": ("random", _claimed, "success 1, in the replay 0"),
    "a failure": ("oracle", in_first_result(success=0.0, spl=0.0, failure="misc"), "success 0, in the replay 1"),
    "a higher SPL": ("oracle", _shorter, "spl 1"),
    "fewer collisions": ("random", in_first_result(collisions=999), "collisions 999"),
    "a shorter distance": ("random", in_first_result(distance_to_goal=0.1), "distance_to_goal 0.1, in the replay"),
    "no shortest path": ("oracle", in_first_result(shortest_path=None, spl=0.0), "shortest_path None"),
    "other actions": ("oracle", in_actions(_turned), "The replay leaves the recorded path before action"),
    "actions of another episode": ("oracle", _swapped, "in the replay"),
    "no STOP": ("random", in_actions(lambda a: a[:-2], counted=True), "the episode has not ended after its"),
    "another robot": ("oracle", in_tree("robot.drive", forward_m=0.2), "leaves the recorded path"),
    "another success rule": ("oracle", in_tree("task.success", distance_m=0.3), "shortest_path"),
    "another seed": (
        "random",
        together(in_manifest(seed=5), in_all_results(seed=5), in_config(seed=5)),
        "leaves the recorded path|path_length",
    ),
    "noise that was there": ("random", _without_noise, "leaves the recorded path|path_length"),
}


@pytest.mark.costly
@pytest.mark.parametrize("lie", LIES)
def test_a_replay_finds_a_lie(folder: Path, tmp_path: Path, lie: str) -> None:
    name, edit, sentence = LIES[lie]
    content = content_of(folder / f"{name}.json.gz")
    edit(content)
    content["episodes"] = content["episodes"][:2]
    first, *_ = judged(folder, written(tmp_path / "forged.json.gz", content))
    assert first.judgement == "different"
    assert re.search(sentence, first.text), first.text


@pytest.mark.parametrize("error", [RenderError("OpenGL is not available here."), HouseError("House 'x' is missing.")])
def test_a_fault_of_this_machine_is_no_verdict_on_the_authors(
    folder: Path, error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(replay, "_scene", fails)
    with pytest.raises(type(error), match=str(error)):
        judged(folder, folder / "oracle.json.gz")


def test_a_result_that_no_action_can_have_made_is_told_from_changed_actions(folder: Path, tmp_path: Path) -> None:
    content = content_of(folder / "oracle.json.gz")
    in_first_result(soft_spl=0.5)(content)
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
    (verdict,) = judged(folder, written(tmp_path / "near.json.gz", content))
    assert verdict.judgement == judgement


@pytest.mark.parametrize(
    "change", [{"gt_explored": False, "first_seen_step": None}, {"first_seen_step": 20}, {"area_seen_m2": 99.0}]
)
def test_what_was_seen_is_checked_where_frames_are_rendered(
    folder: Path, tmp_path: Path, change: dict[str, Any]
) -> None:
    content = content_of(folder / "oracle.json.gz")
    content["episodes"] = content["episodes"][:1]
    in_first_result(**change)(content)
    file = written(tmp_path / "forged.json.gz", content)
    assert [verdict.judgement for verdict in judged(folder, file, frames=1.0)] == ["different"]
    assert [verdict.judgement for verdict in judged(folder, file, frames=0.0)] == ["equal"]


def test_an_episode_that_ended_with_an_error_is_a_failure_and_is_not_replayed(folder: Path, tmp_path: Path) -> None:
    content = content_of(folder / "random.json.gz")
    content["episodes"] = content["episodes"][:1]
    together(in_first_result(end_reason="error", success=0.0, spl=0.0, soft_spl=0.0), in_actions(lambda a: ""))(content)
    content["episodes"][0]["places_m"] = []
    assert [verdict.judgement for verdict in judged(folder, written(tmp_path / "e.json.gz", content))] == ["error"]
