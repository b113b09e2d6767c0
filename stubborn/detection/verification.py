"""Verification of a candidate before a STOP, from four features of its cell (paper: Verification).

The classifier is the paper's Gaussian naive Bayes. Parameters belong to a kind of segmentation. They are shipped as
`stubborn/detection/verifiers/<kind>.json`, which also holds the command that fitted them (`stubborn train verifier`)
and their quality on held-out houses. A category that is not in the file uses the pooled classifier.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Protocol, runtime_checkable

import msgspec

from sim.core.interface import MPCAT40, ConfigError, SegmenterSpec
from sim.core.reading import Number, read_json
from stubborn.detection.classifiers import Features, NaiveBayes

FOLDER = Path(__file__).parent / "verifiers"
"""Folder of the shipped parameters."""
DEFAULT_KIND = "rednet"
"""Kinds without parameters of their own use those of this kind, because it is a network; also in fusion."""
NAIVE_BAYES = "naive-bayes"
"""The method of the paper."""
ACCEPT_ALL = "none"
"""The method that accepts every candidate."""
_Variance = Annotated[float, msgspec.Meta(gt=0.0, le=1e12)]
_Four = tuple[Number, Number, Number, Number]
_Variances = tuple[_Variance, _Variance, _Variance, _Variance]


class _NaiveBayes(msgspec.Struct):
    """Parameters of `NaiveBayes`."""

    prior: tuple[_Variance, _Variance]
    mean: tuple[_Four, _Four]
    variance: tuple[_Variances, _Variances]

    def classifier(self) -> NaiveBayes:
        """Returns the classifier with these parameters."""
        return NaiveBayes.of(self.prior, self.mean, self.variance)


class _Method(msgspec.Struct):
    """Parameters of the method."""

    pooled: _NaiveBayes
    categories: dict[str, _NaiveBayes]


class _Methods(msgspec.Struct, rename="kebab"):
    """Parameters by method."""

    naive_bayes: _Method


class _File(msgspec.Struct):
    """A file of parameters."""

    methods: _Methods


class Verifier(Protocol):
    """Decides whether a candidate is an instance of the goal; belongs to a kind of segmentation."""

    may_refuse: bool
    """False: it accepts every candidate, so that a visit only for verification is useless."""

    def accepts(self, goal: str, features: Features) -> bool:
        """Returns True to stop at the candidate, False to reject it for the rest of the episode."""
        ...

    def would_accept(self, goal: str, features: Features) -> bool:
        """Returns the expected answer for a candidate that is seen from afar; it is asked at every step."""
        ...


@runtime_checkable
class RatesCandidates(Protocol):
    """A verifier that estimates probabilities."""

    def probability(self, goal: str, features: Features) -> float:
        """Returns the probability in [0, 1] that a candidate for this goal is true."""
        ...


class AcceptAll:
    """A verifier that accepts every candidate, for segmentation that needs no verification."""

    may_refuse = False

    def accepts(self, goal: str, features: Features) -> bool:
        """Returns True."""
        return True

    def would_accept(self, goal: str, features: Features) -> bool:
        """Returns True."""
        return True


@dataclass(frozen=True, eq=False)
class FittedVerifier:
    """A verifier that accepts candidates which are true with a higher probability than `least_probability`."""

    by_category: Mapping[str, NaiveBayes]
    """Classifiers of the goal categories with enough examples."""
    pooled: NaiveBayes
    """Classifier of all other goal categories."""
    least_probability: float = 0.5
    """The paper's is one half."""
    may_refuse = True

    @classmethod
    def read(cls, file: Path) -> FittedVerifier:
        """Returns the verifier in a file that `stubborn train verifier` wrote.

        Raises:
            ConfigError: the file is missing or holds something else.
        """
        parameters = read_json(file, _File, what="Verifier file").methods.naive_bayes
        own = {name: category.classifier() for name, category in parameters.categories.items()}
        return cls(own, parameters.pooled.classifier())

    def probability(self, goal: str, features: Features) -> float:
        """Returns the probability in [0, 1] that a candidate for this goal is true."""
        if goal not in MPCAT40:  # goals in words may have other categories than the goals of ObjectNav
            raise ConfigError(f"Unknown category '{goal}'. Available: {', '.join(MPCAT40)}.")
        return self.by_category.get(goal, self.pooled).probability(features)

    def accepts(self, goal: str, features: Features) -> bool:
        """Returns True where the probability is high enough."""
        return self.probability(goal, features) > self.least_probability

    def would_accept(self, goal: str, features: Features) -> bool:
        """Returns the same as `accepts`."""
        return self.accepts(goal, features)


def has_parameters(kind: str) -> bool:
    """Returns whether parameters are shipped for this kind of segmentation; others get those of `DEFAULT_KIND`."""
    return (FOLDER / f"{kind}.json").is_file()


def verifier_for(spec: SegmenterSpec, file: Path | None = None, method: str = NAIVE_BAYES) -> Verifier:
    """Returns the verifier of a kind of segmentation: the shipped one, or `AcceptAll` where no verification is needed.

    Args:
        spec: specification of its segmenter; a kind without parameters gets those of `DEFAULT_KIND`.
        file: parameters in place of the shipped ones.
        method: `NAIVE_BAYES` or `ACCEPT_ALL`.

    Raises:
        ConfigError: the file holds no parameters, or the method is unknown.
    """
    if method not in (NAIVE_BAYES, ACCEPT_ALL):
        raise ConfigError(f"Unknown verification '{method}'. Available: {NAIVE_BAYES}, {ACCEPT_ALL}.")
    if method == ACCEPT_ALL or (file is None and not spec.needs_verification):
        return AcceptAll()
    if file is None:
        file = FOLDER / f"{spec.kind if has_parameters(spec.kind) else DEFAULT_KIND}.json"
    return FittedVerifier.read(file)
