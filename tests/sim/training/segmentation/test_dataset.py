"""Reading shards for training."""

from __future__ import annotations

import io
import json
import shutil
import tarfile
from pathlib import Path

import cv2
import numpy as np
import pytest
from torch.utils.data import DataLoader

from sim.core.interface import ConfigError
from sim.training.segmentation import dataset
from sim.training.segmentation.dataset import (
    LabelledView,
    ViewDataset,
    list_shards,
    read_shard,
    spread_views,
    stored_block_px,
)


def write_tar(file: Path, keys: list[str], *, leave_out: str = "", category: int = 3) -> None:
    """Writes views of 8 x 6 pixels whose depth in metres is their number."""
    with tarfile.open(file, "w") as archive:
        for i, key in enumerate(keys):
            parts = {
                "rgb.png": cv2.imencode(".png", np.full((6, 8, 3), i, np.uint8))[1].tobytes(),
                "depth.png": cv2.imencode(".png", np.full((6, 8), 1000 * i, np.uint16))[1].tobytes(),
                "semantic.png": cv2.imencode(".png", np.full((6, 8), category, np.uint8))[1].tobytes(),
                "json": json.dumps({"key": key}).encode(),
            }
            for suffix, content in parts.items():
                if suffix != leave_out:
                    entry = tarfile.TarInfo(f"{key}.{suffix}")
                    entry.size = len(content)
                    archive.addfile(entry, io.BytesIO(content))


def key_of(view: LabelledView, rng: np.random.Generator) -> str:
    return view.key


def two_shards(folder: Path) -> list[Path]:
    for s in range(2):
        write_tar(folder / f"views-{s}.tar", [f"s{s}_{i}" for i in range(5)])
    return list_shards(folder)


def test_views_are_read_as_they_were_written(tmp_path: Path) -> None:
    write_tar(tmp_path / "v.tar", ["a", "b", "c"])
    views = list(read_shard(tmp_path / "v.tar"))
    assert [view.key for view in views] == ["a", "b", "c"]
    assert [float(view.depth_m.max()) for view in views] == [0.0, 1.0, 2.0]
    assert views[2].rgb.shape == (6, 8, 3)
    assert views[1].record == {"key": "b"}


@pytest.mark.parametrize("workers", [0, 2])
def test_an_epoch_holds_each_view_once_for_any_number_of_workers(tmp_path: Path, workers: int) -> None:
    shards = two_shards(tmp_path)
    dataset = ViewDataset(shards, key_of, buffer=3)
    keys = [key for batch in DataLoader(dataset, batch_size=2, num_workers=workers) for key in batch]
    assert sorted(keys) == sorted(f"s{s}_{i}" for s in range(2) for i in range(5))


def test_the_order_changes_with_the_epoch_only(tmp_path: Path) -> None:
    dataset = ViewDataset(two_shards(tmp_path), key_of, seed=4)
    first, again = list(dataset), list(dataset)
    dataset.epoch = 1
    assert first == again != list(dataset)
    in_order = ViewDataset(list_shards(tmp_path), key_of, shuffle=False)
    assert list(in_order) == sorted(first)


@pytest.mark.parametrize("part", ["rgb.png", "depth.png", "semantic.png", "json"])
def test_an_incomplete_view_is_named(tmp_path: Path, part: str) -> None:
    write_tar(tmp_path / "v.tar", ["a"], leave_out=part)
    with pytest.raises(ConfigError, match=rf"v\.tar': view 'a' has no '{part.split('.')[0]}'"):
        list(read_shard(tmp_path / "v.tar"))


def test_a_truncated_shard_and_an_unknown_category_are_named(tmp_path: Path) -> None:
    write_tar(tmp_path / "v.tar", ["a", "b"])
    content = (tmp_path / "v.tar").read_bytes()
    (tmp_path / "cut.tar").write_bytes(content[: content.index(b"b.depth.png") + 600])
    with pytest.raises(ConfigError, match=r"cut\.tar' is broken"):
        list(read_shard(tmp_path / "cut.tar"))
    (tmp_path / "no.tar").write_bytes(b"no tar file")
    with pytest.raises(ConfigError, match=r"no\.tar' is broken"):
        list(read_shard(tmp_path / "no.tar"))
    write_tar(tmp_path / "strange.tar", ["a"], category=77)
    with pytest.raises(ConfigError, match="category 77, mpcat40 ends at 40"):
        list(read_shard(tmp_path / "strange.tar"))
    with pytest.raises(ConfigError, match="No shards"):
        list_shards(tmp_path / "nowhere")


def test_the_factor_of_stored_views_is_read_from_their_notes(tmp_path: Path) -> None:
    shards = two_shards(tmp_path)
    assert stored_block_px(shards) == 1
    for shard in shards:
        shard.with_suffix(".json").write_text(json.dumps({"config": {"shrink": 2}}))
    assert stored_block_px(shards) == 2
    shards[0].with_suffix(".json").write_text(json.dumps({"config": {"shrink": 4}}))
    with pytest.raises(ConfigError, match=r"different factors: \[2, 4\]"):
        stored_block_px(shards)


@pytest.mark.parametrize(("count", "wanted"), [(0, 6), (2, 2), (3, 3), (5, 5), (9, 6)])
def test_some_views_are_spread_over_all_shards_and_no_other_is_decoded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, count: int, wanted: int
) -> None:
    for number in range(3):
        write_tar(tmp_path / f"views-{number}.tar", [f"a{number}", f"b{number}"])
    shards = list_shards(tmp_path)
    decoded: list[Path] = []
    decode = dataset.decode_view
    monkeypatch.setattr(dataset, "decode_view", lambda file, *of: (decoded.append(file), decode(file, *of))[1])
    assert len(spread_views(shards, count)) == len(decoded) == wanted
    if count == 2:
        assert decoded == [shards[0], shards[-1]]
    elif count:
        assert set(decoded) == set(shards)


def test_a_shard_that_was_copied_is_refused(tmp_path: Path) -> None:
    first, _ = two_shards(tmp_path)
    shutil.copy(first, tmp_path / "copy.tar")
    with pytest.raises(ConfigError, match="'s0_0'"):
        list_shards(tmp_path)
