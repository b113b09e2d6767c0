"""Positions on the surfaces of placed items: objects on tables, cushions on seats."""

from __future__ import annotations

import math

import numpy as np

from sim.homes.housegen.floor_plan.rectangles import Rect, footprint, rotated_extent
from sim.homes.housegen.furnishing.placement.layout import RoomLayout
from sim.homes.housegen.furnishing.placement.records import Placement
from sim.homes.housegen.furniture.item import Item
from sim.homes.housegen.mjcf.placed import PlacedItem

MAX_TRIES = 8


def put_on_surface(
    layout: RoomLayout,
    rng: np.random.Generator,
    host: Placement,
    item: Item,
    *,
    face: float | None = None,
    back: bool = False,
    number: int | None = None,
) -> bool:
    """Puts a small item on one of the tops of `host`; returns False if no room is left.

    Args:
        layout: the room.
        rng: decides where.
        host: item that carries it.
        item: item with mount "top".
        face: yaw relative to the host's front; any when None.
        back: True to put it at the rear edge, in the middle if possible.
        number: number of the surface; any when None.
    """
    for n, surface in enumerate(host.item.surfaces):
        if surface.kind != "top" or number not in (None, n):
            continue
        if _put_on(layout, rng, host, n, item, face, back):
            return True
    return False


def supports_items(layout: RoomLayout, host: Placement) -> bool:
    """Returns whether another item stands or lies on a surface of a floor item."""
    tops_m = [surface.centre_m[2] for surface in host.item.surfaces]
    return any(
        other is not host
        and other.rect.overlaps(host.rect)
        and any(abs(other.placed.z_m - host.placed.z_m - top_m) < 0.03 for top_m in tops_m)
        for other in layout.placements
    )


def _put_on(
    layout: RoomLayout,
    rng: np.random.Generator,
    host: Placement,
    number: int,
    item: Item,
    face: float | None,
    back: bool,
) -> bool:
    """Puts an item at a free place of one surface, given by its number; returns False if it has no such place."""
    surface = host.item.surfaces[number]
    used = layout.used_on_surface(host, number)
    cx, cy, cz = surface.centre_m
    for n in range(MAX_TRIES):
        turn = face if face is not None else float(rng.uniform(-math.pi, math.pi))
        ex, ey = rotated_extent(item.size_m[0], item.size_m[1], turn)
        free_x, free_y = surface.half_size_m[0] - ex / 2, surface.half_size_m[1] - ey / 2
        if free_x < 0 or free_y < 0:
            return False
        local_x = cx - free_x if back else cx + float(rng.uniform(-free_x, free_x))
        local_y = cy + (0.0 if back and n == 0 else float(rng.uniform(-free_y, free_y)))
        rect = Rect(local_x - ex / 2, local_y - ey / 2, local_x + ex / 2, local_y + ey / 2)
        if any(rect.overlaps(other, 0.0) for other in used):
            continue
        x, y = host.to_world(local_x, local_y)
        z = host.placed.z_m + cz
        world = footprint(x, y, ex, ey, host.placed.yaw_rad)
        if layout.is_clear_above(host, world, z, z + item.size_m[2]):
            used.append(rect.grown(0.02))
            placement = Placement(PlacedItem(item, x, y, z, host.placed.yaw_rad + turn), world)
            layout.add(placement, z, z + item.size_m[2])
            return True
    return False
