"""Each cause of failure, on synthetic trajectories."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from sim.task.failures import (
    CAUSES,
    LOOP_STEPS,
    cause_of_failure,
    first_looping_step,
    first_trapped_step,
    on_new_ground,
)
from sim.task.metrics import TRAPPED_WINDOW_STEPS, stayed_near
from sim.task.result import EndReason, StopTarget
from sim.task.trajectory import Trajectory

SEEN, UNSEEN = 0.01, 0.0079


def walk(
    places_m: np.ndarray, *, end: EndReason = "max_steps", seen_at: int | None = None, **known: object
) -> Trajectory:
    """Returns an episode along positions (n + 1, 2); by default the goal is always 9 m away and out of sight."""
    n = len(places_m) - 1
    poses = np.zeros((n + 1, 4), np.float32)
    poses[:, :2] = places_m
    share = np.full(n + 1, UNSEEN, np.float32)
    if seen_at is not None:
        share[seen_at] = SEEN
    values = {"distance_m": np.full(n + 1, 9.0, np.float32), "nearest_instance_m": 9.0, "goal_on_storey": True} | known
    return Trajectory(
        poses=poses,
        actions=np.ones(n, np.uint8),
        ended=np.zeros(n, np.uint8),
        collided=np.zeros(n, np.bool_),
        touched=np.zeros(n, np.bool_),
        duration_s=np.ones(n, np.float32),
        goal_share=share,
        contacts=np.zeros((0, 3), np.float32),
        success=False,
        end_reason=end,
        **values,  # pyright: ignore[reportArgumentType]
    )


def stop_at(to_goal_m: float | None) -> StopTarget:
    return StopTarget(stop_target_xy_m=(1.0, 2.0), stop_target_to_goal_m=to_goal_m, stop_target_category=None)


def line(steps: int, speed_m: float = 0.2) -> np.ndarray:
    return np.c_[speed_m * np.arange(steps + 1), np.zeros(steps + 1)]


def shuttle(steps: int, length_m: float = 3.0, speed_m: float = 0.2) -> np.ndarray:
    """Returns positions that go back and forth on one line."""
    along = np.abs((speed_m * np.arange(steps + 1) + length_m) % (2 * length_m) - length_m)
    return np.c_[along, np.zeros(steps + 1)]


def after(first: np.ndarray, then: np.ndarray) -> np.ndarray:
    return np.concatenate([first, first[-1] + then[1:] - then[0]])


def test_success_has_no_cause_and_a_running_episode_no_answer() -> None:
    assert cause_of_failure(replace(walk(line(20)), success=True)) is None
    with pytest.raises(ValueError, match="still runs"):
        cause_of_failure(replace(walk(line(20)), end_reason=None))


def stop(seen_at: int | None = None, **known: object) -> Trajectory:
    """Returns an episode of 30 steps that ends with a STOP."""
    return walk(line(30), end="stop", seen_at=seen_at, **known)


def away(**reached_m: float) -> np.ndarray:
    """Returns 501 distances of 9 m, except for some steps, such as `step_480=0.0`."""
    distance_m = np.full(501, 9.0, np.float32)
    for step, value in reached_m.items():
        distance_m[int(step.removeprefix("step_"))] = value
    return distance_m


ON_THE_SPOT, NOWHERE = np.zeros((501, 2)), np.full(501, np.nan, np.float32)
HELD_AT_300 = after(line(300), np.zeros((201, 2)))
RETURNED = after(after(line(100), line(100)[::-1]), np.flip(line(300), axis=1))
CASES = {
    "physics that broke, whatever else holds": ("misc", walk(np.zeros((200, 2)), end="error", goal_on_storey=False)),
    "a stop elsewhere": ("false_detection", stop(3)),
    "a stop on a storey without instance": ("false_detection", stop(goal_on_storey=False, nearest_instance_m=None)),
    "a stop slightly too far": ("stopped_short", stop(29, nearest_instance_m=1.4)),
    "a stop too far": ("false_detection", stop(29, nearest_instance_m=1.6)),
    "seen three frames before the stop": ("stopped_short", stop(26, nearest_instance_m=1.2)),
    "seen four frames before the stop": ("false_detection", stop(25, nearest_instance_m=1.2)),
    "near an instance that it does not face": ("false_detection", stop(25, nearest_instance_m=0.4)),
    "near an unseen instance, behind a wall": ("false_detection", stop(nearest_instance_m=0.4)),
    "a place on a storey without instance": ("false_detection", stop(29, stop=stop_at(None), nearest_instance_m=None)),
    "on another storey only": ("stairs", walk(line(500), goal_on_storey=False, distance_m=NOWHERE)),
    "on another storey, trapped": ("stairs", walk(ON_THE_SPOT, goal_on_storey=False, distance_m=NOWHERE)),
    "sees the goal and continues": ("missed_detection", walk(line(500), seen_at=100)),
    "never sees the goal": ("explore", walk(line(500))),
    "sees it shortly before the end": ("misc", walk(line(500), seen_at=450)),  # 10 m driven; the limit is 13.5 m
    "where a stop succeeds": ("missed_detection", walk(line(500), seen_at=475, distance_m=away(step_480=0.0))),
    "where a stop succeeds, at the end": ("misc", walk(line(500), seen_at=475, distance_m=away(step_490=0.0))),
    "near the goal, not at it": ("misc", walk(line(500), seen_at=100, distance_m=away(step_300=0.9))),
    "passed before it was ever seen": ("explore", walk(line(500), distance_m=away(step_100=0.0))),
    "cannot leave": ("trapped", walk(HELD_AT_300)),
    "missed long before it was trapped": ("missed_detection", walk(HELD_AT_300, seen_at=100)),
    "trapped soon after the goal was seen": ("trapped", walk(HELD_AT_300, seen_at=280)),
    "trapped where the goal is seen": ("trapped", walk(HELD_AT_300, seen_at=400)),
    "back and forth": ("loop", walk(shuttle(500))),
    "back and forth from the goal": ("loop", walk(shuttle(500), seen_at=2)),
    "a return over known ground": ("explore", walk(RETURNED)),
}


@pytest.mark.parametrize(("cause", "episode"), CASES.values(), ids=CASES)
def test_an_episode_has_its_cause_of_failure(cause: str, episode: Trajectory) -> None:
    assert cause_of_failure(episode) == cause


def test_a_frame_that_was_not_rendered_does_not_count_among_those_faced() -> None:
    episode = walk(line(30), end="stop", seen_at=25, nearest_instance_m=1.2)
    share = episode.goal_share.copy()
    share[28] = np.nan
    assert cause_of_failure(replace(episode, goal_share=share)) == "stopped_short"


@pytest.mark.parametrize(
    ("off_m", "cause"), [(0.0, "stopped_short"), (0.3, "stopped_short"), (0.31, "false_detection")]
)
@pytest.mark.parametrize(("nearest_m", "seen_at"), [(0.9, 29), (0.9, None), (2.5, 29), (2.5, None)])
def test_a_stated_place_decides_whether_a_wrong_stop_was_for_the_goal(
    off_m: float, cause: str, nearest_m: float, seen_at: int | None
) -> None:
    stated = {"stop": stop_at(off_m)}
    assert (
        cause_of_failure(walk(line(30), end="stop", seen_at=seen_at, nearest_instance_m=nearest_m, **stated)) == cause
    )


def test_the_second_round_of_a_circle_is_a_loop_and_the_first_is_not() -> None:
    angle = 0.04 * np.arange(501)  # 5 m from the centre, 157 steps per round
    circle = 5.0 * np.c_[np.cos(angle), np.sin(angle)]
    begin = first_looping_step(walk(circle))
    assert begin is not None
    assert 100 < begin < 200
    assert first_looping_step(walk(circle[:157])) is None


def test_a_robot_that_turns_on_the_spot_is_trapped_and_not_in_a_loop() -> None:
    spot = walk(np.zeros((501, 2)))
    assert cause_of_failure(spot) == "trapped"
    assert first_looping_step(spot) is None


def test_a_robot_that_hardly_drives_is_not_in_a_loop() -> None:
    assert first_looping_step(walk(shuttle(500, length_m=2.5, speed_m=0.06))) is None  # 9 m in 150 steps
    assert first_looping_step(walk(shuttle(500, length_m=2.5, speed_m=0.07))) is not None


@pytest.mark.parametrize("yaw", [0.0, 0.3, 1.1])
def test_new_ground_does_not_depend_on_the_direction_and_ground_next_to_the_old_path_is_not_new(yaw: float) -> None:
    turn = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    outward = line(100) @ turn.T
    beside = (line(100) + np.array([0.0, 0.4])) @ turn.T
    new = on_new_ground(np.concatenate([outward, beside[::-1]]))
    assert new[:101].sum() == 1 + 25  # 20 m, one in every fourth step of 0.2 m
    assert new[101:].sum() <= 1


def test_the_trapped_rule_equals_the_metric() -> None:
    rng = np.random.default_rng(0)
    for pull in np.linspace(0.0, 0.3, 12):
        places = np.zeros((300, 2))
        for i in range(1, 300):
            places[i] = (1 - pull) * places[i - 1] + rng.normal(0, 0.12, 2)
        metric = any(stayed_near(places[:i]) for i in range(TRAPPED_WINDOW_STEPS + 1, 301))
        assert (first_trapped_step(places) is not None) == metric


def test_an_episode_shorter_than_the_windows_is_neither_trapped_nor_looping() -> None:
    short = walk(shuttle(LOOP_STEPS - 1))
    assert first_looping_step(short) is None
    assert first_trapped_step(np.zeros((TRAPPED_WINDOW_STEPS, 2))) is None


def test_the_causes_are_the_contracts() -> None:
    named = {"stopped_short", "false_detection", "missed_detection", "loop", "trapped", "explore", "stairs", "misc"}
    assert set(CAUSES) == named
