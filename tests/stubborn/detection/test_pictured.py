"""Goals in pictures: what a picture shows, and which tracks look like it."""

from __future__ import annotations

from typing import cast

import numpy as np
import pytest

from sim.core.interface import MPCAT40_ID, ConfigError, Observation, RobotModel, SegmenterSpec
from stubborn import agents
from stubborn.detection.attributes import UNDECIDED
from stubborn.detection.pictured import PictureEvidence, PictureGoal, one_hot
from stubborn.detection.tracks import Pixels, Tracks
from stubborn.detection.wished import WishedSegmenter
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA

RED, BLUE, GREY = (190, 30, 30), (30, 60, 190), (150, 150, 150)


def picture() -> tuple[np.ndarray, np.ndarray]:
    """A red chair in the middle of a grey wall, and a larger blue bed at the side."""
    rgb, semantic = np.full((64, 64, 3), GREY, np.uint8), np.full((64, 64), MPCAT40_ID["wall"], np.uint8)
    rgb[20:44, 20:44], semantic[20:44, 20:44] = RED, MPCAT40_ID["chair"]
    rgb[:, 50:], semantic[:, 50:] = BLUE, MPCAT40_ID["bed"]
    return rgb, semantic


def test_the_goal_is_the_object_in_the_middle():
    rgb, semantic = picture()
    goal = PictureGoal.of(rgb, one_hot(semantic))
    assert goal.category == "chair"
    assert np.count_nonzero(goal.own) == 1
    assert goal.own.sum() == pytest.approx(1.0)
    assert np.count_nonzero(goal.around) == 2


class TwoTracks:
    """Tracks of which the second may have become a part of the first."""

    def __init__(self, *, merged: bool) -> None:
        self.merged = merged

    def now(self) -> np.ndarray:
        return np.array([0, 1, 1 if self.merged else 2])


def factors(colours: tuple[tuple[int, int, int], tuple[int, int, int]], pixels: int = 200, *, merged=False) -> list:
    """Returns the factors of two objects of some colours before the wall and beside the bed of the picture."""
    rgb, semantic = picture()
    goal, evidence = PictureGoal.of(rgb, one_hot(semantic)), PictureEvidence(8)
    for track, colour in enumerate(colours, start=1):
        seen, tracks, nowhere = np.full((40, 40, 3), GREY, np.uint8), np.zeros((40, 40), int), np.full((40, 40), -1)
        seen[:, 32:] = BLUE
        seen.reshape(-1, 3)[:pixels], tracks.flat[:pixels] = colour, track
        evidence.add(Pixels(tracks.astype(np.int16), nowhere, nowhere, np.zeros((40, 40))), seen)
    tracks, both = cast(Tracks, TwoTracks(merged=merged)), np.array([1, 2])
    return evidence.factors(goal, tracks, both, False).tolist()


def test_the_track_with_the_colours_of_the_picture_is_it():
    same, other = factors((RED, BLUE))
    assert same > 0.8
    assert other < 0.2


def test_a_track_of_few_pixels_is_undecided():
    assert factors((RED, BLUE), pixels=40) == pytest.approx([UNDECIDED, UNDECIDED])


def test_evidence_follows_tracks_that_are_merged():
    apart, together = factors((BLUE, RED)), factors((BLUE, RED), merged=True)
    assert together[0] > apart[0]
    assert together[1] == pytest.approx(UNDECIDED)


class SeesAsRobot:
    """A segmenter of pictures alone: red is a chair, all else is wall."""

    spec = SegmenterSpec()
    seen: Observation

    def posteriors(self, observation: Observation) -> np.ndarray:
        self.seen = observation
        red = observation["rgb"][2::4, 2::4, 0] > 170
        return one_hot(np.where(red, MPCAT40_ID["chair"], MPCAT40_ID["wall"]).astype(np.uint8))


def test_other_segmenters_see_the_picture_as_an_image_of_the_robots_camera():
    inner = SeesAsRobot()
    segmenter = WishedSegmenter(inner, SMALL_CAMERA)  # type: ignore[arg-type]
    segmenter.ask("")
    assert segmenter.awaits_picture
    segmenter.show(picture()[0])
    shape = SMALL_CAMERA.height_px, SMALL_CAMERA.width_px
    assert inner.seen["rgb"].shape == (*shape, 3)
    assert inner.seen["depth"].shape == shape
    assert (segmenter.category, segmenter.awaits_picture) == ("chair", False)


def test_an_agent_says_that_the_picture_is_missing():
    agent = agents.make("stubborn-plus", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter())
    agent.reset("", 0)
    with pytest.raises(ConfigError, match="goal_picture"):
        agent.act({})
