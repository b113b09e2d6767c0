"""Run episodes: `python -m sim.run`, or `python -m sim.run --agent oracle --episodes 100 --workers 2`.

The composition root: the one place in `sim` that knows `stubborn`.
"""

from __future__ import annotations

import importlib
import math
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from sim import cli
from sim.analysis import display
from sim.composition.segmenters import KINDS
from sim.env.objectnav import ObjectNavEnv
from sim.env.oracle import Oracle
from sim.episodes.splits import Episode
from sim.errors import EpisodeError
from sim.evaluation.executors import make_executor
from sim.evaluation.parallel import Shard
from sim.evaluation.results import RunDirectory
from sim.evaluation.rollout import broken_metrics, episode_seed, play_episode, record_episode
from sim.evaluation.workers import RunnerSpec
from sim.geometry.pose import Pose
from sim.houses.load import load_house
from sim.interface import Agent, ConfigError
from sim.paths import code_hash
from sim.robot.foreign import load_robot, robot_sha256
from sim.segmenters import SEMANTICS, check_semantics, describe_semantics, make_segmenter, truth_needed
from sim.sensors.noise import get_noise
from sim.sensors.opengl import describe_gl
from sim.sensors.profiles import get_profile
from sim.viewers import selection
from sim.viewers.viewer import VIEWER_IMAGES
from stubborn import agents, draw
from stubborn.target.verification import verifier_for

TRUTH = "gt"
SEMANTICS_DO_NOT_MATTER = ("oracle", "random")
ALL_SENSORS = ("rgb", "depth", "semantic")


@dataclass(frozen=True, kw_only=True)
class Args:
    """Let an agent look for objects in apartments, and write down how it went."""

    agent: str = "stubborn"
    """Who plays: a name of --list-agents, or your own as package.module:factory."""
    semantics: str = "rednet"
    """Where segmentation comes from: rednet, noisy (ground truth with a network's mistakes) or gt (ground truth)."""
    weights: Path | None = None
    """With --semantics rednet: your network in place of the shipped one."""
    verification: str = "naive-bayes"
    """How candidates are verified: naive-bayes (the paper's), logistic, threshold or none."""
    verifier: Path | None = None
    """Parameters of verification (tools/train_verifier.py) in place of those shipped for this segmentation."""
    split: str = "val"
    """A shipped split, or a folder laid out like one."""
    house: Path | None = None
    """One MJCF file in place of a split."""
    labels: Path | None = None
    """With --house: a JSON file {"regex over names": "category"} for houses from elsewhere."""
    robot: Path | None = None
    """Another robot in place of ours: an MJCF file with its sidecar beside it (docs/worlds.md)."""
    goal: str | None = None
    """Only this goal category."""
    start_deg: str | None = None
    """With --house: the start pose "X Y YAW" in metres and degrees."""
    episodes: int = 5
    """The first N episodes of the split; with --house, so many are drawn."""
    seed: int = 0
    """Drives agents, noise and, with --house, starts and goals."""
    workers: int = 1
    """Processes, on this machine or over the cluster."""
    executor: str = "local"
    """Where: local processes, or ray (extra `ray`), a cluster of machines with the same code."""
    address: str | None = None
    """With --executor ray: HOST:PORT of the cluster's head; by default the cluster that this machine is in."""
    shard: str | None = None
    """i/n: every n-th episode from the i-th on, into <out>/shard_i_of_n; see tools/merge_runs.py."""
    profile: str = "fast"
    """Rendering quality: fast or good."""
    noise: str = "none"
    """Noise of sensors and drive: none, realsense or harsh."""
    out: Path | None = None
    """Where everything goes (runs/<time>); a run that is there goes on."""
    record: bool = False
    """Leave a compact trajectory file of each episode, for `sim.task.trajectory.read_trajectory`."""
    video: bool = False
    """Leave an MP4 of each episode in <out>/videos."""
    view: bool = False
    """Show the episodes in MuJoCo's viewer while they are played."""
    rerun: bool = False
    """Stream poses, images, points and map to the Rerun viewer (extra `rerun`)."""
    rerun_save: bool = False
    """Leave a Rerun file of each episode in <out>/rerun (extra `rerun`)."""
    list_agents: bool = False
    """Print the agents and end."""


def main(args: Args) -> int:
    """Run what was asked for; returns the exit status."""
    console = display.make_console()
    if args.list_agents:
        for name in agent_names():
            console.print(name)
        return 0
    check(args)
    episodes, split = plan_episodes(args)
    tell_house(args, console)
    args = replace(args, out=args.out or Path("runs") / time.strftime("%Y-%m-%d_%H-%M-%S"))
    if args.shard is not None and args.out is not None:
        share = Shard.parse(args.shard)
        episodes, args = share.select(episodes), replace(args, out=args.out / share.folder)
    lines, summary = play_missing(args, episodes, split, console)
    display.print_results(console, lines, summary)
    if args.video:
        console.print(f"Videos are in {args.out}/videos.", highlight=False, soft_wrap=True)
    return 1 if summary["errors"] else 0


def play_missing(
    args: Args, episodes: Sequence[Episode], split: dict[str, Any], console: Console
) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Play what is not in the folder `args.out` yet; returns all lines of the folder, and their summary.

    Args:
        args: checked options; the folder may hold a run with the same ones, but for the number of episodes.
        episodes: of `plan_episodes`, or some of them.
        split: what identifies where they come from.
        console: for progress.

    Raises:
        ConfigError: nothing can be written there, or a run with other options is there.
    """
    assert args.out is not None
    executor = make_executor(args.executor, workers=args.workers, address=args.address)
    config = config_of(args, split)
    run = RunDirectory(args.out, config)
    try:
        done = {line["episode_id"] for line in run.lines}
        todo = [episode for episode in episodes if episode.episode_id not in done]
        console.print(
            f"{args.agent} with {args.semantics} semantics, {len(episodes)} episodes of {split['name']} "
            f"(version {split['version']}), drawn by {config['versions']['gl_renderer']}; results in {args.out}"
        )
        if len(todo) < len(episodes):
            console.print(f"{len(episodes) - len(todo)} of them were there already, {len(todo)} to go.")
        others = run.record_code(code_hash()) if todo else []
        if others:
            console.print(
                f"Episodes that were there were played by other code ({', '.join(others)}) than these ({code_hash()}).",
                highlight=False,
                soft_wrap=True,
            )
        spec = RunnerSpec("sim.run:EpisodePlayer", args)
        lines = executor.run(spec, todo, on_death=lambda episode: _death_line(args, episode))
        for line in () if not todo else display.with_progress(console, lines, total=len(todo)):
            run.append(line)
        return run.lines, run.write_summary({"split": split})
    finally:
        run.close()


def tell_house(args: Args, console: Console) -> None:
    """Say what was left out of a house from elsewhere, and what has no label."""
    if args.house is not None and args.labels is not None:
        for note in load_house(args.house, labels_path=args.labels).notes:
            console.print(f"House '{args.house.stem}': {note}", highlight=False, markup=False, soft_wrap=True)


def agent_names() -> list[str]:
    """Every name that --agent takes."""
    return [*agents.NAMES, "oracle"]


def plan_episodes(args: Args) -> tuple[list[Episode], dict[str, Any]]:
    """The episodes to play, and what identifies where they come from.

    Raises:
        ConfigError, EpisodeError, HouseError: what was asked for is not there.
    """
    start = _parse_start(args.start_deg)
    env = ObjectNavEnv(
        split=args.split,
        house=args.house,
        labels=args.labels,
        goal=args.goal,
        start=start,
        sensors=(),
        profile="fast",
        **_body(args),
    )
    try:
        split = env.split
        if args.house is None:
            episodes = [episode for episode in split.episodes if args.goal in (None, episode.goal)]
            if args.episodes > len(episodes):
                raise ConfigError(
                    f"--episodes {args.episodes}: split '{split.name}' has {len(episodes)} episodes"
                    + (f" with goal '{args.goal}'." if args.goal else ".")
                )
            episodes = episodes[: args.episodes]
        else:
            episodes = [
                env.draw_episode(np.random.default_rng([args.seed, i]), episode_id=f"{args.house.stem}_{i:04d}")
                for i in range(args.episodes)
            ]
    finally:
        env.close()
    return episodes, {"name": split.name, "version": split.version, "sha256": split.sha256}


def make_agent(args: Args, env: ObjectNavEnv) -> Agent:
    """The agent of that name, for this environment.

    Raises:
        ConfigError: there is no agent or no factory of that name.
    """
    if args.agent == "oracle":
        return Oracle(env)
    robot = env.robot_model
    looks = args.agent not in SEMANTICS_DO_NOT_MATTER
    segmenter = make_segmenter(args.semantics if looks else TRUTH, env, weights=args.weights)
    if args.agent in agents.NAMES:
        verifier = verifier_for(args.semantics, KINDS[args.semantics].spec, args.verifier, args.verification)
        return agents.make(args.agent, camera=env.camera_model, robot=robot, segmenter=segmenter, verifier=verifier)
    return _load_factory(args.agent)(camera=env.camera_model, robot=robot, segmenter=segmenter)


class EpisodePlayer:
    """One process's environment and agent; see `sim.evaluation.workers`."""

    def __init__(self, args: Args) -> None:
        self._args = args
        self._env = ObjectNavEnv(
            split=args.split,
            house=args.house,
            labels=args.labels,
            sensors=_sensors(args),
            truth=_truth(args),
            profile=args.profile,
            noise=args.noise,
            **_body(args),
        )
        self._agent = make_agent(args, self._env)
        self._viewers = selection.make(args, draw.painter_of(self._agent))
        self._about = {
            "profile": args.profile,
            "noise": args.noise,
            "split": {"name": self._env.split.name, "version": self._env.split.version},
            "versions": _versions(),
        }

    def run(self, episode: Episode) -> dict[str, Any]:
        """One episode, to one result line."""
        seed = episode_seed(self._args.seed, episode.episode_id)
        try:
            metrics = play_episode(self._env, self._agent, episode, seed=seed, viewers=self._viewers)
        except EpisodeError as error:
            return _error_line(self._args, episode, str(error))
        line = _identity(self._args, episode) | metrics
        if self._args.record and self._args.out is not None:
            record_episode(self._env, self._args.out, line, self._about)
        return line

    def close(self) -> None:
        """Free the renderers; discard unfinished recordings."""
        for viewer in self._viewers:
            viewer.close()
        self._env.close()


def _truth(args: Args) -> tuple[str, ...]:
    """Images that are rendered beside what the agent reads: for a noisy detector, and for who looks on."""
    return truth_needed(args.semantics) + VIEWER_IMAGES * selection.any_selected(args)


def _body(args: Args) -> dict[str, Any]:
    """Robot and camera of --robot, as the environment takes them; nothing for ours."""
    if args.robot is None:
        return {}
    robot, camera = load_robot(args.robot)
    return {"robot": robot, "camera": camera}


def _sensors(args: Args) -> tuple[str, ...]:
    """Image sensors that the agent reads; an agent from elsewhere gets all of them."""
    if args.agent in SEMANTICS_DO_NOT_MATTER:
        return ()
    if args.agent in agents.NAMES:
        return ("depth", *SEMANTICS[args.semantics])
    return ALL_SENSORS


def _identity(args: Args, episode: Episode) -> dict[str, Any]:
    return {
        "episode_id": episode.episode_id,
        "house": episode.house,
        "goal": episode.goal,
        "agent": args.agent,
        "semantics": args.semantics,
        "seed": args.seed,
    }


def _error_line(args: Args, episode: Episode, error: str) -> dict[str, Any]:
    """The line of an episode that never ran to an end."""
    nothing = {"distance_to_goal": None, "shortest_path": episode.shortest_path_m, "trapped": None, "failure": None}
    counts = {"num_steps": 0, "path_length": 0.0, "collisions": 0, "gt_explored": None, "wall_time_s": 0.0}
    return _identity(args, episode) | nothing | counts | {"steps_per_s": 0.0} | broken_metrics(error)


def _death_line(args: Args, episode: Episode) -> dict[str, Any]:
    return _error_line(args, episode, f"House '{episode.house}': the worker died twice in this episode.")


def _load_factory(name: str) -> Any:
    module_name, _, factory_name = name.partition(":")
    if not factory_name:
        raise ConfigError(
            f"Unknown agent '{name}'. There is: {', '.join(agent_names())}, or your own as package.module:factory."
        )
    if "" not in sys.path:
        sys.path.insert(0, "")  # `python -m` has it, the spawned workers and an installed script have not
    try:
        module = importlib.import_module(module_name)
    except ModuleNotFoundError as error:
        raise ConfigError(f"Agent '{name}': no module '{error.name}' can be imported from here.") from None
    factory = getattr(module, factory_name, None)
    if not callable(factory):
        raise ConfigError(f"Agent '{name}': module '{module_name}' has no function '{factory_name}'.")
    return factory


def check(args: Args) -> None:
    """Raise ConfigError where options do not go together or name what there is not."""
    if args.episodes < 1:
        raise ConfigError(f"--episodes must be at least 1, got {args.episodes}.")
    if args.workers < 1:
        raise ConfigError(f"--workers must be at least 1, got {args.workers}.")
    if args.seed < 0:
        raise ConfigError(f"--seed must be at least 0, got {args.seed}.")
    if args.house is None and (args.labels is not None or args.start_deg is not None):
        raise ConfigError("--labels and --start-deg go with --house.")
    selection.check(args)
    if args.shard is not None:
        Shard.parse(args.shard)
        if args.out is None:
            raise ConfigError(f"--shard {args.shard} needs --out: one folder for all shards.")
    get_profile(args.profile)
    get_noise(args.noise)
    check_semantics(args.semantics, args.weights)
    verifier_for(args.semantics, KINDS[args.semantics].spec, args.verifier, args.verification)
    if args.agent not in agent_names():
        _load_factory(args.agent)


def _parse_start(text: str | None) -> Pose | None:
    if text is None:
        return None
    try:
        x_m, y_m, yaw_deg = (float(word) for word in text.split())
    except ValueError:
        raise ConfigError(f'--start-deg must be three numbers "X Y YAW" in metres and degrees, got "{text}".') from None
    if not all(math.isfinite(value) for value in (x_m, y_m, yaw_deg)):
        raise ConfigError(f'--start-deg must be finite, got "{text}".')
    return Pose(x_m, y_m, math.radians(yaw_deg))


def config_of(args: Args, split: dict[str, Any]) -> dict[str, Any]:
    """What `config.json` says: every option, the split and the versions that made the results."""
    options = {key: str(value) if isinstance(value, Path) else value for key, value in asdict(args).items()}
    del options["list_agents"]
    noise: dict[str, Any] = {"noise_config": asdict(get_noise(args.noise))}
    noise |= describe_semantics(args.semantics, args.weights)
    if args.robot is not None:
        noise["robot_sha256"] = robot_sha256(args.robot)
    return options | noise | {"split_identity": split, "versions": _versions()}


def _versions() -> dict[str, str]:
    """What made the results: packages, the renderer, and a hash of our own code."""
    packages = ("stubborn-objectnav", "mujoco", "numpy")
    return {name: version(name) for name in packages} | {"gl_renderer": describe_gl(), "code": code_hash()}


def entry(argv: Sequence[str] | None = None) -> int:
    """The command line."""
    try:
        return cli.run(Args, main, argv)
    except KeyboardInterrupt:
        print("\nStopped. The same command with the same --out goes on where it was.", file=sys.stderr)
        return 130


if __name__ == "__main__":
    from sim.run import entry as importable_entry  # spawned workers import `sim.run`, not `__main__`

    sys.exit(importable_entry())
