"""Several runs in their order as a trend: a small chart for each metric, with the 95 % intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sim.app.analysis.metrics import COLLISIONS, FIRST_SIGHT, SPL, SUCCESS, mean_cell
from sim.app.analysis.report.figures import Runs
from sim.app.analysis.tables import Cell
from sim.task.result import Metric

METRICS: tuple[Metric, ...] = (SUCCESS, SPL, FIRST_SIGHT, COLLISIONS)
MIN_RUNS = 3
"""Least number of runs that make a trend."""
WIDTH, HEIGHT = 320, 170
"""Size of a chart in its own units, margins included."""
LEFT, RIGHT, TOP, BOTTOM = 44, 8, 10, 24
"""Margins of the plotted area."""


@dataclass(frozen=True)
class Point:
    """One run in a chart: place of the mean and of the ends of its interval, in the units of the chart."""

    label: str
    x: float
    y: float
    low_y: float
    high_y: float
    text: str


@dataclass(frozen=True)
class Chart:
    """The trend of one metric."""

    title: str
    points: Sequence[Point]
    top: str
    """Text at the upper end of the axis, which begins at 0."""
    half: str
    """Text at its middle."""

    @property
    def line(self) -> str:
        """The points of a polyline through the means."""
        return " ".join(f"{p.x:.1f},{p.y:.1f}" for p in self.points)


def trend(runs: Runs, labels: Sequence[str]) -> list[Chart]:
    """Returns the charts of at least `MIN_RUNS` runs; none for fewer. Metrics that no run has are left out."""
    if len(runs) < MIN_RUNS:
        return []
    charts = (_chart(metric, [mean_cell(metric, lines) for lines in runs], labels) for metric in METRICS)
    return [chart for chart in charts if chart.points]


def _chart(metric: Metric, cells: Sequence[Cell], labels: Sequence[str]) -> Chart:
    highest = max((cell.estimate.ends[1] for cell in cells), default=0.0)
    top = 1.0 if metric.percent or highest <= 0.0 else _round_up(highest)
    step = (WIDTH - LEFT - RIGHT) / len(cells)

    def place(value: float) -> float:
        return TOP + (HEIGHT - TOP - BOTTOM) * (1.0 - value / top)

    points = []
    for i, (cell, label) in enumerate(zip(cells, labels, strict=True)):
        value = cell.estimate
        if value.mean is not None:
            low, high = value.ends
            heights = (place(value.mean), place(low), place(high))
            points.append(Point(label, LEFT + step * (i + 0.5), *heights, cell.text()))
    shown = top * (100.0 if metric.percent else 1.0)
    return Chart(metric.title, points, f"{shown:g}", f"{shown / 2:g}")


def _round_up(value: float) -> float:
    """Returns the least of 1, 2, 3, 4, 5, 6, 8 times a power of ten that is not below a positive number."""
    unit = 10.0 ** math.floor(math.log10(value))
    return next(round(n * unit, 12) for n in (1, 2, 3, 4, 5, 6, 8, 10) if n * unit >= value)
