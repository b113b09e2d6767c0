"""The runs of the paper's tables: each evaluates an agent on a split, and they take turns until all are complete."""

from __future__ import annotations

import itertools
import shlex
import time
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec
from rich.console import Console

from sim.app import cli
from sim.app.analysis.comparison import Run, read_run
from sim.app.composition.agents import find_agent
from sim.app.composition.running import run_missing
from sim.app.composition.setup import resolve
from sim.app.options import RunOptions
from sim.core.configuration import assignments_of, parse_assignments
from sim.core.errors import ConfigError
from sim.core.files import file_name
from sim.core.reading import convert
from sim.episodes.episode import Episode
from sim.episodes.splits import Split
from sim.task.result import EpisodeResult

GROUND_TRUTH = "gt"
"""The segmentation of agents that do not use one: they are run once, under this name."""
FORM = "AGENT [--semantics SOURCE] [--explorer NAME] [--verification METHOD] [--motion KIND] [--config FIELD=VALUE ...]"
"""The text that `AgentSetup.named` takes."""
NAMES = ("explorer", "verification", "noise", "seed", "replicates", "motion", "weights")
"""Options of `stubborn run` with one value that make another row of a table, in the order of its name."""

MAX_NAME = 120
"""Largest number of characters of the agents in the name of a table's file, and of options in that of a run's folder;
longer ones get a checksum."""


def uses_segmentation(agent: str) -> bool:
    """Returns False for an agent whose results do not depend on `--semantics`."""
    return find_agent(agent).uses_segmentation


@dataclass(frozen=True, order=True)
class AgentSetup:
    """An agent with its options and a source of segmentation, as on the command line of `stubborn run`."""

    agent: str
    options: str
    """Options that are not the default, such as "--explorer informed-tour"."""
    semantics: str

    @classmethod
    def named(cls, name: str, semantics: str, *, noise: str = "none", seed: int = 0) -> AgentSetup:
        """Returns the setup of a text such as "stubborn --explorer tour".

        Args:
            name: the text.
            semantics: source of segmentation, which the text can replace.
            noise: noise of sensors and drive.
            seed: seed of the run.

        Raises:
            ConfigError: the text has another form than `FORM`.
        """
        words = _words_by_option(name)
        agent = words["agent"][0]
        source = words.get("semantics", [semantics])[0] if uses_segmentation(agent) else GROUND_TRUTH
        values: dict[str, object] = {option: words[option][0] for option in NAMES if option in words}
        values |= {"noise": noise, "seed": seed}
        return cls(agent, _options_text(values, parse_assignments(words.get("config", ()))), source)

    @property
    def name(self) -> str:
        """The text that `named` takes, without the segmentation."""
        return f"{shlex.quote(self.agent)} {self.options}".strip()

    @property
    def label(self) -> str:
        """Name in a table with several kinds of segmentation."""
        return f"{self.name} ({self.semantics})" if uses_segmentation(self.agent) else self.name

    @property
    def variant(self) -> str:
        """The options for the name of a folder."""
        words = " ".join(shlex.split(self.options)).removeprefix("--").split(" --")
        return "_".join(file_name(part).replace(" ", "-") for part in words)

    def run_options(self) -> RunOptions:
        """Returns the options of `stubborn run`."""
        return cli.parse(RunOptions, ["--agent", self.agent, "--semantics", self.semantics, *shlex.split(self.options)])


@dataclass(frozen=True, order=True)
class RunKey:
    """A run is identified by its setup and the version of its split."""

    split: str
    setup: AgentSetup
    version: str


@dataclass(frozen=True)
class TableRun:
    """A run that tables need: the options of its command, and its episodes."""

    options: RunOptions
    split: Split
    episodes: Sequence[Episode]

    @property
    def results(self) -> Mapping[str, EpisodeResult]:
        """The results in its folder by `episode_id`; none if there is no run yet."""
        assert self.options.out is not None
        return read_run(self.options.out).results if (self.options.out / "results.jsonl").is_file() else {}


def run_in_turns(runs: Sequence[TableRun], chunk: int, minutes: float | None, console: Console) -> None:
    """Lets the runs take turns, a chunk of the episodes of each split, until all are complete or the time is used up.

    Args:
        runs: those of one split one after the other.
        chunk: number of episodes. In the first turn complete runs are also begun, so that other options or another
            code are refused; not those with --keep-results.
        minutes: no chunk of a split begins that would end later.
        console: for progress.

    Raises:
        ConfigError: a folder holds a run with other options.
    """
    began_s, longest_s = time.monotonic(), 0.0
    for first in range(0, max(len(run.episodes) for run in runs), chunk):
        for _, of_split in itertools.groupby(runs, key=lambda run: run.options.split):
            chunk_began_s = time.monotonic()
            if minutes is not None and chunk_began_s - began_s + longest_s >= 60.0 * minutes:
                console.print(f"The {minutes:g} minutes are used up before episode {first + 1}.")
                return
            for run in of_split:
                episodes = run.episodes[first : first + chunk]
                is_complete = all(episode.episode_id in run.results for episode in episodes)
                checks_options = not first and not run.options.keep_results  # also those of a complete run
                if checks_options or not is_complete:
                    run_missing(resolve(run.options), episodes, run.split.identity, console)
            longest_s = max(longest_s, time.monotonic() - chunk_began_s)


class _Recorded(msgspec.Struct):
    """The parts of `config.json` with the options of a run."""

    explorer: str | None = None
    verification: str | None = None
    noise: str | None = None
    seed: int | None = None
    replicates: int | None = None
    motion: str | None = None
    weights: str | None = None
    settings: dict[str, object] = msgspec.field(default_factory=dict)


def key_of(run: Run) -> RunKey:
    """Returns what a run evaluates.

    Raises:
        ConfigError: config.json lacks a field that a table needs.
    """
    agent, semantics = str(run.recorded("agent")), str(run.recorded("semantics"))
    find_agent(agent)
    split = run.recorded("split_identity")
    recorded = convert(dict(run.config), _Recorded, where=f"Config '{run.path / 'config.json'}'")
    values = {name: getattr(recorded, name) for name in NAMES}
    if recorded.weights is not None:
        values["weights"] = Path(recorded.weights).name  # the same row on another machine
    options = _options_text(values, recorded.settings)
    return RunKey(str(split["name"]), AgentSetup(agent, options, semantics), str(split["version"]))


def folder_name(setup: AgentSetup, split: str, noise: str = "none", seed: int = 0) -> str:
    """Returns the name of the folder of a run."""
    variant = setup.variant
    if len(variant) > MAX_NAME:
        variant = f"options-{zlib.crc32(variant.encode()):08x}"
    parts = (file_name(setup.agent), file_name(setup.semantics), noise, split, f"seed{seed}" if seed else "", variant)
    return "_".join(filter(None, parts))


def runs_in(out: Path, *versions: str) -> dict[RunKey, Path]:
    """Returns the folders of the runs in a folder that are of one of these versions of the splits.

    Raises:
        ConfigError: two folders hold runs of the same row, or a run cannot be read.
    """
    folders: dict[RunKey, Path] = {}
    for file in sorted(out.glob("*/results.jsonl")):
        key = key_of(read_run(file.parent))
        if key.version in versions and folders.setdefault(key, file.parent) != file.parent:
            raise ConfigError(f"'{folders[key]}' and '{file.parent}' are runs of the same row.")
    return folders


def _options_text(values: Mapping[str, object], settings: Mapping[str, object]) -> str:
    """Returns the options that are not the default in a fixed order."""
    defaults, words = RunOptions(), list[str]()
    for name in NAMES:
        value = values.get(name)
        if value is not None and str(value) != str(getattr(defaults, name)):
            words += [f"--{name}", str(value)]
    if settings:
        words += ["--config", *assignments_of(dict(sorted(settings.items())))]
    return shlex.join(words)


def _words_by_option(name: str) -> dict[str, list[str]]:
    """Returns the words of the agent and of each option in the text of a setup."""
    try:
        words = shlex.split(name)
    except ValueError as error:
        raise ConfigError(f"--agents: {name!r} cannot be read: {error}.") from None
    options: dict[str, list[str]] = {"agent": []}
    option = "agent"
    for word in words:
        if not word.startswith("--"):
            options[option].append(word)
            continue
        option = word.removeprefix("--")
        if option not in ("semantics", "explorer", "verification", "motion", "config") or option in options:
            raise ConfigError(f"--agents: {name!r} has the option {word}; an agent is given as {FORM}.")
        options[option] = []
    for option, values in options.items():
        if not values or (option != "config" and len(values) > 1):
            needed = "at least one FIELD=VALUE" if option == "config" else "one name"
            raise ConfigError(f"--agents: {name!r} needs {needed} for {option}; an agent is given as {FORM}.")
    return options
