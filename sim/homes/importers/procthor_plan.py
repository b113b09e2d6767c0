"""Turns the rooms, walls, doors and windows of a ProcTHOR house into a floor plan and openings of our generator.

Unity's (x, z) becomes our (x, y): looking down, both have x to the right and the other axis upwards, so that left stays
left. A room that is not a rectangle becomes several, which are open to each other along their whole common side.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from sim.core.errors import HouseError
from sim.homes.housegen.floor_plan.plan import FloorPlan, Room
from sim.homes.housegen.floor_plan.rectangles import OPPOSITE, Interval, Rect, Side, shared_side
from sim.homes.housegen.structure.openings import HALF_WALL_M, HEAD_M, NO_LINTEL_M, Opening
from sim.homes.importers.losses import Losses
from sim.homes.importers.procthor_files import Hole, SourceHouse, Wall
from sim.homes.importers.rectilinear import Point, Stretch, on_side, rectangles, slanted_edge, snapped

CEILING_M = (2.0, 12.0)
"""Least and largest height of ceilings."""
LINTEL_M = 0.05
"""Least height of the wall above a hole."""
MIN_HOLE_M = 0.15
"""Holes that are narrower or lower than this are left out."""
MIN_OVERLAP_M = 0.05
"""Rooms may overlap by less than this."""
_KIND = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")


@dataclass(frozen=True)
class DoorHole:
    """An inner door, or the front door: its opening and how it is closed."""

    opening: Opening
    leaves: int
    """0 (only a frame), 1 or 2."""
    openness: float
    """0: closed; 1: at a right angle."""


@dataclass(frozen=True)
class Layout:
    """The rooms of a house and the holes in their walls."""

    plan: FloorPlan
    """The plan has one room per rectangle; rectangles of one room of the source differ by a number in their name."""
    room_of: tuple[int, ...]
    """The index of the room in the source, for each rectangle."""
    openings: tuple[Opening, ...]
    """All but the doors."""
    doors: tuple[DoorHole, ...]
    ceiling_m: float


def lay_out(house: SourceHouse, where: str, losses: Losses) -> Layout:
    """Returns the plan of a house.

    Args:
        house: the source.
        where: file and line, for messages.
        losses: gets the differences from the source.

    Raises:
        HouseError: a wall is not parallel to an axis, rooms overlap, or a door names a wall that does not exist.
    """
    grid = _Grid(house)
    top_m = max((point.y for wall in house.walls for point in wall.polygon), default=2.6)
    ceiling_m = min(max(top_m, CEILING_M[0]), CEILING_M[1])
    walls = {wall.id: wall for wall in house.walls}
    holes = [(hole, _stretch(hole, walls, grid, where)) for hole in (*house.doors, *house.windows)]
    rooms, room_of = _rooms(house, grid, [stretch for _, stretch in holes], where)
    plan = FloorPlan("flat", tuple(rooms), (), 0)
    openings = [*_between_parts(plan, room_of), *_missing_walls(house, plan, room_of, grid)]
    doors = []
    for number, (hole, stretch) in enumerate(holes):
        opening = _opening(hole, stretch, number < len(house.doors), plan, room_of, house, ceiling_m, losses)
        if opening is None:
            continue
        if number < len(house.doors):
            doors.append(DoorHole(opening, _leaves(hole.assetId), hole.openness or 0.0))
        else:
            openings.append(opening)
    return Layout(plan, tuple(room_of), tuple(openings), tuple(doors), round(ceiling_m, 3))


class _Grid:
    """The coordinates of a house, those that are nearly equal made equal."""

    def __init__(self, house: SourceHouse) -> None:
        points = [point for room in house.rooms for point in room.floorPolygon]
        points += [point for wall in house.walls for point in wall.polygon]
        self._x = snapped(point.x for point in points)
        self._y = snapped(point.z for point in points)

    def at(self, x_m: float, z_m: float) -> Point:
        """Returns the place in our plan of a point of the source."""
        return self._x[x_m], self._y[z_m]

    def ends(self, wall: Wall) -> tuple[Point, Point]:
        """Returns the two lower corners of a wall, in the order of its polygon, which can list upper ones first."""
        first, second = sorted(wall.polygon, key=lambda point: point.y)[:2]
        return self.at(first.x, first.z), self.at(second.x, second.z)


def _rooms(house: SourceHouse, grid: _Grid, holes: Sequence[Stretch], where: str) -> tuple[list[Room], list[int]]:
    """Returns the rectangles of all rooms, and the index of the room of each.

    Raises:
        HouseError: a room has a slanted edge or no area, or two rooms overlap.
    """
    rooms: list[Room] = []
    room_of: list[int] = []
    counts: dict[str, int] = {}
    for index, source in enumerate(house.rooms):
        polygon = [grid.at(point.x, point.z) for point in source.floorPolygon]
        if edge := slanted_edge(polygon):
            raise HouseError(
                f"{where}: room '{source.id}' has a slanted edge from {edge[0]} to {edge[1]}; only edges along x and z "
                "are read."
            )
        rects = rectangles(polygon, holes)
        if not rects:
            raise HouseError(f"{where}: room '{source.id}' has a floor without area.")
        kind = "_".join(_KIND.findall(source.roomType)).lower() or "room"
        name = f"room_{kind}_{counts.get(kind, 0):02d}"
        counts[kind] = counts.get(kind, 0) + 1
        for part, rect in enumerate(rects):
            other = next((n for n, room in enumerate(rooms) if room.rect.overlaps(rect, MIN_OVERLAP_M)), None)
            if other is not None:
                raise HouseError(f"{where}: rooms '{house.rooms[room_of[other]].id}' and '{source.id}' overlap.")
            rooms.append(Room(f"{name}_{part}" if part else name, kind, rect))
            room_of.append(index)
    return rooms, room_of


def _between_parts(plan: FloorPlan, room_of: Sequence[int]) -> Iterator[Opening]:
    """Yields the openings between the rectangles of one room."""
    for a, first in enumerate(plan.rooms):
        for b in range(a + 1, len(plan.rooms)):
            if room_of[a] == room_of[b] and (shared := shared_side(first.rect, plan.rooms[b].rect)):
                yield from _wide_open(a, b, shared[0], first.rect, shared[1])


def _missing_walls(house: SourceHouse, plan: FloorPlan, room_of: Sequence[int], grid: _Grid) -> Iterator[Opening]:
    """Yields the openings where the source has an empty wall between two rooms."""
    rooms = {room.id: index for index, room in enumerate(house.rooms)}
    for wall in house.walls:
        stretch = _along(*grid.ends(wall)) if wall.empty else None
        if stretch is None:
            continue
        for a, side, (lo, hi) in _parts_at(stretch, plan):
            for b, other, span in _parts_at(stretch, plan):
                common = max(lo, span[0]), min(hi, span[1])
                if side == OPPOSITE[other] and room_of[a] == rooms.get(wall.roomId) and room_of[b] > room_of[a]:
                    yield from _wide_open(a, b, side, plan.rooms[a].rect, common)


def _wide_open(a: int, b: int, side: Side, rect: Rect, span: Interval) -> Iterator[Opening]:
    """Yields an opening from floor to ceiling, except for the thickness of the walls at its ends."""
    lo, hi = span[0] + HALF_WALL_M, span[1] - HALF_WALL_M
    if hi > lo:
        yield Opening("open", a, b, side, rect.line(side), (lo, hi), 0.0, NO_LINTEL_M)


def _along(first: Point, second: Point) -> Stretch | None:
    """Returns the stretch between two points, or None if they are the same or not on one line."""
    if first[1] == second[1] and first[0] != second[0]:
        return Stretch("x", first[1], (min(first[0], second[0]), max(first[0], second[0])))
    if first[0] == second[0] and first[1] != second[1]:
        return Stretch("y", first[0], (min(first[1], second[1]), max(first[1], second[1])))
    return None


def _stretch(hole: Hole, walls: Mapping[str, Wall], grid: _Grid, where: str) -> Stretch:
    """Returns where a hole lies: its corners are measured from the first lower corner of its wall `wall0`.

    Raises:
        HouseError: the wall does not exist, or it is slanted.
    """
    if hole.wall0 not in walls:
        raise HouseError(f"{where}: '{hole.id}' is in the wall '{hole.wall0}', which does not exist.")
    first, second = grid.ends(walls[hole.wall0])
    along = _along(first, second)
    if along is None:
        raise HouseError(f"{where}: wall '{hole.wall0}' of '{hole.id}' is slanted or has no length.")
    axis = 0 if along.axis == "x" else 1
    sign = 1.0 if second[axis] > first[axis] else -1.0
    lo, hi = sorted(first[axis] + sign * corner.x for corner in hole.holePolygon)
    return replace(along, span=(max(lo, along.span[0]), min(hi, along.span[1])))


def _parts_at(stretch: Stretch, plan: FloorPlan) -> list[tuple[int, Side, Interval]]:
    """Returns the rectangles with a side along a part of a stretch: index, side, and that part; the longest first."""
    shared_walls: list[tuple[int, Side, Interval]] = []
    for index, room in enumerate(plan.rooms):
        side = on_side(room.rect, stretch)
        if side is not None:
            lo, hi = max(room.rect.span(side)[0], stretch.span[0]), min(room.rect.span(side)[1], stretch.span[1])
            if hi > lo:
                shared_walls.append((index, side, (lo, hi)))
    return sorted(shared_walls, key=lambda part: part[2][0] - part[2][1])


def _opening(
    hole: Hole, stretch: Stretch, is_door: bool, plan: FloorPlan, room_of: Sequence[int], house: SourceHouse,
    ceiling_m: float, losses: Losses,
) -> Opening | None:  # fmt: skip
    """Returns the opening of a hole, or None if it lies in no wall of a room or is too small."""
    what = "door" if is_door else "window"
    parts = _parts_at(stretch, plan)
    own = [part for part in parts if house.rooms[room_of[part[0]]].id == hole.room0] or parts
    z0, z1 = sorted(corner.y for corner in hole.holePolygon)
    z0, z1 = (0.0 if is_door else max(z0, 0.0)), min(z1, ceiling_m - LINTEL_M)
    if not own:
        losses.changes[f"A {what} lies in no wall of a room and was left out."] += 1
        return None
    a, side, span = own[0]
    behind = [part for part in parts if part[1] == OPPOSITE[side] and part[2][0] < span[1] and span[0] < part[2][1]]
    b = behind[0][0] if behind else None
    if behind:
        span = max(span[0], behind[0][2][0]), min(span[1], behind[0][2][1])
    # A hole stays out of the corners, where the other walls are.
    lo, hi = plan.rooms[a].rect.span(side)
    span = round(max(span[0], lo + HALF_WALL_M), 3), round(min(span[1], hi - HALF_WALL_M), 3)
    if span[1] - span[0] < MIN_HOLE_M or z1 - z0 < MIN_HOLE_M:
        losses.changes[f"A {what} is too small and was left out."] += 1
        return None
    if span[1] - span[0] < stretch.span[1] - stretch.span[0] - MIN_HOLE_M:
        losses.changes[f"A {what} was made narrower: it reaches across two rooms, or into a corner."] += 1
    line_m = plan.rooms[a].rect.line(side)
    if not is_door:
        kind = "window" if b is None else "opening"
        return Opening(kind, a, b, side, line_m, span, round(z0, 3), round(z1, 3))
    return Opening("entry" if b is None else "door", a, b, side, line_m, span, 0.0, round(z1, 3) or HEAD_M)


def _leaves(asset: str) -> int:
    """Returns how many leaves a door has, by the name of its asset: `Doorframe_5` has none, `Doorway_Double_1` two."""
    if asset.startswith("Doorframe"):
        return 0
    return 2 if "Double" in asset else 1
