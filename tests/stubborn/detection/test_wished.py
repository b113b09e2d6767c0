"""Scores of goals in words, and the conditions of a wish on tracked objects."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from sim.core.geometry.grid import GridFrame
from sim.core.interface import MPCAT40_ID, Observation, RobotModel
from sim.core.wishes import WishError, parse_wish
from stubborn import agents
from stubborn.detection.attributes import AT_LAST, UNDECIDED, Attributes
from stubborn.detection.tracks import Pixels, Tracks
from stubborn.detection.wished import WishedSegmenter
from stubborn.segmentation.ground_truth import GroundTruthSegmenter
from tests.helpers.gridworld import SMALL_CAMERA

HEIGHT, WIDTH = 8, 16
NAMES = ("fridge", "cooker", "armchair")


def observation() -> Observation:
    """An image with a fridge, a cooker, a chair and a wall, four columns each."""
    semantic = np.repeat([MPCAT40_ID[name] for name in ("appliances", "appliances", "chair", "wall")], 4).astype(
        np.uint8
    )
    objects = np.repeat([0, 1, 2, -1], 4).astype(np.int32)
    return {"semantic": np.tile(semantic, (HEIGHT, 1)), "objects": np.tile(objects, (HEIGHT, 1))}


class Named(GroundTruthSegmenter):
    """Truth that tells objects apart."""

    def objects(self, observation: Observation) -> tuple[np.ndarray, Sequence[str]]:
        return observation["objects"], NAMES


def target(segmenter: WishedSegmenter) -> list[float]:
    scores = segmenter.scores(observation(), segmenter.category)
    return scores.target[0].tolist()


def test_only_objects_with_the_right_name_score_where_they_are_told_apart():
    segmenter = WishedSegmenter(Named(), SMALL_CAMERA)
    segmenter.ask("the fridge")
    assert segmenter.category == "appliances"
    assert target(segmenter) == [1.0, 0.0, 0.0, 0.0]


def test_all_objects_of_the_categories_score_where_they_are_not():
    segmenter = WishedSegmenter(GroundTruthSegmenter(), SMALL_CAMERA)
    segmenter.ask("the fridge")
    assert target(segmenter) == [1.0, 1.0, 0.0, 0.0]


def test_the_posteriors_are_those_of_the_categories_whatever_the_goal_is():
    inner = Named()
    segmenter, seen = WishedSegmenter(inner, SMALL_CAMERA), observation()
    segmenter.ask("something to sit on")
    assert segmenter.category == "chair"
    assert segmenter.posteriors(seen) is inner.posteriors(seen)


def test_a_category_is_passed_on_unchanged():
    inner = GroundTruthSegmenter()
    segmenter = WishedSegmenter(inner, SMALL_CAMERA)
    segmenter.ask("chair")
    seen = observation()
    assert segmenter.posteriors(seen) is inner.posteriors(seen)
    assert segmenter.wish is None


def test_an_agent_refuses_words_that_it_does_not_know():
    agent = agents.make(
        "stubborn-plus", camera=SMALL_CAMERA, robot=RobotModel(), segmenter=GroundTruthSegmenter(), max_steps=10
    )
    agent.reset("the red chair", 0)
    with pytest.raises(WishError, match="spaceship"):
        agent.reset("spaceship", 0)


def colour_factor(colour: str, rgb: tuple[int, int, int], pixels: int) -> float:
    attributes = Attributes(GridFrame.around_start(20, 0.1), 8)
    tracks, nowhere = np.zeros((20, 20), np.int16), np.full((20, 20), -1)
    tracks.flat[:pixels] = 1
    seen = Pixels(tracks, nowhere, nowhere, np.zeros((20, 20)))
    attributes.add(seen, np.zeros((40, 20, 20), np.float32), np.full((20, 20, 3), rgb, np.uint8), None)
    return attributes._colour_factor(1, colour, UNDECIDED)


def test_colours_are_judged_from_pixels():
    assert colour_factor("red", (190, 30, 30), 300) > 0.6
    assert colour_factor("red", (30, 60, 190), 300) < 0.1
    assert colour_factor("blue", (30, 60, 190), 300) > 0.6
    assert colour_factor("red", (190, 30, 30), 20) == UNDECIDED
    assert UNDECIDED < 0.5 < AT_LAST


def test_evidence_follows_tracks_that_are_merged():
    attributes = Attributes(GridFrame.around_start(20, 0.1), 8)
    nowhere = np.full((20, 20), -1)
    seen = Pixels(np.full((20, 20), 2, np.int16), nowhere, nowhere, np.zeros((20, 20)))
    named = np.zeros((20, 20), np.int32), ["armchair"]
    attributes.add(seen, np.zeros((40, 20, 20), np.float32), np.full((20, 20, 3), (190, 30, 30), np.uint8), named)
    assert (attributes.name_of(2), attributes.name_of(1)) == ("armchair", "")
    attributes._follow_merges(np.array([0, 1, 1]))
    assert (attributes.name_of(2), attributes.name_of(1)) == ("", "armchair")
    assert attributes._colour_factor(1, "red", UNDECIDED) > 0.6


@pytest.mark.parametrize(
    ("names", "share"),
    [
        (("wall", "wall", "toy train"), 1.0),
        (("wall", "armchair", "toy train"), 1.0),
        (("armchair", "armchair", "toy train"), 0.5),
        (("armchair",), 0.0),
        (("wall",), 0.0),
    ],
)
def test_a_name_counts_against_that_of_the_main_neighbour_but_not_against_a_wall(
    names: tuple[str, ...], share: float
) -> None:
    attributes = Attributes(GridFrame.around_start(20, 0.1), 8)
    for name in names:  # one frame each
        nowhere = np.full((4, 4), -1)
        seen = Pixels(np.ones((4, 4), np.int16), nowhere, nowhere, np.zeros((4, 4)))
        attributes.add(seen, np.zeros((40, 4, 4), np.float32), None, (np.zeros((4, 4), np.int32), [name]))
    tracks = SimpleNamespace(now=lambda: np.arange(8))
    shares = attributes.name_shares(cast(Tracks, tracks), np.array([1]), frozenset({"toy train"}))
    assert shares.tolist() == [share]


def test_a_kind_of_room_without_numbers_is_undecided() -> None:
    wish = parse_wish("the cooker in the studio")
    attributes = Attributes(GridFrame.around_start(20, 0.1), 8)
    around = SimpleNamespace(middle_xy_m=lambda _: pytest.fail("its surroundings cannot tell"))
    assert wish.rooms == ("studio",)
    assert attributes._room_factor(cast(Tracks, around), 1, wish.rooms, UNDECIDED) == UNDECIDED
