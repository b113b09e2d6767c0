"""Fitting verifiers to a log of candidates: scikit-learn fits, plain numbers come out.

Every method of `stubborn.target.verification.METHODS` is fitted for each goal category with enough candidates of either kind,
and pooled for the others, and judged by cross-validation on the same folds, an episode never on both sides.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.linear_model import LogisticRegression
from sklearn.model_selection import GroupKFold
from sklearn.naive_bayes import GaussianNB
from sklearn.preprocessing import StandardScaler

from sim.interface import GOAL_CATEGORIES, ConfigError
from stubborn.target.classifiers import INPUTS, Features
from stubborn.target.verification import METHODS, FittedVerifier

Table = tuple[NDArray[np.str_], NDArray[np.intp], NDArray[np.float64], NDArray[np.bool_]]
"""Goal, number of the episode, features (n, 4) and truth of all candidates."""

FOLDS = 5
SAME_PLACE_M = 2.0


def fit(lines: Sequence[Mapping[str, Any]], least_of_either: int) -> dict[str, Any]:
    """Counts of candidates and, by method, parameters and how good they are on episodes left out.

    Raises:
        ConfigError: there are fewer than `least_of_either` true or false candidates in all.
    """
    table = _table(lines)
    goals, _, _, truth = table
    if min(truth.sum(), (~truth).sum()) < least_of_either:
        raise ConfigError(
            f"The log holds {truth.sum()} true and {(~truth).sum()} false candidates; {least_of_either} of either are "
            "needed: play more episodes."
        )
    counts = {goal: [int((~truth[goals == goal]).sum()), int(truth[goals == goal].sum())] for goal in GOAL_CATEGORIES}
    own = [goal for goal, pair in counts.items() if min(pair) >= least_of_either]
    return {
        "features": list(Features._fields),
        "episodes": len(lines),
        "least_of_either": least_of_either,
        "candidates": {goal: {"false": pair[0], "true": pair[1]} for goal, pair in counts.items()},
        "methods": {method: _fitted(method, table, own) for method in METHODS},
    }


def _fitted(method: str, table: Table, own: Sequence[str]) -> dict[str, Any]:
    goals, _, features, truth = table
    return {
        "left_out": judge(_left_out(method, table, own), truth),
        "pooled": parameters(method, features, truth),
        "categories": {goal: parameters(method, features[goals == goal], truth[goals == goal]) for goal in own},
    }


def parameters(method: str, features: NDArray[np.float64], truth: NDArray[np.bool_]) -> dict[str, Any]:
    """Of one classifier, as `stubborn.target.classifiers` reads it; class 0 is false, class 1 true.

    Args:
        method: one of `METHODS`.
        features: (n, 4)
        truth: (n,), with both kinds.
    """
    if method == "naive-bayes":
        bayes = GaussianNB().fit(features, truth)
        return {
            "prior": [round(float(value), 6) for value in bayes.class_prior_],
            "mean": np.round(bayes.theta_, 6).tolist(),
            "variance": [[float(f"{value:.6g}") for value in row] for row in bayes.var_],
        }
    inputs = ("mean_score",) if method == "threshold" else tuple(INPUTS)
    seen = np.array([[INPUTS[name](Features(*row)) for name in inputs] for row in features.tolist()])
    scaler = StandardScaler().fit(seen)
    model = LogisticRegression().fit(scaler.transform(seen), truth)
    coefficients = model.coef_[0] / scaler.scale_
    intercept = float(model.intercept_[0] - coefficients @ scaler.mean_)
    return {
        "inputs": list(inputs),
        "coefficients": [float(f"{value:.6g}") for value in coefficients],
        "intercept": float(f"{intercept:.6g}"),
    }


def _left_out(method: str, table: Table, own: Sequence[str]) -> NDArray[np.float64]:
    """Probability of each candidate by what was fitted on other episodes; NaN where these hold one kind only."""
    goals, groups, features, truth = table
    classifier = np.where(np.isin(goals, own), goals, "")  # "": the pooled one, which is fitted to all
    probability = np.full(len(truth), np.nan)
    for train, test in GroupKFold(n_splits=min(FOLDS, len(np.unique(groups)))).split(features, truth, groups):
        for name in np.unique(classifier[test]):
            used = train if name == "" else train[goals[train] == name]
            if not 0 < truth[used].sum() < len(used):
                continue
            fitted = METHODS[method](parameters(method, features[used], truth[used]))
            for asked in test[classifier[test] == name]:
                probability[asked] = fitted.probability(Features(*features[asked]))
    return probability


def judge(probability: NDArray[np.float64], truth: NDArray[np.bool_]) -> dict[str, Any]:
    """What probabilities are worth: precision before and after, what is accepted, and the true share by probability.

    Args:
        probability: (n,) of being true; NaN is left out.
        truth: (n,)
    """
    known = np.isfinite(probability)
    probability, truth = probability[known], truth[known]
    accepted = probability > 0.5
    bins = np.clip(np.floor(probability * 5.0), 0, 4)
    return {
        "candidates": len(truth),
        "precision_before": _share(truth),
        "precision": _share(truth[accepted]),
        "accuracy": _share(accepted == truth),
        "true_accepted": _share(accepted[truth]),
        "false_rejected": _share(~accepted[~truth]),
        "brier": _share((probability - truth) ** 2),
        "by_probability": [
            {
                "from": round(0.2 * number, 1),
                "to": round(0.2 * (number + 1), 1),
                "candidates": int((bins == number).sum()),
                "mean_probability": _share(probability[bins == number]),
                "true_share": _share(truth[bins == number]),
            }
            for number in range(5)
            if (bins == number).any()
        ],
    }


def judge_by_category(lines: Sequence[Mapping[str, Any]], verifier: FittedVerifier) -> dict[str, dict[str, Any]]:
    """What `judge` says of a verifier on logged candidates: of `all`, then of each goal category that has any."""
    goals, _, features, truth = _table(lines)
    rows = zip(goals.tolist(), features.tolist(), strict=True)
    probability = np.array([verifier.probability(goal, Features(*row)) for goal, row in rows], np.float64)
    parts = {"all": np.ones(len(truth), np.bool_)} | {goal: goals == goal for goal in GOAL_CATEGORIES}
    return {name: judge(probability[part], truth[part]) for name, part in parts.items() if part.any()}


def _table(lines: Sequence[Mapping[str, Any]]) -> Table:
    rows = [(line["goal"], number, *each) for number, line in enumerate(lines) for each in _first_of_each(line)]
    goals = np.array([row[0] for row in rows], np.str_)
    groups = np.array([row[1] for row in rows], np.intp)
    values = np.array([row[2:] for row in rows], np.float64).reshape(-1, len(Features._fields) + 1)
    return goals, groups, values[:, :-1], values[:, -1] > 0.5


def _first_of_each(line: Mapping[str, Any]) -> list[list[float]]:
    """Features and truth of an episode's candidates, without those near an earlier one of the same truth."""
    met: list[tuple[float, float, float]] = []
    kept = []
    for *features, truth, x_m, y_m in line["candidates"]:
        if not any(truth == t and math.hypot(x_m - x, y_m - y) <= SAME_PLACE_M for t, x, y in met):
            kept.append([*features, truth])
            met.append((truth, x_m, y_m))
    return kept


def _share(values: NDArray) -> float | None:
    return round(float(values.mean()), 4) if len(values) else None
