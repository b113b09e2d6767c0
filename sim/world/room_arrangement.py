"""Rules on how the furniture of single rooms must stand, beyond those of `sim.world.arrangement`, which applies them.

They are this project's own unless a constant names its source. Distances are in plan, metres.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sim.houses.house import Box, Room
from sim.world.standing import Standing, blocks_floor

HALLWAY_PATH_M = 0.9
"""Width that furniture leaves free in a hallway (Approved Document M, England)."""
TOILET_APART_M = 0.2
"""Gap between a toilet and a basin, a shower or a bathtub; the IRC (R307) asks for 15 in from its middle line."""
OFF_BASIN_M = 0.15
"""Largest distance along the wall between the middles of a mirror in a bathroom and of the basin below it."""
SHOWER_TO_WALL_M = 0.05
"""Largest gap between a shower and each of the two walls of its corner."""
FROM_FIRE_M = 0.5
"""Smallest distance of seats, tables and storage from a fireplace or a stove."""
SHELF_TO_WALL_M = 0.3
"""Largest gap between a bookcase and the nearest wall."""
TABLE_TO_SEAT_M = 0.9
"""Largest gap between a coffee table and the nearest sofa or chair."""
LOW_PLANT_M = 0.8
"""Height of the tallest plant in a bathroom."""
SCREEN_DEG = 45.0
"""Largest angle between the heading of a bed and the direction from its middle to a screen."""
SCREEN_FRONT_M = 0.5
"""Depth of the floor in front of a screen on which no seat stands."""
SIGHT_M = 0.25
"""Half of the width of the strip between a sofa and a screen in which no table but a coffee table stands."""
LONG_TABLE_M, UNEVEN_M = 1.1, 0.35
"""Length of a dining table for four, and the largest distance of the mean of its chairs from its middle."""
TABLES_APART_M = 4.0
"""Smallest distance between the middles of two dining tables of one home."""
HOB_FROM_SINK_M = 0.3
"""Length of worktop between a sink and a hob."""
MAX_BINS = 1
"""Largest number of bins in a kitchen."""
SLACK_M = 0.02
_TO_CHAIR_M = 0.45
_BURNS = frozenset(("sofa", "chair", "seating", "stool", "table", "shelving", "cabinet", "chest_of_drawers", "bed"))


def room_clauses(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns a clause ("has ...") for each rule that the furniture of a room does not follow.

    Args:
        room: the room.
        inside: the instances in it.
    """
    rules = (*_RULES.get(room.kind, ()), _screens, _dining_tables, _fires, _out_of_place)
    return [clause for rule in rules for clause in rule(room, inside)]


def near_tables(standing: Sequence[Standing]) -> list[str]:
    """Returns a sentence for each two dining tables of one storey that stand near each other."""
    tables = [item for item in standing if item.name == "dining table"]
    return [
        f"{a.label} and {b.label} are dining tables {math.dist(a.middle, b.middle):.1f} m apart, "
        f"which must be {TABLES_APART_M:g} m"
        for a, b in itertools.combinations(tables, 2)
        if math.dist(a.middle, b.middle) < TABLES_APART_M - SLACK_M and abs(a.low[2] - b.low[2]) < 1.0
    ]


def _hallway(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on furniture that leaves too little width beside it."""
    clauses = []
    for item in inside:
        box = next((box for box in room.boxes if (np.abs(item.middle - box[0][:2]) <= box[1][:2]).all()), None)
        if box is None or not blocks_floor(item, room.floor_z_m):
            continue
        across = int(np.argmin(box[1][:2]))
        low_m, high_m = box[0][across] - box[1][across], box[0][across] + box[1][across]
        free_m = max(float(item.low[across]) - low_m, high_m - float(item.high[across]))
        if free_m < HALLWAY_PATH_M - SLACK_M:
            clauses.append(f"has {free_m:.2f} m of free width beside {item.label}, which must be {HALLWAY_PATH_M:g} m")
    return clauses


def _bathroom(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on toilets close to other fixtures, mirrors over no basin, loose showers and tall plants."""
    fixtures = [i for i in inside if i.category in ("sink", "shower", "bathtub") or i.name == "vanity cabinet"]
    clauses = []
    for toilet in (item for item in inside if item.category == "toilet"):
        for fixture in fixtures:
            gap_m = toilet.gap_m(fixture)
            if gap_m < TOILET_APART_M - SLACK_M:
                clauses.append(
                    f"has {gap_m:.2f} m between {toilet.label} and {fixture.label}, which must be {TOILET_APART_M:g} m"
                )
    basins = [item for item in fixtures if item.category == "sink" or item.name == "vanity cabinet"]
    clauses += [
        f"has {mirror.label}, a mirror that hangs over no basin"
        for mirror in (item for item in inside if item.category == "mirror")
        if not any(_hangs_over(mirror, basin) for basin in basins)
    ]
    clauses += [
        f"has {shower.label}, a shower that stands in no corner"
        for shower in (item for item in inside if item.category == "shower")
        if not any(to_walls_m(box, shower).max() <= SHOWER_TO_WALL_M for box in room.boxes)
    ]
    for plant in (item for item in inside if item.category == "plant"):
        height_m = float(plant.high[2] - plant.low[2])
        if height_m > LOW_PLANT_M + SLACK_M:
            clauses.append(f"has {plant.label}, a plant {height_m:.1f} m high instead of at most {LOW_PLANT_M:g} m")
    return clauses


def _hangs_over(mirror: Standing, basin: Standing) -> bool:
    away = basin.middle - mirror.middle
    beside_m = abs(float(away @ np.array([-mirror.front[1], mirror.front[0]])))
    return beside_m <= OFF_BASIN_M + SLACK_M and mirror.gap_m(basin) <= OFF_BASIN_M


def _bedroom(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on screens that no bed faces."""
    beds = [item for item in inside if item.category == "bed"]
    return [
        f"has {screen.label}, a screen that no bed faces"
        for screen in _televisions(inside)
        if beds and not any(_angle_deg(bed, screen) <= SCREEN_DEG + 0.5 for bed in beds)
    ]


def _angle_deg(bed: Standing, screen: Standing) -> float:
    away = screen.middle - bed.middle
    return math.degrees(math.acos(float(np.clip(away @ bed.front / max(np.linalg.norm(away), 1e-9), -1.0, 1.0))))


def _screens(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on a second screen in a room, and on seats below or right in front of a screen."""
    screens = _televisions(inside)
    clauses = [f"has {len(screens)} televisions"] if len(screens) > 1 else []
    seats = [item for item in inside if item.category in ("chair", "sofa")]
    for screen in screens:
        left = np.array([-screen.front[1], screen.front[0]])
        half = 0.5 * (screen.high - screen.low)[:2]
        for seat in seats:
            seat_half, away = 0.5 * (seat.high - seat.low)[:2], seat.middle - screen.middle
            beside_m = abs(float(away @ left)) - float((half + seat_half) @ np.abs(left))
            ahead_m = float(away @ screen.front) - float(seat_half @ np.abs(screen.front))
            behind_m = float(away @ screen.front) + float((half + seat_half) @ np.abs(screen.front))
            if beside_m < -0.05 and behind_m > 0.0 and ahead_m < SCREEN_FRONT_M - SLACK_M:
                clauses.append(f"has {seat.label} in front of {screen.label}")
    return clauses


def _televisions(inside: Sequence[Standing]) -> list[Standing]:
    return [item for item in inside if item.name == "television"]


def _living_room(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on tables between a sofa and the screen that it faces."""
    clauses = []
    tables = [item for item in inside if item.category == "table" and item.name != "coffee table"]
    for sofa, screen in itertools.product((i for i in inside if i.category == "sofa"), _televisions(inside)):
        away = screen.middle - sofa.middle
        if away @ sofa.front < 0.7 * np.linalg.norm(away):
            continue
        points = sofa.middle + np.linspace(0.25, 0.85, 20)[:, None] * away
        for table in tables:
            on_line = (points > table.low[:2] - SIGHT_M) & (points < table.high[:2] + SIGHT_M)
            if on_line.all(axis=1).any():
                clauses.append(f"has {table.label} between {sofa.label} and {screen.label}")
    return clauses


def _fires(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on furniture close to a fireplace or a stove."""
    return [
        f"has {item.label} {gap_m:.2f} m from {fire.label}, which must be {FROM_FIRE_M:g} m"
        for fire, item in itertools.product(inside, inside)
        if fire.category == "fireplace" and item.category in _BURNS and blocks_floor(item, room.floor_z_m)
        if (gap_m := item.gap_m(fire)) < FROM_FIRE_M - SLACK_M
    ]


def _out_of_place(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on bookcases away from the walls, and on coffee tables without a seat."""
    seats = [item for item in inside if item.category in ("sofa", "chair")]
    clauses = [
        f"has {shelf.label}, a bookcase that stands at no wall"
        for shelf in (item for item in inside if item.name == "bookcase")
        if min(float(to_walls_m(box, shelf).min()) for box in room.boxes) > SHELF_TO_WALL_M
    ]
    return clauses + [
        f"has {table.label}, a coffee table without a seat next to it"
        for table in (item for item in inside if item.name == "coffee table")
        if min((table.gap_m(seat) for seat in seats), default=math.inf) > TABLE_TO_SEAT_M
    ]


def to_walls_m(box: Box, item: Standing) -> NDArray[np.float64]:
    """Returns the gap between an item and the nearer wall along x and along y (2,), metres."""
    low, high = (np.add(box[0], sign * np.asarray(box[1]))[:2] for sign in (-1.0, 1.0))
    return np.minimum(item.low[:2] - low, high - item.high[:2])


def _dining_tables(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on tables for four or more with chairs on one side only."""
    clauses = []
    chairs = [item for item in inside if item.category == "chair"]
    for table in (item for item in inside if item.name == "dining table"):
        near = [chair.middle - table.middle for chair in chairs if chair.gap_m(table) <= _TO_CHAIR_M]
        if len(near) > 1 and (table.high - table.low)[:2].max() >= LONG_TABLE_M:
            off_m = float(np.linalg.norm(np.mean(near, axis=0)))
            if off_m > UNEVEN_M:
                clauses.append(f"has {table.label}, a dining table whose chairs stand on one side")
    return clauses


def _kitchen(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on a hob at the sink, and on items that do not belong in a kitchen."""
    sinks = [item for item in inside if item.category == "sink"]
    hobs = [item for item in inside if item.name in ("hob", "cooker")]
    clauses = [
        f"has {gap_m:.2f} m of worktop between {sink.label} and {hob.label}, which must be {HOB_FROM_SINK_M:g} m"
        for sink, hob in itertools.product(sinks, hobs)
        if (gap_m := sink.gap_m(hob)) < HOB_FROM_SINK_M - SLACK_M
    ]
    if room.kind == "kitchen":
        bins = sum(item.name == "bin" for item in inside)
        clauses += [f"has {bins} bins"] if bins > MAX_BINS else []
        clauses += [
            f"has {item.label}, which does not belong in a kitchen"
            for item in inside
            if item.category == "gym_equipment" or item.name == "duffel bag"
        ]
    return clauses


_RULES: Mapping[str, tuple[Callable[[Room, Sequence[Standing]], list[str]], ...]] = MappingProxyType(
    {
        "hallway": (_hallway,),
        "bathroom": (_bathroom,),
        "bedroom": (_bedroom,),
        "living_room": (_living_room,),
        "studio": (_living_room, _kitchen),
        "kitchen": (_kitchen,),
    }
)
