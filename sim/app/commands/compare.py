"""Compares two runs of `stubborn run` on the same episodes: fields in which their configurations differ, and results.

stubborn compare runs/before runs/after

Differences are the second run minus the first, paired by episode, over the episodes of both runs, with 95 % intervals
over houses (`sim.app.evaluation.intervals`). A difference is not significant if its interval holds 0. An episode with
replicates counts once, with their mean.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sim.app import cli
from sim.app.analysis import display
from sim.app.analysis.comparison import Run, compare, differences_table, read_run, require_same_episodes
from sim.app.analysis.metrics import SPL, SUCCESS, difference_cell, episodes_of
from sim.app.analysis.tables import NOT_SIGNIFICANT, to_csv, to_markdown, to_rich
from sim.app.evaluation.intervals import MIN_PAIRS
from sim.core.files import write_together
from sim.core.vocabulary import counted


@dataclass(frozen=True, kw_only=True)
class Args:
    """Compare two runs of the same episodes."""

    first: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="FIRST")]
    """Folder of a run."""
    second: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="SECOND")]
    """Folder of another run of the same episodes; differences are SECOND minus FIRST."""
    out: cli.OutFolder | None = None
    """Folder for comparison.md and comparison.csv; nothing is written if not given."""


def main(args: Args) -> int:
    """Reads and compares the runs and prints the tables; returns the exit status."""
    first, second = read_run(args.first), read_run(args.second)
    tables = [differences_table(first, second), compare(first, second)]
    console = display.make_console()
    for table in tables:
        console.print(to_rich(table) if table.rows else "\n".join(table.notes))
    console.print(verdict(first, second), soft_wrap=True)
    if args.out is not None:
        page = f"{to_markdown([table for table in tables if table.rows])}\n{verdict(first, second)}\n"
        pages = {"comparison.md": page, "comparison.csv": to_csv(tables)}
        write_together({args.out / name: text for name, text in pages.items()})
    return 0


def verdict(first: Run, second: Run) -> str:
    """Returns sentences on whether success and SPL differ significantly between two runs.

    Raises:
        ConfigError: the runs are of different splits, or share no episode.
    """
    common = require_same_episodes(first, second)
    a, b = ([of.results[i] for i in common] for of in (first, second))
    sentences = []
    for metric in (SUCCESS, SPL):
        cell = difference_cell(metric, a, b)
        if not cell.verdict:
            sentences.append(f"{metric.title}: no pairs")
        elif cell.verdict == NOT_SIGNIFICANT:
            few = f" (fewer than {MIN_PAIRS} pairs)" if cell.estimate.count < MIN_PAIRS else ""
            sentences.append(f"{metric.title}: no significant difference{few}")
        else:
            sentences.append(f"{metric.title}: B is {cell.verdict}")
        if cell.mean_text != "-":
            sentences[-1] += f", {' '.join(filter(None, (cell.mean_text, cell.interval_text)))}"
        if (needed := cell.estimate.pairs_needed) is not None and needed > cell.estimate.count:
            more = needed / cell.estimate.count
            sentences[-1] += (
                f" (to be significant, this difference needs about {needed} pairs in {more:.1f} times the houses)"
            )
    return f"Verdict over {counted(len(set(episodes_of(a))), 'episode')}. {'. '.join(sentences)}."
