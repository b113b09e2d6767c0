"""Tables of estimates, for the terminal, as Markdown and as CSV."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from rich.table import Table

from sim.app.evaluation.intervals import Estimate, holm
from sim.core.files import csv_text

SIGNIFICANT, NOT_SIGNIFICANT = "significant", "not significant"
CSV_COLUMNS = ("table", "row", "column", "value", "low95", "high95", "episodes", "houses", "verdict")
SIGNIFICANCE = 0.05
"""A difference is significant if its p-value, corrected for the number of differences, is smaller."""
ONE_HOUSE = "*"
"""Marks an interval over the episodes of one house."""
ONE_HOUSE_NOTE = f"{ONE_HOUSE} One house: the interval is over its episodes and says nothing about other houses."


@dataclass(frozen=True)
class Cell:
    """One estimate and its format."""

    estimate: Estimate
    percent: bool = False
    """Shown times 100."""
    digits: int = 1
    difference: bool = False
    """A difference, shown with its sign, or a ratio; not significant where the interval holds `Estimate.neutral`."""
    say_significant: bool = False
    """A significant comparison is shown with that word too."""
    p_holm: float | None = None
    """The p-value of a difference after Holm's correction for the other differences of its table; None: uncorrected."""

    @property
    def is_significant(self) -> bool:
        """True for a significant comparison, after the correction if it has one."""
        return self.estimate.significant and (self.p_holm is None or self.p_holm < SIGNIFICANCE)

    @property
    def verdict(self) -> str:
        """`not significant`, `higher` or `lower` for a comparison; "" for a mean and for a comparison without pairs."""
        if not self.difference or self.estimate.mean is None:
            return ""
        if not self.is_significant:
            return NOT_SIGNIFICANT
        return "higher" if self.estimate.mean > self.estimate.neutral else "lower"

    @property
    def mean_text(self) -> str:
        """`12.0`, or `-` without a value."""
        return "-" if self.estimate.mean is None else self._number(self.estimate.mean)

    @property
    def interval_text(self) -> str:
        """`[8.0, 16.0]`, with an asterisk if it is over one house; "" without an interval."""
        low, high = self.estimate.low, self.estimate.high
        if low is None or high is None:
            return ""
        return f"[{self._number(low)}, {self._number(high)}]" + ONE_HOUSE * (self.estimate.houses == 1)

    def text(self, separator: str = " ") -> str:
        """Returns `12.0 [8.0, 16.0]`, for a difference `+4.0 [-1.0, 9.0] not significant`."""
        word = (
            NOT_SIGNIFICANT
            if self.verdict == NOT_SIGNIFICANT
            else SIGNIFICANT
            if self.verdict and self.say_significant
            else ""
        )
        return separator.join(filter(None, (self.mean_text, self.interval_text, word)))

    def _number(self, value: float) -> str:
        sign = "+" if self.difference and self.estimate.neutral == 0.0 else ""
        return f"{(100.0 if self.percent else 1.0) * value:{sign}.{self.digits}f}"


@dataclass(frozen=True)
class ResultTable:
    """A table: rows of cells under a header."""

    name: str
    """Name in the CSV file."""
    title: str
    header: tuple[str, ...]
    """The first column has the labels of the rows."""
    rows: Sequence[tuple[str, Sequence[Cell | str]]]
    notes: Sequence[str] = field(default_factory=tuple)
    """Sentences below the table."""

    @property
    def footnotes(self) -> tuple[str, ...]:
        """The notes, and the meaning of the asterisk if a cell has one."""
        cells = [cell for _, row in self.rows for cell in row if isinstance(cell, Cell)]
        return (*self.notes, *((ONE_HOUSE_NOTE,) if any(ONE_HOUSE in cell.interval_text for cell in cells) else ()))


def corrected(cells: Sequence[Cell]) -> list[Cell]:
    """Returns the differences with their p-values corrected for their number by Holm's method."""
    p_values = [1.0 if cell.estimate.p is None else cell.estimate.p for cell in cells]
    return [replace(cell, p_holm=p) for cell, p in zip(cells, holm(p_values), strict=True)]


def with_corrections(table: ResultTable) -> ResultTable:
    """Returns a table with all its differences that have a p-value corrected as one family."""
    tested = [cell for _, cells in table.rows for cell in cells if isinstance(cell, Cell) and _has_test(cell)]
    rest = iter(corrected(tested))
    rows = [
        (label, [next(rest) if isinstance(cell, Cell) and _has_test(cell) else cell for cell in cells])
        for label, cells in table.rows
    ]
    return replace(table, rows=rows)


def _has_test(cell: Cell) -> bool:
    return cell.difference and cell.estimate.p is not None


def to_rich(table: ResultTable) -> Table:
    """Returns the table for a `sim.app.analysis.display.PlainConsole`."""
    caption = "\n".join(table.footnotes) or None
    shown = Table(title=table.title, caption=caption, title_justify="left", caption_justify="left")
    shown.add_column(table.header[0])
    for name in table.header[1:]:
        shown.add_column(name, justify="right")
    for label, cells in table.rows:
        shown.add_row(label, *(_text(cell, "\n") for cell in cells))
    return shown


def to_markdown(tables: Sequence[ResultTable]) -> str:
    """Returns several tables as one page."""
    parts = []
    for table in tables:
        rule = ["---", *("---:" for _ in table.header[1:])]
        lines = [list(table.header), rule, *([label, *map(_text, cells)] for label, cells in table.rows)]
        grid = "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)
        notes = "".join(f"\n{note}\n" for note in table.footnotes)
        parts.append(f"**{table.title}**\n\n{grid}{notes}")
    return "\n".join(parts)


def to_csv(tables: Sequence[ResultTable]) -> str:
    """Returns CSV text with a line for each cell of several tables that has a number; shares are not in percent."""
    rows: list[Sequence[object]] = []
    for table in tables:
        for label, cells in table.rows:
            for column, cell in zip(table.header[1:], cells, strict=True):
                if isinstance(cell, Cell):
                    value = cell.estimate
                    numbers = ("" if v is None else round(v, 6) for v in (value.mean, value.low, value.high))
                    rows.append([table.name, label, column, *numbers, value.count, value.houses, cell.verdict])
    return csv_text(CSV_COLUMNS, rows, end="\r\n")


def _text(cell: Cell | str, separator: str = " ") -> str:
    return cell if isinstance(cell, str) else cell.text(separator)
