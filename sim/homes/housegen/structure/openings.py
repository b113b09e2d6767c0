"""Chooses the openings of a floor plan: doors, wide openings and windows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from sim.homes.housegen.floor_plan import FloorPlan, Join, PlanError
from sim.homes.housegen.floor_plan.rectangles import (
    OPPOSITE,
    SIDES,
    Interval,
    Rect,
    Side,
    shared_side,
    side_point,
    subtract,
)
from sim.homes.housegen.floor_plan.rooms import ROOM_RULES
from sim.houses.house import Room
from sim.world.plan_requirements import SWING_M, Doorway, plan_faults, room_faults

HALF_WALL_M = 0.06
"""Thickness of one room's half of a wall, inside the room's rectangle."""
OUTER_WALL_M = 0.12
"""Thickness of outer walls outside of the rectangle."""
JAMB_M = 0.03
"""Thickness of a door frame inside its opening."""
DOOR_TRIES = 12
"""Places that are tried for a door until it opens onto no other doorway."""
_STOREY_M = 3.0
"""Height of a storey in the plan rules, which only tell storeys apart."""
HEAD_M = 2.1
"""Height of the upper edge of doors, openings and windows."""
NO_LINTEL_M = 1e3
"""The same for passages up to the ceiling: above any ceiling."""
_FROM_CORNER_M = 0.08
"""Smallest wall between a door and the corner of a room."""

LEAF_SHARE, OPEN_SHARE, AJAR_SHARE = 0.8, 0.72, 0.5
"""Shares of the doors that get a leaf, of the leaves that are wide open, and of the others that are only ajar, where a
leaf may be."""
PRIVATE = frozenset({"bathroom", "bedroom"})
"""Rooms whose doors all have a leaf where one fits."""
HALF_OPEN_GAP_M, AJAR_GAP_M = (0.52, 0.64), (0.10, 0.34)
"""Gaps beside a leaf that is half open, through which the robot of 0.36 m passes, and beside one that is ajar."""
HALF_OPEN_RAD = np.deg2rad(70.0)
"""A leaf that is more open than this leaves the doorway free."""
WIDEST_DEG, WIDEST_AT_WALL_DEG, AT_WALL_M = 110.0, 92.0, 0.6
"""Largest angle of a leaf, that of a leaf with a wall next to it, and the distance up to which the wall limits it."""
BESIDE_M, BEYOND_M = 0.35, 0.6
"""Floor that stays free next to the doorway on the side of the edge of a leaf that is half open, and past that edge."""
AJAR_RAD = np.deg2rad(28.0)
"""A leaf that is less open than this is ajar: its gap is narrower than those of leaves that are half open."""

OpeningKind = Literal["door", "opening", "open", "window", "entry"]


@dataclass(frozen=True)
class Leaf:
    """A door leaf that is ajar."""

    room: int
    """Index of the room it swings into."""
    hinge_at_start: bool
    """True: its hinge is at the lower end of the opening's span."""
    angle_rad: float
    """0 closes the doorway."""
    widest_rad: float | None = None
    """How far it opens on its hinge when it is pushed; None: it does not move."""

    @property
    def standing_rad(self) -> float:
        """How far it is open for a robot that enters: one that is only ajar is pushed wide open."""
        is_ajar = self.widest_rad is not None and self.angle_rad < AJAR_RAD
        return self.widest_rad if is_ajar and self.widest_rad is not None else self.angle_rad

    def gap_m(self, width_m: float) -> float:
        """Returns the distance between the edge of a leaf of this width and the jamb that it closes against."""
        return 2.0 * width_m * float(np.sin(0.5 * self.angle_rad))


@dataclass(frozen=True)
class Opening:
    """An opening in a wall: along `span` of `side` of room `a`, from `bottom_m` to `top_m`."""

    kind: OpeningKind
    a: int
    b: int | None
    """Index of the room behind it; None for outside."""
    side: Side
    line_m: float
    """World coordinate of the middle of the wall."""
    span: Interval
    bottom_m: float
    top_m: float
    leaf: Leaf | None = None

    @property
    def centre_m(self) -> float:
        """The middle of the span."""
        return 0.5 * (self.span[0] + self.span[1])

    def point(self, at_m: float) -> tuple[float, float]:
        """Returns the point (x, y) at a position along the middle of the wall."""
        return side_point(self.side, at_m, self.line_m)

    def side_of(self, room: int) -> Side:
        """Returns the side of one of its two rooms on which it lies."""
        return self.side if room == self.a else OPPOSITE[self.side]

    def clear_span(self) -> Interval:
        """Returns the span between the jambs of the frame."""
        jamb = JAMB_M if self.kind in ("door", "entry") else 0.0
        return self.span[0] + jamb, self.span[1] - jamb


def cut_openings(rng: np.random.Generator, plan: FloorPlan) -> tuple[Opening, ...]:
    """Returns openings for the connections of a plan, a front door, and windows for rooms that have an outer wall.

    Raises:
        PlanError: two rooms that should be connected share too little wall.
    """
    rects = [room.rect for room in plan.rooms]
    widths = (round(float(rng.uniform(0.80, 0.88)), 2), round(float(rng.uniform(0.86, 1.0)), 2))
    openings: list[Opening] = []
    for join in sorted(plan.joins, key=lambda join: join.kind == "door"):  # doors find places beside wide openings
        openings.append(_cut_apart(rng, plan, join, widths, openings))
    for n, opening in enumerate(openings):
        openings[n] = _with_leaf(rng, plan, opening, openings)
    entry = _cut_entry(rng, plan, rects)
    if entry is not None:
        openings.append(entry)
    openings += _cut_windows(rng, plan, rects, openings)
    return tuple(openings)


def outer_spans(rects: Sequence[Rect], room: int, side: Side) -> list[Interval]:
    """Returns the stretches of a room's side that have no other room behind them."""
    holes = []
    for i, rect in enumerate(rects):
        shared = shared_side(rects[room], rect) if i != room else None
        if shared is not None and shared[0] == side:
            holes.append(shared[1])
    return subtract(rects[room].span(side), holes, 0.01)


def plan_rule_faults(
    plan: FloorPlan, openings: Sequence[Opening], *further: tuple[FloorPlan, Sequence[Opening]]
) -> list[str]:
    """Returns a sentence for each rule of `sim.world.plan_requirements` that a plan and further storeys violate."""
    rooms: list[Room] = []
    doors: list[Doorway] = []
    windows: list[Doorway] = []
    for storey, (level, holes) in enumerate(((plan, openings), *further)):
        z_m = storey * _STOREY_M
        rooms += _rooms(level, z_m)
        for hole in holes:
            if hole.kind in ("door", "entry", "window"):
                along_x = hole.side in ("north", "south")
                doorway = Doorway(hole.point(hole.centre_m), hole.span[1] - hole.span[0], along_x, z_m)
                (windows if hole.kind == "window" else doors).append(doorway)
    return plan_faults(rooms, doors, windows)


def size_rule_faults(plan: FloorPlan) -> list[str]:
    """Returns the faults of a plan that openings do not change, which many plans have."""
    return room_faults(list(_rooms(plan, 0.0)))


def _rooms(plan: FloorPlan, z_m: float) -> Iterator[Room]:
    """Yields the rooms of a plan between their walls."""
    for room in plan.rooms:
        inner = room.rect.grown(-HALF_WALL_M)
        half = (0.5 * inner.width_m, 0.5 * inner.depth_m, 1.0)
        yield Room(room.name, room.kind, (((*inner.centre, z_m + 1.0), half),))


def _cut_apart(
    rng: np.random.Generator, plan: FloorPlan, join: Join, clear_m: tuple[float, float], others: Sequence[Opening]
) -> Opening:
    """Returns the opening of a connection; a door whose floor on either side is free of other doorways if possible."""
    opening = _cut_join(rng, plan, join, clear_m)
    for _ in range(DOOR_TRIES):
        if opening.kind != "door" or not any(_meet(plan, opening, other) for other in others):
            break
        opening = _cut_join(rng, plan, join, clear_m)
    return opening


def _meet(plan: FloorPlan, door: Opening, other: Opening) -> bool:
    """Returns whether the floors before two openings of a room that is no hallway overlap."""
    for room in {door.a, door.b} & {other.a, other.b} - {None}:
        if plan.rooms[room].kind in ("hallway", "stair_hall"):
            continue
        inner = plan.rooms[room].rect.grown(-HALF_WALL_M)
        zones = [inner.strip(hole.side_of(room), hole.span, SWING_M) for hole in (door, other)]
        if zones[0].overlaps(zones[1], 0.01):
            return True
    return False


def _cut_join(rng: np.random.Generator, plan: FloorPlan, join: Join, clear_m: tuple[float, float]) -> Opening:
    """Returns the opening of a connection; `clear_m` are the home's two door widths, for small and other rooms."""
    a, b = plan.rooms[join.a], plan.rooms[join.b]
    shared = shared_side(a.rect, b.rect)
    if shared is None:
        raise PlanError(f"{a.name} and {b.name} are connected but do not touch")
    side, (lo, hi) = shared
    line_m, inner = a.rect.line(side), (lo + HALF_WALL_M, hi - HALF_WALL_M)
    if join.kind == "open":
        return Opening("open", join.a, join.b, side, line_m, inner, 0.0, NO_LINTEL_M)
    length_m = inner[1] - inner[0]
    if join.kind == "partial" and length_m > 1.8:
        width_m = max(round(length_m * float(rng.uniform(0.45, 0.75)), 2), 1.2)
        stub_m = min(0.35, (length_m - width_m) / 2)
        at = round(inner[0] + stub_m + float(rng.uniform(0.0, 1.0)) * (length_m - width_m - 2 * stub_m), 2)
        return Opening("open", join.a, join.b, side, line_m, (at, round(at + width_m, 2)), 0.0, NO_LINTEL_M)
    if join.kind == "opening" and length_m > 1.5:
        width_m = min(round(float(rng.uniform(1.3, 2.4)), 2), length_m - 0.2)
        at = inner[0] + 0.1 + float(rng.uniform(0.0, 1.0)) * max(0.0, length_m - 0.2 - width_m)
        return Opening("opening", join.a, join.b, side, line_m, (round(at, 2), round(at + width_m, 2)), 0.0, HEAD_M)
    small = "bathroom" in (a.kind, b.kind) or "closet" in (a.kind, b.kind)
    width_m = (clear_m[0] if small else clear_m[1]) + 2 * JAMB_M
    if length_m < width_m + 2 * _FROM_CORNER_M:
        width_m = clear_m[0] + 2 * JAMB_M
    if length_m < width_m + 2 * _FROM_CORNER_M:
        raise PlanError(f"{a.name} and {b.name} share only {length_m:.2f} m of wall")
    spare = max(0.0, length_m - width_m - 2 * _FROM_CORNER_M)
    # Near a corner, which leaves a long wall for furniture.
    offset = float(rng.uniform(0.0, min(0.3, spare))) if rng.random() < 0.75 else float(rng.uniform(0.0, spare))
    at = inner[0] + _FROM_CORNER_M + offset if rng.random() < 0.5 else inner[1] - _FROM_CORNER_M - offset - width_m
    return Opening("door", join.a, join.b, side, line_m, (round(at, 3), round(at + width_m, 3)), 0.0, HEAD_M)


def _with_leaf(rng: np.random.Generator, plan: FloorPlan, opening: Opening, others: Sequence[Opening]) -> Opening:
    """Returns most doors with a leaf on a hinge, in the room that is not a hallway, its hinge at the nearer corner.

    Most leaves are wide open. Some are half open, with a gap through which the robot passes; in a room that has no
    other door a leaf may be ajar, so that the robot must push it to enter: a leaf opens into the room, and from within
    the robot could not pull it. A door stays without a leaf where its swing would meet another doorway of that room.
    Doors of bedrooms and bathrooms have a leaf wherever one fits, with its hinge on the other side or in the other room
    if need be.
    """
    if opening.kind != "door" or opening.b is None:
        return opening
    kinds = plan.rooms[opening.a].kind, plan.rooms[opening.b].kind
    private = any(kind in PRIVATE for kind in kinds)
    if rng.random() > LEAF_SHARE and not private:
        return opening
    room = opening.b if kinds[0] == "hallway" or plan.rooms[opening.b].rect.area_m2 > 30 else opening.a
    other_room = opening.a if room == opening.b else opening.b
    for swings_into in (room, other_room) if private else (room,):
        rect, side = plan.rooms[swings_into].rect, opening.side_of(swings_into)
        lo, hi = rect.span(side)
        nearer_start = opening.span[0] - lo < hi - opening.span[1]
        for at_start in (nearer_start, not nearer_start) if private else (nearer_start,):
            hung = _hung(rng, plan, opening, others, swings_into, at_start)
            if hung is not None:
                return hung
    return opening


def _hung(
    rng: np.random.Generator, plan: FloorPlan, opening: Opening, others: Sequence[Opening], room: int, at_start: bool
) -> Opening | None:
    """Returns a door with a leaf that swings into a room; None if it does not fit there."""
    rect = plan.rooms[room].rect
    side = opening.side_of(room)
    lo, hi = rect.span(side)
    width_m = opening.span[1] - opening.span[0]
    if plan.rooms[room].kind == "hallway" or rect.across_m(side) < width_m + 0.75:
        return None
    gap_m = opening.span[0] - lo if at_start else hi - opening.span[1]
    widest_deg = WIDEST_AT_WALL_DEG if gap_m < AT_WALL_M else WIDEST_DEG
    only_door = sum(room in (other.a, other.b) for other in others) == 1
    angle_deg = _draw_angle(rng, width_m - 2 * JAMB_M, widest_deg, may_be_ajar=only_door and room != plan.entry)
    leaf = Leaf(room, at_start, float(np.deg2rad(round(angle_deg))), float(np.deg2rad(widest_deg)))
    hung = replace(opening, leaf=leaf)
    zone = leaf_keep_out(hung, rect)
    for other in others:
        if other is opening or room not in (other.a, other.b):
            continue
        doorway = rect.strip(other.side_of(room), other.span, 0.75)
        crossing = other.leaf is not None and other.leaf.room == room and zone.overlaps(leaf_keep_out(other, rect))
        if zone.overlaps(doorway) or crossing:
            return None
    return hung


def _draw_angle(rng: np.random.Generator, width_m: float, widest_deg: float, *, may_be_ajar: bool) -> float:
    """Returns the angle in degrees to which a leaf of this width is open."""
    if rng.random() < OPEN_SHARE:
        return float(rng.uniform(78.0, widest_deg))
    gap_m = AJAR_GAP_M if may_be_ajar and rng.random() < AJAR_SHARE else HALF_OPEN_GAP_M
    return float(np.degrees(2.0 * np.arcsin(float(rng.uniform(*gap_m)) / (2.0 * width_m))))


def leaf_keep_out(opening: Opening, rect: Rect) -> Rect:
    """Returns the zone that a leaf needs inside the room that it swings into, `rect`, at every angle to its widest."""
    assert opening.leaf is not None
    lo, hi = opening.clear_span()
    width_m = hi - lo
    angle_rad = opening.leaf.angle_rad if opening.leaf.widest_rad is None else opening.leaf.widest_rad
    reach = width_m * abs(np.cos(angle_rad)) + 0.06
    back = reach if angle_rad > np.pi / 2 else 0.06
    moves = opening.leaf.widest_rad is not None
    ahead = width_m if moves else reach if angle_rad <= np.pi / 2 else 0.06
    depth_m = width_m + 0.1
    if moves and opening.leaf.standing_rad < HALF_OPEN_RAD:  # the robot passes between its edge and what stands there
        ahead, depth_m = width_m + BESIDE_M, width_m * float(np.sin(opening.leaf.standing_rad)) + BEYOND_M
    span = (lo - back, lo + ahead) if opening.leaf.hinge_at_start else (hi - ahead, hi + back)
    return rect.strip(opening.side_of(opening.leaf.room), span, max(depth_m, width_m + 0.1))


def _cut_entry(rng: np.random.Generator, plan: FloorPlan, rects: Sequence[Rect]) -> Opening | None:
    """Returns the front door, in a short outer wall of the hallway if possible; None without any outer wall for it."""
    width_m = 0.98
    order = sorted(range(len(rects)), key=lambda i: (i != plan.entry, plan.rooms[i].kind != "hallway"))
    for room in order:
        if plan.rooms[room].kind not in ("hallway", "living_room", "studio", "kitchen"):
            continue
        spans: list[tuple[float, Side, float, float]] = [
            (hi - lo, side, lo, hi) for side in SIDES for lo, hi in outer_spans(rects, room, side)
        ]
        for length_m, side, lo, hi in sorted(spans):
            if length_m >= width_m + 2 * HALF_WALL_M + 0.06:
                middle = 0.5 * (lo + hi) if length_m < 2.5 else float(rng.uniform(lo + 0.8, hi - 0.8))
                span = (round(middle - width_m / 2, 3), round(middle + width_m / 2, 3))
                return Opening("entry", room, None, side, rects[room].line(side), span, 0.0, HEAD_M)
    return None


def _cut_windows(
    rng: np.random.Generator, plan: FloorPlan, rects: Sequence[Rect], others: Sequence[Opening]
) -> list[Opening]:
    """Returns windows in most outer walls of rooms with daylight, at least one for each, and at the ends of hallways.

    A home has three sizes of windows: one for living rooms, one for bathrooms, one for the others.
    """
    large = (round(float(rng.uniform(1.6, 2.2)), 1), round(float(rng.uniform(0.35, 0.75)), 2))
    usual = (round(float(rng.uniform(1.0, 1.5)), 1), round(float(rng.uniform(0.85, 1.0)), 2))
    small = (round(float(rng.uniform(0.5, 0.8)), 1), 1.45)
    windows = []
    for i, room in enumerate(plan.rooms):
        if not ROOM_RULES[room.kind].windows and room.kind != "hallway":
            continue
        size = {"bathroom": small, "living_room": large, "studio": large, "dining_room": large}.get(room.kind, usual)
        width_m = size[0] if room.kind != "hallway" else 0.7
        holes: list[tuple[bool, Opening]] = []
        for side in SIDES:
            taken = [o.span for o in others if o.a == i and o.side == side]
            for lo, hi in outer_spans(rects, i, side):
                if room.kind == "hallway" and taken:
                    continue
                is_kept = bool(rng.random() > 0.12)
                for span in _window_spans((lo, hi), width_m, taken, most=1 if room.kind == "bathroom" else 3):
                    hole = Opening("window", i, None, side, room.rect.line(side), span, size[1], HEAD_M)
                    holes.append((is_kept, hole))
        wanted_ones = [hole for is_kept, hole in holes if is_kept]
        windows += wanted_ones or [hole for _, hole in holes[:1]]
    return windows


def _window_spans(wall: Interval, width_m: float, taken: Sequence[Interval], most: int) -> list[Interval]:
    """Returns the spans of evenly distributed windows in one stretch of wall, narrower where it is short."""
    length_m = wall[1] - wall[0] - 2 * HALF_WALL_M
    width_m = min(width_m, round(length_m - 0.3, 1))
    if width_m < 0.45:
        return []
    count = min(most, 1 + int((length_m - width_m) / (width_m + 1.8)))
    spans = []
    for n in range(count):
        middle = wall[0] + (n + 0.5) * (wall[1] - wall[0]) / count
        spans.append((round(middle - width_m / 2, 3), round(middle + width_m / 2, 3)))
    return [s for s in spans if not any(s[0] < t[1] + 0.2 and s[1] > t[0] - 0.2 for t in taken)]
