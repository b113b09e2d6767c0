"""Rotations and bounding boxes of geoms and of whole items."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.homes.housegen.furniture.item import Child, Geom


def matrix_from_euler(x_rad: float, y_rad: float, z_rad: float) -> NDArray[np.float64]:
    """Returns the (3, 3) matrix of intrinsic rotations about x, y, z in this order, MuJoCo's default `eulerseq`."""
    cx, cy, cz = math.cos(x_rad), math.cos(y_rad), math.cos(z_rad)
    sx, sy, sz = math.sin(x_rad), math.sin(y_rad), math.sin(z_rad)
    return np.array(
        [
            [cy * cz, -cy * sz, sy],
            [cx * sz + sx * sy * cz, cx * cz - sx * sy * sz, -sx * cy],
            [sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy],
        ]
    )


def roll_tilt_turn(roll_rad: float, tilt_rad: float, turn_rad: float) -> NDArray[np.float64]:
    """Returns the (3, 3) matrix of a rotation about x, then the new y, then the item's vertical axis."""
    return matrix_from_euler(0.0, 0.0, turn_rad) @ matrix_from_euler(roll_rad, tilt_rad, 0.0)


def rounded_point(point: Sequence[float] | NDArray) -> tuple[float, float, float]:
    """Returns a position rounded to 0.1 mm, without negative zeros."""
    x, y, z = (round(float(v), 4) + 0.0 for v in point)
    return x, y, z


def euler_from_matrix(rotation: NDArray) -> tuple[float, float, float]:
    """Returns the angles that `matrix_from_euler` takes, rounded to 1e-4 rad."""
    y = math.asin(max(-1.0, min(1.0, float(rotation[0, 2]))))
    if abs(rotation[0, 2]) > 1.0 - 1e-9:
        x, z = math.atan2(rotation[2, 1], rotation[1, 1]), 0.0
    else:
        x, z = math.atan2(-rotation[1, 2], rotation[2, 2]), math.atan2(-rotation[0, 1], rotation[0, 0])
    return (round(x, 4) + 0.0, round(y, 4) + 0.0, round(z, 4) + 0.0)


def bounds(geoms: Sequence[Geom], children: Sequence[Child] = ()) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and highest corner (3,) of the axis-aligned box around geoms and children in their frame."""
    lows, highs = [], []
    for geom in geoms:
        low, high = geom_bounds(geom)
        lows.append(low)
        highs.append(high)
    for child in children:
        geoms = [rotated(g, child.yaw_rad) for g in child.item.geoms]
        low, high = bounds(geoms, [_rotated_child(c, child.yaw_rad) for c in child.item.children])
        lows.append(low + child.pos_m)
        highs.append(high + child.pos_m)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def geom_bounds(geom: Geom) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the lowest and highest corner (3,) of a geom in the item frame."""
    rotation = matrix_from_euler(*geom.euler_rad)
    centre = np.asarray(geom.pos_m)
    if geom.mesh is not None:
        points = geom.mesh.vertices_m @ rotation.T + centre
        return points.min(axis=0), points.max(axis=0)
    half = _half_extent(geom, rotation)
    return centre - half, centre + half


def _half_extent(geom: Geom, rotation: NDArray) -> NDArray[np.float64]:
    """Returns half the size (3,) of the axis-aligned box around a primitive geom."""
    size = geom.size_m
    if geom.shape == "box":
        return np.abs(rotation) @ np.asarray(size)
    if geom.shape == "ellipsoid":
        return np.sqrt((rotation**2) @ (np.asarray(size) ** 2))
    if geom.shape == "sphere":
        return np.full(3, size[0])
    axis = np.abs(rotation[:, 2])
    if geom.shape == "capsule":
        return size[1] * axis + size[0]
    return size[1] * axis + size[0] * np.sqrt(np.maximum(0.0, 1.0 - axis**2))


def rotated(geom: Geom, yaw_rad: float) -> Geom:
    """Returns a geom turned about the vertical axis of its frame."""
    turn = matrix_from_euler(0.0, 0.0, yaw_rad)
    euler = euler_from_matrix(turn @ matrix_from_euler(*geom.euler_rad))
    return dataclasses.replace(geom, pos_m=tuple(turn @ geom.pos_m), euler_rad=euler)


def _rotated_child(child: Child, yaw_rad: float) -> Child:
    turn = matrix_from_euler(0.0, 0.0, yaw_rad)
    return dataclasses.replace(child, pos_m=tuple(turn @ child.pos_m), yaw_rad=child.yaw_rad + yaw_rad)
