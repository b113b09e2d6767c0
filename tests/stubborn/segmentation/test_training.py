"""Samples, loss, learning rate and what is measured of a network."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
import torch

from sim.interface import MPCAT40_ID, CameraModel, ConfigError
from stubborn.segmentation.dataset import LabelledView
from stubborn.segmentation.rednet import CLASSES, RedNet, RedNetConfig
from stubborn.segmentation.training import (
    GOAL_CHANNELS,
    IGNORED,
    NONE,
    Augmentation,
    Iou,
    Reliability,
    Sampler,
    confusion,
    fit_temperature,
    jitter_colour,
    jitter_depth,
    labels,
    learning_rate,
    pyramid_loss,
    random_window,
    turn_hue,
)

TINY = RedNetConfig(width=8, encoder_blocks=(1, 1, 1, 1), bottleneck=False, decoder_blocks=(1, 1, 1, 1), final_blocks=1)


def a_view(height: int = 64, width: int = 96) -> LabelledView:
    """Chair on the left third, floor elsewhere, a void row on top; colour and depth follow the labels."""
    semantic = np.full((height, width), MPCAT40_ID["floor"], np.uint8)
    semantic[:, : width // 3] = MPCAT40_ID["chair"]
    semantic[0] = 0
    rgb = np.repeat(np.where(semantic == MPCAT40_ID["chair"], 220, 40).astype(np.uint8)[..., None], 3, axis=2)
    depth = np.where(semantic == MPCAT40_ID["chair"], 1.0, 3.0).astype(np.float32)
    return LabelledView("v", rgb, depth, semantic)


def test_labels_are_channels_and_void_and_padding_do_not_count() -> None:
    semantic = np.array([[0, 1], [3, 40]], np.uint8)
    channel = labels(np.repeat(np.repeat(semantic, 16, axis=0), 16, axis=1))
    assert channel.shape == (32, 32)
    assert channel[0, 0] == IGNORED
    assert (channel[0, 31], channel[31, 0], channel[31, 31]) == (0, 2, 39)
    padded = labels(np.full((30, 32), 5, np.uint8))
    assert (padded[0] == IGNORED).all()
    assert (padded[1:31] == 4).all()


def test_a_mirrored_sample_is_mirrored_in_all_its_images() -> None:
    sampler = Sampler(CameraModel(), 1, replace(NONE, mirror=True))
    plain = Sampler(CameraModel(), 1, NONE)(a_view(), np.random.default_rng(0))
    seen = set()
    for seed in range(12):
        sample = sampler(a_view(), np.random.default_rng(seed))
        same = [torch.equal(a, b) for a, b in zip(sample, plain, strict=True)]
        turned = [torch.equal(a, b.flip(-1)) for a, b in zip(sample, plain, strict=True)]
        assert all(same) or all(turned)
        seen.add(all(turned))
    assert seen == {True, False}


def test_jitter_changes_images_within_bounds_and_none_changes_nothing() -> None:
    rng = np.random.default_rng(0)
    view = a_view()
    assert jitter_colour(view.rgb, NONE, rng) is view.rgb
    assert jitter_depth(view.depth_m, NONE, rng) is view.depth_m
    a = Augmentation(noise_rgb=0.0)
    means = [jitter_colour(view.rgb, a, np.random.default_rng(i)).mean() / view.rgb.mean() for i in range(200)]
    assert 0.6 < min(means) < 0.8
    assert 1.2 < max(means) < 1.45
    sigma = np.std(jitter_depth(view.depth_m, Augmentation(holes=0), np.random.default_rng(3))[view.depth_m == 3.0])
    assert 0 < sigma <= 2 * 0.0012 * 9.0 * 1.1
    holes = [(jitter_depth(view.depth_m, a, np.random.default_rng(i)) == 0).mean() for i in range(50)]
    assert min(holes) == 0.0
    assert 0.01 < max(holes) < 0.25


def test_windows_have_one_size_lie_anywhere_and_come_in_all_scales() -> None:
    row, col = np.mgrid[0:60, 0:80].astype(np.uint8)
    depth = (1000 * row.astype(np.float32)) + col
    spans, corners = [], []
    for seed in range(300):
        rgb, depth_m, semantic = random_window(
            np.stack([row, row, row], axis=2), depth, col, 40, 0.0, np.random.default_rng(seed)
        )
        assert rgb.shape == (30, 40, 3)
        assert (rgb.dtype, depth_m.dtype, semantic.dtype) == (np.uint8, np.float32, np.uint8)
        assert (depth_m % 1000 == semantic).all()  # depth and labels are of the same pixels
        assert np.abs(rgb[..., 0] - depth_m // 1000).max() <= 1  # colour is an average around them
        spans.append(float(semantic[0, -1]) - semantic[0, 0])
        corners.append((depth_m[0, 0] // 1000, semantic[0, 0]))
    assert 38 <= min(spans) <= 41  # a cut-out
    assert 74 <= max(spans) <= 79  # the whole view
    assert np.median(spans) == pytest.approx(80 / np.sqrt(2), abs=4)  # a zoom in is as likely as one out
    assert np.min(corners, axis=0).tolist() == [0, 0]
    assert np.max(corners, axis=0).tolist() >= [25, 35]
    with pytest.raises(ConfigError, match="80 columns has no window of 81"):
        random_window(np.stack([row, row, row], axis=2), depth, col, 81, 0.0, np.random.default_rng(0))


def test_a_share_of_the_windows_is_the_whole_view() -> None:
    row, col = np.mgrid[0:60, 0:80].astype(np.uint8)
    rgb, depth = np.stack([row, row, row], axis=2), row.astype(np.float32)
    windows = [random_window(rgb, depth, col, 40, 0.6, np.random.default_rng(seed))[2] for seed in range(300)]
    whole = np.mean([window[0, 0] == 0 and window[0, -1] >= 78 for window in windows])
    assert whole == pytest.approx(0.6, abs=0.09)


def test_a_sampler_of_windows_gives_what_a_network_takes() -> None:
    rgb, depth, target = Sampler(CameraModel(), 1, Augmentation(), 48)(a_view(), np.random.default_rng(0))
    assert rgb.shape == (3, 32, 64)
    assert depth.shape == (1, 32, 64)
    assert (target[:, :8] == IGNORED).all()  # 48 x 32 pixels in the middle of 64 x 32
    assert (target[:, 8:56] != IGNORED).any()


def test_turning_the_hue_keeps_greys_and_brightness_and_swaps_primaries_after_a_third() -> None:
    image = np.array([[[10.0, 10.0, 10.0], [200.0, 0.0, 0.0]]], np.float32)
    turned = turn_hue(image, 2 * np.pi / 3)
    assert turned[0, 0] == pytest.approx([10, 10, 10], abs=1e-3)
    assert sorted(turned[0, 1].round(3).tolist()) == [0, 0, 200]
    assert turned[0, 1, 0] == pytest.approx(0.0, abs=1e-3)
    assert turn_hue(image, 0.4).sum(axis=2) == pytest.approx(image.sum(axis=2), rel=1e-5)
    assert turn_hue(turn_hue(image, 0.4), -0.4) == pytest.approx(image, abs=1e-3)


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


def test_views_without_any_label_give_no_loss_and_no_nan() -> None:
    target = torch.full((1, 32, 32), IGNORED)
    out = torch.randn(1, CLASSES, 32, 32, requires_grad=True)
    loss = pyramid_loss([out], target, torch.ones(CLASSES))
    loss.backward()
    assert float(loss.detach()) == 0.0
    assert out.grad is not None
    assert torch.isfinite(out.grad).all()


def test_the_rate_rises_to_its_peak_and_falls_like_a_cosine() -> None:
    rates = [learning_rate(step, 1000, peak=1.0, warmup=100) for step in range(1001)]
    assert rates[0] == pytest.approx(0.01)
    assert max(rates) == pytest.approx(1.0)
    assert rates.index(max(rates)) in (99, 100)
    assert all(a >= b for a, b in itertools.pairwise(rates[100:]))
    assert rates[550] == pytest.approx(0.01 + 0.99 / 2)
    assert rates[1000] == pytest.approx(0.01)


def test_iou_by_hand() -> None:
    wall, chair, sofa = (MPCAT40_ID[name] - 1 for name in ("wall", "chair", "sofa"))
    truth = np.array([wall, wall, wall, chair, chair, sofa, IGNORED])
    predicted = np.array([wall, wall, chair, chair, sofa, sofa, wall])
    iou = Iou.of(confusion(predicted, truth))
    assert iou.by_category == pytest.approx({"wall": 2 / 3, "chair": 1 / 3, "sofa": 1 / 2})
    assert iou.goals == pytest.approx((1 / 3 + 1 / 2) / 2)
    assert iou.everything == pytest.approx((2 / 3 + 1 / 3 + 1 / 2) / 3)
    assert iou.accuracy == pytest.approx(4 / 6)


def test_a_calibrated_score_has_no_calibration_error_and_a_boasting_one_has() -> None:
    rng = np.random.default_rng(0)
    channel, p = int(GOAL_CHANNELS[0]), 0.7
    truth = np.where(rng.random(20_000) < p, channel, 0)
    probability = np.zeros((CLASSES, truth.size), np.float32)
    probability[channel] = p
    honest, boasting = Reliability.empty(), Reliability.empty()
    honest.add(probability, truth)
    probability[channel] = 0.95
    boasting.add(probability, truth)
    assert honest.error < 0.01
    assert boasting.error == pytest.approx(0.25, abs=0.01)
    ((count, score, right),) = honest.rows()
    assert (count, score) == (20_000, pytest.approx(0.7))
    assert right == pytest.approx(0.7, abs=0.01)


def test_the_temperature_of_overconfident_logits_is_found() -> None:
    torch.manual_seed(0)
    honest = torch.randn(5000, 5)
    truth = torch.distributions.Categorical(logits=honest).sample()
    assert fit_temperature(3.0 * honest, truth) == pytest.approx(3.0, rel=0.08)


def test_a_tiny_network_learns_a_view_by_heart() -> None:
    torch.manual_seed(0)
    model = RedNet(TINY)
    rgb, depth, target = (
        t[None].repeat(2, *[1] * t.dim()) for t in Sampler(CameraModel())(a_view(), np.random.default_rng(0))
    )
    optimiser = torch.optim.AdamW(model.parameters(), lr=1e-2)
    for _ in range(25):
        optimiser.zero_grad()
        loss = pyramid_loss(model.pyramid(rgb, depth), target, torch.ones(CLASSES))
        loss.backward()
        optimiser.step()
    model.eval()
    iou = Iou.of(confusion(model(rgb, depth).argmax(1).numpy(), target.numpy()))
    assert iou.accuracy > 0.85
