"""Metrics of a chain of goals: those of GOAT-Bench under our rule of success, and the gain on second visits.

Each goal is measured like an episode that starts where the goal before it ended, with its own number of actions; SPL
restarts at each goal. In the result of a chain shares, SPL and distances are means over its goals, and numbers of
actions, lengths and times are sums. `success` is GOAT-Bench's `partial_success` and `spl` its `composite_spl` (Khanna
et al. 2024, arXiv:2404.06609), with a STOP that is judged by our rule; `goat_success` and `goat_spl` judge it by a
distance of 0.25 m. Unlike there, success and SPL use one set of places, and a goal asks for the objects of an earlier
one only if the episode says so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar, cast

import msgspec

from sim.core.goals import GoalSpec
from sim.task import metrics
from sim.task.result import (
    GOAT_DISTANCE_M,
    NO_STOP_TARGET,
    EndReason,
    EpisodeMetrics,
    GoalMetrics,
    GoalResult,
    metrics_without_episode,
)

T = TypeVar("T")


def goal_result(goal: GoalSpec, measured: GoalMetrics) -> GoalResult:
    """Returns the result of a goal of a chain from its metrics at its end."""
    distance_m = measured.distance_to_goal
    stopped_near = measured.end_reason == "stop" and distance_m is not None and distance_m < GOAT_DISTANCE_M
    spl = metrics.spl(stopped_near, measured.shortest_path, measured.path_length)
    values = {name: getattr(measured, name) for name in GoalMetrics.__struct_fields__}
    return GoalResult(
        **values, goal=goal.text, kind=goal.kind, repeats=goal.repeats, goat_success=float(stopped_near), goat_spl=spl
    )


def not_begun(goal: GoalSpec, reason: EndReason | None) -> GoalResult:
    """Returns the result of a goal that the robot did not get to, because the chain ended or still runs."""
    empty = msgspec.structs.replace(metrics_without_episode(None), end_reason=reason, failure=reason and "misc")
    return goal_result(goal, empty)


def chain_metrics(goals: Sequence[GoalResult]) -> EpisodeMetrics:
    """Returns the metrics of a chain from the results of all of its goals."""
    seen = [goal.first_seen_step for goal in goals]
    path_m, area_m2 = sum(goal.path_length for goal in goals), _largest(goal.area_seen_m2 for goal in goals)
    again = [goal for goal in goals if goal.repeats is not None]
    begun = [goal for goal in goals if goal.num_steps] or goals[:1]
    return EpisodeMetrics(
        success=_mean(goal.success for goal in goals),
        spl=_mean(goal.spl for goal in goals),
        soft_spl=_mean(goal.soft_spl for goal in goals),
        distance_to_goal=_if_all((goal.distance_to_goal for goal in goals), _mean),
        num_steps=sum(goal.num_steps for goal in goals),
        path_length=path_m,
        shortest_path=_if_all((goal.shortest_path for goal in goals), sum),
        collisions=sum(goal.collisions for goal in goals),
        touches=sum(goal.touches for goal in goals),
        gt_explored=all(step is not None for step in seen),
        first_seen_step=_if_all(seen, sum),
        steps_to_first_sight=_if_all((goal.steps_to_first_sight for goal in goals), sum),
        area_seen_m2=area_m2,
        area_per_metre=None if area_m2 is None else metrics.per_metre(area_m2, path_m),
        trapped=any(goal.trapped for goal in goals),
        simulated_s=sum(goal.simulated_s for goal in goals),
        failure=next((goal.failure for goal in goals if goal.failure is not None), None),
        end_reason=goals[-1].end_reason,
        composite_success=float(all(goal.success for goal in goals)),
        second_visit_success=_mean(goal.success for goal in again) if again else None,
        second_visit_spl=_mean(goal.spl for goal in again) if again else None,
        goat_success=_mean(goal.goat_success for goal in goals),
        goat_spl=_mean(goal.goat_spl for goal in goals),
        goals=tuple(goals),
        **{name: getattr(begun[-1], name) for name in type(NO_STOP_TARGET).__struct_fields__},
    )


def _mean(values: Iterable[float]) -> float:
    numbers = list(values)
    return sum(numbers) / len(numbers)


def _if_all(values: Iterable[T | None], of: Callable[[list[T]], T]) -> T | None:
    """Returns a function of some values; None if one of them is None."""
    known = list(values)
    return None if any(value is None for value in known) else of(cast(list[T], known))


def _largest(values: Iterable[float | None]) -> float | None:
    return max((value for value in values if value is not None), default=None)
