"""The table of a leaderboard: a row for each verified submission of a folder.

FOLDER/submissions/NAME.json.gz     one file for each row, as `stubborn submit` writes it
FOLDER/reports/NAME.json            the outcome of its verification, written by `stubborn leaderboard` and never read
FOLDER/table.md, FOLDER/table.csv   written by `stubborn leaderboard`
"""

from __future__ import annotations

import html
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from sim.app.analysis.metrics import COLLISIONS, SPL, SUCCESS, episodes_of, mean_cell
from sim.app.analysis.tables import Cell, ResultTable
from sim.app.submissions.checks import isolation_text, truth_of
from sim.app.submissions.contents import SUFFIX, Submission
from sim.app.submissions.report import Report
from sim.app.submissions.sealing import Origin
from sim.core.errors import ConfigError
from sim.core.files import csv_text
from sim.core.vocabulary import counted
from sim.task.result import EpisodeResult

MIN_EPISODES = 50
"""Least number of episodes of a row; replicates do not count. In 20, the interval of a success of 65 % is 42 points."""
_FILE_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]*")
SUBMISSIONS, REPORTS = "submissions", "reports"
HEADER = (
    "row", "authors", "ground truth (declared)", "own process (declared)", "noise", "episodes", "success %", "SPL",
    "collisions", "verified", "known paths",
)  # fmt: skip

CSV_COLUMNS = (
    "split", "version", "split_sha256", "name", "authors", "links", "agent", "ground_truth_declared",
    "own_process_declared", "noise", "episodes", "success", "success_low", "success_high", "spl", "spl_low", "spl_high",
    "collisions", "collisions_low", "collisions_high", "verified", "origin", "oracle_paths", "shortest_paths",
    "repeated", "file",
)  # fmt: skip


@dataclass(frozen=True)
class Row:
    """One submission of a leaderboard with the outcome of its verification."""

    file: Path
    submission: Submission
    report: Report
    shipped: frozenset[str]
    """Names of the agents that ship with the simulator, and of a person."""

    @property
    def episodes(self) -> int:
        """The number of episodes; replicates are not counted."""
        return number_of_episodes(self.submission)

    @property
    def refusal(self) -> str:
        """The reason why the table has no such row; "": the submission is accepted."""
        if self.report.different:
            return f"{counted(self.report.different, 'episode')} differed in the replay"
        return refusal_before_replay(self.submission, self.report.is_first, self.report.nonstandard, self.shipped)


def refusal_before_replay(
    submission: Submission, is_first: bool, nonstandard: Sequence[str], shipped: Collection[str]
) -> str:
    """Returns the reason why a submission is refused whatever its replay shows; "": it is not refused.

    Args:
        submission: from a file.
        is_first: whether its episodes are the first ones of the split.
        nonstandard: how its setting is different from the standard.
        shipped: names of the agents that ship with the simulator, and of a person.
    """
    if not is_first:
        return "its episodes were chosen by the authors; the first ones of the split are allowed"
    episodes = number_of_episodes(submission)
    if episodes < MIN_EPISODES:
        return f"it has {episodes} episodes; a row needs {MIN_EPISODES}"
    if nonstandard:
        return f"not the standard: {nonstandard[0]}"
    manifest = submission.manifest
    agent = manifest.inputs.agent.partition("+")[0]  # "human+stubborn": a person and an agent
    if agent not in shipped and not manifest.inputs.isolated:
        return "its agent did not run in a process of its own (--agent process:COMMAND)"
    named = next((name for name in shipped if _letters(name) == _letters(manifest.name)), agent)
    if named != agent:
        return f"its name is that of the shipped agent '{named}', and its agent is '{manifest.inputs.agent}'"
    return ""


def number_of_episodes(submission: Submission) -> int:
    """Returns the number of episodes of a submission; replicates are not counted."""
    return len(set(episodes_of(results_of(submission))))


def submission_files(folder: Path) -> list[Path]:
    """Returns the files of the submissions in a folder of a leaderboard, by name.

    Raises:
        ConfigError: there is none, or one has a name that a spreadsheet or a terminal could interpret.
    """
    files = sorted((folder / SUBMISSIONS).glob(f"*{SUFFIX}"))
    odd = next((file.name for file in files if not _FILE_NAME.fullmatch(file.name)), None)
    if odd is not None:
        raise ConfigError(
            f"'{folder / SUBMISSIONS}': the file name '{odd}' is not allowed; use A-Z, a-z, 0-9, '_', '-' and '.'."
        )
    if not files:
        raise ConfigError(f"'{folder / SUBMISSIONS}' holds no submission (*{SUFFIX}); `stubborn submit` writes one.")
    return files


def report_file(folder: Path, submission: Path) -> Path:
    """Returns the file of the report on a submission."""
    return folder / REPORTS / f"{submission.name.removesuffix(SUFFIX)}.json"


def without_copies(rows: Sequence[Row]) -> tuple[list[Row], list[str]]:
    """Returns the rows without those whose content is that of an earlier one, and a phrase for each of these."""
    first: dict[bytes, Row] = {}
    copies = []
    for row in rows:
        earlier = first.setdefault(msgspec.json.encode(row.submission), row)
        if earlier is not row:
            copies.append(f"{row.file.name}: its content is that of {earlier.file.name}")
    return list(first.values()), copies


def tables(rows: Sequence[Row]) -> list[ResultTable]:
    """Returns a table for each split, of rows that are not refused; sealed splits come before public ones.

    In a table, rows with less ground truth come first, then those with more success.
    """
    ranked = []
    repeats = repeated(rows)
    by_split: dict[tuple[int, str, str, str], list[Row]] = {}
    for row in rows:
        by_split.setdefault((_ORDER.index(row.report.origin), *_split(row)), []).append(row)
    for (number, name, version, sha256), members in sorted(by_split.items()):
        origin = _ORDER[number]
        title = f"{_TITLES[origin]}: {plain(name)} {plain(version)} ({sha256[:12]})"
        ordered = sorted(members, key=_rank)
        cells = [(_name(row), _cells(row, repeats[row.file.name])) for row in ordered]
        ranked.append(ResultTable(name, title, HEADER, cells, (*NOTES, _MEANINGS[origin])))
    return ranked


def repeated(rows: Sequence[Row]) -> dict[str, int]:
    """Returns for the file name of each row the number of its episodes with the actions of another row.

    Episodes of fewer than `LONG_ACTIONS` actions do not count.
    """
    owners: dict[tuple[str, str, str], set[str]] = {}
    keys: dict[str, list[tuple[str, str, str]]] = {}
    for row in rows:
        sha256 = row.submission.manifest.split.sha256
        keys[row.file.name] = [
            (sha256, entry.result.episode_id, entry.actions)
            for entry in row.submission.episodes
            if len(entry.actions) >= LONG_ACTIONS
        ]
        for key in keys[row.file.name]:
            owners.setdefault(key, set()).add(row.file.name)
    return {name: sum(len(owners[key]) > 1 for key in of_row) for name, of_row in keys.items()}


LONG_ACTIONS = 20
"""Two agents may well choose the same actions in an episode that is shorter."""
_ORDER: tuple[Origin, ...] = ("organiser", "beacon", "authors", "private", "public")
_TITLES: Mapping[Origin, str] = {
    "organiser": "Sealed by an organiser",
    "beacon": "Sealed by a later hash",
    "authors": "Sealed by the authors alone",
    "private": "Not public, not sealed",
    "public": "Public",
}
_MEANINGS: Mapping[Origin, str] = {
    "organiser": "An organiser made the houses from a secret and ran the agents, which could not know them.",
    "beacon": "The houses come from a hash, made by others, that did not exist when the agent was frozen.",
    "authors": "The houses come from a later commit that the authors could choose: no third party drew them.",
    "private": "It is not known who saw these houses before the run.",
    "public": (
        "Houses and episodes are public. A replay proves what the actions achieve, and not that the agent searched: "
        "one that repeats stored actions gets the same row. Sealed rows count."
    ),
}
NOTES = (
    "Verified: every row's actions were replayed, and lead to its success, SPL and collisions; an episode that ended "
    "with an error counts as a failure, without collisions. Intervals of 95 % are over houses. Authors, agent, ground "
    "truth and own process are what the authors declare; no agent is run again.",
    "Known paths: episodes in which every action is the oracle's + further successes on a path at most 5 % longer than "
    "the shortest one + episodes of 20 actions and more with exactly the actions of another row.",
)


def csv_of(rows: Sequence[Row]) -> str:
    """Returns the rows as CSV; shares are not in percent."""
    repeats, table = repeated(rows), list[Sequence[object]]()
    for row in sorted(rows, key=lambda row: (_split(row), _rank(row))):
        manifest, lines = row.submission.manifest, results_of(row.submission)
        estimates = [mean_cell(metric, lines).estimate for metric in (SUCCESS, SPL, COLLISIONS)]
        numbers = (n for estimate in estimates for n in (estimate.mean, estimate.low, estimate.high))
        table.append([
            *_split(row), manifest.name, "; ".join(manifest.authors), " ".join(manifest.links), manifest.inputs.agent,
            truth_of(manifest.inputs), isolation_text(manifest.inputs), manifest.inputs.noise, row.episodes,
            *("" if n is None else round(n, 6) for n in numbers), _verified(row), row.report.origin,
            row.report.oracle_paths, row.report.shortest_paths, repeats[row.file.name], row.file.name,
        ])  # fmt: skip
    return csv_text(CSV_COLUMNS, table, end="\r\n")


def results_of(submission: Submission) -> list[EpisodeResult]:
    """Returns the results of a submission."""
    return [entry.result for entry in submission.episodes]


def _cells(row: Row, repeats: int) -> list[Cell | str]:
    manifest, lines = row.submission.manifest, results_of(row.submission)
    return [
        plain(", ".join(manifest.authors)),
        truth_of(manifest.inputs),
        plain(_process(row)),
        plain(manifest.inputs.noise),
        str(row.episodes),
        *(mean_cell(metric, lines) for metric in (SUCCESS, SPL, COLLISIONS)),
        _verified(row),
        f"{row.report.oracle_paths} + {row.report.shortest_paths} + {repeats}",
    ]


def _process(row: Row) -> str:
    """Returns whether the agent ran in a process of its own, else the name of the shipped agent that is declared."""
    inputs = row.submission.manifest.inputs
    return isolation_text(inputs) if inputs.isolated else f"no, {inputs.agent}"


def _letters(name: str) -> str:
    """Returns the letters and digits of a name in lower case."""
    return "".join(filter(str.isalnum, name.lower()))


def _verified(row: Row) -> str:
    exactly = "equal" if not row.report.within_tolerance else f"to {100 * row.report.tolerance_m:g} cm"
    errors = row.report.errors
    return f"{exactly}, {errors} of {row.report.episodes} ended with an error" if errors else exactly


def _split(row: Row) -> tuple[str, str, str]:
    split = row.submission.manifest.split
    return split.name, split.version, split.sha256


def _name(row: Row) -> str:
    manifest = row.submission.manifest
    text = plain(manifest.name)
    return f"[{text}]({manifest.links[0]})" if manifest.links else text


def _rank(row: Row) -> tuple[int, str, float, str]:
    inputs, lines = row.submission.manifest.inputs, results_of(row.submission)
    success = sum(result.success for result in lines) / len(lines)
    return ("none", "noisy", "yes").index(truth_of(inputs)), inputs.noise, -success, row.file.name


def plain(text: str) -> str:
    """Returns text of somebody else for a Markdown page, where it is shown as it is: no link, HTML or emphasis."""
    return re.sub(r"([\\`*_\[\]()!#~])", r"\\\1", html.escape(text, quote=False))
