"""Two runs of `sim.run` on the same episodes: how they differ, paired by episode.

python tools/compare_runs.py runs/before runs/after

Differences are the second run minus the first, with 95 % bootstrap intervals over the episodes that both have played.
One whose interval holds 0 is unresolved.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim import cli
from sim.analysis import display
from sim.analysis.comparison import MIN_PAIRS, Run, read_run, require_same_episodes
from sim.analysis.report.figures import METRICS
from sim.analysis.tables import ResultTable, to_markdown, to_rich, write_csv


@dataclass(frozen=True, kw_only=True)
class Args:
    """Compare two runs."""

    first: tyro.conf.Positional[Path]
    """Folder of a run."""
    second: tyro.conf.Positional[Path]
    """Folder of another run on the same episodes."""
    out: Path | None = None
    """Folder for comparison.md and comparison.csv; nothing is written if not given."""


def main(args: Args) -> int:
    """Read, compare, tell; returns the exit status."""
    table = compare(read_run(args.first), read_run(args.second))
    display.make_console().print(to_rich(table))
    if args.out is not None:
        args.out.mkdir(parents=True, exist_ok=True)
        (args.out / "comparison.md").write_text(to_markdown([table]), encoding="utf-8")
        write_csv(args.out / "comparison.csv", [table])
    return 0


def compare(first: Run, second: Run) -> ResultTable:
    """The two runs' means and their paired differences, a row a metric.

    Raises:
        ConfigError: they were made on different splits, or share no episode.
    """
    common = require_same_episodes(first, second)
    a, b = ([of.lines[i] for i in common] for of in (first, second))
    rows = [(metric.title, [metric.cell(a), metric.cell(b), metric.difference(a, b)]) for metric in METRICS]
    changed = [i for i in common if bool(first.lines[i]["success"]) != bool(second.lines[i]["success"])]
    notes = [
        f"A: {first.path}, B: {second.path}; {len(common)} episodes that both have played.",
        f"unresolved: the interval holds 0, or there are fewer than {MIN_PAIRS} pairs.",
    ]
    if changed:
        lost = [i for i in changed if first.lines[i]["success"]]
        gained = [i for i in changed if not first.lines[i]["success"]]
        notes.append(f"Only A succeeds in {len(lost)}: {' '.join(lost) or '-'}.")
        notes.append(f"Only B succeeds in {len(gained)}: {' '.join(gained) or '-'}.")
    title = f"B - A, paired over {len(common)} episodes"
    return ResultTable("comparison", title, ("metric", "A", "B", "B - A"), rows, notes)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
