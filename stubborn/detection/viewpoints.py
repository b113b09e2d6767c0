"""Viewpoints: reachable cells from which a STOP at a candidate counts, or from which it can at least be verified.

A STOP counts where some point of the object is within the success distance of the robot *and* in free line of sight. A
surface at the camera's height may be a wall and hide the object; a table or a sofa in between does not matter.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

from sim.core.geometry.pose import Pose
from stubborn.detection.distances import StopDistances
from stubborn.mapping.masks import NearestCells, sight_is_clear
from stubborn.mapping.navmap import CollisionLayer, NavMap
from stubborn.planning.planner import FreeSpace, Planner


class LastResort(enum.Enum):
    """The use of the nearest reachable place to a candidate that has no viewpoint."""

    NONE = enum.auto()
    """The candidate is ignored."""
    VERIFY = enum.auto()
    """The candidate is verified from that place."""
    STOP = enum.auto()
    """The agent stops at that place."""


@dataclass(frozen=True)
class Viewpoints:
    """Reachable cells to look at a candidate from, all of one kind."""

    free: FreeSpace
    cells: Bool[np.ndarray, "rows cols"]
    near_enough: bool
    """True: the agent may stop there."""


class ViewpointFinder:
    """Finds the viewpoints of candidates on a part of the map."""

    def __init__(
        self,
        planner: Planner,
        layers: tuple[CollisionLayer, ...],
        distances: StopDistances,
        target_edge_m: float,
        counter_m: float = 0.0,
    ) -> None:
        """Makes a finder.

        Args:
            planner: finds free and reachable cells.
            layers: the collision layers to plan on, in order of preference.
            distances: of viewpoints.
            target_edge_m: surfaces this near to a candidate do not hide it.
            counter_m: the same for a candidate that has no viewpoint otherwise, on the side from which it was seen: a
                counter is as high as the camera, and what stands on it was seen over its edge. 0: not tried.
        """
        self.planner = planner
        self.layers = layers
        self.distances = distances
        self.target_edge_m = target_edge_m
        self.counter_m = counter_m

    def find(
        self,
        view: NavMap,
        pose: Pose,
        nearest: NearestCells,
        last_resort: LastResort,
        *,
        over_counters: bool = False,
    ) -> Iterator[Viewpoints]:
        """Yields viewpoints from the best kind to the last resort.

        Args:
            view: a part of the map.
            pose: pose of the robot.
            nearest: for each cell of the view, the distance and the place of the nearest candidate cell.
            last_resort: the use of the nearest reachable place.
            over_counters: also yield viewpoints over the edge of a counter, before the last resort; see `counter_m`.
        """
        gap_m = nearest.gap_cells * np.float32(view.frame.cell_m)
        unseen = self.planner.unseen(view)
        free_spaces: dict[CollisionLayer, FreeSpace] = {}
        for over in (False, True) if over_counters and self.counter_m > 0.0 else (False,):
            in_sight = self.in_sight(view, gap_m, nearest, self.distances.viewpoints_m[-1], over_counters=over)
            for within_m, layer in self.distances.tried_on(self.layers):
                if layer not in free_spaces:
                    free_spaces[layer] = self.planner.free_space(view, pose, layer, unseen)
                cells = free_spaces[layer].reachable & in_sight & (gap_m <= within_m)
                if cells.any():
                    yield Viewpoints(free_spaces[layer], cells, near_enough=True)
        if last_resort is LastResort.NONE:
            return
        free = free_spaces[self.layers[-1]]
        reach_m = np.where(free.reachable, gap_m, np.inf)
        if reach_m.min() <= self.distances.last_resort_m:
            # The ground under the robot is free and moves with it: without a margin the robot would push without end.
            margin_m = self.planner.config.own_ground_m + view.frame.cell_m
            near_enough = last_resort is LastResort.STOP
            yield Viewpoints(free, reach_m <= reach_m.min() + margin_m, near_enough=near_enough)

    def look_from(self, view: NavMap, pose: Pose, nearest: NearestCells, between_m: tuple[float, float]) -> Viewpoints:
        """Returns the cells with a view of a candidate from distances in `between_m`."""
        gap_m = nearest.gap_cells * np.float32(view.frame.cell_m)
        free = self.planner.free_space(view, pose, self.layers[0], self.planner.unseen(view))
        seen = self.in_sight(view, gap_m, nearest, between_m[1])
        return Viewpoints(free, free.reachable & seen & (gap_m >= between_m[0]), near_enough=False)

    def in_sight(
        self,
        view: NavMap,
        gap_m: Float32[np.ndarray, "rows cols"],
        nearest: NearestCells,
        within_m: float,
        *,
        over_counters: bool = False,
    ) -> Bool[np.ndarray, "rows cols"]:
        """Returns the cells within a distance of a candidate from which nothing hides its nearest cell.

        Args:
            view: a part of the map.
            gap_m: the distance of each cell to the candidate.
            nearest: for each cell, the nearest candidate cell.
            within_m: the largest distance.
            over_counters: see `counter_m`.
        """
        edge_cells = (self.counter_m if over_counters else self.target_edge_m) / view.frame.cell_m
        rows, cols = np.nonzero(gap_m <= within_m)
        ends = nearest.rows[rows, cols], nearest.cols[rows, cols]
        in_sight = np.zeros_like(view.rejected)
        in_sight[rows, cols] = sight_is_clear(view.seen_at_eye_level, (rows, cols), ends, edge_cells)
        # A picture hides the wall it is mounted on. Behind that wall there may seem to be free ground, from which the
        # picture cannot be seen: ground never in view counts only on the side from which the candidate was seen.
        seen_side = (rows - ends[0]) * view.shown_y[ends] + (cols - ends[1]) * view.shown_x[ends] > 0
        if over_counters:
            in_sight[rows, cols] &= seen_side
            return in_sight
        # An object that is remembered may be behind a wall that furniture hides: there all ground in between must have
        # been in view.
        from_here = view.frames_in_view[rows, cols] > 0
        if view.sided:
            unknown = (view.frames_in_view == 0) & ~view.visited
            from_here &= sight_is_clear(view.seen_at_eye_level | unknown, (rows, cols), ends, 1.0)
        in_sight[rows, cols] &= seen_side | from_here
        return in_sight
