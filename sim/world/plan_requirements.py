"""The rules for the floor plan of a generated home: its rooms, their sizes, and where their doors lie.

Sizes are measured between the walls. Smallest sizes follow these handbooks where they give one:

- bedrooms: Nationally Described Space Standard (England, 2015), a single bedroom of 7.5 m2 that is 2.15 m wide;
- living rooms: London Housing Design Guide (2010), a sitting area that is 2.8 m wide;
- corridors: Approved Document M (England), an unobstructed width of 0.9 m;
- rooms for work: International Residential Code, section R304, habitable rooms 7 ft (2.13 m) wide;
- windows: International Residential Code, section R303, glazing in habitable rooms; open kitchens and dining rooms may
  share it with the room beside them.

The other limits, the largest sizes and the numbers of rooms and doors, are this project's own: they exclude plans that
have no use for the area, such as a bathroom of 15 m2.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.core.vocabulary import counted
from sim.gl import mujoco
from sim.houses.hazards import read_hazards
from sim.houses.house import Room
from sim.houses.labels import Labels, collidable_geoms

Extent = tuple[float, float, float, float]
"""Smallest x and y, largest x and y, metres."""


@dataclass(frozen=True)
class RoomSize:
    """Limits on the size of a kind of room between its walls."""

    area_m2: tuple[float, float]
    """Smallest, largest."""
    short_m: float
    """Smallest length of the shorter side."""
    aspect: float = 2.2
    """Largest ratio of the longer side to the shorter one."""


ROOM_SIZES: Mapping[str, RoomSize] = MappingProxyType(
    {
        "living_room": RoomSize((13.0, 55.0), 2.8),
        "kitchen": RoomSize((5.5, 24.0), 1.8),
        "dining_room": RoomSize((7.0, 28.0), 2.3),
        "studio": RoomSize((20.0, 50.0), 3.5),
        "bedroom": RoomSize((7.5, 24.0), 2.15),
        "bathroom": RoomSize((2.5, 9.0), 1.2, 2.6),
        "office": RoomSize((6.0, 20.0), 2.13),
        "gym": RoomSize((9.0, 26.0), 2.4),
        "laundry": RoomSize((2.5, 9.0), 1.4, 2.6),
        "closet": RoomSize((2.0, 8.0), 1.2, 2.6),
        "stair_hall": RoomSize((9.0, 16.0), 2.2),
    }
)
"""Size limits by kind of room; other kinds have none."""
HALLWAY_M = (0.9, 15.0)
"""Smallest width of a hallway between its walls, and its largest length in a storey of up to `USUAL_M2`; hallways in
one line count as one."""
USUAL_M2, M2_PER_M = 300.0, 40.0
"""Area of a storey from which hallways may be longer, and by how many square metres for each metre."""
M2_PER_SHARE, MAX_SHARE = 1000.0, 0.4
"""Rooms of larger storeys may be larger: by a part for each so many square metres, up to this share."""
IN_LINE_M = 0.8
"""Width of a straight path through two hallways that makes them one line."""
HALLWAY_SHARE = 0.2
"""Largest share of the hallways in the floor area of a storey."""
NEEDED_ROOMS = ("bedroom", "bathroom", "kitchen", "living_room")
"""Kinds of rooms that every home has, except for a studio, which needs a bathroom only."""
LIVING_SHARE, LIVING_M2 = 0.12, 20.0
"""Smallest share of the largest living room in the floor area of a home, and the area that suffices for any home."""
LIT = frozenset(("living_room", "bedroom", "studio", "office"))
"""Kinds of rooms that have a window."""
BEDROOMS_FROM_M2 = ((78.0, 2), (150.0, 3), (260.0, 4))
"""Smallest numbers of bedrooms, and the floor area of a home from which each applies."""
MAX_ROOMS: Mapping[str, int] = MappingProxyType({"kitchen": 1, "laundry": 1, "gym": 1, "studio": 1})
"""Largest number of rooms of these kinds in a home."""
MORE_THAN_BEDROOMS: Mapping[str, int] = MappingProxyType({"bathroom": 1, "closet": 1, "office": 1})
"""By how much rooms of these kinds may outnumber the bedrooms; the further bathroom is for guests."""
DOOR_EVERY_M, MAX_DOORS_IN_WALL = (1.9, 3.0), 5
"""A wall of a room may have two doors, or one for each stretch of the first length, up to this number; a longer wall
may have one for each stretch of the second length."""
SWING_M = 0.8
"""Depth of the floor before a door, on which no other door of the same room opens, except in a hallway."""
NOT_CAPTIVE = frozenset(("bedroom", "gym"))
"""Kinds of rooms that need a door to one of `CIRCULATION`: they have doors only, and no wide openings."""
CIRCULATION = frozenset(("hallway", "stair_hall", "living_room", "dining_room", "studio"))
"""Kinds of rooms through which one may walk to a bedroom."""
TO_BATHROOM = frozenset(("hallway", "stair_hall", "bedroom", "closet", "laundry", "studio"))
"""Kinds of rooms that may have a door to a bathroom."""
FOR_GUESTS = frozenset(("hallway", "stair_hall", "studio"))
"""Kinds of rooms from which one reaches a bathroom without a walk through a private room."""
_WALL_M = 0.3
"""Largest distance from the middle of a door to the rooms on its two sides."""
_CASING_M = 0.05
"""A geom lies in a wall if its middle is at most this far inside of a room."""
_SAME_DOOR_M = 0.45
"""Geoms of doors nearer than this belong to one doorway, for example a frame and its leaf."""


@dataclass(frozen=True)
class Doorway:
    """A door or a window in a wall."""

    centre_m: tuple[float, float]
    """Middle of its threshold (x, y)."""
    width_m: float
    """Extent along its wall."""
    along_x: bool
    """Whether its wall runs along x."""
    floor_z_m: float = 0.0

    def side_point(self, sign: float) -> tuple[float, float]:
        """Returns a point in the room on one of its two sides: 1 for the larger coordinate, -1 for the smaller one."""
        x, y = self.centre_m
        return (x, y + sign * _WALL_M) if self.along_x else (x + sign * _WALL_M, y)

    def wall(self, extent: Extent) -> str:
        """Returns the side of a room, on which it lies: "x" or "y", with "+" or "-"."""
        axis = int(self.along_x)
        middle = 0.5 * (extent[axis] + extent[axis + 2])
        return f"{'xy'[axis]}{'+' if self.centre_m[axis] > middle else '-'}"

    def swing(self, extent: Extent) -> Extent:
        """Returns the floor before it in a room with this extent."""
        x, y = self.centre_m
        half = 0.5 * self.width_m
        if self.along_x:
            inner = extent[3] if self.wall(extent) == "y+" else extent[1]
            ends = sorted((inner, inner - SWING_M if self.wall(extent) == "y+" else inner + SWING_M))
            return x - half, ends[0], x + half, ends[1]
        inner = extent[2] if self.wall(extent) == "x+" else extent[0]
        ends = sorted((inner, inner - SWING_M if self.wall(extent) == "x+" else inner + SWING_M))
        return ends[0], y - half, ends[1], y + half


def plan_faults(rooms: Sequence[Room], doors: Iterable[Doorway], windows: Iterable[Doorway]) -> list[str]:
    """Returns a sentence for each rule that the floor plan of a home violates.

    Args:
        rooms: the rooms of all storeys.
        doors: their doors and front doors, without wide openings.
        windows: their windows.
    """
    lit = {room.name for window in windows for sign in (-1.0, 1.0) if (room := _room_at(rooms, window, sign))}
    dark = [f"{room.name} has no window" for room in rooms if room.kind in LIT and room.name not in lit]
    return [*room_faults(rooms), *dark, *_door_faults(rooms, tuple(doors))]


def room_faults(rooms: Sequence[Room]) -> list[str]:
    """Returns a sentence for each rule on number and size of rooms that is violated by the rooms of all storeys."""
    home_m2 = sum(room.area_m2 for room in rooms)
    faults = _number_faults(Counter(room.kind for room in rooms), home_m2)
    living_m2 = max((room.area_m2 for room in rooms if room.kind == "living_room"), default=LIVING_M2)
    if living_m2 < min(LIVING_SHARE * home_m2, LIVING_M2):
        faults.append(f"the living room has {living_m2:.0f} of {home_m2:.0f} m2")
    for floor_z_m in sorted({room.floor_z_m for room in rooms}):
        storey = [room for room in rooms if room.floor_z_m == floor_z_m]
        whole_m2 = sum(room.area_m2 for room in storey)
        halls_m2 = sum(room.area_m2 for room in storey if room.kind == "hallway")
        longest_m = HALLWAY_M[1] + max(0.0, whole_m2 - USUAL_M2) / M2_PER_M
        for room in storey:
            faults += _hallway_faults(room) if room.kind == "hallway" else _size_faults(room, whole_m2)
        faults += _long_hallways([room for room in storey if room.kind == "hallway"], longest_m)
        if halls_m2 > HALLWAY_SHARE * whole_m2:
            faults.append(f"hallways take {halls_m2:.0f} of {whole_m2:.0f} m2")
    return faults


def unmet_plan_requirements(
    model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, rooms: Sequence[Room]
) -> list[str]:
    """Returns a sentence for each rule that the floor plan of a compiled house violates.

    Args:
        model: the compiled house.
        data: its state; kinematics must be computed.
        labels: the labels of its geoms.
        rooms: its rooms.
    """
    doors, windows = (measured(kind, model, data, labels, rooms) for kind in ("door", "window"))
    return plan_faults(rooms, doors, windows)


def measured(
    category: Literal["door", "window"],
    model: mujoco.MjModel,
    data: mujoco.MjData,
    labels: Labels,
    rooms: Sequence[Room],
) -> list[Doorway]:
    """Returns the doors or windows of a compiled house, from the solid geoms with that label that lie in walls.

    Leaves inside of a room are left out, and so are glass doors that are hazards; a closed leaf counts with its frame.
    """
    found: list[Doorway] = []
    solid, hazards, slack_m = collidable_geoms(model), read_hazards(model), np.full(3, 0.01)
    for instance in labels.of_category(category):
        ids = np.array([geom for geom in instance.geom_ids if solid[geom]], dtype=np.int64)
        if not ids.size:
            continue
        rotation = data.geom_xmat[ids].reshape(-1, 3, 3)
        middle = data.geom_xpos[ids] + np.einsum("nij,nj->ni", rotation, model.geom_aabb[ids, :3])
        reach = np.einsum("nij,nj->ni", np.abs(rotation), model.geom_aabb[ids, 3:])
        corners = (middle - reach).min(axis=0), (middle + reach).max(axis=0)
        if any((corners[0] > h.low_m - slack_m).all() and (corners[1] < h.high_m + slack_m).all() for h in hazards):
            continue
        floor_z_m = max((room.floor_z_m for room in rooms if room.floor_z_m < float(middle[:, 2].mean())), default=0.0)
        storey = [_extent(room) for room in rooms if room.floor_z_m == floor_z_m]
        in_wall = np.array([not any(_inside(extent, point, -_CASING_M) for extent in storey) for point in middle])
        if not in_wall.any():
            continue
        low, high = (middle - reach)[in_wall].min(axis=0), (middle + reach)[in_wall].max(axis=0)
        size, (x, y, _) = high - low, (0.5 * (low + high)).tolist()
        opening = Doorway((x, y), float(size[:2].max()), bool(size[0] > size[1]), floor_z_m)
        if not any(_distance_m(opening, other) < _SAME_DOOR_M for other in found):
            found.append(opening)
    return found


def _number_faults(count: Counter[str], area_m2: float) -> list[str]:
    """Returns the faults in the kinds and numbers of rooms of a home."""
    needed = ("bathroom",) if count["studio"] else NEEDED_ROOMS
    faults = [f"the home has no {_words(kind)}" for kind in needed if not count[kind]]
    faults += [
        f"the home has {count[kind]} rooms of the kind {kind} instead of at most {most}"
        for kind, most in MAX_ROOMS.items()
        if count[kind] > most
    ]
    beds = max(count["bedroom"], count["studio"])
    least = max((number for from_m2, number in BEDROOMS_FROM_M2 if area_m2 >= from_m2), default=0)
    if 0 < beds < least:
        faults.append(f"the home of {area_m2:.0f} m2 has {counted(beds, 'bedroom')} instead of at least {least}")
    faults += [
        f"the home has {count[kind]} rooms of the kind {kind} for {beds} bedrooms"
        for kind, more in MORE_THAN_BEDROOMS.items()
        if beds and count[kind] > beds + more
    ]
    return faults


def _size_faults(room: Room, storey_m2: float) -> list[str]:
    """Returns the faults in the size of a room of a storey of this area."""
    x0, y0, x1, y1 = _extent(room)
    short_m, long_m = sorted((x1 - x0, y1 - y0))
    limit = ROOM_SIZES.get(room.kind)
    if limit is None:
        return []
    low, high = limit.area_m2
    high *= 1.0 + min(max(0.0, storey_m2 - USUAL_M2) / M2_PER_SHARE, MAX_SHARE)
    faults = []
    if not low - 0.05 <= room.area_m2 <= high + 0.05:
        faults.append(f"{room.name} has {room.area_m2:.1f} m2 instead of {low:g} to {high:.3g} m2")
    if short_m < limit.short_m - 0.005:
        faults.append(f"{room.name} is only {short_m:.2f} m wide instead of {limit.short_m:g} m")
    if long_m > (limit.aspect + 0.01) * short_m:
        faults.append(f"{room.name} is {long_m / short_m:.1f} times as long as wide instead of {limit.aspect:g} times")
    return faults


def _hallway_faults(hallway: Room) -> list[str]:
    """Returns the faults in the width of a hallway."""
    x0, y0, x1, y1 = _extent(hallway)
    short_m = min(x1 - x0, y1 - y0)
    if short_m < HALLWAY_M[0] - 0.005:
        return [f"{hallway.name} is only {short_m:.2f} m wide instead of {HALLWAY_M[0]:g} m"]
    return []


def _long_hallways(hallways: Sequence[Room], longest_m: float) -> list[str]:
    """Returns the faults in the length of the straight lines of hallways of a storey."""
    lengths_m: dict[frozenset[str], float] = {}
    for axis, start in itertools.product((0, 1), hallways):
        line = [start]
        low, high = _extent(start)[axis], _extent(start)[axis + 2]
        rest = [other for other in hallways if other is not start]
        while more := [other for other in rest if _continues(start, (low, high), other, axis)]:
            line += more
            rest = [other for other in rest if other not in more]
            low = min(low, *(_extent(other)[axis] for other in more))
            high = max(high, *(_extent(other)[axis + 2] for other in more))
        names = frozenset(room.name for room in line)
        lengths_m[names] = max(lengths_m.get(names, 0.0), high - low)
    return [
        f"{' and '.join(sorted(names))} {'is' if len(names) == 1 else 'are'} {length_m:.1f} m long "
        f"instead of at most {longest_m:.1f} m"
        for names, length_m in lengths_m.items()
        if length_m > longest_m + 0.005
    ]


def _continues(start: Room, span_m: tuple[float, float], other: Room, axis: int) -> bool:
    """Returns whether a hallway lies in the line of another one, whose line reaches over `span_m` along an axis."""
    a, b = _extent(start), _extent(other)
    across_m = min(a[3 - axis], b[3 - axis]) - max(a[1 - axis], b[1 - axis])
    return across_m > IN_LINE_M and b[axis] <= span_m[1] + _WALL_M and b[axis + 2] >= span_m[0] - _WALL_M


def _door_faults(rooms: Sequence[Room], doors: Sequence[Doorway]) -> list[str]:
    """Returns the faults in the places of doors: too many in a wall, swings that cross, rooms behind wrong rooms."""
    faults: list[str] = []
    doors_of: dict[str, list[Doorway]] = {room.name: [] for room in rooms}
    neighbours: dict[str, set[str]] = {room.name: set() for room in rooms}
    kind_of = {room.name: room.kind for room in rooms}
    for door in doors:
        beside = [room for sign in (-1.0, 1.0) if (room := _room_at(rooms, door, sign)) is not None]
        for room in beside:
            doors_of[room.name].append(door)
            neighbours[room.name] |= {other.name for other in beside if other is not room}
    for room in rooms:
        faults += _wall_faults(room, doors_of[room.name])
        behind = [kind_of[name] for name in neighbours[room.name]]
        if room.kind == "bathroom":
            faults += [f"{room.name} opens off a {_words(kind)}" for kind in behind if kind not in TO_BATHROOM]
        if room.kind == "bedroom" and behind.count("bathroom") > 1:
            faults.append(f"{room.name} has doors to {behind.count('bathroom')} bathrooms")
        if room.kind in NOT_CAPTIVE and behind and not CIRCULATION.intersection(behind):
            faults.append(f"{room.name} is entered only through a {_words(behind[0])}")
    baths = [room.name for room in rooms if room.kind == "bathroom"]
    if baths and not any(kind_of[other] in FOR_GUESTS for name in baths for other in neighbours[name]):
        faults.append("no bathroom has a door to a hallway")
    return faults


def _wall_faults(room: Room, doors: Sequence[Doorway]) -> list[str]:
    """Returns the faults of the doors of one room."""
    extent, faults = _extent(room), []
    for wall, count in Counter(door.wall(extent) for door in doors).items():
        length_m = extent[2] - extent[0] if wall[0] == "y" else extent[3] - extent[1]
        close, wide = (int(length_m / every_m) for every_m in DOOR_EVERY_M)
        if count > max(2, min(close, MAX_DOORS_IN_WALL), wide):
            faults.append(f"{room.name} has {count} doors in a wall of {length_m:.1f} m")
    if room.kind not in ("hallway", "stair_hall"):
        zones = [door.swing(extent) for door in doors]
        if any(_overlap(a, b) for a, b in itertools.combinations(zones, 2)):
            faults.append(f"two doors of {room.name} open onto each other")
    return faults


def _room_at(rooms: Sequence[Room], door: Doorway, sign: float) -> Room | None:
    """Returns the room on one side of a door; None outside of the home."""
    point = door.side_point(sign)
    return next((r for r in rooms if r.floor_z_m == door.floor_z_m and r.contains(*point)), None)


def _extent(room: Room) -> Extent:
    """Returns the rectangle around the boxes of a room."""
    sides = [(x - hx, y - hy, x + hx, y + hy) for (x, y, _), (hx, hy, _) in room.boxes]
    return (
        min(s[0] for s in sides), min(s[1] for s in sides), max(s[2] for s in sides), max(s[3] for s in sides)
    )  # fmt: skip


def _inside(extent: Extent, point_m: NDArray[np.float64], margin_m: float) -> bool:
    x, y = float(point_m[0]), float(point_m[1])
    return extent[0] - margin_m <= x <= extent[2] + margin_m and extent[1] - margin_m <= y <= extent[3] + margin_m


def _overlap(a: Extent, b: Extent) -> bool:
    return min(a[2], b[2]) - max(a[0], b[0]) > 0.01 and min(a[3], b[3]) - max(a[1], b[1]) > 0.01


def _distance_m(a: Doorway, b: Doorway) -> float:
    if a.floor_z_m != b.floor_z_m:
        return np.inf
    return float(np.hypot(a.centre_m[0] - b.centre_m[0], a.centre_m[1] - b.centre_m[1]))


def _words(kind: str) -> str:
    return kind.replace("_", " ")
