"""What contacts change: agents with physics, and with the kinematic motion of Habitat, in the same episodes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import kendalltau

from sim.app.analysis.metrics import COLLISIONS, SPL, SUCCESS, difference_cell, episodes_of, houses_of, mean_cell
from sim.app.analysis.tables import Cell, ResultTable
from sim.app.commands.reproduce.runs import AgentSetup
from sim.app.evaluation.intervals import Estimate, paired_difference
from sim.task.result import EpisodeResult, Metric

MOTIONS = ("contacts", "no-sliding", "sliding")
AGENTS = (
    "stubborn", "stubborn-i", "stubborn-plus", "stubborn --explorer informed-tour", "frontier", "frontier-avoid",
    "semexp", "poni", "random", "oracle",
)  # fmt: skip
SETUPS = tuple(
    agent if motion == MOTIONS[0] else f"{agent} --motion {motion}" for agent in AGENTS for motion in MOTIONS
)
_DRAWS = 2000

Rows = Mapping[str, Mapping[str, Sequence[EpisodeResult]]]
"""The results of each agent, by motion."""


def motions(lines: Mapping[AgentSetup, Sequence[EpisodeResult]], setups: Sequence[AgentSetup]) -> list[ResultTable]:
    """Returns the tables: means, what the first motion changes, the orders of agents, and what measures are worth."""
    rows = _by_agent(lines, setups)
    shown = [motion for motion in MOTIONS if all(motion in of for of in rows.values())]
    tables = [
        *(_means(rows, shown, metric, setups[0].semantics) for metric in (SUCCESS, SPL, COLLISIONS)),
        _changes(rows, shown),
        _orders(rows, shown),
    ]
    if {"stubborn", "stubborn-i"} <= set(rows):
        tables += [_measures(rows, shown), _measures_by_motion(rows, shown)]
    return tables


def _by_agent(lines: Mapping[AgentSetup, Sequence[EpisodeResult]], setups: Sequence[AgentSetup]) -> Rows:
    rows: dict[str, dict[str, Sequence[EpisodeResult]]] = {}
    for setup in setups:
        agent, _, words = setup.name.partition(" --motion ")
        motion, _, further = words.partition(" ")
        rows.setdefault(f"{agent} {further}".strip(), {})[motion or MOTIONS[0]] = lines[setup]
    return rows


def _means(rows: Rows, shown: Sequence[str], metric: Metric, semantics: str) -> ResultTable:
    return ResultTable(
        f"motions_{metric.key}",
        f"{metric.title} by kind of motion ({semantics} segmentation)",
        ("agent", *shown),
        [(agent, [mean_cell(metric, of[motion]) for motion in shown]) for agent, of in rows.items()],
    )


def _changes(rows: Rows, shown: Sequence[str]) -> ResultTable:
    """Returns the differences of the first motion, contacts if they were run, to each other one."""
    columns = [(metric, motion) for metric in (SUCCESS, SPL) for motion in shown[1:]]
    return ResultTable(
        "motions_differences",
        "Differences between motions, paired by episode",
        ("agent", *(f"{metric.title}: {shown[0]} - {motion}" for metric, motion in columns)),
        [
            (agent, [difference_cell(metric, of[motion], of[shown[0]]) for metric, motion in columns])
            for agent, of in rows.items()
        ],
    )


def _measures(rows: Rows, shown: Sequence[str]) -> ResultTable:
    return ResultTable(
        "motions_measures",
        "What the measures against collisions are worth: `stubborn` minus `stubborn-i`",
        ("motion", SUCCESS.title, SPL.title),
        [
            (motion, [difference_cell(m, rows["stubborn-i"][motion], rows["stubborn"][motion]) for m in (SUCCESS, SPL)])
            for motion in shown
        ],
    )


def _measures_by_motion(rows: Rows, shown: Sequence[str]) -> ResultTable:
    return ResultTable(
        "motions_measures_by_motion",
        "Whether the measures are worth more with one kind of motion than with another",
        ("motions", SUCCESS.title, SPL.title),
        [
            (f"{b} - {a}", [_worth_difference(rows, metric, a, b) for metric in (SUCCESS, SPL)])
            for a, b in itertools.combinations(shown, 2)
        ],
    )


def _worth_difference(rows: Rows, metric: Metric, a: str, b: str) -> Cell:
    """Returns what the measures are worth with motion b minus their worth with motion a, paired by episode."""
    some = rows["stubborn"][a]
    first, second = (
        [
            (metric.value(has) or 0.0) - (metric.value(lacks) or 0.0)
            for has, lacks in zip(rows["stubborn"][motion], rows["stubborn-i"][motion], strict=True)
        ]
        for motion in (a, b)
    )
    difference = paired_difference(first, second, houses_of(some), episodes=episodes_of(some))
    return Cell(difference, metric.percent, metric.digits, difference=True)


def _orders(rows: Rows, shown: Sequence[str]) -> ResultTable:
    """Returns Kendall's tau-b between the orders of the agents in two motions."""
    return ResultTable(
        "motions_orders",
        "Rank correlation of the agents between two kinds of motion (Kendall's tau-b)",
        ("motions", SUCCESS.title, SPL.title),
        [
            (f"{a}, {b}", [_order(rows, metric, a, b) for metric in (SUCCESS, SPL)])
            for a, b in itertools.combinations(shown, 2)
        ],
        (f"Intervals are of {_DRAWS} draws of the houses with replacement.",),
    )


def _order(rows: Rows, metric: Metric, a: str, b: str) -> Cell:
    """Returns the rank correlation of the agents' means with an interval over houses."""
    some = next(iter(rows.values()))[a]
    houses, index = np.unique(houses_of(some), return_inverse=True)
    values = np.array([[[metric.value(r) or 0.0 for r in of[motion]] for of in rows.values()] for motion in (a, b)])
    sums = np.stack([values[..., index == house].sum(axis=-1) for house in range(len(houses))], axis=-1)
    counts, rng = np.bincount(index), np.random.default_rng(0)
    tau = _tau(values.mean(axis=-1))
    if math.isnan(tau):  # all agents are equal
        return Cell(Estimate(None, None, None, len(some), len(houses)), digits=2)
    drawn = [_tau(_drawn_means(sums, counts, rng.integers(len(houses), size=len(houses)))) for _ in range(_DRAWS)]
    low, high = np.nanquantile(drawn, (0.025, 0.975))
    return Cell(Estimate(tau, float(low), float(high), len(some), len(houses)), digits=2)


def _drawn_means(sums: np.ndarray, counts: np.ndarray, drawn: np.ndarray) -> np.ndarray:
    """Returns the means (2, agents) over some houses, which may repeat."""
    return sums[..., drawn].sum(axis=-1) / counts[drawn].sum()


def _tau(means: np.ndarray) -> float:
    """Returns the rank correlation of two rows of means (2, agents); NaN where all agents of a row are equal."""
    return float(np.asarray(kendalltau(*means))[0])
