"""Checks of a submission against itself and against its split, before anything is replayed.

A contradiction is refused by one sentence. What passes is consistent; whether it is true is for the replay to say.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Literal

import msgspec

from sim.app.submissions.contents import PLACE_EVERY, Entry, Inputs, Submission
from sim.app.submissions.setting import Setting
from sim.core.errors import ConfigError
from sim.core.interface import TRUE_IMAGES, Action
from sim.core.reading import convert
from sim.episodes.episode import Episode
from sim.episodes.replicates import find_episode, replicate_number, with_replicates
from sim.episodes.splits import Split
from sim.robot.config import PHYSICS_VERSION
from sim.task import metrics
from sim.task.chain import chain_metrics
from sim.task.result import EpisodeResult, GoalMetrics

Truth = Literal["none", "noisy", "yes"]
"""Whether ground truth reached the agent: `noisy` is the true segmentation with the errors of a simulated detector."""
STOP = str(int(Action.STOP))
ROUNDING = 1e-6
"""Largest error of a recorded SPL."""


class _Tree(msgspec.Struct):
    sensors: tuple[str, ...] = ()


class _Segmentation(msgspec.Struct):
    name: str | None = None
    truth: tuple[str, ...] | None = None
    sensors: tuple[str, ...] | None = None


class _Recorded(msgspec.Struct):
    """The entries of a configuration about the inputs of its agent."""

    agent: str
    semantics: str
    seed: int
    config: _Tree
    segmentation: _Segmentation | None = None


def require_consistent(
    submission: Submission, config: Mapping[str, object], setting: Setting, split: Split, *, where: str
) -> None:
    """Raises ConfigError where a submission contradicts itself, its split, or this version of the simulator.

    Args:
        submission: from a file.
        config: its configuration.
        setting: its setting.
        split: the split on which it will be replayed.
        where: names the file for the error message.
    """
    _require_same_physics(submission, where)
    _require_same_split(submission, split, where)
    _require_declared(submission, config, setting, where)
    known = {episode.episode_id: episode for episode in split.episodes}
    for entry in submission.episodes:
        episode_id = entry.result.episode_id
        episode = find_episode(known, episode_id)
        if episode is None:
            raise ConfigError(f"{where}, episode '{episode_id}': the split '{split.name}' has no such episode.")
        _require_entry(entry, episode, submission, setting, f"{where}, episode '{episode_id}'")


def truth_of(inputs: Inputs) -> Truth:
    """Returns whether ground truth reached the agent, as the authors declare it."""
    if inputs.uses_ground_truth or inputs.semantics == "gt":
        return "yes"
    return "noisy" if inputs.semantics == "noisy" else "none"


PLACES = {
    "no": "in the process of the simulator",
    "yes": "in a process of its own, as the same user",
    "namespace": "in a process of its own, in namespaces",
}
"""Where an agent ran, by `isolation_text`."""


def isolation_text(inputs: Inputs) -> str:
    """Returns whether the agent ran in a process of its own, as the authors declare it: yes, no, or namespace."""
    return inputs.isolated if isinstance(inputs.isolated, str) else "yes" if inputs.isolated else "no"


def coverage(submission: Submission, split: Split) -> tuple[bool, str]:
    """Returns whether the episodes are the first ones of the split, and which they are as text.

    The order of a split is balanced over houses and goals, so that the authors do not choose the first N episodes.
    Of each episode there must be as many replicates, numbered from 0.
    """
    submitted = {entry.result.episode_id for entry in submission.episodes}
    replicates, total = 1 + max(map(replicate_number, submitted)), len(split.episodes)
    count = len(submitted) // replicates
    repeated = f", {replicates} replicates of each" if replicates > 1 else ""
    if submitted != {episode.episode_id for episode in with_replicates(split.episodes[:count], replicates)}:
        return False, f"{len(submitted)} of {total} episodes, chosen by the authors"
    return (
        True,
        f"all {total} episodes{repeated}" if count == total else f"the first {count} of {total} episodes{repeated}",
    )


def _require_same_physics(submission: Submission, where: str) -> None:
    recorded = submission.manifest.physics
    if recorded != PHYSICS_VERSION:
        raise ConfigError(
            f"{where} was made with physics of version {recorded}, this is version {PHYSICS_VERSION}: its actions lead "
            "elsewhere here; verify it with the release that it was made with, or run the agent again."
        )


def _require_same_split(submission: Submission, split: Split, where: str) -> None:
    made_on = submission.manifest.split
    if (made_on.version, made_on.sha256) != (split.version, split.sha256):
        raise ConfigError(
            f"{where} was made on the split '{made_on.name}' {made_on.version} with sha256 {made_on.sha256[:12]}, and "
            f"'{split.name}' {split.version} here has {split.sha256[:12]}; name the folder of its split with --split."
        )


def _require_declared(submission: Submission, config: Mapping[str, object], setting: Setting, where: str) -> None:
    """Raises ConfigError where the declared inputs are not those of the configuration or of the result lines."""
    inputs, record = submission.manifest.inputs, convert(dict(config), _Recorded, where=f"{where}, field 'config'")
    recorded = {
        "agent": record.agent,
        "semantics": record.semantics,
        "noise": setting.noise_name,
        "sensors": record.config.sensors,
    }
    for name, value in recorded.items():
        declared = getattr(inputs, name)
        if declared != value:
            raise ConfigError(f"{where} declares {name} {declared!r}, and its configuration has {value!r}.")
    if bool(inputs.isolated) != inputs.agent.startswith("process:"):
        raise ConfigError(f"{where} declares isolated {inputs.isolated} for the agent '{inputs.agent}'.")
    segmentation = record.segmentation or _Segmentation()
    absent = sorted({*(segmentation.sensors or ())} - {*inputs.sensors})
    if absent:
        raise ConfigError(f"{where}: its segmentation reads '{absent[0]}', which is not among the sensors of the run.")
    true_images = TRUE_IMAGES & {*inputs.sensors, *(segmentation.truth or ())}
    if segmentation.name == "ground truth":
        true_images |= {"semantic"}
    if true_images and truth_of(inputs) == "none":
        raise ConfigError(
            f"{where} declares no ground truth, and its configuration gives the agent '{min(true_images)}', which is."
        )
    if record.seed != submission.manifest.seed:
        raise ConfigError(f"{where}: the seed is {submission.manifest.seed}, in its configuration {record.seed}.")


def _require_entry(entry: Entry, known: Episode, submission: Submission, setting: Setting, where: str) -> None:
    """Raises ConfigError where an episode is not one of the split, or its actions cannot be those of its result."""
    result, inputs, actions = entry.result, submission.manifest.inputs, entry.actions
    declared = {
        "house": known.house, "goal": known.goal, "agent": inputs.agent, "semantics": inputs.semantics,
        "seed": submission.manifest.seed, "uses_ground_truth": inputs.uses_ground_truth, "isolated": inputs.isolated,
    }  # fmt: skip
    for name, value in declared.items():
        if getattr(result, name) != value:
            of = "the split" if name in ("house", "goal") else "the manifest"
            raise ConfigError(f"{where}: its result has {name} {getattr(result, name)!r}, {of} has {value!r}.")
    if result.is_error:
        if result.success or result.spl or result.soft_spl:
            raise ConfigError(f"{where} ended with an error and cannot be a success.")
        if actions or entry.places_m:
            raise ConfigError(f"{where} ended with an error and is not replayed; it cannot have actions or positions.")
        return
    if result.num_steps != len(actions):
        raise ConfigError(f"{where} has {len(actions)} actions, and its result counts {result.num_steps}.")
    for goal, part, place in _parts(result, actions, known, where):
        if len(part) > setting.task.max_steps:
            raise ConfigError(f"{place} has {len(part)} actions; the task allows {setting.task.max_steps}.")
        if STOP in part[:-1]:
            raise ConfigError(f"{place} has actions after STOP, which ends an episode.")
        if part or goal is result:
            _require_coherent(goal, part, place)
    places = -(-len(actions) // PLACE_EVERY)
    if len(entry.places_m) != places:
        raise ConfigError(f"{where} has {len(entry.places_m)} positions; {len(actions)} actions have {places}.")


def _parts(result: EpisodeResult, actions: str, known: Episode, where: str) -> list[tuple[GoalMetrics, str, str]]:
    """Returns what each STOP is judged by: the result with all actions, or each goal of a chain with its own ones.

    Raises:
        ConfigError: the goals are not those of the episode, or the result is not composed of theirs.
    """
    if not known.is_chain:
        if result.goals is not None:
            raise ConfigError(f"{where}: its result has goals of a chain, and the episode has one goal.")
        return [(result, actions, where)]
    goals, specs = result.goals or (), [(goal.text, goal.kind, goal.repeats) for goal in known.specs]
    if [(goal.goal, goal.kind, goal.repeats) for goal in goals] != specs:
        raise ConfigError(f"{where}: its goals are not those of the episode of the split.")
    whole = chain_metrics(goals)
    for name in ("success", "spl", "goat_success", "goat_spl", "num_steps", "path_length", "collisions"):
        given, expected = getattr(result, name), getattr(whole, name)
        if given is None or not abs(given - expected) <= ROUNDING:
            raise ConfigError(f"{where} has {name} {given}; its goals give {expected:.6g}.")
    ends = list(itertools.accumulate(goal.num_steps for goal in goals))
    starts = [0, *ends[:-1]]
    return [
        (goal, actions[start:end], f"{where}, goal {number}")
        for number, (goal, start, end) in enumerate(zip(goals, starts, ends, strict=True), start=1)
    ]


def _require_coherent(result: GoalMetrics, actions: str, where: str) -> None:
    """Raises ConfigError where the numbers of a result contradict each other."""
    stopped = actions.endswith(STOP)
    if stopped != (result.end_reason == "stop"):
        last = "is STOP" if stopped else "is not STOP"
        raise ConfigError(f"{where} ended with '{result.end_reason}', and its last action {last}.")
    if result.success and not stopped:
        raise ConfigError(f"{where} is a success without STOP.")
    if bool(result.success) != (result.failure is None):
        raise ConfigError(f"{where} has success {result.success:g} and the cause of failure '{result.failure}'.")
    expected = metrics.spl(bool(result.success), result.shortest_path, result.path_length)
    if not abs(result.spl - expected) <= ROUNDING:
        raise ConfigError(
            f"{where} has spl {result.spl:.6g}; its success, shortest_path and path_length give {expected:.6g}."
        )
