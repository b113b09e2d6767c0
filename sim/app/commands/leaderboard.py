"""Builds the table of a leaderboard from the submissions in its folder.

    stubborn leaderboard leaderboard

Each submission that can have a row is verified (`stubborn verify`), once on this machine: the outcome is kept in the
user's cache. Reports next to the submissions are written and never read. A submission that is refused, has too few
episodes or a different one, chose its episodes, has another robot or is a copy is named and left out; the exit status
is then 1.
"""

from __future__ import annotations

import contextlib
import json
import secrets
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sim.app import cli
from sim.app.analysis.tables import to_markdown
from sim.app.commands.verify import audit, truth_of_agents
from sim.app.composition.agents import SPECS
from sim.app.evaluation.results import HUMAN_NAME
from sim.app.submissions.audit import AuditOptions, check
from sim.app.submissions.contents import read_submission
from sim.app.submissions.leaderboard import (
    Row,
    csv_of,
    refusal_before_replay,
    report_file,
    submission_files,
    tables,
    without_copies,
)
from sim.app.submissions.report import is_of, kept_file, read_report
from sim.core.errors import ConfigError, ObjectNavError
from sim.core.files import write_atomically, write_together
from sim.core.reading import printable, read_text


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
            row = _row(args, file)
        except ObjectNavError as error:  # the houses of a split can be broken too
            left_out.append(f"{file.name}: {error}")
            continue
        if row.refusal:
            left_out.append(f"{file.name}: {row.refusal}.")
        else:
            rows.append(row)
    rows, copies = without_copies(rows)
    left_out += [f"{copy}." for copy in copies]
    shown = tables(rows)
    if not shown:
        raise ConfigError(f"No submission in '{args.folder}' can be shown. {' '.join(left_out)}")
    write_together({args.folder / "table.md": to_markdown(shown), args.folder / "table.csv": csv_of(rows)})
    print(printable(to_markdown(shown)))
    for reason in left_out:
        print(printable(f"Left out: {reason}"))
    return int(bool(left_out))


def _row(args: Args, file: Path) -> Row:
    """Returns the row of a submission, which is replayed unless this machine has replayed it before.

    Raises:
        ConfigError: the table has no such row, whatever the replay shows.
    """
    name = read_submission(file).manifest.split.name
    folder = next((split for split in args.splits if split.resolve().name == name), None)
    options = AuditOptions(split=folder, draw_seed=secrets.randbits(32), workers=args.workers)
    checked = check(file, options, truth_of_agents())
    shipped = frozenset((*SPECS, HUMAN_NAME))
    refusal = refusal_before_replay(checked.submission, checked.is_first, checked.changes, shipped)
    if refusal:
        raise ConfigError(f"{refusal}.")
    kept, report = kept_file(checked), None
    if kept.is_file() and not args.again:
        with contextlib.suppress(ConfigError):  # of another form: it is written again
            report = read_report(kept)
    if report is None or not is_of(report, checked, options.tolerance_m):
        print(f"Verifying {file.name}.")
        kept.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(kept, json.dumps(audit(file, options), indent=2) + "\n")
        report = read_report(kept)
    write_atomically(report_file(args.folder, file), read_text(kept, what="Report"))
    return Row(file, checked.submission, report, shipped)
