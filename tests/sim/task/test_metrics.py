"""Invariants of the metrics."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.core.interface import MPCAT40_ID
from sim.task.metrics import (
    EXPLORED_SHARE,
    TRAPPED_WINDOW_STEPS,
    goal_share,
    path_efficiency,
    per_metre,
    soft_spl,
    spl,
    stayed_near,
)

lengths = st.floats(0.0, 100.0)


@given(shortest=lengths, taken=lengths)
def test_spl_is_between_zero_and_success(shortest, taken):
    assert 0.0 <= spl(True, shortest, taken) <= 1.0
    assert spl(False, shortest, taken) == 0.0


@given(shortest=st.floats(0.01, 100.0), factor=st.floats(1.0, 10.0))
def test_spl_of_a_path_n_times_as_long_is_one_over_n(shortest, factor):
    assert spl(True, shortest, factor * shortest) == pytest.approx(1.0 / factor)


@given(shortest=lengths, share=st.floats(0.0, 1.0))
def test_a_path_no_longer_than_the_shortest_is_efficient(shortest, share):
    assert path_efficiency(shortest, share * shortest) == pytest.approx(1.0)


def test_standing_at_the_goal_from_the_start_is_perfect_and_wandering_there_is_not():
    assert spl(True, 0.0, 0.0) == 1.0
    assert spl(True, 0.0, 1.0) == 0.0


@given(start=st.floats(0.01, 100.0), taken=lengths)
def test_soft_spl_is_spl_at_the_goal_and_nothing_without_progress(start, taken):
    assert soft_spl(start, 0.0, taken) == spl(True, start, taken)
    assert soft_spl(start, start, taken) == 0.0
    assert soft_spl(start, 2.0 * start, taken) == 0.0
    assert soft_spl(start, None, taken) == 0.0


@given(start=st.floats(0.01, 100.0), near=st.floats(0.0, 1.0), far=st.floats(0.0, 1.0))
def test_soft_spl_grows_with_progress(start, near, far):
    near, far = sorted((near, far))
    assert soft_spl(start, near * start, start) >= soft_spl(start, far * start, start)


@pytest.mark.parametrize(("pixels", "seen"), [(79, False), (80, True)])
def test_the_goal_is_explored_at_eight_pixels_of_a_thousand(pixels, seen):
    frame = np.zeros((100, 100), dtype=np.uint8)
    frame.flat[:pixels] = MPCAT40_ID["bed"]
    assert (goal_share(frame, "bed") >= EXPLORED_SHARE) == seen
    assert goal_share(frame, "sofa") == 0.0


def walk(steps: int, speed_m: float) -> list[tuple[float, float]]:
    return [(speed_m * i, 0.0) for i in range(steps + 1)]


def test_a_robot_that_drives_straight_is_not_trapped_and_one_that_creeps_is():
    assert not stayed_near(walk(TRAPPED_WINDOW_STEPS, 0.25))
    assert not stayed_near(walk(TRAPPED_WINDOW_STEPS, 0.0101))
    assert stayed_near(walk(TRAPPED_WINDOW_STEPS, 0.0099))


def test_a_robot_that_leaves_once_and_returns_is_not_trapped():
    circle = [(0.6 * math.cos(a) - 0.6, 0.6 * math.sin(a)) for a in np.linspace(0, math.tau, TRAPPED_WINDOW_STEPS + 1)]
    assert not stayed_near(circle)


def test_a_walk_shorter_than_the_window_is_not_trapped():
    assert not stayed_near(walk(TRAPPED_WINDOW_STEPS - 1, 0.0))
    assert stayed_near(walk(TRAPPED_WINDOW_STEPS, 0.0))


def test_a_robot_that_turned_on_the_spot_saw_nothing_per_metre() -> None:
    assert per_metre(13.2, 3.5e-19) == 0.0
    assert per_metre(13.2, 2.0) == pytest.approx(6.6)
