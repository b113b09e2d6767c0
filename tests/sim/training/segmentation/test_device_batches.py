"""Samples computed on a device are those of `Sampler`: here the device is the processor, with the same functions."""

from __future__ import annotations

import functools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.core.interface import MPCAT40_ID, CameraModel, ConfigError
from sim.houses.labels import Instance
from sim.training.segmentation import samples
from sim.training.segmentation.balanced import Batches, ViewIndex
from sim.training.segmentation.dataset import list_shards
from sim.training.segmentation.device_batches import DeviceBatches, Windows, jitter_colour, jitter_depth, room_for
from sim.training.segmentation.recipe import PROGRESSIVE, Phase, Recipe
from sim.training.segmentation.samples import IGNORED, NONE, Augmentation, Sampler, Window
from sim.training.views.coco import annotate
from sim.training.views.shards import write_shard
from sim.training.views.views import View
from stubborn.segmentation.inputs import InputKind
from tests.helpers import wording

CPU = torch.device("cpu")
OBJECTS = Recipe(phases=(Phase(share=1.0, widths=(1.0,), whole_share=0.0),), object_share=1.0)
"""Every sample is a window that shows an object."""


def random_view(number: int) -> View:
    """A view of smooth colours and surfaces, with a small chair at a random place."""
    rng = np.random.default_rng(number)
    y, x = np.mgrid[:48, :64]
    rgb = np.stack([120 + 100 * np.sin(0.1 * x + phase) for phase in rng.uniform(0, 6, 3)], axis=2).astype(np.uint8)
    depth = (1500 + 20 * x + 9 * y + rng.integers(0, 40, (48, 64))).astype(np.uint16)
    depth[rng.random((48, 64)) < 0.1] = 0
    top, left = int(rng.integers(0, 38)), int(rng.integers(0, 54))
    semantic = np.full((48, 64), MPCAT40_ID["wall"], np.uint8)
    semantic[rng.random((48, 64)) < 0.05] = 0
    ids = np.zeros((48, 64), np.uint16)
    cut = slice(top, top + 8), slice(left, left + 8)
    semantic[cut], ids[cut] = MPCAT40_ID["chair"], 1
    annotations = annotate(ids, [Instance("chair_00", "chair", (0,))], {"chair_00": "plain"})
    return View(f"v{number:05d}", rgb, depth, semantic, {"house": "h"}, instances=ids, annotations=annotations)


@pytest.fixture
def index(tmp_path: Path) -> ViewIndex:
    write_shard(tmp_path, "views-000000", map(random_view, range(12)), house="h", config={}, rgb_format="png")
    return ViewIndex.of(list_shards(tmp_path))


def windows_of(count: int, top: int, left: int, rows: int, cols: int) -> Windows:
    """The same window of `count` views."""
    full = functools.partial(torch.full, (count,))
    return Windows(full(top), full(left), full(rows), full(cols), (48, 64))


def batches_of(
    index: ViewIndex, augmentation: Augmentation, *, second: InputKind = "depth-geometry", recipe: Recipe = PROGRESSIVE
) -> DeviceBatches:
    sampler = Sampler(CameraModel(), 1, augmentation, second=second, used_block_px=2, area_weights=True)
    return DeviceBatches(index, sampler, recipe, batch=4, seed=0, device=CPU)


@pytest.mark.parametrize("second", ["depth", "geometry", "depth-geometry"])
@pytest.mark.parametrize("cols", [64, 44, 32])
def test_without_augmentation_a_window_is_that_of_the_sampler(
    index: ViewIndex, second: InputKind, cols: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    batches, rows, size_px = batches_of(index, NONE, second=second), cols * 3 // 4, (24, 32)
    top, left = 48 - rows, (64 - cols) // 2
    windows = windows_of(12, top, left, rows, cols)
    computed = batches.samples(torch.arange(12), windows, size_px, torch.Generator())
    window = Window((slice(top, top + rows), slice(left, left + cols)), 32, 24)
    monkeypatch.setattr(samples, "random_window", lambda *_, **__: window)
    sampler = replace(batches.sampler, window_px=32)
    expected = [sampler(view.read(), np.random.default_rng(0)) for view in index.views]
    for i, part in enumerate(zip(*expected, strict=True)):
        tolerance = (0.05, 1e-4, 0.0, samples.MAX_WEIGHT / 255)[i]
        assert torch.allclose(computed[i].double(), torch.stack(list(part)).double(), rtol=0.0, atol=tolerance), i


def test_windows_show_the_object_that_was_drawn_and_are_the_same_for_the_same_step(index: ViewIndex) -> None:
    batches = batches_of(index, Augmentation(), recipe=OBJECTS)
    chair = MPCAT40_ID["chair"] - 1
    for step in range(20):
        rgb, second, target, weights = batches[step, 0.5]
        assert (target == chair).flatten(1).any(dim=1).all(), step
        assert [part.shape[1:] for part in (rgb, second, weights)] == [(3, 32, 32), (7, 32, 32), (32, 32)]
        assert all(torch.equal(a, b) for a, b in zip((rgb, second, target, weights), batches[step, 0.5], strict=True))
    assert not torch.equal(batches[0, 0.5][0], batches[1, 0.5][0])


@pytest.mark.costly
@pytest.mark.parametrize("whole_share", [0.0, 0.5, 1.0])
def test_statistics_of_augmented_samples_are_those_of_the_sampler(index: ViewIndex, whole_share: float) -> None:
    recipe = Recipe(phases=(Phase(share=1.0, widths=(1.0,), whole_share=whole_share),))
    ours = batches_of(index, Augmentation(), recipe=recipe)
    reference = Batches(index, ours.sampler, recipe, batch=4, seed=0)
    parts = [[batches[step, 0.5] for step in range(60)] for batches in (ours, reference)]
    for channel, name in enumerate(("colour", "second input", "labels", "weights")):
        a, b = (torch.cat([sample[channel][..., 4:-4, :].float() for sample in each]) for each in parts)
        if name == "labels":
            a, b = a[a != IGNORED], b[b != IGNORED]
        assert abs(float(a.mean() - b.mean())) < 0.15 * float(b.std()), name
        assert float(a.std()) == pytest.approx(float(b.std()), rel=0.15), name


def test_a_mirrored_sample_mirrors_colour_labels_weights_and_turns_the_normal(index: ViewIndex) -> None:
    batches, mirrored = batches_of(index, NONE), batches_of(index, replace(NONE, mirror=True))
    views = torch.zeros(40, dtype=torch.int64)
    windows = windows_of(40, 0, 0, 48, 64)
    plain = batches.samples(views, windows, (24, 32), torch.Generator().manual_seed(0))
    other = mirrored.samples(views, windows, (24, 32), torch.Generator().manual_seed(0))
    flipped = ~(plain[2] == other[2]).flatten(1).all(dim=1)
    assert 8 < int(flipped.sum()) < 32
    for i in (0, 2, 3):
        assert torch.equal(other[i][flipped], plain[i][flipped].flip(-1)), i
        assert torch.equal(other[i][~flipped], plain[i][~flipped]), i
    right = 1 + 3  # after the depth: inverse depth, valid, height, then the normal's component to the right
    assert torch.allclose(other[1][flipped, right], -plain[1][flipped, right].flip(-1))


def test_holes_have_no_depth_and_noise_grows_with_the_distance() -> None:
    random, depth_m = torch.Generator().manual_seed(0), torch.full((64, 60, 80), 2.0)
    depth_m[:, :, 40:] = 4.0
    holes = jitter_depth(depth_m, replace(NONE, holes=6), random) == 0.0
    assert 0.02 < float(holes.float().mean()) < 0.1
    assert (~holes.flatten(1).any(dim=1)).any(), "some samples have no hole"
    noisy = jitter_depth(depth_m, replace(NONE, depth_noise=0.0012), random) - depth_m
    assert float(noisy[..., 40:].std() / noisy[..., :40].std()) == pytest.approx(4.0, rel=0.02)


def test_a_tenth_of_the_samples_is_grey() -> None:
    image = torch.rand((400, 3, 8, 8), generator=torch.Generator().manual_seed(1)) * 200
    grey = jitter_colour(image, replace(NONE, grey=0.1), torch.Generator().manual_seed(0))
    share = (grey.amax(dim=1) == grey.amin(dim=1)).flatten(1).all(dim=1).float().mean()
    assert 0.05 < float(share) < 0.16


def test_an_index_without_goals_ends_with_a_sentence() -> None:
    with pytest.raises(ConfigError, match=wording.NO_VIEW_SHOWS_AN_OBJECT):
        batches_of(ViewIndex((), {}), NONE)


def test_room_for_views_is_the_free_memory_without_that_of_the_training(
    index: ViewIndex, monkeypatch: pytest.MonkeyPatch
) -> None:
    of_a_view = 48 * 64 * 9
    for free, expected in (((4 << 30) + 10 * of_a_view, 10), ((4 << 30) + of_a_view - 1, 0), (1 << 30, 0)):
        monkeypatch.setattr(torch.cuda, "mem_get_info", lambda _, free=free: (free, 80 << 30))
        assert room_for(index.views, torch.device("cuda")) == expected
