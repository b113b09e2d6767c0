"""Records an episode that a person drove, in the format of `--record`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn

from sim.app.composition.record import identity_of
from sim.app.composition.setup import RunConfig, Setup, resolve
from sim.app.evaluation.last_view import write_last_view
from sim.app.evaluation.rollout import record_episode
from sim.app.options import RunOptions
from sim.core.errors import ConfigError
from sim.core.interface import AgentSpec
from sim.core.invocation import command
from sim.core.option_types import meanings
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode

HUMAN_NAME = "human"
"""The agent's name in the results of a person."""


def _make_human(**_: object) -> NoReturn:
    raise ConfigError(f"A person drives in the browser: `{command('web')}`.")


HUMAN = AgentSpec(
    make=_make_human,
    description="a person at the page of stubborn web",
    sensors=("rgb", "depth", "semantic"),
    uses_segmentation=False,
    uses_ground_truth=True,
)
"""The declaration of a person, who sees all images, the true segmentation included."""


def setup_of_person(setup: Setup, out: Path | None, *, with_agent: bool = False) -> Setup:
    """Returns the setup of a person that has the world of an agent's setup.

    Args:
        setup: the setup of the agent that could have driven.
        out: folder of the record.
        with_agent: whether the agent drove a part of the episode, so that the results are not those of a person alone.
    """
    of_person = RunOptions(
        agent=f"{HUMAN_NAME}+agent" if with_agent else HUMAN_NAME,
        semantics="gt",
        episodes=1,
        out=out,
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
    setup: Setup, env: ObjectNavEnv, episode: Episode, metrics: Mapping[str, Any], content: Mapping[str, Any]
) -> dict[str, Any]:
    """Writes trajectory and last picture of the episode that has just ended; returns its result line.

    Args:
        setup: the setup of the person.
        env: the environment of the episode.
        episode: the episode.
        metrics: the entries that `play_episode` returned.
        content: content of the record's `config.json`.

    Raises:
        ConfigError: the folder is not writable.
    """
    options = setup.options
    assert options.out is not None
    line = identity_of(setup, episode) | judged(metrics)
    about = {"profile": options.profile, "noise": options.noise, "split": content["split_identity"]}
    record_episode(env, options.out, line, about | {"versions": content["versions"]})
    write_last_view(env, options.out, line["episode_id"])
    return line


def judged(line: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the result line of an episode that a person ended: a STOP far from the goal is `misc`.

    `false_detection` says that a segmentation took another object for the goal. A person has no segmentation.
    """
    return {**line, "failure": "misc"} if line["failure"] == "false_detection" else dict(line)
