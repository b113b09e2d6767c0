"""Metrics of result lines as columns of tables: the key of the number, its unit and its digits."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from sim.app.analysis.comparison import Line
from sim.app.analysis.tables import Cell
from sim.app.evaluation.intervals import estimate, paired_difference, ratio_of_medians
from sim.app.evaluation.results import AT_MOST_ONE, metric_value
from sim.episodes.replicates import episode_of


@dataclass(frozen=True)
class Metric:
    """A number of a result line, shown as a column."""

    title: str
    key: str
    percent: bool = False
    digits: int = 1

    @property
    def most(self) -> float:
        """The largest possible value: 1, or infinite."""
        return 1.0 if self.key in AT_MOST_ONE else math.inf

    def cell(self, lines: Sequence[Line]) -> Cell:
        """Returns the mean over episodes; one with replicates counts once, with the mean of its lines."""
        values = [metric_value(line, self.key) for line in lines]
        found = estimate(values, houses_of(lines), episodes=episodes_of(lines), most=self.most)
        return Cell(found, self.percent, self.digits)

    def difference(self, first: Sequence[Line], second: Sequence[Line]) -> Cell:
        """Returns the mean of second minus first; both hold the same episodes in the same order."""
        a, b = ([metric_value(line, self.key) for line in lines] for lines in (first, second))
        found = paired_difference(a, b, houses_of(first), episodes=episodes_of(first), most=self.most)
        return Cell(found, self.percent, self.digits, difference=True)

    def median(self, lines: Sequence[Line]) -> str:
        """Returns the median over lines as text; `-` where no line has the number."""
        known = [value for value in (metric_value(line, self.key) for line in lines) if value is not None]
        return f"{statistics.median(map(float, known)):.{self.digits}f}" if known else "-"

    def ratio_of_medians(self, first: Sequence[Line], second: Sequence[Line]) -> Cell:
        """Returns the median of second over that of first; both hold the same episodes in the same order."""
        a, b = ([metric_value(line, self.key) for line in lines] for lines in (first, second))
        found = ratio_of_medians(a, b, houses_of(first), episodes=episodes_of(first))
        return Cell(found, digits=2, difference=True)


def houses_of(lines: Sequence[Line]) -> list[str]:
    """Returns the house of each line."""
    return [str(line["house"]) for line in lines]


def episodes_of(lines: Sequence[Line]) -> list[str]:
    """Returns the id of each line's episode, which its replicates share."""
    return [episode_of(str(line["episode_id"])) for line in lines]


SUCCESS = Metric("success %", "success", percent=True)
SPL = Metric("SPL", "spl", digits=3)
EXPLORED = Metric("GT exploration %", "gt_explored", percent=True)
TRAPPED = Metric("trapped %", "trapped", percent=True)
COLLISIONS = Metric("collisions", "collisions", digits=2)
STEPS = Metric("steps", "num_steps", digits=0)
FIRST_SIGHT = Metric("steps to first sight", "steps_to_first_sight", digits=0)
"""Restricted mean: an episode that never shows the goal counts with the step limit."""
NEVER_SEEN = Metric("never seen %", "never_seen", percent=True)
AREA = Metric("area seen, m2", "area_seen_m2")
AREA_PER_METRE = Metric("area per metre, m2/m", "area_per_metre", digits=2)
