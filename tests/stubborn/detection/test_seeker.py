import math

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame, Window
from sim.core.geometry.pose import Pose
from sim.core.interface import ConfigError, SegmenterSpec, SuccessRule
from stubborn.detection.approach import Approach
from stubborn.detection.candidates import CandidateParts
from stubborn.detection.classifiers import Features
from stubborn.detection.distances import StopDistances, TargetConfig
from stubborn.detection.seeker import TargetSeeker, _seen_best, _seen_best_of_each
from stubborn.detection.verification import AcceptAll, Verifier
from stubborn.mapping.mapper import Sighting
from stubborn.mapping.masks import distance_to, nearest, sight_is_clear
from stubborn.mapping.navmap import NavMap
from stubborn.planning.planner import Route
from tests.helpers.asciimap import map_of
from tests.helpers.ground import BOTH_LAYERS, PLANNER, whole

EXACT, INEXACT = SegmenterSpec(exact_outlines=True), SegmenterSpec(exact_outlines=False)


class RefuseAll:
    """A verifier that records its calls."""

    may_refuse = True

    def __init__(self) -> None:
        self.asked: list[tuple[str, Features]] = []

    def accepts(self, goal: str, features: Features) -> bool:
        self.asked.append((goal, features))
        return False

    def would_accept(self, goal: str, features: Features) -> bool:
        return False


class Doubtful:
    """A verifier that accepts objects with a mean score above 0.7."""

    may_refuse = True

    def accepts(self, goal: str, features: Features) -> bool:
        return features.cumulative / features.total_view > 0.7

    would_accept = accepts


def made(config: TargetConfig, verifier: Verifier, segmenter: SegmenterSpec) -> TargetSeeker:
    distances = StopDistances.of(config, SuccessRule(), segmenter)
    seek = TargetSeeker(config, PLANNER, verifier, layers=BOTH_LAYERS, distances=distances, candidate_score=0.5)
    seek.reset("sofa")
    return seek


def seeker(verifier: Verifier | None = None, **options: float) -> TargetSeeker:
    return made(TargetConfig(**options), verifier or AcceptAll(), EXACT)  # type: ignore[arg-type]


def approached(
    seek: TargetSeeker, navmap: NavMap, pose: Pose, step: int = 0, *, window: Window | None = None
) -> Approach:
    """Returns the approach to a candidate; there must be one."""
    approach = seek.approach(navmap, window or whole(navmap), pose, step)
    assert approach is not None
    return approach


def routed(
    seek: TargetSeeker, navmap: NavMap, pose: Pose, step: int = 0, *, window: Window | None = None
) -> tuple[Approach, Route]:
    """Returns the approach to a candidate and its route; there must be one."""
    approach = approached(seek, navmap, pose, step, window=window)
    assert approach.route is not None
    return approach, approach.route


def known(text: str) -> tuple[NavMap, Pose]:
    """Returns a map drawn with letters on which every cell has been in view once."""
    navmap, pose = map_of(text)
    navmap.frames_in_view[:] = 1
    navmap.grow_known(*(slice(0, n) for n in navmap.frame.shape))
    return navmap, pose


def room(width: int = 80, height: int = 60, **places: tuple[int, int]) -> list[list[str]]:
    """Returns a walled room with letters at (row from below, column)."""
    rows = [["#" if c in (0, width - 1) else "." for c in range(width)] for _ in range(height)]
    rows[0] = rows[-1] = ["#"] * width
    for letter, (row, col) in places.items():
        rows[height - 1 - row][col] = letter
    return rows


def text_of(rows: list[list[str]]) -> str:
    return "\n".join("".join(r) for r in rows)


def test_without_a_candidate_there_is_no_approach():
    navmap, pose = known(text_of(room(R=(30, 10))))
    assert seeker().approach(navmap, whole(navmap), pose, 0) is None


def test_the_route_leads_to_a_viewpoint_near_the_candidate():
    navmap, pose = known(text_of(room(R=(30, 10), T=(30, 60))))
    approach, route = routed(seeker(), navmap, pose)
    assert approach.cell == (30, 60)
    rows, cols = np.nonzero(route.goal.cells)
    assert np.hypot(rows - 30, cols - 60).max() * 0.05 <= 0.85 * 1.03  # the fast distance is good to 2 %
    assert route.length_m == pytest.approx(2.5 - 0.85, abs=0.1)


def test_on_a_viewpoint_there_is_no_route_left():
    navmap, pose = known(text_of(room(R=(30, 46), T=(30, 60))))
    approach = approached(seeker(), navmap, pose)
    assert approach.route is None
    assert approach.bearing_rad == pytest.approx(0.0, abs=1e-6)


def test_with_inexact_outlines_the_agent_goes_nearer():
    navmap, pose = known(text_of(room(R=(30, 10), T=(30, 60))))
    config = TargetConfig(outline_margin_m=0.3)
    careful = made(config, AcceptAll(), INEXACT)
    _, route = routed(careful, navmap, pose)
    assert route.length_m == pytest.approx(2.5 - 0.55, abs=0.1)
    for distance_m, near_enough in ((0.80, False), (0.60, True)):
        sighting = Sighting(np.array([30]), np.array([60]), np.array([distance_m], np.float32))
        assert seeker().in_reach(navmap, sighting) == (30, 60)
        assert (careful.in_reach(navmap, sighting) is not None) == near_enough


def test_without_a_nearer_viewpoint_the_usual_one_is_used():
    rows = room(R=(30, 10), T=(30, 60))
    for row in range(1, 59):
        for col in range(48, 60):
            rows[row][col] = "o"
    navmap, pose = known(text_of(rows))
    careful = made(TargetConfig(), AcceptAll(), INEXACT)
    approach = approached(careful, navmap, pose)
    assert approach.near_enough
    assert approach.route is not None
    _, cols = np.nonzero(approach.route.goal.cells)
    assert cols.min() >= 60 - 0.85 / 0.05  # not from farther away than with true outlines


@pytest.mark.parametrize("segmenter", [EXACT, INEXACT])
def test_distances_shift_with_the_success_distance_and_stay_within_it(segmenter: SegmenterSpec):
    usual = StopDistances.of(TargetConfig(), SuccessRule(), segmenter)
    for distance_m in (0.06, 0.3, 0.5, 2.0):
        shifted = StopDistances.of(TargetConfig(), SuccessRule(distance_m=distance_m), segmenter)
        assert 0.0 < shifted.in_view_m < distance_m
        assert 0.0 < shifted.viewpoints_m[0] <= shifted.viewpoints_m[1] < distance_m
        assert shifted.last_resort_m > shifted.viewpoints_m[1]
        if distance_m > 1.0:
            assert shifted.in_view_m - usual.in_view_m == pytest.approx(distance_m - 1.0)


def test_a_margin_as_large_as_the_distance_is_refused():
    with pytest.raises(ConfigError, match=r"0 <= outline_margin_m < viewpoint_m and stop_in_view_m, got 0\.9, 0\.85"):
        TargetConfig(outline_margin_m=0.9)


def doubtful_one_first() -> tuple[NavMap, Pose]:
    """Returns a map with a nearby candidate of mostly low scores and a clear candidate farther away."""
    navmap, pose = known(text_of(room(R=(30, 10), T=(30, 60))))
    navmap.score_max[30, 35] = 0.6
    navmap.score_sum[30, 35], navmap.score_sum[30, 60] = 3.0, 9.0
    navmap.frames_in_view[30, 35] = navmap.frames_in_view[30, 60] = 10
    return navmap, pose


def test_candidates_that_would_be_accepted_are_approached_first():
    navmap, pose = doubtful_one_first()
    for verifier, cell in ((AcceptAll(), (30, 35)), (Doubtful(), (30, 60))):
        approach = approached(seeker(verifier), navmap, pose)
        assert approach.cell == cell


def test_doubtful_candidates_are_approached_when_there_is_no_other():
    navmap, pose = doubtful_one_first()
    navmap.rejected[30, 60] = True
    approach = approached(seeker(Doubtful()), navmap, pose)
    assert approach.cell == (30, 35)


def test_an_acceptable_candidate_without_a_viewpoint_does_not_hold_up_the_others():
    rows = room(R=(30, 10), T=(30, 60))
    for row in range(60):
        for col in range(40, 80):
            if rows[59 - row][col] == ".":
                rows[59 - row][col] = "o"
    navmap, pose = known(text_of(rows))
    navmap.score_max[30, 25], navmap.score_sum[30, 25], navmap.score_sum[30, 60] = 0.6, 3.0, 9.0
    navmap.frames_in_view[:] = 10
    approach = approached(seeker(Doubtful()), navmap, pose)
    assert approach.cell == (30, 25)


class Wavering(Doubtful):
    """Otherwise it would alternate between the two."""

    def __init__(self) -> None:
        self.asked = 0

    def would_accept(self, goal: str, features: Features) -> bool:
        self.asked += 1
        return self.asked % 4 in (0, 1)


def test_an_acceptable_candidate_is_pursued_to_the_end():
    navmap, pose = doubtful_one_first()
    wavering = seeker(Wavering())
    approaches = [wavering.approach(navmap, whole(navmap), pose, step) for step in range(6)]
    assert len({approach.cell for approach in approaches if approach}) == 1


def test_a_part_is_acceptable_as_its_cell_seen_best():
    navmap, _ = known(text_of(room(R=(30, 10), T=(30, 60))))
    navmap.score_max[30, 61] = navmap.score_max[30, 35] = 0.6
    navmap.frames_in_view[:] = 10
    navmap.score_sum[30, 60], navmap.score_sum[30, 61], navmap.score_sum[30, 35] = 9.0, 2.0, 3.0
    doubtful = seeker(Doubtful())
    assert np.argwhere(doubtful._acceptable(navmap, doubtful.parts(navmap))).tolist() == [[30, 60], [30, 61]]


def test_the_approached_cell_is_the_candidate_that_the_route_leads_to():
    rows = room(R=(30, 10), T=(30, 60))
    for row in range(22, 39):
        for col in range(14, 33):
            if row in (22, 38) or col in (14, 32):
                rows[row][col] = "#"  # walls all around another candidate, which is nearer in a straight line
    navmap, pose = known(text_of(rows))
    navmap.score_max[30, 23] = 0.9
    approach, route = routed(seeker(), navmap, pose)
    _, cols = np.nonzero(route.goal.cells)
    assert cols.min() > 32
    assert approach.cell == (30, 60)


def test_no_viewpoint_lies_behind_a_wall_however_near():
    rows = room(R=(30, 30), T=(30, 41))
    for row in range(60):
        rows[row][39] = "#"
    for row in range(2, 14):
        rows[row][39] = "."
    navmap, pose = known(text_of(rows))
    approach = approached(seeker(), navmap, pose)
    assert approach.route is not None  # 0.55 m away in a straight line, and yet the path goes around
    assert approach.route.length_m > 1.5
    _, cols = np.nonzero(approach.route.goal.cells)
    assert cols.min() > 39


def test_no_viewpoint_lies_on_unseen_ground_behind_an_object_that_hangs_on_a_wall():
    """The wall behind a picture is hidden by it, and the ground behind that wall was never in view."""
    rows = room(R=(30, 10), T=(30, 40))
    for row in range(20, 40):
        for col in range(30, 41):
            if rows[59 - row][col] == ".":
                rows[59 - row][col] = "#" if col == 40 else "o"
    navmap, pose = known(text_of(rows))
    navmap.frames_in_view[:, 41:] = 0
    navmap.shown_x[30, 40] = -1.0  # it was seen from the left
    seek = seeker()
    _, route = routed(seek, navmap, pose)
    _, cols = np.nonzero(route.goal.cells)
    assert cols.max() <= 40
    navmap.frames_in_view[:, 41:] = 1  # now the ground behind is known to be open
    _, route = routed(seek, navmap, pose)
    _, cols = np.nonzero(route.goal.cells)
    assert cols.max() > 40
    navmap.sided = True  # a remembered object: furniture may hide the wall behind it, and hides this ground
    navmap.frames_in_view[:, 41] = 0
    _, route = routed(seek, navmap, pose)
    _, cols = np.nonzero(route.goal.cells)
    assert cols.max() <= 40


def test_low_furniture_hides_nothing():
    rows = room(R=(30, 20), T=(30, 45))
    for row in range(20, 40):
        for col in range(36, 45):
            rows[row][col] = "o"
    navmap, pose = known(text_of(rows))
    _, route = routed(seeker(), navmap, pose)
    assert route.length_m < 1.0


def enclosed_target() -> tuple[NavMap, Pose]:
    rows = room(R=(30, 10), T=(30, 60))
    for row in range(5, 55):
        for col in range(35, 79):
            if row < 8 or row > 51 or col < 38:
                rows[row][col] = "#"
    return known(text_of(rows))


def test_an_unreachable_candidate_is_set_aside_and_tried_again_later():
    navmap, pose = enclosed_target()
    seek = seeker(retry_after_steps=10)
    assert seek.approach(navmap, whole(navmap), pose, 0) is None
    assert navmap.set_aside[30, 60]
    assert not navmap.rejected.any()
    navmap.seen_obstacle[20:40, 35:38] = navmap.seen_at_eye_level[20:40, 35:38] = False
    assert seek.approach(navmap, whole(navmap), pose, 9) is None
    assert seek.approach(navmap, whole(navmap), pose, 10) is not None


def test_each_time_a_candidate_cannot_be_reached_it_waits_twice_as_long():
    navmap, pose = enclosed_target()
    seek, tried = seeker(retry_after_steps=10), []
    for step in range(80):
        navmap.set_aside[0, 0] = True  # removed when all deferred candidates are tried again
        assert seek.approach(navmap, whole(navmap), pose, step) is None
        if not navmap.set_aside[0, 0]:
            tried.append(step)
    assert tried == [0, 10, 30, 70]


def far_target() -> tuple[NavMap, Pose]:
    """Returns a map with a candidate in a large piece of furniture, 1.35 m from the nearest free place."""
    rows = room(R=(30, 10), T=(30, 60))
    for row in range(6, 54):
        for col in range(36, 79):
            if rows[59 - row][col] == ".":
                rows[59 - row][col] = "o"
    return known(text_of(rows))


def test_a_candidate_that_cannot_be_got_near_is_verified_from_the_nearest_reachable_place():
    navmap, pose = far_target()
    assert seeker().approach(navmap, whole(navmap), pose, 0) is None  # there is nothing to verify
    navmap, pose = far_target()
    seek = seeker(RefuseAll())
    approach, route = routed(seek, navmap, pose)
    assert not approach.near_enough
    rows, cols = np.nonzero(route.goal.cells)
    reachable = route.goal.free.reachable
    gap_cells = np.hypot(*(np.indices(reachable.shape) - np.array((30, 60))[:, None, None]))
    assert np.hypot(rows - 30, cols - 60).max() <= gap_cells[reachable].min() * 1.03 + 4.0
    x_m, y_m = navmap.frame.centres(rows[0], cols[0])
    there = Pose(float(x_m), float(y_m), 0.0)
    approach = approached(seek, navmap, there, 1)
    assert approach.route is None
    assert not approach.near_enough
    assert seek.judge(navmap, approach.cell) is False
    assert seek.approach(navmap, whole(navmap), there, 2) is None


def test_a_candidate_accepted_from_too_far_away_waits_and_is_near_enough_late_in_the_episode():
    navmap, pose = far_target()
    seek = seeker(RefuseAll(), last_resort_step=100, retry_after_steps=10)
    approach = approached(seek, navmap, pose, 5)
    assert not approach.near_enough
    seek.postpone(navmap, 5)
    assert seek.approach(navmap, whole(navmap), pose, 14) is None
    assert seek.approach(navmap, whole(navmap), pose, 15) is not None
    late = seek.approach(navmap, whole(navmap), pose, 100)
    assert late is not None
    assert late.near_enough


def test_optimistic_marks_count_when_pessimistic_ones_close_the_path_to_a_target():
    rows = room(R=(30, 10), T=(30, 60))
    for row in range(1, 59):
        for col in (30, 31, 32):
            rows[row][col] = "w"
    navmap, pose = known(text_of(rows))
    _, route = routed(seeker(), navmap, pose)
    assert route.length_m < 2.0
    navmap.optimistic_marks[:] = navmap.pessimistic_marks
    assert seeker().approach(navmap, whole(navmap), pose, 0) is None


def test_a_candidate_outside_the_local_window_is_still_approached():
    navmap, pose = known(text_of(room(width=300, R=(30, 10), T=(30, 280))))
    window = navmap.frame.window_at(pose.x_m, pose.y_m, 100)
    approach, route = routed(seeker(), navmap, pose, window=window)
    assert approach.cell == (30, 280)
    assert route.length_m > 12.0


def sighting_at(*places: tuple[int, int, float]) -> Sighting:
    rows, cols, distance_m = (np.array(v) for v in zip(*places, strict=True))
    return Sighting(rows, cols, distance_m.astype(np.float32))


def test_a_target_point_in_view_within_reach_ends_the_approach():
    navmap, _ = known(text_of(room(R=(30, 10))))
    navmap.score_max[30, [26, 31]] = 0.9
    seek = seeker()
    assert seek.in_reach(navmap, sighting_at((30, 31, 1.2))) is None
    assert seek.in_reach(navmap, sighting_at((30, 31, 1.2), (30, 26, 0.8))) == (30, 26)
    navmap.rejected[30, 26] = True
    assert seek.in_reach(navmap, sighting_at((30, 31, 0.9), (30, 26, 0.8))) == (30, 31)
    assert seek.in_reach(navmap, sighting_at((30, 31, 1.2), (30, 26, 0.8))) is None


def test_a_point_in_view_that_is_no_candidate_on_the_map_is_not_in_reach():
    navmap, _ = known(text_of(room(R=(30, 10))))
    assert seeker().in_reach(navmap, sighting_at((30, 26, 0.8))) is None


def test_a_verifier_is_asked_with_the_four_features_and_refusal_takes_the_connected_cells_and_a_margin():
    navmap, _ = known(text_of(room(R=(30, 10))))
    navmap.score_max[20:25, 40:50] = 0.9
    navmap.score_max[20:25, 60] = 0.9
    navmap.score_sum[22, 44], navmap.other_max[22, 44], navmap.frames_in_view[22, 44] = 3.5, 0.4, 7
    navmap.score_sum[22, 60] = 9.0  # another candidate
    refuse = RefuseAll()
    seek = seeker(refuse)
    assert seek.judge(navmap, (20, 40)) is False  # approached at its edge, judged by its cell seen best
    [(goal, features)] = refuse.asked
    assert goal == "sofa"
    assert tuple(features) == pytest.approx((7, 3.5, 0.9, 0.4))
    assert navmap.rejected[20:25, 40:50].all()
    assert navmap.rejected[22, 40 - 5]
    assert not navmap.rejected[22, 40 - 6]
    assert not navmap.rejected[22, 60]
    left = seek.candidates(navmap)
    assert left.any()
    assert not left[:, :56].any()


def test_a_candidate_first_found_after_step_200_is_not_verified():
    navmap, _ = known(text_of(room(R=(30, 10))))
    navmap.score_max[20:25, 40:50] = 0.9
    navmap.found_step[20:25, 40:50] = 201
    refuse = RefuseAll()
    assert seeker(refuse).judge(navmap, (22, 44)) is True
    assert refuse.asked == []
    navmap.found_step[24, 49] = 200
    assert seeker(refuse).judge(navmap, (22, 44)) is False


def test_a_late_candidate_is_not_verified_beside_a_rejected_object_either():
    navmap, _ = known(text_of(room(R=(30, 10))))
    navmap.score_max[20:25, 40:50] = 0.9
    navmap.found_step[20:25, 40:50] = 201
    navmap.rejected[20:25, 38:40] = True  # next to the candidate
    refuse = RefuseAll()
    assert seeker(refuse).judge(navmap, (22, 44)) is True
    assert refuse.asked == []


def test_reset_forgets_deferred_candidates_and_their_waiting_times():
    navmap, pose = enclosed_target()
    seek = seeker(retry_after_steps=10)
    for step in (0, 10, 30):
        assert seek.approach(navmap, whole(navmap), pose, step) is None
    seek.reset("sofa")
    fresh, pose = enclosed_target()
    assert seek.approach(fresh, whole(fresh), pose, 0) is None
    assert fresh.set_aside.any()
    fresh.seen_obstacle[:] = False  # the path opens
    fresh.seen_at_eye_level[:] = False
    assert seek.approach(fresh, whole(fresh), pose, 9) is None
    assert seek.approach(fresh, whole(fresh), pose, 10) is not None


def test_viewpoints_in_the_wrong_order_are_refused():
    with pytest.raises(ConfigError, match="viewpoint_m <= far_viewpoint_m"):
        TargetConfig(viewpoint_m=1.2)


def test_sight_ends_at_the_first_blocked_cell_but_not_at_the_targets_own_edge():
    blocked = np.zeros((20, 20), bool)
    blocked[10, 12] = True
    starts, ends = (np.array([10, 10, 5]), np.array([2, 2, 2])), (np.array([10, 10, 5]), np.array([18, 13, 18]))
    np.testing.assert_array_equal(sight_is_clear(blocked, starts, ends, 1.6), [False, True, True])
    nothing = np.zeros(0, int)
    assert sight_is_clear(blocked, (nothing, nothing), (nothing, nothing), 1.0).size == 0


def test_nearest_cell_and_distance_agree_with_brute_force():
    mask = np.zeros((30, 40), bool)
    cells = [(3, 4), (25, 30), (12, 39)]
    for cell in cells:
        mask[cell] = True
    distance, rows, cols = nearest(mask)
    exact = distance_to(mask)
    for row in range(0, 30, 3):
        for col in range(0, 40, 3):
            gaps = [math.hypot(row - r, col - c) for r, c in cells]
            assert exact[row, col] == pytest.approx(min(gaps), abs=1e-3)
            assert distance[row, col] == pytest.approx(min(gaps), rel=0.03)
            assert math.hypot(row - rows[row, col], col - cols[row, col]) <= min(gaps) * 1.05 + 1e-6


def test_the_known_window_holds_all_that_was_seen_and_a_margin():
    navmap = NavMap.empty(GridFrame.around_start(101, 0.05))
    assert navmap.known_window(5).frame.shape == (11, 11)
    navmap.grow_known(slice(20, 25), slice(30, 31))
    navmap.grow_known(slice(60, 61), slice(28, 91))
    window = navmap.known_window(5)
    assert (window.rows, window.cols) == (slice(15, 66), slice(23, 96))


class Rated(Doubtful):
    """A verifier that also states a probability."""

    def probability(self, goal: str, features: Features) -> float:
        return 0.9 if self.accepts(goal, features) else 0.2


def test_the_confidence_is_the_verifiers_probability_of_what_it_accepted_last_else_the_highest_score():
    for verifier, confidence in ((Rated(), 0.9), (AcceptAll(), 0.8), (RefuseAll(), None)):
        navmap, _ = known(text_of(room(R=(30, 10), T=(30, 60))))
        navmap.score_sum[30, 60], navmap.score_max[30, 60] = 0.8, 0.8
        seek = seeker(verifier)
        assert seek.confidence is None
        assert seek.judge(navmap, (30, 60)) == (confidence is not None)
        assert seek.confidence == (None if confidence is None else pytest.approx(confidence))
        seek.reset("bed")
        assert seek.confidence is None


def test_the_accepted_cell_is_where_the_candidate_scores_highest_and_not_the_one_that_is_judged():
    for verifier, cell in ((AcceptAll(), (31, 63)), (RefuseAll(), None)):
        navmap, _ = known(text_of(room(R=(30, 10), T=(30, 60))))
        navmap.score_sum[30:32, 60:65] = navmap.score_max[30:32, 60:65] = 0.8
        navmap.score_sum[31, 63] = 2.4
        navmap.score_sum[30, 20] = navmap.score_max[30, 20] = 5.0  # another candidate
        seek = seeker(verifier)
        assert seek.accepted_cell is None
        seek.judge(navmap, (30, 60))
        assert seek.accepted_cell == cell
        seek.reset("bed")
        assert seek.accepted_cell is None


def test_the_cells_seen_best_of_all_candidates_are_those_of_each_alone():
    rng = np.random.default_rng(0)
    navmap = NavMap.empty(GridFrame.around_start(60, 0.05))
    navmap.score_max[:] = rng.random((60, 60)) < 0.3
    navmap.score_sum[:] = rng.integers(0, 3, (60, 60))  # many cells score the same
    parts = CandidateParts.of(navmap, 0.5, 2)
    assert parts.count > 5
    alone = [_seen_best(navmap, parts.labels == number) for number in range(1, parts.count + 1)]
    assert _seen_best_of_each(navmap, parts) == alone
    assert _seen_best_of_each(navmap, CandidateParts.of(NavMap.empty(navmap.frame), 0.5, 2)) == []
