"""The table of other projects' names has categories of mpcat40, uses that our furniture has, and a source for each."""

from __future__ import annotations

import typing

import pytest

from sim.core.interface import MPCAT40
from sim.homes.housegen.furniture import CATALOGUE
from sim.homes.housegen.furniture.uses import USES
from sim.homes.importers.fitting import SHAPES
from sim.houses.proposals import category_of_name
from sim.houses.taxonomies import Taxonomy, entries, words_of


@pytest.mark.parametrize("taxonomy", typing.get_args(Taxonomy))
def test_every_name_has_a_category_and_a_source(taxonomy: Taxonomy) -> None:
    table = entries(taxonomy)
    assert len(table) > 20
    for name, entry in table.items():
        assert entry.category in MPCAT40, name
        assert entry.source in ("mp3d", "hm3d", "ours"), name


def test_every_use_is_one_of_our_furniture_or_a_shape() -> None:
    for name, entry in entries("ai2thor").items():
        if entry.use in SHAPES or entry.category not in CATALOGUE.categories:
            continue
        uses = USES.get(entry.category, ())
        assert all(use in ("", *uses) for use in entry.use.split("/")), name
        assert entry.use or not uses or entry.category == "sofa", name


def test_proposals_agree_with_the_table_for_types_of_several_words() -> None:
    for name, entry in entries("ai2thor").items():
        if len(words_of(name)) > 1:
            assert category_of_name(f"{name}_12_1") == entry.category, name
