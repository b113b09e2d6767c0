"""`submit`, `verify` and `leaderboard` as a user calls them."""

from __future__ import annotations

import copy
import csv
import json
import os
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import pytest

from sim.app.analysis.comparison import read_run
from sim.app.commands import leaderboard, submit, verify
from sim.app.composition.agents import SPECS
from sim.app.evaluation.results import HUMAN_NAME
from sim.app.submissions.contents import Submission, read_submission
from sim.app.submissions.leaderboard import LONG_ACTIONS, Row, repeated, tables
from sim.app.submissions.packing import About, pack
from sim.app.submissions.report import Report, read_report
from sim.app.submissions.sealing import Origin
from sim.core.errors import ConfigError
from sim.core.reading import sha256_of
from sim.robot.config import PHYSICS_VERSION
from tests.helpers import wording
from tests.helpers.submissions import content_of, written

SHIPPED = frozenset((*SPECS, HUMAN_NAME))


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
        "a replay cannot prove it",
        "segmentation none; ground truth yes",
    ):
        assert part in printed
    assert json.loads(report.read_text())["equal"] == 3
    content = content_of(folder / "oracle.json.gz")
    content["episodes"][1]["result"].update(success=0.0, spl=0.0, failure="misc")
    assert verify.main(verify.Args(file=written(tmp_path / "forged.json.gz", content), **options)) == 1
    assert "NOT VERIFIED: 1 episode differed in the replay" in capsys.readouterr().out


def test_an_agent_that_gets_no_segmentation_declares_none(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = submit.Args(run=folder / "process", name="x", authors=(), out=tmp_path / "x.json.gz")
    assert submit.main(words) == 0
    assert "in a process of its own, as the same user; segmentation none; " in capsys.readouterr().out


def test_a_run_without_its_actions_is_refused_with_the_command_that_records(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder / "oracle", tmp_path / "run")
    shutil.rmtree(tmp_path / "run" / "trajectories")
    with pytest.raises(ConfigError, match=r"--agent.*--record.*--out.*run_recorded"):
        pack(read_run(tmp_path / "run"), About(name="x", authors=()))


def test_actions_of_another_run_are_not_packed(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder / "oracle", tmp_path / "run")
    shutil.copy(folder / "random" / "trajectories" / "tiny_0000.npz", tmp_path / "run" / "trajectories")
    with pytest.raises(ConfigError, match=wording.IS_OF_ANOTHER_RESULT_THAN_ITS_LINE):
        pack(read_run(tmp_path / "run"), About(name="x", authors=()))


@pytest.mark.parametrize(("field", "value"), [("house", "a.xml"), ("physics", 0)])
def test_a_run_that_cannot_be_replayed_is_not_packed(folder: Path, field: str, value: Any) -> None:
    run = read_run(folder / "oracle")
    with pytest.raises(ConfigError, match=wording.A_SUBMISSION_NEEDS_A_SPLIT_PHYSICS_OF_VERSION_0):
        pack(replace(run, config={**run.config, field: value}), About(name="x", authors=()))


def small_rows(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Allows rows of three episodes with small images, in an empty leaderboard with an empty cache."""
    monkeypatch.setattr("sim.app.submissions.setting.Setting.changes", lambda setting: [])
    monkeypatch.setattr("sim.app.submissions.leaderboard.MIN_EPISODES", 3)
    monkeypatch.setenv("STUBBORN_CACHE_DIR", str(tmp_path / "cache"))
    (tmp_path / "submissions").mkdir()


@pytest.mark.costly
def test_the_leaderboard_has_the_rows_that_hold(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    small_rows(monkeypatch, tmp_path)
    content = content_of(folder / "random.json.gz")
    content["manifest"] |= {"name": "Our <b>agent</b> [x](y) | z", "authors": ["A. *Author*"]}
    written(tmp_path / "submissions" / "good.json.gz", content)
    erred = copy.deepcopy(content)
    erred["episodes"][0] |= {"actions": "", "places_m": []}
    erred["episodes"][0]["result"] |= {"end_reason": "error", "success": 0.0, "spl": 0.0, "soft_spl": 0.0}
    written(tmp_path / "submissions" / "erred.json.gz", erred)
    content["episodes"][0]["result"]["collisions"] = 99
    written(tmp_path / "submissions" / "forged.json.gz", content)
    content = content_of(folder / "oracle.json.gz")
    written(tmp_path / "submissions" / "few.json.gz", content | {"episodes": content["episodes"][:2]})
    content["episodes"] = content["episodes"][1:]
    written(tmp_path / "submissions" / "chosen.json.gz", content)
    (tmp_path / "submissions" / "broken.json.gz").write_bytes(b"x")
    args = leaderboard.Args(folder=tmp_path, splits=(folder / "tiny",))
    assert leaderboard.main(args) == 1
    printed = capsys.readouterr().out
    for part in (
        "forged.json.gz: 1 episode differed in the replay", "chosen.json.gz: its episodes were chosen by the authors",
        "broken.json.gz: Submission ", "few.json.gz: it has 2 episodes; a row needs 3",
    ):  # fmt: skip
        assert f"Left out: {part}" in printed
    verified = {line.split()[1] for line in printed.splitlines() if line.startswith("Verifying")}
    assert verified == {"good.json.gz.", "erred.json.gz.", "forged.json.gz."}
    table = (tmp_path / "table.md").read_text()
    assert r"Our &lt;b&gt;agent&lt;/b&gt; \[x\]\(y\)" in table
    assert "| equal |" in table
    assert "| equal, 1 of 3 ended with an error |" in table
    assert len([line for line in table.splitlines() if line.startswith("| ")]) == 4
    _, row = csv.DictReader((tmp_path / "table.csv").open())
    assert (row["name"], row["authors"]) == ("Our <b>agent</b> [x](y) | z", "A. *Author*")
    assert (row["noise"], row["episodes"], row["verified"]) == ("harsh", "3", "equal")
    assert (row["ground_truth_declared"], row["own_process_declared"], row["success"]) == ("yes", "no", "0.0")
    monkeypatch.setattr(leaderboard, "audit", lambda file, options: pytest.fail("a current report was made again"))
    for name in ("forged", "chosen", "few", "broken"):
        (tmp_path / "submissions" / f"{name}.json.gz").unlink()
    assert leaderboard.main(args) == 0


@pytest.mark.costly
def test_a_report_that_comes_with_a_forged_submission_is_not_read(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    small_rows(monkeypatch, tmp_path)
    good = tmp_path / "submissions" / "a.json.gz"
    content = content_of(folder / "random.json.gz")
    written(good, content)
    args = leaderboard.Args(folder=tmp_path, splits=(folder / "tiny",))
    assert leaderboard.main(args) == 0
    report = json.loads((tmp_path / "reports" / "a.json").read_text())
    content["episodes"][0]["result"]["collisions"] = 99
    forged = written(tmp_path / "submissions" / "b.json.gz", content)
    claim = report | {"sha256": sha256_of(forged, what="Submission")}
    (tmp_path / "reports" / "b.json").write_text(json.dumps(claim))
    assert leaderboard.main(args) == 1
    assert "b.json.gz: 1 episode differed in the replay" in capsys.readouterr().out
    assert len([line for line in (tmp_path / "table.md").read_text().splitlines() if line.startswith("| ")]) == 3
    assert "| equal | 0 + 0 + 0 |" in (tmp_path / "table.md").read_text(), "the forged copy does not count"


@pytest.mark.costly
def test_a_report_that_contradicts_its_submission_is_made_again(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    small_rows(monkeypatch, tmp_path)
    written(tmp_path / "submissions" / "a.json.gz", content_of(folder / "random.json.gz"))
    args = leaderboard.Args(folder=tmp_path, splits=(folder / "tiny",))
    assert leaderboard.main(args) == 0
    (kept,) = (tmp_path / "cache").rglob("*.json")
    report = json.loads(kept.read_text())
    changes: tuple[dict[str, Any], ...] = (
        {"equal": 0}, {"episodes": 0, "equal": 0}, {"tolerance_m": 1e9}, {"is_first": False}, {"origin": "organiser"},
        {"errors": 1, "equal": 2}, {"nonstandard": ["x"]}, {"physics": 1}, {"oracle_paths": None},
    )  # fmt: skip
    for change in changes:
        kept.write_text(json.dumps(report | change))
        assert leaderboard.main(args) == 0
        again = json.loads(kept.read_text())
        assert {key: again[key] for key in change} == {key: report[key] for key in change}


def test_one_content_under_three_names_is_one_row(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    small_rows(monkeypatch, tmp_path)
    for name in ("a", "b", "c"):
        (tmp_path / "submissions" / f"{name}.json.gz").write_bytes((folder / "random.json.gz").read_bytes())
    assert leaderboard.main(leaderboard.Args(folder=tmp_path, splits=(folder / "tiny",))) == 1
    printed = capsys.readouterr().out
    assert "b.json.gz: its content is that of a.json.gz." in printed
    assert "c.json.gz: its content is that of a.json.gz." in printed
    assert len(list(csv.DictReader((tmp_path / "table.csv").open()))) == 1


@pytest.mark.parametrize("name", ['=HYPERLINK("x").json.gz', "a\u202eb.json.gz", "-a.json.gz", "a b.json.gz"])
def test_a_file_name_that_can_be_interpreted_is_refused(name: str, tmp_path: Path) -> None:
    (tmp_path / "submissions").mkdir()
    (tmp_path / "submissions" / name).write_bytes(b"")
    with pytest.raises(ConfigError, match="is not allowed; use A-Z"):
        leaderboard.main(leaderboard.Args(folder=tmp_path))


@pytest.mark.parametrize(
    ("agent", "name", "reason"),
    [
        ("mine", "Ours", "did not run in a process of its own"),
        ("mine\uff1aNAME", "Ours", "did not run in a process of its own"),
        ("mine:NAME", "Ours", "did not run in a process of its own"),
        ("random", "Stubborn-Plus", "its name is that of the shipped agent 'stubborn-plus', and its agent is 'random'"),
        ("random", "Random", ""),
        ("human+stubborn", "A person", ""),
    ],
)
def test_a_foreign_agent_needs_a_process_of_its_own_and_a_name_of_its_own(
    agent: str, name: str, reason: str, folder: Path
) -> None:
    row = row_of(read_submission(folder / "random.json.gz"), "a.json.gz", "public")
    inputs = msgspec.structs.replace(row.submission.manifest.inputs, agent=agent)
    manifest = msgspec.structs.replace(row.submission.manifest, inputs=inputs, name=name)
    row = replace(row, submission=msgspec.structs.replace(row.submission, manifest=manifest))
    assert row.refusal == "" if not reason else reason in row.refusal


def test_every_submission_that_a_pull_request_changes_is_verified_by_the_code_of_the_base(tmp_path: Path) -> None:
    def git(*words: str, folder: Path) -> None:
        who = ("-c", "user.name=a", "-c", "user.email=a@b")
        subprocess.run(["git", *who, *words], cwd=folder, check=True, capture_output=True)

    origin, base = tmp_path / "origin", tmp_path / "base"
    submissions = origin / "leaderboard" / "submissions"
    submissions.mkdir(parents=True)
    git("init", "-q", "-b", "main", folder=origin)
    (origin / ".ci").mkdir()
    shutil.copy(Path(__file__).parents[4] / ".ci" / "submissions", origin / ".ci")
    for name in ("renamed", "changed", "linked", "deleted", "kept"):
        (submissions / f"{name}.json.gz").write_text(f"{name} " + "a line\n" * 50)
    git("add", ".", folder=origin)
    git("commit", "-qm", "base", folder=origin)
    git("clone", "-q", str(origin), str(base), folder=tmp_path)
    git("checkout", "-qb", "entry", folder=origin)
    (submissions / "renamed.json.gz").rename(submissions / "moved =x.json.gz")
    (submissions / "moved =x.json.gz").write_text("renamed " + "a line\n" * 49 + "forged\n")
    (submissions / "changed.json.gz").write_text("new")
    (submissions / "linked.json.gz").unlink()
    (submissions / "linked.json.gz").symlink_to("kept.json.gz")
    (submissions / "deleted.json.gz").unlink()
    (submissions / "added.json.gz").write_text("new")
    (origin / ".ci" / "submissions").write_text("exit 0\n")
    git("add", "-A", ".", folder=origin)
    git("commit", "-qm", "entry", folder=origin)
    git("update-ref", "refs/pull/7/head", "HEAD", folder=origin)
    git("checkout", "-q", "main", folder=origin)
    stand_in = tmp_path / "verify"
    stand_in.write_text(f'#!/bin/sh\ntest -f "$4" && echo "$4" >> {tmp_path}/verified\n')
    stand_in.chmod(0o755)
    subprocess.run(["bash", ".ci/submissions", "7"], cwd=base, check=True, env={**os.environ, "VERIFY": str(stand_in)})
    names = {Path(line).name for line in (tmp_path / "verified").read_text().splitlines()}
    assert names == {"moved =x.json.gz", "changed.json.gz", "linked.json.gz", "added.json.gz"}


def test_a_tolerance_that_proves_nothing_is_refused(folder: Path) -> None:
    with pytest.raises(ConfigError, match=r"at most 0\.1 m"):
        verify.main(verify.Args(file=folder / "random.json.gz", tolerance_m=1e9))


def test_replicates_are_no_further_episodes_of_a_row(folder: Path) -> None:
    submission = read_submission(folder / "oracle.json.gz")
    copies = [
        msgspec.structs.replace(e, result=msgspec.structs.replace(e.result, episode_id=f"{e.result.episode_id}~{i}"))
        for e in submission.episodes
        for i in range(1, 41)
    ]
    report = Report("0" * 64, 1, 120, 120, 0, 0, 0, 0, is_first=True, nonstandard=(), tolerance_m=0.01)
    fake = msgspec.structs.replace(submission, episodes=copies)
    assert Row(Path("x"), fake, report, SHIPPED).episodes == 3


def test_the_leaderboard_of_the_repository_is_that_of_its_files(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Each submission has a current report, and the tables are those of all of them."""
    monkeypatch.setattr(leaderboard, "audit", lambda file, options: pytest.fail(f"{file} has no current report"))
    shipped = Path(__file__).parents[4] / "leaderboard"
    if any(read_report(file).physics != PHYSICS_VERSION for file in (shipped / "reports").iterdir()):
        pytest.skip("the rows are of an older version of the physics")
    shutil.copytree(shipped, tmp_path / "leaderboard")
    names = {sha256_of(file, what="Submission"): file.name for file in (shipped / "submissions").iterdir()}
    monkeypatch.setattr(
        leaderboard, "kept_file", lambda checked: shipped / "reports" / names[checked.sha256].replace(".gz", "")
    )
    assert leaderboard.main(leaderboard.Args(folder=tmp_path / "leaderboard")) == 0
    for name in ("table.md", "table.csv"):
        assert (tmp_path / "leaderboard" / name).read_bytes() == (shipped / name).read_bytes()


def row_of(submission: Submission, name: str, origin: Origin) -> Row:
    """Returns a row of fifty copies of the episodes of a submission, with this origin of its split."""
    copies = [
        msgspec.structs.replace(e, result=msgspec.structs.replace(e.result, episode_id=f"{e.result.episode_id}_{i}"))
        for e in submission.episodes
        for i in range(50)
    ]
    count = len(copies)
    report = Report(
        "0" * 64, 1, count, count, 0, 0, 0, 0, is_first=True, nonstandard=(), tolerance_m=0.01, origin=origin,
        oracle_paths=7, shortest_paths=2,
    )  # fmt: skip
    return Row(Path(name), msgspec.structs.replace(submission, episodes=copies), report, SHIPPED)


def test_sealed_rows_are_ranked_apart_from_public_ones_and_repeated_actions_are_counted(folder: Path) -> None:
    submission = read_submission(folder / "process.json.gz")
    long_ones = sum(len(entry.actions) >= LONG_ACTIONS for entry in submission.episodes)
    assert long_ones
    inputs = msgspec.structs.replace(submission.manifest.inputs, isolated=True)
    submission.manifest.inputs = inputs
    twice = [row_of(submission, name, "public") for name in ("a", "b")]
    sealed = row_of(submission, "c", "beacon")
    shown = tables([*twice, sealed])
    assert [table.title.split(":")[0] for table in shown] == ["Sealed by a later hash", "Public"]
    assert [len(table.rows) for table in shown] == [1, 2]
    assert repeated(twice) == {"a": 50 * long_ones, "b": 50 * long_ones}
    assert repeated([sealed]) == {"c": 0}
