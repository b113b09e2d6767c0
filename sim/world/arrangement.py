"""How the furniture of a generated house must stand: rules of dwelling design, and the check of them.

Sources: NKBA Kitchen Planning Guidelines (work triangle, aisles, worktop next to appliances, 30 in in front of a
toilet as recommended; here 0.6 m, the 24 in that the IRC asks for at least within 3 in); Neufert, Architects' Data
(0.6 m next to a bed, seats that face each other or a focus, wardrobes away from windows). Everything is measured on the
compiled model: instances with their everyday names, their boxes, and the heading of their bodies.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.houses.house import Room
from sim.houses.labels import Labels
from sim.world.leaves import Leaf, hinged_leaves
from sim.world.room_arrangement import near_tables, room_clauses
from sim.world.standing import Standing, blocks_floor, is_in

MIN_TRIANGLE_M, MAX_TRIANGLE_M = 4.0, 7.9
"""Sum of the legs of the work triangle: 13 to 26 ft (NKBA guideline 3)."""
MIN_LINE_M = 2.4
"""The same sum in a single run: both legs of 4 ft, there and back."""
AISLE_M = 1.0
"""Width of the aisle between an island and a run (NKBA: 42 in, 1.07 m, for one cook)."""
TOUCH_M = 0.08
"""Units of a run have at most this gap."""
BESIDE_BED_M, TOILET_FRONT_M = 0.6, 0.6
DOUBLE_BED_M = 1.45
"""A bed at least this wide is for two, who get up on either side."""
MAX_TO_CHAIR_M, MAX_TO_NIGHTSTAND_M = 0.45, 0.4
MIN_CHAIRS = 2
FACING_M = (0.8, 6.0)
"""Distances at which a sofa faces something."""
TALL_M = 1.3
"""Higher pieces hide a window."""
BEFORE_WINDOW_M = 0.4
"""An item nearer to a window than this stands in front of it."""
FIXTURE_APART_M = 0.06
"""Gap between a toilet or a basin and a door leaf at any angle, also where it stands wide open."""
WALL_M = 0.3
"""Rooms with a smaller gap lie side by side."""
SLACK_M = 0.03
_RUN = frozenset(("kitchen counter", "counter", "cooker", "fridge", "dishwasher", "washing machine"))
_ISLANDS = frozenset(("kitchen island", "breakfast bar", "kitchen trolley"))
_FOCUS = frozenset(("television", "fireplace", "wood stove", "tiled stove", "armchair", "rocking chair"))
_SOFAS = frozenset(("sofa", "corner sofa", "daybed"))
_NEVER_AT_WINDOWS = frozenset(("fireplace", "wood stove", "tiled stove", "television"))
_TALL = frozenset(("cabinet", "shelving", "appliances", "furniture"))
_HARD_FLOORS = frozenset(("kitchen", "bathroom", "laundry", "hallway", "stair_hall", "studio"))
"""Rooms without carpet on the whole floor."""


def arrangement_faults(
    model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, rooms: Sequence[Room], standing: Sequence[Standing]
) -> list[str]:
    """Returns a sentence for each rule that the furniture of a compiled house does not follow.

    Args:
        model: the compiled house.
        data: its state; kinematics must be computed.
        labels: the labels of its geoms.
        rooms: its rooms.
        standing: its instances (`sim.world.standing`).
    """
    windows = [item for item in standing if item.category == "window"]
    faults = [f"{item.label} stands in front of {window.label}" for item, window in _before_windows(standing, windows)]
    faults += _blocked_swings(model, data, labels, standing) + near_tables(standing)
    floors = {room.name: _floor_look(model, data, labels, room) for room in rooms}
    for room in rooms:
        inside = [item for item in standing if is_in(room, item)]
        clauses = _seats_at_tables(inside)
        if room.kind in ("kitchen", "studio"):
            clauses += _kitchen(inside)
        if room.kind in ("living_room", "studio"):
            clauses += _sofas(inside, [*inside, *windows])
        if room.kind == "bedroom":
            clauses += _beds(room, inside)
        clauses += _toilets(room, inside)
        clauses += room_clauses(room, inside)
        if room.kind in _HARD_FLOORS and any(name.startswith("carpet") for name in floors[room.name][0]):
            clauses.append("has carpet on its whole floor")
        if room.kind == "kitchen":
            clauses += [
                f"has the floor of {other.name}"
                for other in rooms
                if other.kind == "living_room" and _is_beside(room, other) and floors[room.name] == floors[other.name]
                if floors[room.name][0]
            ]
        faults += [f"{room.name} {clause}" for clause in clauses]
    return faults


def _before_windows(items: Iterable[Standing], windows: Sequence[Standing]) -> Iterable[tuple[Standing, Standing]]:
    """Yields fireplaces, screens and tall pieces that stand in front of a window, each with the window."""
    for item in items:
        always = item.name in _NEVER_AT_WINDOWS
        if not always and not (item.category in _TALL and item.high[2] - item.low[2] > TALL_M):
            continue
        for window in windows:
            across = int(np.argmin((window.high - window.low)[:2]))
            overlap = item.overlap_m(window)
            low_fire = always and item.name != "television"
            seen_m = overlap[2] if not low_fire else window.high[2] - item.low[2]
            if overlap[1 - across] > 0.1 and overlap[across] > -BEFORE_WINDOW_M and 0.1 < seen_m < 3.0:
                yield item, window
                break


def _seats_at_tables(inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on dining tables without enough chairs and desks without a chair."""
    chairs = [item for item in inside if item.category == "chair"]
    clauses = []
    for item in inside:
        near = sum(item.gap_m(chair) <= MAX_TO_CHAIR_M for chair in chairs)
        if item.name == "dining table":
            laid = sum(o.name == "place setting" and item.gap_m(o) == 0.0 for o in inside)
            if near < max(MIN_CHAIRS, laid):
                clauses.append(f"has {item.label}, a dining table with {near} of {max(MIN_CHAIRS, laid)} chairs")
        elif item.name == "desk" and near == 0:
            clauses.append(f"has {item.label}, a desk without a chair")
    return clauses


def _kitchen(inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on the units of a kitchen."""
    units = [item for item in inside if item.name in _RUN]
    counters = [unit for unit in units if unit.category == "counter"]
    clauses = []
    hobs = [item for item in inside if item.name in ("hob", "cooker")]
    for kind, item in _work_units(inside).items():
        if min(item.gap_m(counter) for counter in counters) > TOUCH_M and not (
            kind == "fridge" and _joined(item, units)
        ):
            clauses.append(f"has no worktop next to the {kind}")
    fronts = list(work_centres(inside).values())
    if len(fronts) == 3:
        legs_m = list(itertools.starmap(math.dist, itertools.combinations(fronts, 2)))
        triangle_m = sum(legs_m)
        least_m = MIN_LINE_M if triangle_m - 2 * max(legs_m) < 0.1 else MIN_TRIANGLE_M
        if not least_m - SLACK_M <= triangle_m <= MAX_TRIANGLE_M + SLACK_M:
            clauses.append(
                f"has a work triangle of {triangle_m:.1f} m, which must be {least_m:.1f} to {MAX_TRIANGLE_M:.1f} m"
            )
    for island in (item for item in inside if item.name in _ISLANDS):
        aisle_m = min((island.gap_m(unit) for unit in units), default=AISLE_M)
        if aisle_m < AISLE_M - SLACK_M:
            clauses.append(f"has an aisle of {aisle_m:.2f} m at {island.label}, which must be {AISLE_M:.1f} m")
    for cabinet in (item for item in inside if item.name == "wall cabinet"):
        if any((cabinet.overlap_m(hob)[:2] > 0.1).all() for hob in hobs):
            clauses.append(f"has {cabinet.label} above its hob")
    return clauses


def _work_units(inside: Sequence[Standing]) -> dict[str, Standing]:
    """Returns the fridge, the sink and the cooker or hob of a kitchen with worktops; a missing one is left out."""
    if not any(item.name in _RUN and item.category == "counter" for item in inside):
        return {}  # a requirement of its own
    kinds = {
        "fridge": [item for item in inside if item.name == "fridge"],
        "sink": [item for item in inside if item.category == "sink"],
        "cooker or hob": [item for item in inside if item.name in ("hob", "cooker")],
    }
    return {kind: units[0] for kind, units in kinds.items() if units}


def work_centres(inside: Sequence[Standing]) -> dict[str, NDArray[np.float64]]:
    """Returns the middles (2,) of the fronts of the fridge, the sink and the cooker or hob, metres.

    The front of a sink or a hob is that of the worktop that holds it.
    """
    counters = [item for item in inside if item.name in _RUN and item.category == "counter"]
    centres = {}
    for kind, item in _work_units(inside).items():
        holder = next((c for c in counters if kind != "fridge" and c.gap_m(item) == 0.0), item)
        depth_m = 0.5 * float(np.abs(holder.high - holder.low)[:2] @ np.abs(holder.front))
        centres[kind] = item.middle + holder.front * (depth_m - float((item.middle - holder.middle) @ holder.front))
    return centres


def _joined(fridge: Standing, units: Sequence[Standing]) -> bool:
    """Returns whether a fridge is joined to a worktop by a dishwasher or a washing machine between them."""
    low = [unit for unit in units if unit.name in ("dishwasher", "washing machine")]
    between = [unit for unit in low if fridge.gap_m(unit) <= TOUCH_M]
    return any(a.gap_m(b) <= TOUCH_M for a in between for b in units if b.category == "counter")


def _sofas(inside: Sequence[Standing], targets: Sequence[Standing]) -> list[str]:
    """Returns clauses on the seats of a living room: a sofa or two armchairs, and a focus in front of the sofa."""
    sofas = [item for item in inside if item.name in _SOFAS]
    if not sofas:
        chairs = sum(item.name in ("armchair", "rocking chair", "chair") for item in inside)
        return [] if chairs >= 2 else ["has no sofa and no two armchairs"]
    if any(_faces(sofa, target) for sofa in sofas for target in targets):
        return []
    return [f"has {sofas[0].label}, which faces neither a screen nor a fireplace, a seat or a window"]


def _faces(sofa: Standing, target: Standing) -> bool:
    if target.name not in _FOCUS and target.category != "window":
        return False
    away = target.middle - sofa.middle
    ahead_m = float(away @ sofa.front)
    aside_m = float(abs(away @ np.array([-sofa.front[1], sofa.front[0]])))
    return FACING_M[0] <= ahead_m <= FACING_M[1] and aside_m <= 0.5 + 0.35 * ahead_m


def _beds(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on beds without free floor along their long sides, and on nightstands apart from them."""
    seats = [item for item in inside if item.category in ("bed", "sofa", "chair")]
    clauses = [
        f"has {item.label}, a nightstand that is next to no bed and no seat"
        for item in inside
        if item.name == "nightstand" and min((item.gap_m(seat) for seat in seats), default=0.0) > MAX_TO_NIGHTSTAND_M
    ]
    for bed in (item for item in inside if item.category == "bed"):
        left = np.array([-bed.front[1], bed.front[0]])
        size = (bed.high - bed.low)[:2]
        length_m, width_m = float(size @ np.abs(bed.front)), float(size @ np.abs(left))
        middle_m = 0.5 * (0.6 - 0.05)  # from the end of a nightstand to the foot
        free = sum(
            _is_free(
                room,
                inside,
                bed.middle + bed.front * middle_m + left * sign * 0.5 * (width_m + BESIDE_BED_M),
                np.abs(bed.front) * 0.5 * (length_m - 0.65) + np.abs(left) * 0.5 * (BESIDE_BED_M - SLACK_M),
                bed,
            )
            for sign in (1.0, -1.0)
        )
        if free < (2 if width_m >= DOUBLE_BED_M else 1):
            both = "both long sides" if width_m >= DOUBLE_BED_M else "a long side"
            clauses.append(f"has {bed.label} without {BESIDE_BED_M:.1f} m of free floor along {both}")
    return clauses


def _toilets(room: Room, inside: Sequence[Standing]) -> list[str]:
    """Returns clauses on toilets without free floor in front of them."""
    clauses = []
    for toilet in (item for item in inside if item.category == "toilet"):
        left = np.abs(np.array([-toilet.front[1], toilet.front[0]]))
        depth_m = float((toilet.high - toilet.low)[:2] @ np.abs(toilet.front))
        middle = toilet.middle + toilet.front * 0.5 * (depth_m + TOILET_FRONT_M)
        half = np.abs(toilet.front) * 0.5 * (TOILET_FRONT_M - SLACK_M) + left * 0.18
        if not _is_free(room, inside, middle, half, toilet):
            clauses.append(f"has less than {TOILET_FRONT_M:.1f} m of free floor in front of {toilet.label}")
    return clauses


def _is_free(
    room: Room, inside: Sequence[Standing], middle: NDArray[np.float64], half: NDArray[np.float64], owner: Standing
) -> bool:
    """Returns whether a rectangle of floor lies in the room and no furniture stands on it."""
    low, high = middle - half, middle + half
    corners = itertools.product((low[0] + SLACK_M, high[0] - SLACK_M), (low[1] + SLACK_M, high[1] - SLACK_M))
    if not all(room.contains(float(x), float(y)) for x, y in corners):
        return False
    return not any(
        item is not owner
        and blocks_floor(item, room.floor_z_m)
        and (np.minimum(item.high[:2], high) - np.maximum(item.low[:2], low) > SLACK_M).all()
        for item in inside
    )


def _blocked_swings(
    model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, standing: Sequence[Standing]
) -> list[str]:
    """Returns a sentence for each piece of furniture in the quarter circle of a door leaf, or fixture at its end."""
    faults = []
    for leaf in hinged_leaves(model, data, labels):
        body = int(model.jnt_bodyid[leaf.joint])
        widest_deg = math.degrees(leaf.widest_rad - leaf.closed_rad)
        swing = _swept(model, data, leaf, np.arange(4.0, 90.0, 8.0))
        ends = _swept(model, data, leaf, np.array([90.0, max(90.0, widest_deg)]))
        floor_z_m = float(data.xpos[body, 2])
        for item in standing:
            if not blocks_floor(item, floor_z_m, 1.9) or item.high[2] < floor_z_m:
                continue
            apart_m = FIXTURE_APART_M if _is_fixture(item) else -0.02
            points = np.vstack((swing, ends)) if _is_fixture(item) else swing
            if ((points > item.low[:2] - apart_m) & (points < item.high[:2] + apart_m)).all(axis=-1).any():
                faults.append(f"{item.label} stands where {model.body(body).name} swings")
    return faults


def _swept(model: mujoco.MjModel, data: mujoco.MjData, leaf: Leaf, degrees: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns points (n, 2) along a leaf at some angles from where it closes the doorway, metres."""
    x, y = data.xmat[model.jnt_bodyid[leaf.joint]].reshape(3, 3)[:2, 0]
    turns = float(data.xaxis[leaf.joint, 2])
    closed_rad = math.atan2(y, x) + turns * (leaf.closed_rad - float(data.qpos[leaf.qpos]))
    radius, angle = np.meshgrid(np.linspace(0.15, leaf.width_m, 8), closed_rad + turns * np.radians(degrees))
    along = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return (data.xanchor[leaf.joint, :2] + radius[..., None] * along).reshape(-1, 2)


def _is_fixture(item: Standing) -> bool:
    return item.category in ("toilet", "sink") or item.name == "vanity cabinet"


def _floor_look(
    model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, room: Room
) -> tuple[tuple[str, ...], tuple[float, ...]]:
    """Returns the names of the textures and the colour of the floor geom below the middle of a room."""
    centre, _ = room.boxes[0]
    ray = np.array([centre[0], centre[1], room.floor_z_m + 0.3])
    for geom in (g for item in labels.instances if item.category == "floor" for g in item.geom_ids):
        material = int(model.geom_matid[geom])
        if material < 0 or model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_BOX.value:
            continue
        reach = np.abs(data.geom_xmat[geom].reshape(3, 3)) @ model.geom_size[geom]
        offset = np.abs(ray - data.geom_xpos[geom])
        if (offset[:2] > reach[:2]).any() or offset[2] > 0.3 + 2 * reach[2] + 0.05:
            continue
        textures = tuple(model.tex(int(t)).name for t in np.ravel(model.mat_texid[material]) if t >= 0)
        return textures, tuple(model.mat_rgba[material].tolist())
    return (), ()


def _is_beside(a: Room, b: Room) -> bool:
    """Returns whether two rooms of a storey share a wall of 0.8 m, or no wall is between them."""
    if a.floor_z_m != b.floor_z_m:
        return False
    overlaps = [
        np.minimum(np.add(c, h), np.add(d, k))[:2] - np.maximum(np.subtract(c, h), np.subtract(d, k))[:2]
        for (c, h), (d, k) in itertools.product(a.boxes, b.boxes)
    ]
    return any(overlap.min() > -WALL_M and overlap.max() > 0.8 for overlap in overlaps)
