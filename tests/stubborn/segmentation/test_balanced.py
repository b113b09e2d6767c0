"""Views drawn by the objects that they show: categories and styles equally often, windows with the drawn object."""

from __future__ import annotations

import itertools
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from sim.datasets.coco import annotate
from sim.datasets.shards import write_shard
from sim.datasets.views import View
from sim.houses.labels import Instance
from sim.interface import MPCAT40_ID, ConfigError
from stubborn.segmentation.balanced import BalancedViews, ViewIndex
from stubborn.segmentation.dataset import list_shards, read_shard


def view_of(number: int, objects: list[tuple[str, str]], *, extras: bool = True) -> View:
    """A view with a block of pixels for each category and style."""
    semantic = np.full((48, 64), MPCAT40_ID["wall"], np.uint8)
    ids = np.zeros((48, 64), np.uint16)
    instances, styles = [], {}
    for i, (category, style) in enumerate(objects):
        cut = slice(10, 30), slice(10 * i, 10 * i + 8)
        semantic[cut], ids[cut] = MPCAT40_ID[category], i + 1
        instances.append(Instance(f"{category}_{i:02d}", category, (i,)))
        styles[instances[-1].name] = style
    more = {"instances": ids, "annotations": annotate(ids, instances, styles)} if extras else {}
    colour, depth = np.zeros((48, 64, 3), np.uint8), np.full((48, 64), 2000, np.uint16)
    return View(f"v{number:05d}", colour, depth, semantic, {"house": "h"}, **more)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Nine views with chairs of one style and one with a chair of another style, a stool and a lamp."""
    views = [view_of(i, [("chair", "common"), ("chair", "common")]) for i in range(9)]
    views.append(view_of(9, [("chair", "seldom"), ("stool", "low"), ("lighting", "lamp")]))
    write_shard(tmp_path, "views-000000", views, house="h", config={})
    return tmp_path


def test_the_index_has_the_goal_objects_by_category_and_style_and_reads_the_same_views(folder: Path) -> None:
    index = ViewIndex.of(list_shards(folder))
    assert index.counts() == {"chair": (19, 2), "stool": (1, 1)}
    for stored, view in zip(index.views, read_shard(folder / "views-000000.tar"), strict=True):
        read = stored.read()
        assert (read.key, read.record) == (view.key, view.record)
        for name in ("rgb", "depth_m", "semantic", "instances"):
            np.testing.assert_array_equal(getattr(read, name), getattr(view, name))


def test_categories_and_styles_are_drawn_equally_often(folder: Path) -> None:
    data = BalancedViews(ViewIndex.of(list_shards(folder)), lambda view, _, instance: (view, instance), object_share=1)
    drawn: Counter[str] = Counter()
    for view, instance in itertools.islice(data, 400):
        shown = np.unique(view.semantic[view.instances == instance])
        drawn[("seldom " if view.key == "v00009" else "common ") + str(int(shown.item()))] += 1
    stool, chair = MPCAT40_ID["stool"], MPCAT40_ID["chair"]
    assert set(drawn) == {f"common {chair}", f"seldom {chair}", f"seldom {stool}"}
    assert 150 < drawn[f"seldom {stool}"] < 250
    assert 60 < drawn[f"seldom {chair}"] < 140


def test_the_others_are_any_views_and_an_epoch_has_its_own_order(folder: Path) -> None:
    index = ViewIndex.of(list_shards(folder))
    data = BalancedViews(index, object_share=0.0)
    first = [view.key for view in itertools.islice(data, 200)]
    assert len(set(first)) == 10
    assert first == [view.key for view in itertools.islice(data, 200)]
    data.epoch = 1
    assert first != [view.key for view in itertools.islice(data, 200)]


def test_views_without_objects_are_refused(tmp_path: Path) -> None:
    write_shard(tmp_path, "views-000000", [view_of(0, [], extras=False)], house="h", config={})
    with pytest.raises(ConfigError, match="has no objects; make it with --extras instances"):
        ViewIndex.of(list_shards(tmp_path))
