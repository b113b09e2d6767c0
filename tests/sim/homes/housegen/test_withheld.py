"""Withheld styles: training houses show none, selection houses prefer them, and each use keeps a style."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sim.core.interface import GOAL_CATEGORIES
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.generator import HouseConfig, generate_house
from sim.homes.housegen.withheld import is_withheld, restricted


def own(category: str) -> list[Style]:
    return [style for style in CATALOGUE.styles(category) if style.pool != "heldout"]


def test_every_goal_category_has_a_withheld_style_and_no_heldout_one_is() -> None:
    for category in GOAL_CATEGORIES:
        withheld = [style for style in CATALOGUE.styles(category) if is_withheld(style)]
        assert withheld, category
        assert len(withheld) < len(own(category)) / 2, category
        assert all(style.pool != "heldout" for style in withheld)


def test_training_keeps_a_style_for_every_use() -> None:
    left = restricted(CATALOGUE, "without")
    for category in GOAL_CATEGORIES:
        assert not any(is_withheld(style) for style in left.styles(category))
        for use in {use for style in CATALOGUE.styles(category, "train") for use in style.uses or (None,)}:
            assert left.styles(category, "train", use), (category, use)


def test_selection_shows_withheld_styles_alone_where_there_are_some() -> None:
    only = restricted(CATALOGUE, "only")
    for category in GOAL_CATEGORIES:
        withheld = [style for style in own(category) if is_withheld(style)]
        for use in {use for style in withheld for use in style.uses}:
            assert all(is_withheld(style) for style in only.styles(category, "train", use)), (category, use)
    assert [style.name for style in only.styles("shower", "train")] == [
        style.name for style in own("shower") if is_withheld(style)
    ]


def test_a_model_is_withheld_by_its_name_whatever_else_there_is() -> None:
    models = [replace(CATALOGUE.styles("chair", "train")[0], name=f"model_{n}_i00000000") for n in range(200)]
    share = sum(map(is_withheld, models)) / len(models)
    assert 0.1 < share < 0.3
    own_before = {style.name for style in CATALOGUE.styles("chair") if is_withheld(style)}
    both = CATALOGUE.with_styles(*models)
    assert {style.name for style in both.styles("chair") if is_withheld(style)} >= own_before


@pytest.mark.costly
def test_a_house_knows_the_style_of_every_instance() -> None:
    made = generate_house(3, HouseConfig(pool="train"), restricted(CATALOGUE, "without"))
    names = {body.name for body in made.spec.bodies if body.name not in ("", "world")}
    assert set(made.styles) == names
    categories = {name: name.rsplit("_", 1)[0] for name in names}
    known = {(s.category, s.name): is_withheld(s) for category in GOAL_CATEGORIES for s in own(category)}
    seen = {(categories[name], style) for name, style in made.styles.items() if categories[name] in GOAL_CATEGORIES}
    assert seen
    assert not any(known[key] for key in seen)
