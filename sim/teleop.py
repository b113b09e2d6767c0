"""Drive the robot yourself: `python -m sim.teleop`, or `python -m sim.teleop --goal sofa --out runs/mine`.

The second composition root beside `sim.run`, and as such allowed to know `stubborn`: an agent of its kind looks on,
so that the map on the screen is the one that it would build from what you let it see.

You play an episode of a split, by default the first that is not in `--out` yet. It is recorded like any agent's: a
line in `results.jsonl` (agent `human`), a trajectory file, a summary; the tools for runs take it. Quitting records
nothing.
"""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from sim import cli, run
from sim.analysis import display
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Episode
from sim.evaluation.results import RunDirectory
from sim.evaluation.rollout import episode_seed, play_episode, record_episode
from sim.interface import MPCAT40, MPCAT40_ID, Action, ConfigError, Observation
from sim.robot.foreign import load_robot
from sim.viewers.overlay import ACTION_WORDS, colour_depth, in_words
from sim.viewers.palette import colour_segmentation
from sim.viewers.terminal import Colours, Terminal, beside, fitted, half_blocks
from sim.viewers.video import VideoRecorder
from stubborn.agent import StubbornAgent
from stubborn.draw import BeliefPainter, describe_intention
from stubborn.segmentation.ground_truth import GroundTruthSegmenter

KEYS: dict[str, Action] = {
    "w": Action.MOVE_FORWARD,
    "up": Action.MOVE_FORWARD,
    "a": Action.TURN_LEFT,
    "left": Action.TURN_LEFT,
    "d": Action.TURN_RIGHT,
    "right": Action.TURN_RIGHT,
    "x": Action.STOP,
}
HELP = "arrows or wad drive  x STOP  g distance  c camera  m layout  p plan  q quit"
CAMERAS = ("rgb", "semantic", "depth")
LAYOUTS = ("both", "camera", "map")
_STRUCTURE = frozenset(MPCAT40_ID[name] for name in ("void", "wall", "floor", "ceiling", "door", "window"))


@dataclass(frozen=True, kw_only=True)
class Args:
    """Look for an object yourself, with the keys of a terminal."""

    split: str = "val"
    """A shipped split, or a folder laid out like one."""
    episode_id: str | None = None
    """Which episode; by default the first that is not in --out yet."""
    house: Path | None = None
    """One MJCF file in place of a split."""
    labels: Path | None = None
    """With --house: a JSON file {"regex over names": "category"} for houses from elsewhere."""
    goal: str | None = None
    """Only this goal category."""
    start_deg: str | None = None
    """With --house: the start pose "X Y YAW" in metres and degrees."""
    robot: Path | None = None
    """Another robot in place of ours: an MJCF file with its sidecar beside it (docs/worlds.md)."""
    seed: int = 0
    """Drives noise and, with --house, start and goal."""
    profile: str = "fast"
    """Rendering quality: fast or good."""
    noise: str = "none"
    """Noise of sensors and drive: none, realsense or harsh."""
    out: Path | None = None
    """Where the record goes (runs/<time>); episodes are added to a record that is there."""
    video: bool = False
    """Leave an MP4 of the episode in <out>/videos."""
    colours: Literal["auto", "true", "256"] = "auto"
    """Of the terminal: 24 bits, 256, or what it says of itself."""


class Quit(Exception):
    """The driver has left."""


class Cockpit(Protocol):
    """Where pictures are shown and keys come from; `sim.viewers.terminal.Terminal` is one."""

    colours: Colours

    @property
    def size(self) -> tuple[int, int]: ...  # noqa: D102
    def show(self, lines: Sequence[str]) -> None: ...  # noqa: D102
    def key(self) -> str: ...  # noqa: D102


class Human:
    """An `Agent` that asks a person; a Stubborn agent draws the map and would know what to do."""

    def __init__(self, env: ObjectNavEnv, cockpit: Cockpit) -> None:
        self._env, self._cockpit = env, cockpit
        self.mapper = StubbornAgent(camera=env.camera_model, robot=env.robot_model, segmenter=GroundTruthSegmenter())
        self.painter = BeliefPainter(self.mapper, show_plan=False)
        self.camera, self.layout = CAMERAS[0], LAYOUTS[0]

    def reset(self, goal: str, seed: int) -> None:
        """Start a new episode."""
        self.mapper.reset(goal, seed)

    def act(self, observation: Observation) -> Action:
        """Show what there is to see until a key says what to do.

        Raises:
            Quit: the key for leaving.
        """
        self.mapper.act(observation)  # maps; what it would do is only shown when asked for
        message = self._news()
        while True:
            self._cockpit.show(self._screen(observation, message))
            key = self._cockpit.key()
            if key in KEYS:
                self.mapper.last_action = KEYS[key]  # what it learns of collisions from is what was really done
                return KEYS[key]
            if key in ("q", ""):
                raise Quit
            message = self._answer(key)

    def _answer(self, key: str) -> str:
        """Do what a key asks for that moves nothing; what to say."""
        if key == "g":
            distance_m = self._env.scene.task.metrics()["distance_to_goal"]
            return "there is no way to the goal" if distance_m is None else f"goal: {distance_m:.1f} m to go"
        if key == "c":
            self.camera = _next(CAMERAS, self.camera)
            return f"camera shows {self.camera}"
        if key == "m":
            self.layout = _next(LAYOUTS, self.layout)
            return f"layout: {self.layout}"
        if key == "p":
            self.painter.show_plan = not self.painter.show_plan
            advised = self.mapper.last_action
            if advised is None or not self.painter.show_plan:
                return "the agent's plan is not shown any more"
            return f"the agent would: {ACTION_WORDS[advised]} ({describe_intention(self.mapper)})"
        return "that key does nothing"

    def _news(self) -> str:
        """What the last action did."""
        motion = self._env.motion
        if motion is None:
            return "you stand at the start"
        if motion.collided:
            return f"{ACTION_WORDS[motion.action]}: COLLISION, something stopped the body"
        return f"{ACTION_WORDS[motion.action]}: done"

    def _screen(self, observation: Observation, message: str) -> list[str]:
        """The lines of the whole screen."""
        columns, lines = self._cockpit.size
        step = self._env.scene.task.num_steps + 1
        head = wrap(f"Look for: {in_words(self.mapper.goal).upper()}, step {step}. {message}", columns)
        foot = [*wrap(f"in sight: {_names_in_sight(observation['semantic'])}", columns), *wrap(HELP, columns)]
        room = max(2, lines - len(head) - len(foot))
        blocks, widths = [], []
        share = columns if self.layout != "both" else (columns - 2) // 2
        if self.layout != "map":
            picture = fitted(self._picture(observation), share, room)
            blocks.append(half_blocks(picture, self._cockpit.colours))
            widths.append(picture.shape[1])
        if self.layout != "camera":
            size = max(4, min(share, 2 * room) // 2 * 2)
            blocks.append(half_blocks(self.painter.paint(size), self._cockpit.colours))
            widths.append(size)
        return [*head, *beside(blocks, widths), *foot][:lines]

    def _picture(self, observation: Observation) -> NDArray[np.uint8]:
        if self.camera == "semantic":
            return colour_segmentation(observation["semantic"])
        if self.camera == "depth":
            return colour_depth(observation["depth"], self._env.camera_model)
        return observation["rgb"]


def main(args: Args) -> int:
    """Play one episode; returns the exit status."""
    console = display.make_console()
    terminal = Terminal()
    if args.colours != "auto":
        terminal.colours = args.colours
    try:
        with terminal:
            terminal.show(["Setting the house up ..."])
            out, line = drive(args, terminal)
    except (Quit, KeyboardInterrupt):
        console.print("You left before the end: nothing was recorded.")
        return 0
    words = "found" if line["success"] else f"not found ({line['failure']})"
    console.print(
        f"{line['episode_id']}: {line['goal']} {words} after {line['num_steps']} steps, SPL {line['spl']:.2f}, "
        f"{line['collisions']} collisions; recorded in {out}",
        highlight=False,
        soft_wrap=True,
    )
    return 0


def drive(args: Args, cockpit: Cockpit) -> tuple[Path, dict[str, Any]]:
    """Play an episode in a terminal and record it; its folder and its result line.

    Raises:
        ConfigError, EpisodeError, HouseError: what was asked for is not there.
        Quit: the driver left before the end.
    """
    options = run_options(args)
    assert options.out is not None
    episodes, split = plan(args, options)
    begun_here = not (options.out / "config.json").exists()
    record = RunDirectory(options.out, run.config_of(options, split))
    try:
        episode = choose(args, episodes, {line["episode_id"] for line in record.lines})
        line = play(args, options.out, episode, cockpit, run.config_of(options, split))
        record.append(line)
        record.write_summary({"split": split})
    except (Quit, KeyboardInterrupt):
        if begun_here:
            _leave_nothing(options.out)
        raise
    finally:
        record.close()
    return options.out, line


def _leave_nothing(out: Path) -> None:
    """Take back a folder in which nothing was recorded, so that the next start there may have other options."""
    for name in ("config.json", "results.jsonl", ".lock"):
        (out / name).unlink(missing_ok=True)
    for folder in (out / "videos", out):
        with contextlib.suppress(OSError):  # not there, or somebody keeps something in it
            folder.rmdir()


def run_options(args: Args) -> run.Args:
    """What `sim.run` would call this run."""
    return run.Args(
        agent="human",
        semantics="gt",
        split=args.split,
        house=args.house,
        labels=args.labels,
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


def plan(args: Args, options: run.Args) -> tuple[list[Episode], dict[str, Any]]:
    """All episodes that could be played, and what identifies where they come from."""
    if args.house is not None:  # one is drawn from the seed
        return run.plan_episodes(options)
    env = ObjectNavEnv(split=args.split, goal=args.goal, sensors=())
    try:
        split = env.split
    finally:
        env.close()
    episodes = [episode for episode in split.episodes if args.goal in (None, episode.goal)]
    return episodes, {"name": split.name, "version": split.version, "sha256": split.sha256}


def choose(args: Args, episodes: Sequence[Episode], done: set[str]) -> Episode:
    """The episode to play.

    Raises:
        ConfigError: there is none of that name, or it was played already.
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
    raise ConfigError(f"There is no episode '{args.episode_id}' here; there are '{left[0].episode_id}' and others.")


def play(args: Args, out: Path, episode: Episode, cockpit: Cockpit, config: dict[str, Any]) -> dict[str, Any]:
    """Let somebody drive through an episode; its result line, once the trajectory is written."""
    robot, camera = (None, None) if args.robot is None else load_robot(args.robot)
    env = ObjectNavEnv(
        split=args.split,
        house=args.house,
        labels=args.labels,
        sensors=run.ALL_SENSORS,
        truth=run.ALL_SENSORS,
        profile=args.profile,
        noise=args.noise,
        robot=robot,
        camera=camera,
    )
    human = Human(env, cockpit)
    viewers = [VideoRecorder(out, BeliefPainter(human.mapper, show_plan=False))] if args.video else []
    try:
        seed = episode_seed(args.seed, episode.episode_id)
        metrics = play_episode(env, human, episode, seed=seed, viewers=viewers)
        identity = {"episode_id": episode.episode_id, "house": episode.house, "goal": episode.goal}
        line = identity | {"agent": "human", "semantics": "gt", "seed": args.seed} | metrics
        about = {"profile": args.profile, "noise": args.noise, "split": config["split_identity"]}
        record_episode(env, out, line, about | {"versions": config["versions"]})
        return line
    finally:
        for viewer in viewers:
            viewer.close()
        env.close()


def _names_in_sight(semantic: NDArray[np.uint8], most: int = 8) -> str:
    """The furniture in the picture, the largest first."""
    counts = np.bincount(semantic.ravel(), minlength=len(MPCAT40))
    shown = [i for i in np.argsort(-counts, kind="stable").tolist() if counts[i] and i not in _STRUCTURE]
    return ", ".join(in_words(MPCAT40[i]) for i in shown[:most]) or "no furniture"


def _next(choices: Sequence[str], now: str) -> str:
    return choices[(choices.index(now) + 1) % len(choices)]


def entry(argv: Sequence[str] | None = None) -> int:
    """The command line."""
    return cli.run(Args, main, argv)


if __name__ == "__main__":
    sys.exit(entry())
