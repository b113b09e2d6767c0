"""The second head of a network: everyday names within the categories, in frames and as scores of a wish."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from sim.core.geometry.grid import GridFrame
from sim.core.interface import MPCAT40_ID, CameraModel, ConfigError
from stubborn.detection.attributes import Attributes
from stubborn.detection.tracks import Pixels
from stubborn.detection.wished import WishedSegmenter
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.names import NameGroups
from stubborn.segmentation.network import NetworkSegmenter
from stubborn.segmentation.networks import without_names
from stubborn.segmentation.rednet import RedNet
from tests.stubborn.segmentation.test_network import TINY

NAMES = ("fridge", "cooker", "laptop", "monitor")
APPLIANCES = MPCAT40_ID["appliances"] - 1
CAMERA = CameraModel(width_px=128, height_px=96)


def frame() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    rgb = rng.integers(0, 256, (96, 128, 3), dtype=np.uint8)
    return {"rgb": rgb, "depth": rng.uniform(0.5, 5.0, (96, 128)).astype(np.float32)}


@pytest.fixture
def network() -> RedNet:
    torch.manual_seed(0)
    return RedNet(replace(TINY, names=NAMES)).eval()


def test_names_share_the_probability_of_their_category():
    groups = NameGroups.of(NAMES)
    posteriors = np.zeros((40, 4, 4), np.float32)
    posteriors[APPLIANCES], posteriors[MPCAT40_ID["tv_monitor"] - 1] = 0.6, 0.3
    logits = np.log(np.array([3.0, 1.0, 1.0, 3.0], np.float32))[:, None, None].repeat(2, 1).repeat(2, 2)
    fridge, cooker, laptop, monitor = groups.probabilities(logits, posteriors)[:, 0, 0]
    assert (fridge, cooker) == pytest.approx((0.45, 0.15))
    assert (laptop, monitor) == pytest.approx((0.3 / 4, 0.9 / 4))  # no pixel is of `objects`, where a laptop may be


def test_a_name_that_no_house_has_is_refused():
    with pytest.raises(ConfigError, match="'spaceship' is not in the vocabulary"):
        NameGroups.of(("fridge", "spaceship"))


def test_the_head_changes_no_posterior_and_survives_a_file(network: RedNet, tmp_path: Path):
    save_network(tmp_path / "w.safetensors", network, {"block_px": 2})
    loaded, _ = load_network(tmp_path / "w.safetensors")
    segmenter, seen = NetworkSegmenter(loaded, camera=CAMERA, mirrored=True), frame()
    plain = NetworkSegmenter(without_names(loaded), camera=CAMERA, mirrored=True)
    np.testing.assert_allclose(segmenter.posteriors(seen), plain.posteriors(seen), atol=1e-6)
    named = segmenter.named(seen)
    assert named is not None
    image, names = named
    assert names == NAMES
    assert image.shape == (4, 12, 16)
    of_category = segmenter.posteriors(seen)[APPLIANCES, 1::2, 1::2]
    np.testing.assert_allclose(image[:2].sum(axis=0), of_category, atol=1e-5)
    assert plain.named(seen) is None


def test_a_wish_scores_where_its_name_is_probable(network: RedNet):
    segmenter, seen = WishedSegmenter(NetworkSegmenter(network, camera=CAMERA), CAMERA), frame()
    scores = {}
    for goal in ("the fridge", "the cooker", "dishwasher"):
        segmenter.ask(goal)
        scores[goal] = segmenter.scores(seen, segmenter.category).target
    whole = segmenter.posteriors(seen)[APPLIANCES]
    np.testing.assert_allclose(scores["the fridge"] + scores["the cooker"], whole, atol=1e-4)
    np.testing.assert_allclose(scores["dishwasher"], whole, atol=1e-6)  # a name that the head has not learned


def test_names_of_a_camera_without_whole_cells_have_the_posteriors_resolution(network: RedNet):
    camera, seen = replace(CAMERA, height_px=100), frame()
    seen = {name: np.pad(image, ((0, 4), *((0, 0),) * (image.ndim - 1)), mode="edge") for name, image in seen.items()}
    segmenter = WishedSegmenter(NetworkSegmenter(network, camera=camera), camera)
    shape = segmenter.posteriors(seen).shape[1:]
    assert shape == (25, 32)
    named = segmenter.named(seen, shape)
    assert named is not None
    assert named[0].shape == (4, 25, 32)
    segmenter.ask("the fridge")
    assert segmenter.scores(seen, segmenter.category).target.shape == shape


def test_a_segmenter_may_guess_finer_names_and_names_that_no_house_has():
    class Guesses:
        camera = CAMERA

        def scores(self, observation, goal):
            raise NotImplementedError

        def categories(self, observation):
            raise NotImplementedError

        def posteriors(self, observation):
            return np.full((40, 12, 16), 1 / 40, np.float32)

        def named(self, observation):
            return np.full((3, 24, 32), 1 / 80, np.float32), ("fridge", "cooker", "spaceship")

    segmenter = WishedSegmenter(Guesses(), CAMERA)  # type: ignore[arg-type]
    segmenter.ask("the fridge")
    np.testing.assert_allclose(segmenter.scores(frame(), segmenter.category).target, 0.5 / 40, rtol=1e-4)


def test_a_track_has_the_names_of_its_pixels():
    attributes, nowhere = Attributes(GridFrame.around_start(20, 0.1), 8), np.full((8, 8), -1)
    track = np.zeros((8, 8), np.int16)
    track[:, :4], track[:4, 4:] = 1, 2
    image = np.zeros((3, 2, 2), np.float32)
    image[:, :, 0] = np.array([0.6, 0.2, 0.0])[:, None]
    image[:, 0, 1] = (0.0, 0.0, 0.7)
    names = ("fridge", "cooker", "spaceship")
    attributes.add(Pixels(track, nowhere, nowhere, np.zeros((8, 8))), np.zeros((40, 8, 8), np.float32), None, None,
                   (image, names))  # fmt: skip
    assert [attributes.name_of(number) for number in (1, 2, 3)] == ["fridge", "spaceship", ""]

    class Unmerged:
        def now(self) -> np.ndarray:
            return np.arange(8)

    def shares(*wanted: str) -> list[float]:
        return attributes.name_shares(Unmerged(), np.array([1, 2]), frozenset(wanted)).tolist()  # type: ignore[arg-type]

    assert shares("fridge") == pytest.approx([0.75, 0.0])
    assert shares("fridge", "cooker") == pytest.approx([1.0, 0.0])
    assert shares("fridge", "dishwasher") == [1.0, 1.0]  # it has not learned dishwashers
