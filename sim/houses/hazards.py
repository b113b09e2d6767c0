"""Reads the hazards that sites of a house declare.

A hazard is an obstacle that depth cannot see, sees too late or takes for passable, placed by
`sim.homes.housegen.hazards` where paths lead. Its site is a box of the world body named `hazard_<kind>_<number>` around
its geoms. Sites are never rendered.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.houses.house import site_box

_HAZARD = re.compile(r"hazard_(?P<kind>[a-z][a-z_]*)_\d+")


@dataclass(frozen=True)
class Hazard:
    """The extent of one hazard."""

    name: str
    """Name of its site, for example `hazard_glass_00`."""
    kind: str
    """Family of the hazard, for example `glass`."""
    low_m: tuple[float, float, float]
    high_m: tuple[float, float, float]
    """Lowest and highest corner of the axis-aligned box around it."""

    def distance_m(self, xy_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the distances (n,) in plan from positions (n, 2) to the box; 0 inside."""
        low, high = np.array(self.low_m[:2]), np.array(self.high_m[:2])
        return np.hypot(*np.maximum(np.maximum(low - xy_m, xy_m - high), 0.0).T)


def read_hazards(model: mujoco.MjModel) -> tuple[Hazard, ...]:
    """Returns the hazards that sites of the world body declare, in the model's order."""
    hazards = []
    for site in range(model.nsite):
        match = _HAZARD.fullmatch(model.site(site).name)
        if match is None or model.site_bodyid[site] != 0 or model.site_type[site] != mujoco.mjtGeom.mjGEOM_BOX:
            continue
        (x, y, z), (hx, hy, hz) = site_box(model, site)
        hazards.append(Hazard(match[0], match["kind"], (x - hx, y - hy, z - hz), (x + hx, y + hy, z + hz)))
    return tuple(hazards)
