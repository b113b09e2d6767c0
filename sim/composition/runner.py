"""The episode runner of a worker process: one environment and one agent that run episode after episode."""

from __future__ import annotations

import difflib
import traceback
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.composition.agents import build_agent, find_agent
from sim.composition.options import RunOptions, start_pose
from sim.composition.run_config import RunConfig, configuration_of, sensors_of, truth_images, verifier_of, versions
from sim.composition.segmenters import NoSegmentation, make_segmenter
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.splits import Episode, Split
from sim.errors import ConfigError, ObjectNavError, RenderError, debug
from sim.evaluation.last_view import write_last_view
from sim.evaluation.rollout import broken_metrics, episode_seed, play_episode, record_episode
from sim.interface import GOAL_CATEGORIES, Agent, AgentSpec, Segmenter
from sim.memory import give_large_blocks_pages_of_their_own, return_freed_memory
from sim.sensors.sensor import Sensor
from sim.viewers import selection
from sim.viewers.viewer import VIEWER_IMAGES, MapPainter


@dataclass(frozen=True)
class Parts:
    """The environment of a run with the agent that acts in it."""

    env: ObjectNavEnv
    agent: Agent
    segmenter: Segmenter | None
    """The agent's segmentation; None: it has none."""
    painter: MapPainter | None
    """Draws the agent's map; None: it has none."""


def build_parts(options: RunOptions, *, watched: bool) -> Parts:
    """Returns environment and agent of a run.

    Args:
        options: checked options.
        watched: whether viewers need all images.
    """
    spec, config = find_agent(options.agent), configuration_of(options)
    truth = truth_images(spec, options.semantics) + VIEWER_IMAGES * watched
    env = make_env(options, config, sensors=sensors_of(spec, config), truth=truth)
    segmenter = make_segmenter(options.semantics, env, config.detector) if spec.uses_segmentation else None
    verifier = verifier_of(options, config.verification)
    agent = build_agent(
        options.agent, spec, env, segmenter=segmenter or NoSegmentation(), verifier=verifier, config=config.agent
    )
    return Parts(env, agent, segmenter, spec.painter(agent) if spec.painter else None)


class EpisodeRunner:
    """Runs episodes in one process; see `sim.evaluation.workers`."""

    def __init__(self, options: RunOptions) -> None:
        give_large_blocks_pages_of_their_own()
        self._options = options
        self._spec = find_agent(options.agent)
        parts = build_parts(options, watched=selection.any_selected(options))
        self._env, self._agent = parts.env, parts.agent
        self._viewers = selection.make(options, parts.painter, parts.segmenter)
        self._about = {
            "profile": options.profile,
            "noise": options.noise,
            "split": {"name": self._env.split.name, "version": self._env.split.version},
            "versions": versions(options),
        }

    def run(self, episode: Episode) -> dict[str, Any]:
        """Runs one episode and returns its result line."""
        return_freed_memory()
        seed = episode_seed(self._options.seed, episode.episode_id)
        try:
            metrics = play_episode(
                self._env, self._agent, episode, seed=seed, viewers=self._viewers, name=self._options.agent
            )
        except (ConfigError, RenderError, OSError):  # concerns every episode: an option, OpenGL, the disk
            raise
        except Exception as error:  # one bad house, start or agent does not end a run of many
            return self._broken(episode, error)
        line = identity_of(self._options, self._spec, episode) | metrics
        if self._options.record and self._options.out is not None:
            record_episode(self._env, self._options.out, line, self._about)
        filmed = self._options.record or self._options.video
        if filmed and self._options.out is not None and line["end_reason"] != "error":
            write_last_view(self._env, self._options.out, line["episode_id"])
        return line

    def _broken(self, episode: Episode, error: Exception) -> dict[str, Any]:
        """Returns the line of an episode that raised an error; unfinished recordings are discarded."""
        if debug():
            traceback.print_exc()
        for viewer in self._viewers:
            viewer.close()
        told = str(error)
        if not isinstance(error, ObjectNavError):
            told = f"{type(error).__name__}: {told} (unexpected; --debug shows where)"
        return error_line(self._options, episode, " ".join(told.split()))

    def close(self) -> None:
        """Frees the renderers; viewers discard an unfinished recording."""
        for viewer in self._viewers:
            viewer.close()
        self._env.close()


def make_env(
    options: RunOptions, config: RunConfig, *, sensors: tuple[str | Sensor, ...], truth: tuple[str, ...] = ()
) -> ObjectNavEnv:
    """Returns the environment of a run.

    Args:
        options: checked options; they name the houses.
        config: the configuration tree of these options.
        sensors: sensors in the observation.
        truth: images without noise that are rendered besides.
    """
    return ObjectNavEnv(
        split=options.split,
        house=options.house,
        labels=options.labels,
        root=options.root,
        goal=options.goal if options.house is not None else None,
        start=start_pose(options.start_deg),
        sensors=sensors,
        truth=truth,
        profile=config.profile,
        noise=config.noise,
        robot=config.robot,
        camera=config.camera,
        task=config.task,
    )


def plan_episodes(options: RunOptions, spec: AgentSpec | None = None) -> tuple[list[Episode], dict[str, Any]]:
    """Returns the episodes of a run, and what identifies the split or house they come from.

    Raises:
        ConfigError, EpisodeError, HouseError: the split, house, goal or start does not exist.
    """
    env = make_env(options, configuration_of(options, spec), sensors=())
    try:
        split = env.split
        if options.house is None:
            episodes = _named_episodes(split, options) if options.only else _first_episodes(split, options)
        else:
            episodes = [
                env.draw_episode(np.random.default_rng([options.seed, i]), episode_id=f"{options.house.stem}_{i:04d}")
                for i in range(options.episodes)
            ]
    finally:
        env.close()
    return episodes, {"name": split.name, "version": split.version, "sha256": split.sha256}


def _named_episodes(split: Split, options: RunOptions) -> list[Episode]:
    """Returns the episodes that the option `only` names, in the order of the split.

    Raises:
        ConfigError: the split has no such episode, or it has another goal than the one that the options name.
    """
    of_goal = [episode for episode in split.episodes if options.goal in (None, episode.goal)]
    ids = [episode.episode_id for episode in of_goal]
    for name in options.only:
        if name not in ids:
            near = difflib.get_close_matches(name, ids, n=1)
            hint = f" Did you mean '{near[0]}'?" if near else ""
            with_goal = f" with goal '{options.goal}'" if options.goal else ""
            raise ConfigError(f"--only '{name}': split '{split.name}' has no such episode{with_goal}.{hint}")
    return [episode for episode in of_goal if episode.episode_id in options.only]


def _first_episodes(split: Split, options: RunOptions) -> list[Episode]:
    """Returns the first episodes of a split, as many as the options ask for, with their goal if they name one.

    Raises:
        ConfigError: the split has fewer, or none with this goal.
    """
    goals = [goal for goal in GOAL_CATEGORIES if any(episode.goal == goal for episode in split.episodes)]
    if options.goal is not None and options.goal not in goals:
        near = difflib.get_close_matches(options.goal, goals, n=1)
        hint = f" Did you mean '{near[0]}'?" if near else ""
        raise ConfigError(
            f"--goal '{options.goal}': split '{split.name}' has no such episode.{hint} It has: {', '.join(goals)}."
        )
    episodes = [episode for episode in split.episodes if options.goal in (None, episode.goal)]
    if options.episodes > len(episodes):
        with_goal = f" with goal '{options.goal}'" if options.goal else ""
        raise ConfigError(
            f"Split '{split.name}' has {len(episodes)} episodes{with_goal}, and {options.episodes} were asked for "
            f"(--episodes, by default {RunOptions.episodes}); give --episodes {len(episodes)}."
        )
    return episodes[: options.episodes]


def error_line(options: RunOptions, episode: Episode, error: str) -> dict[str, Any]:
    """Returns the result line of an episode that could not be run to its end."""
    nothing = {"distance_to_goal": None, "shortest_path": episode.shortest_path_m, "trapped": None, "failure": None}
    counts = {"num_steps": 0, "path_length": 0.0, "collisions": 0, "wall_time_s": 0.0}
    nothing |= dict.fromkeys(
        ("gt_explored", "first_seen_step", "steps_to_first_sight", "area_seen_m2", "area_per_metre")
    )
    identity = identity_of(options, find_agent(options.agent), episode)
    return identity | nothing | counts | {"steps_per_s": 0.0} | broken_metrics(error)


def identity_of(options: RunOptions, spec: AgentSpec, episode: Episode) -> dict[str, Any]:
    """Returns the part of a result line that names episode, agent and segmentation."""
    return {
        "episode_id": episode.episode_id,
        "house": episode.house,
        "goal": episode.goal,
        "agent": options.agent,
        "uses_ground_truth": spec.uses_ground_truth,
        "semantics": options.semantics,
        "seed": options.seed,
    }
