"""The tables of the paper and of the splits, built from result lines: the runs that each table needs, and its rows.

Every table has means with 95 % intervals over the episodes that all its runs have, and paired differences
between runs. Intervals are over houses (`sim.app.evaluation.intervals`).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from sim.app.analysis.metrics import (
    COLLISIONS,
    EXPLORED,
    FIRST_SIGHT,
    SPL,
    STEPS,
    SUCCESS,
    TRAPPED,
    difference_cell,
    episodes_of,
    houses_of,
    mean_cell,
    median_text,
    ratio_cell,
)
from sim.app.analysis.tables import Cell, ResultTable
from sim.app.commands.reproduce import motion_tables
from sim.app.commands.reproduce.runs import GROUND_TRUTH, AgentSetup
from sim.app.evaluation.intervals import estimate, paired_difference
from sim.core.errors import ConfigError
from sim.core.interface import GOAL_CATEGORIES
from sim.task.failures import CAUSES
from sim.task.result import METRICS, EpisodeResult, Metric
from stubborn import agents
from stubborn.detection.verification import ACCEPT_ALL

Lines = Mapping[AgentSetup, Sequence[EpisodeResult]]
"""The lines of each setup, of the same episodes in the same order."""


ABLATION = dict(zip(("I", "II", "III", "IV", "V"), (*tuple(agents.ABLATION)[:-1], "stubborn"), strict=True))
"""The agent of each row of the ablation; the last is the whole agent, whose episodes also serve the other tables."""


@dataclass(frozen=True)
class PaperTable:
    """One of the tables of the paper."""

    agents: tuple[str, ...]
    """The default agents (see `AgentSetup.named`); the others are compared with the first."""
    semantics: str
    """The default source of segmentation."""
    build: Callable[[Lines, Sequence[AgentSetup]], list[ResultTable]]

    def setups(self, agents: Sequence[str] = (), semantics: str | None = None) -> tuple[AgentSetup, ...]:
        """Returns the setups whose runs the table needs."""
        chosen = semantics or self.semantics
        return tuple(AgentSetup.named(agent, chosen) for agent in agents or self.agents)


def failures(lines: Lines, setups: Sequence[AgentSetup]) -> list[ResultTable]:
    """Returns Table I: causes of the failed episodes; `failure` of a line is one of `sim.task.failures.CAUSES`."""
    rows: list[tuple[str, list[Cell | str]]] = [
        *((cause, [_share_of_failures(cause, lines[setup]) for setup in setups]) for cause in CAUSES),
        ("failed episodes", [_count_of_failures(lines[setup]) for setup in setups]),
        ("success %", [mean_cell(SUCCESS, lines[setup]) for setup in setups]),
    ]
    header = ("cause", *(setup.label for setup in setups))
    causes = ResultTable("failures", "Causes of failure, % of the failed episodes", header, rows)
    pairs = _against_first(setups)
    return [
        causes,
        ResultTable(
            "failures_differences",
            "Episodes that failed by each cause, difference in % of all episodes",
            ("cause", *(f"{a.label} - {b.label}" for a, b in pairs)),
            [(cause, [_failed_by(cause, lines[b], lines[a]) for a, b in pairs]) for cause in CAUSES],
        ),
    ]


def ablation(lines: Lines, setups: Sequence[AgentSetup]) -> list[ResultTable]:
    """Returns Table III: the effect of each measure against collisions, by adding one measure per row."""
    names = {agent: row for row, agent in ABLATION.items()}
    metrics = (TRAPPED, EXPLORED, COLLISIONS, SPL, SUCCESS)
    pairs = [(b, a) for a, b in itertools.pairwise(setups)]
    if len(setups) > 2:
        pairs.append((setups[-1], setups[0]))
    title = f"Avoiding collisions, {setups[0].semantics} segmentation"
    return _means_and_differences("ablation", title, lines, setups, pairs, metrics, names)


def exploration(lines: Lines, setups: Sequence[AgentSetup]) -> list[ResultTable]:
    """Returns Table IV: how often the goal was seen, by category."""
    rows = _rows_by_goal(lines, lambda part: [mean_cell(EXPLORED, part[setup]) for setup in setups])
    header = ("goal (episodes)", *(setup.name for setup in setups))
    seen = ResultTable("exploration", "GT exploration, %: the goal covered 0.8 % of a frame", header, rows)
    pairs = [(a, b) for i, b in enumerate(setups) for a in setups[:i]]
    return [seen, _differences("exploration", lines, pairs, (EXPLORED, TRAPPED, COLLISIONS), {})]


def controls(lines: Lines, setups: Sequence[AgentSetup]) -> list[ResultTable]:
    """Returns the figure of SemExp: success with the true semantics and goal, and with wrong ones."""
    metrics = (SUCCESS, SPL, EXPLORED, FIRST_SIGHT)
    title = f"SemExp and its controls, {setups[0].semantics} segmentation"
    return _means_and_differences("controls", title, lines, setups, _against_first(setups), metrics, {})


def categories(lines: Lines, setups: Sequence[AgentSetup]) -> list[ResultTable]:
    """Returns Table V: success by category, and the difference of the first setup to each other one."""
    pairs = _against_first(setups)

    def row(part: Lines) -> list[Cell | str]:
        return [
            *(mean_cell(SUCCESS, part[setup]) for setup in setups),
            *(difference_cell(SUCCESS, part[b], part[a]) for a, b in pairs),
        ]

    header = ("goal (episodes)", *(setup.name for setup in setups), *(f"{a.name} - {b.name}" for a, b in pairs))
    title = f"Success, %, {setups[0].semantics} segmentation"
    return [ResultTable("categories", title, header, _rows_by_goal(lines, row))]


def overall(lines: Lines, setups: Sequence[AgentSetup]) -> list[ResultTable]:
    """Returns Table VI: success and SPL of all setups, and the difference of the first to each other one."""
    metrics = (SUCCESS, SPL, EXPLORED, COLLISIONS, STEPS)
    return _means_and_differences("overall", "All agents", lines, setups, _against_first(setups), metrics, {})


def verification(lines: Lines, setups: Sequence[AgentSetup]) -> list[ResultTable]:
    """Returns success, SPL and causes of failure with each method of verification."""
    metrics = (SUCCESS, SPL, TRAPPED, STEPS)
    title = f"Verification, {setups[0].semantics} segmentation"
    pairs = _against_first(setups)
    return _means_and_differences("verification", title, lines, setups, pairs, metrics, {}) + failures(lines, setups)


def splits(lines: Lines, setups: Sequence[AgentSetup]) -> list[ResultTable]:
    """Returns the table of one split: success, collisions and exploration, and each setup minus the first one."""
    metrics = (SUCCESS, SPL, COLLISIONS, TRAPPED, FIRST_SIGHT, METRICS["never_seen"], METRICS["area_per_metre"])
    pairs = [(other, first) for first, other in _against_first(setups)]
    title = f"Agents, {setups[0].semantics} segmentation"
    means, differences = _means_and_differences("splits", title, lines, setups, pairs, metrics, {})
    rows = [
        (name, [replace(cell, say_significant=True) if isinstance(cell, Cell) else cell for cell in cells])
        for name, cells in differences.rows
    ]
    note = "Steps to first sight: restricted mean; an episode that never showed the goal counts with the step limit."
    return [replace(means, notes=(note,)), replace(differences, rows=rows)]


def explorers(lines: Lines, setups: Sequence[AgentSetup]) -> list[ResultTable]:
    """Returns the tables of `splits`, and one of medians of the time to first sight and their ratio to the first."""
    first = lines[setups[0]]
    rows: list[tuple[str, list[Cell | str]]] = [
        (setup.label, [median_text(FIRST_SIGHT, lines[setup]), *_against(first, lines[setup])]) for setup in setups
    ]
    header = ("agent", "median", f"ratio to {setups[0].name}", "sooner", "later")
    note = (
        "Medians of the steps to first sight; an episode that never showed the goal counts with the step limit. Sooner "
        "and later: episodes."
    )
    return [*splits(lines, setups), ResultTable("first_sight", "Time to first sight", header, rows, (note,))]


UNVERIFIED = f"stubborn --verification {ACCEPT_ALL}"
"""The paper's Single-Frame: the same map, and every candidate is accepted."""
CONTROLS = ("semantics=shuffled", "goal=wrong", "semantics=none")
"""The controls that show whether a learned explorer uses semantics and the goal (the paper's section on SemExp)."""
TABLES: Mapping[str, PaperTable] = {
    "failures": PaperTable(
        ("stubborn", "semexp --verification none", "cloned", f"cloned --semantics {GROUND_TRUTH}"), "rednet", failures
    ),
    "ablation": PaperTable(tuple(ABLATION.values()), GROUND_TRUTH, ablation),
    "exploration": PaperTable(
        ("stubborn", "stubborn-i", "semexp", "stubborn-i --explorer semexp", "frontier-avoid"),
        GROUND_TRUTH,
        exploration,
    ),
    "controls": PaperTable(
        ("semexp", *(f"semexp --config agent.explorer.{control}" for control in CONTROLS)), GROUND_TRUTH, controls
    ),
    "categories": PaperTable(("stubborn", UNVERIFIED), "rednet", categories),
    "overall": PaperTable(
        ("stubborn", UNVERIFIED, "stubborn-plus", "semexp --verification none", "poni", "cloned", "random", "oracle"),
        "rednet",
        overall,
    ),
    "verification": PaperTable(("stubborn", UNVERIFIED, "latest-frame"), "rednet", verification),
    "splits": PaperTable(
        ("stubborn", "frontier-avoid", "frontier", *list(ABLATION.values())[:-1], "oracle"), GROUND_TRUTH, splits
    ),
    "explorers": PaperTable(
        (
            "stubborn",
            "frontier-avoid",
            "frontier",
            "stubborn --explorer tour",
            "stubborn --explorer informed-tour",
            "poni",
            "semexp",
            *(f"semexp --config agent.explorer.{control}" for control in CONTROLS),
            "cloned",
            "random",
            "oracle",
        ),
        GROUND_TRUTH,
        explorers,
    ),
    "motions": PaperTable(motion_tables.SETUPS, GROUND_TRUTH, motion_tables.motions),
}
"""The tables by name."""
PAPER_TABLES = tuple(name for name in TABLES if name not in ("verification", "splits", "explorers", "motions"))
"""The tables that the paper has too; `controls` is its figure of SemExp."""


def table_named(name: str) -> PaperTable:
    """Returns the table with this name.

    Raises:
        ConfigError: there is no such table.
    """
    if name not in TABLES:
        raise ConfigError(f"There is no table '{name}'. Available: {', '.join(TABLES)}.")
    return TABLES[name]


def _means_and_differences(
    name: str,
    title: str,
    lines: Lines,
    setups: Sequence[AgentSetup],
    pairs: Sequence[tuple[AgentSetup, AgentSetup]],
    metrics: Sequence[Metric],
    names: Mapping[str, str],
) -> list[ResultTable]:
    labels = [f"{names[setup.agent]} {setup.agent}" if _has_own_name(setup, names) else setup.label for setup in setups]
    cells = [[mean_cell(metric, lines[setup]) for metric in metrics] for setup in setups]
    rows = list(zip(labels, cells, strict=True))
    means = ResultTable(name, title, ("agent", *(metric.title for metric in metrics)), rows)
    return [means, _differences(name, lines, pairs, metrics, names)]


def _differences(
    name: str,
    lines: Lines,
    pairs: Iterable[tuple[AgentSetup, AgentSetup]],
    metrics: Sequence[Metric],
    names: Mapping[str, str],
) -> ResultTable:
    """Returns a table with one row per pair: the first minus the second, in each metric."""
    rows = [
        (
            " - ".join(names[setup.agent] if _has_own_name(setup, names) else setup.label for setup in (a, b)),
            [difference_cell(metric, lines[b], lines[a]) for metric in metrics],
        )
        for a, b in pairs
    ]
    header = ("agents", *(metric.title for metric in metrics))
    return ResultTable(f"{name}_differences", "Differences, paired by episode", header, rows)


def _has_own_name(setup: AgentSetup, names: Mapping[str, str]) -> bool:
    """Returns whether an agent is one of those that the table names, without further options."""
    return setup.agent in names and not setup.variant


def _against_first(setups: Sequence[AgentSetup]) -> list[tuple[AgentSetup, AgentSetup]]:
    return [(setups[0], other) for other in setups[1:]]


def _against(first: Sequence[EpisodeResult], second: Sequence[EpisodeResult]) -> list[Cell | str]:
    """Returns the ratio of the median steps to first sight, and how many episodes second has sooner and later."""
    if first is second:
        return ["1", "", ""]
    values = [map(FIRST_SIGHT.value, results) for results in (first, second)]
    changes = [b - a for a, b in zip(*values, strict=True) if a is not None and b is not None]
    ratio = replace(ratio_cell(FIRST_SIGHT, first, second), say_significant=True)
    return [ratio, str(sum(change < 0.0 for change in changes)), str(sum(change > 0.0 for change in changes))]


def _count_of_failures(lines: Sequence[EpisodeResult]) -> str:
    return f"{sum(not result.success for result in lines)} of {len(lines)}"


def _share_of_failures(cause: str, lines: Sequence[EpisodeResult]) -> Cell:
    """Returns the share of the failed episodes that failed by this cause."""
    failed = [result for result in lines if not result.success]
    matches = [result.failure == cause for result in failed]
    return Cell(estimate(matches, houses_of(failed), episodes=episodes_of(failed), most=1.0), percent=True)


def _failed_by(cause: str, first: Sequence[EpisodeResult], second: Sequence[EpisodeResult]) -> Cell:
    """Returns the difference, second minus first, of the share of all episodes that failed by this cause."""
    a, b = ([result.failure == cause for result in lines] for lines in (first, second))
    difference = paired_difference(a, b, houses_of(first), episodes=episodes_of(first), most=1.0)
    return Cell(difference, percent=True, difference=True)


def _rows_by_goal(lines: Lines, row: Callable[[Lines], list[Cell | str]]) -> list[tuple[str, list[Cell | str]]]:
    """Returns a row for each goal that occurs, in the order of the contract, and one for all episodes."""
    rows = []
    for goal in (*GOAL_CATEGORIES, "all"):
        part = {setup: [result for result in of if goal in (result.goal, "all")] for setup, of in lines.items()}
        if all(part.values()):
            rows.append((f"{goal} ({len(next(iter(part.values())))})", row(part)))
    return rows
