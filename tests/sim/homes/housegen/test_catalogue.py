"""The catalogue of furniture: new styles, replaced styles, new families, and refused requests."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from sim.core.errors import ConfigError
from sim.homes.housegen import furniture, generate
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.catalogue import Style
from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.uses import USES
from sim.homes.housegen.furniture.workbench import Workbench


def build_block(w: Workbench) -> None:
    w.box((-0.15, 0.15), (-0.16, 0.16), (0.0, 0.44), Look())


def stool(name: str) -> Style:
    return Style("stool", name, "train", build_block, uses=("low", "bar"))


def test_a_style_from_outside_is_in_a_house_and_the_shipped_catalogue_is_unchanged():
    shipped = CATALOGUE.styles("stool")
    block = stool("block")
    house = generate(1, kind="studio", catalogue=CATALOGUE.replacing("stool", block))
    stools = [body for body in house.bodies if body.name.startswith("stool_")]
    assert stools
    assert all([list(geom.size) for geom in body.geoms] == [[0.15, 0.16, 0.22]] for body in stools)
    assert CATALOGUE.styles("stool") == shipped


@pytest.mark.parametrize(("use", "name"), [("dining", "dining table"), ("desk", "desk")])
def test_a_style_with_two_uses_has_the_name_of_the_one_that_was_asked_for(use, name):
    both = Style("table", "plank", "train", build_block, uses=("dining", "desk"))
    catalogue = CATALOGUE.replacing("table", both)
    assert catalogue.make_item("table", np.random.default_rng(0), pool="train", use=use).name == name


def test_an_added_style_comes_last_and_only_in_the_new_catalogue():
    block = stool("block")
    assert CATALOGUE.with_styles(block).styles("stool") == (*CATALOGUE.styles("stool"), block)
    assert block not in CATALOGUE.styles("stool")


def test_replaced_styles_leave_other_categories_unchanged():
    block = stool("block")
    replaced = CATALOGUE.replacing("stool", block)
    assert replaced.categories == CATALOGUE.categories
    for category in CATALOGUE.categories:
        assert replaced.styles(category) == ((block,) if category == "stool" else CATALOGUE.styles(category))


def test_children_come_from_the_catalogue_of_their_parent():
    catalogue = CATALOGUE.replacing("cushion", Style("cushion", "slab", "train", build_block, uses=("throw",)))
    sofa = catalogue.make_item("sofa", np.random.default_rng(0), pool="train", style="block_arm", cushions=2)
    assert [child.item.style for child in sofa.children] == ["slab", "slab"]


def test_two_styles_of_one_name_in_a_category_are_refused():
    with pytest.raises(ConfigError, match="two styles 'block' of category 'stool'"):
        CATALOGUE.with_styles(stool("block"), stool("block"))
    with pytest.raises(ConfigError, match=f"two styles '{CATALOGUE.styles('stool')[0].name}' of category 'stool'"):
        CATALOGUE.with_styles(stool(CATALOGUE.styles("stool")[0].name))


@pytest.mark.parametrize(
    ("category", "uses", "message"),
    [
        ("chair", ("dining", "diningg"), r"'block'.*'chair'.*'diningg'"),
        ("chair", (), "'chair'"),
        ("chair", "dining", r"\(.*'dining'.*\)"),
        ("bed", ("double",), r"'bed'.*`uses`.*'double'"),
    ],
)
def test_uses_by_which_no_room_asks_are_refused_with_those_that_exist(category, uses, message):
    with pytest.raises(ConfigError, match=message):
        CATALOGUE.with_styles(Style(category, "block", "train", build_block, uses=uses))


def test_uses_are_optional_where_rooms_ask_without_one_and_free_in_new_categories():
    for category, uses in (("sofa", ()), ("bed", ()), ("stairs", ("steep",))):
        block = Style(category, "block", "train", build_block, uses=uses)
        assert block in CATALOGUE.with_styles(block).styles(category)


@pytest.mark.parametrize("pool", ["train", "heldout"])
def test_every_pool_has_styles_of_every_listed_category_and_use_and_no_others(pool):
    assert set(USES) == set(CATALOGUE.categories)
    for category, uses in USES.items():
        styles = CATALOGUE.styles(category, pool)
        assert styles, category
        assert set(uses) == {use for style in styles for use in style.uses}, category


def test_a_replacement_of_another_category_is_refused():
    with pytest.raises(ConfigError, match=r"'block'.*'stool'.*'chair'"):
        CATALOGUE.replacing("chair", stool("block"))
    with pytest.raises(ConfigError, match="'spaceship'"):
        CATALOGUE.replacing("spaceship")


def test_a_module_that_declares_styles_is_a_family_without_further_entries(tmp_path, monkeypatch):
    shipped = list(furniture.shipped_styles())
    (tmp_path / "zeppelins.py").write_text(
        "from sim.homes.housegen.furniture.catalogue import Style\n"
        "STYLES = (Style('stool', 'zeppelin', 'train', lambda w: None),)\n"
    )
    monkeypatch.setattr(furniture, "__path__", [*furniture.__path__, str(tmp_path)])
    try:
        found = list(furniture.shipped_styles())
    finally:
        sys.modules.pop("sim.homes.housegen.furniture.zeppelins", None)
    assert {(style.category, style.name) for style in found if style not in shipped} == {("stool", "zeppelin")}


def test_unknown_requests_name_the_allowed_values():
    rng = np.random.default_rng(0)
    with pytest.raises(ConfigError, match="sofa"):
        CATALOGUE.make_item("spaceship", rng, pool="train")
    with pytest.raises(ConfigError, match="slat_back"):
        CATALOGUE.make_item("chair", rng, pool="train", style="windsor")
    with pytest.raises(ConfigError, match="office"):
        CATALOGUE.make_item("chair", rng, pool="train", use="throne")
    with pytest.raises(ConfigError, match="width_m"):
        CATALOGUE.make_item("chair", rng, pool="train", widht_m=0.4)  # type: ignore[call-arg]
