"""Which lamps light a picture: fixed-function OpenGL has eight lights, a home has a lamp in every room.

Light that is the same everywhere always shines. Of the lamps, those nearest to what the camera looks at count, as long
as no wall stands between; the nearest throws shadows. So each room is lit by its own lamp, and a picture costs one
shadow map whatever the house.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.sensors.occlusion import Visibility

LAMPS_LIT = 2
"""Lamps that shine at once."""
LOOK_AHEAD_M = 1.5
"""Nearest is meant from here before the eye."""


class Lamps:
    """The lamps of one model.

    Args:
        model: compiled world.
        visibility: knows its walls.
        drawable: ids of the geoms that are rendered at all.
    """

    def __init__(self, model: mujoco.MjModel, visibility: Visibility, drawable: NDArray[np.intp]) -> None:
        self._model = model
        self._visibility = visibility
        self._drawable = drawable
        self._shining = model.light_active.copy()
        self._casts = model.light_castshadow.copy()
        everywhere = model.light_type == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL.value
        self._sun_casts = bool((self._shining.astype(np.bool_) & self._casts.astype(np.bool_) & everywhere).any())
        self._lamps = np.flatnonzero(self._shining.astype(np.bool_) & ~everywhere)
        self._fixed = model.body_weldid[model.geom_bodyid[drawable]] == 0  # (drawable,)
        self._lit: dict[int, NDArray[np.bool_]] = {}

    def choose(self, data: mujoco.MjData, eye_m: NDArray, forward: NDArray) -> list[int]:
        """Numbers of the lamps that shine, the one that throws shadows first.

        Args:
            data: state of the model; kinematics must be up to date.
            eye_m: (3,) optical centre in the world.
            forward: (3,) where the camera looks.
        """
        places = data.light_xpos[self._lamps]  # (k, 3)
        away_m = np.linalg.norm(places - (eye_m + LOOK_AHEAD_M * forward), axis=1)
        away_m[~self._visibility.in_sight(eye_m, places)] = np.inf
        nearest = np.argsort(away_m, kind="stable")[:LAMPS_LIT]
        return [int(self._lamps[i]) for i in nearest if np.isfinite(away_m[i])]

    def lit(self, data: mujoco.MjData, lamp: int) -> NDArray[np.bool_]:
        """(drawable,) True for geoms that this lamp shines on: no wall stands between."""
        if lamp not in self._lit:
            places = data.geom_xpos[self._drawable]
            self._lit[lamp] = self._visibility.in_sight(data.light_xpos[lamp], places) | ~self._fixed
        return self._lit[lamp]

    def casters(self, data: mujoco.MjData, lamp: int, eye_m: NDArray, axes: NDArray) -> NDArray[np.intp]:
        """Ids of the drawable geoms that no wall hides from a lamp and whose shadow may fall into the picture.

        A sun that throws shadows too lets all stay that the lamp shines on.

        Args:
            data: state of the model, the one that `visibility` has looked at last.
            lamp: its number.
            eye_m: (3,) optical centre in the world.
            axes: (3, 3) the camera's forward, left and up as rows.
        """
        lit = self.lit(data, lamp)
        if not self._sun_casts:
            lit = lit & self._visibility.shading(data.light_xpos[lamp], eye_m, axes)
        return self._drawable[lit]

    def light(self, lamps: Sequence[int]) -> None:
        """Let these lamps shine in the model, the first with shadows; all others are off until `restore`."""
        others = np.setdiff1d(self._lamps, lamps)
        self._model.light_active[others] = 0
        self._model.light_castshadow[list(lamps[1:])] = 0

    def restore(self) -> None:
        """The model as it was."""
        self._model.light_active[:] = self._shining
        self._model.light_castshadow[:] = self._casts
