"""Fits verifiers to a log of candidates with scikit-learn, and evaluates them.

The paper's naive Bayes is fitted for each goal category with enough true and enough false candidates, and pooled for
the others. It is evaluated by cross-validation; the candidates of a house are never in both parts of a fold. The
results are plain numbers that JSON can hold.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Float64, Shaped
from sklearn.model_selection import GroupKFold
from sklearn.naive_bayes import GaussianNB

from sim.core.interface import GOAL_CATEGORIES, ConfigError
from stubborn.detection.classifiers import Features, NaiveBayes
from stubborn.detection.verification import NAIVE_BAYES, FittedVerifier

FOLDS = 5
SAME_PLACE_M = 2.0
"""Candidates of one episode with the same truth count once if the robot judged them from places within this
distance."""
_BINS = 5


class Candidates(NamedTuple):
    """All candidates of a log."""

    goals: Shaped[np.ndarray, " n"]
    """Goal category."""
    houses: Shaped[np.ndarray, " n"]
    """Name of the house."""
    features: Float64[np.ndarray, "n 4"]
    """See `Features`."""
    truth: Bool[np.ndarray, " n"]
    """True where a STOP would have succeeded."""


def fit(lines: Sequence[Mapping[str, Any]], least_of_either: int) -> dict[str, Any]:
    """Returns the counts of candidates, the parameters of the naive Bayes, and its quality on held-out houses.

    Args:
        lines: lines of the log of `stubborn train verifier`; those of failed episodes (0 steps) are left out.
        least_of_either: a category with fewer true or fewer false candidates uses the pooled naive Bayes.

    Raises:
        ConfigError: there are fewer than `least_of_either` true or false candidates in total.
    """
    lines = _completed(lines)
    table = _candidates(lines)
    goals, truth = table.goals, table.truth
    if min(truth.sum(), (~truth).sum()) < least_of_either:
        raise ConfigError(
            f"The log holds {truth.sum()} true and {(~truth).sum()} false candidates; {least_of_either} of each are "
            "needed: run more episodes."
        )
    counts = {goal: [int((~truth[goals == goal]).sum()), int(truth[goals == goal].sum())] for goal in GOAL_CATEGORIES}
    separate = [goal for goal, pair in counts.items() if min(pair) >= least_of_either]
    return {
        "features": list(Features._fields),
        "episodes": len(lines),
        "least_of_either": least_of_either,
        "candidates": {goal: {"false": pair[0], "true": pair[1]} for goal, pair in counts.items()},
        "methods": {NAIVE_BAYES: _fitted(table, separate)},
    }


def _fitted(table: Candidates, separate: Sequence[str]) -> dict[str, Any]:
    """Returns the quality of the classifiers and their parameters."""
    quality = judge(_left_out(table, separate), table.truth)
    return {"left_out": quality} | _classifiers(table.goals, table.features, table.truth, separate)


def _classifiers(
    goals: Shaped[np.ndarray, " n"],
    features: Float64[np.ndarray, "n 4"],
    truth: Bool[np.ndarray, " n"],
    separate: Sequence[str],
) -> dict[str, Any]:
    """Returns the parameters of the classifiers as `stubborn.detection.verification` reads them.

    Args:
        goals: goal of each candidate.
        features: features of each candidate.
        truth: True for each true candidate; both values must occur.
        separate: goals that get a naive Bayes of their own.
    """
    parts = {goal: goals == goal for goal in separate}
    both = {goal: part for goal, part in parts.items() if 0 < truth[part].sum() < part.sum()}
    own = {goal: _naive_bayes(features[part], truth[part]) for goal, part in both.items()}
    return {"pooled": _naive_bayes(features, truth), "categories": own}


def _naive_bayes(features: Float64[np.ndarray, "n 4"], truth: Bool[np.ndarray, " n"]) -> dict[str, Any]:
    bayes = GaussianNB().fit(features, truth)
    return {
        "prior": [round(float(value), 6) for value in bayes.class_prior_],
        "mean": np.round(bayes.theta_, 6).tolist(),
        "variance": [[float(f"{value:.6g}") for value in row] for row in bayes.var_],
    }


def _left_out(table: Candidates, separate: Sequence[str]) -> Float64[np.ndarray, " n"]:
    """Returns the probability of each candidate by a classifier that was fitted to other houses.

    It is NaN where the other houses hold only true or only false candidates.
    """
    goals, houses, features, truth = table
    probability = np.full(len(truth), np.nan)
    if len(np.unique(houses)) < 2:
        return probability
    for train, test in GroupKFold(n_splits=min(FOLDS, len(np.unique(houses)))).split(features, truth, houses):
        if not 0 < truth[train].sum() < len(train):
            continue
        content = _classifiers(goals[train], features[train], truth[train], separate)
        pooled = NaiveBayes.of(**content["pooled"])
        own = {goal: NaiveBayes.of(**parameters) for goal, parameters in content["categories"].items()}
        for i in test:
            probability[i] = own.get(str(goals[i]), pooled).probability(Features(*features[i]))
    return probability


def judge(probability: Float64[np.ndarray, " n"], truth: Bool[np.ndarray, " n"]) -> dict[str, Any]:
    """Returns the quality of probabilities: precision before and after verification, accuracy, calibration.

    Args:
        probability: probability of each candidate to be true; NaN is left out.
        truth: True for each true candidate.
    """
    known = np.isfinite(probability)
    probability, truth = probability[known], truth[known]
    accepted = probability > FittedVerifier.least_probability
    return {
        "candidates": len(truth),
        "precision_before": _share(truth),
        "precision": _share(truth[accepted]),
        "accuracy": _share(accepted == truth),
        "true_accepted": _share(accepted[truth]),
        "false_rejected": _share(~accepted[~truth]),
        "brier": _share((probability - truth) ** 2),
        "by_probability": _calibration(probability, truth),
    }


def _calibration(probability: Float64[np.ndarray, " n"], truth: Bool[np.ndarray, " n"]) -> list[dict[str, Any]]:
    """Returns the share of true candidates in each bin of the probability that is not empty."""
    bins = np.clip(np.floor(probability * float(_BINS)), 0, _BINS - 1)
    return [
        {
            "from": round(number / _BINS, 1),
            "to": round((number + 1) / _BINS, 1),
            "candidates": int((bins == number).sum()),
            "mean_probability": _share(probability[bins == number]),
            "true_share": _share(truth[bins == number]),
        }
        for number in range(_BINS)
        if (bins == number).any()
    ]


def _completed(lines: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Returns the lines of the episodes that did not fail."""
    return [line for line in lines if line["steps"]]


def _candidates(lines: Sequence[Mapping[str, Any]]) -> Candidates:
    """Returns the candidates of all lines, without repetitions."""
    met = [(line, candidate) for line in lines for candidate in _without_repetitions(line)]
    goals = np.array([line["goal"] for line, _ in met], np.str_)
    houses = np.array([line["house"] for line, _ in met], np.str_)
    values = np.array([candidate for _, candidate in met], np.float64).reshape(-1, len(Features._fields) + 1)
    return Candidates(goals, houses, values[:, :-1], values[:, -1] > 0.5)


def _without_repetitions(line: Mapping[str, Any]) -> list[list[float]]:
    """Returns features and truth of an episode's candidates, without those near an earlier one of the same truth."""
    earlier: list[tuple[float, float, float]] = []
    kept = []
    for *features, truth, x_m, y_m in line["candidates"]:
        if not any(truth == t and math.hypot(x_m - x, y_m - y) <= SAME_PLACE_M for t, x, y in earlier):
            kept.append([*features, truth])
            earlier.append((truth, x_m, y_m))
    return kept


def _share(values: Bool[np.ndarray, " n"] | Float[np.ndarray, " n"]) -> float | None:
    """Returns the mean, rounded to four digits; None without values."""
    return round(float(values.mean()), 4) if len(values) else None
