"""Writes a recorded run as a LeRobot dataset (format v3: Parquet, MP4).

    stubborn run --agent stubborn-plus --episodes 200 --record --out runs/plus
    stubborn export lerobot runs/plus --out runs/plus_lerobot

Each recorded episode is run again by its actions, with the physics and the noise of the run, and its camera pictures
become a video. Episodes that ended with an error are left out. An episode whose replay leaves its recorded path is
named and left out; the exit status is then 1. The same command goes on with an export that was stopped, and adds the
episodes of a run that has grown.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import msgspec
import tyro

from sim.app import cli
from sim.app.analysis.comparison import Run, read_run
from sim.app.bridges.lerobot.dataset import DatasetWriter
from sim.app.bridges.lerobot.features import task_of
from sim.app.bridges.lerobot.replays import Replayer
from sim.core.errors import ConfigError, EpisodeError
from sim.core.files import write_atomically
from sim.core.interface import MOVES
from sim.core.reading import read_json
from sim.core.vocabulary import counted
from sim.task.trajectory import read_trajectory, trajectory_file

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
    """Writes the dataset and prints a line for each episode; returns 1 if the replay of an episode was another one."""
    run = read_run(args.run)
    ids = exported(run, only_success=args.only_success)
    if not ids:
        if args.only_success and exported(run, only_success=False):
            raise ConfigError(f"No recorded episode of '{args.run}' succeeded; leave out --only-success.")
        raise ConfigError(f"'{args.run}' has no recorded episode to export: run it with --record.")
    if any(read_trajectory(trajectory_file(run.path, each)).actions.max(initial=0) >= len(MOVES) for each in ids):
        raise ConfigError(f"The agent of '{args.run}' tilts its camera; a dataset has the actions of the drive only.")
    writer, replayer = DatasetWriter(args.out, args.width_px), Replayer(run)
    try:
        shape = replayer.picture_shape(args.width_px)
        about = _begun(args, ids)
        rows, tasks, about = _written(args, about, run, writer, replayer)
    finally:
        replayer.close()
    count = len(ids) - len(about.left_out)
    if not count:
        raise ConfigError(f"No episode of '{args.run}' follows its recorded path, so there is nothing to export.")
    writer.finish(count, tasks, shape, robot="stubborn")
    print(f"{counted(count, 'episode')}, {counted(rows, 'frame')}, {counted(len(tasks), 'task')} in {args.out}.")
    if about.left_out:
        print(f"{counted(len(about.left_out), 'episode')} left out, see above or '{args.out / ABOUT}'.")
    return int(bool(about.left_out))


def _written(
    args: Args, about: About, run: Run, writer: DatasetWriter, replayer: Replayer
) -> tuple[int, list[str], About]:
    """Writes the episodes; returns the number of rows, the tasks by their number, and which episodes are left out."""
    rows, number, tasks = 0, 0, list[str]()
    for position, episode_id in enumerate(about.episodes, start=1):
        goal = run.results[episode_id].goal
        task = task_of(goal)
        where = f"[{position}/{len(about.episodes)}] {episode_id}"
        if episode_id in about.left_out:
            print(f"{where}: left out before.", flush=True)
            continue
        if writer.has(number):
            count = writer.length_of(number)
        else:
            index = tasks.index(task) if task in tasks else len(tasks)
            try:
                count = writer.add(number, goal, task, index, rows, replayer.frames(episode_id))
            except EpisodeError as error:
                print(f"{where}: left out. {error}", flush=True)
                about = msgspec.structs.replace(about, left_out=[*about.left_out, episode_id])
                _write_about(args, about)
                continue
            print(f"{where}: {task}, {counted(count, 'frame')}", flush=True)
        tasks += [] if task in tasks else [task]
        rows, number = rows + count, number + 1
    return rows, tasks, about


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
    """Ids in the order of the run's results."""
    left_out: list[str] = []
    """Ids of those that are not in the dataset, because their replay leaves the recorded path."""


def _begun(args: Args, ids: list[str]) -> About:
    """Returns what the folder is an export of, and writes it there.

    Raises:
        ConfigError: it is one of another run, with other options, or of episodes that have changed since.
    """
    about, file = About(str(args.run.resolve()), args.width_px, args.only_success, ids), args.out / ABOUT
    left_out: list[str] = []
    if file.is_file():
        before = read_json(file, About, what="Export")
        changed = [
            name for name in ("run", "width_px", "only_success") if getattr(before, name) != getattr(about, name)
        ]
        if before.episodes != ids[: len(before.episodes)]:
            changed.append("the order of its episodes")
        if changed:
            raise ConfigError(f"--out '{args.out}' is another export ({', '.join(changed)}). Give another folder.")
        left_out = before.left_out
    about = msgspec.structs.replace(about, left_out=left_out)
    args.out.mkdir(parents=True, exist_ok=True)
    _write_about(args, about)
    return about


def _write_about(args: Args, about: About) -> None:
    write_atomically(args.out / ABOUT, msgspec.json.encode(about) + b"\n")
