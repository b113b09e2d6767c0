"""Plans with a ring of corridors round a core: larger homes of the kind `loop`, and the kind `estate`.

The core is [0, width] x [0, depth]. A corridor runs along its north and south side, another along its east side, and
the public rooms lie along its west side, so that there are two paths between any two of them. Rows of private rooms lie
outside of the ring; wings leave it to the north, east and south.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim.homes.housegen.floor_plan.corridor_wing import Wing, add_wing
from sim.homes.housegen.floor_plan.draft import Draft
from sim.homes.housegen.floor_plan.frames import Frame
from sim.homes.housegen.floor_plan.plan import PlanError
from sim.homes.housegen.floor_plan.rectangles import Rect, Side, in_steps
from sim.homes.housegen.floor_plan.room_queue import WITHOUT_DAYLIGHT, RoomQueue
from sim.homes.housegen.floor_plan.rows import add_row, draw_depth_m, draw_length_m, with_stairs_m

COURT_M = 2.0
"""Distance of a wing from the row before it, whose rooms keep their windows."""
PAIR_DEPTH_M = 4.4
"""Depth from which a core has two rows of rooms back to back."""


@dataclass(frozen=True, kw_only=True)
class Ring:
    """The lengths of a ring and of its surroundings, metres."""

    width: float
    """Extent of the core along x."""
    depth: float
    """Extent of the core along y."""
    corridor: float
    """Width of the corridors."""
    rows: tuple[float, float, float]
    """Depth of the north, south and east row; 0 for no east row."""
    public: float
    """Extent of the public rooms along x."""
    wings: tuple[Side, ...]
    """Directions of the wings."""
    wing_length: float
    """Length of the rows of a wing."""
    wing_depth: float
    """Depth of the rows of a wing."""


def draw_ring(
    rng: np.random.Generator, area_m2: float, required: Sequence[str], corridor_m: float, scale: float, *, estate: bool
) -> tuple[Draft, int]:
    """Returns a draft and the index of the corridor with the front door.

    Raises:
        PlanError: the rooms do not fit.
    """
    ring = (_draw_estate if estate else _draw_loop)(rng, area_m2, corridor_m, scale)
    ring = replace(ring, rows=(with_stairs_m(ring.rows[0], required), *ring.rows[1:]))
    draft = Draft()
    w, d, c = ring.width, ring.depth, ring.corridor
    north = draft.add("hallway", Rect(0.0, d, w, d + c))
    south = draft.add("hallway", Rect(0.0, -c, w, 0.0))
    east = draft.add("hallway", Rect(w, -c, w + c, d + c))
    draft.join(north, east, "open")
    draft.join(south, east, "open")
    _add_public_rooms(rng, draft, ring, north, south)
    rows_m2 = w * (ring.rows[0] + ring.rows[1]) + (d + 2 * c) * ring.rows[2]
    wings_m2 = 2 * len(ring.wings) * ring.wing_length * ring.wing_depth
    queue = RoomQueue(rng, area_m2, (rows_m2 + wings_m2 + 0.6 * w * d) / max(scale, 1.0), required)
    add_core(rng, draft, queue, Core(Rect(0.0, 0.0, w, d), north, south, c), scale, estate=estate)
    _add_rows(rng, draft, queue, ring, (north, south, east), scale, estate)
    return draft, east


def _draw_loop(rng: np.random.Generator, area_m2: float, corridor_m: float, scale: float) -> Ring:
    """Returns the measures of a loop home."""
    rows = [draw_depth_m(rng, 3.4, 4.1, scale) for _ in range(3)]
    depth = draw_length_m(rng, 2.6, 3.4) if area_m2 < 210.0 else draw_length_m(rng, 4.2, 5.4)
    public = draw_length_m(rng, 4.2, 5.0) if area_m2 < 210.0 else draw_length_m(rng, 4.8, 6.0)
    if area_m2 < 180.0 or rng.random() < 0.4:
        rows[2] = 0.0
    fixed = Ring(
        width=0.0, depth=depth, corridor=corridor_m, rows=(rows[0], rows[1], rows[2]), public=public, wings=(),
        wing_length=0.0, wing_depth=0.0,
    )  # fmt: skip
    return _with_width(fixed, area_m2, (5.0, 13.5))


def _draw_estate(rng: np.random.Generator, area_m2: float, corridor_m: float, scale: float) -> Ring:
    """Returns the measures of an estate with two or three wings."""
    rows = [draw_depth_m(rng, 3.7, 4.2, scale) for _ in range(3)]
    growth = float(np.clip((area_m2 - 300.0) / 500.0, 0.0, 1.0))
    depth = round(draw_length_m(rng, 5.0, 5.8) + 2.2 * growth, 1)
    public = round(draw_length_m(rng, 5.4, 6.2) + 1.2 * growth, 1)
    count = 2 if area_m2 < 430.0 else 3 if area_m2 > 600.0 else int(rng.integers(2, 4))
    sides: list[Side] = ["north", "south", "east"]
    wings = tuple(sides[i] for i in sorted(rng.permutation(3)[:count].tolist()))
    with_row = "east" not in wings and area_m2 > 380.0
    wing_depth = draw_depth_m(rng, 3.6, 4.2, scale)
    wing_length = draw_length_m(rng, 3.4, 4.6) + round(draw_length_m(rng, 3.5, 6.0) * growth, 1)
    fixed = Ring(
        width=0.0, depth=depth, corridor=corridor_m, rows=(rows[0], rows[1], rows[2] if with_row else 0.0),
        public=public, wings=wings, wing_length=wing_length, wing_depth=wing_depth,
    )  # fmt: skip
    return _with_width(fixed, area_m2, (7.5, 21.0))


def _with_width(ring: Ring, area_m2: float, width_m: tuple[float, float]) -> Ring:
    """Returns the ring with the width of the core that gives an area.

    Raises:
        PlanError: that width is not allowed.
    """
    c, whole = ring.corridor, ring.depth + 2 * ring.corridor
    fixed = whole * (c + ring.public + ring.rows[2]) + 0.8 * ring.public * ring.rows[0]
    fixed += len(ring.wings) * ring.wing_length * (2 * ring.wing_depth + c)
    width = in_steps((area_m2 - fixed) / (whole + ring.rows[0] + ring.rows[1]))
    if not width_m[0] <= width <= width_m[1]:
        raise PlanError(f"a core {width:.1f} m wide does not suit {area_m2:.0f} m2")
    return replace(ring, width=width)


def _add_public_rooms(rng: np.random.Generator, draft: Draft, ring: Ring, north: int, south: int) -> None:
    """Adds living room, dining room and kitchen on the west side; they connect the north and the south corridor."""
    y0, y1, x0 = -ring.corridor, ring.depth + ring.corridor, -ring.public
    names = ["living_room"]
    if ring.public * (y1 - y0) > 34.0:
        names = ["living_room", "dining_room"] if rng.random() < 0.5 else ["dining_room", "living_room"]
    cut = y0 + (y1 - y0) * float(rng.uniform(0.56, 0.62) if names[0] == "living_room" else rng.uniform(0.38, 0.44))
    cuts = [y0, y1] if len(names) == 1 else [y0, in_steps(cut), y1]
    rooms = [draft.add(n, Rect(x0, a, 0.0, b)) for n, a, b in zip(names, cuts, cuts[1:], strict=False)]
    if len(rooms) == 2:
        draft.join(rooms[0], rooms[1], "partial")
    for hall, room in ((north, rooms[-1]), (south, rooms[0])):
        draft.join(hall, room, "open" if rng.random() < 0.5 else "door")
    kitchen_m = round(min(ring.public, 24.0 / ring.rows[0]), 1)
    kitchen = draft.add("kitchen", Rect(-kitchen_m, y1, 0.0, y1 + ring.rows[0]))
    draft.join(rooms[-1], kitchen, "opening" if rng.random() < 0.7 else "door")
    if len(rooms) == 1:
        dining_m = round(min(ring.public, 18.0 / ring.rows[1]), 1)
        dining = draft.add("dining_room", Rect(-dining_m, y0 - ring.rows[1], 0.0, y0))
        draft.join(rooms[0], dining, "partial")


def _add_rows(
    rng: np.random.Generator,
    draft: Draft,
    queue: RoomQueue,
    ring: Ring,
    halls: tuple[int, int, int],
    scale: float,
    estate: bool,
) -> None:
    """Adds the rows outside of the north, south and east corridor, and the wings."""
    w, d, c = ring.width, ring.depth, ring.corridor
    frames = (Frame(0.0, d + c, "east"), Frame(w, -c, "west"), Frame(w + c, d + c, "south"))
    lengths_m = (w, w, d + 2 * c)
    starts: dict[Side, Frame] = {"east": Frame(w + c, d / 2, "east")}
    for side, hall, frame, length_m, depth_m in zip(
        ("north", "south", "east"), halls, frames, lengths_m, ring.rows, strict=True
    ):
        if depth_m == 0.0:
            continue
        gap_m = c if side in ring.wings else 0.0
        row = queue.fill_row(rng, length_m, depth_m, scale, gap_m=gap_m)
        for gap in add_row(rng, draft, hall, row, length_m, c, frame.left()):
            starts[side] = Frame(gap.centre[0], gap.y0 if side == "north" else gap.y1, side)
    for side in ring.wings:
        n = ("north", "south", "east").index(side)
        before_m = 0.0 if side == "east" else ring.rows[n] + COURT_M
        wing = Wing(
            frame=starts[side], before_m=before_m, length_m=ring.wing_length,
            depths_m=(ring.wing_depth, ring.wing_depth), corridor_m=c,
        )  # fmt: skip
        add_wing(rng, draft, queue, wing, halls[n], scale, end_room=estate and rng.random() < 0.5)


@dataclass(frozen=True)
class Core:
    """The core of a ring: its rectangle and the corridors along its north and south side."""

    rect: Rect
    north: int
    south: int
    corridor_m: float


def add_core(
    rng: np.random.Generator, draft: Draft, queue: RoomQueue, core: Core, scale: float, *, estate: bool
) -> None:
    """Fills the core of a ring with rooms.

    Raises:
        PlanError: no rooms fit.
    """
    middle_m = _middle_width_m(rng, core) if estate else 0.0
    if not middle_m:
        _add_pairs(rng, draft, queue, core, (core.rect.x0, core.rect.x1), scale)
        return
    at = in_steps(core.rect.centre[0] - middle_m / 2 + rng.uniform(-0.8, 0.8))
    middle = Rect(at, core.rect.y0, round(at + middle_m, 3), core.rect.y1)
    if middle_m <= core.corridor_m:  # else the middle stays open: a courtyard
        hallway = draft.add("hallway", middle)
        draft.join(core.north, hallway, "open")
        draft.join(core.south, hallway, "open")
    for span in ((core.rect.x0, middle.x0), (middle.x1, core.rect.x1)):
        _add_pairs(rng, draft, queue, core, span, scale)


def _middle_width_m(rng: np.random.Generator, core: Core) -> float:
    """Returns the width of a cross corridor or of a courtyard across the whole depth in the middle of the core."""
    if rng.random() < 0.35 or core.rect.width_m < 9.0:
        return core.corridor_m
    return draw_length_m(rng, max(4.2, core.rect.depth_m / 1.6), min(0.6 * core.rect.width_m, 8.0))


def _add_pairs(
    rng: np.random.Generator, draft: Draft, queue: RoomQueue, core: Core, span: tuple[float, float], scale: float
) -> None:
    """Fills a part of the core: rooms at the north and at the south corridor, back to back where it is deep enough."""
    length_m, depth_m = span[1] - span[0], core.rect.depth_m
    south, north = Frame(span[0], core.rect.y0, "east"), Frame(span[1], core.rect.y1, "west")
    if depth_m < PAIR_DEPTH_M:
        frame, hall = (south, core.south) if rng.random() < 0.5 else (north, core.north)
        row = queue.fill_row(rng, length_m, depth_m, scale, kinds=WITHOUT_DAYLIGHT)
        add_row(rng, draft, hall, row, length_m, core.corridor_m, frame.left())
        return
    cut_m = in_steps(depth_m * rng.uniform(0.46, 0.54))
    for frame, hall, deep_m in ((south, core.south, cut_m), (north, core.north, depth_m - cut_m)):
        row = queue.fill_row(rng, length_m, deep_m, scale, kinds=WITHOUT_DAYLIGHT)
        add_row(rng, draft, hall, row, length_m, core.corridor_m, frame.left())
