"""The tables of results agree with the archive, and unusual archives are reported."""

from __future__ import annotations

import io
import json
import re
import shutil
import tarfile
from collections.abc import Mapping
from pathlib import Path

import pytest

from sim.errors import ConfigError
from sim.evaluation import bootstrap
from tools.research import result_tables
from tools.research.result_archive import ARCHIVE, ArchivedRun, RunKey, newest, read_archive
from tools.research.result_definitions import comparisons, page_tables
from tools.research.result_tables import (
    COMPARISONS,
    PAGE,
    RESULTS,
    TABLES,
    Record,
    comparison_record,
    fill_page,
    main,
    read_csv,
    result_record,
    row_keys,
    to_csv,
    unknown_quantities,
)

RESAMPLED = ("_low", "_high", "_significant")
"""Ends of columns that need the bootstrap."""
CONFIG = {
    "agent": "stubborn",
    "semantics": "gt",
    "split": "val",
    "split_identity": {"name": "val", "version": "2.0.0", "sha256": "0" * 64},
    "versions": {"stubborn-objectnav": "0.1.0"},
}
LINE = {"episode_id": "val_0000", "house": "val_00", "goal": "bed", "end_reason": "stop", "success": 1.0}


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Mapping[RunKey, ArchivedRun]:
    return read_archive(ARCHIVE, tmp_path_factory.mktemp("archive"), lambda text: None)


def without_intervals(records: list[Record]) -> list[Record]:
    return [{key: value for key, value in each.items() if not key.endswith(RESAMPLED)} for each in records]


def test_the_tables_of_the_page_are_rows_of_the_shipped_csv_file() -> None:
    results, compared = read_csv(TABLES / RESULTS), read_csv(TABLES / COMPARISONS)
    page = PAGE.read_text(encoding="utf-8")
    assert fill_page(page, results) == page
    assert unknown_quantities(page, results, compared) == []


def test_the_shipped_csv_files_are_those_of_the_archive(
    runs: Mapping[RunKey, ArchivedRun], monkeypatch: pytest.MonkeyPatch
) -> None:
    results, compared = read_csv(TABLES / RESULTS), read_csv(TABLES / COMPARISONS)
    keys, pairs = row_keys(runs), list(comparisons())
    columns = [list(result_record(runs[keys[0].run], 20)), list(comparison_record(pairs[0], runs))]
    assert [list(records[0]) for records in (results, compared)] == columns
    for number in (0, len(keys) // 2):
        assert result_record(runs[keys[number].run], keys[number].episodes) == results[number]
    assert comparison_record(pairs[1], runs) == compared[1]
    monkeypatch.setattr(bootstrap, "bootstrap_interval", lambda values, houses: (0.0, 0.0))
    made = [result_record(runs[key.run], key.episodes) for key in keys]
    assert without_intervals(made) == without_intervals(results)
    assert without_intervals([comparison_record(each, runs) for each in pairs]) == without_intervals(compared)


def test_a_sentence_may_quote_only_quantities_of_the_csv_files() -> None:
    results, compared = read_csv(TABLES / RESULTS), read_csv(TABLES / COMPARISONS)
    for text in ("94.1 [89.1, 98.0]", "by 15.0 points\n[6.5, 23.8]"):
        assert len(unknown_quantities(text, results, compared)) == 1
    assert unknown_quantities("94.0 [89.1, 98.0], by +15.0 points\n[+6.5, +23.9]", results, compared) == []


def test_check_reports_a_page_and_a_csv_file_that_differ(
    tmp_path: Path, runs: Mapping[RunKey, ArchivedRun], monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    few = sorted({key for table in page_tables() for key in table.needed()}, key=lambda key: (key.run, key.episodes))
    monkeypatch.setattr(bootstrap, "bootstrap_interval", lambda values, houses: (0.0, 0.0))
    monkeypatch.setattr(result_tables, "read_archive", lambda *_: runs)
    monkeypatch.setattr(result_tables, "row_keys", lambda _: few)
    monkeypatch.setattr(result_tables, "comparisons", lambda: list(comparisons())[:1])
    page = tmp_path / "results.md"
    page.write_text(re.sub(QUOTED, "", PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    args = result_tables.Args(tables=tmp_path, page=page)
    assert main(args) == 0
    check = result_tables.Args(check=True, tables=tmp_path, page=page)
    assert main(check) == 0
    page.write_text(page.read_text(encoding="utf-8").replace("|99.5 ", "|99.6 "), encoding="utf-8")
    capsys.readouterr()
    assert main(check) == 1
    assert "results.md' differs" in capsys.readouterr().out
    assert main(args) == 0
    shutil.copy(tmp_path / RESULTS, tmp_path / COMPARISONS)
    assert main(check) == 1


QUOTED = r"[-\d.]+(?: points)?\s\[[-\d., \n]+\]"
"""Quantities of the page: they are not those of intervals without width."""


def archive_of(folder: Path, files: Mapping[str, str]) -> Path:
    """Returns a tar file with these files, one of them a link."""
    archive = folder / "archive.tar.gz"
    with tarfile.open(archive, "w:gz") as opened:
        for name, text in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(text)
            opened.addfile(member, io.BytesIO(text.encode()))
        link = tarfile.TarInfo("linked/config.json")
        link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
        opened.addfile(link)
    return archive


def test_odd_folders_of_an_archive_are_skipped_with_a_message(tmp_path: Path) -> None:
    config, line = json.dumps(CONFIG), json.dumps(LINE) + "\n"
    files = {
        "good/config.json": config,
        "good/results.jsonl": line,
        "older/good/config.json": config,
        "older/good/results.jsonl": line,
        "../outside/config.json": config,
        "half/config.json": config,
        "broken/config.json": "[",
        "broken/results.jsonl": line,
        "settings/config.json": json.dumps(CONFIG | {"settings": 3}),
        "settings/results.jsonl": line,
        "unknown/config.json": json.dumps(CONFIG | {"agent": "nobody"}),
        "unknown/results.jsonl": line,
        "notes.txt": "",
    }
    said: list[str] = []
    folder = tmp_path / "in" / "here"
    found = read_archive(archive_of(tmp_path, files), folder, said.append)
    assert [run.folder for run in found.values()] == ["good"]
    skipped = ["'../outside/config.json'", "'notes.txt'", "'linked/config.json'", "'half'", "'broken'", "'settings'"]
    for name in (*skipped, "'unknown'"):
        assert sum(text.startswith(f"Skipped {name}") for text in said) == 1, name
    assert not (tmp_path / "in" / "outside").exists()


def test_the_run_with_more_episodes_is_shown_for_a_row(tmp_path: Path) -> None:
    config, line = json.dumps(CONFIG), json.dumps(LINE) + "\n"
    more = line + json.dumps(LINE | {"episode_id": "val_0001"}) + "\n"
    files = {"a/config.json": config, "a/results.jsonl": more, "b/config.json": config, "b/results.jsonl": line}
    said: list[str] = []
    (run,) = read_archive(archive_of(tmp_path, files), tmp_path / "runs", said.append).values()
    assert run.folder == "a"
    assert any(text.startswith("Skipped 'b'") for text in said)
    with pytest.raises(ConfigError, match="older"):
        newest([run, ArchivedRun(run.key, run.run, "c")], said.append)


def test_a_row_has_the_command_that_repeats_it(tmp_path: Path) -> None:
    config = CONFIG | {
        "explorer": "tour",
        "verification": "none",
        "settings": {"agent.seeker.look.bar": [[0, 0.05], [500, 0.7]]},
    }
    files = {"a/config.json": json.dumps(config), "a/results.jsonl": json.dumps(LINE) + "\n"}
    (run,) = read_archive(archive_of(tmp_path, files), tmp_path / "runs", lambda text: None).values()
    assert run.command(1) == (
        "stubborn run --agent stubborn --explorer tour --verification none --config "
        "'agent.seeker.look.bar=[[0,0.05],[500,0.7]]' "
        "--semantics gt --split val --episodes 1"
    )


def test_a_csv_file_read_again_has_the_same_rows(tmp_path: Path) -> None:
    records = [{"a": "x, y", "b": ""}, {"a": '"', "b": "2"}]
    (tmp_path / "some.csv").write_text(to_csv(records), encoding="utf-8")
    assert read_csv(tmp_path / "some.csv") == records
