"""The claims that the paper bases on each of its tables, tested on the episodes of the same table here.

A claim is a difference between two agents. It is *replicated* if the difference here is significant in the paper's
direction after Holm's correction for the claims of its table. It is *not replicated* if the interval here excludes the
paper's difference and the difference is not replicated. Otherwise it is *unresolved*. The claim that an agent is not
better than another one is replicated if the interval ends below `MARGIN`, not replicated if it begins above it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from sim.app.analysis.metrics import EXPLORED, SPL, SUCCESS, TRAPPED, episodes_of, houses_of
from sim.app.analysis.tables import Cell, ResultTable, corrected
from sim.app.commands.reproduce.paper_tables import Lines
from sim.app.evaluation.intervals import paired_difference
from sim.task.failures import CAUSES
from sim.task.result import EpisodeResult, Metric

MARGIN = 0.05
"""A difference of less than 5 points of a share does not make an agent better, in the claims of `Claim.is_better`."""
REPLICATED, NOT_REPLICATED, UNRESOLVED = "replicated", "not replicated", "unresolved"
MAIN_CAUSE, NEXT_CAUSE = "false_detection", "the next cause"


@dataclass(frozen=True)
class Claim:
    """A difference that the paper reports: the first agent minus the second one."""

    first: str
    """Name of the agent with its options, as in the table."""
    second: str
    """The other agent, or `NEXT_CAUSE`: the most frequent other cause of failure of the same agent."""
    of: Metric | str
    """The metric, or the cause of failure that is counted."""
    paper: float
    """The paper's difference; of a share, between -1 and 1."""
    is_better: bool = True
    """False: the paper claims that the first agent is not better than the second one."""

    @property
    def text(self) -> str:
        """The row of the claim, such as "stubborn - frontier-avoid, GT exploration %"."""
        value = self.of.title if isinstance(self.of, Metric) else f"failed by {self.of} %"
        return f"{self.first} - {self.second}, {value}" + ("" if self.is_better else " (claim: not higher)")

    def cell(self, lines: Mapping[str, Sequence[EpisodeResult]]) -> Cell:
        """Returns the difference in the lines, by name of the agent."""
        a = lines[self.first]
        if isinstance(self.of, Metric):
            metric = self.of
            values = [[metric.value(result) for result in results] for results in (a, lines[self.second])]
            most, percent, digits = metric.most, metric.percent, metric.digits
        else:
            others = Counter(result.failure for result in a if not result.success and result.failure != self.of)
            other = max(CAUSES, key=lambda cause: others[cause])
            pairs = (
                ((a, self.of), (a, other))
                if self.second == NEXT_CAUSE
                else ((a, self.of), (lines[self.second], self.of))
            )
            values = [[float(not r.success and r.failure == cause) for r in results] for results, cause in pairs]
            most, percent, digits = 1.0, True, 1
        difference = paired_difference(values[1], values[0], houses_of(a), episodes=episodes_of(a), most=most)
        return Cell(difference, percent, digits, difference=True)

    def verdict(self, cell: Cell) -> str:
        """Returns whether the difference, corrected for the number of claims, replicates the paper's."""
        value = cell.estimate
        if value.mean is None or value.low is None or value.high is None:
            return UNRESOLVED
        if not self.is_better:
            return REPLICATED if value.high < MARGIN else NOT_REPLICATED if value.low > MARGIN else UNRESOLVED
        if cell.is_significant and (value.mean > 0.0) == (self.paper > 0.0):
            return REPLICATED
        return UNRESOLVED if value.low <= self.paper <= value.high else NOT_REPLICATED


_SINGLE, _SEMEXP = "stubborn --verification none", "semexp --verification none"
_BARE_SEMEXP, _FRONTIER = "stubborn-i --explorer semexp", "frontier-avoid"
_SHUFFLED = "semexp --config agent.explorer.semantics=shuffled"
_WRONG_GOAL = "semexp --config agent.explorer.goal=wrong"
CLAIMS: Mapping[str, tuple[str, tuple[Claim, ...]]] = {
    "failures": (
        "Table I",
        (
            Claim("stubborn", NEXT_CAUSE, MAIN_CAUSE, 0.223),  # (45.1 - 15.9) % of 76.3 % failures
            Claim(_SEMEXP, NEXT_CAUSE, MAIN_CAUSE, 0.288),  # (47.7 - 12.6) % of 82.1 %
            Claim("stubborn", _SEMEXP, "loop", -0.082),  # 0.9 % of 76.3 % - 10.8 % of 82.1 %
        ),
    ),
    "ablation": (
        "Table III",
        (
            Claim("stubborn-ii", "stubborn-i", EXPLORED, 0.05),
            Claim("stubborn-iii", "stubborn-ii", EXPLORED, 0.05),
            Claim("stubborn", "stubborn-iv", EXPLORED, 0.03),
            Claim("stubborn", "stubborn-i", EXPLORED, 0.13),
            Claim("stubborn-ii", "stubborn-i", TRAPPED, -0.013),
            Claim("stubborn-iii", "stubborn-ii", TRAPPED, -0.02),
            Claim("stubborn-iv", "stubborn-iii", TRAPPED, -0.015),
            Claim("stubborn", "stubborn-iv", TRAPPED, -0.002),
        ),
    ),
    "exploration": (
        "Table IV",
        (
            Claim("stubborn", _FRONTIER, EXPLORED, 0.09),
            Claim("stubborn", "semexp", EXPLORED, 0.09),
            Claim("stubborn", "stubborn-i", EXPLORED, 0.13),
            Claim("semexp", _FRONTIER, EXPLORED, 0.0, is_better=False),
            Claim("semexp", _BARE_SEMEXP, EXPLORED, 0.01, is_better=False),
            Claim(_BARE_SEMEXP, "stubborn-i", EXPLORED, 0.03, is_better=False),
        ),
    ),
    "controls": (
        "figure of SemExp",
        (
            Claim("semexp", _SHUFFLED, SUCCESS, 0.018, is_better=False),
            Claim("semexp", _WRONG_GOAL, SUCCESS, 0.015, is_better=False),
        ),
    ),
    "categories": ("Table V", (Claim("stubborn", _SINGLE, SUCCESS, 0.02),)),
    "overall": (
        "Table VI",
        (
            Claim("stubborn", _SINGLE, SUCCESS, 0.015),
            Claim("stubborn", _SEMEXP, SUCCESS, 0.0585),
            Claim("stubborn", _SEMEXP, SPL, 0.0273),
            Claim("stubborn", "poni", SUCCESS, 0.037),
            Claim("stubborn", "poni", SPL, 0.01),
        ),
    ),
}
"""The paper's name of each table, and its claims; differences are those of the paper's figures (`paper_figures`)."""


@dataclass(frozen=True)
class JudgedTable:
    """A table of the paper with the verdicts on its claims."""

    title: str
    """The paper's name of the table."""
    claims: Sequence[Claim]
    cells: Sequence[Cell]
    """The difference of each claim here."""
    verdicts: Sequence[str]
    """The verdict on each claim."""

    @property
    def verdict(self) -> str:
        """The verdict on the table: the worst one on its claims."""
        return next((v for v in (NOT_REPLICATED, UNRESOLVED) if v in self.verdicts), REPLICATED)

    @property
    def counts(self) -> str:
        """For example "3 of 6 claims replicated"."""
        return f"{self.verdicts.count(REPLICATED)} of {len(self.verdicts)} claims replicated"

    def table(self, name: str) -> ResultTable:
        """Returns a table with a row for each claim."""
        rows: list[tuple[str, list[Cell | str]]] = [
            (claim.text, [cell, _paper_text(claim, cell), verdict])
            for claim, cell, verdict in zip(self.claims, self.cells, self.verdicts, strict=True)
        ]
        title = f"The paper's {self.title}: {self.verdict} ({self.counts})"
        return ResultTable(f"{name}_claims", title, ("claim", "here", "paper", "verdict"), rows)


def judged(name: str, lines: Lines) -> JudgedTable | None:
    """Returns the verdicts on the claims of a table, or None where the lines lack the agents of the paper."""
    by_name: dict[str, Sequence[EpisodeResult]] = {}
    for setup, results in lines.items():
        by_name.setdefault(setup.name, results)  # `cloned` is there with two kinds of segmentation
    title, claims = CLAIMS.get(name, ("", ()))
    agents = {agent for claim in claims for agent in (claim.first, claim.second)} - {NEXT_CAUSE}
    if not agents or not agents <= by_name.keys():
        return None
    cells = [claim.cell(by_name) for claim in claims]
    family = [number for number, claim in enumerate(claims) if claim.is_better]
    for number, cell in zip(family, corrected([cells[number] for number in family]), strict=True):
        cells[number] = cell
    verdicts = [claim.verdict(cell) for claim, cell in zip(claims, cells, strict=True)]
    return JudgedTable(title, claims, cells, verdicts)


def overview(tables: Sequence[JudgedTable]) -> str:
    """Returns a table, as Markdown, of the verdict on each table and the claims that are not replicated."""
    lines = ["| table | verdict | claims that are not replicated or unresolved: here, paper |", "| --- | --- | --- |"]
    for table in tables:
        open_claims = [
            f"{claim.text}: {cell.mean_text} {cell.interval_text}, {_paper_text(claim, cell)} ({verdict})"
            for claim, cell, verdict in zip(table.claims, table.cells, table.verdicts, strict=True)
            if verdict != REPLICATED
        ]
        lines.append(f"| {table.title} | {table.verdict}: {table.counts} | {'; '.join(open_claims)} |")
    return "\n".join(lines) + "\n"


def _paper_text(claim: Claim, cell: Cell) -> str:
    return replace(cell, estimate=replace(cell.estimate, mean=claim.paper)).mean_text
