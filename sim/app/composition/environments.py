"""The environment of a run, and its episodes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from sim.app.bridges.process_command import takes_words
from sim.app.composition.setup import Setup
from sim.app.options import RunOptions
from sim.core.errors import ConfigError, did_you_mean
from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES
from sim.core.vocabulary import counted, vocabulary
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.episode import Episode
from sim.episodes.replicates import with_replicates
from sim.episodes.seeds import drawing_generator
from sim.episodes.splits import Split
from sim.sensors.noise import get_noise
from sim.sensors.sensor import Sensor


def make_env(setup: Setup, *, sensors: tuple[str | Sensor, ...], truth: tuple[str, ...] = ()) -> ObjectNavEnv:
    """Returns the environment of a run.

    Args:
        setup: of the run.
        sensors: sensors in the observation.
        truth: further images, without noise, that are rendered.
    """
    return ObjectNavEnv(**env_options(setup), sensors=sensors, truth=truth)


def env_options(setup: Setup) -> dict[str, Any]:
    """Returns the arguments of the environment of a run, except for sensors and true images."""
    options, config = setup.options, setup.config
    return {
        "split": options.split,
        "house": options.house,
        "labels": options.labels,
        "root": options.root if options.house is not None else None,
        "goal": options.goal if options.house is not None else None,
        "start": setup.start,
        "profile": config.profile,
        "noise": config.noise,
        "robot": config.robot,
        "camera": config.camera,
        "cameras": config.cameras,
        "look": setup.spec.looks,
        "scan": config.scan,
        "task": config.task,
    }


class RunEpisodes(NamedTuple):
    """The episodes of a run."""

    episodes: list[Episode]
    split: dict[str, str]
    """Identity of the split or house that they come from."""
    notes: tuple[str, ...] = ()
    """Sentences about what was changed in a house with `--labels`."""


def episodes_of(setup: Setup) -> RunEpisodes:
    """Returns the episodes of a run.

    Raises:
        ConfigError, EpisodeError, HouseError: the split, house, goal or start does not exist.
    """
    options, notes = setup.options, ()
    env = make_env(setup, sensors=())
    try:
        split = env.split
        if options.house is None:
            fitting = tuple(episode for episode in split.episodes if takes(setup, episode))
            split_of_agent = replace(split, episodes=fitting)
            if not split_of_agent.episodes:
                raise _nothing_for(setup, f"Split '{split.name}'", split.episodes)
            choose = _named_episodes if options.only else _first_episodes
            episodes = choose(split_of_agent, options)
        else:
            episodes = drawn_episodes(env, setup)
            notes = env.notes_on(split.houses[0]) if options.labels is not None else ()
    finally:
        env.close()
    return RunEpisodes(with_replicates(episodes, options.replicates), split.identity, notes)


def known_goals(setup: Setup) -> tuple[str, ...]:
    """Returns the goal categories that the agent of a run knows; it gets no other episodes."""
    return GOAL_CATEGORIES if setup.spec.goals is None else setup.spec.goals(setup.config.agent)


def takes(setup: Setup, episode: Episode) -> bool:
    """Returns whether the agent of a run takes all goals of an episode; only one that knows the truth takes labels."""
    spec, known, others = setup.spec, known_goals(setup), takes_words(setup.config.agent)
    taken = {
        "words": others and spec.words is not None,
        "description": others and spec.words is not None,
        "instance": others and spec.words is not None and spec.uses_ground_truth,
        "picture": others and spec.pictures is not None,
    }
    return all(taken.get(goal.kind, goal.text in known) for goal in episode.specs)


MAX_REPEATS = 60
"""Number of consecutive draws without a new episode after which the search for further ones ends."""


def drawn_episodes(env: ObjectNavEnv, setup: Setup) -> list[Episode]:
    """Returns new episodes in the only house of a run; without noise they are all different.

    Raises:
        ConfigError: there are too few different episodes: start and goal are fixed, or few goals can be reached.
    """
    options, (house,) = setup.options, env.split.houses
    repeats = setup.config.noise != get_noise("none") or bool(env.split.sidecar(house).noise)
    episodes: dict[tuple[str, Pose] | int, Episode] = {}
    refused, i, last = list[Episode](), 0, 0
    while len(episodes) < options.episodes and i - last <= MAX_REPEATS:
        episode = env.draw_episode(drawing_generator(options.seed, i), episode_id=f"{house}_{len(episodes):04d}")
        key = i if repeats else (episode.goal, episode.start)
        i += 1
        if not takes(setup, episode):
            refused.append(episode)
        elif key not in episodes:
            episodes[key], last = episode, i
    if not episodes:
        raise _nothing_for(setup, f"House '{house}'", refused)
    if len(episodes) < options.episodes:
        raise ConfigError(
            f"House '{house}' has {counted(len(episodes), 'different episode')} with "
            f"this start and goal, but --episodes is {options.episodes} (by default {RunOptions.episodes}); give "
            f"--episodes {len(episodes)}, or --noise realsense."
        )
    return list(episodes.values())


def _nothing_for(setup: Setup, place: str, episodes: Sequence[Episode]) -> ConfigError:
    """Returns the error for episodes of which the agent takes none."""
    kinds = {goal.kind for episode in episodes for goal in episode.specs}
    agent = setup.options.agent
    if kinds <= {"words", "description"} and setup.spec.words is None:
        return ConfigError(
            f"Agent '{agent}' takes no goals in words; an agent declares them with AgentSpec.words "
            "(docs/words.md#agents)."
        )
    if kinds == {"picture"} and setup.spec.pictures is None:
        return ConfigError(
            f"Agent '{agent}' takes no pictures as goals; an agent declares them with AgentSpec.pictures "
            "(docs/words.md)."
        )
    known = ", ".join(known_goals(setup))
    return ConfigError(f"{place} has no episode with a goal that the agent '{agent}' knows: {known}.")


def _named_episodes(split: Split, options: RunOptions) -> list[Episode]:
    """Returns the episodes that the option `only` names, in the order of the split.

    Raises:
        ConfigError: the split has no such episode, or it has another goal than the one that the options name.
    """
    of_goal = [episode for episode in split.episodes if options.goal in (None, episode.goal)]
    ids = [episode.episode_id for episode in of_goal]
    for name in options.only:
        if name not in ids:
            with_goal = f" with goal '{options.goal}'" if options.goal else ""
            raise ConfigError(
                f"--only '{name}': split '{split.name}' has no such episode{with_goal}.{did_you_mean(name, ids)}"
            )
    return [episode for episode in of_goal if episode.episode_id in options.only]


def _first_episodes(split: Split, options: RunOptions) -> list[Episode]:
    """Returns the first episodes of a split, as many as the options ask for, with their goal if they name one.

    Raises:
        ConfigError: the split has fewer episodes, or no episode with this goal.
    """
    goals = list(dict.fromkeys(episode.goal for episode in split.episodes))
    goals.sort(key=lambda goal: GOAL_CATEGORIES.index(goal) if goal in GOAL_CATEGORIES else len(GOAL_CATEGORIES))
    if options.goal is not None and options.goal not in goals:
        word = vocabulary().find(options.goal)
        category = "" if word is None else vocabulary().main_category(word.names)
        hint = f" Did you mean '{category}'?" if category in goals else did_you_mean(options.goal, goals)
        raise ConfigError(
            f"--goal '{options.goal}': split '{split.name}' has no such episode.{hint} It has: {', '.join(goals)}."
            " Other words need a house (--house)."
        )
    episodes = [episode for episode in split.episodes if options.goal in (None, episode.goal)]
    if options.episodes > len(episodes):
        with_goal = f" with goal '{options.goal}'" if options.goal else ""
        raise ConfigError(
            f"Split '{split.name}' has {len(episodes)} episodes{with_goal}, and {options.episodes} were asked for "
            f"(--episodes, by default {RunOptions.episodes}); give --episodes {len(episodes)}."
        )
    return episodes[: options.episodes]
