"""Converts MuJoCo geoms to convex polytopes and reads the triangles of mesh geoms.

Every MuJoCo collision geom is convex (a mesh collides as its convex hull), so each becomes a polytope of vertices and
edges. Polytopes of curved shapes are circumscribed, at most `CURVE_TOLERANCE_M` too large.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.convex import Polytope
from sim.gl import mujoco

CURVE_TOLERANCE_M = 0.002
"""Largest distance by which the polytope of a curved geom exceeds the geom."""
UNBOUNDED_M = 100.0
"""Half extent that represents an infinite plane."""
PLANE_DEPTH_M = 0.01
"""Thickness of a rendered plane, so that a line can cross it."""
_CONVEX_SHARE = 0.995
"""A mesh is convex when its volume is at least this share of its hull's volume."""
_GEOM = mujoco.mjtGeom


def data_at_rest(model: mujoco.MjModel) -> mujoco.MjData:
    """Returns the initial state of a model, kinematics computed."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return data


def geom_polytope(model: mujoco.MjModel, data: mujoco.MjData, geom: int, *, rendered: bool = False) -> Polytope:
    """Returns the convex polytope of a geom in the world.

    Args:
        model: the compiled model.
        data: its state; kinematics must be computed.
        geom: id of the geom.
        rendered: a plane is the thin rectangle that is rendered, not the half space that blocks collisions.

    Raises:
        ValueError: the geom is a height field or a signed distance field, which is not convex.
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
        raise ValueError(f"geom {geom} is of type {_GEOM(shape).name}, which is not convex.")
    rotation = data.geom_xmat[geom].reshape(3, 3)
    return Polytope(vertices @ rotation.T + data.geom_xpos[geom], edges)


def world_boxes(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Sequence[int] | NDArray[np.integer]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and the highest corners (n, 3) of the world-aligned boxes around geoms, metres.

    Boxes around meshes are those of their vertices: MuJoCo's own box of a mesh is aligned with its axes of inertia, and
    turned into the world it can be wider by a third.
    """
    ids = np.asarray(geoms, np.int64)
    rotation = data.geom_xmat[ids].reshape(-1, 3, 3)
    middle = data.geom_xpos[ids] + np.einsum("nij,nj->ni", rotation, model.geom_aabb[ids, :3])
    reach = np.einsum("nij,nj->ni", np.abs(rotation), model.geom_aabb[ids, 3:])
    low, high = middle - reach, middle + reach
    for row in np.flatnonzero(model.geom_type[ids] == mujoco.mjtGeom.mjGEOM_MESH).tolist():
        vertices = _mesh_vertices(model, int(model.geom_dataid[ids[row]])) @ rotation[row].T + data.geom_xpos[ids[row]]
        low[row], high[row] = vertices.min(axis=0), vertices.max(axis=0)
    return low, high


def geoms_between(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: NDArray[np.int64], low_m: float, high_m: float
) -> NDArray[np.int64]:
    """Returns the geoms with a part of their bounding sphere between two heights, and all planes."""
    z, radius = data.geom_xpos[geoms, 2], model.geom_rbound[geoms]
    reaches = (z - radius <= high_m) & (z + radius >= low_m)
    return geoms[reaches | (model.geom_type[geoms] == _GEOM.mjGEOM_PLANE)]


def mesh_triangles(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> NDArray[np.float64]:
    """Returns the triangles (n, 3, 3) of a mesh geom in the world: triangle, corner, xyz."""
    mesh = int(model.geom_dataid[geom])
    start = int(model.mesh_faceadr[mesh])
    faces = model.mesh_face[start : start + int(model.mesh_facenum[mesh])]
    rotation = data.geom_xmat[geom].reshape(3, 3)
    return (_mesh_vertices(model, mesh) @ rotation.T + data.geom_xpos[geom])[faces]


def is_hollow(model: mujoco.MjModel, geom: int) -> bool:
    """Returns whether a geom is a mesh that is not convex."""
    return model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH and not mesh_is_convex(model, geom)


def mesh_is_convex(model: mujoco.MjModel, geom: int) -> bool:
    """Returns whether a mesh geom is convex: its volume is that of its convex hull."""
    mesh = int(model.geom_dataid[geom])
    start = int(model.mesh_faceadr[mesh])
    faces = model.mesh_face[start : start + int(model.mesh_facenum[mesh])]
    return _is_convex(_mesh_vertices(model, mesh).tobytes(), faces.tobytes())


@functools.lru_cache(maxsize=1024)
def _is_convex(points: bytes, faces: bytes) -> bool:
    from scipy.spatial import ConvexHull, QhullError  # on demand: a quarter of a second at every start

    vertices = np.frombuffer(points, dtype=np.float64).reshape(-1, 3)
    a, b, c = vertices[np.frombuffer(faces, dtype=np.int32).reshape(-1, 3)].transpose(1, 0, 2)
    volume_m3 = float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0
    try:
        return abs(volume_m3) >= _CONVEX_SHARE * float(ConvexHull(vertices).volume)
    except QhullError:
        return False


def _box(low: NDArray[np.float64], high: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Returns vertices and edges of an axis-aligned box."""
    corner = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)])
    return np.where(corner == 1, high, low), _BOX_EDGES


_BOX_EDGES = np.array([(i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit])


def _plane(size: NDArray[np.float64], rendered: bool) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Returns vertices and edges of the half space below a plane, or of the rendered rectangle."""
    if not rendered:
        half = np.array([UNBOUNDED_M, UNBOUNDED_M])
        return _box(np.array([*-half, -UNBOUNDED_M]), np.array([*half, 0.0]))
    half = np.where(size[:2] > 0.0, size[:2], UNBOUNDED_M)
    return _box(np.array([*-half, -PLANE_DEPTH_M]), np.array([*half, 0.0]))


@functools.lru_cache(maxsize=256)
def _cylinder(radius: float, half_length: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Returns vertices and edges of a circumscribed prism: 1 / cos(pi / n) - 1 < tolerance / radius."""
    n = max(8, math.ceil(math.pi / math.sqrt(2.0 * CURVE_TOLERANCE_M / radius)))
    angle = np.arange(n) * (math.tau / n)
    ring = radius / math.cos(math.pi / n) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    vertices = np.concatenate([np.c_[ring, np.full(n, -half_length)], np.c_[ring, np.full(n, half_length)]])
    i = np.arange(n)
    following = (i + 1) % n
    return vertices, np.concatenate([np.c_[i, i + n], np.c_[i, following], np.c_[i + n, following + n]])


@functools.lru_cache(maxsize=256)
def _ball(radii: tuple[float, float, float], half_length: float = 0.0) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Returns vertices and edges around an ellipsoid, or around a capsule when `half_length` is not 0.

    Meridians and parallels both exceed the shape by about (pi / n)^2 / 2 of the radius.
    """
    n = max(8, 4 * math.ceil(0.25 * math.pi / math.sqrt(CURVE_TOLERANCE_M / max(radii))))
    quarter = np.linspace(0.0, 0.5 * math.pi, n // 4 + 1)
    polar = np.concatenate([quarter, math.pi - quarter[::-1]])  # the equator twice: both ends of a capsule's cylinder
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
    """Returns the vertices (n, 3) of a mesh in the frame of its geoms."""
    start = int(model.mesh_vertadr[mesh])
    return model.mesh_vert[start : start + int(model.mesh_vertnum[mesh])].astype(np.float64)


def _mesh_hull(vertices: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Returns vertices and edges of the convex hull of points (n, 3)."""
    return _hull_of_bytes(vertices.tobytes())


def _flat_hull(vertices: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Returns vertices and edges of the convex hull of points (n, 3) that lie in a plane or on a line."""
    from scipy.spatial import ConvexHull, QhullError  # on demand, as below

    offsets = vertices - vertices.mean(axis=0)
    in_plane = offsets @ np.linalg.svd(offsets, full_matrices=False)[2][:2].T
    try:
        around = ConvexHull(in_plane).vertices
    except QhullError:  # a line
        return vertices[[in_plane[:, 0].argmin(), in_plane[:, 0].argmax()]], np.array([[0, 1]])
    numbers = np.arange(len(around))
    return vertices[around], np.c_[numbers, np.roll(numbers, -1)]


@functools.lru_cache(maxsize=1024)
def _hull_of_bytes(points: bytes) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Computes a convex hull; results are cached by content, since meshes repeat within a house."""
    from scipy.spatial import ConvexHull, QhullError  # on demand: a quarter of a second at every start

    vertices = np.frombuffer(points, dtype=np.float64).reshape(-1, 3)
    try:
        hull = ConvexHull(vertices)
    except QhullError:
        return _flat_hull(vertices)
    kept = np.sort(hull.vertices)
    triangles = np.searchsorted(kept, hull.simplices)
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return vertices[kept], np.unique(edges, axis=0)
