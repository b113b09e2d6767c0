"""Places where a STOP succeeds: near a point of the goal's footprint in free line of sight (docs/task.md).

One function, `GoalRegion.satisfied`, computes both the mask of places to which distances are measured and the test at
STOP. It uses the boundary of a footprint only: a line to a point inside it crosses the boundary at a point that is
nearer and in sight too. A robot inside the footprint (under a table) is at the goal. Distance, height of the line of
sight and storey are those of one `SuccessRule`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.convex import ConvexPolygon, PolygonTable, lines_blocked, polygon_from_above
from sim.core.interface import MPCAT40_ID, SuccessRule
from sim.core.store import kept, key_of
from sim.gl import mujoco
from sim.houses.geoms import geom_polytope, geoms_between, is_hollow, mesh_triangles
from sim.houses.labels import Instance, Labels, rendered_geoms
from sim.task.footprints import Floor, Footprint, Footprints, house_floors
from sim.world.freespace import FreeSpace

SIGHT_BLOCKERS = ("wall", "door", "window")
"""Categories that block the line of sight."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Geometry that does not depend on the goal: all footprints, and the obstacles that block sight on one storey."""

    footprints: Footprints
    blockers: tuple[ConvexPolygon, ...]

    @classmethod
    def of(
        cls,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        labels: Labels,
        *,
        sight_height_m: float,
        floor_z_m: float = 0.0,
        key: str | None = None,
    ) -> Surroundings:
        """Returns the surroundings of one storey; kinematics of `data` must be computed.

        Args:
            model: compiled world.
            data: its state.
            labels: category and instance of each geom.
            sight_height_m: height of the line of sight above the floor.
            floor_z_m: height of the storey's floor.
            key: names the world and its state; the result is then kept in the user's cache (`sim.core.store`).
        """

        def make() -> tuple[tuple[Floor, ...], PolygonTable]:
            blockers = sight_blockers(model, data, labels, floor_z_m + sight_height_m)
            return house_floors(model, data, labels), PolygonTable.of(blockers)

        parts = None if key is None else key_of("surroundings", key, sight_height_m, floor_z_m)
        floors, blockers = kept(parts, tuple[tuple[Floor, ...], PolygonTable], make)
        return cls(Footprints(model, floors), blockers.polygons)


class GoalRegion:
    """All places of one storey at which a STOP for one goal succeeds, with objects where they are now."""

    def __init__(
        self,
        data: mujoco.MjData,
        instances: Sequence[Instance],
        goal: str,
        *,
        surroundings: Surroundings,
        success: SuccessRule,
        floor_z_m: float = 0.0,
    ) -> None:
        """Computes the footprints of the instances of a goal; kinematics of `data` must be computed.

        Args:
            data: state of the compiled world.
            instances: all objects of the house that satisfy the goal.
            goal: the goal, for messages.
            surroundings: of the same storey.
            success: when a STOP succeeds; the height of its line of sight is that of `surroundings`.
            floor_z_m: height of the storey's floor.
        """
        self.goal = goal
        self.distance_m = success.distance_m
        self._blockers = surroundings.blockers
        everywhere = [surroundings.footprints.of(data, instance) for instance in instances]
        self.exists = any(footprint is not None for footprint in everywhere)
        """True: some storey of the house has an instance."""
        self.footprints = tuple(
            footprint
            for footprint in everywhere
            if footprint is not None and abs(footprint.floor_z_m - floor_z_m) < success.same_storey_m
        )

    def succeeds(self, x_m: float, y_m: float) -> bool:
        """Returns whether a STOP at this place of the storey succeeds."""
        return bool(self.satisfied(np.array([[x_m, y_m]], dtype=np.float64))[0])

    def nearest_m(self, x_m: float, y_m: float) -> float | None:
        """Returns the metres in plan to the nearest footprint, walls ignored; None if the storey has none."""
        here = np.array([[x_m, y_m]], dtype=np.float64)
        distances = [
            0.0 if footprint.contains(here)[0] else float(footprint.boundary_m.query(here)[0][0])
            for footprint in self.footprints
        ]
        return min(distances, default=None)

    def satisfied(self, xy_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Returns (n,) whether a STOP succeeds at each of the places (n, 2)."""
        satisfied = np.zeros(len(xy_m), dtype=np.bool_)
        for footprint in self.footprints:
            near = np.flatnonzero(~satisfied & footprint.near(xy_m, self.distance_m))
            if near.size:
                satisfied[near] = self.reaches(footprint, xy_m[near])
        return satisfied

    def mask(self, space: FreeSpace) -> NDArray[np.bool_]:
        """Returns (rows, cols) the free cells at whose centre a STOP succeeds."""
        candidates = np.zeros(space.frame.shape, dtype=np.bool_)
        for footprint in self.footprints:
            candidates[space.frame.index_of(footprint.bounds_m, self.distance_m)] = True
        cells = np.argwhere(candidates & space.free)
        mask = np.zeros(space.frame.shape, dtype=np.bool_)
        mask[tuple(cells.T)] = self.satisfied(space.frame.to_metres(cells))
        return mask

    def reaches(self, footprint: Footprint, xy_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Returns (n,) whether some point of the footprint is near enough and in sight from each place (n, 2)."""
        x0, y0, x1, y1 = footprint.bounds_m
        r = self.distance_m
        blockers = [b for b in self._blockers if _overlap(b.bounds_m, (x0 - r, y0 - r, x1 + r, y1 + r))]
        points = footprint.boundary_m.data
        distance, nearest = footprint.boundary_m.query(xy_m, distance_upper_bound=r * (1.0 + 1e-12))
        reached = footprint.contains(xy_m)
        within = np.flatnonzero(~reached & np.isfinite(distance))
        reached[within] = ~lines_blocked(xy_m[within], points[np.asarray(nearest)[within]], blockers)
        for hidden in _chunks(_not_hidden(within[~reached[within]], xy_m, footprint.bounds_m, blockers)):
            place, point = np.nonzero(_distances(xy_m[hidden], points) <= r)
            seen = ~lines_blocked(xy_m[hidden][place], points[point], blockers)
            reached[hidden[place[seen]]] = True
        return reached

    def sees(self, footprint: Footprint, xy_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Returns (n,) whether the nearest point of a footprint is in sight from each place (n, 2), at any distance."""
        nearest = footprint.boundary_m.query(xy_m)[1]
        return ~lines_blocked(xy_m, footprint.boundary_m.data[nearest], self._blockers)


def sight_blockers(
    model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, height_m: float
) -> tuple[ConvexPolygon, ...]:
    """Returns the cross sections, at a height, of the rendered geoms that block the line of sight."""
    opaque = np.isin(labels.geom_category, [MPCAT40_ID[name] for name in SIGHT_BLOCKERS]) & rendered_geoms(model)
    sections: list[ConvexPolygon | None] = []
    for geom in geoms_between(model, data, np.flatnonzero(opaque), height_m, height_m).tolist():
        if is_hollow(model, geom):
            sections += _mesh_section(mesh_triangles(model, data, geom), height_m)
        else:
            body = geom_polytope(model, data, geom, rendered=True)
            sections.append(polygon_from_above(body, height_m, height_m))
    return tuple(section for section in sections if section is not None)


def _mesh_section(triangles_m: NDArray[np.float64], height_m: float) -> list[ConvexPolygon | None]:
    """Returns thin strips along the lines in which triangles (n, 3, 3) of a mesh meet a horizontal plane."""
    z = triangles_m[..., 2] - height_m
    sections = []
    for corners, above in zip(triangles_m, z >= 0.0, strict=True):
        if above.all() or not above.any():
            continue
        ends = []
        for a, b in ((0, 1), (1, 2), (2, 0)):
            if above[a] != above[b]:
                t = (height_m - corners[a, 2]) / (corners[b, 2] - corners[a, 2])
                ends.append(corners[a, :2] + t * (corners[b, :2] - corners[a, :2]))
        along = ends[1] - ends[0]
        length = float(np.hypot(*along))
        if length > 1e-6:
            across = np.array([-along[1], along[0]]) * (0.001 / length)
            sections.append(ConvexPolygon.around(np.array([e + s * across for e in ends for s in (-1.0, 1.0)])))
    return sections


def _not_hidden(
    places: NDArray[np.int64],
    xy_m: NDArray[np.float64],
    bounds_m: tuple[float, float, float, float],
    blockers: Sequence[ConvexPolygon],
) -> NDArray[np.int64]:
    """Returns the places, indices of points (n, 2), from which no single blocker hides a whole rectangle.

    The region that a convex blocker hides from one place is convex, so a rectangle is hidden if its four corners are.
    """
    x0, y0, x1, y1 = bounds_m
    for blocker in blockers:
        hidden = np.ones(len(places), dtype=np.bool_)
        for corner in ((x0, y0), (x1, y0), (x1, y1), (x0, y1)):
            remaining = np.flatnonzero(hidden)
            ends = np.broadcast_to(np.array(corner), (len(remaining), 2))
            hidden[remaining] = lines_blocked(xy_m[places[remaining]], ends, (blocker,))
        places = places[~hidden]
    return places


def _overlap(a: Sequence[float], b: Sequence[float]) -> bool:
    return a[0] <= b[2] and a[2] >= b[0] and a[1] <= b[3] and a[3] >= b[1]


def _distances(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns (n, m) metres between points (n, 2) and (m, 2)."""
    return np.hypot(a[:, None, 0] - b[None, :, 0], a[:, None, 1] - b[None, :, 1])


def _chunks(indices: NDArray[np.int64]) -> Iterator[NDArray[np.int64]]:
    """Yields the indices in pieces, so that tables of all pairs stay in the processor's cache."""
    for start in range(0, len(indices), 2048):
        yield indices[start : start + 2048]
