"""Is a candidate what it seems? Gaussian naive Bayes over four numbers of the object layers (paper: Verification).

Parameters belong to a kind of semantics and are shipped as `stubborn/verifiers/<kind>.json`, which also says which
command fitted them (`tools/train_verifier.py`). A category with too few examples shares the pooled classifier.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from sim.interface import GOAL_CATEGORIES, ConfigError

FOLDER = Path(__file__).parent / "verifiers"
"""Where the shipped parameters lie."""
UNVERIFIED = ("gt",)
"""Kinds of semantics that leave nothing to verify."""


class Features(NamedTuple):
    """What the object layers hold at a candidate cell: the input of a verifier."""

    total_view: int
    """Frames that had the cell in view."""
    cumulative: float
    """Sum of the target's score over these frames."""
    maximum: float
    """Highest score of the target."""
    maximum_other: float
    """Highest score of any other category."""


class Verifier(Protocol):
    """Decides whether a candidate is what it seems; belongs to a kind of semantics."""

    may_refuse: bool
    """False: whatever is asked is accepted, and it is no use to go somewhere only to ask."""

    def accepts(self, goal: str, features: Features) -> bool:
        """True: stop here. False: never come back to this candidate."""
        ...


class AcceptAll:
    """The verifier of ground truth: there is nothing to verify."""

    may_refuse = False

    def accepts(self, goal: str, features: Features) -> bool:
        """True for everything."""
        return True


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
        return float(0.5 * (1.0 + np.tanh(0.5 * (score[1] - score[0]))))  # the logistic, without overflow


@dataclass(frozen=True, eq=False)
class NaiveBayesVerifier:
    """Accepts what is more probably true than `least_probability`; see the module."""

    by_category: Mapping[str, NaiveBayes]
    """For the goal categories with enough examples."""
    pooled: NaiveBayes
    """For all others."""
    least_probability: float = 0.5
    may_refuse = True

    @classmethod
    def read(cls, file: Path) -> NaiveBayesVerifier:
        """From a file that `tools/train_verifier.py` wrote.

        Raises:
            ConfigError: it holds something else.
        """
        try:
            content = json.loads(file.read_text(encoding="utf-8"))
            by_category = {name: NaiveBayes.from_dict(each) for name, each in content["categories"].items()}
            return cls(by_category, NaiveBayes.from_dict(content["pooled"]))
        except OSError as error:
            raise ConfigError(f"Verifier file '{file}' cannot be read: {error.strerror}.") from None
        except (KeyError, TypeError, AttributeError, ValueError) as error:
            raise ConfigError(f"Verifier file '{file}' is not what tools/train_verifier.py writes: {error}") from None

    def probability(self, goal: str, features: Features) -> float:
        """That a candidate for this goal is true, in [0, 1]."""
        if goal not in GOAL_CATEGORIES:
            raise ConfigError(f"Unknown goal '{goal}'. There is: {', '.join(GOAL_CATEGORIES)}.")
        return self.by_category.get(goal, self.pooled).probability(features)

    def accepts(self, goal: str, features: Features) -> bool:
        """See `Verifier`."""
        return self.probability(goal, features) > self.least_probability


def verifier_for(semantics: str, file: Path | None = None) -> Verifier:
    """The verifier of a kind of semantics: of ground truth the one that accepts all, else the shipped one.

    Args:
        semantics: the kind.
        file: parameters in place of the shipped ones.

    Raises:
        ConfigError: there are no parameters for this kind, or the file holds none.
    """
    if file is not None:
        return NaiveBayesVerifier.read(file)
    if semantics in UNVERIFIED:
        return AcceptAll()
    file = FOLDER / f"{semantics}.json"
    if not file.is_file():
        known = [*UNVERIFIED, *sorted(each.stem for each in FOLDER.glob("*.json"))]
        raise ConfigError(f"No verifier for semantics '{semantics}'. There is: {', '.join(known)}.")
    return NaiveBayesVerifier.read(file)
