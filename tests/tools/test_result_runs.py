"""The episodes of the tables of results: which rows are run, and an archive from which another machine continues."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from sim.core.errors import ConfigError
from tools.research import result_runs
from tools.research.result_archive import VERSION, RunKey, read_archive
from tools.research.result_definitions import page_tables
from tools.research.result_runs import Args, main, needed, pack, runs_in, unpack

KEY = RunKey("val", "stubborn", "--explorer informed-tour", "gt", VERSION)


def write_run(folder: Path, episodes: int, version: str = VERSION) -> None:
    """Writes a run of `KEY`."""
    config = {
        "agent": "stubborn", "explorer": "informed-tour", "semantics": "gt", "split": "val",
        "split_identity": {"name": "val", "version": version, "sha256": "0" * 64},
    }  # fmt: skip
    line = {"house": "val_00", "goal": "bed", "end_reason": "stop", "success": 1.0}
    lines = [json.dumps({"episode_id": f"val_{i:04}", **line}) for i in range(episodes)]
    folder.mkdir(parents=True)
    (folder / "config.json").write_text(json.dumps(config))
    (folder / "results.jsonl").write_text("".join(f"{each}\n" for each in lines))


def test_every_row_of_a_table_is_run_on_the_splits_as_they_are_now() -> None:
    rows = [row for table in page_tables() for row in table.needed() if row.run.split != "transfer"]
    found = needed(Args().splits)
    assert all(found[row.run] >= row.episodes for row in rows)
    assert {key.split for key in needed(("val",))} == {"val"}


def test_splits_of_another_version_than_the_tables_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(result_runs, "VERSION", "2.0.0")
    with pytest.raises(ConfigError, match=r"'val' has version 3.0.0, the tables 2.0.0"):
        needed(("val",))


def test_runs_that_are_packed_and_unpacked_are_equal_and_the_longer_one_stays(tmp_path: Path) -> None:
    write_run(tmp_path / "first" / "some", 3)
    write_run(tmp_path / "first" / "earlier", 4, "2.0.0")
    folders = runs_in(tmp_path / "first")
    assert list(folders) == [KEY]
    archive = tmp_path / "splits.tar.gz"
    archive.write_bytes(pack(folders))
    assert pack(folders) == archive.read_bytes()
    assert list(read_archive(archive, tmp_path / "read", lambda text: None)) == [KEY]
    unpack(archive, tmp_path / "second")
    for file in (tmp_path / "second").rglob("*.json*"):
        assert file.read_bytes() == (tmp_path / "first" / file.relative_to(tmp_path / "second")).read_bytes()
    assert pack(runs_in(tmp_path / "second")) == archive.read_bytes()
    for episodes, left in ((2, 3), (5, 5)):
        write_run(tmp_path / f"third{episodes}" / "other_name", episodes)
        unpack(archive, tmp_path / f"third{episodes}")
        (folder,) = runs_in(tmp_path / f"third{episodes}").values()
        assert len((folder / "results.jsonl").read_text().splitlines()) == left
        assert folder.name == "other_name"


def test_two_runs_of_one_row_are_refused(tmp_path: Path) -> None:
    for name in ("some", "other"):
        write_run(tmp_path / name, 1)
    with pytest.raises(ConfigError, match=r"other' and '.*some' are runs of the same row"):
        runs_in(tmp_path)


def test_rows_take_turns_until_all_are_complete_and_the_archive_has_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    other = RunKey("val", "oracle", "", "gt", VERSION)
    calls: list[list[str]] = []

    def ran(words: list[str], *, check: bool) -> None:
        calls.append(words)

    monkeypatch.setattr(subprocess, "run", ran)
    monkeypatch.setattr(result_runs, "needed", lambda splits: {KEY: 70, other: 60})
    write_run(tmp_path / "runs" / "some", 50)
    args = Args(out=tmp_path / "runs", archive=tmp_path / "runs.tar.gz")
    assert main(args) == 0
    asked = [(words[words.index("--agent") + 1], words[words.index("--episodes") + 1]) for words in calls]
    assert asked == [("oracle", "50"), ("stubborn", "70"), ("oracle", "60")]
    assert calls[1][calls[1].index("--explorer") + 1] == "informed-tour"
    assert calls[1][calls[1].index("--out") + 1] == str(tmp_path / "runs" / "some")
    printed = capsys.readouterr().out
    assert "val: stubborn --explorer informed-tour, gt: 50 of 70 episodes" in printed
    assert "val: oracle, gt: 0 of 60 episodes" in printed
    assert list(read_archive(tmp_path / "runs.tar.gz", tmp_path / "read", print)) == [KEY]
    calls.clear()
    assert main(Args(out=tmp_path / "runs", archive=tmp_path / "runs.tar.gz", minutes=0.0)) == 0
    assert calls == []
