"""One run out of several: the shards of `sim.run --shard i/n`, or any runs with the same options.

python tools/merge_runs.py runs/big                       # runs/big/shard_*_of_* into runs/big
python tools/merge_runs.py runs/a runs/b --out runs/both

Lines, trajectories, videos and recordings are copied, the summary is made anew. It may be run as often as one likes,
also while shards are still being played: what is new is added. The merged folder is a run like any other: `sim.run`
with the same options and that --out plays what is missing.
"""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyro

from sim import cli
from sim.analysis import display
from sim.analysis.comparison import Line, Run, read_run
from sim.evaluation.results import NOT_COMPARED, RunDirectory
from sim.evaluation.rollout import TIMES
from sim.interface import ConfigError

SHARDS = "shard_*_of_*"
COPIED = ("trajectories", "videos", "rerun")
"""Folders of a run with a file or more an episode."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Merge runs that have the same options."""

    runs: tyro.conf.Positional[tuple[Path, ...]]
    """Folders of runs; or one folder that holds shards."""
    out: Path | None = None
    """Where the merged run goes; by default the one folder given."""


def main(args: Args) -> int:
    """Merge; returns 1 where episodes broke or are missing."""
    folders, out = sources(args)
    runs = [read_run(folder) for folder in folders]
    for run in runs[1:]:
        require_same_options(runs[0], run)
    lines = merged_lines(runs)
    console = display.make_console()
    merged = RunDirectory(out, merged_config(runs))
    try:
        there = {line["episode_id"]: line for line in merged.lines}
        for episode_id, line in lines.items():
            if episode_id not in there:
                merged.append(line)
            elif without_times(there[episode_id]) != without_times(line):
                raise _conflict(episode_id, out, line)
        summary = merged.write_summary({"split": merged.config["split_identity"]})
        display.print_results(console, merged.lines, summary)
    finally:
        merged.close()
    for folder in folders:
        copy_files(folder, out)
    missing = int(merged.config["episodes"]) - len(merged.lines)
    told = f"{len(merged.lines)} episodes of {len(runs)} runs, {missing} missing; results in {out}"
    console.print(told, highlight=False, soft_wrap=True)
    return 1 if missing or summary["errors"] else 0


def sources(args: Args) -> tuple[list[Path], Path]:
    """The folders to merge, and where to.

    Raises:
        ConfigError: nothing to merge, or nowhere to put it.
    """
    if len(args.runs) == 1 and (shards := sorted(args.runs[0].glob(SHARDS))):
        return shards, args.out or args.runs[0]
    if args.out is None:
        named = ", ".join(f"'{folder}'" for folder in args.runs) or "nothing"
        raise ConfigError(f"Give one folder that holds {SHARDS}, or several runs and --out; got {named}.")
    return list(args.runs), args.out


def require_same_options(first: Run, other: Run) -> None:
    """Raise ConfigError where two runs differ in what results hang on."""
    for key in sorted((set(first.config) | set(other.config)) - NOT_COMPARED):
        a, b = first.config.get(key), other.config.get(key)
        if a != b:
            raise ConfigError(
                f"'{first.path}' has {key} = {json.dumps(a)}, '{other.path}' has {json.dumps(b)}: these are two runs."
            )


def merged_lines(runs: Sequence[Run]) -> dict[str, Line]:
    """All lines by episode, sorted; an episode that two runs have played counts once.

    Raises:
        ConfigError: they have played it differently.
    """
    lines: dict[str, Line] = {}
    for run in runs:
        for episode_id, line in run.lines.items():
            if without_times(lines.setdefault(episode_id, line)) != without_times(line):
                raise _conflict(episode_id, run.path, lines[episode_id])
    return dict(sorted(lines.items()))


def without_times(line: Line) -> dict[str, Any]:
    """What two runs of the same episode agree in."""
    return {key: value for key, value in line.items() if key not in TIMES}


def merged_config(runs: Sequence[Run]) -> dict[str, Any]:
    """The config of the whole: of no shard, by all the code that played."""
    versions = [run.config.get("versions", {}) for run in runs]
    codes = [code for run, of in zip(runs, versions, strict=True) for code in run.config.get("codes", [of.get("code")])]
    episodes = max(int(run.config["episodes"]) for run in runs)
    return {**runs[0].config, "shard": None, "episodes": episodes, "codes": list(dict.fromkeys(codes))}


def copy_files(folder: Path, out: Path) -> None:
    """Copy what episodes have left beside their lines, and is not there yet."""
    for name in COPIED:
        for file in sorted((folder / name).glob("*")):
            to = out / name / file.name
            if file.is_file() and not to.exists():
                to.parent.mkdir(parents=True, exist_ok=True)
                part = to.with_name(f".{to.name}.part")
                shutil.copy2(file, part)
                part.replace(to)


def _conflict(episode_id: str, path: Path, line: Line) -> ConfigError:
    told = json.dumps({key: line.get(key) for key in ("success", "num_steps", "end_reason")})
    return ConfigError(f"'{path}' has played '{episode_id}' differently from another run, where it gave {told}.")


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
