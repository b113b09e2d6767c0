"""Pots, leaves and blades, of which the plants of the pool `wide` are made."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sim.housegen.furniture.item import Look, MeshShape
from sim.housegen.furniture.shapes import Leaf, Ring, foliage, frustum, loft, named_mesh
from sim.housegen.furniture.workbench import Point, Workbench


def polar(radius: float, angle: float, z: float) -> Point:
    return (radius * math.cos(angle), radius * math.sin(angle), z)


def shifted(point: Point, by: Point) -> Point:
    return (point[0] + by[0], point[1] + by[1], point[2] + by[2])


def curve(base: Point, angle: float, reach: float, up: float, end: float, steps: int = 5) -> list[Point]:
    """An arc from `base` that rises towards `up` and ends `reach` away at the height `end`, both above the base."""
    points = []
    for t in np.linspace(0.0, 1.0, steps):
        out = 2 * t * (1 - t) * 0.3 * reach + t * t * reach
        points.append(shifted(base, polar(float(out), angle, float(2 * t * (1 - t) * up + t * t * end))))
    return points


def blade(path: Sequence[Point], width: float) -> tuple[np.ndarray, np.ndarray]:
    points = np.asarray(path, float)
    along = np.gradient(points, axis=0)
    level = np.array([points[-1][1] - points[0][1], points[0][0] - points[-1][0], 0.0])
    side = level / np.linalg.norm(level) if np.linalg.norm(level) > 1e-6 else np.array([0.0, 1.0, 0.0])
    half = 0.5 * width * np.array(TAPER)[:, None]
    below = np.cross(along, side)
    below /= np.linalg.norm(below, axis=1, keepdims=True)
    deep = np.maximum(0.5 * half, 0.0012)
    vertices = np.stack([points - half * side, points + deep * below, points + half * side], axis=1).reshape(-1, 3)
    faces = [(0, 1, 2), (12, 14, 13)]
    for k in range(0, 12, 3):
        for i in range(3):
            a, b = k + i, k + (i + 1) % 3
            faces += [(a, a + 3, b + 3), (a, b + 3, b)]
    triangles = np.array(faces)
    a, b, c = (vertices[triangles[:, i]] - points[0] for i in range(3))
    if np.einsum("ij,ij->", a, np.cross(b, c)) < 0:
        triangles = triangles[:, ::-1]
    return vertices, triangles


def blades(w: Workbench, blades: Sequence[Blade], look: Look) -> None:
    """Long bent leaves, five points each, six to a mesh."""
    for start in range(0, len(blades), 6):
        made = [blade(path, width) for path, width in blades[start : start + 6]]
        vertices = np.vstack([v for v, _ in made])
        faces = np.vstack([f + 15 * i for i, (_, f) in enumerate(made)])
        w.mesh(named_mesh("blades", vertices, faces.tolist()), (0.0, 0.0, 0.0), look, solid=False)


def leaves(w: Workbench, leaves: Sequence[Leaf], look: Look) -> None:
    """Short leaves, fourteen to a mesh."""
    for start in range(0, len(leaves), 14):
        w.mesh(foliage(leaves[start : start + 14]), (0.0, 0.0, 0.0), look, solid=False)


def soil(w: Workbench, z: float, r: float) -> None:
    look = w.look(w.choice(("soil", "soil", "stone")))
    w.cylinder((0.0, 0.0), (z - 0.004, z + 0.004), r, look, solid=False)


def round(w: Workbench, rings: Sequence[tuple[float, float]], look: Look, segments: int = 14) -> None:
    skin: MeshShape = loft([Ring(z, r, r) for z, r in rings], segments, hull=True)
    w.mesh(skin, (0.0, 0.0, 0.0), look)


def planter(w: Workbench, r: float, high: float) -> float:
    """One of seven pots of about this radius and height; the height of its soil."""
    kind = w.whole(0, 6)
    look = w.look(w.choice(("pot", "pot", "ceramic", "masonry", "wicker" if kind == 3 else "paint")))
    z = 0.0
    if kind == 0:
        round(w, [(0.0, 0.68 * r), (0.82 * high, 0.93 * r), (0.83 * high, r), (high, r)], look)
    elif kind == 1:
        w.cylinder((0.0, 0.0), (0.0, high), 0.92 * r, look)
        w.cylinder((0.0, 0.0), (0.0, 0.08 * high), 1.15 * r, w.look("dark"))
    elif kind == 2:
        low = w.length(1.1, 1.8)
        w.mesh(frustum((low * r, low * r), (1.8 * r, 1.8 * r), high), (0.0, 0.0, 0.0), look)
    elif kind == 3:
        basket = w.look("wicker")
        round(w, [(0.0, 0.75 * r), (0.3 * high, 1.05 * r), (0.6 * high, 1.08 * r), (high, 0.85 * r)], basket)
        for side in BOTH:
            y = side * 0.9 * r
            w.bar((0.0, y, 0.9 * high), (0.0, side * 1.0 * r, 1.12 * high), 0.012, 0.35 * r, basket, solid=False)
    elif kind == 4:
        lift = w.length(0.4, 1.1) * high
        wood = w.look(w.choice(("wood", "brass", "dark")))
        thick = 0.1 * r
        for i in range(4):
            angle = 0.25 * math.pi + 0.5 * math.pi * i
            w.rod(polar(1.05 * r, angle, 0.0), polar(1.0 * r, angle, lift + 0.5 * high), thick, wood)
            w.rod((0.0, 0.0, lift), polar(1.0 * r, angle, lift), 0.7 * thick, wood, solid=False)
        w.cylinder((0.0, 0.0), (lift, lift + high), 0.92 * r, look)
        z = lift
    elif kind == 5:
        high *= 1.25
        round(w, [(0.0, 0.6 * r), (high, r)], look, w.whole(5, 8))
    else:
        round(
            w,
            [(0.0, 0.45 * r), (0.1 * high, 0.75 * r), (0.45 * high, 1.1 * r), (0.8 * high, r), (high, 0.85 * r)],
            look,
        )
    soil(w, z + high, 0.72 * r)
    return z + high


Blade = tuple[Sequence[Point], float]


BOTH = (-1, 1)


TAPER = (0.55, 0.95, 1.0, 0.7, 0.08)
