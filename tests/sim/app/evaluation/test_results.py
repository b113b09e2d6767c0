"""The files of a run survive a kill, and refuse to mix runs."""

from __future__ import annotations

import contextlib
import json
import math
import os
import re
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, cast

import pytest

from sim.app.evaluation.results import RunDirectory, RunRecord, read_results, segmentation_of
from sim.app.evaluation.summary import summarise
from sim.core.interface import ConfigError
from sim.task.result import METRICS, EpisodeResult
from tests.helpers.results import ENTRIES, a_result

CONFIG = {"agent": "stubborn", "episodes": 5, "workers": 1}


def entries(number: int, **changes: object) -> dict[str, object]:
    base = {"episode_id": f"e{number}", "house": f"h{number % 2}", "distance_to_goal": 0.1, "collisions": 3}
    return ENTRIES | base | changes


def line(number: int, **changes: object) -> EpisodeResult:
    return a_result(**entries(number, **changes))


def opened(folder: Path, config: Mapping[str, object]) -> RunDirectory[EpisodeResult]:
    return RunDirectory(folder, config, EpisodeResult)


def test_the_time_to_first_sight_counts_episodes_that_never_saw_the_goal_with_the_limit() -> None:
    seen = {"gt_explored": True, "first_seen_step": 20, "steps_to_first_sight": 20, "area_per_metre": 4.0}
    never = {"gt_explored": False, "first_seen_step": None, "steps_to_first_sight": 500, "area_per_metre": 2.0}
    summary = summarise([line(0, **seen), line(1, **seen), line(2, **never), line(3, **seen)])
    assert summary["steps_to_first_sight"]["mean"] == 140.0
    assert summary["never_seen"]["mean"] == 0.25
    assert summary["never_seen"]["mean"] == 1.0 - summary["gt_explored"]["mean"]
    assert summary["area_per_metre"]["mean"] == 3.5
    low, high = summary["steps_to_first_sight"]["ci95"]
    assert low < 140.0 < high


def test_a_run_that_was_killed_while_writing_a_line_goes_on_without_that_line(tmp_path: Path) -> None:
    run = opened(tmp_path, CONFIG)
    run.append(line(1))
    run.append(line(2))
    run.close()
    whole = (tmp_path / "results.jsonl").read_text()
    (tmp_path / "results.jsonl").write_text(whole[:-10])
    again = opened(tmp_path, CONFIG)
    assert [result.episode_id for result in again.lines] == ["e1"]
    assert "line 2 was dropped" in again.healed
    again.append(line(2))
    again.close()
    assert (tmp_path / "results.jsonl").read_text() == whole


def test_other_options_in_the_same_folder_are_refused_and_named(tmp_path: Path) -> None:
    opened(tmp_path, CONFIG).close()
    with pytest.raises(ConfigError, match=r'"stubborn".*"oracle"'):
        opened(tmp_path, CONFIG | {"agent": "oracle"})


@pytest.mark.parametrize("change", [{"workers": 2}, {"record": True}, {"explorer": None}])
def test_options_that_change_no_line_may_change_when_a_run_goes_on(change: dict[str, object], tmp_path: Path) -> None:
    opened(tmp_path, CONFIG).close()
    opened(tmp_path, CONFIG | change).close()


def test_a_run_continues_to_more_episodes_and_says_so(tmp_path: Path) -> None:
    for episodes in (5, 8, 6):
        opened(tmp_path, CONFIG | {"episodes": episodes}).close()
    assert json.loads((tmp_path / "config.json").read_text())["episodes"] == 8


def test_every_code_that_ran_in_a_folder_is_recorded(tmp_path: Path) -> None:
    codes = (("a1", []), ("a1", []), ("b2", ["a1"]), ("b2", ["a1"]), ("c3", ["a1", "b2"]))
    for number, (code, others) in enumerate(codes):
        run = opened(tmp_path, CONFIG | {"versions": {"code": code}})
        assert run.record_code(code) == others
        run.append(line(number))
        run.close()
    written = json.loads((tmp_path / "config.json").read_text())
    assert written["codes"] == ["a1", "b2", "c3"]
    assert written["versions"] == {"code": "a1"}


def test_runs_without_a_list_of_codes_name_their_code_and_code_that_ran_nothing_is_not_named(tmp_path: Path) -> None:
    opened(tmp_path, CONFIG | {"versions": {"code": "a1"}}).close()
    run = opened(tmp_path, CONFIG | {"versions": {"code": "b2"}})
    assert run.record_code("b2") == []
    run.append(line(1))
    run.close()
    config = json.loads((tmp_path / "config.json").read_text())
    assert config.pop("codes") == ["b2"]
    (tmp_path / "config.json").write_text(json.dumps(config))
    again = opened(tmp_path, CONFIG | {"versions": {"code": "b2"}})
    assert again.record_code("b2") == ["a1"]  # the code that created the folder, if there is no list
    again.close()


def test_two_writers_in_one_folder_are_refused(tmp_path: Path) -> None:
    run = opened(tmp_path, CONFIG)
    with pytest.raises(ConfigError, match="Another process") as refused:
        opened(tmp_path, CONFIG)
    locks = [link for link in Path("/proc/self/fd").iterdir() if os.path.realpath(link) == str(tmp_path / ".lock")]
    assert (len(locks), refused.type) == (1, ConfigError)  # the file of the one that was refused is closed
    run.close()


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match="Cannot write to --out"):
        opened(tmp_path / "file" / "run", CONFIG)


def test_null_metrics_do_not_count_in_the_mean() -> None:
    summary = summarise([line(1, distance_to_goal=None), line(2, distance_to_goal=2.0)])
    assert summary["distance_to_goal"]["mean"] == 2.0
    assert summary["episodes"] == 2


def test_an_episode_with_an_error_is_a_failure_and_counts_in_no_other_mean() -> None:
    broken = line(0, end_reason="error", success=0.0, spl=0.0, soft_spl=0.0, collisions=0, steps_to_first_sight=500)
    summary = summarise([broken, line(1, collisions=7, steps_to_first_sight=30)])
    assert summary["success"]["mean"] == 0.5
    assert summary["collisions"]["mean"] == 7.0
    assert summary["steps_to_first_sight"]["mean"] == 30.0


def test_a_summary_counts_the_causes_of_failure() -> None:
    failed = [line(n, failure=cause) for n, cause in enumerate(["explore", "trapped", "trapped", None])]
    assert summarise(failed)["failures"] == {"trapped": 2, "explore": 1}


def test_a_summary_of_nothing_is_valid_json() -> None:
    assert json.loads(json.dumps(summarise([]), allow_nan=False))["success"] == {"mean": None, "ci95": [None, None]}


def test_a_summary_states_over_what_its_intervals_are() -> None:
    two_houses, one_house = summarise([line(1), line(2)]), summarise([line(1), line(3)])
    assert (two_houses["houses"], two_houses["ci95_over"]) == (2, "houses")
    assert (one_house["houses"], one_house["ci95_over"]) == (1, "the episodes of the one house")


def test_the_intervals_of_a_summary_are_over_houses() -> None:
    alike = [line(n, house=f"h{n // 10}", success=float(n // 10 % 2)) for n in range(80)]
    low, high = summarise(alike)["success"]["ci95"]
    assert (low, high) == pytest.approx(
        (0.167, 0.833), abs=0.001
    )  # Wilson with Student's t: 7 effective episodes, not 80


def test_a_summary_has_the_means_of_each_replicate_and_their_spread() -> None:
    lines = [
        line(0, success=s, spl=s, episode_id=f"val_0000{mark}") for mark, s in (("", 1.0), ("~1", 0.0), ("~2", 1.0))
    ]
    summary = summarise(lines)
    assert (summary["episodes"], summary["success"]["mean"]) == (1, pytest.approx(2 / 3))
    assert summary["replicates"]["success"]["means"] == [1.0, 0.0, 1.0]
    assert summary["replicates"]["success"]["std"] == pytest.approx(math.sqrt(1 / 3))
    assert "replicates" not in summarise(lines[:1])


def test_a_field_inside_the_configuration_that_differs_is_named(tmp_path: Path) -> None:
    nested = {"config": {"robot": {"radius_m": 0.18}, "camera": {}}}
    opened(tmp_path, CONFIG | nested).close()
    with pytest.raises(ConfigError, match=r"config\.robot\.radius_m.*0.18.*0.2"):
        opened(tmp_path, CONFIG | {"config": {"robot": {"radius_m": 0.2}, "camera": {}}})


def test_a_run_goes_on_with_the_same_weights_in_another_folder_and_not_with_others(tmp_path: Path) -> None:
    def config(folder: str, checksum: str) -> dict:
        return CONFIG | {
            "weights": f"{folder}/net",
            "config": {"detector": {"weights": f"{folder}/net"}, "agent": {"explorer": {"weights": f"{folder}/plan"}}},
            "files_sha256": {"weights": checksum, "agent.explorer.weights": "b"},
        }

    opened(tmp_path, config("/here", "a")).close()
    opened(tmp_path, config("/there", "a")).close()
    with pytest.raises(ConfigError, match="weights"):
        opened(tmp_path, config("/there", "c"))


def test_the_config_names_the_episodes_of_all_starts(tmp_path: Path) -> None:
    def named(*only: str) -> list[str]:
        opened(tmp_path, CONFIG | {"only": list(only)}).close()
        return json.loads((tmp_path / "config.json").read_text())["only"]

    assert named("e1") == ["e1"]
    assert named("e0") == ["e0", "e1"]
    assert named("e1") == ["e0", "e1"]
    assert named() == []  # the first N


def write_lines(folder: Path, *lines: Mapping[str, object] | str) -> None:
    """Starts a run whose file of results has these lines."""
    opened(folder, CONFIG | {"seed": 0}).close()
    text = "".join((line if isinstance(line, str) else json.dumps(line)) + "\n" for line in lines)
    (folder / "results.jsonl").write_text(text)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([entries(1), entries(1)], "line 2: episode 'e1' has the same result in line 1"),
        ([entries(1), entries(2), entries(1, success=0.0)], "line 3: episode 'e1' has another result in line 1"),
        ([entries(1, seed=7)], "line 1: seed is 7, but this run has 0"),
        ([entries(1, agent="oracle")], 'line 1: agent is "oracle", but this run has "stubborn"'),
        ([entries(1), "\0\0\0"], "line 2 is empty"),
        ([entries(1, success="yes")], "line 1, field 'success': expected"),
        ([entries(1, success=2.0)], "line 1, field 'success'"),
        ([entries(1, spl=[1.0])], "field 'spl'"),
        ([entries(1, stop_target_xy_m=[1.0])], "field 'stop_target_xy_m'"),
        ([entries(1, stop_target_to_goal_m="near")], "field 'stop_target_to_goal_m'"),
        ([entries(1, end_reason="tired")], "field 'end_reason': invalid enum value 'tired'"),
        ([{"episode_id": "e1"}], "line 1: object missing required field"),
        (['{"spl": NaN}'], "line 1 is not JSON"),
    ],
)
def test_lines_that_are_not_of_this_run_are_refused_by_number_and_field(
    lines: list, message: str, tmp_path: Path
) -> None:
    write_lines(tmp_path, *lines)
    with pytest.raises(ConfigError, match=re.escape(message)):
        opened(tmp_path, CONFIG | {"seed": 0})
    (tmp_path / "results.jsonl").write_text("")
    opened(tmp_path, CONFIG | {"seed": 0}).close()  # it is not locked


@pytest.mark.parametrize(
    ("episodes", "message"),
    [
        ({"e1": ("h1", "bed")}, None),
        ({"e2": ("h1", "bed")}, r"1.*'e1'"),
        ({"e1": ("h9", "bed")}, "line 1: house is 'h1', but 'h9'"),
        ({"e1": ("h1", "sofa")}, "line 1: goal is 'bed', but 'sofa'"),
    ],
)
def test_lines_of_another_split_are_refused(episodes: dict, message: str | None, tmp_path: Path) -> None:
    write_lines(tmp_path, entries(1))
    run = opened(tmp_path, CONFIG | {"seed": 0})
    with contextlib.nullcontext() if message is None else pytest.raises(ConfigError, match=message):
        run.require_of(episodes)
    run.close()


def test_results_of_an_older_format_are_refused_with_the_version_that_reads_them(tmp_path: Path) -> None:
    older = entries(1)
    del older["steps_to_first_sight"]
    write_lines(tmp_path, older)
    with pytest.raises(ConfigError, match=r"steps_to_first_sight.*0\.2"):
        read_results(tmp_path / "results.jsonl")


def test_every_metric_has_its_mean_in_the_summary_and_a_field_of_the_result(tmp_path: Path) -> None:
    summary = summarise([line(1), line(2)])
    in_summary = {key for key, metric in METRICS.items() if metric.in_summary}
    assert in_summary & set(summary) == {key for key in in_summary if not METRICS[key].chains}
    assert {metric.field for metric in METRICS.values()} <= set(EpisodeResult.__struct_fields__)
    assert list(line(1).as_json())[:3] == ["episode_id", "house", "goal"]


@pytest.mark.parametrize("content", ["", "{", "[]", '{"seed": "0"}', '{"versions": {"code": 5}}', "\0" * 20])
def test_a_broken_config_is_refused_with_its_name(content: str, tmp_path: Path) -> None:
    opened(tmp_path, CONFIG).close()
    (tmp_path / "config.json").write_text(content)
    with pytest.raises(ConfigError, match=r"config\.json"):
        opened(tmp_path, CONFIG)


def test_a_start_that_wrote_nothing_leaves_no_folder_and_one_that_did_stays(tmp_path: Path) -> None:
    run = opened(tmp_path / "run", CONFIG)
    run.write_summary({})
    run.discard_if_empty()
    run.close()
    assert not (tmp_path / "run").exists()
    run = opened(tmp_path / "run", CONFIG)
    run.append(line(1))
    run.discard_if_empty()
    run.close()
    again = opened(tmp_path / "run", CONFIG)
    again.discard_if_empty()  # it did not begin this run
    again.close()
    assert (tmp_path / "run" / "config.json").exists()


def test_an_error_stays_until_the_line_of_its_next_run_replaces_it(tmp_path: Path) -> None:
    run = opened(tmp_path, CONFIG)
    for number, reason in enumerate(("stop", "error", "error")):
        run.append(line(number, end_reason=reason))
    assert run.errors(["e1", "e0"]) == {"e1"}
    assert len(read_results(tmp_path / "results.jsonl").values) == 3
    run.append(line(1, spl=0.25))
    run.append(line(3))
    run.write_summary({})
    run.close()
    results = read_results(tmp_path / "results.jsonl").values
    assert [(result.episode_id, result.end_reason) for result in results] == [
        ("e0", "stop"), ("e1", "stop"), ("e2", "error"), ("e3", "stop"),
    ]  # fmt: skip


def _remove(folder: Path) -> None:
    shutil.rmtree(folder)


def _truncate(folder: Path) -> None:
    (folder / "results.jsonl").write_text("")


def _replace(folder: Path) -> None:
    content = (folder / "results.jsonl").read_text()
    (folder / "results.jsonl").unlink()
    (folder / "results.jsonl").write_text(content)


def _overwrite(folder: Path) -> None:
    content = (folder / "results.jsonl").read_text()
    (folder / "results.jsonl").write_text(content.replace("0.5", "0.9"))


@pytest.mark.parametrize("change", [_remove, _truncate, _replace, _overwrite])
def test_results_that_another_program_removes_or_changes_end_the_run_with_what_is_lost(
    change: Callable[[Path], None], tmp_path: Path
) -> None:
    run = opened(tmp_path / "run", CONFIG)
    run.append(line(1))
    change(tmp_path / "run")
    lost = r"another program.*The results of \d episodes.*'e1'"
    if change is not _replace:  # until a line is written, the same content is there
        with pytest.raises(ConfigError, match=lost):
            run.write_summary({})
    if change is not _overwrite:  # the size is the same until the run ends
        with pytest.raises(ConfigError, match=lost):
            run.append(line(2))
    run.discard_if_empty()
    run.close()


def test_the_config_is_on_the_disk_before_the_first_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[str] = []
    monkeypatch.setattr(os, "fsync", lambda handle: synced.append(os.readlink(f"/proc/self/fd/{handle}")))
    run = opened(tmp_path / "run", CONFIG)
    assert [Path(file).name[:12] for file in synced] == [".config.json", "run"]
    run.append(line(1))
    run.close()
    assert Path(synced[-1]).name == "results.jsonl"


def test_a_change_of_the_users_code_is_refused_with_two_ways_out(tmp_path: Path) -> None:
    run = opened(tmp_path, CONFIG | {"versions": {"code": "a+1"}})
    run.append(line(1))
    run.require_own_code("a+1", {"e1"})
    run.require_own_code("b+1", {"e1"})  # this project's code has changed, not the user's
    run.require_own_code("a+2", set())  # nothing of the earlier code is kept
    with pytest.raises(ConfigError, match=r"1.*--out.*--keep-results"):
        run.require_own_code("a+2", {"e1"})
    run.close()


def test_a_seed_of_any_size_is_read_back(tmp_path: Path) -> None:
    write_lines(tmp_path, entries(1, seed=2**63 - 1))
    assert read_results(tmp_path / "results.jsonl").values[0].seed == 2**63 - 1


def test_a_run_resumed_with_another_library_names_it(tmp_path: Path) -> None:
    opened(tmp_path, CONFIG | {"versions": {"mujoco": "4.0.0", "numpy": "2.4.6", "code": "a"}}).close()
    run = opened(tmp_path, CONFIG | {"versions": {"mujoco": "4.1.0", "numpy": "2.4.6", "code": "b"}})
    assert run.other_versions() == {"mujoco": ("4.0.0", "4.1.0")}
    run.close()


def test_a_run_of_other_physics_is_not_resumed(tmp_path):
    opened(tmp_path / "run", {"agent": "oracle"}).close()  # the first version wrote no number
    with pytest.raises(ConfigError, match=r"1.*2.*choose") as error:
        opened(tmp_path / "run", {"agent": "oracle", "physics": 2})
    assert "\n" not in str(error.value)


SEGMENTATIONS = {
    "none": {"segmentation": {"name": None}},
    "rednet, shipped weights (01234567)": {"segmentation": {"name": "rednet"}},
    "rednet, mine.safetensors (01234567)": {"segmentation": {"name": "rednet"}, "weights": "mine.safetensors"},
    "rednet, set.safetensors (01234567)": {
        "segmentation": {"name": "rednet"}, "settings": {"detector.weights": "set.safetensors"}
    },
    "the agent's network": {"segmentation": {"name": "the agent's network"}},
    "ground truth": {"segmentation": {"name": "ground truth"}, "semantics": "gt", "files_sha256": {}},
    "rednet": {},
    "unknown": {"semantics": None},
}  # fmt: skip
"""Entries of a `config.json` by the text that names its segmentation; the last two are of older versions."""


@pytest.mark.parametrize("text", SEGMENTATIONS)
def test_a_run_names_the_segmentation_that_acted_and_its_weights(text: str) -> None:
    record: Any = {"semantics": "rednet", "weights": None, "files_sha256": {"weights": "0123456789"}}
    assert segmentation_of(record | SEGMENTATIONS[text]) == text


def test_the_segmentation_of_a_foreign_record_is_one_line_without_escapes() -> None:
    for record in ({"segmentation": {"name": "a\x1b[2J\nb"}}, {"semantics": "a\x1b[2J\nb"}):
        text = segmentation_of(cast(RunRecord, record))
        assert text.isprintable()
        assert text.endswith(" b")
