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


def test_broken_physics_are_misc_whatever_else_holds() -> None:
    assert cause_of_failure(walk(np.zeros((200, 2)), end="error", goal_on_storey=False)) == "misc"


def test_a_stop_elsewhere_is_a_false_detection() -> None:
    assert cause_of_failure(walk(line(30), end="stop", seen_at=3)) == "false_detection"


def test_a_stop_on_a_storey_without_instance_is_a_false_detection_too() -> None:
    episode = walk(line(30), end="stop", goal_on_storey=False, nearest_instance_m=None)
    assert cause_of_failure(episode) == "false_detection"


@pytest.mark.parametrize(("nearest_m", "cause"), [(1.4, "stopped_short"), (1.6, "false_detection")])
def test_a_stop_slightly_too_far_from_the_goal_in_view_is_no_false_detection(nearest_m: float, cause: str) -> None:
    assert cause_of_failure(walk(line(30), end="stop", seen_at=29, nearest_instance_m=nearest_m)) == cause


@pytest.mark.parametrize(("seen_at", "cause"), [(26, "stopped_short"), (25, "false_detection")])
def test_the_frame_of_the_stop_and_three_before_count(seen_at: int, cause: str) -> None:
    assert cause_of_failure(walk(line(30), end="stop", seen_at=seen_at, nearest_instance_m=1.2)) == cause


@pytest.mark.parametrize("seen_at", [3, 25])
def test_a_stop_near_an_instance_that_the_robot_does_not_face_is_a_false_detection(seen_at: int) -> None:
    assert cause_of_failure(walk(line(30), end="stop", seen_at=seen_at, nearest_instance_m=0.4)) == "false_detection"


def test_a_frame_that_was_not_rendered_does_not_count_among_those_faced() -> None:
    episode = walk(line(30), end="stop", seen_at=25, nearest_instance_m=1.2)
    share = episode.goal_share.copy()
    share[28] = np.nan
    assert cause_of_failure(replace(episode, goal_share=share)) == "stopped_short"


def test_a_stop_near_an_unseen_instance_behind_a_wall_is_a_false_detection() -> None:
    assert cause_of_failure(walk(line(30), end="stop", nearest_instance_m=0.4)) == "false_detection"


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


def test_a_stated_place_on_a_storey_without_instance_is_a_false_detection() -> None:
    stated = {"stop": stop_at(None), "nearest_instance_m": None}
    assert cause_of_failure(walk(line(30), end="stop", seen_at=29, **stated)) == "false_detection"


def test_an_instance_on_another_storey_only_is_stairs_even_for_a_trapped_robot() -> None:
    nowhere = np.full(501, np.nan, np.float32)
    assert cause_of_failure(walk(line(500), goal_on_storey=False, distance_m=nowhere)) == "stairs"
    assert cause_of_failure(walk(np.zeros((501, 2)), goal_on_storey=False, distance_m=nowhere)) == "stairs"


def test_an_agent_that_sees_the_goal_and_continues_has_missed_it() -> None:
    assert cause_of_failure(walk(line(500), seen_at=100)) == "missed_detection"


def test_an_agent_that_never_sees_the_goal_on_new_ground_has_not_explored_enough() -> None:
    assert cause_of_failure(walk(line(500))) == "explore"


def test_an_agent_that_sees_the_goal_shortly_before_max_steps_is_misc() -> None:
    assert cause_of_failure(walk(line(500), seen_at=450)) == "misc"  # 10 m driven; 1.5 times the distance is 13.5 m


def test_an_agent_that_continues_where_a_stop_succeeds_has_missed_the_goal() -> None:
    distance_m = np.full(501, 9.0, np.float32)
    distance_m[480] = 0.0
    assert cause_of_failure(walk(line(500), seen_at=475, distance_m=distance_m)) == "missed_detection"
    distance_m[:] = 9.0
    distance_m[490] = 0.0
    assert cause_of_failure(walk(line(500), seen_at=475, distance_m=distance_m)) == "misc"


def test_an_agent_that_comes_near_the_goal_but_not_to_it_is_misc() -> None:
    distance_m = np.full(501, 9.0, np.float32)
    distance_m[300] = 0.9
    assert cause_of_failure(walk(line(500), seen_at=100, distance_m=distance_m)) == "misc"


def test_a_goal_passed_before_it_was_ever_seen_was_not_missed() -> None:
    distance_m = np.full(501, 9.0, np.float32)
    distance_m[100] = 0.0
    assert cause_of_failure(walk(line(500), distance_m=distance_m)) == "explore"


def test_a_robot_that_cannot_leave_is_trapped() -> None:
    assert cause_of_failure(walk(after(line(300), np.zeros((201, 2))))) == "trapped"


def test_the_first_problem_counts_between_trap_and_missed_goal() -> None:
    held_at_300 = after(line(300), np.zeros((201, 2)))
    assert cause_of_failure(walk(held_at_300, seen_at=100)) == "missed_detection"
    assert cause_of_failure(walk(held_at_300, seen_at=280)) == "trapped"
    assert cause_of_failure(walk(held_at_300, seen_at=400)) == "trapped"


def test_a_robot_that_drives_back_and_forth_is_in_a_loop() -> None:
    assert cause_of_failure(walk(shuttle(500))) == "loop"
    assert cause_of_failure(walk(shuttle(500), seen_at=2)) == "loop"


def test_the_second_round_of_a_circle_is_a_loop_and_the_first_is_not() -> None:
    angle = 0.04 * np.arange(501)  # 5 m from the centre, 157 steps per round
    circle = 5.0 * np.c_[np.cos(angle), np.sin(angle)]
    begin = first_looping_step(walk(circle))
    assert begin is not None
    assert 100 < begin < 200
    assert first_looping_step(walk(circle[:157])) is None


def test_a_return_over_known_ground_is_no_loop() -> None:
    there_and_back = after(line(100), line(100)[::-1])
    assert cause_of_failure(walk(after(there_and_back, np.flip(line(300), axis=1)))) == "explore"


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
