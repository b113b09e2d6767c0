"""Metrics of result lines as columns of tables: which number, in which unit, with how many digits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sim.analysis.comparison import Line, Value, estimate, paired_difference
from sim.analysis.tables import Cell


@dataclass(frozen=True)
class Metric:
    """A column: a number of a result line."""

    title: str
    key: str
    percent: bool = False
    digits: int = 1

    def cell(self, lines: Sequence[Line]) -> Cell:
        """Its mean over lines."""
        return Cell(estimate([line_value(line, self.key) for line in lines]), self.percent, self.digits)

    def difference(self, first: Sequence[Line], second: Sequence[Line]) -> Cell:
        """Second minus first, paired."""
        values = ([line_value(line, self.key) for line in lines] for lines in (first, second))
        return Cell(paired_difference(*values), self.percent, self.digits, difference=True)


def line_value(line: Line, key: str) -> Value:
    """Returns the number under this key of a result line; None where there is none."""
    value = line.get(key)
    return None if value is None else float(value)


SUCCESS = Metric("success %", "success", percent=True)
SPL = Metric("SPL", "spl", digits=3)
EXPLORED = Metric("GT exploration %", "gt_explored", percent=True)
TRAPPED = Metric("trapped %", "trapped", percent=True)
COLLISIONS = Metric("collisions", "collisions", digits=2)
STEPS = Metric("steps", "num_steps", digits=0)
