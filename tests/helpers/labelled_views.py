"""Labelled views for the tests of training."""

from __future__ import annotations

import numpy as np

from sim.core.interface import MPCAT40_ID
from sim.houses.labels import Instance
from sim.training.segmentation.dataset import LabelledView
from sim.training.views.coco import annotate
from sim.training.views.views import View


def a_view(height: int = 64, width: int = 96) -> LabelledView:
    """Returns a view: a chair on the left third, floor elsewhere, void in the top row; colour and depth agree."""
    semantic = np.full((height, width), MPCAT40_ID["floor"], np.uint8)
    semantic[:, : width // 3] = MPCAT40_ID["chair"]
    semantic[0] = 0
    rgb = np.repeat(np.where(semantic == MPCAT40_ID["chair"], 220, 40).astype(np.uint8)[..., None], 3, axis=2)
    depth = np.where(semantic == MPCAT40_ID["chair"], 1.0, 3.0).astype(np.float32)
    return LabelledView("v", rgb, depth, semantic)


def view_of(
    number: int, objects: list[tuple[str, str]], *, extras: bool = True, size_px: tuple[int, int] = (64, 48)
) -> View:
    """Returns a view of a wall, with a block of pixels for each category and style."""
    shape = size_px[::-1]
    semantic, ids = np.full(shape, MPCAT40_ID["wall"], np.uint8), np.zeros(shape, np.uint16)
    instances, styles = [], {}
    for i, (category, style) in enumerate(objects):
        cut = slice(10, 30), slice(10 * i, 10 * i + 8)
        semantic[cut], ids[cut] = MPCAT40_ID[category], i + 1
        instances.append(Instance(f"{category}_{i:02d}", category, (i,)))
        styles[instances[-1].name] = style
    more = {"instances": ids, "annotations": annotate(ids, instances, styles)} if extras else {}
    colour, depth = np.zeros((*shape, 3), np.uint8), np.full(shape, 2000, np.uint16)
    return View(f"v{number:05d}", colour, depth, semantic, {"house": "h"}, **more)
