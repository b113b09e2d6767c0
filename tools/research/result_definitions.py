"""The tables of docs/results.md and three other pages: which runs each one shows, and which runs are compared.

A table shows only rows of `docs/tables/results.csv`, and all rows of one split in a table are of the same episodes.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from sim.app.analysis.metrics import COLLISIONS, EXPLORED, FIRST_SIGHT, SPL, STEPS, SUCCESS, TRAPPED
from sim.app.commands.reproduce.runs import AgentSetup, RunKey
from sim.task.result import METRICS, Metric
from tools.research.result_archive import SEALED, VERSION

MEANS = (SUCCESS, SPL, METRICS["soft_spl"], METRICS["distance_to_goal"], EXPLORED, COLLISIONS, TRAPPED, STEPS)
"""Metrics whose mean and interval each row of results.csv has."""
COMPARED = (SUCCESS, SPL, EXPLORED, COLLISIONS, TRAPPED, FIRST_SIGHT, STEPS, METRICS["second_visit_spl"])
"""Metrics whose paired difference each row of comparisons.csv has."""
PRIMARY_METRICS = (SUCCESS, SPL)
"""Metrics of the primary comparisons of a table; their p-values are corrected together (Holm 1979)."""
MEDIAN = "median_first_sight"
"""Column of results.csv: median steps to first sight; an episode that never shows the goal counts with the limit."""
FAILED = "failed_"
"""Start of the columns of results.csv with the number of failed episodes by cause (`sim.task.failures`)."""
FALSE_DETECTIONS = f"{FAILED}false_detection"
"""Column of results.csv: episodes that ended with a STOP at another object."""


@dataclass(frozen=True, order=True)
class RowKey:
    """A row of results.csv: a run, and how many of its first episodes."""

    run: RunKey
    episodes: int

    @classmethod
    def of(cls, split: str, episodes: int, name: str, semantics: str = "gt") -> RowKey:
        """Returns the row of an agent with options, such as "stubborn --explorer tour"."""
        agent, _, options = name.partition(" ")
        version = "sealed" if split == SEALED else VERSION
        return cls(RunKey(split, AgentSetup(agent, options, semantics), version), episodes)


@dataclass(frozen=True)
class Comparison:
    """A row of comparisons.csv: the first row minus the second one, of the same episodes of a split."""

    table: str
    first: RowKey
    second: RowKey
    primary: bool = True
    """It answers the question of its table. All others are exploratory: their intervals are not corrected."""


@dataclass(frozen=True)
class PageTable:
    """A table of a page: labels, then cells, each a column of a row of results.csv."""

    name: str
    header: tuple[str, ...]
    rows: tuple[tuple[tuple[str, ...], tuple[tuple[RowKey, Metric | str], ...]], ...]

    @property
    def page(self) -> str:
        """The page in docs."""
        return _PAGES.get(self.name, "results.md")


_PAGES = {"worlds": "worlds.md", "traps": "traps.md", "words": "words.md", "chain-agents": "words.md"}
EPISODES = {
    "headline": {"val": 200, "test": 500, SEALED: 200},
    "further": {"large": 200, "hazards": 200, "transfer": 200, "contact-heldout": 60, "contact-val": 150},
    "ablation": {"val": 100, "hazards": 100},
    "explorers": {"val": 100},
    "explorers-large": {"large": 200},
    "semexp": {"val": 100},
    "network": {"val": 100, "transfer": 200},
    "earlier": {"val": 200, "large": 100, "hazards": 100},
    "drift": {"val": 30},
    "traps": {"contact-val": 150},
    "words": dict.fromkeys(("words-seen", "words-synonyms", "words-unseen", "descriptions", "pictures"), 150),
    "chains": {"chains-val": 40},
    "chain-agents": {"chains-val": 40},
    "worlds": {"val": 50, "rooms": 50, "house": 50, "kitchen": 50},
}
"""The first episodes of each split that a table has."""
_ORACLE_AND_BOTH = ("oracle gt", "stubborn gt", "stubborn-plus gt", "stubborn rednet", "stubborn-plus rednet")
AGENTS: Mapping[str, Mapping[str, Sequence[str]]] = {
    "headline": {"val": _ORACLE_AND_BOTH, "test": _ORACLE_AND_BOTH, SEALED: _ORACLE_AND_BOTH},
    "further": dict.fromkeys(EPISODES["further"], _ORACLE_AND_BOTH),
    "worlds": dict.fromkeys(("val", "rooms", "house", "kitchen"), _ORACLE_AND_BOTH),
    "words": dict.fromkeys(EPISODES["words"], ("oracle gt", "frontier gt", *_ORACLE_AND_BOTH[1:])),
    "chain-agents": {"chains-val": _ORACLE_AND_BOTH},
}
"""Agents and segmentation by split; `further` has harder splits, `worlds` the houses of other projects."""
CHAINS = (
    RowKey.of("chains-val", EPISODES["chains"]["chains-val"], "stubborn-plus"),
    RowKey.of("chains-val", EPISODES["chains"]["chains-val"], "stubborn-plus --config agent.memory=false"),
)
"""The agent that keeps what it knows of the house after each goal of a chain, and the one that forgets it."""
GOAL_GROUPS = {
    "all": "all",
    "category": "categories",
    "words": "names and other words",
    "picture": "pictures",
    "description": "descriptions",
    "second_visit": "second visits",
}
"""The goals of chains by kind, as `sim.app.evaluation.summary.summarise` names them, and their names in words.md."""
EXPLORATORY = (("worlds", "val"), ("further", "contact-val"))
"""Tables and splits whose comparisons are primary in another table, or of a split that agents were developed on."""
GAINS = ("headline", "further")
"""Tables whose primary comparisons stubborn_plus.md shows."""
ABLATION = {
    "stubborn-i": "I: none",
    "stubborn-ii": "II: untrap moves",
    "stubborn-iii": "III: and collision layers",
    "stubborn-iv": "IV: and exploration avoids them",
    "stubborn": "V: and visited ground is free",
}
TRAPS = {**ABLATION, "poni": "`poni`", "stubborn-plus": "`stubborn-plus`"}
EXPLORERS = {
    "stubborn": "corners (`stubborn`)",
    "frontier-avoid": "`frontier-avoid`",
    "frontier": "`frontier`",
    "stubborn --explorer informed-tour": "`informed-tour`",
    "poni": "`poni`",
    "semexp": "`semexp`",
    "cloned": "`cloned`",
    "random": "`random`",
    "oracle": "`oracle`",
}
_LARGE_NAMES = ("stubborn", "frontier-avoid", "stubborn --explorer informed-tour", "poni", "oracle")
LARGE_EXPLORERS = {name: EXPLORERS[name] for name in _LARGE_NAMES}
PRIMARY_EXPLORERS = ("stubborn --explorer informed-tour", "poni")
"""Explorers whose comparison with corners is primary."""
SEMEXP = {
    "stubborn": "corners (`stubborn`)",
    "semexp": "`semexp`",
    "semexp --config agent.explorer.goal=wrong": "`semexp`, wrong goal",
    "semexp --config agent.explorer.semantics=shuffled": "`semexp`, shuffled semantics",
    "semexp --config agent.explorer.semantics=none": "`semexp`, no semantics",
}
"""The last three are controls: they show whether `semexp` uses the goal and the semantics, and are compared with it."""
NETWORK: Mapping[str, Mapping[str, str]] = {
    "val": {"stubborn": "naive Bayes", "stubborn --verification none": "none", "stubborn-plus": "tracks"},
    "transfer": {"stubborn": "naive Bayes", "stubborn-plus": "tracks"},
}
"""Verification by split and agent with options."""
DRIFT = {
    "stubborn --noise realsense": "odometry",
    "stubborn --noise realsense --config noise.pose.from_odometry=false": "true pose",
}
"""Runs with gps and compass by odometry, and with the true pose."""
EARLIER = {"stubborn-plus": "shipped", "stubborn-plus --weights old300.safetensors": "of version 3.0.0"}
"""The shipped network, and the one that was not trained in homes of version 4.0.0."""


def page_tables() -> tuple[PageTable, ...]:
    """Returns the tables of the page."""
    return (
        *(_agents(name) for name in AGENTS),
        _table(
            "ablation", ABLATION, {"val": (SUCCESS,), "hazards": (SUCCESS, TRAPPED, COLLISIONS)},
            "measures", "val: success %", "hazards: success %", "hazards: trapped %", "hazards: collisions",
        ),
        _table(
            "explorers", EXPLORERS, {"val": (SUCCESS, SPL, MEDIAN)}, "explorer", "success %", "SPL", "first sight"
        ),
        _table(
            "explorers-large", LARGE_EXPLORERS, {"large": (SUCCESS, SPL, MEDIAN)},
            "explorer", "success %", "SPL", "first sight",
        ),
        _table("semexp", SEMEXP, {"val": (SUCCESS, SPL, MEDIAN)}, "explorer", "success %", "SPL", "first sight"),
        _table("traps", TRAPS, {"contact-val": (SUCCESS, COLLISIONS)}, "agent", "success %", "collisions"),
        _table("drift", DRIFT, {"val": (SUCCESS, SPL)}, "`gps`, `compass`", "success %", "SPL"),
        _networks("network", NETWORK, "verification", (SUCCESS, SPL, FALSE_DETECTIONS)),
        _networks("earlier", dict.fromkeys(EPISODES["earlier"], EARLIER), "network", (SUCCESS, SPL)),
    )  # fmt: skip


def comparisons() -> Iterator[Comparison]:
    """Yields the comparisons that the page may quote; two that explore with the same segmentation are primary."""
    for table, splits in AGENTS.items():
        for split, names in splits.items():
            rows = [RowKey.of(split, EPISODES[table][split], *name.split()) for name in names]
            for second, first in itertools.combinations(rows, 2):
                one, other = second.run.setup, first.run.setup
                is_primary = (
                    (one.agent, other.agent) in (("stubborn", "stubborn-plus"), ("frontier", "stubborn-plus"))
                    and one.semantics == other.semantics
                    and (table, split) not in EXPLORATORY
                )
                yield Comparison(table, first, second, is_primary)
    for split in EPISODES["ablation"]:
        *rows, whole = _rows("ablation", split, ABLATION).values()
        yield from (Comparison("ablation", row, whole) for row in rows)
    traps = _rows("traps", "contact-val", TRAPS)
    whole = traps.pop("stubborn")
    yield from (Comparison("traps", row, whole) for row in traps.values())
    yield Comparison("chains", *CHAINS)
    for table, split, names in (("explorers", "val", EXPLORERS), ("explorers-large", "large", LARGE_EXPLORERS)):
        corners, *others = _rows(table, split, names).items()
        for name, row in others:
            yield Comparison(table, row, corners[1], name in PRIMARY_EXPLORERS)
    corners, semexp, *controls = _rows("semexp", "val", SEMEXP).values()
    for first, second in ((semexp, corners), *((control, semexp) for control in controls)):
        yield Comparison("semexp", first, second)
    for split, names in NETWORK.items():
        second, *others = _rows("network", split, names, "rednet").values()
        for first in others:  # those between the two agents are primary in other tables
            yield Comparison("network", first, second, first.run.setup.agent == second.run.setup.agent)
    for split in EPISODES["earlier"]:
        first, second = _rows("earlier", split, EARLIER, "rednet").values()
        yield Comparison("earlier", first, second)
    first, second = _rows("drift", "val", DRIFT).values()
    yield Comparison("drift", first, second)


def needed_rows() -> list[RowKey]:
    """Returns the rows that tables and comparisons need, in their order."""
    shown = [row for table in page_tables() for _, cells in table.rows for row, _ in cells]
    return shown + [row for pair in comparisons() for row in (pair.first, pair.second)]


def _rows(table: str, split: str, names: Iterable[str], semantics: str = "gt") -> dict[str, RowKey]:
    return {name: RowKey.of(split, EPISODES[table][split], name, semantics) for name in names}


def _agents(table: str) -> PageTable:
    rows = []
    for split, agent in ((split, agent) for split, names in AGENTS[table].items() for agent in names):
        row = RowKey.of(split, EPISODES[table][split], *agent.split())
        rows.append(((f"{split}, {row.episodes}", *_agent(agent)), _cells(row, (SUCCESS, SPL))))
    return PageTable(table, ("split, episodes", "agent", "segmentation", "success %", "SPL"), tuple(rows))


def _agent(text: str) -> tuple[str, str]:
    """Returns the labels of an agent and its segmentation."""
    name, semantics = text.split()
    return f"`{name}`", "-" if name == "oracle" else "truth" if semantics == "gt" else "network"


def _networks(
    table: str, names: Mapping[str, Mapping[str, str]], label: str, columns: Sequence[Metric | str]
) -> PageTable:
    """Returns a table of rows with the network, whose labels are split, agent and another."""
    rows = [
        ((f"{split}, {row.episodes}", f"`{row.run.setup.agent}`", of_split[name]), _cells(row, columns))
        for split, of_split in names.items()
        for name, row in _rows(table, split, of_split, "rednet").items()
    ]
    titles = (column.title if isinstance(column, Metric) else "false detections" for column in columns)
    return PageTable(table, ("split, episodes", "agent", label, *titles), tuple(rows))


def _table(
    table: str, labels: Mapping[str, str], columns: Mapping[str, Sequence[Metric | str]], *header: str
) -> PageTable:
    """Returns a table with a row for each agent and, for each split, some columns."""
    rows = []
    for name, label in labels.items():
        keys = {split: RowKey.of(split, EPISODES[table][split], name) for split in columns}
        rows.append(((label,), tuple(cell for split in columns for cell in _cells(keys[split], columns[split]))))
    return PageTable(table, header, tuple(rows))


def _cells(row: RowKey, columns: Sequence[Metric | str]) -> tuple[tuple[RowKey, Metric | str], ...]:
    return tuple((row, column) for column in columns)
