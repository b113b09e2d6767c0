"""Axis-aligned boxes in the frame of an item, for the assembly of its geoms."""

from __future__ import annotations

from sim.homes.housegen.furniture.item import Geom, Look
from sim.homes.housegen.furniture.transforms import geom_bounds

Box = tuple[float, float, float, float, float, float]
"""Lowest x, y, z, then highest, in metres; plain numbers, because thousands of pairs are tested."""


def geom_box(geom: Geom) -> Box:
    """Returns the axis-aligned box around a geom in the item's frame."""
    (x0, y0, z0), (x1, y1, z1) = (corner.tolist() for corner in geom_bounds(geom))
    return x0, y0, z0, x1, y1, z1


def union(a: Box, b: Box) -> Box:
    """Returns the smallest box around two boxes."""
    return (
        min(a[0], b[0]), min(a[1], b[1]), min(a[2], b[2]),
        max(a[3], b[3]), max(a[4], b[4]), max(a[5], b[5]),
    )  # fmt: skip


def overlap(a: Box, b: Box) -> Box:
    """Returns the box that two boxes share; one of its sides is 0 if they do not overlap."""
    x, y, z = max(a[0], b[0]), max(a[1], b[1]), max(a[2], b[2])
    return x, y, z, max(x, min(a[3], b[3])), max(y, min(a[4], b[4])), max(z, min(a[5], b[5]))


def base_m2(box: Box) -> float:
    """Returns the area of a box in plan."""
    return (box[3] - box[0]) * (box[4] - box[1])


def volume_m3(box: Box) -> float:
    """Returns the volume of a box."""
    return base_m2(box) * (box[5] - box[2])


def box_geom(box: Box) -> Geom:
    """Returns a collision geom of the shape of a box."""
    x, y, z = (round(0.5 * (box[i] + box[i + 3]), 4) for i in range(3))
    half = tuple(round(0.5 * (box[i + 3] - box[i]), 4) for i in range(3))
    return Geom("box", half, (x, y, z), Look())
