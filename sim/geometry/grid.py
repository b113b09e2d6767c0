"""The one place on the truth's side where metres in plan become cells, and cells become metres.

Arrays over the ground are indexed [row, col] = [y, x]; cell (0, 0) is the corner with the smallest x and y.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

CELL_M = 0.025
"""Edge of a cell of the free space."""


@dataclass(frozen=True, kw_only=True)
class PlanFrame:
    """Where a grid lies in the world, seen from above."""

    origin_xy_m: tuple[float, float]
    """World position of the outer corner of cell (0, 0)."""
    shape: tuple[int, int]
    """Rows (y) and columns (x)."""
    cell_m: float = CELL_M
    """Edge length of one cell."""

    def to_cells(self, xy_m: ArrayLike) -> NDArray[np.int64]:
        """(..., 2) row and column of the cells that hold points (..., 2); they may lie off the grid."""
        xy = np.asarray(xy_m, dtype=np.float64)
        return np.floor((xy - self.origin_xy_m) / self.cell_m).astype(np.int64)[..., ::-1]

    def to_metres(self, cells: ArrayLike) -> NDArray[np.float64]:
        """(..., 2) x and y of the centres of cells (..., 2)."""
        xy = np.asarray(cells, dtype=np.float64)[..., ::-1]
        return (xy + 0.5) * self.cell_m + np.asarray(self.origin_xy_m)

    def inside(self, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
        """(...,) which cells (..., 2) are on the grid."""
        return np.all((cells >= 0) & (cells < self.shape), axis=-1)

    def window(self, bounds_m: tuple[float, float, float, float], margin_m: float = 0.0) -> tuple[slice, slice]:
        """Rows and columns of all cells within `margin_m` of a rectangle (smallest x, y, largest x, y)."""
        x0, y0, x1, y1 = bounds_m
        low = self.to_cells((x0 - margin_m, y0 - margin_m))
        high = self.to_cells((x1 + margin_m, y1 + margin_m)) + 1
        (row0, col0), (row1, col1) = np.clip([low, high], 0, self.shape).tolist()
        return slice(row0, row1), slice(col0, col1)

    def centres(self, window: tuple[slice, slice] | None = None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """x of each column's and y of each row's centre, of a window or of the whole grid."""
        rows, cols = window or (slice(0, self.shape[0]), slice(0, self.shape[1]))
        x = (np.arange(cols.start, cols.stop, dtype=np.float64) + 0.5) * self.cell_m + self.origin_xy_m[0]
        y = (np.arange(rows.start, rows.stop, dtype=np.float64) + 0.5) * self.cell_m + self.origin_xy_m[1]
        return x, y
