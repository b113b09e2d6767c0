"""Computes the numbers of a report: means with intervals, groups of episodes, causes of failure, paired differences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import msgspec

from sim.app.analysis.metrics import SUCCESS, difference_cell, episodes_of, houses_of, mean_cell
from sim.app.analysis.tables import Cell
from sim.app.evaluation.intervals import estimate, paired_difference
from sim.app.evaluation.summary import few_episodes
from sim.core.interface import GOAL_CATEGORIES
from sim.task.explanations import MEANING, outcome
from sim.task.failures import CAUSES
from sim.task.result import EpisodeResult, GoalResult, Metric, metrics_for


@dataclass(frozen=True)
class Proportion:
    """The proportion of episodes with a property, with its 95 % interval; each replicate of an episode is a line."""

    count: int
    """Lines with the property."""
    of: int
    """Lines."""
    mean: float
    """The proportion over episodes; 0 without episodes."""
    interval: tuple[float, float]

    @property
    def percent(self) -> float:
        """The proportion in percent."""
        return 100.0 * self.mean


def proportion(values: Sequence[bool], houses: Sequence[str], episodes: Sequence[str] | None = None) -> Proportion:
    """Returns the proportion of values that are true, with its interval over houses; see `estimate`."""
    share = estimate(values, houses, episodes=episodes, most=1.0)
    low, high = (limit if end is None else end for end, limit in ((share.low, 0.0), (share.high, 1.0)))
    return Proportion(sum(values), len(values), share.mean or 0.0, (low, high))


def proportion_of(values: Sequence[bool], lines: Sequence[EpisodeResult]) -> Proportion:
    """Returns the proportion of some lines with a property; replicates of an episode count once."""
    return proportion(values, houses_of(lines), episodes_of(lines))


@dataclass(frozen=True)
class Group:
    """A row of a table: a group of episodes."""

    name: str
    shares: Sequence[Proportion]
    """One for each run."""
    differences: Sequence[Cell]
    """One for each run after the first: that run minus the first, in percent of the pairs."""
    note: str = ""


Runs = Sequence[Sequence[EpisodeResult]]
"""The results of each run; all have the same episodes in the same order."""


def groups(runs: Runs, key: Literal["goal", "house"]) -> list[Group]:
    """Returns the success by goal category (in the order of the contract) or by house (by name).

    Chains are split into their goals, which are grouped by kind and by visit in place of the category.
    """
    if key == "goal" and any(line.goals is not None for line in runs[0]):
        runs = _by_goals(runs)
    names = [getattr(result, key) for result in runs[0]]
    order = [goal for goal in GOAL_CATEGORIES if goal in names]
    return grouped(runs, names, [*order, *sorted(set(names).difference(order))])


def goal_group(goal: GoalResult) -> str:
    """Returns the name of the group of a goal of a chain."""
    return f"{goal.kind}, {'first' if goal.repeats is None else 'second'} visit"


def _by_goals(runs: Runs) -> Runs:
    """Returns a line for each goal of the chains, with its kind and visit as its goal."""
    result: list[list[EpisodeResult]] = [[] for _ in runs]
    for lines in zip(*runs, strict=True):
        goals = next((line.goals for line in lines if line.goals is not None), ())
        for number, goal in enumerate(goals):
            for of_run, line in zip(result, lines, strict=True):
                success = 0.0 if line.goals is None else line.goals[number].success
                episode_id = f"{line.episode_id}, goal {number + 1}"  # goals are no replicates of one episode
                of_run.append(
                    msgspec.structs.replace(
                        line, episode_id=episode_id, goal=goal_group(goal), success=success, goals=None
                    )
                )
    return result


def grouped(runs: Runs, names: Sequence[str], order: Sequence[str]) -> list[Group]:
    """Returns the success by group.

    Args:
        runs: the lines of each run.
        names: the group of each episode.
        order: the groups to return; those without an episode are left out.
    """
    rows = []
    for name in (name for name in order if name in names):
        some = [[line for line, of in zip(lines, names, strict=True) if of == name] for lines in runs]
        shares = [proportion_of([result.success == 1.0 for result in lines], lines) for lines in some]
        rows.append(Group(name, shares, differences(SUCCESS, some)))
    return rows


def causes(runs: Runs) -> list[Group]:
    """Returns the episodes that failed by each cause, the most frequent first; proportions are of all episodes."""
    outcomes = [[outcome(line) for line in lines] for lines in runs]
    houses, episodes = houses_of(runs[0]), episodes_of(runs[0])
    known = {name for names in outcomes for name in names} - {"found"}
    rows = []
    for cause in [*(cause for cause in CAUSES if cause in known), *sorted(known.difference(CAUSES))]:
        failed = [[name == cause for name in names] for names in outcomes]
        shares = [proportion_of(values, runs[0]) for values in failed]
        compared = [paired_difference(failed[0], values, houses, episodes=episodes, most=1.0) for values in failed[1:]]
        against = [Cell(estimate, percent=True, difference=True) for estimate in compared]
        rows.append(Group(cause, shares, against, MEANING.get(cause, _OTHER.get(cause, ""))))
    return sorted(rows, key=lambda group: -sum(share.count for share in group.shares))


_OTHER = {"error": "The episode ended with an error.", "failed": "No cause was recorded."}


def means(runs: Runs) -> list[tuple[Metric, list[Cell], list[Cell]]]:
    """Returns for each metric its mean in each run, and the paired differences of the others from the first run."""
    return [
        (metric, [mean_cell(metric, lines) for lines in runs], differences(metric, runs))
        for metric in metrics_for([line for lines in runs for line in lines])
    ]


def differences(metric: Metric, runs: Runs) -> list[Cell]:
    """Returns the paired difference of each run after the first: that run minus the first."""
    return [difference_cell(metric, runs[0], lines) for lines in runs[1:]]


def interval_note(runs: Runs) -> str:
    """Returns the sentence that says how the intervals of a report are made."""
    few = few_episodes(min(len(set(episodes_of(run))) for run in runs))
    if len(set(houses_of(runs[0]))) == 1:
        note = "95 % intervals. There is one house: they (*) are over its episodes, and say nothing about other houses."
    else:
        note = "95 % intervals over houses, by Student's t and Wilson's formula."
    return f"{note} {few}".rstrip()
