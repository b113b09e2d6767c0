"""Curves over parameters of traps: every episode is in one bin, and intervals hold the means."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sim.app.commands.traps.curves import MAX_BINS, QUANTITIES, bin_edges, curve
from sim.app.commands.traps.family_report import as_csv, draw_curves, draw_families, family_table
from sim.app.commands.traps.report import Args, main
from sim.app.commands.traps.trial import TrapResult
from sim.core.interface import ConfigError
from sim.houses.sidecar import TrapFacts

GAP, PANES, OBJECTS = QUANTITIES


def facts(family: str, gap_m: float, difficulty: str = "easy") -> TrapFacts:
    return TrapFacts(
        family=family, difficulty=difficulty, seed=0, parameters={"gap_m": gap_m}, gap_m=gap_m, hidden_length_m=2.0,
        hidden_objects=3, shortest_path_m=5.0, open_path_m=4.0, fewest_actions=20,
    )  # fmt: skip


def row(trap: str, agent: str, escaped: bool, collisions: int) -> TrapResult:
    return TrapResult(
        trap=trap, episode_id="e", agent=agent, escaped=escaped, steps=9, steps_in_trap=3, collisions=collisions,
        trapped=False, spl=0.0, forward_mean_m=None, deepest_mm=0.0, fell=not escaped,
    )  # fmt: skip


TRAPS = {f"pane_{i}": facts("pane_gap", 0.4 + 0.02 * i, "hard" if i < 10 else "easy") for i in range(20)}
ROWS = [row(trap, agent, i >= 5 or agent == "b", i % 3) for agent in "ab" for i, trap in enumerate(TRAPS)]


@pytest.mark.parametrize("count", [1, 3, 40])
def test_every_value_is_in_one_bin_and_no_bin_is_empty(count: int):
    values = np.random.default_rng(0).uniform(size=count)
    edges = bin_edges(values)
    counts = np.histogram(values, np.minimum(edges, 2.0))[0]
    assert counts.sum() == count
    assert counts.min() > 0
    assert len(counts) <= MAX_BINS


def test_equal_values_are_in_one_bin():
    assert bin_edges(np.array([3.0, 3.0, 3.0])).tolist() == [3.0, np.inf]


def test_a_curve_counts_each_episode_once_and_its_intervals_hold_the_means():
    points = curve(ROWS, TRAPS, GAP)
    for agent in "ab":
        of = [point for point in points if point.agent == agent]
        assert sum(point.episodes for point in of) == 20
        for point in of:
            assert point.success_low <= point.success + 1e-9
            assert point.success <= point.success_high + 1e-9
            assert point.collisions_low <= point.collisions <= point.collisions_high
    narrow = next(point for point in points if point.agent == "a")
    assert (narrow.low, narrow.success) == (0.4, 0.0)


def test_traps_without_panes_are_in_no_curve_over_panes():
    traps = {**TRAPS, "stools": facts("stool_ring", 0.5)}
    points = curve([*ROWS, row("stools", "a", True, 0)], traps, PANES)
    assert sum(point.episodes for point in points if point.agent == "a") == 20


def test_the_table_has_a_line_for_each_family_and_difficulty():
    table = family_table(ROWS, TRAPS)
    assert table.header == ("family", "a", "b")
    assert [label for label, _ in table.rows] == ["pane_gap", "all, easy", "all, medium", "all, hard", "all"]
    assert str(table.rows[-1][1][0]).startswith("15/20 (51-90 %), 0.9 collisions, 5 fell")
    assert table.rows[2][1][0] == "-"


def test_the_figures_have_an_axis_for_each_quantity_and_the_csv_a_line_for_each_point():
    points = [point for quantity in QUANTITIES for point in curve(ROWS, TRAPS, quantity)]
    assert len(draw_curves(points).axes) == 2 * len(QUANTITIES)
    assert len(draw_families(ROWS, TRAPS).axes) == 2
    assert len(as_csv(points).splitlines()) == 1 + len(points)


@pytest.mark.costly
def test_the_report_of_a_split_of_families_has_curves_and_tables(tmp_path: Path):
    args = Args(
        out=tmp_path, split="contact-val", agents=("tests.helpers.runners:make_quitter",),
        traps=("pane_gap_easy_00",), pictures=False,
    )  # fmt: skip
    assert main(args) == 0
    assert "| pane_gap | 0/1" in (tmp_path / "families.md").read_text()
    assert {"curves.png", "curves.csv", "families.png"} <= {file.name for file in tmp_path.iterdir()}

    assert main(args) == 0  # nothing is missing
    config = json.loads((tmp_path / "config.json").read_text())
    (name,) = config["own_code"]
    config["own_code"][name] = "0123456789ab"  # the agent was changed
    (tmp_path / "config.json").write_text(json.dumps(config))
    with pytest.raises(ConfigError, match=r"own_code.*0123456789ab.*choose"):
        main(args)
