"""Geoms seen from above: convex polytopes, their plan projections, and what a straight line in plan runs into.

Every MuJoCo collision geom is convex (a mesh collides as its hull), so each becomes a polytope of vertices and edges.
Its projection between two heights is the convex hull of the vertices in between and of the points where edges cross
the two heights. Curved shapes are circumscribed, at most `CURVE_TOLERANCE_M` too large.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from sim.gl import mujoco

CURVE_TOLERANCE_M = 0.002
"""How much larger than the true shape the polytope of a curved geom may be."""
UNBOUNDED_M = 100.0
"""Half extent that stands for an infinite plane."""
PLANE_DEPTH_M = 0.01
"""Thickness given to a rendered plane, so that a line can run into it."""
MIN_CROSSING_M = 0.001
"""A line runs into a polygon when it stays in it for longer than this; touching the surface is not enough."""
JOINT_M = 1e-6
"""How much a polygon grows against lines, so that none slips through the joint of two that meet."""
_MIN_AREA_M2 = 1e-8
_MIN_EDGE_M = 1e-7
_CONVEX_SHARE = 0.995
_GEOM = mujoco.mjtGeom


class Polytope(NamedTuple):
    """A convex body in the world."""

    vertices_m: NDArray[np.float64]  # (n, 3)
    edges: NDArray[np.int64]  # (m, 2) indices of vertices


@dataclass(frozen=True, eq=False)
class ConvexPolygon:
    """A convex polygon in plan: vertices counter-clockwise, and the half planes `normals @ p <= offsets`."""

    vertices_m: NDArray[np.float64]  # (k, 2)
    normals: NDArray[np.float64]  # (k, 2) outward, of length 1
    offsets_m: NDArray[np.float64]  # (k,)
    bounds_m: tuple[float, float, float, float]
    """Smallest x and y, largest x and y."""

    @classmethod
    def around(cls, points_m: NDArray[np.float64]) -> ConvexPolygon | None:
        """The convex hull of points (n, 2); None when it has no area."""
        if len(points_m) < 3:
            return None
        middle = points_m[0]
        hull = cv2.convexHull((points_m - middle).astype(np.float32))[:, 0].astype(np.float64)
        return cls.of_corners(hull + middle)

    @classmethod
    def of_corners(cls, corners_m: NDArray[np.float64]) -> ConvexPolygon | None:
        """The polygon with these corners (k, 2), in order either way round; None when it has no area."""
        along = np.concatenate((corners_m[1:], corners_m[:1])) - corners_m
        about = corners_m - corners_m[0]
        area_m2 = 0.5 * float(about[:, 0] @ along[:, 1] - about[:, 1] @ along[:, 0])
        if abs(area_m2) < _MIN_AREA_M2:
            return None
        if area_m2 < 0.0:
            return cls.of_corners(corners_m[::-1])
        length = np.sqrt(np.einsum("ij,ij->i", along, along))
        if length.min() <= _MIN_EDGE_M:
            return cls.of_corners(corners_m[length > _MIN_EDGE_M])
        normals = np.stack((along[:, 1] / length, -along[:, 0] / length), axis=1)
        low, high = corners_m.min(axis=0).tolist(), corners_m.max(axis=0).tolist()
        return cls(corners_m, normals, np.einsum("ij,ij->i", normals, corners_m), (*low, *high))

    def contains(self, xy_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(n,) which of the points (n, 2) lie in the polygon or on its edge."""
        return np.all(xy_m @ self.normals.T <= self.offsets_m + 1e-9, axis=1)

    def distance(self, xy_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """(n,) metres from the points (n, 2) to the polygon; 0 inside."""
        along = np.roll(self.vertices_m, -1, axis=0) - self.vertices_m
        nearest_sq = np.full(len(xy_m), np.inf)
        for start, edge in zip(self.vertices_m, along, strict=True):
            offset = xy_m - start
            t = np.clip(offset @ edge / (edge @ edge), 0.0, 1.0)
            offset -= t[:, None] * edge
            np.minimum(nearest_sq, np.einsum("ij,ij->i", offset, offset), out=nearest_sq)
        nearest_sq[self.contains(xy_m)] = 0.0
        return np.sqrt(nearest_sq)

    def crossed_by(self, start_m: NDArray[np.float64], end_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(n,) which of the segments from (n, 2) to (n, 2) run through the polygon (clipping of Cyrus and Beck)."""
        step = end_m - start_m
        entry, leave = np.zeros(len(step)), np.ones(len(step))
        for normal, offset in zip(self.normals, self.offsets_m, strict=True):
            room, speed = offset + JOINT_M - start_m @ normal, step @ normal
            outward, inward = speed > 1e-12, speed < -1e-12
            t = room / np.where(outward | inward, speed, 1.0)
            leave = np.where(outward, np.minimum(leave, t), leave)
            entry = np.where(inward, np.maximum(entry, t), entry)
            leave = np.where(~(outward | inward) & (room < 0.0), -1.0, leave)
        return (leave - entry) * np.linalg.norm(step, axis=1) > MIN_CROSSING_M


def geom_polytope(model: mujoco.MjModel, data: mujoco.MjData, geom: int, *, rendered: bool = False) -> Polytope:
    """The convex body of a geom where it stands.

    Args:
        model: the compiled model.
        data: its state, kinematics computed.
        geom: index of the geom; a height field or a signed distance field is no convex body.
        rendered: a plane is what a camera sees of it (its size, a thin sheet) instead of the half space it blocks.

    Raises:
        ValueError: the geom's shape is none of MuJoCo's convex ones.
    """
    shape, size = int(model.geom_type[geom]), model.geom_size[geom]
    if shape == _GEOM.mjGEOM_BOX:
        vertices, edges = _box(-size, size)
    elif shape == _GEOM.mjGEOM_PLANE:
        vertices, edges = _plane(size, rendered)
    elif shape == _GEOM.mjGEOM_CYLINDER:
        vertices, edges = _cylinder(float(size[0]), float(size[1]))
    elif shape == _GEOM.mjGEOM_SPHERE:
        vertices, edges = _ball((size[0],) * 3)
    elif shape == _GEOM.mjGEOM_ELLIPSOID:
        vertices, edges = _ball(tuple(size))
    elif shape == _GEOM.mjGEOM_CAPSULE:
        vertices, edges = _ball((size[0],) * 3, float(size[1]))
    elif shape == _GEOM.mjGEOM_MESH:
        vertices, edges = _mesh_hull(_mesh_vertices(model, int(model.geom_dataid[geom])))
    else:
        raise ValueError(f"geom {geom} is of type {_GEOM(shape).name}, which is no convex shape.")
    rotation = data.geom_xmat[geom].reshape(3, 3)
    return Polytope(vertices @ rotation.T + data.geom_xpos[geom], edges)


def geoms_between(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: NDArray[np.int64], low_m: float, high_m: float
) -> NDArray[np.int64]:
    """Those of the geoms whose bounding sphere reaches between two heights; planes always."""
    z, radius = data.geom_xpos[geoms, 2], model.geom_rbound[geoms]
    reaches = (z - radius <= high_m) & (z + radius >= low_m)
    return geoms[reaches | (model.geom_type[geoms] == _GEOM.mjGEOM_PLANE)]


def plan_polygon(body: Polytope, low_m: float = -math.inf, high_m: float = math.inf) -> ConvexPolygon | None:
    """What a convex body covers in plan between two heights (which may be equal); None: nothing."""
    z = body.vertices_m[:, 2]
    if float(z.max()) < low_m or float(z.min()) > high_m:
        return None
    points = [body.vertices_m[(z >= low_m) & (z <= high_m), :2]]
    first, second = body.vertices_m[body.edges[:, 0]], body.vertices_m[body.edges[:, 1]]
    for height in {low_m, high_m}:
        crossing = (first[:, 2] - height) * (second[:, 2] - height) < 0.0
        if np.any(crossing):
            a, b = first[crossing], second[crossing]
            t = (height - a[:, 2:]) / (b[:, 2:] - a[:, 2:])
            points.append(a[:, :2] + t * (b[:, :2] - a[:, :2]))
    return ConvexPolygon.around(np.concatenate(points))


def mesh_triangles(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> NDArray[np.float64]:
    """(n, 3, 3) the rendered triangles of a mesh geom in the world: triangle, corner, xyz."""
    mesh = int(model.geom_dataid[geom])
    start = int(model.mesh_faceadr[mesh])
    faces = model.mesh_face[start : start + int(model.mesh_facenum[mesh])]
    rotation = data.geom_xmat[geom].reshape(3, 3)
    return (_mesh_vertices(model, mesh) @ rotation.T + data.geom_xpos[geom])[faces]


def mesh_is_convex(model: mujoco.MjModel, geom: int) -> bool:
    """Whether a mesh geom looks like the hull that it collides as: its volume is the hull's."""
    mesh = int(model.geom_dataid[geom])
    start = int(model.mesh_faceadr[mesh])
    faces = model.mesh_face[start : start + int(model.mesh_facenum[mesh])]
    return _is_convex(_mesh_vertices(model, mesh).tobytes(), faces.tobytes())


@functools.lru_cache(maxsize=1024)
def _is_convex(points: bytes, faces: bytes) -> bool:
    vertices = np.frombuffer(points, dtype=np.float64).reshape(-1, 3)
    a, b, c = vertices[np.frombuffer(faces, dtype=np.int32).reshape(-1, 3)].transpose(1, 0, 2)
    volume_m3 = float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0
    try:
        return abs(volume_m3) >= _CONVEX_SHARE * float(ConvexHull(vertices).volume)
    except QhullError:
        return False


def lines_blocked(
    start_m: NDArray[np.float64], end_m: NDArray[np.float64], polygons: Iterable[ConvexPolygon]
) -> NDArray[np.bool_]:
    """(n,) which of the segments from (n, 2) to (n, 2) run through some polygon."""
    blocked = np.zeros(len(start_m), dtype=np.bool_)
    low, high = np.minimum(start_m, end_m), np.maximum(start_m, end_m)
    for polygon in polygons:
        x0, y0, x1, y1 = polygon.bounds_m
        near = ~blocked & (low[:, 0] <= x1 + JOINT_M) & (high[:, 0] >= x0 - JOINT_M)
        near &= (low[:, 1] <= y1 + JOINT_M) & (high[:, 1] >= y0 - JOINT_M)
        pairs = np.flatnonzero(near)
        if pairs.size:
            blocked[pairs] = polygon.crossed_by(start_m[pairs], end_m[pairs])
    return blocked


def _box(low: NDArray[np.float64], high: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices and edges of an axis-aligned box."""
    corner = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)])
    return np.where(corner == 1, high, low), _BOX_EDGES


_BOX_EDGES = np.array([(i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit])


def _plane(size: NDArray[np.float64], rendered: bool) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The half space under a plane, or the sheet that is seen of it."""
    if not rendered:
        half = np.array([UNBOUNDED_M, UNBOUNDED_M])
        return _box(np.array([*-half, -UNBOUNDED_M]), np.array([*half, 0.0]))
    half = np.where(size[:2] > 0.0, size[:2], UNBOUNDED_M)
    return _box(np.array([*-half, -PLANE_DEPTH_M]), np.array([*half, 0.0]))


@functools.lru_cache(maxsize=256)
def _cylinder(radius: float, half_length: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A circumscribed prism: 1 / cos(pi / n) - 1 < tolerance / radius."""
    n = max(8, math.ceil(math.pi / math.sqrt(2.0 * CURVE_TOLERANCE_M / radius)))
    angle = np.arange(n) * (math.tau / n)
    ring = radius / math.cos(math.pi / n) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    vertices = np.concatenate([np.c_[ring, np.full(n, -half_length)], np.c_[ring, np.full(n, half_length)]])
    i = np.arange(n)
    ahead = (i + 1) % n
    return vertices, np.concatenate([np.c_[i, i + n], np.c_[i, ahead], np.c_[i + n, ahead + n]])


@functools.lru_cache(maxsize=256)
def _ball(radii: tuple[float, float, float], half_length: float = 0.0) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A circumscribed ellipsoid, or a capsule when its halves are pulled apart along z.

    Meridians and parallels both cut the corner by about (pi / n)^2 / 2 of the radius.
    """
    n = max(8, 4 * math.ceil(0.25 * math.pi / math.sqrt(CURVE_TOLERANCE_M / max(radii))))
    quarter = np.linspace(0.0, 0.5 * math.pi, n // 4 + 1)
    polar = np.concatenate([quarter, math.pi - quarter[::-1]])  # the equator twice: the seam of a capsule
    upper = np.arange(len(polar)) < len(quarter)
    angle = np.arange(n) * (math.tau / n)
    sphere = np.stack(
        [
            np.outer(np.sin(polar), np.cos(angle)),
            np.outer(np.sin(polar), np.sin(angle)),
            np.outer(np.cos(polar), np.ones(n)),
        ],
        axis=-1,
    )
    vertices = sphere * np.asarray(radii) / math.cos(math.pi / n) ** 2
    vertices[..., 2] += np.where(upper, half_length, -half_length)[:, None]
    index = np.arange(len(polar) * n).reshape(len(polar), n)
    parallels = np.c_[index.ravel(), np.roll(index, -1, axis=1).ravel()]
    meridians = np.c_[index[:-1].ravel(), index[1:].ravel()]
    return vertices.reshape(-1, 3), np.concatenate([parallels, meridians])


def _mesh_vertices(model: mujoco.MjModel, mesh: int) -> NDArray[np.float64]:
    """(n, 3) vertices in the frame of the geoms that show the mesh."""
    start = int(model.mesh_vertadr[mesh])
    return model.mesh_vert[start : start + int(model.mesh_vertnum[mesh])].astype(np.float64)


def _mesh_hull(vertices: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices and edges of the convex hull of points (n, 3)."""
    return _hull_of_bytes(vertices.tobytes())


@functools.lru_cache(maxsize=1024)
def _hull_of_bytes(points: bytes) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Convex hull, remembered by content: houses repeat their meshes."""
    vertices = np.frombuffer(points, dtype=np.float64).reshape(-1, 3)
    try:
        hull = ConvexHull(vertices)
    except QhullError:  # a flat mesh: every pair of vertices may be an edge
        first, second = np.triu_indices(len(vertices), 1)
        return vertices, np.c_[first, second]
    kept = np.sort(hull.vertices)
    triangles = np.searchsorted(kept, hull.simplices)
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return vertices[kept], np.unique(edges, axis=0)
