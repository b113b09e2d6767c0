"""The gloss of geoms, which decides how much of a depth camera's light returns: glass, mirrors, polished metal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40_ID
from sim.gl import mujoco
from sim.houses.labels import Labels, opacity

_GLASS_CATEGORIES = tuple(MPCAT40_ID[name] for name in ("mirror", "window"))


def geom_gloss(model: mujoco.MjModel, labels: Labels) -> NDArray[np.float32]:
    """Returns the gloss (ngeom,) of all geoms in [0, 1]: 0 is matt, 1 a perfect mirror or pane of glass.

    It is the largest of the geom's transparency (1 - alpha), its material's reflectance, and specular times shininess.
    A mirror or a window without a material, as in third-party scenes, has gloss 1.
    """
    material = model.geom_matid
    plain = material < 0
    transparency = 1.0 - opacity(model)
    reflectance = _of_geoms(model.mat_reflectance, material)
    polish = _of_geoms(model.mat_specular * model.mat_shininess, material)
    gloss = np.maximum.reduce([transparency, reflectance, polish])
    gloss[plain & np.isin(labels.geom_category, _GLASS_CATEGORIES)] = 1.0
    return np.clip(gloss, 0.0, 1.0).astype(np.float32)


def _of_geoms(of_materials: NDArray, material: NDArray[np.int32]) -> NDArray[np.float64]:
    """Returns a material property (ngeom,) by geom; 0 for geoms without a material."""
    return np.append(of_materials.astype(np.float64), 0.0)[material]
