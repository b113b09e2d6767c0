"""Frontiers of the known part of the map; all explorers that drive to frontiers share them.

A level camera cannot see the floor under and next to the robot. Ground near the robot's own trail therefore counts as
known, and paths may cross unknown ground at the planner's cost for it.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool

from sim.core.geometry.grid import Window, cells_near_segment
from sim.core.geometry.pose import Pose
from sim.core.interface import ConfigError
from stubborn.exploration.explorer import Ground, Search
from stubborn.mapping.masks import distance_to, farther_than
from stubborn.mapping.navmap import CollisionLayer
from stubborn.planning.planner import FreeSpace, Goal

_MARGIN_M = 0.1
"""The radius of the spent disc exceeds the path length of an arrival by at least this. Path lengths are measured from
the middle of the robot's cell, but the disc lies around the robot's position. Without a margin a reached frontier could
stay open, and the search would choose it again without end."""


def frontier_cells(
    known_free: Bool[np.ndarray, "rows cols"], open_unknown: Bool[np.ndarray, "rows cols"]
) -> Bool[np.ndarray, "rows cols"]:
    """Returns the known free cells that have an unblocked unknown cell among their 8 neighbours."""
    near_unknown = cv2.dilate(np.ascontiguousarray(open_unknown).view(np.uint8), np.ones((3, 3), np.uint8))
    return known_free & (near_unknown > 0)


@dataclass(frozen=True)
class Frontiers:
    """The known part of the map at one step, and its frontiers."""

    window: Window
    free: FreeSpace
    cells: Bool[np.ndarray, "rows cols"]
    """The frontiers that can be reached."""
    unknown: Bool[np.ndarray, "rows cols"]
    """Ground that was not in view; ground near the trail counts as known."""
    trail: Bool[np.ndarray, "rows cols"]
    """The robot's trail; shares memory with the map."""
    off_trail: Bool[np.ndarray, "rows cols"]
    """Ground that is not near the trail."""

    @classmethod
    def of(
        cls, ground: Ground, *, own_known_m: float, margin_cells: int, layer: CollisionLayer | None = None
    ) -> Frontiers:
        """Returns the frontiers of a map.

        Args:
            ground: map and pose at this step.
            own_known_m: ground within this distance of the trail counts as known.
            margin_cells: margin around the known part of the map within which paths may run.
            layer: the collision layer to plan on; None: the preferred one.
        """
        window = ground.navmap.known_window(margin_cells)
        trail = ground.navmap.view(window).trail
        off_trail = farther_than(trail, own_known_m, window.frame.cell_m)
        unknown = ground.unknown(window) & off_trail
        free = ground.free_space(window, layer, unknown)
        cells = frontier_cells(free.reachable & ~unknown, free.traversable & unknown)
        return cls(window, free, cells, unknown, trail, off_trail)

    def to_least_visited(self, arrived_m: float) -> Search:
        """Returns the route to the ground farthest from the trail, for use when no unknown ground is left.

        Returns None if no such route exists, or it is not longer than `arrived_m`.
        """
        far_cells = np.where(self.free.reachable, distance_to(self.trail), -np.inf)
        route = yield Goal(self.free, far_cells == far_cells.max())
        return None if route is None or route.length_m <= arrived_m else route


def require_margin(config: str, arrived_m: float, spent_m: float) -> None:
    """Raises ConfigError unless `arrived_m` of a configuration is positive and `spent_m` exceeds it by a margin."""
    if not (arrived_m > 0.0 and spent_m >= arrived_m + _MARGIN_M - 1e-9):
        raise ConfigError(
            f"{config} needs arrived_m > 0 and spent_m >= arrived_m + {_MARGIN_M}, got {arrived_m} and {spent_m} m."
        )


def spend_around(spent: Bool[np.ndarray, "rows cols"], window: Window, pose: Pose, radius_m: float) -> None:
    """Marks the cells around the robot as spent: the robot has seen what the frontiers there show.

    Args:
        spent: mask over the whole map; it is changed.
        window: part of the map that is marked.
        pose: pose of the robot.
        radius_m: radius of the disc that is marked.
    """
    index, disc = cells_near_segment(window.frame, pose.xy_m, pose.xy_m, radius_m)
    spent[window.index][index] |= disc
