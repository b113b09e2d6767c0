"""Verdicts on tracks by probability, steps left and views, and the viewpoints for a look at a doubtful one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.core.geometry.pose import Pose
from sim.core.interface import MAX_STEPS, MPCAT40, ConfigError, SegmenterSpec, SuccessRule
from stubborn.detection.distances import StopDistances, TargetConfig
from stubborn.detection.evidence import Evidence, EvidenceConfig
from stubborn.detection.fusion import Fusion
from stubborn.detection.look import LookConfig, Verdicts, believed, look_at
from stubborn.detection.viewpoints import LastResort, ViewpointFinder
from stubborn.mapping.masks import nearest
from stubborn.planning.planner import Route
from tests.helpers.asciimap import map_of
from tests.helpers.ground import BOTH_LAYERS, PLANNER

CLASSES = len(MPCAT40) - 1
TRACK = 1


def evidence(*bearings_rad: float) -> Evidence:
    """Returns the evidence of a track that was clearly seen from some directions."""
    result = Evidence(EvidenceConfig(), Fusion(), 2)
    for bearing_rad in bearings_rad:
        at = np.array([2.0 * math.cos(bearing_rad)]), np.array([2.0 * math.sin(bearing_rad)])
        result.add(np.array([TRACK]), np.full((1, CLASSES), 1.0 / CLASSES, np.float32), np.array([300]), *at)
    return result


class Judged:
    """A track and the decisions about it, step by step."""

    def __init__(
        self, *, exact: bool = False, looks: int = 0, distance_m: float = 2.0, max_steps: int = MAX_STEPS
    ) -> None:
        self.distance_m = distance_m
        self.pursued: int | None = None
        self.verdicts = Verdicts(LookConfig(), exact=exact, max_steps=max_steps)
        for _ in range(looks):
            self.verdicts.looked(TRACK)

    def at(self, p: float, step: int = 0, bearings_rad: tuple[float, ...] = ()) -> str:
        """Returns the verdict with a probability of the goal, at a step."""
        probability, distance_m = np.array([0.0, p], np.float32), np.array([0.0, self.distance_m])
        self.verdicts.update(probability, distance_m, evidence(*bearings_rad), step, self.pursued)
        if TRACK in self.verdicts.accepted:
            return "accepted"
        if TRACK in self.verdicts.rejected:
            return "rejected"
        return "doubtful" if TRACK in self.verdicts.doubtful else "none"


@pytest.mark.parametrize(
    ("p", "bearings_rad", "expected"),
    [
        (0.95, (), "accepted"),  # the probability depends on the number of views and their directions
        (0.65, (0.0,), "doubtful"),
        (0.65, (0.0, 0.5), "doubtful"),  # 30 deg apart are one view
        (0.65, (0.0, 1.1), "rejected"),
        (0.65, (3.0, -3.0), "doubtful"),  # also near to each other, across +-180 deg
        (0.1, (0.0,), "none"),
    ],
)
def test_below_the_bar_a_track_is_doubtful_until_it_was_seen_from_two_sides(
    p: float, bearings_rad: tuple[float, ...], expected: str
):
    assert Judged().at(p, 0, bearings_rad) == expected


def test_exact_posteriors_are_accepted_where_the_goal_is_most_probable():
    assert Judged(exact=True).at(0.6) == "accepted"
    assert Judged(exact=True).at(0.3) == "doubtful"


def test_after_the_last_look_a_track_below_the_bar_is_rejected():
    assert Judged(looks=1).at(0.65) == "doubtful"
    assert Judged(looks=2).at(0.65) == "rejected"


def test_a_rejected_track_is_accepted_when_it_looks_better_or_when_few_steps_are_left():
    track = Judged(looks=2)
    assert [track.at(0.5), track.at(0.95)] == ["rejected", "accepted"]
    track = Judged(looks=2)
    assert [track.at(0.35, step) for step in (0, 200, 420)] == ["rejected", "rejected", "accepted"]


def test_a_goal_exists_so_a_candidate_is_more_probable_the_more_was_seen_without_another_one():
    config = LookConfig()
    alone, two = np.array([0.0, 0.5], np.float32), np.array([0.0, 0.5, 0.5], np.float32)
    over_time = [float(believed(alone, step, config)[TRACK]) for step in (0, 100, 300)]
    assert over_time[0] == pytest.approx(0.5)
    assert over_time == sorted(over_time)
    assert over_time[2] == pytest.approx(0.5 / (1.0 - 0.5 * 0.85), abs=0.05)
    assert believed(two, 300, config)[TRACK] < over_time[2]
    one_object = np.array([0, 1, 1])
    assert believed(two, 300, config, one_object)[TRACK] == pytest.approx(over_time[2])
    assert believed(np.array([0.0, 1.0], np.float32), 300, config).max() == 1.0


def test_only_a_track_that_was_looked_at_is_judged_by_what_else_there_is():
    assert Judged().at(0.65, 150, (0.0,)) == "doubtful"
    assert Judged(looks=1).at(0.65, 150, (0.0,)) == "accepted"
    track = Judged(looks=2)
    assert [track.at(0.65, 150) for _ in range(2)] == ["rejected", "accepted"]
    assert Judged(looks=1).at(0.65, 150) == "doubtful"  # the look did not show it


def test_an_accepted_track_remains_so_until_it_is_well_below_the_bar():
    track = Judged()
    assert [track.at(p) for p in (0.81, 0.75, 0.65, 0.75)] == ["accepted", "accepted", "doubtful", "doubtful"]


def test_a_near_object_that_was_never_seen_whole_gets_a_look_before_it_is_accepted():
    near = 1.0
    assert Judged(distance_m=near).at(0.95) == "doubtful"
    assert Judged(distance_m=near).at(0.95, 0, (0.0,)) == "accepted"
    assert Judged(distance_m=near, looks=1).at(0.95) == "accepted"
    assert Judged(distance_m=near).at(0.95, MAX_STEPS - 99) == "accepted"  # no time
    assert Judged(distance_m=near, exact=True).at(0.95) == "accepted"


def test_a_candidate_that_became_unreachable_is_not_accepted():
    assert Judged(distance_m=15.0).at(0.95, MAX_STEPS - 100) == "accepted"
    assert Judged(distance_m=18.0).at(0.95, MAX_STEPS - 100) == "doubtful"


@pytest.mark.parametrize("max_steps", [200, MAX_STEPS, 2000])
def test_the_risk_follows_the_steps_that_the_episode_has_left(max_steps: int):
    assert Judged(max_steps=max_steps).at(0.45, max_steps - 100) == "accepted"
    assert Judged(max_steps=max_steps).at(0.45, max_steps - 150) == "doubtful"
    assert Judged(max_steps=max_steps, distance_m=18.0).at(0.95, max_steps - 100) == "doubtful"


def test_a_look_that_began_goes_on_until_the_probability_is_well_below_that_of_its_beginning():
    track = Judged()
    assert [track.at(p) for p in (0.32, 0.28)] == ["doubtful", "none"]
    track.pursued = TRACK
    assert [track.at(p) for p in (0.32, 0.28, 0.2, 0.16)] == ["doubtful", "doubtful", "doubtful", "none"]


def test_the_bar_falls_as_steps_run_out():
    bar = [LookConfig().bar_with(MAX_STEPS - step) for step in range(MAX_STEPS + 1)]
    assert bar == sorted(bar, reverse=True)
    assert [bar[step] for step in (0, 250, 400, MAX_STEPS)] == pytest.approx([0.8, 0.63, 0.4, 0.05])


@pytest.mark.parametrize(
    "wrong",
    [{"bar": ()}, {"bar": ((100, 0.5), (50, 0.1))}, {"bar": ((0, 1.5),)}, {"slack": -0.1}, {"look_m": (2.0, 1.0)},
     {"most_looks": -1}, {"per_metre": -0.1}, {"straight": -0.1}, {"detour_m": -1.0},
     {"patience_steps": -1}, {"unseen_steps": 0.0}, {"missed": 1.5}],
)  # fmt: skip
def test_wrong_values_are_refused(wrong: dict):
    with pytest.raises(ConfigError, match="LookConfig"):
        LookConfig(**wrong)


def looks_from(*seen_from_rad: float) -> Route:
    """Returns the route to the viewpoints of a cell in the middle of a room, for a robot to its left."""
    navmap, _ = map_of("\n".join("." * 140 for _ in range(140)))
    navmap.frames_in_view[:] = 1
    target = np.zeros(navmap.frame.shape, np.bool_)
    target[70, 70] = True
    x_m, y_m = (float(v) for v in navmap.frame.centres(70, 70))
    distances = StopDistances.of(TargetConfig(), SuccessRule(), SegmenterSpec())
    finder = ViewpointFinder(PLANNER, BOTH_LAYERS, distances, 0.08)
    seen = np.zeros(12, np.bool_)
    seen[[round(bearing_rad / math.tau * 12) % 12 for bearing_rad in seen_from_rad]] = True
    pose = Pose(x_m - 3.0, y_m, 0.0)
    approach = look_at(navmap, nearest(target), (x_m, y_m), seen, pose, finder, LookConfig())
    assert approach is not None
    assert approach.cell == (70, 70)
    assert not approach.near_enough
    assert approach.route is not None
    return approach.route


def test_a_look_is_taken_from_where_the_whole_object_is_in_view():
    rows, cols = np.nonzero(looks_from().goal.cells)
    gap_m = 0.05 * np.hypot(rows - 70, cols - 70)
    assert 1.25 <= gap_m.min() <= gap_m.max() <= 2.3


def test_a_second_look_is_taken_from_another_direction():
    rows, cols = np.nonzero(looks_from(math.pi).goal.cells)  # it was seen from the left
    bearing_rad = np.arctan2(rows - 70, cols - 70)
    off_rad = np.abs(np.arctan2(np.sin(bearing_rad - math.pi), np.cos(bearing_rad - math.pi)))
    assert off_rad.min() >= math.radians(44)


@pytest.mark.parametrize(
    ("counter_m", "seen_from_x", "found"), [(0.0, -1.0, False), (0.65, -1.0, True), (0.65, 1.0, False)]
)
def test_what_stands_on_a_counter_is_seen_over_its_edge_but_only_from_the_side_from_which_it_was_seen(
    counter_m: float, seen_from_x: float, found: bool
):
    navmap, _ = map_of("\n".join("." * 60 + "#" + "." * 39 for _ in range(60)))
    navmap.frames_in_view[:] = 1
    navmap.seen_at_eye_level[:, 60] = True
    target = np.zeros(navmap.frame.shape, np.bool_)
    target[30, 66] = True  # 0.3 m behind the edge
    navmap.shown_x[target] = seen_from_x
    distances = StopDistances.of(TargetConfig(), SuccessRule(), SegmenterSpec())
    finder = ViewpointFinder(PLANNER, BOTH_LAYERS, distances, 0.08, counter_m)
    x_m, y_m = (float(v) for v in navmap.frame.centres(30, 40))
    pose, cells = Pose(x_m, y_m, 0.0), nearest(target)
    assert not list(finder.find(navmap, pose, cells, LastResort.NONE))
    kinds = list(finder.find(navmap, pose, cells, LastResort.NONE, over_counters=True))
    assert bool(kinds) == found
    assert all(kind.near_enough and np.nonzero(kind.cells)[1].max() < 60 for kind in kinds)
