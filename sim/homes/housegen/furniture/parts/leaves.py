"""Leaves, stems, fronds and blossoms of plants: closed triangle bodies that are joined into one mesh for each look.

A leaf has 8 to 20 vertices, so that a whole plant stays below 250 vertices.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.homes.housegen.furniture.item import MeshShape
from sim.homes.housegen.furniture.shapes import named_mesh
from sim.homes.housegen.furniture.workbench import Point

Body = tuple[NDArray[np.float64], list[tuple[int, int, int]]]
"""Vertices (n, 3) in metres and triangles of a closed body."""
OVAL = (0.75, 1.0)
"""Half widths of a leaf at its two inner points, as shares of the greatest: broad near the tip."""
SWORD = (1.0, 0.8)
"""The same for a long leaf that is broad near its base."""


def joined(kind: str, bodies: Sequence[Body]) -> MeshShape:
    """Returns one mesh of several bodies."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in bodies)])
    faces = [[a + n, b + n, c + n] for n, (_, part) in zip(starts, bodies, strict=False) for a, b, c in part]
    return named_mesh(kind, np.vstack([vertices for vertices, _ in bodies]), faces)


def arch(base: Point, angle: float, reach: float, rise: float, droop: float = 0.0) -> list[Point]:
    """Returns four points of a leaf that leaves `base` steeply and bends outwards.

    The leaf ends `reach` away at the height `rise - droop` above its base; its third point is `rise` above the base.
    """
    heights = (0.0, 0.62 * rise, rise, rise - droop)
    return [
        (base[0] + share * reach * math.cos(angle), base[1] + share * reach * math.sin(angle), base[2] + z)
        for share, z in zip((0.0, 0.28, 0.68, 1.0), heights, strict=True)
    ]


def blade(path: Sequence[Point], width: float, shares: Sequence[float] = OVAL) -> Body:
    """Returns a leaf along a path from its base to its tip, with a ridge along its middle.

    `shares` has the half width at each inner point of the path as a share of 0.5 * `width`.
    """
    points = np.asarray(path, float)
    level = np.array([points[0, 1] - points[-1, 1], points[-1, 0] - points[0, 0], 0.0])
    side = level / np.linalg.norm(level) if np.linalg.norm(level) > 1e-4 else np.array([0.0, 1.0, 0.0])
    vertices = [points[0], points[-1]]
    for i, share in enumerate(shares, start=1):
        along = points[i + 1] - points[i - 1]
        up = np.cross(along, side)
        up *= 0.22 * share * width / np.linalg.norm(up)
        half = 0.5 * share * width * side
        vertices += [points[i] - half, points[i] + up, points[i] + half]
    last = 2 + 3 * (len(shares) - 1)
    faces = []
    for k in range(3):
        j = (k + 1) % 3
        faces += [(0, 2 + j, 2 + k), (1, last + k, last + j)]
        for start in range(2, last, 3):
            faces += [(start + k, start + j, start + 3 + j), (start + k, start + 3 + j, start + 3 + k)]
    return _outwards(np.array(vertices), faces)


def frond(path: Sequence[Point], leaflet: float) -> Body:
    """Returns a palm leaf: a row of narrow leaflets on both sides of a bent rib.

    Each leaflet is `leaflet` long, those at both ends shorter, and hangs by half its length.
    """
    points = np.asarray(path, float)
    level = np.array([points[0, 1] - points[-1, 1], points[-1, 0] - points[0, 0], 0.0])
    side = level / max(float(np.linalg.norm(level)), 1e-6)
    count = len(points) - 1
    vertices: list[NDArray[np.float64]] = []
    faces: list[tuple[int, int, int]] = []
    for i in range(1, count):
        along = points[i + 1] - points[i]
        long = leaflet * math.sin(math.pi * (i + 0.6) / (count + 0.8))
        for way in (-1, 1):
            tip = points[i] + long * (0.75 * way * side + 0.6 * along / np.linalg.norm(along)) - (0.0, 0.0, 0.5 * long)
            body, part = _outwards(
                np.array([points[i], points[i] + 0.85 * along, tip, points[i] + 0.4 * along + (0.0, 0.0, 0.012)]),
                [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
            )
            faces += [(a + len(vertices), b + len(vertices), c + len(vertices)) for a, b, c in part]
            vertices += list(body)
    return np.array(vertices), faces


def cut_leaf(at: Point, along: ArrayLike, outline: Sequence[tuple[float, float]], length: float) -> Body:
    """Returns a leaf with a given outline, star-shaped about (0.3, 0), from its stalk at `at`.

    Points at its side hang below the middle by a quarter of their distance from it.

    Args:
        at: where the stalk ends.
        along: direction of the leaf from the stalk to its tip.
        outline: points (share of the length along the leaf, share of the length to its left), counter-clockwise.
        length: length of the leaf.
    """
    axis = np.asarray(along, float) / np.linalg.norm(along)
    side = np.cross((0.0, 0.0, 1.0), axis)
    side /= np.linalg.norm(side)
    up = np.cross(axis, side)
    flat = np.asarray(outline)
    rim = [length * (u * axis + v * side - 0.25 * (abs(v) + 0.5 * max(0.0, u - 0.3)) * up) for u, v in flat]
    middle = length * 0.3 * axis
    vertices = np.array([*rim, middle + 0.02 * length * up, middle - 0.02 * length * up]) + np.asarray(at)
    return _outwards(vertices, _two_fans(len(rim)))


def blossom(at: Point, along: Point, radius: float, petals: int = 5) -> Body:
    """Returns an open flower of pointed petals around a cup, which faces the direction `along`."""
    axis = np.asarray(along, float) / np.linalg.norm(along)
    first = np.cross(axis, (0.36, 0.48, -0.8))
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    vertices = []
    for i in range(2 * petals):
        angle, far = math.pi * i / petals, radius * (1.0 if i % 2 == 0 else 0.45)
        rise = 0.35 * radius if i % 2 == 0 else 0.1 * radius
        vertices.append(far * (math.cos(angle) * first + math.sin(angle) * second) + rise * axis)
    vertices = np.array([*vertices, -0.05 * radius * axis, -0.7 * radius * axis]) + np.asarray(at)
    return _outwards(vertices, _two_fans(2 * petals))


def tube(path: Sequence[Point], radii: Sequence[float], segments: int = 6, *, groove: float = 1.0) -> Body:
    """Returns a stem along a path that is nowhere parallel to x; a last radius of 0 makes a pointed end.

    With `groove` < 1, every second edge of the stem has this share of the radius: the ribs of a cactus.
    """
    points, n = np.asarray(path, float), segments
    along = np.gradient(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    angles = np.arange(n) * (math.tau / n)
    shares = np.where(np.arange(n) % 2 == 0, 1.0, groove)
    vertices: list[NDArray[np.float64]] = []
    for point, axis, radius in zip(points, along, radii, strict=True):
        if radius == 0.0:
            vertices.append(point)
            continue
        first = np.array([1.0, 0.0, 0.0]) - axis[0] * axis
        first /= np.linalg.norm(first)
        second = np.cross(axis, first)
        around = np.outer(np.cos(angles), first) + np.outer(np.sin(angles), second)
        vertices += list(point + radius * shares[:, None] * around)
    rings, pointed = len(vertices) // n, len(vertices) % n == 1
    faces = []
    for i in range(n):
        j = (i + 1) % n
        for low in range(0, (rings - 1) * n, n):
            faces += [(low + i, low + j, low + n + j), (low + i, low + n + j, low + n + i)]
        if pointed:
            faces.append(((rings - 1) * n + i, (rings - 1) * n + j, rings * n))
    faces += [(0, i + 1, i) for i in range(1, n - 1)]
    if not pointed:
        top = (rings - 1) * n
        faces += [(top, top + i, top + i + 1) for i in range(1, n - 1)]
    return np.array(vertices), faces


def bush(at: Point, half: Point, rng: np.random.Generator, segments: int = 9) -> Body:
    """Returns a lump of foliage: an ellipsoid with these half axes and a surface that is uneven by a sixth."""
    vertices = [np.array([0.0, 0.0, -0.8])]
    for level in (-0.45, 0.1, 0.65):
        wide = math.sqrt(1.0 - level * level)
        for i in range(segments):
            a = math.tau * (i + 0.5 * (level == 0.1)) / segments
            far = rng.uniform(0.84, 1.14)
            vertices.append(far * np.array([wide * math.cos(a), wide * math.sin(a), level + rng.uniform(-0.1, 0.1)]))
    vertices.append(np.array([0.0, 0.0, 1.0]))
    n = segments
    faces = []
    for i in range(n):
        j = (i + 1) % n
        faces += [(0, 1 + j, 1 + i), (3 * n + 1, 2 * n + 1 + i, 2 * n + 1 + j)]
        for low in (1, 1 + n):
            faces += [(low + i, low + j, low + n + j), (low + i, low + n + j, low + n + i)]
    return np.asarray(at) + np.array(vertices) * np.asarray(half), faces


def _two_fans(n: int) -> list[tuple[int, int, int]]:
    """Returns the triangles between a rim of n vertices and the two that follow, one on either side of it."""
    faces = []
    for i in range(n):
        j = (i + 1) % n
        faces += [(i, j, n), (j, i, n + 1)]
    return faces


def _outwards(vertices: NDArray[np.float64], faces: list[tuple[int, int, int]]) -> Body:
    """Returns the body with triangles that face outwards, whichever way they were given."""
    a, b, c = (vertices[[face[i] for face in faces]] - vertices[0] for i in range(3))
    if np.einsum("ij,ij->", a, np.cross(b, c)) < 0:
        faces = [(x, z, y) for x, y, z in faces]
    return vertices, faces
