"""Verdicts on tracks by probability and views, and the places from which a doubtful one is looked at."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.geometry.pose import Pose
from sim.interface import MPCAT40, SegmenterSpec, SuccessRule
from stubborn.planning.planner import Route
from stubborn.raster import nearest
from stubborn.target.distances import StopDistances, TargetConfig
from stubborn.target.evidence import Evidence, EvidenceConfig
from stubborn.target.look import LookConfig, Verdicts, look_at
from stubborn.target.viewpoints import ViewpointFinder
from tests.helpers.asciimap import map_of
from tests.helpers.ground import BOTH_LAYERS, PLANNER

CLASSES = len(MPCAT40) - 1
TRACK = 1


def evidence(*bearings_rad: float) -> Evidence:
    """Returns the evidence of a track that was seen well from some directions."""
    result = Evidence(EvidenceConfig(), 2, CLASSES)
    for bearing_rad in bearings_rad:
        at = np.array([2.0 * math.cos(bearing_rad)]), np.array([2.0 * math.sin(bearing_rad)])
        result.add(np.array([TRACK]), np.full((1, CLASSES), 1.0 / CLASSES, np.float32), np.array([300]), *at)
    return result


def verdict(p: float, *bearings_rad: float, exact: bool = False, looks: int = 0, rejected: bool = False) -> str:
    verdicts = Verdicts(LookConfig(), exact=exact)
    if rejected:
        verdicts.settle(TRACK, 0.0)
    for _ in range(looks):
        verdicts.looked(TRACK)
    probability = np.array([0.0, p], np.float32)
    verdicts.update(probability, evidence(*bearings_rad))
    if TRACK in verdicts.accepted:
        return "accepted"
    return "rejected" if TRACK in verdicts.rejected else "doubtful" if verdicts.doubtful(probability) else "none"


@pytest.mark.parametrize(
    ("p", "bearings_rad", "expected"),
    [
        (0.95, (), "doubtful"),  # seen from afar only
        (0.95, (0.0,), "accepted"),
        (0.7, (0.0,), "doubtful"),
        (0.7, (0.0, 0.5), "doubtful"),  # 30 deg apart are one view
        (0.7, (0.0, 1.1), "accepted"),
        (0.7, (3.0, -3.0), "doubtful"),  # as near to each other around the back
        (0.4, (0.0, 1.1), "rejected"),
        (0.1, (0.0,), "none"),
    ],
)
def test_one_decisive_view_or_two_that_differ_decide(p: float, bearings_rad: tuple[float, ...], expected: str):
    assert verdict(p, *bearings_rad) == expected


def test_exact_posteriors_need_no_look():
    assert verdict(0.95, exact=True) == "accepted"


def test_after_the_last_look_a_track_is_decided_on():
    assert verdict(0.55, 0.0, looks=2) == "accepted"
    assert verdict(0.45, 0.0, looks=2) == "rejected"
    assert verdict(0.45, 0.0, looks=1) == "doubtful"


def test_a_rejected_track_stays_rejected_until_much_speaks_for_it():
    assert verdict(0.7, 0.0, 1.1, rejected=True) == "rejected"
    assert verdict(0.85, 0.0, 1.1, rejected=True) == "accepted"


def test_near_the_end_the_bar_for_a_try_falls():
    config = LookConfig()
    tries = [config.last_try(step) for step in (0, 379, 380, 439, 440, 499)]
    assert tries == [math.inf, math.inf, 0.3, 0.3, 0.05, 0.05]


def looks_from(*seen_from_rad: float) -> Route:
    """Returns the route to the places to look from at a cell in the middle of a room, for a robot to its left."""
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
