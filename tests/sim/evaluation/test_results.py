"""The files of a run survive a kill, and refuse to mix runs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sim.evaluation.results import RunDirectory, bootstrap_interval, summarise
from sim.interface import ConfigError

CONFIG = {"agent": "stubborn", "episodes": 5, "workers": 1}


def line(number: int, **metrics: object) -> dict:
    base = {"episode_id": f"e{number}", "success": 1.0, "spl": 0.5, "soft_spl": 0.5, "distance_to_goal": 0.1}
    return base | {"gt_explored": 1.0, "trapped": 0.0, "collisions": 3, "end_reason": "stop"} | metrics


def test_a_run_that_was_killed_while_writing_a_line_goes_on_without_that_line(tmp_path: Path) -> None:
    run = RunDirectory(tmp_path, CONFIG)
    run.append(line(1))
    run.append(line(2))
    run.close()
    whole = (tmp_path / "results.jsonl").read_text()
    (tmp_path / "results.jsonl").write_text(whole[:-10])
    again = RunDirectory(tmp_path, CONFIG)
    assert [there["episode_id"] for there in again.lines] == ["e1"]
    again.append(line(2))
    again.close()
    assert (tmp_path / "results.jsonl").read_text() == whole


def test_other_options_in_the_same_folder_are_refused_and_named(tmp_path: Path) -> None:
    RunDirectory(tmp_path, CONFIG).close()
    with pytest.raises(ConfigError, match=r'agent = "stubborn", this one has "oracle"'):
        RunDirectory(tmp_path, CONFIG | {"agent": "oracle"})


def test_the_number_of_workers_may_change_when_a_run_goes_on(tmp_path: Path) -> None:
    RunDirectory(tmp_path, CONFIG).close()
    RunDirectory(tmp_path, CONFIG | {"workers": 2}).close()


def test_a_run_goes_on_to_more_episodes_and_says_so(tmp_path: Path) -> None:
    for episodes in (5, 8, 6):
        RunDirectory(tmp_path, CONFIG | {"episodes": episodes}).close()
    assert json.loads((tmp_path / "config.json").read_text())["episodes"] == 8


def test_a_run_from_before_trajectories_can_go_on_with_them(tmp_path: Path) -> None:
    RunDirectory(tmp_path, CONFIG).close()
    RunDirectory(tmp_path, CONFIG | {"record": True}).close()


def test_every_code_that_played_in_a_folder_is_written_down(tmp_path: Path) -> None:
    for code, others in (("a1", []), ("a1", []), ("b2", ["a1"]), ("b2", ["a1"]), ("c3", ["a1", "b2"])):
        run = RunDirectory(tmp_path, CONFIG | {"versions": {"code": code}})
        assert run.played_by(code) == others
        run.append(line(1))
        run.close()
    written = json.loads((tmp_path / "config.json").read_text())
    assert written["codes"] == ["a1", "b2", "c3"]
    assert written["versions"] == {"code": "a1"}


def test_code_that_played_before_codes_were_listed_is_known_and_code_that_played_nothing_is_not(tmp_path: Path) -> None:
    RunDirectory(tmp_path, CONFIG | {"versions": {"code": "a1"}}).close()
    run = RunDirectory(tmp_path, CONFIG | {"versions": {"code": "b2"}})
    assert run.played_by("b2") == []
    run.append(line(1))
    run.close()
    config = json.loads((tmp_path / "config.json").read_text())
    assert config.pop("codes") == ["b2"]
    (tmp_path / "config.json").write_text(json.dumps(config))
    again = RunDirectory(tmp_path, CONFIG | {"versions": {"code": "b2"}})
    assert again.played_by("b2") == ["a1"]  # what the folder was begun with, where nothing better is known
    again.close()


def test_two_writers_in_one_folder_are_refused(tmp_path: Path) -> None:
    run = RunDirectory(tmp_path, CONFIG)
    with pytest.raises(ConfigError, match="Another process"):
        RunDirectory(tmp_path, CONFIG)
    run.close()


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match="Cannot write to --out"):
        RunDirectory(tmp_path / "file" / "run", CONFIG)


def test_null_metrics_do_not_count_in_the_mean() -> None:
    summary = summarise([line(1, distance_to_goal=None), line(2, distance_to_goal=2.0)])
    assert summary["distance_to_goal"]["mean"] == 2.0
    assert summary["episodes"] == 2


def test_a_summary_counts_the_causes_of_failure() -> None:
    failed = [line(n, failure=cause) for n, cause in enumerate(["explore", "trapped", "trapped", None])]
    assert summarise(failed)["failures"] == {"trapped": 2, "explore": 1}


def test_a_summary_of_nothing_is_valid_json() -> None:
    assert json.loads(json.dumps(summarise([]), allow_nan=False))["success"] == {"mean": None, "ci95": [None, None]}


def test_the_interval_does_not_depend_on_the_order_of_episodes() -> None:
    values = np.random.default_rng(0).random(40)
    assert bootstrap_interval(values) == bootstrap_interval(values[::-1])


def test_the_interval_of_a_fair_coin_is_near_the_normal_one() -> None:
    low, high = bootstrap_interval(np.repeat([0.0, 1.0], 200))
    assert low == pytest.approx(0.5 - 1.96 * 0.025, abs=0.006)
    assert high == pytest.approx(0.5 + 1.96 * 0.025, abs=0.006)
