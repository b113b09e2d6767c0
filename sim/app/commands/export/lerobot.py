"""Writes a recorded run as a LeRobot dataset (format v3: Parquet, MP4).

    stubborn run --agent stubborn-plus --episodes 200 --record --out runs/plus
    stubborn export lerobot runs/plus --out runs/plus_lerobot

Each recorded episode is run again by its actions, with the physics and the noise of the run, and its camera pictures
become a video. Episodes that ended with an error are left out. The same command goes on with an export that was
stopped, and adds the episodes of a run that has grown.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import msgspec
import tyro

from sim.app import cli
from sim.app.analysis.comparison import Run, read_run
from sim.app.analysis.display import counted
from sim.app.bridges.lerobot.dataset import DatasetWriter
from sim.app.bridges.lerobot.features import task_of
from sim.app.bridges.lerobot.replays import Replayer
from sim.core.errors import ConfigError
from sim.core.files import write_atomically
from sim.core.reading import read_json
from sim.task.trajectory import trajectory_file

ABOUT = "stubborn.json"
"""The run and the options of an export, in its folder."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Write a recorded run as a LeRobot dataset."""

    run: tyro.conf.Positional[Path]
    """Folder of a run with --record."""
    out: cli.OutFolder
    """Folder of the dataset."""
    width_px: cli.Count = 320
    """Width of the pictures, an even number."""
    only_success: bool = False
    """Leave out episodes without success, for imitation."""


def main(args: Args) -> int:
    """Writes the dataset and prints a line for each episode; returns the exit status."""
    run = read_run(args.run)
    ids = exported(run, only_success=args.only_success)
    if not ids:
        raise ConfigError(f"'{args.run}' has no recorded episode to export: run it with --record.")
    writer, replayer = DatasetWriter(args.out, args.width_px), Replayer(run)
    tasks = list(dict.fromkeys(task_of(run.results[episode_id].goal) for episode_id in ids))
    try:
        rows, shape = 0, replayer.picture_shape(args.width_px)
        _require_same(args, ids)
        for number, episode_id in enumerate(ids):
            if writer.has(number):
                rows += writer.length_of(number)
                continue
            goal = run.results[episode_id].goal
            task = task_of(goal)
            count = writer.add(number, goal, task, tasks.index(task), rows, replayer.frames(episode_id))
            rows += count
            print(f"[{number + 1}/{len(ids)}] {episode_id}: {task}, {counted(count, 'frame')}", flush=True)
    finally:
        replayer.close()
    writer.finish(len(ids), tasks, shape, robot="stubborn")
    print(f"{counted(len(ids), 'episode')}, {counted(rows, 'frame')}, {counted(len(tasks), 'task')} in {args.out}.")
    return 0


def exported(run: Run, *, only_success: bool) -> list[str]:
    """Returns the ids of the episodes of a run that are exported, in the order of its results."""
    return [
        episode_id
        for episode_id, result in run.results.items()
        if not result.is_error
        and (result.success or not only_success)
        and trajectory_file(run.path, episode_id).is_file()
    ]


class About(msgspec.Struct, frozen=True):
    """What a folder is an export of."""

    run: str
    width_px: int
    only_success: bool
    episodes: list[str]
    """Ids in the order of the dataset."""


def _require_same(args: Args, ids: list[str]) -> None:
    """Writes what the folder is an export of.

    Raises:
        ConfigError: it is one of another run, with other options, or of episodes that have changed since.
    """
    about, file = About(str(args.run.resolve()), args.width_px, args.only_success, ids), args.out / ABOUT
    if file.is_file():
        before = read_json(file, About, what="Export")
        changed = [
            name for name in ("run", "width_px", "only_success") if getattr(before, name) != getattr(about, name)
        ]
        if before.episodes != ids[: len(before.episodes)]:
            changed.append("the order of its episodes")
        if changed:
            raise ConfigError(f"--out '{args.out}' is another export ({', '.join(changed)}). Give another folder.")
    args.out.mkdir(parents=True, exist_ok=True)
    write_atomically(file, msgspec.json.encode(about) + b"\n")
