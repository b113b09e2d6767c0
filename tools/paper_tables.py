"""The paper's tables from result lines: which runs each needs, and what it makes of them.

Every table has means with 95 % bootstrap intervals over the episodes that all its runs have played, and the differences
of pairs of runs, paired by episode.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from sim.analysis.comparison import Line, estimate, paired_difference
from sim.analysis.metrics import COLLISIONS, EXPLORED, SPL, STEPS, SUCCESS, TRAPPED, Metric
from sim.analysis.tables import Cell, ResultTable
from sim.interface import GOAL_CATEGORIES, ConfigError
from sim.task.failures import CAUSES

TRUTH = "gt"
SEMANTICS_DO_NOT_MATTER = ("oracle", "random")
"""Agents that look at no segmentation; they are played once, with `gt`."""


@dataclass(frozen=True)
class Player:
    """Who plays, with which segmentation."""

    agent: str
    semantics: str

    @property
    def label(self) -> str:
        """In a table with several kinds of segmentation."""
        return self.agent if self.agent in SEMANTICS_DO_NOT_MATTER else f"{self.agent} ({self.semantics})"


Lines = Mapping[Player, Sequence[Line]]
"""For each player the lines of the same episodes, in the same order."""
ABLATION = {"I": "stubborn-i", "II": "stubborn-ii", "III": "stubborn-iii", "IV": "stubborn-iv", "V": "stubborn"}
"""Row V is `stubborn`, so that its episodes serve the other tables."""


@dataclass(frozen=True)
class PaperTable:
    """One of the paper's tables."""

    agents: tuple[str, ...]
    """Who plays unless somebody else is asked for; the first is what the others are compared with."""
    semantics: str
    """Where segmentation comes from unless something else is asked for."""
    build: Callable[[Lines, Sequence[Player]], list[ResultTable]]

    def players(self, agents: Sequence[str] = (), semantics: str | None = None) -> tuple[Player, ...]:
        """The runs that it needs."""
        chosen = semantics or self.semantics
        return tuple(
            Player(agent, TRUTH if agent in SEMANTICS_DO_NOT_MATTER else chosen) for agent in agents or self.agents
        )


def failures(lines: Lines, players: Sequence[Player]) -> list[ResultTable]:
    """Table I: why the failed episodes failed; `failure` of the lines is one of `sim.task.failures.CAUSES`."""
    rows: list[tuple[str, list[Cell | str]]] = []
    for cause in CAUSES:
        shares = ([float(line["failure"] == cause) for line in lines[p] if not line["success"]] for p in players)
        rows.append((cause, [Cell(estimate(share), percent=True) for share in shares]))
    failed = [sum(not line["success"] for line in lines[p]) for p in players]
    rows.append(("failed episodes", [f"{count} of {len(lines[p])}" for count, p in zip(failed, players, strict=True)]))
    rows.append(("success %", [SUCCESS.cell(lines[p]) for p in players]))
    header = ("cause", *(player.label for player in players))
    causes = ResultTable("failures", "Causes of failure, % of the failed episodes", header, rows)
    pairs = _against_first(players)
    return [
        causes,
        ResultTable(
            "failures_differences",
            "Episodes that failed by each cause, difference in % of all episodes",
            ("cause", *(_named(pair) for pair in pairs)),
            [(cause, [_failed_by(cause, lines[b], lines[a]) for a, b in pairs]) for cause in CAUSES],
        ),
    ]


def ablation(lines: Lines, players: Sequence[Player]) -> list[ResultTable]:
    """Table III: what each means against collisions does; a row against the one before, the last against the first."""
    names = {agent: row for row, agent in ABLATION.items()}
    metrics = (TRAPPED, EXPLORED, COLLISIONS, SPL, SUCCESS)
    pairs = [(b, a) for a, b in itertools.pairwise(players)]
    if len(players) > 2:
        pairs.append((players[-1], players[0]))
    title = f"Avoiding collisions, {players[0].semantics} segmentation"
    return _means_and_differences("ablation", title, lines, players, pairs, metrics, names)


def exploration(lines: Lines, players: Sequence[Player]) -> list[ResultTable]:
    """Table IV: how often the goal was seen, by category."""
    rows: list[tuple[str, list[Cell | str]]] = [
        (f"{goal} ({len(some[players[0]])})", [EXPLORED.cell(some[p]) for p in players])
        for goal, some in _by_goal(lines)
    ]
    rows.append((f"all ({len(lines[players[0]])})", [EXPLORED.cell(lines[p]) for p in players]))
    header = ("goal (episodes)", *(player.agent for player in players))
    seen = ResultTable("exploration", "GT exploration, %: the goal covered 0.8 % of a frame", header, rows)
    pairs = [(a, b) for i, b in enumerate(players) for a in players[:i]]
    return [seen, _differences("exploration", lines, pairs, (EXPLORED, TRAPPED, COLLISIONS), {})]


def categories(lines: Lines, players: Sequence[Player]) -> list[ResultTable]:
    """Table V: success by category, and each other player against the first."""
    pairs = _against_first(players)

    def row(of: Lines) -> list[Cell | str]:
        return [*(SUCCESS.cell(of[p]) for p in players), *(SUCCESS.difference(of[b], of[a]) for a, b in pairs)]

    rows = [(f"{goal} ({len(some[players[0]])})", row(some)) for goal, some in _by_goal(lines)]
    rows.append((f"all ({len(lines[players[0]])})", row(lines)))
    header = ("goal (episodes)", *(player.agent for player in players), *(_named(pair) for pair in pairs))
    return [ResultTable("categories", f"Success, %, {players[0].semantics} segmentation", header, rows)]


def overall(lines: Lines, players: Sequence[Player]) -> list[ResultTable]:
    """Table VI: success and SPL of everybody, each against the first."""
    metrics = (SUCCESS, SPL, EXPLORED, COLLISIONS, STEPS)
    return _means_and_differences("overall", "All agents", lines, players, _against_first(players), metrics, {})


TABLES: Mapping[str, PaperTable] = {
    "failures": PaperTable(("stubborn", "single-frame", "frontier-avoid"), "noisy", failures),
    "ablation": PaperTable(tuple(ABLATION.values()), TRUTH, ablation),
    "exploration": PaperTable(("stubborn", "stubborn-i", "frontier-avoid", "frontier"), TRUTH, exploration),
    "categories": PaperTable(("stubborn", "single-frame"), "noisy", categories),
    "overall": PaperTable(
        ("stubborn", "stubborn-plus", "single-frame", "frontier-avoid", "frontier", "random", "oracle"),
        "noisy",
        overall,
    ),
}
"""By name."""


def table_named(name: str) -> PaperTable:
    """The table of that name.

    Raises:
        ConfigError: there is none.
    """
    if name not in TABLES:
        raise ConfigError(f"There is no table '{name}'. There is: {', '.join(TABLES)}.")
    return TABLES[name]


def _means_and_differences(
    name: str,
    title: str,
    lines: Lines,
    players: Sequence[Player],
    pairs: Sequence[tuple[Player, Player]],
    metrics: Sequence[Metric],
    names: Mapping[str, str],
) -> list[ResultTable]:
    rows = [
        (f"{names[p.agent]} {p.agent}" if p.agent in names else p.label, [metric.cell(lines[p]) for metric in metrics])
        for p in players
    ]
    means = ResultTable(name, title, ("agent", *(metric.title for metric in metrics)), rows)
    return [means, _differences(name, lines, pairs, metrics, names)]


def _differences(
    name: str,
    lines: Lines,
    pairs: Iterable[tuple[Player, Player]],
    metrics: Sequence[Metric],
    names: Mapping[str, str],
) -> ResultTable:
    """A row a pair: the first minus the second, in each metric."""
    rows = [
        (
            f"{names.get(a.agent, a.label)} - {names.get(b.agent, b.label)}",
            [metric.difference(lines[b], lines[a]) for metric in metrics],
        )
        for a, b in pairs
    ]
    header = ("agents", *(metric.title for metric in metrics))
    return ResultTable(f"{name}_differences", "Differences, paired by episode", header, rows)


def _against_first(players: Sequence[Player]) -> list[tuple[Player, Player]]:
    return [(players[0], other) for other in players[1:]]


def _named(pair: tuple[Player, Player]) -> str:
    return f"{pair[0].agent} - {pair[1].agent}"


def _failed_by(cause: str, first: Sequence[Line], second: Sequence[Line]) -> Cell:
    values = ([float(line["failure"] == cause) for line in lines] for lines in (first, second))
    return Cell(paired_difference(*values), percent=True, difference=True)


def _by_goal(lines: Lines) -> list[tuple[str, Lines]]:
    """The goals that were asked for, in the contract's order, with their lines."""
    parts = [
        (goal, {player: [line for line in of if line["goal"] == goal] for player, of in lines.items()})
        for goal in GOAL_CATEGORIES
    ]
    return [(goal, part) for goal, part in parts if all(part.values())]
