"""Tables of estimates: for the terminal, as Markdown, as CSV."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.table import Table

from sim.analysis.comparison import UNRESOLVED, Estimate

CSV_COLUMNS = ("table", "row", "column", "value", "low95", "high95", "episodes", "verdict")


@dataclass(frozen=True)
class Cell:
    """One estimate and how it is shown."""

    estimate: Estimate
    percent: bool = False
    """Shown times 100."""
    digits: int = 1
    difference: bool = False
    """Shown with its sign and, where the interval holds 0, as unresolved."""

    @property
    def verdict(self) -> str:
        """`unresolved`, `higher` or `lower` for a difference; "" for a mean, and where nothing is known."""
        if not self.difference or self.estimate.mean is None:
            return ""
        if not self.estimate.resolved:
            return UNRESOLVED
        return "higher" if self.estimate.mean > 0.0 else "lower"

    def text(self) -> str:
        """`12.0 [8.0, 16.0]`, a difference as `+4.0 [-1.0, 9.0] unresolved`."""
        value = self.estimate
        if value.mean is None or value.low is None or value.high is None:
            return "-"
        scale, sign = 100.0 if self.percent else 1.0, "+" if self.difference else ""
        mean, low, high = (f"{scale * number:{sign}.{self.digits}f}" for number in (value.mean, value.low, value.high))
        unresolved = f" {UNRESOLVED}" if self.verdict == UNRESOLVED else ""
        return f"{mean} [{low}, {high}]{unresolved}"


@dataclass(frozen=True)
class ResultTable:
    """Rows of cells under a header."""

    name: str
    """Of its files."""
    title: str
    header: tuple[str, ...]
    """The first column has the rows' labels."""
    rows: Sequence[tuple[str, Sequence[Cell | str]]]
    notes: Sequence[str] = field(default_factory=tuple)
    """Sentences below the table."""


def to_rich(table: ResultTable) -> Table:
    """For the terminal."""
    shown = Table(
        title=table.title, caption="\n".join(table.notes) or None, title_justify="left", caption_justify="left"
    )
    shown.add_column(table.header[0])
    for name in table.header[1:]:
        shown.add_column(name, justify="right")
    for label, cells in table.rows:
        shown.add_row(label, *(_text(cell).replace(" [", "\n[").replace("] ", "]\n") for cell in cells))
    return shown


def to_markdown(tables: Sequence[ResultTable]) -> str:
    """Several tables as one page."""
    parts = []
    for table in tables:
        rule = ["---", *("---:" for _ in table.header[1:])]
        lines = [list(table.header), rule, *([label, *map(_text, cells)] for label, cells in table.rows)]
        grid = "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)
        notes = "".join(f"\n{note}\n" for note in table.notes)
        parts.append(f"**{table.title}**\n\n{grid}{notes}")
    return "\n".join(parts)


def write_csv(file: Path, tables: Sequence[ResultTable]) -> None:
    """Several tables, a line a cell that holds a number; shares and not percent."""
    with file.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(CSV_COLUMNS)
        for table in tables:
            for label, cells in table.rows:
                for column, cell in zip(table.header[1:], cells, strict=True):
                    if isinstance(cell, Cell):
                        value = cell.estimate
                        numbers = ("" if v is None else round(v, 6) for v in (value.mean, value.low, value.high))
                        writer.writerow([table.name, label, column, *numbers, value.count, cell.verdict])


def _text(cell: Cell | str) -> str:
    return cell if isinstance(cell, str) else cell.text()
