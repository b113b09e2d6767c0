"""Slivers at the image's edge are left out of an evaluation; other objects and surfaces are not."""

from __future__ import annotations

import numpy as np

from sim.core.interface import MPCAT40_ID
from sim.training.segmentation.evaluation import SLIVER_PX, without_slivers


def test_only_thin_regions_at_an_edge_become_void() -> None:
    wall, chair, sofa = (MPCAT40_ID[name] for name in ("wall", "chair", "sofa"))
    semantic = np.full((60, 80), wall, np.uint8)
    thin = SLIVER_PX // 4 - 1
    semantic[5:50, :thin] = chair  # a sliver at the left edge, however high
    semantic[-thin:, 20:40] = sofa  # one at the lower edge
    semantic[10:14, 20:24] = chair  # small, but not at an edge
    semantic[20:40, -20:] = sofa  # at an edge, but not thin
    semantic[:2, 50:] = MPCAT40_ID["ceiling"]  # a surface
    before = semantic.copy()
    kept = without_slivers(semantic, 4)
    void = kept == 0
    assert (semantic == before).all()
    assert void[5:50, :thin].all()
    assert void[-thin:, 20:40].all()
    assert void.sum() == 45 * thin + 20 * thin
    assert (kept[~void] == semantic[~void]).all()
    assert not (without_slivers(semantic, 8)[5:50, :thin] == 0).any()
