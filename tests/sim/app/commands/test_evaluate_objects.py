"""The sheet of missed objects, on a few tiny views and a network that has learned nothing."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
import torch

from sim.app.commands.evaluate.objects import Args, main, missed_objects
from sim.core.interface import MPCAT40_ID
from sim.training.segmentation.dataset import list_shards
from stubborn.segmentation.calibration import Calibration
from stubborn.segmentation.checkpoints import save_network
from stubborn.segmentation.rednet import RedNet, RedNetConfig
from tests.sim.app.commands.test_train_segmentation import write_views

TINY = RedNetConfig(width=8, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1), final_blocks=1)


@pytest.fixture
def always_wall() -> RedNet:
    """Returns a network that calls every pixel a wall."""
    torch.manual_seed(0)
    model = RedNet(TINY)
    with torch.no_grad():
        model.get_parameter("final_deconv_custom.weight").zero_()
        model.get_parameter("final_deconv_custom.bias").zero_()[MPCAT40_ID["wall"] - 1] = 5.0
    return model


def test_every_pixel_of_a_missed_sofa_is_counted_and_named(tmp_path: Path, always_wall: RedNet) -> None:
    write_views(tmp_path / "views", 3)
    missed_all = list(missed_objects(list_shards(tmp_path / "views"), always_wall, 1, Calibration.of_temperature(1.0)))
    assert [(missed.category, missed.taken_for) for missed in missed_all] == [("sofa", "wall")] * 3
    for missed in missed_all:
        left, top, width, height = missed.box
        assert (top, height, left + width) == (0, 48, 64)
        assert missed.missed_px == 48 * width == np.count_nonzero(missed.truth == MPCAT40_ID["sofa"])


def test_objects_are_predicted_with_the_calibration_of_the_weights(tmp_path: Path, always_wall: RedNet) -> None:
    write_views(tmp_path / "views", 2)
    calibration = Calibration.of_temperature(1.0)
    calibration.offset[MPCAT40_ID["wall"] - 1] = -10.0
    calibration.offset[MPCAT40_ID["floor"] - 1] = 10.0
    missed_all = list(missed_objects(list_shards(tmp_path / "views"), always_wall, 1, calibration))
    assert [missed.taken_for for missed in missed_all] == ["floor"] * 2


def test_the_sheet_has_the_worst_object_of_each_house(
    tmp_path: Path, always_wall: RedNet, capsys: pytest.CaptureFixture
) -> None:
    write_views(tmp_path / "views", 4)  # of two houses
    save_network(tmp_path / "wall.safetensors", always_wall, {"block_px": 1})
    sheet = tmp_path / "worst.png"
    assert main(Args(views=tmp_path / "views", weights=tmp_path / "wall.safetensors", out=sheet, threads=1)) == 0
    assert "2 objects in" in capsys.readouterr().out
    drawn = cv2.imread(str(sheet))
    assert drawn is not None
    assert drawn.shape[0] == 2 * 300


def test_nothing_is_drawn_where_nothing_is_missed(
    tmp_path: Path, always_wall: RedNet, capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sim.app.commands.evaluate.objects.missed_objects", lambda *_: iter(()))
    write_views(tmp_path / "views", 1)
    save_network(tmp_path / "wall.safetensors", always_wall, {"block_px": 1})
    sheet = tmp_path / "worst.png"
    assert main(Args(views=tmp_path / "views", weights=tmp_path / "wall.safetensors", out=sheet, threads=1)) == 0
    assert capsys.readouterr().out == "The network misses no object of these views.\n"
    assert not sheet.exists()
