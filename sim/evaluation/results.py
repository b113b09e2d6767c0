"""The files of a run: `config.json`, `results.jsonl` (one line per episode) and `summary.json`.

One process writes and flushes each line as its episode ends. A killed run leaves at most one incomplete line, the last,
which is removed when the run is resumed.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Annotated, Any, Literal

import msgspec

from sim.errors import ConfigError
from sim.evaluation.bootstrap import estimate
from sim.evaluation.config_fields import ABSENT, differing_fields, field_text, is_same_file
from sim.files import write_atomically
from sim.reading import Count, Lines, Name, Number, convert, read_json, read_lines

SUMMARY_METRICS = (
    "success", "spl", "soft_spl", "distance_to_goal", "gt_explored", "never_seen", "steps_to_first_sight",
    "area_seen_m2", "area_per_metre", "trapped", "collisions",
)  # fmt: skip
"""Metrics (`metric_value`) that the summary averages."""
OF_ERRORS = ("success", "spl", "soft_spl")
"""Metrics in which an episode that ended with an error counts."""
RESAMPLED, RESAMPLED_IN_ONE_HOUSE = "houses, then the episodes of each", "the episodes of the one house"
"""The units that the intervals of a summary resample."""
PLACEMENT_OPTIONS = ("executor", "address", "shard")
"""Options that say where episodes are run; they change no result."""
VIEWER_OPTIONS = ("video", "view", "rerun", "rerun_save")
"""Options that start viewers; they change no result."""
WITHOUT_EFFECT = frozenset({"workers", "out", "record", *PLACEMENT_OPTIONS, *VIEWER_OPTIONS})
"""Entries of the config that change no result."""
NOT_COMPARED = WITHOUT_EFFECT | {"versions", "codes", "episodes", "only", "settings", "segmentation"}
"""Entries of the config in which a resumed run may differ; with more episodes it runs the additional ones.

`settings` are the assignments of the command line; what counts is the tree that they lead to, `config`.
`segmentation` says in words what `semantics` and the code lead to.
"""


IDENTITY = ("agent", "semantics", "seed")
"""Keys that a line and the config of its run have in common, with equal values."""
Measured = Number | bool | None


class ResultLine(msgspec.Struct):
    """The fields of a line of `results.jsonl` that are read; fields that older versions do not write have a default."""

    episode_id: Name
    house: Name
    goal: Name
    end_reason: Literal["stop", "max_steps", "fallen", "error"]
    success: Annotated[float, msgspec.Meta(ge=0.0, le=1.0)] | bool
    agent: str = ""
    semantics: str = ""
    seed: Count = 0
    failure: str | None = None
    error: str | None = None
    spl: Measured = None
    soft_spl: Measured = None
    distance_to_goal: Measured = None
    num_steps: Count | None = None
    path_length: Measured = None
    shortest_path: Measured = None
    collisions: Measured = None
    gt_explored: Measured = None
    first_seen_step: Measured = None
    steps_to_first_sight: Measured = None
    area_seen_m2: Measured = None
    area_per_metre: float | None = None  # not bounded: older runs divided by path lengths near 0
    trapped: Measured = None
    stop_confidence: Measured = None
    stop_target_xy_m: tuple[Number, Number] | None = None
    stop_target_to_goal_m: Measured = None
    wall_time_s: Measured = None
    steps_per_s: Measured = None


_NOT_WRITTEN = {
    name: None
    for name in ResultLine.__struct_fields__[-len(ResultLine.__struct_defaults__) :]
    if name not in (*IDENTITY, "error")
}
"""Fields that a line may lack, which readers then find as None."""


class SplitIdentity(msgspec.Struct):
    """The fields that identify the source of a run's episodes."""

    name: Name
    version: str = ""
    sha256: str = ""


class RunRecord(msgspec.Struct):
    """The parts of `config.json` that are read; a run of an older version may lack any of them."""

    agent: str | None = None
    semantics: str | None = None
    split: str | None = None
    house: str | None = None
    labels: str | None = None
    root: str | None = None
    robot: str | None = None
    weights: str | None = None
    goal: str | None = None
    noise: str | None = None
    seed: Count | None = None
    episodes: Count | None = None
    split_identity: SplitIdentity | None = None
    versions: dict[str, str] = {}
    codes: list[str] | None = None
    config: dict[str, Any] = {}
    files_sha256: dict[str, str] = {}


@dataclass
class RunDirectory:
    """The folder of one run, locked against a second writer while it is open."""

    path: Path
    config: Mapping[str, Any]
    line_type: type = ResultLine
    """Type of the lines."""

    def __post_init__(self) -> None:
        existed = self.path.exists()
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._lock: IO[str] = (self.path / ".lock").open("w")
        except OSError as error:
            raise ConfigError(f"Cannot write to --out '{self.path}': {error.strerror}.") from None
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise ConfigError(f"Another process is writing to --out '{self.path}'.") from None
        self._created = [self.path / ".lock", *([] if existed else [self.path])]
        self.healed = ""
        """A sentence on an incomplete last line that was dropped; "" where there was none."""
        try:
            self._write_or_compare_config()
            self.lines: list[dict[str, Any]] = self._read_and_heal()
            self._results = (self.path / "results.jsonl").open("a", encoding="utf-8")
        except BaseException:
            self._lock.close()
            raise

    def discard_if_empty(self) -> None:
        """Removes what this process created if no line was written, so that the next start may have other options."""
        if self.lines or self.path / "config.json" not in self._created:
            return
        for file in ("config.json", "results.jsonl", "summary.json", ".lock"):
            (self.path / file).unlink(missing_ok=True)
        for folder in (self.path / "videos", self.path):
            with contextlib.suppress(OSError):  # it does not exist, or holds other files
                folder.rmdir()

    def drop_errors(self, episode_ids: Collection[str] | None = None) -> int:
        """Removes the lines of episodes that ended with an error, so that they are run again; returns their number.

        Those of `episode_ids` only, if they are given.
        """
        kept = [
            line
            for line in self.lines
            if line["end_reason"] != "error" or (episode_ids is not None and line["episode_id"] not in episode_ids)
        ]
        dropped = len(self.lines) - len(kept)
        if dropped:
            self._results.close()
            text = "".join(json.dumps(line, allow_nan=False) + "\n" for line in kept)
            write_atomically(self.path / "results.jsonl", text)
            self._results = (self.path / "results.jsonl").open("a", encoding="utf-8")
            self.lines = kept
        return dropped

    def require_of(self, episodes: Mapping[str, tuple[str, str]]) -> None:
        """Raises ConfigError if a line belongs to no episode, or to one with another house or goal.

        Args:
            episodes: house and goal by id.
        """
        for number, line in enumerate(self.lines, start=1):
            where = f"Results '{self.path / 'results.jsonl'}', line {number}"
            house, goal = episodes.get(line["episode_id"], (None, None))
            if house is None:
                raise ConfigError(
                    f"{where}: '{line['episode_id']}' is not an episode of this run; choose another folder."
                )
            for key, wanted in (("house", house), ("goal", goal)):
                if line[key] != wanted:
                    raise ConfigError(f"{where}: {key} is '{line[key]}', but '{wanted}' in the episode of this run.")

    def _read_and_heal(self) -> list[dict[str, Any]]:
        """Returns the lines of earlier processes; an incomplete last line is cut off the file."""
        file = self.path / "results.jsonl"
        found = read_result_lines(file, self.line_type)
        for number, line in enumerate(found.values, start=1):
            for key in IDENTITY:
                if key in line and key in self.config and line[key] != self.config[key]:
                    raise ConfigError(
                        f"Results '{file}', line {number}: {key} is {field_text(line[key])}, but this run has "
                        f"{field_text(self.config[key])}; choose another folder."
                    )
        if found.torn:
            self.healed = found.torn
            with file.open("r+b") as stream:
                stream.truncate(found.whole_bytes)
        return found.values

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
        existing = read_record(file)
        first_code = existing.get("versions", {}).get("code", "unknown")
        codes = existing.get("codes", [first_code]) if self.lines else []
        if code not in codes:
            codes = [*codes, code]
        if codes != existing.get("codes"):
            _write_json(file, existing | {"codes": codes})
        return [other for other in codes if other != code]

    def other_versions(self) -> dict[str, tuple[str, str]]:
        """Returns what differs between the versions that the run began with and those of now, the code apart.

        Both are given for each name, the earlier one first.
        """
        before, now = read_record(self.path / "config.json").get("versions", {}), self.config.get("versions", {})
        return {
            name: (before[name], now[name])
            for name in now
            if name != "code" and before.get(name, now[name]) != now[name]
        }

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
            self._created.append(file)
            _write_json(file, config)
            return
        existing = read_record(file)
        for path, before, now in differing_fields(existing, config):
            unset = all(value is None or value is ABSENT for value in (before, now))
            if path.partition(".")[0] not in NOT_COMPARED and not unset and not is_same_file(path, existing, config):
                raise ConfigError(
                    f"--out '{self.path}' holds a run with {path} = {field_text(before)}, this run has "
                    f"{field_text(now)}; choose another folder, or resume the run with the same options."
                )
        changed = {}
        if (config.get("episodes") or 0) > (existing.get("episodes") or 0):
            changed["episodes"] = config["episodes"]
        before, now = (list(record.get("only") or ()) for record in (existing, config))
        if before and not set(now) <= set(before):
            changed["only"] = sorted({*before, *now})
            changed["episodes"] = len(changed["only"])
        elif before and not now:
            changed["only"] = []
        if changed:
            _write_json(file, existing | changed)


def metric_value(line: Mapping[str, Any], metric: str) -> float | None:
    """Returns a metric of a result line; None where the line, for example of an older version, does not have it.

    An episode that ended with an error is a failure, whose success and SPL are 0. It has no other metric: it did not
    run to its end, so that it has too few steps, collisions and metres.

    `never_seen` is 1 - `gt_explored`. It belongs to `steps_to_first_sight`, whose value is `max_steps` in an episode
    that never showed the goal: the mean is the restricted mean time to first sight.
    """
    value = line.get("gt_explored" if metric == "never_seen" else metric)
    if value is None or (line.get("end_reason") == "error" and metric not in OF_ERRORS):
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
    write_atomically(file, json.dumps(content, indent=2, allow_nan=False) + "\n")


def read_record(file: Path) -> dict[str, Any]:
    """Returns the content of a `config.json`.

    Raises:
        ConfigError: it cannot be read, or a field has another type.
    """
    content = read_json(file, dict[str, Any], what="Config")
    convert(content, RunRecord, where=f"Config '{file}'")
    return content


def read_result_lines(file: Path, line_type: type = ResultLine) -> Lines:
    """Returns the lines of a `results.jsonl`; no line where there is no such file.

    Raises:
        ConfigError: a line before the last is broken, or an episode has two lines.
    """
    found = read_lines(file, line_type, what="Results")
    if line_type is ResultLine:
        found = found._replace(values=[_NOT_WRITTEN | line for line in found.values])
    first: dict[str, int] = {}
    for number, line in enumerate(found.values, start=1):
        before = first.setdefault(line["episode_id"], number)
        if before != number:
            same = "the same" if line == found.values[before - 1] else "another"
            raise ConfigError(
                f"Results '{file}', line {number}: episode '{line['episode_id']}' has {same} result in line {before}; "
                "remove one of the lines."
            )
    return found
