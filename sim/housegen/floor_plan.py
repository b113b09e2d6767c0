"""Floor plans: rooms as rectangles in rows along corridors, and which of them are joined.

A home is one to three wings. A wing is a corridor with a row of rooms on either side; at one end a block of public
rooms (living room, kitchen, dining room) may close it. A second wing leaves the first through a gap in one of its
rows. Everything is drawn in a frame whose corridor runs along +x, then mirrored and turned at random.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from sim.housegen.rectangles import Rect, shared_side
from sim.housegen.rooms import ROOM_RULES, Column, PlanKind, Program, draw_program

JoinKind = Literal["door", "opening", "open"]
"""A door of 0.8-1.0 m, a wide opening under a lintel, or no wall at all."""


CORRIDOR_M = ((180.0, (1.5, 1.9)), (120.0, (1.35, 1.75)), (0.0, (1.2, 1.45)))
"""Homes from so many square metres on have corridors of such widths: in long ones things stand along the walls."""


class PlanError(ValueError):
    """The rooms drawn do not fit together; another draw may."""


@dataclass(frozen=True)
class Room:
    """One room; `rect` reaches to the middle of its walls."""

    name: str
    """`room_<kind>_<nn>`."""
    kind: str
    rect: Rect


@dataclass(frozen=True)
class Join:
    """Two rooms between which one can walk; indices into `FloorPlan.rooms`."""

    a: int
    b: int
    kind: JoinKind


@dataclass(frozen=True)
class FloorPlan:
    """Rooms and how they are joined. `entry` is the hallway (or other room) with the front door, and its side."""

    kind: PlanKind
    rooms: tuple[Room, ...]
    joins: tuple[Join, ...]
    entry: int

    @property
    def area_m2(self) -> float:
        """Floor area to the middle of the walls."""
        return sum(room.rect.area_m2 for room in self.rooms)

    @property
    def bounds(self) -> Rect:
        """The rectangle around all rooms."""
        rects = [room.rect for room in self.rooms]
        return Rect(
            min(r.x0 for r in rects), min(r.y0 for r in rects), max(r.x1 for r in rects), max(r.y1 for r in rects)
        )


@dataclass
class _Draft:
    """Rooms and joins while a plan is drawn."""

    kinds: list[str] = field(default_factory=list)
    rects: list[Rect] = field(default_factory=list)
    joins: list[Join] = field(default_factory=list)

    def add(self, kind: str, rect: Rect) -> int:
        self.kinds.append(kind)
        self.rects.append(rect)
        return len(self.kinds) - 1

    def join(self, a: int, b: int, kind: JoinKind) -> None:
        if not any({a, b} == {j.a, j.b} for j in self.joins):
            self.joins.append(Join(a, b, kind))

    def shared_m(self, a: int, b: int) -> float:
        shared = shared_side(self.rects[a], self.rects[b])
        return shared[1][1] - shared[1][0] if shared else 0.0


@dataclass(frozen=True)
class _Row:
    """Columns along one side of a corridor and how deep they are."""

    columns: tuple[Column, ...]
    depth_m: float
    scale: float
    """Rooms are this much larger than usual."""

    def widths(self, column: Column, slot_m: float) -> tuple[float, float, float]:
        """Smallest, usual and largest width of a column, metres."""
        if column.front == "slot":
            return slot_m, slot_m, slot_m
        rules = [ROOM_RULES[kind] for kind in (column.front, column.back) if kind]
        usable = self.depth_m if len(rules) == 1 else self.depth_m / 2
        low = max(max(rule.area_m2[0] / usable for rule in rules), max(rule.short_m for rule in rules))
        low = max(low, max(usable / rule.aspect for rule in rules))
        largest = max(rule.area_m2[2] * (max(self.scale, 1.0) if rule.grows else 1.0) for rule in rules)
        high = min(largest / usable, min(rule.aspect for rule in rules) * usable)
        usual = self.scale * sum(rule.area_m2[1] for rule in rules) / self.depth_m
        return low, min(max(usual, low), max(high, low)), max(high, low)


def draw_floor_plan(rng: np.random.Generator, kind: PlanKind, area_m2: float, wanted: Sequence[str] = ()) -> FloorPlan:
    """A plan of this shape with about this area, with the private rooms `wanted` if they fit.

    Raises:
        PlanError: the drawn rooms do not fit together, or the area is off by more than a quarter.
    """
    program = draw_program(rng, kind, area_m2, wanted)
    draft = _Draft()
    low_m, high_m = next(widths for above_m2, widths in CORRIDOR_M if area_m2 >= above_m2)
    corridor_m = _draw(rng, low_m, high_m)
    scale = float(np.clip(0.85 * area_m2 / program.usual_area_m2, 0.85, 1.7))
    depth_scale = float(np.clip(scale**0.5, 0.9, 1.25))
    public_at_end = kind in ("studio", "flat", "openplan", "large") or (kind == "lshape" and rng.random() < 0.6)
    main, branches = _share_out(rng, kind, program, public_at_end)
    depths = (_draw(rng, 3.5, 4.5) * depth_scale, _draw(rng, 3.5, 4.5) * depth_scale)
    if kind == "studio":
        depths = (_draw(rng, 2.3, 2.9), _draw(rng, 2.0, 2.6))
    upper, lower = (_Row(tuple(columns), round(depth, 1), scale) for columns, depth in zip(main, depths, strict=True))
    length_m = _common_length(rng, upper, lower, corridor_m)
    hall = draft.add("hallway", Rect(0.0, 0.0, length_m, corridor_m))
    gaps = _lay_row(
        rng,
        draft,
        hall,
        upper,
        length_m,
        corridor_m,
        lambda s0, s1, t0, t1: Rect(s0, corridor_m + t0, s1, corridor_m + t1),
    )
    gaps += _lay_row(rng, draft, hall, lower, length_m, corridor_m, lambda s0, s1, t0, t1: Rect(s0, -t1, s1, -t0))
    for gap, branch in zip(gaps, branches, strict=True):
        _lay_branch(rng, draft, hall, gap, branch, corridor_m, scale)
    if public_at_end:
        _lay_public_block(rng, draft, hall, program.public, area_m2, kind)
    _add_loops(rng, draft)
    _check_draft(draft, area_m2)
    return _finish(rng, draft, kind, hall)


def _draw(rng: np.random.Generator, low: float, high: float) -> float:
    """A length between `low` and `high` in steps of 5 cm."""
    return round(float(rng.uniform(low, high)) * 20.0) / 20.0


def _share_out(
    rng: np.random.Generator, kind: PlanKind, program: Program, public_at_end: bool
) -> tuple[tuple[list[Column], list[Column]], list[tuple[list[Column], list[Column]]]]:
    """Columns of the main wing (upper, lower row) and of each branch (left, right row)."""
    groups = [program.private[i] for i in rng.permutation(len(program.private))]
    if not public_at_end:
        public = tuple(Column(room) for room in program.public)
        groups.insert(0, public)
    wings = {"lshape": 2, "large": 3 if len(groups) >= 8 and rng.random() < 0.6 else 2}.get(kind, 1)
    shares = [groups] if wings == 1 else _split_groups(groups, wings)
    main = _two_rows(rng, shares[0])
    branches = []
    for i, share in enumerate(shares[1:]):
        row = main[i]
        at = len(row) if kind == "lshape" or rng.random() < 0.3 else int(rng.integers(0, len(row) + 1))
        row.insert(_between_groups(row, at), Column("slot"))
        branches.append(_two_rows(rng, share))
    return main, branches


def _between_groups(row: list[Column], at: int) -> int:
    """The nearest place at or after `at` where a corridor does not part a bedroom from the bathroom behind its wall."""
    while (at < len(row) and row[at].back is not None) or (at < len(row) and at > 0 and _belongs(row[at - 1], row[at])):
        at += 1
    return at


def _belongs(left: Column, right: Column) -> bool:
    public = ("living_room", "kitchen", "dining_room")
    return right.back is not None or (left.front in public and right.front in public)


def _split_groups(groups: Sequence[tuple[Column, ...]], parts: int) -> list[list[tuple[Column, ...]]]:
    """Consecutive shares of about the same area."""
    areas = [sum(column.usual_area_m2 for column in group) for group in groups]
    shares: list[list[tuple[Column, ...]]] = [[] for _ in range(parts)]
    done = 0.0
    for group, area in zip(groups, areas, strict=True):
        shares[min(int(parts * (done + 0.5 * area) / sum(areas)), parts - 1)].append(group)
        done += area
    if not all(shares):
        raise PlanError(f"{len(groups)} groups of rooms do not fill {parts} wings")
    return shares


def _two_rows(rng: np.random.Generator, groups: Sequence[tuple[Column, ...]]) -> tuple[list[Column], list[Column]]:
    """Groups dealt to two rows so that both get about the same area; public rooms first, at the entrance's end."""
    rows: tuple[list[tuple[Column, ...]], list[tuple[Column, ...]]] = ([], [])
    areas = [0.0, 0.0]
    for group in sorted(groups, key=lambda g: -sum(column.usual_area_m2 for column in g)):
        i = int(areas[1] < areas[0])
        rows[i].append(group)
        areas[i] += sum(column.usual_area_m2 for column in group)
    flat: list[list[Column]] = []
    for row in rows:
        order = [row[i] for i in rng.permutation(len(row))]
        flat.append([column for group in order for column in group])
    return flat[0], flat[1]


def _common_length(rng: np.random.Generator, upper: _Row, lower: _Row, slot_m: float) -> float:
    """A corridor length for which both rows can be filled.

    Raises:
        PlanError: there is none.
    """
    ranges = []
    for row in (upper, lower):
        if row.columns:
            widths = np.array([row.widths(column, slot_m) for column in row.columns])
            ranges.append(widths.sum(axis=0))
    low, high = max(r[0] for r in ranges), min(r[2] for r in ranges)
    if low > high:
        raise PlanError(f"rows of {ranges[0][1]:.1f} m and {ranges[-1][1]:.1f} m do not fit one corridor")
    usual = float(np.mean([r[1] for r in ranges]) * rng.uniform(0.95, 1.05))
    return round(float(np.clip(usual, low, high)) * 20.0) / 20.0


def _fill(rng: np.random.Generator, row: _Row, length_m: float, slot_m: float) -> list[float]:
    """Widths of the row's columns that add up to `length_m`, in steps of 5 cm where it goes up."""
    widths = np.array([row.widths(column, slot_m) for column in row.columns])
    now = widths[:, 1].copy()
    for _ in range(8):
        rest = length_m - now.sum()
        room = (widths[:, 2] - now) if rest > 0 else (now - widths[:, 0])
        if abs(rest) < 1e-9 or room.sum() < 1e-9:
            break
        now += np.sign(rest) * room * min(1.0, abs(rest) / room.sum())
    edges = np.round(np.cumsum(now) * 20.0) / 20.0
    edges[-1] = length_m
    return np.diff(edges, prepend=0.0).tolist()


def _lay_row(
    rng: np.random.Generator,
    draft: _Draft,
    hall: int,
    row: _Row,
    length_m: float,
    slot_m: float,
    place: Callable[[float, float, float, float], Rect],
) -> list[Rect]:
    """Add a row's rooms and their doors; returns the gaps left for branch corridors.

    `place(s0, s1, t0, t1)` turns positions along the corridor and away from it into the plan's frame.
    """
    gaps: list[Rect] = []
    if not row.columns:
        return gaps
    at = 0.0
    fronts: list[int | None] = []
    backs: list[int | None] = []
    for column, width_m in zip(row.columns, _fill(rng, row, length_m, slot_m), strict=True):
        s0, s1, at = at, at + width_m, at + width_m
        if column.front == "slot":
            gaps.append(place(s0, s1, 0.0, row.depth_m))
            fronts.append(None)
            backs.append(None)
            continue
        cut = row.depth_m if column.back is None else round(row.depth_m * float(rng.uniform(0.44, 0.54)), 1)
        front = draft.add(column.front, place(s0, s1, 0.0, cut))
        draft.join(hall, front, "opening" if column.front == "living_room" and rng.random() < 0.5 else "door")
        fronts.append(front)
        backs.append(draft.add(column.back, place(s0, s1, cut, row.depth_m)) if column.back else None)
    _join_row(rng, draft, fronts, backs)
    return gaps


def _join_row(rng: np.random.Generator, draft: _Draft, fronts: list[int | None], backs: list[int | None]) -> None:
    """Doors from back rooms to the bedroom before them, openings between neighbouring public rooms."""
    for i, back in enumerate(backs):
        if back is not None:
            bedroom = fronts[i - 1] if i > 0 else None
            owner = bedroom if bedroom is not None and draft.kinds[bedroom] == "bedroom" else fronts[i]
            assert owner is not None
            draft.join(owner, back, "door")
    for left, right in itertools.pairwise(fronts):
        if left is not None and right is not None:
            kinds = {draft.kinds[left], draft.kinds[right]}
            if kinds <= {"living_room", "kitchen", "dining_room"}:
                draft.join(left, right, "opening" if rng.random() < 0.7 else "door")


def _lay_branch(
    rng: np.random.Generator,
    draft: _Draft,
    hall: int,
    gap: Rect,
    rows: tuple[list[Column], list[Column]],
    corridor_m: float,
    scale: float,
) -> None:
    """Add a wing whose corridor leaves the main one through `gap` and goes on behind the row."""
    deeper = float(np.clip(scale**0.5, 0.9, 1.25))
    left, right = (_Row(tuple(row), round(_draw(rng, 3.4, 4.4) * deeper, 1), scale) for row in rows)
    length_m = _common_length(rng, left, right, corridor_m)
    up = gap.y0 > 0.0
    base = gap.y1 if up else gap.y0
    sign = 1.0 if up else -1.0

    def along(s0: float, s1: float) -> tuple[float, float]:
        a, b = base + sign * s0, base + sign * s1
        return min(a, b), max(a, b)

    def place_left(s0: float, s1: float, t0: float, t1: float) -> Rect:
        y0, y1 = along(s0, s1)
        return Rect(gap.x0 - t1, y0, gap.x0 - t0, y1)

    def place_right(s0: float, s1: float, t0: float, t1: float) -> Rect:
        y0, y1 = along(s0, s1)
        return Rect(gap.x1 + t0, y0, gap.x1 + t1, y1)

    y0, y1 = along(0.0, length_m)
    corridor = draft.add("hallway", Rect(gap.x0, min(gap.y0, y0), gap.x1, max(gap.y1, y1)))
    draft.join(hall, corridor, "open")
    _lay_row(rng, draft, corridor, left, length_m, corridor_m, place_left)
    _lay_row(rng, draft, corridor, right, length_m, corridor_m, place_right)


def _lay_public_block(
    rng: np.random.Generator, draft: _Draft, hall: int, public: Sequence[str], area_m2: float, kind: PlanKind
) -> None:
    """Close the main wing with the public rooms, across its whole depth, at the corridor's far end."""
    hall_rect = draft.rects[hall]
    beside = [
        r
        for i, r in enumerate(draft.rects)
        if i != hall and abs(r.x1 - hall_rect.x1) < 0.01 and r.y1 > hall_rect.y0 - 9
    ]
    y0 = min([r.y0 for r in beside] + [hall_rect.y0])
    y1 = max([r.y1 for r in beside if r.y0 < hall_rect.y1 + 0.01] + [hall_rect.y1])
    depth_m, x0 = y1 - y0, hall_rect.x1
    private_m2 = sum(rect.area_m2 for rect in draft.rects)
    usual = sum(ROOM_RULES[room].area_m2[1] for room in public)
    wanted = max(area_m2 - private_m2, 0.85 * usual)
    order = list(public)
    if len(order) == 3:
        order = ["living_room", "dining_room", "kitchen"]
    if rng.random() < 0.5:
        order.reverse()
    width_m = float(np.clip(wanted / depth_m, 3.6, 7.5))
    shares = np.array([ROOM_RULES[room].area_m2[1] * rng.uniform(0.9, 1.1) for room in order])
    if kind == "studio" or depth_m / width_m > 1.15 * len(order) / 2 or len(order) < 3:
        edges = y0 + np.round(np.cumsum(shares / shares.sum()) * depth_m * 20.0) / 20.0
        edges = [y0, *edges[:-1].tolist(), y1]
        rects = [Rect(x0, a, x0 + round(width_m, 1), b) for a, b in itertools.pairwise(edges)]
    else:
        rects = _two_deep(order, shares, Rect(x0, y0, x0 + round(width_m, 1), y1))
    rooms = [draft.add(room, rect) for room, rect in zip(order, rects, strict=True)]
    _join_public(rng, draft, hall, rooms, kind)


def _two_deep(order: Sequence[str], shares: np.ndarray, block: Rect) -> list[Rect]:
    """The living room across one part of the block, the other two rooms side by side in the rest."""
    live = list(order).index("living_room")
    share = float(shares[live] / shares.sum())
    cut = (
        round((block.y0 + share * block.depth_m) * 20) / 20
        if live == 0
        else round((block.y1 - share * block.depth_m) * 20) / 20
    )
    living = Rect(block.x0, block.y0, block.x1, cut) if live == 0 else Rect(block.x0, cut, block.x1, block.y1)
    rest = Rect(block.x0, cut, block.x1, block.y1) if live == 0 else Rect(block.x0, block.y0, block.x1, cut)
    others = [i for i in range(3) if i != live]
    part = float(shares[others[0]] / (shares[others[0]] + shares[others[1]]))
    middle = round((rest.x0 + part * rest.width_m) * 20) / 20
    halves = [Rect(rest.x0, rest.y0, middle, rest.y1), Rect(middle, rest.y0, rest.x1, rest.y1)]
    rects = {live: living, others[0]: halves[0], others[1]: halves[1]}
    return [rects[i] for i in range(3)]


def _join_public(rng: np.random.Generator, draft: _Draft, hall: int, rooms: Sequence[int], kind: PlanKind) -> None:
    """Join the public rooms with each other and one of them with the corridor."""
    wide: JoinKind = "open" if kind == "openplan" else "opening"
    for i, a in enumerate(rooms):
        for b in rooms[i + 1 :]:
            if draft.shared_m(a, b) > 1.6:
                # Where three rooms meet, one wall must stay, or a lone post would be left of all of them.
                third = len(rooms) == 3 and "living_room" not in (draft.kinds[a], draft.kinds[b])
                link: JoinKind = "opening" if third and wide == "open" else wide
                draft.join(a, b, link if kind == "openplan" or rng.random() < 0.75 else "door")
    touching = [room for room in rooms if draft.shared_m(hall, room) > 1.0]
    if not touching:
        raise PlanError("the corridor ends between two public rooms")
    for room in touching:
        draft.join(hall, room, "opening" if kind in ("openplan", "studio") or rng.random() < 0.5 else "door")


def _add_loops(rng: np.random.Generator, draft: _Draft) -> None:
    """A few more doors, so that some homes have a second way round."""
    likely = {
        frozenset(("living_room", "office")): 0.4,
        frozenset(("living_room", "dining_room")): 0.8,
        frozenset(("kitchen", "laundry")): 0.6,
        frozenset(("bedroom", "bathroom")): 0.25,
        frozenset(("kitchen", "dining_room")): 0.8,
        frozenset(("bedroom", "office")): 0.15,
    }
    for a in range(len(draft.kinds)):
        for b in range(a + 1, len(draft.kinds)):
            chance = likely.get(frozenset((draft.kinds[a], draft.kinds[b])), 0.0)
            if chance and draft.shared_m(a, b) > 1.6 and rng.random() < chance:
                draft.join(a, b, "door")


def _check_draft(draft: _Draft, area_m2: float) -> None:
    """Raise PlanError where rooms overlap, are too small or too long, or the area is off."""
    for i, (kind, rect) in enumerate(zip(draft.kinds, draft.rects, strict=True)):
        rule = ROOM_RULES[kind]
        if rect.short_m < rule.short_m - 0.11 or rect.area_m2 < 0.9 * rule.area_m2[0]:
            raise PlanError(f"{kind} of {rect.width_m:.1f} x {rect.depth_m:.1f} m is too small")
        if rect.long_m / rect.short_m > 1.15 * rule.aspect:
            raise PlanError(f"{kind} of {rect.width_m:.1f} x {rect.depth_m:.1f} m is too long")
        for other in draft.rects[:i]:
            if rect.overlaps(other, 0.01):
                raise PlanError(f"{kind} overlaps another room")
    total = sum(rect.area_m2 for rect in draft.rects)
    if not 0.75 * area_m2 < total < 1.25 * area_m2:
        raise PlanError(f"rooms add up to {total:.0f} m2 instead of {area_m2:.0f} m2")


def _finish(rng: np.random.Generator, draft: _Draft, kind: PlanKind, hall: int) -> FloorPlan:
    """Mirror and turn the draft, put its corner at the origin, give the rooms their names."""
    flip_x, flip_y, swap = (bool(rng.random() < 0.5) for _ in range(3))
    rects = [_turned(rect, flip_x, flip_y, swap) for rect in draft.rects]
    x0, y0 = min(r.x0 for r in rects), min(r.y0 for r in rects)
    counts: dict[str, int] = {}
    rooms = []
    for name, rect in zip(draft.kinds, rects, strict=True):
        number = counts.get(name, 0)
        counts[name] = number + 1
        moved = Rect(*(round(v, 3) for v in (rect.x0 - x0, rect.y0 - y0, rect.x1 - x0, rect.y1 - y0)))
        rooms.append(Room(f"room_{name}_{number:02d}", name, moved))
    return FloorPlan(kind, tuple(rooms), tuple(draft.joins), hall)


def _turned(rect: Rect, flip_x: bool, flip_y: bool, swap: bool) -> Rect:
    if flip_x:
        rect = replace(rect, x0=-rect.x1, x1=-rect.x0)
    if flip_y:
        rect = replace(rect, y0=-rect.y1, y1=-rect.y0)
    return Rect(rect.y0, rect.x0, rect.y1, rect.x1) if swap else rect
