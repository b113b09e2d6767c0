"""A map of a furnished house for the placement of hazards: free floor, shortest paths, floor to keep connected."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.geometry.descent_kernels import descend
from sim.core.geometry.fast_marching import distances
from sim.core.interface import MPCAT40_ID, RobotModel
from sim.gl import mujoco
from sim.homes.housegen.structure.openings import Opening
from sim.houses.geoms import data_at_rest
from sim.houses.house import Room, read_rooms
from sim.houses.labels import collidable_geoms, read_labels
from sim.world.check import STRUCTURE
from sim.world.freespace import CELL_M, FreeSpace
from sim.world.plan import polygons_between

LOW_M = 0.03
"""Furniture that is lower is left out of the map: feet and plinths stand below furniture that is part of it."""
TALL_M = 2.1
"""Height up to which the space of tall hazards must be free."""
SPARE_M = 0.27
"""Half the width of the paths that must stay: the robot's radius of 0.18 m and 9 cm to spare."""
TIGHT_M = 0.20
"""Half the width of narrower paths, to places that had no wider one before."""
MOST_FREE_M = 4.0
"""Length over which straight lines are followed."""
_LOST_M2 = {TIGHT_M: 0.12, SPARE_M: 0.4}
"""Largest area that a hazard may disconnect beyond the floor right next to it, for each half width."""
_DRAWN_RADIUS_M = 0.018
"""Solid cells reach this far beyond the geoms: half a cell's diagonal, so that thin geoms are not missed."""
_FURNITURE_GAP = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (5, 5))
"""Hazards stay two cells from furniture."""
_BUILDING_IDS = [MPCAT40_ID[category] for category in sorted(STRUCTURE)]
_SHIFT = 8
"""Binary digits of the fractions of a cell with which outlines are drawn."""

Path = NDArray[np.float64]
"""Positions (n, 2), one a cell."""


class FloorMap:
    """Free floor of one house; it changes when a hazard is added."""

    def __init__(self, spec: mujoco.MjSpec, openings: Sequence[Opening]) -> None:
        """Measures the free floor of a house without hazards."""
        self.openings = tuple(openings)
        model = spec.compile()
        data = data_at_rest(model)
        labels, self.rooms = read_labels(model, ignore_prefix=""), read_rooms(model)
        low, high = (
            FreeSpace(
                model,
                data,
                labels,
                rooms=self.rooms,
                robot=RobotModel(radius_m=_DRAWN_RADIUS_M, height_m=height, climb_m=LOW_M),
            )
            for height in (0.88, TALL_M)
        )
        self.frame = low.frame
        self._solid = ~low.free
        self._tall_solid = ~low.free | (~high.free if high.free.shape == low.free.shape else False)
        solid = np.flatnonzero(collidable_geoms(model) & ~np.isin(labels.geom_category, _BUILDING_IDS))
        outlines = [polygon.vertices_m for polygon in polygons_between(model, data, solid, (0.0, TALL_M))]
        self._near_furniture = cv2.dilate(self._drawn(outlines).astype(np.uint8), _FURNITURE_GAP).astype(np.bool_)
        self._hazards = np.zeros_like(self._solid)
        self._main = {half_m: _largest(self.clearance() >= half_m) for half_m in _LOST_M2}
        self._fields: dict[str, NDArray[np.float32]] = {}
        self._cells: dict[str, NDArray[np.int64]] = {}

    def clearance(self) -> NDArray[np.float32]:
        """Returns the distance (rows, cols) from each cell to the nearest obstacle, metres."""
        return cv2.distanceTransform((~self._solid).astype(np.uint8), cv2.DIST_L2, 5) * np.float32(CELL_M)

    def draw_path(self, rng: np.random.Generator) -> Path | None:
        """Returns a shortest path between random places of two random rooms; None if a room has no free place."""
        order = rng.permutation(len(self.rooms))[:2]
        if len(order) < 2:
            return None
        begin = self._random_cell(rng, self.rooms[int(order[0])])
        field = self._field_of(rng, self.rooms[int(order[1])])
        if begin is None or field is None or not np.isfinite(field[begin]):
            return None
        return self.frame.to_metres(descend(field, *begin))

    def free_length_m(self, x_m: float, y_m: float, yaw_rad: float) -> float:
        """Returns how far a line from a position stays free up to the height of a pane, `MOST_FREE_M` at most."""
        steps = np.arange(0.0, MOST_FREE_M, 0.5 * CELL_M)
        points = np.array([x_m, y_m]) + steps[:, None] * np.array([np.cos(yaw_rad), np.sin(yaw_rad)])
        cells = np.clip(self.frame.to_cells(points), 0, np.array(self.frame.shape) - 1)
        hits = np.flatnonzero(self._tall_solid[cells[:, 0], cells[:, 1]])
        return float(steps[hits[0]]) if hits.size else MOST_FREE_M

    def try_add(self, outlines: Sequence[NDArray[np.float64]], apart_m: float) -> bool:
        """Adds a hazard with these outlines; returns False, and changes nothing, if it does not fit.

        It fits where it touches nothing, is at least `apart_m` from all other hazards, and disconnects no floor.
        """
        if not outlines:
            return True  # the robot passes it
        mask = self._drawn(outlines)
        if not mask.any() or (mask & (self._tall_solid | self._near_furniture)).any():
            return False
        away_m = cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, 5) * CELL_M
        if (away_m[self._hazards] < apart_m).any():
            return False
        before = self._solid
        self._solid = before | mask
        clearance_m = self.clearance()
        after = {half_m: _largest(clearance_m >= half_m) for half_m in _LOST_M2}
        for half_m, most_m2 in _LOST_M2.items():
            lost = self._main[half_m] & ~after[half_m] & (away_m > half_m + 0.03)
            if lost.sum() * CELL_M**2 > most_m2:
                self._solid = before
                return False
        self._main = after
        self._cells.clear()
        self._tall_solid = self._tall_solid | mask
        self._hazards |= mask
        return True

    def _drawn(self, outlines: Sequence[NDArray[np.float64]]) -> NDArray[np.bool_]:
        """Returns the mask (rows, cols) of the cells that convex outlines touch."""
        mask = np.zeros(self.frame.shape, np.uint8)
        for outline in outlines:
            cells = (outline - np.array(self.frame.origin_xy_m)) / CELL_M - 0.5
            cv2.fillConvexPoly(mask, np.round(cells * 2**_SHIFT).astype(np.int32), 1, shift=_SHIFT)
        return mask.astype(np.bool_)

    def _field_of(self, rng: np.random.Generator, room: Room) -> NDArray[np.float32] | None:
        """Returns the geodesic distances to a random place of a room, the same one each time."""
        if room.name not in self._fields:
            cell = self._random_cell(rng, room)
            if cell is None:
                return None
            source = np.zeros_like(self._solid)
            source[cell] = True
            self._fields[room.name] = distances(source, self._main[SPARE_M], CELL_M)
        return self._fields[room.name]

    def _random_cell(self, rng: np.random.Generator, room: Room) -> tuple[int, int] | None:
        """Returns a random cell of a room on the connected floor; None if the room has no such cell."""
        cells = self._cells_of(room)
        if not len(cells):
            return None
        row, col = cells[rng.integers(len(cells))].tolist()
        return row, col

    def _cells_of(self, room: Room) -> NDArray[np.int64]:
        """Returns the cells (n, 2) of a room on the connected floor."""
        if room.name not in self._cells:
            x, y = self.frame.axes()
            mask = np.zeros_like(self._solid)
            for (cx, cy, _), (hx, hy, _) in room.boxes:
                mask |= np.outer(np.abs(y - cy) <= hy, np.abs(x - cx) <= hx)
            self._cells[room.name] = np.argwhere(mask & self._main[SPARE_M])
        return self._cells[room.name]


def _largest(free: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Returns the largest connected part of a mask."""
    count, parts, stats, _ = cv2.connectedComponentsWithStats(free.astype(np.uint8), connectivity=4)
    if count < 2:
        return np.zeros_like(free)
    return np.asarray(parts) == 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())
