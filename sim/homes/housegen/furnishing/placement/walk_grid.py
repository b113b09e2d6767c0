"""A grid of one room's floor that shows whether the robot can still reach doorways and furniture."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.homes.housegen.floor_plan.rectangles import Rect

CELL_M = 0.05
ROBOT_M = 0.22
"""Half the width kept free for the robot: its radius of 0.18 m and 4 cm to spare."""
REACH_M = 0.8
"""An item counts as reachable when the robot's centre gets this near to its footprint in plan."""
POCKET_CELLS = 60
"""Largest floor area that may be free but unreachable, in cells: 0.15 m2."""
_GATE_CELLS = 6
"""Cells around a doorway that count as free: the walls next to it do not stop a robot that passes through."""
_RADIUS_CELLS = round(ROBOT_M / CELL_M)
_DISC = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * _RADIUS_CELLS + 1, 2 * _RADIUS_CELLS + 1))


class WalkGrid:
    """Cells of a room that furniture and walls occupy, and the doorways that must stay connected."""

    def __init__(self, inner: Rect) -> None:
        self._inner = inner
        self._doorways: list[tuple[float, float]] = []
        self._taken = np.zeros((math.ceil(inner.depth_m / CELL_M) + 2, math.ceil(inner.width_m / CELL_M) + 2), np.uint8)
        self._taken[[0, -1], :] = 1
        self._taken[:, [0, -1]] = 1
        self.checks = 0
        """Number of calls of `stays_walkable`."""

    def add_doorway(self, x_m: float, y_m: float) -> None:
        """Adds a point through which the robot enters the room."""
        self._doorways.append((x_m, y_m))

    def occupy(self, rect: Rect) -> None:
        """Marks the cells that a rectangle touches as occupied."""
        self._taken[self._cells(rect)] = 1

    def occupied(self) -> NDArray[np.uint8]:
        """Returns a copy of the occupied cells, for `set_occupied`."""
        return self._taken.copy()

    def set_occupied(self, cells: NDArray[np.uint8]) -> None:
        """Replaces the occupied cells by a copy that `occupied` returned."""
        self._taken[:] = cells

    def widest_free(self) -> tuple[float, tuple[float, float]]:
        """Returns radius and middle (x, y) of the largest circle of free floor, in metres."""
        distance = cv2.distanceTransform((self._taken == 0).astype(np.uint8), cv2.DIST_L2, 3)
        row, col = np.unravel_index(int(np.argmax(distance)), distance.shape)
        middle = (self._inner.x0 + (int(col) - 0.5) * CELL_M, self._inner.y0 + (int(row) - 0.5) * CELL_M)
        return float(distance[row, col]) * CELL_M, middle

    def stays_walkable(self, new: Rect, reachable: Sequence[Rect]) -> bool:
        """Returns whether the room stays usable for the robot with `new` occupied as well.

        The robot must get from each doorway to all others and to nearly all free floor, and it must get near to every
        rectangle of `reachable`.
        """
        self.checks += 1
        taken = self._taken.copy()
        taken[self._cells(new)] = 1
        for x, y in self._doorways:
            row, col = self._cell(x, y)
            rows = slice(max(row - _GATE_CELLS, 0), row + _GATE_CELLS + 1)
            taken[rows, max(col - _GATE_CELLS, 0) : col + _GATE_CELLS + 1] = 0
        blocked = cv2.dilate(taken, _DISC, borderType=cv2.BORDER_CONSTANT, borderValue=0)
        count, parts = cv2.connectedComponents((blocked == 0).astype(np.uint8), connectivity=4)
        part = self._main_part(count, np.asarray(parts))
        if part is None:
            return False
        sizes = np.bincount(parts.ravel())[1:]
        if sizes.sum() - sizes[part - 1] > POCKET_CELLS:
            return False
        distance = cv2.distanceTransform((parts != part).astype(np.uint8), cv2.DIST_L2, 3)
        return all(distance[self._cells(rect)].min(initial=np.inf) * CELL_M < REACH_M for rect in reachable)

    def _main_part(self, count: int, parts: NDArray[np.int32]) -> int | None:
        """Returns the number of the connected part that holds all doorways, or the largest part of a room without any.

        Returns None if a doorway is blocked, two doorways lie in different parts, or nothing is free.
        """
        if count < 2:
            return None
        if not self._doorways:
            return 1 + int(np.argmax(np.bincount(parts.ravel())[1:]))
        names = {int(parts[self._cell(x, y)]) for x, y in self._doorways}
        return None if len(names) != 1 or 0 in names else names.pop()

    def _cells(self, rect: Rect) -> tuple[slice, slice]:
        """Returns the rows and columns of the cells that a rectangle touches."""
        c0 = max(0, math.floor((rect.x0 - self._inner.x0) / CELL_M) + 1)
        c1 = math.ceil((rect.x1 - self._inner.x0) / CELL_M) + 1
        r0 = max(0, math.floor((rect.y0 - self._inner.y0) / CELL_M) + 1)
        r1 = math.ceil((rect.y1 - self._inner.y0) / CELL_M) + 1
        return slice(r0, r1), slice(c0, c1)

    def _cell(self, x_m: float, y_m: float) -> tuple[int, int]:
        """Returns the row and column of the cell of a point, never one of the border."""
        row = int((y_m - self._inner.y0) / CELL_M) + 1
        col = int((x_m - self._inner.x0) / CELL_M) + 1
        return min(max(row, 1), self._taken.shape[0] - 2), min(max(col, 1), self._taken.shape[1] - 2)
