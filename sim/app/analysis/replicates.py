"""States how far replicates of the same episodes differ (`stubborn run --replicates`), which is chance alone."""

from __future__ import annotations

from collections.abc import Sequence

from sim.app.analysis.metrics import SPL, SUCCESS, episodes_of
from sim.app.evaluation.intervals import replicate_spread
from sim.task.result import EpisodeResult


def replicate_note(results: Sequence[EpisodeResult]) -> str:
    """Returns the sentence on the spread of a run's success and SPL; "" for a run without replicates."""
    spreads = [_spread(list(map(metric.value, results)), results) for metric in (SUCCESS, SPL)]
    return _sentence(spreads, results, "the mean over one replicate of each")


def difference_note(first: Sequence[EpisodeResult], second: Sequence[EpisodeResult]) -> str:
    """Returns the sentence on the spread of the difference of two runs with paired results; "" without replicates."""
    spreads = []
    for metric in (SUCCESS, SPL):
        pairs = zip(*(map(metric.value, results) for results in (first, second)), strict=True)
        spreads.append(_spread([None if a is None or b is None else b - a for a, b in pairs], first))
    return _sentence(spreads, first, "the difference over one replicate of each")


def _spread(values: Sequence[float | None], results: Sequence[EpisodeResult]) -> float | None:
    return replicate_spread(values, episodes_of(results))


def _sentence(spreads: Sequence[float | None], results: Sequence[EpisodeResult], what: str) -> str:
    success, spl = spreads
    if success is None or spl is None:
        return ""
    count = len(set(episodes_of(results)))
    return (
        f"{len(results)} replicates of {count} episodes; each episode counts once. Chance alone gives {what} a "
        f"standard deviation of {100.0 * success:.1f} points of success and {spl:.3f} of SPL."
    )
