"""Intervals over houses, against known formulas and simulated data."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from sim.app.evaluation.intervals import Estimate, estimate, paired_difference, ratio_of_medians, replicate_spread
from sim.app.evaluation.summary import few_episodes


def houses_of(count: int, episodes: int) -> list[str]:
    return [f"house_{i // episodes}" for i in range(count * episodes)]


def interval(value: Estimate) -> tuple[float, float]:
    assert value.low is not None
    assert value.high is not None
    return value.low, value.high


def of_differences(values: np.ndarray, houses: list[str], most: float = math.inf) -> Estimate:
    return paired_difference([0.0] * len(values), values.tolist(), houses, most=most)


def test_the_interval_of_a_difference_is_students_over_the_means_of_equal_houses() -> None:
    means = np.random.default_rng(0).normal(1.0, 1.0, 20)
    difference = of_differences(np.repeat(means, 30), houses_of(20, 30))
    expected = stats.ttest_1samp(means, 0.0)
    assert interval(difference) == pytest.approx(tuple(expected.confidence_interval(0.95)))
    assert difference.p == pytest.approx(expected[1])
    assert (difference.count, difference.houses) == (600, 20)


def test_houses_with_more_episodes_weigh_more_as_in_a_ratio_estimator() -> None:
    values, names = np.array([2.0] * 6 + [0.0] * 3 + [1.0] * 3), ["a"] * 6 + ["b"] * 3 + ["c"] * 3
    difference = of_differences(values, names)
    sums = np.array([(2.0 - 1.25) * 6, -1.25 * 3, -0.25 * 3])
    half = stats.t.ppf(0.975, 2) * math.sqrt(3 / 2 * (sums @ sums)) / 12
    assert difference.mean == pytest.approx(1.25)
    assert interval(difference) == pytest.approx((1.25 - half, 1.25 + half))


def test_the_interval_of_a_rate_is_wilsons_for_one_episode_in_each_of_many_houses() -> None:
    values = np.repeat([0.0, 1.0], [40, 360]).tolist()
    expected = stats.binomtest(360, 400).proportion_ci(method="wilson")
    bounds = interval(estimate(values, houses_of(400, 1), most=1.0))
    assert bounds == pytest.approx((expected.low, expected.high), abs=0.001)


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_a_rate_of_0_or_1_has_an_interval_with_a_width(value: float) -> None:
    low, high = interval(estimate([value] * 100, houses_of(20, 5), most=1.0))
    assert (low, high) == pytest.approx((0.958, 1.0) if value else (0.0, 0.042), abs=0.0005)
    few_low, few_high = interval(estimate([value] * 10, houses_of(5, 2), most=1.0))
    assert few_high - few_low > 5 * (high - low)


def test_values_that_are_nearly_equal_do_not_give_a_narrow_interval() -> None:
    values = 0.9 + 0.001 * np.random.default_rng(0).random(100)
    low, high = interval(estimate(values.tolist(), houses_of(20, 5), most=1.0))
    assert 0.02 < high - low < 0.03


def test_a_difference_of_shares_is_at_least_as_uncertain_as_one_episode() -> None:
    same = of_differences(np.zeros(200), houses_of(20, 10), most=1.0)
    assert interval(same) == pytest.approx((-2.093 / 200, 2.093 / 200), abs=1e-5)
    assert same.p == 1.0
    one = np.zeros(200)
    one[0] = 1.0
    assert not of_differences(one, houses_of(20, 10), most=1.0).significant


def test_the_interval_of_an_amount_is_above_0_and_longer_above_the_mean() -> None:
    values = [0.0] * 90 + [40.0] * 10
    value = estimate(values, houses_of(100, 1))
    low, high = interval(value)
    assert value.mean == pytest.approx(4.0)
    assert 0.0 < low < 4.0 < high
    assert low * high == pytest.approx(16.0)


def test_an_amount_in_two_houses_has_no_interval_that_says_nothing() -> None:
    far = estimate([1.0, 40.0], ["a", "b"])
    assert (far.mean, far.low, far.high) == (20.5, None, None)
    assert estimate([10.0, 12.0], ["a", "b"]).low is not None


@pytest.mark.parametrize(("between", "within"), [(0.5, 0.1), (0.2, 0.4), (0.0, 1.0)])
def test_intervals_over_ten_houses_hold_the_true_mean_in_about_95_of_100_samples(between: float, within: float) -> None:
    rng, names = np.random.default_rng(0), houses_of(10, 6)
    draws = np.repeat(rng.normal(0.0, between, (1000, 10)), 6, axis=1) + rng.normal(0.0, within, (1000, 60))
    held = sum(low <= 0.0 <= high for low, high in (interval(of_differences(values, names)) for values in draws))
    assert 0.93 <= held / 1000 <= 0.97


@pytest.mark.parametrize("rate", [0.5, 0.9, 0.98])
def test_intervals_of_a_rate_hold_the_true_one_in_95_to_98_of_100_samples(rate: float) -> None:
    rng, names = np.random.default_rng(0), houses_of(15, 7)
    of_houses = rng.beta(15 * rate, 15 * (1 - rate), (1000, 15))
    draws = rng.random((1000, 105)) < np.repeat(of_houses, 7, axis=1)
    ends = (interval(estimate(values.tolist(), names, most=1.0)) for values in draws)
    held = sum(low <= rate <= high for low, high in ends)
    assert 0.935 <= held / 1000 <= 0.985


@pytest.mark.parametrize("off", [0.08, 0.11])
def test_a_difference_becomes_significant_with_about_the_number_of_pairs_that_it_needs(off: float) -> None:
    for per_house in (1, 10):
        noise = np.random.default_rng(3).normal(0.0, 1.0, 200)
        one = of_differences(noise - noise.mean() + off, houses_of(200 // per_house, per_house))
        needed = one.pairs_needed
        assert needed is not None
        assert needed > 200
        low, high = interval(one)
        of_house = 0.5 * (high - low) / stats.t.ppf(0.975, one.houses - 1) * math.sqrt(one.houses)
        for factor, significant in ((1.02, True), (0.98, False)):
            houses = round(factor * needed / per_house)
            means = np.random.default_rng(4).normal(0.0, 1.0, houses)
            means *= of_house / means.std(ddof=1)
            values = np.repeat(means - means.mean() + off, per_house)
            assert of_differences(values, houses_of(houses, per_house)).significant == significant


def test_what_is_significant_equal_or_of_one_house_needs_no_more_pairs() -> None:
    for case in (
        Estimate(0.2, 0.1, 0.3, 50, 10), Estimate(0.0, -0.1, 0.1, 50, 10), Estimate(0.1, -0.1, 0.3, 50, 1),
        Estimate(None, None, None, 0, 0), Estimate(1.0, None, None, 50, 10),
    ):  # fmt: skip
        assert case.pairs_needed is None
    assert Estimate(0.1, -0.1, 0.3, 5000, 1000).pairs_needed == pytest.approx(20_000, rel=0.01)
    assert Estimate(0.1, -0.1, 0.3, 50, 10).pairs_needed == pytest.approx(200 * (2.03 / 2.262) ** 2, abs=6)


def test_one_house_leaves_its_episodes_and_says_so() -> None:
    one = estimate(np.repeat([0.0, 1.0], 200).tolist(), ["only"] * 400, most=1.0)
    assert one.houses == 1
    assert interval(one) == (pytest.approx(0.45, abs=0.01), pytest.approx(0.55, abs=0.01))


def test_the_interval_does_not_depend_on_the_order_of_episodes() -> None:
    rng = np.random.default_rng(0)
    values, names, order = rng.random(40), np.array(houses_of(8, 5)), rng.permutation(40)
    both = [estimate(v.tolist(), n.tolist(), most=1.0) for v, n in ((values, names), (values[order], names[order]))]
    assert both[0] == both[1]


def test_missing_values_and_houses_without_values_do_not_count() -> None:
    assert estimate([1.0, None, 3.0], ["a", "b", "a"]).houses == 1
    assert estimate([None, None], ["a", "b"]) == Estimate(None, None, None, 0, 0)
    assert paired_difference([1.0, None, 3.0], [2.0, 5.0, None], ["a", "b", "c"]) == Estimate(1.0, None, None, 1, 1)


def test_pairs_in_the_same_house_are_one_sample() -> None:
    gains = np.repeat([0.0, 0.0, 0.0, 1.0], 25)  # all gains are in one of four houses
    assert of_differences(gains, houses_of(100, 1)).significant
    assert not of_differences(gains, houses_of(4, 25)).significant


def test_replicates_of_an_episode_count_once() -> None:
    rng, names, ids = np.random.default_rng(0), houses_of(10, 6), [str(i) for i in range(60)]
    values = rng.integers(0, 2, 60).astype(float)
    once = estimate(values.tolist(), names, episodes=ids, most=1.0)
    thrice = estimate(np.tile(values, 3).tolist(), names * 3, episodes=ids * 3, most=1.0)
    assert thrice == once
    uneven = estimate([1.0, 0.0, *values.tolist()], [names[0], names[0], *names], episodes=[ids[0], ids[0], *ids])
    assert uneven.count == 60
    mean_of_first = (1.0 + values[0]) / 3
    assert uneven.mean == pytest.approx((values[1:].sum() + mean_of_first) / 60)
    assert paired_difference([0.0] * 120, [*values, *values], names * 2, episodes=ids * 2).count == 60


def test_the_spread_of_replicates_is_that_of_repeated_means() -> None:
    rng = np.random.default_rng(0)
    rates = rng.random(100)
    draws = rng.random((450, 100)) < rates  # each row: one replicate of 100 episodes
    ids = [str(i) for i in range(100)] * 3
    spreads = [replicate_spread(rows.ravel().tolist(), ids) for rows in draws.reshape(-1, 3, 100)]
    assert np.mean([spread or 0.0 for spread in spreads]) == pytest.approx(
        math.sqrt((rates * (1.0 - rates)).sum()) / 100, rel=0.03
    )
    assert replicate_spread([1.0, 0.0, None], ["a", "b", "a"]) is None


def test_a_ratio_of_medians_is_significant_when_its_interval_excludes_one() -> None:
    rng, names = np.random.default_rng(0), houses_of(20, 10)
    first = rng.uniform(50.0, 150.0, 200)
    half = ratio_of_medians(first.tolist(), (0.5 * first).tolist(), names)
    same = ratio_of_medians(first.tolist(), first.tolist(), names)
    assert half.mean == pytest.approx(0.5)
    assert half.low == half.high == pytest.approx(0.5)  # each resample keeps the pairs together
    assert (half.significant, same.mean, same.significant) == (True, 1.0, False)
    twice = ratio_of_medians(
        first.tolist() * 2, first.tolist() * 2, names * 2, episodes=[str(i) for i in range(200)] * 2
    )
    assert twice == same


def test_pairs_of_one_house_are_drawn_together_as_those_of_many() -> None:
    rng = np.random.default_rng(0)
    first, second = rng.uniform(50.0, 150.0, (2, 40)).tolist()
    one = ratio_of_medians(first, second, ["h"] * 40)
    many = ratio_of_medians(first, second, [f"h{i:02d}" for i in range(40)])
    assert (one.low, one.high) == pytest.approx((many.low, many.high), rel=0.1)


@pytest.mark.slow
def test_the_interval_of_a_ratio_of_medians_holds_the_true_one_in_about_95_of_100_samples() -> None:
    rng, held, names = np.random.default_rng(0), 0, houses_of(20, 5)
    for _ in range(200):
        of_houses = np.repeat(rng.normal(0.0, 0.3, 20), 5)
        first = np.exp(4.0 + of_houses + rng.normal(0.0, 0.5, 100))
        second = 0.8 * np.exp(4.0 + of_houses + rng.normal(0.0, 0.5, 100))
        low, high = interval(ratio_of_medians(first.tolist(), second.tolist(), names))
        held += low <= 0.8 <= high
    assert 0.91 <= held / 200 <= 0.99


def test_a_ratio_without_pairs_or_to_zero_is_no_number_that_misleads() -> None:
    assert ratio_of_medians([None], [1.0], ["a"]) == Estimate(None, None, None, 0, 0, neutral=1.0)
    assert ratio_of_medians([0.0, 0.0], [1.0, 2.0], ["a", "b"]).mean == float("inf")


@pytest.mark.parametrize("steps", [[3, 500], [500, 500, 500, 0], [500] * 9 + [400]])
def test_the_interval_of_a_bounded_number_stays_within_what_is_possible(steps: list[int]) -> None:
    value = estimate(steps, [f"h{i}" for i in range(len(steps))], most=500.0)
    low, high = interval(value)
    assert 0.0 <= low < value.mean < high <= 500.0  # type: ignore[operator]
    share = estimate([step / 500.0 for step in steps], [f"h{i}" for i in range(len(steps))], most=1.0)
    assert (low, high) == pytest.approx(tuple(500.0 * end for end in interval(share)))


def test_a_raised_limit_of_steps_has_no_upper_end() -> None:
    assert interval(estimate([100, 900, 800], ["a", "b", "c"], most=500.0))[1] > 500.0


@pytest.mark.parametrize(("count", "warns"), [(0, False), (1, True), (29, True), (30, False)])
def test_few_episodes_are_named(count: int, warns: bool) -> None:
    assert ("intervals are rough" in few_episodes(count)) == warns
