"""Records an episode that a person drove, in the format of `--record`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import msgspec

from sim.app.composition.record import recording_of, result_of
from sim.app.composition.setup import RunConfig, Setup, resolve
from sim.app.evaluation.last_view import write_last_view
from sim.app.evaluation.results import HUMAN_NAME
from sim.app.evaluation.rollout import record_episode
from sim.app.options import RunOptions
from sim.core.interface import Action, AgentSpec, Observation
from sim.core.option_types import meanings
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.task.result import EpisodeResult, RolloutResult
from sim.task.trajectory import SplitName


class Person:
    """The `Agent` of an episode that has none: a person chooses every action."""

    def reset(self, goal: str, seed: int) -> None:
        """Does nothing."""

    def act(self, observation: Observation) -> Action:
        """Returns STOP, for a person who hands the episode over."""
        return Action.STOP


def _make_person(**_: object) -> Person:
    return Person()


HUMAN = AgentSpec(
    make=_make_person,
    description="a person at the page of stubborn web",
    sensors=("rgb", "depth", "semantic"),
    uses_segmentation=False,
    uses_ground_truth=True,
    words=(),
)
"""The declaration of a person, who sees all images, the true segmentation included."""


def setup_of_person(setup: Setup, *, with_agent: bool) -> Setup:
    """Returns the setup of a person that has the world of an agent's setup.

    Args:
        setup: the setup of the agent that could have driven.
        with_agent: whether the agent drove a part of the episode, so that the results are not those of a person alone.
    """
    of_person = RunOptions(
        agent=f"{HUMAN_NAME}+agent" if with_agent else HUMAN_NAME,
        semantics="gt",
        episodes=1,
        record=True,
        **_of_world(setup.options),
    )
    person, of_world = resolve(of_person, HUMAN), _of_world(setup.config)
    return replace(
        person,
        config=replace(person.config, **of_world),
        settings={path: value for path, value in setup.settings.items() if path.partition(".")[0] in of_world},
    )


def _of_world(options: RunOptions | RunConfig) -> dict[str, Any]:
    """Returns the fields that apply to a person as well as to an agent."""
    return {name: getattr(options, name) for name, option in meanings(type(options)).items() if option.of_world}


def record_driven(
    setup: Setup, env: ObjectNavEnv, episode: Episode, result: RolloutResult, versions: dict[str, str]
) -> EpisodeResult:
    """Writes trajectory and last picture of the episode that has just ended; returns its result.

    Args:
        setup: the setup of the person.
        env: the environment of the episode.
        episode: the episode.
        result: what `play_episode` returned.
        versions: those of the record's `config.json`.

    Raises:
        ConfigError: the folder is not writable.
    """
    out = setup.options.out
    assert out is not None
    judged = result_of(setup, episode, judged_result(result))
    split = SplitName(env.split.name, env.split.version)
    record_episode(env, out, recording_of(setup, episode, judged, split, versions))
    write_last_view(env, out, episode.episode_id)
    return judged


def judged_result(result: RolloutResult) -> RolloutResult:
    """Returns the result of an episode that a person ended: a STOP far from the goal is `misc`.

    `false_detection` says that a segmentation took another object for the goal. A person has no segmentation.
    """
    return msgspec.structs.replace(result, failure="misc") if result.failure == "false_detection" else result
