"""Builds the table of a leaderboard from the submissions in its folder.

    stubborn leaderboard leaderboard

Each submission without a current report is verified first (`stubborn verify`). A submission that is refused, has a
different episode, chose its episodes or has another robot is named and left out; the exit status is then 1.
"""

from __future__ import annotations

import json
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sim.app import cli
from sim.app.analysis.tables import to_markdown
from sim.app.commands.verify import audit
from sim.app.submissions.audit import Choices
from sim.app.submissions.contents import read_submission
from sim.app.submissions.leaderboard import Row, csv_of, is_current, report_file, submission_files, tables
from sim.app.submissions.report import Report, read_report
from sim.core.errors import ConfigError, ObjectNavError
from sim.core.files import write_atomically, write_together
from sim.core.reading import printable, sha256_of


@dataclass(frozen=True, kw_only=True)
class Args:
    """Verify the submissions in a folder and write the table of those that pass."""

    folder: Annotated[tyro.conf.Positional[cli.OutFolder], tyro.conf.arg(metavar="FOLDER")] = Path("leaderboard")
    """Folder with submissions/, to which reports/, table.md and table.csv are written."""
    splits: tuple[Path, ...] = ()
    """Folders of splits that do not ship; the one with the name of a submission's split is used."""
    workers: cli.Count = 1
    """Number of processes."""
    again: bool = False
    """Verify all submissions again."""


def main(args: Args) -> int:
    """Writes the table; returns 1 if a submission is not in it."""
    rows, left_out = [], []
    for file in submission_files(args.folder):
        try:
            row = Row(file, read_submission(file), _report(args, file))
        except ObjectNavError as error:  # the houses of a split can be broken too
            left_out.append(f"{file.name}: {error}")
            continue
        if row.refusal:
            left_out.append(f"{file.name}: {row.refusal}.")
        rows.append(row)
    shown = tables(rows)
    if not shown:
        raise ConfigError(f"No submission in '{args.folder}' can be shown. {' '.join(left_out)}")
    write_together({args.folder / "table.md": to_markdown(shown), args.folder / "table.csv": csv_of(rows)})
    print(printable(to_markdown(shown)))
    for reason in left_out:
        print(printable(f"Left out: {reason}"))
    return int(bool(left_out))


def _report(args: Args, file: Path) -> Report:
    """Returns the report on a submission; it is verified if there is no report, or one of another file or version."""
    kept = report_file(args.folder, file)
    if kept.is_file() and not args.again:
        report = read_report(kept)
        if is_current(report, sha256_of(file, what="Submission")):
            return report
    name = read_submission(file).manifest.split.name
    folder = next((split for split in args.splits if split.resolve().name == name), None)
    print(f"Verifying {file.name}.")
    choices = Choices(split=folder, draw_seed=secrets.randbits(32), workers=args.workers)
    write_atomically(kept, json.dumps(audit(file, choices), indent=2) + "\n")
    return read_report(kept)
