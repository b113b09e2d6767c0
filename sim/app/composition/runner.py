"""Runs the episodes of a worker process with one environment and one agent."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from sim.app.composition.agents import build_agent, free_agent
from sim.app.composition.environments import make_env
from sim.app.composition.own_segmentation import OwnSegmenter
from sim.app.composition.perception import AskedSegmenter, seen_by
from sim.app.composition.record import error_result, recording_of, result_of, versions
from sim.app.composition.segmenters import NoSegmentation
from sim.app.composition.setup import Setup
from sim.app.evaluation.last_view import write_last_view
from sim.app.evaluation.own_code import text_of
from sim.app.evaluation.rollout import play_episode, record_episode
from sim.app.evaluation.watch import is_stop
from sim.app.viewers import selection
from sim.app.viewers.viewer import VIEWER_IMAGES, MapPainter, SeesFrames, Viewer
from sim.core.errors import ConfigError, ObjectNavError, RenderError, debug
from sim.core.interface import Agent
from sim.env.memory import give_large_blocks_pages_of_their_own, return_freed_memory
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.seeds import episode_seeds
from sim.task.result import EpisodeResult, RolloutResult
from sim.task.trajectory import SplitName


class Play(Protocol):
    """A function that runs an episode, such as `play_episode`."""

    def __call__(
        self,
        env: ObjectNavEnv,
        agent: Agent,
        episode: Episode,
        *,
        seed: int,
        seed_of_agent: int | None = None,
        viewers: Sequence[Viewer] = (),
        name: str | None = None,
    ) -> RolloutResult:
        """Returns the result without the episode and the agent."""
        ...


@dataclass(frozen=True)
class Parts:
    """The environment of a run with the agent that acts in it."""

    env: ObjectNavEnv
    agent: Agent
    seen: SeesFrames | None
    """The segmentation that the agent acts on, if viewers need it; None: it has none."""
    painter: MapPainter | None
    """Draws the agent's map; None: it has none."""
    play: Play = play_episode
    """Runs one episode."""


def build_parts(setup: Setup, *, watched: bool) -> Parts:
    """Returns environment and agent of a run.

    Args:
        setup: the setup of the run.
        watched: whether viewers need all images.
    """
    spec, config = setup.spec, setup.config
    env = make_env(setup, sensors=setup.sensors, truth=setup.truth + VIEWER_IMAGES * watched)
    segmenter = made = setup.segmentation.make(env, config.detector) if spec.uses_segmentation else None
    if segmenter is not None and watched:
        segmenter = AskedSegmenter(segmenter, setup.segmentation_name)
    agent = build_agent(
        setup.options.agent,
        spec,
        env,
        segmenter=segmenter or NoSegmentation(),
        verifier=setup.verifier,
        config=config.agent,
        step_timeout_s=setup.options.step_limit_s,
        out=setup.options.out,
    )
    if isinstance(made, OwnSegmenter):
        made.require_read_by(agent, setup.options.agent)
    return Parts(env, agent, seen_by(setup, agent, segmenter), spec.painter(agent) if spec.painter else None)


class EpisodeRunner:
    """Runs episodes in one process; see `sim.app.evaluation.workers`.

    Args:
        setup: the setup of the run.
        make: makes the environment and the agent.
    """

    def __init__(self, setup: Setup, make: Callable[[Setup], Parts] | None = None) -> None:
        give_large_blocks_pages_of_their_own()
        setup = self._setup = setup.with_absolute_paths()  # the agent may change the folder of the process
        options = self._options = setup.options
        parts = build_parts(setup, watched=options.watched) if make is None else make(setup)
        self._env, self._agent, self._play = parts.env, parts.agent, parts.play
        setup.require_planned(self._env.split)
        self._house = ""
        self._viewers = selection.make(options, parts.painter, parts.seen)
        self._versions = versions(options)

    def run(self, episode: Episode) -> EpisodeResult:
        """Runs one episode and returns its result."""
        return_freed_memory()
        options = self._options
        seeds = episode_seeds(options.seed, episode.episode_id, options.seed_key)
        try:
            self._require_same_house(episode.house)
            ended = self._play(
                self._env,
                self._agent,
                episode,
                seed=seeds.environment,
                seed_of_agent=seeds.agent,
                viewers=self._viewers,
                name=options.agent,
            )
        except (ConfigError, RenderError, OSError):  # concerns every episode: an option, OpenGL, the disk
            raise
        except BaseException as error:  # one bad house, start or agent does not end a run of many
            if is_stop(error):
                raise
            return self._broken(episode, error)
        result = result_of(self._setup, episode, ended)
        if options.record and options.out is not None:
            split = SplitName(self._env.split.name, self._env.split.version)
            recording = recording_of(self._setup, episode, result, split, self._versions)
            record_episode(self._env, options.out, recording)
        if (options.record or options.video) and options.out is not None and not result.is_error:
            write_last_view(self._env, options.out, episode.episode_id)
        return result

    def _require_same_house(self, house: str) -> None:
        """Raises HouseError if a file of a house has changed since the run was planned.

        The files are checked each time that the house is loaded.
        """
        if house != self._house:
            self._env.split.require_unchanged(house)
            self._house = house

    def _broken(self, episode: Episode, error: BaseException) -> EpisodeResult:
        """Returns the result of an episode that raised an error; unfinished recordings are discarded."""
        if debug():
            traceback.print_exc()
        for viewer in self._viewers:
            viewer.close()
        reason = text_of(error)
        if not isinstance(error, ObjectNavError):
            reason = f"{type(error).__name__}: {reason} (unexpected; --debug shows where)"
        return error_result(self._setup, episode, reason)

    def close(self) -> None:
        """Frees the renderers and the agent; viewers discard an unfinished recording."""
        for viewer in self._viewers:
            viewer.close()
        free_agent(self._agent)
        self._env.close()
