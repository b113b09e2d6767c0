"""Computes how many episodes and houses show a difference of success between two agents (docs/tables/resolution.csv).

The variance of a paired difference has a part between houses and one within them, which are estimated from recorded
runs by the analysis of variance of houses with different numbers of episodes (Searle 1971, section 10.2). The rows say
how many houses, with as many episodes each as the recorded ones, show a difference of 3, 5 or 10 points: with a
probability of 80 % its 95 % interval excludes 0. `shown_points` is the smallest difference that the recorded episodes
show with this probability.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from sim.app.analysis.comparison import Line, require_same_episodes
from sim.app.analysis.metrics import SUCCESS, episodes_of
from sim.app.evaluation.results import metric_value
from sim.core.errors import ConfigError
from tools.research.result_archive import ArchivedRun, RunKey
from tools.research.result_definitions import Comparison

POINTS = (3, 5, 10)
POWER = 0.8


def paired_lines(pair: Comparison, runs: Mapping[RunKey, ArchivedRun]) -> tuple[list[Line], list[Line]]:
    """Returns the lines of the episodes of both runs, in the same order.

    Raises:
        ConfigError: a run is not in the archive, or the runs are of different episodes.
    """
    for key in (pair.first, pair.second):
        if key not in runs:
            raise ConfigError(
                f"A comparison of table '{pair.table}' needs a run that the archive does not have: {key}."
            )
    one, other = runs[pair.first], runs[pair.second]
    shared = set(require_same_episodes(one.run, other.run))
    first, second = (
        [line for line in run.first_lines(pair.episodes) if line["episode_id"] in shared] for run in (one, other)
    )
    return first, second


def resolution_record(pair: Comparison, runs: Mapping[RunKey, ArchivedRun]) -> dict[str, str]:
    """Returns a row of resolution.csv.

    Raises:
        ConfigError: a run is not in the archive, or the runs are of different episodes.
    """
    first, second = paired_lines(pair, runs)
    gains = [
        (metric_value(a, SUCCESS.key) or 0.0) - (metric_value(b, SUCCESS.key) or 0.0)
        for a, b in zip(first, second, strict=True)
    ]
    episodes, number = np.unique(episodes_of(first), return_inverse=True)
    means = np.bincount(number, gains) / np.bincount(number)
    house_of = {episode: str(line["house"]) for episode, line in zip(episodes_of(first), first, strict=True)}
    houses, index = np.unique([house_of[episode] for episode in episodes], return_inverse=True)
    between, within = variance_components(means, index)
    per_house = len(episodes) / len(houses)
    of_house = between + within / per_house
    record = {
        "split": pair.first.split,
        "version": pair.first.version,
        "agent": pair.first.name,
        "minus_agent": pair.second.name,
        "semantics": pair.first.semantics,
        "episodes": str(len(episodes)),
        "houses": str(len(houses)),
        "sd_between_houses": f"{math.sqrt(between):.3f}",
        "sd_within_houses": f"{math.sqrt(within):.3f}",
        "shown_points": f"{100.0 * shown_difference(of_house, len(houses)):.1f}",
    }
    for points in POINTS:
        needed = houses_needed(of_house, points / 100.0)
        record |= {f"houses_{points}": str(needed), f"episodes_{points}": str(round(needed * per_house))}
    return record


def variance_components(values: NDArray[np.float64], index: NDArray[np.intp]) -> tuple[float, float]:
    """Returns the variances between and within houses of (n,) values; `index` is the house of each."""
    sizes = np.bincount(index)
    count, total = len(sizes), len(values)
    means = np.bincount(index, values) / sizes
    within = float(((values - means[index]) ** 2).sum()) / max(total - count, 1)  # 0 with one episode in each house
    of_means = float((sizes * (means - values.mean()) ** 2).sum()) / (count - 1)
    size = (total - float((sizes**2).sum()) / total) / (count - 1)
    return max(0.0, (of_means - within) / size), within


def shown_difference(of_house: float, houses: int) -> float:
    """Returns the difference that a number of houses shows with probability `POWER`.

    Args:
        of_house: variance of the mean of a house.
        houses: at least 2.
    """
    quantiles = stdtrit(houses - 1, 0.975) + stdtrit(houses - 1, POWER)
    return float(quantiles) * math.sqrt(of_house / houses)


def houses_needed(of_house: float, difference: float) -> int:
    """Returns the smallest number of houses that show a difference with probability `POWER`; at least 2."""
    houses = 2
    while shown_difference(of_house, houses) > difference:
        houses += 1
    return houses
