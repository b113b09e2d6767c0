"""Labelled views for the tests of training."""

from __future__ import annotations

import numpy as np

from sim.core.interface import MPCAT40_ID
from sim.training.segmentation.dataset import LabelledView


def a_view(height: int = 64, width: int = 96) -> LabelledView:
    """Returns a view: a chair on the left third, floor elsewhere, void in the top row; colour and depth agree."""
    semantic = np.full((height, width), MPCAT40_ID["floor"], np.uint8)
    semantic[:, : width // 3] = MPCAT40_ID["chair"]
    semantic[0] = 0
    rgb = np.repeat(np.where(semantic == MPCAT40_ID["chair"], 220, 40).astype(np.uint8)[..., None], 3, axis=2)
    depth = np.where(semantic == MPCAT40_ID["chair"], 1.0, 3.0).astype(np.float32)
    return LabelledView("v", rgb, depth, semantic)
