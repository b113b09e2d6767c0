"""Furniture that belongs together: a bed and its nightstands, a table and its chairs, a desk and the items on it.

Each function puts its group into a room and returns its main item, or None if the room has no position for it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from sim.homes.housegen.floor_plan.rectangles import Interval, Rect
from sim.homes.housegen.furnishing.furniture_source import FurnitureSource
from sim.homes.housegen.furnishing.placement import Placement, RoomLayout
from sim.homes.housegen.furnishing.placement.floor import put_against_wall, put_partly_under
from sim.homes.housegen.furnishing.placement.free_standing import put_in_middle
from sim.homes.housegen.furnishing.placement.on_walls import hang_from_ceiling
from sim.homes.housegen.furnishing.placement.surfaces import put_on_surface
from sim.homes.housegen.furnishing.steps import hang_above, lay_rug, place, place_beside, place_in_front, put_on_top
from sim.homes.housegen.furniture.item import Item
from sim.world import room_arrangement

MIN_CHAIRS = 2
"""Least number of chairs at a dining table; a table for which fewer fit is not placed."""
LARGE_DINING_M2, LONG_TABLE_M = 16.0, 2.0
"""Floor area from which a dining room gets a long table, and its length."""
EVEN_M = 0.2
"""Largest distance of the mean of the seats in use from the middle of a table for four or more."""
PLACE_M = 0.58
"""Least length of table for one person: Neufert gives 0.6 m."""
DOUBLE_M = 1.1
"""Least width of the mattress of a bed with two pillows."""
BESIDE_BED_M = 0.65
"""Free floor along a long side of a bed; the check of the finished house asks for a little less."""
NIGHTSTAND_M = 0.6
"""Length at the head of a bed where a nightstand may stand."""
BOTH = (1.0, -1.0)
"""The two long sides of a bed."""
NARROW_BED: tuple[tuple[tuple[float, ...], bool], ...] = (
    (BOTH, True),
    (BOTH, False),
    ((1.0,), False),
    ((-1.0,), False),
)
"""Free long sides of a narrow bed and whether each has room for a nightstand, in the order in which they are tried."""

Seat = tuple[float, float, float]
"""x, y where a chair meets the table's edge, in the table's frame, and the heading of its front."""


def bed_group(layout: RoomLayout, source: FurnitureSource, *, large: bool) -> Placement | None:
    """Places a bed with its head to a wall, nightstands with lamps, perhaps a bench, a rug and a picture."""
    bed = _place_bed(layout, source, large=large)
    if bed is None:
        return None
    if source.chance(0.5):
        bench = source.make("seating", "plain")
        if bench is not None and bench.size_m[1] <= bed.item.size_m[1] + 0.1:
            place_in_front(layout, bed, bench, 0.05, facing=False)
    if source.chance(0.95 if layout.inner.area_m2 > 13 else 0.6):
        size_m = (1.7, 2.4) if layout.inner.area_m2 > 13 else None
        x, y = bed.to_world(0.25 * bed.item.size_m[0] + 0.15, 0.0)
        if not lay_rug(layout, source, x, y, bed.placed.yaw_rad, size_m=size_m):
            lay_rug(layout, source, x, y, bed.placed.yaw_rad + math.pi / 2)
    if source.chance(0.5):
        hang_above(layout, source, bed, "picture")
    return bed


def _place_bed(layout: RoomLayout, source: FurnitureSource, *, large: bool) -> Placement | None:
    """Places a bed against a wall, with its nightstands: a narrower one where a wide one does not fit.

    A bed of at least `DOUBLE_M` has free floor along both long sides, a narrower bed along one. Positions with room for
    a nightstand on both sides are tried first.
    """
    widths_m = (source.pick((1.4, 1.6, 1.8)), 1.4, 1.2, 0.9) if large else (0.9, 0.9)
    double = [width_m for width_m in widths_m if width_m >= DOUBLE_M]
    tries = [(width_m, BOTH, with_nightstands) for with_nightstands in (True, False) for width_m in double]
    tries += [(width_m, *way) for width_m in widths_m if width_m < DOUBLE_M for way in NARROW_BED]
    for width_m, free_sides, with_nightstands in tries:
        item = source.make("bed", width_m=width_m)
        if item is None:
            return None
        along, beside_m = ("middle", BESIDE_BED_M) if free_sides == BOTH else ("corner", 0.0)
        fits = partial(_has_free_sides, layout, free_sides=free_sides, with_nightstands=with_nightstands)
        bed = put_against_wall(layout, source.rng, item, along=along, front_m=0.6, beside_m=beside_m, fits=fits)
        if bed is not None:
            _place_nightstands(layout, source, bed)
            layout.reserve(bed, [_beside(bed, towards) for towards in free_sides])
            return bed
    return None


def _has_free_sides(layout: RoomLayout, bed: Placement, *, free_sides: Sequence[float], with_nightstands: bool) -> bool:
    """Returns whether the floor along some long sides of a bed is free, and has room for nightstands if asked for."""
    return all(
        layout.inner.contains(_beside(bed, towards), 0.06)
        and layout.is_zone_free(_beside(bed, towards))
        and (not with_nightstands or _has_room_at_head(layout, bed, towards))
        for towards in free_sides
    )


def _has_room_at_head(layout: RoomLayout, bed: Placement, towards: float) -> bool:
    """Returns whether a nightstand can stand on one side of the head of a bed."""
    zone = _strip(bed, towards, (-bed.item.size_m[0] / 2, NIGHTSTAND_M - 0.05 - bed.item.size_m[0] / 2), NIGHTSTAND_M)
    return layout.is_zone_free(zone) and not layout.in_doorway(zone, 0.005) and not layout.in_reserved_zone(zone)


def _beside(bed: Placement, towards: float) -> Rect:
    """Returns the floor along a long side of a bed, from where a nightstand ends to the foot."""
    depth_m = bed.item.size_m[0]
    return _strip(bed, towards, (NIGHTSTAND_M - depth_m / 2, depth_m / 2), BESIDE_BED_M)


def _strip(bed: Placement, towards: float, along: Interval, across_m: float) -> Rect:
    """Returns a strip of floor along a long side of a bed, between two positions along the bed."""
    edge_m = bed.item.size_m[1] / 2
    x0, y0 = bed.to_world(along[0], towards * edge_m)
    x1, y1 = bed.to_world(along[1], towards * (edge_m + across_m))
    return Rect(min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1))


def _place_nightstands(layout: RoomLayout, source: FurnitureSource, bed: Placement) -> None:
    """Places a nightstand on either side of a bed, a narrow one where no wider one fits."""
    uses = ("chest_of_drawers", "nightstand") if source.chance(0.5) else ("table", "nightstand", "side")
    items = [source.make(*uses), source.make(*uses, width_m=0.4)]
    for towards in (1.0, -1.0):
        for item in items:
            nightstand = place_beside(layout, bed, item, towards) if item is not None else None
            if nightstand is not None:
                put_on_top(layout, source, nightstand, ("lighting", "objects"), (0.75, 0.4))
                break


def dining_group(layout: RoomLayout, source: FurnitureSource, *, around_m: float = 0.75) -> Placement | None:
    """Places a table with chairs at its sides, a lamp above it and perhaps a rug under it.

    Returns None also where the home has another dining table nearby.
    """
    long_m = LONG_TABLE_M if layout.kind == "dining_room" and layout.inner.area_m2 > LARGE_DINING_M2 else None
    for width_m, least in ((long_m, 0.65), (1.3, 0.7), (0.85, 0.0)):
        table = _table_with_chairs(layout, source, width_m, least, around_m)
        if table is not None:
            break
    else:
        return None
    put_on_top(layout, source, table, ("objects", "plant", "objects"), (0.6, 0.25, 0.3))
    lamp = source.make("lighting", "ceiling")
    if lamp is not None and lamp.mount == "ceiling":
        hang_from_ceiling(layout, lamp, table.placed.x_m, table.placed.y_m)
    if layout.kind != "kitchen" and source.chance(0.4):
        size_m = (1.9, 2.6) if layout.inner.area_m2 > 12 else None
        lay_rug(layout, source, table.placed.x_m, table.placed.y_m, table.placed.yaw_rad, size_m=size_m)
    return table


def _table_with_chairs(
    layout: RoomLayout, source: FurnitureSource, width_m: float | None, least: float, around_m: float
) -> Placement | None:
    """Places a table of a width away from the walls, with chairs on both sides; None if it does not fit."""
    before = layout.snapshot()
    item, chair = source.make("table", "dining", width_m=width_m), source.make("chair", "dining")
    if item is None or chair is None:
        return None
    seats = _seats(source, item, chair)
    half = chair.size_m[1] / 2
    spots = [(x - 0.2 * math.cos(turn), y - 0.2 * math.sin(turn), half) for x, y, turn in seats]
    table = put_in_middle(layout, source.rng, item, spots, around_m=around_m, least=least, apart_m=0.3)
    if table is None:
        return None
    if not _is_near_table(source, table):
        taken = [(x, y) for x, y, turn in seats if _put_chair(layout, source, table, chair, (x, y, turn))]
        off_m = math.dist((0.0, 0.0), np.mean(taken, axis=0)) if taken else 0.0
        if len(taken) >= MIN_CHAIRS and (off_m < EVEN_M or max(item.size_m[:2]) < room_arrangement.LONG_TABLE_M):
            return table
    layout.restore(before)
    return None


def _is_near_table(source: FurnitureSource, table: Placement) -> bool:
    """Returns whether another dining table of the home stands near a table."""
    return any(
        other is not table
        and other.item.name == "dining table"
        and math.dist(other.rect.centre, table.rect.centre) < room_arrangement.TABLES_APART_M
        for other in source.placements()
    )


def breakfast_group(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a small table against a wall with chairs at its free sides."""
    chair, before = source.make("chair", "dining"), layout.snapshot()
    table = place(layout, source, "table", "dining", front_m=0.6, width_m=0.95, depth_m=0.7)
    if chair is None or table is None:
        return None
    if _is_near_table(source, table):
        layout.restore(before)
        return None
    layout.release_zones(table)
    depth, width = table.item.size_m[:2]
    seats = ((0.0, width / 2, -math.pi / 2), (0.0, -width / 2, math.pi / 2), (depth / 2, 0.0, math.pi))
    if sum(_put_chair(layout, source, table, chair, seat) for seat in seats) < MIN_CHAIRS:
        layout.restore(before)
        return None
    put_on_top(layout, source, table, ("objects", "plant"), (0.6, 0.25))
    return table


def _seats(source: FurnitureSource, table: Item, chair: Item) -> list[Seat]:
    """Returns seats along the long sides, also at the ends of a long table; one at each side of a square table."""
    depth, width = table.size_m[:2]
    if abs(depth - width) < 0.15:
        quarters = (0.0, math.pi / 2, math.pi, -math.pi / 2)
        return [(math.cos(a) * depth / 2, math.sin(a) * depth / 2, a + math.pi) for a in quarters]
    seats: list[Seat] = []
    count = max(1, min(4, int((width + 0.02) / max(PLACE_M, chair.size_m[1] + 0.06))))
    for n in range(count):
        y = (n - 0.5 * (count - 1)) * (width - 0.06) / count
        seats += [(depth / 2, y, math.pi), (-depth / 2, y, 0.0)]
    if width > 1.7 and source.chance(0.5):
        seats += [(0.0, width / 2, -math.pi / 2), (0.0, -width / 2, math.pi / 2)]
    return seats


def _put_chair(layout: RoomLayout, source: FurnitureSource, table: Placement, chair: Item, seat: Seat) -> bool:
    """Puts a chair at its seat, a little under the table, sometimes slightly turned; False if it does not fit."""
    x, y, turn = seat
    out_m = chair.size_m[0] / 2 - 0.14
    place_xy = table.to_world(x - out_m * math.cos(turn), y - out_m * math.sin(turn))
    askew_rad = source.uniform(-0.12, 0.12) if source.chance(0.4) else 0.0
    return put_partly_under(layout, chair, table, *place_xy, table.placed.yaw_rad + turn + askew_rad) is not None


def desk_group(layout: RoomLayout, source: FurnitureSource) -> Placement | None:
    """Places a desk against a wall with a chair, a monitor, a lamp and objects."""
    before = layout.snapshot()
    desk = place(layout, source, "table", "desk", front_m=0.85)
    chair = source.make("chair", "office") or source.make("chair", "dining")
    if desk is None or chair is None:
        return None
    layout.release_zones(desk)
    x, y = desk.to_world(desk.item.size_m[0] / 2 + chair.size_m[0] / 2 - 0.15, 0.0)
    yaw_rad = desk.placed.yaw_rad + math.pi + source.uniform(-0.2, 0.2)
    if put_partly_under(layout, chair, desk, x, y, yaw_rad) is None:
        layout.restore(before)
        return None
    for n in range(3):
        monitor = source.make("tv_monitor", "monitor", fresh=n > 0)
        if monitor is None or monitor.mount != "top":
            break
        if put_on_surface(layout, source.rng, desk, monitor, face=0.0, back=True):
            break
    put_on_top(layout, source, desk, ("lighting", "objects", "objects", "plant"), (0.6, 0.5, 0.3, 0.2))
    return desk
