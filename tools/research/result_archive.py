"""Reads the archive of result lines that the tables of results are made from.

It holds one folder for each run, with the `config.json` and `results.jsonl` that `stubborn run` wrote.
"""

from __future__ import annotations

import shlex
import tarfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import msgspec

from sim.app.analysis.comparison import Line, Run, read_run
from sim.app.composition.agents import find_agent
from sim.app.composition.options import RunOptions
from sim.core.errors import ConfigError
from sim.core.reading import PlainMember, convert, open_plain
from sim.episodes.replicates import episode_of

ROOT = Path(__file__).resolve().parents[2]
TABLES = ROOT / "docs" / "tables"
VERSION = "3.0.0"
"""Version of the splits of the tables. Results of different ones are of different houses or physics."""
ARCHIVE = TABLES / f"splits-{VERSION}.tar.gz"
RUN_FILES = ("config.json", "results.jsonl")
MAX_FILE_BYTES = 50_000_000
GROUND_TRUTH_KINDS = ("gt", "noisy")
"""Kinds of segmentation that are made from ground truth."""
CHECKSUM_DIGITS = 8
Say = Callable[[str], None]


class _Setup(msgspec.Struct):
    """The parts of `config.json` that say which options a run had."""

    explorer: str | None = None
    verification: str | None = None
    noise: str | None = None
    seed: int | None = None
    replicates: int | None = None
    settings: dict[str, Any] = msgspec.field(default_factory=dict)


@dataclass(frozen=True, order=True)
class RunKey:
    """The agent and options that one row of a table evaluates."""

    split: str
    agent: str
    options: str
    """Options of `stubborn run` that are not the default, such as "--explorer informed-tour"."""
    semantics: str
    version: str
    """Version of the splits."""

    @property
    def name(self) -> str:
        """The agent with its options."""
        return f"{self.agent} {self.options}".strip()


@dataclass(frozen=True)
class ArchivedRun:
    """One run of the archive."""

    key: RunKey
    run: Run
    folder: str
    """Its folder in the archive."""

    def first_lines(self, count: int | None = None) -> list[Line]:
        """Returns the lines of the first episodes of the split, with their replicates.

        The ids of episodes are numbered in the order of the split.

        Raises:
            ConfigError: the run has fewer episodes.
        """
        if count is not None and count > self.episodes:
            raise ConfigError(f"'{self.folder}' has {self.episodes} episodes; a table needs {count}.")
        wanted = set(sorted({episode_of(each) for each in self.run.lines})[:count])
        return [self.run.lines[each] for each in sorted(self.run.lines) if episode_of(each) in wanted]

    @property
    def episodes(self) -> int:
        """The number of episodes; replicates are not counted."""
        return len({episode_of(each) for each in self.run.lines})

    @property
    def uses_ground_truth(self) -> bool:
        """True where the agent declares it, or reads segmentation that is made from ground truth."""
        spec = find_agent(self.key.agent)
        return spec.uses_ground_truth or (spec.uses_segmentation and self.key.semantics in GROUND_TRUTH_KINDS)

    @property
    def codes(self) -> str:
        """The hashes of the code that ran the episodes, as config.json records them."""
        versions = self.run.config.get("versions", {})
        return " ".join(self.run.config.get("codes") or [str(versions.get("code", "unknown"))])

    @property
    def network(self) -> str:
        """The first digits of the SHA-256 of the network's weights; "" without a network."""
        return str(self.run.config.get("files_sha256", {}).get("weights", ""))[:CHECKSUM_DIGITS]

    def command(self, episodes: int) -> str:
        """Returns the command that runs the same episodes."""
        source = self.run.recorded("split")
        parts = ["stubborn run --agent", self.key.agent, self.key.options, "--semantics", self.key.semantics]
        return " ".join(filter(None, [*parts, "--split", shlex.quote(source), f"--episodes {episodes}"]))


def read_archive(archive: Path, folder: Path, say: Say) -> dict[RunKey, ArchivedRun]:
    """Returns the runs of an archive; what is not a run is reported and skipped.

    Args:
        archive: a tar file.
        folder: an empty folder, which receives the files of the runs.
        say: receives a sentence on each folder and file that is skipped.

    Raises:
        ConfigError: the archive cannot be read, holds no run, or holds two of the same row.
    """
    try:
        with open_plain(archive, what="Archive") as stream, tarfile.open(fileobj=stream, tarinfo=PlainMember) as opened:
            names = sorted(set(_extract(opened, folder, say)))
    except (OSError, tarfile.TarError, EOFError, ValueError, RecursionError) as error:
        raise ConfigError(f"Archive '{archive}' cannot be read: {error}.") from None
    found: dict[RunKey, ArchivedRun] = {}
    for name in names:
        try:
            run = read_run(folder / name)
            if not run.lines:
                raise ConfigError("it has no episode.")
            archived = ArchivedRun(key_of(run), run, name)
        except ConfigError as error:
            say(f"Skipped '{name}': {error}")
            continue
        if found.setdefault(archived.key, archived) is not archived:
            raise ConfigError(f"'{found[archived.key].folder}' and '{name}' of '{archive}' are runs of the same row.")
    if not found:
        raise ConfigError(f"Archive '{archive}' holds no run.")
    return found


def key_of(run: Run) -> RunKey:
    """Returns what a run evaluates.

    Raises:
        ConfigError: config.json lacks a field that a table needs.
    """
    agent, semantics = str(run.recorded("agent")), str(run.recorded("semantics"))
    find_agent(agent)
    split = run.recorded("split_identity")
    return RunKey(str(split["name"]), agent, shlex.join(_options(run)), semantics, str(split["version"]))


def _options(run: Run) -> Iterator[str]:
    """Yields the words of the options of `stubborn run` that are not the default, in a fixed order."""
    setup = convert(dict(run.config), _Setup, where=f"Config '{run.path / 'config.json'}'")
    defaults = RunOptions()
    for name in ("explorer", "verification", "noise", "seed", "replicates"):
        value = getattr(setup, name)
        if value is not None and value != getattr(defaults, name):
            yield from (f"--{name}", str(value))
    settings = {path: _setting_text(value) for path, value in setup.settings.items()}
    if settings:
        yield from ("--config", *(f"{path}={value}" for path, value in sorted(settings.items())))


def _setting_text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value).replace(" ", "")


def _extract(opened: tarfile.TarFile, folder: Path, say: Say) -> Iterator[str]:
    """Writes the files of runs below a folder, and yields the folder of each in the archive."""
    for member in opened:
        path = PurePosixPath(member.name)
        if member.isdir():
            continue
        inside = not path.is_absolute() and ".." not in path.parts and len(path.parts) > 1
        if not inside or not member.isfile() or path.name not in RUN_FILES or member.size > MAX_FILE_BYTES:
            say(f"Skipped '{member.name}': it is not a {' or '.join(RUN_FILES)} of a run.")
            continue
        content = opened.extractfile(member)
        if content is None:
            continue
        target = folder.joinpath(*path.parts)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content.read())
        yield str(path.parent)
