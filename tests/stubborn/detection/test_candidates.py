"""Rejected objects whose outline changes, and groups of cells that are too small to be an object."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.interface import SuccessRule
from stubborn.detection.classifiers import Features
from stubborn.detection.distances import StopDistances, TargetConfig
from stubborn.detection.seeker import TargetSeeker
from stubborn.mapping.mapper import Sighting
from stubborn.mapping.navmap import NavMap
from tests.helpers.asciimap import map_of
from tests.helpers.ground import BOTH_LAYERS, PLANNER
from tests.stubborn.detection.test_seeker import EXACT, RefuseAll


class ByMean:
    """A verifier that accepts objects with a mean score above 0.7."""

    may_refuse = True

    def accepts(self, goal: str, features: Features) -> bool:
        return features.cumulative > 0.7 * features.total_view

    would_accept = accepts


def seeker(verifier: object, least_cells: int = 4) -> TargetSeeker:
    distances = StopDistances.of(TargetConfig(), SuccessRule(), EXACT)
    seek = TargetSeeker(
        TargetConfig(),
        PLANNER,
        verifier,  # type: ignore[arg-type]
        layers=BOTH_LAYERS,
        distances=distances,
        candidate_score=0.5,
        least_cells=least_cells,
    )
    seek.reset("table")
    return seek


def room() -> NavMap:
    navmap, _ = map_of("\n".join("." * 80 for _ in range(60)))
    navmap.frames_in_view[:] = 10
    navmap.grow_known(slice(0, 60), slice(0, 80))
    return navmap


def show(navmap: NavMap, rows: slice, cols: slice, mean: float, step: int = 5) -> None:
    """Enters cells that were seen ten times with a mean score."""
    navmap.score_max[rows, cols] = 0.9
    navmap.score_sum[rows, cols] = 10 * mean
    navmap.found_step[rows, cols] = step


def test_a_rejected_object_stays_rejected_when_its_outline_grows_past_the_margin():
    navmap, seek = room(), seeker(ByMean())
    show(navmap, slice(20, 25), slice(40, 50), 0.4)
    assert seek.judge(navmap, (22, 44)) is False
    show(navmap, slice(20, 25), slice(50, 59), 0.9)  # 4 columns past the margin of 5 cells, and scored high
    assert not seek.candidates(navmap).any()
    assert seek.judge(navmap, (22, 57)) is False
    sighting = Sighting(np.array([22]), np.array([57]), np.array([0.5], np.float32))
    assert seek.in_reach(navmap, sighting) is None


@pytest.mark.parametrize("gap", [0, 2])
def test_pieces_of_a_rejected_object_belong_to_it_across_a_small_gap(gap: int):
    navmap, seek = room(), seeker(ByMean())
    show(navmap, slice(20, 25), slice(40, 50), 0.4)
    assert seek.judge(navmap, (22, 44)) is False
    show(navmap, slice(20, 25), slice(50, 55), 0.4)
    show(navmap, slice(20, 25), slice(55 + gap, 60), 0.9)
    assert not seek.candidates(navmap).any()


def test_a_real_object_that_touches_a_rejected_fragment_is_judged_by_its_own_cells():
    navmap, seek = room(), seeker(ByMean())
    show(navmap, slice(20, 22), slice(40, 44), 0.4)
    navmap.frames_in_view[20:22, 40:44] = 30
    navmap.score_sum[20:22, 40:44] = 12.0  # more than any cell of the table, at a mean of 0.4
    assert seek.judge(navmap, (21, 42)) is False
    show(navmap, slice(22, 32), slice(40, 60), 0.9)  # the table
    assert seek.candidates(navmap)[30, 55]
    assert not seek.candidates(navmap)[20:22, 40:44].any()
    assert seek.judge(navmap, (30, 55)) is True


def test_without_a_candidate_nothing_is_accepted():
    navmap, refuse = room(), RefuseAll()
    assert seeker(refuse).judge(navmap, (30, 30)) is False
    assert refuse.asked == []
    assert not navmap.rejected.any()


def test_a_few_cells_are_not_an_object():
    navmap = room()
    show(navmap, slice(30, 31), slice(40, 43), 0.9)
    sighting = Sighting(np.array([30]), np.array([41]), np.array([0.5], np.float32))
    for least_cells, counts in ((4, False), (3, True)):
        seek = seeker(ByMean(), least_cells)
        assert seek.candidates(navmap).any() == counts
        assert (seek.in_reach(navmap, sighting) is not None) == counts
        assert seek.judge(navmap, (30, 41)) is counts
