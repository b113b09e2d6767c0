"""Merges several runs into one: the shards of `stubborn run --shard i/n`, or any runs with the same options.

stubborn merge runs/big                       # runs/big/shard_*_of_* into runs/big
stubborn merge runs/a runs/b --out runs/both

Lines, trajectories, videos and recordings are copied, and the summary is computed from all lines. The command can be
repeated, also while shards are still running: it adds new episodes. The merged folder is a run: `stubborn run` with the
same options and this --out runs the missing episodes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim.app import cli
from sim.app.analysis import display
from sim.app.analysis.comparison import Run, read_run
from sim.app.evaluation.config_fields import field_text, run_differences
from sim.app.evaluation.results import EPISODE_FOLDERS, RunDirectory, read_record
from sim.app.evaluation.summary import summary_of
from sim.core.files import episode_id_of, write_atomically
from sim.core.interface import ConfigError
from sim.core.reading import read_bytes
from sim.core.vocabulary import counted
from sim.task.result import EpisodeResult

SHARDS = "shard_*_of_*"
MAX_FILE_BYTES = 4 << 30
"""Largest file of an episode that is copied; videos are the largest."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Merge runs that have the same options."""

    runs: tyro.conf.Positional[tuple[Path, ...]]
    """Folders of runs; or one folder that holds shards."""
    out: cli.OutFolder | None = None
    """Folder of the merged run; by default the one folder given."""


def main(args: Args) -> int:
    """Merges the runs; returns 1 if episodes are missing or ended with an error."""
    folders, out = sources(args)
    runs = [read_run(folder) for folder in folders]
    for run in runs[1:]:
        require_same_options(runs[0], run)
    results = merged_results(runs)
    console = display.make_console()
    merged = RunDirectory(out, merged_config(runs), EpisodeResult)
    try:
        existing, added = {result.episode_id: result for result in merged.lines}, set[str]()
        for episode_id, result in results.items():
            before = existing.get(episode_id)
            if before is None or (before.is_error and before != result):  # a shard has run it again
                merged.append(result)
                added.add(episode_id)
            elif not result.is_error and before.without_times() != result.without_times():
                raise _conflict(out, result)
        for code in merged.config["codes"]:
            merged.record_code(code)  # the folder may hold lines of an earlier merge
        summary = summary_of(runs[0].config, merged.lines)
        merged.write_summary(summary)
        display.print_results(console, merged.lines, summary)
    finally:
        merged.close()
    for run in runs:
        copy_files(run, results, added, out)
    stored = read_record(out / "config.json")  # the folder may hold an earlier merge of other episodes
    missing = max(stored["episodes"] - len(merged.lines), 0)
    counts = f"{counted(len(merged.lines), 'episode')} of {counted(len(runs), 'run')}"
    console.print(f"{counts}, {missing} missing; results in {out}", soft_wrap=True)
    keys = list(dict.fromkeys(str(run.config["seed_key"]) for run in runs if run.config.get("seed_key")))
    if len(keys) > 1:
        console.print(f"The runs have different seed keys ({', '.join(keys)}); with --seed-key they share one.")
    if lacking := sorted(set(stored.get("only") or ()) - {result.episode_id for result in merged.lines}):
        console.print(f"Missing: {' '.join(lacking)}", soft_wrap=True)
    return 1 if missing or summary["errors"] else 0


def sources(args: Args) -> tuple[list[Path], Path]:
    """Returns the folders to merge, and the folder of the merged run.

    Raises:
        ConfigError: there is nothing to merge, or no output folder.
    """
    if len(args.runs) == 1 and (shards := sorted(args.runs[0].glob(SHARDS))):
        return shards, args.out or args.runs[0]
    if args.out is None or not args.runs:
        named = ", ".join(f"'{folder}'" for folder in args.runs) or "nothing"
        raise ConfigError(f"Give one folder that holds {SHARDS}, or several runs and --out; got {named}.")
    return list(args.runs), args.out


def require_same_options(first: Run, other: Run) -> None:
    """Raises ConfigError if two runs differ in an option that changes results."""
    for path, a, b in run_differences(first.config, other.config, resumed=True):
        raise ConfigError(
            f"'{first.path}' has {path} = {field_text(a)}, '{other.path}' has {field_text(b)}: "
            "runs with different options cannot be merged."
        )


def merged_results(runs: Sequence[Run]) -> dict[str, EpisodeResult]:
    """Returns all results by episode id, sorted; an episode of two runs counts once.

    Raises:
        ConfigError: the results of an episode differ between two runs.
    """
    merged: dict[str, EpisodeResult] = {}
    for run in runs:
        for episode_id, result in run.results.items():
            first = merged.setdefault(episode_id, result)
            if first.is_error or result.is_error:
                merged[episode_id] = result if first.is_error else first
            elif first.without_times() != result.without_times():
                raise _conflict(run.path, first)
    return dict(sorted(merged.items()))


def merged_config(runs: Sequence[Run]) -> dict[str, object]:
    """Returns the config of the merged run: without a shard, with the hashes of all code that ran episodes.

    If all runs name their episodes (`--only`), the config names all of these.
    """
    codes = [code for run in runs for code in run.config.get("codes") or [run.config.get("versions", {}).get("code")]]
    named = [set(run.config.get("only") or ()) for run in runs]
    only = sorted(set.union(*named)) if all(named) else []
    episodes = len(only) or max(run.recorded("episodes") for run in runs)
    changes = {"shard": None, "episodes": episodes, "codes": list(dict.fromkeys(filter(None, codes)))}
    return {**runs[0].config, **changes, **({"only": only} if any(named) else {})}


def copy_files(run: Run, results: Mapping[str, EpisodeResult], added: Set[str], out: Path) -> None:
    """Copies the files of a run's episodes that the merged run lacks, or has of an earlier result.

    Args:
        run: one of the merged runs.
        results: the merged results; an episode that ended otherwise in this run, with an error, is not copied.
        added: episodes whose result is new in the merged run.
        out: folder of the merged run.
    """
    for name in EPISODE_FOLDERS:
        for file in sorted((run.path / name).glob("*")):
            episode_id = episode_id_of(file)
            result, target = run.results.get(episode_id), out / name / file.name
            if result is None or result.without_times() != results[episode_id].without_times():
                continue
            if file.is_file() and (episode_id in added or not target.exists()):
                write_atomically(target, read_bytes(file, what="File of a run", most=MAX_FILE_BYTES))


def _conflict(path: Path, result: EpisodeResult) -> ConfigError:
    other = f"success {result.success:g}, num_steps {result.num_steps}, end_reason {result.end_reason}"
    return ConfigError(f"'{path}' has another result of '{result.episode_id}' than another run, which has {other}.")
