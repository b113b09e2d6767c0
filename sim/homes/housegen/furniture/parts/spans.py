"""Ranges along an axis and points round an axis, in metres, and the signs of the two sides."""

from __future__ import annotations

import math

from sim.homes.housegen.furniture.workbench import Range

BOTH_SIDES = (-1, 1)
"""The signs of the two sides of an axis."""


def around(middle: float, reach: float) -> Range:
    """Returns the range that reaches this far to either side of its middle."""
    return middle - reach, middle + reach


def inset(span: Range, low: float, high: float | None = None) -> Range:
    """Returns a range that ends `low` and `high` further in than another one, `low` at both ends if `high` is None."""
    return span[0] + low, span[1] - (low if high is None else high)


def centred(length: float, low: float = 0.0, high: float | None = None) -> Range:
    """Returns the range of this length about zero; its ends are moved inwards as those of `inset`."""
    return inset((-0.5 * length, 0.5 * length), low, high)


def on_side(side: int, near: float, far: float) -> Range:
    """Returns the range between two distances from zero, on the side with the sign `side`."""
    return min(side * near, side * far), max(side * near, side * far)


def footprint(depth: float, width: float) -> tuple[Range, Range]:
    """Returns the x and y ranges of a rectangle around the origin."""
    return centred(depth), centred(width)


def polar(radius: float, angle: float) -> tuple[float, float]:
    """Returns x and y of the point at this distance from the z axis, `angle` radians to the left of +x."""
    return radius * math.cos(angle), radius * math.sin(angle)
