"""Means over episodes with 95 % bootstrap intervals that resample houses, then the episodes of each house.

Episodes in one house are similar, so they are not independent samples. The two-stage cluster bootstrap (Davison and
Hinkley 1997, section 3.8) samples houses with replacement and, within each sampled house, as many of its episodes with
replacement as the house has. The mean is over all sampled episodes. The interval is the 2.5 % and 97.5 % percentiles of
the means. It describes other houses of the same kind, not only these.

It is conservative: the mean of a sampled house varies with its episodes twice, in the data and in the second stage. In
simulations with 20 houses of 10 episodes, intervals were 1.4 times as wide as those over episodes and contained the
true mean in 98 % of the samples where houses are similar, and in 95 % where they differ much (those over episodes: 92 %
and 80 %).

With one house there is no sample of houses. Its episodes are resampled alone, and the interval describes other
episodes in this house only; `Estimate.houses` is then 1, and tables mark the interval with an asterisk. With two to
about ten houses the interval tends to be too narrow.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Value = float | bool | None
RESAMPLES = 10_000
MIN_PAIRS = 20
"""A difference with fewer pairs is never significant: the interval of a few values is too narrow, and that of equal
values has no width."""
_BLOCK = 500_000
"""Episodes that are sampled at the same time; bounds the memory to about 20 MB."""


@dataclass(frozen=True)
class Estimate:
    """A mean over episodes, a paired difference or a ratio, with its 95 % interval; None without episodes."""

    mean: float | None
    low: float | None
    high: float | None
    count: int
    """Episodes, or pairs of episodes, that have a value."""
    houses: int
    """Houses of these episodes. 1: the interval is over the episodes of this one house."""
    neutral: float = 0.0
    """The value that two equal runs give: 0 for a difference, 1 for a ratio."""

    @property
    def significant(self) -> bool:
        """True for a significant comparison: its interval excludes `neutral` and it has at least `MIN_PAIRS` pairs."""
        if self.low is None or self.high is None or self.count < MIN_PAIRS:
            return False
        return not self.low <= self.neutral <= self.high

    @property
    def pairs_needed(self) -> int | None:
        """The number of pairs with which this difference, if it is the true one, would be about significant.

        The width of an interval falls with the square root of the number of pairs, if the houses become more in the
        same proportion: more episodes in the same houses do less. None: the comparison is significant, or its value
        is the neutral one, or its houses are one.
        """
        if self.mean is None or self.low is None or self.high is None or self.houses < 2 or self.significant:
            return None
        off = abs(self.mean - self.neutral)
        if off == 0.0:
            return None
        return max(MIN_PAIRS, math.ceil(self.count * (0.5 * (self.high - self.low) / off) ** 2))


def estimate(values: Sequence[Value], houses: Sequence[str]) -> Estimate:
    """Returns the mean of the values that are not None, and its interval.

    Args:
        values: one for each episode.
        houses: the house of each episode.

    Raises:
        ValueError: the two have different lengths.
    """
    known = [(float(value), house) for value, house in zip(values, houses, strict=True) if value is not None]
    if not known:
        return Estimate(None, None, None, 0, 0)
    numbers = np.array([value for value, _ in known])
    names = [house for _, house in known]
    low, high = bootstrap_interval(numbers, names)
    return Estimate(float(numbers.mean()), low, high, len(known), len(set(names)))


def paired_difference(first: Sequence[Value], second: Sequence[Value], houses: Sequence[str]) -> Estimate:
    """Returns the mean of second minus first over pairs, and its interval; pairs with a None are ignored.

    Args:
        first: one value for each episode.
        second: values of the same episodes in the same order.
        houses: the house of each episode.

    Raises:
        ValueError: the arguments have different lengths.
    """
    pairs = zip(first, second, strict=True)
    return estimate([None if a is None or b is None else float(b) - float(a) for a, b in pairs], houses)


def ratio_of_medians(
    first: Sequence[Value], second: Sequence[Value], houses: Sequence[str], *, resamples: int = RESAMPLES
) -> Estimate:
    """Returns the median of second over the median of first, and its interval; pairs with a None are ignored.

    Each resample draws houses and then pairs of their episodes, as the module says, and takes both medians of them. A
    ratio to 0 is infinite.

    Args:
        first: one value for each episode, 0 or more.
        second: values of the same episodes in the same order.
        houses: the house of each episode.
        resamples: number of resamples.

    Raises:
        ValueError: the arguments have different lengths.
    """
    known = sorted(
        (house, float(a), float(b))
        for a, b, house in zip(first, second, houses, strict=True)
        if a is not None and b is not None
    )
    if not known:
        return Estimate(None, None, None, 0, 0, neutral=1.0)
    values = np.array([pair for _, *pair in known]).T
    _, starts = np.unique([house for house, *_ in known], return_index=True)
    clusters = np.split(np.arange(len(known)), starts[1:])
    rng = np.random.default_rng(0)
    ratios = np.empty(resamples)
    for number, drawn in enumerate(rng.integers(len(clusters), size=(resamples, len(clusters))).tolist()):
        pairs = np.concatenate([rng.choice(clusters[i], len(clusters[i])) for i in drawn])
        ratios[number] = _ratio_of_medians(values[:, pairs])
    low, high = np.percentile(ratios, [2.5, 97.5], method="nearest")  # ratios may be infinite
    return Estimate(_ratio_of_medians(values), float(low), float(high), len(known), len(clusters), neutral=1.0)


def bootstrap_interval(
    values: NDArray[np.float64], houses: Sequence[str], *, seed: int = 0, resamples: int = RESAMPLES
) -> tuple[float, float]:
    """Returns the 95 % percentile interval of the mean; it does not depend on the order of the episodes.

    Args:
        values: (n,) at least one.
        houses: the house of each value.
        seed: of the resamples.
        resamples: number of resamples.
    """
    names = np.asarray(houses)
    order = np.lexsort((values, names))
    _, starts, sizes = np.unique(names[order], return_index=True, return_counts=True)
    clusters = np.split(np.asarray(values, np.float64)[order], starts[1:])
    rng = np.random.default_rng(seed)
    drawn = rng.integers(len(clusters), size=(resamples, len(clusters)), dtype=np.int32)
    sums = _resampled_sums(clusters, drawn.ravel(), rng).reshape(drawn.shape)
    low, high = np.percentile(sums.sum(axis=1) / sizes[drawn].sum(axis=1), [2.5, 97.5])
    return float(low), float(high)


def _ratio_of_medians(pairs: NDArray[np.float64]) -> float:
    """Returns the median of the second row over that of the first, for an array (2, n)."""
    below, above = np.median(pairs, axis=1)
    return float(above / below) if below > 0.0 else math.inf


def _resampled_sums(
    clusters: Sequence[NDArray[np.float64]], drawn: NDArray[np.int32], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Returns (n,) sums, one for each sampled cluster: it has m values, and m of them are sampled with replacement."""
    by_cluster = np.argsort(drawn.astype(np.min_scalar_type(len(clusters))), kind="stable")  # radix sort below 65,536
    sums = []
    for cluster, count in zip(clusters, np.bincount(drawn, minlength=len(clusters)).tolist(), strict=True):
        block = max(1, _BLOCK // len(cluster))
        for rows in (min(block, count - first) for first in range(0, count, block)):
            chosen = rng.integers(len(cluster), size=(rows, len(cluster)), dtype=np.int32)
            sums.append(cluster[chosen].sum(axis=1))
    found = np.empty(len(drawn))
    found[by_cluster] = np.concatenate(sums)
    return found
