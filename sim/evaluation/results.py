"""The files of a run: `config.json`, `results.jsonl` (one line per episode) and `summary.json`.

One process writes and flushes each line as its episode ends. A killed run leaves at most one incomplete line, the last,
which is removed when the run is resumed.
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

from sim.errors import ConfigError
from sim.evaluation.bootstrap import estimate
from sim.evaluation.config_fields import ABSENT, differing_fields, field_text

SUMMARY_METRICS = (
    "success", "spl", "soft_spl", "distance_to_goal", "gt_explored", "never_seen", "steps_to_first_sight",
    "area_seen_m2", "area_per_metre", "trapped", "collisions",
)  # fmt: skip
"""Metrics (`metric_value`) that the summary averages."""
RESAMPLED, RESAMPLED_IN_ONE_HOUSE = "houses, then the episodes of each", "the episodes of the one house"
"""What the intervals of a summary resample."""
PLACEMENT_OPTIONS = ("executor", "address", "shard")
"""Options that say where episodes are run; they change no result."""
VIEWER_OPTIONS = ("video", "view", "rerun", "rerun_save")
"""Options that start viewers; they change no result."""
WITHOUT_EFFECT = frozenset({"workers", "out", "record", *PLACEMENT_OPTIONS, *VIEWER_OPTIONS})
"""Entries of the config that change no result."""
NOT_COMPARED = WITHOUT_EFFECT | {"versions", "codes", "episodes", "settings"}
"""Entries of the config in which a resumed run may differ; with more episodes it runs the additional ones.

`settings` are the assignments of the command line; what counts is the tree that they lead to, `config`.
"""


@dataclass
class RunDirectory:
    """The folder of one run, locked against a second writer while it is open."""

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
        self.lines: list[dict[str, Any]] = read_whole_lines(self.path / "results.jsonl", repair=True)
        self._results = (self.path / "results.jsonl").open("a", encoding="utf-8")

    def append(self, line: Mapping[str, Any]) -> None:
        """Writes one result line and syncs it to disk."""
        self._results.write(json.dumps(line, allow_nan=False) + "\n")
        self._results.flush()
        os.fsync(self._results.fileno())
        self.lines.append(dict(line))

    def record_code(self, code: str) -> list[str]:
        """Adds a hash of the code to `codes` in config.json: it runs the episodes from here on.

        Returns:
            the other hashes, of the code that ran the existing lines, the oldest first.
        """
        file = self.path / "config.json"
        existing = json.loads(file.read_text(encoding="utf-8"))
        first_code = existing.get("versions", {}).get("code", "unknown")
        codes = existing.get("codes", [first_code]) if self.lines else []
        if code not in codes:
            codes = [*codes, code]
        if codes != existing.get("codes"):
            _write_json(file, existing | {"codes": codes})
        return [other for other in codes if other != code]

    def write_summary(self, extra: Mapping[str, Any]) -> dict[str, Any]:
        """Averages all lines, writes `summary.json` and returns its content."""
        summary = {**extra, **summarise(self.lines)}
        _write_json(self.path / "summary.json", summary)
        return summary

    def close(self) -> None:
        """Closes the files and releases the folder."""
        self._results.close()
        self._lock.close()

    def _write_or_compare_config(self) -> None:
        file = self.path / "config.json"
        config = json.loads(json.dumps(dict(self.config)))
        if not file.exists():
            if (self.path / "results.jsonl").exists():
                raise ConfigError(f"--out '{self.path}' has results but no config.json; choose another folder.")
            _write_json(file, config)
            return
        try:
            existing = json.loads(file.read_text(encoding="utf-8"))
        except ValueError:
            raise ConfigError(
                f"--out '{self.path}' holds a config.json that is not JSON; choose another folder."
            ) from None
        for path, before, now in differing_fields(existing, config):
            unset = all(value is None or value is ABSENT for value in (before, now))
            if path.partition(".")[0] not in NOT_COMPARED and not unset:
                raise ConfigError(
                    f"--out '{self.path}' holds a run with {path} = {field_text(before)}, this run has "
                    f"{field_text(now)}; choose another folder, or resume the run with the same options."
                )
        if (config.get("episodes") or 0) > (existing.get("episodes") or 0):
            _write_json(file, existing | {"episodes": config["episodes"]})


def metric_value(line: Mapping[str, Any], metric: str) -> float | None:
    """Returns a metric of a result line; None where the line, for example of an older version, does not have it.

    `never_seen` is 1 - `gt_explored`. It belongs to `steps_to_first_sight`, whose value is `max_steps` in an episode
    that never showed the goal: the mean is the restricted mean time to first sight.
    """
    value = line.get("gt_explored" if metric == "never_seen" else metric)
    if value is None:
        return None
    return 1.0 - float(value) if metric == "never_seen" else float(value)


def summarise(lines: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Returns the number of episodes and, for each of `SUMMARY_METRICS`, the mean and its 95 % bootstrap interval.

    Intervals resample houses, then the episodes of each (`sim.evaluation.bootstrap`); `ci95_resamples` says so, and
    says when one house leaves only its episodes to resample. `failures` counts the failed episodes by cause
    (`sim.task.failures`), the most frequent first. Episodes whose value is null do not count for that metric.
    """
    lines = list(lines)
    houses = [str(line["house"]) for line in lines]
    summary: dict[str, Any] = {
        "episodes": len(lines),
        "errors": sum(line["end_reason"] == "error" for line in lines),
        "falls": sum(line["end_reason"] == "fallen" for line in lines),
        "houses": len(set(houses)),
        "ci95_resamples": RESAMPLED_IN_ONE_HOUSE if len(set(houses)) == 1 else RESAMPLED,
    }
    for metric in SUMMARY_METRICS:
        value = estimate([metric_value(line, metric) for line in lines], houses)
        summary[metric] = {"mean": value.mean, "ci95": [value.low, value.high]}
    causes = Counter(line["failure"] for line in lines if line.get("failure") is not None)
    summary["failures"] = dict(causes.most_common())
    return summary


def _write_json(file: Path, content: Mapping[str, Any]) -> None:
    part = file.with_suffix(".json.part")
    part.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    part.replace(file)


def read_whole_lines(file: Path, *, repair: bool = False) -> list[dict[str, Any]]:
    """Returns the complete lines of a results.jsonl; an incomplete last line is left out.

    Args:
        file: may not exist; it then has no lines.
        repair: also cut an incomplete last line off the file.

    Raises:
        ValueError: a line before the last is not JSON.
    """
    if not file.exists():
        return []
    content = file.read_bytes()
    whole = content[: content.rfind(b"\n") + 1]
    if repair and len(whole) < len(content):
        with file.open("r+b") as stream:
            stream.truncate(len(whole))
    return [json.loads(line) for line in whole.splitlines()]
