"""Classifiers that separate true (class 1) from false (class 0) candidates by four features.

`sim.training.fits.verifier` fits them with scikit-learn. This module evaluates them with NumPy only.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64


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


@dataclass(frozen=True, eq=False)
class NaiveBayes:
    """A Gaussian naive Bayes classifier: within each class the features are independent Gaussians."""

    log_prior: Float64[np.ndarray, " 2"]
    mean: Float64[np.ndarray, "2 4"]
    """Per class and feature."""
    variance: Float64[np.ndarray, "2 4"]
    """Per class and feature."""

    @classmethod
    def of(
        cls, prior: Sequence[float], mean: Sequence[Sequence[float]], variance: Sequence[Sequence[float]]
    ) -> NaiveBayes:
        """Returns the classifier with a prior per class, and a mean and a variance per class and feature."""
        return cls(np.log(prior), np.array(mean, np.float64), np.array(variance, np.float64))

    def probability(self, features: Sequence[float]) -> float:
        """Returns the probability that the candidate is true, in [0, 1]."""
        offset = np.asarray(features, np.float64) - self.mean
        score = self.log_prior - 0.5 * (np.log(self.variance) + offset * offset / self.variance).sum(axis=1)
        return logistic(float(score[1] - score[0]))


def logistic(x: float) -> float:
    """Returns 1 / (1 + exp(-x)), without overflow."""
    return 0.5 * (1.0 + math.tanh(0.5 * x))
