"""The comparison of networks on a few tiny views: turns, resumed runs, the table."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.app.commands.train.segmentation import Trainer
from sim.core.interface import ConfigError
from tests.sim.app.commands.test_train_segmentation import rows, write_views
from tools.training.compare_networks import Args, main, trained_hours


def options(tmp_path: Path, **changes: object) -> Args:
    base = {"views": (tmp_path / "train",), "val_views": (tmp_path / "val",), "out": tmp_path / "out", "batch": 2}
    base |= {"networks": ("compact", "unet"), "seeds": (0,), "block_px": 1, "val_count": 2}
    return Args(**{**base, "hours": 0.0002, "turn_hours": 0.0001, **changes})  # type: ignore[arg-type]


@pytest.mark.slow
def test_networks_take_turns_until_all_have_trained_for_the_same_time(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 4)
    write_views(tmp_path / "val", 2)
    assert main(options(tmp_path)) == 0
    for name in ("compact_0", "unet_0"):
        hours = [float(row["hours"]) for row in rows(tmp_path / "out" / name / "val.csv")]
        assert hours == sorted(hours)
        assert trained_hours(tmp_path / "out" / name) >= 0.0002 * 0.99
    table = (tmp_path / "out/networks.md").read_text()
    assert "| compact | 8.6 | 1 |" in table
    assert "| unet |" in table


def test_with_no_time_only_the_table_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Trainer, "run", lambda self: pytest.fail("a network was trained"))
    (tmp_path / "out").mkdir()
    assert main(options(tmp_path, hours=0.0)) == 0
    assert (tmp_path / "out/networks.md").read_text().count("\n") == 2
    with pytest.raises(ConfigError, match="No network 'vgg'"):
        main(options(tmp_path, networks=("vgg",)))
