"""Convex polytopes and polygons: plan projections between two heights, and line segments that polygons block.

The projection of a convex polytope between two heights is the convex hull of the vertices in between and of the points
where edges cross the two heights. `sim.houses.geoms` makes polytopes of MuJoCo geoms.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Bool, Float64, Int64

MIN_CROSSING_M = 0.001
"""A segment crosses a polygon when the part inside is longer than this; touching the boundary is not enough."""
JOINT_M = 1e-6
"""Polygons are grown by this much for segments, so that none passes between two adjacent polygons."""
_MIN_AREA_M2 = 1e-8
_MIN_EDGE_M = 1e-7


class Polytope(NamedTuple):
    """A convex polytope in the world."""

    vertices_m: Float64[np.ndarray, "n 3"]
    edges: Int64[np.ndarray, "m 2"]
    """Indices of vertices."""


@dataclass(frozen=True, eq=False)
class ConvexPolygon:
    """A convex polygon in plan: vertices counter-clockwise, and the half planes `normals @ p <= offsets`."""

    vertices_m: Float64[np.ndarray, "k 2"]
    normals: Float64[np.ndarray, "k 2"]
    """Outward, of length 1."""
    offsets_m: Float64[np.ndarray, " k"]
    bounds_m: tuple[float, float, float, float]
    """Smallest x and y, largest x and y."""

    @classmethod
    def around(cls, points_m: Float64[np.ndarray, "n 2"]) -> ConvexPolygon | None:
        """Returns the convex hull of points; None when it has no area."""
        if len(points_m) < 3:
            return None
        middle = points_m[0]
        hull = cv2.convexHull((points_m - middle).astype(np.float32))[:, 0].astype(np.float64)
        return cls.of_corners(hull + middle)

    @classmethod
    def of_corners(cls, corners_m: Float64[np.ndarray, "k 2"]) -> ConvexPolygon | None:
        """Returns the polygon with these corners, in either orientation; None when it has no area."""
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

    def contains(self, xy_m: Float64[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
        """Returns True for the points that lie in the polygon or on its edge."""
        return np.all(xy_m @ self.normals.T <= self.offsets_m + 1e-9, axis=1)

    def distance(self, xy_m: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, " n"]:
        """Returns the distances in metres from the points to the polygon; 0 inside."""
        along = np.roll(self.vertices_m, -1, axis=0) - self.vertices_m
        nearest_sq = np.full(len(xy_m), np.inf)
        for start, edge in zip(self.vertices_m, along, strict=True):
            offset = xy_m - start
            t = np.clip(offset @ edge / (edge @ edge), 0.0, 1.0)
            offset -= t[:, None] * edge
            np.minimum(nearest_sq, np.einsum("ij,ij->i", offset, offset), out=nearest_sq)
        nearest_sq[self.contains(xy_m)] = 0.0
        return np.sqrt(nearest_sq)

    def crossed_by(
        self, start_m: Float64[np.ndarray, "n 2"], end_m: Float64[np.ndarray, "n 2"]
    ) -> Bool[np.ndarray, " n"]:
        """Returns True for the segments from start to end that cross the polygon (Cyrus-Beck clipping)."""
        step = end_m - start_m
        entry, leave = np.zeros(len(step)), np.ones(len(step))
        for normal, offset in zip(self.normals, self.offsets_m, strict=True):
            depth_m, slope = offset + JOINT_M - start_m @ normal, step @ normal
            outward, inward = slope > 1e-12, slope < -1e-12
            t = depth_m / np.where(outward | inward, slope, 1.0)
            leave = np.where(outward, np.minimum(leave, t), leave)
            entry = np.where(inward, np.maximum(entry, t), entry)
            leave = np.where(~(outward | inward) & (depth_m < 0.0), -1.0, leave)
        return (leave - entry) * np.linalg.norm(step, axis=1) > MIN_CROSSING_M


@dataclass(frozen=True, eq=False)
class PolygonTable:
    """Polygons in a few arrays, as which they are kept: thousands of small arrays take long to read."""

    corners_m: Float64[np.ndarray, "n 2"]
    normals: Float64[np.ndarray, "n 2"]
    offsets_m: Float64[np.ndarray, " n"]
    bounds_m: Float64[np.ndarray, "k 4"]
    ends: Int64[np.ndarray, " k"]
    """Index after the last corner of each polygon."""

    @classmethod
    def of(cls, polygons: Sequence[ConvexPolygon]) -> PolygonTable:
        """Returns the table of some polygons."""
        empty = np.zeros((0, 2))
        return cls(
            np.concatenate([empty, *(polygon.vertices_m for polygon in polygons)]),
            np.concatenate([empty, *(polygon.normals for polygon in polygons)]),
            np.concatenate([empty[:, 0], *(polygon.offsets_m for polygon in polygons)]),
            np.array([polygon.bounds_m for polygon in polygons], np.float64).reshape(-1, 4),
            np.cumsum([len(polygon.vertices_m) for polygon in polygons], dtype=np.int64),
        )

    @functools.cached_property
    def polygons(self) -> tuple[ConvexPolygon, ...]:
        """The polygons, in their order."""
        ends, bounds = self.ends.tolist(), self.bounds_m.tolist()
        return tuple(
            ConvexPolygon(self.corners_m[i:j], self.normals[i:j], self.offsets_m[i:j], (x0, y0, x1, y1))
            for i, j, (x0, y0, x1, y1) in zip([0, *ends], ends, bounds, strict=False)
        )


def polygon_from_above(body: Polytope, low_m: float = -math.inf, high_m: float = math.inf) -> ConvexPolygon | None:
    """Returns the plan projection of the part of a body between two heights, which may be equal; None if empty."""
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


def lines_blocked(
    start_m: Float64[np.ndarray, "n 2"], end_m: Float64[np.ndarray, "n 2"], polygons: Iterable[ConvexPolygon]
) -> Bool[np.ndarray, " n"]:
    """Returns True for the segments from start to end that cross at least one polygon."""
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
