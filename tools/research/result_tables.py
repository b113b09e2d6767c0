"""Makes `docs/tables/*.csv`, paper.md and the tables of some pages of docs, from the archive of result lines.

    python -m tools.research.result_tables            # writes them
    python -m tools.research.result_tables --check    # exit status 1 where a file differs from what it would write
    python -m tools.research.result_tables --run --minutes 120 --workers 2    # runs missing episodes, and archives them

`results.csv` has one row for each agent with its options, split and segmentation, and `comparisons.csv` the paired
differences. `paper.md` has the tables of the paper (`stubborn reproduce all`), a verdict on each of its claims, and two
tables that ask why Table IV is not replicated; each table's differences are corrected as one family there. Shares are
between 0 and 1; `_low` and `_high` are the 95 % interval (`sim.app.evaluation.intervals`). In `comparisons.csv` the
column `family` names the primary comparisons of a table: `success_p_holm` and `spl_p_holm` are their p-values,
corrected by Holm's method for all primary comparisons of the table in both metrics. All others are exploratory, and
nothing is corrected for their number. `_replicates_sd` is the standard deviation that chance alone gives the mean over
one replicate of each episode (`stubborn run --replicates`). The tables of the pages in `PAGES` stand between
`<!-- table: NAME -->` and `<!-- end -->`. The sentences of these pages may quote only quantities with an interval, such
as `94.0 [89.1, 98.0]`, that are in the CSV files, in paper.md or in these tables, also with the opposite sign.

With --run, the folder --out receives the runs of the archive first, so that another machine continues where one
stopped. The archive then holds all runs of --out that are of its version of the splits. Rows with the network are in
fp32 without the mirror image of each frame; only a processor without bf16 instructions runs them so by default, and
others refuse to continue them.
"""

from __future__ import annotations

import re
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console

from sim.app import cli
from sim.app.analysis import display
from sim.app.analysis.comparison import require_same_episodes
from sim.app.analysis.metrics import (
    FIRST_SIGHT,
    SPL,
    SUCCESS,
    difference_cell,
    episodes_of,
    houses_of,
    mean_cell,
    median_text,
)
from sim.app.analysis.tables import to_markdown
from sim.app.commands.reproduce.paper_claims import MARGIN, JudgedTable, judged, overview
from sim.app.commands.reproduce.paper_tables import PAPER_TABLES, table_named
from sim.app.commands.reproduce.reproduce import Args as ReproduceArgs
from sim.app.commands.reproduce.reproduce import lines_of, make_table, part_of, shared_runs
from sim.app.commands.reproduce.runs import AgentSetup, RunKey, TableRun, folder_name, run_in_turns, runs_in
from sim.app.evaluation.intervals import Estimate, holm, replicate_spread
from sim.app.evaluation.summary import summarise
from sim.core.errors import ConfigError
from sim.core.files import csv_text, write_atomically, write_together
from sim.core.reading import read_bytes, read_text
from sim.core.reading import read_csv as read_table
from sim.episodes.splits import load_split
from sim.task.failures import CAUSES
from sim.task.result import EpisodeResult, Metric
from tools.research.paper_reasons import reasons
from tools.research.result_archive import (
    ARCHIVE,
    ROOT,
    TABLES,
    VERSION,
    VERSIONS,
    ArchivedRun,
    pack,
    read_archive,
    unpack,
)
from tools.research.result_definitions import (
    CHAINS,
    COMPARED,
    FAILED,
    GAINS,
    GOAL_GROUPS,
    MEANS,
    MEDIAN,
    PRIMARY_METRICS,
    Comparison,
    PageTable,
    RowKey,
    comparisons,
    needed_rows,
    page_tables,
)

Record = dict[str, str]
"""One row of a CSV file, by column."""
DOCS = ROOT / "docs"
PAGES = ("results.md", "stubborn_plus.md", "worlds.md", "traps.md", "words.md", "motions.md")
"""Pages with tables."""
RESULTS, COMPARISONS, PAPER, PUBLISHED = "results.csv", "comparisons.csv", "paper.md", "published_code.csv"
QUANTITY = re.compile(r"([-+]?\d[\d.]*)(?: (?:points|steps|%|of SPL|of success))? \[([-+]?\d[\d.]*), ([-+]?\d[\d.]*)\]")
"""A number with an interval in a sentence or table of a page."""
Quantity = tuple[str, str, str]
"""A mean and the ends of its interval, as they are written without a plus sign."""
INTERVAL = ("value", "low95", "high95")
"""Columns of published_code.csv."""
SPLIT_HASH = re.compile(r" \([0-9a-f]{8}\)")
CHUNK = 50
"""Episodes of a row before the next row's turn."""
PAPER_EPISODES = 100
"""The first episodes of val, as far as all runs of a table of the paper have them."""
MOTION_EPISODES = {"val": 100, "hazards": 50}
"""The first episodes of the splits that motions.md shows, as far as all agents have them with each motion."""
ABOUT_PAPER = f"""\
# The paper's tables

Columns that begin with *paper* are of Luo et al. (2022), from MP3D houses in Habitat; all others are measured here, in
generated houses (splits {VERSION}) with contacts. Compare orders and differences of agents, not the figures. `gt` is
ground-truth segmentation, `rednet` the network that shipped with these splits. `cloned`, a small end-to-end agent,
corresponds to the paper's EEAux and is not that agent.

`stubborn reproduce all --episodes {PAPER_EPISODES} --workers 2` measures these tables again, and resumes; each table
states its hours. Here, the network computed in fp32; on a processor with bf16 instructions, the command averages each
frame with its mirror image, so that rows with the network differ. `random`, `semexp` and `cloned` draw other random
numbers in each run; the commands in results.csv repeat those of a row (`--seed-key`). This page is made from the
[result lines]({ARCHIVE.name}) by `python -m tools.research.result_tables`.

## Verdicts

A claim is a difference between two agents that the paper reports. It is *replicated* if the difference here is
significant in the paper's direction (Holm's correction for the claims of its table), *not replicated* if it is not and
its interval excludes the paper's difference, and *unresolved* otherwise. A claim that an agent is *not higher* is
replicated if the interval ends below {100 * MARGIN:.0f} points, and not replicated if it begins above. The paper's own
intervals (6 points to each side in Table IV) are not used. A table has the worst verdict on its claims.

"""
ABOUT_REASONS = """\
## Why Table IV is not replicated

Differences with their intervals; *not significant* is meant after Holm's correction within each table. Exploratory: the
questions were asked after the verdicts were known. Episodes in which an agent was trapped are not a random sample.

"""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write the tables of results from the archive of result lines, or check them."""

    check: bool = False
    """Write nothing; the exit status is 1 where a file differs."""
    run: bool = False
    """Run missing episodes and write the archive only."""
    splits: tuple[str, ...] = ("val", "hazards", "large", "test", "contact-val", "contact-heldout")
    """With --run: splits whose rows are run; other runs of --out are archived, too."""
    minutes: cli.NotNegative | None = None
    """With --run: time limit; no chunk begins that would end later. 0 only archives the runs of --out."""
    workers: cli.Count = 1
    """With --run: number of processes."""
    out: cli.OutFolder = Path("runs/results")
    """With --run: folder of the runs; that of `stubborn reproduce` will do."""
    archive: Path = ARCHIVE
    """Archive of result lines."""
    tables: Path = TABLES
    """Folder of the CSV files."""
    docs: Path = DOCS
    """Folder of the pages."""


def main(args: Args) -> int:
    """Writes or checks the files; returns the exit status."""
    console = display.make_console()
    if args.run:
        return run_missing_rows(args, console)

    def say(text: str) -> None:
        console.print(text, soft_wrap=True)

    with tempfile.TemporaryDirectory() as folder:
        runs = read_archive(args.archive, Path(folder))
        results = [result_record(runs[key.run], key.episodes) for key in row_keys(runs)]
        pairs = list(comparisons())
        compared = with_families(pairs, [comparison_record(pair, runs) for pair in pairs])
        paper = paper_page(Path(folder), runs)
        others = other_tables(Path(folder), runs)
    filled = {
        args.docs / name: fill_page(read_text(args.docs / name, what="Page"), texts)
        for name, texts in tables_by_page(results, compared, others).items()
    }
    contents = {
        args.tables / RESULTS: to_csv(results),
        args.tables / COMPARISONS: to_csv(compared),
        args.tables / PAPER: paper,
        **filled,
    }
    texts = [paper, *(text for made in others.values() for text in made.values())]
    known = known_quantities(results, compared, read_csv(args.tables / PUBLISHED), texts)
    unknown = {page: unknown_quantities(text, known) for page, text in filled.items()}
    for page, text in ((page, text) for page, quoted in unknown.items() for text in quoted):
        say(f"'{page}' quotes {text}, which is in no CSV file and no table.")
    differing = [file for file, text in contents.items() if not file.is_file() or _text(file) != text]
    is_unknown = any(unknown.values())
    if args.check:
        for file in differing:
            say(f"'{file}' differs from the archive; `python -m tools.research.result_tables` writes it.")
        return int(bool(differing) or is_unknown)
    write_together(dict(contents))
    say(f"{len(results)} rows in {args.tables / RESULTS}, {len(compared)} in {args.tables / COMPARISONS}.")
    return int(is_unknown)


def run_missing_rows(args: Args, console: Console) -> int:
    """Runs the episodes that the tables lack and writes the archive; returns the exit status."""
    if args.archive.is_file():
        unpack(args.archive, args.out)
    folders = runs_in(args.out, *VERSIONS)
    most: dict[RunKey, int] = {}
    for row in sorted(needed_rows(), key=lambda row: row.run.split):
        if row.run.split in args.splits:
            most[row.run] = max(row.episodes, most.get(row.run, 0))
    runs = {key: table_run(args, key, episodes, folders) for key, episodes in most.items()}
    if args.minutes != 0.0:
        run_in_turns(list(runs.values()), CHUNK, args.minutes, console)
    folders = runs_in(args.out, *VERSIONS)
    write_atomically(args.archive, pack(folders))
    for key, run in runs.items():
        if len(run.results) < len(run.episodes):
            counts = f"{len(run.results)} of {len(run.episodes)} episodes"
            console.print(f"{key.split}: {key.setup.name}, {key.setup.semantics}: {counts}")
    console.print(f"{len(folders)} runs in {args.archive}")
    return 0


def table_run(args: Args, key: RunKey, episodes: int, folders: Mapping[RunKey, Path]) -> TableRun:
    """Returns the run of a row, in its folder if it has one.

    Raises:
        ConfigError: the split has another version now than the tables.
    """
    split, setup = load_split(key.split), key.setup
    if split.version != VERSION:
        raise ConfigError(f"'{key.split}' has version {split.version}, the tables {VERSION} (result_archive.py).")
    options = replace(
        setup.run_options(), split=key.split, episodes=episodes, workers=args.workers,
        out=folders.get(key, args.out / folder_name(setup, key.split)), keep_results=True,
    )  # fmt: skip
    return TableRun(options, split, split.episodes[:episodes])


def paper_page(folder: Path, runs: Mapping[RunKey, ArchivedRun]) -> str:
    """Returns the page of the paper's tables, docs/tables/paper.md.

    Args:
        folder: the unpacked archive; it receives the tables, too.
        runs: the runs in it.

    Raises:
        ConfigError: a run is missing.
    """
    part = part_of(ReproduceArgs(table="all", episodes=PAPER_EPISODES, minutes=0.0, out=folder))
    pages: list[str] = []
    claims: list[JudgedTable] = []
    for name in PAPER_TABLES:
        setups = table_named(name).setups()
        page = make_table(part, name, setups, Console(quiet=True))
        if page is None:
            raise ConfigError(f"'{ARCHIVE.name}' lacks a run of the paper's table '{name}'.")
        pages.append(page)
        claims += filter(None, [judged(name, lines_of(*shared_runs(part, setups)))])
    why = f"{ABOUT_REASONS}{to_markdown(reasons(runs))}\n## Tables\n\n"
    return f"{ABOUT_PAPER}{overview(claims)}\n{why}" + "\n".join(pages)


def other_tables(folder: Path, runs: Mapping[RunKey, ArchivedRun]) -> dict[str, dict[str, str]]:
    """Returns for each page its tables that are not made of rows of results.csv, as Markdown by name.

    Args:
        folder: the unpacked archive; it receives the tables of motions, too.
        runs: the runs in it.

    Raises:
        ConfigError: a run is missing.
    """
    return {"motions.md": motion_texts(folder), "words.md": {"chains": chains_text(runs)}}


def motion_texts(folder: Path) -> dict[str, str]:
    """Returns the tables of each split of motions.md, made from the unpacked archive in a folder.

    Raises:
        ConfigError: a run is missing.
    """
    texts = {}
    for split, episodes in MOTION_EPISODES.items():
        part = part_of(
            ReproduceArgs(table="motions", split=split, episodes=episodes, semantics="gt", minutes=0.0, out=folder)
        )
        text = make_table(part, "motions", table_named("motions").setups((), "gt"), Console(quiet=True))
        if text is None:
            raise ConfigError(f"'{ARCHIVE.name}' lacks a run of the tables of motions on {split}.")
        texts[f"motions-{split}"] = SPLIT_HASH.sub("", text)  # it reads like a commit
    return texts


def chains_text(runs: Mapping[RunKey, ArchivedRun]) -> str:
    """Returns the table of words.md with the goals of chains, by kind."""
    keeps, forgets = (summarise(runs[row.run].first_results(row.episodes))["goals"] for row in CHAINS)
    rows = []
    for group, label in GOAL_GROUPS.items():
        cells = (
            (keeps[group]["success"], SUCCESS),
            (keeps[group]["spl"], SPL),
            (forgets[group]["success"], SUCCESS),
            (forgets[group]["spl"], SPL),
        )
        texts = (_interval_text(metric, [cell["mean"], *cell["ci95"]]) for cell, metric in cells)
        rows.append((f"{label}, {keeps[group]['goals']}", *texts))
    header = ("goals", "success %", "SPL", "without memory: success %", "SPL")
    return _markdown(header, rows, labels=1)


def row_keys(runs: Mapping[RunKey, ArchivedRun]) -> list[RowKey]:
    """Returns the rows of results.csv in order: each run with all its episodes, and what the page's tables need.

    Raises:
        ConfigError: a table or comparison needs a run that the archive does not have.
    """
    for row in needed_rows():
        if row.run not in runs:
            raise ConfigError(
                f"The tables need a run of '{row.run.setup.label}' on {row.run.split}; the archive has none."
            )
    shown = {row for table in page_tables() for _, cells in table.rows for row, _ in cells}
    return sorted(shown | {RowKey(key, run.episodes) for key, run in runs.items()})


def result_record(run: ArchivedRun, episodes: int) -> Record:
    """Returns a row of results.csv, of the first episodes of a run."""
    lines = run.first_results(episodes)
    record = {**_identity(run.key), "ground_truth": _yes(run.uses_ground_truth), **_counts(lines)}
    for metric in MEANS:
        record |= _estimate_columns(metric, mean_cell(metric, lines).estimate)
    for metric in PRIMARY_METRICS:
        spread = replicate_spread(list(map(metric.value, lines)), episodes_of(lines))
        record[f"{metric.key}_replicates_sd"] = "" if spread is None else f"{spread:.6f}"
    record[MEDIAN] = median_text(FIRST_SIGHT, lines)
    failed = Counter(result.failure for result in lines if not result.success)
    record |= {f"{FAILED}{cause}": str(failed[cause]) for cause in CAUSES}
    config = run.run.config
    versions, split = config.get("versions", {}), run.run.recorded("split_identity")
    return record | {
        "package": versions.get("stubborn-objectnav", ""),
        "mujoco": versions.get("mujoco", ""),
        "split_sha256": split["sha256"][:8],
        "code": run.codes,
        "network": run.network,
        "command": run.command(episodes),
    }


def comparison_record(pair: Comparison, runs: Mapping[RunKey, ArchivedRun]) -> Record:
    """Returns a row of comparisons.csv without its family; raises ConfigError like `paired_lines`."""
    first, second = paired_lines(pair, runs)
    minus = {
        f"minus_{name}": value for name, value in _identity(pair.second.run).items() if name not in ("split", "version")
    }
    record = {"table": pair.table, **_identity(pair.first.run), **minus, **_counts(first)}
    for metric in COMPARED:
        value = difference_cell(metric, second, first).estimate
        record |= _estimate_columns(metric, value) | {f"{metric.key}_significant": _yes(value.significant)}
        if metric in PRIMARY_METRICS:
            record |= {f"{metric.key}_p": f"{1.0 if value.p is None else value.p:.6f}", f"{metric.key}_p_holm": ""}
    outcomes = [(bool(a.success), bool(b.success)) for a, b in zip(first, second, strict=True)]
    return record | {
        "only_first_succeeds": str(outcomes.count((True, False))),
        "only_second_succeeds": str(outcomes.count((False, True))),
    }


def paired_lines(
    pair: Comparison, runs: Mapping[RunKey, ArchivedRun]
) -> tuple[list[EpisodeResult], list[EpisodeResult]]:
    """Returns the lines of the episodes of both runs, in the same order.

    Raises:
        ConfigError: the runs are of different episodes.
    """
    rows = (pair.first, pair.second)
    shared = set(require_same_episodes(*(runs[row.run].run for row in rows)))
    first, second = (
        [result for result in runs[row.run].first_results(row.episodes) if result.episode_id in shared] for row in rows
    )
    return first, second


def with_families(pairs: Sequence[Comparison], records: Sequence[Record]) -> list[Record]:
    """Returns rows of comparisons.csv with their family, and the corrected p-values of primary ones."""
    classified = [
        {"table": record["table"], "family": "primary" if pair.primary else "exploratory", **record}
        for pair, record in zip(pairs, records, strict=True)
    ]
    columns = [f"{metric.key}_p" for metric in PRIMARY_METRICS]
    for table in {pair.table for pair in pairs}:
        family = [record for record in classified if record["table"] == table and record["family"] == "primary"]
        corrected = iter(holm([float(record[column]) for record in family for column in columns]))
        for record in family:
            record |= {f"{column}_holm": f"{next(corrected):.6f}" for column in columns}
    return classified


def tables_by_page(
    results: Sequence[Record], compared: Sequence[Record], others: Mapping[str, Mapping[str, str]]
) -> dict[str, dict[str, str]]:
    """Returns for each page its tables as Markdown by name.

    Args:
        results: the rows of results.csv.
        compared: the rows of comparisons.csv.
        others: for each page the tables that are not made of such rows.
    """
    rows = {(*(record[name] for name in _identity_names()), record["episodes"]): record for record in results}

    def record_of(key: RowKey) -> Record:
        return rows[(*_identity(key.run).values(), str(key.episodes))]

    texts = {page: dict(others.get(page, {})) for page in PAGES}
    for table in page_tables():
        texts[table.page][table.name] = table_text(table, record_of)
    texts["stubborn_plus.md"]["gains"] = gains_text(compared)
    return texts


def gains_text(compared: Iterable[Record]) -> str:
    """Returns the table of stubborn_plus.md: the primary comparisons with `stubborn`, by segmentation and split."""
    rows = []
    for semantics, label in (("gt", "truth"), ("rednet", "network")):
        for record in compared:
            if record["table"] in GAINS and record["family"] == "primary" and record["semantics"] == semantics:
                cells = (
                    text
                    for metric in PRIMARY_METRICS
                    for text in (cell_text(record, metric), _p_text(float(record[f"{metric.key}_p_holm"])))
                )
                rows.append((f"{record['split']}, {record['episodes']}", label, *cells))
    header = ("split, episodes", "segmentation", "gain in success, points", "corrected p", "gain in SPL", "corrected p")
    return _markdown(header, rows, labels=2)


def fill_page(page: str, texts: Mapping[str, str]) -> str:
    """Returns a page with its tables.

    Args:
        page: the page.
        texts: its tables as Markdown by name.

    Raises:
        ConfigError: the page lacks the marks of a table.
    """
    for name, shown in texts.items():
        marks = re.compile(rf"(<!-- table: {name} -->\n).*?(<!-- end -->)", re.DOTALL)
        if len(marks.findall(page)) != 1:
            raise ConfigError(f"The page needs one '<!-- table: {name} -->' with an '<!-- end -->' after it.")
        page = marks.sub(lambda match, shown=shown: f"{match[1]}\n{shown}\n{match[2]}", page)
    return page


def table_text(table: PageTable, record_of: Callable[[RowKey], Record]) -> str:
    """Returns a table as Markdown."""
    rows = [(*labels, *(cell_text(record_of(key), column) for key, column in cells)) for labels, cells in table.rows]
    return _markdown(table.header, rows, labels=len(table.rows[0][0]))


def _p_text(p: float) -> str:
    return f"{p:.3f}" if p >= 0.001 else "< 0.001"


def _markdown(header: Sequence[str], rows: Iterable[Sequence[str]], *, labels: int) -> str:
    """Returns a table whose first columns are labels and whose others are numbers."""
    rule = ["---"] * labels + ["--:"] * (len(header) - labels)
    return "".join(f"|{'|'.join(line)}|\n" for line in (header, rule, *rows))


def cell_text(record: Record, column: Metric | str, *, sign: str = "") -> str:
    """Returns a cell of the page, such as `94.0 [89.1, 98.0]`; a column without an interval as it is."""
    if isinstance(column, str):
        return record[column]
    numbers = [record[f"{column.key}{end}"] for end in ("", "_low", "_high")]
    return "-" if "" in numbers else _interval_text(column, list(map(float, numbers)), sign=sign)


def _interval_text(metric: Metric, numbers: Sequence[float], *, sign: str = "") -> str:
    """Returns a mean and the ends of its interval as text."""
    factor = 100.0 if metric.percent else 1.0
    mean, low, high = (f"{factor * number:{sign}.{metric.digits}f}" for number in numbers)
    return f"{mean} [{low}, {high}]"


def known_quantities(
    results: Iterable[Record], compared: Iterable[Record], published: Iterable[Record], tables: Iterable[str]
) -> set[Quantity]:
    """Returns the quantities with an interval that a page may quote; those of differences also with the opposite sign.

    Args:
        results: rows of results.csv.
        compared: rows of comparisons.csv.
        published: rows of published_code.csv.
        tables: texts with other tables that were made, such as those of motions.
    """
    cells = [cell_text(record, metric) for record in results for metric in MEANS]
    cells += [cell_text(record, metric) for record in compared for metric in COMPARED]
    cells += tables
    for record in published:
        numbers = [(100.0 if "%" in record["metric"] else 1.0) * float(record[end]) for end in INTERVAL if record[end]]
        if len(numbers) == len(INTERVAL):
            cells += [f"{numbers[0]:.{d}f} [{numbers[1]:.{d}f}, {numbers[2]:.{d}f}]" for d in (1, 3)]
    known = _quantities(" ".join(cells))
    return known | {(_opposite(mean), _opposite(high), _opposite(low)) for mean, low, high in known}


def unknown_quantities(page: str, known: Container[Quantity]) -> list[str]:
    """Returns the quantities with an interval that a page quotes and that are not known."""
    quoted = _quantities(" ".join(page.split()))
    return sorted(f"{mean} [{low}, {high}]" for mean, low, high in quoted if (mean, low, high) not in known)


def _quantities(text: str) -> set[Quantity]:
    found = ((match[i].removeprefix("+") for i in (1, 2, 3)) for match in QUANTITY.finditer(text))
    return {(mean, low, high) for mean, low, high in found}


def _opposite(number: str) -> str:
    return number[1:] if number.startswith("-") else f"-{number}"


def to_csv(records: Sequence[Record]) -> str:
    """Returns CSV text."""
    return csv_text(list(records[0]), (record.values() for record in records))


def read_csv(file: Path) -> list[Record]:
    """Returns the rows of a CSV file."""
    return [dict(record) for record in read_table(file, what="Table")]


def _identity(key: RunKey) -> Record:
    return {
        "split": key.split,
        "version": key.version,
        "agent": key.setup.agent,
        "options": key.setup.options,
        "semantics": key.setup.semantics,
    }


def _identity_names() -> Iterator[str]:
    yield from _identity(RunKey("", AgentSetup("", "", ""), ""))


def _counts(lines: Sequence[EpisodeResult]) -> Record:
    return {"episodes": str(len(set(episodes_of(lines)))), "houses": str(len(set(houses_of(lines))))}


def _estimate_columns(metric: Metric, estimated: Estimate) -> Record:
    numbers = {"": estimated.mean, "_low": estimated.low, "_high": estimated.high}
    return {f"{metric.key}{end}": "" if value is None else f"{value:.6f}" for end, value in numbers.items()}


def _text(file: Path) -> str:
    return read_bytes(file, what="Table").decode("utf-8", errors="replace")


def _yes(value: bool) -> str:
    return "yes" if value else "no"


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
