"""Logs of whole episodes to which parameters are fitted. A log is continued, and refused for other settings.

A log is a folder with one line per episode. The same command continues it, and more episodes extend it, as long as
split, code and detector are the same.
"""

from __future__ import annotations

import shlex
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from sim.app import cli
from sim.app.composition.segmenters import KINDS, detector_config, detector_record, find_segmentation
from sim.app.evaluation.config_fields import differing_fields, field_text
from sim.app.evaluation.executors import make_executor
from sim.app.evaluation.own_code import hash_of_own
from sim.app.evaluation.results import RunDirectory, read_result_lines
from sim.app.evaluation.workers import RunnerSpec
from sim.core.files import file_name
from sim.core.interface import ConfigError
from sim.core.paths import assets_dir, code_hash
from sim.core.reading import read_json
from sim.episodes.splits import Split, load_split
from sim.training.figures import require_packages
from sim.training.fits.log_line import LogLine

LogLineT = TypeVar("LogLineT", bound=LogLine)
BATCH = 100
"""Number of episodes that are given to the workers together: a house is loaded once per batch, and a run that is cut
short is still balanced."""
COMPARED = ("semantics", "detector", "split_identity")
"""Entries of the config of a log in which it must be equal when no episode is run."""


@dataclass(frozen=True, kw_only=True)
class LogOptions:
    """The options that all commands with a log of episodes have in common."""

    split: str
    """A shipped split, or a folder with the same layout (`stubborn episodes`)."""
    semantics: str = "rednet"
    """The segmentation whose errors are learned: one of `stubborn run`, also your own, that needs verification."""
    weights: Path | None = None
    """With --semantics rednet: weights in place of the shipped ones."""
    episodes: cli.Count = 100
    """Number of episodes, the first of the split."""
    max_steps: cli.Count = 300
    """Steps of an episode."""
    workers: cli.Count = 1
    """Number of processes."""
    minutes: cli.NotNegative | None = None
    """Time limit of the episodes; 0 runs none."""
    seed: cli.Seed = 0
    """Seed of the episodes."""
    log: cli.OutFolder | None = None
    """Folder of the log; None: a folder in runs, named after the command, --semantics and the split."""
    out: cli.OutFile
    """File of the parameters (JSON)."""

    def command(self, name: str, episodes: int, *more: str) -> str:
        """Returns the command that gives the same parameters, for the file that holds them.

        It runs the same episodes if the log holds the first ones of the split; --minutes may have left some out.

        Args:
            name: the last word of the command.
            episodes: number of episodes in the log, in place of --episodes.
            more: words of further options.
        """
        words = ["--semantics", self.semantics]
        words += [] if self.weights is None else ["--weights", str(self.weights)]
        words += ["--split", self.split, "--episodes", str(episodes), "--max-steps", str(self.max_steps), *more]
        words += ["--seed", str(self.seed), "--out", str(self.out)]
        return f"stubborn train {name} {shlex.join(words)}"


JUDGING = ("val", "test", "large-test")
"""Shipped splits whose houses judge agents: nothing is fitted on them."""


def checked_split(args: LogOptions) -> Split:
    """Returns the split of the options.

    Raises:
        ConfigError: the segmentation is exact, the fit is on val or test or a copy of them, there is no such split, or
            scikit-learn, which fits, is not installed.
    """
    require_packages("sklearn")
    if not find_segmentation(args.semantics, args.weights).spec.needs_verification:
        kinds = [name for name, kind in KINDS.items() if kind.spec.needs_verification]
        raise ConfigError(f"--semantics '{args.semantics}' makes no errors to learn. Available: {', '.join(kinds)}.")
    split = load_split(args.split)
    judging = [name for name in JUDGING if _shares_houses(split, load_split(assets_dir() / name))]
    if judging:
        raise ConfigError(f"Nothing is fitted on houses of '{judging[0]}', which judges agents; give another --split.")
    return split


def _shares_houses(split: Split, shipped: Split) -> bool:
    """Returns whether a split is a shipped one or a copy of it, or uses its house files."""
    files = {file.resolve() for file in shipped.house_paths.values()}
    return split.sha256 == shipped.sha256 or any(file.resolve() in files for file in split.house_paths.values())


def default_log(command: str, args: LogOptions, split: Split) -> Path:
    """Returns the folder of the log if --log is not given."""
    return Path("runs") / f"{command}-{file_name(args.semantics)}-{split.name}"


def lines_of(
    args: LogOptions,
    split: Split,
    log: Path,
    line_type: type[LogLineT],
    runner: RunnerSpec,
) -> list[LogLineT]:
    """Returns the lines of the first `args.episodes` episodes, by id; those that are not in the log yet are run now.

    Args:
        args: with 0 minutes, no episode is run, and the log is read even if its code or seed differs.
        split: the split of `args`.
        log: folder of the log.
        line_type: the fields of a line.
        runner: runs an episode and returns its line.

    Raises:
        ConfigError: the log is of another split or of other segmentation.
    """
    if args.minutes == 0:
        _require_log_of(log, log_config(args, split))
        lines = read_result_lines(log / "results.jsonl", line_type).values
    else:
        run = RunDirectory(log, log_config(args, split), line_type)
        try:
            _run_episodes(args, split, run, runner)
            lines = run.lines
        finally:
            run.discard_if_empty()
            run.close()
    ids = {episode.episode_id for episode in split.episodes[: args.episodes]}
    return sorted((line for line in lines if line.episode_id in ids), key=lambda line: line.episode_id)


def _require_log_of(log: Path, config: Mapping[str, object]) -> None:
    """Raises ConfigError if a log is not of this split and segmentation."""
    file = log / "config.json"
    of_log = read_json(file, dict[str, object], what="Config of a log") if file.is_file() else {}
    for path, actual, asked in differing_fields(of_log, {key: config[key] for key in of_log if key in config}):
        if path.partition(".")[0] in COMPARED and path != "detector.weights":  # the checksum of the weights counts
            raise ConfigError(
                f"Log '{log}' was made with {path} = {field_text(actual)}, this command has {field_text(asked)}; "
                "take another --log, or the options of that log."
            )


def log_config(args: LogOptions, split: Split) -> Mapping[str, object]:
    """Returns the values that all lines of a log have in common; `RunDirectory` does not continue a log with others.

    The hash of the code is that of the modules without fitted parameters, since the episodes do not use them.
    """
    return {
        "semantics": args.semantics,
        "detector": detector_record(detector_config(find_segmentation(args.semantics, args.weights), args.weights)),
        "seed": args.seed,
        "max_steps": args.max_steps,
        "split_identity": split.identity,
        "code": code_hash(parameters=False) + _own_code(args.semantics),
    }


def _own_code(semantics: str) -> str:
    """Returns "+" and a hash of the code of a user's segmentation; "" for those that ship."""
    module, separator, _ = semantics.partition(":")
    return f"+{hash_of_own((module,))}" if separator else ""


def _run_episodes(
    args: LogOptions,
    split: Split,
    run: RunDirectory[LogLineT],
    runner: RunnerSpec,
) -> None:
    """Runs the episodes that are not in the log yet, until the time is up."""
    done = {line.episode_id for line in run.lines}
    todo = [episode for episode in split.episodes[: args.episodes] if episode.episode_id not in done]
    print(f"{len(done)} episodes are in the log {run.path}, {len(todo)} are run now", flush=True)
    until_s = time.monotonic() + 60.0 * args.minutes if args.minutes is not None else float("inf")
    executor = make_executor("local", workers=args.workers)
    for batch in (todo[first : first + BATCH] for first in range(0, len(todo), BATCH)):
        for line in executor.run(runner, batch, on_death=lambda episode, _: run.line_type.of(episode)):
            run.append(line)
            print(f"[{len(run.lines)}/{len(todo) + len(done)}] {line.episode_id}", flush=True)
            if time.monotonic() > until_s:
                return
