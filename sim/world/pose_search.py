"""Searches the fewest actions from a start to a goal, breadth first, over poses that the robot can drive to.

A pose is a place and one of 12 headings. An action is a turn of 30 deg or a forward of 0.25 m, as the oracle drives
them. A forward is possible where the robot's disc, with a margin, is clear of every obstacle all along. Clearances are
exact distances to the plan projections of the collision geoms, sampled on a grid of `GRID_M`.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.grid import GridFrame
from sim.core.geometry.pose import Pose
from sim.core.interface import FORWARD_M, TURN_RAD, Action
from sim.world.freespace import FreeSpace

GRID_M = 0.0125
"""Edge of the cells of the clearance: half of a cell of the free space."""
SAMPLE_M = 0.025
"""Distance between the places on a forward that are tested."""
NODES_M = (0.05, 0.025)
"""Poses with one heading and the same multiple of this in x and y are one pose. The oracle uses the first one; the
second is tried where the first finds no route."""
HEADINGS = round(math.tau / TURN_RAD)
_REACH_M = 0.1
"""Distances are exact up to this much more than the robot's radius."""


@dataclass(frozen=True)
class PoseRoute:
    """A route with the fewest actions."""

    actions: tuple[Action, ...]
    places_m: NDArray[np.float64]  # (actions + 1, 2)
    """The robot's place before the first action and after each one."""


class PoseSearch:
    """A breadth-first search in one free space.

    Args:
        space: the free space.
        margin_m: clearance in addition to the robot's radius.
    """

    def __init__(self, space: FreeSpace, *, margin_m: float) -> None:
        self._space = space
        self._frame, self._passable = _passable_cells(space, space.radius_m + margin_m)

    def route(self, start: Pose, goal: NDArray[np.bool_]) -> PoseRoute | None:
        """Returns a route to a cell of `goal`, a mask (rows, cols) on the frame of the free space; None without one."""
        for node_m in NODES_M:
            route = self._route(start, goal, node_m)
            if route is not None:
                return route
        return None

    def _route(self, start: Pose, goal: NDArray[np.bool_], node_m: float) -> PoseRoute | None:
        low, (rows, cols) = np.array(self._frame.origin_xy_m), self._frame.shape
        size = np.ceil(np.array([cols, rows]) * self._frame.cell_m / node_m).astype(np.int64) + 1
        places = np.full((HEADINGS * int(np.prod(size)), 2), np.nan)
        parent = np.full(len(places), -1, np.int64)
        swept_m = _swept(start.yaw_rad)

        def key(at_m: NDArray[np.float64], heading: NDArray[np.int64]) -> NDArray[np.int64]:
            cell = np.floor((at_m - low) / node_m).astype(np.int64)
            return (heading * size[1] + cell[:, 1]) * size[0] + cell[:, 0]

        at_m, heading = np.array([[start.x_m, start.y_m]]), np.zeros(1, np.int64)
        keys = key(at_m, heading)
        places[keys], parent[keys] = at_m, keys
        while len(keys):
            reached = goal[tuple(self._space.frame.to_cells(at_m).T)]
            if reached.any():
                return _trace(int(keys[int(np.argmax(reached))]), parent, places, int(np.prod(size)))
            ahead_m = at_m + swept_m[heading, -1]
            free = self._is_passable(at_m[:, None] + swept_m[heading])
            new_m = np.concatenate([ahead_m[free], at_m, at_m])
            turned = np.concatenate([heading[free], (heading + 1) % HEADINGS, (heading - 1) % HEADINGS])
            before = np.concatenate([keys[free], keys, keys])
            after, first = np.unique(key(new_m, turned), return_index=True)
            fresh = parent[after] < 0
            keys, first = after[fresh], first[fresh]
            at_m, heading = new_m[first], turned[first]
            places[keys], parent[keys] = at_m, before[first]
        return None

    def _is_passable(self, path_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Returns for paths (n, samples, 2) whether the disc is clear at every sample."""
        cells = self._frame.to_cells(path_m)
        inside = self._frame.inside(cells).all(axis=1)
        row, col = np.clip(cells, 0, np.array(self._frame.shape) - 1).transpose(2, 0, 1)
        return np.logical_and(inside, self._passable[row, col].all(axis=1))


def _swept(yaw_rad: float) -> NDArray[np.float64]:
    """Returns the samples of a forward at each heading, relative to its begin: (headings, samples, 2) metres."""
    yaws = yaw_rad + np.arange(HEADINGS) * TURN_RAD
    along = np.linspace(SAMPLE_M, FORWARD_M, round(FORWARD_M / SAMPLE_M))
    return along[None, :, None] * np.stack([np.cos(yaws), np.sin(yaws)], axis=1)[:, None, :]


def _passable_cells(space: FreeSpace, clearance_m: float) -> tuple[GridFrame, NDArray[np.bool_]]:
    """Returns a grid and the mask (rows, cols) of the cells in which the disc has this clearance at every point.

    A cell passes where its centre has this clearance from obstacles and half a diagonal more. Edges of floors count
    without it, as in the free space: wheels and casters are 3 cm inside of the disc.
    """
    factor = round(space.frame.cell_m / GRID_M)
    rows, cols = space.frame.shape
    frame = GridFrame(origin_xy_m=space.frame.origin_xy_m, shape=(rows * factor, cols * factor), cell_m=GRID_M)
    need_m = clearance_m + GRID_M / math.sqrt(2.0)
    passable = space.free.repeat(factor, axis=0).repeat(factor, axis=1)
    for polygon in space.obstacles:
        window = frame.index_of(polygon.bounds_m, need_m + _REACH_M)
        x_m, y_m = frame.axes(window)
        if len(x_m) and len(y_m):
            points = np.stack(np.meshgrid(x_m, y_m), axis=-1).reshape(-1, 2)
            passable[window] &= (polygon.distance(points) >= need_m).reshape(len(y_m), len(x_m))
    return frame, passable


def _trace(end: int, parent: NDArray[np.int64], places: NDArray[np.float64], plane: int) -> PoseRoute:
    """Returns the route that ends at a key; `plane` is the number of keys of one heading."""
    keys = [end]
    while parent[keys[-1]] != keys[-1]:
        keys.append(int(parent[keys[-1]]))
    keys.reverse()
    headings = [key // plane for key in keys]
    actions = []
    for before, after in itertools.pairwise(headings):
        turned = (after - before) % HEADINGS
        actions.append({0: Action.MOVE_FORWARD, 1: Action.TURN_LEFT}.get(turned, Action.TURN_RIGHT))
    return PoseRoute(tuple(actions), places[keys])
