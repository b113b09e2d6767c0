"""The training tool on a few tiny views: its files, continued runs, finetuning, refused arguments."""

from __future__ import annotations

import json
import re
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from torch.utils.data import Subset

from sim.app.commands.evaluate.network_card import Training, training_commands, training_stages, training_text
from sim.app.commands.train.segmentation import Args, Trainer, main
from sim.core.interface import MPCAT40_ID, ConfigError
from sim.core.paths import code_hash
from sim.houses.labels import Instance
from sim.training.segmentation import trainer as segmentation_trainer
from sim.training.segmentation.trained_network import start_network
from sim.training.views.coco import annotate
from sim.training.views.shards import write_shard
from sim.training.views.views import View
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.networks import NETWORKS
from stubborn.segmentation.rednet import COMPACT, RedNet, RedNetConfig
from tests.helpers import wording
from tests.helpers.results import rows

SMALL = RedNetConfig(
    width=8,  # with fewer, PyTorch 2.13 overruns memory: fp32, channels_last, gradient of a 1x1 convolution of stride 2
    encoder_blocks=(1, 1, 1, 1),
    bottleneck=False,
    decoder_blocks=(1, 1, 1, 1),
    final_blocks=1,
    second="geometry",
)


@pytest.fixture(autouse=True)
def small_network(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets `--size small` name a network whose steps take little time."""
    for module in ("options", "trained_network"):
        monkeypatch.setattr(f"sim.training.segmentation.{module}.NETWORKS", {**NETWORKS, "small": SMALL})


def write_views(folder: Path, count: int, rows_px: int = 48) -> None:
    """Writes views, 64 pixels wide, of a bright sofa in front of a dark wall, with instances and styles."""
    rng = np.random.default_rng(0)
    views = []
    for i in range(count):
        ids = np.ones((rows_px, 64), np.uint16)
        ids[:, rng.integers(16, 48) :] = 2
        objects = (Instance("wall_00", "wall", (0,)), Instance("sofa_00", "sofa", (1,)))
        semantic = np.where(ids == 2, MPCAT40_ID["sofa"], MPCAT40_ID["wall"]).astype(np.uint8)
        rgb = np.repeat(np.where(ids == 2, 200, 50).astype(np.uint8)[..., None], 3, axis=2)
        depth = np.where(ids == 2, 1000, 3000).astype(np.uint16)
        annotations = annotate(ids, objects, {"sofa_00": f"style_{i % 2}"})
        views.append(View(f"v{i:05d}", rgb, depth, semantic, {"house": f"house_{i % 2}"}, ids, annotations))
    write_shard(folder, "views-000000", views, house="h", config={})


def options(tmp_path: Path, **changes: object) -> Args:
    base = {"views": (tmp_path / "train",), "val_views": (tmp_path / "val",), "out": tmp_path / "out", "block_px": 1}
    base |= {"size": "small", "batch": 2, "steps": 4, "evaluate_every": 2, "device": "cpu"}
    return Args(**{**base, **changes})  # type: ignore[arg-type]


@pytest.mark.costly
def test_training_writes_curves_and_weights_prints_its_loss_and_continues_a_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "more", 3)
    write_views(tmp_path / "val", 2)
    folders = (tmp_path / "train", tmp_path / "more")
    assert main(options(tmp_path, size="compact", views=folders)) == 0
    first = rows(tmp_path / "out/val.csv")
    assert [row["step"] for row in first] == ["2", "4"]
    model, card = load_network(tmp_path / "out/rednet.safetensors")
    assert model.config == COMPACT
    assert card["block_px"] == 1
    assert card["options"]["views"] == [str(folder) for folder in folders]
    assert card["recipe"]["average"] == 0.9998
    assert card["miou_calibrated"] == pytest.approx(max(float(row["miou_calibrated"]) for row in first), abs=1e-4)
    loss = float(rows(tmp_path / "out/train.csv")[-1]["loss"])
    text = capsys.readouterr().out
    assert "6 views; objects and styles: sofa 6 of 2" in text
    printed = re.search(r"step 4 of 4: loss (\d+\.\d{3}), ", text)
    assert printed is not None
    assert float(printed[1]) == pytest.approx(loss, abs=1e-3)
    assert main(options(tmp_path, size="compact", views=folders, steps=6)) == 0
    assert [row["step"] for row in rows(tmp_path / "out/val.csv")] == ["2", "4", "6"]
    assert load_network(tmp_path / "out/last.safetensors")[1]["step"] == 6


@pytest.mark.costly
def test_a_killed_run_continues_to_the_same_weights_and_has_no_row_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_views(tmp_path / "train", 6)
    write_views(tmp_path / "val", 2)
    monkeypatch.setattr(segmentation_trainer, "LOG_EVERY_STEPS", 1)
    assert main(options(tmp_path, out=tmp_path / "whole")) == 0
    train_on, out = Trainer._train_on, tmp_path / "out"

    def killed_at_4(trainer: Trainer, *batch: torch.Tensor) -> torch.Tensor:
        if trainer.step == 3:
            raise KeyboardInterrupt
        return train_on(trainer, *batch)

    monkeypatch.setattr(Trainer, "_train_on", killed_at_4)
    with pytest.raises(KeyboardInterrupt):
        main(options(tmp_path))
    assert [row["step"] for row in rows(out / "train.csv")] == ["1", "2", "3"]
    monkeypatch.setattr(Trainer, "_train_on", train_on)
    assert Trainer(options(tmp_path)).step == 2  # the state of the evaluation
    for _ in range(2):  # the second time there is nothing to do
        assert main(options(tmp_path)) == 0
        assert [row["step"] for row in rows(out / "train.csv")] == ["1", "2", "3", "4"]
        assert [row["step"] for row in rows(out / "val.csv")] == ["2", "4"]
        for name in ("last", "step-0000004"):
            same = [load_network(tmp_path / run / f"{name}.safetensors")[0].state_dict() for run in ("whole", "out")]
            assert all(torch.equal(tensor, same[1][key]) for key, tensor in same[0].items())
        assert Trainer(options(tmp_path)).best == pytest.approx(max_of(out / "val.csv", "miou_calibrated"))


def max_of(file: Path, column: str) -> float:
    return max(float(row[column]) for row in rows(file))


@pytest.mark.slow
def test_views_that_were_added_are_used_by_the_continued_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, count in (("train", 3), ("more", 2), ("val", 2)):
        write_views(tmp_path / name, count)
    assert main(options(tmp_path, steps=2)) == 0
    assert main(options(tmp_path, views=(tmp_path / "train", tmp_path / "more"))) == 0
    assert "5 views; objects" in capsys.readouterr().out
    assert [row["views"] for row in rows(tmp_path / "out/val.csv")] == ["3", "5"]


@pytest.mark.costly
def test_a_continued_run_evaluates_on_the_same_views(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "val", 20)
    monkeypatch.setattr(segmentation_trainer, "EVALUATION_SHARE", 1e-6)
    first = Trainer(options(tmp_path, hours=0.1))
    first._evaluate_start()
    assert len(first.val) == 7  # one in three
    first._save_state()
    again = Trainer(options(tmp_path, hours=0.1))
    assert isinstance(first.val, Subset)
    assert isinstance(again.val, Subset)
    assert [*again.val.indices] == [*first.val.indices]
    assert again._left_s() == first._left_s() < 360.0
    state = torch.load(tmp_path / "out/state.pt")
    del state["progress"]["val_stride"], state["progress"]["evaluation_s"]  # as older versions wrote it
    torch.save(state, tmp_path / "out/state.pt")
    assert len(Trainer(options(tmp_path, hours=0.1)).val) == 20


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
    slow = {"init": first, "size": None, "rate": 1e-9, "block_px": 2, "steps": 1, "evaluate_every": 1}
    assert main(options(tmp_path, out=tmp_path / "finer", **slow)) == 0
    (before, earlier), (after, card) = load_network(first), load_network(tmp_path / "finer/rednet.safetensors")
    assert card["started_from"] == {key: earlier[key] for key in ("step", "hours", "options", "code")}
    assert earlier["code"] == f"code {code_hash()}"
    assert card["options"]["rate"] == "1e-09"
    assert (earlier["block_px"], card["block_px"]) == (1, 2)
    weights = [network.state_dict()["conv1.weight"] for network in (before, after)]
    assert torch.allclose(*weights, atol=1e-4)
    assert (
        main(options(tmp_path, out=tmp_path / "finest", **slow | {"init": tmp_path / "finer/rednet.safetensors"})) == 0
    )
    _, last = load_network(tmp_path / "finest/rednet.safetensors")
    stages = training_stages(last)
    assert training_text(stages[-1]) == f"1 steps, {last['hours']} h, code {code_hash()}"
    folders = [stage.options["out"] for stage in stages]
    assert folders == [str(tmp_path / name) for name in ("out", "finer", "finest")]
    with pytest.raises(ConfigError, match="size 'compact'"):
        main(options(tmp_path, out=tmp_path / "other", init=first, size="compact"))


@pytest.mark.costly
def test_the_initial_weights_have_their_share_in_the_result(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "val", 2)
    assert main(options(tmp_path, steps=1)) == 0
    init = tmp_path / "out/rednet.safetensors"
    further = {"init": init, "size": None, "rate": 0.01, "steps": 2, "evaluate_every": 2}
    weights = {}
    for share in (0.0, 0.25, 1.0):
        out = tmp_path / f"share{share}"
        assert main(options(tmp_path, out=out, init_share=share, **further)) == 0
        network, card = load_network(out / "rednet.safetensors")
        weights[share] = network.state_dict()["conv1.weight"]
        averaged = ", then averaged with the weights before it" in training_text(training_stages(card)[-1])
        assert averaged == (share > 0.0)
    begin = load_network(init)[0].state_dict()["conv1.weight"]
    assert torch.equal(weights[1.0], begin)
    assert (weights[0.0] - begin).abs().max() > 1e-3
    assert torch.allclose(weights[0.25], 0.75 * weights[0.0] + 0.25 * begin, atol=2e-4)  # files have 16 bits
    with pytest.raises(ConfigError, match="--init-share needs --init"):
        main(options(tmp_path, out=tmp_path / "random", init_share=0.5))


def test_the_shipped_weights_have_a_name() -> None:
    size, model, metadata = start_network(None, Path("shipped"))
    assert (size, model.config) == ("compact-both", NETWORKS["compact-both"])
    assert isinstance(metadata["step"], int)
    assert metadata["step"] > 0


@pytest.mark.slow
def test_a_network_on_depth_is_trained_further_with_geometry_and_then_keeps_it(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "val", 2)
    first, both = tmp_path / "first.safetensors", NETWORKS["compact-both"]
    save_network(first, RedNet(COMPACT))
    assert main(options(tmp_path, init=first, size="compact-both", steps=1)) == 0
    assert load_network(tmp_path / "out/rednet.safetensors")[0].config == both
    again = options(tmp_path, init=tmp_path / "out/rednet.safetensors", size=None, out=tmp_path / "again", steps=1)
    assert main(again) == 0
    assert load_network(tmp_path / "again/rednet.safetensors")[0].config == both


def test_a_run_of_another_size_and_too_few_views_are_refused(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 1)
    write_views(tmp_path / "val", 1)
    with pytest.raises(ConfigError, match=wording.FEWER_VIEWS_THAN_ONE_BATCH_OF_2):
        main(options(tmp_path))
    with pytest.raises(ConfigError, match=r"--size.*'huge'"):
        main(options(tmp_path, size="huge"))
    with pytest.raises(ConfigError, match=r"--block-px.*640.*480.*7"):
        main(options(tmp_path, block_px=7))
    with pytest.raises(ConfigError, match=r"--views.*--val-views"):
        main(options(tmp_path, val_views=()))
    with pytest.raises(ConfigError, match="--furniture"):
        main(options(tmp_path, furniture=tmp_path))
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
        ({"rate": 1e-4}, "--rate = 0.0012, this command has 0.0001"),
        ({"seed": 3}, "--seed = 0, this command has 3"),
        ({"val_views": (tmp_path / "train", tmp_path / "val")}, "--val-views = 1 files"),
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
    with pytest.raises(ConfigError, match=r"'.*val'.*\[1.*2\]"):
        main(options(tmp_path))


def test_too_few_views_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "val", 2)
    (tmp_path / "train" / "views-000000.json").write_text('{"views": 3, "pixels": {}}')
    with pytest.raises(ConfigError, match=wording.FEWER_VIEWS_THAN_ONE_BATCH_OF_4):
        main(options(tmp_path, batch=4))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("options", "told"),
    [({"rate": 0.001}, False), ({"rate": 0.001, "window_px": 160}, True), ({"rate": 0.001, "rows": [1, 2]}, True)],
)
def test_a_card_says_which_options_are_of_earlier_versions(options: dict[str, object], told: bool) -> None:
    text = "\n".join(training_commands([Training(options={"seed": "1"}), Training(options={**options})]))
    assert "--seed 1\nstubborn train segmentation --rate 0.001" in text
    assert ("earlier versions" in text) == told


@pytest.mark.costly
def test_the_time_limit_is_kept_when_steps_suddenly_take_longer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_views(tmp_path / "train", 3)
    write_views(tmp_path / "val", 2)
    monkeypatch.setattr("sim.training.segmentation.trainer.LOG_EVERY_STEPS", 4)
    trainer = Trainer(options(tmp_path, hours=0.05, evaluate_every=10_000))
    step, now, steps = trainer._train_on, time.perf_counter, []

    def slow(*batch: Any) -> Any:
        steps.append(len(steps) + 1)
        if len(steps) == 5:
            monkeypatch.setattr(time, "perf_counter", lambda: now() + 180.0)
        return step(*batch)

    monkeypatch.setattr(trainer, "_train_on", slow)
    trainer.run()
    assert steps == [1, 2, 3, 4, 5]
