"""The measures of a track's shape, and the features of which its log-odds are a linear function."""

from __future__ import annotations

import numpy as np
import pytest

from stubborn.detection.shape import FEATURES, MEASURES, features_of
from stubborn.kernels.tracks import shapes_of

EDGE_M = 0.1
SHAPE = (20, 20, 22)


def measures(*boxes: tuple[slice, slice, slice]) -> dict[str, float]:
    """Returns the measures of a track that owns the voxels of some boxes."""
    volume = np.zeros(SHAPE, np.int16)
    for box in boxes:
        volume[box] = 3
    voxels = np.argwhere(volume == 3)
    low, high = voxels.min(axis=0)[None], voxels.max(axis=0)[None]
    found = shapes_of(volume.reshape(-1), np.array([3]), low, high, SHAPE, EDGE_M)
    return dict(zip(MEASURES, found[0].tolist(), strict=True))


def test_a_picture_is_thin_upright_and_hangs():
    found = measures((slice(4, 5), slice(5, 13), slice(12, 18)))
    assert found == pytest.approx(
        {"bottom_m": 1.2, "top_m": 1.8, "long_m": 0.8, "short_m": 0.1, "upright_m": 0.6, "flat_share": 0.0}, abs=1e-5
    )


def test_the_top_of_a_table_is_flat_and_its_extents_do_not_depend_on_its_heading():
    found = measures((slice(2, 8), slice(3, 15), slice(7, 8)))
    assert found == pytest.approx(
        {"bottom_m": 0.7, "top_m": 0.8, "long_m": 1.2, "short_m": 0.6, "upright_m": 0.1, "flat_share": 1.0}, abs=1e-5
    )
    volume = np.zeros(SHAPE, np.int16)
    rows, cols = np.meshgrid(np.arange(20), np.arange(20), indexing="ij")
    along, across = (rows + cols - 20) / np.sqrt(2.0), (rows - cols) / np.sqrt(2.0)
    volume[(abs(along) <= 6.0) & (abs(across) <= 3.0), 7] = 3
    whole = np.zeros((1, 3), np.int64), np.array([[19, 19, 21]])
    turned = shapes_of(volume.reshape(-1), np.array([3]), *whole, SHAPE, EDGE_M)[0]
    assert turned[2:4].tolist() == pytest.approx([1.2, 0.6], abs=0.08)


@pytest.mark.parametrize(("layers", "share"), [(2, 1.0), (3, 0.0)])
def test_a_surface_is_flat_if_it_is_at_most_two_voxels_thick(layers: int, share: float):
    assert measures((slice(2, 8), slice(3, 15), slice(7, 7 + layers)))["flat_share"] == share


def test_few_stray_voxels_do_not_change_the_heights():
    seat = (slice(2, 8), slice(3, 9), slice(4, 5))
    assert measures(seat, (slice(2, 3), slice(3, 4), slice(20, 21)))["top_m"] == measures(seat)["top_m"]


def test_a_track_without_voxels_has_zeros():
    box = np.zeros((1, 3), np.int64)
    assert not shapes_of(np.zeros(np.prod(SHAPE), np.int16), np.array([3]), box, box, SHAPE, EDGE_M).any()


def test_the_features_of_each_measure_add_up_to_one_and_keep_its_value():
    values = np.random.default_rng(0).uniform(0.0, 2.5, (50, len(MEASURES))).astype(np.float32)
    features = features_of(values)
    assert features.shape == (50, FEATURES)
    first = 0
    for column, knots in zip(values.T, MEASURES.values(), strict=True):
        part = features[:, first : first + len(knots)]
        first += len(knots)
        np.testing.assert_allclose(part.sum(axis=1), 1.0, atol=1e-5)
        np.testing.assert_allclose(part @ np.array(knots), column.clip(knots[0], knots[-1]), atol=1e-5)
