"""The numbers of a report: means with intervals, groups of episodes, causes of failure, and paired differences."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from sim.analysis.comparison import MIN_PAIRS, Estimate, Line, paired_difference
from sim.analysis.metrics import COLLISIONS, EXPLORED, SPL, STEPS, SUCCESS, TRAPPED, Metric
from sim.analysis.report.words import MEANING, outcome
from sim.analysis.tables import Cell
from sim.interface import GOAL_CATEGORIES
from sim.task.failures import CAUSES

METRICS = (
    SUCCESS,
    SPL,
    Metric("soft SPL", "soft_spl", digits=3),
    Metric("distance to goal, m", "distance_to_goal", digits=2),
    EXPLORED,
    TRAPPED,
    COLLISIONS,
    STEPS,
    Metric("path, m", "path_length", digits=2),
)
"""What runs are judged and compared by."""
Z95 = 1.959964


@dataclass(frozen=True)
class Share:
    """How many of some episodes, with the 95 % Wilson interval of their share."""

    count: int
    of: int

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson (1927): holds for few episodes too, and has a width where all of them ended alike."""
        if self.of == 0:
            return 0.0, 1.0
        p, n, zz = self.count / self.of, self.of, Z95**2
        middle, half = p + zz / (2 * n), Z95 * math.sqrt(p * (1 - p) / n + zz / (4 * n * n))
        return max(0.0, (middle - half) / (1 + zz / n)), min(1.0, (middle + half) / (1 + zz / n))

    @property
    def percent(self) -> float:
        """0 for none of none."""
        return 100.0 * self.count / self.of if self.of else 0.0


@dataclass(frozen=True)
class Group:
    """A row of a table: some of the episodes."""

    name: str
    shares: Sequence[Share]
    """One for each run."""
    difference: Cell | None
    """Second minus first, in % of the pairs; None for one run."""
    note: str = ""


Runs = Sequence[Sequence[Line]]
"""The lines of each run; those of two runs are of the same episodes in the same order."""


def groups(runs: Runs, key: str) -> list[Group]:
    """Success by goal category (in the contract's order) or by house (by name)."""
    names = {str(line[key]) for line in runs[0]}
    order = [*(goal for goal in GOAL_CATEGORIES if goal in names), *sorted(names.difference(GOAL_CATEGORIES))]
    found = []
    for name in order:
        some = [[line for line in lines if line[key] == name] for lines in runs]
        shares = [Share(sum(bool(line["success"]) for line in lines), len(lines)) for lines in some]
        found.append(Group(name, shares, SUCCESS.difference(*some) if len(runs) == 2 else None))
    return found


def causes(runs: Runs) -> list[Group]:
    """How many episodes failed by each cause; the shares are of all episodes."""
    outcomes = [[outcome(line) for line in lines] for lines in runs]
    there = {name for names in outcomes for name in names} - {"found"}
    found = []
    for cause in [*(cause for cause in CAUSES if cause in there), *sorted(there.difference(CAUSES))]:
        shares = [Share(names.count(cause), len(names)) for names in outcomes]
        difference = None
        if len(runs) == 2:
            values = [[float(name == cause) for name in names] for names in outcomes]
            difference = Cell(paired_difference(*values), percent=True, difference=True)
        found.append(Group(cause, shares, difference, MEANING.get(cause, _OTHER.get(cause, ""))))
    return sorted(found, key=lambda group: -sum(share.count for share in group.shares))


_OTHER = {"error": "The episode could not be played to its end.", "failed": "No cause was written down."}


def means(runs: Runs) -> list[tuple[Metric, list[Cell]]]:
    """Each metric: its mean in each run and, for two runs, the paired difference."""
    return [(metric, [*map(metric.cell, runs), *_differences(metric, runs)]) for metric in METRICS]


def verdict(estimate: Estimate) -> str:
    """What a difference says, in words."""
    if estimate.mean is None or estimate.low is None or estimate.high is None:
        return "no pairs"
    if estimate.count < MIN_PAIRS:
        return f"fewer than {MIN_PAIRS} pairs"
    if not estimate.resolved:
        return "unresolved"
    return "higher" if estimate.mean > 0.0 else "lower"


def _differences(metric: Metric, runs: Runs) -> Iterable[Cell]:
    return [metric.difference(*runs)] if len(runs) == 2 else []
