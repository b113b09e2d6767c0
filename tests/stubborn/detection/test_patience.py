"""Tracks that wait, and missing progress."""

from __future__ import annotations

import pytest

from sim.core.geometry.pose import Pose
from stubborn.detection.patience import Progress, SetAside


@pytest.mark.parametrize(("step", "due"), [(200, 240), (390, 420), (430, 470)])
def test_a_track_waits_but_not_beyond_the_step_of_the_last_resort(step: int, due: int):
    aside = SetAside(first_steps=40, last_resort_step=420)
    aside.add([3], step)
    assert [aside.is_due(3, at) for at in (step, due - 1, due)] == [False, False, True]
    assert aside.is_due(4, step)


def test_each_time_a_track_waits_twice_as_long_until_all_waiting_ends():
    aside = SetAside(first_steps=40, last_resort_step=420)
    for step, due in ((0, 40), (40, 120), (120, 280)):
        aside.add([3], step)
        assert not aside.is_due(3, due - 1)
        assert aside.is_due(3, due)
    aside.end()
    assert aside.is_due(3, 280)
    aside.add([3], 280)
    assert aside.is_due(3, 320)


def test_around_a_place_tracks_wait_for_the_first_time_only():
    aside = SetAside(first_steps=40, last_resort_step=420)
    aside.add_spot(1.0, 2.0, step=100)
    aside.end()
    assert aside.is_near_spot(1.4, 2.3, 0.5, step=139)
    assert not aside.is_near_spot(1.4, 2.4, 0.5, step=139)
    assert not aside.is_near_spot(1.4, 2.3, 0.5, step=140)


def test_a_felt_surface_restarts_the_count_of_missing_progress():
    here = Pose(0.0, 0.0, 0.0)

    def stuck_after(felt_at: int) -> int:
        progress = Progress(least_m=1.0, most_steps=5, most_pushes=2)
        return next(n for n in range(20) if progress.is_stuck(here, pursuing=True, times_felt=int(n >= felt_at)))

    assert stuck_after(20) == 5
    assert stuck_after(3) == 8


def test_something_stops_a_robot_that_drives_and_does_not_move():
    progress = Progress(least_m=1.0, most_steps=5, most_pushes=2)
    here = Pose(0.0, 0.0, 0.0)
    seen = []
    for drove in (True, False, True, True):
        progress.count_pushes(here, drove=drove)
        seen.append(progress.pushes_on)
    assert seen == [False, False, False, True]
    progress.count_pushes(Pose(0.25, 0.0, 0.0), drove=True)
    assert not progress.pushes_on
