"""How little a depth camera's light comes back from each geom: glass, mirrors, polished metal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.houses.labels import Labels
from sim.interface import MPCAT40_ID

_GLASS_CATEGORIES = tuple(MPCAT40_ID[name] for name in ("mirror", "window"))


def geom_gloss(model: mujoco.MjModel, labels: Labels) -> NDArray[np.float32]:
    """Gloss (ngeom,) of every geom in [0, 1]: 0 matt, 1 a perfect mirror or pane.

    It is the largest of the geom's transparency (1 - alpha), its material's reflectance, and specular times shininess.
    A mirror or a window without any material, as in houses from elsewhere, counts as 1.
    """
    material = model.geom_matid
    plain = material < 0
    transparency = 1.0 - np.where(plain, model.geom_rgba[:, 3], _of_geoms(model.mat_rgba[:, 3], material, 1.0))
    reflectance = _of_geoms(model.mat_reflectance, material, 0.0)
    polish = _of_geoms(model.mat_specular * model.mat_shininess, material, 0.0)
    gloss = np.maximum.reduce([transparency, reflectance, polish])
    gloss[plain & np.isin(labels.geom_category, _GLASS_CATEGORIES)] = 1.0
    return np.clip(gloss, 0.0, 1.0).astype(np.float32)


def _of_geoms(of_materials: NDArray, material: NDArray[np.int32], without: float) -> NDArray[np.float64]:
    """A material's property by geom; `without` where a geom has none."""
    return np.append(of_materials.astype(np.float64), without)[material]
