"""Shards of a run are merged into one run."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from sim.app.analysis.comparison import read_run
from sim.app.commands import run
from sim.app.commands.merge import Args, main
from sim.app.composition.setup import resolve
from sim.app.evaluation.results import RunDirectory
from sim.app.options import RunOptions
from sim.core.interface import ConfigError
from sim.task.result import EpisodeResult
from tests.helpers import wording
from tests.helpers.results import a_result, lines_of
from tests.helpers.worlds import room, with_box

CONFIG = {"agent": "random", "seed": 0, "episodes": 4, "split_identity": {"name": "tiny"}, "versions": {"code": "c0de"}}


def line_of(episode: int, **changes: Any) -> EpisodeResult:
    return a_result(episode_id=f"e{episode}", agent="random", **changes)


def write(folder: Path, lines: Iterable[EpisodeResult], **changes: Any) -> Path:
    written = RunDirectory(folder, {**CONFIG, **changes}, EpisodeResult)
    for line in lines:
        written.append(line)
    written.close()
    return folder


@pytest.mark.costly
def test_merged_shards_are_the_run_of_one_process(tmp_path: Path) -> None:
    furnished = with_box(room(6, 6), "sofa_00", centre_m=(2.5, 0, 0.4), half_m=(0.4, 0.8, 0.4))
    (tmp_path / "sofa_room.xml").write_text(furnished.spec.to_xml())
    command = ["--agent", "oracle", "--house", str(tmp_path / "sofa_room.xml"), "--episodes", "3", "--record"]
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    assert run.entry([*command, "--out", str(whole)]) == 0
    for i in (1, 2):
        assert run.entry([*command, "--out", str(parts), "--shard", f"{i}/2"]) == 0
    assert [len(lines_of(parts / f"shard_{i}_of_2")) for i in (1, 2)] == [2, 1]
    assert main(Args(runs=(parts,))) == 0
    assert lines_of(parts) == lines_of(whole)
    assert [file.name for file in sorted((parts / "trajectories").iterdir())] == [
        file.name for file in sorted((whole / "trajectories").iterdir())
    ]
    summaries = [json.loads((folder / "summary.json").read_text()) for folder in (parts, whole)]
    assert summaries[0] == summaries[1]
    assert run.entry([*command, "--out", str(parts)]) == 0  # the merged folder is a run that can be resumed


def test_missing_episodes_are_reported_and_added_later(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path / "shard_0_of_2", [line_of(0), line_of(2)])
    write(tmp_path / "shard_1_of_2", [line_of(1)])
    assert main(Args(runs=(tmp_path,))) == 1
    assert "3 episodes of 2 runs, 1 missing" in capsys.readouterr().out
    write(tmp_path / "shard_1_of_2", [line_of(3)])
    assert main(Args(runs=(tmp_path,))) == 0
    assert [line["episode_id"] for line in lines_of(tmp_path)] == ["e0", "e1", "e2", "e3"]


def test_an_episode_in_two_runs_counts_once_if_they_agree_but_for_the_times(tmp_path: Path) -> None:
    first = write(tmp_path / "a", [line_of(0), line_of(1)], episodes=2)
    second = write(tmp_path / "b", [line_of(1, wall_time_s=7.0)], episodes=2)
    assert main(Args(runs=(first, second), out=tmp_path / "both")) == 0
    assert len(lines_of(tmp_path / "both")) == 2
    third = write(tmp_path / "c", [line_of(1, num_steps=11)], episodes=2)
    with pytest.raises(ConfigError, match="'e1'"):
        main(Args(runs=(first, third), out=tmp_path / "other"))
    with pytest.raises(ConfigError, match="'e1'"):
        main(Args(runs=(third,), out=tmp_path / "both"))


def test_the_files_of_an_episode_are_those_of_its_line(tmp_path: Path) -> None:
    def with_file(name: str, line: EpisodeResult) -> Path:
        folder = write(tmp_path / name, [line], episodes=1)
        (folder / "trajectories").mkdir()
        (folder / "trajectories" / "e0.npz").write_text(name)
        return folder

    failed = with_file("failed", line_of(0, success=0.0, end_reason="error", error="lost"))
    again = with_file("again", line_of(0))
    for name, runs in (("both", (failed, again)), ("later", (failed,)), ("later", (failed, again))):
        main(Args(runs=runs, out=tmp_path / name))
    for name in ("both", "later"):
        assert (tmp_path / name / "trajectories" / "e0.npz").read_text() == "again"


def test_runs_with_other_options_are_never_merged(tmp_path: Path) -> None:
    first, second = write(tmp_path / "a", [line_of(0)]), write(tmp_path / "b", [line_of(1, seed=1)], seed=1)
    with pytest.raises(ConfigError, match=wording.HAS_SEED_0_HAS_1_RUNS_WITH_DIFFERENT_OPTIONS):
        main(Args(runs=(first, second), out=tmp_path / "both"))
    assert not (tmp_path / "both").exists()


def test_runs_of_named_episodes_become_one_of_all_these(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first = write(tmp_path / "a", [line_of(0), line_of(1)], only=["e0", "e1"], episodes=2)
    second = write(tmp_path / "b", [line_of(3)], only=["e3", "e4"], episodes=2)
    assert main(Args(runs=(first, second), out=tmp_path / "both")) == 1
    assert "3 episodes of 2 runs, 1 missing" in (output := capsys.readouterr().out)
    assert "Missing: e4" in output
    assert json.loads((tmp_path / "both" / "config.json").read_text())["only"] == ["e0", "e1", "e3", "e4"]
    assert main(Args(runs=(first,), out=tmp_path / "both")) == 1  # again
    assert "3 episodes of 1 run, 1 missing" in (output := capsys.readouterr().out)
    assert "Missing: e4" in output
    late = write(tmp_path / "late", [line_of(4)], only=["e4", "e5"], episodes=2)
    assert main(Args(runs=(late,), out=tmp_path / "both")) == 1
    assert "4 episodes of 1 run, 1 missing" in (output := capsys.readouterr().out)
    assert "Missing: e5" in output
    whole = write(tmp_path / "c", [line_of(2)], only=[], episodes=4)
    assert main(Args(runs=(first, whole), out=tmp_path / "more")) == 1
    assert json.loads((tmp_path / "more" / "config.json").read_text())["only"] == []


def test_all_code_that_ran_episodes_is_named(tmp_path: Path) -> None:
    runs = (write(tmp_path / "a", [line_of(0)]), write(tmp_path / "b", [line_of(1)], versions={"code": "0lder"}))
    main(Args(runs=runs, out=tmp_path / "both"))
    assert json.loads((tmp_path / "both" / "config.json").read_text())["codes"] == ["c0de", "0lder"]
    later = write(tmp_path / "c", [line_of(2)], versions={"code": "newer"})
    main(Args(runs=(later,), out=tmp_path / "both"))
    assert json.loads((tmp_path / "both" / "config.json").read_text())["codes"] == ["c0de", "0lder", "newer"]


def test_a_merge_of_runs_that_do_not_name_their_code_is_a_run(tmp_path: Path) -> None:
    main(Args(runs=(write(tmp_path / "a", [line_of(0)], versions={}),), out=tmp_path / "b"))
    assert read_run(tmp_path / "b").config["codes"] == []


def test_nothing_to_merge_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="shard_"):
        main(Args(runs=(tmp_path,)))
    with pytest.raises(ConfigError, match="got nothing"):
        main(Args(runs=(), out=tmp_path / "out"))
    with pytest.raises(ConfigError, match="--shard 1/2 needs --out"):
        resolve(RunOptions(shard="1/2"))
