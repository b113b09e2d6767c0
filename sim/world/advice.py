"""Advice on the design of a furnished home: what an architect would change, although the home can be used.

No house is rejected for it, and the generator does not apply these rules. `sim.world.arrangement` and
`sim.world.plan_requirements` have the rules that every generated house follows.

Sources: NKBA Kitchen Planning Guidelines (guideline 3, legs of the work triangle of at most 9 ft; 8, 32 in behind a
seated diner; 11, worktop of 24 in next to a sink); London Housing Design Guide (2010), a second toilet in homes for
five people. The other limits are this project's own. Distances are in plan, metres.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.core.vocabulary import counted
from sim.houses.house import Room
from sim.world.arrangement import DOUBLE_BED_M, MAX_TO_CHAIR_M, TOUCH_M, work_centres
from sim.world.room_arrangement import SHELF_TO_WALL_M, to_walls_m
from sim.world.standing import Standing, blocks_floor, is_in

MAX_SEATS_NEEDED = 4
"""A home has a table with one seat more than it has bedrooms; this number suffices for any home."""
SECOND_TOILET_FROM = 5
"""Sleeping places from which a home has a second toilet (London Housing Design Guide)."""
MAX_LEG_M = 2.74
"""Longest leg of the work triangle (NKBA guideline 3: 9 ft)."""
WORKTOP_M = 0.45
"""Length of worktop on the longer side of a sink (NKBA guideline 11: 24 in, 0.61 m)."""
BEHIND_DINER_M = 0.65
"""From the edge of a dining table to an obstacle behind a chair (NKBA guideline 8: 32 in, 0.81 m)."""
STORAGE_FRONT_M = 0.55
"""Depth of the free floor in front of storage: its door leaves are up to 0.5 m wide."""
MAX_ALIKE = 4
"""Largest number of small objects of one name in a room."""
HIDDEN_SHARE = 0.25
"""Share of a picture or a mirror that furniture may hide."""
AT_WALL_M = 0.25
"""Furniture nearer to a wall than this hides what hangs on the wall."""
COMPANY_M = 1.0
"""A stool or a bench away from the walls has a seat, a bed, a table or a counter at most this far away."""
RUG_TO_FIRE_M = 0.1
"""Smallest distance of a rug from a fireplace or a stove, which includes its hearth plate."""
ON_RUG_SHARES = (0.05, 0.9)
"""Furniture with a share of its base between these on a rug does not stand level."""
SLACK_M = 0.02
_STORAGE = frozenset(("wardrobe", "chest of drawers", "sideboard", "linen shelf", "drying cupboard"))
_EASILY_MOVED = frozenset(("stool", "pouf", "dining chair", "office chair"))
_HANGING = frozenset(("picture", "mirror", "board_panel"))
_HIDES = frozenset(("cabinet", "chest_of_drawers", "shelving", "appliances", "furniture"))
_COMPANY = frozenset(("sofa", "chair", "bed", "table", "counter"))
_HEAVY = frozenset(("cabinet", "shelving", "chest_of_drawers"))
_HALL_PIECES = frozenset(("console table", "bench"))


def advice(rooms: Sequence[Room], standing: Sequence[Standing]) -> list[str]:
    """Returns a sentence for each property of a home that an architect would change.

    Args:
        rooms: its rooms.
        standing: its instances (`sim.world.standing`).
    """
    sentences = [*_household(rooms, standing), *_hidden(standing), *_rugs(standing)]
    for room in rooms:
        inside = [item for item in standing if is_in(room, item)]
        clauses = [*_diners(room, inside), *_storage(room, inside), *_alike(inside), *_adrift(room, inside)]
        if room.kind in ("kitchen", "studio"):
            clauses += _work_centres(inside)
        sentences += [f"{room.name} {clause}" for clause in clauses]
    return sentences


def _household(rooms: Sequence[Room], standing: Sequence[Standing]) -> list[str]:
    """Returns sentences on too few seats at the largest dining table, and too few toilets, for the beds of a home."""
    bedrooms = sum(room.kind in ("bedroom", "studio") for room in rooms)
    if not bedrooms:
        return []
    sentences = []
    seats = max((len(_chairs_at(item, standing)) for item in standing if _is_for_meals(item)), default=0)
    needed = min(bedrooms + 1, MAX_SEATS_NEEDED)
    if seats < needed:
        sentences.append(
            f"the home has {counted(seats, 'seat')} at its largest dining table instead of at least {needed}"
        )
    places = sum(2 if _width_m(item) >= DOUBLE_BED_M else 1 for item in standing if item.category == "bed")
    toilets = sum(item.category == "toilet" for item in standing)
    if places >= SECOND_TOILET_FROM and toilets == 1:
        sentences.append(f"the home has one toilet for {places} sleeping places")
    return sentences


def _is_for_meals(item: Standing) -> bool:
    return item.name in ("dining table", "breakfast bar", "kitchen island")


def _chairs_at(table: Standing, items: Sequence[Standing]) -> list[Standing]:
    """Returns the chairs at a table; for a bar or an island, its stools."""
    kind = "chair" if table.name == "dining table" else "stool"
    return [item for item in items if item.category == kind and item.gap_m(table) <= MAX_TO_CHAIR_M]


def _work_centres(inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on long legs of the work triangle, and on sinks without worktop next to them."""
    centres = work_centres(inside)
    legs = {f"{a} and {b}": math.dist(centres[a], centres[b]) for a, b in itertools.combinations(centres, 2)}
    clauses = [
        f"has {leg_m:.1f} m between {names}, which must be at most {MAX_LEG_M:.1f} m"
        for names, leg_m in legs.items()
        if leg_m > MAX_LEG_M + SLACK_M
    ]
    counters = [item for item in inside if item.category == "counter"]
    for sink in (item for item in inside if item.category == "sink"):
        holder = next((counter for counter in counters if counter.gap_m(sink) == 0.0), None)
        if holder is None or _heading(holder.front) is None:
            continue
        along = int(np.argmin(np.abs(holder.front)))
        worktop_m = max(_worktop_m(sink, holder, counters, along, sign) for sign in (1, -1))
        if worktop_m < WORKTOP_M - SLACK_M:
            clauses.append(
                f"has {worktop_m:.2f} m of worktop on the longer side of {sink.label}, which must be {WORKTOP_M:g} m"
            )
    return clauses


def _worktop_m(sink: Standing, holder: Standing, counters: Sequence[Standing], along: int, sign: int) -> float:
    """Returns the length of the worktop from a sink to one side, over the counters in one line with its holder."""
    start_m = end_m = float((sink.high if sign > 0 else sink.low)[along]) * sign
    line = [c for c in counters if abs(float(c.middle[1 - along] - holder.middle[1 - along])) < TOUCH_M]
    for counter in sorted(line, key=lambda c: sign * float(c.middle[along])):
        near_m, far_m = sorted((sign * float(counter.low[along]), sign * float(counter.high[along])))
        if near_m - end_m <= TOUCH_M and far_m > end_m:
            end_m = far_m
    return end_m - start_m


def _diners(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns a clause for each dining table at which there is no room behind a chair."""
    clauses = []
    for table in (item for item in inside if item.name == "dining table"):
        chairs = _chairs_at(table, inside)
        others = [item for item in inside if item is not table and item not in chairs]
        narrow = []
        for chair in chairs:
            back = _heading(-chair.front)
            if back is None:
                continue
            to_back_m = _side_m(chair, back) - _side_m(table, back)
            narrow.append((to_back_m + _free_m(room, chair, back, others), chair.label))
        if narrow and min(narrow)[0] < BEHIND_DINER_M - SLACK_M:
            free_m, label = min(narrow)
            clauses.append(f"has {free_m:.2f} m from {table.label} to what is behind {label}, "
                           f"which must be {BEHIND_DINER_M:g} m")  # fmt: skip
    return clauses


def _storage(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on wardrobes, chests and sideboards whose doors cannot open."""
    clauses = []
    for item in (item for item in inside if item.name in _STORAGE):
        front = _heading(item.front)
        if front is None:
            continue
        others = [other for other in inside if other is not item and other.name not in _EASILY_MOVED]
        free_m = _free_m(room, item, front, others)
        if free_m < STORAGE_FRONT_M - SLACK_M:
            clauses.append(f"has {free_m:.2f} m of free floor before {item.label}, which must be {STORAGE_FRONT_M:g} m")
    return clauses


def _alike(inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on many small objects of one name."""
    count = Counter(item.name for item in inside if item.category == "objects")
    return [f"has {number} objects of the kind {name}" for name, number in count.items() if number > MAX_ALIKE]


def _adrift(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on stools and benches alone in the middle of a room, and on racks away from the walls."""
    clauses = []
    for item in inside:
        is_rack = item.name == "dumbbell rack"
        if not is_rack and item.category not in ("seating", "stool"):
            continue
        wall_m = min(float(to_walls_m(box, item).min()) for box in room.boxes)
        company = any(o.category in _COMPANY and o.gap_m(item) < COMPANY_M for o in inside if not is_rack)
        if wall_m > SHELF_TO_WALL_M and not company:
            clauses.append(f"has {item.label}, which stands alone in the middle of the room")
    return clauses


def _hidden(standing: Sequence[Standing]) -> list[str]:
    """Returns a sentence for each picture, mirror and board that a piece of furniture hides."""
    sentences = []
    tall = [item for item in standing if item.category in _HIDES]
    for hung in (item for item in standing if item.category in _HANGING):
        front = _heading(hung.front)
        if front is None:
            continue
        along = int(np.argmin(np.abs(front)))
        area_m2 = float((hung.high - hung.low)[along] * (hung.high - hung.low)[2])
        for item in tall:
            gap_m = _side_m(item, -front) * -1.0 - _side_m(hung, front)
            overlap = np.maximum(item.overlap_m(hung), 0.0)
            if -AT_WALL_M < gap_m < AT_WALL_M and overlap[along] * overlap[2] > HIDDEN_SHARE * area_m2:
                sentences.append(f"{hung.label} hangs behind {item.label}")
                break
    return sentences


def _rugs(standing: Sequence[Standing]) -> list[str]:
    """Returns sentences on rugs at a fire, and on heavy furniture that stands only partly on a rug."""
    sentences = []
    for rug, item in itertools.product((item for item in standing if item.name == "rug"), standing):
        if abs(float(item.low[2] - rug.low[2])) > 0.1:
            continue
        if item.category == "fireplace" and _to_rug_m(rug, item) < RUG_TO_FIRE_M - SLACK_M:
            sentences.append(f"the rug {rug.label} lies {_to_rug_m(rug, item):.2f} m from {item.label}")
        is_heavy = item.category in _HEAVY and item.name != "nightstand"
        if is_heavy or item.name in _HALL_PIECES:
            share = _share_on_rug(rug, item)
            if ON_RUG_SHARES[0] < share < ON_RUG_SHARES[1]:
                sentences.append(f"{item.label} stands only partly on the rug {rug.label}")
    return sentences


def _is_round(rug: Standing) -> bool:
    """Returns whether a rug is round: its sides have the same length."""
    size = (rug.high - rug.low)[:2]
    return bool(abs(size[0] - size[1]) < 0.02)


def _to_rug_m(rug: Standing, item: Standing) -> float:
    """Returns the distance between a rug and an item, 0 where they overlap."""
    if not _is_round(rug):
        return rug.gap_m(item)
    nearest = np.clip(rug.middle, item.low[:2], item.high[:2])
    return max(0.0, math.dist(nearest, rug.middle) - 0.5 * float(rug.high[0] - rug.low[0]))


def _share_on_rug(rug: Standing, item: Standing) -> float:
    """Returns the share of an item's base that lies on a rug, from a grid of 20 x 20 points."""
    if (rug.overlap_m(item)[:2] <= 0.0).any():
        return 0.0
    steps = (np.arange(20) + 0.5) / 20
    x, y = (item.low[axis] + steps * (item.high[axis] - item.low[axis]) for axis in (0, 1))
    away = np.abs(np.stack(np.meshgrid(x, y), axis=-1) - rug.middle) / (0.5 * (rug.high - rug.low)[:2])
    on = np.hypot(away[..., 0], away[..., 1]) <= 1.0 if _is_round(rug) else (away <= 1.0).all(axis=-1)
    return float(on.mean())


def _free_m(room: Room, item: Standing, heading: NDArray[np.float64], others: Sequence[Standing]) -> float:
    """Returns the depth of the free floor from one side of an item to the next wall or piece of furniture.

    A piece counts if it stands before more than 30 % of the item's width.

    Args:
        room: the room of the item.
        item: the item.
        heading: unit vector (2,) along x or y out of this side.
        others: the pieces that may be in the way.
    """
    across = int(np.argmin(np.abs(heading)))
    side_m = _side_m(item, heading)
    width_m = float((item.high - item.low)[across])
    ends_m = [
        float(np.asarray(centre)[:2] @ heading + np.asarray(half)[:2] @ np.abs(heading))
        for centre, half in room.boxes
        if (np.abs(item.middle - np.asarray(centre)[:2]) <= np.asarray(half)[:2]).all()
    ]
    ends_m += [
        -_side_m(other, -heading)
        for other in others
        if blocks_floor(other, room.floor_z_m) and other.overlap_m(item)[across] > 0.3 * width_m
    ]
    return min((end_m - side_m for end_m in ends_m if end_m > side_m - 0.1), default=math.inf)


def _side_m(item: Standing, heading: NDArray[np.float64]) -> float:
    """Returns the coordinate of an item's outermost point along a heading (2,)."""
    return float(item.middle @ heading + 0.5 * (item.high - item.low)[:2] @ np.abs(heading))


def _heading(direction: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Returns the axis (2,) along which a direction points within 18 degrees, None if there is no such axis."""
    axis = np.round(direction)
    return axis if np.abs(direction).max() > math.cos(math.radians(18.0)) else None


def _width_m(item: Standing) -> float:
    """Returns the extent of an item across its heading."""
    return float((item.high - item.low)[:2] @ np.abs(np.array([-item.front[1], item.front[0]])))
