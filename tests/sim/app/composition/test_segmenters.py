"""Segmenters by name: RedNet's weights in the run, and a clear message if they are missing."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.app.composition.record import record_of
from sim.app.composition.segmenters import make_segmenter
from sim.app.composition.setup import resolve
from sim.app.options import RunOptions
from sim.core.interface import CameraModel, ConfigError
from stubborn.segmentation.checkpoints import save_network
from stubborn.segmentation.network import NetworkSegmenter
from stubborn.segmentation.rednet import RedNet, RedNetConfig

TINY = RedNetConfig(width=8, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1), final_blocks=1)


class Eyes:
    """The part of an environment that a segmenter reads."""

    camera_model = CameraModel()


@pytest.fixture
def weights(tmp_path: Path) -> Path:
    torch.manual_seed(0)
    save_network(tmp_path / "tiny.safetensors", RedNet(TINY), {"block_px": 4, "temperature": 1.5})
    return tmp_path / "tiny.safetensors"


def test_rednet_is_made_of_the_weights_that_are_given(weights: Path) -> None:
    segmenter = make_segmenter("rednet", Eyes(), weights)  # type: ignore[arg-type]
    assert isinstance(segmenter, NetworkSegmenter)
    assert segmenter.block_px == 4
    assert float(segmenter.calibration.scale[0]) == pytest.approx(1 / 1.5)
    rng = np.random.default_rng(0)
    rgb, depth = rng.integers(0, 255, (480, 640, 3), np.uint8), np.full((480, 640), 2.0, np.float32)
    scores = segmenter.scores({"rgb": rgb, "depth": depth}, "chair")
    assert scores.target.shape == scores.best_other.shape == (120, 160)
    assert 0 < scores.target.min() <= scores.target.max() < 1


def test_the_network_of_a_run_has_one_thread_since_others_would_change_its_last_digits(weights: Path) -> None:
    before = torch.get_num_threads()
    try:
        torch.set_num_threads(2)
        make_segmenter("rednet", Eyes(), weights)  # type: ignore[arg-type]
        assert torch.get_num_threads() == 1
    finally:
        torch.set_num_threads(before)


def test_the_checksum_of_the_weights_is_part_of_a_run(weights: Path, tmp_path: Path) -> None:
    split = {"name": "val", "version": "1.0.0", "sha256": "0"}

    def checksums(file: Path) -> dict[str, str]:
        options = RunOptions(semantics="rednet", weights=file)
        return record_of(resolve(options), split)["files_sha256"]

    first = checksums(weights)
    other = tmp_path / "other.safetensors"
    save_network(other, RedNet(TINY), {"block_px": 4})
    assert first != checksums(other)
    assert json.dumps(first)


def test_weights_that_are_not_there_and_weights_without_rednet_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="No weights at"):
        resolve(RunOptions(semantics="rednet", weights=tmp_path / "none.safetensors"))
    with pytest.raises(ConfigError, match=r"--weights.*--semantics.*'gt'"):
        resolve(RunOptions(semantics="gt", weights=tmp_path / "none.safetensors"))
    with pytest.raises(ConfigError, match=r"Unknown --semantics 'dreams'.*gt \(ground truth\)"):
        resolve(RunOptions(semantics="dreams"))
