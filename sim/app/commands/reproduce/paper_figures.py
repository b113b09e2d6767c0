"""The figures that Luo et al. (2022) report, for comparison with ours.

They are of MP3D houses in Habitat (tables 1, 3, 4, 5: validation; 6: the test split of the challenge of 2021): only
the order of agents and their differences can be compared with ours.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sim.app.analysis.tables import Cell, ResultTable
from sim.task.failures import CAUSES

Columns = Mapping[str, Mapping[str, str]]
"""Text by title of the column, then by the first words of the row."""


def _column(names: str, figures: str) -> dict[str, str]:
    """Returns a column of figures, each of one word."""
    return dict(zip(names.split(), figures.split(), strict=True))


def _causes(figures: str) -> dict[str, str]:
    """Returns a column of shares of the failures, with half of the width of their interval, and of the success."""
    causes = [cause for cause in CAUSES if cause != "stopped_short"]
    *shares, success = figures.split()
    texts = (share.replace("+-", " ± ") for share in shares)
    return {**dict(zip(causes, texts, strict=True)), "success %": success}


_SIX = "chair sofa bed plant toilet tv_monitor all"
_FIFTEEN = (
    "stool toilet sink chest_of_drawers plant bed cabinet table counter chair sofa seating picture cushion towel all"
)

FIGURES: Mapping[str, Columns] = {
    "failures": {
        "SemExp": _causes("47.7+-9.0 2.7+-2.3 10.8+-5.9 10.8+-5.4 8.1+-5.0 12.6+-5.9 7.2+-4.0 17.9"),
        "EEAux": _causes("35.3+-6.3 6.3+-3.2 14.7+-4.6 12.5+-4.3 8.9+-3.7 0.4+-0.9 21.9+-5.4 23.7"),
        "EEAux, true": _causes("1.4+-1.1 1.4+-1.1 22.2+-6.9 13.9+-5.8 12.5+-5.4 6.9+-4.0 41.7+-8.5 40.4"),
        "Stubborn": _causes("45.1+-8.8 5.3+-3.6 0.9+-0.9 8.0+-5.0 13.3+-6.1 15.9+-6.0 11.5+-5.7 23.7"),
    },
    "ablation": {
        "trapped %": _column("I II III IV V", "10.0 8.7 6.7 5.2 5.0"),
        "GT exploration %": _column("I II III IV V", "54 59 64 64 67"),
    },
    "exploration": {
        "Stubborn": _column(_SIX, "80 72 39 61 67 83 67"),
        "Stubborn without avoidance": _column(_SIX, "74 58 38 50 36 66 54"),
        "SemExp": _column(_SIX, "79 65 38 57 26 83 58"),
        "SemExp without avoidance": _column(_SIX, "76 65 38 51 26 83 57"),
        "Frontier": _column(_SIX, "75 65 24 56 29 100 58"),
    },
    "controls": {
        "success %": {
            "semexp": "56.5",
            "semexp --config agent.explorer.semantics=shuffled": "54.7",
            "semexp --config agent.explorer.goal=wrong": "55.0",
        },
    },
    "categories": {
        "Stubborn": _column(_FIFTEEN, "16 43 31 19 33 51 34 61 39 47 31 69 27 46 12 37"),
        "Single-Frame": _column(_FIFTEEN, "9 35 26 16 28 44 30 56 36 46 31 69 30 56 15 35"),
    },
    "overall": {
        "success %": {
            "stubborn": "23.7",
            "stubborn --verification none": "22.2",
            "semexp --verification none": "17.85",
            "poni": "20",
            "Habitat-Web": "27.8",
            "TreasureHunt": "21.4",
            "EmbCLIP": "18.1",
            "OVRL": "23.2",
            "EEAux": "23.7",
        },
        "SPL": {
            "stubborn": "0.098",
            "semexp --verification none": "0.071",
            "poni": "0.088",
            "Habitat-Web": "0.099",
            "TreasureHunt": "0.089",
            "EmbCLIP": "0.078",
            "OVRL": "0.076",
            "EEAux": "0.062",
        },
    },
}
"""The columns of each table of `paper_tables` that the paper has too."""
OTHERS = (
    "The last rows are agents with checkpoints that cannot be had here. For all but TreasureHunt, "
    "docs/tables/published_agents.csv has the commands that run their code, or states why it cannot run."
)


def beside_paper(name: str, table: ResultTable) -> ResultTable:
    """Returns a table with the paper's columns; a row that only the paper has is without figures of ours."""
    columns = FIGURES.get(name)
    if columns is None:
        return table
    rows: list[tuple[str, list[Cell | str]]] = []
    remaining = {row: None for column in columns.values() for row in column}  # in order
    for label, cells in table.rows:
        row = next((row for row in remaining if _names(label, row)), None)
        rows.append((label, [*cells, *(column.get(row or "", "") for column in columns.values())]))
        remaining.pop(row or "", None)
    if name == "overall":
        without: list[Cell | str] = [""] * (len(table.header) - 1)
        rows += [(row, [*without, *(column.get(row, "") for column in columns.values())]) for row in remaining]
    header = (*table.header, *(f"paper: {title}" for title in columns))
    return replace(table, header=header, rows=rows, notes=(*table.notes, *((OTHERS,) if name == "overall" else ())))


def _names(label: str, row: str) -> bool:
    """Returns whether the label of a row of ours, such as `bed (12)` or `II stubborn-ii`, is of this row."""
    return label == row or label.startswith(f"{row} (") or label.startswith(f"{row} stubborn")
