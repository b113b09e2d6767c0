"""The file of a submission: gzipped JSON with a manifest, the configuration of the run, and each episode's actions.

The file is data from somebody else. Its size is bounded before and after decompression, every field has a declared type
and length, and it names no path that is opened.
"""

from __future__ import annotations

import gzip
import tempfile
from collections import Counter
from pathlib import Path
from typing import Annotated, Literal, cast

import msgspec
from msgspec import Meta

from sim.app.evaluation.results import RunRecord
from sim.core.errors import ConfigError
from sim.core.files import write_atomically
from sim.core.reading import Count, Metres, Name, Seed, convert, disguise_of, parse_json, read_bytes, read_gzip_json
from sim.task.result import EpisodeResult, Isolation

FORMAT: Literal["stubborn-submission-1"] = "stubborn-submission-1"
SUFFIX = ".json.gz"
MAX_FILE_BYTES = 16 << 20
"""Largest file; an episode of 500 actions takes about 1 KB."""
MAX_EPISODES = 20_000
MAX_ACTIONS = 10_000
"""Largest number of actions of an episode."""
MAX_CONFIG_BYTES = 1 << 20
PLACE_EVERY = 10
"""The position of the robot is recorded after each so many actions, and after the last one."""

_PLAIN = r"^[^\x00-\x1f\x7f-\x9f\u2028\u2029]*\Z"
_NO_FORMULA = r"^[^\s=+@\-\x00-\x1f\x7f-\x9f][^\x00-\x1f\x7f-\x9f\u2028\u2029]*\Z"
"""A spreadsheet would read a text that begins with "=" as a formula."""
Short = Annotated[str, Meta(min_length=1, max_length=80, pattern=_NO_FORMULA)]
"""A name."""
Text = Annotated[str, Meta(max_length=2000, pattern=_PLAIN)]
Link = Annotated[str, Meta(max_length=300, pattern=r"^https://[A-Za-z0-9.-]+(/[A-Za-z0-9._~/?#&=%+:@-]*)?\Z")]
Actions = Annotated[str, Meta(max_length=MAX_ACTIONS, pattern=r"^[0-5]*\Z")]
Version = Annotated[str, Meta(max_length=300, pattern=_PLAIN)]


class Inputs(msgspec.Struct, forbid_unknown_fields=True):
    """The inputs of the agent as the authors declare them: a replay cannot prove them."""

    agent: Annotated[str, Meta(min_length=1, max_length=1000, pattern=_NO_FORMULA)]
    semantics: Name
    sensors: Annotated[tuple[Short, ...], Meta(max_length=50)]
    noise: Name
    uses_ground_truth: bool
    isolated: Isolation
    """The agent ran in a process of its own (`--agent process:COMMAND`), or also in namespaces of Linux."""


class SplitOf(msgspec.Struct, forbid_unknown_fields=True):
    """The split of the run."""

    name: Short
    version: Short
    sha256: Annotated[str, Meta(pattern=r"^[0-9a-f]{64}\Z")]


class Manifest(msgspec.Struct, forbid_unknown_fields=True):
    """The statements of the authors about the run."""

    name: Short
    """Name of the row."""
    authors: Annotated[tuple[Short, ...], Meta(max_length=50)]
    description: Text
    links: Annotated[tuple[Link, ...], Meta(max_length=10)]
    split: SplitOf
    seed: Seed
    physics: Count
    """Version of the physics (`sim.robot.config.PHYSICS_VERSION`)."""
    inputs: Inputs
    versions: Annotated[dict[Short, Version], Meta(max_length=50)]
    """Packages, processor, OpenGL renderer and code with which the run was made."""


class Entry(msgspec.Struct, forbid_unknown_fields=True):
    """One episode."""

    result: EpisodeResult
    actions: Actions
    """A digit for each action (`sim.core.interface.Action`)."""
    places_m: Annotated[tuple[tuple[Metres, Metres], ...], Meta(max_length=MAX_ACTIONS)] = ()
    """x and y of the robot after every `PLACE_EVERY`-th action and after the last one, to 0.1 mm."""


class Submission(msgspec.Struct, forbid_unknown_fields=True):
    """The whole file."""

    format: Literal["stubborn-submission-1"]
    manifest: Manifest
    config: msgspec.Raw
    """The run's `config.json` without options that change no result."""
    episodes: Annotated[list[Entry], Meta(min_length=1, max_length=MAX_EPISODES)]

    def config_tree(self, *, where: str) -> RunRecord:
        """Returns the configuration.

        Args:
            where: names the file for the error message.

        Raises:
            ConfigError: it is too large, or no JSON object.
        """
        content = bytes(self.config)
        if len(content) > MAX_CONFIG_BYTES:
            raise ConfigError(f"{where}, field 'config': it has {len(content)} bytes, at most {MAX_CONFIG_BYTES}.")
        tree = parse_json(content, dict[str, object], where=f"{where}, field 'config',")
        convert(tree, RunRecord, where=f"{where}, field 'config'")
        return cast(RunRecord, tree)


def read_submission(file: Path) -> Submission:
    """Returns the submission in a file.

    Raises:
        ConfigError: the file cannot be read, is damaged or too large, has another format, or has an episode twice.
    """
    read_bytes(file, what="Submission", most=MAX_FILE_BYTES)  # refuses a large file before it is decompressed
    submission: Submission = read_gzip_json(file, Submission, what="Submission", strict=False)  # 0.2.0 writes 3.0 steps
    counts = Counter(entry.result.episode_id for entry in submission.episodes)
    twice = next((name for name, count in counts.items() if count > 1), None)
    if twice is not None:
        raise ConfigError(f"Submission '{file}' has the episode '{twice}' {counts[twice]} times; each counts once.")
    _require_plain_texts(submission.manifest, file)
    return submission


def _require_plain_texts(manifest: Manifest, file: Path) -> None:
    """Raises ConfigError if a text of the manifest can look like another one."""
    inputs = manifest.inputs
    texts = (
        manifest.name, *manifest.authors, manifest.description, manifest.split.name, manifest.split.version,
        inputs.agent, inputs.semantics, inputs.noise, *inputs.sensors,
    )  # fmt: skip
    for text in texts:
        reason = disguise_of(text)
        if reason:
            raise ConfigError(f"Submission '{file}': the text '{ascii(text)[1:-1]}' {reason}.")


def write_submission(file: Path, submission: Submission) -> int:
    """Writes a submission, the same content to the same bytes, and returns their number.

    Raises:
        ConfigError: `read_submission` would refuse the file, which is not written.
        OSError: the file cannot be written.
    """
    content = gzip.compress(msgspec.json.encode(submission), 9, mtime=0)
    with tempfile.TemporaryDirectory() as folder:
        tried = Path(folder) / file.name
        tried.write_bytes(content)
        try:
            read_submission(tried)
        except ConfigError as error:
            raise ConfigError(str(error).replace(str(tried), str(file))) from None
    write_atomically(file, content)
    return len(content)
