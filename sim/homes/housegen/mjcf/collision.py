"""Collision geoms of an item: fewer and simpler shapes than its visual geoms, which the robot cannot tell from them.

A chair of twenty rails and spindles collides as its seat, its back and its arms. No gap into which the robot fits is
closed.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

from sim.homes.housegen.furniture.item import Geom, Item, Surface
from sim.homes.housegen.mjcf.boxes import Box, base_m2, box_geom, geom_box, overlap, union, volume_m3

SMALL_ITEM_M = 0.8
"""Items no wider than this collide as a block under their largest plate: the robot is 0.88 m high."""
OVERHANG_M = 0.05
"""Largest distance by which legs may extend beyond the plate that they carry."""
MAX_FILLED_M3 = 0.012
"""Largest volume that one box may add to the two parts that it replaces."""
MAX_FILLED_M2 = 0.02
"""Largest floor area that it may add."""
ROBOT_HEIGHT_M = 0.85
"""A plate below this height stops the robot, even if the space under the plate is empty."""
ABOVE_SURFACE_M = 0.4
"""Height that stays free above a surface on which objects stand."""
BLOCKS = frozenset(("sink",))
"""Categories of open items that the robot cannot enter: they collide as one box."""

_Part = tuple[Box, Geom | None]
"""A box, and the geom that it surrounds unless the box itself is the collision geom."""
_Filled = dict[tuple[int, int], tuple[float, Box, Box]]
"""The volume that one box would add to two, and both, by their ids: an id is reused once its box is deleted."""


def collision_boxes(solid: Sequence[Geom], item: Item) -> list[Geom]:
    """Returns few collision geoms that replace some solid geoms of an item."""
    if not solid:
        return []
    parts: list[_Part] = [(geom_box(geom), geom) for geom in solid]
    if item.category in BLOCKS:
        return [box_geom(functools.reduce(union, (box for box, _ in parts)))]
    parts = _join_under_plate(parts, item)
    filled: _Filled = {}
    while (pair := _best_pair(parts, item, filled)) is not None:
        i, j = pair
        joined = union(parts[i][0], parts[j][0])
        parts = [part for n, part in enumerate(parts) if n not in pair] + [(joined, None)]
    return [geom if geom is not None else box_geom(box) for box, geom in parts]


def _join_under_plate(parts: list[_Part], item: Item) -> list[_Part]:
    """Returns the parts of a small item with its largest plate and everything under it joined into one block."""
    if max(item.size_m[:2]) > SMALL_ITEM_M:
        return parts
    top = max((geom for geom in item.geoms if geom.solid), key=lambda geom: base_m2(geom_box(geom)))
    x0, y0, z0, x1, y1, z1 = geom_box(top)
    shelves = any(0.03 < surface.centre_m[2] < z1 - 0.02 for surface in item.surfaces)
    if shelves or top.shape in ("sphere", "ellipsoid") or z1 < 0.1 or z0 > ROBOT_HEIGHT_M:
        return parts

    def is_under(box: Box) -> bool:
        low = box[0] >= x0 - OVERHANG_M and box[1] >= y0 - OVERHANG_M
        return low and box[3] <= x1 + OVERHANG_M and box[4] <= y1 + OVERHANG_M and box[5] <= z1

    under = [part for part in parts if is_under(part[0])]
    if len(under) < 2:
        return parts
    block = functools.reduce(union, (box for box, _ in under))
    return [part for part in parts if not is_under(part[0])] + [(block, _cylinder(block, top))]


def _cylinder(block: Box, plate: Geom) -> Geom | None:
    """Returns a cylinder in the block if the plate on top is an upright cylinder."""
    if plate.shape != "cylinder" or abs(plate.euler_rad[0]) + abs(plate.euler_rad[1]) > 0.01:
        return None
    box = box_geom(block)
    return replace(box, shape="cylinder", size_m=(max(box.size_m[:2]), box.size_m[2]))


def _best_pair(parts: Sequence[_Part], item: Item, filled: _Filled) -> tuple[int, int] | None:
    """Returns the two parts that add the least volume if they share one box; None if every pair adds too much.

    `filled` keeps the volumes that were computed before.
    """
    best, pair = math.inf, None
    for i, j in itertools.combinations(range(len(parts)), 2):
        a, b = parts[i][0], parts[j][0]
        key = id(a), id(b)
        if key not in filled:
            filled[key] = (_filled_m3(a, b, item), a, b)
        if filled[key][0] < best:
            best, pair = filled[key][0], (i, j)
    return pair


def _filled_m3(a: Box, b: Box, item: Item) -> float:
    """Returns the volume that one box would add to two that it replaces; inf where it must not replace them.

    For an item out of reach any volume may be added, but not above a surface.
    """
    joined = union(a, b)
    filled_m3 = volume_m3(joined) - volume_m3(a) - volume_m3(b)
    if item.mount == "floor":
        filled_m2 = base_m2(joined) - base_m2(a) - base_m2(b) + base_m2(overlap(a, b))
        if filled_m3 >= MAX_FILLED_M3 or filled_m2 >= MAX_FILLED_M2:
            return math.inf
    return math.inf if _covers_a_top(joined, (a, b), item.surfaces) else filled_m3


def _covers_a_top(joined: Box, parts: tuple[Box, Box], surfaces: Sequence[Surface]) -> bool:
    """Returns whether a box occupies space above a surface that its parts left free."""
    for surface in surfaces:
        (x, y, z), (hx, hy) = surface.centre_m, surface.half_size_m
        room = (x - hx, y - hy, z + 0.005, x + hx, y + hy, z + ABOVE_SURFACE_M)
        if volume_m3(overlap(joined, room)) > sum(volume_m3(overlap(part, room)) for part in parts) + 1e-5:
            return True
    return False
