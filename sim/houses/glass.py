"""Finds the panes of windows: light passes them, and only a share of the light of a depth sensor returns.

Glass reflects 4 % of the light at each of its two faces (Fresnel's equations for an index of 1.5 and light that falls
straight in); Foster, Sun, Park, Kuipers, "VisAGGE: visible angle grid for glass environments", ICRA 2013, measured that
a lidar sees panes in few of its rays.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40_ID
from sim.gl import mujoco
from sim.houses.labels import Labels, opacity

RETURN_SHARE = 0.08
"""Share of the rays that a pane returns."""
PICTURE_PREFIX = "view_"
"""Textures with this prefix show the outside on a pane at the outer face of a wall."""


def picture_panes(model: mujoco.MjModel, labels: Labels) -> NDArray[np.bool_]:
    """Returns (ngeom,) True for panes that show a picture of the outside."""
    textures = np.zeros(model.ntex + 1, np.bool_)  # the last entry is for -1, no texture
    textures[:-1] = [model.tex(number).name.startswith(PICTURE_PREFIX) for number in range(model.ntex)]
    materials = np.append(textures[model.mat_texid].any(axis=1), False) if model.nmat else np.zeros(1, np.bool_)
    return _of_windows(labels) & materials[model.geom_matid]


def clear_panes(model: mujoco.MjModel, labels: Labels) -> NDArray[np.bool_]:
    """Returns (ngeom,) True for transparent panes."""
    return _of_windows(labels) & (opacity(model) < 1.0)


def returning(shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Returns which rays a pane returns: the same `RETURN_SHARE` of the rays of a sensor in each reading."""
    return np.random.default_rng(0).random(shape) < RETURN_SHARE


def _of_windows(labels: Labels) -> NDArray[np.bool_]:
    return labels.geom_category == MPCAT40_ID["window"]
