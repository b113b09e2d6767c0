"""The figures of a report: bins, histograms, calibration of stops, trends of runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest
from msgspec.structs import replace

from sim.app.analysis.report.distributions import (
    DISTANCES,
    FIRST_SIGHT_LABELS,
    FIRST_SIGHTS,
    HOUSE_SIZES,
    SPL_LABELS,
    Bins,
    Histogram,
    calibration,
    first_sight_histogram,
    spl_histogram,
)
from sim.app.analysis.report.episodes import by_number
from sim.app.analysis.report.figures import grouped, proportion_of
from sim.app.analysis.report.trend import BOTTOM, HEIGHT, METRICS, TOP, trend
from sim.task.result import EpisodeResult
from tests.helpers.results import a_goal, a_result


def line(**changed: Any) -> EpisodeResult:
    """Returns the result of a successful episode."""
    return a_result(**{"episode_id": "e0", "first_seen_step": 7, "steps_to_first_sight": 7, "collisions": 2} | changed)


@pytest.mark.parametrize("bins", [DISTANCES, HOUSE_SIZES])
def test_a_number_is_in_the_bin_that_begins_at_or_below_it_and_ends_above_it(bins: Bins) -> None:
    assert len(bins.names) == len(set(bins.names)) == len(bins.edges) + 1
    for i, edge in enumerate(bins.edges):
        assert bins.name(edge) == bins.names[i]
        assert bins.name(edge - 1e-9) == bins.names[max(0, i - 1)]
    assert bins.name(1e9) == bins.names[-2]
    assert bins.name(None) == bins.unknown == bins.names[-1]
    assert len(FIRST_SIGHT_LABELS) == len(FIRST_SIGHTS) + 1


def test_numbers_in_names_are_sorted_by_value_and_a_superscript_is_no_number() -> None:
    assert sorted(["val_10", "flat_2²", "val_9"], key=by_number) == ["flat_2²", "val_9", "val_10"]


def test_groups_hold_each_episode_once_and_differences_are_from_the_first_run() -> None:
    first = [line(success=float(i % 2)) for i in range(6)]
    second, third = [line(success=1.0)] * 6, [line(success=0.0)] * 6
    names = ["a", "b", "a", "c", "c", "c"]
    groups = grouped([first, second, third], names, ["c", "b", "nothing", "a"])
    assert [group.name for group in groups] == ["c", "b", "a"]
    assert [share.of for group in groups for share in group.shares] == [3, 3, 3, 1, 1, 1, 2, 2, 2]
    assert [[cell.estimate.mean for cell in group.differences] for group in groups] == [
        [pytest.approx(1 / 3), pytest.approx(-2 / 3)], [0.0, -1.0], [1.0, 0.0]
    ]  # fmt: skip


def counts_of(labels: Sequence[str], histogram: Histogram) -> dict[str, int]:
    """Returns the counts of the first run's bins that are not empty."""
    return {name: share.count for name, share in zip(labels, histogram.shares[0], strict=True) if share.count}


def test_replicates_of_an_episode_do_not_make_the_interval_narrower() -> None:
    once = [line(episode_id=f"e{i}", house=f"h{i}", spl=i / 10, stop_confidence=0.5) for i in range(8)]
    often = [replace(line, episode_id=f"{line.episode_id}~{k}") for line in once for k in range(1, 6)]
    for few, many in zip(spl_histogram([once]).shares[0], spl_histogram([often]).shares[0], strict=True):
        assert many.count == 5 * few.count
        assert many.interval == pytest.approx(few.interval)
    assert calibration(often).correct.interval == pytest.approx(calibration(once).correct.interval)


def test_spl_counts_failures_apart_and_each_tenth_from_its_lower_edge() -> None:
    lines = [line(spl=value) for value in (0.0999, 0.1, 0.95, 1.0)]
    lines.append(line(spl=0.0, success=0.0))
    lines = [replace(line, episode_id=f"e{i}", house=f"h{i}") for i, line in enumerate(lines)]
    histogram = spl_histogram([lines, []])
    assert counts_of(SPL_LABELS, histogram) == {"failed": 1, "0-0.1": 1, "0.1-0.2": 1, "0.9-1": 2}
    assert [{share.of for share in shares} for shares in histogram.shares] == [{5}, {0}]
    assert [share.percent for share in histogram.shares[0] if share.count] == pytest.approx([20.0, 20.0, 20.0, 40.0])
    assert histogram.shares[0][-1].interval[1] == pytest.approx(0.869, abs=0.001)  # 2 of 5, with Student's t of 4
    assert histogram.top_percent == 100
    assert spl_histogram([[], []]).top_percent == 100


def test_an_episode_that_never_showed_the_goal_is_the_last_bin_of_first_sights() -> None:
    lines = [line(first_seen_step=step) for step in (0, 1, 9, 10, 499)]
    lines += [line(first_seen_step=None, gt_explored=False), line(first_seen_step=None, gt_explored=None)]
    assert counts_of(FIRST_SIGHT_LABELS, first_sight_histogram([lines])) == {
        "0": 1, "1-9": 2, "10-24": 1, "200 on": 1, "never": 1
    }  # fmt: skip


def stops(*pairs: tuple[float, int]) -> list[EpisodeResult]:
    return [line(stop_confidence=confidence, success=float(success)) for confidence, success in pairs]


def test_confidence_that_equals_the_share_of_correct_stops_has_no_calibration_error() -> None:
    perfect = stops(*[(0.75, 1)] * 3, (0.75, 0), *[(1.0, 1)] * 4)
    assert calibration(perfect).error == pytest.approx(0.0)
    sure = stops(*[(1.0, 1)] * 3, (1.0, 0))
    assert calibration(sure).error == pytest.approx(0.25)


def test_calibration_counts_stops_with_a_confidence_in_tenths() -> None:
    lines = [*stops((0.0, 0), (0.31, 0), (0.39, 1), (1.0, 1)), line(stop_confidence=None)]
    lines.append(line(end_reason="max_steps", success=0.0, stop_confidence=0.9))
    curve = calibration(lines)
    assert curve.stops == 5
    assert curve.correct.of == 4
    assert [(b.low, b.correct.count, b.correct.of) for b in curve.bins] == [(0.0, 0, 1), (0.3, 1, 2), (0.9, 1, 1)]
    assert curve.bins[1].confidence == pytest.approx(0.35)
    assert calibration([line()]).bins == []


def test_the_confidence_of_a_chain_is_that_of_its_last_stop() -> None:
    episode = line(stop_confidence=0.9, success=0.5)
    first, last = a_goal(success=0.0), a_goal(success=1.0)
    for goals, correct in (((first, last), 1), ((last, first), 0)):
        assert calibration([replace(episode, goals=goals)]).correct.count == correct


def runs(*collisions: Sequence[float]) -> list[list[EpisodeResult]]:
    return [[line(house=f"h{i}", collisions=c) for i, c in enumerate(of_run)] for of_run in collisions]


def test_a_trend_shows_each_run_in_order_within_the_chart() -> None:
    charts = trend(runs([0, 0, 0], [10, 20, 30], [4, 5, 6]), "ABC")
    assert [chart.title for chart in charts] == [metric.title for metric in METRICS]
    points = charts[-1].points
    assert [point.label for point in points] == ["A", "B", "C"]
    assert points[0].x < points[1].x < points[2].x
    assert points[1].y < points[2].y < points[0].y == HEIGHT - BOTTOM  # more collisions are higher
    for point in points:
        assert TOP <= point.high_y <= point.y <= point.low_y <= HEIGHT
    assert float(charts[-1].top) >= 30.0


def test_two_runs_are_no_trend_and_a_number_that_no_run_has_is_left_out() -> None:
    assert trend(runs([1], [2]), "AB") == []
    without = [[line(steps_to_first_sight=None)]] * 3
    assert "steps to first sight" not in [chart.title for chart in trend(without, "ABC")]


def test_a_proportion_is_over_episodes_whatever_their_number_of_replicates() -> None:
    lines = [line(episode_id=name) for name in ("x", "x~1", "x~2", "y")]
    proportion = proportion_of([True, True, True, False], lines)
    assert (proportion.count, proportion.of, proportion.percent) == (3, 4, 50.0)
    assert proportion_of([], []).percent == 0.0
