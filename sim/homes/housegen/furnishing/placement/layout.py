"""The layout of one room while it is furnished: which space is occupied, and which must stay free."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.homes.housegen.floor_plan.rectangles import Interval, Rect, Side, subtract
from sim.homes.housegen.furnishing.placement.records import Placement
from sim.homes.housegen.furnishing.placement.walk_grid import WalkGrid
from sim.homes.housegen.furnishing.placement.walls import RoomWalls
from sim.homes.housegen.structure.openings import HALF_WALL_M, Opening, leaf_keep_out
from sim.world.arrangement import FIXTURE_APART_M
from sim.world.room_arrangement import HALLWAY_PATH_M

ROBOT_HEIGHT_M = 0.9
DOORWAY_DEPTH_M, ENTRY_DEPTH_M = 0.7, 0.9
"""Depth of the zone kept free on the room's side of a doorway, and of the front door."""


@dataclass(frozen=True)
class Block:
    """Occupied space: a footprint between two heights."""

    rect: Rect
    z0_m: float
    z1_m: float


@dataclass(frozen=True)
class Snapshot:
    """The state of a layout at one time."""

    placements: tuple[Placement, ...]
    blocks: tuple[Block, ...]
    reserved: tuple[tuple[Rect, Rect], ...]
    occupied: NDArray[np.uint8]
    on_surface: Mapping[tuple[int, int], tuple[Rect, ...]]


LEAF_PIECES = 4
"""Rectangles by which a door leaf is marked on the walking grid."""


class RoomLayout:
    """The placements of one room, and the tests whether another one fits."""

    def __init__(self, index: int, kind: str, rect: Rect, openings: Sequence[Opening], ceiling_m: float) -> None:
        self.kind = kind
        self.inner = rect.grown(-HALF_WALL_M)
        self.ceiling_m = ceiling_m
        self.walls = RoomWalls(self.inner)
        self.grid = WalkGrid(self.inner)
        self.placements: list[Placement] = []
        self._blocks: list[Block] = []
        self._reserved: list[tuple[Rect, Rect]] = []  # footprint of the owner, its zone
        self._keep_out: list[Rect] = []
        self._on_surface: dict[tuple[int, int], list[Rect]] = {}
        for opening in openings:
            if index in (opening.a, opening.b):
                self._add_opening(index, rect, opening)

    def filled_share(self) -> float:
        """Returns the share of the floor that furniture covers."""
        taken = sum(p.item.size_m[0] * p.item.size_m[1] for p in self._standing())
        return taken / self.inner.area_m2

    # ---- tests ---------------------------------------------------------------------------------------------------

    def is_clear(
        self, rect: Rect, z0_m: float, z1_m: float, *, ignore: Rect | None = None, doorways: bool = True
    ) -> bool:
        """Returns whether no block, other than those of footprint `ignore`, and no doorway overlaps a space."""
        if doorways and self.in_doorway(rect, 0.005):
            return False
        return not any(
            block.rect.overlaps(rect, 0.003) and block.z0_m < z1_m - 0.002 and block.z1_m > z0_m + 0.002
            for block in self._blocks
            if block.rect != ignore
        )

    def is_clear_above(self, host: Placement, rect: Rect, z0_m: float, z1_m: float) -> bool:
        """Returns whether a space above an item is free of everything but that item."""
        return not any(
            block.rect.overlaps(rect, 0.0) and block.z0_m < z1_m and block.z1_m > z0_m + 0.002
            for block in self._blocks
            if block.rect != host.rect
        )

    def in_doorway(self, rect: Rect, slack_m: float) -> bool:
        """Returns whether a rectangle overlaps the zone of a doorway or of a door leaf by more than `slack_m`."""
        return any(rect.overlaps(zone, slack_m) for zone in self._keep_out)

    def in_reserved_zone(self, rect: Rect, *, ignore: Rect | None = None) -> bool:
        """Returns whether a rectangle overlaps a reserved zone; zones of the item at `ignore` are skipped."""
        return any(rect.overlaps(zone, 0.01) for owner, zone in self._reserved if owner != ignore)

    def free_spans(self, side: Side, depth_m: float) -> list[Interval]:
        """Returns the parts of a side in front of which a strip of floor has no doorway and no furniture."""
        strip = self.inner.strip(side, self.inner.span(side), depth_m)
        blocks = [block.rect for block in self._blocks if block.z0_m < ROBOT_HEIGHT_M]
        holes = [rect.span(side) for rect in [*self._keep_out, *blocks] if rect.overlaps(strip, 0.005)]
        return subtract(self.inner.span(side), [*holes, *self.walls.gaps(side)], 0.3)

    def is_zone_free(self, zone: Rect) -> bool:
        """Returns whether a zone lies in the room and nothing at the robot's height stands in it."""
        if not self.inner.grown(0.05).contains(zone, 0.06):
            return False
        return not any(block.rect.overlaps(zone, 0.02) and block.z0_m < ROBOT_HEIGHT_M for block in self._blocks)

    def narrows_hallway(self, rect: Rect) -> bool:
        """Returns whether the room is a hallway in which an item of this footprint leaves too little width."""
        inner = self.inner
        if inner.width_m < inner.depth_m:
            free_m = max(rect.x0 - inner.x0, inner.x1 - rect.x1)
        else:
            free_m = max(rect.y0 - inner.y0, inner.y1 - rect.y1)
        return self.kind == "hallway" and free_m < HALLWAY_PATH_M

    # ---- changes -------------------------------------------------------------------------------------------------

    def try_put(self, placement: Placement, zones: Sequence[Rect] = (), *, ignore: Rect | None = None) -> bool:
        """Adds a floor item and reserves its zones; returns False, and changes nothing, if it does not fit.

        It fits where it overlaps nothing but the item of footprint `ignore`, its zones are free, and the robot can
        still reach everything.
        """
        rect, height_m = placement.rect, placement.item.size_m[2]
        if not self.inner.contains(rect, 0.002) or not self.is_clear(rect, 0.0, height_m, ignore=ignore):
            return False
        if placement.item.category != "objects" and self.narrows_hallway(rect):
            return False
        if self.in_reserved_zone(rect, ignore=ignore) or not all(self.is_zone_free(zone) for zone in zones):
            return False
        if not self.grid.stays_walkable(rect, [*(p.rect for p in self._standing()), rect]):
            return False
        self.grid.occupy(rect)
        self._reserved += [(rect, zone) for zone in zones]
        self.add(placement, 0.0, height_m)
        return True

    def add(self, placement: Placement, bottom_m: float, top_m: float) -> None:
        """Adds an item without any test; its footprint is occupied between two heights."""
        self.placements.append(placement)
        self._blocks.append(Block(placement.rect, bottom_m, top_m))

    def close_off(self, rect: Rect, passage: Rect) -> None:
        """Keeps items out of a part of the room (stairs, a stairwell) and off the floor by which it is reached."""
        self._blocks.append(Block(rect, 0.0, self.ceiling_m))
        self._keep_out.append(passage)
        self.grid.occupy(rect)

    def reserve(self, placement: Placement, zones: Sequence[Rect]) -> None:
        """Keeps the floor of some zones free for an item."""
        self._reserved += [(placement.rect, zone) for zone in zones]

    def release_zones(self, placement: Placement) -> None:
        """Frees the zones of an item for the items that belong there: a table in front of a sofa, chairs at a table."""
        self._reserved = [(owner, zone) for owner, zone in self._reserved if owner != placement.rect]

    def used_on_surface(self, host: Placement, number: int) -> list[Rect]:
        """Returns the list of rectangles used on a surface of an item, in the item's frame; new ones are appended."""
        return self._on_surface.setdefault((id(host.placed), number), [])

    def snapshot(self) -> Snapshot:
        """Returns the present state of the layout, for `restore`."""
        used = {key: tuple(rects) for key, rects in self._on_surface.items()}
        return Snapshot(tuple(self.placements), tuple(self._blocks), tuple(self._reserved), self.grid.occupied(), used)

    def restore(self, state: Snapshot) -> None:
        """Removes everything that was added after a snapshot was taken."""
        self.placements[:] = state.placements
        self._blocks[:] = state.blocks
        self._reserved[:] = state.reserved
        self._on_surface = {key: list(rects) for key, rects in state.on_surface.items()}
        self.grid.set_occupied(state.occupied)

    # ---- inside --------------------------------------------------------------------------------------------------

    def _standing(self) -> list[Placement]:
        """Returns the items on the floor that cannot be walked over."""
        return [p for p in self.placements if p.item.mount == "floor" and not p.item.walk_over]

    def _add_opening(self, index: int, rect: Rect, opening: Opening) -> None:
        side = opening.side_of(index)
        self.walls.add_opening(side, opening)
        if opening.kind == "window":
            return
        lo, hi = opening.clear_span()
        if opening.kind == "open":
            middle, half = opening.centre_m, min(0.6, (hi - lo) / 2)
            lo, hi = middle - half, middle + half
        depth_m = DOORWAY_DEPTH_M if opening.kind != "entry" else ENTRY_DEPTH_M
        self._keep_out.append(self.inner.strip(side, (lo - 0.06, hi + 0.06), depth_m))
        if opening.leaf is not None and opening.leaf.room == index:
            apart_m = FIXTURE_APART_M if self.kind == "bathroom" else 0.0
            self._keep_out.append(leaf_keep_out(opening, rect).grown(apart_m))
            for part in _leaf_rects(opening, rect):
                self.grid.occupy(part)
        if opening.kind != "entry":
            self.grid.add_doorway(*self.inner.strip(side, (lo, hi), 0.3).centre)


def _leaf_rects(opening: Opening, rect: Rect) -> list[Rect]:
    """Returns rectangles along the footprint of a door leaf in a room of rectangle `rect`, from the hinge on."""
    assert opening.leaf is not None
    lo, hi = opening.clear_span()
    side, angle_rad = opening.side_of(opening.leaf.room), opening.leaf.standing_rad
    pieces = []
    for n in range(LEAF_PIECES):
        near, far = ((hi - lo) * (n + k) / LEAF_PIECES for k in (0, 1))
        a, b = sorted(r * math.cos(angle_rad) for r in (near, far))
        span = (lo + a - 0.02, lo + b + 0.02) if opening.leaf.hinge_at_start else (hi - b - 0.02, hi - a + 0.02)
        inward_m, outward_m = far * math.sin(angle_rad) + 0.08, 0.02 - near * math.sin(angle_rad)
        pieces.append(rect.strip(side, span, inward_m, outward_m))
    return pieces
