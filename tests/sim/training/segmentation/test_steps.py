"""The loss, the learning rate, and a network that is fitted to one view."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import torch
from torch.optim.swa_utils import AveragedModel

from sim.training.segmentation.samples import IGNORED
from sim.training.segmentation.steps import (
    MAX_RATIO,
    exponential_average,
    pyramid_loss,
    root_class_weights,
    set_normalisation,
)
from stubborn.segmentation.rednet import CLASSES, RedNet, RedNetConfig
from tests.helpers import wording

TINY = RedNetConfig(width=8, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1), final_blocks=1)


def test_the_loss_is_the_sum_of_the_cross_entropies_of_all_scales() -> None:
    torch.manual_seed(0)
    target = torch.randint(0, CLASSES, (2, 32, 32))
    target[:, :4] = IGNORED
    outputs = [torch.randn(2, CLASSES, 32 // k, 32 // k) for k in (1, 2, 4)]
    weights = torch.ones(CLASSES)
    by_hand = 0.0
    for k, out in zip((1, 2, 4), outputs, strict=True):
        small = target[:, k // 2 :: k, k // 2 :: k]
        log_p = out.log_softmax(dim=1)
        kept = small != IGNORED
        by_hand += float(-log_p.permute(0, 2, 3, 1)[kept].gather(1, small[kept][:, None]).mean())
    assert float(pyramid_loss(outputs, target, weights)) == pytest.approx(by_hand, rel=1e-5)


def test_the_loss_of_views_without_labels_is_zero() -> None:
    target = torch.full((1, 32, 32), IGNORED)
    out = torch.randn(1, CLASSES, 32, 32, requires_grad=True)
    loss = pyramid_loss([out], target, torch.ones(CLASSES))
    loss.backward()
    assert float(loss.detach()) == 0.0
    assert out.grad is not None
    assert torch.isfinite(out.grad).all()


def test_one_subpixel_gives_the_logits_and_the_loss_of_its_pixels() -> None:
    torch.manual_seed(0)
    model = RedNet(TINY).eval().requires_grad_(False)
    rgb, depth = torch.randn(2, 3, 64, 64), torch.randn(2, 1, 64, 64)
    target = torch.randint(0, CLASSES, (2, 64, 64))
    full = model.pyramid(rgb, depth)
    for row, column in itertools.product((0, 1), repeat=2):
        outputs = model.pyramid(rgb, depth, subpixel=(row, column))
        torch.testing.assert_close(outputs[0], full[0][:, :, row::2, column::2])
        loss = pyramid_loss(outputs[:1], target, torch.ones(CLASSES), subpixel=(row, column))
        alone = torch.nn.functional.cross_entropy(full[0][:, :, row::2, column::2], target[:, row::2, column::2])
        assert float(loss) == pytest.approx(float(alone), rel=1e-5)


def test_pixel_weights_count_pixels_more_often() -> None:
    torch.manual_seed(0)
    out, weights = torch.randn(1, CLASSES, 32, 32), torch.rand(CLASSES) + 0.5
    target = torch.randint(0, CLASSES, (1, 32, 32))
    target[:, :3] = IGNORED
    twice = torch.ones(1, 32, 32)
    twice[:, :, 16:] = 2.0
    doubled = torch.cat([out, out[..., 16:]], dim=-1), torch.cat([target, target[..., 16:]], dim=-1)
    expected = torch.nn.functional.cross_entropy(*doubled, weight=weights, ignore_index=IGNORED)
    assert float(pyramid_loss([out], target, weights, pixels=twice)) == pytest.approx(float(expected), rel=1e-5)
    even = pyramid_loss([out], target, weights, pixels=torch.ones(1, 32, 32))
    assert float(even) == pytest.approx(float(pyramid_loss([out], target, weights)), rel=1e-5)


def test_root_weights_fall_with_the_square_root_of_the_share_up_to_a_ratio() -> None:
    pixels = np.zeros(41)
    pixels[:5] = (1e6, 4e4, 1e4, 1.0, 0.0)  # void has no weight
    weights = root_class_weights(pixels)
    assert float(weights[1] / weights[0]) == pytest.approx(2.0)
    assert float(weights[2] / weights[0]) == pytest.approx(MAX_RATIO)
    assert float(weights[3]) == 0.0
    assert float(weights[:3].mean()) == pytest.approx(1.0)


def test_the_average_forgets_the_initial_weights_and_then_changes_slowly() -> None:
    network = torch.nn.Linear(1, 1, bias=False)
    network.register_buffer("batches", torch.tensor(0))
    torch.nn.init.constant_(network.weight, 100.0)
    average = AveragedModel(network, multi_avg_fn=exponential_average(0.999), use_buffers=True)
    torch.nn.init.constant_(network.weight, 1.0)
    for _ in range(100):
        network.get_buffer("batches").add_(1)
        average.update_parameters(network)
    assert average.module.get_parameter("weight").item() == pytest.approx(1.0, abs=0.01)
    assert average.module.get_buffer("batches").item() == 100
    average.n_averaged += 20000
    torch.nn.init.constant_(network.weight, 2.0)
    average.update_parameters(network)
    assert average.module.get_parameter("weight").item() == pytest.approx(1.001, abs=0.01)


def test_the_normalisation_becomes_that_of_the_given_views_and_the_weights_stay() -> None:
    torch.manual_seed(0)
    network = RedNet(TINY).eval()
    before = {name: value.clone() for name, value in network.named_parameters()}
    batches = [(torch.rand(4, 3, 32, 32) + shift, torch.rand(4, 1, 32, 32)) for shift in (0.0, 2.0)]
    set_normalisation(network, batches)
    assert not network.training
    assert all(torch.equal(value, before[name]) for name, value in network.named_parameters())
    layer = next(layer for layer in network.modules() if isinstance(layer, torch.nn.BatchNorm2d))
    assert layer.momentum == 0.1
    first = network.get_submodule("conv1")
    means = torch.stack([first(rgb).mean(dim=(0, 2, 3)) for rgb, _ in batches])
    assert layer.running_mean is not None
    assert torch.allclose(layer.running_mean, means.mean(dim=0), atol=1e-4)
    with pytest.raises(ValueError, match=wording.AT_LEAST_ONE_BATCH):
        set_normalisation(network, [])
