"""Placed items with their footprints, and the boxes by which two placed items are tested for contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.homes.housegen.floor_plan.rectangles import OPPOSITE, Rect, Side, footprint
from sim.homes.housegen.furniture.item import Geom, Item
from sim.homes.housegen.furniture.transforms import geom_bounds, rotated
from sim.homes.housegen.mjcf.placed import PlacedItem

TOUCH_M = 0.015
"""Items that are nearer than this touch each other."""


@dataclass(frozen=True)
class Placement:
    """A placed item that other items can be placed against."""

    placed: PlacedItem
    rect: Rect
    """Footprint in the world."""
    side: Side | None = None
    """Wall that the item stands against or hangs on."""

    @property
    def item(self) -> Item:
        """The item."""
        return self.placed.item

    def to_world(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Returns the world position in plan of a point of the item's frame."""
        return self.placed.to_world(x_m, y_m)


def floor_placement(item: Item, x_m: float, y_m: float, yaw_rad: float, side: Side | None = None) -> Placement:
    """Returns the placement of an item that stands on the floor at this pose."""
    rect = footprint(x_m, y_m, item.size_m[0], item.size_m[1], yaw_rad)
    return Placement(PlacedItem(item, x_m, y_m, 0.0, yaw_rad), rect, side)


def zone_in_front(rect: Rect, back: Side, length_m: float) -> Rect:
    """Returns the zone of this length in front of an item with its back at the side `back` of the room."""
    return rect.strip(OPPOSITE[back], rect.span(OPPOSITE[back]), 0.0, length_m)


def geom_boxes(geoms: Sequence[Geom], placed: PlacedItem) -> NDArray[np.float64]:
    """Returns (n, 6) axis-aligned boxes x0 y0 z0 x1 y1 z1 in the world, one around each geom of a placed item."""
    boxes = [np.concatenate(geom_bounds(rotated(geom, placed.yaw_rad))) for geom in geoms]
    return np.array(boxes).reshape(-1, 6) + [placed.x_m, placed.y_m, placed.z_m] * 2


def boxes_touch(a: NDArray[np.float64], b: NDArray[np.float64]) -> bool:
    """Returns whether any box of `a` is nearer than `TOUCH_M` to any box of `b` along all three axes."""
    gap = np.maximum(a[:, None, :3] - b[None, :, 3:], b[None, :, :3] - a[:, None, 3:])
    return bool((gap.max(axis=2) < TOUCH_M).any())
