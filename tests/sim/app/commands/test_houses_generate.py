"""Tests of the tool that generates houses: no train seed is skipped, and withheld styles are shown."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from sim.app.commands.houses import generate as generate_houses
from sim.core.errors import ConfigError, HouseError
from sim.homes.housegen.furniture.catalogue import Catalogue
from sim.homes.housegen.generator import HouseConfig
from sim.homes.housegen.splits.recipes import Recipe
from sim.homes.housegen.withheld import is_withheld


def test_each_train_seed_is_tried_in_order_even_if_some_give_no_house(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried: list[int] = []
    listed: list[int] = []

    def make(recipe: Recipe) -> generate_houses.Made:
        tried.append(recipe.seed)
        if recipe.seed in {1, 5, 6}:
            return generate_houses.Made(recipe.name, error="no room")
        return generate_houses.Made(recipe.name, "<mujoco/>", seconds=1.0)

    monkeypatch.setenv("STUBBORN_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(generate_houses, "_make", make)
    monkeypatch.setattr(generate_houses, "copy_textures", lambda folder: None)
    monkeypatch.setattr(
        generate_houses, "write_house_list", lambda out, some, version: listed.extend(r.seed for r, _ in some)
    )
    generate_houses.main(generate_houses.Args(out=tmp_path / "out", split="train", houses=6))
    assert tried == list(range(9))
    assert listed == [0, 2, 3, 4, 7, 8]


def test_houses_of_withheld_styles_show_what_training_leaves_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[Catalogue] = []

    def make(seed: int, config: HouseConfig, catalogue: Catalogue) -> None:
        shown.append(catalogue)
        raise HouseError("no room")

    monkeypatch.setattr(generate_houses, "generate_house", make)
    monkeypatch.setattr(generate_houses, "copy_textures", lambda folder: None)
    for withheld in (None, "only"):
        generate_houses.main(generate_houses.Args(out=tmp_path, withheld=withheld))
    assert len(shown) == 2
    chairs = [shown[i].styles("chair", "train", "dining") for i in range(2)]
    assert all(is_withheld(style) for style in chairs[1])
    assert not all(is_withheld(style) for style in chairs[0])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"split": "val", "area_m2": 80.0}, r"--area-m2.*--split"),
        ({"split": "train", "first_seed": 3}, r"--first-seed.*--split"),
        ({"transfer_test": True, "furniture": Path("models"), "withheld": "only"}, r"--withheld.*--tra"),
    ],
)
def test_options_that_recipes_determine_are_refused(options: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=message):
        generate_houses.main(generate_houses.Args(out=tmp_path, **options))
