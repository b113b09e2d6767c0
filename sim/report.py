"""Writes the report of a run, or of two runs side by side, as one HTML page.

    python -m sim.report runs/mine                 # writes runs/mine/report.html
    python -m sim.report runs/before runs/after    # writes runs/after/report_against_before.html

For a run with `--record` it has a picture of each episode. No episode is run again; the page needs no network.
"""

from __future__ import annotations

import shlex
import sys
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim import cli
from sim.analysis import display
from sim.analysis.comparison import read_run
from sim.analysis.report.build import build_page
from sim.files import require_writable, write_atomically


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write the report of a run, or of two runs of the same episodes, as one HTML page."""

    run: tyro.conf.Positional[Path]
    """Folder of a run."""
    other: tyro.conf.Positional[Path | None] = None
    """Folder of another run of the same episodes, which is compared with the first."""
    out: cli.OutFile | None = None
    """The page (RUN/report.html, or OTHER/report_against_RUN.html)."""


def main(args: Args) -> int:
    """Reads the runs and writes the page; returns the exit status."""
    runs = [read_run(args.run), *([read_run(args.other)] if args.other is not None else [])]
    out = args.out or _default_out(args)
    require_writable(out, name="--out", folder=False)
    paths = [str(path) for path in (args.run, args.other) if path is not None]
    console = display.make_console()
    console.print(
        f"{max(len(run.lines) for run in runs)} episodes; each house takes about a second, each goal in it a tenth."
    )
    page = build_page(runs, out_folder=out.parent, command=shlex.join(["python", "-m", "sim.report", *paths]))
    write_atomically(out, page)
    message = f"{out} ({out.stat().st_size / 1e6:.1f} MB)"
    console.print(message, highlight=False, markup=False, soft_wrap=True)
    return 0


def _default_out(args: Args) -> Path:
    if args.other is None:
        return args.run / "report.html"
    return args.other / f"report_against_{args.run.resolve().name}.html"


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
