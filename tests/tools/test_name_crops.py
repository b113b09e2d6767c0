"""Crops of objects that a person names, on a few tiny views."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import torch

from sim.core.interface import MPCAT40_ID, ConfigError
from sim.training.segmentation.dataset import list_shards
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.rednet import RedNet
from tests.sim.app.commands.test_evaluate_objects import TINY
from tests.sim.app.commands.test_train_segmentation import write_views
from tools.training.name_crops import FRAME, Args, choose, main, predict


@pytest.fixture
def args(tmp_path: Path) -> Args:
    """Returns the options for views of six sofas, and a network that calls every pixel a sofa."""
    write_views(tmp_path / "views", 6)
    torch.manual_seed(0)
    model = RedNet(TINY)
    with torch.no_grad():
        model.get_parameter("final_deconv_custom.weight").zero_()
        model.get_parameter("final_deconv_custom.bias").zero_()[MPCAT40_ID["sofa"] - 1] = 5.0
    save_network(tmp_path / "sofa.safetensors", model, {"block_px": 1})
    return Args(views=tmp_path / "views", out=tmp_path / "crops", weights=tmp_path / "sofa.safetensors", each=4)


def test_sheets_show_framed_objects_and_answers_are_compared(
    args: Args, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(args) == 0
    assert "4 crops in" in capsys.readouterr().out
    sheet = cv2.imread(str(args.out / "sheet_0.png"))
    assert sheet is not None
    assert (sheet[:, :, ::-1] == FRAME).all(axis=2).sum() > 4 * 100
    answers = tmp_path / "answers.txt"
    answers.write_text("sofa bed\nsofa sofa")
    assert main(replace(args, answers=answers)) == 0
    assert capsys.readouterr().out.splitlines() == [
        "1: sofa, answer bed, network sofa", "answers: 3 of 4 right (75 %)", "network: 4 of 4 right (100 %)"
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "message"), [("sofa", "1 answers for 4 crops"), ("sofa sofa sofa settee", "'settee'")]
)
def test_answers_that_do_not_fit_are_refused(args: Args, tmp_path: Path, text: str, message: str) -> None:
    answers = tmp_path / "answers.txt"
    answers.write_text(text)
    with pytest.raises(ConfigError, match=message):
        main(replace(args, answers=answers))


def test_an_object_that_the_networks_grid_does_not_show_is_void_to_it(args: Args, tmp_path: Path) -> None:
    network, _ = load_network(tmp_path / "sofa.safetensors")
    save_network(tmp_path / "coarse.safetensors", network, {"block_px": 2})  # of each two columns, it gets the second
    crop = choose(list_shards(args.views), 1, seed=0)[0]
    thin = np.zeros_like(crop.inside)
    thin[:, 0] = True
    coarse = replace(args, weights=tmp_path / "coarse.safetensors")
    assert predict([crop, replace(crop, inside=thin)], coarse) == ["sofa", "void"]
