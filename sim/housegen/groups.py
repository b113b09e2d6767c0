"""Things that belong together: a bed and its nightstands, sofa and screen, table and chairs, a row of kitchen units.

Each function puts its group into a room and returns its main piece, or None where the room has no place for it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from sim.housegen.furniture.item import Item
from sim.housegen.placement import WALL_GAP_M, Along, RoomSpace, Standing
from sim.housegen.rectangles import INWARD_YAW_RAD, OPPOSITE, SIDES, Side, footprint
from sim.housegen.selection import Kit

RUNNER_M = 1.0
"""Narrower rugs are runners."""
AISLE_M = 0.75
"""Floor kept free before what one works at."""


def place(
    space: RoomSpace, kit: Kit, category: str, *uses: str, along: Along = "any", front_m: float = 0.6,
    sides: Sequence[Side] | None = None, tries: int = 2, **hints: Any,
) -> Standing | None:  # fmt: skip
    """One item against a wall; a new design when the first one does not fit."""
    for n in range(tries):
        item = kit.make(category, *uses, fresh=n > 0, **hints)
        if item is None:
            return None
        if item.mount == "wall":
            found = space.on_wall(kit.rng, item, sides=sides, along=along)
        else:
            found = space.against_wall(kit.rng, item, sides=sides, along=along, front_m=front_m)
        if found is not None:
            return found
    return None


def hang(space: RoomSpace, kit: Kit, category: str, *uses: str, along: Along = "any", **hints: Any) -> Standing | None:
    """One thing on a wall, where the floor before it leaves somebody stand near."""
    item = kit.make(category, *uses, **hints)
    if item is None or item.mount != "wall":
        return None
    return space.on_wall(kit.rng, item, along=along, over_floor=category == "clothes")


def hang_over(space: RoomSpace, kit: Kit, host: Standing, category: str, *uses: str, **hints: Any) -> Standing | None:
    """One thing on the wall right above what stands against it."""
    item = kit.make(category, *uses, **hints)
    if item is None or item.mount != "wall" or host.side is None:
        return None
    bottom = max(item.mount_height_m, host.placed.item.size_m[2] + 0.15)
    lo, hi = host.rect.span(host.side)
    return space.on_wall(kit.rng, item, sides=[host.side], at=0.5 * (lo + hi), bottom_m=bottom)


def beside(
    space: RoomSpace, kit: Kit, host: Standing, item: Item, towards: float, gap_m: float = 0.05, front_m: float = 0.0
) -> Standing | None:
    """An item next to another one at the same wall: `towards` +1 further along the side, -1 before it."""
    side = host.side
    if side is None:
        return None
    lo, hi = host.rect.span(side)
    reach = item.size_m[1] / 2 + gap_m
    at = hi + reach if towards > 0 else lo - reach
    sign = 1.0 if side in ("east", "north") else -1.0
    line = space.inner.line(side) - sign * (item.size_m[0] / 2 + WALL_GAP_M)
    x, y = (line, at) if side in ("east", "west") else (at, line)
    zones = []
    if front_m:
        rect = footprint(x, y, item.size_m[0], item.size_m[1], INWARD_YAW_RAD[side])
        zones = [rect.strip(OPPOSITE[side], rect.span(OPPOSITE[side]), 0.0, front_m)]
    found = space.at(item, x, y, INWARD_YAW_RAD[side], zones)
    return Standing(found.placed, found.rect, side) if found else None


def before(
    space: RoomSpace, host: Standing, item: Item, gap_m: float, *, facing: bool, shift_m: float = 0.0
) -> Standing | None:
    """An item in front of another one, looking back at it (`facing`) or the same way."""
    yaw = host.placed.yaw_rad
    c, s = math.cos(yaw), math.sin(yaw)
    ahead = host.placed.item.size_m[0] / 2 + gap_m + item.size_m[0] / 2
    x = host.placed.x_m + c * ahead - s * shift_m
    y = host.placed.y_m + s * ahead + c * shift_m
    return space.at(item, x, y, yaw + math.pi if facing else yaw)


def lay_rug(
    space: RoomSpace,
    kit: Kit,
    x_m: float,
    y_m: float,
    yaw_rad: float,
    *,
    runner: bool | None = None,
    size_m: tuple[float, float] | None = None,
) -> bool:
    """A rug under what stands there; a narrow one for halls if `runner`, a wide one if False.

    `size_m` is its depth and width; False where none can lie there.
    """
    hints: dict[str, Any] = {"depth_m": size_m[0], "width_m": size_m[1]} if size_m else {}
    for n in range(3):
        rug = kit.make("floor", "rug", fresh=n > 0, **hints)
        if rug is None:
            return False
        if (runner is None or runner == (min(rug.size_m[:2]) < RUNNER_M)) and space.lay(rug, x_m, y_m, yaw_rad):
            return True
    return False


def bed_group(space: RoomSpace, kit: Kit, *, large: bool) -> Standing | None:
    """A bed with its head to a wall, nightstands with lamps, a rug, a picture above, perhaps a bench at its foot."""
    bed = None
    widths = (kit.pick((1.4, 1.6, 1.8)), 1.2, 0.9) if large else (0.9, 0.9, 1.2)
    for width_m in widths:
        item = kit.make("bed", width_m=width_m)
        if item is None:
            return None
        for around in (0.55, 0.3, 0.0):
            bed = space.against_wall(kit.rng, item, along="middle" if around else "any", front_m=0.6, beside_m=around)
            if bed:
                break
        if bed:
            break
    if bed is None:
        return None
    stand = kit.make("chest_of_drawers", "nightstand") if kit.chance(0.5) else kit.make("table", "nightstand", "side")
    for towards in (1.0, -1.0):
        if stand is not None and kit.chance(0.95):
            night = beside(space, kit, bed, stand, towards)
            if night:
                put_things(space, kit, night, ("lighting", "objects"), (0.75, 0.4))
    if kit.chance(0.5):
        bench = kit.make("seating", "plain")
        if bench is not None and bench.size_m[1] <= bed.placed.item.size_m[1] + 0.1:
            before(space, bed, bench, 0.05, facing=False)
    c, s = math.cos(bed.placed.yaw_rad), math.sin(bed.placed.yaw_rad)
    if kit.chance(0.95 if space.inner.area_m2 > 13 else 0.6):
        ahead = 0.25 * bed.placed.item.size_m[0] + 0.15
        size_m = (1.7, 2.4) if space.inner.area_m2 > 13 else None
        x, y = bed.placed.x_m + ahead * c, bed.placed.y_m + ahead * s
        if not lay_rug(space, kit, x, y, bed.placed.yaw_rad, size_m=size_m):
            lay_rug(space, kit, x, y, bed.placed.yaw_rad + math.pi / 2)
    if kit.chance(0.5):
        hang_over(space, kit, bed, "picture")
    return bed


def put_things(space: RoomSpace, kit: Kit, host: Standing, categories: Sequence[str], chances: Sequence[float]) -> None:
    """Small things on top of something, each with its usual chance."""
    uses = {
        "lighting": ("table",),
        "objects": ("kitchen", "top") if space.kind in ("kitchen", "dining_room") else ("top",),
        "plant": ("table", "small", "top"),
        "tv_monitor": ("monitor",),
        "cushion": ("throw",),
        "appliances": ("microwave",),
    }
    for category, usual in zip(categories, chances, strict=True):
        if kit.clutter_chance(usual):
            item = kit.make(category, *uses.get(category, ()))
            if item is not None and item.mount == "top":
                space.on_top(kit.rng, host, item)


def sofa_group(space: RoomSpace, kit: Kit) -> Standing | None:
    """Screen on one wall, sofa facing it, a low table on a rug between them, easy chairs at its ends."""
    sofa_item = kit.make("sofa")
    if sofa_item is None:
        return None

    def score(side: Side) -> float:
        return space.wall_length(side) + min(space.wall_length(OPPOSITE[side]), 2.5) + kit.uniform(0.0, 1.5)

    sides = sorted(SIDES, key=score, reverse=True)
    for side in sides:
        depth = space.inner.width_m if side in ("east", "west") else space.inner.depth_m
        away = depth - 3.7
        gap = WALL_GAP_M if away < 1.0 or kit.chance(0.6) else min(away, kit.uniform(0.9, 1.4))
        sofa = space.against_wall(kit.rng, sofa_item, sides=[side], along="middle", front_m=1.0, gap_m=gap)
        if sofa is not None:
            break
    else:
        return space.against_wall(kit.rng, sofa_item, front_m=0.6)
    _screen(space, kit, sofa)
    low = kit.make("table", "coffee")
    yaw = sofa.placed.yaw_rad
    c, s = math.cos(yaw), math.sin(yaw)
    if low is not None:
        table = _free_before(space, sofa, low, 0.4)
        if table is not None:
            put_things(space, kit, table, ("objects", "plant", "objects"), (0.6, 0.3, 0.3))
    ahead = sofa.placed.item.size_m[0] / 2 + 0.65
    if kit.chance(0.8):
        size_m = (1.7, 2.5) if space.inner.area_m2 > 18 else None
        x, y = sofa.placed.x_m + c * (ahead + 0.15), sofa.placed.y_m + s * (ahead + 0.15)
        lay_rug(space, kit, x, y, yaw, runner=False, size_m=size_m)
    easy = kit.make("chair", "arm") if kit.chance(0.75) else kit.make("seating", "ottoman")
    if easy is not None:
        for end in kit.rng.permutation([1.0, -1.0]).tolist()[: 1 if kit.chance(0.5) else 2]:
            across = sofa.placed.item.size_m[1] / 2 + easy.size_m[0] / 2 + 0.05
            x = sofa.placed.x_m + c * (ahead + 0.1) - s * end * across
            y = sofa.placed.y_m + s * (ahead + 0.1) + c * end * across
            space.at(easy, x, y, yaw - end * math.pi / 2 - end * 0.0)
    side_table = kit.make("table", "side")
    if side_table is not None and kit.chance(0.6) and sofa.side is not None:
        towards = 1.0 if kit.chance(0.5) else -1.0
        found = beside(space, kit, sofa, side_table, towards)
        if found:
            put_things(space, kit, found, ("lighting", "plant"), (0.6, 0.3))
    if kit.chance(0.5):
        hang_over(space, kit, sofa, "picture")
    return sofa


def _free_before(space: RoomSpace, host: Standing, item: Item, gap_m: float) -> Standing | None:
    """Before a sofa: its own zone must give way, so the item is put with that zone ignored."""
    space.release(host)
    return before(space, host, item, gap_m, facing=True)


def _screen(space: RoomSpace, kit: Kit, sofa: Standing) -> None:
    """A screen opposite the sofa: on a low cabinet, or on the wall above one."""
    if sofa.side is None:
        return
    side = OPPOSITE[sofa.side]
    lo, hi = sofa.rect.span(side)
    middle = 0.5 * (lo + hi)
    board = kit.make("cabinet", "media", "sideboard")
    host = None
    if board is not None:
        host = space.near_on_wall(board, side, middle, front_m=0.5)
    ways = ["wall", "stand"] if host is None or kit.chance(0.4) else ["stand", "wall", "wall"]
    for way in ways:
        screen = kit.make("tv_monitor", "tv_wall" if way == "wall" else "tv")
        if screen is None:
            continue
        if (
            way == "stand"
            and host is not None
            and screen.mount == "top"
            and space.on_top(kit.rng, host, screen, face=0.0, back=True)
        ):
            return
        if way == "wall" and screen.mount == "wall":
            at = middle if host is None else 0.5 * sum(host.rect.span(side))
            bottom = max(0.85, (host.placed.item.size_m[2] + 0.12) if host else 0.95)
            if space.on_wall(kit.rng, screen, sides=[side], at=at, bottom_m=bottom):
                return
    floor = kit.make("tv_monitor", "tv_floor")
    if floor is not None and floor.mount == "floor":
        space.near_on_wall(floor, side, middle, front_m=0.4, slide_m=1.5)


Seat = tuple[float, float, float]
"""x, y where a chair meets the table's edge, in the table's frame, and the heading in which it looks."""


def dining_group(space: RoomSpace, kit: Kit, *, around_m: float = 0.75) -> Standing | None:
    """A table with chairs on its sides and a lamp above it."""
    chair = kit.make("chair", "dining")
    for width_m, least in ((None, 0.65), (1.3, 0.7), (0.85, 0.0)):
        hints: dict[str, Any] = {"width_m": width_m} if width_m else {}
        item = kit.make("table", "dining", **hints)
        if item is None or chair is None:
            return None
        seats = _seats(kit, item, chair)
        half = chair.size_m[1] / 2
        spots = [(x - 0.2 * math.cos(turn), y - 0.2 * math.sin(turn), half) for x, y, turn in seats]
        table = space.in_middle(kit.rng, item, spots, around_m=around_m, least=least, apart_m=0.3)
        if table is not None:
            break
    else:
        return None
    for seat in seats:
        _draw_up(space, kit, table, chair, seat)
    put_things(space, kit, table, ("objects", "plant", "objects"), (0.6, 0.25, 0.3))
    lamp = kit.make("lighting", "ceiling")
    if lamp is not None and lamp.mount == "ceiling":
        space.on_ceiling(lamp, table.placed.x_m, table.placed.y_m)
    if space.kind != "kitchen" and kit.chance(0.4):
        size_m = (1.9, 2.6) if space.inner.area_m2 > 12 else None
        lay_rug(space, kit, table.placed.x_m, table.placed.y_m, table.placed.yaw_rad, size_m=size_m)
    return table


def breakfast_group(space: RoomSpace, kit: Kit) -> Standing | None:
    """A small table against a wall with chairs on its free sides."""
    chair = kit.make("chair", "dining")
    table = place(space, kit, "table", "dining", front_m=0.6, width_m=0.95, depth_m=0.7)
    if chair is None or table is None:
        return None
    space.release(table)
    depth, width = table.placed.item.size_m[:2]
    for seat in ((0.0, width / 2, -math.pi / 2), (0.0, -width / 2, math.pi / 2), (depth / 2, 0.0, math.pi)):
        _draw_up(space, kit, table, chair, seat)
    put_things(space, kit, table, ("objects", "plant"), (0.6, 0.25))
    return table


def _seats(kit: Kit, table: Item, chair: Item) -> list[Seat]:
    """Along the long sides, at the ends of a long table too; round small and square ones."""
    depth, width = table.size_m[:2]
    if abs(depth - width) < 0.15:
        quarters = (0.0, math.pi / 2, math.pi, -math.pi / 2)
        return [(math.cos(a) * depth / 2, math.sin(a) * depth / 2, a + math.pi) for a in quarters]
    seats: list[Seat] = []
    count = max(1, min(4, int((width - 0.25) / (chair.size_m[1] + 0.14))))
    for n in range(count):
        y = (n - 0.5 * (count - 1)) * (width - 0.2) / count
        seats += [(depth / 2, y, math.pi), (-depth / 2, y, 0.0)]
    if width > 1.7 and kit.chance(0.5):
        seats += [(0.0, width / 2, -math.pi / 2), (0.0, -width / 2, math.pi / 2)]
    return seats


def _draw_up(space: RoomSpace, kit: Kit, table: Standing, chair: Item, seat: Seat) -> None:
    """A chair at its seat, a little under the table and not always straight."""
    c, s = math.cos(table.placed.yaw_rad), math.sin(table.placed.yaw_rad)
    lx, ly, turn = seat
    out = chair.size_m[0] / 2 - 0.14
    px, py = lx - out * math.cos(turn), ly - out * math.sin(turn)
    x, y = table.placed.x_m + c * px - s * py, table.placed.y_m + s * px + c * py
    askew = kit.uniform(-0.12, 0.12) if kit.chance(0.4) else 0.0
    space.tucked(chair, table, x, y, table.placed.yaw_rad + turn + askew)


def desk_group(space: RoomSpace, kit: Kit) -> Standing | None:
    """A desk against a wall, its chair drawn up, a monitor, a lamp, papers."""
    desk = place(space, kit, "table", "desk", front_m=0.85)
    if desk is None:
        return None
    space.release(desk)
    chair = kit.make("chair", "office") or kit.make("chair", "dining")
    if chair is not None:
        yaw = desk.placed.yaw_rad
        out = desk.placed.item.size_m[0] / 2 + chair.size_m[0] / 2 - 0.15
        x, y = desk.placed.x_m + math.cos(yaw) * out, desk.placed.y_m + math.sin(yaw) * out
        space.tucked(chair, desk, x, y, yaw + math.pi + kit.uniform(-0.2, 0.2))
    monitor = kit.make("tv_monitor", "monitor")
    if monitor is not None and monitor.mount == "top":
        space.on_top(kit.rng, desk, monitor, face=0.0, back=True)
    put_things(space, kit, desk, ("lighting", "objects", "objects", "plant"), (0.6, 0.5, 0.3, 0.2))
    return desk


def row(space: RoomSpace, kit: Kit, items: Sequence[Item], side: Side, *, front_m: float = AISLE_M) -> list[Standing]:
    """Items shoulder to shoulder along a wall, in this order or the other way round; none where not all fit."""
    gap_m = 0.004
    for order in (list(items), list(reversed(items))) if kit.chance(0.5) else (list(reversed(items)), list(items)):
        at = space.row_start(order, side, front_m, gap_m) if order else None
        if at is None:
            continue
        stood = []
        for item in order:
            found = space.near_on_wall(item, side, at + item.size_m[1] / 2, front_m=front_m, slide_m=0.0)
            if found is not None:
                stood.append(found)
            at += item.size_m[1] + gap_m
        if stood:
            return stood
    return []
