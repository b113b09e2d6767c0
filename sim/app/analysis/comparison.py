"""Reads runs, checks that they have the same episodes, and compares their results and their configurations.

Two agents that ran the same episodes differ less by chance than their separate intervals suggest: houses, goals and
starts are the same. So differences are taken in each episode (`sim.app.evaluation.intervals.paired_difference`).
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim.app.analysis.metrics import difference_cell, difference_note, episodes_of, mean_cell
from sim.app.analysis.tables import ResultTable
from sim.app.evaluation.config_fields import ABSENT, field_text, run_differences
from sim.app.evaluation.intervals import MIN_PAIRS
from sim.app.evaluation.results import RunRecord, read_record, read_results
from sim.core.errors import ConfigError
from sim.core.vocabulary import counted
from sim.task.result import EpisodeResult, metrics_for
from sim.task.trajectory import read_trajectory, trajectory_file

LETTERS = "ABCDEFGHIJKL"
"""Names of the runs that are compared, the first one `A`."""
SAME_PATH_M = 0.05
"""Largest difference of the same shortest path measured by two versions of the code: one cell."""
MAX_LACKING = 5
"""A part of the configuration has a row for each field that not all runs have, up to this number of fields."""


@dataclass(frozen=True)
class Run:
    """The content of a run's folder."""

    path: Path
    config: RunRecord
    results: Mapping[str, EpisodeResult]
    """Results by `episode_id`."""

    def recorded(self, name: str) -> Any:
        """Returns a field of config.json; raises ConfigError if a run of an older version does not have it."""
        value = self.config.get(name)
        if value is None:
            raise ConfigError(f"'{self.path / 'config.json'}' has no field '{name}', which this command needs.")
        return value


def read_run(path: Path) -> Run:
    """Returns the run in a folder.

    Raises:
        ConfigError: the folder has no run, or its files do not have the format of `stubborn run`.
    """
    config, results = path / "config.json", path / "results.jsonl"
    for file in (config, results):
        if not file.is_file():
            raise ConfigError(f"'{path}' is not a run: it has no {file.name}.")
    try:
        record, lines = read_record(config), read_results(results).values
    except ConfigError as error:
        raise ConfigError(f"'{path}' is not a run: {error}") from None
    return Run(path, record, {result.episode_id: result for result in lines})


def code_of(run: Run, episode_id: str) -> str:
    """Returns the hash of the code that ran an episode (its trajectory's), or all hashes of the run ("a1 or b2")."""
    file = trajectory_file(run.path, episode_id)
    if file.is_file():
        recording = read_trajectory(file).about
        return "unknown" if recording is None else recording.versions.get("code", "unknown")
    return " or ".join(run.config.get("codes") or [str(run.config.get("versions", {}).get("code", "unknown"))])


def compare(first: Run, second: Run) -> ResultTable:
    """Returns the means of two runs and their paired differences, one row per metric.

    Raises:
        ConfigError: the runs are of different splits, or share no episode.
    """
    common = require_same_episodes(first, second)
    a, b = ([of.results[i] for i in common] for of in (first, second))
    episodes = len(set(episodes_of(a)))
    against = {metric: difference_cell(metric, a, b) for metric in metrics_for([*a, *b])}
    rows = [(metric.title, [mean_cell(metric, a), mean_cell(metric, b), cell]) for metric, cell in against.items()]
    changed = [i for i in common if first.results[i].success != second.results[i].success]
    notes = [
        f"A: {first.path}, B: {second.path}; {counted(episodes, 'episode')} of both runs.",
        f"not significant: the interval contains 0, or there are fewer than {MIN_PAIRS} pairs.",
    ]
    errors = [sum(result.is_error for result in results) for results in (a, b)]
    if any(errors):
        notes.append(
            f"Ended with an error: {errors[0]} of A, {errors[1]} of B; they are failures, and other metrics omit them."
        )
    if note := difference_note(a, b):
        notes.append(note)
    broken = [x.is_error or y.is_error for x, y in zip(a, b, strict=True)]
    whole = {episode for episode, is_broken in zip(episodes_of(a), broken, strict=True) if not is_broken}
    pairs = {metric.title: cell.estimate.count for metric, cell in against.items()}
    fewer = [f"{title} {count}" for title, count in pairs.items() if count < len(whole)]
    if fewer:
        notes.append(f"Differences of fewer episodes, because the others have no value: {', '.join(fewer)}.")
    if changed:
        lost = [i for i in changed if first.results[i].success > second.results[i].success]
        gained = [i for i in changed if first.results[i].success < second.results[i].success]
        chains = any(result.goals is not None for result in a)
        for name, won in (("A", lost), ("B", gained)):
            start = f"{name} reaches more goals in" if chains else f"Only {name} succeeds in"
            notes.append(f"{start} {counted(len(won), 'episode')}: {' '.join(won)}." if won else f"{start} no episode.")
    title = f"B - A, paired over {episodes} episodes"
    return ResultTable("comparison", title, ("metric", "A", "B", "B - A"), rows, notes)


def differences_table(first: Run, *others: Run) -> ResultTable:
    """Returns a table of the fields of config.json in which runs, A, B and so on, differ from the first one.

    Two agents may have no field in common: many fields of one part that only some of the runs have are one row.
    """
    values: dict[str, list[str]] = {}
    for number, other in enumerate(others, start=1):
        for path, a, b in run_differences(first.config, other.config):
            values.setdefault(path, [_short_text(a)] * (1 + len(others)))[number] = _short_text(b)
    notes = () if values else ("The configurations are equal.",)
    header = ("field", *LETTERS[: 1 + len(others)])
    return ResultTable("fields", "Fields in which the runs differ", header, sorted(_counted(values).items()), notes)


def _counted(values: Mapping[str, list[str]]) -> dict[str, list[str]]:
    """Returns the rows of `differences_table` with the fields of each large part that not all runs have as one row."""
    lacking: dict[str, list[str]] = {}
    for path, texts in values.items():
        if ABSENT.value in texts:
            top, *inner = path.split(".")
            lacking.setdefault(f"{top}.{inner[0]}" if top == "config" and inner else top, []).append(path)
    rows = dict(values)
    for part, paths in lacking.items():
        if len(paths) > MAX_LACKING:
            texts = [rows.pop(path) for path in paths]
            counts = [sum(text != ABSENT.value for text in of_run) for of_run in zip(*texts, strict=True)]
            rows[f"{part}: fields of some runs only"] = [f"{count} fields" for count in counts]
    return rows


def _short_text(value: object) -> str:
    """Returns a value as JSON; for an object that the other run does not have, only its number of fields."""
    return f"{len(value)} fields" if isinstance(value, Mapping) else field_text(value)


def require_same_episodes(first: Run, *others: Run) -> list[str]:
    """Returns the ids of the episodes that all runs share, in the order of the first run.

    Episodes sampled in one house (`stubborn run --house`) have the same ids for every seed. So house, goal and shortest
    path must also be equal; the path to `SAME_PATH_M`, and only where no episode ended with an error or is a chain.

    Raises:
        ConfigError: a run is of another split than the first, shares no episode with it, or shares only ids of
            episodes; or no episode is in all runs.
    """
    common = list(first.results)
    for other in others:
        shared = set(_shared_episodes(first, other))
        common = [episode_id for episode_id in common if episode_id in shared]
    if not common:
        raise ConfigError(f"No episode is in all of the {1 + len(others)} runs.")
    return common


def _shared_episodes(first: Run, second: Run) -> list[str]:
    """Returns the episodes of two runs; see `require_same_episodes`."""
    identities = [run.config.get("split_identity") or {} for run in (first, second)]
    if identities[0] != identities[1]:
        named = " and ".join(f"{i.get('name')} {i.get('version')} ({str(i.get('sha256'))[:8]})" for i in identities)
        raise ConfigError(f"'{first.path}' and '{second.path}' were not run on the same episodes: {named}.")
    common = [episode_id for episode_id in first.results if episode_id in second.results]
    keys = ("house", "goal", "shortest_path") if _same_paths_expected(first, second) else ("house", "goal")
    if not common:
        raise ConfigError(f"'{first.path}' and '{second.path}' have no episode in common.")
    for episode_id in common:
        a, b = first.results[episode_id], second.results[episode_id]
        for key in keys:
            one, other = getattr(a, key), getattr(b, key)
            if not (_same_path(a, b) if key == "shortest_path" else one == other):
                raise ConfigError(
                    f"'{first.path}' and '{second.path}' were not run on the same episodes: '{episode_id}' has "
                    f"{key} {json.dumps(one)} and {json.dumps(other)}."
                )
    return common


def _same_paths_expected(first: Run, second: Run) -> bool:
    """Returns False for runs with another success rule or robot, in which the same start has another shortest path."""
    trees = [run.config.get("config", {}) for run in (first, second)]
    drawn = [[run.config.get(key) for key in ("house", "seed", "start_deg")] for run in (first, second)]
    same_starts = drawn[0][0] is None or drawn[0] == drawn[1]  # those of a split do not depend on the seed
    differs = any(trees[0].get(part) != trees[1].get(part) for part in ("task", "robot", "camera"))
    return not (same_starts and all(trees) and differs)  # a run without a tree is older than the choice of a rule


def _same_path(first: EpisodeResult, second: EpisodeResult) -> bool:
    if first.is_error or second.is_error:  # the path may not have been measured
        return True
    if first.goals is not None and second.goals is not None:  # the path to each goal begins where the robot was
        return True
    a_m, b_m = first.shortest_path, second.shortest_path
    return a_m == b_m if a_m is None or b_m is None else abs(a_m - b_m) <= SAME_PATH_M
