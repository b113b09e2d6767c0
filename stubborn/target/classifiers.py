"""Two classes, false (0) and true (1) candidates, told apart by four numbers: plain arrays, fitted elsewhere.

`stubborn/target/verifier_fit.py` fits them with scikit-learn; here they are only asked, at no cost of another package.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from sim.interface import ConfigError


class Features(NamedTuple):
    """What the object layers hold at a candidate cell: the input of a classifier."""

    total_view: int
    """Frames that had the cell in view."""
    cumulative: float
    """Sum of the target's score over these frames."""
    maximum: float
    """Highest score of the target."""
    maximum_other: float
    """Highest score of any other category."""


class Classifier(Protocol):
    """Says how probably a candidate is true."""

    def probability(self, features: Features) -> float:
        """In [0, 1]."""
        ...


@dataclass(frozen=True, eq=False)
class NaiveBayes:
    """Two classes, false (0) and true (1) candidates; within each the features are independent Gaussians."""

    log_prior: NDArray[np.float64]
    """(2,)"""
    mean: NDArray[np.float64]
    """(2, 4) per class and feature."""
    variance: NDArray[np.float64]
    """(2, 4)"""

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> NaiveBayes:
        """From `prior` (2), `mean` and `variance` (2 lists of 4).

        Raises:
            ConfigError: another shape, or a prior or variance that is not positive.
        """
        prior, mean, variance = (np.array(content[key], np.float64) for key in ("prior", "mean", "variance"))
        wanted = (2, len(Features._fields))
        if prior.shape != (2,) or mean.shape != wanted or variance.shape != wanted:
            raise ConfigError(
                f"A naive Bayes needs prior (2,), mean and variance {wanted}, "
                f"got {prior.shape}, {mean.shape} and {variance.shape}."
            )
        if not (prior > 0).all() or not (variance > 0).all():
            raise ConfigError("A naive Bayes needs priors and variances > 0.")
        return cls(np.log(prior), mean, variance)

    def probability(self, features: Sequence[float]) -> float:
        """That the candidate is true, in [0, 1]."""
        off = np.asarray(features, np.float64) - self.mean
        score = self.log_prior - 0.5 * (np.log(self.variance) + off * off / self.variance).sum(axis=1)
        return _logistic(float(score[1] - score[0]))


INPUTS: Mapping[str, Callable[[Features], float]] = MappingProxyType(
    {
        "log_views": lambda f: math.log1p(f.total_view),
        "mean_score": lambda f: f.cumulative / max(f.total_view, 1),
        "maximum": lambda f: f.maximum,
        "maximum_other": lambda f: f.maximum_other,
    }
)
"""What a logistic regression may look at."""


@dataclass(frozen=True, eq=False)
class Logistic:
    """A logistic regression over some `INPUTS`; over the mean score alone it is a threshold on it."""

    inputs: tuple[str, ...]
    coefficients: NDArray[np.float64]
    """(inputs,)"""
    intercept: float

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Logistic:
        """From `inputs`, `coefficients` and `intercept`.

        Raises:
            ConfigError: an unknown input, or not a coefficient for each.
        """
        inputs, coefficients = tuple(content["inputs"]), np.array(content["coefficients"], np.float64)
        if not set(inputs) <= set(INPUTS) or coefficients.shape != (len(inputs),):
            raise ConfigError(
                f"A logistic regression needs a coefficient for each of its inputs, out of {', '.join(INPUTS)}; "
                f"got {coefficients.shape} for {list(inputs)}."
            )
        return cls(inputs, coefficients, float(content["intercept"]))

    def probability(self, features: Features) -> float:
        """That the candidate is true, in [0, 1]."""
        return _logistic(self.intercept + float(self.coefficients @ [INPUTS[name](features) for name in self.inputs]))


def _logistic(x: float) -> float:
    return 0.5 * (1.0 + math.tanh(0.5 * x))  # without overflow
