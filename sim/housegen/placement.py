"""Where things can stand, hang and lie in one room: clearances, walls, doors, and the way the robot needs.

A `RoomSpace` remembers what a room holds and answers with places. It refuses whatever would overlap another thing,
stand in a doorway or before a window, or cut the room's free floor in two; the check of the finished house then
measures the same on the real geoms.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.housegen.furniture.item import Geom, Item, Surface
from sim.housegen.furniture.workbench import euler_from_matrix, geom_bounds, matrix_from_euler
from sim.housegen.merging import touched_at_most
from sim.housegen.mjcf import Placed
from sim.housegen.openings import HALF_WALL_M, Opening, leaf_keep_out
from sim.housegen.rectangles import (
    INWARD_YAW_RAD,
    OPPOSITE,
    SIDES,
    Interval,
    Rect,
    Side,
    footprint,
    rotated_extent,
    subtract,
)

Along = Literal["any", "middle", "corner"]
"""Where along a wall: anywhere, as near its middle as can be, or in a corner."""

CELL_M = 0.05
MAX_WALKS = 16
"""Places along the walls that are given up one after the other because they would cut the room in two."""
GRID_M = 0.3
"""Between the places in a room that are tried for what stands free."""
ROBOT_M = 0.22
"""Half the width kept free for the robot: its radius of 0.18 m and 4 cm to spare."""
ROBOT_HEIGHT_M = 0.9
REACH_M = 0.8
"""A thing counts as reachable when the robot's centre gets this near to its footprint in plan."""
WALL_GAP_M = 0.016
"""Between furniture and wall: the baseboard."""
LOW_M = 0.9
"""Lower things may stand before any window."""
DOORWAY_DEPTH_M = 0.7
"""How far in front of a doorway nothing may stand."""


@dataclass(frozen=True)
class Block:
    """Space that is taken: a footprint between two heights."""

    rect: Rect
    z0_m: float
    z1_m: float


@dataclass(frozen=True)
class Standing:
    """A placed item with its footprint in the world, for others to be placed against."""

    placed: Placed
    rect: Rect
    side: Side | None = None
    """The wall it stands against."""


class RoomSpace:
    """One room while it is furnished."""

    def __init__(self, index: int, kind: str, rect: Rect, openings: Sequence[Opening], ceiling_m: float) -> None:
        self.kind = kind
        self.inner = rect.grown(-HALF_WALL_M)
        self.ceiling_m = ceiling_m
        self.standing: list[Standing] = []
        self._blocks: list[Block] = []
        self._clear: list[tuple[Rect, Rect]] = []  # footprint of the owner, its zone
        self._keep_out: list[Rect] = []
        self._gates: list[tuple[float, float]] = []
        self._holes: dict[Side, list[Opening]] = {side: [] for side in SIDES}
        self._on_surface: dict[tuple[int, int], list[Rect]] = {}
        self._walks = 0  # how often the robot's ways were looked at
        shape = (math.ceil(self.inner.depth_m / CELL_M) + 2, math.ceil(self.inner.width_m / CELL_M) + 2)
        self._taken = np.zeros(shape, dtype=np.uint8)
        self._taken[[0, -1], :] = 1
        self._taken[:, [0, -1]] = 1
        for opening in openings:
            if index in (opening.a, opening.b):
                self._add_opening(index, rect, opening)

    def windows(self) -> list[tuple[Side, Opening]]:
        """The room's windows and the sides they are on."""
        return [(side, hole) for side in SIDES for hole in self._holes[side] if hole.kind == "window"]

    def doors(self) -> list[tuple[Side, Opening]]:
        """Whatever one can walk through, and the front door."""
        return [(side, hole) for side in SIDES for hole in self._holes[side] if hole.kind != "window"]

    def filled_share(self) -> float:
        """Part of the floor that things stand on."""
        taken = sum(
            s.placed.item.size_m[0] * s.placed.item.size_m[1]
            for s in self.standing
            if s.placed.item.mount == "floor" and not s.placed.item.walk_over
        )
        return taken / self.inner.area_m2

    def wall_length(self, side: Side) -> float:
        """Longest stretch of a side without a door."""
        return max((hi - lo for lo, hi in self._stretches(side)), default=0.0)

    # ---- places on the floor -----------------------------------------------------------------------------------

    def against_wall(
        self,
        rng: np.random.Generator,
        item: Item,
        *,
        sides: Sequence[Side] | None = None,
        along: Along = "any",
        front_m: float = 0.6,
        beside_m: float = 0.0,
        gap_m: float = WALL_GAP_M,
    ) -> Standing | None:
        """Put an item with its back to a wall; None where it fits nowhere.

        Args:
            rng: decides between equal places.
            item: floor item.
            sides: walls allowed, tried in this order; all in random order when None.
            along: where along the wall.
            front_m: floor kept free before it.
            beside_m: floor kept free on either side (nightstands, chairs).
            gap_m: between its back and the wall.
        """
        order = list(sides) if sides is not None else [SIDES[i] for i in rng.permutation(4)]
        patience = self._walks + MAX_WALKS
        for side in order:
            for at in self._positions(rng, side, item.size_m[1], along, beside_m):
                if self._walks >= patience:
                    return None
                standing = self._stand(item, side, at, gap_m)
                zones = [_ahead(standing.rect, side, front_m)] if front_m else []
                if self._blocks_window(side, standing.rect, item.size_m[2]):
                    continue
                if self.try_put(standing, zones):
                    return standing
        return None

    def in_middle(
        self,
        rng: np.random.Generator,
        item: Item,
        seats: Sequence[tuple[float, float, float]],
        *,
        around_m: float,
        least: float = 0.0,
        apart_m: float = 0.0,
    ) -> Standing | None:
        """Put an item where most of its seats can be used, nearer the room's middle rather than not.

        Args:
            rng: decides between places.
            item: floor item.
            seats: x, y in the item's frame and the radius of the free floor wanted there.
            around_m: how far from the walls it stays if it can.
            least: share of the seats that must be usable; two of them must be anyhow.
            apart_m: how far from walls and other things it stays at least.
        """
        best: tuple[int, Standing] | None = None
        for x, y, yaw in self._spots_inside(rng, item, around_m):
            standing = Standing(Placed(item, x, y, 0.0, yaw), footprint(x, y, item.size_m[0], item.size_m[1], yaw))
            around = standing.rect.grown(apart_m)
            if not self.inner.contains(around, 0.01) or not self._is_clear(around, 0.0, item.size_m[2], None):
                continue
            usable = sum(self._seat_free(standing, seat) for seat in seats)
            if usable < max(min(2, len(seats)), least * len(seats)) or (best is not None and usable <= best[0]):
                continue
            if any(standing.rect.overlaps(zone, 0.01) for _, zone in self._clear) or not self._allows(standing):
                continue
            best = (usable, standing)
            if usable == len(seats):
                break
        return best[1] if best is not None and self.try_put(best[1], []) else None

    def _spots_inside(
        self, rng: np.random.Generator, item: Item, around_m: float
    ) -> Iterator[tuple[float, float, float]]:
        """Places and headings away from the walls: a few about the middle, then all over the room."""
        longer = 0.0 if self.inner.depth_m > self.inner.width_m else math.pi / 2
        cx, cy = self.inner.centre
        for n in range(12):
            yaw = longer if n % 4 else longer - math.pi / 2
            ex, ey = rotated_extent(item.size_m[0], item.size_m[1], yaw)
            free_x, free_y = (
                max(0.0, size / 2 - extent / 2 - around_m) * min(1.0, n / 12)
                for size, extent in ((self.inner.width_m, ex), (self.inner.depth_m, ey))
            )
            yield cx + float(rng.uniform(-1, 1)) * free_x, cy + float(rng.uniform(-1, 1)) * free_y, yaw
        xs = np.arange(self.inner.x0 + 0.6, self.inner.x1 - 0.5, GRID_M)
        ys = np.arange(self.inner.y0 + 0.6, self.inner.y1 - 0.5, GRID_M)
        spots = sorted((abs(float(x) - cx) + abs(float(y) - cy), float(x), float(y)) for x in xs for y in ys)
        for yaw in (longer, longer - math.pi / 2):
            for _, x, y in spots:
                yield x, y, yaw

    def _seat_free(self, host: Standing, seat: tuple[float, float, float]) -> bool:
        """Whether the floor round a seat of something is free."""
        c, s = math.cos(host.placed.yaw_rad), math.sin(host.placed.yaw_rad)
        x, y = host.placed.x_m + c * seat[0] - s * seat[1], host.placed.y_m + s * seat[0] + c * seat[1]
        spot = Rect(x - seat[2], y - seat[2], x + seat[2], y + seat[2])
        return (
            self.inner.contains(spot)
            and self._is_clear(spot, 0.0, ROBOT_HEIGHT_M, None)
            and not any(spot.overlaps(zone, 0.01) for _, zone in self._clear)
        )

    def _allows(self, standing: Standing) -> bool:
        """Whether the robot still gets everywhere with something there."""
        raster = self._taken.copy()
        self._mark(raster, standing.rect)
        return self._walkable(raster, [standing.rect])

    def at(self, item: Item, x_m: float, y_m: float, yaw_rad: float, zones: Sequence[Rect] = ()) -> Standing | None:
        """Put an item exactly there if it fits."""
        standing = Standing(
            Placed(item, x_m, y_m, 0.0, yaw_rad), footprint(x_m, y_m, item.size_m[0], item.size_m[1], yaw_rad)
        )
        return standing if self.try_put(standing, zones) else None

    def tucked(
        self, item: Item, host: Standing, x_m: float, y_m: float, yaw_rad: float, out_m: float = 0.3
    ) -> Standing | None:
        """Put an item partly under `host` (a chair, a table), drawn back along its own -x until nothing touches."""
        c, s = math.cos(yaw_rad), math.sin(yaw_rad)
        host_boxes = geom_boxes(touched_at_most(host.placed.item), host.placed)
        shapes = touched_at_most(item)
        for step in range(int(out_m / 0.04) + 1):
            x, y = x_m - c * 0.04 * step, y_m - s * 0.04 * step
            placed = Placed(item, x, y, 0.0, yaw_rad)
            if boxes_touch(geom_boxes(shapes, placed), host_boxes, 0.015):
                continue
            standing = Standing(placed, footprint(x, y, item.size_m[0], item.size_m[1], yaw_rad))
            return standing if self.try_put(standing, [], ignore=host.rect) else None
        return None

    def near_on_wall(
        self, item: Item, side: Side, at: float, *, front_m: float = 0.6, slide_m: float = 0.8
    ) -> Standing | None:
        """Put an item against a wall at a place along it, or up to `slide_m` beside that place."""
        lo, hi = self.inner.span(side)
        half = item.size_m[1] / 2
        for step in range(int(slide_m / 0.1) + 1):
            for sign in (1.0, -1.0) if step else (1.0,):
                place = at + sign * 0.1 * step
                span = (place - half, place + half)
                free = any(a - 0.002 <= span[0] and span[1] <= b + 0.002 for a, b in self._stretches(side))
                if span[0] < lo - 0.002 or span[1] > hi + 0.002 or not free:
                    continue
                standing = self._stand(item, side, place, WALL_GAP_M)
                zones = [_ahead(standing.rect, side, front_m)] if front_m else []
                if not self._blocks_window(side, standing.rect, item.size_m[2]) and self.try_put(standing, zones):
                    return standing
        return None

    def row_start(self, items: Sequence[Item], side: Side, front_m: float, gap_m: float) -> float | None:
        """Where a row of items can begin along a side, in a corner if it can be; None where it fits nowhere."""
        length = sum(item.size_m[1] + gap_m for item in items)
        for lo, hi in sorted(self._stretches(side), key=lambda s: s[0] - s[1]):
            spare = hi - lo - length - 0.006
            if spare < 0:
                continue
            steps = np.arange(0.0, spare, 0.1).tolist()
            for shift in (0.0, spare, *steps[1:]):
                if self._row_fits(items, side, lo + 0.003 + shift, front_m, gap_m):
                    return lo + 0.003 + shift
        return None

    def _row_fits(self, items: Sequence[Item], side: Side, start: float, front_m: float, gap_m: float) -> bool:
        at = start
        for item in items:
            standing = self._stand(item, side, at + item.size_m[1] / 2, WALL_GAP_M)
            zone = _ahead(standing.rect, side, front_m)
            at += item.size_m[1] + gap_m
            if (
                self._blocks_window(side, standing.rect, item.size_m[2])
                or not self._is_clear(standing.rect, 0.0, item.size_m[2], None)
                or self._zone_blocked(zone)
                or any(standing.rect.overlaps(other, 0.01) for _, other in self._clear)
            ):
                return False
        return True

    def release(self, standing: Standing) -> None:
        """Give up the free zone of something, for what belongs in it (a table before a sofa, chairs at a table)."""
        self._clear = [(owner, zone) for owner, zone in self._clear if owner != standing.rect]

    def reserve(self, standing: Standing, front_m: float) -> None:
        """Keep the floor free again before something that stands against a wall."""
        if standing.side is not None:
            self._clear.append((standing.rect, _ahead(standing.rect, standing.side, front_m)))

    def lay(self, item: Item, x_m: float, y_m: float, yaw_rad: float) -> bool:
        """Lay a flat thing (a rug) on the floor; others may stand on it, no other flat thing may overlap it."""
        rect = footprint(x_m, y_m, item.size_m[0], item.size_m[1], yaw_rad)
        flat = [s.rect for s in self.standing if s.placed.item.walk_over]
        leaves = [zone for zone in self._keep_out if rect.overlaps(zone, 0.25)]
        if not self.inner.contains(rect.grown(0.03)) or any(rect.overlaps(r) for r in flat) or leaves:
            return False
        self.standing.append(Standing(Placed(item, x_m, y_m, 0.0, yaw_rad), rect))
        return True

    def try_put(self, standing: Standing, zones: Sequence[Rect], *, ignore: Rect | None = None) -> bool:
        """Add a floor item if nothing is in its way, its zones are clear and the robot still gets everywhere."""
        item, rect = standing.placed.item, standing.rect
        if not self.inner.contains(rect, 0.002) or not self._is_clear(rect, 0.0, item.size_m[2], ignore):
            return False
        if any(rect.overlaps(zone, 0.01) for owner, zone in self._clear if owner != ignore):
            return False
        if any(self._zone_blocked(zone) for zone in zones):
            return False
        raster = self._taken.copy()
        self._mark(raster, rect)
        others = [s.rect for s in self.standing if s.placed.item.mount == "floor" and not s.placed.item.walk_over]
        if not self._walkable(raster, [*others, rect]):
            return False
        self._taken = raster
        self._clear += [(rect, zone) for zone in zones]
        self._add(standing, 0.0)
        return True

    # ---- places on walls, tops and the ceiling -----------------------------------------------------------------

    def on_wall(
        self,
        rng: np.random.Generator,
        item: Item,
        *,
        bottom_m: float | None = None,
        sides: Sequence[Side] | None = None,
        along: Along = "any",
        at: float | None = None,
        margin_m: float = 0.05,
        over_floor: bool = False,
    ) -> Standing | None:
        """Hang an item on a wall, its origin at `bottom_m` (the item's usual height when None).

        `at` fixes the place along the wall (of the only side given); `margin_m` keeps others away; with `over_floor`
        nothing may stand below it.
        """
        bottom = item.mount_height_m if bottom_m is None else bottom_m
        top = bottom + item.size_m[2]
        if top > self.ceiling_m - 0.03:
            return None
        order = list(sides) if sides is not None else [SIDES[i] for i in rng.permutation(4)]
        for side in order:
            places = [at] if at is not None else self._positions(rng, side, item.size_m[1], along, 0.1)
            for place in places:
                span = (place - item.size_m[1] / 2, place + item.size_m[1] / 2)
                rect = self.inner.strip(side, span, item.size_m[0])
                padded = self.inner.strip(side, (span[0] - margin_m, span[1] + margin_m), item.size_m[0] + 0.02)
                if not self.inner.contains(rect, 0.002) or self._meets_hole(side, span, bottom, top):
                    continue
                lowest = 0.0 if over_floor else bottom - margin_m
                if not self._is_clear(padded, lowest, top + margin_m, None, doorways=bottom < 2.0):
                    continue
                x, y = self._on_line(side, place, 0.0)
                standing = Standing(Placed(item, x, y, bottom, INWARD_YAW_RAD[side]), rect, side)
                if bottom < ROBOT_HEIGHT_M and item.size_m[0] > 0.12:
                    raster = self._taken.copy()
                    self._mark(raster, rect)
                    if not self._walkable(raster, [rect]):
                        continue
                    self._taken = raster
                self.standing.append(standing)
                self._blocks.append(Block(rect, 0.0 if over_floor else bottom, top))
                return standing
        return None

    def dress_window(self, item: Item, side: Side, window: Opening) -> bool:
        """Hang a curtain or blind before a window, its top a little above it, over whatever stands below the sill."""
        top = min(window.top_m + 0.14, self.ceiling_m - 0.02)
        bottom = top - item.size_m[2]
        half = item.size_m[1] / 2
        span = (window.centre_m - half, window.centre_m + half)
        rect = self.inner.strip(side, span, item.size_m[0])
        if bottom < 0.01 or not self.inner.contains(rect, 0.002):
            return False
        if not self._is_clear(rect, bottom, top, None):
            return False
        x, y = self._on_line(side, window.centre_m, 0.0)
        self._add(Standing(Placed(item, x, y, bottom, INWARD_YAW_RAD[side]), rect, side), bottom)
        return True

    def on_top(
        self,
        rng: np.random.Generator,
        host: Standing,
        item: Item,
        *,
        kind: str = "top",
        face: float | None = None,
        back: bool = False,
    ) -> bool:
        """Put a small thing on one of the host's surfaces of this kind; False where there is no room left.

        Args:
            rng: decides where.
            host: what it stands on.
            item: the thing, mount "top".
            kind: kind of surface.
            face: yaw against the host's front; any when None.
            back: True to put it at the rear edge, in the middle if it can be.
        """
        for number, surface in enumerate(host.placed.item.surfaces):
            if surface.kind != kind:
                continue
            spot = self._spot(rng, host, number, surface, item, face, back)
            if spot is not None:
                self.standing.append(spot)
                return True
        return False

    def carries(self, host: Standing) -> bool:
        """Whether something stands or lies on a floor item's surfaces."""
        tops = [surface.centre_m[2] for surface in host.placed.item.surfaces]
        return any(
            other is not host
            and other.rect.overlaps(host.rect)
            and any(abs(other.placed.z_m - host.placed.z_m - top) < 0.03 for top in tops)
            for other in self.standing
        )

    def on_ceiling(self, item: Item, x_m: float, y_m: float) -> bool:
        """Hang a lamp from the ceiling."""
        rect = footprint(x_m, y_m, item.size_m[0], item.size_m[1], 0.0)
        if not self._is_clear(rect, self.ceiling_m - item.size_m[2], self.ceiling_m, None, doorways=False):
            return False
        self._add(Standing(Placed(item, x_m, y_m, self.ceiling_m), rect), self.ceiling_m - item.size_m[2])
        return True

    def all_reachable(self, wanted: Callable[[str], bool]) -> bool:
        """True where every thing on the floor whose category is wanted can be approached."""
        rects = [s.rect for s in self.standing if wanted(s.placed.item.category)]
        return self._walkable(self._taken, rects)

    # ---- inside ------------------------------------------------------------------------------------------------

    def _add_opening(self, index: int, rect: Rect, opening: Opening) -> None:
        side = opening.side_of(index)
        self._holes[side].append(opening)
        if opening.kind == "window":
            return
        lo, hi = opening.clear_span()
        if opening.kind == "open":
            middle, half = opening.centre_m, min(0.6, (hi - lo) / 2)
            lo, hi = middle - half, middle + half
        depth = DOORWAY_DEPTH_M if opening.kind != "entry" else 0.9
        self._keep_out.append(self.inner.strip(side, (lo - 0.06, hi + 0.06), depth))
        if opening.leaf is not None and opening.leaf.room == index:
            zone = leaf_keep_out(opening, rect)
            self._keep_out.append(zone)
            self._mark(self._taken, self._leaf_rect(opening, rect))
        if opening.kind != "entry":
            strip = self.inner.strip(side, (lo, hi), 0.3)
            x, y = strip.centre
            self._gates.append((x, y))

    @staticmethod
    def _leaf_rect(opening: Opening, rect: Rect) -> Rect:
        """Footprint of an ajar leaf."""
        assert opening.leaf is not None
        lo, hi = opening.clear_span()
        reach = (hi - lo) * math.cos(opening.leaf.angle_rad)
        span = (lo, lo + reach) if opening.leaf.hinge_at_start else (hi - reach, hi)
        a, b = sorted(span)
        return rect.strip(opening.side_of(opening.leaf.room), (a - 0.02, b + 0.02), (hi - lo) + 0.08)

    def _stretches(self, side: Side) -> list[Interval]:
        """Parts of a side where something can stand: none where one walks through."""
        holes = [hole.span for hole in self._holes[side] if hole.kind != "window"]
        return subtract(self.inner.span(side), holes, 0.05)

    def _positions(
        self,
        rng: np.random.Generator,
        side: Side,
        width_m: float,
        along: Along,
        beside_m: float,
    ) -> list[float]:
        """Places along a side for something of this width, the best first."""
        places: list[tuple[float, float]] = []
        for lo, hi in self._stretches(side):
            a, b = lo + width_m / 2 + beside_m, hi - width_m / 2 - beside_m
            if b < a:
                a, b = lo + width_m / 2, hi - width_m / 2
                if b < a:
                    continue
            count = max(1, min(24, int((b - a) / 0.1) + 1))
            for at in np.linspace(a, b, count) if count > 1 else [0.5 * (a + b)]:
                centre = 0.5 * sum(self.inner.span(side))
                corner = min(at - lo, hi - at)
                score = {"middle": abs(at - centre), "corner": corner, "any": 0.0}[along]
                places.append((score + float(rng.uniform(0.0, 0.4 if along != "any" else 1.0)), float(at)))
        return [at for _, at in sorted(places)]

    def _on_line(self, side: Side, at: float, inward_m: float) -> tuple[float, float]:
        """The point at a place along a side, some way into the room."""
        sign = 1.0 if side in ("east", "north") else -1.0
        line = self.inner.line(side) - sign * inward_m
        return (line, at) if side in ("east", "west") else (at, line)

    def _stand(self, item: Item, side: Side, at: float, gap_m: float) -> Standing:
        x, y = self._on_line(side, at, item.size_m[0] / 2 + gap_m)
        yaw = INWARD_YAW_RAD[side]
        return Standing(Placed(item, x, y, 0.0, yaw), footprint(x, y, item.size_m[0], item.size_m[1], yaw), side)

    def _blocks_window(self, side: Side, rect: Rect, height_m: float) -> bool:
        lo, hi = rect.span(side)
        return any(
            hole.kind == "window"
            and height_m > max(hole.bottom_m, LOW_M) + 0.05
            and hi > hole.span[0] - 0.02
            and lo < hole.span[1] + 0.02
            for hole in self._holes[side]
        )

    def _meets_hole(self, side: Side, span: Interval, bottom_m: float, top_m: float) -> bool:
        return any(
            span[1] > hole.span[0] - 0.09 and span[0] < hole.span[1] + 0.09
            and top_m > hole.bottom_m - 0.06 and bottom_m < hole.top_m + 0.09
            for hole in self._holes[side]
        )  # fmt: skip

    def _is_clear(self, rect: Rect, z0: float, z1: float, ignore: Rect | None, *, doorways: bool = True) -> bool:
        """True where no block and no doorway is in the way."""
        if doorways and any(rect.overlaps(zone, 0.005) for zone in self._keep_out):
            return False
        return not any(
            block.rect.overlaps(rect, 0.003) and block.z0_m < z1 - 0.002 and block.z1_m > z0 + 0.002
            for block in self._blocks
            if block.rect != ignore
        )

    def _zone_blocked(self, zone: Rect) -> bool:
        if not self.inner.grown(0.05).contains(zone, 0.06):
            return True
        return any(block.rect.overlaps(zone, 0.02) and block.z0_m < ROBOT_HEIGHT_M for block in self._blocks)

    def _mark(self, raster: NDArray[np.uint8], rect: Rect) -> None:
        raster[self._window(rect)] = 1

    def _window(self, rect: Rect) -> tuple[slice, slice]:
        """Cells that a rectangle touches."""
        c0 = max(0, math.floor((rect.x0 - self.inner.x0) / CELL_M) + 1)
        c1 = math.ceil((rect.x1 - self.inner.x0) / CELL_M) + 1
        r0 = max(0, math.floor((rect.y0 - self.inner.y0) / CELL_M) + 1)
        r1 = math.ceil((rect.y1 - self.inner.y0) / CELL_M) + 1
        return slice(r0, r1), slice(c0, c1)

    def _cell(self, x_m: float, y_m: float) -> tuple[int, int]:
        row = int((y_m - self.inner.y0) / CELL_M) + 1
        col = int((x_m - self.inner.x0) / CELL_M) + 1
        return min(max(row, 1), self._taken.shape[0] - 2), min(max(col, 1), self._taken.shape[1] - 2)

    def _walkable(self, raster: NDArray[np.uint8], rects: Sequence[Rect]) -> bool:
        """True where the robot gets from each doorway to all others, to nearly all floor, and near every rectangle."""
        self._walks += 1
        taken = raster.copy()
        for x, y in self._gates:  # walls beside a doorway do not stop a robot that passes through it
            row, col = self._cell(x, y)
            taken[max(row - 6, 0) : row + 7, max(col - 6, 0) : col + 7] = 0
        solid = np.maximum(taken, 0)
        blocked = cv2.dilate(solid, _DISC, borderType=cv2.BORDER_CONSTANT, borderValue=0)
        count, parts = cv2.connectedComponents((blocked == 0).astype(np.uint8), connectivity=4)
        if count < 2:
            return False
        if self._gates:
            names = {int(parts[self._cell(x, y)]) for x, y in self._gates}
            if len(names) != 1 or 0 in names:
                return False
            part = names.pop()
        else:
            part = 1 + int(np.argmax(np.bincount(parts.ravel())[1:]))
        sizes = np.bincount(parts.ravel())[1:]
        if sizes.sum() - sizes[part - 1] > POCKET_CELLS:
            return False
        away = cv2.distanceTransform((parts != part).astype(np.uint8), cv2.DIST_L2, 3)
        return all(away[self._window(rect)].min(initial=np.inf) * CELL_M < REACH_M for rect in rects)

    def _spot(
        self,
        rng: np.random.Generator,
        host: Standing,
        number: int,
        surface: Surface,
        item: Item,
        face: float | None,
        back: bool,
    ) -> Standing | None:
        """A free place on a surface, in the host's frame first, then in the world."""
        key = (id(host.placed), number)
        used = self._on_surface.setdefault(key, [])
        cx, cy, cz = surface.centre_m
        for n in range(8):
            turn = face if face is not None else float(rng.uniform(-math.pi, math.pi))
            ex, ey = rotated_extent(item.size_m[0], item.size_m[1], turn)
            sx, sy = surface.half_size_m[0] - ex / 2, surface.half_size_m[1] - ey / 2
            if sx < 0 or sy < 0:
                return None
            lx = cx - sx if back else cx + float(rng.uniform(-sx, sx))
            ly = cy + (0.0 if back and n == 0 else float(rng.uniform(-sy, sy)))
            rect = Rect(lx - ex / 2, ly - ey / 2, lx + ex / 2, ly + ey / 2)
            if any(rect.overlaps(other, 0.0) for other in used):
                continue
            yaw = host.placed.yaw_rad
            c, s = math.cos(yaw), math.sin(yaw)
            x, y = host.placed.x_m + c * lx - s * ly, host.placed.y_m + s * lx + c * ly
            z = host.placed.z_m + cz
            world = footprint(x, y, ex, ey, yaw)
            if not self._is_clear_above(host, world, z, z + item.size_m[2]):
                continue
            used.append(rect.grown(0.02))
            placed = Placed(item, x, y, z, yaw + turn)
            self._blocks.append(Block(world, z, z + item.size_m[2]))
            return Standing(placed, world)
        return None

    def _is_clear_above(self, host: Standing, rect: Rect, z0: float, z1: float) -> bool:
        return not any(
            block.rect.overlaps(rect, 0.0) and block.z0_m < z1 and block.z1_m > z0 + 0.002
            for block in self._blocks
            if block.rect != host.rect
        )

    def _add(self, standing: Standing, bottom_m: float) -> None:
        self.standing.append(standing)
        self._blocks.append(Block(standing.rect, bottom_m, bottom_m + standing.placed.item.size_m[2]))


def _ahead(rect: Rect, back: Side, length_m: float) -> Rect:
    """The zone before something that stands with its back to a side."""
    return rect.strip(OPPOSITE[back], rect.span(OPPOSITE[back]), 0.0, length_m)


def geom_boxes(solid: Sequence[Geom], placed: Placed) -> NDArray[np.float64]:
    """(n, 6) axis-aligned boxes x0 y0 z0 x1 y1 z1 of an item's solid geoms where it is placed."""
    turn = matrix_from_euler(0.0, 0.0, placed.yaw_rad)
    shift = np.array([placed.x_m, placed.y_m, placed.z_m])
    boxes = []
    for geom in solid:
        x, y, z = (float(v) for v in turn @ geom.pos_m)
        euler = euler_from_matrix(turn @ matrix_from_euler(*geom.euler_rad))
        low, high = geom_bounds(replace(geom, pos_m=(x, y, z), euler_rad=euler))
        boxes.append(np.concatenate([low + shift, high + shift]))
    return np.array(boxes).reshape(-1, 6)


def boxes_touch(a: NDArray[np.float64], b: NDArray[np.float64], margin_m: float) -> bool:
    """True where any box of `a` comes nearer than `margin_m` to any of `b` in all three axes."""
    gap = np.maximum(a[:, None, :3] - b[None, :, 3:], b[None, :, :3] - a[:, None, 3:])
    return bool((gap.max(axis=2) < margin_m).any())


POCKET_CELLS = 60
"""Floor that the robot would fit on but cannot get to, at most: 0.15 m2."""
_RADIUS_CELLS = round(ROBOT_M / CELL_M)
_DISC = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * _RADIUS_CELLS + 1, 2 * _RADIUS_CELLS + 1))
