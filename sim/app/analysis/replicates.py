"""States how far replicates of the same episodes differ (`stubborn run --replicates`), which is chance alone."""

from __future__ import annotations

from collections.abc import Sequence

from sim.app.analysis.comparison import Line
from sim.app.analysis.metrics import SPL, SUCCESS, episodes_of
from sim.app.evaluation.intervals import replicate_spread
from sim.app.evaluation.results import metric_value


def replicate_note(lines: Sequence[Line]) -> str:
    """Returns the sentence on the spread of a run's success and SPL; "" for a run without replicates."""
    spreads = [_spread([metric_value(line, metric.key) for line in lines], lines) for metric in (SUCCESS, SPL)]
    return _sentence(spreads, lines, "the mean over one replicate of each")


def difference_note(first: Sequence[Line], second: Sequence[Line]) -> str:
    """Returns the sentence on the spread of the difference of two runs with paired lines; "" without replicates."""
    spreads = []
    for metric in (SUCCESS, SPL):
        pairs = zip(*([metric_value(line, metric.key) for line in lines] for lines in (first, second)), strict=True)
        spreads.append(_spread([None if a is None or b is None else b - a for a, b in pairs], first))
    return _sentence(spreads, first, "the difference over one replicate of each")


def _spread(values: Sequence[float | None], lines: Sequence[Line]) -> float | None:
    return replicate_spread(values, episodes_of(lines))


def _sentence(spreads: Sequence[float | None], lines: Sequence[Line], what: str) -> str:
    success, spl = spreads
    if success is None or spl is None:
        return ""
    count = len(set(episodes_of(lines)))
    return (
        f"{len(lines)} replicates of {count} episodes, each of which counts once. Chance alone gives {what} a standard "
        f"deviation of {100.0 * success:.1f} points of success and {spl:.3f} of SPL."
    )
