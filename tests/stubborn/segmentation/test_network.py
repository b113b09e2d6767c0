"""The RedNet segmenter and the conversion of its images."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, CameraModel, ConfigError
from stubborn.segmentation import network
from stubborn.segmentation.calibration import Calibration
from stubborn.segmentation.checkpoints import save_network
from stubborn.segmentation.network import NetworkSegmenter
from stubborn.segmentation.preprocess import normalise_depth, normalise_rgb, padding, shrink
from stubborn.segmentation.rednet import RedNet, RedNetConfig
from tests.helpers import wording

TINY = RedNetConfig(width=4, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1), final_blocks=1)


@pytest.fixture(scope="module")
def model() -> RedNet:
    torch.manual_seed(0)
    return RedNet(TINY).eval()


@pytest.fixture(scope="module")
def frame() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    return {
        "rgb": rng.integers(0, 256, (480, 640, 3), dtype=np.uint8),
        "depth": rng.uniform(0.0, 5.0, (480, 640)).astype(np.float32),
    }


def test_scores_are_the_softmax_at_the_middle_pixels_of_blocks(model: RedNet, frame: dict[str, np.ndarray]) -> None:
    segmenter = NetworkSegmenter(model, calibration=Calibration.of_temperature(2.0))
    scores = segmenter.scores(frame, "sofa")
    logits = segmenter.logits(frame["rgb"], frame["depth"]).numpy()[:, 1::2, 1::2] / 2.0
    probability = np.exp(logits - logits.max(axis=0))
    probability /= probability.sum(axis=0)
    channel = MPCAT40_ID["sofa"] - 1
    np.testing.assert_allclose(scores.target, probability[channel], atol=1e-6)
    np.testing.assert_allclose(scores.best_other, np.delete(probability, channel, axis=0).max(axis=0), atol=1e-6)


@pytest.mark.parametrize("goal", GOAL_CATEGORIES)
def test_scores_of_every_goal_are_probabilities(model: RedNet, frame: dict[str, np.ndarray], goal: str) -> None:
    target, best_other = NetworkSegmenter(model).scores(frame, goal)
    assert target.shape == best_other.shape == (120, 160)
    assert target.dtype == best_other.dtype == np.float32
    assert target.min() >= 0.0
    assert float((target + best_other).max()) <= 1.0 + 1e-6


def test_the_frame_is_not_changed_and_the_same_frame_gives_the_same_scores(
    model: RedNet, frame: dict[str, np.ndarray]
) -> None:
    before = {name: image.copy() for name, image in frame.items()}
    segmenter = NetworkSegmenter(model)
    again = {name: image.copy() for name, image in frame.items()}  # another array: the last frame's result is kept
    first, second = segmenter.scores(frame, "bed"), segmenter.scores(again, "bed")
    assert np.array_equal(first.target, second.target)
    assert all(np.array_equal(before[name], frame[name]) for name in frame)


def test_scores_and_posteriors_of_one_frame_take_one_pass_of_the_network(
    model: RedNet, frame: dict[str, np.ndarray], monkeypatch: pytest.MonkeyPatch
) -> None:
    segmenter, passes = NetworkSegmenter(model), []
    compute: Any = segmenter.model.pyramid
    monkeypatch.setattr(
        segmenter.model, "pyramid", lambda *seen, **options: passes.append(1) or compute(*seen, **options)
    )
    bed, posteriors = segmenter.scores(frame, "bed"), segmenter.posteriors(frame)
    np.testing.assert_array_equal(bed.target, posteriors[MPCAT40_ID["bed"] - 1])
    assert len(passes) == 1
    segmenter.scores({name: image.copy() for name, image in frame.items()}, "bed")
    assert len(passes) == 2


def test_padding_keeps_every_pixel_in_its_place(model: RedNet) -> None:
    """240 rows are padded to 256 and cropped again."""
    rgb = np.random.default_rng(1).integers(0, 256, (240, 320, 3), dtype=np.uint8)
    pad = padding(240, 320)
    assert pad == (8, 8, 0, 0)
    back = normalise_rgb(rgb)[:, *pad.inner]
    assert back.shape == (3, 240, 320)
    np.testing.assert_allclose(back[0] * 0.544 + 0.493, rgb[..., 0] / 255.0, atol=1e-5)


def test_depth_is_scaled_from_the_nearest_to_the_farthest_distance() -> None:
    depth = np.full((32, 32), 5.0, np.float32)
    depth[0, :3] = 0.0, 0.3, 0.5
    scaled = normalise_depth(depth, CameraModel())[0] * 0.285 + 0.213
    np.testing.assert_allclose(scaled[0, :4], [0.0, 0.0, 0.0, 1.0], atol=1e-6)


def test_shrinking_takes_the_middle_label_of_a_block() -> None:
    labels = np.array([[1, 1, 9, 9], [1, 1, 9, 9]], np.uint8)
    assert shrink(labels, 2).tolist() == [[1, 9]]
    with pytest.raises(ConfigError, match=wording.NOT_A_WHOLE_NUMBER_OF_3_PIXEL_BLOCKS):
        shrink(labels, 3)


def test_unknown_goals_and_wrong_block_sizes_are_refused(model: RedNet, frame: dict[str, np.ndarray]) -> None:
    for goal in ("unicorn", "void"):
        with pytest.raises(ConfigError, match=f"no category '{goal}'"):
            NetworkSegmenter(model).scores(frame, goal)
    with pytest.raises(ConfigError, match="score_block_px, got 3 and 4"):
        NetworkSegmenter(model, block_px=3, score_block_px=4)
    with pytest.raises(ConfigError, match=wording.TEMPERATURE_MUST_BE_0):
        Calibration.of_temperature(0.0)


def test_resolution_and_temperature_are_stored_with_the_weights(model: RedNet, tmp_path: Path) -> None:
    save_network(tmp_path / "net.safetensors", model, {"temperature": 1.5, "block_px": 4})
    segmenter = NetworkSegmenter.from_file(tmp_path / "net.safetensors")
    assert float(segmenter.calibration.scale[3]) == pytest.approx(1 / 1.5)
    assert segmenter.block_px == 4


@pytest.mark.costly
def test_a_mirrored_segmenter_averages_the_image_and_its_mirror_image(
    model: RedNet, frame: dict[str, np.ndarray], monkeypatch: pytest.MonkeyPatch
) -> None:
    turned = {name: np.ascontiguousarray(image[:, ::-1]) for name, image in frame.items()}
    plain = NetworkSegmenter(model, block_px=1)
    one, other = (plain.logits(images["rgb"], images["depth"]) for images in (frame, turned))
    expected = 0.5 * (one + other.flip(-1))
    both = {}
    for bf16 in (True, False):
        monkeypatch.setattr(network, "computes_bf16", lambda bf16=bf16: bf16)
        assert not NetworkSegmenter(model).bf16
        both[bf16] = NetworkSegmenter(model, block_px=1, mirrored=True).logits(frame["rgb"], frame["depth"])
    torch.testing.assert_close(both[False], expected, atol=1e-4, rtol=0.0)
    assert {both[True].dtype, *(tensor.dtype for tensor in model.parameters())} == {torch.float32}
    assert 0.0 < float((both[True] - expected).abs().mean()) < 0.02 * float((both[True] - one).abs().mean())


@pytest.mark.costly
def test_a_segmenter_in_bf16_computes_what_autocast_computes(
    model: RedNet, frame: dict[str, np.ndarray], monkeypatch: pytest.MonkeyPatch
) -> None:
    both = {}
    for bf16 in (True, False):
        monkeypatch.setattr(network, "computes_bf16", lambda bf16=bf16: bf16)
        with torch.autocast("cpu", torch.bfloat16, enabled=not bf16):
            both[bf16] = NetworkSegmenter(model, mirrored=True).logits(frame["rgb"], frame["depth"])
    assert torch.equal(both[True], both[False])
