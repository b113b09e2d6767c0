"""The paper's tables from lines by hand."""

from __future__ import annotations

import pytest

from sim.analysis.tables import Cell, ResultTable
from sim.interface import ConfigError
from sim.task.failures import CAUSES
from tools.paper_tables import ABLATION, TABLES, Player, table_named

GOALS = ("bed", "sofa")


def line(number: int, *, success: bool, failure: str | None = None, **known: object) -> dict:
    base = {"episode_id": f"e{number:02d}", "goal": GOALS[number % 2], "success": float(success), "failure": failure}
    base |= {"spl": 0.5 * success, "gt_explored": True, "trapped": False, "collisions": 2, "num_steps": 100}
    return base | known


def lines_of(players: tuple[Player, ...], *, failed: tuple[int, ...]) -> dict:
    """40 episodes each; player i fails the first `failed[i]`, of which the very first by a trap."""
    return {
        player: [
            line(n, success=n >= count, failure=None if n >= count else "explore" if n else "trapped")
            for n in range(40)
        ]
        for player, count in zip(players, failed, strict=True)
    }


def cell(table: ResultTable, row: str, column: str) -> Cell:
    cells = dict(table.rows)[row]
    found = cells[table.header.index(column) - 1]
    assert isinstance(found, Cell)
    return found


def test_causes_are_shares_of_the_failed_episodes_and_their_differences_of_all() -> None:
    players = TABLES["failures"].players()[:2]
    causes, differences = TABLES["failures"].build(lines_of(players, failed=(10, 20)), players)
    assert [row for row, _ in causes.rows] == [*CAUSES, "failed episodes", "success %"]
    first, second = (player.label for player in players)
    assert cell(causes, "trapped", first).estimate.mean == pytest.approx(0.1)
    assert cell(causes, "explore", second).estimate.mean == pytest.approx(19 / 20)
    assert dict(causes.rows)["failed episodes"] == ["10 of 40", "20 of 40"]
    explore = cell(differences, "explore", "stubborn - single-frame")
    assert explore.estimate.mean == pytest.approx(-10 / 40)
    assert explore.verdict == "lower"
    assert cell(differences, "trapped", "stubborn - single-frame").verdict == "unresolved"


def test_who_never_fails_has_no_causes() -> None:
    players = TABLES["failures"].players()[:2]
    causes, _ = TABLES["failures"].build(lines_of(players, failed=(0, 1)), players)
    assert cell(causes, "loop", players[0].label).text() == "-"


def test_the_ablation_compares_each_row_with_the_one_before_and_the_last_with_the_first() -> None:
    players = TABLES["ablation"].players()
    means, differences = TABLES["ablation"].build(lines_of(players, failed=(20, 15, 10, 5, 0)), players)
    assert [row for row, _ in means.rows] == [f"{row} {agent}" for row, agent in ABLATION.items()]
    assert [row for row, _ in differences.rows] == ["II - I", "III - II", "IV - III", "V - IV", "V - I"]
    last = cell(differences, "V - I", "success %")
    assert (last.estimate.mean, last.verdict) == (pytest.approx(0.5), "higher")
    assert cell(differences, "V - I", "collisions").verdict == "unresolved"


def test_goals_have_rows_in_the_contracts_order_with_their_episodes() -> None:
    players = TABLES["categories"].players()
    (table,) = TABLES["categories"].build(lines_of(players, failed=(4, 8)), players)
    assert [row for row, _ in table.rows] == ["sofa (20)", "bed (20)", "all (40)"]
    assert cell(table, "bed (20)", "stubborn").estimate.mean == pytest.approx(18 / 20)
    assert cell(table, "all (40)", "stubborn - single-frame").estimate.mean == pytest.approx(0.1)


@pytest.mark.parametrize("name", TABLES)
def test_every_table_can_be_made_of_its_own_players(name: str) -> None:
    players = table_named(name).players()
    for table in table_named(name).build(lines_of(players, failed=(3,) * len(players)), players):
        assert table.rows
        assert all(len(cells) == len(table.header) - 1 for _, cells in table.rows)


def test_tables_share_their_runs_and_the_oracle_plays_once() -> None:
    assert set(TABLES["categories"].players()) <= set(TABLES["failures"].players()) <= set(TABLES["overall"].players())
    assert TABLES["ablation"].players()[-1] == TABLES["exploration"].players()[0] == Player("stubborn", "gt")
    assert Player("oracle", "gt") in TABLES["overall"].players(semantics="rednet")
    assert TABLES["overall"].players(("random", "stubborn"), "rednet") == (
        Player("random", "gt"),
        Player("stubborn", "rednet"),
    )


def test_a_table_that_there_is_not_is_told_what_there_is() -> None:
    with pytest.raises(ConfigError, match="failures, ablation, exploration, categories, overall"):
        table_named("failure")
