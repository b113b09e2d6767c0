"""Writes the report of a run, or of several runs side by side, as one HTML page.

    stubborn report runs/mine                         # writes runs/mine/report.html
    stubborn report runs/before runs/after            # writes runs/after/report_against_before.html
    stubborn report runs/may runs/june runs/july      # writes runs/july/report_of_3_runs.html

For a run with `--record` it shows a floor plan and a picture of each episode; with `--video`, its video. No episode is
run again; the page needs no network.
"""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim.app import cli
from sim.app.analysis import display
from sim.app.analysis.comparison import read_run
from sim.app.analysis.report.build import MAX_RUNS, build_page
from sim.core.errors import ConfigError
from sim.core.files import require_writable, write_atomically
from sim.core.vocabulary import counted


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write the report of a run, or of several runs of the same episodes, as one HTML page."""

    runs: tyro.conf.Positional[tuple[Path, ...]]
    """Folders of runs; differences are from the first one. Three or more are also shown as a trend, in this order."""
    out: cli.OutFile | None = None
    """The page (RUN/report.html; of several runs LAST/report_against_FIRST.html or LAST/report_of_3_runs.html)."""


def main(args: Args) -> int:
    """Reads the runs and writes the page; returns the exit status."""
    if not 1 <= len(args.runs) <= MAX_RUNS:
        raise ConfigError(f"Give 1 to {MAX_RUNS} folders of runs, got {len(args.runs)}.")
    runs = [read_run(path) for path in args.runs]
    out = args.out or _default_out(args.runs)
    require_writable(out, name="--out", folder=False)
    console = display.make_console()
    console.print(
        f"{counted(max(len(run.results) for run in runs), 'episode')}; "
        "each house takes about a second, each goal in it a tenth."
    )
    command = shlex.join(["stubborn", "report", *map(str, args.runs)])
    write_atomically(out, build_page(runs, out_folder=out.parent, command=command))
    message = f"{out} ({display.file_size(out.stat().st_size)})"
    console.print(message, soft_wrap=True)
    return 0


def _default_out(runs: Sequence[Path]) -> Path:
    if len(runs) == 1:
        return runs[0] / "report.html"
    if len(runs) == 2:
        return runs[1] / f"report_against_{runs[0].resolve().name}.html"
    return runs[-1] / f"report_of_{len(runs)}_runs.html"
