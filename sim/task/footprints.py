"""Footprints: the union of the plan projections of an instance's rendered geoms, and the floors below instances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.core.geometry.convex import ConvexPolygon, PolygonTable, polygon_from_above
from sim.core.interface import MPCAT40_ID
from sim.gl import mujoco
from sim.houses.geoms import PLANE_DEPTH_M, geom_polytope, is_hollow, mesh_triangles
from sim.houses.labels import Instance, Labels, collidable_geoms, rendered_geoms

if TYPE_CHECKING:
    from scipy.spatial import KDTree

SAMPLE_M = 0.025
"""Largest gap between neighbouring sample points on a footprint's boundary."""
FLOOR_CONTACT_M = 0.1
"""Largest depth by which an object may sink into the floor that it stands on."""
_PIXEL_M = 0.005
_BORDER_PX = 2


class Floor(NamedTuple):
    """A piece of floor: the height of its top, and its outline in plan."""

    top_m: float
    plan: ConvexPolygon | None


class _Placed(NamedTuple):
    """The positions and rotations of an instance's geoms, as bytes, and the footprint of the instance there."""

    place: bytes
    footprint: Footprint | None


@dataclass(frozen=True, eq=False)
class Footprint:
    """The union of the plan projections of an instance's rendered geoms."""

    instance: Instance
    table: PolygonTable
    """Convex polygons; the footprint is their union."""
    boundary_points_m: NDArray[np.float64]  # (n, 2) on its boundary, `SAMPLE_M` apart or nearer
    bounds_m: tuple[float, float, float, float]
    z_m: tuple[float, float]
    """Heights of the lowest and the highest point."""
    floor_z_m: float
    """Height of the floor below the instance."""

    @property
    def parts(self) -> tuple[ConvexPolygon, ...]:
        """The convex polygons."""
        return self.table.polygons

    @cached_property
    def boundary_m(self) -> KDTree:
        """A tree of the points on its boundary."""
        from scipy.spatial import KDTree  # on demand: a quarter of a second at every start

        return KDTree(self.boundary_points_m)

    def near(self, xy_m: NDArray[np.float64], margin_m: float) -> NDArray[np.bool_]:
        """Returns (n,) whether each of the places (n, 2) is in the bounding box grown by a margin."""
        x0, y0, x1, y1 = self.bounds_m
        return np.all((xy_m >= (x0 - margin_m, y0 - margin_m)) & (xy_m <= (x1 + margin_m, y1 + margin_m)), axis=1)

    def contains(self, xy_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Returns (n,) whether each of the places (n, 2) is in the footprint."""
        inside = np.zeros(len(xy_m), dtype=np.bool_)
        candidates = np.flatnonzero(self.near(xy_m, 0.0))
        for part in self.parts if candidates.size else ():
            inside[candidates] |= part.contains(xy_m[candidates])
        return inside


class Footprints:
    """Footprints of the instances of one model; a footprint is computed again only after its instance has moved.

    Args:
        model: compiled world.
        floors: floors of the house.
    """

    def __init__(self, model: mujoco.MjModel, floors: Sequence[Floor] = ()) -> None:
        self._model, self._floors = model, floors
        self._at_first: dict[tuple[int, ...], _Placed] = {}
        self._at_last: dict[tuple[int, ...], _Placed] = {}

    def of(self, data: mujoco.MjData, instance: Instance) -> Footprint | None:
        """Returns the footprint of an instance in a state; None if nothing of it is rendered.

        The footprints of the first and of the last state of each instance are stored.

        Args:
            data: state of the world, with kinematics computed.
            instance: the instance.
        """
        geoms, place = instance.geom_ids, _place(data, instance)
        for known in (self._at_first, self._at_last):
            if geoms in known and known[geoms].place == place:
                return known[geoms].footprint
        placed = _Placed(place, footprint_of(self._model, data, instance, self._floors))
        self._at_first.setdefault(geoms, placed)
        self._at_last[geoms] = placed
        return placed.footprint

    def remember(self, data: mujoco.MjData, instance: Instance, footprint: Footprint | None) -> None:
        """Stores the footprint of an instance in the first state, which was computed before."""
        self._at_first.setdefault(instance.geom_ids, _Placed(_place(data, instance), footprint))


def _place(data: mujoco.MjData, instance: Instance) -> bytes:
    """Returns the positions and rotations of an instance's geoms, as bytes."""
    geoms = list(instance.geom_ids)
    return data.geom_xpos[geoms].tobytes() + data.geom_xmat[geoms].tobytes()


def footprint_of(
    model: mujoco.MjModel, data: mujoco.MjData, instance: Instance, floors: Sequence[Floor] = ()
) -> Footprint | None:
    """Returns the footprint of an instance; None if nothing of it is rendered."""
    rendered = rendered_geoms(model)
    geoms = [geom for geom in instance.geom_ids if rendered[geom]]
    parts = tuple(part for geom in geoms for part in _rendered_parts(model, data, geom))
    if not parts:
        return None
    bounds = np.array([part.bounds_m for part in parts])
    low, high = bounds[:, :2].min(axis=0), bounds[:, 2:].max(axis=0)
    z = np.concatenate([geom_polytope(model, data, geom, rendered=True).vertices_m[:, 2] for geom in geoms])
    z_m = (float(z.min()), float(z.max()))
    floor_z_m = _floor_under(floors, 0.5 * (low + high), z_m[0])
    boundary = _boundary_points(parts, low, high)
    return Footprint(instance, PolygonTable.of(parts), boundary, (*low.tolist(), *high.tolist()), z_m, floor_z_m)


def house_floors(model: mujoco.MjModel, data: mujoco.MjData, labels: Labels) -> tuple[Floor, ...]:
    """Returns the floors of all storeys that wheels can stand on."""
    geoms = np.flatnonzero((labels.geom_category == MPCAT40_ID["floor"]) & collidable_geoms(model))
    bodies = [geom_polytope(model, data, geom) for geom in geoms.tolist()]
    return tuple(Floor(float(body.vertices_m[:, 2].max()), polygon_from_above(body)) for body in bodies)


def _floor_under(floors: Sequence[Floor], xy_m: NDArray[np.float64], bottom_m: float) -> float:
    """Returns the height of the highest floor under a place, not above `bottom_m`; elsewhere of any floor below it."""
    below = [floor for floor in floors if floor.top_m <= bottom_m + FLOOR_CONTACT_M]
    under = [floor for floor in below if floor.plan is not None and floor.plan.contains(xy_m[None])[0]]
    return max((floor.top_m for floor in under or below), default=0.0)


def _rendered_parts(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> list[ConvexPolygon]:
    """Returns the plan projection of a rendered geom: one convex polygon, or the triangles of a hollow mesh.

    A hollow mesh of upright triangles alone, such as an open tube, has a thin rectangle for each of them.
    """
    body = geom_polytope(model, data, geom, rendered=True)
    whole = polygon_from_above(body)
    if whole is None:
        return [_upright_polygon(body.vertices_m[:, :2])]
    if not is_hollow(model, geom):
        return [whole]
    corners = mesh_triangles(model, data, geom)[..., :2]
    low = np.array(whole.bounds_m[:2])
    hull = _raster([whole.vertices_m], low, whole.bounds_m[2:])
    missing = hull & ~_raster(corners, low, whole.bounds_m[2:])
    if not _eroded(missing, 1).any():
        return [whole]
    parts = [part for corner in corners if (part := ConvexPolygon.of_corners(corner)) is not None]
    return parts or list(map(_upright_polygon, corners))


def _upright_polygon(points_m: NDArray[np.float64]) -> ConvexPolygon:
    """Returns a rectangle of `PLANE_DEPTH_M` around points (n, 2) on a line: the plan of an upright flat mesh."""
    middle = points_m.mean(axis=0)
    ahead = np.linalg.svd(points_m - middle, full_matrices=True)[2][0]
    along = (points_m - middle) @ ahead
    half = 0.5 * PLANE_DEPTH_M
    ends = np.array([[along.min() - half, -half], [along.max() + half, -half]])
    corners = np.concatenate([ends, ends[::-1] * (1, -1)])
    polygon = ConvexPolygon.of_corners(middle + corners @ np.stack([ahead, (-ahead[1], ahead[0])]))
    assert polygon is not None
    return polygon


def _boundary_points(
    parts: Sequence[ConvexPolygon], low: NDArray[np.float64], high: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Returns (n, 2) corners and points `SAMPLE_M` apart on the edges of the parts, without those inside the union."""
    points = _edge_points(parts)
    if len(parts) == 1:
        return points
    pixels = np.round((points - low) / _PIXEL_M).astype(np.int64) + _BORDER_PX
    inner = _eroded(_raster([part.vertices_m for part in parts], low, high), _BORDER_PX)
    points = points[~inner[pixels[:, 1], pixels[:, 0]]]
    return points[np.unique(np.round(points / 0.001).astype(np.int64), axis=0, return_index=True)[1]]


def _edge_points(parts: Sequence[ConvexPolygon]) -> NDArray[np.float64]:
    """Returns (n, 2) the corners of polygons and points on their edges."""
    start = np.concatenate([part.vertices_m for part in parts])
    edge = np.concatenate([np.roll(part.vertices_m, -1, axis=0) for part in parts]) - start
    count = np.maximum(1, np.ceil(np.hypot(*edge.T) / SAMPLE_M)).astype(np.int64)
    number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return np.repeat(start, count, axis=0) + (number / np.repeat(count, count))[:, None] * np.repeat(
        edge, count, axis=0
    )


def _raster(
    polygons: Sequence[NDArray[np.float64]] | NDArray[np.float64], low: NDArray[np.float64], high: ArrayLike
) -> NDArray[np.bool_]:
    """Returns an image of convex polygons (k, 2), pixels of `_PIXEL_M` with a border around them."""
    size = np.ceil((np.asarray(high) - low) / _PIXEL_M).astype(int) + 1 + 2 * _BORDER_PX
    image = np.zeros((size[1], size[0]), dtype=np.uint8)
    for polygon in polygons:
        pixels = np.round((polygon - low) / _PIXEL_M).astype(np.int32) + _BORDER_PX
        cv2.fillConvexPoly(image, pixels, 1)
    return image.astype(np.bool_)


def _eroded(image: NDArray[np.bool_], radius_px: int) -> NDArray[np.bool_]:
    kernel = np.ones((2 * radius_px + 1, 2 * radius_px + 1), dtype=np.uint8)
    return cv2.erode(image.astype(np.uint8), kernel, borderValue=0).astype(np.bool_)
