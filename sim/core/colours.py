"""Names of colours: the eleven basic colour terms of English (Berlin and Kay 1969) and beige.

A name is decided in CIELAB by lightness, chroma and hue, so that a generator that knows the colour of a surface and an
agent that sees its pixels use the same words. The limits were chosen by eye on the palettes of the shipped furniture.
"""

from __future__ import annotations

from typing import Literal

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

ColourName = Literal[
    "white", "grey", "black", "beige", "brown", "red", "orange", "yellow", "green", "blue", "purple", "pink"
]
COLOUR_NAMES: tuple[ColourName, ...] = (
    "white", "grey", "black", "beige", "brown", "red", "orange", "yellow", "green", "blue", "purple", "pink",
)  # fmt: skip
"""All names, in the order of the numbers that `colour_numbers` returns."""
_GREY_CHROMA, _CREAM_CHROMA = 7.0, 14.0
"""Largest chroma of neutral colours, and of those that are still called white where they are light."""
_BLACK_L, _WHITE_L, _CREAM_L = 24.0, 80.0, 87.0
_CLEAR_L, _CLEAR_AB = 4.0, 2.0
"""Differences of lightness and of the other two coordinates that a clear name survives."""
_HUES_DEG: tuple[tuple[float, ColourName], ...] = (
    (10.0, "pink"), (43.0, "red"), (66.0, "orange"), (103.0, "yellow"), (195.0, "green"), (295.0, "blue"),
    (335.0, "purple"), (360.0, "pink"),
)  # fmt: skip
"""Upper limit of the hue of each name, degrees."""


def colour_numbers(rgb: ArrayLike) -> NDArray[np.intp]:
    """Returns the indices in `COLOUR_NAMES` of sRGB colours.

    Args:
        rgb: (..., 3), in [0, 1].

    Returns:
        (...) whole numbers.
    """
    colours = np.asarray(rgb, np.float32)
    lab = cv2.cvtColor(colours.reshape(-1, 1, 3), cv2.COLOR_RGB2LAB).reshape(-1, 3)
    light, chroma = lab[:, 0], np.hypot(lab[:, 1], lab[:, 2])
    hue = np.degrees(np.arctan2(lab[:, 2], lab[:, 1])) % 360.0
    limits = np.array([limit for limit, _ in _HUES_DEG])
    names = np.array([COLOUR_NAMES.index(name) for _, name in _HUES_DEG])
    number = names[np.minimum(np.searchsorted(limits, hue, side="right"), len(names) - 1)]
    warm = hue < 103.0
    rules: tuple[tuple[NDArray[np.bool_], ColourName], ...] = (
        (((hue < 10.0) | (hue > 335.0)) & (light < 42.0), "red"),
        (warm & (hue > 25.0) & (light < 62.0) & (chroma < 30.0), "brown"),
        ((hue > 43.0) & (hue < 103.0) & (light < 62.0) & (chroma < 42.0), "brown"),
        ((hue > 30.0) & (hue < 66.0) & (light < 48.0) & (chroma < 50.0), "brown"),
        ((hue < 40.0) & (light > 60.0) & (chroma < 45.0), "pink"),
        ((hue >= 295.0) & (hue < 312.0) & (chroma > 70.0), "blue"),
        ((hue > 55.0) & (hue < 103.0) & (chroma < 42.0) & (light >= 62.0) & (light < 74.0), "brown"),
        ((hue > 40.0) & (hue < 110.0) & (chroma < 32.0) & (light >= 68.0), "beige"),
        (chroma < _GREY_CHROMA, "grey"),
        ((chroma < _GREY_CHROMA) & (light > _WHITE_L), "white"),
        ((chroma < _CREAM_CHROMA) & (light > _CREAM_L), "white"),
        ((light < _BLACK_L) & (chroma < 12.0), "black"),
        (light < 12.0, "black"),
    )
    for holds, name in rules:
        number = np.where(holds, COLOUR_NAMES.index(name), number)
    return number.reshape(colours.shape[:-1]).astype(np.intp)


def clear_colour_name(rgb: ArrayLike) -> ColourName | None:
    """Returns the name of one sRGB colour (3,) in [0, 1], or None if a slightly different colour has another name.

    Light and shadow change the colour of a surface in a picture. A colour has a clear name if the colours that are
    `_CLEAR_L` lighter or darker, or `_CLEAR_AB` away in one of the other two directions of CIELAB, have the same one.
    """
    lab = cv2.cvtColor(np.asarray(rgb, np.float32).reshape(1, 1, 3), cv2.COLOR_RGB2LAB).reshape(3)
    steps = np.diag([_CLEAR_L, _CLEAR_AB, _CLEAR_AB]).astype(np.float32)
    around = np.concatenate([lab[None], lab + steps, lab - steps])
    around[:, 0] = np.clip(around[:, 0], 0.0, 100.0)
    colours = cv2.cvtColor(around.reshape(-1, 1, 3), cv2.COLOR_LAB2RGB).reshape(-1, 3)
    names = set(colour_numbers(np.clip(colours, 0.0, 1.0)).tolist())
    return COLOUR_NAMES[names.pop()] if len(names) == 1 else None
