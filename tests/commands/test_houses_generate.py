"""Tests of the tool that generates houses: no train seed is skipped."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.commands.houses import generate as generate_houses
from sim.housegen.splits.recipes import Recipe


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
