"""Is a candidate what it seems? A classifier asks four numbers of the object layers (paper: Verification).

The paper's is Gaussian naive Bayes; others over the same numbers are `METHODS` beside it. Parameters belong to a kind
of semantics and are shipped as `stubborn/verifiers/<kind>.json`, which also says which command fitted them
(`tools/train_verifier.py`) and how good each method was on episodes left out. A category with too few examples shares
the pooled classifier.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Protocol

from sim.interface import GOAL_CATEGORIES, ConfigError
from stubborn.target.classifiers import Classifier, Features, Logistic, NaiveBayes

FOLDER = Path(__file__).parent / "verifiers"
"""Where the shipped parameters lie."""
UNVERIFIED = ("gt",)
"""Kinds of semantics that leave nothing to verify."""
METHODS: Mapping[str, Callable[[Mapping[str, Any]], Classifier]] = MappingProxyType(
    {"naive-bayes": NaiveBayes.from_dict, "logistic": Logistic.from_dict, "threshold": Logistic.from_dict}
)
"""Kinds of classifiers, the paper's first; `threshold` looks at the mean score over all frames only."""
ACCEPT_ALL = "none"
"""The method of who does not verify."""


class Verifier(Protocol):
    """Decides whether a candidate is what it seems; belongs to a kind of semantics."""

    may_refuse: bool
    """False: whatever is asked is accepted, and it is no use to go somewhere only to ask."""

    def accepts(self, goal: str, features: Features) -> bool:
        """True: stop here. False: never come back to this candidate."""
        ...

    def would_accept(self, goal: str, features: Features) -> bool:
        """What it expects to say of a candidate that is seen from afar; it is asked at every step."""
        ...


class AcceptAll:
    """The verifier of ground truth: there is nothing to verify."""

    may_refuse = False

    def accepts(self, goal: str, features: Features) -> bool:
        """True for everything."""
        return True

    def would_accept(self, goal: str, features: Features) -> bool:
        """True for everything."""
        return True


@dataclass(frozen=True, eq=False)
class FittedVerifier:
    """Accepts what is more probably true than `least_probability`; see the module."""

    by_category: Mapping[str, Classifier]
    """For the goal categories with enough examples."""
    pooled: Classifier
    """For all others."""
    least_probability: float = 0.5
    may_refuse = True

    @classmethod
    def read(cls, file: Path, method: str = "naive-bayes") -> FittedVerifier:
        """From a file that `tools/train_verifier.py` wrote.

        Raises:
            ConfigError: it is not there or holds something else, or there is no such method.
        """
        if method not in METHODS:
            raise ConfigError(f"Unknown verification '{method}'. There is: {', '.join((*METHODS, ACCEPT_ALL))}.")
        make = METHODS[method]
        try:
            content = json.loads(file.read_text(encoding="utf-8"))["methods"][method]
            return cls({name: make(each) for name, each in content["categories"].items()}, make(content["pooled"]))
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

    def would_accept(self, goal: str, features: Features) -> bool:
        """The same."""
        return self.accepts(goal, features)


def verifier_for(semantics: str, file: Path | None = None, method: str = "naive-bayes") -> Verifier:
    """The verifier of a kind of semantics: of ground truth the one that accepts all, else the shipped one.

    Args:
        semantics: the kind.
        file: parameters in place of the shipped ones.
        method: one of `METHODS`, or `ACCEPT_ALL`.

    Raises:
        ConfigError: there are no parameters for this kind, the file holds none, or there is no such method.
    """
    if method == ACCEPT_ALL or (file is None and semantics in UNVERIFIED):
        return AcceptAll()
    file = file or FOLDER / f"{semantics}.json"
    if not file.is_file() and file.parent == FOLDER:
        known = [*UNVERIFIED, *sorted(each.stem for each in FOLDER.glob("*.json"))]
        raise ConfigError(f"No verifier for semantics '{semantics}'. There is: {', '.join(known)}.")
    return FittedVerifier.read(file, method)
