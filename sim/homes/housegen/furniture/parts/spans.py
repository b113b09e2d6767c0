"""Ranges along an axis, in metres, and the signs of the two sides."""

from __future__ import annotations

from sim.homes.housegen.furniture.workbench import Range

BOTH_SIDES = (-1, 1)
"""The signs of the two sides of an axis."""


def on_side(side: int, near: float, far: float) -> Range:
    """Returns the range between two distances from zero, on the side with the sign `side`."""
    return min(side * near, side * far), max(side * near, side * far)


def footprint(depth: float, width: float) -> tuple[Range, Range]:
    """Returns the x and y ranges of a rectangle around the origin."""
    return (-0.5 * depth, 0.5 * depth), (-0.5 * width, 0.5 * width)
