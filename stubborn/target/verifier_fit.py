"""Fits verifiers to a log of candidates with scikit-learn, and judges them.

Every method of `stubborn.target.verification.METHODS` is fitted for each goal category with enough true and enough
false candidates, and pooled for the others. All methods are judged by cross-validation on the same folds; the
candidates of an episode are never in both parts of a fold. The results are plain numbers that JSON can hold.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Float64, Int, Shaped
from sklearn.linear_model import LogisticRegression
from sklearn.model_selection import GroupKFold
from sklearn.naive_bayes import GaussianNB
from sklearn.preprocessing import StandardScaler

from sim.interface import GOAL_CATEGORIES, ConfigError
from stubborn.target.classifiers import INPUTS, Features
from stubborn.target.verification import METHODS, FittedVerifier

FOLDS = 5
SAME_PLACE_M = 2.0
"""Candidates of one episode and the same truth count once within this distance."""
_BINS = 5


class Candidates(NamedTuple):
    """All candidates of a log."""

    goals: Shaped[np.ndarray, " n"]
    """Goal category."""
    episodes: Int[np.ndarray, " n"]
    """Number of the episode."""
    features: Float64[np.ndarray, "n 4"]
    """See `Features`."""
    truth: Bool[np.ndarray, " n"]
    """True where a STOP would have succeeded."""


def fit(lines: Sequence[Mapping[str, Any]], least_of_either: int) -> dict[str, Any]:
    """Returns the counts of candidates and, for each method, its parameters and its quality on episodes left out.

    Args:
        lines: lines of the log of `tools/train_verifier.py`; those of failed episodes (0 steps) are left out.
        least_of_either: a category with fewer true or fewer false candidates uses the pooled classifier.

    Raises:
        ConfigError: there are fewer than `least_of_either` true or false candidates in total.
    """
    lines = _completed(lines)
    table = _candidates(lines)
    goals, truth = table.goals, table.truth
    if min(truth.sum(), (~truth).sum()) < least_of_either:
        raise ConfigError(
            f"The log holds {truth.sum()} true and {(~truth).sum()} false candidates; {least_of_either} of either are "
            "needed: play more episodes."
        )
    counts = {goal: [int((~truth[goals == goal]).sum()), int(truth[goals == goal].sum())] for goal in GOAL_CATEGORIES}
    separate = [goal for goal, pair in counts.items() if min(pair) >= least_of_either]
    return {
        "features": list(Features._fields),
        "episodes": len(lines),
        "least_of_either": least_of_either,
        "candidates": {goal: {"false": pair[0], "true": pair[1]} for goal, pair in counts.items()},
        "methods": {method: _fitted(method, table, separate) for method in METHODS},
    }


def _fitted(method: str, table: Candidates, separate: Sequence[str]) -> dict[str, Any]:
    """Returns the quality and the parameters of one method; `separate` goals get a classifier of their own."""
    goals, _, features, truth = table
    return {
        "left_out": judge(_left_out(method, table, separate), truth),
        "pooled": parameters(method, features, truth),
        "categories": {goal: parameters(method, features[goals == goal], truth[goals == goal]) for goal in separate},
    }


def parameters(method: str, features: Float64[np.ndarray, "n 4"], truth: Bool[np.ndarray, " n"]) -> dict[str, Any]:
    """Returns the parameters of one classifier as `stubborn.target.classifiers` reads them.

    Args:
        method: one of `METHODS`.
        features: of the candidates.
        truth: of the candidates; both values must occur.
    """
    if method == "naive-bayes":
        bayes = GaussianNB().fit(features, truth)
        return {
            "prior": [round(float(value), 6) for value in bayes.class_prior_],
            "mean": np.round(bayes.theta_, 6).tolist(),
            "variance": [[float(f"{value:.6g}") for value in row] for row in bayes.var_],
        }
    inputs = ("mean_score",) if method == "threshold" else tuple(INPUTS)
    values = np.array([[INPUTS[name](Features(*row)) for name in inputs] for row in features.tolist()])
    scaler = StandardScaler().fit(values)
    model = LogisticRegression().fit(scaler.transform(values), truth)
    coefficients = model.coef_[0] / scaler.scale_
    intercept = float(model.intercept_[0] - coefficients @ scaler.mean_)
    return {
        "inputs": list(inputs),
        "coefficients": [float(f"{value:.6g}") for value in coefficients],
        "intercept": float(f"{intercept:.6g}"),
    }


def _left_out(method: str, table: Candidates, separate: Sequence[str]) -> Float64[np.ndarray, " n"]:
    """Returns the probability of each candidate by a classifier that was fitted to other episodes.

    It is NaN where the other episodes hold only true or only false candidates.
    """
    goals, episodes, features, truth = table
    classifier = np.where(np.isin(goals, separate), goals, "")  # "": the pooled one, which is fitted to all candidates
    probability = np.full(len(truth), np.nan)
    for train, test in GroupKFold(n_splits=min(FOLDS, len(np.unique(episodes)))).split(features, truth, episodes):
        for name in np.unique(classifier[test]):
            used = train if name == "" else train[goals[train] == name]
            if not 0 < truth[used].sum() < len(used):
                continue
            fitted = METHODS[method](parameters(method, features[used], truth[used]))
            for i in test[classifier[test] == name]:
                probability[i] = fitted.probability(Features(*features[i]))
    return probability


def judge(probability: Float64[np.ndarray, " n"], truth: Bool[np.ndarray, " n"]) -> dict[str, Any]:
    """Returns the quality of probabilities: precision before and after verification, accuracy, calibration.

    Args:
        probability: of each candidate to be true; NaN is left out.
        truth: of each candidate.
    """
    known = np.isfinite(probability)
    probability, truth = probability[known], truth[known]
    accepted = probability > 0.5
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
    """Returns the share of true candidates in each bin of the probability that holds any."""
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


def judge_by_category(lines: Sequence[Mapping[str, Any]], verifier: FittedVerifier) -> dict[str, dict[str, Any]]:
    """Returns the result of `judge` for a verifier on logged candidates: of all, then of each category that occurs.

    Candidates of failed episodes (0 steps) are left out.
    """
    goals, _, features, truth = _candidates(_completed(lines))
    rows = zip(goals.tolist(), features.tolist(), strict=True)
    probability = np.array([verifier.probability(goal, Features(*row)) for goal, row in rows], np.float64)
    parts = {"all": np.ones(len(truth), np.bool_)} | {goal: goals == goal for goal in GOAL_CATEGORIES}
    return {name: judge(probability[part], truth[part]) for name, part in parts.items() if part.any()}


def _completed(lines: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Returns the lines of the episodes that did not fail."""
    return [line for line in lines if line["steps"]]


def _candidates(lines: Sequence[Mapping[str, Any]]) -> Candidates:
    """Returns the candidates of all lines, without repetitions."""
    rows = [(line["goal"], number, *each) for number, line in enumerate(lines) for each in _without_repetitions(line)]
    goals = np.array([row[0] for row in rows], np.str_)
    episodes = np.array([row[1] for row in rows], np.intp)
    values = np.array([row[2:] for row in rows], np.float64).reshape(-1, len(Features._fields) + 1)
    return Candidates(goals, episodes, values[:, :-1], values[:, -1] > 0.5)


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
