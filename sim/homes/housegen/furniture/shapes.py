"""Small procedural meshes: chamfered boxes, lofts, bent strips, hanging cloth; each at most 250 vertices.

Vertices are rounded to 0.1 mm, so that the same parameters give the same mesh, the same name and short XML.
MuJoCo collides a mesh by its convex hull; meshes without faces are also rendered as their hull.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.homes.housegen.furniture.item import MeshShape

MAX_VERTICES = 250
"""Limit for one mesh; it keeps the XML of a house small."""
BOX_CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
BOX_FACES = np.array(
    [
        tri
        for a, b, c, d in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        for tri in ((a, b, c), (a, c, d))
    ],
    dtype=np.int32,
)
"""Corners (8, 3) of the cube of edge 2 about the origin, and its triangles (12, 3), counter-clockwise from outside."""


@dataclass(frozen=True)
class Ring:
    """A horizontal cross-section of a loft that is a superellipse |x/rx|^p + |y/ry|^p = 1 at height z."""

    z_m: float
    rx_m: float
    ry_m: float
    x_m: float = 0.0
    y_m: float = 0.0
    power: float = 2.0
    """2: an ellipse; 4: a rounded rectangle."""


def named_mesh(kind: str, vertices_m: ArrayLike, faces: ArrayLike = ()) -> MeshShape:
    """Returns a mesh; its name contains a hash of its content.

    Raises:
        ValueError: more than `MAX_VERTICES` vertices.
    """
    mesh = hashed_mesh(kind, vertices_m, faces)
    if len(mesh.vertices_m) > MAX_VERTICES:
        raise ValueError(f"Mesh '{kind}' has {len(mesh.vertices_m)} vertices; at most {MAX_VERTICES} are allowed.")
    return mesh


def hashed_mesh(
    kind: str, vertices_m: ArrayLike, faces: ArrayLike, texture_uv: NDArray[np.float64] | None = None
) -> MeshShape:
    """Returns a mesh of any number of vertices (n, 3) and faces (m, 3); its name contains a hash of its content."""
    vertices = np.round(np.asarray(vertices_m, dtype=np.float64), 4) + 0.0  # + 0.0 turns -0.0 into 0.0
    triangles = np.asarray(faces, dtype=np.int32).reshape(-1, 3)
    content = np.rint(vertices * 1e4).astype("<i4").tobytes() + triangles.astype("<i4").tobytes()
    content += b"" if texture_uv is None else texture_uv.tobytes()
    return MeshShape(f"{kind}_{hashlib.sha1(content).hexdigest()[:8]}", vertices, triangles, texture_uv)


def chamfered_box(size_m: tuple[float, float, float], chamfer_m: float) -> MeshShape:
    """Returns a box of full size `size_m` about the origin with edges cut off by `chamfer_m`."""
    half = 0.5 * np.asarray(size_m)
    cut = np.minimum(chamfer_m, 0.98 * half)
    corners = [BOX_CORNERS * np.where(np.arange(3) == axis, half, half - cut) for axis in range(3)]
    return named_mesh("chamfer", np.vstack(corners))


def frustum(
    bottom_m: tuple[float, float], top_m: tuple[float, float], height_m: float, lean_m: tuple[float, float] = (0, 0)
) -> MeshShape:
    """Returns a four-sided tapered block from z = 0 to `height_m`; `lean_m` shifts its top in x and y."""
    vertices = [
        (sx * 0.5 * size[0] + shift[0], sy * 0.5 * size[1] + shift[1], z)
        for size, shift, z in ((bottom_m, (0.0, 0.0), 0.0), (top_m, lean_m, height_m))
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    return named_mesh("frustum", vertices)


def loft(rings: Sequence[Ring], segments: int = 12, *, hull: bool = False, loop: bool = False) -> MeshShape:
    """Returns a surface over a stack of rings, closed at both ends; rings may go down again to form a bowl.

    With `hull`, the mesh has no faces and MuJoCo uses the convex hull, which halves the XML of a convex loft. With
    `loop`, the last ring is joined to the first one instead: a body with a hole, such as the seat of a toilet.
    """
    angles = math.pi / 4 + np.arange(segments) * (math.tau / segments)  # a corner of a rounded square is a vertex
    cos, sin = np.cos(angles), np.sin(angles)
    vertices = []
    for ring in rings:
        stretch = (np.abs(cos) ** ring.power + np.abs(sin) ** ring.power) ** (-1.0 / ring.power)
        x, y = ring.x_m + ring.rx_m * stretch * cos, ring.y_m + ring.ry_m * stretch * sin
        vertices.append(np.column_stack([x, y, np.full(segments, ring.z_m)]))
    return named_mesh("loft", np.vstack(vertices), () if hull else ring_faces(len(rings), segments, loop=loop))


def ring_faces(rings: int, segments: int, *, loop: bool = False) -> list[tuple[int, int, int]]:
    """Returns the triangles of a surface over rings of `segments` vertices each, closed at both ends.

    With `loop`, the last ring is joined to the first one instead.
    """
    faces: list[tuple[int, int, int]] = []
    count = rings * segments
    for level in range(rings if loop else rings - 1):
        for i in range(segments):
            a, b = level * segments + i, level * segments + (i + 1) % segments
            faces += _quad(a, b, (b + segments) % count, (a + segments) % count)
    if not loop:
        last = count - segments
        for i in range(1, segments - 1):
            faces += [(0, i + 1, i), (last, last + i, last + i + 1)]
    return faces


def turned(profile_m: Sequence[tuple[float, float]], segments: int = 12, *, hull: bool = False) -> MeshShape:
    """Returns a loft over circles about the z axis, given as (height, radius): a body as from a lathe."""
    return loft([Ring(z, r, r) for z, r in profile_m], segments, hull=hull)


def hoop(radius_m: float, thick_m: float, height_m: float) -> MeshShape:
    """Returns a flat band about the z axis with outer radius `radius_m` and its middle at z = 0."""
    segments = 20
    angles = math.pi / 4 + np.arange(segments) * (math.tau / segments)
    inner_m, half_m = radius_m - thick_m, 0.5 * height_m
    rings = ((radius_m, -half_m), (radius_m, half_m), (inner_m, half_m), (inner_m, -half_m))
    vertices = [np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(segments, z)]) for r, z in rings]
    return named_mesh("hoop", np.vstack(vertices), ring_faces(4, segments, loop=True))


def arc_wall(
    radius_m: float, thick_m: float, base_m: float, angles_rad: Sequence[float], tops_m: Sequence[float]
) -> MeshShape:
    """Returns an upright curved wall about the z axis, from `base_m` to a top per angle; angles must increase."""
    n = len(angles_rad)
    cos, sin = np.cos(angles_rad), np.sin(angles_rad)
    outer, inner, tops = radius_m, radius_m - thick_m, np.asarray(tops_m)
    base, lower = np.full(n, base_m), tops - 0.35 * thick_m
    edges = ((outer, base), (outer, lower), (outer - 0.3 * thick_m, tops), (inner + 0.3 * thick_m, tops), (inner, base))
    vertices = np.vstack([np.column_stack([r * cos, r * sin, z]) for r, z in edges])
    count = len(edges)
    faces: list[tuple[int, int, int]] = []
    for k in range(count):
        for i in range(n - 1):
            up = (k + 1) % count
            faces += _quad(k * n + i, k * n + i + 1, up * n + i + 1, up * n + i)
    for k in range(1, count - 1):
        faces += [(0, k * n, (k + 1) * n), (n - 1, (k + 1) * n + n - 1, k * n + n - 1)]
    return named_mesh("wall", vertices, faces)


def pillow(size_m: tuple[float, float, float], power: float = 4.5) -> MeshShape:
    """Returns a cushion of full size `size_m` about the origin, thick in the middle and thin at the seam."""
    dx, dy, dz = (0.5 * side for side in size_m)
    levels = ((-1.0, 0.50), (-0.62, 0.82), (0.0, 1.0), (0.62, 0.82), (1.0, 0.50))
    return loft([Ring(z * dz, s * dx, s * dy, power=power) for z, s in levels], 16, hull=True)


def puffed(radius_m: float, height_m: float, *, firm: float = 3.0) -> MeshShape:
    """Returns a round stuffed body that stands on z = 0: a pouf or a cushion; a larger `firm` gives a flatter top."""
    profile = [
        (0.5 * height_m * (1.0 + level), radius_m * max(0.55, (1.0 - abs(level) ** firm) ** (1.0 / firm)))
        for level in (-1.0, -0.92, -0.7, -0.3, 0.3, 0.7, 0.92, 1.0)
    ]
    return turned(profile, 18, hull=True)


def strip(path_m: Sequence[tuple[float, float]], thickness_m: float, width_m: float) -> MeshShape:
    """Returns a sheet bent along a path in the (x, z) plane: `thickness_m` to its left, `width_m` along y about 0."""
    path = np.asarray(path_m, dtype=np.float64)
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    other = path + thickness_m * np.column_stack([-along[:, 1], along[:, 0]])
    n = len(path)
    vertices = [
        np.column_stack([side[:, 0], np.full(n, y * 0.5 * width_m), side[:, 1]])
        for y in (-1, 1)
        for side in (path, other)
    ]
    faces: list[tuple[int, int, int]] = []
    p0, q0, p1, q1 = 0, n, 2 * n, 3 * n  # path and other side, right (-y) and left (+y)
    for i in range(n - 1):
        faces += _quad(p0 + i, p0 + i + 1, q0 + i + 1, q0 + i)
        faces += _quad(p1 + i, q1 + i, q1 + i + 1, p1 + i + 1)
        faces += _quad(p0 + i, p1 + i, p1 + i + 1, p0 + i + 1)
        faces += _quad(q0 + i, q0 + i + 1, q1 + i + 1, q1 + i)
    faces += _quad(p0, q0, q1, p1)
    faces += _quad(p0 + n - 1, p1 + n - 1, q1 + n - 1, q0 + n - 1)
    return named_mesh("strip", np.vstack(vertices), faces)


def drape(width_m: float, height_m: float, depth_m: float, folds: int, *, gather: float = 1.0) -> MeshShape:
    """Returns a hanging cloth from z = 0 to `height_m` with folds along y; `gather` < 1 narrows its lower edge."""
    n = 2 * folds + 1
    y = np.linspace(-0.5, 0.5, n) * width_m
    x = np.where(np.arange(n) % 2 == 0, 0.0, 0.6 * depth_m)
    rows = [
        np.column_stack([x + front * 0.4 * depth_m, y * scale, np.full(n, z)])
        for z, scale in ((0.0, gather), (height_m, 1.0))
        for front in (0, 1)
    ]
    faces: list[tuple[int, int, int]] = []
    b0, f0, b1, f1 = 0, n, 2 * n, 3 * n  # back and front edge, below and above
    for i in range(n - 1):
        faces += _quad(f0 + i, f0 + i + 1, f1 + i + 1, f1 + i)
        faces += _quad(b0 + i + 1, b0 + i, b1 + i, b1 + i + 1)
        faces += _quad(b0 + i, b0 + i + 1, f0 + i + 1, f0 + i)
        faces += _quad(f1 + i, f1 + i + 1, b1 + i + 1, b1 + i)
    faces += _quad(b0, f0, f1, b1)
    faces += _quad(f0 + n - 1, b0 + n - 1, b1 + n - 1, f1 + n - 1)
    return named_mesh("drape", np.vstack(rows), faces)


def _quad(a: int, b: int, c: int, d: int) -> list[tuple[int, int, int]]:
    return [(a, b, c), (a, c, d)]
