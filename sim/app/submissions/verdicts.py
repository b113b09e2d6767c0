"""Compares the results in a submission with those of its replay, and says what a difference means."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from sim.app.submissions.contents import PLACE_EVERY, Entry
from sim.app.submissions.replay import Replay
from sim.task.result import EpisodeMetrics, GoalResult

Judgement = Literal["equal", "within tolerance", "different", "error"]
TOLERANCE_M = 0.01
"""Other processors and libraries round differently; contacts amplify that, to millimetres in an episode."""
ROUNDING = 1e-9
"""Numbers this near are equal: JSON keeps all digits of a number."""
EXACT = ("success", "num_steps", "end_reason", "collisions", "touches", "trapped")
LENGTHS = ("shortest_path", "path_length", "distance_to_goal")
"""Metres; they may differ by the tolerance."""
SHARES = ("spl", "soft_spl")
"""Ratios of lengths; they may differ by the tolerance over the shortest path."""
SEEN_EXACT = ("gt_explored", "failure")
"""Metrics of rendered frames."""
SEEN_STEPS, SEEN_AREA = "first_seen_step", "area_seen_m2"
STEPS_OF_RENDERER = 1
"""Other OpenGL renderers draw edges of a pixel differently, which can shift the first sight by one frame ..."""
AREA_OF_RENDERER = 0.01
"""... and the seen area by this share."""
MIN_PATH_M = 0.5
LONG_M, DIRECT = 3.0, 1.05
"""A path of at least this length that is longer than the shortest one by at most this factor repeats a known one."""


@dataclass(frozen=True)
class Verdict:
    """The judgement on one episode."""

    episode_id: str
    judgement: Judgement
    framed: bool
    text: str
    """The differences and their meaning; "" for an equal episode."""
    known_path: Literal["", "oracle", "shortest"] = ""
    """`oracle`: the actions are the oracle's, one by one; `shortest`: a success on a path hardly longer than the
    shortest one. An agent that has never seen the house takes such a path where it sees the goal early."""


def judge(entry: Entry, replay: Replay | None, *, tolerance_m: float = TOLERANCE_M) -> Verdict:
    """Returns the judgement on an episode.

    Args:
        entry: of the submission.
        replay: of its actions; None: it ended with an error and was not replayed.
        tolerance_m: largest difference of lengths.
    """
    episode_id = entry.result.episode_id
    if replay is None:
        return Verdict(episode_id, "error", False, "it ended with an error: a failure, which is not replayed")
    if replay.fault or replay.metrics is None:
        text = f"{replay.fault}. The result does not come from these actions in this episode"
        return Verdict(episode_id, "different", replay.framed, text)
    known = _known_path(replay.metrics, is_oracles=replay.is_oracles)
    differing, near = _differences(entry, replay.metrics, replay.framed, tolerance_m)
    if differing:
        text = f"{'; '.join(differing)}. {_meaning(entry, replay, tolerance_m)}"
        return Verdict(episode_id, "different", replay.framed, text, known)
    if near:
        return Verdict(episode_id, "within tolerance", replay.framed, "; ".join(near), known)
    return Verdict(episode_id, "equal", replay.framed, "", known)


def _known_path(metrics: EpisodeMetrics, *, is_oracles: bool) -> Literal["", "oracle", "shortest"]:
    """Returns the known path that the actions of an episode repeat; see `Verdict.known_path`."""
    if is_oracles:
        return "oracle"
    shortest_m = metrics.shortest_path or 0.0
    direct = shortest_m >= LONG_M and metrics.path_length <= DIRECT * shortest_m
    return "shortest" if metrics.success and direct else ""


def _differences(
    entry: Entry, metrics: EpisodeMetrics, framed: bool, tolerance_m: float
) -> tuple[list[str], list[str]]:
    """Returns the differences beyond the tolerance, and those within it."""
    differing, near = [], []
    if [_outcome(goal) for goal in entry.result.goals or ()] != [_outcome(goal) for goal in metrics.goals or ()]:
        differing.append("the goals of the chain have other results in the replay")
    shortest_m = max(metrics.shortest_path or 0.0, MIN_PATH_M)
    allowed = dict.fromkeys(EXACT, 0.0) | dict.fromkeys(LENGTHS, tolerance_m)
    allowed |= dict.fromkeys(SHARES, tolerance_m / shortest_m)
    if framed:
        area = AREA_OF_RENDERER * (metrics.area_seen_m2 or 0.0)
        allowed |= dict.fromkeys(SEEN_EXACT, 0.0) | {SEEN_STEPS: STEPS_OF_RENDERER, SEEN_AREA: area}
    for name, most in allowed.items():
        submitted, replayed = getattr(entry.result, name), getattr(metrics, name)
        off = _off(submitted, replayed)
        if off > ROUNDING:
            (differing if off > max(most, ROUNDING) else near).append(
                f"{name} {_text(submitted)}, in the replay {_text(replayed)}"
            )
    return differing, near


def _outcome(goal: GoalResult) -> tuple[object, ...]:
    """Returns what must be equal of a goal of a chain; lengths are compared over the chain."""
    return goal.goal, goal.kind, goal.repeats, *(getattr(goal, name) for name in EXACT)


def _meaning(entry: Entry, replay: Replay, tolerance_m: float) -> str:
    """Returns a sentence on the likely reason of a difference."""
    if len(entry.places_m) == len(replay.places_m):
        off = [math.dist(a, b) for a, b in zip(entry.places_m, replay.places_m, strict=True)]
        apart = next((number for number, distance_m in enumerate(off) if distance_m > tolerance_m + 1e-4), None)
        if apart is None:
            return "The actions lead along the recorded path, so the result itself was changed or computed otherwise"
        step = min((apart + 1) * PLACE_EVERY, len(entry.actions))
        return (
            f"The replay leaves the recorded path before action {step}, by {off[apart]:.2f} m: other actions, another "
            "robot, house, seed or noise, or another kind of processor"
        )
    return "The recorded path has another number of places than the actions: one of them was changed"


def _off(submitted: object, replayed: object) -> float:
    """Returns how far apart two values are; infinity where one is missing or not a number."""
    if isinstance(submitted, (bool, int, float)) and isinstance(replayed, (bool, int, float)):
        off = abs(float(submitted) - float(replayed))
        return off if math.isfinite(off) else math.inf
    return 0.0 if submitted == replayed else math.inf


def _text(value: object) -> str:
    return f"{value:.4f}".rstrip("0").rstrip(".") if isinstance(value, float) else str(value)
