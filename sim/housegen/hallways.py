"""Corridors: things along their walls at intervals, as far as the way past them stays wide."""

from __future__ import annotations

import math

import numpy as np

from sim.housegen.furniture.item import Item
from sim.housegen.groups import hang, hang_over, lay_rug, put_things
from sim.housegen.placement import WALL_GAP_M, RoomSpace, Standing
from sim.housegen.rectangles import Side
from sim.housegen.selection import Kit

WAY_M = 0.9
"""Left free beside whatever stands in a corridor."""
INTERVAL_M = 2.4
"""Between one thing along a corridor and the next."""
KINDS = (
    ("table", "console"), ("seating", "bench"), ("shelving", "bookcase"), ("plant", "floor"), ("cabinet", "sideboard"),
    ("table", "console"), ("plant", "floor"), ("seating", "plain"), ("chest_of_drawers", "dresser"),
    ("lighting", "floor"),
)  # fmt: skip
"""What stands in corridors: category and use."""


def furnish_hall(space: RoomSpace, kit: Kit) -> None:
    """Hooks for coats, then furniture at intervals on either side, and runners on the floor."""
    if space.inner.short_m > 1.15 and kit.chance(0.7):
        hang(space, kit, "clothes", "hooks", along="any")
    _line_up(space, kit)
    if kit.chance(0.6):
        runners(space, kit)


def runners(space: RoomSpace, kit: Kit) -> None:
    """Rugs one behind the other along a corridor."""
    wide = space.inner.width_m > space.inner.depth_m
    count = max(1, int(space.inner.long_m / 4.0))
    for n in range(count):
        share = (n + 0.5) / count
        x = space.inner.x0 + share * space.inner.width_m if wide else space.inner.centre[0]
        y = space.inner.centre[1] if wide else space.inner.y0 + share * space.inner.depth_m
        lay_rug(space, kit, x, y, math.pi / 2 if wide else 0.0, runner=True, size_m=(0.75, 2.4))


def _line_up(space: RoomSpace, kit: Kit) -> None:
    """Something every few metres, now on one side and now on the other, no two of a kind beside each other."""
    sides: tuple[Side, Side] = ("south", "north") if space.inner.width_m > space.inner.depth_m else ("west", "east")
    lo, hi = space.inner.span(sides[0])
    count = max(1, round((hi - lo) / INTERVAL_M * (0.7 + 0.5 * kit.clutter)))
    kinds = [KINDS[n] for n in kit.rng.permutation(len(KINDS)).tolist()]
    turn = int(kit.rng.integers(2))
    last: list[str] = []
    for n, at in enumerate(np.linspace(lo, hi, 2 * count + 1)[1::2].tolist()):
        order = (sides[(n + turn) % 2], sides[(n + turn + 1) % 2])
        for tried, kind in enumerate(kinds):
            if kind[0] not in last[-2:] and _stand(space, kit, kit.make(*kind), order, at) is not None:
                kinds.append(kinds.pop(tried))
                last.append(kind[0])
                break


def _stand(space: RoomSpace, kit: Kit, item: Item | None, sides: tuple[Side, Side], at: float) -> Standing | None:
    """An item near a place along one of the sides, if it leaves the way free, with what belongs on it and above it."""
    if item is None or item.mount != "floor" or space.inner.short_m - item.size_m[0] - WALL_GAP_M < WAY_M:
        return None
    for side in sides:
        found = space.near_on_wall(item, side, at, front_m=WAY_M)
        if found is None:
            continue
        if item.category in ("table", "cabinet", "chest_of_drawers"):
            put_things(space, kit, found, ("objects", "plant", "lighting"), (0.6, 0.4, 0.3))
            hang_over(space, kit, found, "mirror" if kit.chance(0.5) else "picture")
        return found
    return None
