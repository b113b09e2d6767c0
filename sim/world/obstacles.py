"""Finds the obstacles of the robot in plan: objects higher than it climbs, and edges between floors."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.convex import ConvexPolygon, polygon_from_above
from sim.core.geometry.convex_kernels import mark_inside
from sim.core.geometry.grid import GridFrame, runs_of
from sim.core.interface import MPCAT40_ID, RobotModel
from sim.gl import mujoco
from sim.houses.geoms import UNBOUNDED_M, geom_polytope
from sim.houses.labels import ROBOT_PREFIX, Labels, collidable_geoms, geoms_of
from sim.world.plan import polygons_between

LEVEL_FLOOR_M = 0.03
"""Floors at most this far above or below the storey's are part of it, except for edges that are too high to climb."""
TOLERANCE_M = 0.0005
"""Geoms that are higher than `RobotModel.climb_m` by less than this do not count as obstacles."""
EDGE_CELL_M = 0.025
"""Edges between floors are found on cells of this size."""


def obstacle_polygons(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    labels: Labels,
    robot: RobotModel,
    floor_z_m: float,
) -> list[ConvexPolygon]:
    """Returns the plan projections of the obstacles on a storey, without the robot.

    Args:
        model: a compiled house or world.
        data: its state; kinematics must be computed.
        labels: of `model`.
        robot: its height and the height that it climbs count.
        floor_z_m: height of the storey's floor.
    """
    candidates = collidable_geoms(model) & ~geoms_of(model, ROBOT_PREFIX)
    is_floor = labels.geom_category == MPCAT40_ID["floor"]
    objects, floors = (np.flatnonzero(candidates & kind) for kind in (~is_floor, is_floor))
    climb_m = robot.climb_m + TOLERANCE_M
    low_m, top_m = floor_z_m + climb_m, floor_z_m + robot.height_m
    return [
        *polygons_between(model, data, objects, (low_m, top_m)),
        *polygons_between(model, data, floors, (floor_z_m + LEVEL_FLOOR_M, top_m)),
        *_edges(_low_floors(model, data, floors, floor_z_m, climb_m), climb_m),
    ]


def _low_floors(
    model: mujoco.MjModel, data: mujoco.MjData, floors: NDArray[np.intp], floor_z_m: float, climb_m: float
) -> list[tuple[float, ConvexPolygon]]:
    """Returns top and plan of the floors that are not obstacles as a whole, the lowest first."""
    bodies = [geom_polytope(model, data, int(geom)) for geom in floors]
    near = [(float(body.vertices_m[:, 2].max()), body) for body in bodies]
    near = sorted((floor for floor in near if abs(floor[0] - floor_z_m) <= LEVEL_FLOOR_M), key=lambda floor: floor[0])
    if not near or near[-1][0] - near[0][0] <= climb_m:  # no edge between them is too high
        return []
    plans = [(top_m, polygon_from_above(body)) for top_m, body in near]
    return [(top_m, plan) for top_m, plan in plans if plan is not None]


def _edges(floors: list[tuple[float, ConvexPolygon]], climb_m: float) -> list[ConvexPolygon]:
    """Returns rectangles along the upper side of edges that are too high, a cell wide; floors as of `_low_floors`."""
    raised = np.array([plan.bounds_m for top_m, plan in floors if top_m - floors[0][0] > climb_m]).reshape(-1, 4)
    raised = raised[(raised[:, 2:] - raised[:, :2]).max(axis=1, initial=0.0) < UNBOUNDED_M]
    if len(raised) == 0:
        return []
    corner_m = raised[:, :2].min(axis=0) - 2 * EDGE_CELL_M
    cols, rows = np.ceil((raised[:, 2:].max(axis=0) - corner_m) / EDGE_CELL_M).astype(int) + 2
    frame = GridFrame(origin_xy_m=(corner_m[0], corner_m[1]), shape=(int(rows), int(cols)), cell_m=EDGE_CELL_M)
    height_m = _heights(frame, floors)
    beside_m = cv2.erode(height_m, np.ones((3, 3), np.uint8))
    upper = np.isfinite(height_m) & (height_m - beside_m > climb_m)
    rows_of_edges = np.flatnonzero(upper.any(axis=1)).tolist()
    return [_rectangle(frame, row, *ends) for row in rows_of_edges for ends in runs_of(upper[row])]


def _heights(frame: GridFrame, floors: list[tuple[float, ConvexPolygon]]) -> NDArray[np.float32]:
    """Returns the height of the highest floor (rows, cols); inf outside the floors: their edge there is not a step."""
    height_m = np.full(frame.shape, np.inf, np.float32)
    for top_m, plan in floors:
        window = frame.index_of(plan.bounds_m)
        x_m, y_m = frame.axes(window)
        covered = np.zeros((len(y_m), len(x_m)), np.bool_)
        mark_inside(covered, x_m, y_m, plan.normals, plan.offsets_m)
        height_m[window][covered] = top_m
    return height_m


def _rectangle(frame: GridFrame, row: int, first: int, end: int) -> ConvexPolygon:
    """Returns the rectangle of some cells of a row."""
    (x_m, y_m), cell_m = frame.origin_xy_m, frame.cell_m
    left, right, low, high = x_m + first * cell_m, x_m + end * cell_m, y_m + row * cell_m, y_m + (row + 1) * cell_m
    rectangle = ConvexPolygon.of_corners(np.array([[left, low], [right, low], [right, high], [left, high]]))
    assert rectangle is not None  # it has at least one cell
    return rectangle
