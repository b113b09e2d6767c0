"""Classifiers of candidates, how they are fitted and judged, and the verifier of each kind of segmentation."""

import json
from pathlib import Path

import numpy as np
import pytest
from sklearn.naive_bayes import GaussianNB

from sim.core.interface import GOAL_CATEGORIES, ConfigError, SegmenterSpec
from sim.training.fits.verifier import fit
from stubborn.detection.classifiers import Features, NaiveBayes
from stubborn.detection.verification import AcceptAll, FittedVerifier, verifier_for
from tests.helpers import wording

IMPERFECT = SegmenterSpec()
TRUE = SegmenterSpec(needs_verification=False)


def examples(count: int, true_share: float, seed: int, shift: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Returns random candidates; true ones were seen in more frames and with lower scores of other categories."""
    rng = np.random.default_rng(seed)
    truth = rng.random(count) < true_share
    views = rng.gamma(3.0, 8.0, count) + 5.0 * truth + shift
    share = np.where(truth, rng.beta(6, 2, count), rng.beta(2, 5, count))
    top = np.clip(share + rng.normal(0.1, 0.1, count), 0.5, 1.0)
    other = np.clip(1.1 - share + rng.normal(0, 0.15, count), 0.0, 1.0)
    return np.column_stack([np.round(views), views * share, top, other]), truth


def log_of(by_goal: dict[str, tuple[np.ndarray, np.ndarray]]) -> list[dict]:
    """Returns lines of the tool's log, one candidate per episode, ten episodes per house."""
    lines = [
        {"goal": goal, "steps": 30, "candidates": [[*map(float, row), float(true), 0.0, 0.0]]}
        for goal, (features, truth) in by_goal.items()
        for row, true in zip(features, truth, strict=True)
    ]
    return [{"house": f"house_{number // 10}", **line} for number, line in enumerate(lines)]


def written(content: dict, folder: Path) -> FittedVerifier:
    file = folder / "kind.json"
    file.write_text(json.dumps(content))
    return FittedVerifier.read(file)


def test_probabilities_are_those_of_scikit_learn(tmp_path: Path):
    features, truth = examples(300, 0.4, seed=1)
    verifier = written(fit(log_of({"chair": (features, truth)}), 20), tmp_path)
    expected = GaussianNB().fit(features, truth).predict_proba(features)[:, 1]
    ours = [verifier.probability("chair", Features(*row)) for row in features]
    np.testing.assert_allclose(ours, expected, atol=1e-4)
    accepted = [verifier.accepts("chair", Features(*row)) for row in features]
    sure = np.abs(expected - 0.5) > 1e-3
    np.testing.assert_array_equal(np.array(accepted)[sure], (expected > 0.5)[sure])


def test_the_classifiers_are_judged_on_candidates_of_houses_left_out():
    features, truth = examples(300, 0.5, seed=7)
    methods = fit(log_of({"bed": (features, truth)}), 20)["methods"]
    assert set(methods) == {"naive-bayes"}
    left_out = methods["naive-bayes"]["left_out"]
    assert left_out["candidates"] == 300
    assert left_out["precision_before"] == pytest.approx(truth.mean(), abs=1e-3)
    assert left_out["precision"] > left_out["precision_before"]


def test_the_method_none_accepts_all_and_unknown_methods_are_refused(tmp_path: Path):
    assert isinstance(verifier_for(IMPERFECT, method="none"), AcceptAll)
    for spec in (IMPERFECT, TRUE):
        with pytest.raises(ConfigError, match=r"Unknown verification 'hunch'\. Available: naive-bayes, none"):
            verifier_for(spec, method="hunch")
    with pytest.raises(ConfigError, match=wording.CANNOT_BE_READ):
        verifier_for(IMPERFECT, tmp_path / "none.json")


def test_extreme_features_give_a_probability_and_no_overflow():
    bayes = NaiveBayes.of([0.5, 0.5], [[0.0] * 4, [1.0] * 4], [[1e-6] * 4] * 2)
    with np.errstate(all="raise"):
        assert bayes.probability((500, 500.0, 1.0, 0.0)) == pytest.approx(1.0)
        assert bayes.probability((-500, -500.0, 0.0, 0.0)) == pytest.approx(0.0)


def test_a_category_with_too_few_true_or_false_examples_uses_the_pooled_classifier(tmp_path: Path):
    many, few_false = examples(200, 0.5, seed=2), examples(200, 0.95, seed=3, shift=30.0)
    assert 0 < (~few_false[1]).sum() < 20 < few_false[1].sum()
    content = fit(log_of({"chair": many, "sofa": few_false}), 20)
    assert set(content["methods"]["naive-bayes"]["categories"]) == {"chair"}
    assert content["candidates"]["sofa"] == {"false": int((~few_false[1]).sum()), "true": int(few_false[1].sum())}
    verifier = written(content, tmp_path)
    row = Features(40, 14.0, 0.7, 0.65)
    both = [np.concatenate(pair) for pair in zip(many, few_false, strict=True)]
    pooled = GaussianNB().fit(*both).predict_proba([row])[0, 1]
    own = GaussianNB().fit(*many).predict_proba([row])[0, 1]
    assert abs(pooled - own) > 0.01
    assert verifier.probability("sofa", row) == pytest.approx(pooled, abs=1e-4)
    assert verifier.probability("toilet", row) == pytest.approx(pooled, abs=1e-4)
    assert verifier.probability("chair", row) == pytest.approx(own, abs=1e-4)


def test_calibration_counts_every_candidate_once_and_is_right_where_classes_are_apart():
    features, truth = examples(400, 0.5, seed=4)
    features[:, 3] = np.where(truth, 0.1, 0.9) + 0.01 * np.random.default_rng(0).standard_normal(400)
    calibration = fit(log_of({"bed": (features, truth)}), 20)["methods"]["naive-bayes"]["left_out"]
    assert sum(row["candidates"] for row in calibration["by_probability"]) == 400
    assert calibration["accuracy"] > 0.99
    assert all(row["from"] <= row["mean_probability"] <= row["to"] for row in calibration["by_probability"])


def test_a_candidate_near_an_earlier_one_of_the_same_truth_does_not_count_again():
    strong, weak = [20.0, 18.0, 0.98, 0.3], [12.0, 1.0, 0.6, 0.9]
    here, near, far = (0.0, 0.0), (1.0, 1.0), (4.0, 0.0)
    met = [(strong, 1.0, here), (weak, 1.0, near), (weak, 0.0, near), (weak, 0.0, here), (strong, 1.0, far)]
    line = {
        "goal": "bed",
        "house": "house_0",
        "steps": 30,
        "candidates": [[*features, truth, *place] for features, truth, place in met],
    }
    content = fit([line, line], 2)
    assert content["candidates"]["bed"] == {"false": 2, "true": 4}
    np.testing.assert_allclose(content["methods"]["naive-bayes"]["pooled"]["mean"], [weak, strong])
    assert content["methods"]["naive-bayes"]["left_out"]["candidates"] == 0  # one house: none is held out


def test_candidates_of_failed_episodes_are_not_fitted():
    lines = log_of({"bed": examples(100, 0.5, seed=10)})
    content = fit(lines, 20)
    broken = [line | {"steps": 0} for line in lines[:30]]
    assert fit([*lines, *broken], 20) == content
    assert content["episodes"] == 100


def test_too_few_candidates_are_refused_with_the_numbers():
    features, truth = examples(30, 0.3, seed=5)
    with pytest.raises(ConfigError, match=rf"{truth.sum()} true and {(~truth).sum()} false candidates; 20 of each"):
        fit(log_of({"bed": (features, truth)}), 20)


def test_segmentation_that_needs_no_verification_gets_a_verifier_that_accepts_all():
    verifier = verifier_for(TRUE)
    assert isinstance(verifier, AcceptAll)
    assert not verifier.may_refuse
    assert verifier.accepts("chair", Features(0, 0.0, 0.0, 1.0))


def test_the_shipped_parameters_judge_clear_cases_for_every_category():
    verifier = verifier_for(SegmenterSpec(kind="noisy"))
    assert isinstance(verifier, FittedVerifier)
    for goal in GOAL_CATEGORIES:
        seldom = verifier.probability(goal, Features(20, 3.0, 0.62, 0.88))
        always = verifier.probability(goal, Features(25, 21.0, 0.95, 0.3))
        assert seldom < 0.5 < always, goal


def test_a_kind_without_parameters_gets_those_of_the_shipped_network():
    ours, other = (verifier_for(SegmenterSpec(kind=kind)) for kind in ("rednet", "dreams"))
    assert isinstance(ours, FittedVerifier)
    assert isinstance(other, FittedVerifier)
    features = Features(12, 9.0, 0.9, 0.2)
    assert ours.probability("chair", features) == other.probability("chair", features)
    with pytest.raises(ConfigError, match=wording.KIND_MUST_CONSIST_OF):
        SegmenterSpec(kind="../rednet")


def test_an_unknown_goal_and_a_broken_file_are_refused(tmp_path: Path):
    """A category that is not a goal of ObjectNav belongs to a goal in words: it is verified as all goals together."""
    pooled = FittedVerifier({}, NaiveBayes(np.zeros(2), np.zeros((2, 4)), np.ones((2, 4))))
    assert pooled.probability("appliances", Features(1, 1.0, 1.0, 0.0)) == pytest.approx(0.5)
    with pytest.raises(ConfigError, match="Unknown category 'unicorn'"):
        pooled.probability("unicorn", Features(1, 1.0, 1.0, 0.0))
    broken = tmp_path / "broken.json"
    for content in ("[]", "{", '{"pooled": {"prior": [1], "mean": [], "variance": []}, "categories": {}}'):
        broken.write_text(content)
        with pytest.raises(ConfigError, match=r"broken\.json"):
            FittedVerifier.read(broken)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"prior": [0.5]}, "prior"),
        ({"prior": [1.0, 0.0]}, r"prior\[1\]"),
        ({"mean": [[0.0] * 4, [0.0] * 3]}, r"mean\[1\]"),
        ({"variance": [[1.0] * 4, [1.0, 1.0, -1.0, 1.0]]}, r"variance\[1\]\[2\]"),
    ],
)
@pytest.mark.parametrize("part", ["pooled", "categories"])
def test_a_file_with_a_wrong_parameter_is_refused_with_its_place(change: dict, field: str, part: str, tmp_path: Path):
    good = {"prior": [0.5, 0.5], "mean": [[0.0] * 4] * 2, "variance": [[1.0] * 4] * 2}
    method = {"pooled": good, "categories": {"bed": good}}
    written({"methods": {"naive-bayes": method}}, tmp_path)
    method |= {part: good | change if part == "pooled" else {"bed": good | change}}
    with pytest.raises(ConfigError, match=rf"kind\.json', field 'methods.naive-bayes.{part}.*{field}"):
        written({"methods": {"naive-bayes": method}}, tmp_path)
