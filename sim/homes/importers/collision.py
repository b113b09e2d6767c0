"""Makes the collision geoms of an object from its triangles: boxes of a grid, or convex parts by CoACD.

Boxes are cells of a grid of 5 cm that the surface passes through, joined to larger boxes and then reduced to the part
of the surface that they contain, so that a flat wall keeps its place and a doorway its width. Convex parts need the
package `coacd` (https://github.com/SarahWeiii/CoACD, Wei et al. 2022) of the extra `import`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_fill_holes, label

from sim.core.errors import HouseError
from sim.homes.housegen.imported.scene_files import library
from sim.homes.housegen.imported.solids import thickened
from sim.homes.importers.surfaces import Surface
from sim.homes.importers.visual import samples, spacing_within, welded

CELL_M = 0.05
"""Thinner boxes are made as thick as this."""
ALIKE_M = 0.025
"""Layers of a box are one box if their sides differ by less."""
SHIFTS = 5
"""Places of the grid that are tried along each axis: with the best one, uneven walls stay within one layer of cells."""
MAX_CELLS = 60_000_000
"""Cells of the grid of one object; of a larger object the cells are larger."""
MAX_POINTS = 4_000_000
"""Points of the surface of one object that fill the cells; with more, the cells are larger, too."""
CONCAVITY_M = 0.03
"""Largest depth of a hollow that a convex part fills, metres."""
MAX_PARTS = 64


def collision_boxes(corners_m: NDArray[np.float64], *, is_filled: bool = False) -> NDArray[np.float64]:
    """Returns boxes (n, 6), lowest corner and then highest, that contain all triangles.

    Args:
        corners_m: the triangles (m, 3, 3).
        is_filled: the inside of closed outlines of each level is filled too, so that no free place remains there; the
            inside of a ring that has nothing above or below, such as a skirting board, is free.
    """
    size_m, cell_m = np.ptp(corners_m.reshape(-1, 3), axis=0), CELL_M
    while np.prod(size_m / cell_m + 2.0) > MAX_CELLS:
        cell_m *= 1.5
    cell_m = 2.0 * spacing_within(corners_m, 0.5 * cell_m, MAX_POINTS)
    points = np.vstack([samples(corners_m, 0.5 * cell_m)[0], _on_edges(corners_m, 0.5 * cell_m)])
    origin = _origin(points, cell_m)
    index = np.floor((points - origin) / cell_m).astype(np.int64)
    low = index.min(axis=0)
    index -= low
    filled = np.zeros(tuple(index.max(axis=0) + 1), dtype=np.bool_)
    filled[tuple(index.T)] = True
    inner = np.zeros_like(filled)
    if is_filled:
        is_covered = filled.any(axis=2)
        for level in range(int(index[:, 2].max()) + 1):
            inside = np.asarray(binary_fill_holes(filled[:, :, level])) & ~filled[:, :, level]
            holes = np.asarray(label(inside)[0], dtype=np.int64)  # type: ignore[index]
            covered = np.bincount(holes.ravel(), is_covered.ravel()) >= 0.5 * np.bincount(holes.ravel())
            inner[:, :, level] = (holes > 0) & covered[holes]
    if inner.any():
        cells = np.argwhere(inner)
        index = np.vstack([index, cells, cells])
        points = np.vstack([points, *((corner + low) * cell_m + origin for corner in (cells, cells + 1))])
    ranges, of_cell = joined_cells(filled | inner)
    boxes = thickened(_tight(points, index, ranges, of_cell[tuple(index.T)]))
    return np.asarray(np.round(boxes, 4), dtype=np.float64)


def _tight(
    points: NDArray[np.float64], index: NDArray[np.int64], ranges: NDArray[np.int64], group: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Returns the boxes (n, 6) around the points of boxes of cells.

    A box is divided across its longest side where its layers differ: above a doorway, the cell at its edge has the
    lintel in it, which would make the doorway narrower.

    Args:
        points: (k, 3) metres.
        index: (k, 3) the cell of each point.
        ranges: (m, 6) cells of the boxes.
        group: (k,) the box of each point.
    """
    axis = (ranges[:, 3:] - ranges[:, :3]).argmax(axis=1)
    layers = (ranges[:, 3:] - ranges[:, :3]).max(axis=1)
    first = np.cumsum(layers) - layers
    layer = np.take_along_axis(index - ranges[group, :3], axis[group][:, None], axis=1)[:, 0]
    of_layer = _around(points, first[group] + layer, int(layers.sum()))
    made = []
    for start, count, along in zip(first.tolist(), layers.tolist(), axis.tolist(), strict=True):
        others = [n for n in range(6) if n % 3 != along]
        begin = None
        for box in of_layer[start : start + count]:
            if not np.isfinite(box[0]):
                continue
            if begin is not None and np.abs(box[others] - begin[others]).max() <= ALIKE_M:
                made[-1] = np.concatenate([np.minimum(made[-1][:3], box[:3]), np.maximum(made[-1][3:], box[3:])])
            else:
                begin = box
                made.append(box)
    return np.array(made)


def _origin(points: NDArray[np.float64], cell_m: float) -> NDArray[np.float64]:
    """Returns the origin (3,) of a grid in which the points fill few cells."""
    step_m = cell_m / SHIFTS
    cells = np.floor(points / step_m + 1e-4).astype(np.int64)
    fine = _distinct(cells)
    best = np.zeros(3, dtype=np.int64)
    for axis in range(3):
        columns = fine // SHIFTS
        columns[:, axis] = fine[:, axis]
        columns, filled = _distinct(columns), []
        for shift in range(SHIFTS):
            columns[:, axis] -= shift > 0
            layers = columns.copy()
            layers[:, axis] //= SHIFTS
            filled.append(len(_distinct(layers)))
        best[axis] = int(np.argmin(filled))
    return np.asarray((cells.min(axis=0) + best - 1e-4) * step_m, dtype=np.float64)


def _distinct(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Returns the different rows of cells (n, 3), relative to the lowest."""
    cells = cells - cells.min(axis=0)
    _, y, z = (cells.max(axis=0) + 1).tolist()
    code = np.unique((cells[:, 0] * y + cells[:, 1]) * z + cells[:, 2])
    return np.stack([code // (y * z), code // z % y, code % z], axis=1)


def _on_edges(corners_m: NDArray[np.float64], spacing_m: float) -> NDArray[np.float64]:
    """Returns points (k, 3) on the edges of triangles: a surface that ends between two cells has only these in one."""
    ends = np.stack([corners_m, corners_m[:, [1, 2, 0]]], axis=2).reshape(-1, 2, 3)
    count = np.maximum(1, np.ceil(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / spacing_m)).astype(np.int64)
    edge = np.repeat(np.arange(len(ends)), count)
    share = (np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)) / count[edge]
    return np.asarray(ends[edge, 0] + share[:, None] * (ends[edge, 1] - ends[edge, 0]), dtype=np.float64)


def _around(points: NDArray[np.float64], group: NDArray[np.int64], count: int) -> NDArray[np.float64]:
    """Returns the boxes (count, 6) around groups of points; those without a point are turned inside out."""
    order = np.argsort(group, kind="stable")
    firsts, start = np.unique(group[order], return_index=True)
    boxes = np.hstack([np.full((count, 3), np.inf), np.full((count, 3), -np.inf)])
    boxes[firsts, :3] = np.minimum.reduceat(points[order], start, axis=0)
    boxes[firsts, 3:] = np.maximum.reduceat(points[order], start, axis=0)
    return boxes


def joined_cells(filled: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Returns boxes of cells (n, 6), first and last + 1, that cover the filled cells, and the box of each cell.

    Runs of cells are joined to rectangles, and these to boxes, for three orders of the axes; the fewest boxes count.
    The box of a cell that is not filled is -1.
    """
    best: NDArray[np.int64] | None = None
    for axes in ((2, 0, 1), (0, 1, 2), (1, 0, 2)):
        boxes = _boxes_along(np.transpose(filled, axes))
        if best is None or len(boxes) < len(best):
            back = np.argsort(axes)
            best = np.hstack([boxes[:, :3][:, back], boxes[:, 3:][:, back]])
    assert best is not None
    of_cell = np.full(filled.shape, -1, dtype=np.int64)
    for number, (x0, y0, z0, x1, y1, z1) in enumerate(best.tolist()):
        of_cell[x0:x1, y0:y1, z0:z1] = number
    return best, of_cell


def _boxes_along(filled: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Returns boxes (n, 6): runs along the first axis, joined along the second and then along the third."""
    edges = np.diff(np.pad(filled, ((1, 1), (0, 0), (0, 0))).astype(np.int8), axis=0)
    first = np.argwhere(np.moveaxis(edges == 1, 0, 2))  # (n, 3): second, third axis, first cell of the run
    last = np.argwhere(np.moveaxis(edges == -1, 0, 2))
    runs = np.stack([first[:, 2], first[:, 0], first[:, 1], last[:, 2], first[:, 0] + 1, first[:, 1] + 1], axis=1)
    return _joined(_joined(runs, 1), 2)


def _joined(boxes: NDArray[np.int64], axis: int) -> NDArray[np.int64]:
    """Returns boxes; boxes that are adjacent along an axis and equal along the others are joined."""
    others = [n for n in (0, 3, 1, 4, 2, 5) if n % 3 != axis]
    order = np.lexsort([boxes[:, axis], *(boxes[:, n] for n in reversed(others))])
    boxes = boxes[order]
    follows = np.zeros(len(boxes), dtype=np.bool_)
    follows[1:] = (boxes[1:, others] == boxes[:-1, others]).all(axis=1) & (boxes[1:, axis] == boxes[:-1, axis + 3])
    starts = np.flatnonzero(~follows)
    ends = np.append(starts[1:], len(boxes)) - 1
    made = boxes[starts].copy()
    made[:, axis + 3] = boxes[ends, axis + 3]
    return made


def convex_parts(surfaces: Sequence[Surface]) -> list[NDArray[np.float64]]:
    """Returns the vertices (n, 3) of convex parts that together are about the object, the same in each run.

    Raises:
        HouseError: CoACD fails on the object.
    """
    coacd = library("coacd", extra="import")
    vertices, faces = welded(surfaces)
    coacd.set_log_level("error")
    try:
        hulls = coacd.run_coacd(
            coacd.Mesh(vertices, faces), threshold=CONCAVITY_M, real_metric=True, max_convex_hull=MAX_PARTS,
            preprocess_resolution=40, mcts_iterations=60, mcts_nodes=10, max_ch_vertex=32, seed=0,
        )  # fmt: skip
    except Exception as error:  # compiled code, which may raise any class
        raise HouseError(f"CoACD cannot divide an object into convex parts ({type(error).__name__}).") from None
    parts = [np.asarray(points, dtype=np.float64) for points, _ in hulls]
    return [part for part in parts if _has_volume(part)]


def _has_volume(points: NDArray[np.float64]) -> bool:
    return len(points) >= 4 and float(np.linalg.svd(points - points.mean(axis=0))[1][-1]) > 1e-4
