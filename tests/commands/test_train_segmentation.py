"""The training tool on a few tiny views: its files, continued runs, finetuning, refused arguments."""

from __future__ import annotations

import csv
import io
import json
import re
import tarfile
from pathlib import Path

import cv2
import numpy as np
import pytest
import torch

from sim.commands.evaluate.network_card import training_stages
from sim.commands.train import segmentation
from sim.commands.train.segmentation import Args, Trainer, main
from sim.datasets.coco import annotate
from sim.datasets.shards import write_shard
from sim.datasets.views import View
from sim.houses.labels import Instance
from sim.interface import MPCAT40_ID, ConfigError
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.networks import NETWORKS, build_network
from stubborn.segmentation.rednet import COMPACT


def write_views(folder: Path, count: int, size_px: int = 64, rows_px: int | None = None) -> None:
    """Writes views of a bright sofa in front of a dark wall."""
    folder.mkdir()
    rng = np.random.default_rng(0)
    with tarfile.open(folder / "views-000000.tar", "w") as archive:
        for i in range(count):
            semantic = np.full((rows_px or size_px, size_px), MPCAT40_ID["wall"], np.uint8)
            semantic[:, rng.integers(16, 48) :] = MPCAT40_ID["sofa"]
            is_sofa = semantic == MPCAT40_ID["sofa"]
            rgb = np.repeat(np.where(is_sofa, 200, 50).astype(np.uint8)[..., None], 3, axis=2)
            parts = {
                "rgb.png": cv2.imencode(".png", rgb)[1].tobytes(),
                "depth.png": cv2.imencode(".png", np.where(is_sofa, 1000, 3000).astype(np.uint16))[1].tobytes(),
                "semantic.png": cv2.imencode(".png", semantic)[1].tobytes(),
                "json": json.dumps({"house": f"house_{i % 2}"}).encode(),
            }
            for suffix, content in parts.items():
                entry = tarfile.TarInfo(f"v{i:03d}.{suffix}")
                entry.size = len(content)
                archive.addfile(entry, io.BytesIO(content))


def write_views_with_objects(folder: Path, count: int) -> None:
    """Views of a bright sofa in front of a dark wall, with instances and styles."""
    folder.mkdir()
    rng = np.random.default_rng(0)
    views = []
    for i in range(count):
        ids = np.ones((64, 64), np.uint16)
        ids[:, rng.integers(16, 48) :] = 2
        objects = (Instance("wall_00", "wall", (0,)), Instance("sofa_00", "sofa", (1,)))
        semantic = np.where(ids == 2, MPCAT40_ID["sofa"], MPCAT40_ID["wall"]).astype(np.uint8)
        rgb = np.repeat(np.where(ids == 2, 200, 50).astype(np.uint8)[..., None], 3, axis=2)
        depth = np.where(ids == 2, 1000, 3000).astype(np.uint16)
        annotations = annotate(ids, objects, {"sofa_00": f"style_{i % 2}"})
        views.append(View(f"v{i:05d}", rgb, depth, semantic, {"house": "h"}, ids, annotations))
    write_shard(folder, "views-000000", views, house="h", config={})


def rows(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


def options(tmp_path: Path, **changes: object) -> Args:
    base = {"views": (tmp_path / "train",), "val_views": (tmp_path / "val",), "out": tmp_path / "out", "block_px": 1}
    return Args(**{**base, "batch": 2, "steps": 4, "evaluate_every": 2, "device": "cpu", **changes})  # type: ignore[arg-type]


@pytest.mark.costly
def test_training_writes_curves_and_weights_prints_its_loss_and_continues_a_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "more", 3)
    write_views(tmp_path / "val", 2)
    folders = (tmp_path / "train", tmp_path / "more")
    assert main(options(tmp_path, views=folders)) == 0
    first = rows(tmp_path / "out/val.csv")
    assert [row["step"] for row in first] == ["2", "4"]
    model, card = load_network(tmp_path / "out/rednet.safetensors")
    assert model.config == COMPACT
    assert card["block_px"] == 1
    assert card["options"]["views"] == [str(folder) for folder in folders]
    assert card["miou_calibrated"] == pytest.approx(max(float(row["miou_calibrated"]) for row in first), abs=1e-4)
    loss = float(rows(tmp_path / "out/train.csv")[-1]["loss"])
    printed = re.search(r"step 4 of 4: loss (\d+\.\d{3}), ", capsys.readouterr().out)
    assert printed is not None
    assert float(printed[1]) == pytest.approx(loss, abs=1e-3)
    assert main(options(tmp_path, views=folders, steps=6)) == 0
    assert [row["step"] for row in rows(tmp_path / "out/val.csv")] == ["2", "4", "6"]
    assert load_network(tmp_path / "out/last.safetensors")[1]["step"] == 6


@pytest.mark.slow
def test_the_recipe_with_balanced_objects_trains_continues_and_says_what_it_draws_from(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_views_with_objects(tmp_path / "train", 3)
    write_views(tmp_path / "val", 2)
    recipe = {"balance": 0.8, "class_weights": "root", "area_weights": True, "window_px": 32, "warmup_steps": 1}
    assert main(options(tmp_path, **recipe)) == 0
    assert "3 views; objects and styles: sofa 3 of 2" in capsys.readouterr().out
    assert main(options(tmp_path, steps=6, **recipe)) == 0
    losses = [float(row["loss"]) for row in rows(tmp_path / "out/train.csv")]
    assert len(losses) == 2
    assert np.isfinite(losses).all()
    with pytest.raises(ConfigError, match="with --class-weights = root"):
        main(options(tmp_path, steps=8, **(recipe | {"class_weights": "log"})))
    with pytest.raises(ConfigError, match="--balance and --rare-share exclude each other"):
        main(options(tmp_path, **recipe, rare_share=0.1))


@pytest.mark.slow
def test_a_killed_run_keeps_its_best_network_and_has_no_row_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_views(tmp_path / "train", 6)
    write_views(tmp_path / "val", 2)
    out = tmp_path / "out"
    monkeypatch.setattr(segmentation, "LOG_EVERY_STEPS", 1)
    train_on = Trainer._train_on

    def killed_at_4(trainer: Trainer, *batch: torch.Tensor) -> float:
        if trainer.step == 3:
            raise KeyboardInterrupt
        return train_on(trainer, *batch)

    monkeypatch.setattr(Trainer, "_train_on", killed_at_4)
    with pytest.raises(KeyboardInterrupt):
        main(options(tmp_path))
    assert [row["step"] for row in rows(out / "train.csv")] == ["1", "2", "3"]
    monkeypatch.setattr(Trainer, "_train_on", train_on)
    best = float(rows(out / "val.csv")[0]["miou_calibrated"])
    assert Trainer(options(tmp_path)).best == pytest.approx(best)
    for _ in range(2):  # the second time there is nothing to do
        assert main(options(tmp_path, evaluate_every=3)) == 0
        assert [row["step"] for row in rows(out / "train.csv")] == ["1", "2", "3", "4"]
        assert [row["step"] for row in rows(out / "val.csv")] == ["2", "3", "4"]


@pytest.mark.costly
def test_a_run_that_was_killed_before_its_first_state_begins_its_curves_anew(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "val", 2)
    for _ in range(2):
        assert main(options(tmp_path, steps=2)) == 0
        assert [row["step"] for row in rows(tmp_path / "out/val.csv")] == ["2"]
        (tmp_path / "out/state.pt").unlink()


@pytest.mark.slow
def test_finetuning_starts_from_the_given_weights_and_records_their_training(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "val", 2)
    assert main(options(tmp_path, steps=2)) == 0
    first = tmp_path / "out/rednet.safetensors"
    slow = {
        "init": first,
        "rate": 1e-9,
        "window_px": 32,
        "whole_share": 0.5,
        "focus_share": 0.5,
        "val_block_px": 2,
        "steps": 1,
        "evaluate_every": 1,
    }
    assert main(options(tmp_path, out=tmp_path / "finer", **slow)) == 0
    (before, earlier), (after, card) = load_network(first), load_network(tmp_path / "finer/rednet.safetensors")
    assert card["started_from"] == {key: earlier[key] for key in ("step", "hours", "options")}
    assert card["options"]["window_px"] == "32"
    assert (earlier["block_px"], card["block_px"]) == (1, 2)
    weights = [network.state_dict()["conv1.weight"] for network in (before, after)]
    assert torch.allclose(*weights, atol=1e-4)
    assert (
        main(options(tmp_path, out=tmp_path / "finest", **slow | {"init": tmp_path / "finer/rednet.safetensors"})) == 0
    )
    _, last = load_network(tmp_path / "finest/rednet.safetensors")
    folders = [stage["options"]["out"] for stage in training_stages(last)]
    assert folders == [str(tmp_path / name) for name in ("out", "finer", "finest")]
    with pytest.raises(ConfigError, match="is not of size 'unet'"):
        main(options(tmp_path, out=tmp_path / "other", init=first, size="unet"))


@pytest.mark.slow
def test_a_network_on_depth_is_trained_further_with_geometry_and_then_keeps_it(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 3, rows_px=48)
    write_views(tmp_path / "val", 2, rows_px=48)
    first, both = tmp_path / "first.safetensors", NETWORKS["compact-both"]
    save_network(first, build_network(COMPACT))
    assert main(options(tmp_path, init=first, size="compact-both", steps=1)) == 0
    assert load_network(tmp_path / "out/rednet.safetensors")[0].config == both
    again = options(tmp_path, init=tmp_path / "out/rednet.safetensors", out=tmp_path / "again", steps=1)
    assert main(again) == 0
    assert load_network(tmp_path / "again/rednet.safetensors")[0].config == both


def test_a_run_of_another_size_and_too_few_views_are_refused(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 1)
    write_views(tmp_path / "val", 1)
    with pytest.raises(ConfigError, match="fewer views than one batch of 2"):
        main(options(tmp_path))
    with pytest.raises(ConfigError, match=r"--size must be one of compact, compact-geometry, .*, got 'huge'"):
        main(options(tmp_path, size="huge"))
    with pytest.raises(ConfigError, match=r"--window-px must be at least 32 .*, got 16"):
        main(options(tmp_path, window_px=16))
    with pytest.raises(ConfigError, match=r"--whole-share needs --window-px, got 0.5 without it"):
        main(options(tmp_path, whole_share=0.5))
    with pytest.raises(ConfigError, match=r"--focus-share needs --window-px, got 0.5 without it"):
        main(options(tmp_path, focus_share=0.5))
    with pytest.raises(ConfigError, match=r"--average must be less than 1, got 1\.0"):
        main(options(tmp_path, average=1.0))
    with pytest.raises(ConfigError, match="No shards"):
        main(options(tmp_path, views=(tmp_path / "train", tmp_path / "nothing")))


@pytest.mark.slow
def test_a_run_is_continued_with_its_own_options_and_for_longer_only(tmp_path: Path) -> None:
    for name in ("train", "other"):
        write_views(tmp_path / name, 3 + len(name) % 2)
    write_views(tmp_path / "val", 2)
    assert main(options(tmp_path, hours=0.0003, steps=2, evaluate_every=1000)) == 0
    done = int(rows(tmp_path / "out/train.csv")[-1]["step"])
    for changes, message in (
        ({"rate": 1e-4}, "--rate = 0.002, this command has 0.0001"),
        ({"seed": 3}, "--seed = 0, this command has 3"),
        ({"views": (tmp_path / "train", tmp_path / "val")}, "--views = 1 files"),
    ):
        with pytest.raises(ConfigError, match=message):
            main(options(tmp_path, hours=0.0003, steps=2, **changes))
    assert Trainer(options(tmp_path, hours=0.0003, steps=2)).total == done
    assert Trainer(options(tmp_path, hours=1.0, steps=2)).total > done


def test_views_of_different_sizes_are_refused(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "val", 2)
    for name, shrink in (("train", 1), ("val", 2)):
        for shard in (tmp_path / name).glob("*.tar"):
            note = {"config": {"shrink": shrink}, "pixels": {"wall": 9, "sofa": 9}}
            shard.with_suffix(".json").write_text(json.dumps(note))
    with pytest.raises(ConfigError, match=r"train', '.*val' were shrunk by different factors: \[1, 2\]"):
        main(options(tmp_path))


def test_too_few_views_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "val", 2)
    (tmp_path / "train" / "views-000000.json").write_text('{"views": 3, "pixels": {}}')
    with pytest.raises(ConfigError, match="fewer views than one batch of 4"):
        main(options(tmp_path, batch=4))
    assert not (tmp_path / "out").exists()
