"""The tables of results agree with the archive, and unusual archives are reported."""

from __future__ import annotations

import hashlib
import io
import json
import re
import shutil
import tarfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from scipy.special import stdtrit

from sim.core.errors import ConfigError
from stubborn.segmentation.shipped import SHIPPED_REDNET
from tools.research import result_tables
from tools.research.paper_page import PAPER, paper_page
from tools.research.resolution import houses_needed, resolution_record, shown_difference, variance_components
from tools.research.result_archive import (
    ARCHIVE,
    CHECKSUM_DIGITS,
    RUN_FILES,
    ArchivedRun,
    RunKey,
    read_archive,
)
from tools.research.result_definitions import RESOLVED, comparisons, page_tables
from tools.research.result_tables import (
    COMPARISONS,
    PAGE,
    RESOLUTION,
    RESULTS,
    TABLES,
    comparison_record,
    fill_page,
    holm,
    main,
    read_csv,
    result_record,
    row_keys,
    to_csv,
    unknown_quantities,
    with_families,
)

CONFIG = {
    "agent": "stubborn",
    "semantics": "gt",
    "split": "val",
    "split_identity": {"name": "val", "version": "3.0.0", "sha256": "0" * 64},
    "versions": {"stubborn-objectnav": "0.1.0"},
}
LINE = {"episode_id": "val_0000", "house": "val_00", "goal": "bed", "end_reason": "stop", "success": 1.0}


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Mapping[RunKey, ArchivedRun]:
    return read_archive(ARCHIVE, tmp_path_factory.mktemp("archive"), lambda text: None)


def test_the_tables_of_the_page_are_rows_of_the_shipped_csv_file() -> None:
    results, compared = read_csv(TABLES / RESULTS), read_csv(TABLES / COMPARISONS)
    page = PAGE.read_text(encoding="utf-8")
    assert fill_page(page, results) == page
    assert unknown_quantities(page, results, compared) == []


def test_runs_with_a_network_are_of_the_network_that_ships(runs: Mapping[RunKey, ArchivedRun]) -> None:
    shipped = hashlib.sha256(SHIPPED_REDNET.read_bytes()).hexdigest()[:CHECKSUM_DIGITS]
    of_network = {run.network for key, run in runs.items() if key.semantics == "rednet"}
    assert of_network == {shipped}


def test_the_shipped_csv_files_are_those_of_the_archive(runs: Mapping[RunKey, ArchivedRun]) -> None:
    made = [result_record(runs[key.run], key.episodes) for key in row_keys(runs)]
    assert read_csv(TABLES / RESULTS) == made
    pairs = list(comparisons())
    assert read_csv(TABLES / COMPARISONS) == with_families(pairs, [comparison_record(each, runs) for each in pairs])
    resolved = [resolution_record(each, runs) for each in pairs if each.table in RESOLVED and each.primary]
    assert read_csv(TABLES / RESOLUTION) == resolved


def test_the_page_of_the_paper_is_that_of_the_archive(tmp_path: Path) -> None:
    read_archive(ARCHIVE, tmp_path, lambda text: None)
    assert (TABLES / PAPER).read_text(encoding="utf-8") == paper_page(tmp_path)
    shutil.rmtree(tmp_path / "poni_rednet_none_val")
    with pytest.raises(ConfigError, match="lacks a run of the paper's table 'overall'"):
        paper_page(tmp_path)


def test_holm_multiplies_the_smallest_p_value_by_their_number_and_keeps_the_order() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.9, 0.8]) == [1.0, 1.0]


def test_every_table_has_primary_comparisons_and_only_they_are_corrected() -> None:
    records = read_csv(TABLES / COMPARISONS)
    primary = [record for record in records if record["family"] == "primary"]
    assert {record["table"] for record in primary} == {record["table"] for record in records}
    assert all((record["family"] == "primary") == bool(record["success_p_holm"]) for record in records)
    for record in records:
        excluded = not float(record["success_low"]) <= 0.0 <= float(record["success_high"])
        assert excluded == (float(record["success_p"]) < 0.05)


def test_a_sentence_may_quote_only_quantities_of_the_csv_files() -> None:
    results, compared = read_csv(TABLES / RESULTS), read_csv(TABLES / COMPARISONS)
    for text in ("94.1 [89.5, 96.6]", "by 15.0 points\n[8.1, 21.8]"):
        assert len(unknown_quantities(text, results, compared)) == 1
    assert unknown_quantities("94.5 [90.4, 96.9], by +20.0 points\n[+9.6, +30.4]", results, compared) == []


def test_check_reports_a_page_and_a_csv_file_that_differ(
    tmp_path: Path, runs: Mapping[RunKey, ArchivedRun], monkeypatch: pytest.MonkeyPatch, capsys
) -> None:
    few = sorted({key for table in page_tables() for key in table.needed()}, key=lambda key: (key.run, key.episodes))
    monkeypatch.setattr(result_tables, "read_archive", lambda *_: runs)
    monkeypatch.setattr(result_tables, "paper_page", lambda _: "The tables.\n")
    monkeypatch.setattr(result_tables, "row_keys", lambda _: few)
    monkeypatch.setattr(result_tables, "comparisons", lambda: [each for each in comparisons() if each.primary][:1])
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
        "../outside/config.json": config,
        "half/config.json": config,
        "begun/config.json": config,
        "begun/results.jsonl": "",
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
    for name in (*skipped, "'unknown'", "'begun'"):
        assert sum(text.startswith(f"Skipped {name}") for text in said) == 1, name
    assert not (tmp_path / "in" / "outside").exists()


def test_an_archive_with_two_runs_of_one_row_is_refused(tmp_path: Path) -> None:
    config, line = json.dumps(CONFIG), json.dumps(LINE) + "\n"
    files = {f"{name}/{file}": text for name in "ab" for file, text in zip(RUN_FILES, (config, line), strict=True)}
    with pytest.raises(ConfigError, match=r"'a' and 'b' of .* are runs of the same row"):
        read_archive(archive_of(tmp_path, files), tmp_path / "runs", print)


def test_replicates_are_no_episodes_and_their_spread_is_in_the_table(tmp_path: Path) -> None:
    lines = [
        LINE
        | {"episode_id": f"val_000{i}{mark}", "house": f"val_0{i}", "success": float(success), "spl": 0.5 * success}
        for i, outcomes in enumerate(((1, 0), (1, 1), (0, 0)))
        for mark, success in zip(("", "~1"), outcomes, strict=True)
    ]
    text = "".join(json.dumps(line) + "\n" for line in lines)
    files = {"a/config.json": json.dumps(CONFIG | {"replicates": 2}), "a/results.jsonl": text}
    (run,) = read_archive(archive_of(tmp_path, files), tmp_path / "runs", lambda _: None).values()
    assert [line["episode_id"] for line in run.first_lines(2)] == ["val_0000", "val_0000~1", "val_0001", "val_0001~1"]
    record = result_record(run, 3)
    assert (record["episodes"], record["options"], record["success"]) == ("3", "--replicates 2", "0.500000")
    assert float(record["success_replicates_sd"]) == pytest.approx((0.5 / 3 / 3) ** 0.5, abs=1e-6)
    assert "--replicates 2" in record["command"]


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


def test_variances_between_and_within_houses_are_those_of_simulated_data() -> None:
    rng, index = np.random.default_rng(0), np.repeat(np.arange(4000), np.resize([4, 6, 8], 4000))
    values = rng.normal(0.0, 0.3, 4000)[index] + rng.normal(0.0, 0.5, len(index))
    assert variance_components(values, index) == pytest.approx((0.09, 0.25), rel=0.05)


def test_the_needed_houses_show_a_difference_in_four_of_five_samples() -> None:
    houses = houses_needed(0.04, 0.1)
    assert shown_difference(0.04, houses) <= 0.1 < shown_difference(0.04, houses - 1)
    draws = np.random.default_rng(0).normal(0.1, 0.2, (20_000, houses))
    statistic = draws.mean(axis=1) / draws.std(axis=1, ddof=1) * np.sqrt(houses)
    assert np.mean(statistic > stdtrit(houses - 1, 0.975)) == pytest.approx(0.8, abs=0.02)
