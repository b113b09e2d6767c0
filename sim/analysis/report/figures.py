"""Computes the numbers of a report: means with intervals, groups of episodes, causes of failure, paired differences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from sim.analysis.comparison import Line
from sim.analysis.metrics import (
    AREA,
    AREA_PER_METRE,
    COLLISIONS,
    EXPLORED,
    FIRST_SIGHT,
    NEVER_SEEN,
    SPL,
    STEPS,
    SUCCESS,
    TRAPPED,
    Metric,
    houses_of,
)
from sim.analysis.tables import Cell
from sim.evaluation.bootstrap import MIN_PAIRS, Estimate, estimate, paired_difference
from sim.interface import GOAL_CATEGORIES
from sim.task.explanations import MEANING, outcome
from sim.task.failures import CAUSES

METRICS = (
    SUCCESS,
    SPL,
    Metric("soft SPL", "soft_spl", digits=3),
    Metric("distance to goal, m", "distance_to_goal", digits=2),
    EXPLORED,
    NEVER_SEEN,
    FIRST_SIGHT,
    AREA,
    AREA_PER_METRE,
    TRAPPED,
    COLLISIONS,
    STEPS,
    Metric("path, m", "path_length", digits=2),
)
"""Metrics by which runs are judged and compared."""
Z95 = 1.959964
FEW = 30
"""Number of episodes below which a bootstrap interval is too narrow; it has no width if all episodes end alike."""


@dataclass(frozen=True)
class Proportion:
    """The number of episodes with a property, among some episodes, and the 95 % interval of their proportion."""

    count: int
    of: int
    interval: tuple[float, float]

    @property
    def percent(self) -> float:
        """The proportion in percent; 0 without episodes."""
        return 100.0 * self.count / self.of if self.of else 0.0


def wilson(count: int, of: int) -> Proportion:
    """Returns a proportion with its Wilson (1927) interval.

    It holds for few episodes too, and has a width where all of them ended alike, but takes them as independent.
    """
    if of == 0:
        return Proportion(0, 0, (0.0, 1.0))
    p, n, zz = count / of, of, Z95**2
    middle, half = p + zz / (2 * n), Z95 * math.sqrt(p * (1 - p) / n + zz / (4 * n * n))
    return Proportion(count, of, (max(0.0, (middle - half) / (1 + zz / n)), min(1.0, (middle + half) / (1 + zz / n))))


@dataclass(frozen=True)
class Group:
    """A row of a table: a group of episodes."""

    name: str
    shares: Sequence[Proportion]
    """One for each run."""
    differences: Sequence[Cell]
    """One for each run after the first: that run minus the first, in percent of the pairs."""
    note: str = ""


Runs = Sequence[Sequence[Line]]
"""The lines of each run; all have the same episodes in the same order."""


def groups(runs: Runs, key: str) -> list[Group]:
    """Returns the success by goal category (in the order of the contract) or by house (by name)."""
    names = [str(line[key]) for line in runs[0]]
    order = [goal for goal in GOAL_CATEGORIES if goal in names]
    return grouped(runs, names, [*order, *sorted(set(names).difference(order))])


def grouped(runs: Runs, names: Sequence[str], order: Sequence[str]) -> list[Group]:
    """Returns the success by group.

    Args:
        runs: the lines of each run.
        names: the group of each episode.
        order: the groups to return; those without an episode are left out.
    """
    found = []
    for name in (name for name in order if name in names):
        some = [[line for line, of in zip(lines, names, strict=True) if of == name] for lines in runs]
        shares = [wilson(sum(bool(line["success"]) for line in lines), len(lines)) for lines in some]
        found.append(Group(name, shares, differences(SUCCESS, some)))
    return found


def causes(runs: Runs) -> list[Group]:
    """Returns the episodes that failed by each cause, the most frequent first; proportions are of all episodes."""
    outcomes, houses = [[outcome(line) for line in lines] for lines in runs], houses_of(runs[0])
    known = {name for names in outcomes for name in names} - {"found"}
    found = []
    for cause in [*(cause for cause in CAUSES if cause in known), *sorted(known.difference(CAUSES))]:
        failed = [[float(name == cause) for name in names] for names in outcomes]
        shares = [_proportion(values, houses) for values in failed]
        against = [
            Cell(paired_difference(failed[0], values, houses), percent=True, difference=True) for values in failed[1:]
        ]
        found.append(Group(cause, shares, against, MEANING.get(cause, _OTHER.get(cause, ""))))
    return sorted(found, key=lambda group: -sum(share.count for share in group.shares))


def _proportion(values: Sequence[float], houses: Sequence[str]) -> Proportion:
    """Returns the proportion of ones with its bootstrap interval over houses, or Wilson's interval for few episodes."""
    if len(values) < FEW:
        return wilson(round(sum(values)), len(values))
    share = estimate(values, houses)
    return Proportion(round(sum(values)), len(values), (share.low or 0.0, share.high or 0.0))


_OTHER = {"error": "The episode ended with an error.", "failed": "No cause was recorded."}


def means(runs: Runs) -> list[tuple[Metric, list[Cell], list[Cell]]]:
    """Returns for each metric its mean in each run, and the paired differences of the others from the first run."""
    return [(metric, [_mean(metric, lines) for lines in runs], differences(metric, runs)) for metric in METRICS]


def _mean(metric: Metric, lines: Sequence[Line]) -> Cell:
    """Returns the mean of a metric; a share of few episodes has Wilson's interval."""
    cell = metric.cell(lines)
    value = cell.estimate
    if not metric.percent or value.mean is None or value.count >= FEW:
        return cell
    low, high = wilson(round(value.mean * value.count), value.count).interval
    return replace(cell, estimate=replace(value, low=low, high=high))


def differences(metric: Metric, runs: Runs) -> list[Cell]:
    """Returns the paired difference of each run after the first: that run minus the first."""
    return [metric.difference(runs[0], lines) for lines in runs[1:]]


def verdict(difference: Estimate) -> str:
    """Returns the verdict on a difference in words."""
    if difference.mean is None:
        return "no pairs"
    if difference.count < MIN_PAIRS:
        return f"fewer than {MIN_PAIRS} pairs"
    if not difference.significant:
        return "not significant"
    return "higher" if difference.mean > 0.0 else "lower"


def few_note(count: int) -> str:
    """Returns a warning about the intervals of few episodes; "" for enough of them."""
    if count >= FEW:
        return ""
    return (
        f"Only {count} episode{'s' * (count != 1)}: the results are uncertain. Intervals of shares in % are Wilson's, "
        "which are valid for few episodes; those of other means are too narrow. With "
        f"{FEW} or more episodes, all are bootstrap intervals."
    )


def interval_note(runs: Runs) -> str:
    """Returns the sentence that says how the bootstrap intervals of a report are made."""
    few = len(runs[0]) < FEW
    kind = "95 % intervals of shares by Wilson, of other means by bootstrap" if few else "95 % bootstrap intervals"
    if len(set(houses_of(runs[0]))) == 1:
        return (
            f"{kind}. There is one house: its episodes are resampled, and the intervals (*) say "
            "nothing about other houses."
        )
    return f"{kind}: houses are resampled, then the episodes of each house."
