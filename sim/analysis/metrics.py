"""Metrics of result lines as columns of tables: the key of the number, its unit and its digits."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from sim.analysis.comparison import Line
from sim.analysis.tables import Cell
from sim.evaluation.bootstrap import estimate, paired_difference, ratio_of_medians
from sim.evaluation.results import metric_value


@dataclass(frozen=True)
class Metric:
    """A number of a result line, shown as a column."""

    title: str
    key: str
    percent: bool = False
    digits: int = 1

    def cell(self, lines: Sequence[Line]) -> Cell:
        """Returns the mean over lines."""
        values = [metric_value(line, self.key) for line in lines]
        return Cell(estimate(values, houses_of(lines)), self.percent, self.digits)

    def difference(self, first: Sequence[Line], second: Sequence[Line]) -> Cell:
        """Returns the mean of second minus first; both hold the same episodes in the same order."""
        a, b = ([metric_value(line, self.key) for line in lines] for lines in (first, second))
        return Cell(paired_difference(a, b, houses_of(first)), self.percent, self.digits, difference=True)

    def pairs(self, first: Sequence[Line], second: Sequence[Line]) -> int:
        """Returns the number of episodes that have the number in both; they are in the same order."""
        both = zip(first, second, strict=True)
        return sum(all(metric_value(line, self.key) is not None for line in pair) for pair in both)

    def median(self, lines: Sequence[Line]) -> str:
        """Returns the median over lines as text; `-` where no line has the number."""
        known = [value for value in (metric_value(line, self.key) for line in lines) if value is not None]
        return f"{statistics.median(map(float, known)):.{self.digits}f}" if known else "-"

    def ratio_of_medians(self, first: Sequence[Line], second: Sequence[Line]) -> Cell:
        """Returns the median of second over that of first; both hold the same episodes in the same order."""
        a, b = ([metric_value(line, self.key) for line in lines] for lines in (first, second))
        return Cell(ratio_of_medians(a, b, houses_of(first)), digits=2, difference=True)


def houses_of(lines: Sequence[Line]) -> list[str]:
    """Returns the house of each line."""
    return [str(line["house"]) for line in lines]


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
