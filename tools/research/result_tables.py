"""Makes the tables of results: `docs/tables/*.csv` and the tables of docs/results.md, from the archive of result lines.

    python -m tools.research.result_tables            # writes them
    python -m tools.research.result_tables --check    # exit status 1 where a file differs from what it would write

`results.csv` has one row for each agent with its options, split and segmentation, and `comparisons.csv` the paired
differences. Shares are between 0 and 1; `_low` and `_high` are the 95 % bootstrap interval
(`sim.evaluation.bootstrap`). No episode is run. The page's tables stand between `<!-- table: NAME -->` and
`<!-- end -->`; its sentences may quote only quantities with an interval, such as `94.0 [89.1, 98.0]`, that are in the
two files.
"""

from __future__ import annotations

import csv
import io
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sim import cli
from sim.analysis import display
from sim.analysis.comparison import Line, require_same_episodes
from sim.analysis.metrics import FIRST_SIGHT, Metric, houses_of
from sim.errors import ConfigError
from sim.evaluation.bootstrap import Estimate
from sim.files import write_together
from sim.reading import read_bytes, read_text
from sim.reading import read_csv as read_table
from sim.task.failures import CAUSES
from tools.research.result_archive import ARCHIVE, ROOT, ArchivedRun, RunKey, read_archive
from tools.research.result_definitions import (
    COMPARED,
    FAILED,
    MEANS,
    MEDIAN,
    Comparison,
    PageTable,
    RowKey,
    comparisons,
    page_tables,
)

Record = dict[str, str]
"""One row of a CSV file, by column."""
TABLES = ROOT / "docs" / "tables"
PAGE = ROOT / "docs" / "results.md"
RESULTS, COMPARISONS = "results.csv", "comparisons.csv"
QUANTITY = re.compile(r"([-+]?\d[\d.]*)(?: (?:points|steps|%|of SPL))? (\[[-+]?\d[\d.]*, [-+]?\d[\d.]*\])")
"""A number with an interval in a sentence of the page."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write the tables of results from the archive of result lines, or check them."""

    check: bool = False
    """Write nothing; the exit status is 1 where a file differs."""
    archive: Path = ARCHIVE
    """The archive of result lines."""
    tables: Path = TABLES
    """Folder of the CSV files."""
    page: Path = PAGE
    """The page with the tables."""


def main(args: Args) -> int:
    """Writes or checks the files; returns the exit status."""
    console = display.make_console()

    def say(text: str) -> None:
        console.print(text, markup=False, highlight=False, soft_wrap=True)

    with tempfile.TemporaryDirectory() as folder:
        runs = read_archive(args.archive, Path(folder), say)
        results = [result_record(runs[key.run], key.episodes) for key in row_keys(runs)]
        compared = [comparison_record(each, runs) for each in comparisons()]
    page = fill_page(read_text(args.page, what="--page"), results)
    wanted = {
        args.tables / RESULTS: to_csv(results),
        args.tables / COMPARISONS: to_csv(compared),
        args.page: page,
    }
    unknown = unknown_quantities(page, results, compared)
    for text in unknown:
        say(f"'{args.page}' quotes {text}, which is in no row of {RESULTS} or {COMPARISONS}.")
    differing = [file for file, text in wanted.items() if not file.is_file() or _text(file) != text]
    if args.check:
        for file in differing:
            say(f"'{file}' differs from the archive; `python -m tools.research.result_tables` writes it.")
        return int(bool(differing or unknown))
    write_together(dict(wanted))
    say(f"{len(results)} rows in {args.tables / RESULTS}, {len(compared)} in {args.tables / COMPARISONS}.")
    return int(bool(unknown))


def row_keys(runs: Mapping[RunKey, ArchivedRun]) -> list[RowKey]:
    """Returns the rows of results.csv in order: each run with all its episodes, and what the page's tables need.

    Raises:
        ConfigError: a table needs a run that the archive does not have.
    """
    keys = {RowKey(key, len(run.run.lines)) for key, run in runs.items()}
    for table in page_tables():
        for key in table.needed():
            if key.run not in runs:
                raise ConfigError(
                    f"Table '{table.name}' needs a run of '{key.run.name}' with {key.run.semantics} segmentation on "
                    f"{key.run.split}; the archive has none."
                )
            keys.add(key)
    return sorted(keys, key=lambda key: (key.run, key.episodes))


def result_record(run: ArchivedRun, episodes: int) -> Record:
    """Returns a row of results.csv, of the first episodes of a run."""
    lines = run.first_lines(episodes)
    record = {**_identity(run.key), "ground_truth": _yes(run.uses_ground_truth), **_counts(lines)}
    for metric in MEANS:
        record |= _estimate_columns(metric, metric.cell(lines).estimate)
    record[MEDIAN] = FIRST_SIGHT.median(lines)
    failed = Counter(line["failure"] for line in lines if not line["success"])
    record |= {f"{FAILED}{cause}": str(failed[cause]) for cause in CAUSES}
    config = run.run.config
    versions, split = config.get("versions", {}), config["split_identity"]
    return record | {
        "package": versions.get("stubborn-objectnav", ""),
        "mujoco": versions.get("mujoco", ""),
        "split_version": f"{split['version']} {split['sha256'][:8]}",
        "code": run.codes,
        "network": run.network,
        "command": run.command(episodes),
    }


def comparison_record(pair: Comparison, runs: Mapping[RunKey, ArchivedRun]) -> Record:
    """Returns a row of comparisons.csv.

    Raises:
        ConfigError: a run is not in the archive, or the runs are of different episodes.
    """
    for key in (pair.first, pair.second):
        if key not in runs:
            raise ConfigError(
                f"A comparison of table '{pair.table}' needs a run that the archive does not have: {key}."
            )
    one, other = runs[pair.first], runs[pair.second]
    shared = set(require_same_episodes(one.run, other.run))
    first, second = (
        [line for line in run.first_lines(pair.episodes) if line["episode_id"] in shared] for run in (one, other)
    )
    minus = {f"minus_{name}": value for name, value in _identity(pair.second).items() if name != "split"}
    record = {"table": pair.table, **_identity(pair.first), **minus, **_counts(first)}
    for metric in COMPARED:
        found = metric.difference(second, first).estimate
        record |= _estimate_columns(metric, found) | {f"{metric.key}_significant": _yes(found.significant)}
    outcomes = [(bool(a["success"]), bool(b["success"])) for a, b in zip(first, second, strict=True)]
    return record | {
        "only_first_succeeds": str(outcomes.count((True, False))),
        "only_second_succeeds": str(outcomes.count((False, True))),
    }


def fill_page(text: str, results: Sequence[Record]) -> str:
    """Returns the page with its tables made from rows of results.csv.

    Raises:
        ConfigError: the page lacks the marks of a table.
    """
    rows = {(*(record[name] for name in _identity_names()), record["episodes"]): record for record in results}

    def record_of(key: RowKey) -> Record:
        return rows[(*_identity(key.run).values(), str(key.episodes))]

    for table in page_tables():
        marks = re.compile(rf"(<!-- table: {table.name} -->\n).*?(<!-- end -->)", re.DOTALL)
        if len(marks.findall(text)) != 1:
            raise ConfigError(f"The page needs one '<!-- table: {table.name} -->' with an '<!-- end -->' after it.")
        shown = table_text(table, record_of)
        text = marks.sub(lambda match, shown=shown: f"{match[1]}\n{shown}\n{match[2]}", text)
    return text


def table_text(table: PageTable, record_of: Callable[[RowKey], Record]) -> str:
    """Returns a table as Markdown."""
    labels = len(table.rows[0][0])
    rule = ["---"] * labels + ["--:"] * (len(table.header) - labels)
    lines = [table.header, rule]
    for texts, cells in table.rows:
        lines.append([*texts, *(cell_text(record_of(key), column) for key, column in cells)])
    return "".join(f"|{'|'.join(line)}|\n" for line in lines)


def cell_text(record: Record, column: Metric | str, *, sign: str = "") -> str:
    """Returns a cell of the page, such as `94.0 [89.1, 98.0]`; a column without an interval as it is."""
    if isinstance(column, str):
        return record[column]
    numbers = [record[f"{column.key}{end}"] for end in ("", "_low", "_high")]
    if "" in numbers:
        return "-"
    factor = 100.0 if column.percent else 1.0
    mean, low, high = (f"{factor * float(number):{sign}.{column.digits}f}" for number in numbers)
    return f"{mean} [{low}, {high}]"


def unknown_quantities(page: str, results: Iterable[Record], compared: Iterable[Record]) -> list[str]:
    """Returns the quantities with an interval that the page quotes and no row of the CSV files has."""
    known = {cell_text(record, metric) for record in results for metric in MEANS}
    for record in compared:
        known |= {cell_text(record, metric, sign=sign) for metric in COMPARED for sign in ("", "+")}
    quoted = {f"{match[1]} {match[2]}" for match in QUANTITY.finditer(" ".join(page.split()))}
    return sorted(quoted - known)


def to_csv(records: Sequence[Record]) -> str:
    """Returns CSV text."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, list(records[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(records)
    return stream.getvalue()


def read_csv(file: Path) -> list[Record]:
    """Returns the rows of a CSV file."""
    return [dict(record) for record in read_table(file, what="Table")]


def _identity(key: RunKey) -> Record:
    return {"split": key.split, "agent": key.agent, "options": key.options, "semantics": key.semantics}


def _identity_names() -> Iterator[str]:
    yield from _identity(RunKey("", "", "", ""))


def _counts(lines: Sequence[Line]) -> Record:
    return {"episodes": str(len(lines)), "houses": str(len(set(houses_of(lines))))}


def _estimate_columns(metric: Metric, found: Estimate) -> Record:
    numbers = {"": found.mean, "_low": found.low, "_high": found.high}
    return {f"{metric.key}{end}": "" if value is None else f"{value:.6f}" for end, value in numbers.items()}


def _text(file: Path) -> str:
    return read_bytes(file, what="Table").decode("utf-8", errors="replace")


def _yes(value: bool) -> str:
    return "yes" if value else "no"


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
