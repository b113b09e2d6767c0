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
from sim.app.analysis.comparison import Run, differences_table, read_run, require_same_episodes
from sim.app.analysis.metrics import SPL, SUCCESS, difference_cell, difference_note, episodes_of, mean_cell
from sim.app.analysis.tables import NOT_SIGNIFICANT, ResultTable, to_csv, to_markdown, to_rich
from sim.app.evaluation.intervals import MIN_PAIRS
from sim.core.files import write_together
from sim.task.result import metrics_for


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
    console.print(verdict(first, second), highlight=False, soft_wrap=True)
    if args.out is not None:
        page = f"{to_markdown([table for table in tables if table.rows])}\n{verdict(first, second)}\n"
        pages = {"comparison.md": page, "comparison.csv": to_csv(tables)}
        write_together({args.out / name: text for name, text in pages.items()})
    return 0


def compare(first: Run, second: Run) -> ResultTable:
    """Returns the means of two runs and their paired differences, one row per metric.

    Raises:
        ConfigError: the runs are of different splits, or share no episode.
    """
    common = require_same_episodes(first, second)
    a, b = ([of.results[i] for i in common] for of in (first, second))
    episodes = len(set(episodes_of(a)))
    against = {metric: difference_cell(metric, a, b) for metric in metrics_for([*a, *b])}
    rows = [(metric.title, [mean_cell(metric, a), mean_cell(metric, b), cell]) for metric, cell in against.items()]
    changed = [i for i in common if first.results[i].success != second.results[i].success]
    notes = [
        f"A: {first.path}, B: {second.path}; {episodes} episodes of both runs.",
        f"not significant: the interval holds 0, or there are fewer than {MIN_PAIRS} pairs.",
    ]
    errors = [sum(result.is_error for result in results) for results in (a, b)]
    if any(errors):
        notes.append(
            f"Ended with an error: {errors[0]} of A, {errors[1]} of B; they are failures, and other metrics omit them."
        )
    if note := difference_note(a, b):
        notes.append(note)
    broken = [x.is_error or y.is_error for x, y in zip(a, b, strict=True)]
    whole = {episode for episode, is_broken in zip(episodes_of(a), broken, strict=True) if not is_broken}
    pairs = {metric.title: cell.estimate.count for metric, cell in against.items()}
    fewer = [f"{title} {count}" for title, count in pairs.items() if count < len(whole)]
    if fewer:
        notes.append(f"Differences of fewer episodes, because the others have no value: {', '.join(fewer)}.")
    if changed:
        lost = [i for i in changed if first.results[i].success > second.results[i].success]
        gained = [i for i in changed if first.results[i].success < second.results[i].success]
        chains = any(result.goals is not None for result in a)
        for name, won in (("A", lost), ("B", gained)):
            start = f"{name} reaches more goals in" if chains else f"Only {name} succeeds in"
            notes.append(f"{start} {len(won)}: {' '.join(won) or '-'}.")
    title = f"B - A, paired over {episodes} episodes"
    return ResultTable("comparison", title, ("metric", "A", "B", "B - A"), rows, notes)


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
    return f"Verdict over {len(set(episodes_of(a)))} episodes. {'. '.join(sentences)}."
