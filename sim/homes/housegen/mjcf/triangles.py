"""Triangulates every shape that a geom can have, as finely as is visible from half a metre."""

from __future__ import annotations

import functools
import itertools
import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from sim.homes.housegen.furniture.item import Geom, MeshShape
from sim.homes.housegen.furniture.shapes import BOX_CORNERS, BOX_FACES, hashed_mesh

Facets = tuple[NDArray[np.float64], NDArray[np.int32]]
"""Corners (n, 3) in the geom's frame, metres; triangles (m, 3), counter-clockwise from outside."""
Rings = tuple[tuple[float, float], ...]
"""(radius, height) of the rings of a body of revolution about z, metres."""


def mesh_shape(kind: str, vertices_m: NDArray[np.float64], faces: NDArray[np.int32]) -> MeshShape:
    """Returns a mesh named after a hash of its content; vertices are rounded to 0.1 mm, half-way values up."""
    return hashed_mesh(kind, np.asarray(vertices_m, dtype=np.float64) + 1e-9, faces)


def triangle_areas(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the areas (m,) of triangles (m, 3, 3)."""
    return 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)


def facets(geom: Geom) -> Facets:
    """Returns the surface of a geom.

    Raises:
        ValueError: its shape is not one of `item.Shape`.
    """
    if geom.mesh is not None:
        return _mesh(geom.mesh.vertices_m, geom.mesh.faces)
    if geom.shape == "box":
        return BOX_CORNERS * geom.size_m, BOX_FACES
    if geom.shape == "cylinder":
        return _revolve(((geom.size_m[0], -geom.size_m[1]), (geom.size_m[0], geom.size_m[1])))
    if geom.shape == "capsule":
        return _revolve(_capsule(*geom.size_m[:2]))
    if geom.shape in ("sphere", "ellipsoid"):
        size = np.asarray(geom.size_m if geom.shape == "ellipsoid" else (geom.size_m[0],) * 3)
        corners, faces = _revolve(_ball(float(size.max())), _segments_for(float(size.max())))
        return corners * size, faces
    raise ValueError(
        f"No triangles for shape '{geom.shape}'. Available: box, cylinder, capsule, sphere, ellipsoid, mesh."
    )


def _segments_for(radius_m: float) -> int:
    """Returns the number of corners of a circle of this radius."""
    return 6 if radius_m < 0.03 else 8 if radius_m < 0.1 else 12


def _capsule(radius_m: float, half_m: float) -> Rings:
    """Returns the rings of a capsule; a thin one has flat ends."""
    if radius_m < 0.03:
        return (radius_m, -half_m - 0.6 * radius_m), (radius_m, half_m + 0.6 * radius_m)
    upper = (radius_m, half_m), (0.7 * radius_m, half_m + 0.7 * radius_m), (0.0, half_m + radius_m)
    return (*((r, -z) for r, z in reversed(upper)), *upper)


def _ball(radius_m: float) -> Rings:
    """Returns rings of the unit sphere, more of them for a larger sphere."""
    stacks = 3 if radius_m < 0.03 else 4 if radius_m < 0.07 else 6
    angles = [math.pi * (n / stacks - 0.5) for n in range(stacks + 1)]
    return tuple((0.0 if n in (0, stacks) else math.cos(a), math.sin(a)) for n, a in enumerate(angles))


@functools.lru_cache(maxsize=512)
def _revolve(rings: Rings, segments: int = 0) -> Facets:
    """Returns a body of revolution about z from its rings, lowest first; radius 0 is a pole."""
    segments = segments or _segments_for(max(radius for radius, _ in rings))
    turns = np.arange(segments) * (math.tau / segments)
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    corners: list[NDArray[np.float64]] = []
    starts: list[tuple[int, int]] = []  # first corner of each ring, and its number of corners
    for radius, z in rings:
        ring = np.column_stack([radius * circle, np.full(segments, z)]) if radius else np.array([[0.0, 0.0, z]])
        starts.append((sum(len(c) for c in corners), len(ring)))
        corners.append(ring)
    faces: list[tuple[int, int, int]] = []
    for (low, n_low), (high, n_high) in itertools.pairwise(starts):
        for i in range(segments):
            j = (i + 1) % segments
            if n_low > 1:
                faces.append((low + i, low + j, high + (j if n_high > 1 else 0)))
            if n_high > 1:
                faces.append((low + (i if n_low > 1 else 0), high + j, high + i))
    for start, count, up in ((*starts[0], False), (*starts[-1], True)):
        for i in range(1, count - 1):
            faces.append((start, start + i, start + i + 1) if up else (start, start + i + 1, start + i))
    return np.vstack(corners), np.array(faces, dtype=np.int32)


def _mesh(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> Facets:
    """Returns a mesh unchanged, or its convex hull where it has no faces."""
    return (vertices, faces) if len(faces) else _hull(vertices.tobytes())


@functools.lru_cache(maxsize=512)
def _hull(points: bytes) -> Facets:
    """Returns the convex hull of (n, 3) float64 points."""
    vertices = np.frombuffer(points, dtype=np.float64).reshape(-1, 3)
    hull = ConvexHull(vertices)
    new = np.full(len(vertices), -1)
    new[hull.vertices] = np.arange(len(hull.vertices))
    triangles = hull.simplices.copy()
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return vertices[hull.vertices], new[triangles].astype(np.int32)
