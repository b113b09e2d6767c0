"""Words for objects, and goals in words read as conditions."""

from __future__ import annotations

import pytest

from sim.core.errors import EpisodeError
from sim.core.vocabulary import UNSEEN, singulars, vocabulary
from sim.core.wishes import WishError, categories_of, parse_wish, require_goal
from sim.homes.housegen.furniture.names import CATEGORIES_OF_NAMES


def names(text: str) -> set[str]:
    return set(parse_wish(text).names)


@pytest.mark.parametrize("name", sorted(CATEGORIES_OF_NAMES))
def test_each_name_of_the_homes_means_at_least_itself(name):
    found = vocabulary().find(name)
    assert found is not None
    assert name in found.names
    assert set(CATEGORIES_OF_NAMES[name]) <= set(vocabulary().categories_of(found.names))


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("a refrigerator", "fridge"), ("the settee", "sofa"), ("couch", "corner sofa"), ("bookshelf", "bookcase"),
        ("bookshelves", "bookcase"), ("telly", "television"), ("TV", "television"), ("night stand", "nightstand"),
        ("bedside table", "nightstand"), ("arm-chair", "armchair"), ("Dish washer", "dishwasher"), ("oven", "cooker"),
        ("trash can", "bin"), ("worktop", "kitchen counter"), ("knives", ""), ("flower bed", ""), ("water table", ""),
    ],
)  # fmt: skip
def test_synonyms_plurals_and_spellings(words, name):
    found = vocabulary().find(words)
    assert (found is not None and name in found.names) if name else (found is None), found


def test_a_general_word_means_several_categories():
    wish = parse_wish("something to sit on in the living room")
    assert {"sofa", "armchair", "bar stool"} <= wish.names
    assert "bed" not in wish.names
    assert wish.rooms == ("living_room", "studio")
    assert set(wish.categories) >= {"chair", "sofa", "stool"}


def test_all_conditions_of_a_wish():
    wish = parse_wish("Please take me to the largest red wooden table next to the window in the dining room.")
    assert (wish.size, wish.colour, wish.material, wish.rooms) == ("largest", "red", "wood", ("dining_room",))
    assert [(beside.place, beside.names) for beside in wish.beside] == [("next to", frozenset({"window"}))]
    assert wish.text == "largest red wooden table next to the window in the dining room"
    assert not wish.is_plain


def test_a_shape_is_read_although_both_words_mean_something_else_together():
    wish = parse_wish("the largest of the two red circular tables on the rug")
    assert (wish.shape, wish.colour, wish.size, wish.count) == ("round", "red", "largest", 2)
    assert wish.names == names("table")
    assert [(beside.place, beside.names) for beside in wish.beside] == [("on", frozenset({"rug"}))]
    assert parse_wish("round table").shape == "round"
    assert not parse_wish("round table").is_plain
    with pytest.raises(WishError, match="'round'"):
        parse_wish("the round")


def test_the_smaller_of_two():
    wish = parse_wish("the smaller of the two beds")
    assert (wish.size, wish.count) == ("smallest", 2)
    assert wish.names == names("bed")


def test_a_room_may_stand_before_the_name_unless_both_are_a_word():
    assert parse_wish("the bathroom mirror").rooms == ("bathroom",)
    assert (parse_wish("kitchen chair").rooms, names("kitchen chair")) == ((), {"dining chair"})


def test_a_room_may_stand_before_a_place():
    wish = parse_wish("the red chair in the living room next to the window, please")
    assert wish == parse_wish("the red chair next to the window in the living room")
    assert (wish.rooms, wish.beside[0].words) == (("living_room", "studio"), "window")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("the grene chair", "'grene' before 'chair' is not known. Did you mean 'green'"),
        ("the dinning table", "'dinning' before 'table' is not known. Did you mean 'dining table'"),
        ("a blue wooden cuch", "No object is known as 'cuch'. Did you mean 'couch'"),
        ("spaceship", "No object is known as 'spaceship'"), ("flower bed", "No object is known as 'flower bed'"),
        ("the red chair in the batroom", "No room is known as 'batroom'. Did you mean 'bathroom'? Rooms: "),
        ("chair inside my bed room by the bed", "No room is known as 'bed room'. Did you mean 'bedroom'"),
        ("spaceship in the batroom", "No object is known as 'spaceship in the batroom'"),
        ("chair next to", "chair next to"), ("", "1 to 300 characters"), ("x" * 301, "got 301"),
        ("chair next to the red table", "'the red table'"), ("chair next to the", "object on each side of 'next to'"),
        ("find", "must name an object"), ("the", "must name an object"), ("!?", "must name an object"),
        ("chair in the bedroom in the kitchen", "one room, got 'bedroom' and 'kitchen'"),
        ("bathroom mirror in the hall", "one room, got two in 'bathroom mirror in the hall'"),
        ("the red blue chair", "'blue' before 'chair' is a second one"),
        ("find it in the bedroom", "'it'"), ("in the bedroom", "must name an object"),
    ],
)  # fmt: skip
def test_an_unknown_word_is_named_and_not_guessed(text, words):
    with pytest.raises(WishError) as refused:
        parse_wish(text)
    assert words in str(refused.value)


@pytest.mark.parametrize("word", ["elephant", "umbrella"])
def test_a_message_suggests_nothing_for_an_object_that_no_home_has(word):
    with pytest.raises(WishError, match=f"^No object is known as '{word}'.$"):
        parse_wish(f"the red {word}")


def test_goals_are_categories_labels_or_words():
    for goal in ("chair", "chair_03", "chest_of_drawers_00", "the red chair"):
        require_goal(goal)
    for goal in ("void_00", "chair_²"):
        with pytest.raises(EpisodeError, match=f"Unknown goal '{goal}'"):
            require_goal(goal)
    assert categories_of("chest_of_drawers_12") == ("chest_of_drawers",)
    assert categories_of("fridge") == ("appliances",)
    assert categories_of("tv_monitor") == ("tv_monitor",)


def test_names_that_no_training_may_use_are_names():
    assert set(CATEGORIES_OF_NAMES) >= UNSEEN


@pytest.mark.parametrize(
    ("plural", "singular"),
    [
        ("chairs", "chair"),
        ("benches", "bench"),
        ("shelves", "shelf"),
        ("canopies", "canopy"),
        ("glass", ""),
        ("bus", ""),
    ],
)
def test_singulars(plural, singular):
    assert (singular in singulars(plural)) if singular else (singulars(plural) == [])
