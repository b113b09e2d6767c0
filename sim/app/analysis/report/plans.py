"""Draws floor plans for a page: outlines of the objects on a storey as SVG paths.

Coordinates on a page are whole centimetres, x to the right and y down, from the upper left corner of the storey's grid
(`sim.world.freespace`). So the plan of a house is drawn once, and the paths of all its episodes fit over it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypedDict

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.core.geometry.convex import polygon_from_above
from sim.core.geometry.grid import GridFrame
from sim.core.interface import GOAL_CATEGORIES
from sim.gl import mujoco
from sim.houses.geoms import data_at_rest, geom_polytope, mesh_is_convex, mesh_triangles
from sim.houses.house import Room
from sim.houses.labels import rendered_geoms
from sim.task.ground_truth import GroundTruth
from sim.world.freespace import CELL_M, FreeSpace

PX_M = 100.0
"""Units of the page in a metre."""
CUT_M = (0.9, 1.3)
"""Walls, doors and windows are cut between these heights above the floor, so that lintels leave doorways open."""
HIGHEST_M, HIGHEST_GOAL_M = 1.9, 2.6
"""Objects and goals whose lower edge is higher than this above the floor are left out."""
CUT = ("wall", "door", "window", "column")
LEFT_OUT = frozenset({"floor", "ceiling", "beam", "lighting", "void", *CUT})
SMOOTH_PX = 1.5
"""Largest distance of a simplified outline from the true one."""


class Plan(TypedDict):
    """The drawing of one storey, JSON types."""

    size: tuple[int, int]
    floor: list[list[int]]
    """Rectangles."""
    shapes: list[list[str]]
    """[category, name, SVG path], from the lowest up."""
    rooms: list[list[str | int]]
    """[name, x, y, width]."""


@dataclass(frozen=True)
class Sheet:
    """The place of a storey on the page."""

    frame: GridFrame

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height."""
        rows, cols = self.frame.shape
        return round(cols * self.frame.cell_m * PX_M), round(rows * self.frame.cell_m * PX_M)

    def place(self, xy_m: ArrayLike) -> NDArray[np.int32]:
        """Returns (n, 2) points on the page of points (n, 2) in the world."""
        xy = (np.asarray(xy_m, np.float64).reshape(-1, 2) - self.frame.origin_xy_m) * PX_M
        return np.stack([xy[:, 0], self.size_px[1] - xy[:, 1]], axis=1).round().astype(np.int32)


def sheet_around(positions_m: NDArray[np.floating]) -> Sheet:
    """Returns a sheet for positions (n, 2) in a house that cannot be loaded, with a margin of 1 m."""
    low, high = positions_m.min(axis=0) - 1.0, positions_m.max(axis=0) + 1.0
    cols, rows = np.ceil((high - low) / CELL_M).astype(int).tolist()
    return Sheet(GridFrame(origin_xy_m=(float(low[0]), float(low[1])), shape=(rows, cols), cell_m=CELL_M))


def draw_plan(truth: GroundTruth, floor_z_m: float) -> Plan:
    """Returns the drawing of one storey."""
    sheet = Sheet(truth.space(floor_z_m).frame)
    rooms = [room for room in truth.world.rooms if abs(room.floor_z_m - floor_z_m) < truth.world.rule.same_storey_m]
    return {
        "size": sheet.size_px,
        "floor": _rectangles(sheet, rooms),
        "shapes": [*_objects(truth, sheet, floor_z_m), *_structure(truth, sheet, floor_z_m)],
        "rooms": [[room.kind.replace("_", " "), *_label_place(sheet, room)] for room in rooms],
    }


def draw_area(space: FreeSpace, mask: NDArray[np.bool_]) -> str:
    """Returns the outline of some cells of a free space as an SVG path; "" for none."""
    sheet = Sheet(space.frame)
    scale = space.frame.cell_m * PX_M
    image = cv2.resize(mask.astype(np.uint8)[::-1], sheet.size_px, interpolation=cv2.INTER_NEAREST)
    return _outline(np.asarray(image, np.uint8), (0, 0), smooth_px=scale)


def _objects(truth: GroundTruth, sheet: Sheet, floor_z_m: float) -> Iterable[list[str]]:
    """Returns the shapes of the objects on this storey."""
    model, labels = truth.world.model, truth.world.labels
    data, rendered = data_at_rest(model), rendered_geoms(model)
    shapes: list[tuple[float, list[str]]] = []
    for instance in labels.instances:
        geoms = [geom for geom in instance.geom_ids if rendered[geom]]
        if instance.category in LEFT_OUT or not geoms:
            continue
        z_m = np.concatenate([geom_polytope(model, data, geom, rendered=True).vertices_m[:, 2] for geom in geoms])
        low_m, top_m = float(z_m.min()) - floor_z_m, float(z_m.max())
        highest_m = HIGHEST_GOAL_M if instance.category in GOAL_CATEGORIES else HIGHEST_M
        if -truth.world.rule.same_storey_m < low_m <= highest_m:
            parts = [part for geom in geoms for part in _cut(model, data, geom, -math.inf, math.inf)]
            shapes.append((top_m, [instance.category, instance.name, _union(sheet, parts)]))
    return [shape for _, shape in sorted(shapes, key=lambda item: item[0])]


def _structure(truth: GroundTruth, sheet: Sheet, floor_z_m: float) -> Iterable[list[str]]:
    """Yields the cut walls, doors, windows and columns; each category is one SVG path."""
    model, labels = truth.world.model, truth.world.labels
    data, rendered = data_at_rest(model), rendered_geoms(model)
    low_m, high_m = floor_z_m + CUT_M[0], floor_z_m + CUT_M[1]
    for category in CUT:
        polygons = [
            polygon
            for instance in labels.of_category(category)
            for geom in instance.geom_ids
            if rendered[geom]
            for polygon in _cut(model, data, geom, low_m, high_m)
        ]
        if path := _union(sheet, polygons):
            yield [category, category, path]


def _cut(
    model: mujoco.MjModel, data: mujoco.MjData, geom: int, low_m: float, high_m: float
) -> list[NDArray[np.float64]]:
    """Returns polygons (k, 2) in plan of a geom between two heights; those of a concave mesh may be lines."""
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH and not mesh_is_convex(model, geom):
        triangles = mesh_triangles(model, data, geom)
        reach = (triangles[..., 2].min(axis=1) <= high_m) & (triangles[..., 2].max(axis=1) >= low_m)
        return list(triangles[reach][..., :2])
    polygon = polygon_from_above(geom_polytope(model, data, geom, rendered=True), low_m, high_m)
    return [] if polygon is None else [polygon.vertices_m]


def _union(sheet: Sheet, polygons_m: Sequence[NDArray[np.float64]]) -> str:
    """Returns the outline of the union of convex polygons (k, 2) as an SVG path."""
    if not polygons_m:
        return ""
    polygons = [sheet.place(polygon) for polygon in polygons_m]
    low = np.min([polygon.min(axis=0) for polygon in polygons], axis=0)
    high = np.max([polygon.max(axis=0) for polygon in polygons], axis=0)
    low, high = np.maximum(low, 0), np.minimum(high, sheet.size_px)
    if np.any(high <= low):
        return ""
    image = np.zeros((high[1] - low[1] + 1, high[0] - low[0] + 1), np.uint8)
    for polygon in polygons:
        cv2.fillConvexPoly(image, polygon - low, 1)
    return _outline(image, (int(low[0]), int(low[1])))


def _outline(image: NDArray[np.uint8], corner_px: tuple[int, int], smooth_px: float = SMOOTH_PX) -> str:
    """Returns the contours of a mask, with holes (fill-rule evenodd), as an SVG path of relative lines."""
    contours, _ = cv2.findContours(image, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_SIMPLE, offset=corner_px)
    parts = []
    for contour in contours:
        corners = np.asarray(cv2.approxPolyDP(contour, smooth_px, closed=True)).reshape(-1, 2)
        if len(corners) > 2:
            steps = np.diff(corners, axis=0).tolist()
            parts.append(f"M{corners[0][0]} {corners[0][1]}l" + " ".join(f"{dx} {dy}" for dx, dy in steps) + "z")
    return "".join(parts)


def _rectangles(sheet: Sheet, rooms: Sequence[Room]) -> list[list[int]]:
    """Returns [x, y, width, height] of the boxes of the rooms, or of the whole sheet if no room is declared."""
    rectangles = []
    for room in rooms:
        for (x, y, _), (hx, hy, _) in room.boxes:
            (left, bottom), (right, top) = sheet.place([(x - hx, y - hy), (x + hx, y + hy)]).tolist()
            rectangles.append([left, top, right - left, bottom - top])
    return rectangles or [[0, 0, *sheet.size_px]]


def _label_place(sheet: Sheet, room: Room) -> list[int]:
    """Returns [x, y, width]: the middle of the largest box of a room, and its width."""
    (x, y, _), (half_m, _, _) = max(room.boxes, key=lambda box: box[1][0] * box[1][1])
    return [*sheet.place([(x, y)])[0].tolist(), round(2.0 * half_m * PX_M)]
