"""Makes the tables of results: `docs/tables/*.csv` and the tables of docs/results.md, from the archive of result lines.

    python -m tools.research.result_tables            # writes them
    python -m tools.research.result_tables --check    # exit status 1 where a file differs from what it would write

`results.csv` has one row for each agent with its options, split and segmentation, `comparisons.csv` the paired
differences, and `resolution.csv` the episodes that show a difference (`tools.research.resolution`). `paper.md` has
the tables of the paper (`tools.research.paper_page`). Shares are between 0 and 1; `_low` and `_high` are the 95 %
interval (`sim.app.evaluation.intervals`). In `comparisons.csv` the column `family` names the primary comparisons of a
table: `success_p_holm` and `spl_p_holm` are their p-values, corrected by Holm's method for all primary comparisons of
the table in both metrics. All others are exploratory, and nothing is corrected for their number. `_replicates_sd` is
the standard deviation that chance alone gives the mean over one replicate of each episode (`stubborn run
--replicates`). No episode is run. The page's tables stand between `<!-- table: NAME -->` and `<!-- end -->`; its
sentences may quote only quantities with an interval, such as `94.0 [89.1, 98.0]`, that are in the two files.
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

from sim.app import cli
from sim.app.analysis import display
from sim.app.analysis.comparison import Line
from sim.app.analysis.metrics import FIRST_SIGHT, Metric, episodes_of, houses_of
from sim.app.evaluation.intervals import Estimate, replicate_spread
from sim.app.evaluation.results import metric_value
from sim.core.errors import ConfigError
from sim.core.files import write_together
from sim.core.reading import read_bytes, read_text
from sim.core.reading import read_csv as read_table
from sim.task.failures import CAUSES
from tools.research.paper_page import PAPER, paper_page
from tools.research.resolution import paired_lines, resolution_record
from tools.research.result_archive import ARCHIVE, ROOT, TABLES, ArchivedRun, RunKey, read_archive
from tools.research.result_definitions import (
    COMPARED,
    FAILED,
    MEANS,
    MEDIAN,
    PRIMARY_METRICS,
    RESOLVED,
    Comparison,
    PageTable,
    RowKey,
    comparisons,
    page_tables,
)

Record = dict[str, str]
"""One row of a CSV file, by column."""
PAGE = ROOT / "docs" / "results.md"
RESULTS, COMPARISONS, RESOLUTION = "results.csv", "comparisons.csv", "resolution.csv"
QUANTITY = re.compile(r"([-+]?\d[\d.]*)(?: (?:points|steps|%|of SPL))? (\[[-+]?\d[\d.]*, [-+]?\d[\d.]*\])")
"""A number with an interval in a sentence of the page."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write the tables of results from the archive of result lines, or check them."""

    check: bool = False
    """Write nothing; the exit status is 1 where a file differs."""
    archive: Path = ARCHIVE
    """Archive of result lines."""
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
        pairs = list(comparisons())
        compared = with_families(pairs, [comparison_record(each, runs) for each in pairs])
        resolved = [resolution_record(each, runs) for each in pairs if each.table in RESOLVED and each.primary]
        paper = paper_page(Path(folder))
    page = fill_page(read_text(args.page, what="--page"), results)
    wanted = {
        args.tables / RESULTS: to_csv(results),
        args.tables / COMPARISONS: to_csv(compared),
        args.tables / RESOLUTION: to_csv(resolved),
        args.tables / PAPER: paper,
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
    keys = {RowKey(key, run.episodes) for key, run in runs.items()}
    for table in page_tables():
        for key in table.needed():
            if key.run not in runs:
                raise ConfigError(
                    f"Table '{table.name}' needs a run of '{key.run.name}' with {key.run.semantics} segmentation on "
                    f"{key.run.split} {key.run.version}; the archive has none."
                )
            keys.add(key)
    return sorted(keys, key=lambda key: (key.run, key.episodes))


def result_record(run: ArchivedRun, episodes: int) -> Record:
    """Returns a row of results.csv, of the first episodes of a run."""
    lines = run.first_lines(episodes)
    record = {**_identity(run.key), "ground_truth": _yes(run.uses_ground_truth), **_counts(lines)}
    for metric in MEANS:
        record |= _estimate_columns(metric, metric.cell(lines).estimate)
    for metric in PRIMARY_METRICS:
        spread = replicate_spread([metric_value(line, metric.key) for line in lines], episodes_of(lines))
        record[f"{metric.key}_replicates_sd"] = "" if spread is None else f"{spread:.6f}"
    record[MEDIAN] = FIRST_SIGHT.median(lines)
    failed = Counter(line["failure"] for line in lines if not line["success"])
    record |= {f"{FAILED}{cause}": str(failed[cause]) for cause in CAUSES}
    config = run.run.config
    versions, split = config.get("versions", {}), config["split_identity"]
    return record | {
        "package": versions.get("stubborn-objectnav", ""),
        "mujoco": versions.get("mujoco", ""),
        "split_sha256": split["sha256"][:8],
        "code": run.codes,
        "network": run.network,
        "command": run.command(episodes),
    }


def comparison_record(pair: Comparison, runs: Mapping[RunKey, ArchivedRun]) -> Record:
    """Returns a row of comparisons.csv without its family.

    Raises:
        ConfigError: a run is not in the archive, or the runs are of different episodes.
    """
    first, second = paired_lines(pair, runs)
    minus = {
        f"minus_{name}": value for name, value in _identity(pair.second).items() if name not in ("split", "version")
    }
    record = {"table": pair.table, **_identity(pair.first), **minus, **_counts(first)}
    for metric in COMPARED:
        found = metric.difference(second, first).estimate
        record |= _estimate_columns(metric, found) | {f"{metric.key}_significant": _yes(found.significant)}
        if metric in PRIMARY_METRICS:
            record |= {f"{metric.key}_p": f"{1.0 if found.p is None else found.p:.6f}", f"{metric.key}_p_holm": ""}
    outcomes = [(bool(a["success"]), bool(b["success"])) for a, b in zip(first, second, strict=True)]
    return record | {
        "only_first_succeeds": str(outcomes.count((True, False))),
        "only_second_succeeds": str(outcomes.count((False, True))),
    }


def with_families(pairs: Sequence[Comparison], records: Sequence[Record]) -> list[Record]:
    """Returns rows of comparisons.csv with their family, and the corrected p-values of primary ones."""
    found = [
        {"table": record["table"], "family": "primary" if pair.primary else "exploratory", **record}
        for pair, record in zip(pairs, records, strict=True)
    ]
    columns = [f"{metric.key}_p" for metric in PRIMARY_METRICS]
    for table in {pair.table for pair in pairs}:
        family = [record for record in found if record["table"] == table and record["family"] == "primary"]
        corrected = iter(holm([float(record[column]) for record in family for column in columns]))
        for record in family:
            record |= {f"{column}_holm": f"{next(corrected):.6f}" for column in columns}
    return found


def holm(p_values: Sequence[float]) -> list[float]:
    """Returns the p-values corrected for their number by Holm's method (1979)."""
    corrected, least = [1.0] * len(p_values), 0.0
    for rank, number in enumerate(sorted(range(len(p_values)), key=p_values.__getitem__)):
        least = max(least, min(1.0, (len(p_values) - rank) * p_values[number]))
        corrected[number] = least
    return corrected


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
    return {
        "split": key.split,
        "version": key.version,
        "agent": key.agent,
        "options": key.options,
        "semantics": key.semantics,
    }


def _identity_names() -> Iterator[str]:
    yield from _identity(RunKey("", "", "", "", ""))


def _counts(lines: Sequence[Line]) -> Record:
    return {"episodes": str(len(set(episodes_of(lines)))), "houses": str(len(set(houses_of(lines))))}


def _estimate_columns(metric: Metric, found: Estimate) -> Record:
    numbers = {"": found.mean, "_low": found.low, "_high": found.high}
    return {f"{metric.key}{end}": "" if value is None else f"{value:.6f}" for end, value in numbers.items()}


def _text(file: Path) -> str:
    return read_bytes(file, what="Table").decode("utf-8", errors="replace")


def _yes(value: bool) -> str:
    return "yes" if value else "no"


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
