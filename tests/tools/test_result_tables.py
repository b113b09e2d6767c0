"""The tables of results agree with the archive, and unusual archives are reported."""

from __future__ import annotations

import hashlib
import importlib
import json
import re
import shlex
import shutil
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sim.app import cli
from sim.app.analysis.metrics import SUCCESS
from sim.app.commands.main import COMMANDS
from sim.app.commands.reproduce import runs as table_runs
from sim.app.commands.reproduce.runs import AgentSetup, RunKey, runs_in
from sim.app.composition.setup import resolve
from sim.app.evaluation.intervals import holm
from sim.app.options import RunOptions
from sim.core.configuration import as_json, leaves_of
from sim.core.errors import ConfigError
from sim.homes.housegen.splits.recipes import SPLIT_VERSION
from stubborn.segmentation.shipped import SHIPPED_REDNET
from tests.helpers import documented, wording
from tests.helpers.results import ENTRIES
from tools.research import result_tables
from tools.research.paper_reasons import EPISODES, reasons
from tools.research.result_archive import (
    ARCHIVE,
    CHECKSUM_DIGITS,
    ROOT,
    VERSION,
    ArchivedRun,
    pack,
    read_archive,
    unpack,
)
from tools.research.result_definitions import comparisons, needed_rows, page_tables
from tools.research.result_tables import (
    COMPARISONS,
    DOCS,
    PAGES,
    PAPER,
    PUBLISHED,
    RESULTS,
    TABLES,
    Args,
    cell_text,
    comparison_record,
    fill_page,
    known_quantities,
    main,
    motion_texts,
    other_tables,
    paper_page,
    read_csv,
    result_record,
    row_keys,
    tables_by_page,
    to_csv,
    unknown_quantities,
    with_families,
)

CONFIG: dict[str, Any] = {
    "agent": "stubborn",
    "semantics": "gt",
    "split": "val",
    "split_identity": {"name": "val", "version": VERSION, "sha256": "0" * 64},
    "versions": {"stubborn-objectnav": "0.1.0"},
}
LINE = ENTRIES


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Mapping[RunKey, ArchivedRun]:
    return read_archive(ARCHIVE, tmp_path_factory.mktemp("archive"))


@pytest.fixture(scope="module")
def others(runs: Mapping[RunKey, ArchivedRun]) -> dict[str, dict[str, str]]:
    return other_tables(next(iter(runs.values())).run.path.parent, runs)


def test_the_tables_of_the_pages_are_rows_of_the_shipped_csv_files_and_sentences_quote_only_these(
    others: Mapping[str, Mapping[str, str]],
) -> None:
    results = read_csv(TABLES / RESULTS)
    tables = [text for texts in others.values() for text in texts.values()]
    tables.append((TABLES / PAPER).read_text(encoding="utf-8"))
    compared = read_csv(TABLES / COMPARISONS)
    known = known_quantities(results, compared, read_csv(TABLES / PUBLISHED), tables)
    for name, texts in tables_by_page(results, compared, others).items():
        page = (DOCS / name).read_text(encoding="utf-8")
        assert texts, name
        assert fill_page(page, texts) == page, name
        assert unknown_quantities(page, known) == [], name
    for page in (ROOT / "README.md", DOCS / "explorers.md"):
        assert unknown_quantities(page.read_text(encoding="utf-8"), known) == [], page


def test_runs_with_a_network_are_of_the_shipped_one_unless_they_name_another_in_todays_homes(
    runs: Mapping[RunKey, ArchivedRun],
) -> None:
    shipped = hashlib.sha256(SHIPPED_REDNET.read_bytes()).hexdigest()[:CHECKSUM_DIGITS]
    with_network = {key: run.network for key, run in runs.items() if key.setup.semantics == "rednet"}
    assert {network for key, network in with_network.items() if "--weights" not in key.setup.options} == {shipped}
    assert shipped not in {network for key, network in with_network.items() if "--weights" in key.setup.options}
    assert VERSION == SPLIT_VERSION
    assert {runs[key].run.config["config"]["detector"]["mirrored"] for key in with_network} == {False}


def test_the_shipped_csv_files_are_those_of_the_archive(runs: Mapping[RunKey, ArchivedRun]) -> None:
    made = [result_record(runs[key.run], key.episodes) for key in row_keys(runs)]
    assert read_csv(TABLES / RESULTS) == made
    pairs = list(comparisons())
    assert read_csv(TABLES / COMPARISONS) == with_families(pairs, [comparison_record(pair, runs) for pair in pairs])


def test_the_page_of_the_paper_is_that_of_the_archive(tmp_path: Path) -> None:
    runs = read_archive(ARCHIVE, tmp_path)
    assert (TABLES / PAPER).read_text(encoding="utf-8") == paper_page(tmp_path, runs)
    shutil.rmtree(tmp_path / "poni_rednet_none_val")
    with pytest.raises(ConfigError, match="'overall'"):
        paper_page(tmp_path, runs)
    shutil.rmtree(tmp_path / "poni_gt_none_val_motion-sliding")
    with pytest.raises(ConfigError, match="motions on val"):
        motion_texts(tmp_path)


def test_every_episode_is_in_one_third_by_distance_and_corners_are_trapped_or_not(
    runs: Mapping[RunKey, ArchivedRun],
) -> None:
    by_length, by_trap = reasons(runs)
    counts = {label: int(re.findall(r"\((\d+)\)", label)[0]) for label, _ in (*by_length.rows, *by_trap.rows)}
    for split in EPISODES:
        of_split = {label: count for label, count in counts.items() if label.startswith(f"{split}, ")}
        *thirds, total = of_split.values()
        assert (len(thirds), sum(thirds), total) == (3, EPISODES[split], EPISODES[split])
        assert max(thirds) - min(thirds) <= 1
    assert sum(count for label, count in counts.items() if label.startswith("stubborn-i is")) == EPISODES["val"]


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


def test_a_sentence_may_quote_only_quantities_that_are_known_and_differences_in_both_directions() -> None:
    record = {
        f"success{end}": value for end, value in zip(("", "_low", "_high"), ("0.2", "0.096", "0.304"), strict=True)
    }
    published = {"metric": "collisions", "value": "7.2", "low95": "4.3", "high95": "12.04"}
    known = known_quantities([], [], [published], [f"|{cell_text(record, SUCCESS, sign='+')}|"])
    for text in ("94.1 [89.5, 96.6]", "by 20.0 points\n[9.6, 30.5]", "7.2 [4.3, 12.1]"):
        assert len(unknown_quantities(text, known)) == 1
    for text in ("by +20.0 points\n[+9.6, +30.4]", "-20.0 [-30.4, -9.6]", "20.0 points of success [9.6, 30.4]"):
        assert unknown_quantities(f"{text} and 7.2 [4.3, 12.0]", known) == [], text


def test_check_reports_a_page_and_a_csv_file_that_differ(
    tmp_path: Path,
    runs: Mapping[RunKey, ArchivedRun],
    others: dict[str, dict[str, str]],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    few = sorted({row for table in page_tables() for _, cells in table.rows for row, _ in cells})
    monkeypatch.setattr(result_tables, "read_archive", lambda *_: runs)
    monkeypatch.setattr(result_tables, "paper_page", lambda *_: "The tables.\n")
    monkeypatch.setattr(result_tables, "other_tables", lambda *_: others)
    monkeypatch.setattr(result_tables, "row_keys", lambda _: few)
    monkeypatch.setattr(result_tables, "comparisons", lambda: [pair for pair in comparisons() if pair.primary][:1])
    shutil.copy(TABLES / PUBLISHED, tmp_path)
    for name in PAGES:
        text = re.sub(QUOTED, "", (DOCS / name).read_text(encoding="utf-8"))
        (tmp_path / name).write_text(text, encoding="utf-8")
    page = tmp_path / "results.md"
    args = Args(tables=tmp_path, docs=tmp_path)
    assert main(args) == 0
    check = replace(args, check=True)
    assert main(check) == 0
    page.write_text(page.read_text(encoding="utf-8").replace("|val, ", "|of val, ", 1), encoding="utf-8")
    capsys.readouterr()
    assert main(check) == 1
    assert "results.md' differs" in capsys.readouterr().out
    assert main(args) == 0
    shutil.copy(tmp_path / RESULTS, tmp_path / COMPARISONS)
    assert main(check) == 1


QUOTED = r"[-+]?\d[\d.]*(?:\s(?:points|steps|%|of\s\w+))*\s\[[-+\d.,\s]+\]"
"""Quantities of a page, which may be in rows that a test leaves out."""


KEY = RunKey("val", AgentSetup("stubborn", "--explorer informed-tour", "gt"), VERSION)


def write_run(folder: Path, lines: list[dict[str, Any]], **config: Any) -> Path:
    """Writes a run with some entries of config.json; returns its folder."""
    folder.mkdir(parents=True)
    (folder / "config.json").write_text(json.dumps(CONFIG | config))
    (folder / "results.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    return folder


def numbered(count: int) -> list[dict[str, Any]]:
    return [LINE | {"episode_id": f"val_{number:04}"} for number in range(count)]


def archived(folder: Path) -> ArchivedRun:
    ((key, path),) = runs_in(folder, VERSION).items()
    return ArchivedRun(key, table_runs.read_run(path))


def test_runs_that_are_packed_and_unpacked_are_equal_and_the_longer_one_stays(tmp_path: Path) -> None:
    write_run(tmp_path / "first" / "some", numbered(3), explorer="informed-tour")
    write_run(
        tmp_path / "first" / "earlier", numbered(4), split_identity=CONFIG["split_identity"] | {"version": "2.0.0"}
    )
    folders = runs_in(tmp_path / "first", VERSION)
    assert list(folders) == [KEY]
    archive = tmp_path / "splits.tar.gz"
    archive.write_bytes(pack(folders))
    assert pack(folders) == archive.read_bytes()
    assert list(read_archive(archive, tmp_path / "read")) == [KEY]
    unpack(archive, tmp_path / "second")
    assert pack(runs_in(tmp_path / "second", VERSION)) == archive.read_bytes()
    for episodes, kept in ((2, 3), (5, 5)):
        folder = write_run(tmp_path / f"third{episodes}" / "other_name", numbered(episodes), explorer="informed-tour")
        unpack(archive, folder.parent)
        assert list(runs_in(folder.parent, VERSION).values()) == [folder]
        assert len((folder / "results.jsonl").read_text().splitlines()) == kept


def test_two_runs_of_one_row_and_a_damaged_archive_are_refused(tmp_path: Path) -> None:
    for name in ("some", "other"):
        write_run(tmp_path / "runs" / name, numbered(1))
    with pytest.raises(ConfigError, match=r"'.*some'"):
        runs_in(tmp_path / "runs", VERSION)
    (tmp_path / "archive.tar.gz").write_bytes(ARCHIVE.read_bytes()[:1000])
    with pytest.raises(ConfigError, match=wording.CANNOT_BE_READ):
        read_archive(tmp_path / "archive.tar.gz", tmp_path / "read")


def test_rows_take_turns_until_all_are_complete_and_the_archive_has_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [row for row in needed_rows() if row.run.split == "val" and row.run.setup.agent in ("oracle", "poni")]
    calls: list[tuple[str, int, Path]] = []
    monkeypatch.setattr(result_tables, "needed_rows", lambda: rows)
    monkeypatch.setattr(
        table_runs, "run_missing",
        lambda setup, episodes, *_: calls.append((setup.options.agent, len(episodes), setup.options.out)),
    )  # fmt: skip
    mine = write_run(tmp_path / "runs" / "mine", numbered(50), agent="poni")
    args = Args(run=True, out=tmp_path / "runs", archive=tmp_path / "runs.tar.gz")
    assert main(args) == 0
    assert sorted(name for name, _, _ in calls) == ["oracle"] * 4 + ["poni"]  # of 200 and 100; poni has the first 50
    assert {count for _, count, _ in calls} == {50}
    assert {folder for name, _, folder in calls if name == "poni"} == {mine}
    printed = capsys.readouterr().out
    assert "val: poni, gt: 50 of 100 episodes" in printed
    assert "val: oracle, gt: 0 of 200 episodes" in printed
    assert [key.setup.agent for key in read_archive(args.archive, tmp_path / "read")] == ["poni"]
    assert [folder.name for folder in (tmp_path / "read").iterdir()] == ["poni_gt_none_val"]
    monkeypatch.setattr(result_tables, "VERSION", "2.0.0")
    with pytest.raises(ConfigError, match=rf"'val' has version {VERSION}, the tables 2.0.0"):
        main(args)


def test_replicates_are_no_episodes_and_their_spread_is_in_the_table(tmp_path: Path) -> None:
    lines = [
        LINE
        | {"episode_id": f"val_000{i}{mark}", "house": f"val_0{i}", "success": float(success), "spl": 0.5 * success}
        for i, outcomes in enumerate(((1, 0), (1, 1), (0, 0)))
        for mark, success in zip(("", "~1"), outcomes, strict=True)
    ]
    run = archived(write_run(tmp_path / "a", lines, replicates=2).parent)
    assert [result.episode_id for result in run.first_results(2)] == [
        "val_0000",
        "val_0000~1",
        "val_0001",
        "val_0001~1",
    ]
    record = result_record(run, 3)
    assert (record["episodes"], record["options"], record["success"]) == ("3", "--replicates 2", "0.500000")
    assert float(record["success_replicates_sd"]) == pytest.approx((0.5 / 3 / 3) ** 0.5, abs=1e-6)
    assert "--replicates 2" in record["command"]


def test_a_row_has_the_command_that_repeats_it(tmp_path: Path) -> None:
    settings = {"agent.seeker.look.bar": [[0, 0.05], [500, 0.7]]}
    write_run(tmp_path / "a", [LINE], explorer="tour", verification="none", settings=settings, seed_key="0123abcd")
    assert archived(tmp_path).command(1) == (
        "stubborn run --agent stubborn --explorer tour --verification none --config "
        "'agent.seeker.look.bar=[[0,0.05],[500,0.7]]' "
        "--semantics gt --split val --episodes 1 --seed-key 0123abcd"
    )


def test_the_command_of_a_row_with_the_network_says_that_it_was_not_averaged_with_the_mirror_image(
    tmp_path: Path,
) -> None:
    for mirrored, options in ((False, "--config detector.mirrored=false "), (True, "")):
        write_run(
            tmp_path / str(mirrored) / "a", [LINE], semantics="rednet", config={"detector": {"mirrored": mirrored}}
        )
        expected = f"stubborn run --agent stubborn {options}--semantics rednet --split val --episodes 1"
        assert archived(tmp_path / str(mirrored)).command(1) == expected


def test_the_command_of_a_row_configures_the_agent_as_its_run_was(runs: Mapping[RunKey, ArchivedRun]) -> None:
    for run in runs.values():
        words = shlex.split(run.command(1).rpartition("; ")[2])
        options = cli.parse(RunOptions, words[2:])
        today = dict(leaves_of(as_json(resolve(replace(options, split="val", weights=None)).config)))
        recorded = dict(leaves_of(run.run.config["config"]))
        both = {path for path in today.keys() & recorded.keys() if path.startswith("agent.")}
        assert [path for path in both if today[path] != recorded[path]] == [], run.run.path.name


COMMANDS_OF_TABLES = {
    command: file.name
    for file in sorted(TABLES.glob("*.csv"))
    for record in read_csv(file)
    for command in record.get("command", "").split("; ")
    if command
}
"""Commands of the CSV files, and the file that each is in."""


@pytest.mark.parametrize("command", COMMANDS_OF_TABLES)
def test_every_command_of_a_csv_file_is_accepted_with_its_options(command: str) -> None:
    program, words = documented.program_of(documented.canonical(shlex.split(command)))
    module = importlib.import_module(COMMANDS[program].module if program in COMMANDS else program)
    cli.parse(module.Args, words)


def test_a_csv_file_read_again_has_the_same_rows(tmp_path: Path) -> None:
    records = [{"a": "x, y", "b": ""}, {"a": '"', "b": "2"}]
    (tmp_path / "some.csv").write_text(to_csv(records), encoding="utf-8")
    assert read_csv(tmp_path / "some.csv") == records
