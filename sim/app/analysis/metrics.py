"""Means, differences and ratios of a metric over results, as cells of tables."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from sim.app.analysis.tables import Cell
from sim.app.evaluation.intervals import estimate, paired_difference, ratio_of_medians, replicate_spread
from sim.episodes.replicates import episode_of
from sim.task.result import METRICS, EpisodeResult, Metric

SUCCESS, SPL, COLLISIONS = METRICS["success"], METRICS["spl"], METRICS["collisions"]
STEPS, TRAPPED = METRICS["num_steps"], METRICS["trapped"]
EXPLORED, FIRST_SIGHT = METRICS["gt_explored"], METRICS["steps_to_first_sight"]


def mean_cell(metric: Metric, results: Sequence[EpisodeResult]) -> Cell:
    """Returns the mean over episodes; one with replicates counts once, with the mean of its results."""
    values = list(map(metric.value, results))
    mean = estimate(values, houses_of(results), episodes=episodes_of(results), most=metric.most)
    return Cell(mean, metric.percent, metric.digits)


def difference_cell(metric: Metric, first: Sequence[EpisodeResult], second: Sequence[EpisodeResult]) -> Cell:
    """Returns the mean of second minus first; both hold the same episodes in the same order."""
    a, b = (list(map(metric.value, results)) for results in (first, second))
    difference = paired_difference(a, b, houses_of(first), episodes=episodes_of(first), most=metric.most)
    return Cell(difference, metric.percent, metric.digits, difference=True)


def median_text(metric: Metric, results: Sequence[EpisodeResult]) -> str:
    """Returns the median over results as text, with a half between two whole numbers; `-` without any number."""
    known = [value for value in map(metric.value, results) if value is not None]
    return f"{statistics.median(known):g}" if known else "-"


def ratio_cell(metric: Metric, first: Sequence[EpisodeResult], second: Sequence[EpisodeResult]) -> Cell:
    """Returns the median of second over that of first; both hold the same episodes in the same order."""
    a, b = (list(map(metric.value, results)) for results in (first, second))
    ratio = ratio_of_medians(a, b, houses_of(first), episodes=episodes_of(first))
    return Cell(ratio, digits=2, difference=True)


def houses_of(results: Sequence[EpisodeResult]) -> list[str]:
    """Returns the house of each result."""
    return [result.house for result in results]


def episodes_of(results: Sequence[EpisodeResult]) -> list[str]:
    """Returns the id of each result's episode, which its replicates share."""
    return [episode_of(result.episode_id) for result in results]


def replicate_note(results: Sequence[EpisodeResult]) -> str:
    """Returns the sentence on the spread of a run's success and SPL; "" for a run without replicates."""
    spreads = [_spread(list(map(metric.value, results)), results) for metric in (SUCCESS, SPL)]
    return _sentence(spreads, results, "the mean over one replicate of each")


def difference_note(first: Sequence[EpisodeResult], second: Sequence[EpisodeResult]) -> str:
    """Returns the sentence on the spread of the difference of two runs with paired results; "" without replicates."""
    spreads = []
    for metric in (SUCCESS, SPL):
        pairs = zip(*(map(metric.value, results) for results in (first, second)), strict=True)
        spreads.append(_spread([None if a is None or b is None else b - a for a, b in pairs], first))
    return _sentence(spreads, first, "the difference over one replicate of each")


def _spread(values: Sequence[float | None], results: Sequence[EpisodeResult]) -> float | None:
    return replicate_spread(values, episodes_of(results))


def _sentence(spreads: Sequence[float | None], results: Sequence[EpisodeResult], what: str) -> str:
    success, spl = spreads
    if success is None or spl is None:
        return ""
    count = len(set(episodes_of(results)))
    return (
        f"{len(results)} replicates of {count} episodes; each episode counts once. Chance alone gives {what} a "
        f"standard deviation of {100.0 * success:.1f} points of success and {spl:.3f} of SPL."
    )
