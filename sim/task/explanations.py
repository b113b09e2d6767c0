"""Explains in sentences how and why an episode ended, and names actions and categories in words.

Viewers use `explain_end`, which needs only the result and the distance to the goal. Reports use `explain` and
`marks`, which give the numbers of the trajectory to which the rules of `sim.task.failures` applied.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import Action, SuccessRule
from sim.core.vocabulary import counted, in_words, is_plural, with_article
from sim.task.failures import (
    LOOP_STEPS,
    STOPPED_AT_GOAL_M,
    cause_of_failure,
    first_looping_step,
    first_trapped_step,
)
from sim.task.metrics import EXPLORED_SHARE, TRAPPED_RADIUS_M, TRAPPED_WINDOW_STEPS
from sim.task.result import EpisodeResult, GoalResult, RolloutResult, goals_found
from sim.task.trajectory import Trajectory

ACTION_WORDS: Mapping[Action, str] = {
    Action.STOP: "stop",
    Action.MOVE_FORWARD: "forward",
    Action.TURN_LEFT: "turn left",
    Action.TURN_RIGHT: "turn right",
    Action.LOOK_UP: "look up",
    Action.LOOK_DOWN: "look down",
}
TRAPPED = f"{TRAPPED_WINDOW_STEPS} steps within {TRAPPED_RADIUS_M:g} m of one position"
"""The meaning of `trapped` (`sim.task.failures`), as videos and reports word it."""
_CAUSES: Mapping[str, str] = {
    "missed_detection": "The goal was in sight, but the agent drove on.",
    "trapped": f"The robot was trapped: {TRAPPED}.",
    "loop": "The robot drove in a loop.",
    "explore": f"The goal never covered {100 * EXPLORED_SHARE:g} % of an image.",
    "stairs": "The goal is on another storey.",
}
MEANING: Mapping[str, str] = {
    "false_detection": "The agent called STOP at an object that is not the goal.",
    "stopped_short": "The agent stopped for the goal, but too far from it or behind a wall.",
    "missed_detection": "The goal was in view and the agent did not go to it.",
    "loop": f"{LOOP_STEPS} steps on ground where the robot had been before.",
    "trapped": f"{TRAPPED}.",
    "explore": f"The goal never covered {100 * EXPLORED_SHARE:g} % of an image before the steps ran out.",
    "stairs": "The goal is on another storey, or the robot drove over an edge.",
    "misc": "No other rule applies: the steps ran out on the path to the goal or at the goal, or there was an error.",
}
"""The meaning of each cause of failure (the rules are in `sim.task.failures`)."""
ENDS: Mapping[str, str] = {
    "stop": "called STOP",
    "max_steps": "the steps ran out",
    "time_limit": "the time ran out",
    "fallen": "the robot drove over an edge",
    "error": "the episode ended with an error",
}


@dataclass(frozen=True)
class Outcome:
    """The end of an episode in words."""

    found: bool
    headline: str
    """For example "Found after 48 steps"."""
    sentence: str
    """Reason why the STOP counts, or does not count."""


def explain_end(
    result: RolloutResult, goal: str, rule: SuccessRule, nearest_m: float | None, *, detects: bool
) -> Outcome:
    """Returns the end of an episode in words.

    Args:
        result: of the episode.
        goal: category that the episode asked for.
        rule: when a STOP succeeds.
        nearest_m: distance in plan to the nearest instance of the goal on the storey; None: the storey has no instance.
        detects: whether the agent stops because of a segmentation. A person, or an agent without one, has
            stopped too early where the goal is not; that is not a false detection.
    """
    success, steps = result.success == 1.0, counted(result.num_steps, "step")
    found = "Found" if success else "Not found"
    headline = f"{found if result.goals is None else goals_found(result.goals)} after {steps}"
    if result.error:
        return Outcome(False, headline, result.error)
    if result.end_reason == "fallen":
        return Outcome(False, headline, "The robot drove over an edge and fell.")
    if result.goals is not None:
        return Outcome(success, headline, chain_in_words(result.goals))
    if result.end_reason == "stop":
        stop = _success(result, goal, nearest_m) if success else _wrong_stop(result, goal, rule, nearest_m, detects)
        return Outcome(success, headline, stop)
    left_m = result.distance_to_goal
    cause = _CAUSES.get(result.failure or "", "The goal was in sight.")
    remaining = "" if left_m is None else f" A place where a STOP counts is {left_m:.1f} m away."
    if left_m == 0.0:
        remaining = " The robot is where a STOP counts, and STOP was not called."
    return Outcome(False, headline, f"All {steps} are used up. {cause}{remaining}")


def chain_in_words(goals: Sequence[GoalResult]) -> str:
    """Returns the goals of a chain with their outcomes: "1 sofa: found; 2 desk: not found (explore)."."""
    outcomes = ["found" if goal.success == 1.0 else f"not found ({goal.failure})" for goal in goals]
    named = (f"{i} {in_words(goal.goal)}: {end}" for i, (goal, end) in enumerate(zip(goals, outcomes, strict=True), 1))
    return f"{'; '.join(named)}."


def _success(result: RolloutResult, goal: str, nearest_m: float | None) -> str:
    shortest_m = result.shortest_path
    near = "" if nearest_m is None else f": {_nearest_of(goal)} {nearest_m:.2f} m away and in sight"
    shortest = "" if shortest_m is None else f" The shortest path is {shortest_m:.1f} m (SPL {result.spl:.2f})."
    return f"The STOP counts{near}. The robot drove {result.path_length:.1f} m.{shortest}"


def _wrong_stop(result: RolloutResult, goal: str, rule: SuccessRule, nearest_m: float | None, detects: bool) -> str:
    name = in_words(goal)
    mistaken = detects and result.failure == "false_detection"
    if nearest_m is None:
        return f"The STOP does not count: there {_be(goal)} no {name} on this storey."
    if mistaken and (target := _stop_target(result, name)):
        return f"False detection: the agent stopped {target}."
    if nearest_m <= rule.distance_m:
        hidden = f"but a wall or a door hides {'them' if is_plural(goal) else 'it'}"
        return f"The STOP does not count: {_nearest_of(goal)} {nearest_m:.2f} m away, {hidden}."
    up_m = math.ceil(round(nearest_m * 100, 6)) / 100  # 1.003 m is farther than 1 m
    far = f"{_nearest_of(goal)} {up_m:.2f} m away"
    if mistaken:
        return f"False detection: the agent took another object for the {name}; {far}."
    return f"The STOP came too early: {far}. At most {rule.distance_m:g} m counts."


@dataclass(frozen=True)
class Mark:
    """A moment of an episode, or a span of steps."""

    kind: str
    """`seen`, `nearest`, `at_goal`, `trapped`, `loop` or `end`."""
    step: int
    until: int | None
    """Last step of a span; None for a moment."""
    words: str


def outcome(result: EpisodeResult) -> str:
    """Returns `found`, the cause of the failure, `error`, or `failed` where no cause was recorded."""
    if result.is_error:
        return "error"
    return "found" if result.success == 1.0 else result.failure or "failed"


def explain(result: EpisodeResult, trajectory: Trajectory | None) -> str:
    """Returns a few sentences on why the episode ended as it did, with numbers of the trajectory if there is one."""
    cause = outcome(result)
    if cause == "error":
        return f"The episode ended with an error: {result.error or 'no reason was recorded'}"
    if result.goals is not None:
        return f"{goals_found(result.goals)}. {chain_in_words(result.goals)}"
    if trajectory is None:
        return "Found." if cause == "found" else f"Not found. {MEANING.get(cause, 'No cause was recorded.')}"
    reason = _REASONS.get(cause, _other_reason)
    sentences = [reason(result, trajectory).strip()]
    current = cause_of_failure(trajectory) if trajectory.end_reason is not None else None
    if not trajectory.success and current is not None and current != cause:
        sentences.append(f"By the rules of the code that wrote this report the cause is {in_words(current)}.")
    return " ".join(sentences)


def marks(result: EpisodeResult, trajectory: Trajectory) -> list[Mark]:
    """Returns the decisive moments in the order of their steps; the end is always among them."""
    goal, last = in_words(result.goal), trajectory.num_steps
    if result.goals is not None:
        ends = itertools.accumulate(goal.num_steps for goal in result.goals)
        return [
            Mark("end", step, None, f"{in_words(goal.goal)}: {'found' if goal.success else goal.failure}")
            for goal, step in zip(result.goals, ends, strict=True)
        ]
    moments: list[Mark] = []
    seen, at_goal = _seen(trajectory), _at_goal(trajectory)
    if len(seen):
        moments.append(Mark("seen", int(seen[0]), None, f"{goal} first in view ({counted(len(seen), 'frame')} in all)"))
    if len(at_goal) and not trajectory.success:
        moments.append(Mark("at_goal", int(at_goal[0]), None, "the robot is where a STOP would succeed"))
    elif not trajectory.success and (nearest := _nearest(trajectory)) is not None:
        moments.append(Mark("nearest", nearest[0], None, f"nearest to the goal, {nearest[1]:.1f} m to go"))
    trapped, looping = first_trapped_step(trajectory.positions_m), first_looping_step(trajectory)
    if trapped is not None:
        until = trapped + TRAPPED_WINDOW_STEPS
        moments.append(Mark("trapped", trapped, until, TRAPPED))
    if looping is not None:
        until = looping + LOOP_STEPS
        moments.append(Mark("loop", looping, until, f"{LOOP_STEPS} steps over visited ground"))
    moments.append(Mark("end", last, None, _end(result, trajectory)))
    return sorted(moments, key=lambda mark: mark.step)


def _found(result: EpisodeResult, trajectory: Trajectory) -> str:
    shortest_m = result.shortest_path
    shortest = f" The shortest path is {shortest_m:.1f} m." if shortest_m is not None else ""
    return f"Found: stopped after {trajectory.num_steps} steps and {_driven(trajectory)}.{shortest}"


def _false_detection(result: EpisodeResult, trajectory: Trajectory) -> str:
    goal = in_words(result.goal)
    target = _stop_target(result, goal)
    place = f" {target}" if target else f": {_distance_to_instance(result.goal, trajectory)}"
    return f"Called STOP at step {trajectory.num_steps}{place}. {_view(result, trajectory)}"


def _missed_detection(result: EpisodeResult, trajectory: Trajectory) -> str:
    at_goal = _at_goal(trajectory)
    if len(at_goal):
        return f"{_view(result, trajectory)} At step {at_goal[0]} a STOP would have succeeded, but the agent drove on."
    return f"{_view(result, trajectory)} The robot drove {_driven(trajectory)} in all and did not go there."


def _trapped(result: EpisodeResult, trajectory: Trajectory) -> str:
    step = first_trapped_step(trajectory.positions_m)
    since = "" if step is None else f", from step {step} on"  # None: the cause comes from rules of another version
    return f"The robot was trapped: {TRAPPED}{since}. {_view(result, trajectory)}"


def _loop(result: EpisodeResult, trajectory: Trajectory) -> str:
    step = first_looping_step(trajectory)
    if step is None:  # the cause comes from rules of another version
        return f"The robot drove in a loop. {_view(result, trajectory)}"
    driven_m = float(trajectory.moved_m[step : step + LOOP_STEPS].sum())
    driven = f"the robot drove {driven_m:.1f} m in {LOOP_STEPS} steps, nearly all of it over visited ground"
    return f"From step {step} on {driven}. {_view(result, trajectory)}"


def _explore(result: EpisodeResult, trajectory: Trajectory) -> str:
    nearest = _nearest(trajectory)
    near = f"; a place where a STOP counts was {nearest[1]:.1f} m away at step {nearest[0]}" if nearest else ""
    return f"{_never_seen(result)} in {trajectory.num_steps} steps and {_driven(trajectory)}{near}."


def _stairs(result: EpisodeResult, trajectory: Trajectory) -> str:
    if trajectory.end_reason == "fallen":
        return f"The robot drove over an edge at step {trajectory.num_steps} and fell. {_view(result, trajectory)}"
    return f"No {in_words(result.goal)} {_be(result.goal)} on the storey where the episode starts."


def _other_reason(result: EpisodeResult, trajectory: Trajectory) -> str:
    if trajectory.end_reason == "stop":
        distance = _distance_to_instance(result.goal, trajectory)
        seen = _view(result, trajectory) if len(_seen(trajectory)) else ""
        return f"Called STOP at step {trajectory.num_steps} short of the goal: {distance}. {seen}"
    at_goal = "It ended where a STOP counts, and STOP was not called. " if result.distance_to_goal == 0.0 else ""
    return f"{_view(result, trajectory)} {at_goal}{_end(result, trajectory).capitalize()}."


_REASONS: Mapping[str, Callable[[EpisodeResult, Trajectory], str]] = {
    "found": _found,
    "false_detection": _false_detection,
    "missed_detection": _missed_detection,
    "trapped": _trapped,
    "loop": _loop,
    "explore": _explore,
    "stairs": _stairs,
}
"""For each outcome the function that describes it; the others are described by `_other_reason`."""


def _view(result: EpisodeResult, trajectory: Trajectory) -> str:
    """Returns a sentence on when the goal was in view."""
    seen = _seen(trajectory)
    if not len(seen):
        return f"{_never_seen(result)}."
    was = "were" if is_plural(result.goal) else "was"
    return f"The {in_words(result.goal)} {was} in view from step {seen[0]} on, in {counted(len(seen), 'frame')}."


def _never_seen(result: EpisodeResult) -> str:
    return f"The {in_words(result.goal)} never covered {100 * EXPLORED_SHARE:g} % of a frame"


def _driven(trajectory: Trajectory) -> str:
    return f"{float(trajectory.moved_m.sum()):.1f} m"


def _distance_to_instance(goal: str, trajectory: Trajectory) -> str:
    nearest_m = trajectory.nearest_instance_m
    if nearest_m is None:
        return f"no {in_words(goal)} {_be(goal)} on this storey"
    too_far = trajectory.stop.stop_target_xy_m is None and nearest_m > STOPPED_AT_GOAL_M
    return f"{_nearest_of(goal)} {nearest_m:.1f} m away{', too far for a stop there' if too_far else ''}"


def _nearest_of(goal: str) -> str:
    """Returns the beginning of a sentence: "the nearest chair is", "the nearest clothes are"."""
    return f"the nearest {in_words(goal)} {_be(goal)}"


def _be(goal: str) -> str:
    return "are" if is_plural(goal) else "is"


def _stop_target(result: RolloutResult, goal: str) -> str:
    """Returns a text on the object for which the agent stopped: "at a sofa, 1.8 m from the nearest chair", or ""."""
    off_m, category = result.stop_target_to_goal_m, result.stop_target_category
    if off_m is None:
        return ""
    return f"{f'at {with_article(category)},' if category else 'for something'} {off_m:.1f} m from the nearest {goal}"


def _end(result: EpisodeResult, trajectory: Trajectory) -> str:
    end = ENDS.get(str(trajectory.end_reason), "the file ends here")
    if trajectory.success:
        return f"{end} at the goal"
    left_m = result.distance_to_goal
    return f"{end}, {left_m:.1f} m to go" if left_m is not None else f"{end}, no path to the goal from here"


def _seen(trajectory: Trajectory) -> NDArray[np.intp]:
    """Returns the steps at which the goal was in view."""
    return np.flatnonzero(trajectory.goal_share >= EXPLORED_SHARE)


def _at_goal(trajectory: Trajectory) -> NDArray[np.intp]:
    """Returns the steps at which a STOP would have succeeded, from the first view of the goal on if there is one."""
    at_goal, seen = np.flatnonzero(trajectory.distance_m <= 0.0), _seen(trajectory)
    return at_goal[at_goal >= seen[0]] if len(seen) else at_goal


def _nearest(trajectory: Trajectory) -> tuple[int, float] | None:
    """Returns the step with the smallest distance to the goal and the distance; None if there was never a path."""
    if not np.isfinite(trajectory.distance_m).any():
        return None
    step = int(np.nanargmin(trajectory.distance_m))
    return step, float(trajectory.distance_m[step])
