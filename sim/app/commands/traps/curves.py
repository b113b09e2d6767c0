"""Curves of success and collisions over parameters of traps: bins with as many traps each, and 95 % intervals."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.app.analysis.report.figures import proportion
from sim.app.commands.traps.trial import TrapResult
from sim.app.evaluation.intervals import estimate
from sim.homes.housegen.traps.families.catalogue import FAMILIES
from sim.houses.sidecar import TrapFacts

MAX_BINS = 5
Rows = Sequence[TrapResult]
"""Rows of `sim.app.commands.traps.report`."""


@dataclass(frozen=True)
class Quantity:
    """A number of each trap over which curves are drawn."""

    name: str
    label: str
    value: Callable[[TrapFacts], float | None]
    """None: the trap is not part of the curve."""


def _pane_length_m(facts: TrapFacts) -> float | None:
    """Returns the total length of the panes; None for families of other obstacles."""
    family = FAMILIES.get(facts.family)
    return facts.hidden_length_m if family is not None and family.of_panes else None


QUANTITIES = (
    Quantity("gap_m", "width of the gap, m", lambda facts: facts.gap_m),
    Quantity("pane_length_m", "total length of the panes, m", _pane_length_m),
    Quantity("hidden_objects", "number of hidden objects", lambda facts: float(facts.hidden_objects)),
)


@dataclass(frozen=True)
class Point:
    """One bin of one agent's curve: its traps, its success rate and its mean number of collisions with intervals."""

    agent: str
    quantity: str
    low: float
    """Smallest value in the bin."""
    high: float
    """Largest value in the bin."""
    middle: float
    """Mean value in the bin."""
    episodes: int
    success: float
    success_low: float
    success_high: float
    collisions: float
    collisions_low: float
    collisions_high: float


def curve(rows: Rows, facts: Mapping[str, TrapFacts], quantity: Quantity) -> list[Point]:
    """Returns the points of all agents; bins are those of all traps that any agent has run.

    Args:
        rows: results.
        facts: of each trap by its name.
        quantity: over which the curve is.
    """
    values = {trap: quantity.value(facts[trap]) for trap in dict.fromkeys(row.trap for row in rows)}
    known = {trap: value for trap, value in values.items() if value is not None}
    if not known:
        return []
    edges = bin_edges(np.array(list(known.values())))
    points = []
    for agent in sorted({row.agent for row in rows}):
        for low, high in itertools.pairwise(edges.tolist()):
            inside = [
                row for row in rows
                if row.agent == agent and row.trap in known and low <= known[row.trap] < high
            ]  # fmt: skip
            if inside:
                points.append(point_of(agent, quantity.name, inside, [known[row.trap] for row in inside]))
    return points


def bin_edges(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the edges of at most `MAX_BINS` bins [low, high) with about as many values each; none is empty."""
    quantiles = np.quantile(values, np.linspace(0.0, 1.0, MAX_BINS + 1)[:-1], method="higher")
    return np.append(np.unique(quantiles), np.inf)


def point_of(agent: str, quantity: str, rows: Rows, values: Sequence[float] = (0.0,)) -> Point:
    """Returns success and collisions of an agent over some rows, and the range of the values of their traps."""
    traps = [row.trap for row in rows]
    share = proportion([row.escaped for row in rows], traps)
    collisions = estimate([float(row.collisions) for row in rows], traps)
    assert collisions.mean is not None
    return Point(
        agent, quantity, min(values), max(values), float(np.mean(values)), len(rows),
        share.mean, *share.interval, collisions.mean, *collisions.ends,
    )  # fmt: skip
