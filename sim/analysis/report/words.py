"""An episode in words: how it ended and why, and the moments worth a look on its way.

The causes are those of `sim.task.failures`; here its rules are said with the numbers of the one episode.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.analysis.comparison import Line
from sim.task.failures import AT_IT_M, LOOP_STEPS, cause_of_failure, first_looping_step, first_trapped_step
from sim.task.metrics import EXPLORED_SHARE, TRAPPED_RADIUS_M, TRAPPED_WINDOW_STEPS
from sim.task.trajectory import Trajectory

MEANING: Mapping[str, str] = {
    "false_detection": "The agent called STOP at something that was not the goal.",
    "missed_detection": "The goal was in view and the agent went on without it.",
    "loop": f"{LOOP_STEPS} steps of driving over ground where it had been before.",
    "trapped": f"{TRAPPED_WINDOW_STEPS} steps within {TRAPPED_RADIUS_M:g} m of one place.",
    "explore": "The goal never came into view before the steps ran out.",
    "stairs": "The goal is on another storey.",
    "misc": "None of the other rules: stopped short of the goal, ran out of steps on the way, or broke.",
}
"""What each cause of a failure means, in a sentence (the rules are in `sim.task.failures`)."""
ENDS: Mapping[str, str] = {
    "stop": "called STOP",
    "max_steps": "the steps ran out",
    "error": "the episode broke",
}


@dataclass(frozen=True)
class Mark:
    """A moment of an episode, or a span of steps."""

    kind: str
    """`seen`, `nearest`, `there`, `trapped`, `loop` or `end`."""
    step: int
    until: int | None
    """Last step of a span; None: a moment."""
    words: str


def outcome(line: Line) -> str:
    """`found`, the cause of the failure, `error`, or `failed` where no cause was written down."""
    if line.get("end_reason") == "error":
        return "error"
    return "found" if line["success"] else str(line.get("failure") or "failed")


def explain(line: Line, trajectory: Trajectory | None) -> str:
    """Why the episode ended as it did: a few sentences, with the numbers of the trajectory where there is one."""
    result = outcome(line)
    if result == "error":
        return f"The episode broke: {line.get('error') or 'no reason was written down'}"
    if trajectory is None:
        return "Found." if result == "found" else f"Not found. {MEANING.get(result, 'No cause was written down.')}"
    sentences = [_reason(result, line, trajectory)]
    today = cause_of_failure(trajectory) if trajectory.end_reason is not None else None
    if not trajectory.success and today is not None and today != result:
        sentences.append(f"By the rules of the code that wrote this report the cause would be {_plain(today)}.")
    return " ".join(sentences)


def marks(line: Line, trajectory: Trajectory) -> list[Mark]:
    """The moments worth a look, in the order of their steps; the end is always among them."""
    goal, last = _plain(str(line["goal"])), trajectory.num_steps
    found: list[Mark] = []
    seen = _seen(trajectory)
    if len(seen):
        found.append(Mark("seen", int(seen[0]), None, f"{goal} first in view ({len(seen)} frames in all)"))
    there = _there(trajectory)
    if len(there) and not trajectory.success:
        found.append(Mark("there", int(there[0]), None, "stands where a STOP would count"))
    elif not trajectory.success and (nearest := _nearest(trajectory)) is not None:
        found.append(Mark("nearest", nearest[0], None, f"nearest to the goal, {nearest[1]:.1f} m to go"))
    trapped, looping = first_trapped_step(trajectory.positions_m), first_looping_step(trajectory)
    if trapped is not None:
        until = trapped + TRAPPED_WINDOW_STEPS
        found.append(Mark("trapped", trapped, until, f"{TRAPPED_WINDOW_STEPS} steps within {TRAPPED_RADIUS_M:g} m"))
    if looping is not None:
        until = looping + LOOP_STEPS
        found.append(Mark("loop", looping, until, f"{LOOP_STEPS} steps over old ground"))
    found.append(Mark("end", last, None, _the_end(line, trajectory)))
    return sorted(found, key=lambda mark: mark.step)


def _reason(result: str, line: Line, trajectory: Trajectory) -> str:
    goal, seen = _plain(str(line["goal"])), _seen(trajectory)
    sight = f"The {goal} was in view from step {seen[0]} on, in {len(seen)} frames." if len(seen) else ""
    never = f"The {goal} never covered {100 * EXPLORED_SHARE:g} % of a frame"
    driven = f"{float(trajectory.moved_m.sum()):.1f} m"
    if result == "found":
        return f"Found: stopped after {trajectory.num_steps} steps and {driven}{_against_shortest(line)}."
    if result == "false_detection":
        where = _instance_away(goal, trajectory)
        return f"Called STOP at step {trajectory.num_steps}: {where}. {sight or never + '.'}"
    if result == "missed_detection":
        there = _there(trajectory)
        if len(there):
            return f"{sight} At step {there[0]} a STOP would have counted, and it drove on."
        return f"{sight} It drove on, {driven} in all, and did not go there."
    if result == "trapped":
        step = first_trapped_step(trajectory.positions_m)
        stayed = f"stayed within {TRAPPED_RADIUS_M:g} m for {TRAPPED_WINDOW_STEPS} steps"
        return f"From step {step} on it {stayed}. {sight or never + '.'}"
    if result == "loop":
        return f"{_loop_in_words(trajectory)} {sight or never + '.'}"
    if result == "explore":
        nearest = _nearest(trajectory)
        near = f"; the nearest it came was {nearest[1]:.1f} m, at step {nearest[0]}" if nearest else ""
        return f"{never} in {trajectory.num_steps} steps and {driven}{near}."
    if result == "stairs":
        return f"No {goal} is on the storey where the episode starts."
    if result == "misc" and trajectory.end_reason == "stop":
        return f"Called STOP at step {trajectory.num_steps} short of it: {_instance_away(goal, trajectory)}. {sight}"
    return f"{sight or never + '.'} {_the_end(line, trajectory).capitalize()}."


def _loop_in_words(trajectory: Trajectory) -> str:
    step = first_looping_step(trajectory)
    if step is None:  # judged by rules of another version
        return "It drove in a loop."
    driven_m = float(trajectory.moved_m[step : step + LOOP_STEPS].sum())
    return f"From step {step} on it drove {driven_m:.1f} m in {LOOP_STEPS} steps, nearly all of it over old ground."


def _against_shortest(line: Line) -> str:
    shortest_m = line.get("shortest_path")
    return f"; the shortest way is {shortest_m:.1f} m" if shortest_m is not None else ""


def _instance_away(goal: str, trajectory: Trajectory) -> str:
    nearest_m = trajectory.nearest_instance_m
    if nearest_m is None:
        return f"no {goal} is on this storey"
    beyond = f", more than the {AT_IT_M:g} m that could be meant" if nearest_m > AT_IT_M else ""
    return f"the nearest {goal} is {nearest_m:.1f} m away{beyond}"


def _the_end(line: Line, trajectory: Trajectory) -> str:
    end = ENDS.get(str(trajectory.end_reason), "the file ends here")
    if trajectory.success:
        return f"{end} where it counts"
    left_m = line.get("distance_to_goal")
    return f"{end}, {left_m:.1f} m to go" if left_m is not None else f"{end}, no way to the goal from here"


def _seen(trajectory: Trajectory) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Steps at which the goal was in view."""
    return np.flatnonzero(trajectory.goal_share >= EXPLORED_SHARE)


def _there(trajectory: Trajectory) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Steps at which a STOP would have counted, from the first sight of the goal on; all where it was never seen."""
    there, seen = np.flatnonzero(trajectory.distance_m <= 0.0), _seen(trajectory)
    return there[there >= seen[0]] if len(seen) else there


def _nearest(trajectory: Trajectory) -> tuple[int, float] | None:
    """The step at which the goal was nearest, and how near; None where there was never a way."""
    if not np.isfinite(trajectory.distance_m).any():
        return None
    step = int(np.nanargmin(trajectory.distance_m))
    return step, float(trajectory.distance_m[step])


def _plain(name: str) -> str:
    return name.replace("_", " ")
