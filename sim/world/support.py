"""Tests whether the floor carries the robot: its wheels and casters must stand around the centre of mass."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.gl import mujoco
from sim.robot.config import RobotConfig

_DOWN = np.array([0.0, 0.0, -1.0])
_MESH = int(mujoco.mjtGeom.mjGEOM_MESH)


class FloorSupport:
    """The floors of one world, and the test whether they carry the robot at a pose."""

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, floors: NDArray[np.intp], config: RobotConfig
    ) -> None:
        """`floors` are the ids of the geoms that carry wheels."""
        self._model, self._data = model, data
        area = np.prod(model.geom_size[floors, :2], axis=1)
        area[model.geom_type[floors] == mujoco.mjtGeom.mjGEOM_PLANE] = np.inf
        self._floors = floors[np.argsort(-area, kind="stable")].tolist()  # the largest one answers most questions
        self._reach_m = config.physics.max_step_m
        wheels = config.wheels
        self._wheels = ((0.0, wheels.half_track_m), (0.0, -wheels.half_track_m))
        self._casters = ((wheels.caster_offset_m, 0.0), (-wheels.caster_offset_m, 0.0))

    def carries(self, x_m: float, y_m: float, z_m: float, yaw_rad: float) -> bool:
        """Returns whether both wheels or both casters have a floor below them.

        The centre of mass is above the middle of the axle, so that it is inside the hull of the supported points just
        in these two cases. A floor counts when it is at most `PhysicsConfig.max_step_m` above or below the robot.
        """
        wheels, casters = self._supported(x_m, y_m, z_m, yaw_rad)
        return all(wheels) or all(casters)

    def is_beyond_an_edge(self, x_m: float, y_m: float, z_m: float, yaw_rad: float) -> bool:
        """Returns whether some wheel or caster has no floor below it."""
        wheels, casters = self._supported(x_m, y_m, z_m, yaw_rad)
        return not all((*wheels, *casters))

    def _supported(self, x_m: float, y_m: float, z_m: float, yaw_rad: float) -> tuple[list[bool], list[bool]]:
        """Returns for both wheels and for both casters whether there is a floor below."""
        cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)

        def supported(point: tuple[float, float]) -> bool:
            ahead, left = point
            return self._has_floor(x_m + cos * ahead - sin * left, y_m + sin * ahead + cos * left, z_m)

        return list(map(supported, self._wheels)), list(map(supported, self._casters))

    def _has_floor(self, x_m: float, y_m: float, z_m: float) -> bool:
        start = np.array([x_m, y_m, z_m + self._reach_m])
        return any(0.0 <= self._distance_m(floor, start) <= 2.0 * self._reach_m for floor in self._floors)

    def _distance_m(self, floor: int, start: NDArray[np.float64]) -> float:
        """Returns the distance straight down to a floor; negative if the floor is not below."""
        model, data = self._model, self._data
        if model.geom_type[floor] == _MESH:
            return mujoco.mj_rayMesh(model, data, floor, start, _DOWN)
        at, size = data.geom_xpos[floor], model.geom_size[floor]
        return mujoco.mju_rayGeom(at, data.geom_xmat[floor], size, start, _DOWN, int(model.geom_type[floor]))
