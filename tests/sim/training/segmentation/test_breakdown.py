"""Counts of right and wrong pixels by distance, and of found objects by size, on images drawn by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sim.core.interface import MPCAT40_ID
from sim.training.segmentation.breakdown import Breakdown

SOFA, WALL = MPCAT40_ID["sofa"], MPCAT40_ID["wall"]


@pytest.fixture
def two_sofas() -> Breakdown:
    """Returns a found sofa of 8 x 8 pixels at 1.5 m and one of 3 x 3 at 3.5 m of which a third is correct."""
    semantic = np.full((24, 32), WALL, np.uint8)
    semantic[2:10, 2:10] = semantic[15:18, 20:23] = SOFA
    depth_m = np.full((24, 32), 0.0, np.float32)
    depth_m[2:10, 2:10], depth_m[15:18, 20:23] = 1.5, 3.5
    predicted = semantic.astype(np.int64) - 1
    predicted[16:18, 20:23] = WALL - 1
    breakdown = Breakdown()
    breakdown.add(predicted, semantic, depth_m, block_px=4)
    return breakdown


def test_objects_are_found_if_half_of_their_pixels_are_right(two_sofas: Breakdown) -> None:
    assert [(seen.edge_px, round(seen.right, 3)) for seen in two_sofas.objects] == [(32.0, 1.0), (12.0, 0.333)]
    assert two_sofas.found_by_size() == [(0, 16, 1, 0.0), (32, 64, 1, 1.0)]
    assert two_sofas.found_by_category() == {"sofa": (2, 0.5)}


def test_pixels_are_counted_at_their_distance_and_those_without_depth_nowhere(two_sofas: Breakdown) -> None:
    rows = {(low, high): iou for low, high, iou in two_sofas.iou_by_distance()}
    assert rows[1.0, 2.0].by_category == {"sofa": 1.0}
    assert rows[3.0, 4.0].by_category["sofa"] == pytest.approx(1 / 3)
    assert np.isnan(rows[2.0, 3.0].goals)
    assert int(two_sofas.by_distance.sum()) == 64 + 9


def test_void_and_specks_are_not_objects() -> None:
    semantic = np.zeros((24, 32), np.uint8)
    semantic[3, 4:7] = SOFA
    breakdown = Breakdown()
    breakdown.add(np.zeros((24, 32), np.int64), semantic, np.full((24, 32), 2.5, np.float32), block_px=2)
    assert breakdown.objects == []
    assert int(breakdown.by_distance.sum()) == 3
