"""Drive the robot yourself: `stubborn teleop`, or `stubborn teleop --goal sofa --out runs/mine`.

You drive an episode of a split, by default the first that is not in `--out` yet. It is recorded like any agent's: a
line in `results.jsonl` (agent `human`), a trajectory file, a summary; the tools for runs read it. Quitting records
nothing.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from sim import cli
from sim.analysis import display
from sim.composition.driven import record_driven
from sim.composition.environments import episodes_of, make_env
from sim.composition.human import HUMAN, HUMAN_NAME, Cockpit, Human, Quit
from sim.composition.options import RunOptions
from sim.composition.record import record_of
from sim.composition.setup import Setup, resolve
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Episode
from sim.errors import ConfigError
from sim.evaluation.results import RunDirectory
from sim.evaluation.rollout import episode_seed, play_episode
from sim.viewers.terminal import Terminal
from sim.viewers.video import VideoRecorder
from sim.viewers.viewer import VIEWER_IMAGES
from stubborn.drawing.map_painter import AgentMapPainter


@dataclass(frozen=True, kw_only=True)
class Args:
    """Drive the robot yourself, with the keys of a terminal."""

    split: str = "val"
    """A shipped split, or a folder laid out like one."""
    episode_id: str | None = None
    """The episode; by default the first that is not in --out yet."""
    house: Path | None = None
    """One MJCF file in place of a split."""
    labels: Path | None = None
    """With --house: a JSON file {"regex over names": "category"} for a house that has other names."""
    root: Path | None = None
    """With --house: another folder whose files the house may use, in addition to its own folder."""
    goal: str | None = None
    """Only this goal category."""
    start_deg: str | None = None
    """With --house: the start pose "X Y YAW" in metres and degrees."""
    robot: str | None = None
    """Replaces the default robot: an MJCF file with its sidecar next to it, or menagerie:NAME (docs/worlds.md)."""
    seed: cli.Seed = 0
    """Seed of noise and, with --house, of start and goal."""
    profile: str = "fast"
    """Rendering quality: fast or good."""
    noise: str = "none"
    """Noise of sensors and drive: none, realsense or harsh."""
    out: cli.OutFolder | None = None
    """Folder of the record (runs/<time>); episodes are added to an existing record."""
    video: bool = False
    """Write an MP4 of the episode to <out>/videos."""
    colours: Literal["auto", "true", "256"] = "auto"
    """Colours of the terminal: 24 bits, 256, or what it reports."""


def main(args: Args) -> int:
    """Runs one episode; returns the exit status."""
    console = display.make_console()
    terminal = Terminal()
    if args.colours != "auto":
        terminal.colours = args.colours
    try:
        with terminal:
            terminal.show(["Loading the house ..."])
            out, line = drive(args, terminal)
    except (Quit, KeyboardInterrupt):
        console.print("You quit before the end: nothing was recorded.")
        return 0
    outcome = "found" if line["success"] else f"not found ({line['failure']})"
    console.print(
        f"{line['episode_id']}: {line['goal']} {outcome} after {line['num_steps']} steps, SPL {line['spl']:.2f}, "
        f"{line['collisions']} collisions; recorded in {out}",
        highlight=False,
        soft_wrap=True,
    )
    return 0


def drive(args: Args, cockpit: Cockpit) -> tuple[Path, dict[str, Any]]:
    """Runs an episode in a terminal and records it; returns its folder and its result line.

    Raises:
        ConfigError, EpisodeError, HouseError: the split, house, goal or episode does not exist.
        Quit: the person quit before the end.
    """
    options = run_options(args)
    assert options.out is not None
    setup = resolve(options, HUMAN)
    episodes, split = available(args, setup)
    content = record_of(setup, split)
    record = RunDirectory(options.out, content)
    try:
        episode = choose(args, episodes, {line["episode_id"] for line in record.lines})
        line = run_episode(setup, episode, cockpit, content)
        record.append(line)
        record.write_summary({"split": split})
    finally:
        record.discard_if_empty()
        record.close()
    return options.out, line


def run_options(args: Args) -> RunOptions:
    """Returns the options with which `stubborn run` would describe this run."""
    return RunOptions(
        agent=HUMAN_NAME,
        semantics="gt",
        split=args.split,
        house=args.house,
        labels=args.labels,
        root=args.root,
        goal=args.goal,
        start_deg=args.start_deg,
        episodes=1,
        robot=args.robot,
        seed=args.seed,
        profile=args.profile,
        noise=args.noise,
        out=args.out or Path("runs") / time.strftime("%Y-%m-%d_%H-%M-%S"),
        record=True,
        video=args.video,
    )


def available(args: Args, setup: Setup) -> tuple[list[Episode], dict[str, Any]]:
    """Returns all episodes that can be run, and the fields that identify their source."""
    if args.house is not None:  # one is sampled from the seed
        return episodes_of(setup)
    env = ObjectNavEnv(split=args.split, goal=args.goal, sensors=())
    try:
        split = env.split
    finally:
        env.close()
    episodes = [episode for episode in split.episodes if args.goal in (None, episode.goal)]
    return episodes, {"name": split.name, "version": split.version, "sha256": split.sha256}


def choose(args: Args, episodes: Sequence[Episode], done: set[str]) -> Episode:
    """Returns the episode to run.

    Raises:
        ConfigError: no episode has that name, or it was run already.
    """
    left = [episode for episode in episodes if episode.episode_id not in done]
    if args.episode_id is None:
        if not left:
            raise ConfigError(f"--out '{args.out}' holds all of these {len(episodes)} episodes; take another folder.")
        return left[0]
    if args.episode_id in done:
        raise ConfigError(f"--out '{args.out}' holds episode '{args.episode_id}' already; take another folder.")
    for episode in left:
        if episode.episode_id == args.episode_id:
            return episode
    raise ConfigError(
        f"There is no episode '{args.episode_id}' here; available: '{episodes[0].episode_id}' and others."
    )


def run_episode(setup: Setup, episode: Episode, cockpit: Cockpit, content: dict[str, Any]) -> dict[str, Any]:
    """Lets a person drive through an episode; returns its result line, once the trajectory is written."""
    options = setup.options
    assert options.out is not None
    env = make_env(setup, sensors=setup.sensors, truth=VIEWER_IMAGES)
    human = Human(env, cockpit)
    viewers = [VideoRecorder(options.out, AgentMapPainter(human.mapper, show_route=False))] if options.video else []
    try:
        seed = episode_seed(options.seed, episode.episode_id)
        metrics = play_episode(env, human, episode, seed=seed, viewers=viewers)
        return record_driven(setup, env, episode, metrics, content)
    finally:
        for viewer in viewers:
            viewer.close()
        env.close()


def entry(argv: Sequence[str] | None = None) -> int:
    """Runs the command line; returns its exit status."""
    return cli.run(Args, main, argv)


if __name__ == "__main__":
    sys.exit(entry())
