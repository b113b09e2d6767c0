"""Sorts episodes into bins: by shortest path and house size, SPL and time to first sight, confidence of stops."""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sim.app.analysis.report.figures import Proportion, Runs, proportion_of
from sim.task.result import EpisodeResult

SPL_LABELS = ("failed", *(f"{low / 10:g}-{(low + 1) / 10:g}" for low in range(10)))
CONFIDENCE_BINS = 10


@dataclass(frozen=True)
class Bins:
    """Half-open intervals of a number: edge i <= number < edge i + 1, from 0 on; the last one has no end."""

    edges: tuple[float, ...]
    unit: str
    unknown: str
    """Name of the bin of None."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bins in order, `unknown` last."""
        _, second, *_, last = self.edges
        middle = (f"{low:g} to {high:g} {self.unit}" for low, high in itertools.pairwise(self.edges[1:]))
        return f"under {second:g} {self.unit}", *middle, f"{last:g} {self.unit} and more", self.unknown

    def name(self, value: float | None) -> str:
        """Returns the name of the bin of a number, which is at least the first edge."""
        if value is None:
            return self.unknown
        return self.names[max(0, bisect.bisect_right(self.edges, value) - 1)]


DISTANCES = Bins((0.0, 4.0, 8.0, 12.0, 16.0, 24.0, 40.0), "m", "no path")
"""Bins of the shortest path."""
HOUSE_SIZES = Bins((0.0, 60.0, 80.0, 100.0, 125.0, 150.0, 300.0, 500.0), "m²", "size unknown")
"""Bins of the floor area of all rooms of a house."""
FIRST_SIGHTS = (0, 1, 10, 25, 50, 100, 200)
"""First number of steps of each bin of the time to first sight."""
FIRST_SIGHT_LABELS = ("0", "1-9", "10-24", "25-49", "50-99", "100-199", "200 on", "never")
"""Labels of these bins, and of the one of episodes that never showed the goal."""


@dataclass(frozen=True)
class Histogram:
    """Shares of bins in the episodes of each run that have the number."""

    labels: Sequence[str]
    shares: Sequence[Sequence[Proportion]]
    """Shares of each run, one for each label."""

    @property
    def top_percent(self) -> int:
        """Returns the upper end of the axis of all pictures, a multiple of 20 above the intervals of all bars."""
        highest = max((100.0 * s.interval[1] for shares in self.shares for s in shares if s.count), default=100.0)
        return min(100, 20 * math.ceil(highest / 20.0))


def spl_histogram(runs: Runs) -> Histogram:
    """Returns the distribution of SPL: failures in a bin of their own, then tenths."""
    return _histogram(runs, SPL_LABELS, _spl_bin)


def first_sight_histogram(runs: Runs) -> Histogram:
    """Returns the distribution of the steps to first sight, with episodes that never showed the goal as the last bin.

    Episodes that could not begin do not count.
    """
    return _histogram(runs, FIRST_SIGHT_LABELS, _sight_bin)


def _histogram(runs: Runs, labels: Sequence[str], bin_of: Callable[[EpisodeResult], int | None]) -> Histogram:
    shares = []
    for lines in runs:
        counted = [line for line in lines if bin_of(line) is not None]
        bins = [bin_of(line) for line in counted]
        shares.append([proportion_of([number == i for number in bins], counted) for i in range(len(labels))])
    return Histogram(labels, shares)


def _spl_bin(result: EpisodeResult) -> int:
    return 1 + min(9, int(10.0 * result.spl)) if result.success and result.spl > 0.0 else 0


def _sight_bin(result: EpisodeResult) -> int | None:
    if result.gt_explored is None:
        return None
    if result.first_seen_step is None:
        return len(FIRST_SIGHT_LABELS) - 1
    return bisect.bisect_right(FIRST_SIGHTS, result.first_seen_step) - 1


@dataclass(frozen=True)
class StopBin:
    """Stops with a confidence in one interval."""

    low: float
    high: float
    confidence: float
    """Mean of these stops."""
    correct: Proportion


@dataclass(frozen=True)
class Calibration:
    """The agent's confidence at its stops against how many of them are correct."""

    bins: Sequence[StopBin]
    stops: int
    """Episodes that ended with STOP."""
    correct: Proportion
    """Share of correct ones among the stops with a confidence."""
    confidence: float
    """Mean of the stops with a confidence; 0 without any."""

    @property
    def error(self) -> float:
        """Expected calibration error: mean distance of confidence and share over the bins, weighted by their stops."""
        distances = (abs(b.confidence - b.correct.mean) * b.correct.of for b in self.bins)
        return sum(distances) / self.correct.of if self.correct.of else 0.0


def calibration(lines: Sequence[EpisodeResult]) -> Calibration:
    """Returns the calibration of a run's stops; correct ones find the goal, or the last goal of a chain."""
    stops = [result for result in lines if result.end_reason == "stop"]
    rated = [(result, result.stop_confidence) for result in stops if result.stop_confidence is not None]
    bins = []
    for i in range(CONFIDENCE_BINS):
        some = [rating for rating in rated if min(CONFIDENCE_BINS - 1, int(rating[1] * CONFIDENCE_BINS)) == i]
        if some:
            low, high = i / CONFIDENCE_BINS, (i + 1) / CONFIDENCE_BINS
            bins.append(StopBin(low, high, _mean_confidence(some), _correct(some)))
    return Calibration(bins, len(stops), _correct(rated), _mean_confidence(rated))


def _mean_confidence(rated: Sequence[tuple[EpisodeResult, float]]) -> float:
    return sum(confidence for _, confidence in rated) / len(rated) if rated else 0.0


def _correct(rated: Sequence[tuple[EpisodeResult, float]]) -> Proportion:
    lines = [result for result, _ in rated]
    return proportion_of([(line if line.goals is None else line.goals[-1]).success == 1.0 for line in lines], lines)
