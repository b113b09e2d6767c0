"""Excludes narrow regions at the edge of the image from an evaluation: a person does not recognise the cut objects."""

from __future__ import annotations

import cv2
import numpy as np
from jaxtyping import UInt8

from sim.training.segmentation.samples import SURFACES

SLIVER_PX = 24
"""A sliver at an edge of the image extends less than this from the edge, in pixels of the 640 x 480 image."""


def without_slivers(semantic: UInt8[np.ndarray, "h w"], block_px: int) -> UInt8[np.ndarray, "h w"]:
    """Returns the labels with slivers at the image's edges as void, which no evaluation counts.

    A sliver is a connected region of one category, other than walls, floors and ceilings, that touches the left or the
    right edge and is less than `SLIVER_PX` wide, or touches the upper or the lower edge and is less than `SLIVER_PX`
    high.

    Args:
        semantic: mpcat40 ids.
        block_px: edge of the square of pixels of the 640 x 480 image that one pixel stands for.
    """
    kept, (height, width) = semantic.copy(), semantic.shape
    edge = np.concatenate([semantic[0], semantic[-1], semantic[:, 0], semantic[:, -1]])
    for category in np.setdiff1d(edge, SURFACES).tolist():
        count, regions, boxes, _ = cv2.connectedComponentsWithStats((semantic == category).astype(np.uint8))
        for number in range(1, count):
            left, top, cols, rows = boxes[number, :4].tolist()
            at_side = (left == 0 or left + cols == width) and cols * block_px < SLIVER_PX
            above = (top == 0 or top + rows == height) and rows * block_px < SLIVER_PX
            if at_side or above:
                kept[regions == number] = 0
    return kept
