"""Depth maps seen from the lamps of a house, from which soft shadows are computed.

A map shows what is below its lamp. It is rendered when the lamp first lights an image, and again when a movable geom
has moved since; most images need no new map.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40_ID
from sim.gl import mujoco
from sim.houses.labels import Labels
from sim.renderer.lamps import Lamps
from sim.renderer.occlusion import opaque_geoms
from sim.renderer.opengl import DEPTH_OFFSET, DEPTH_SLOPE
from sim.renderer.scene import GeomScene
from sim.renderer.shading_kernels import MAP_REACH_PX

MAP_PX = 320
"""Largest edge of a map; the frame buffer of the image limits it too."""
MAP_SLOPE = 2.2
"""Largest horizontal distance on a map, per metre below the lamp: 65 degrees to each side."""
_DOWN = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])  # forward, left, up
_NO_CASTERS = tuple(MPCAT40_ID[name] for name in ("lighting", "ceiling", "mirror"))
"""A lamp must not lie in the shadow of its own shade."""


class LampMaps:
    """The depth maps of one model.

    Args:
        model: compiled world.
        labels: category of each geom; lamps and transparent geoms cast no shadow.
        lamps: finds the geoms that a lamp lights.
        visual_ids: ids of the visual geoms.
        size_px: edge of a map.
    """

    def __init__(
        self, model: mujoco.MjModel, labels: Labels, lamps: Lamps, visual_ids: NDArray[np.intp], size_px: int
    ) -> None:
        self._lamps = lamps
        self._visual_ids = visual_ids
        self._casts = ~np.isin(labels.geom_category[visual_ids], _NO_CASTERS) & opaque_geoms(model)[visual_ids]
        self._movable = visual_ids[model.body_weldid[model.geom_bodyid[visual_ids]] != 0]
        self._rect = mujoco.MjrRect(0, 0, size_px, size_px)
        self._color = np.zeros((size_px, size_px, 3), np.uint8)
        self._maps: dict[int, tuple[bytes, NDArray[np.float32]]] = {}

    def of(self, data: mujoco.MjData, lamp: int, scene: GeomScene, context: mujoco.MjrContext) -> NDArray[np.float32]:
        """Returns the map of a lamp, (3, n, n): depth in metres, and the least and the largest depth around a pixel.

        Rows go to +x, columns to -y.

        Args:
            data: state of the model; kinematics must be computed.
            lamp: id of the light.
            scene: it is filled again if the map has to be rendered.
            context: frame buffer for ids.
        """
        at = data.geom_xpos[self._movable].tobytes() + data.geom_xmat[self._movable].tobytes()
        if lamp not in self._maps or self._maps[lamp][0] != at:
            geoms = self._visual_ids[self._lamps.lit_geoms(data, lamp) & self._casts]
            scene.fill(data, geoms, data.light_xpos[lamp], _DOWN, (MAP_SLOPE, MAP_SLOPE))
            scene.render_ids(self._rect, context)
            depth = np.zeros(self._color.shape[:2], np.float32)
            mujoco.mjr_readPixels(self._color, depth, self._rect, context)
            depth = 1.0 / (depth * np.float32(DEPTH_SLOPE) + np.float32(DEPTH_OFFSET))
            around = np.ones((2 * MAP_REACH_PX + 3, 2 * MAP_REACH_PX + 3), np.uint8)
            self._maps[lamp] = (at, np.array([depth, cv2.erode(depth, around), cv2.dilate(depth, around)], np.float32))
        return self._maps[lamp][1]
