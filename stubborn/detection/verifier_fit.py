"""Fits verifiers to a log of candidates with scikit-learn, and evaluates them.

The paper's naive Bayes is fitted for each goal category with enough true and enough false candidates, and pooled for
the others. The logistic regressions are one model of all candidates in which each category shifts the intercept; a
normal prior pulls the shifts towards zero, so that a category with few candidates is judged like the others. Their
threshold is chosen so that as many episodes as possible would end at a true candidate: a wrong STOP costs the chance to
succeed later, in the rest of the log and after it. All methods are evaluated by cross-validation on the same folds; the
candidates of a house are never in both parts of a fold. The results are plain numbers that JSON can hold.
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
from stubborn.detection.classifiers import INPUTS, Features
from stubborn.detection.verification import METHODS, FittedVerifier

FOLDS = 5
SAME_PLACE_M = 2.0
"""Candidates of one episode with the same truth count once if the robot judged them from places within this
distance."""
SHIFT_DEVIATION = 1.0
"""Standard deviation of the prior of a category's shift, in logits."""
OPEN_SHARE = 0.8
"""Success rate of an episode that continues after the log (which ends at step 200 of 500), relative to that of an
episode from its start (`stubborn-plus` on val: 64 % against 80 %, docs/segmentation.md)."""
_BINS = 5


class Candidates(NamedTuple):
    """All candidates of a log."""

    goals: Shaped[np.ndarray, " n"]
    """Goal category."""
    episodes: Int[np.ndarray, " n"]
    """Number of the episode; its candidates are in the order in which the robot met them."""
    houses: Shaped[np.ndarray, " n"]
    """Name of the house."""
    features: Float64[np.ndarray, "n 4"]
    """See `Features`."""
    truth: Bool[np.ndarray, " n"]
    """True where a STOP would have succeeded."""


def fit(lines: Sequence[Mapping[str, Any]], least_of_either: int) -> dict[str, Any]:
    """Returns the counts of candidates and, for each method, its parameters and its quality on held-out episodes.

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
        "methods": {method: _fitted(method, table, separate, len(lines)) for method in METHODS},
    }


def _fitted(method: str, table: Candidates, separate: Sequence[str], episodes: int) -> dict[str, Any]:
    """Returns the quality and the parameters of one method, in a log of `episodes` episodes."""
    probability = _left_out(method, table, separate)
    bar = {} if method == "naive-bayes" else {"least_probability": best_bar(probability, table, episodes)}
    success = expected_success(probability, table, bar.get("least_probability", 0.5), episodes)
    quality = judge(probability, table.truth, **bar) | {"expected_success": round(success, 4)}
    return bar | {"left_out": quality} | _classifiers(method, table.goals, table.features, table.truth, separate)


def _classifiers(
    method: str,
    goals: Shaped[np.ndarray, " n"],
    features: Float64[np.ndarray, "n 4"],
    truth: Bool[np.ndarray, " n"],
    separate: Sequence[str],
) -> dict[str, Any]:
    """Returns the parameters of one method as `stubborn.detection.verification` reads them.

    Args:
        method: one of `METHODS`.
        goals: goal of each candidate.
        features: features of each candidate.
        truth: True for each true candidate; both values must occur.
        separate: goals that get a naive Bayes of their own.
    """
    if method == "naive-bayes":
        parts = {goal: goals == goal for goal in separate}
        both = {goal: part for goal, part in parts.items() if 0 < truth[part].sum() < part.sum()}
        own = {goal: _naive_bayes(features[part], truth[part]) for goal, part in both.items()}
        return {"pooled": _naive_bayes(features, truth), "categories": own}
    inputs = ("mean_score",) if method == "threshold" else tuple(INPUTS)
    values = np.array([[INPUTS[name](Features(*row)) for name in inputs] for row in features.tolist()])
    scaler = StandardScaler().fit(values)
    met = [goal for goal in GOAL_CATEGORIES if (goals == goal).any()]
    of_goal = SHIFT_DEVIATION * (goals[:, None] == np.array(met))
    # With C = 1 the prior of each coefficient is a normal distribution with a standard deviation of 1.
    model = LogisticRegression(C=1.0, max_iter=1000).fit(np.hstack([scaler.transform(values), of_goal]), truth)
    weights, shifts = np.split(model.coef_[0], [len(inputs)])
    middle, spread = np.asarray(scaler.mean_), np.asarray(scaler.scale_)
    coefficients = weights / spread
    intercept = float(model.intercept_[0] - coefficients @ middle)

    def shifted(shift: float) -> dict[str, Any]:
        return {
            "inputs": list(inputs),
            "coefficients": [float(f"{value:.6g}") for value in coefficients],
            "intercept": float(f"{intercept + shift:.6g}"),
        }

    own = {goal: shifted(SHIFT_DEVIATION * shift) for goal, shift in zip(met, shifts.tolist(), strict=True)}
    return {"pooled": shifted(0.0), "categories": own}


def _naive_bayes(features: Float64[np.ndarray, "n 4"], truth: Bool[np.ndarray, " n"]) -> dict[str, Any]:
    bayes = GaussianNB().fit(features, truth)
    return {
        "prior": [round(float(value), 6) for value in bayes.class_prior_],
        "mean": np.round(bayes.theta_, 6).tolist(),
        "variance": [[float(f"{value:.6g}") for value in row] for row in bayes.var_],
    }


def _left_out(method: str, table: Candidates, separate: Sequence[str]) -> Float64[np.ndarray, " n"]:
    """Returns the probability of each candidate by a classifier that was fitted to other houses.

    It is NaN where the other houses hold only true or only false candidates.
    """
    goals, _, houses, features, truth = table
    make = METHODS[method]
    probability = np.full(len(truth), np.nan)
    if len(np.unique(houses)) < 2:
        return probability
    for train, test in GroupKFold(n_splits=min(FOLDS, len(np.unique(houses)))).split(features, truth, houses):
        if not 0 < truth[train].sum() < len(train):
            continue
        content = _classifiers(method, goals[train], features[train], truth[train], separate)
        pooled, own = make(content["pooled"]), {goal: make(each) for goal, each in content["categories"].items()}
        for i in test:
            probability[i] = own.get(str(goals[i]), pooled).probability(Features(*features[i]))
    return probability


def expected_success(probability: Float64[np.ndarray, " n"], table: Candidates, bar: float, episodes: int) -> float:
    """Returns the share of episodes that end at a true candidate if the agent stops at the first one above the bar.

    Args:
        probability: probability of each candidate; NaN is never above the bar.
        table: the candidates, in the order in which each episode met them.
        bar: from 0 to 1.
        episodes: number of episodes of the log, also those without a candidate.
    """
    accepted = np.flatnonzero(probability > bar)
    _, first = np.unique(table.episodes[accepted], return_index=True)
    ended_well = table.truth[accepted[first]].sum() / episodes
    still_open = 1.0 - len(first) / episodes
    return float(ended_well / (1.0 - OPEN_SHARE * still_open))  # the share s solves s = ended_well + OPEN_SHARE open s


def best_bar(probability: Float64[np.ndarray, " n"], table: Candidates, episodes: int) -> float:
    """Returns the bar from 0.05 to 0.95 with the highest `expected_success`, the lowest of equally good ones.

    Neighbouring bars are averaged, so that a single lucky one is not chosen. Without probabilities the bar is one half.
    """
    if not np.isfinite(probability).any():
        return 0.5
    bars = np.arange(5, 100, 5) / 100.0
    success = np.array([expected_success(probability, table, bar, episodes) for bar in bars.tolist()])
    smooth = np.convolve(np.pad(success, 1, mode="edge"), np.full(3, 1.0 / 3.0), mode="valid")
    return float(bars[int(np.argmax(np.round(smooth, 6)))])


def judge(
    probability: Float64[np.ndarray, " n"], truth: Bool[np.ndarray, " n"], least_probability: float = 0.5
) -> dict[str, Any]:
    """Returns the quality of probabilities: precision before and after verification, accuracy, calibration.

    Args:
        probability: probability of each candidate to be true; NaN is left out.
        truth: True for each true candidate.
        least_probability: candidates with more are accepted.
    """
    known = np.isfinite(probability)
    probability, truth = probability[known], truth[known]
    accepted = probability > least_probability
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


def judge_by_category(lines: Sequence[Mapping[str, Any]], verifier: FittedVerifier) -> dict[str, dict[str, Any]]:
    """Returns the result of `judge` for a verifier on logged candidates: for all, then for each category in them.

    Candidates of failed episodes (0 steps) are left out.
    """
    goals, _, _, features, truth = _candidates(_completed(lines))
    rows = zip(goals.tolist(), features.tolist(), strict=True)
    probability = np.array([verifier.probability(goal, Features(*row)) for goal, row in rows], np.float64)
    bar = verifier.least_probability
    parts = {"all": np.ones(len(truth), np.bool_)} | {goal: goals == goal for goal in GOAL_CATEGORIES}
    return {name: judge(probability[part], truth[part], bar) for name, part in parts.items() if part.any()}


def _completed(lines: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Returns the lines of the episodes that did not fail."""
    return [line for line in lines if line["steps"]]


def _candidates(lines: Sequence[Mapping[str, Any]]) -> Candidates:
    """Returns the candidates of all lines, without repetitions."""
    met = [(number, line, each) for number, line in enumerate(lines) for each in _without_repetitions(line)]
    goals = np.array([line["goal"] for _, line, _ in met], np.str_)
    episodes = np.array([number for number, _, _ in met], np.intp)
    houses = np.array([line["house"] for _, line, _ in met], np.str_)
    values = np.array([each for _, _, each in met], np.float64).reshape(-1, len(Features._fields) + 1)
    return Candidates(goals, episodes, houses, values[:, :-1], values[:, -1] > 0.5)


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
