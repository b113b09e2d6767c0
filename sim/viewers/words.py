"""Explains the end of an episode in sentences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sim.interface import Action, SuccessRule
from sim.task.metrics import TRAPPED_RADIUS_M, TRAPPED_WINDOW_STEPS

ACTION_WORDS: Mapping[Action, str] = {
    Action.STOP: "stop",
    Action.MOVE_FORWARD: "forward",
    Action.TURN_LEFT: "turn left",
    Action.TURN_RIGHT: "turn right",
}
TRAPPED = f"{TRAPPED_WINDOW_STEPS} steps within {TRAPPED_RADIUS_M:g} m of one position"
"""The meaning of `trapped` (`sim.task.failures`), as videos and reports word it."""
_CAUSES: Mapping[str, str] = {
    "missed_detection": "The goal was in sight, but the agent drove on.",
    "trapped": f"The robot was trapped: {TRAPPED}.",
    "loop": "The robot drove in a loop.",
    "explore": "The goal was never in sight.",
    "stairs": "The goal is on another storey.",
}


@dataclass(frozen=True)
class Outcome:
    """The end of an episode in words."""

    found: bool
    headline: str
    """Headline, for example "Found after 48 steps"."""
    sentence: str
    """The reason why it counts or does not."""


def in_words(category: str) -> str:
    """Returns the name of a category with spaces: "chest of drawers"."""
    return category.replace("_", " ")


def with_article(category: str) -> str:
    """Returns the name of a category with its article: "an armchair"."""
    name = in_words(category)
    return name if name in ("clothes", "gym equipment", "seating") else f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def explain_end(
    line: Mapping[str, Any], goal: str, rule: SuccessRule, nearest_m: float | None, *, detects: bool
) -> Outcome:
    """Returns the end of an episode in words.

    Args:
        line: the episode's result line.
        goal: category that the episode asked for.
        rule: when a STOP succeeds.
        nearest_m: distance in plan to the nearest instance of the goal on the storey; None: there is none.
        detects: whether the agent stops because of a segmentation. A person, or an agent without one, has
            stopped too early where the goal is not; this is not a false detection.
    """
    found, steps = bool(line["success"]), f"{line['num_steps']} step" + "s" * (line["num_steps"] != 1)
    headline = f"{'Found' if found else 'Not found'} after {steps}"
    if line.get("error"):
        return Outcome(False, headline, str(line["error"]))
    if line.get("end_reason") == "fallen":
        return Outcome(False, headline, "The robot drove over an edge and fell.")
    if line.get("end_reason") == "stop":
        stop = _success(line, goal, rule, nearest_m) if found else _wrong_stop(line, goal, rule, nearest_m, detects)
        return Outcome(found, headline, stop)
    left_m = line.get("distance_to_goal")
    cause = _CAUSES.get(line.get("failure") or "", "The goal was in sight.")
    left = "" if left_m is None else f" A place where a STOP counts is {left_m:.1f} m away."
    return Outcome(False, headline, f"All {steps} are used up. {cause}{left}")


def _success(line: Mapping[str, Any], goal: str, rule: SuccessRule, nearest_m: float | None) -> str:
    shortest_m = line.get("shortest_path")
    near = "" if nearest_m is None else f"the nearest {in_words(goal)} is {nearest_m:.2f} m away and in sight; "
    driven = f"Driven: {line['path_length']:.1f} m"
    shortest = "" if shortest_m is None else f"; shortest path: {shortest_m:.1f} m; SPL {line['spl']:.2f}"
    return f"The STOP counts: {near}at most {rule.distance_m:g} m is allowed. {driven}{shortest}."


def _wrong_stop(line: Mapping[str, Any], goal: str, rule: SuccessRule, nearest_m: float | None, detects: bool) -> str:
    name, off_m = in_words(goal), line.get("stop_target_to_goal_m")
    mistaken = detects and line.get("failure") == "false_detection"
    if nearest_m is None:
        return f"The STOP does not count: there is no {name} on this storey."
    if mistaken and off_m is not None:
        return f"False detection: the agent stopped for something {off_m:.1f} m from the nearest {name}."
    if nearest_m <= rule.distance_m:
        return f"The STOP does not count: the nearest {name} is {nearest_m:.2f} m away, but a wall or a door hides it."
    far = f"the nearest {name} is {nearest_m:.1f} m away, and at most {rule.distance_m:g} m counts"
    if mistaken:
        return f"False detection: the agent took another object for the {name}; {far}."
    return f"The STOP came too early: {far}."
