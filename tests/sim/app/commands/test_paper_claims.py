"""The verdicts on the paper's claims, from result lines with known differences."""

from __future__ import annotations

import pytest

from sim.app.analysis.metrics import EXPLORED, SPL, SUCCESS, TRAPPED
from sim.app.commands.reproduce.paper_claims import (
    CLAIMS,
    NEXT_CAUSE,
    NOT_REPLICATED,
    REPLICATED,
    UNRESOLVED,
    Claim,
    judged,
    overview,
)
from sim.app.commands.reproduce.paper_figures import FIGURES
from sim.app.commands.reproduce.paper_tables import ABLATION, PAPER_TABLES, table_named
from sim.app.commands.reproduce.runs import AgentSetup
from sim.task.result import EpisodeResult, Metric
from tests.helpers.results import a_result

EPISODES, HOUSES = 200, 20
COLUMNS = {
    "stubborn": "Stubborn",
    "stubborn-i": "Stubborn without avoidance",
    "semexp": "SemExp",
    "stubborn-i --explorer semexp": "SemExp without avoidance",
    "frontier-avoid": "Frontier",
}


def line(number: int, *, success: bool, failure: str | None = None) -> EpisodeResult:
    identity = {"episode_id": f"e{number:03d}", "house": f"h{number % HOUSES}"}
    return a_result(**identity, success=float(success), failure=None if success else failure or "explore")


def lines_of(first: int, second: int) -> dict[str, list[EpisodeResult]]:
    """Returns two agents, a and b, that succeed in the first so many episodes."""
    counts = {"a": first, "b": second}
    return {agent: [line(n, success=n < count) for n in range(EPISODES)] for agent, count in counts.items()}


@pytest.mark.parametrize(
    ("successes", "paper", "is_better", "verdict"),
    [
        ((160, 100), 0.1, True, REPLICATED),
        ((100, 160), -0.1, True, REPLICATED),
        ((100, 160), 0.1, True, NOT_REPLICATED),  # significant in the other direction
        ((100, 100), 0.1, True, NOT_REPLICATED),  # the interval excludes 10 points
        ((100, 100), 0.001, True, UNRESOLVED),
        ((100, 100), 0.0, False, REPLICATED),
        ((100, 160), 0.0, False, REPLICATED),
        ((160, 100), 0.0, False, NOT_REPLICATED),
        ((108, 100), 0.0, False, UNRESOLVED),
    ],
)
def test_a_claim_is_judged_by_the_interval_of_the_difference(
    successes: tuple[int, int], paper: float, is_better: bool, verdict: str
) -> None:
    claim = Claim("a", "b", SUCCESS, paper, is_better)
    assert claim.verdict(claim.cell(lines_of(*successes))) == verdict


def test_the_next_cause_is_the_most_frequent_other_cause_of_the_same_agent() -> None:
    causes = ["false_detection"] * 60 + ["loop"] * 20 + ["trapped"] * 10
    results = [line(n, success=n >= 90, failure=causes[n] if n < 90 else None) for n in range(EPISODES)]
    cell = Claim("a", NEXT_CAUSE, "false_detection", 0.2).cell({"a": results})
    assert cell.estimate.mean == pytest.approx((60 - 20) / EPISODES)


def test_a_difference_that_the_number_of_claims_explains_is_not_replicated(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = lines_of(104, 100)
    setups = {AgentSetup(agent, "", "gt"): results for agent, results in lines.items()}
    claim = Claim("a", "b", SUCCESS, 0.02)
    monkeypatch.setitem(CLAIMS, "one", ("Table", (claim,)))  # type: ignore[attr-defined]
    monkeypatch.setitem(CLAIMS, "many", ("Table", (claim,) * 8))  # type: ignore[attr-defined]
    one, many = judged("one", setups), judged("many", setups)
    assert one is not None
    assert many is not None
    assert (one.verdict, many.verdict) == (REPLICATED, UNRESOLVED)
    assert many.counts == "0 of 8 claims replicated"
    assert "Table | unresolved" in overview([many])


def test_without_the_papers_agents_a_table_has_no_claims() -> None:
    assert judged("exploration", {AgentSetup("stubborn", "", "gt"): lines_of(10, 5)["a"]}) is None
    assert judged("splits", {}) is None


@pytest.mark.parametrize("name", PAPER_TABLES)
def test_each_table_of_the_paper_has_claims_about_its_own_agents(name: str) -> None:
    named = {setup.name for setup in table_named(name).setups()} | {NEXT_CAUSE}
    assert all({claim.first, claim.second} <= named for claim in CLAIMS[name][1])


@pytest.mark.parametrize("name", PAPER_TABLES[1:])
def test_the_papers_differences_are_those_of_its_figures(name: str) -> None:
    def figure(agent: str, claim: Claim) -> float:
        columns = FIGURES[name]
        if name == "exploration":
            return float(columns[COLUMNS[agent]]["all"])
        if name == "categories":
            return float(columns["Stubborn" if agent == "stubborn" else "Single-Frame"]["all"])
        row = {named: numeral for numeral, named in ABLATION.items()}[agent] if name == "ablation" else agent
        assert isinstance(claim.of, Metric)
        title = {EXPLORED: "GT exploration %", TRAPPED: "trapped %", SUCCESS: "success %", SPL: "SPL"}[claim.of]
        return float(columns[title][row])

    for claim in CLAIMS[name][1]:
        scale = 1.0 if claim.of is SPL else 0.01
        difference = scale * (figure(claim.first, claim) - figure(claim.second, claim))
        assert claim.paper == pytest.approx(difference, abs=5e-4), claim.text
