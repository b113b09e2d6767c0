"""Views drawn by the objects that they show: categories and styles equally often, windows with the drawn object."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.core.interface import MPCAT40_ID, CameraModel, ConfigError
from sim.training.segmentation.balanced import Batches, ViewIndex
from sim.training.segmentation.dataset import list_shards, read_shard
from sim.training.segmentation.recipe import PROGRESSIVE, Recipe
from sim.training.segmentation.samples import Sampler
from sim.training.views.shards import write_shard
from tests.helpers.labelled_views import view_of


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Nine views with chairs of one style and one with a chair of another style, a stool and a lamp."""
    views = [view_of(i, [("chair", "common"), ("chair", "common")]) for i in range(9)]
    views.append(view_of(9, [("chair", "seldom"), ("stool", "low"), ("lighting", "lamp")]))
    write_shard(tmp_path, "views-000000", views, house="h", config={})
    return tmp_path


def batches_of(folder: Path, recipe: Recipe = PROGRESSIVE) -> Batches:
    """Batches of two samples, of a network that uses images of half the size of the views."""
    sampler = Sampler(CameraModel(), area_weights=True, used_block_px=2)
    return Batches(ViewIndex.of(list_shards(folder)), sampler, recipe, batch=2, seed=0)


def test_the_index_has_the_goal_objects_by_category_and_style_and_reads_the_same_views(folder: Path) -> None:
    index = ViewIndex.of(list_shards(folder))
    assert index.counts() == {"chair": (19, 2), "stool": (1, 1)}
    for stored, view in zip(index.views, read_shard(folder / "views-000000.tar"), strict=True):
        read = stored.read()
        assert (read.key, read.record) == (view.key, view.record)
        for name in ("rgb", "depth_m", "semantic", "instances"):
            np.testing.assert_array_equal(getattr(read, name), getattr(view, name))


def test_categories_and_styles_are_drawn_equally_often(folder: Path) -> None:
    index, rng, drawn = ViewIndex.of(list_shards(folder)), np.random.default_rng(0), Counter[str]()
    for _ in range(400):
        shown = index.draw(rng)
        view = index.views[shown.view].read()
        category = int(np.unique(view.semantic[view.instances == shown.number]).item())
        drawn[("seldom " if view.key == "v00009" else "common ") + str(category)] += 1
    stool, chair = MPCAT40_ID["stool"], MPCAT40_ID["chair"]
    assert set(drawn) == {f"common {chair}", f"seldom {chair}", f"seldom {stool}"}
    assert 150 < drawn[f"seldom {stool}"] < 250
    assert 60 < drawn[f"seldom {chair}"] < 140


def test_a_batch_depends_on_its_step_only_and_has_the_samples_of_its_phase(folder: Path) -> None:
    batches = batches_of(folder)
    first, again, other = batches[5, 0.0], batches_of(folder)[5, 0.0], batches[6, 0.0]
    assert all(torch.equal(one, two) for one, two in zip(first, again, strict=True))
    assert not torch.equal(first[2], other[2])
    assert (len(first[0]), len(batches[5, 0.9][0])) == (4, 2)  # the first phase has twice as many samples
    assert [tuple(part.shape[1:]) for part in first] == [(3, 32, 32), (1, 32, 32), (32, 32), (32, 32)]
    assert {tuple(batches[step, 0.9][2].shape[1:]) for step in range(8)} == {(32, 32), (32, 64)}


def test_samples_show_the_drawn_object_or_are_any_views(folder: Path) -> None:
    shares = []
    for object_share in (0.0, 1.0):
        recipe = replace(PROGRESSIVE, object_share=object_share)
        targets = torch.cat([batches_of(folder, recipe)[step, 0.0][2] for step in range(25)])
        shares.append(float((targets == MPCAT40_ID["stool"] - 1).flatten(1).any(dim=1).float().mean()))
    assert shares[0] < 0.2  # one view in ten shows the stool
    assert shares[1] > 0.4  # half of the samples are drawn by it


def test_views_without_objects_are_refused(tmp_path: Path) -> None:
    write_shard(tmp_path, "views-000000", [view_of(0, [], extras=False)], house="h", config={})
    with pytest.raises(ConfigError, match="--extras"):
        ViewIndex.of(list_shards(tmp_path))
