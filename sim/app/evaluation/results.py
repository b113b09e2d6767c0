"""The files of a run: `config.json`, `results.jsonl` (one line per episode) and `summary.json`.

One process writes each line to the disk as its episode ends. A killed run leaves at most one incomplete line, the last,
which is removed when the run is resumed.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import json
import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Generic, Protocol, Required, TypedDict, TypeVar, cast

from sim.app.evaluation.config_fields import ABSENT, field_text, run_differences
from sim.core.errors import ConfigError
from sim.core.files import open_to_grow, write_atomically
from sim.core.reading import (  # fmt: skip
    MAX_LINES_BYTES,
    Count,
    Lines,
    Name,
    Seed,
    convert,
    printable,
    read_bytes,
    read_json,
    read_lines,
    reason_of,
    sha256_of,
)
from sim.core.vocabulary import counted
from sim.task.result import READ_BY, EpisodeResult

IDENTITY = ("agent", "semantics", "seed")
"""Keys that a line and the config of its run have in common, with equal values."""
HUMAN_NAME, NODES_NAME = "human", "ros"
"""Names of the agent in the results of a person, and of a robot that nodes of ROS 2 drive."""
LineT = TypeVar("LineT", bound="Line")


class Line(Protocol):
    """A line of the file of results."""

    @property
    def episode_id(self) -> str: ...  # noqa: D102
    @property
    def house(self) -> str: ...  # noqa: D102
    @property
    def goal(self) -> str: ...  # noqa: D102

    @property
    def is_error(self) -> bool:
        """True: a line of the next run of this episode replaces it."""
        ...

    def as_json(self) -> dict[str, object]:
        """Returns the JSON values of the line."""
        ...


class SplitIdentity(TypedDict, total=False):
    """The fields that identify the source of a run's episodes."""

    name: Required[Name]
    version: str
    sha256: str


class RunRecord(TypedDict, total=False):
    """The content of `config.json` as far as it is read; a run of an older version may lack any of the fields."""

    agent: str | None
    explorer: str | None
    semantics: str | None
    split: str | None
    house: str | None
    labels: str | None
    root: str | None
    robot: str | None
    weights: str | None
    goal: str | None
    noise: str | None
    profile: str | None
    shard: str | None
    seed: Seed | None
    seed_key: str | None
    episodes: Count
    replicates: Count | None
    only: list[str] | None
    split_identity: SplitIdentity | None
    versions: dict[str, str]
    codes: list[str] | None
    settings: dict[str, Any]
    """The fields of the configuration that `--config` changed, by path."""
    config: dict[str, Any]
    """The configuration tree (`sim.app.composition.setup.RunConfig`)."""
    physics: Count | None
    segmentation: dict[str, object] | None
    files_sha256: dict[str, str]


def is_driven(record: RunRecord) -> bool:
    """Returns whether a person drove the episodes of a run, alone or with an agent."""
    return str(record.get("agent")).partition("+")[0] == HUMAN_NAME


def can_be_repeated(record: RunRecord) -> bool:
    """Returns whether `stubborn run` runs the episodes of a run again: no person and no nodes of ROS 2 drove them."""
    return not is_driven(record) and record.get("agent") != NODES_NAME


EPISODE_FOLDERS = ("trajectories", "pictures", "videos", "rerun", "mcap")
"""Folders of a run with files of single episodes."""


@dataclass
class RunDirectory(Generic[LineT]):
    """The folder of one run, locked against a second writer while it is open."""

    path: Path
    config: Mapping[str, Any]
    line_type: type[LineT]

    def __post_init__(self) -> None:
        self.path = self.path.absolute()  # an agent may change the current folder
        self._file = self.path / "results.jsonl"
        existed = self.path.exists()
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._lock: IO[bytes] = open_to_grow(self.path / ".lock", "ab")
        except OSError as error:
            raise ConfigError(f"Cannot write to --out '{self.path}': {reason_of(error)}.") from None
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._lock.close()
            raise ConfigError(f"Another process is writing to --out '{self.path}'.") from None
        self._folder_existed, self._made_config = existed, False
        self.healed = ""
        """A sentence on an incomplete last line that was removed; "" if every line was complete."""
        try:
            self._write_or_compare_config()
            self.lines: list[LineT] = self._read_and_heal()
            self._places = {line.episode_id: place for place, line in enumerate(self.lines)}
            self._open(read_bytes(self._file, what="Results", most=MAX_LINES_BYTES) if self._file.exists() else b"")
        except BaseException:
            self._lock.close()
            raise

    def discard_if_empty(self) -> None:
        """Removes what this process made if no line was written, so that the next start may have other options."""
        if self.lines or not self._made_config:
            return
        for file in ("config.json", "results.jsonl", "summary.json", ".lock"):
            (self.path / file).unlink(missing_ok=True)
        folders = [self.path / name for name in EPISODE_FOLDERS]
        for folder in (*folders, *(() if self._folder_existed else (self.path,))):
            with contextlib.suppress(OSError):  # it does not exist, or holds other files
                folder.rmdir()

    def errors(self, episode_ids: Collection[str]) -> set[str]:
        """Returns the ids of the given episodes whose line is an error; `append` replaces such a line."""
        return {line.episode_id for line in self.lines if line.is_error} & set(episode_ids)

    def require_own_code(self, code: str, kept: Collection[str]) -> None:
        """Raises ConfigError if the user's code has changed since it ran the episodes that are kept.

        Args:
            code: a hash of this project's code, "+" and a hash of the user's code; without "+" there is no user's code.
            kept: ids of the episodes.
        """
        if not kept:
            return
        existing = read_record(self.path / "config.json")
        codes = existing.get("codes") or [existing.get("versions", {}).get("code", "")]
        before = [text.partition("+")[2] for text in codes if text]
        now = code.partition("+")[2]
        if now and all(before) and before and now not in before:
            number = counted(len(kept), "episode")
            raise ConfigError(
                f"Your code ({self.config.get('agent')}) has changed since it ran {number} in --out '{self.path}' "
                f"(code {before[-1]}, now {now}). To run all episodes with the new code, give another --out; to keep "
                "these results and run only the missing episodes with the new code, add --keep-results."
            )

    def require_of(self, episodes: Mapping[str, tuple[str, str]]) -> None:
        """Raises ConfigError if a line belongs to no episode, or to one with another house or goal.

        Args:
            episodes: house and goal by id.
        """
        for number, line in enumerate(self.lines, start=1):
            where = f"Results '{self._file}', line {number}"
            if line.episode_id not in episodes:
                raise ConfigError(f"{where}: '{line.episode_id}' is not an episode of this run; choose another folder.")
            house, goal = episodes[line.episode_id]
            for key, recorded, expected in (("house", line.house, house), ("goal", line.goal, goal)):
                if recorded != expected:
                    raise ConfigError(f"{where}: {key} is '{recorded}', but '{expected}' in the episode of this run.")

    def _read_and_heal(self) -> list[LineT]:
        """Returns the lines of earlier processes; an incomplete last line is cut off the file."""
        lines = read_result_lines(self._file, self.line_type)
        for number, line in enumerate(lines.values, start=1):
            values = line.as_json()
            for key in IDENTITY:
                if key in values and key in self.config and values[key] != self.config[key]:
                    raise ConfigError(
                        f"Results '{self._file}', line {number}: {key} is {field_text(values[key])}, but this run has "
                        f"{field_text(self.config[key])}; choose another folder."
                    )
        if lines.torn:
            self.healed = lines.torn
            with open_to_grow(self._file, "r+b") as stream:
                stream.truncate(lines.whole_bytes)
        return lines.values

    def append(self, line: LineT) -> None:
        """Writes one result line and syncs it to disk; it replaces the line of an earlier error in the same episode.

        Raises:
            ConfigError: another program removed or changed the results.
        """
        self._require_untouched(new=line.episode_id)
        place = self._places.get(line.episode_id)
        if place is None or not self.lines[place].is_error:
            self._places[line.episode_id] = len(self.lines)
            self.lines.append(line)
            self._write(_as_bytes(line))
        else:
            self.lines[place] = line
            self._results.close()
            content = b"".join(map(_as_bytes, self.lines))
            write_atomically(self._file, content, sync=True)
            self._open(content)
        self._require_untouched(new="")

    def _open(self, content: bytes) -> None:
        """Opens the file of results to append lines; `content` is its content so far."""
        self._results = open_to_grow(self._file)
        self._bytes, self._digest = len(content), hashlib.sha256(content)

    def _write(self, content: bytes) -> None:
        self._results.write(content)
        self._results.flush()
        os.fsync(self._results.fileno())
        self._bytes += len(content)
        self._digest.update(content)

    def _require_untouched(self, *, new: str = "", content: bool = False) -> None:
        """Raises ConfigError if the results on the disk are not those that this process wrote.

        Args:
            new: id of the episode whose line will be written; "": none.
            content: whether to compare the content, and not only the size.
        """
        try:
            size = self._file.stat().st_size
            same = size == self._bytes
            if same and content:
                same = sha256_of(self._file, what="Results") == self._digest.hexdigest()
            reason = f"was changed by another program: it has {size} bytes, and this run wrote {self._bytes}"
        except (OSError, ConfigError):
            same, reason = False, "was removed by another program"
        if not same:
            ids = [line.episode_id for line in self.lines] + [new] * bool(new)
            named = f"'{ids[0]}' to '{ids[-1]}'" if len(ids) > 1 else "".join(f"'{episode_id}'" for episode_id in ids)
            raise ConfigError(
                f"While the run wrote to it, '{self._file}' {reason}. The results of {len(ids)} episodes are lost or "
                f"may be damaged ({named}); run them again with another --out."
            )

    def record_code(self, code: str) -> list[str]:
        """Adds a hash of the code to `codes` in config.json: it runs the episodes from here on.

        Returns:
            the other hashes, of the code that ran the existing lines, the oldest first.
        """
        file = self.path / "config.json"
        existing = read_record(file)
        first_code = existing.get("versions", {}).get("code", "unknown")
        codes = (existing.get("codes") or [first_code]) if self.lines else []
        if code not in codes:
            codes = [*codes, code]
        if codes != existing.get("codes"):
            _write_json(file, {**existing, "codes": codes})
        return [other for other in codes if other != code]

    def other_versions(self) -> dict[str, tuple[str, str]]:
        """Returns the versions that have changed since the run began, except that of the code.

        The values are the earlier and the present version for each name.
        """
        before, now = read_record(self.path / "config.json").get("versions", {}), self.config.get("versions", {})
        return {
            name: (before[name], now[name])
            for name in now
            if name != "code" and before.get(name, now[name]) != now[name]
        }

    def write_summary(self, summary: Mapping[str, object]) -> None:
        """Writes `summary.json`.

        Raises:
            ConfigError: another program removed or changed the results.
        """
        self._require_untouched(content=True)
        _write_json(self.path / "summary.json", summary)

    def close(self) -> None:
        """Closes the files and releases the folder."""
        self._results.close()
        self._lock.close()

    def _require_same_physics(self, existing: RunRecord, config: Mapping[str, object]) -> None:
        """Raises ConfigError where the run was made with another version of the physics; the first wrote none."""
        before, now = existing.get("physics") or 1, config.get("physics")
        if now is not None and before != now:
            raise ConfigError(
                f"--out '{self.path}' holds a run of physics version {before}, this program has version {now}: the "
                "robot moves differently, so that the run cannot be resumed; choose another folder."
            )

    def _write_or_compare_config(self) -> None:
        file = self.path / "config.json"
        config = json.loads(json.dumps(dict(self.config)))
        if not file.exists():
            if self._file.exists():
                raise ConfigError(f"--out '{self.path}' has results but no config.json; choose another folder.")
            self._made_config = True
            _write_json(file, config)  # it is on the disk before the first line
            return
        existing = read_record(file)
        self._require_same_physics(existing, config)
        differences = run_differences(existing, config, resumed=True)
        # The options first: they are what the user changed, and often the cause of other settings.
        for path, before, now in sorted(differences, key=lambda difference: difference[0].startswith("config.")):
            if not all(value is None or value is ABSENT for value in (before, now)):
                version = existing.get("versions", {}).get("stubborn-objectnav")
                older = version != config.get("versions", {}).get("stubborn-objectnav") and version is not None
                raise ConfigError(
                    f"--out '{self.path}' holds a run{f' of version {version}' if older else ''} with "
                    f"{path} = {field_text(before)}, this run has {field_text(now)}; choose another folder, or resume "
                    "the run with the same options."
                )
        changed = {}
        if existing.get("seed_key") is None and config.get("seed_key") is not None:
            changed["seed_key"] = config["seed_key"]  # a run of version 0.1 has none
        if (config.get("episodes") or 0) > (existing.get("episodes") or 0):
            changed["episodes"] = config["episodes"]
        before, now = (list(record.get("only") or ()) for record in (existing, config))
        if before and not set(now) <= set(before):
            changed["only"] = sorted({*before, *now})
            changed["episodes"] = len(changed["only"])
        elif before and not now:
            changed["only"] = []
        if changed:
            _write_json(file, {**existing, **changed})


def _as_bytes(line: Line) -> bytes:
    return (json.dumps(line.as_json(), allow_nan=False) + "\n").encode()


def _write_json(file: Path, content: Mapping[str, object]) -> None:
    write_atomically(file, json.dumps(content, indent=2, allow_nan=False) + "\n", sync=True)


def read_record(file: Path) -> RunRecord:
    """Returns the content of a `config.json`.

    Raises:
        ConfigError: it cannot be read, or a field has another type.
    """
    content = read_json(file, dict[str, object], what="Config")
    convert(content, RunRecord, where=f"Config '{file}'")
    return cast(RunRecord, content)


def segmentation_of(record: RunRecord) -> str:
    """Returns the segmentation with which a run's agent acted, and its weights, as it is shown to users.

    "none" is the segmentation of an agent that the simulator gave none, and that names none of its own.
    """
    declared, semantics = record.get("segmentation"), record.get("semantics")
    # A run of an older version declares nothing.
    text = str((semantics or "unknown") if declared is None else (declared.get("name") or "none"))
    weights = (record.get("files_sha256") or {}).get("weights")
    if declared is not None and weights is not None and text == semantics:  # a network, not the agent's own
        text += f", {own_weights(record) or 'shipped weights'} ({weights[:8]})"
    return " ".join(printable(text).split())  # the record of a submission may have any characters


def own_weights(record: RunRecord) -> str | None:
    """Returns the file of the weights that the user named for the network; None: those that ship."""
    return record.get("weights") or (record.get("settings") or {}).get("detector.weights")


def read_results(file: Path) -> Lines[EpisodeResult]:
    """Returns the lines of a run's `results.jsonl`; see `read_result_lines`."""
    return read_result_lines(file, EpisodeResult)


def read_result_lines(file: Path, line_type: type[LineT]) -> Lines[LineT]:
    """Returns the lines of a `results.jsonl`; no line where there is no such file.

    Raises:
        ConfigError: a line before the last is broken or of an older format, or an episode has two lines.
    """
    older = f"results of an older format are read by version {READ_BY}"
    lines = read_lines(file, line_type, what="Results", older=older)
    first: dict[str, int] = {}
    for number, line in enumerate(lines.values, start=1):
        before = first.setdefault(line.episode_id, number)
        if before != number:
            same = "the same" if line == lines.values[before - 1] else "another"
            raise ConfigError(
                f"Results '{file}', line {number}: episode '{line.episode_id}' has {same} result in line {before}; "
                "remove one of the lines."
            )
    return lines
