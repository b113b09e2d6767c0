"""The summary of a run: means of the metrics with their intervals, spread of replicates, and causes of failure."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any

from sim.app.evaluation.intervals import MIN_EPISODES, estimate, replicate_spread
from sim.app.evaluation.results import RunRecord, segmentation_of
from sim.core.vocabulary import counted
from sim.episodes.replicates import episode_of, replicate_number
from sim.task.result import METRICS, EpisodeResult, metrics_for

OVER_HOUSES, OVER_ONE_HOUSE = "houses", "the episodes of the one house"
"""The units over which the intervals of a summary are taken."""


def summary_of(record: RunRecord, results: Sequence[EpisodeResult]) -> dict[str, Any]:
    """Returns the content of `summary.json`: split and segmentation of the run, and `summarise` of its results."""
    return {
        "split": record.get("split_identity"),
        "segmentation": segmentation_of(record),
    } | summarise(results)


def summarise(results: Sequence[EpisodeResult]) -> dict[str, Any]:
    """Returns the number of episodes and, for each metric of a summary, the mean and its 95 % interval.

    Intervals are over houses (`sim.app.evaluation.intervals`); `ci95_over` says so, and says when one house leaves only
    its episodes. `failures` counts the failed episodes by cause (`sim.task.failures`), the most frequent first.
    Episodes whose value is null do not count for that metric. An episode with replicates (`--replicates`) counts once,
    with their mean; `replicates` then has the means of each replicate and their standard deviation
    (`replicate_spread`). Chains of goals add `goals`.
    """
    houses = [result.house for result in results]
    episodes = [episode_of(result.episode_id) for result in results]
    summary: dict[str, Any] = {
        "episodes": len(set(episodes)),
        "errors": sum(result.is_error for result in results),
        "falls": sum(result.end_reason == "fallen" for result in results),
        "houses": len(set(houses)),
        "ci95_over": OVER_ONE_HOUSE if len(set(houses)) == 1 else OVER_HOUSES,
    }
    for metric in metrics_for(results, summary=True):
        value = estimate(list(map(metric.value, results)), houses, episodes=episodes, most=metric.most)
        summary[metric.key] = {"mean": value.mean, "ci95": [value.low, value.high]}
    summary |= _goals(results)
    summary |= _replicates(results, episodes)
    causes = Counter(result.failure for result in results if result.failure is not None)
    return summary | {"failures": dict(causes.most_common())}


def _goals(results: Sequence[EpisodeResult]) -> dict[str, Any]:
    """Returns, under `goals`, means over the goals of chains: of all, of each kind, of first and of second visits.

    The names are those of GOAT-Bench where it has the number. {}: there are no chains.
    """
    lines = [(result, goal) for result in results for goal in result.goals or ()]
    if not lines:
        return {}
    groups = {
        "all": lines,
        **{kind: [line for line in lines if line[1].kind == kind] for kind in sorted({goal.kind for _, goal in lines})},
        "first_visit": [line for line in lines if line[1].repeats is None],
        "second_visit": [line for line in lines if line[1].repeats is not None],
    }
    means: dict[str, Any] = {}
    for name, members in groups.items():
        means[name] = {"goals": len(members)}
        for field in ("success", "spl", "goat_success", "goat_spl", "num_steps"):
            values = [getattr(goal, field) for _, goal in members]
            most = math.inf if field == "num_steps" else 1.0
            value = estimate(values, [result.house for result, _ in members], most=most)
            means[name][field] = {"mean": value.mean, "ci95": [value.low, value.high]}
    return {"goals": means}


def few_episodes(count: int) -> str:
    """Returns the warning of a summary of too few episodes; "" for enough."""
    if not 0 < count < MIN_EPISODES:
        return ""
    return f"Warning: {counted(count, 'episode')}; with fewer than {MIN_EPISODES}, intervals are rough."


def _replicates(results: Sequence[EpisodeResult], episodes: Sequence[str]) -> dict[str, Any]:
    """Returns, under `replicates`, the mean of each replicate of all episodes and their spread; {} without any."""
    numbers = [replicate_number(result.episode_id) for result in results]
    if len(set(numbers)) < 2:
        return {}
    spreads = {}
    for metric in (METRICS["success"], METRICS["spl"]):
        values = list(map(metric.value, results))
        means = []
        for number in sorted(set(numbers)):
            known = [value for value, of in zip(values, numbers, strict=True) if of == number and value is not None]
            means.append(sum(known) / len(known) if known else None)
        spreads[metric.key] = {"means": means, "std": replicate_spread(values, episodes)}
    return {"replicates": spreads}
