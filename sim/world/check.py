"""Checks whether a house can be used; each fault that is found is one sentence.

The check measures the compiled model, not the generator's own data: labels, overlaps of collision geoms, objects
without support, unstable objects, and whether the robot reaches every room and every goal category. For generated
houses it also tests the floor plan, and the furniture that each kind of room must have.
"""

from __future__ import annotations

import copy
import difflib
import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.core.geometry.grid import GridFrame
from sim.core.interface import GOAL_CATEGORIES, SuccessRule
from sim.core.vocabulary import vocabulary
from sim.core.wishes import ROOMS
from sim.gl import mujoco
from sim.houses.geoms import data_at_rest, world_boxes
from sim.houses.hazards import Hazard, read_hazards
from sim.houses.house import House, Room, read_rooms, sites_without_room
from sim.houses.instance_facts import InstanceFacts, read_instance_facts
from sim.houses.labels import Instance, Labels, collidable_geoms, cover_geoms, describe_geom, read_labels
from sim.world.advice import advice
from sim.world.arrangement import arrangement_faults
from sim.world.freespace import FreeSpace, connected_to
from sim.world.plan_requirements import unmet_plan_requirements
from sim.world.room_requirements import unmet_requirements
from sim.world.standing import Standing, read_standing

MAX_OVERLAP_M = 0.01
"""Largest overlap of two objects that is allowed."""
SUPPORT_GAP_M = 0.02
"""An object has no support when its bounding box is at least this far from every other one."""
SETTLE_S, SETTLE_STEP_S = 1.0, 0.004
"""Simulated time and time step of the check of movable objects."""
MAX_SETTLING_M, MAX_DRIFT_M_S = 0.002, 0.001
"""Largest displacement of a movable object in that time, and its largest speed at the end."""
REACH_MARGIN_M = 0.1
"""An instance must be this much nearer to the robot than the success distance, since its box exceeds its footprint."""
MIN_ROOM_CELLS, MIN_CONNECTED_SHARE = 200, 0.8
"""In a room with more free cells than this, the robot must reach at least this share of them."""
STRUCTURE = frozenset(("wall", "floor", "ceiling", "door", "window", "stairs", "railing"))
"""Parts of the building: they may overlap each other."""


def check_house(spec: mujoco.MjSpec, *, furnished: bool = False) -> list[str]:
    """Returns a sentence for each fault of a house; an empty list if the house has no fault.

    Args:
        spec: the house, without a robot; it is not changed.
        furnished: True: each room must also have the furniture of its kind (`sim.world.room_requirements`), which must
            stand as dwelling design wants it (`sim.world.arrangement`), and the floor plan must keep the rules of
            `sim.world.plan_requirements`, as in every generated house.
    """
    try:
        house = _compiled(spec, None)
    except (ValueError, HouseError) as error:
        return [f"it does not compile: {error}"]
    faults = _overlaps(house) + _without_support(house) + _unstable(house.model)
    if furnished:
        standing = _furniture(house)
        faults += unmet_requirements(standing, house.rooms)
        faults += unmet_plan_requirements(house.model, house.data, house.labels, house.rooms)
        faults += arrangement_faults(house.model, house.data, house.labels, house.rooms, standing)
    if not house.rooms:
        return [*faults, "it has no room sites"]
    return faults + _unreachable(house)


def advise_house(spec: mujoco.MjSpec) -> list[str]:
    """Returns what an architect would change in a furnished house, a sentence each (`sim.world.advice`).

    No house is rejected for it. The list is empty for a house that does not compile, or whose labels are not allowed.

    Args:
        spec: the house, without a robot; it is not changed.
    """
    try:
        house = _compiled(spec, None)
    except (ValueError, HouseError):
        return []
    return advice(house.rooms, _furniture(house))


def check_own_house(house: House) -> tuple[list[str], list[str]]:
    """Returns the faults of a user's house, and remarks; each is a sentence.

    Faults are places and goals that the robot cannot reach, and names, colours and materials in a wrong form. Overlaps,
    objects without support and objects that move by themselves are only remarks, because the house can be used. The
    house may have no room sites.

    Args:
        house: a house that `load_house` returned.
    """
    compiled = _compiled(house.spec, house.rules)
    remarks = _overlaps(compiled) + _without_support(compiled) + _unstable(compiled.model)
    remarks += _doubtful_rooms(compiled.model, compiled.rooms)
    faults = _unreachable(compiled)
    try:
        facts = read_instance_facts(compiled.model, compiled.labels)
    except HouseError as error:
        faults.append(str(error).rstrip("."))
    else:
        remarks += _doubtful_names(facts)
    return faults, remarks


def _doubtful_names(facts: Mapping[str, InstanceFacts]) -> Iterator[str]:
    """Yields a sentence for each everyday name that no goal in words can ask for."""
    known = vocabulary()
    for instance, fact in facts.items():
        if fact.name and fact.name not in known.categories:
            found = known.find(fact.name)
            similar = sorted(found.names) if found else difflib.get_close_matches(fact.name, known.categories, n=1)
            hint = f"; a known name is '{similar[0]}'" if similar else ""
            yield f"the name '{fact.name}' of '{instance}' is no everyday name that goals in words know{hint}"


def _doubtful_rooms(model: mujoco.MjModel, rooms: Sequence[Room]) -> Iterator[str]:
    """Yields a sentence for each site that looks like a room and is none, and for each kind that may be misspelt."""
    for name in sites_without_room(model):
        yield f"site '{name}' is no room: a room is a box site of the world body with a name such as room_bedroom_00"
    known = sorted(set(itertools.chain.from_iterable(ROOMS.values())))
    for room in rooms:
        if room.kind not in known and (similar := difflib.get_close_matches(room.kind, known, n=1, cutoff=0.8)):
            yield f"the kind of '{room.name}' may be misspelt: goals in words know '{similar[0]}'"


def _compiled(spec: mujoco.MjSpec, rules: Mapping[str, str] | None) -> _CompiledHouse:
    """Returns a compiled house in its initial state.

    Raises:
        ValueError: it does not compile.
        HouseError: its labels are not allowed.
    """
    model = spec.compile()
    labels = read_labels(model, rules=rules, ignore_prefix="")
    data = data_at_rest(model)
    return _CompiledHouse(model, data, labels, read_rooms(model))


@dataclass(frozen=True)
class _CompiledHouse:
    """A compiled house in its initial state, kinematics computed."""

    model: mujoco.MjModel
    data: mujoco.MjData
    labels: Labels
    rooms: tuple[Room, ...]

    def category(self, geom: int) -> str:
        return self._instance(geom).category

    def name(self, geom: int) -> str:
        return self._instance(geom).name

    def _instance(self, geom: int) -> Instance:
        """Returns the instance of a geom; a geom without a label, which label rules allow, is its own instance."""
        number = int(self.labels.geom_instance[geom])
        return (
            self.labels.instances[number] if number >= 0 else Instance(describe_geom(self.model, geom), "void", (geom,))
        )

    def boxes(self, geoms: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns the lowest and highest corners (n, 3) of the world-aligned boxes around geoms, metres."""
        return world_boxes(self.model, self.data, geoms)


def _furniture(house: _CompiledHouse) -> list[Standing]:
    """Returns the instances of a house that are not part of a hazard."""
    hazards = read_hazards(house.model)
    everything = read_standing(house.model, house.data, house.labels)
    return [item for item in everything if not any(is_part_of(item, hazard) for hazard in hazards)]


def _overlaps(house: _CompiledHouse) -> list[str]:
    """Finds objects with collision geoms that overlap by more than `MAX_OVERLAP_M`.

    Parts of the building may overlap each other, and so may an object and objects in bodies nested in it.
    """
    model, labels = house.model, house.labels
    solid = np.flatnonzero(collidable_geoms(model) & ~cover_geoms(model))
    low, high = house.boxes(solid)
    structure = np.array([house.category(geom) in STRUCTURE for geom in solid.tolist()])
    root = model.body_rootid[model.geom_bodyid[solid]]
    instance = labels.geom_instance[solid]
    largest: dict[tuple[str, str], float] = {}
    for i, j in _close_pairs(low, high, -MAX_OVERLAP_M):
        nested = root[i] == root[j] and root[i] != 0
        if nested or instance[i] == instance[j] or (structure[i] and structure[j]):
            continue
        a, b = int(solid[i]), int(solid[j])
        depth = -mujoco.mj_geomDistance(model, house.data, a, b, MAX_OVERLAP_M, None)
        if depth > MAX_OVERLAP_M:
            names = (house.name(a), house.name(b))
            largest[names] = max(largest.get(names, 0.0), depth)
    return [f"{a} and {b} overlap by {100 * depth:.1f} cm" for (a, b), depth in largest.items()]


def _without_support(house: _CompiledHouse) -> list[str]:
    """Finds objects that are near no other object, so that nothing supports them: no object below, above or around."""
    low, high = house.boxes(np.arange(house.model.ngeom))
    instance = house.labels.geom_instance
    supported = set()
    for i, j in _close_pairs(low, high, SUPPORT_GAP_M):
        if instance[i] != instance[j]:
            supported |= {int(instance[i]), int(instance[j])}
    return [
        f"{instance.name} has no support"
        for number, instance in enumerate(house.labels.instances)
        if number not in supported and instance.category not in STRUCTURE
    ]


def _unstable(model: mujoco.MjModel) -> list[str]:
    """Finds movable objects that have moved after `SETTLE_S`, or still move then."""
    joints = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE)
    if not joints.size:
        return []
    model = copy.copy(model)
    model.opt.timestep, model.opt.cone = SETTLE_STEP_S, mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_MULTICCD)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=round(SETTLE_S / SETTLE_STEP_S))
    faults = []
    for joint in joints.tolist():
        q, v = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
        moved_m = float(np.linalg.norm(data.qpos[q : q + 3] - model.qpos0[q : q + 3]))
        speed_m_s = float(np.linalg.norm(data.qvel[v : v + 3]))
        if not (moved_m <= MAX_SETTLING_M and speed_m_s <= MAX_DRIFT_M_S):  # "not", so that a NaN is a fault too
            name = model.body(model.jnt_bodyid[joint]).name
            faults.append(f"{name} is not stable: after {SETTLE_S:.0f} s it has moved {1000 * moved_m:.1f} mm")
    return faults


def is_part_of(item: Standing, hazard: Hazard) -> bool:
    """Returns whether an item belongs to a hazard, which stands where no furniture would: inside its box in plan."""
    inside = (item.low[:2] > np.array(hazard.low_m[:2]) - 0.02) & (item.high[:2] < np.array(hazard.high_m[:2]) + 0.02)
    return bool(inside.all())


def _unreachable(house: _CompiledHouse) -> list[str]:
    """Finds rooms and goal categories that the default robot cannot reach from the room with the most free space.

    Each storey counts for itself: the robot starts on it and cannot leave it.
    """
    faults: list[str] = []
    near: set[str] = set()
    if not house.rooms:
        faults, near = _unreachable_without_rooms(house)
    for floor_z_m in sorted({room.floor_z_m for room in house.rooms}):
        of_storey, reached = _unreachable_on(house, floor_z_m)
        faults += of_storey
        near |= reached
    goals = [category for category in GOAL_CATEGORIES if house.labels.of_category(category)]
    return faults + [f"the robot cannot come near any {category}" for category in goals if category not in near]


def _unreachable_without_rooms(house: _CompiledHouse) -> tuple[list[str], set[str]]:
    """Returns the faults of a house without room sites, and the goal categories that the robot can approach."""
    space = FreeSpace(house.model, house.data, house.labels)
    reached = space.largest_part()
    if not reached.any():
        return ["it has no free position for the robot on the ground storey"], set()
    return [], _goals_near(house, reached, space.frame, (-math.inf, math.inf))


def _unreachable_on(house: _CompiledHouse, floor_z_m: float) -> tuple[list[str], set[str]]:
    """Returns the faults of the rooms of one storey, and the goal categories that the robot comes near on it."""
    space = FreeSpace(house.model, house.data, house.labels, rooms=house.rooms, floor_z_m=floor_z_m)
    x, y = space.frame.axes()
    rooms = [room for room in house.rooms if room.floor_z_m == floor_z_m]
    masks = {room.name: space.free & _room_mask(room, x, y) for room in rooms}
    largest = max(masks.values(), key=np.count_nonzero)
    if not largest.any():
        return ["no room has a free position for the robot"], set()
    cells = np.argwhere(largest)
    source = np.zeros_like(space.free)
    source[tuple(cells[len(cells) // 2])] = True
    reached = connected_to(space.free, source)
    cells_of = {name: (np.count_nonzero(mask), np.count_nonzero(mask & reached)) for name, mask in masks.items()}
    faults = [f"the robot cannot enter {name}" for name, (_, entered) in cells_of.items() if not entered]
    faults += [
        f"the robot cannot reach a part of {name}"
        for name, (free, entered) in cells_of.items()
        if free > MIN_ROOM_CELLS and entered < MIN_CONNECTED_SHARE * free
    ]
    top_m = max(z + half for room in rooms for (_, _, z), (_, _, half) in room.boxes)
    return faults, _goals_near(house, reached, space.frame, (floor_z_m, top_m))


def _goals_near(
    house: _CompiledHouse, reached: NDArray[np.bool_], frame: GridFrame, heights_m: tuple[float, float]
) -> set[str]:
    """Returns the goal categories with an instance between two heights near one of the cells reached (rows, cols)."""

    def is_near(geoms: Iterable[int]) -> bool:
        low, high = house.boxes(np.array(list(geoms)))
        middle_m = 0.5 * (low[:, 2].min() + high[:, 2].max())  # the boxes of tilted parts may reach below the floor
        if not heights_m[0] <= middle_m < heights_m[1]:
            return False
        (x0, y0, _), (x1, y1, _) = low.min(axis=0).tolist(), high.max(axis=0).tolist()
        return _any_within(reached, frame, (x0, y0, x1, y1), SuccessRule.distance_m - REACH_MARGIN_M)

    return {
        category
        for category in GOAL_CATEGORIES
        if any(is_near(instance.geom_ids) for instance in house.labels.of_category(category))
    }


def _any_within(
    cells: NDArray[np.bool_], frame: GridFrame, box_m: tuple[float, float, float, float], distance_m: float
) -> bool:
    """Returns whether a cell (rows, cols) is nearer than a distance to a box (smallest x, y, largest x, y)."""
    window = frame.index_of(box_m, distance_m)
    x, y = frame.axes(window)
    dx = np.maximum(np.maximum(box_m[0] - x, x - box_m[2]), 0.0)
    dy = np.maximum(np.maximum(box_m[1] - y, y - box_m[3]), 0.0)
    return bool((cells[window] & (np.hypot(dx[None, :], dy[:, None]) < distance_m)).any())


def _close_pairs(low: NDArray[np.float64], high: NDArray[np.float64], gap_m: float) -> Iterable[tuple[int, int]]:
    """Returns the pairs i < j of boxes nearer than `gap_m` in every axis (negative: overlapping by more than that).

    The boxes are sorted by their lower x, so that each is compared only with those that begin before it ends.
    """
    order = np.argsort(low[:, 0], kind="stable")
    begin, end = low[order], high[order]
    ends = np.searchsorted(begin[:, 0], end[:, 0] + gap_m)
    count = np.maximum(ends - np.arange(len(order)) - 1, 0)
    first = np.repeat(np.arange(len(order)), count)
    second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count)
    for axis in (1, 2):
        apart = np.maximum(begin[first, axis] - end[second, axis], begin[second, axis] - end[first, axis])
        first, second = first[apart < gap_m], second[apart < gap_m]
    # A box that is smaller than a negative gap overlaps nothing by more than that, not even itself.
    apart = np.maximum(begin[first, 0] - end[second, 0], begin[second, 0] - end[first, 0])
    pairs = np.sort(np.stack([order[first], order[second]])[:, apart < gap_m], axis=0)
    pairs = pairs[:, np.lexsort((pairs[1], pairs[0]))]
    return zip(*pairs.tolist(), strict=True)


def _room_mask(room: Room, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.bool_]:
    mask = np.zeros((len(y), len(x)), dtype=np.bool_)
    for (cx, cy, _), (hx, hy, _) in room.boxes:
        mask |= np.outer(np.abs(y - cy) <= hy, np.abs(x - cx) <= hx)
    return mask
