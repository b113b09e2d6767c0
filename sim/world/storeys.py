"""Finds the floors of a compiled world and the heights of its levels."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import MPCAT40_ID
from sim.gl import mujoco
from sim.houses.geoms import data_at_rest, world_boxes
from sim.houses.labels import Labels
from sim.robot.body import FLOOR_MASK

LEVEL_M = 0.15
"""Floors less than this above a level belong to it: rugs, thresholds. A landing or a sunken area is its own level."""


def floor_geoms(model: mujoco.MjModel, labels: Labels) -> NDArray[np.intp]:
    """Returns the ids of the geoms that carry wheels, without coverings."""
    return np.flatnonzero((labels.geom_category == MPCAT40_ID["floor"]) & (model.geom_contype == FLOOR_MASK[0]))


def floor_levels(model: mujoco.MjModel, labels: Labels) -> tuple[float, ...]:
    """Returns the heights of the levels of floors in metres, lowest first; (0.0,) for a world without a static floor.

    A storey may have several levels; storeys are distinguished by `SuccessRule.same_storey_m`.
    """
    return tuple(storey_floors(sorted(_floor_tops(model, labels).tolist()), LEVEL_M)) or (0.0,)


def storey_floors(levels_m: Iterable[float], apart_m: float) -> list[float]:
    """Returns the height of the lowest level of each storey.

    Args:
        levels_m: heights of the levels, lowest first. A level less than `apart_m` above the lowest one of a storey
            belongs to that storey.
        apart_m: see `SuccessRule.same_storey_m`.
    """
    floors_m: list[float] = []
    for level_m in levels_m:
        if not floors_m or level_m - floors_m[-1] >= apart_m:
            floors_m.append(level_m)
    return floors_m


def _floor_tops(model: mujoco.MjModel, labels: Labels) -> NDArray[np.float64]:
    """Returns the heights of the tops of all static floors, metres."""
    data = data_at_rest(model)
    floors = floor_geoms(model, labels)
    ids = floors[model.body_weldid[model.geom_bodyid[floors]] == 0]
    rise = np.abs(data.geom_xmat[ids, 6:9] * model.geom_size[ids]).sum(axis=1)
    shape = model.geom_type[ids]
    rise[shape == mujoco.mjtGeom.mjGEOM_PLANE] = 0.0
    tops_m = data.geom_xpos[ids, 2] + rise
    others = ~np.isin(shape, (mujoco.mjtGeom.mjGEOM_BOX.value, mujoco.mjtGeom.mjGEOM_PLANE.value))
    tops_m[others] = world_boxes(model, data, ids[others])[1][:, 2]
    return tops_m
