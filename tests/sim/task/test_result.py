"""The type of a result: its metrics, its JSON, and the page that documents it."""

from __future__ import annotations

import json
from pathlib import Path

import msgspec
import pytest

from sim.task.result import (
    METRICS,
    EpisodeMetrics,
    EpisodeResult,
    GoalMetrics,
    StopTarget,
    failed_metrics,
    metrics_without_episode,
    outcome_of,
)
from tests.helpers.results import ENTRIES, a_goal, a_result

PAGE = Path(__file__).parents[3] / "docs" / "task.md"


def test_a_result_written_and_read_is_the_same() -> None:
    driven = a_result(person_steps=3, hint_steps=0, other_driver=None, stop_target_xy_m=(1.0, 2.5))
    for result in (a_result(), driven, a_result(end_reason="error", error="lost")):
        text = json.dumps(result.as_json(), allow_nan=False)
        assert msgspec.json.decode(text, type=EpisodeResult) == result
    assert set(driven.as_json()) - set(a_result().as_json()) == {"person_steps", "hint_steps", "other_driver"}
    assert a_result().as_json() == ENTRIES


def test_an_error_counts_as_a_failure_and_in_no_other_metric() -> None:
    broken = a_result(end_reason="error", success=0.0, spl=0.0, soft_spl=0.0, collisions=4)
    counted = {key for key, metric in METRICS.items() if metric.value(broken) is not None}
    assert counted == {"success", "spl", "soft_spl"}


def test_a_goal_that_was_never_seen_is_the_complement_of_one_that_was() -> None:
    values = [(METRICS["gt_explored"].value(r), METRICS["never_seen"].value(r)) for r in (a_result(gt_explored=True),)]
    assert values == [(1.0, 0.0)]
    assert METRICS["never_seen"].value(a_result(gt_explored=None)) is None


def test_a_metric_that_is_at_most_one_has_a_type_that_says_so() -> None:
    for metric in METRICS.values():
        values = a_result().as_json() | {metric.field: 2.0}
        if metric.most == 1.0:
            with pytest.raises(msgspec.ValidationError):
                msgspec.convert(values, EpisodeResult)


def test_an_episode_that_broke_keeps_its_counts_and_loses_its_scores() -> None:
    whole = msgspec.structs.replace(metrics_without_episode(2.0), success=1.0, spl=0.9, num_steps=7)
    broken = failed_metrics(whole)
    assert (broken.success, broken.spl, broken.soft_spl, broken.failure) == (0.0, 0.0, 0.0, "misc")
    assert (broken.end_reason, broken.num_steps, broken.shortest_path) == ("error", 7, 2.0)


def test_info_has_the_metrics_and_no_first_sight_before_there_is_one() -> None:
    before = metrics_without_episode(2.0)
    own = set(GoalMetrics.__struct_fields__) - set(StopTarget.__struct_fields__)
    assert set(before.as_info()) == own - {"first_seen_step"}
    assert set(msgspec.structs.replace(before, first_seen_step=4).as_info()) == own


def test_the_page_of_the_task_names_every_metric_and_field() -> None:
    page = PAGE.read_text(encoding="utf-8")
    fields = {*EpisodeMetrics.__struct_fields__, "stop_confidence", *METRICS}
    assert [name for name in sorted(fields) if f"`{name}`" not in page] == []


def test_the_outcome_of_a_chain_counts_its_goals() -> None:
    assert outcome_of(a_result()) == "found"
    assert outcome_of(a_result(success=0.0, failure="loop")) == "not found (loop)"
    assert outcome_of(a_result(success=0.0, end_reason="fallen")) == "not found (fallen)"
    chain = msgspec.structs.replace(a_result(success=0.5), goals=(a_goal(), a_goal(success=0.0)))
    assert outcome_of(chain) == "1 of 2 goals found"
