"""Replays recorded actions in physics, without an agent, and recomputes the metrics of each episode."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from gymnasium.utils.seeding import np_random
from numpy.typing import NDArray

from sim.app.submissions.contents import Entry
from sim.app.submissions.packing import places_of
from sim.app.submissions.setting import Setting
from sim.core.errors import EpisodeError, PhysicsError
from sim.core.interface import Action
from sim.env.oracle import Oracle
from sim.env.scene import Scene
from sim.episodes.episode import Episode
from sim.episodes.seeds import episode_seeds
from sim.episodes.splits import Split, load_split
from sim.robot.conditions import Conditions
from sim.sensors.noise import SensorNoise, noise_from_dict
from sim.task.objectnav import Task
from sim.task.result import EpisodeMetrics
from sim.world.world import World

Look = Callable[[], dict[str, NDArray]]
"""Returns the true images at the robot's current pose, by name."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """Everything that the episodes of a submission have in common."""

    split: str
    """Name or folder of the split."""
    setting: Setting
    seed: int


@dataclass(frozen=True)
class Replay:
    """An episode whose actions were replayed."""

    episode_id: str
    metrics: EpisodeMetrics | None
    """At the end; None: the actions could not be replayed."""
    places_m: tuple[tuple[float, float], ...]
    """See `Entry.places_m`."""
    framed: bool
    """The true frames were rendered, so that the metrics of what was seen count."""
    is_oracles: bool
    """Whether every action is the one that the oracle would have chosen there."""
    fault: str
    """A sentence on why the actions could not be replayed to the end of the episode; "": they could."""
    seconds: float
    """Processor time, that of the house included."""


def replay_house(job: Job, entries: Sequence[tuple[Entry, bool]]) -> list[Replay]:
    """Returns the replays of some episodes of one house.

    Args:
        job: common to all episodes.
        entries: episodes of one house, each with whether its frames are rendered.

    Raises:
        HouseError, RenderError: the house cannot be loaded or rendered on this machine, whatever the submission says.
    """
    began_s = time.process_time()
    split, setting = _split(job.split), job.setting
    episodes = [split.episode(entry.result.episode_id) for entry, _ in entries]
    world, task, look, close = _scene(
        split, episodes[0].house, setting, frames=any(with_frames for _, with_frames in entries)
    )
    verdicts = []
    try:
        for episode, (entry, framed) in zip(episodes, entries, strict=True):
            conditions = conditions_of(setting, split, episode, job.seed)
            verdicts.append(_replay(world, task, episode, entry, conditions, look if framed else None, began_s=began_s))
            began_s = time.process_time()
    finally:
        close()
    return verdicts


def conditions_of(setting: Setting, split: Split, episode: Episode, seed: int) -> Conditions:
    """Returns the conditions of the physics of an episode, as `ObjectNavEnv.reset` draws them from the run's seed."""
    fixed = split.sidecar(episode.house).noise
    noise = SensorNoise(noise_from_dict(fixed) if fixed else setting.noise, setting.camera, ())
    generator, _ = np_random(episode_seeds(seed, episode.episode_id).environment)
    return noise.begin(generator.spawn(1)[0], np.zeros(0, np.float32))


def _scene(
    split: Split, house: str, setting: Setting, *, frames: bool
) -> tuple[World, Task, Look | None, Callable[[], None]]:
    """Returns the world and task of a house, a function that renders frames if they are wanted, and one that closes."""
    loaded, robot, config = split.load_house(house), setting.robot, setting.task
    if not frames:
        world = World(loaded, robot=robot, rule=config.success)
        return world, Task(world, config, camera=setting.camera), None, lambda: None
    scene = Scene(loaded, robot=robot, camera=setting.camera, profile="fast", task=config)

    def look() -> dict[str, NDArray]:
        return scene.camera.render(scene.world.data, scene.world.camera_pose, scene.task.images)

    return scene.world, scene.task, look, scene.close


def _replay(
    world: World,
    task: Task,
    episode: Episode,
    entry: Entry,
    conditions: Conditions,
    look: Look | None,
    *,
    began_s: float,
) -> Replay:
    """Replays one episode; an error of the episode or the physics is its fault."""
    fault, metrics, places, is_oracles = "", None, (), False
    try:
        world.reset(episode.start, conditions)
        task.begin(episode.specs, episode.start)
        if look is not None:
            task.look(look())
        guide = _Guide(task)
        positions = np.array(list(_positions(world, task, entry, look, guide))).reshape(-1, 2)
        places = places_of(positions)
        metrics, is_oracles = task.metrics(), guide.agrees
        if not task.done:
            fault = f"the episode has not ended after its {len(entry.actions)} actions"
    except (EpisodeError, PhysicsError) as error:
        fault = str(error).rstrip(".")
    seconds = round(time.process_time() - began_s, 4)
    return Replay(episode.episode_id, metrics, places, look is not None, is_oracles, fault, seconds)


@dataclass(frozen=True)
class _Stage:
    """The environment of a replay, as the oracle sees it."""

    task: Task

    @property
    def scene(self) -> _Stage:
        return self


class _Guide:
    """Compares actions with those of the oracle, until the first one that differs."""

    def __init__(self, task: Task) -> None:
        self._oracle, self._task, self._goal_number = Oracle(_Stage(task)), task, task.goal_number
        self._oracle.reset("", 0)
        self.agrees = True

    def compare(self, action: Action) -> None:
        """Notes whether the oracle chooses this action where the robot is now."""
        if self.agrees and self._task.goal_number != self._goal_number:
            self._goal_number = self._task.goal_number
            self._oracle.next_goal("")
        self.agrees = self.agrees and self._oracle.choose() == action


def _positions(
    world: World, task: Task, entry: Entry, look: Look | None, guide: _Guide
) -> Iterator[tuple[float, float]]:
    """Carries out the actions and yields the robot's position after each one."""
    for action in map(Action, map(int, entry.actions)):
        result = entry.result if entry.result.goals is None else entry.result.goals[task.goal_number]
        if action is Action.STOP and result.stop_target_xy_m is not None:
            task.stops_for(*result.stop_target_xy_m)
        task.require_running()
        guide.compare(action)
        motion = world.move(action)
        task.observe(action, motion, None if look is None else look())
        yield world.pose.x_m, world.pose.y_m


@functools.lru_cache(maxsize=2)
def _split(name: str) -> Split:
    """Returns a split; a worker reads it once."""
    return load_split(name)
