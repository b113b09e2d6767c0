"""The approach to a candidate: the route to its nearest viewpoint."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Int

from sim.core.geometry.grid import Window
from sim.core.geometry.pose import Pose
from stubborn.detection.viewpoints import LastResort, ViewpointFinder, Viewpoints
from stubborn.mapping.masks import nearest
from stubborn.mapping.navmap import NavMap
from stubborn.planning.planner import Goal, Route
from stubborn.planning.steering import route_end


@dataclass(frozen=True)
class Approach:
    """The route to the nearest viewpoint of the pursued candidates."""

    route: Route | None
    """The route to a viewpoint; None when the robot is on one."""
    bearing_rad: float
    """World angle from the robot to the candidate cell."""
    cell: tuple[int, int]
    """Row and column, on the whole map, of the candidate cell nearest to the viewpoint that the route leads to."""
    near_enough: bool = True
    """False: a STOP there would not count; the candidate can only be verified from there."""

    @property
    def length_m(self) -> float:
        """Length of the route; slow ground counts as longer (see `Route`)."""
        return 0.0 if self.route is None else self.route.length_m


def approach_on(
    view: NavMap,
    candidates: Bool[np.ndarray, "rows cols"],
    pose: Pose,
    finder: ViewpointFinder,
    last_resort: LastResort,
    *,
    over_counters: bool = False,
) -> Approach | None:
    """Returns the approach to some candidates on a part of the map; its cell is relative to that part.

    Returns None if they have no reachable viewpoint. For `last_resort` and `over_counters` see `ViewpointFinder.find`.
    """
    if not candidates.any():
        return None
    cells = nearest(candidates)
    for viewpoints in finder.find(view, pose, cells, last_resort, over_counters=over_counters):
        approach = approach_to(view, viewpoints, cells.rows, cells.cols, pose, finder)
        if approach is not None:
            return approach
    return None


def approach_from_here(
    view: NavMap, candidates: Bool[np.ndarray, "rows cols"], pose: Pose, finder: ViewpointFinder
) -> Approach | None:
    """Returns the approach that ends at the robot's present position; its cell is relative to that part of the map.

    Returns None if no candidate is in sight within `StopDistances.pushing_m`.
    """
    if not candidates.any():
        return None
    cells, here = nearest(candidates), view.frame.cell(pose.x_m, pose.y_m)
    gap_m = cells.gap_cells * np.float32(view.frame.cell_m)
    if not finder.in_sight(view, gap_m, cells, finder.distances.pushing_m)[here]:
        return None
    cell = int(cells.rows[here]), int(cells.cols[here])
    return Approach(None, _bearing_rad(view, cell, pose), cell)


def approach_to(
    view: NavMap,
    viewpoints: Viewpoints,
    nearest_row: Int[np.ndarray, "rows cols"],
    nearest_col: Int[np.ndarray, "rows cols"],
    pose: Pose,
    finder: ViewpointFinder,
) -> Approach | None:
    """Returns the approach to viewpoints; None if no route exists.

    `nearest_row` and `nearest_col` are the candidate cell that is nearest to each cell of the view.
    """
    here = view.frame.cell(pose.x_m, pose.y_m)
    arrived = bool(viewpoints.cells[here])
    route = None if arrived else finder.planner.route(Goal(viewpoints.free, viewpoints.cells), pose)
    if route is None and not arrived:
        return None
    end = here if route is None else route_end(route, pose)
    cell = int(nearest_row[end]), int(nearest_col[end])
    return Approach(route, _bearing_rad(view, cell, pose), cell, viewpoints.near_enough)


def on_map(approach: Approach, part: Window) -> Approach:
    """Returns an approach on a part of the map, with its cell relative to the whole map."""
    return replace(approach, cell=(approach.cell[0] + part.rows.start, approach.cell[1] + part.cols.start))


def _bearing_rad(view: NavMap, cell: tuple[int, int], pose: Pose) -> float:
    """Returns the world angle from the robot to the centre of a cell."""
    x_m, y_m = view.frame.centres(*cell)
    return math.atan2(float(y_m) - pose.y_m, float(x_m) - pose.x_m)
