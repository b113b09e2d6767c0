"""A fixed colour for each category, and pictures of segmentation with a legend."""

from __future__ import annotations

import colorsys

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40, MPCAT40_ID
from sim.core.vocabulary import plain

_GREYS = {"void": 0, "wall": 200, "floor": 110, "ceiling": 235, "door": 150, "window": 175}
"""Structure is grey, so that furniture is easy to see."""
_GOLDEN_RATIO = 0.618034
MAX_NAMES, MIN_SHARE = 12, 0.002
"""Number of names in a legend; categories that cover less of the image are not named."""


def _make_palette() -> NDArray[np.uint8]:
    palette = np.zeros((len(MPCAT40), 3), np.uint8)
    for i in range(len(MPCAT40)):
        hue = (i * _GOLDEN_RATIO) % 1.0  # neighbours in the list get distant hues
        rgb = colorsys.hsv_to_rgb(hue, 0.55 + 0.35 * (i % 2), 0.95 - 0.25 * (i % 3 == 0))
        palette[i] = [round(255 * value) for value in rgb]
    for name, grey in _GREYS.items():
        palette[MPCAT40_ID[name]] = grey
    return palette


PALETTE: NDArray[np.uint8] = _make_palette()
"""uint8 (41, 3): the RGB colour of each mpcat40 id."""
PALETTE.setflags(write=False)


def colour_segmentation(semantic: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Returns uint8 (h, w, 3): the colour of each mpcat40 id of a (h, w) image."""
    return PALETTE[semantic]


def with_legend(semantic: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Returns coloured mpcat40 ids (h, w) with the names of the largest categories in the upper left corner."""
    picture = np.ascontiguousarray(colour_segmentation(semantic))
    counts = np.bincount(semantic.ravel(), minlength=len(MPCAT40))
    named = [int(i) for i in np.argsort(-counts)[:MAX_NAMES] if counts[i] > MIN_SHARE * semantic.size]
    scale = semantic.shape[0] / 480
    line_px = round(20 * scale)
    for row, category in enumerate(named):
        top = round(8 * scale) + row * line_px
        box = (round(8 * scale), top, round(150 * scale), line_px)
        cv2.rectangle(picture, box, (255, 255, 255), cv2.FILLED)
        swatch = (box[0] + 3, top + 3, line_px - 6, line_px - 6)
        cv2.rectangle(picture, swatch, [int(value) for value in PALETTE[category]], cv2.FILLED)
        cv2.rectangle(picture, swatch, (60, 60, 60), 1)
        corner = (box[0] + line_px + 2, top + round(14 * scale))
        name = plain(MPCAT40[category])
        cv2.putText(picture, name, corner, cv2.FONT_HERSHEY_SIMPLEX, 0.42 * scale, (20, 20, 20), 1, cv2.LINE_AA)
    return picture
