"""Tables of the trap report: a header and lines of cells, as Markdown and for the terminal."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rich.table import Table

from sim.app.commands.traps.trial import TrapResult


def grid(rows: Sequence[TrapResult]) -> tuple[list[str], list[list[str]]]:
    """Returns header and lines of the table: a line for each trap, then the totals; a column for each agent."""
    names = sorted({row.agent for row in rows})
    traps = list(dict.fromkeys(row.trap for row in rows))
    lines = []
    for trap in traps:
        cells = [[row for row in rows if (row.trap, row.agent) == (trap, name)] for name in names]
        lines.append([trap, *(_cell(cell) for cell in cells)])
    every = [[row for row in rows if row.agent == name] for name in names]
    lines.append(["**success**", *(f"**{sum(r.escaped for r in of)}/{len(of)}**" for of in every)])
    for label, key in (("steps in the trap, median", "steps_in_trap"), ("collisions, median", "collisions")):
        lines.append([label, *(f"{np.median([getattr(row, key) for row in of]):.0f}" for of in every)])
    lines.append(["metres per forward, mean", *(f"{_forward_m(of):.2f}" for of in every)])
    lines.append(["deepest contact, mm", *(f"{max(row.deepest_mm for row in of):.1f}" for of in every)])
    return ["trap", *names], lines


def markdown_of(header: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Returns a table as Markdown."""
    rule = ["---", *("---:" for _ in header[1:])]
    return "".join("| " + " | ".join(line) + " |\n" for line in (header, rule, *lines))


def table_of(title: str, header: Sequence[str], lines: Sequence[Sequence[str]]) -> Table:
    """Returns a table for the terminal."""
    table = Table(title=title)
    table.add_column(header[0])
    for name in header[1:]:
        table.add_column(name, justify="right")
    for line in lines:
        table.add_row(*(cell.strip("*") for cell in line))
    return table


def _cell(rows: Sequence[TrapResult]) -> str:
    """Returns successes out of episodes, with medians of steps in the trap and of collisions."""
    if not rows:
        return "-"
    steps = np.median([row.steps_in_trap for row in rows])
    collisions = np.median([row.collisions for row in rows])
    return f"{sum(row.escaped for row in rows)}/{len(rows)} ({steps:.0f}, {collisions:.0f})"


def _forward_m(rows: Sequence[TrapResult]) -> float:
    """Returns the mean displacement of a forward action."""
    moved = [row.forward_mean_m for row in rows if row.forward_mean_m is not None]
    return float(np.mean(moved)) if moved else 0.0
