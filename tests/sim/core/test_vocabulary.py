"""Categories and goals in words, as sentences name them."""

from __future__ import annotations

import pytest

from sim.core.interface import MPCAT40
from sim.core.vocabulary import is_plural, plain, vocabulary, with_article

WORDED = {
    "chair": "a chair",
    "armchair": "an armchair",
    "chest_of_drawers": "a chest of drawers",
    "tv_monitor": "a television",
    "clothes": "clothes",
    "gym_equipment": "gym equipment",
    "blinds": "blinds",
    "appliances": "an appliance",
    "objects": "an object",
    "hourglass": "an hourglass",
    "utility sink": "a utility sink",
    "cactus": "a cactus",
    "jar with twigs": "a jar with twigs",
    "towels": "towels",
    "red chair next to the blinds": "a red chair next to the blinds",
    "find the slippers under the bed": "the slippers under the bed",
    "the largest bed": "the largest bed",
}


@pytest.mark.parametrize("goal", WORDED)
def test_a_goal_has_the_article_of_its_noun(goal: str) -> None:
    assert with_article(goal) == WORDED[goal]


def test_the_name_of_an_object_stays_as_files_have_it() -> None:
    assert [plain("chest_of_drawers"), plain("tv_monitor_00")] == ["chest of drawers", "tv_monitor_00"]


@pytest.mark.parametrize(
    ("goal", "plural"),
    [("clothes", True), ("the slippers by a glass door", True), ("pile of clothes", False), ("glass of water", False)],
)
def test_the_noun_decides_whether_a_goal_is_plural(goal: str, plural: bool) -> None:
    assert is_plural(goal) == plural


def test_no_name_has_the_article_of_a_single_object_before_a_plural() -> None:
    for name in [*MPCAT40, *vocabulary().categories]:
        article, _, noun = with_article(name).partition(" ")
        assert not (article in ("a", "an") and is_plural(noun))
