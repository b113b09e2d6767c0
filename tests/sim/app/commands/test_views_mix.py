"""The views of the recipe: their parts, their proportions in every turn, and what a continued command keeps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from sim.app.commands.views import generate
from sim.app.commands.views.generate import plan
from sim.app.commands.views.mix import Args, folders, main, parts, selection
from sim.episodes.splits import load_split


def by_name(args: Args, turns: int) -> dict[str, generate.Args]:
    return {part.out.name: part for part in parts(args, turns)}


def test_each_turn_adds_views_in_the_same_proportions_to_what_is_there(tmp_path: Path) -> None:
    args = Args(out=tmp_path, furniture=tmp_path)
    first, later = by_name(args, 1), by_name(args, 3)
    total = sum(part.views for part in first.values())
    assert {name: part.views / total for name, part in first.items()} == {
        "reshaped": 0.4, "models": 0.4, "train": 0.05, "aimed": 0.15
    }  # fmt: skip
    train = load_split("train")
    for name, part in first.items():
        assert replace(later[name], views=part.views) == part
        assert plan(later[name], train)[: part.views // 40] == plan(part, train)


def test_without_models_the_views_of_their_houses_are_of_our_own_furniture(tmp_path: Path) -> None:
    args = Args(out=tmp_path)
    made = by_name(args, 2)
    assert (made["reshaped"].views, sum(part.views for part in made.values())) == (2 * 640, 2 * 800)
    assert [folder.name for folder in folders(tmp_path, None)] == list(made) == ["reshaped", "train", "aimed"]
    assert all(part.furniture is None for part in (*made.values(), selection(args)))


def test_the_training_shows_no_withheld_style_and_no_house_twice(tmp_path: Path) -> None:
    args = Args(out=tmp_path, furniture=tmp_path, seed=1)
    made, judged = list(parts(args, 2)), selection(args)
    assert {part.withheld for part in made} == {"without"}
    assert judged.withheld == "only"
    train = load_split("train")
    seeds = [task.fresh_seed for part in (*made, judged) for task in plan(part, train)]
    assert None not in seeds
    assert len(set(seeds)) == len(seeds)
    other = selection(replace(args, seed=0))
    assert not set(seeds) & {task.fresh_seed for task in plan(other, train)}


def test_the_selection_is_made_first_and_the_training_in_turns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[tuple[str, int]] = []
    monkeypatch.setattr(generate, "main", lambda part: made.append((part.out.name, part.views)))
    assert main(Args(out=tmp_path, views=801, selection=30)) == 0
    assert made == [
        ("selection", 40), ("reshaped", 640), ("train", 40), ("aimed", 120),
        ("reshaped", 1280), ("train", 80), ("aimed", 240),
    ]  # fmt: skip
