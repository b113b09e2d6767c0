"""A 2-D lidar: the distances to visible surfaces in one plane around the robot (`scan`), which leans with its body.

The rays start on the robot's axis. Like the camera, the lidar does not see the robot itself, and it sees the geoms that
are rendered: invisible glass and other geoms of group 3 and above return nothing. Panes of windows return a share of
the rays (`sim.houses.glass`); the others go on. One call of `mj_multiRay` casts all rays.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.errors import ConfigError
from sim.core.interface import CameraModel
from sim.gl import mujoco
from sim.houses.glass import returning
from sim.sensors.ranges import require_range, require_whole
from sim.sensors.sensor import NoiseSettings, SensorContext

MAX_RAYS = 10_000
_PAST_M = 1e-4
"""A ray goes on this far behind a face of a pane."""
_MAX_PANES = 8
"""Faces of panes that a ray passes; behind more of them it is lost."""
_SEEN_GROUPS = np.array([1, 1, 1, 0, 0, 0], np.uint8)
"""Geom groups that are rendered; the robot is in group 5."""


@dataclass(frozen=True, kw_only=True)
class ScanConfig:
    """The lidar of the sensor `scan`. The defaults are those of a common small lidar (Slamtec RPLIDAR A1)."""

    rays: int = 360
    fov_rad: float = 2.0 * math.pi
    """Angle that the rays cover, centred on the heading; 2 pi: all around."""
    min_range_m: float = 0.15
    """Nearer surfaces read 0."""
    max_range_m: float = 12.0
    """Farther surfaces, and rays without a return, read this value."""
    height_m: float = 0.25
    """Height of the plane above the floor."""

    def __post_init__(self) -> None:
        require_whole(self, 1, MAX_RAYS, "rays")
        require_range(self, 0.0, math.inf, "min_range_m", "max_range_m", "height_m")
        require_range(self, 0.0, 2.0 * math.pi, "fov_rad")
        if self.min_range_m >= self.max_range_m:
            raise ConfigError(
                f"ScanConfig needs min_range_m < max_range_m, got {self.min_range_m} and {self.max_range_m} m."
            )

    @property
    def step_rad(self) -> float:
        """Angle between two rays. Of a full circle, the last ray is one step before the first."""
        gaps = self.rays if self.fov_rad > 2.0 * math.pi - 1e-6 else self.rays - 1
        return self.fov_rad / max(1, gaps)

    @property
    def angles_rad(self) -> NDArray[np.float64]:
        """Direction of each ray (rays,), counter-clockwise from the heading, in increasing order."""
        first = -0.5 * self.fov_rad if self.rays > 1 else 0.0
        return first + self.step_rad * np.arange(self.rays, dtype=np.float64)


@dataclass(frozen=True, kw_only=True)
class ScanSensor:
    """Distances in a plane across the robot's axis, metres; see `ScanConfig`."""

    config: ScanConfig = field(default_factory=ScanConfig)
    name: str = "scan"
    images: tuple[str, ...] = ()
    reads: tuple[str, ...] = ("pose", "model", "data", "glass")
    noise: NoiseSettings | None = None

    def space(self, camera: CameraModel) -> spaces.Box:
        """Returns the space of float32 distances (rays,)."""
        return spaces.Box(0.0, self.config.max_range_m, (self.config.rays,), np.float32)

    def read(self, context: SensorContext) -> NDArray:
        """Returns the distance of each ray (rays,), in the order of `ScanConfig.angles_rad`."""
        config, pose = self.config, context.pose
        angles = config.angles_rad
        directions = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ pose.axes[:2]  # (rays, 3)
        eye_m = pose.point(0.0, 0.0, config.height_m)
        distance_m = np.empty(config.rays)
        geoms = np.empty(config.rays, np.int32)
        mujoco.mj_multiRay(
            context.model, context.data, eye_m, directions.ravel(), _SEEN_GROUPS, True, -1, geoms, distance_m, None,
            config.rays, config.max_range_m,
        )  # fmt: skip
        in_glass = (geoms >= 0) & np.append(context.glass, False)[geoms] & ~returning((config.rays,))
        for ray in np.flatnonzero(in_glass).tolist():
            distance_m[ray] = _past_glass(context, eye_m, directions[ray], distance_m[ray])
        distance_m[distance_m < 0.0] = config.max_range_m  # no return
        distance_m[distance_m < config.min_range_m] = 0.0
        return np.minimum(distance_m, config.max_range_m).astype(np.float32)


def _past_glass(
    context: SensorContext, eye_m: NDArray[np.float64], direction: NDArray[np.float64], distance_m: float
) -> float:
    """Returns the distance of the first surface that is not glass on a ray that meets a pane; -1: there is none."""
    geom = np.zeros((1, 1), np.int32)
    for _ in range(_MAX_PANES):
        start_m = distance_m + _PAST_M
        further_m = mujoco.mj_ray(
            context.model, context.data, eye_m + start_m * direction, direction, _SEEN_GROUPS, 1, -1, geom
        )
        if further_m < 0.0:
            return -1.0
        distance_m = start_m + further_m
        if not context.glass[geom[0, 0]]:
            return distance_m
    return -1.0
