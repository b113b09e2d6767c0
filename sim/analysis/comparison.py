"""Runs against runs: differences paired by episode, with bootstrap intervals over episodes.

Two agents that played the same episodes differ less by luck than their separate intervals say: the houses, goals and
starts are the same. So the difference is taken in each episode, and the mean of the differences is resampled.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim.errors import ConfigError
from sim.evaluation.results import bootstrap_interval, read_whole_lines
from sim.task.trajectory import read_trajectory, trajectory_file

Line = Mapping[str, Any]
Value = float | None
UNRESOLVED = "unresolved"
SAME_PATH_M = 0.05
"""The same way measured by two versions of the code may differ by a cell."""
MIN_PAIRS = 20
"""Fewer pairs resolve nothing: the bootstrap of a few values is too narrow, and of equal ones it has no width."""


@dataclass(frozen=True)
class Estimate:
    """A mean over episodes, or a mean difference, with its 95 % bootstrap interval; None where there is no episode."""

    mean: Value
    low: Value
    high: Value
    count: int
    """Episodes, or pairs of episodes, that have a value."""

    @property
    def resolved(self) -> bool:
        """For a difference: whether its interval leaves out 0, and there are `MIN_PAIRS` behind it."""
        if self.low is None or self.high is None or self.count < MIN_PAIRS:
            return False
        return not self.low <= 0.0 <= self.high


@dataclass(frozen=True)
class Run:
    """What one run's folder holds."""

    path: Path
    config: Mapping[str, Any]
    lines: Mapping[str, Line]
    """By `episode_id`."""


def estimate(values: Sequence[Value]) -> Estimate:
    """Mean and interval of the values that are there."""
    there = np.array([value for value in values if value is not None], dtype=float)
    low, high = bootstrap_interval(there)
    return Estimate(float(there.mean()) if len(there) else None, low, high, len(there))


def paired_difference(first: Sequence[Value], second: Sequence[Value]) -> Estimate:
    """Mean of second minus first, pair by pair, and its interval; a pair without one of the two does not count.

    Raises:
        ValueError: the two have different lengths.
    """
    pairs = [(a, b) for a, b in zip(first, second, strict=True) if a is not None and b is not None]
    return estimate([float(b) - float(a) for a, b in pairs])


def read_run(path: Path) -> Run:
    """The run in a folder.

    Raises:
        ConfigError: there is none, or its files are not what `sim.run` writes.
    """
    config, results = path / "config.json", path / "results.jsonl"
    for file in (config, results):
        if not file.is_file():
            raise ConfigError(f"'{path}' is no run: it has no {file.name}.")
    try:
        lines = read_whole_lines(results)
        return Run(path, json.loads(config.read_text(encoding="utf-8")), {line["episode_id"]: line for line in lines})
    except (ValueError, KeyError, TypeError) as error:
        raise ConfigError(f"'{path}' is no run: {error!r}.") from None


def code_of(run: Run, episode_id: str) -> str:
    """Hash of the code that played an episode: its trajectory's, else all that played in the run ("a1 or b2")."""
    file = trajectory_file(run.path, episode_id)
    if file.is_file():
        return str(read_trajectory(file).about.get("versions", {}).get("code", "unknown"))
    return " or ".join(run.config.get("codes") or [str(run.config.get("versions", {}).get("code", "unknown"))])


def require_same_episodes(first: Run, second: Run) -> list[str]:
    """Ids of the episodes that two runs share, in the first one's order.

    Episodes drawn in one house (`sim.run --house`) are called the same whatever the seed: so house, goal and shortest
    path must be the same as well, the path to `SAME_PATH_M` and only where neither episode broke.

    Raises:
        ConfigError: they were made on different splits, share no episode, or only share names of episodes.
    """
    identities = [run.config.get("split_identity", {}) for run in (first, second)]
    if identities[0] != identities[1]:
        told = " and ".join(f"{i.get('name')} {i.get('version')} ({str(i.get('sha256'))[:8]})" for i in identities)
        raise ConfigError(f"'{first.path}' and '{second.path}' were not played on the same episodes: {told}.")
    common = [episode_id for episode_id in first.lines if episode_id in second.lines]
    if not common:
        raise ConfigError(f"'{first.path}' and '{second.path}' have no episode in common.")
    for episode_id in common:
        a, b = first.lines[episode_id], second.lines[episode_id]
        for key in ("house", "goal", "shortest_path"):
            if not (_same_path(a, b) if key == "shortest_path" else a.get(key) == b.get(key)):
                raise ConfigError(
                    f"'{first.path}' and '{second.path}' were not played on the same episodes: '{episode_id}' has "
                    f"{key} {json.dumps(a.get(key))} and {json.dumps(b.get(key))}."
                )
    return common


def _same_path(first: Line, second: Line) -> bool:
    if "error" in (first.get("end_reason"), second.get("end_reason")):  # then it may not have been measured
        return True
    a_m, b_m = first.get("shortest_path"), second.get("shortest_path")
    return a_m == b_m if a_m is None or b_m is None else abs(a_m - b_m) <= SAME_PATH_M
