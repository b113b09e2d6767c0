"""Means, differences and ratios of a metric over results, as cells of tables."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from sim.app.analysis.tables import Cell
from sim.app.evaluation.intervals import estimate, paired_difference, ratio_of_medians
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
    """Returns the median over results as text; `-` where no result has the number."""
    known = [value for value in map(metric.value, results) if value is not None]
    return f"{statistics.median(known):.{metric.digits}f}" if known else "-"


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
