"""The spans of height that the rendered geoms of a house occupy above the cells of a grid.

An upright box (walls, most furniture boards) occupies the cells that it covers by half or more, and at least one row
of cells where it is thinner than a cell, over its whole height. The surface of any other geom is sampled, and the
cells and heights that hold a sample are occupied: between the seat and the floor of a chair there remains free space.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from sim.core.geometry.grid import GridFrame
from sim.core.interface import MPCAT40_ID
from sim.gl import mujoco
from sim.homes.plans.span_kernels import mark_triangles, merge_spans, runs_of_marks
from sim.houses.geoms import geom_polytope, mesh_triangles
from sim.houses.labels import Labels, geoms_of, rendered_geoms
from sim.robot.body import PREFIX

SAMPLE_M = 0.02
"""Height of the boxes, one above the other over each cell, that are searched for samples of a surface."""
TOP_M = 3.15
"""Higher parts are left out."""
_UPRIGHT = 1.0 - 1e-6
_LAST = [MPCAT40_ID[name] for name in ("wall", "ceiling", "window", "door", "void")]

Spans = tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.float32], NDArray[np.uint16]]
"""`span_start`, `span_low_m`, `span_high_m` and `span_instance` of `sim.homes.plans.plan.Plan`."""


def occupied_spans(
    model: mujoco.MjModel, data: mujoco.MjData, labels: Labels, frame: GridFrame, floor_z_m: float
) -> Spans:
    """Returns the spans above the cells of a grid, of all rendered geoms but floors and ceilings.

    A geom without an instance belongs to the instance of index `len(labels.instances)`.

    Args:
        model: a compiled house or world; a robot in it is left out.
        data: its state; kinematics must be computed.
        labels: of `model`.
        frame: the grid.
        floor_z_m: height of the storey's floor.
    """
    skipped = np.isin(labels.geom_category, [MPCAT40_ID["floor"], MPCAT40_ID["ceiling"]])
    parts = []
    for geom in np.flatnonzero(rendered_geoms(model) & ~skipped & ~geoms_of(model, PREFIX)).tolist():
        instance = int(labels.geom_instance[geom])
        for cells, low_m, high_m in _of_geom(model, data, geom, frame, floor_z_m):
            owner = np.full(len(cells), instance if instance >= 0 else len(labels.instances), np.int64)
            late = np.full(len(cells), labels.geom_category[geom] in _LAST)
            parts.append((cells, owner, late, low_m, high_m))
    size = frame.shape[0] * frame.shape[1]
    if not parts:
        return np.zeros(size + 1, np.int32), np.zeros(0, np.float32), np.zeros(0, np.float32), np.zeros(0, np.uint16)
    cells, owner, late, low_m, high_m = (np.concatenate(column) for column in zip(*parts, strict=True))
    kept = (high_m > 0.0) & (low_m < TOP_M)
    order = np.flatnonzero(kept)[np.lexsort((low_m[kept], owner[kept], late[kept], cells[kept]))]
    cells, owner, low_m, high_m = merge_spans(cells[order], owner[order], low_m[order], high_m[order], SAMPLE_M)
    start = np.concatenate(([0], np.cumsum(np.bincount(cells, minlength=size))))
    low_m, high_m = np.clip(low_m, 0.0, TOP_M), np.clip(high_m, 0.0, TOP_M)
    return start.astype(np.int32), low_m.astype(np.float32), high_m.astype(np.float32), owner.astype(np.uint16)


def _of_geom(
    model: mujoco.MjModel, data: mujoco.MjData, geom: int, frame: GridFrame, floor_z_m: float
) -> Iterator[tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]]:
    """Yields row-major cells with the lower and upper ends of the spans that a geom occupies."""
    rotation = data.geom_xmat[geom].reshape(3, 3)
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_BOX and np.abs(rotation[2]).max() > _UPRIGHT:
        cells = _box_cells(rotation, data.geom_xpos[geom], model.geom_size[geom], frame)
        half_m = float(np.abs(rotation[2]) @ model.geom_size[geom])
        z_m = float(data.geom_xpos[geom, 2]) - floor_z_m
        yield cells, np.full(len(cells), z_m - half_m), np.full(len(cells), z_m + half_m)
        return
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
        triangles_m = mesh_triangles(model, data, geom)
    else:
        triangles_m = _hull_triangles(geom_polytope(model, data, geom, rendered=True).vertices_m)
    triangles_m = triangles_m - (0.0, 0.0, floor_z_m)
    yield _surface_spans(triangles_m, frame)


def _surface_spans(
    triangles_m: NDArray[np.float64], frame: GridFrame
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Returns row-major cells with the lower and upper ends of the spans that hold samples of triangles (n, 3, 3)."""
    nothing = np.zeros(0, np.int64), np.zeros(0), np.zeros(0)
    if len(triangles_m) == 0:
        return nothing
    triangles_m = _shrunk(triangles_m, frame.cell_m)
    low, high = triangles_m.min(axis=(0, 1)), triangles_m.max(axis=(0, 1))
    rows, cols = frame.index_of((float(low[0]), float(low[1]), float(high[0]), float(high[1])))
    first = math.floor(max(low[2], 0.0) / SAMPLE_M)
    heights = math.ceil(min(high[2], TOP_M) / SAMPLE_M) - first + 1
    shape = (rows.stop - rows.start, cols.stop - cols.start, heights)
    if min(shape) < 1:
        return nothing
    x_m, y_m = frame.origin_xy_m
    corner_m = np.array([y_m + rows.start * frame.cell_m, x_m + cols.start * frame.cell_m, first * SAMPLE_M])
    boxes = (triangles_m[..., [1, 0, 2]] - corner_m) / (frame.cell_m, frame.cell_m, SAMPLE_M)
    marks = np.zeros(shape, np.bool_)
    mark_triangles(boxes, 0.9, marks)
    runs = runs_of_marks(marks)
    cells = (runs[:, 0] + rows.start) * frame.shape[1] + runs[:, 1] + cols.start
    return cells, (runs[:, 2] + first) * SAMPLE_M, (runs[:, 3] + first) * SAMPLE_M


def _shrunk(triangles_m: NDArray[np.float64], cell_m: float) -> NDArray[np.float64]:
    """Returns a surface that is smaller in plan by half a cell on each side: any sample occupies a whole cell."""
    low, high = triangles_m.min(axis=(0, 1)), triangles_m.max(axis=(0, 1))
    size_m = np.maximum(high - low, 1e-6)
    share = np.maximum(size_m - cell_m, 0.002) / np.maximum(size_m, 0.002)
    share[2] = 1.0
    middle = 0.5 * (low + high)
    return middle + (triangles_m - middle) * share


def _box_cells(
    rotation: NDArray[np.float64], centre_m: NDArray[np.float64], half_m: NDArray[np.float64], frame: GridFrame
) -> NDArray[np.int64]:
    """Returns the row-major cells that an upright box covers: the separating axis test of a cell and a smaller box."""
    sides = [axis for axis in range(3) if abs(rotation[2, axis]) < 0.5]
    reach_m = sum(half_m[axis] * np.abs(rotation[:2, axis]) for axis in sides)
    low, high = centre_m[:2] - reach_m, centre_m[:2] + reach_m
    window = frame.index_of((float(low[0]), float(low[1]), float(high[0]), float(high[1])))
    x_m, y_m = frame.axes(window)
    dx, dy = (x_m - centre_m[0])[None, :], (y_m - centre_m[1])[:, None]
    covered = np.ones((len(y_m), len(x_m)), np.bool_)
    half_cell_m = 0.5 * frame.cell_m
    for axis in sides:
        normal, extent_m = rotation[:2, axis], float(half_m[axis])
        cell_m = half_cell_m * float(np.abs(normal).sum())
        shrunk_m = max(extent_m - half_cell_m, 0.001)
        covered &= np.abs(normal[0] * dx + normal[1] * dy) <= shrunk_m + cell_m - 1e-9
    rows, cols = np.nonzero(covered)
    return (rows + window[0].start) * frame.shape[1] + cols + window[1].start


def _hull_triangles(vertices_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the triangles (n, 3, 3) of the surface of a convex body; none when it is flat."""
    try:
        return vertices_m[ConvexHull(vertices_m).simplices]
    except QhullError:
        return np.zeros((0, 3, 3))
