"""The networks by name: shapes, files, averaging of batch normalisation, ImageNet weights."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.core.interface import CameraModel, ConfigError
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.inputs import INPUTS
from stubborn.segmentation.network import NetworkSegmenter
from stubborn.segmentation.networks import NETWORKS, build_network, with_geometry
from stubborn.segmentation.rednet import CLASSES, RedNet, RedNetConfig, folded
from stubborn.segmentation.unet import UNetConfig
from tests.helpers import wording

SMALL = {
    "dense": UNetConfig(widths=(4, 4, 8, 8, 8), blocks=(1, 1, 1, 1), decoder=(4, 4, 8, 8)),
    "lite0": UNetConfig(encoder="lite0", widths=(4, 4, 4, 4, 4), decoder=(4, 4, 4, 4)),
}


@pytest.mark.parametrize("name", [name for name in NETWORKS if name != "published"])
def test_every_network_gives_a_logit_of_each_class_for_each_pixel(name: str) -> None:
    model = build_network(NETWORKS[name]).eval()
    second = torch.randn(1, INPUTS[model.config.second].channels, 64, 96)
    with torch.inference_mode():
        outputs = model.pyramid(torch.randn(1, 3, 64, 96), second)
        assert model(torch.randn(1, 3, 64, 96), second).shape == (1, CLASSES, 64, 96)
    assert outputs[0].shape == (1, CLASSES, 64 // model.stride_px, 96 // model.stride_px)
    assert [out.shape[-1] for out in outputs] == sorted((out.shape[-1] for out in outputs), reverse=True)


@pytest.mark.parametrize("kind", SMALL)
def test_a_u_net_is_stored_with_its_configuration(tmp_path: Path, kind: str) -> None:
    model = build_network(SMALL[kind]).eval()
    save_network(tmp_path / "net.safetensors", model, {"block_px": 2})
    loaded, metadata = load_network(tmp_path / "net.safetensors")
    rgb, second = torch.randn(1, 3, 32, 64), torch.randn(1, 6, 32, 64)
    assert loaded.config == model.config
    assert metadata == {"block_px": 2}
    for name, tensor in model.state_dict().items():
        assert torch.equal(loaded.state_dict()[name], tensor.half().to(tensor.dtype))
    with torch.inference_mode():
        torch.testing.assert_close(loaded(rgb, second), model(rgb, second), rtol=0.0, atol=0.01)


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


@pytest.mark.parametrize("kind", SMALL)
def test_folding_batch_normalisation_keeps_the_output(kind: str) -> None:
    torch.manual_seed(0)
    model = build_network(SMALL[kind])
    rgb, second = torch.randn(2, 3, 64, 64), torch.randn(2, 6, 64, 64)
    for _ in range(3):
        model(rgb, second)  # statistics that differ from the initial ones
    model.eval()
    with torch.inference_mode():
        torch.testing.assert_close(folded(model)(rgb, second), model(rgb, second), rtol=1e-3, atol=1e-4)


def test_the_second_input_of_a_u_net_counts() -> None:
    model = build_network(SMALL["lite0"]).eval()
    rgb = torch.randn(1, 3, 32, 32)
    with torch.inference_mode():
        assert not torch.equal(model(rgb, torch.zeros(1, 6, 32, 32)), model(rgb, torch.ones(1, 6, 32, 32)))


def test_the_scores_of_a_u_net_have_the_resolution_of_its_logits() -> None:
    rng = np.random.default_rng(0)
    frame = {"rgb": rng.integers(0, 256, (480, 640, 3), dtype=np.uint8), "depth": np.full((480, 640), 2.0, np.float32)}
    segmenter = NetworkSegmenter(build_network(SMALL["dense"]).eval(), camera=CameraModel(), block_px=2)
    scores = segmenter.scores(frame, "sofa")
    posteriors = segmenter.posteriors(frame)
    assert scores.target.shape == (120, 160)
    assert posteriors.shape == (CLASSES, 120, 160)
    np.testing.assert_allclose(posteriors.sum(axis=0), 1.0, atol=1e-5)
    with pytest.raises(ConfigError, match=wording.MULTIPLE_OF_THE_BLOCK_OF_ONE_LOGIT_8_PIXELS):
        NetworkSegmenter(build_network(SMALL["dense"]).eval(), block_px=4, score_block_px=4)


def test_an_unknown_encoder_is_refused() -> None:
    with pytest.raises(ConfigError, match="lite0"):
        replace(SMALL["dense"], encoder="vgg")
