"""Grids over the floor: the one place where metres become cells and cells become metres.

Arrays over the ground are indexed [row, col] = [y, x]; cell (0, 0) is the corner with the smallest x and y. The plane
is the world seen from above, or the start frame of an episode.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64
from numpy.typing import ArrayLike, NDArray

from sim.core.errors import ConfigError
from sim.core.geometry.segment_kernels import mask_near_segment


@dataclass(frozen=True, kw_only=True)
class GridFrame:
    """The position, the size and the resolution of a grid in the plane."""

    origin_xy_m: tuple[float, float]
    """Position of the outer corner of cell (0, 0)."""
    shape: tuple[int, int]
    """Rows (y) and columns (x)."""
    cell_m: float
    """Edge length of one cell."""

    def __post_init__(self) -> None:
        if self.cell_m <= 0:
            raise ConfigError(f"GridFrame.cell_m must be > 0 m, got {self.cell_m}.")
        if min(self.shape) < 1:
            raise ConfigError(f"GridFrame.shape needs at least 1 x 1 cells, got {self.shape[0]} x {self.shape[1]}.")

    @classmethod
    def around_start(cls, size_cells: int, cell_m: float) -> GridFrame:
        """Returns a square grid; the centre of its middle cell is at (0, 0)."""
        origin_m = -(size_cells // 2 + 0.5) * cell_m
        return cls(origin_xy_m=(origin_m, origin_m), shape=(size_cells, size_cells), cell_m=cell_m)

    # Coordinates in arrays of their own.

    def cell(self, x_m: float, y_m: float) -> tuple[int, int]:
        """Returns the row and column of one point."""
        return (
            math.floor((y_m - self.origin_xy_m[1]) / self.cell_m),
            math.floor((x_m - self.origin_xy_m[0]) / self.cell_m),
        )

    def cells(self, x_m: ArrayLike, y_m: ArrayLike) -> tuple[Int64[np.ndarray, "*y"], Int64[np.ndarray, "*x"]]:
        """Returns the rows and columns of points; points outside give indices outside the shape."""
        cols = np.floor((np.asarray(x_m) - self.origin_xy_m[0]) / self.cell_m).astype(np.intp)
        rows = np.floor((np.asarray(y_m) - self.origin_xy_m[1]) / self.cell_m).astype(np.intp)
        return np.asarray(rows), np.asarray(cols)  # also of a single point, which NumPy makes a scalar

    def centres(
        self, rows: ArrayLike, cols: ArrayLike
    ) -> tuple[Float64[np.ndarray, "*cols"], Float64[np.ndarray, "*rows"]]:
        """Returns the x and y of cell centres."""
        x_m = self.origin_xy_m[0] + (np.asarray(cols) + 0.5) * self.cell_m
        y_m = self.origin_xy_m[1] + (np.asarray(rows) + 0.5) * self.cell_m
        return np.asarray(x_m), np.asarray(y_m)

    def contains(self, rows: ArrayLike, cols: ArrayLike) -> Bool[np.ndarray, "*shape"]:
        """Returns True where the index is on this grid."""
        rows, cols = np.asarray(rows), np.asarray(cols)
        return np.asarray((rows >= 0) & (rows < self.shape[0]) & (cols >= 0) & (cols < self.shape[1]))

    # Coordinates stacked along the last axis.

    def to_cells(self, xy_m: ArrayLike) -> Int64[np.ndarray, "*n 2"]:
        """Returns the row and column of the cells that hold points (..., 2); they may be off the grid."""
        xy = np.asarray(xy_m, dtype=np.float64)
        return np.floor((xy - self.origin_xy_m) / self.cell_m).astype(np.int64)[..., ::-1]

    def to_metres(self, cells: ArrayLike) -> Float64[np.ndarray, "*n 2"]:
        """Returns the x and y of the centres of cells (..., 2)."""
        xy = np.asarray(cells, dtype=np.float64)[..., ::-1]
        return (xy + 0.5) * self.cell_m + np.asarray(self.origin_xy_m)

    def inside(self, cells: Int64[np.ndarray, "*n 2"]) -> Bool[np.ndarray, "*n"]:
        """Returns True where cells are on the grid."""
        return np.all((cells >= 0) & (cells < self.shape), axis=-1)

    # Rectangles of cells.

    def axes(
        self, index: tuple[slice, slice] | None = None
    ) -> tuple[Float64[np.ndarray, " cols"], Float64[np.ndarray, " rows"]]:
        """Returns the x of each column's and the y of each row's centre, of a rectangle or of the whole grid."""
        rows, cols = index or (slice(0, self.shape[0]), slice(0, self.shape[1]))
        return self.centres(np.arange(rows.start, rows.stop), np.arange(cols.start, cols.stop))

    def mesh(self) -> tuple[Float64[np.ndarray, "1 cols"], Float64[np.ndarray, "rows 1"]]:
        """Returns the x (1, cols) and y (rows, 1) of all cell centres, ready to broadcast."""
        x_m, y_m = self.axes()
        return x_m[None, :], y_m[:, None]

    def index_of(self, bounds_m: tuple[float, float, float, float], margin_m: float = 0.0) -> tuple[slice, slice]:
        """Returns the rows and columns within `margin_m` of a rectangle (smallest x, y, largest x, y).

        They are empty where the rectangle is off the grid.
        """
        x0, y0, x1, y1 = bounds_m
        low = self.to_cells((x0 - margin_m, y0 - margin_m))
        high = self.to_cells((x1 + margin_m, y1 + margin_m)) + 1
        (row0, col0), (row1, col1) = np.clip([low, high], 0, self.shape).tolist()
        return slice(row0, row1), slice(col0, col1)

    def part(self, rows: slice, cols: slice) -> Window:
        """Returns the rectangle of these rows and columns, clipped to this grid."""
        row_0, row_1, _ = rows.indices(self.shape[0])
        col_0, col_1, _ = cols.indices(self.shape[1])
        frame = GridFrame(
            origin_xy_m=(self.origin_xy_m[0] + col_0 * self.cell_m, self.origin_xy_m[1] + row_0 * self.cell_m),
            shape=(row_1 - row_0, col_1 - col_0),
            cell_m=self.cell_m,
        )
        return Window(frame=frame, rows=slice(row_0, row_1), cols=slice(col_0, col_1))

    def window_at(self, x_m: float, y_m: float, size_cells: int) -> Window:
        """Returns a square of cells around a point, shifted where it would leave this grid."""
        row, col = self.cell(x_m, y_m)
        size_rows, size_cols = min(size_cells, self.shape[0]), min(size_cells, self.shape[1])
        row_0 = min(max(row - size_rows // 2, 0), self.shape[0] - size_rows)
        col_0 = min(max(col - size_cols // 2, 0), self.shape[1] - size_cols)
        return self.part(slice(row_0, row_0 + size_rows), slice(col_0, col_0 + size_cols))

    def patch(self, x_m: Sequence[float], y_m: Sequence[float], margin_m: float) -> Window:
        """Returns the smallest rectangle of cells that holds the points with a margin, clipped to this grid.

        It has at least one row and one column, at the edge of the grid where the points are off it.
        """
        return self.part(*self.around(x_m, y_m, margin_m))

    def around(self, x_m: Sequence[float], y_m: Sequence[float], margin_m: float) -> tuple[slice, slice]:
        """Returns the rows and columns of `patch`."""
        # In plain Python: agents do this several times a step, and NumPy takes ten times as long for two points.
        low = self.cell(min(x_m) - margin_m, min(y_m) - margin_m)
        high = self.cell(max(x_m) + margin_m, max(y_m) + margin_m)
        rows, cols = (
            slice(min(max(first, 0), size - 1), min(max(last, 0), size - 1) + 1)
            for first, last, size in zip(low, high, self.shape, strict=True)
        )
        return rows, cols


@dataclass(frozen=True, kw_only=True)
class Window:
    """A rectangle of a larger grid: its own frame, and its rows and columns in the larger one."""

    frame: GridFrame
    rows: slice
    cols: slice

    @property
    def index(self) -> tuple[slice, slice]:
        """The index of this rectangle in an array of the larger grid."""
        return self.rows, self.cols

    @property
    def corner(self) -> tuple[int, int]:
        """Row and column in the larger grid of this rectangle's first cell."""
        return self.rows.start, self.cols.start


def cells_near_segment(
    frame: GridFrame, start_xy_m: tuple[float, float], end_xy_m: tuple[float, float], radius_m: float
) -> tuple[tuple[slice, slice], Bool[np.ndarray, "rows cols"]]:
    """Returns the cells with their centre within `radius_m` of a segment: the area that a disc sweeps along it.

    The result is the index of a small rectangle of `frame` and the mask inside it.
    """
    (x0, y0), (x1, y1) = start_xy_m, end_xy_m
    rows, cols = frame.around((x0, x1), (y0, y1), radius_m)
    cell_m = frame.cell_m
    corner_m = frame.origin_xy_m[0] + cols.start * cell_m, frame.origin_xy_m[1] + rows.start * cell_m
    size = rows.stop - rows.start, cols.stop - cols.start
    return (rows, cols), mask_near_segment(*size, *corner_m, cell_m, x0, y0, x1, y1, radius_m)


def runs_of(cells: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Returns first and last + 1 of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], cells, [False]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
