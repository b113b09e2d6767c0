"""Convex polygons in plan: the obstacles, the floors and the extent of one storey of a house."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.core.errors import HouseError
from sim.core.geometry.convex import ConvexPolygon, polygon_from_above
from sim.core.interface import MPCAT40_ID
from sim.gl import mujoco
from sim.houses.geoms import UNBOUNDED_M, geom_polytope, geoms_between
from sim.houses.house import Room
from sim.houses.labels import Labels, collidable_geoms, cover_geoms

FLOOR_STEP_M = 0.05
"""A floor belongs to a storey when its top is at most this far above or below the storey's height."""
WALL_REACH_M = 0.25
"""Margin around a room's box that still counts as the house: doorways lie inside walls."""
OPEN_FLOOR_M = 10.0
"""Margin around the obstacles, or around the origin, that is searched on an unbounded floor without walls."""
MIN_WALLED_M = 1.5
"""Least side of the rectangle around the walls of a house without rooms."""
BESIDE_M = 0.5
"""A wall stands along a side of the rectangle around all walls if it is at most this far inside of it."""
WALLED_SHARE = 0.25
"""Walls enclose a house without rooms if they stand along at least this share of each side."""


def polygons_between(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: NDArray[np.int64], heights_m: tuple[float, float]
) -> list[ConvexPolygon]:
    """Returns the plan projections of those geoms that have a part between two heights."""
    near = geoms_between(model, data, geoms, *heights_m).tolist()
    polygons = (polygon_from_above(geom_polytope(model, data, geom), *heights_m) for geom in near)
    return [polygon for polygon in polygons if polygon is not None]


def floor_polygons(
    model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, floor_z_m: float
) -> list[ConvexPolygon] | None:
    """Returns the plan projections of the floors of a storey; None when an infinite plane makes it unbounded.

    A plane with a size carries the robot where it is rendered (`sim.world.support`).
    """
    polygons: list[ConvexPolygon] = []
    for geom in np.flatnonzero(
        (labels.geom_category == MPCAT40_ID["floor"]) & collidable_geoms(model) & ~cover_geoms(model)
    ):
        body = geom_polytope(model, data, int(geom))
        if abs(float(body.vertices_m[:, 2].max()) - floor_z_m) > FLOOR_STEP_M:
            continue
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
            if not (model.geom_size[geom, :2] > 0.0).all():
                return None
            body = geom_polytope(model, data, int(geom), rendered=True)
        polygon = polygon_from_above(body)
        if polygon is not None:
            polygons.append(polygon)
    return polygons


def house_extent(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    labels: Labels,
    rooms: tuple[Room, ...],
    floors: list[ConvexPolygon] | None,
    obstacles: list[ConvexPolygon],
) -> list[ConvexPolygon]:
    """Returns polygons that cover a storey: its rooms and their walls.

    Without rooms it is the bounding rectangle of the walls, else of the floors, else of the obstacles with a margin.
    Walls count only if they stand along all four sides: one or two walls enclose nothing.
    """
    if rooms:
        return [rectangle for room in rooms for rectangle in room_rectangles(room, WALL_REACH_M)]
    walls = np.flatnonzero(labels.geom_category == MPCAT40_ID["wall"])
    walled = polygons_between(model, data, walls, (-math.inf, math.inf))
    enclosed = _bounding_rectangle(walled)
    if enclosed is not None and _encloses(walled, enclosed):
        return [enclosed]
    around = (
        _bounding_rectangle(floors or [])
        or _bounding_rectangle(obstacles, margin_m=OPEN_FLOOR_M)
        or _rectangle(-OPEN_FLOOR_M, -OPEN_FLOOR_M, OPEN_FLOOR_M, OPEN_FLOOR_M)
    )
    return [around]


def room_rectangles(room: Room, margin_m: float = 0.0) -> list[ConvexPolygon]:
    """Returns the boxes of a room in plan, grown by a margin.

    Raises:
        HouseError: a box has no area.
    """
    return [
        _rectangle(x - hx - margin_m, y - hy - margin_m, x + hx + margin_m, y + hy + margin_m)
        for (x, y, _), (hx, hy, _) in room.boxes
    ]


def _bounding_rectangle(polygons: list[ConvexPolygon], *, margin_m: float = 0.0) -> ConvexPolygon | None:
    """Returns the rectangle around the bounded polygons; None if no polygon is bounded."""
    bounds = np.array([polygon.bounds_m for polygon in polygons]).reshape(-1, 4)
    bounds = bounds[(bounds[:, 2:] - bounds[:, :2]).max(axis=1, initial=0.0) < UNBOUNDED_M]
    if len(bounds) == 0:
        return None
    return _rectangle(*(bounds[:, :2].min(axis=0) - margin_m), *(bounds[:, 2:].max(axis=0) + margin_m))


def _encloses(walls: list[ConvexPolygon], rectangle: ConvexPolygon) -> bool:
    """Returns whether walls stand along all four sides of the rectangle around them."""
    bounds = np.array([wall.bounds_m for wall in walls])  # (n, 4) smallest x and y, largest x and y
    x0, y0, x1, y1 = rectangle.bounds_m
    if min(x1 - x0, y1 - y0) < MIN_WALLED_M:
        return False
    for side in range(4):
        along = 1 - side % 2
        near = np.abs(bounds[:, side] - rectangle.bounds_m[side]) <= BESIDE_M
        length_m = (bounds[near, along + 2] - bounds[near, along]).sum()
        if length_m < WALLED_SHARE * (rectangle.bounds_m[along + 2] - rectangle.bounds_m[along]):
            return False
    return True


def _rectangle(x0: float, y0: float, x1: float, y1: float) -> ConvexPolygon:
    polygon = ConvexPolygon.around(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], dtype=np.float64))
    if polygon is None:
        raise HouseError(f"the rectangle from ({x0:.3f}, {y0:.3f}) to ({x1:.3f}, {y1:.3f}) m has no area.")
    return polygon
