"""The files of a run: `config.json`, `results.jsonl` (a line an episode) and `summary.json`.

A line is written and flushed as its episode ends, by one process. A run that was killed leaves at most one broken
line at the end, which is dropped when the run goes on.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np

from sim.errors import ConfigError

SUMMARY_METRICS = ("success", "spl", "soft_spl", "distance_to_goal", "gt_explored", "trapped", "collisions")
"""Metrics of a result line that the summary averages."""
BOOTSTRAP_RESAMPLES = 10_000
PLACES = ("executor", "address", "shard")
"""Options that say where episodes are played, which changes no result."""
WATCHED = ("video", "view", "rerun", "rerun_save")
"""Options that let somebody look on, which changes no result."""
NOT_COMPARED = frozenset({"workers", "out", "versions", "codes", "episodes", "record", *PLACES, *WATCHED})
"""Entries of the config in which a resumed run may differ; with more episodes it goes on to them."""


@dataclass
class RunDirectory:
    """One run's folder, locked against a second writer while it is open."""

    path: Path
    config: Mapping[str, Any]

    def __post_init__(self) -> None:
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._lock: IO[str] = (self.path / ".lock").open("w")
        except OSError as error:
            raise ConfigError(f"Cannot write to --out '{self.path}': {error.strerror}.") from None
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise ConfigError(f"Another process is writing to --out '{self.path}'.") from None
        self._write_or_compare_config()
        self.lines: list[dict[str, Any]] = read_whole_lines(self.path / "results.jsonl", mend=True)
        self._results = (self.path / "results.jsonl").open("a", encoding="utf-8")

    def append(self, line: Mapping[str, Any]) -> None:
        """Write one result and make sure that it is on disk."""
        self._results.write(json.dumps(line, allow_nan=False) + "\n")
        self._results.flush()
        os.fsync(self._results.fileno())
        self.lines.append(dict(line))

    def played_by(self, code: str) -> list[str]:
        """Note under `codes` in config.json that this code plays from here on.

        Returns:
            the other hashes of code that played the lines there are, the oldest first.
        """
        file = self.path / "config.json"
        there = json.loads(file.read_text(encoding="utf-8"))
        begun_by = there.get("versions", {}).get("code", "unknown")
        codes = there.get("codes", [begun_by]) if self.lines else []
        if code not in codes:
            codes = [*codes, code]
        if codes != there.get("codes"):
            _write_json(file, there | {"codes": codes})
        return [other for other in codes if other != code]

    def write_summary(self, extra: Mapping[str, Any]) -> dict[str, Any]:
        """Average all lines, write `summary.json` and return it."""
        summary = {**extra, **summarise(self.lines)}
        _write_json(self.path / "summary.json", summary)
        return summary

    def close(self) -> None:
        """Let go of the folder."""
        self._results.close()
        self._lock.close()

    def _write_or_compare_config(self) -> None:
        file = self.path / "config.json"
        wanted = json.loads(json.dumps(dict(self.config)))
        if not file.exists():
            if (self.path / "results.jsonl").exists():
                raise ConfigError(f"--out '{self.path}' has results but no config.json; take another folder.")
            _write_json(file, wanted)
            return
        try:
            there = json.loads(file.read_text(encoding="utf-8"))
        except ValueError:
            raise ConfigError(
                f"--out '{self.path}' holds a config.json that is not JSON; take another folder."
            ) from None
        for key in sorted((set(there) | set(wanted)) - NOT_COMPARED):
            if there.get(key) != wanted.get(key):
                raise ConfigError(
                    f"--out '{self.path}' holds a run with {key} = {json.dumps(there.get(key))}, this one has "
                    f"{json.dumps(wanted.get(key))}; take another folder, or the same options to go on."
                )
        if (wanted.get("episodes") or 0) > (there.get("episodes") or 0):
            _write_json(file, there | {"episodes": wanted["episodes"]})


def summarise(lines: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Number of episodes and, for each of `SUMMARY_METRICS`, mean and 95 % bootstrap interval over episodes.

    Also how many episodes failed by which cause (`sim.task.failures`), the most frequent first.
    Episodes in which a metric is null (no way to the goal) do not count for that metric.
    """
    lines = list(lines)
    summary: dict[str, Any] = {"episodes": len(lines), "errors": sum(line["end_reason"] == "error" for line in lines)}
    for metric in SUMMARY_METRICS:
        values = np.array([line[metric] for line in lines if line.get(metric) is not None], dtype=float)
        summary[metric] = {"mean": _mean(values), "ci95": bootstrap_interval(values)}
    causes = Counter(line["failure"] for line in lines if line.get("failure") is not None)
    summary["failures"] = dict(causes.most_common())
    return summary


def bootstrap_interval(values: np.ndarray, *, seed: int = 0) -> list[float | None]:
    """95 % percentile bootstrap interval of the mean (Efron 1985); the same for the same values in any order."""
    if len(values) == 0:
        return [None, None]
    rng = np.random.default_rng(seed)
    values = np.sort(values)
    means = np.empty(BOOTSTRAP_RESAMPLES)
    for first in range(0, BOOTSTRAP_RESAMPLES, 1000):  # 1000 x 2000 episodes are 16 MB
        means[first : first + 1000] = values[rng.integers(len(values), size=(1000, len(values)))].mean(axis=1)
    low, high = np.percentile(means, [2.5, 97.5])
    return [float(low), float(high)]


def _mean(values: np.ndarray) -> float | None:
    return float(values.mean()) if len(values) else None


def _write_json(file: Path, content: Mapping[str, Any]) -> None:
    part = file.with_suffix(".json.part")
    part.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    part.replace(file)


def read_whole_lines(file: Path, *, mend: bool = False) -> list[dict[str, Any]]:
    """The lines of a results.jsonl that were written whole; a broken last one is left out.

    Args:
        file: need not be there.
        mend: cut the broken one off the file as well.

    Raises:
        ValueError: a line before the last is not JSON.
    """
    if not file.exists():
        return []
    content = file.read_bytes()
    whole = content[: content.rfind(b"\n") + 1]
    if mend and len(whole) < len(content):
        with file.open("r+b") as stream:
            stream.truncate(len(whole))
    return [json.loads(line) for line in whole.splitlines()]
