"""The shape of a track as evidence for its category: heights, extents, and how much of it is horizontal.

Furniture of an unknown style keeps the heights and the size of its kind: a seat is 0.45 m high, a picture is thin and
hangs on a wall. Each measure is described by hat functions around fixed values, so that the log-odds that
`stubborn.detection.fusion_fit` fits are piecewise linear in the measure.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from jaxtyping import Float32

MEASURES: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {
        "bottom_m": (0.0, 0.15, 0.35, 0.6, 0.9, 1.3),
        "top_m": (0.2, 0.45, 0.65, 0.85, 1.1, 1.5, 2.0),
        "long_m": (0.15, 0.3, 0.5, 0.8, 1.3, 2.0),
        "short_m": (0.1, 0.2, 0.4, 0.7, 1.1),
        "upright_m": (0.1, 0.2, 0.4, 0.8, 1.4),
        "flat_share": (0.0, 0.3, 0.6, 1.0),
    }
)
"""The measures of a track, each with the values of its hat functions.

- `bottom_m`, `top_m`: heights above the floor between which nine tenths of its voxels are.
- `long_m`, `short_m`: lengths of the sides of the rectangle with the same spread as its cells, seen from above. A short
  side of one voxel is a surface on a wall.
- `upright_m`: mean height of the voxels above one another in its cells; large for vertical surfaces.
- `flat_share`: share of its cells with at most two voxels above one another, which show a horizontal surface.
"""
FEATURES = sum(len(values) for values in MEASURES.values())
"""Number of features of a shape."""


def features_of(measures: Float32[np.ndarray, "n measures"]) -> Float32[np.ndarray, "n features"]:
    """Returns the values of the hat functions of each measure, in the order of `MEASURES`.

    Those of one measure add up to 1: at most two neighbours are not 0. Below the first value the first function is 1,
    above the last value the last one.
    """
    parts = []
    for column, values in zip(measures.T, MEASURES.values(), strict=True):
        knots = np.array(values)
        hats = [np.interp(column, knots, one) for one in np.eye(len(knots))]
        parts.append(np.stack(hats, axis=1))
    return np.concatenate(parts, axis=1).astype(np.float32)
