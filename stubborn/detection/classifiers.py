"""Classifiers that separate true (class 1) from false (class 0) candidates by four features.

`stubborn.detection.verifier_fit` fits them with scikit-learn. This module evaluates them with NumPy only.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from jaxtyping import Float64

from sim.interface import ConfigError


class Features(NamedTuple):
    """The content of the object layers at a candidate's cell: the input of a classifier."""

    total_view: int
    """Frames that had the cell in view."""
    cumulative: float
    """Sum of the target's score over these frames."""
    maximum: float
    """Highest score of the target."""
    maximum_other: float
    """Highest score of any other category."""


class Classifier(Protocol):
    """Estimates the probability that a candidate is true."""

    def probability(self, features: Features) -> float:
        """Returns the probability, in [0, 1]."""
        ...


@dataclass(frozen=True, eq=False)
class NaiveBayes:
    """A Gaussian naive Bayes classifier: within each class the features are independent Gaussians."""

    log_prior: Float64[np.ndarray, " 2"]
    mean: Float64[np.ndarray, "2 4"]
    """Per class and feature."""
    variance: Float64[np.ndarray, "2 4"]
    """Per class and feature."""

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> NaiveBayes:
        """Returns the classifier with `prior` (2), `mean` and `variance` (2 lists of 4).

        Raises:
            ConfigError: a shape is wrong, or a prior or variance is not positive.
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
        """Returns the probability that the candidate is true, in [0, 1]."""
        offset = np.asarray(features, np.float64) - self.mean
        score = self.log_prior - 0.5 * (np.log(self.variance) + offset * offset / self.variance).sum(axis=1)
        return _logistic(float(score[1] - score[0]))


def _logistic(x: float) -> float:
    """Returns 1 / (1 + exp(-x)), without overflow."""
    return 0.5 * (1.0 + math.tanh(0.5 * x))
