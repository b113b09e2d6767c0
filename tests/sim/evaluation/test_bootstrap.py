"""Intervals that resample houses and then their episodes, against known widths and simulated data."""

from __future__ import annotations

import time

import numpy as np
import pytest

from sim.evaluation.bootstrap import Estimate, bootstrap_interval, estimate, paired_difference, ratio_of_medians


def houses_of(count: int, episodes: int) -> list[str]:
    return [f"house_{i // episodes}" for i in range(count * episodes)]


def each_in_its_house(count: int) -> list[str]:
    """With one episode in each house, the bootstrap over houses equals the ordinary bootstrap over episodes."""
    return houses_of(count, 1)


def width(values: np.ndarray, houses: list[str]) -> float:
    low, high = bootstrap_interval(values, houses)
    return high - low


def test_episodes_that_agree_within_each_house_count_as_one() -> None:
    of_houses = np.random.default_rng(0).random(20)
    episodes = np.repeat(of_houses, 30)
    expected = bootstrap_interval(of_houses, each_in_its_house(20))
    assert bootstrap_interval(episodes, houses_of(20, 30)) == pytest.approx(expected, abs=0.005)
    naive = width(episodes, each_in_its_house(600))
    assert width(episodes, houses_of(20, 30)) == pytest.approx(np.sqrt(30) * naive, rel=0.1)


@pytest.mark.parametrize("off", [0.08, 0.11])
def test_a_difference_becomes_significant_with_about_the_number_of_pairs_that_it_needs(off: float) -> None:
    one = np.random.default_rng(3).normal(0.0, 1.0, 200)
    one += off - one.mean()
    first = estimate(list(one), each_in_its_house(200))
    assert first.mean is not None
    needed = first.pairs_needed
    assert needed is not None
    assert needed > 200
    centred = np.random.default_rng(4).normal(0.0, 1.0, needed)
    for factor, significant in ((1.3, True), (0.7, False)):
        count = int(factor * needed)
        values = np.resize(centred, count)
        values = values - values.mean() + first.mean
        assert estimate(list(values), each_in_its_house(count)).significant == significant


def test_what_is_significant_equal_or_of_one_house_needs_no_more_pairs() -> None:
    for each in (
        Estimate(0.2, 0.1, 0.3, 50, 10), Estimate(0.0, -0.1, 0.1, 50, 10), Estimate(0.1, -0.1, 0.3, 50, 1),
        Estimate(None, None, None, 0, 0),
    ):  # fmt: skip
        assert each.pairs_needed is None
    assert Estimate(0.1, -0.1, 0.3, 50, 10).pairs_needed == 200


def test_the_width_for_houses_that_succeed_or_fail_as_a_whole_is_that_of_a_coin() -> None:
    episodes = np.repeat([0.0, 1.0], 100)  # 20 houses of 10 episodes
    low, high = bootstrap_interval(episodes, houses_of(20, 10))
    assert (low, high) == (pytest.approx(0.3, abs=0.01), pytest.approx(0.7, abs=0.01))  # quantiles of Binomial(20, 1/2)


def test_the_interval_of_a_fair_coin_is_near_the_normal_one() -> None:
    low, high = bootstrap_interval(np.repeat([0.0, 1.0], 200), each_in_its_house(400))
    assert low == pytest.approx(0.5 - 1.96 * 0.025, abs=0.006)
    assert high == pytest.approx(0.5 + 1.96 * 0.025, abs=0.006)


@pytest.mark.parametrize(("between", "within"), [(0.3, 0.1), (0.2, 0.4), (0.1, 1.0)])
def test_intervals_over_twenty_houses_hold_the_true_mean_in_about_95_of_100_samples(
    between: float, within: float
) -> None:
    rng, held = np.random.default_rng(0), 0
    names = houses_of(20, 10)
    for _ in range(400):
        values = np.repeat(rng.normal(0.0, between, 20), 10) + rng.normal(0.0, within, 200)
        low, high = bootstrap_interval(values, names, resamples=400)
        held += low <= 0.0 <= high
    assert 0.90 <= held / 400 <= 0.995


def test_houses_with_more_episodes_weigh_more_as_in_the_mean() -> None:
    values, names = np.array([0.0] * 9 + [1.0]), ["large"] * 9 + ["small"]
    low, high = bootstrap_interval(values, names)
    assert (low, high) == (0.0, 1.0)  # a resample holds only one of the houses with probability 1/4
    assert estimate(list(values), names).mean == pytest.approx(0.1)


def test_one_house_leaves_its_episodes_to_resample_and_says_so() -> None:
    values = list(np.repeat([0.0, 1.0], 200))
    one = estimate(values, ["only"] * 400)
    assert one.houses == 1
    assert (one.low, one.high) == (pytest.approx(0.45, abs=0.01), pytest.approx(0.55, abs=0.01))


def test_the_interval_does_not_depend_on_the_order_of_episodes() -> None:
    rng = np.random.default_rng(0)
    values, names, order = rng.random(40), np.array(houses_of(8, 5)), rng.permutation(40)
    assert bootstrap_interval(values, list(names)) == bootstrap_interval(values[order], list(names[order]))


def test_missing_values_and_houses_without_values_do_not_count() -> None:
    assert estimate([1.0, None, 3.0], ["a", "b", "a"]).houses == 1
    assert estimate([None, None], ["a", "b"]) == Estimate(None, None, None, 0, 0)
    assert paired_difference([1.0, None, 3.0], [2.0, 5.0, None], ["a", "b", "c"]) == Estimate(1.0, 1.0, 1.0, 1, 1)


def test_pairs_in_the_same_house_are_drawn_together() -> None:
    gains = np.repeat([0.0, 0.0, 0.0, 1.0], 25)  # all gains are in one of four houses
    over_houses = paired_difference([0.0] * 100, list(gains), houses_of(4, 25))
    over_episodes = paired_difference([0.0] * 100, list(gains), each_in_its_house(100))
    assert over_episodes.significant
    assert not over_houses.significant


def test_a_split_of_a_thousand_episodes_takes_well_under_a_second() -> None:
    values = np.random.default_rng(0).random(1020)
    began_s = time.process_time()
    bootstrap_interval(values, houses_of(20, 51))
    assert time.process_time() - began_s < 1.0


@pytest.mark.slow
def test_a_ratio_of_medians_is_significant_when_its_interval_excludes_one() -> None:
    rng, names = np.random.default_rng(0), houses_of(20, 10)
    first = rng.uniform(50.0, 150.0, 200)
    half, same = (
        ratio_of_medians(list(first), list(0.5 * first), names),
        ratio_of_medians(list(first), list(first), names),
    )
    assert half.mean == pytest.approx(0.5)
    assert half.low == half.high == pytest.approx(0.5)  # each resample keeps the pairs together
    assert (half.significant, same.mean, same.significant) == (True, 1.0, False)


@pytest.mark.slow
def test_the_interval_of_a_ratio_of_medians_holds_the_true_one_in_about_95_of_100_samples() -> None:
    rng, held, names = np.random.default_rng(0), 0, houses_of(20, 5)
    for _ in range(60):
        of_houses = np.repeat(rng.normal(0.0, 0.3, 20), 5)
        first = np.exp(4.0 + of_houses + rng.normal(0.0, 0.5, 100))
        second = 0.8 * np.exp(4.0 + of_houses + rng.normal(0.0, 0.5, 100))
        found = ratio_of_medians(list(first), list(second), names, resamples=300)
        assert found.low is not None
        assert found.high is not None
        held += found.low <= 0.8 <= found.high
    assert held / 60 >= 0.88


def test_a_ratio_without_pairs_or_to_zero_is_no_number_that_misleads() -> None:
    assert ratio_of_medians([None], [1.0], ["a"]) == Estimate(None, None, None, 0, 0, neutral=1.0)
    assert ratio_of_medians([0.0, 0.0], [1.0, 2.0], ["a", "b"]).mean == float("inf")
