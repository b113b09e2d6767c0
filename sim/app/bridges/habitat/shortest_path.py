"""Habitat's shortest paths between places, over the free space of the robot at the start of the episode."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.core.errors import ConfigError
from sim.core.geometry.pose import Pose
from sim.env.objectnav import ObjectNavEnv
from sim.episodes.habitat import from_position
from sim.task.ground_truth import GroundTruth
from sim.world.freespace import NEAREST_FREE_M, FreeSpace

Places = tuple[tuple[float, float, float], ...]
"""Positions of Habitat's frame: right, up, back, metres."""


class ShortestPaths:
    """Geodesic distances to places on the storey of the running episode; those to the last places are kept."""

    def __init__(self, env: ObjectNavEnv) -> None:
        self._env = env
        self._kept: tuple[GroundTruth, float, Places, NDArray[np.float32]] | None = None

    @property
    def storey(self) -> tuple[GroundTruth, float]:
        """The house of the running episode, and the height of the floor of its storey."""
        task = self._env.scene.task
        return task.truth, task.start.floor_z_m

    @property
    def episode(self) -> tuple[GroundTruth, Pose]:
        """The house and the start of the running episode."""
        task = self._env.scene.task
        return task.truth, task.start

    @property
    def steps(self) -> int:
        """The number of actions of the running episode so far."""
        return self._env.scene.task.num_steps

    @property
    def space(self) -> FreeSpace:
        """The free space of the storey."""
        truth, floor_z_m = self.storey
        return truth.space(floor_z_m)

    def distance_m(self, start: ArrayLike, ends: ArrayLike) -> float:
        """Returns the length of the shortest path from one place to the nearest of others; inf: there is no path."""
        here, field = self._on_storey(places_of(start)[:1]), self.field(ends)
        return min((self.space.distance_at(field, *xy_m) for xy_m in here), default=math.inf)

    def field(self, ends: ArrayLike) -> NDArray[np.float32]:
        """Returns the distance from each cell (rows, cols) to the nearest of these places; inf: there is no path."""
        truth, floor_z_m = self.storey
        places = places_of(ends)
        if self._kept is None or self._kept[0] is not truth or self._kept[1:3] != (floor_z_m, places):
            self._kept = (truth, floor_z_m, places, self.space.geodesic(self._cells(places)))
        return self._kept[3]

    def _cells(self, places: Places) -> NDArray[np.bool_]:
        """Returns the free cells (rows, cols) nearest to the places, within `NEAREST_FREE_M` of them."""
        space = self.space
        cells = np.zeros(space.free.shape, np.bool_)
        for x_m, y_m in self._on_storey(places):
            window = space.frame.index_of((x_m, y_m, x_m, y_m), NEAREST_FREE_M)
            x, y = space.frame.axes(window)
            away_m = np.where(space.free[window], np.hypot(x[None, :] - x_m, y[:, None] - y_m), math.inf)
            if away_m.min(initial=math.inf) <= NEAREST_FREE_M:
                cells[window][np.unravel_index(int(away_m.argmin()), away_m.shape)] = True
        return cells

    def _on_storey(self, places: Places) -> list[tuple[float, float]]:
        """Returns x and y, in the project's frame, of the places that are on the storey."""
        truth, floor_z_m = self.storey
        points = (from_position(place) for place in places)
        return [(x_m, y_m) for x_m, y_m, z_m in points if abs(z_m - floor_z_m) < truth.success.same_storey_m]


def places_of(positions: ArrayLike) -> Places:
    """Returns one position (3,) or several (n, 3) as tuples.

    Raises:
        ConfigError: they are something else.
    """
    try:
        points = np.asarray(positions, np.float64).reshape(-1, 3)
    except (TypeError, ValueError):
        points = np.full((1, 3), math.nan)
    if not points.size or not np.isfinite(points).all():
        raise ConfigError(f"Positions are (3,) or (n, 3) finite numbers, in metres, got {positions!r:.80}.")
    return tuple((right, up, back) for right, up, back in points.tolist())
