"""Plans of compiled houses. This module and `sim.homes.plans.surfaces` import MuJoCo."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.grid import GridFrame
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID
from sim.gl import mujoco
from sim.homes.plans.gap_kernels import lower_to_gap
from sim.homes.plans.plan import CELL_M, Plan, storey_name
from sim.homes.plans.surfaces import TOP_M, occupied_spans
from sim.houses.geoms import data_at_rest, geom_polytope
from sim.houses.house import House
from sim.houses.labels import Labels
from sim.task.ground_truth import GroundTruth
from sim.world.freespace import FreeSpace, covered
from sim.world.obstacles import obstacle_polygons
from sim.world.plan import floor_polygons
from sim.world.storeys import floor_levels, storey_floors
from sim.world.world import World

_FAR_M = 0.6
"""Distances to obstacles are computed up to this."""
_PADDING_M = 1000.0
"""Added to distances, so that 0 means a cell beyond the grid."""
_MIN_CEILING_M = 1.5
"""A lower ceiling does not belong to the storey."""


def export_plans(house: House, source: Mapping[str, object]) -> Iterator[Plan]:
    """Yields the plan of each storey of a house, the lowest first; a storey without free space has none.

    Args:
        house: the house; its movable objects are where its file puts them.
        source: kept in the plans; JSON types.

    Raises:
        HouseError: the house cannot be compiled.
    """
    world = World(house)
    truth = GroundTruth(world)
    at_rest = data_at_rest(world.model)
    levels_m = sorted({round(level, 3) for level in floor_levels(world.model, world.labels)})
    for number, floor_z_m in enumerate(storey_floors(levels_m, world.rule.same_storey_m)):
        if truth.space(floor_z_m).free.any():
            yield _storey(storey_name(house.name, number), world, truth, at_rest, floor_z_m, source)


def _storey(
    name: str, world: World, truth: GroundTruth, at_rest: mujoco.MjData, floor_z_m: float, source: Mapping[str, object]
) -> Plan:
    """Returns the plan of one storey."""
    space = truth.space(floor_z_m)
    frame = _coarse(space.frame)
    start, low_m, high_m, instance = occupied_spans(world.model, at_rest, world.labels, frame, floor_z_m)
    labels = world.labels
    categories = [MPCAT40_ID[instance.category] for instance in labels.instances]
    return Plan(
        name=name,
        frame=frame,
        floor_z_m=floor_z_m,
        ceiling_m=_ceiling_m(world.model, at_rest, labels, floor_z_m),
        radius_m=world.robot.radius_m,
        slack_m=_slack_m(world, at_rest, space, frame, floor_z_m),
        floor=_floor(world.model, at_rest, labels, floor_z_m, frame),
        room=_rooms(world, floor_z_m, frame),
        rooms=tuple(room.name for room in world.rooms),
        succeeds=_success_bits(truth, floor_z_m, frame),
        span_start=start,
        span_low_m=low_m,
        span_high_m=high_m,
        span_instance=instance,
        instances=(*(instance.name for instance in labels.instances), "void"),
        categories=np.array([*categories, MPCAT40_ID["void"]], np.uint8),
        source=source,
    )


def _coarse(fine: GridFrame) -> GridFrame:
    """Returns the grid of a plan that covers a finer grid and has the same corner."""
    rows, cols = (math.ceil(size * fine.cell_m / CELL_M - 1e-9) for size in fine.shape)
    return GridFrame(origin_xy_m=fine.origin_xy_m, shape=(rows, cols), cell_m=CELL_M)


def _blocks(fine: NDArray, frame: GridFrame, ratio: int) -> NDArray:
    """Returns (rows, cols, ratio * ratio) the fine cells of each cell; 0 beyond the fine grid."""
    rows, cols = frame.shape
    padded = np.zeros((rows * ratio, cols * ratio), fine.dtype)
    padded[: fine.shape[0], : fine.shape[1]] = fine
    return padded.reshape(rows, ratio, cols, ratio).transpose(0, 2, 1, 3).reshape(rows, cols, ratio * ratio)


def _slack_m(
    world: World, at_rest: mujoco.MjData, space: FreeSpace, frame: GridFrame, floor_z_m: float
) -> NDArray[np.float32]:
    """Returns the distance of cell centres to the border of the free space, positive inside.

    At obstacles it is exact; at edges of the floor and at ground that cannot be reached it comes from the cells.
    """
    gap_m = np.full(frame.shape, _FAR_M)
    for polygon in obstacle_polygons(world.model, at_rest, world.labels, world.robot, floor_z_m):
        window = frame.index_of(polygon.bounds_m, _FAR_M)
        x_m, y_m = frame.axes(window)
        lower_to_gap(gap_m[window], x_m, y_m, polygon.vertices_m, polygon.normals, polygon.offsets_m)
    ratio, fine_m = round(CELL_M / space.frame.cell_m), space.frame.cell_m
    free = np.pad(space.free, 1).astype(np.uint8)
    inside, outside = (cv2.distanceTransform(mask, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) for mask in (free, 1 - free))
    by_cells_m = ((inside - outside) * fine_m)[1:-1, 1:-1].astype(np.float32)
    blocks = _blocks(by_cells_m + np.float32(_PADDING_M), frame, ratio)
    by_cells_m = np.where(blocks.min(axis=2) > 0.0, blocks.mean(axis=2) - np.float32(_PADDING_M), np.float32(-_FAR_M))
    return np.minimum(gap_m - space.radius_m, by_cells_m).astype(np.float32)


def _success_bits(truth: GroundTruth, floor_z_m: float, frame: GridFrame) -> NDArray[np.uint32]:
    """Returns the goals for which a STOP succeeds in most of each cell."""
    space = truth.space(floor_z_m)
    ratio = round(CELL_M / space.frame.cell_m)
    bits = np.zeros(frame.shape, np.uint32)
    for goal in truth.goals():
        mask = truth.region(goal, floor_z_m).mask(space)
        most = _blocks(mask.astype(np.uint8), frame, ratio).sum(axis=2) * 2 > ratio * ratio
        bits |= most.astype(np.uint32) << np.uint32(GOAL_CATEGORIES.index(goal))
    return bits


def _floor(
    model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, floor_z_m: float, frame: GridFrame
) -> NDArray[np.bool_]:
    """Returns the cells with their centre on a floor of the storey."""
    outlines = floor_polygons(model, data, labels, floor_z_m)
    return np.ones(frame.shape, np.bool_) if outlines is None else covered(frame, outlines)


def _rooms(world: World, floor_z_m: float, frame: GridFrame) -> NDArray[np.int16]:
    """Returns the room of each cell; -1: none."""
    room_of = np.full(frame.shape, -1, np.int16)
    for number, room in enumerate(world.rooms):
        if abs(room.floor_z_m - floor_z_m) >= world.rule.same_storey_m:
            continue
        for (x, y, _), (hx, hy, _) in room.boxes:
            x_m, y_m = frame.mesh()
            room_of[(np.abs(x_m - x) <= hx) & (np.abs(y_m - y) <= hy)] = number
    return room_of


def _ceiling_m(model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, floor_z_m: float) -> float:
    """Returns the height of the lowest ceiling above a floor; `TOP_M` without a ceiling."""
    heights = [
        float(geom_polytope(model, data, geom, rendered=True).vertices_m[:, 2].min()) - floor_z_m
        for geom in np.flatnonzero(labels.geom_category == MPCAT40_ID["ceiling"]).tolist()
    ]
    return min([height for height in heights if height > _MIN_CEILING_M], default=TOP_M)
