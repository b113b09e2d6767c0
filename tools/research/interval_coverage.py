"""Simulates how often 95 % intervals of a mean over episodes contain the true mean, and how wide they are.

python -m tools.research.interval_coverage --samples 1000

The true distribution of a metric is that of a recorded run (or of the paired difference of two) in the archive of
results, `docs/tables`. A sample has H houses with m episodes each; its episodes are drawn from that distribution with a
Gaussian copula, so that the normal scores of two episodes in one house have a given correlation. (In the recorded runs
the intraclass correlation of success, SPL and collisions is between -0.09 and 0.14, on average 0.02.) The intervals:

- `ours`: that of `sim.app.evaluation.intervals`, which all results have;
- `t`: mean and standard error of the means of the houses, with Student's t for H - 1 degrees of freedom;
- `houses`: the percentile bootstrap of houses with all their episodes;
- `two-stage`: the percentile bootstrap of houses, then of the episodes of each, of a tenth of the samples;
- `boot-t`: the bootstrap of houses of the studentised mean;
- `BCa`: the bias-corrected and accelerated bootstrap of houses.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri, stdtrit

from sim.app import cli
from sim.app.analysis.metrics import COLLISIONS, SPL, SUCCESS, Metric
from sim.app.evaluation.intervals import Estimate, estimate, paired_difference
from sim.app.evaluation.results import metric_value
from tools.research.result_archive import ARCHIVE, ArchivedRun, RunKey, read_archive
from tools.research.result_definitions import run_key

SIZES = ((10, 10), (15, 7), (20, 15), (30, 7))
"""Houses, and episodes of each, as in the splits that ship."""
CORRELATIONS = (0.0, 0.1)
MEANS = (
    ("val", "oracle gt", SUCCESS), ("val", "stubborn-plus gt", SUCCESS), ("val", "stubborn gt", SUCCESS),
    ("val", "stubborn rednet", SUCCESS), ("large", "cloned gt", SUCCESS), ("val", "random gt", SUCCESS),
    ("val", "oracle gt", SPL), ("val", "stubborn gt", SPL), ("val", "stubborn rednet", SPL),
    ("large", "cloned gt", SPL), ("val", "random gt", SPL), ("val", "stubborn gt", COLLISIONS),
    ("val", "stubborn rednet", COLLISIONS), ("hazards", "stubborn gt", COLLISIONS),
    ("large", "stubborn-i gt", COLLISIONS),
)  # fmt: skip
"""Runs whose mean of a metric is estimated."""
PAIRS = (
    ("val", "stubborn rednet", "stubborn-plus rednet", SUCCESS), ("val", "stubborn gt", "stubborn-plus gt", SUCCESS),
    ("val", "oracle gt", "stubborn-plus gt", SUCCESS), ("hazards", "stubborn gt", "stubborn-ii gt", SUCCESS),
    ("val", "stubborn gt", "stubborn-plus gt", SPL), ("large", "stubborn rednet", "stubborn-plus rednet", SPL),
    ("val", "stubborn gt", "stubborn-plus gt", COLLISIONS), ("val", "stubborn gt", "stubborn-i gt", COLLISIONS),
)  # fmt: skip
"""Runs whose difference, the second minus the first, is estimated."""
SLOWER = 10
"""The share of samples that the slowest method takes is one in so many."""
Values = NDArray[np.float64]
Interval = tuple[Values, Values]


@dataclass(frozen=True, kw_only=True)
class Args:
    """Simulate the coverage of intervals."""

    samples: cli.Count = 1000
    """Samples of each row."""
    resamples: cli.Count = 499
    """Resamples of the bootstraps."""
    only_ours: bool = False
    """Simulate the interval of the results alone."""
    archive: Path = ARCHIVE
    """Archive of result lines."""
    seed: cli.Seed = 0


@dataclass(frozen=True)
class Scenario:
    """A distribution of values, and the function that estimates its mean from (values, houses)."""

    name: str
    values: Values
    """(n,) the recorded ones, sorted."""
    estimate: Callable[[list[float], list[str]], Estimate]


def main(args: Args) -> int:
    """Prints the tables; returns the exit status."""
    rng = np.random.default_rng(args.seed)
    methods = {} if args.only_ours else METHODS
    with tempfile.TemporaryDirectory() as folder:
        known = list(scenarios(read_archive(args.archive, Path(folder), lambda _: None)))
    names = " ".join(f"{name:>12}" for name in ("ours", *methods))
    print(f"Coverage in % and, after /, width over that of t; houses x episodes, correlation\n{'':46}{names}")
    for houses, episodes in SIZES:
        for correlation in CORRELATIONS:
            print(f"{houses} x {episodes}, {correlation}")
            for each in known:
                drawn = samples_of(each.values, (args.samples, houses, episodes), correlation, rng)
                found = [ours(each, drawn), *(method(drawn, args.resamples, rng) for method in methods.values())]
                print(f"  {each.name:44}" + " ".join(_cell(each, interval, student(drawn)) for interval in found))
                sys.stdout.flush()
    return 0


def scenarios(runs: Mapping[RunKey, ArchivedRun]) -> Iterator[Scenario]:
    """Yields the distributions of `MEANS` and `PAIRS`."""

    def values_of(split: str, name: str, metric: Metric) -> list[float | None]:
        agent, semantics = name.split()
        return [metric_value(line, metric.key) for line in runs[run_key(split, agent, semantics)].first_lines()]

    for split, name, metric in MEANS:
        known = [value for value in values_of(split, name, metric) if value is not None]

        def mean(values: list[float], houses: list[str], most: float = metric.most) -> Estimate:
            return estimate(values, houses, most=most)

        yield Scenario(f"{metric.key}, {split}, {name}: {np.mean(known):.3f}", np.sort(known), mean)
    for split, first, second, metric in PAIRS:
        pairs = zip(values_of(split, first, metric), values_of(split, second, metric), strict=False)
        known = [b - a for a, b in pairs if a is not None and b is not None]

        def difference(values: list[float], houses: list[str], most: float = metric.most) -> Estimate:
            return paired_difference([0.0] * len(values), values, houses, most=most)

        name = f"{metric.key}, {split}, {second} - {first.split()[0]}: {np.mean(known):.3f}"
        yield Scenario(name.replace("stubborn-plus", "plus"), np.sort(known), difference)


def samples_of(values: Values, shape: tuple[int, int, int], correlation: float, rng: np.random.Generator) -> Values:
    """Returns samples (samples, houses, episodes) of sorted values (n,)."""
    shared = rng.standard_normal((*shape[:2], 1))
    score = np.sqrt(correlation) * shared + np.sqrt(1.0 - correlation) * rng.standard_normal(shape)
    return values[np.minimum((ndtr(score) * len(values)).astype(np.int64), len(values) - 1)]


def ours(scenario: Scenario, drawn: Values) -> Interval:
    """Returns the intervals of the results; one without ends is the mean itself."""
    samples, houses, episodes = drawn.shape
    names = [f"{i // episodes:02d}" for i in range(houses * episodes)]
    ends = np.empty((2, samples))
    for number, values in enumerate(drawn.reshape(samples, -1).tolist()):
        ends[:, number] = scenario.estimate(values, names).ends
    return ends[0], ends[1]


def student(drawn: Values, resamples: int = 0, rng: np.random.Generator | None = None) -> Interval:
    """Returns the t intervals over the means of houses."""
    means = drawn.mean(axis=2)
    half = stdtrit(means.shape[1] - 1, 0.975) * means.std(axis=1, ddof=1) / np.sqrt(means.shape[1])
    return means.mean(axis=1) - half, means.mean(axis=1) + half


def house_bootstrap(drawn: Values, resamples: int, rng: np.random.Generator) -> Interval:
    """Returns the percentiles over resampled houses."""
    low, high = np.percentile(_resampled(drawn.mean(axis=2), resamples, rng)[0], [2.5, 97.5], axis=0)
    return low, high


def two_stage(drawn: Values, resamples: int, rng: np.random.Generator) -> Interval:
    """Returns the percentiles over resampled houses and resampled episodes of each."""
    some = drawn[: -(-len(drawn) // SLOWER)]
    samples, houses, episodes = some.shape
    ends = np.empty((2, samples))
    for number, of_houses in enumerate(some):
        house = rng.integers(houses, size=(resamples, houses, 1))
        again = of_houses[house, rng.integers(episodes, size=(resamples, houses, episodes))]
        ends[:, number] = np.percentile(again.mean(axis=(1, 2)), [2.5, 97.5])
    return ends[0], ends[1]


def bootstrap_t(drawn: Values, resamples: int, rng: np.random.Generator) -> Interval:
    """Returns the intervals of the studentised mean; a resample without variance is ignored."""
    means = drawn.mean(axis=2)
    centre, error = means.mean(axis=1), means.std(axis=1) / np.sqrt(means.shape[1])
    again, spread = _resampled(means, resamples, rng)
    ratio = np.full_like(again, np.nan)
    np.divide(again - centre, spread, out=ratio, where=spread > 1e-9)
    ratio[:, np.isnan(ratio).all(axis=0)] = 0.0
    low, high = np.nanpercentile(ratio, [2.5, 97.5], axis=0)
    return centre - high * error, centre - low * error


def bca(drawn: Values, resamples: int, rng: np.random.Generator) -> Interval:
    """Returns the bias-corrected and accelerated percentiles over resampled houses."""
    means = drawn.mean(axis=2)
    centre = means.mean(axis=1)
    again = np.sort(_resampled(means, resamples, rng)[0], axis=0)
    below = (again < centre).mean(axis=0) + 0.5 * (again == centre).mean(axis=0)
    bias = ndtri(np.clip(below, 1.0 / resamples, 1.0 - 1.0 / resamples))
    off = means - centre[:, None]
    scale = 6.0 * (off**2).sum(axis=1) ** 1.5
    skew = np.divide((off**3).sum(axis=1), scale, out=np.zeros_like(scale), where=scale > 0.0)
    ends = []
    for score in ndtri([0.025, 0.975]):
        level = ndtr(bias + (bias + score) / (1.0 - skew * (bias + score)))
        ends.append(again[np.clip((level * resamples).astype(int), 0, resamples - 1), np.arange(len(means))])
    return ends[0], ends[1]


def _resampled(means: Values, resamples: int, rng: np.random.Generator) -> tuple[Values, Values]:
    """Returns mean and standard error (resamples, samples) of resampled houses, for (samples, houses) means."""
    houses = means.shape[1]
    weights = rng.multinomial(houses, np.full(houses, 1.0 / houses), resamples) / houses
    again = weights @ means.T
    return again, np.sqrt(np.maximum(weights @ (means**2).T - again**2, 0.0) / houses)


def _cell(scenario: Scenario, interval: Interval, reference: Interval) -> str:
    true, (low, high) = scenario.values.mean(), interval
    held = 100.0 * np.mean((low <= true + 1e-9) & (true - 1e-9 <= high))
    widths = [(upper - lower)[: len(low)].mean() for lower, upper in (interval, reference)]
    return f"{held:6.1f} /{widths[0] / widths[1]:5.2f}"


METHODS = {
    "t": student,
    "houses": house_bootstrap,
    "two-stage": two_stage,
    "boot-t": bootstrap_t,
    "BCa": bca,
}

if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
