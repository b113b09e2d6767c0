"""Prints the results of a run in the terminal; `sim.app.analysis.progress` reports its progress."""

from __future__ import annotations

import functools
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from sim.app.evaluation.summary import few_episodes
from sim.core import invocation
from sim.core.errors import debug
from sim.core.reading import printable
from sim.core.vocabulary import counted, plain
from sim.episodes.replicates import episode_of
from sim.task.result import METRICS, EpisodeResult, goals_found

MAX_EPISODES_SHOWN = 20
PLAIN_WIDTH = 120
"""Columns of output that is not a terminal (a file, a pipe, a CI log)."""


class PlainConsole(Console):
    """A console for which text is text: brackets are not markup, and control characters are written as escapes.

    Numbers and paths get no colours.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__(markup=False, emoji=False, highlight=False, **options)

    def render_str(self, text: str, **options: Any) -> Text:
        """Returns text for the terminal; every text that is printed and every cell of a table comes here."""
        return super().render_str(printable(text), **options)


def make_console() -> Console:
    """Returns a console for the terminal, or for plain text that is wide enough for the tables."""
    console = PlainConsole()
    return console if console.is_terminal else PlainConsole(width=PLAIN_WIDTH)


def print_where_to_look(
    console: Console, out: Path, *, video: bool, failed: str | None = None, sharded: bool = False
) -> None:
    """Prints where the results of a run are, and the commands that show them.

    Args:
        console: prints.
        out: folder of the run.
        video: whether its episodes were filmed.
        failed: ID of a failed episode of a split, or of a replicate of it; None: none failed.
        sharded: whether the run is a part of a larger one.
    """
    say = functools.partial(console.print, soft_wrap=True)
    say(f"Results are in {out}: results.jsonl has a line for each episode, summary.json the table above.")
    if video:
        say(f"Videos are in {out}/videos.")
    elif failed is not None:
        whole = ", without --shard" if sharded else ""
        say(f"Film a failure: the same command with --only {episode_of(failed)} --video --out ANOTHER_FOLDER{whole}.")
    say(f"A page about this run: {invocation.command('report', out)}")
    say(f"Watch an agent in the browser, or drive yourself: {invocation.command('web')}")


def describe(result: EpisodeResult) -> str:
    """Returns one sentence about an episode."""
    if result.is_error:
        outcome = "ended with an error"
    elif result.goals is not None:
        outcome = f"and so on, {goals_found(result.goals)}"
    elif result.success:
        outcome = "found"
    else:
        outcome = f"not found ({result.end_reason}, {result.failure})"
    goal, steps = plain(result.goal), counted(result.num_steps, "step")
    return f"{result.episode_id}: {goal} {outcome} after {steps}, {result.wall_time_s or 0.0:.0f} s"


def file_size(size_bytes: int) -> str:
    """Returns the size of a file in the unit that fits it: "812 bytes", "43 kB", "1.2 MB"."""
    if size_bytes < 1000:
        return counted(size_bytes, "byte")
    return f"{size_bytes / 1e3:.0f} kB" if size_bytes < 999_500 else f"{size_bytes / 1e6:.1f} MB"


def print_results(console: Console, results: Sequence[EpisodeResult], summary: Mapping[str, Any]) -> None:
    """Prints the episodes if they are few, and the means with their intervals."""
    if len(results) <= MAX_EPISODES_SHOWN:
        console.print(_episode_table(results))
    console.print(_summary_table(summary))
    if "goals" in summary:
        console.print(_goals_table(summary["goals"]))
    causes = Counter(cause for cause in map(_cause, results) if cause is not None)
    if causes:
        console.print("Failed by " + ", ".join(f"{cause}: {count}" for cause, count in causes.most_common()))
    for result in results:
        if result.error:
            console.print(f"error in {result.episode_id}: {result.error}", soft_wrap=True)
    if any(result.is_error for result in results) and not debug():
        console.print(
            "--debug shows the traceback of an error; --retry-errors with the same --out runs these episodes again.",
            soft_wrap=True,
        )


def _cause(result: EpisodeResult) -> str | None:
    """Returns the cause of a failure, `error` where the episode broke; None if none was recorded, as for a success.

    `results.jsonl` has `misc` for an error, because the causes are those of the paper.
    """
    return "error" if result.is_error else result.failure


def _episode_table(results: Sequence[EpisodeResult]) -> Table:
    table = Table(title="Episodes")
    for name in ("episode", "goal", "success"):
        table.add_column(name)
    for name in ("SPL", "steps", "path m", "shortest m", "to go m", "collisions", "steps/s"):
        table.add_column(name, justify="right")
    for result in sorted(results, key=lambda result: result.episode_id):
        table.add_row(
            result.episode_id,
            _goal_cell(result),
            _success_cell(result),
            _number(result.spl),
            str(result.num_steps),
            _number(result.path_length),
            _number(result.shortest_path),
            _number(result.distance_to_goal),
            str(result.collisions),
            _number(result.steps_per_s, digits=1),
        )
    return table


def _goal_cell(result: EpisodeResult) -> str:
    more = "" if result.goals is None else f" + {len(result.goals) - 1}"
    return plain(result.goal) + more


def _success_cell(result: EpisodeResult) -> str:
    if result.goals is not None and not result.is_error:
        return f"{sum(goal.success == 1.0 for goal in result.goals)} of {len(result.goals)}"
    return "yes" if result.success else f"no: {_cause(result)}"


def _summary_table(summary: Mapping[str, Any]) -> Table:
    segmentation = f"Segmentation: {summary['segmentation']}. " if "segmentation" in summary else ""
    caption = f"{segmentation}Intervals are over {summary['ci95_over']}. {few_episodes(summary['episodes'])}".rstrip()
    if spread := summary.get("replicates"):
        success, spl = (spread[metric]["std"] or 0.0 for metric in ("success", "spl"))
        caption += f" Standard deviation over replicates: success {success:.3f}, SPL {spl:.3f}."
    title = f"{counted(summary['episodes'], 'episode')} in {counted(summary['houses'], 'house')}"
    table = Table(title=title, caption=caption)
    table.add_column("metric")
    table.add_column("mean", justify="right")
    table.add_column("95 % interval", justify="right")
    for metric in (key for key in METRICS if key in summary):
        table.add_row(metric, *_mean_and_interval(summary[metric]))
    return table


def _goals_table(goals: Mapping[str, Any]) -> Table:
    """Returns the means over the goals of chains, by kind and by visit."""
    table = Table(title="Goals of the chains")
    table.add_column("goals")
    for name in ("count", "success", "95 % interval", "SPL", "95 % interval", "success by GOAT", "SPL by GOAT"):
        table.add_column(name, justify="right")
    for name, means in goals.items():
        cells = []
        for key in ("success", "spl"):
            cells += _mean_and_interval(means[key])
        by_goat = [_number(means[key]["mean"], 3) for key in ("goat_success", "goat_spl")]
        table.add_row(name.replace("_", " "), str(means["goals"]), *cells, *by_goat)
    return table


def _mean_and_interval(estimate: Mapping[str, Any]) -> tuple[str, str]:
    low, high = estimate["ci95"]
    return _number(estimate["mean"], 3), "-" if low is None else f"[{_number(low, 3)}, {_number(high, 3)}]"


def _number(value: float | None, digits: int = 2) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
