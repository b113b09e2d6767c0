"""Renders recorded episodes as demonstrations for imitation: small depth and category images at each pose.

    stubborn run --agent oracle --split train --episodes 2000 --record --out runs/shown/oracle
    python -m tools.training.render_demonstrations runs/shown/oracle runs/shown/poni --out runs/demonstrations

Each episode of the runs that were recorded with --record becomes a file `<out>/<run>/<episode>.npz`
(`sim.training.cloned.demonstrations`); no episode is run again. The same command continues a killed run. Train with
`stubborn train cloned`.
"""

from __future__ import annotations

import itertools
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import tyro

from sim.app import cli
from sim.app.analysis.comparison import Run, read_run
from sim.app.analysis.report.drawings import split_of
from sim.app.evaluation.parallel import ordered_map
from sim.core.files import episode_file, inside
from sim.core.geometry.pose import Pose
from sim.core.interface import CameraModel, ConfigError
from sim.renderer.camera import Camera
from sim.task.trajectory import read_trajectory, trajectory_file
from sim.training.cloned.demonstrations import demonstrate, read_demonstration, write_demonstration
from sim.world.world import World

PRINT_EVERY_S = 10.0


@dataclass(frozen=True, kw_only=True)
class Args:
    """Render recorded episodes as demonstrations."""

    runs: tyro.conf.Positional[tuple[Path, ...]]
    """Folders of runs that were made with --record; two of the same name would write the same files."""
    out: cli.OutFolder
    """Folder of the demonstrations; episodes that are there are kept."""
    width_px: cli.Count = 64
    """Width of the images."""
    height_px: cli.Count = 48
    """Height of the images."""
    failed: bool = False
    """Also render episodes without success; those without an action are always left out."""
    workers: cli.Count = 1
    """Number of processes."""


@dataclass(frozen=True)
class HouseWork:
    """The episodes of one house in one run."""

    run: Path
    house: str
    episodes: tuple[tuple[str, str], ...]
    """Id and goal of each."""
    out: Path
    camera: CameraModel


def main(args: Args) -> int:
    """Renders; returns the exit status."""
    names = [path.resolve().name for path in args.runs]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ConfigError(f"Two runs are named '{twice}': their demonstrations would have the same files.")
    if not args.runs:
        raise ConfigError("Name at least one run that was made with --record.")
    work = [item for path in args.runs for item in _work_of(read_run(path), args)]
    todo = sum(len(item.episodes) for item in work)
    print(f"{todo} episodes to render", flush=True)
    episodes = frames = 0
    started_s = printed_s = time.monotonic()
    for rendered in ordered_map(render_house, work, workers=args.workers):
        episodes, frames = episodes + rendered[0], frames + rendered[1]
        if time.monotonic() - printed_s > PRINT_EVERY_S:
            printed_s = time.monotonic()
            print(f"{episodes} of {todo} episodes, {frames / (printed_s - started_s):.0f} frames/s", flush=True)
    empty = f"; {todo - episodes} without an action were left out" if episodes < todo else ""
    print(f"wrote {episodes} episodes with {frames} frames to {args.out}{empty}")
    return 0


def render_house(work: HouseWork) -> tuple[int, int]:
    """Renders the episodes of one house; returns the number of episodes and of frames."""
    run = read_run(work.run)
    world = World(split_of(run).load_house(work.house))
    camera = Camera(world.model, world.labels, camera=work.camera)
    episodes = frames = 0
    try:
        for episode_id, goal in work.episodes:
            trajectory = read_trajectory(trajectory_file(work.run, episode_id))
            if trajectory.num_steps == 0:  # the agent failed at its first action
                continue
            poses = [Pose(*(float(value) for value in row)) for row in trajectory.poses[: trajectory.num_steps]]
            shown = demonstrate(
                poses,
                trajectory.actions.tolist(),
                world,
                camera,
                goal=goal,
                house=work.house,
                success=trajectory.success,
            )
            write_demonstration(_file_of(work.run, episode_id, work.out), shown)
            episodes, frames = episodes + 1, frames + trajectory.num_steps
    finally:
        camera.close()
    return episodes, frames


def _work_of(run: Run, args: Args) -> Iterator[HouseWork]:
    """Yields what is to be rendered of a run, house by house."""
    if run.config.get("robot"):
        raise ConfigError(f"'{run.path}' was run with another robot; demonstrations are rendered for the default one.")
    mount_m = CameraModel().height_m
    height_m = run.config.get("config", {}).get("camera", {}).get("height_m", mount_m)
    if height_m != mount_m:
        raise ConfigError(f"'{run.path}' has a camera at {height_m} m; demonstrations are rendered from {mount_m} m.")
    split_of(run)  # refuses another version now, not in a worker
    camera = CameraModel(width_px=args.width_px, height_px=args.height_px)
    results = sorted(run.results.values(), key=lambda result: (result.house, result.episode_id))
    usable = [result for result in results if result.success or args.failed]
    recorded = [result for result in usable if trajectory_file(run.path, result.episode_id).is_file()]
    if not recorded:
        raise ConfigError(f"'{run.path}' has no trajectory of an episode that succeeded: run it with --record.")
    files = {result.episode_id: _file_of(run.path, result.episode_id, args.out) for result in recorded}
    known = next((file for file in files.values() if file.exists()), None)
    if known is not None:
        rows, cols = read_demonstration(known).depth_mm.shape[1:]
        if (cols, rows) != (args.width_px, args.height_px):
            raise ConfigError(f"'{known}' has images of {cols} x {rows} pixels; take another --out.")
    todo = [result for result in recorded if not files[result.episode_id].exists()]
    for house, members in itertools.groupby(todo, key=lambda result: result.house):
        episodes = tuple((result.episode_id, result.goal) for result in members)
        yield HouseWork(run.path, house, episodes, args.out, camera)


def _file_of(run: Path, episode_id: str, out: Path) -> Path:
    """Returns the file of a demonstration."""
    return episode_file(inside(out, run.resolve().name, what="A run"), episode_id, ".npz")


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
