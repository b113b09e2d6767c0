"""Reports the progress of a run in the terminal: episodes, their steps, steps per second and the time left."""

from __future__ import annotations

import contextlib
import itertools
import threading
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from sim.app.analysis.display import describe
from sim.app.evaluation.watch import Steps
from sim.core.vocabulary import with_article
from sim.episodes.episode import Episode
from sim.task.result import EpisodeResult

QUIET_S = 5.0
"""First interval between two lines on a running episode, if the output is not a terminal; the interval then grows."""
LONGEST_QUIET_S = 60.0
"""Longest interval between two such lines: the log of a long episode stays short."""
MAX_NAMED = 3
"""Largest number of running episodes that a line names."""


@dataclass(frozen=True)
class _Running:
    """An episode that runs."""

    steps: Steps
    since_s: float


class ProgressReport:
    """Reports which episodes begin, run and end: with a progress bar in a terminal, else with lines of text.

    A line is printed when an episode begins, when it ends, and in between at intervals of `QUIET_S` to
    `LONGEST_QUIET_S`, so that a log or a pipe shows that the run continues.

    Args:
        console: prints the lines.
        total: number of episodes.
        max_steps: largest number of steps of an episode.
        quiet_s: see `QUIET_S`.
    """

    def __init__(self, console: Console, *, total: int, max_steps: int, quiet_s: float = QUIET_S) -> None:
        self._console, self._total, self._max_steps, self._quiet_s = console, total, max_steps, quiet_s
        self._running: dict[str, _Running] = {}
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._wait_s = quiet_s
        self._printed_s = time.monotonic()
        self._first: tuple[float, int] | None = None
        """Time and number of steps at the first report with steps, when house and kernels were loaded."""
        self._done = self._steps_done = 0
        self._bar = _bar(console) if console.is_terminal else None

    def started(self, episode: Episode, steps: Steps) -> None:
        """Reports that an episode begins; `steps` returns its number of steps so far."""
        with self._lock:
            self._running[episode.episode_id] = _Running(steps, time.monotonic())
            goal = f"the picture of {episode.goal}" if episode.in_picture else with_article(episode.goal)
            self._print(f"{episode.episode_id} begins: looking for {goal} in house {episode.house}")

    def over(self, results: Iterable[EpisodeResult]) -> Iterator[EpisodeResult]:
        """Yields the results, and reports the progress until the last one."""
        watch = threading.Thread(target=self._report_running, daemon=True, name="progress")
        with contextlib.ExitStack() as stack:
            if self._bar is not None:
                stack.enter_context(self._bar)
                self._task = self._bar.add_task("loading the first house", total=self._total)
            watch.start()
            stack.callback(watch.join)
            stack.callback(self._over.set)
            for result in results:
                self._ended(result)
                yield result

    def _ended(self, result: EpisodeResult) -> None:
        with self._lock:
            self._running.pop(result.episode_id, None)
            self._done += 1
            self._wait_s = self._quiet_s
            self._steps_done += result.num_steps
            if self._bar is not None:
                self._bar.update(self._task, completed=self._done)
            self._print(f"[{self._done}/{self._total}] {describe(result)}")

    def _report_running(self) -> None:
        while not self._over.wait(min(0.5, self._quiet_s)):
            with self._lock:
                due = self._bar is not None or time.monotonic() - self._printed_s >= self._wait_s
                if self._running and due:
                    self._print_running()
                    self._wait_s = min(1.5 * self._wait_s, LONGEST_QUIET_S)

    def _print_running(self) -> None:
        now_s = time.monotonic()
        steps = {name: episode.steps() for name, episode in self._running.items()}
        named = [
            f"{name} for {now_s - self._running[name].since_s:.0f} s"
            if count is None
            else f"{name}, step {count} of {self._max_steps}"
            for name, count in itertools.islice(steps.items(), MAX_NAMED)
        ]
        others = f" and {len(steps) - MAX_NAMED} more" if len(steps) > MAX_NAMED else ""
        counts = [0 if count is None else count for count in steps.values()]
        pace = self._pace(counts, now_s) if None not in steps.values() else ""
        if self._bar is None:
            self._print(f"[{self._done}/{self._total}] running: {'; '.join(named)}{others}{pace}")
        else:
            shown = self._done + sum(min(0.99, count / self._max_steps) for count in counts)
            self._bar.update(self._task, completed=min(shown, self._total - 0.01))
            self._print(f"{'; '.join(named)}{others}{pace}")

    def _pace(self, counts: list[int], now_s: float) -> str:
        """Returns a text with the steps per second since the first steps and the time left; "" before the first steps.

        An episode is expected to have the mean number of steps of those that have ended; before the first has ended, it
        is expected to have the largest number of steps.
        """
        made = self._steps_done + sum(counts)
        if self._first is None and made > 0:
            self._first = now_s, made
        if self._first is None or made <= self._first[1]:
            return ""
        expected = self._steps_done / self._done if self._done else float(self._max_steps)
        waiting = self._total - self._done - len(counts)
        remaining = waiting * expected + sum(max(0.0, expected - count) for count in counts)
        rate, bound = (made - self._first[1]) / (now_s - self._first[0]), "about" if self._done else "at most"
        if remaining < rate:  # less than a second: the last episodes are longer than the ones before them
            return f"; {rate:.1f} steps/s"
        return f"; {rate:.1f} steps/s, {bound} {_duration(remaining / rate)} left"

    def _print(self, words: str) -> None:
        self._printed_s = time.monotonic()
        if self._bar is not None:
            self._bar.update(self._task, description=words)
            return
        self._console.print(words, soft_wrap=True)
        self._console.file.flush()


def _duration(seconds: float) -> str:
    """Returns a duration in words: "40 s", "12 min", "3.5 h"."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400.0 else f"{seconds / 3600:.1f} h"


def _bar(console: Console) -> Progress:
    columns = (BarColumn(bar_width=20), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, TextColumn("{task.description}", markup=False), console=console)
