"""Chooses the lamps that light an image: fixed-function OpenGL has eight lights, a house has one lamp per room.

Directional lights are always on. Of the lamps, those nearest to the region that the camera looks at are on, unless a
wall is in between; the nearest casts the shadows of `sim.renderer.shading`. So each room is lit by its own lamp, and an
image needs one map of shadows in every house.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.renderer.occlusion import Visibility

MAX_LAMPS = 2
"""Largest number of lamps that are on in an image."""
ABOVE_EYE_M = (-0.85, 3.5)
"""Lamps lower or higher than this above the eye belong to another storey."""
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
        on = self._active.astype(np.bool_)
        directional = model.light_type == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL.value
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
        above_m = positions[:, 2] - eye_m[2]
        distance_m[(above_m < ABOVE_EYE_M[0]) | (above_m > ABOVE_EYE_M[1])] = np.inf
        nearest = np.argsort(distance_m, kind="stable")[:MAX_LAMPS]
        return [int(self._lamps[i]) for i in nearest if np.isfinite(distance_m[i])]

    def casts_shadows(self, lamp: int) -> bool:
        """Returns True for a lamp that shines down: only these have shadows."""
        model = self._model
        down = model.light_dir[lamp, 2] < -0.9 or model.light_type[lamp] != mujoco.mjtLightType.mjLIGHT_SPOT.value
        return bool(model.light_castshadow[lamp] and down)

    def lit_geoms(self, data: mujoco.MjData, lamp: int) -> NDArray[np.bool_]:
        """Returns (visual geoms,) True for geoms without a wall between them and the lamp, and for all movable ones."""
        if lamp not in self._lit:
            positions = data.geom_xpos[self._visual_ids]
            self._lit[lamp] = self._visibility.in_sight(data.light_xpos[lamp], positions) | ~self._static
        return self._lit[lamp]

    def switch_on(self, lamps: Sequence[int]) -> None:
        """Switches on these lamps and all others off, until `restore` is called."""
        others = np.setdiff1d(self._lamps, lamps)
        self._model.light_active[others] = 0

    def restore(self) -> None:
        """Restores the lights of the model."""
        self._model.light_active[:] = self._active
