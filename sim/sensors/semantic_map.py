"""A map of the true categories around the robot, seen from above: an oracle for studies of planning (`semantic_map`).

A cell shows the category of the highest visible geom above it that begins below `TOP_M`, without the ceiling and lamps.
"""

from __future__ import annotations

import math
import weakref
from dataclasses import dataclass, field

import cv2
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.geometry.convex import polygon_from_above
from sim.core.interface import MPCAT40, MPCAT40_ID, SEMANTIC_MAP, CameraModel
from sim.gl import mujoco
from sim.houses.geoms import geom_polytope, is_hollow, mesh_triangles
from sim.houses.labels import rendered_geoms
from sim.sensors.ranges import require_range, require_whole
from sim.sensors.sensor import NoiseSettings, SensorContext

TOP_M = 1.8
"""Geoms that begin higher above the floor do not count, such as the upper parts of a doorway."""
BELOW_M = 0.3
"""Geoms that end farther below the floor belong to another storey."""
_LEFT_OUT = tuple(MPCAT40_ID[name] for name in ("void", "ceiling", "lighting"))
_SHIFT = 4
"""Bits of the fraction of a pixel in which OpenCV takes corners."""


@dataclass(frozen=True, kw_only=True)
class MapConfig:
    """The size of the map."""

    cells: int = 200
    """Cells along each side."""
    cell_m: float = 0.05

    def __post_init__(self) -> None:
        require_whole(self, 1, 2000, "cells")
        require_range(self, 0.001, 10.0, "cell_m")


@dataclass(frozen=True, kw_only=True)
class SemanticMapSensor:
    """The categories around the robot; ground truth. The robot is in the middle and drives towards row 0."""

    config: MapConfig = field(default_factory=MapConfig)
    name: str = SEMANTIC_MAP
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("pose", "model", "data", "labels")
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of uint8 maps (cells, cells), mpcat40 ids; 0: nothing."""
        return spaces.Box(0, len(MPCAT40) - 1, (self.config.cells, self.config.cells), np.uint8)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the map (cells, cells): rows go back, columns to the right."""
        model, data, pose, config = context.model, context.data, context.pose, self.config
        image = np.zeros((config.cells, config.cells), np.uint8)
        geoms = np.flatnonzero(rendered_geoms(model) & ~np.isin(context.labels.geom_category, _LEFT_OUT))
        reach_m = config.cells * config.cell_m * math.sqrt(0.5)
        radius_m = np.where(model.geom_rbound[geoms] > 0.0, model.geom_rbound[geoms], np.inf)
        off_m = np.hypot(*(data.geom_xpos[geoms, :2] - (pose.x_m, pose.y_m)).T)
        layers = []
        for geom in geoms[off_m - radius_m <= reach_m].tolist():
            low_m, top_m, outlines = _outlines(model, data, geom)
            if low_m - pose.floor_z_m < TOP_M and top_m - pose.floor_z_m > -BELOW_M:
                layers.append((top_m, int(context.labels.geom_category[geom]), outlines))
        c, s = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        turn = np.array([[-c, -s], [s, -c]])  # to back and right
        for _, category, outlines in sorted(layers, key=lambda layer: layer[0]):
            cells = (outlines - (pose.x_m, pose.y_m)) @ turn.T / config.cell_m + 0.5 * config.cells - 0.5
            near = np.all((cells.max(axis=1) > -1.0) & (cells.min(axis=1) < config.cells), axis=1)
            for corners in np.round(cells[near, :, ::-1] * (1 << _SHIFT)).astype(np.int32):
                cv2.fillConvexPoly(image, corners, category, shift=_SHIFT)
        return image


_known: weakref.WeakKeyDictionary[mujoco.MjModel, dict[int, tuple[float, float, NDArray]]] = weakref.WeakKeyDictionary()
"""Outlines of the geoms of each model that cannot move."""


def _outlines(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> tuple[float, float, NDArray]:
    """Returns the heights of the lowest and the highest point of a geom, and its convex outlines (n, k, 2) in plan."""
    known = _known.setdefault(model, {})
    if geom in known:
        return known[geom]
    body = geom_polytope(model, data, geom, rendered=True)
    polygon = polygon_from_above(body)
    outlines = np.zeros((0, 3, 2)) if polygon is None else polygon.vertices_m[None]
    if polygon is not None and is_hollow(model, geom):
        outlines = mesh_triangles(model, data, geom)[..., :2]
    result = float(body.vertices_m[:, 2].min()), float(body.vertices_m[:, 2].max()), outlines
    if model.body_weldid[model.geom_bodyid[geom]] == 0:
        known[geom] = result
    return result
