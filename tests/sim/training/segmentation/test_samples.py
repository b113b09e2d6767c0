"""Training samples: labels, windows, augmentation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from sim.core.interface import MPCAT40_ID, CameraModel, ConfigError
from sim.training.segmentation.dataset import LabelledView
from sim.training.segmentation.samples import (
    IGNORED,
    MAX_WEIGHT,
    NONE,
    SMALL_SHARE,
    Augmentation,
    Sampler,
    jitter_colour,
    jitter_depth,
    labels,
    pixel_weights,
    random_pixel,
    random_window,
    turn_hue,
)
from stubborn.segmentation.inputs import INPUTS
from tests.helpers import wording
from tests.helpers.labelled_views import a_view


def test_labels_are_channels_and_void_and_padding_are_ignored() -> None:
    semantic = np.array([[0, 1], [3, 40]], np.uint8)
    channel = labels(np.repeat(np.repeat(semantic, 16, axis=0), 16, axis=1))
    assert channel.shape == (32, 32)
    assert channel[0, 0] == IGNORED
    assert (channel[0, 31], channel[31, 0], channel[31, 31]) == (0, 2, 39)
    padded = labels(np.full((30, 32), 5, np.uint8))
    assert (padded[30:] == IGNORED).all()
    assert (padded[:30] == 4).all()


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


def test_jitter_changes_images_within_bounds_and_NONE_changes_nothing() -> None:
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


def test_windows_have_one_size_and_all_positions_and_scales() -> None:
    row, col = np.mgrid[0:60, 0:80].astype(np.uint8)
    depth = (1000 * row.astype(np.float32) + col)[..., None]
    spans, corners = [], []
    for seed in range(300):
        window = random_window(60, 80, 40, 0.0, np.random.default_rng(seed))
        rgb, semantic = window.colour(np.stack([row, row, row], axis=2)), window.nearest(col)
        cut = depth[window.cut]
        nearer = INPUTS["depth"].zoomed(cut, window.width_px, window.height_px, 40 / cut.shape[1])
        assert rgb.shape == (30, 40, 3)
        assert (rgb.dtype, nearer.dtype, semantic.dtype) == (np.uint8, np.float32, np.uint8)
        metres = np.round(nearer[..., 0] * (40 / cut.shape[1]))  # half the depth at twice the size
        assert (metres % 1000 == semantic).all()  # depth and labels are of the same pixels
        assert np.abs(rgb[..., 0] - metres // 1000).max() <= 1  # colour is an average around them
        spans.append(float(semantic[0, -1]) - semantic[0, 0])
        corners.append((metres[0, 0] // 1000, semantic[0, 0]))
    assert 38 <= min(spans) <= 41  # a cut-out
    assert 74 <= max(spans) <= 79  # the whole view
    assert np.median(spans) == pytest.approx(80 / np.sqrt(2), abs=4)  # a zoom in is as likely as one out
    assert np.min(corners, axis=0).tolist() == [0, 0]
    assert np.max(corners, axis=0).tolist() >= [25, 35]
    with pytest.raises(ConfigError, match=wording.N_80_COLUMNS_HAS_NO_WINDOW_OF_81):
        random_window(60, 80, 81, 0.0, np.random.default_rng(0))


def test_a_share_of_the_windows_is_the_whole_view() -> None:
    col = np.mgrid[0:60, 0:80].astype(np.uint8)[1]
    windows = [random_window(60, 80, 40, 0.6, np.random.default_rng(seed)).nearest(col) for seed in range(300)]
    whole = np.mean([window[0, 0] == 0 and window[0, -1] >= 78 for window in windows])
    assert whole == pytest.approx(0.6, abs=0.09)


def test_a_window_around_a_pixel_shows_it() -> None:
    semantic = np.full((60, 80), MPCAT40_ID["wall"], np.uint8)
    semantic[55:58, 2:5] = MPCAT40_ID["stool"]
    for seed in range(300):
        rng = np.random.default_rng(seed)
        pixel = random_pixel(semantic == MPCAT40_ID["stool"], rng)
        assert pixel is not None
        rows, cols = random_window(60, 80, 40, 0.0, rng, shown=pixel).cut
        assert 0 <= rows.start <= pixel[0] < rows.stop <= 60
        assert 0 <= cols.start <= pixel[1] < cols.stop <= 80
    assert random_pixel(np.zeros((4, 4), np.bool_), np.random.default_rng(0)) is None


def test_a_sampler_of_windows_pads_them_for_the_network() -> None:
    rgb, depth, target = Sampler(CameraModel(), 1, Augmentation(), 48)(a_view(), np.random.default_rng(0))[:3]
    assert rgb.shape == (3, 32, 64)
    assert depth.shape == (1, 32, 64)
    assert (target[:, :8] == IGNORED).all()  # 48 x 32 pixels in the middle of 64 x 32
    assert (target[:, 8:56] != IGNORED).any()


def test_rotating_the_hue_keeps_greys_and_brightness_and_permutes_primaries_after_a_third() -> None:
    image = np.array([[[10.0, 10.0, 10.0], [200.0, 0.0, 0.0]]], np.float32)
    turned = turn_hue(image, 2 * np.pi / 3)
    assert turned[0, 0] == pytest.approx([10, 10, 10], abs=1e-3)
    assert sorted(turned[0, 1].round(3).tolist()) == [0, 0, 200]
    assert turned[0, 1, 0] == pytest.approx(0.0, abs=1e-3)
    assert turn_hue(image, 0.4).sum(axis=2) == pytest.approx(image.sum(axis=2), rel=1e-5)
    assert turn_hue(turn_hue(image, 0.4), -0.4) == pytest.approx(image, abs=1e-3)


def test_a_whole_view_in_training_has_the_distances_of_the_view_that_the_network_will_see() -> None:
    view, rng = a_view(), np.random.default_rng(0)
    for block_px in (1, 2):
        used = Sampler(CameraModel(), block_px)(view, rng)[1]
        trained = Sampler(CameraModel(), 1, NONE, view.rgb.shape[1] // block_px, 1.0, used_block_px=block_px)(
            view, rng
        )[1]
        assert trained.mean() == pytest.approx(float(used.mean()), abs=0.02)


def with_instances() -> LabelledView:
    """A chair of a 32nd of the view on its left and a floor; the floor is an instance as well."""
    view = a_view()
    instances = np.full(view.semantic.shape, 2, np.uint16)
    semantic = np.full(view.semantic.shape, MPCAT40_ID["floor"], np.uint8)
    semantic[:8, :24], instances[:8, :24] = MPCAT40_ID["chair"], 1
    return replace(view, semantic=semantic, instances=instances)


def test_pixels_of_small_objects_weigh_more_and_surfaces_do_not() -> None:
    view = with_instances()
    weights = pixel_weights(view, 1)
    assert weights[0, 0] == pytest.approx((SMALL_SHARE * 32) ** 0.5)
    assert (weights[view.semantic == MPCAT40_ID["floor"]] == 1.0).all()
    assert view.instances is not None
    tiny = replace(view, instances=np.where(view.instances == 1, np.arange(96, dtype=np.uint16) + 3, 2).astype("u2"))
    assert pixel_weights(tiny, 1)[0, 0] == MAX_WEIGHT
    with pytest.raises(ConfigError, match=wording.HAS_NO_INSTANCES):
        pixel_weights(a_view(), 1)


def test_a_window_shows_the_object_that_was_drawn_with_weights_of_its_size_in_the_view() -> None:
    sampler = Sampler(CameraModel(), 1, Augmentation(), window_px=32, area_weights=True)
    for seed in range(20):
        target, weights = sampler(with_instances(), np.random.default_rng(seed), instance=1)[-2:]
        chair = target == MPCAT40_ID["chair"] - 1
        assert chair.any()
        assert weights.shape == target.shape
        np.testing.assert_allclose(weights[chair], (SMALL_SHARE * 32) ** 0.5, rtol=1e-6)
        assert (weights[target == MPCAT40_ID["floor"] - 1] == 1.0).all()


def test_a_share_of_the_samples_is_grey() -> None:
    rgb = np.random.default_rng(0).integers(0, 255, (8, 8, 3), np.uint8)
    some = replace(NONE, grey=0.25)
    grey = [np.ptp(jitter_colour(rgb, some, np.random.default_rng(seed)), axis=2).max() == 0 for seed in range(400)]
    assert 0.18 < np.mean(grey) < 0.32
