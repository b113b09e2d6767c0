"""The evaluation tool on a few tiny views: its results, and the temperature that it writes to the file."""

from __future__ import annotations

import http.server
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import torch

from sim.app import cli
from sim.app.commands.evaluate import own
from sim.app.commands.evaluate import segmentation as evaluate_rednet
from sim.app.commands.evaluate.segmentation import Args
from sim.app.services.forms import posteriors_bytes, read_view
from sim.core.interface import MPCAT40_ID, ConfigError
from sim.training.segmentation.evaluation import Iou
from stubborn.segmentation.calibration import Calibration
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.rednet import RedNet, RedNetConfig
from stubborn.segmentation.shipped import SHIPPED_REDNET
from tests.helpers import wording
from tests.helpers.services import Server, send
from tests.sim.app.commands.test_train_segmentation import write_views

TINY = RedNetConfig(width=8, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1), final_blocks=1)


@pytest.fixture(autouse=True)
def few_timed_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evaluate_rednet, "TIMED_FRAMES", 2)


@pytest.fixture
def weights(tmp_path: Path) -> Path:
    """Returns an overconfident network."""
    torch.manual_seed(0)
    model = RedNet(TINY)
    with torch.no_grad():
        model.final_deconv_custom.weight *= 5.0
    save_network(tmp_path / "tiny.safetensors", model, {"block_px": 1, "step": 7})
    return tmp_path / "tiny.safetensors"


@pytest.mark.costly
def test_a_calibration_is_fitted_written_and_improves_calibration(tmp_path: Path, weights: Path) -> None:
    for name in ("one", "two"):
        write_views(tmp_path / name, 4)
    card = tmp_path / "card.md"
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "train.csv").write_text("step,hours,loss\n20,0.1,9.5\n40,0.2,4.5\n")
    (tmp_path / "run" / "val.csv").write_text("step,hours,miou_goals,accuracy\n40,0.2,0.3,0.7\n")
    args = Args(
        views=(tmp_path / "one", tmp_path / "two"),
        weights=weights,
        calibrate=True,
        card=card,
        curves=(tmp_path / "run",),
        threads=1,
    )
    before = load_network(weights)[0].state_dict()
    assert evaluate_rednet.main(args) == 0
    model, metadata = load_network(weights)
    assert np.mean(metadata["calibration"]["scale"]) < 0.5
    assert metadata["step"] == 7
    assert all(torch.equal(before[name], tensor) for name, tensor in model.state_dict().items())
    measured = evaluate_rednet.measure(Args(views=args.views, weights=weights, threads=1), model, metadata)
    assert measured.views == 8
    assert measured.after.error < 0.6 * measured.before.error
    assert 0.0 <= measured.iou.goals <= 1.0
    some = evaluate_rednet.measure(Args(views=args.views, weights=weights, threads=1, count=3), model, metadata)
    assert some.views == 6
    assert measured.frame_ms > 0.5
    text = card.read_text()
    assert "| number of views | 8 |" in text
    for picture in ("card_confusion.png", "card_curves.png"):
        assert f"({picture})" in text
        drawn = cv2.imread(str(tmp_path / picture))
        assert drawn is not None
        assert drawn.std() > 5.0


@pytest.mark.costly
def test_another_resolution_is_evaluated_and_written_with_the_calibration(tmp_path: Path, weights: Path) -> None:
    for name in ("one", "two"):
        write_views(tmp_path / name, 4)
    views = (tmp_path / "one", tmp_path / "two")
    assert evaluate_rednet.main(Args(views=views, weights=weights, block_px=2, threads=1)) == 0
    assert load_network(weights)[1]["block_px"] == 1
    assert evaluate_rednet.main(Args(views=views, weights=weights, block_px=2, threads=1, calibrate=True)) == 0
    assert load_network(weights)[1]["block_px"] == 2


def test_views_at_a_lower_resolution_than_the_network_needs_are_refused(
    tmp_path: Path, weights: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_views(tmp_path / "one", 2)
    views = [
        view for shard in evaluate_rednet.list_shards(tmp_path / "one") for view in evaluate_rednet.read_shard(shard)
    ]
    with pytest.raises(ConfigError, match=wording.NEEDS_BLOCKS_OF_1_PIXELS_BUT_THE_VIEWS_ARE_STORE):
        evaluate_rednet.loader(RedNet(TINY), views, 1, 2)
    words = ["--views", str(tmp_path / "one"), "--weights", str(weights), "--threads", "0"]
    assert cli.run(Args, evaluate_rednet.main, words) == 2
    assert "--threads must be at least 1" in capsys.readouterr().err


def test_views_of_one_house_and_folders_without_a_training_are_refused(tmp_path: Path, weights: Path) -> None:
    write_views(tmp_path / "one", 1)
    with pytest.raises(ConfigError, match="one house"):
        evaluate_rednet.main(Args(views=(tmp_path / "one",), weights=weights, threads=1))
    write_views(tmp_path / "two", 2)
    args = Args(views=(tmp_path / "two",), weights=weights, threads=1, card=tmp_path / "card.md", curves=(tmp_path,))
    with pytest.raises(ConfigError, match=r"train\.csv"):
        evaluate_rednet.main(args)
    assert not (tmp_path / "card.md").exists()


def test_a_calibration_is_not_written_into_a_file_of_another_project(tmp_path: Path) -> None:
    file = tmp_path / "published.pth"
    file.write_bytes(b"weights")
    with pytest.raises(ConfigError, match="--calibrate"):
        evaluate_rednet.main(Args(views=(tmp_path,), weights=file, calibrate=True))
    assert file.read_bytes() == b"weights"


@pytest.mark.costly
def test_mirror_images_slivers_and_the_calibration_change_what_is_measured(tmp_path: Path, weights: Path) -> None:
    for name in ("one", "two"):
        write_views(tmp_path / name, 4)
    args = Args(views=(tmp_path / "one", tmp_path / "two"), weights=weights, block_px=2, threads=1)
    model, metadata = load_network(weights)
    plain = evaluate_rednet.measure(args, model, metadata)
    assert (plain.calibrated.of() == plain.matrix).all()
    mirrored = evaluate_rednet.measure(replace(args, mirror=True), model, metadata)
    assert mirrored.matrix.sum() == plain.matrix.sum()
    assert (mirrored.matrix != plain.matrix).any()
    without = evaluate_rednet.measure(replace(args, slivers=False), model, metadata)
    assert without.matrix.sum() < plain.matrix.sum()  # sofas of 16 columns at the right edge are slivers
    sofa = torch.zeros(40)
    sofa[MPCAT40_ID["sofa"] - 1] = 1e4
    metadata["calibration"] = Calibration(torch.ones(40), sofa).to_metadata()
    shifted = evaluate_rednet.measure(args, model, metadata)
    assert (shifted.matrix == plain.matrix).all()
    sofas = plain.matrix[MPCAT40_ID["sofa"] - 1].sum()
    assert Iou.of(shifted.calibrated.of()).accuracy == pytest.approx(sofas / plain.matrix.sum())


@pytest.mark.costly
def test_two_networks_are_compared_on_the_same_views(
    tmp_path: Path, weights: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("one", "two"):
        write_views(tmp_path / name, 4)
    other = tmp_path / "other.safetensors"
    model, metadata = load_network(weights)
    sofa = torch.zeros(40)
    sofa[MPCAT40_ID["sofa"] - 1] = 1e4
    save_network(other, model, metadata | {"calibration": Calibration(torch.ones(40), sofa).to_metadata()})
    views = (tmp_path / "one", tmp_path / "two")
    assert evaluate_rednet.main(Args(views=views, weights=weights, against=weights, threads=1)) == 0
    assert capsys.readouterr().out.count("+0.000 [0.000, 0.000]") == 3  # all views and each folder
    evaluate_rednet.main(Args(views=views, weights=other, against=weights, threads=1))
    values = re.findall(r"(?:all views|one|two): ([-+]\d\.\d+) ", capsys.readouterr().out)
    assert len(values) == 3
    assert float(values[0]) != 0.0


def test_the_calibration_of_the_shipped_weights_is_replaced_only_when_the_options_say_so(tmp_path: Path) -> None:
    for file in (None, SHIPPED_REDNET):
        with pytest.raises(ConfigError, match=r"--weights.*FILE.*--shipped"):
            evaluate_rednet.main(Args(views=(tmp_path,), weights=file, calibrate=True))


OWN = "tests.helpers.segmentations"


@pytest.mark.parametrize(("name", "accuracy"), [("BRIGHT", "1.000"), ("BrightGoals", None)])
def test_a_segmentation_of_ones_own_is_evaluated(
    name: str, accuracy: str | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_views(tmp_path / "views", 4)
    assert evaluate_rednet.main(Args(views=(tmp_path / "views",), semantics=f"{OWN}:{name}")) == 0
    printed = capsys.readouterr().out
    assert "| mIoU, goal categories present | 1.000 [1.000, 1.000] |" in printed
    assert "| sofa | 1.000 | 4 | 100 % |" in printed
    assert "| number of views | 4 |" in printed
    assert accuracy is None or f"| pixel accuracy | {accuracy} |" in printed


def test_it_is_evaluated_on_the_grid_of_the_shipped_network(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_views(tmp_path / "views", 2)  # of 64 x 48 pixels
    counted = []
    for stored_px in (2, 4):
        monkeypatch.setattr(own, "stored_block_px", lambda shards, stored_px=stored_px: stored_px)
        counted.append(own.measure_own(f"{OWN}:BRIGHT", [tmp_path / "views"], count=0, config=()).confusions.of().sum())
    assert counted == [2 * 24 * 32, 2 * 48 * 64]


def test_the_configuration_of_a_segmentation_of_ones_own_counts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_views(tmp_path / "views", 2)
    evaluate_rednet.main(Args(views=(tmp_path / "views",), semantics=f"{OWN}:BRIGHT", config=("detector.bar=250",)))
    assert "| sofa | 0.000 | 2 | 0 % |" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"semantics": f"{OWN}:Truth"}, "'semantic'"),
        ({"semantics": f"{OWN}:BRIGHT", "calibrate": True}, "--calibrate"),
        ({"semantics": f"{OWN}:BRIGHT", "config": ("detector.level=1",)}, "bar"),
        ({"config": ("detector.level=1",)}, "--config and --calibration need --semantics"),
        ({"semantics": f"{OWN}:BRIGHT", "calibration": Path("calibration.json")}, "--calibration is for a server"),
    ],
)
def test_options_that_a_segmentation_of_ones_own_cannot_take_are_refused(
    options: dict[str, Any], message: str, tmp_path: Path
) -> None:
    write_views(tmp_path / "views", 1)
    with pytest.raises(ConfigError, match=message):
        evaluate_rednet.main(Args(views=(tmp_path / "views",), **options))


@pytest.mark.costly
def test_a_server_is_evaluated_and_calibrated_on_other_houses(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def answer(handler: http.server.BaseHTTPRequestHandler, body: bytes) -> None:
        rgb = read_view(body)[0][2::4, 2::4, 0]
        posteriors = np.full((40, *rgb.shape), 0.01 / 39, np.float32)
        right = np.where(rgb > 100, MPCAT40_ID["sofa"], MPCAT40_ID["wall"]) - 1
        wrong = np.random.default_rng(0).random(rgb.shape) < 0.3  # of which the server is certain, too
        np.put_along_axis(posteriors, np.where(wrong, MPCAT40_ID["bed"] - 1, right)[None], 0.99, axis=0)
        send(handler, posteriors_bytes(posteriors))

    write_views(tmp_path / "views", 40)
    server, file = Server(answer), tmp_path / "calibration.json"
    args = Args(views=(tmp_path / "views",), semantics=server.url, calibration=file)
    assert evaluate_rednet.main(args) == 0
    line = capsys.readouterr().out.splitlines()[-1]
    before, after = (float(number) for number in re.findall(r"\d+\.\d+", line))
    assert after < 0.5 * before, line
    assert len(json.loads(file.read_text())["scale"]) == 40
    with pytest.raises(ConfigError, match="--calibration fits raw scores"):
        evaluate_rednet.main(replace(args, config=(f"detector.calibration={file}",)))
    server.close()
