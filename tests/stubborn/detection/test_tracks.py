"""Tracks in a world of boxes: identity from frame to frame, competing categories, evidence only where visible."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import MPCAT40, MPCAT40_ID
from stubborn.detection.evidence import Evidence, EvidenceConfig
from stubborn.detection.fusion import SURFACES, Fusion
from stubborn.detection.tracks import TrackConfig, Tracks
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA, Box, GridWorld

WALL = Box((4.0, 4.2), (-3.0, 3.0), (0.0, 2.5))
TABLE = Box((2.0, 2.6), (-0.5, 0.5), (0.0, 0.7), "table")
PICTURE = Box((3.95, 4.0), (0.8, 1.4), (1.0, 1.6), "picture")
CHAIR = Box((2.0, 2.4), (1.2, 1.6), (0.0, 0.9), "chair")
FRAME = GridFrame.around_start(300, 0.05)


def tracked() -> Tracks:
    return Tracks(TrackConfig(least_pixels_of_others=12), SMALL_CAMERA, 0.0, FRAME)


def look(
    tracks: Tracks, pose: tuple[float, float, float], *boxes: Box, goal: str = "table", taken_for: str | None = None
) -> None:
    """Enters a frame of some boxes; with `taken_for`, half of the table's probability goes to another category."""
    world = GridWorld([WALL, *boxes], pose, camera=SMALL_CAMERA)
    observation = world.observe(goal)
    posteriors = np.array(GroundTruthSegmenter().posteriors(observation))
    if taken_for is not None:
        table = posteriors[MPCAT40_ID["table"] - 1].copy()
        posteriors[MPCAT40_ID["table"] - 1] = 0.3 * table
        posteriors[MPCAT40_ID[taken_for] - 1] += 0.7 * table
    tracks.add(posteriors, observation["depth"], Pose(*pose), goal)


def of(tracks: Tracks, category: str) -> list[int]:
    """Returns the tracks that surely have a category; thin parts of a newly seen side do not."""
    numbers = np.arange(1, tracks.count + 1)
    sure = tracks.evidence.probability[numbers, MPCAT40_ID[category] - 1] > 0.5
    return numbers[sure & (tracks.sizes(numbers) >= 12)].tolist()


VIEWS = ((0.0, 0.0, 0.0), (0.2, 0.3, -0.1), (0.4, 0.5, -0.25), (0.6, 0.8, -0.4), (0.8, 1.2, -0.75))


def test_an_object_is_one_track_from_all_sides_that_are_passed():
    tracks = tracked()
    for pose in VIEWS:
        look(tracks, pose, TABLE, PICTURE)
    assert len(of(tracks, "table")) == 1
    assert len(of(tracks, "picture")) == 1
    (table,) = of(tracks, "table")
    assert tracks.middle_xy_m(table) == pytest.approx((2.3, 0.0), abs=0.2)
    index, mask = tracks.footprint(table)
    x_m, y_m = FRAME.centres(*np.nonzero(np.pad(mask, ((index[0].start, 0), (index[1].start, 0)))))
    assert 1.9 <= x_m.min() <= x_m.max() <= 2.7
    assert -0.6 <= y_m.min() <= y_m.max() <= 0.6


def test_objects_side_by_side_are_two_tracks():
    tracks = tracked()
    for pose in VIEWS:
        look(tracks, pose, TABLE, CHAIR)
    assert [len(of(tracks, name)) for name in ("table", "chair")] == [1, 1]


def test_a_wrong_category_in_one_view_is_outvoted_by_the_others():
    tracks = tracked()
    look(tracks, VIEWS[0], TABLE, goal="cabinet", taken_for="cabinet")
    assert tracks.probabilities("cabinet").max() > 0.5
    for pose in VIEWS[1:]:
        look(tracks, pose, TABLE, goal="cabinet")
    assert tracks.probabilities("cabinet").max() < 0.2
    assert len(of(tracks, "table")) == 1


def test_a_possible_part_of_the_goal_stays_one_track_when_another_heading_shows_the_whole():
    """Otherwise each heading would end the track or start it again, and no look at it would count."""
    tracks = tracked()
    table, cushion = (MPCAT40_ID[name] - 1 for name in ("table", "cushion"))
    look(tracks, VIEWS[0], TABLE, goal="cushion")
    for probability in (0.45, 0.2) * 8:
        world = GridWorld([WALL, TABLE], VIEWS[0], camera=SMALL_CAMERA)
        observation = world.observe("cushion")
        posteriors = np.array(GroundTruthSegmenter().posteriors(observation))
        on_table = posteriors[table] > 0.5
        part = on_table & (np.cumsum(on_table, axis=1) <= 0.3 * on_table.sum(axis=1, keepdims=True))
        assert part.any()
        posteriors[cushion][part], posteriors[table][part] = probability, 1.0 - probability
        tracks.add(posteriors, observation["depth"], Pose(*VIEWS[0]), "cushion")
    assert 0.25 < tracks.probabilities("cushion").max() < 0.45
    assert tracks.count <= 4  # the wall and the table's sides may add one or two


def test_hidden_tracks_are_not_judged():
    tracks = tracked()
    look(tracks, VIEWS[0], TABLE)
    before = tracks.probabilities("table").max()
    screen = Box((1.0, 1.05), (-2.0, 2.0), (0.0, 2.5))
    look(tracks, VIEWS[0], screen, TABLE)
    assert tracks.probabilities("table").max() == before
    assert 1 not in tracks.in_view


def test_a_tracks_probability_is_zero_where_it_lost_all_voxels_or_does_not_exist():
    tracks = tracked()
    look(tracks, VIEWS[0], TABLE)
    assert tracks.probabilities("table")[0] == 0.0
    assert len(tracks.probabilities("table")) == tracks.count + 1
    assert tracks.probabilities("table", least_voxels=1000).max() == 0.0


def test_candidates_next_to_each_other_count_as_one_object():
    tracks = tracked()
    for _ in range(4):
        tracks._begin()
    for track, row in ((1, 10), (2, 12), (3, 14), (4, 20)):
        tracks._low[track] = tracks._high[track] = (row, 5, 0)
    gap = 1
    assert tracks.objects(np.array([0.0, 0.4, 0.5, 0.3, 0.6], np.float32), gap).tolist() == [0, 2, 2, 2, 4]
    assert tracks.objects(np.array([0.0, 0.4, 0.05, 0.3, 0.6], np.float32), gap).tolist() == [0, 1, 2, 3, 4]


CLASSES = len(MPCAT40) - 1


NAMED = [i for i, name in enumerate(MPCAT40[1:]) if name not in SURFACES]


def seen(*views: tuple[float, float, float], frames: int = 1, growth: float = 0.0) -> float:
    """Returns the fused probability of an object after views (bearing in rad, distance in metres, its probability)."""
    evidence = Evidence(EvidenceConfig(), Fusion(growth=growth), 2)
    for bearing_rad, distance_m, p in views * frames:
        mean = np.full((1, CLASSES), 0.02 / (CLASSES - 2), np.float32)
        mean[0, NAMED[0]], mean[0, NAMED[1]] = p * 0.98, (1.0 - p) * 0.98
        at = np.array([distance_m * np.cos(bearing_rad)]), np.array([distance_m * np.sin(bearing_rad)])
        evidence.add(np.array([1]), mean, np.array([200]), *at)
    return float(evidence.probability[1, NAMED[0]])


def test_looking_longer_from_one_place_is_no_further_evidence():
    once, often = seen((0.0, 2.0, 0.6)), seen((0.0, 2.0, 0.6), frames=50)
    assert often == pytest.approx(once, abs=1e-3)
    assert once == pytest.approx(0.6, abs=0.05)


def test_an_object_at_the_edge_of_the_image_is_not_seen_well():
    narrow = Box((2.0, 2.4), (-0.2, 0.2), (0.0, 0.9), "table")
    for yaw_rad, well in ((0.0, True), (-0.45, True), (-0.62, False)):  # half of the field of view is 0.69 rad
        tracks = tracked()
        for _ in range(3):
            look(tracks, (0.0, 0.0, yaw_rad), narrow)
        (table,) = of(tracks, "table")
        assert tracks.evidence.near_sectors(table).any() == well


def test_views_that_differ_count_and_those_that_contradict_cancel():
    one = seen((0.0, 2.0, 0.6), growth=0.3)
    three = seen((0.0, 2.0, 0.6), (1.5, 2.0, 0.6), (3.0, 2.0, 0.6), growth=0.3)
    assert three > one + 0.02
    assert seen((0.0, 2.0, 0.9), (1.5, 2.0, 0.1)) == pytest.approx(0.5, abs=0.05)


def test_a_look_from_too_near_or_too_far_counts_less():
    assert seen((0.0, 2.0, 0.1), (1.5, 0.8, 0.9)) < 0.3
    assert seen((0.0, 2.0, 0.1), (1.5, 4.5, 0.9)) < 0.3
