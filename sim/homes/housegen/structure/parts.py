"""Building blocks of walls, doors and windows: their looks, and boxes that show a texture at its true scale."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sim.homes.housegen.floor_plan.rectangles import Side
from sim.homes.housegen.furniture.item import Geom, Item, Look

CASING_M = (0.07, 0.014)
"""Width and thickness of the boards around a door."""
Box3 = tuple[float, float, float, float, float, float]
"""x0, x1, y0, y1, z0, z1 in metres."""


@dataclass(frozen=True)
class StructureLooks:
    """The looks of the walls, floors, doors and windows of one home."""

    walls: Mapping[str, Look]
    """Looks by room name."""
    floors: Mapping[str, Look]
    """Looks by room name."""
    ceiling: Look
    trim: Look
    """Baseboards and window frames."""
    door: Look
    door_frame: Look
    handle: Look
    views: Mapping[Side, Look]
    """Pictures that are visible through the windows of each side."""
    time: str
    """Time of day, a key of `sim.homes.housegen.surfaces.lighting.DAYLIGHT`."""


def oriented_box(box: Box3, look: Look, facing: Side | None = None, *, solid: bool = True) -> Geom:
    """Returns a box; with `facing` its local z points along that side's normal and its local x stays level.

    MuJoCo shows a texture at its true scale only on the faces along a box's local z: the visible face of a wall must be
    one of them.
    """
    x0, x1, y0, y1, z0, z1 = box
    at = (round(0.5 * (x0 + x1), 4), round(0.5 * (y0 + y1), 4), round(0.5 * (z0 + z1), 4))
    half = np.round([0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.5 * (z1 - z0)], 4)
    if facing is None or look.texture is None:
        return Geom("box", tuple(half.tolist()), at, look, solid=solid)
    if facing in ("north", "south"):  # local x, y, z = world x, z, -y
        return Geom("box", (float(half[0]), float(half[2]), float(half[1])), at, look, (math.pi / 2, 0.0, 0.0), solid)
    # local x, y, z = world y, z, x
    return Geom(
        "box", (float(half[1]), float(half[2]), float(half[0])), at, look, (math.pi / 2, math.pi / 2, 0.0), solid
    )


def structure_item(category: str, style: str, geoms: Sequence[Geom]) -> Item:
    """Returns an item of the building from geoms in world coordinates, or in the frame of an opening."""
    return Item(category, style, (0.0, 0.0, 0.0), tuple(geoms))


def visual_boxes(boxes: Sequence[Box3], look: Look) -> list[Geom]:
    """Returns visual-only boxes."""
    return [oriented_box(box, look, solid=False) for box in boxes]
