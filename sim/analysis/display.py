"""Output of a run in the terminal: progress while it runs, tables at the end."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from sim.evaluation.results import SUMMARY_METRICS
from sim.reading import printable

Line = Mapping[str, Any]
MOST_EPISODES_SHOWN = 20
PLAIN_WIDTH = 120
"""Columns of output that is not a terminal (a file, a pipe, a CI log)."""


class PlainConsole(Console):
    """A console for which text is text: brackets are no markup, and control characters are written as escapes."""

    def __init__(self, **options: Any) -> None:
        super().__init__(markup=False, emoji=False, **options)

    def render_str(self, text: str, **options: Any) -> Text:
        """Returns text for the terminal; every text that is printed and every cell of a table comes here."""
        return super().render_str(printable(text), **options)


def make_console() -> Console:
    """Returns a console for the terminal, or for plain text that is wide enough for the tables."""
    console = PlainConsole()
    return console if console.is_terminal else PlainConsole(width=PLAIN_WIDTH)


def with_progress(console: Console, lines: Iterable[dict[str, Any]], *, total: int) -> Iterator[dict[str, Any]]:
    """Yields the lines and shows progress: a bar in a terminal, else one line of text per episode."""
    if console.is_terminal:
        yield from _with_bar(console, lines, total)
        return
    for number, line in enumerate(lines, start=1):
        console.print(f"[{number}/{total}] {describe(line)}", highlight=False, markup=False, soft_wrap=True)
        yield line


def describe(line: Line) -> str:
    """Returns one sentence about an episode."""
    outcome = "found" if line["success"] else f"not found ({line['end_reason']}, {line['failure']})"
    return (
        f"{line['episode_id']}: {line['goal']} {outcome} after {line['num_steps']} steps, {line['wall_time_s']:.0f} s"
    )


def print_results(console: Console, lines: Sequence[Line], summary: Mapping[str, Any]) -> None:
    """Prints the episodes if they are few, and the means with their intervals."""
    if len(lines) <= MOST_EPISODES_SHOWN:
        console.print(_episode_table(lines))
    console.print(_summary_table(summary))
    if summary["failures"]:
        console.print("Failed by " + ", ".join(f"{cause}: {count}" for cause, count in summary["failures"].items()))
    for line in lines:
        if line.get("error"):
            console.print(f"error in {line['episode_id']}: {line['error']}", markup=False, soft_wrap=True)


def _with_bar(console: Console, lines: Iterable[dict[str, Any]], total: int) -> Iterator[dict[str, Any]]:
    columns = (
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        TextColumn("{task.description}", markup=False),
    )
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("loading the first house", total=total)
        for line in lines:
            progress.update(task, advance=1, description=describe(line))
            yield line


def _episode_table(lines: Sequence[Line]) -> Table:
    table = Table(title="Episodes")
    for name in ("episode", "goal"):
        table.add_column(name)
    table.add_column("success")
    for name in ("SPL", "steps", "path m", "shortest m", "left m", "collisions", "steps/s"):
        table.add_column(name, justify="right")
    for line in sorted(lines, key=lambda line: line["episode_id"]):
        table.add_row(
            line["episode_id"],
            line["goal"],
            "yes" if line["success"] else f"no: {line['failure']}",
            _number(line["spl"]),
            str(line["num_steps"]),
            _number(line["path_length"]),
            _number(line["shortest_path"]),
            _number(line["distance_to_goal"]),
            str(line["collisions"]),
            _number(line["steps_per_s"], digits=1),
        )
    return table


def _summary_table(summary: Mapping[str, Any]) -> Table:
    houses = f"{summary['houses']} house" + "s" * (summary["houses"] != 1)
    caption = f"Intervals resample {summary['ci95_resamples']}."
    table = Table(title=f"{summary['episodes']} episodes in {houses}", caption=caption)
    table.add_column("metric")
    table.add_column("mean", justify="right")
    table.add_column("95 % interval", justify="right")
    for metric in SUMMARY_METRICS:
        low, high = summary[metric]["ci95"]
        table.add_row(metric, _number(summary[metric]["mean"], 3), f"[{_number(low, 3)}, {_number(high, 3)}]")
    return table


def _number(value: float | None, digits: int = 2) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
