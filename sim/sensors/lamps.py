"""Chooses the lamps that light an image: fixed-function OpenGL has eight lights, a house has one lamp per room.

Directional lights are always on. Of the lamps, those nearest to the region that the camera looks at are on, unless a
wall is in between; the nearest casts shadows. So each room is lit by its own lamp, and an image needs one shadow map
in every house.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.sensors.occlusion import Visibility

MAX_LAMPS = 2
"""Largest number of lamps that are on in an image."""
LOOK_AHEAD_M = 1.5
"""Distances of lamps are measured from the point this far ahead of the eye."""


class Lamps:
    """The lamps of one model.

    Args:
        model: compiled world.
        visibility: finds the walls of `model`.
        visual_ids: ids of the visual geoms.
    """

    def __init__(self, model: mujoco.MjModel, visibility: Visibility, visual_ids: NDArray[np.intp]) -> None:
        self._model = model
        self._visibility = visibility
        self._visual_ids = visual_ids
        self._active = model.light_active.copy()
        self._casts_shadow = model.light_castshadow.copy()
        on, casts = self._active.astype(np.bool_), self._casts_shadow.astype(np.bool_)
        directional = model.light_type == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL.value
        self._directional_casts = bool((on & casts & directional).any())
        self._lamps = np.flatnonzero(on & ~directional)
        self._static = model.body_weldid[model.geom_bodyid[visual_ids]] == 0  # (visual geoms,)
        self._lit: dict[int, NDArray[np.bool_]] = {}

    def choose(self, data: mujoco.MjData, eye_m: NDArray, forward: NDArray) -> list[int]:
        """Returns the ids of the lamps that light an image, the one that casts shadows first.

        Args:
            data: state of the model; kinematics must be computed.
            eye_m: (3,) optical centre in the world.
            forward: (3,) optical axis.
        """
        positions = data.light_xpos[self._lamps]  # (k, 3)
        distance_m = np.linalg.norm(positions - (eye_m + LOOK_AHEAD_M * forward), axis=1)
        distance_m[~self._visibility.in_sight(eye_m, positions)] = np.inf
        nearest = np.argsort(distance_m, kind="stable")[:MAX_LAMPS]
        return [int(self._lamps[i]) for i in nearest if np.isfinite(distance_m[i])]

    def lit_geoms(self, data: mujoco.MjData, lamp: int) -> NDArray[np.bool_]:
        """Returns (visual geoms,) True for geoms without a wall between them and the lamp, and for all movable ones."""
        if lamp not in self._lit:
            positions = data.geom_xpos[self._visual_ids]
            self._lit[lamp] = self._visibility.in_sight(data.light_xpos[lamp], positions) | ~self._static
        return self._lit[lamp]

    def shadow_casters(self, data: mujoco.MjData, lamp: int, eye_m: NDArray, axes: NDArray) -> NDArray[np.intp]:
        """Returns the ids of the visual geoms that a lamp lights and whose shadow may fall into the image.

        With a directional light that casts shadows, these are all geoms that the lamp lights.

        Args:
            data: state of the model; it must be the one of the last call of `Visibility.visible`.
            lamp: id of the lamp.
            eye_m: (3,) optical centre in the world.
            axes: (3, 3) the camera's forward, left and up as rows.
        """
        lit = self.lit_geoms(data, lamp)
        if not self._directional_casts:
            lit = lit & self._visibility.may_shade(data.light_xpos[lamp], eye_m, axes)
        return self._visual_ids[lit]

    def switch_on(self, lamps: Sequence[int]) -> None:
        """Switches on these lamps, the first with shadows, and all others off, until `restore` is called."""
        others = np.setdiff1d(self._lamps, lamps)
        self._model.light_active[others] = 0
        self._model.light_castshadow[list(lamps[1:])] = 0

    def restore(self) -> None:
        """Restores the lights of the model."""
        self._model.light_active[:] = self._active
        self._model.light_castshadow[:] = self._casts_shadow
