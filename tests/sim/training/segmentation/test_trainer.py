"""Views with which a training of the segmentation network cannot end well are refused before it begins."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.core.interface import ConfigError
from sim.training.segmentation.options import Args
from sim.training.segmentation.trainer import Trainer
from sim.training.views.shards import write_shard
from tests.helpers.labelled_views import view_of


@pytest.mark.parametrize(
    ("category", "size_px", "message"),
    [("lighting", (64, 48), "--val-views.*goal category"), ("chair", (32, 24), "32 x 24, 64 x 48 pixels")],
)
def test_views_for_evaluation_show_a_goal_and_have_the_size_of_the_others(
    tmp_path: Path, category: str, size_px: tuple[int, int], message: str
) -> None:
    train, val = tmp_path / "train", tmp_path / "val"
    write_shard(train, "views-0", (view_of(i, [("chair", "plain")]) for i in range(2)), house="h", config={})
    write_shard(val, "views-0", [view_of(9, [(category, "plain")], size_px=size_px)], house="h", config={})
    with pytest.raises(ConfigError, match=message):
        Trainer(Args(views=(train,), val_views=(val,), out=tmp_path / "out", size="compact", batch=2, block_px=1))
