"""Light furniture that the robot can push: its collision geoms, its mass and its friction.

A movable looks like the static item and collides as the same few boxes (`sim.homes.housegen.mjcf.collision`), but its
collision geoms are only boxes, capsules and spheres: MuJoCo has exact contacts for pairs of these, while cylinders and
meshes in light contact sometimes get wrong normals and jump. Rods become capsules, upright round parts become octagons
of four boxes.

Masses: retail weights of dining chairs are 4.5-9 kg and of office chairs 9-18 kg (sizepedia.org, How much does a chair
weigh); the styles set their own. The mass of a plant is that of the soil in its pot: moist soilless potting mix has
0.3-0.5 kg per litre, and a decorative pot contains a smaller nursery pot. Friction: felt or nylon glides on a hard
floor have 0.2, bare pots 0.3 (polished wood 0.25-0.5, glazed 0.2-0.4), rolling castors 0.05.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from sim.homes.housegen.furniture.item import Geom, Item, MeshShape
from sim.homes.housegen.furniture.transforms import (
    bounds,
    euler_from_matrix,
    geom_bounds,
    matrix_from_euler,
    rounded_point,
)
from sim.homes.housegen.mjcf.collision import collision_boxes
from sim.homes.housegen.mjcf.triangles import facets, triangle_areas

MAX_PUSH_N = 20.0
"""Largest force that may be needed to push an item: the robot can exert 25 N. Heavier items stay static."""
GRAVITY_M_S2 = 9.81
GLIDES, POTTERY, CASTORS, RUBBER = 0.2, 0.3, 0.05, 0.4
"""Sliding friction of a movable's underside; it overrides the floor's."""
ROLLING_M = 0.01
"""Rolling friction of balls: a ball pushed to 0.5 m/s comes to rest within one or two metres."""
SOIL_KG_M3 = 350.0
PLANT_KG = (3.0, 6.5)
FOLIAGE_SHARE = 0.05
"""Mass of a square metre of a plant's stem and crown relative to one of its pot, which is full of soil."""
GYM_BALL_KG, MEDICINE_BALL_KG, LARGE_BALL_M = 1.2, 3.0, 0.2
"""A gymnastic ball weighs 0.9-1.4 kg, a medicine ball 1-5 kg; balls above the given radius are gymnastic balls."""
DUMBBELL_KG, ROLLER_KG = 3.0, 0.6
_ON_FLOOR_M = 0.02
_SLENDER = 1.8
"""A cylinder is a rod if its half length is at least this many radii."""
_OCTAGON = 0.96
"""Half width of the octagon that replaces a circle of radius 1: it is as much too wide as too narrow."""


@dataclass(frozen=True)
class Movable:
    """A body with a free joint, in the item's frame."""

    item: Item
    """Its appearance; its geoms do not collide."""
    collision_geoms: tuple[Geom, ...]
    """Geoms that collide and are not rendered."""
    mass_kg: float
    centre_m: tuple[float, float, float]
    """Centre of mass."""
    inertia_kg_m2: tuple[float, float, float, float, float, float]
    """About the centre of mass: xx, yy, zz, xy, xz, yz."""
    friction: float
    rolls: bool = False
    """Whether it needs rolling friction to come to rest."""
    offset_m: tuple[float, float] = (0.0, 0.0)
    """Position of its frame in the frame of the item that it was part of; both have the same orientation."""


def split_movable(item: Item) -> tuple[Item | None, tuple[Movable, ...]]:
    """Splits an item into the part that stays in place and the part that can be pushed.

    Returns:
        The static rest, None if nothing is left, and the movables; an item that is too heavy, is fixed to
        something or carries other items is all rest.
    """
    if item.mount != "floor" or item.children or item.walk_over or item.collision_geoms:
        return item, ()
    if item.category == "gym_equipment":
        return _light_parts(item)
    if item.category in ("chair", "stool") and item.mass_kg is not None:
        friction = CASTORS if _has_castors(item) else GLIDES
        made = as_movable(item, item.mass_kg, friction)
    elif item.category == "plant":
        made = as_movable(item, _plant_kg(item), POTTERY)
    else:
        return item, ()
    if made.friction * made.mass_kg * GRAVITY_M_S2 > MAX_PUSH_N:
        return item, ()
    return None, (made,)


def as_movable(item: Item, mass_kg: float, friction: float, *, rolls: bool = False) -> Movable:
    """Returns an item as a body of this mass and friction."""
    solid = [geom for geom in item.geoms if geom.solid and not _is_foliage(item, geom)]
    collision_geoms = [shape for geom in collision_boxes(solid, item) for shape in _exact_shapes(geom)]
    centre, inertia = _mass_properties(item, mass_kg)
    look = replace(item, geoms=tuple(replace(geom, solid=False) for geom in item.geoms))
    return Movable(look, tuple(collision_geoms), round(mass_kg, 2), centre, inertia, friction, rolls)


def _is_foliage(item: Item, geom: Geom) -> bool:
    """Returns whether a geom is a plant's stem or crown, which do not collide."""
    return item.category == "plant" and geom_bounds(geom)[0][2] >= _ON_FLOOR_M


# ---- collision geoms -------------------------------------------------------------------------------------------------


def _exact_shapes(geom: Geom) -> list[Geom]:
    """Returns boxes, capsules and spheres that replace one solid geom; the geom itself if it is one of these."""
    if geom.shape == "cylinder":
        radius, half = geom.size_m
        if half >= _SLENDER * radius:
            return [_capsule(geom, radius, half)]
        if abs(_axis(geom)[2]) > 0.99:
            return _octagon(geom, (0.0, 0.0, 0.0), (radius, radius, half))
        return [replace(geom, shape="box", size_m=(radius, radius, half))]
    if geom.shape == "ellipsoid":
        return [replace(geom, shape="box", size_m=tuple(round(0.8 * s, 4) for s in geom.size_m))]
    if geom.mesh is None:
        return [geom]
    if geom.mesh.name.startswith("loft") and abs(_axis(geom)[2]) > 0.99:
        return _layers(geom, geom.mesh)
    low, high = geom.mesh.vertices_m.min(axis=0), geom.mesh.vertices_m.max(axis=0)
    return [_box(geom, 0.5 * (low + high), 0.5 * (high - low))]


def _capsule(rod: Geom, radius: float, half: float) -> Geom:
    """Returns a capsule as long as a rod; the tip of a capsule that stands on the floor touches the floor."""
    axis, centre = _axis(rod), np.asarray(rod.pos_m)
    up = axis if axis[2] >= 0 else -axis
    low, high = centre - (half - radius) * up, centre + (half - radius) * up
    if geom_bounds(rod)[0][2] < 0.5 * _ON_FLOOR_M and up[2] > 0.5:
        low = low + up * (radius - low[2]) / up[2]
    middle, length = 0.5 * (low + high), float(np.linalg.norm(high - low))
    return replace(rod, shape="capsule", size_m=(radius, round(0.5 * length, 4)), pos_m=rounded_point(middle))


def _layers(geom: Geom, mesh: MeshShape) -> list[Geom]:
    """Returns an upright round mesh as one octagon, a high one as two, each as wide as its widest ring."""
    vertices = mesh.vertices_m
    low, high = float(vertices[:, 2].min()), float(vertices[:, 2].max())
    cuts = [low, 0.5 * (low + high), high] if high - low > 0.12 else [low, high]
    shapes: list[Geom] = []
    for z0, z1 in itertools.pairwise(cuts):
        ring = vertices[(vertices[:, 2] >= z0 - 1e-6) & (vertices[:, 2] <= z1 + 1e-6)]
        middle = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
        half = 0.5 * np.ptp(ring, axis=0)
        at = (float(middle[0]), float(middle[1]), 0.5 * (z0 + z1))
        shapes += _octagon(geom, at, (float(half[0]), float(half[1]), 0.5 * (z1 - z0)))
    return shapes


def _octagon(geom: Geom, at: tuple[float, float, float], half: tuple[float, float, float]) -> list[Geom]:
    """Returns four boxes through the axis; their union is an octagonal prism with half sizes `half`."""
    rx, ry, hz = half
    long, short = _OCTAGON, _OCTAGON * math.tan(math.pi / 8)
    boxes = [
        _box(geom, np.array(at), np.array([long * rx, short * ry, hz])),
        _box(geom, np.array(at), np.array([short * rx, long * ry, hz])),
    ]
    mean = 0.5 * (rx + ry)
    for turn in (math.pi / 4, -math.pi / 4):
        rotation = matrix_from_euler(0.0, 0.0, turn)
        boxes.append(_box(geom, np.array(at), np.array([long * mean, short * mean, hz]), rotation))
    return boxes


def _box(geom: Geom, middle: NDArray, half: NDArray, turn: NDArray | None = None) -> Geom:
    """Returns a box, given in the frame of a geom, that replaces the geom."""
    rotation = matrix_from_euler(*geom.euler_rad)
    at = np.asarray(geom.pos_m) + rotation @ middle
    size = tuple(round(float(max(h, 0.002)), 4) for h in half)
    euler = euler_from_matrix(rotation if turn is None else rotation @ turn)
    return replace(geom, shape="box", mesh=None, size_m=size, pos_m=rounded_point(at), euler_rad=euler)


# ---- mass ------------------------------------------------------------------------------------------------------------


def _plant_kg(item: Item) -> float:
    """Returns the mass of soil that the pot's bounding box could hold, limited to the soil in a nursery pot."""
    pot = [geom for geom in item.geoms if geom.solid and geom_bounds(geom)[0][2] < _ON_FLOOR_M]
    low, high = bounds(pot)
    return float(np.clip(SOIL_KG_M3 * 0.6 * np.prod(high - low), *PLANT_KG))


def _mass_properties(
    item: Item, mass_kg: float
) -> tuple[tuple[float, float, float], tuple[float, float, float, float, float, float]]:
    """Returns centre of mass and inertia of a mass that is spread over the surfaces of the solid geoms.

    Furniture is made of boards, tubes and shells: their mass depends on their area rather than on their volume. The
    midpoints of a triangle's edges, each with a third of its mass, have its exact first and second moments.
    """
    points, weights = [], []
    for geom in item.geoms:
        if not geom.solid:
            continue
        corners, faces = facets(geom)
        world = np.asarray(geom.pos_m) + corners @ matrix_from_euler(*geom.euler_rad).T
        a, b, c = (world[faces[:, k]] for k in range(3))
        points += [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)]
        weights += [triangle_areas(world[faces]) * (FOLIAGE_SHARE if _is_foliage(item, geom) else 1.0)] * 3
    at, share = np.vstack(points), np.concatenate(weights)
    mass = mass_kg * share / share.sum()
    centre = mass @ at / mass_kg
    x, y, z = (at - centre).T
    moments = (y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z)
    xx, yy, zz, xy, xz, yz = (round(float(mass @ m), 5) + 0.0 for m in moments)
    return rounded_point(centre), (xx, yy, zz, xy, xz, yz)


# ---- gym equipment ---------------------------------------------------------------------------------------------------


def _light_parts(item: Item) -> tuple[Item | None, tuple[Movable, ...]]:
    """Splits off balls, dumbbells and rollers that lie separately on the floor, each as a movable of its own."""
    rest: list[Geom] = []
    made: list[Movable] = []
    for part in _separate(item.geoms):
        mass_kg = _light_kg(part)
        if mass_kg is None:
            rest += part
            continue
        rolls = part[0].shape == "sphere" or len(part) == 1
        low, high = bounds(part)
        x, y, _ = rounded_point(0.5 * (low + high))
        moved = tuple(replace(geom, pos_m=rounded_point(np.subtract(geom.pos_m, (x, y, 0.0)))) for geom in part)
        alone = replace(item, geoms=moved, size_m=rounded_point(high - low), surfaces=())
        made.append(replace(as_movable(alone, mass_kg, RUBBER, rolls=rolls), offset_m=(x, y)))
    return (replace(item, geoms=tuple(rest)) if rest else None), tuple(made)


def _light_kg(part: Sequence[Geom]) -> float | None:
    """Returns the mass of a ball, a foam roller or a dumbbell on the floor; None for anything else."""
    if bounds(part)[0][2] > _ON_FLOOR_M or not all(geom.solid for geom in part):
        return None
    if len(part) == 1 and part[0].shape == "sphere":
        return GYM_BALL_KG if part[0].size_m[0] > LARGE_BALL_M else MEDICINE_BALL_KG
    lying = [geom.shape == "cylinder" and abs(_axis(geom)[2]) < 0.1 for geom in part]
    if all(lying):
        return ROLLER_KG if len(part) == 1 else DUMBBELL_KG
    return None


def _separate(geoms: Sequence[Geom]) -> list[list[Geom]]:
    """Returns groups of geoms with boxes that touch, in the order of their first geoms."""
    low, high = np.swapaxes([geom_bounds(geom) for geom in geoms], 0, 1)
    touching = (np.maximum(low[:, None], low) <= np.minimum(high[:, None], high) + 0.002).all(axis=2)
    count, group = connected_components(touching)
    return [[geom for geom, g in zip(geoms, group, strict=True) if g == number] for number in range(count)]


def _has_castors(item: Item) -> bool:
    """Returns whether an item rolls on balls at the floor."""
    return any(geom.shape == "sphere" and geom_bounds(geom)[0][2] < _ON_FLOOR_M for geom in item.geoms)


def _axis(geom: Geom) -> NDArray[np.float64]:
    """Returns the direction (3,) of a geom's local z in the item frame."""
    return matrix_from_euler(*geom.euler_rad)[:, 2]
