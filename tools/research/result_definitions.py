"""The tables of docs/results.md: which runs each one shows, and which runs are compared.

A table shows only rows of `docs/tables/results.csv`, and all rows of one split in a table are of the same episodes.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from sim.app.analysis.metrics import COLLISIONS, EXPLORED, FIRST_SIGHT, SPL, STEPS, SUCCESS, TRAPPED, Metric
from tools.research.result_archive import VERSION, RunKey

SOFT_SPL = Metric("soft SPL", "soft_spl", digits=3)
DISTANCE = Metric("distance to goal, m", "distance_to_goal", digits=2)
MEANS = (SUCCESS, SPL, SOFT_SPL, DISTANCE, EXPLORED, COLLISIONS, TRAPPED, STEPS)
"""Metrics whose mean and interval each row of results.csv has."""
COMPARED = (SUCCESS, SPL, COLLISIONS, TRAPPED, FIRST_SIGHT, STEPS)
"""Metrics whose paired difference each row of comparisons.csv has."""
PRIMARY_METRICS = (SUCCESS, SPL)
"""Metrics of the primary comparisons of a table; their p-values are corrected together (Holm 1979)."""
MEDIAN = "median_first_sight"
"""Column of results.csv: median steps to first sight; an episode that never shows the goal counts with the limit."""
FAILED = "failed_"
"""Start of the columns of results.csv with the number of failed episodes by cause (`sim.task.failures`)."""
FALSE_DETECTIONS = f"{FAILED}false_detection"
"""Column of results.csv: episodes that ended with a STOP at another object."""


@dataclass(frozen=True)
class RowKey:
    """A row of results.csv: a run, and how many of its first episodes."""

    run: RunKey
    episodes: int


@dataclass(frozen=True)
class Comparison:
    """A row of comparisons.csv: the first run minus the second one, paired by episode."""

    table: str
    first: RunKey
    second: RunKey
    episodes: int
    primary: bool = True
    """It answers the question of its table. All others are exploratory: their intervals are not corrected."""


@dataclass(frozen=True)
class PageTable:
    """A table of the page: labels, then cells, each a column of a row of results.csv."""

    name: str
    header: tuple[str, ...]
    rows: tuple[tuple[tuple[str, ...], tuple[tuple[RowKey, Metric | str], ...]], ...]

    def needed(self) -> Iterator[RowKey]:
        """Yields the rows of results.csv that the table shows."""
        for _, cells in self.rows:
            yield from (row for row, _ in cells)


HEADLINE_EPISODES = {
    "val": 200,
    "large": 100,
    "hazards": 200,
    "transfer": 100,
    "contact-val": 150,
    "contact-heldout": 60,
}
HEADLINE = {
    "val": ("oracle gt", "stubborn gt", "stubborn-plus gt", "stubborn rednet", "stubborn-plus rednet"),
    "large": ("oracle gt", "stubborn gt"),
    "hazards": ("stubborn gt", "stubborn-plus gt"),
    "transfer": ("stubborn-plus rednet",),
    "contact-val": ("stubborn-plus gt",),
    "contact-heldout": ("stubborn gt", "stubborn-plus gt"),
}
"""Agents and segmentation, by split."""
FURTHER_EPISODES = {"large": 100, "hazards": 100, "test": 500}
FURTHER = {
    "large": ("stubborn rednet", "stubborn-plus rednet"),
    "hazards": ("stubborn rednet", "stubborn-plus rednet"),
    "test": ("stubborn-plus rednet",),
}
"""The same on harder splits and, for the last measurement, on `test`."""
RESOLVED = ("headline", "further")
"""Tables whose primary comparisons have a row in resolution.csv."""
ABLATION = {
    "stubborn-i": "I: none",
    "stubborn-ii": "II: untrap moves",
    "stubborn-iii": "III: and collision layers",
    "stubborn-iv": "IV: and exploration avoids them",
    "stubborn": "V: and visited ground is free",
}
ABLATION_EPISODES = {"val": 200, "hazards": 200}
EXPLORERS = {
    "stubborn": "corners (`stubborn`)",
    "frontier-avoid": "`frontier-avoid`",
    "frontier": "`frontier`",
    "stubborn --explorer informed-tour": "`informed-tour`",
    "poni": "`poni`",
    "cloned": "`cloned`",
    "random": "`random`",
    "oracle": "`oracle`",
}
EXPLORER_EPISODES = {"val": 200, "large": 100}
PRIMARY_EXPLORERS = ("stubborn --explorer informed-tour", "poni")
"""Explorers whose comparison with corners is primary."""
DRIFT = ("stubborn --noise realsense", "stubborn --noise realsense --config noise.pose.from_odometry=false")
"""Runs with gps and compass by odometry, and with the true pose."""
DRIFT_EPISODES = 30
SEMEXP = {
    "stubborn": "corners (`stubborn`)",
    "semexp": "`semexp`",
    "semexp --config agent.explorer.goal=wrong": "`semexp`, wrong goal",
    "semexp --config agent.explorer.semantics=shuffled": "`semexp`, shuffled semantics",
}
"""The last two are controls: they show whether `semexp` uses the goal and the semantics, and are compared with it."""
SEMEXP_EPISODES = 200
NETWORK = (
    ("val", "stubborn", "naive Bayes", 200),
    ("val", "stubborn --verification none", "none", 200),
    ("val", "stubborn-plus", "tracks", 200),
    ("transfer", "stubborn", "naive Bayes", 100),
    ("transfer", "stubborn-plus", "tracks", 100),
)
"""Split, agent with options, its verification, episodes."""


def run_key(split: str, name: str, semantics: str) -> RunKey:
    """Returns the key of an agent with options, such as "stubborn --explorer tour"."""
    agent, _, options = name.partition(" ")
    return RunKey(split, agent, options, semantics, VERSION)


def _of_agent(split: str, agent: str) -> RunKey:
    """Returns the key of an entry of `HEADLINE`, such as "stubborn gt"."""
    name, semantics = agent.split()
    return run_key(split, name, semantics)


def page_tables() -> tuple[PageTable, ...]:
    """Returns the tables of the page."""
    return (
        _agents("headline", HEADLINE, HEADLINE_EPISODES),
        _agents("further", FURTHER, FURTHER_EPISODES),
        _ablation(),
        _explorers(),
        _semexp(),
        _network(),
    )


def comparisons() -> Iterator[Comparison]:
    """Yields the comparisons that the page may quote."""
    yield from _agents_compared("headline", HEADLINE, HEADLINE_EPISODES)
    yield from _agents_compared("further", FURTHER, FURTHER_EPISODES)
    *rows, whole = ABLATION
    for split, episodes in ABLATION_EPISODES.items():
        for name in rows:
            first, second = run_key(split, name, "gt"), run_key(split, whole, "gt")
            yield Comparison("ablation", first, second, episodes)
    for split, episodes in EXPLORER_EPISODES.items():
        for name in list(EXPLORERS)[1:]:
            first, second = run_key(split, name, "gt"), run_key(split, "stubborn", "gt")
            yield Comparison("explorers", first, second, episodes, name in PRIMARY_EXPLORERS)
    corners, semexp, *controls = (run_key("val", name, "gt") for name in SEMEXP)
    for first, second in ((semexp, corners), *((control, semexp) for control in controls)):
        yield Comparison("semexp", first, second, SEMEXP_EPISODES)
    yield from _network_comparisons()
    first, second = (run_key("val", name, "gt") for name in DRIFT)
    yield Comparison("drift", first, second, DRIFT_EPISODES)


def _agents_compared(
    table: str, agents: Mapping[str, Sequence[str]], episodes: Mapping[str, int]
) -> Iterator[Comparison]:
    """Yields each pair of agents of a split; those of our two agents with the same segmentation are primary."""
    for split, names in agents.items():
        present = [_of_agent(split, agent) for agent in names]
        for second, first in itertools.combinations(present, 2):
            primary = second.agent == "stubborn" and first.semantics == second.semantics
            yield Comparison(table, first, second, episodes[split], primary)


def _network_comparisons() -> Iterator[Comparison]:
    """Yields, for each split of the table, each row minus the first one."""
    keys: dict[tuple[str, int], list[RunKey]] = {}
    for split, name, _, episodes in NETWORK:
        keys.setdefault((split, episodes), []).append(run_key(split, name, "rednet"))
    for (_, episodes), (second, *others) in keys.items():
        yield from (Comparison("network", first, second, episodes) for first in others)


def _agents(table: str, agents: Mapping[str, Sequence[str]], episodes: Mapping[str, int]) -> PageTable:
    rows = []
    for split, agent in ((split, agent) for split, names in agents.items() for agent in names):
        name, semantics = agent.split()
        row = RowKey(_of_agent(split, agent), episodes[split])
        shown = "-" if name == "oracle" else "truth" if semantics == "gt" else "network"
        rows.append(((f"{split}, {row.episodes}", f"`{name}`", shown), _cells(row, (SUCCESS, SPL))))
    header = ("split, episodes", "agent", "segmentation", "success %", "SPL")
    return PageTable(table, header, tuple(rows))


def _ablation() -> PageTable:
    rows = []
    for name, label in ABLATION.items():
        val, hazards = (RowKey(run_key(split, name, "gt"), count) for split, count in ABLATION_EPISODES.items())
        rows.append(((label,), (*_cells(val, (SUCCESS,)), *_cells(hazards, (SUCCESS, TRAPPED, COLLISIONS)))))
    header = ("measures", "val: success %", "hazards: success %", "hazards: trapped %", "hazards: collisions")
    return PageTable("ablation", header, tuple(rows))


def _explorers() -> PageTable:
    rows = []
    for name, label in EXPLORERS.items():
        of = {split: RowKey(run_key(split, name, "gt"), count) for split, count in EXPLORER_EPISODES.items()}
        cells = [cell for row in of.values() for cell in _cells(row, (SUCCESS, SPL))]
        rows.append(((label,), (*cells, *_cells(of["large"], (MEDIAN,)))))
    header = ("explorer", "val: success %", "val: SPL", "large: success %", "large: SPL", "large: first sight")
    return PageTable("explorers", header, tuple(rows))


def _semexp() -> PageTable:
    rows = []
    for name, label in SEMEXP.items():
        row = RowKey(run_key("val", name, "gt"), SEMEXP_EPISODES)
        rows.append(((label,), _cells(row, (SUCCESS, SPL, MEDIAN))))
    return PageTable("semexp", ("explorer", "success %", "SPL", "first sight"), tuple(rows))


def _network() -> PageTable:
    rows = []
    for split, name, verification, episodes in NETWORK:
        row = RowKey(run_key(split, name, "rednet"), episodes)
        labels = (f"{split}, {episodes}", f"`{row.run.agent}`", verification)
        rows.append((labels, _cells(row, (SUCCESS, SPL, FALSE_DETECTIONS))))
    header = ("split, episodes", "agent", "verification", "success %", "SPL", "false detections")
    return PageTable("network", header, tuple(rows))


def _cells(row: RowKey, columns: Sequence[Metric | str]) -> tuple[tuple[RowKey, Metric | str], ...]:
    return tuple((row, column) for column in columns)
