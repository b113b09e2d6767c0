"""Doors and windows of a home, as labelled items in their walls; openings of the same size share one item."""

from __future__ import annotations

import math
from collections.abc import Callable

from sim.homes.housegen.floor_plan.rectangles import INWARD_YAW_RAD, outward, side_point
from sim.homes.housegen.furniture.item import Geom, Item, Look
from sim.homes.housegen.mjcf.placed import Hinge, PlacedItem
from sim.homes.housegen.structure.openings import HALF_WALL_M, JAMB_M, OUTER_WALL_M, Opening
from sim.homes.housegen.structure.parts import (
    CASING_M,
    Box3,
    StructureLooks,
    oriented_box,
    structure_item,
    visual_boxes,
)

SADDLE_M = (0.09, 0.003)
"""Width and height of the strip that covers the joint of two floors in a doorway; it does not collide."""


def place_in_wall(item: Item, hole: Opening) -> PlacedItem:
    """Returns an item that was designed for an opening in a north wall, turned to the wall of its opening."""
    yaw = {"north": 0.0, "west": math.pi / 2, "south": math.pi, "east": -math.pi / 2}[hole.side]
    return PlacedItem(item, *hole.point(hole.centre_m), 0.0, yaw)


class OpeningItems:
    """The items of a home's windows and doors by size, each made once."""

    def __init__(self, looks: StructureLooks) -> None:
        self._looks = looks
        self._made: dict[tuple[object, ...], Item] = {}

    def window(self, hole: Opening) -> Item:
        """Returns the window of an opening, in the frame of `place_in_wall`."""
        view = self._looks.views[hole.side]
        key = ("window", _width(hole), hole.bottom_m, hole.top_m, view)
        return self._once(key, lambda: _window(_width(hole), hole.bottom_m, hole.top_m, view, self._looks.trim))

    def frame(self, hole: Opening) -> Item:
        """Returns the door frame of an opening, in the frame of `place_in_wall`."""
        key = ("frame", _width(hole), hole.top_m, hole.kind)
        return self._once(key, lambda: _frame(_width(hole), hole.top_m, hole.kind == "entry", self._looks))

    def leaf(self, width_m: float, high_m: float, gap_m: float) -> Item:
        """Returns a door leaf with its hinge at the origin, along +x, `gap_m` above the floor."""
        key = ("leaf", width_m, high_m, gap_m)
        return self._once(key, lambda: structure_item("door", "leaf", _leaf_geoms(width_m, high_m, self._looks, gap_m)))

    def _once(self, key: tuple[object, ...], make: Callable[[], Item]) -> Item:
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]


def _width(hole: Opening) -> float:
    """Returns the width of an opening, rounded to 1 mm."""
    return round(hole.span[1] - hole.span[0], 3)


def _window(width_m: float, z0: float, z1: float, view: Look, trim: Look) -> Item:
    """Returns a window: frame with bars, sill, and a pane that shows the outside."""
    lo, hi = -0.5 * width_m, 0.5 * width_m
    bar, out = 0.05, OUTER_WALL_M - 0.02
    bars = [((lo, lo + bar), z0, z1), ((hi - bar, hi), z0, z1), ((lo, hi), z0, z0 + bar), ((lo, hi), z1 - bar, z1)]
    if width_m > 0.85:
        bars.append(((-0.025, 0.025), z0, z1))
    if z1 - z0 > 1.3:
        bars.append(((lo, hi), z0 + 0.66 * (z1 - z0), z0 + 0.66 * (z1 - z0) + 0.04))
    frame: list[Box3] = [(*span, out - 0.06, out, b, t) for span, b, t in bars]
    frame.append((lo - 0.04, hi + 0.04, -HALF_WALL_M - 0.03, out, z0 - 0.025, z0))
    pane = (lo, hi, out - 0.02, OUTER_WALL_M, z0, z1)
    return structure_item("window", "pane", [oriented_box(pane, view, "north"), *visual_boxes(frame, trim)])


def place_door(hole: Opening, items: OpeningItems) -> list[PlacedItem]:
    """Returns the frame of a door and its leaf if it has one: two items, both labelled door."""
    placed = [place_in_wall(items.frame(hole), hole)]
    lo, hi = hole.clear_span()
    if hole.kind == "entry":
        leaf = items.leaf(round(hi - lo, 4), hole.top_m - JAMB_M, 0.0)
        yaw = 0.0 if hole.side in ("north", "south") else math.pi / 2
        placed.append(PlacedItem(leaf, *hole.point(lo), 0.0, yaw))  # at the end of the floor: nothing is visible below
    elif hole.leaf is not None:
        placed.append(place_leaf(hole, items))
    return placed


def place_leaf(hole: Opening, items: OpeningItems) -> PlacedItem:
    """Returns the leaf of an inner door, `hole.leaf`, turned about its hinge into the room that it opens to."""
    assert hole.leaf is not None
    lo, hi = hole.clear_span()
    leaf = items.leaf(round(hi - lo - 0.004, 4), hole.top_m - JAMB_M - 0.006, 0.01)
    side = hole.side_of(hole.leaf.room)
    along = math.pi / 2 if side in ("east", "west") else 0.0
    closed = along if hole.leaf.hinge_at_start else along + math.pi
    swing = 1.0 if math.sin(INWARD_YAW_RAD[side] - closed) > 0 else -1.0
    at_hinge = (lo + 0.002) if hole.leaf.hinge_at_start else (hi - 0.002)
    x, y = side_point(side, at_hinge, hole.line_m - outward(side) * (HALF_WALL_M + 0.004 + 0.02))
    angle_rad, widest_rad = hole.leaf.angle_rad, hole.leaf.widest_rad
    hinge = None if widest_rad is None else Hinge(angle_rad, widest_rad, turns_left=swing > 0)
    return PlacedItem(leaf, x, y, 0.0, closed + swing * angle_rad, hinge)


def _frame(width_m: float, top: float, outside: bool, looks: StructureLooks) -> Item:
    """Returns a door frame: jambs that collide, boards around them on each visible face of the wall, a flat saddle."""
    lo, hi = -0.5 * width_m, 0.5 * width_m
    inner, outer = -HALF_WALL_M - 0.004, OUTER_WALL_M if outside else HALF_WALL_M + 0.004
    jambs: list[Box3] = [(*span, inner, outer, 0.0, top) for span in ((lo, lo + JAMB_M), (hi - JAMB_M, hi))]
    boards: list[Box3] = [(lo + JAMB_M, hi - JAMB_M, inner, outer, top - JAMB_M, top)]
    boards.append((lo + JAMB_M, hi - JAMB_M, -SADDLE_M[0] / 2, SADDLE_M[0] / 2, 0.0, SADDLE_M[1]))
    wide, thick = CASING_M
    reveal = JAMB_M - 0.008
    for face in (-1.0,) if outside else (-1.0, 1.0):
        near, far = sorted((face * HALF_WALL_M, face * (HALF_WALL_M + thick)))
        for a, b in ((lo + JAMB_M - wide, lo + reveal), (hi - reveal, hi - JAMB_M + wide)):
            boards.append((a, b, near, far, 0.0, top - JAMB_M + wide))
        boards.append((lo + reveal, hi - reveal, near, far, top - reveal, top - JAMB_M + wide))
    geoms = [oriented_box(box, looks.door_frame) for box in jambs]
    return structure_item("door", "frame", [*geoms, *visual_boxes(boards, looks.door_frame)])


def _leaf_geoms(width_m: float, high_m: float, looks: StructureLooks, gap_m: float) -> list[Geom]:
    """Returns a leaf 4 cm thick with its hinge at the origin, along +x, `gap_m` above the floor."""
    half = 0.02
    geoms = [oriented_box((0.0, width_m, -half, half, gap_m, high_m), looks.door, "north")]
    for z0, z1 in ((0.18, 0.88), (1.08, high_m - 0.16)):
        box = (0.13, width_m - 0.13, -half - 0.006, half + 0.006, z0, z1)
        geoms.append(oriented_box(box, looks.door, "north", solid=False))
    at = width_m - 0.06
    handle = [(at - 0.012, at + 0.012, -half - 0.05, half + 0.05, 1.01, 1.03)]
    handle += [(at - 0.11, at + 0.012, s - 0.009, s + 0.009, 1.008, 1.032) for s in (-half - 0.05, half + 0.05)]
    return [*geoms, *visual_boxes(handle, looks.handle)]
