"""The tables of the paper, computed from result lines with known means."""

from __future__ import annotations

import pytest

from sim.app.analysis.metrics import FIRST_SIGHT, median_text
from sim.app.analysis.tables import Cell, ResultTable
from sim.app.commands.reproduce.motion_tables import MOTIONS
from sim.app.commands.reproduce.paper_tables import ABLATION, TABLES, table_named
from sim.app.commands.reproduce.runs import AgentSetup
from sim.core.interface import ConfigError
from sim.task.failures import CAUSES
from sim.task.result import EpisodeResult
from tests.helpers import wording
from tests.helpers.results import a_result

GOALS = ("bed", "sofa")


def line(number: int, *, success: bool, failure: str | None = None, **known: object) -> EpisodeResult:
    identity = {"episode_id": f"e{number:02d}", "house": f"h{number // 2}", "goal": GOALS[number % 2]}
    scores = {"success": float(success), "spl": 0.5 * success, "collisions": 2, "num_steps": 100, "failure": failure}
    return a_result(**identity | scores | known)


def lines_of(setups: tuple[AgentSetup, ...], *, failed: tuple[int, ...]) -> dict:
    """Returns 40 episodes per setup; setup i fails the first `failed[i]` of them, the very first one by a trap."""
    return {
        setup: [
            line(n, success=n >= count, failure=None if n >= count else "explore" if n else "trapped")
            for n in range(40)
        ]
        for setup, count in zip(setups, failed, strict=True)
    }


def cell(table: ResultTable, row: str, column: str) -> Cell:
    cells = dict(table.rows)[row]
    cell = cells[table.header.index(column) - 1]
    assert isinstance(cell, Cell)
    return cell


def test_causes_are_shares_of_the_failed_episodes_and_their_differences_of_all() -> None:
    setups = TABLES["failures"].setups()[:2]
    causes, differences = TABLES["failures"].build(lines_of(setups, failed=(10, 20)), setups)
    assert [row for row, _ in causes.rows] == [*CAUSES, "failed episodes", "success %"]
    first, second = (setup.label for setup in setups)
    assert cell(causes, "trapped", first).estimate.mean == pytest.approx(0.1)
    assert cell(causes, "explore", second).estimate.mean == pytest.approx(19 / 20)
    assert dict(causes.rows)["failed episodes"] == ["10 of 40", "20 of 40"]
    explore = cell(differences, "explore", f"{first} - {second}")
    assert explore.estimate.mean == pytest.approx(-10 / 40)
    assert explore.verdict == "lower"
    assert cell(differences, "trapped", f"{first} - {second}").verdict == "not significant"


def test_an_agent_that_never_fails_has_no_causes() -> None:
    setups = TABLES["failures"].setups()[:2]
    causes, _ = TABLES["failures"].build(lines_of(setups, failed=(0, 1)), setups)
    assert cell(causes, "loop", setups[0].label).text() == "-"


def test_the_ablation_compares_each_row_with_the_one_before_and_the_last_with_the_first() -> None:
    setups = TABLES["ablation"].setups()
    means, differences = TABLES["ablation"].build(lines_of(setups, failed=(20, 15, 10, 5, 0)), setups)
    assert [row for row, _ in means.rows] == [f"{row} {agent}" for row, agent in ABLATION.items()]
    assert [row for row, _ in differences.rows] == ["II - I", "III - II", "IV - III", "V - IV", "V - I"]
    last = cell(differences, "V - I", "success %")
    assert (last.estimate.mean, last.verdict) == (pytest.approx(0.5), "higher")
    assert cell(differences, "V - I", "collisions").verdict == "not significant"


def test_rows_of_the_ablation_have_roman_numerals_and_the_last_is_the_whole_agent() -> None:
    assert next(iter(ABLATION.items())) == ("I", "stubborn-i")
    assert list(ABLATION.items())[-1] == ("V", "stubborn")


def test_goals_have_rows_in_the_contracts_order_with_their_episodes() -> None:
    setups = TABLES["categories"].setups()
    (table,) = TABLES["categories"].build(lines_of(setups, failed=(4, 8)), setups)
    assert [row for row, _ in table.rows] == ["sofa (20)", "bed (20)", "all (40)"]
    assert cell(table, "bed (20)", "stubborn").estimate.mean == pytest.approx(18 / 20)
    assert cell(table, "all (40)", "stubborn - stubborn --verification none").estimate.mean == pytest.approx(0.1)


@pytest.mark.parametrize("name", TABLES)
def test_every_table_can_be_made_of_its_own_setups(name: str) -> None:
    setups = table_named(name).setups()
    for table in table_named(name).build(lines_of(setups, failed=(3,) * len(setups)), setups):
        assert table.rows
        assert len(set(table.header)) == len(table.header)
        assert all(len(cells) == len(table.header) - 1 for _, cells in table.rows)


@pytest.mark.slow
def test_explorers_are_compared_by_the_median_time_to_first_sight() -> None:
    setups = TABLES["explorers"].setups(("stubborn", "poni"))
    lines = {
        setup: [line(n, success=True, steps_to_first_sight=factor * (100 + n % 7) - (n == 5)) for n in range(40)]
        for setup, factor in zip(setups, (2, 1), strict=True)
    }
    *_, table = TABLES["explorers"].build(lines, setups)
    rows = dict(table.rows)
    assert rows["stubborn (gt)"] == ["206", "1", "", ""]
    median, ratio, sooner, later = rows["poni (gt)"]
    assert (median, sooner, later) == ("103", "40", "0")
    assert isinstance(ratio, Cell)
    assert ratio.text().startswith("0.50 [0.")
    assert ratio.verdict == "lower"


@pytest.mark.parametrize(("steps", "text"), [([10, 20, 31], "20"), ([10, 21], "15.5"), ([10, 20], "15"), ([], "-")])
def test_a_median_between_two_whole_numbers_keeps_its_half(steps: list[int], text: str) -> None:
    assert median_text(FIRST_SIGHT, [a_result(steps_to_first_sight=count) for count in steps]) == text


@pytest.mark.costly
def test_motions_have_a_column_each_and_the_orders_of_agents_are_compared() -> None:
    agents = ("stubborn", "stubborn-i", "oracle")
    setups = TABLES["motions"].setups((*agents, *(f"{agent} --motion sliding" for agent in agents)))
    made = TABLES["motions"].build(lines_of(setups, failed=(10, 20, 0, 5, 2, 0)), setups)
    success, spl, collisions, changes, orders, measures, by_motion = made
    for means in (success, spl, collisions):
        assert [row for row, _ in means.rows] == list(agents)
        assert means.header == ("agent", "contacts", "sliding")
    assert cell(changes, "stubborn-i", "success %: contacts - sliding").estimate.mean == pytest.approx(-18 / 40)
    assert cell(measures, "contacts", "success %").estimate.mean == pytest.approx(10 / 40)
    assert cell(by_motion, "sliding - contacts", "success %").estimate.mean == pytest.approx(-3 / 40 - 10 / 40)
    order = cell(orders, "contacts, sliding", "success %").estimate
    assert order.mean == pytest.approx(1 / 3)  # two of the three pairs of agents have the same order
    assert order.ends[0] <= 1 / 3 <= order.ends[1]


@pytest.mark.costly
def test_motions_are_compared_without_contacts_and_with_further_options() -> None:
    agents = ("stubborn", "stubborn --config agent.planning.dilation_m=0.1")
    named = [
        agent.replace(" --config", f" --motion {motion} --config") for agent in agents[1:] for motion in MOTIONS[1:]
    ]
    setups = TABLES["motions"].setups((*(f"stubborn --motion {motion}" for motion in MOTIONS[1:]), *named))
    means, _, _, changes, *_ = TABLES["motions"].build(lines_of(setups, failed=(5, 4, 3, 2)), setups)
    assert [row for row, _ in means.rows] == list(agents)
    assert cell(changes, agents[1], "success %: no-sliding - sliding").estimate.mean == pytest.approx(-1 / 40)


def test_tables_share_their_runs_and_the_oracle_runs_once() -> None:
    network = {setup for setup in TABLES["failures"].setups() if setup.semantics == "rednet"}
    assert set(TABLES["categories"].setups()) | network <= set(TABLES["overall"].setups())
    assert set(TABLES["controls"].setups()[:1]) <= set(TABLES["exploration"].setups())
    assert TABLES["ablation"].setups()[-1] == TABLES["exploration"].setups()[0] == AgentSetup("stubborn", "", "gt")
    assert AgentSetup("oracle", "", "gt") in TABLES["overall"].setups(semantics="rednet")
    assert TABLES["overall"].setups(("random", "stubborn"), "rednet") == (
        AgentSetup("random", "", "gt"),
        AgentSetup("stubborn", "", "rednet"),
    )


@pytest.mark.parametrize(
    ("name", "setup", "variant"),
    [
        ("stubborn", AgentSetup("stubborn", "", "rednet"), ""),
        ("stubborn --verification none", AgentSetup("stubborn", "--verification none", "rednet"), "verification-none"),
        (
            "stubborn --explorer my.explorers:FARTHEST --config agent.planning.dilation_m=0.1 task.max_steps=90",
            AgentSetup(
                "stubborn",
                "--explorer my.explorers:FARTHEST --config agent.planning.dilation_m=0.1 task.max_steps=90",
                "rednet",
            ),
            "explorer-my.explorers_FARTHEST_config-agent.planning.dilation_m=0.1-task.max_steps=90",
        ),
    ],
)
def test_a_setup_is_written_as_on_the_command_line(name: str, setup: AgentSetup, variant: str) -> None:
    assert AgentSetup.named(name, "rednet") == setup
    assert (setup.name, setup.variant) == (name, variant)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("stubborn --explore tour", r"--explore.*AGENT.*\[--semantics.*SOURCE\]"),
        ("stubborn --explorer", wording.NEEDS_ONE_NAME_FOR_EXPLORER),
        ("stubborn --noise harsh", "--noise"),
        ("stubborn frontier", wording.NEEDS_ONE_NAME_FOR_AGENT),
        ("--explorer tour", wording.NEEDS_ONE_NAME_FOR_AGENT),
        ("stubborn --config", "FIELD=VALUE"),
        ("stubborn 'tour", wording.CANNOT_BE_READ_NO_CLOSING_QUOTATION),
    ],
)
def test_a_setup_of_another_form_is_refused(name: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        AgentSetup.named(name, "gt")


def test_the_table_of_verification_has_all_methods() -> None:
    options = [setup.options for setup in TABLES["verification"].setups()[:-1]]
    assert options == ["", "--verification none"]


def test_an_unknown_table_is_refused_with_the_tables_that_exist() -> None:
    with pytest.raises(ConfigError, match=wording.FAILURES_ABLATION_EXPLORATION_CONTROLS_CATEGORIE):
        table_named("failure")


def test_a_row_with_options_of_its_own_has_them_in_its_name() -> None:
    setups = tuple(AgentSetup.named(name, "gt") for name in ("stubborn-i", "stubborn-i --config agent.cell_m=0.1"))
    means, differences = TABLES["ablation"].build(lines_of(setups, failed=(10, 20)), setups)
    assert len({row for row, _ in means.rows}) == 2
    assert all("agent.cell_m=0.1" in row for row, _ in differences.rows)
