"""Pots, leaves and long blades, of which the plants of the pool `wide` are made."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from sim.homes.housegen.furniture.item import Look
from sim.homes.housegen.furniture.parts import BOTH_SIDES
from sim.homes.housegen.furniture.shapes import Leaf, Ring, foliage, frustum, loft, named_mesh
from sim.homes.housegen.furniture.workbench import Point, Workbench

Blade = tuple[Sequence[Point], float]
"""A long bent leaf: five points along its middle, and its width."""
_TAPER = (0.55, 0.95, 1.0, 0.7, 0.08)
"""Width of a blade at its five points, as shares of its greatest width."""
_BLADES_PER_MESH = 6
_LEAVES_PER_MESH = 14


def polar(radius: float, angle: float, z: float) -> Point:
    """Returns the point at this height, distance from the z axis and angle in radians."""
    return (radius * math.cos(angle), radius * math.sin(angle), z)


def shifted(point: Point, by: Point) -> Point:
    """Returns the sum of two points."""
    return (point[0] + by[0], point[1] + by[1], point[2] + by[2])


def curve(base: Point, angle: float, reach: float, up: float, end: float, steps: int = 5) -> list[Point]:
    """Returns an arc that rises from `base` towards the height `up` and ends `reach` away at the height `end`.

    Both heights are above the base.
    """
    points = []
    for t in np.linspace(0.0, 1.0, steps):
        out = 2 * t * (1 - t) * 0.3 * reach + t * t * reach
        points.append(shifted(base, polar(float(out), angle, float(2 * t * (1 - t) * up + t * t * end))))
    return points


def add_blades(w: Workbench, blades: Sequence[Blade], look: Look) -> None:
    """Adds long bent leaves, several in each mesh."""
    for start in range(0, len(blades), _BLADES_PER_MESH):
        meshes = [_blade_mesh(path, width) for path, width in blades[start : start + _BLADES_PER_MESH]]
        vertices = np.vstack([points for points, _ in meshes])
        faces = np.vstack([triangles + 15 * i for i, (_, triangles) in enumerate(meshes)])
        w.mesh(named_mesh("blades", vertices, faces.tolist()), (0.0, 0.0, 0.0), look, solid=False)


def add_leaves(w: Workbench, leaves: Sequence[Leaf], look: Look) -> None:
    """Adds short leaves, several in each mesh."""
    for start in range(0, len(leaves), _LEAVES_PER_MESH):
        w.mesh(foliage(leaves[start : start + _LEAVES_PER_MESH]), (0.0, 0.0, 0.0), look, solid=False)


def _blade_mesh(path: Sequence[Point], width: float) -> tuple[np.ndarray, np.ndarray]:
    """Returns the vertices (15, 3) and the triangles (n, 3) of a closed blade along five points."""
    points = np.asarray(path, float)
    along = np.gradient(points, axis=0)
    level = np.array([points[-1][1] - points[0][1], points[0][0] - points[-1][0], 0.0])
    side = level / np.linalg.norm(level) if np.linalg.norm(level) > 1e-6 else np.array([0.0, 1.0, 0.0])
    half = 0.5 * width * np.array(_TAPER)[:, None]
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
    if np.einsum("ij,ij->", a, np.cross(b, c)) < 0:  # the faces point inwards
        triangles = triangles[:, ::-1]
    return vertices, triangles


def soil(w: Workbench, z: float, radius: float) -> None:
    """Adds a thin disc of soil or pebbles around the height z."""
    look = w.look(w.choice(("soil", "soil", "stone")))
    w.cylinder((0.0, 0.0), (z - 0.004, z + 0.004), radius, look, solid=False)


def round_pot(w: Workbench, rings: Sequence[tuple[float, float]], look: Look, segments: int = 14) -> None:
    """Adds a pot of rings, each given by its height and radius, from the lowest to the highest."""
    w.mesh(loft([Ring(z, r, r) for z, r in rings], segments, hull=True), (0.0, 0.0, 0.0), look)


def planter(w: Workbench, radius: float, height: float) -> float:
    """Adds one of seven pots of about this size with soil, and returns the height of the soil."""
    add_pot = w.choice(_POTS)
    other = "wicker" if add_pot is _basket else "paint"
    look = w.look(w.choice(("pot", "pot", "ceramic", "masonry", other)))
    top = add_pot(w, radius, height, look)
    soil(w, top, 0.72 * radius)
    return top


def _rimmed_pot(w: Workbench, r: float, height: float, look: Look) -> float:
    """Adds a tapered pot with a rim, and returns its height, as all functions of `_POTS` do."""
    round_pot(w, [(0.0, 0.68 * r), (0.82 * height, 0.93 * r), (0.83 * height, r), (height, r)], look)
    return height


def _cylinder_on_saucer(w: Workbench, r: float, height: float, look: Look) -> float:
    w.cylinder((0.0, 0.0), (0.0, height), 0.92 * r, look)
    w.cylinder((0.0, 0.0), (0.0, 0.08 * height), 1.15 * r, w.look("dark"))
    return height


def _square_pot(w: Workbench, r: float, height: float, look: Look) -> float:
    bottom = w.length(1.1, 1.8)
    w.mesh(frustum((bottom * r, bottom * r), (1.8 * r, 1.8 * r), height), (0.0, 0.0, 0.0), look)
    return height


def _basket(w: Workbench, r: float, height: float, look: Look) -> float:
    """Adds a basket with two handles; it is always of wicker, but `look` is drawn for every pot."""
    wicker = w.look("wicker")
    rings = [(0.0, 0.75 * r), (0.3 * height, 1.05 * r), (0.6 * height, 1.08 * r), (height, 0.85 * r)]
    round_pot(w, rings, wicker)
    for side in BOTH_SIDES:
        lower, upper = (0.0, side * 0.9 * r, 0.9 * height), (0.0, side * 1.0 * r, 1.12 * height)
        w.bar(lower, upper, 0.012, 0.35 * r, wicker, solid=False)
    return height


def _pot_on_stand(w: Workbench, r: float, height: float, look: Look) -> float:
    lift = w.length(0.4, 1.1) * height
    wood = w.look(w.choice(("wood", "brass", "dark")))
    thick = 0.1 * r
    for i in range(4):
        angle = 0.25 * math.pi + 0.5 * math.pi * i
        w.rod(polar(1.05 * r, angle, 0.0), polar(1.0 * r, angle, lift + 0.5 * height), thick, wood)
        w.rod((0.0, 0.0, lift), polar(1.0 * r, angle, lift), 0.7 * thick, wood, solid=False)
    w.cylinder((0.0, 0.0), (lift, lift + height), 0.92 * r, look)
    return lift + height


def _faceted_pot(w: Workbench, r: float, height: float, look: Look) -> float:
    round_pot(w, [(0.0, 0.6 * r), (1.25 * height, r)], look, w.whole(5, 8))
    return 1.25 * height


def _belly_pot(w: Workbench, r: float, height: float, look: Look) -> float:
    rings = [(0.0, 0.45 * r), (0.1 * height, 0.75 * r), (0.45 * height, 1.1 * r), (0.8 * height, r)]
    round_pot(w, [*rings, (height, 0.85 * r)], look)
    return height


_POTS: tuple[Callable[[Workbench, float, float, Look], float], ...] = (
    _rimmed_pot,
    _cylinder_on_saucer,
    _square_pot,
    _basket,
    _pot_on_stand,
    _faceted_pot,
    _belly_pot,
)
