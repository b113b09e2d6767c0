"""Simulates how often 95 % intervals of a mean over episodes contain the true mean, and how wide they are.

python -m tools.research.interval_coverage --samples 1000

A sample has H houses with m episodes each. A house's rate of success is drawn from a beta distribution of mean 0.7,
whose spread is given by the correlation of two episodes in one house. The intervals are:

- `two-stage`: the bootstrap of `sim.evaluation.bootstrap`, houses and then the episodes of each;
- `houses`: the bootstrap of houses with all their episodes;
- `t`: mean and standard error of the means of the houses, with Student's t for H - 1 degrees of freedom.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from sim import cli

MEAN = 0.7
METHODS = ("two-stage", "houses", "t")
SIZES = ((10, 10), (20, 10), (30, 7), (30, 34))
"""Houses and episodes of each; the last are `val`."""

CORRELATIONS = (0.0, 0.1, 0.3)
"""Of two episodes in one house."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Simulate the coverage of intervals."""

    samples: cli.Count = 1000
    """Samples of each row."""
    resamples: cli.Count = 500
    """Resamples of the bootstraps."""
    seed: cli.Seed = 0


def main(args: Args) -> int:
    """Prints the tables; returns the exit status."""
    rng = np.random.default_rng(args.seed)
    print("houses x episodes, correlation: coverage % and width in points of " + ", ".join(METHODS))
    for houses, episodes in SIZES:
        for correlation in CORRELATIONS:
            found = coverage(houses, episodes, correlation, args.samples, args.resamples, rng)
            cells = "  ".join(f"{100 * share:5.1f} {100 * width:5.1f}" for share, width in found)
            print(f"{houses:3d} x {episodes:2d}, {correlation:.1f}:  {cells}", flush=True)
    return 0


def coverage(
    houses: int, episodes: int, correlation: float, samples: int, resamples: int, rng: np.random.Generator
) -> list[tuple[float, float]]:
    """Returns for each method the share of intervals that contain the true mean, and their mean width."""
    hits, widths = np.zeros(len(METHODS)), np.zeros(len(METHODS))
    for _ in range(samples):
        successes = rng.binomial(episodes, rates(houses, correlation, rng))  # (houses,)
        for number, (low, high) in enumerate(intervals(successes, episodes, resamples, rng)):
            hits[number] += low <= MEAN <= high
            widths[number] += high - low
    return list(zip((hits / samples).tolist(), (widths / samples).tolist(), strict=True))


def rates(houses: int, correlation: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """Returns (houses,) rates of success."""
    if correlation == 0.0:
        return np.full(houses, MEAN)
    spread = 1.0 / correlation - 1.0
    return rng.beta(MEAN * spread, (1.0 - MEAN) * spread, houses)


def intervals(
    successes: NDArray[np.int64], episodes: int, resamples: int, rng: np.random.Generator
) -> list[tuple[float, float]]:
    """Returns the interval of each method, for (houses,) numbers of successes among `episodes` each."""
    houses = len(successes)
    drawn = successes[rng.integers(houses, size=(resamples, houses))]
    again = rng.binomial(episodes, drawn / episodes)
    ends = [np.percentile(each.mean(axis=1) / episodes, [2.5, 97.5]) for each in (again, drawn)]
    shares = successes / episodes
    half = stats.t.ppf(0.975, houses - 1) * shares.std(ddof=1) / math.sqrt(houses)
    return [(float(low), float(high)) for low, high in ends] + [(shares.mean() - half, shares.mean() + half)]


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
