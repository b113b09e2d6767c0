"""Writes text into pictures with the font of OpenCV 5."""

from __future__ import annotations

import functools

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.viewers.viewer import Colour
from sim.core.errors import RenderError

NORMAL, BOLD = 400, 700
"""Weights of the font."""
_ANY_SIZE = (4096, 4096)


@functools.cache
def _font() -> cv2.FontFace:
    """Returns the font; raises RenderError where OpenCV has none."""
    if not hasattr(cv2, "FontFace"):
        raise RenderError(f"Pictures with text need OpenCV 5; this is {cv2.__version__}, as habitat-lab needs it.")
    return cv2.FontFace("sans")


def text_width(words: str, size_px: int, weight: int = NORMAL) -> int:
    """Returns the width of a text in pixels; `size_px` is the height of a line."""
    return int(cv2.getTextSize(_ANY_SIZE, words, (0, 0), _font(), size_px, weight)[2])


def write(
    picture: NDArray[np.uint8],
    words: str,
    left_base: tuple[int, int],
    width_px: int,
    size_px: int,
    colour: Colour,
    weight: int = NORMAL,
) -> None:
    """Writes text from its lower left corner, smaller where it would be wider than `width_px`."""
    wide = text_width(words, size_px, weight)
    if wide > width_px:
        size_px = max(4, int(size_px * width_px / wide))
    cv2.putText(picture, words, left_base, colour, _font(), size_px, weight)


def wrapped(words: str, width_px: int, size_px: int) -> list[str]:
    """Returns lines that are at most `width_px` wide, broken between words."""
    lines: list[str] = []
    for word in words.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and text_width(longer, size_px) <= width_px:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines
