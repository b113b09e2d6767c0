"""The networks by name: shapes, files, further inputs, the resolution of scores."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from sim.core.interface import CameraModel, ConfigError
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.inputs import INPUTS
from stubborn.segmentation.network import NetworkSegmenter
from stubborn.segmentation.networks import NETWORKS, with_geometry
from stubborn.segmentation.rednet import CLASSES, RedNet, RedNetConfig

SMALL = RedNetConfig(
    width=4,
    encoder_blocks=(1, 1, 1, 1),
    bottleneck=False,
    decoder_blocks=(1, 1, 1, 1),
    final_blocks=1,
    second="geometry",
)


@pytest.mark.parametrize("name", [name for name in NETWORKS if name != "published"])
def test_every_network_gives_a_logit_of_each_class_for_each_pixel(name: str) -> None:
    model = RedNet(NETWORKS[name]).eval()
    second = torch.randn(1, INPUTS[model.config.second].channels, 64, 96)
    with torch.inference_mode():
        outputs = model.pyramid(torch.randn(1, 3, 64, 96), second)
        assert model(torch.randn(1, 3, 64, 96), second).shape == (1, CLASSES, 64, 96)
    assert outputs[0].shape == (1, CLASSES, 64, 96)
    assert [out.shape[-1] for out in outputs] == sorted((out.shape[-1] for out in outputs), reverse=True)


def test_a_network_is_stored_with_its_configuration_and_16_bit_weights(tmp_path: Path) -> None:
    model = RedNet(SMALL).eval()
    save_network(tmp_path / "net.safetensors", model, {"block_px": 2})
    loaded, metadata = load_network(tmp_path / "net.safetensors")
    rgb, second = torch.randn(1, 3, 32, 64), torch.randn(1, 6, 32, 64)
    assert loaded.config == SMALL
    assert metadata == {"block_px": 2}
    for name, tensor in model.state_dict().items():
        assert torch.equal(loaded.state_dict()[name], tensor.half().to(tensor.dtype))
    with torch.inference_mode():
        assert torch.equal(loaded(rgb, second), model.half().float()(rgb, second))


def test_a_network_that_gets_the_geometric_channels_keeps_its_output() -> None:
    torch.manual_seed(0)
    small = RedNetConfig(width=4, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1))
    model = RedNet(small).eval()
    wider = with_geometry(model)
    depth_m, rgb = np.random.default_rng(0).uniform(0.5, 5.0, (64, 64)).astype(np.float32), torch.randn(1, 3, 64, 64)
    camera = CameraModel(width_px=64, height_px=64)
    inputs = [
        torch.from_numpy(INPUTS[kind].normalised(INPUTS[kind].of(depth_m, camera), camera))[None]
        for kind in ("depth", "depth-geometry")
    ]
    assert [second.shape[1] for second in inputs] == [1, 7]
    with torch.inference_mode():
        torch.testing.assert_close(wider(rgb, inputs[1]), model(rgb, inputs[0]))
    assert not wider.training
    with pytest.raises(ConfigError, match="'depth-geometry'"):
        with_geometry(wider)


@pytest.mark.parametrize(("block_px", "shape"), [(2, (120, 160)), (8, (60, 80))])
def test_a_score_is_for_4_pixels_or_for_the_larger_block_of_a_logit(block_px: int, shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(0)
    frame = {"rgb": rng.integers(0, 256, (480, 640, 3), dtype=np.uint8), "depth": np.full((480, 640), 2.0, np.float32)}
    segmenter = NetworkSegmenter(RedNet(SMALL).eval(), camera=CameraModel(), block_px=block_px)
    scores = segmenter.scores(frame, "sofa")
    posteriors = segmenter.posteriors(frame)
    assert scores.target.shape == shape
    assert posteriors.shape == (CLASSES, *shape)
    np.testing.assert_allclose(posteriors.sum(axis=0), 1.0, atol=1e-5)


def test_scores_of_smaller_blocks_than_those_of_the_logits_are_refused() -> None:
    with pytest.raises(ConfigError, match="score_block_px, got 8 and 4"):
        NetworkSegmenter(RedNet(SMALL).eval(), block_px=8, score_block_px=4)
