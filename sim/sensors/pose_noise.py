"""Noise of gps and compass: white noise, and a drift that grows with the square root of the number of actions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.interface import CameraModel, wrap_angle
from sim.sensors.ranges import require_range


@dataclass(frozen=True, kw_only=True)
class PoseNoise:
    """Noise of gps and compass; every default is off."""

    gps_std_m: float = 0.0
    """Standard deviation of the white noise in each direction."""
    gps_walk_m: float = 0.0
    """Standard deviation by which the drift changes at each action, in each direction (a random walk)."""
    compass_std_rad: float = 0.0
    compass_walk_rad: float = 0.0

    def __post_init__(self) -> None:
        require_range(self, 0.0, math.inf, "gps_std_m", "gps_walk_m", "compass_std_rad", "compass_walk_rad")

    def model(self, camera: CameraModel) -> NoisyPose | None:
        """Returns a new noise model; None if all noise is off."""
        return None if self == PoseNoise() else NoisyPose(self)


class NoisyPose:
    """Applies a `PoseNoise` to gps and compass, episode by episode; it remembers the drift."""

    sensors = ("gps", "compass")
    images = ()

    def __init__(self, config: PoseNoise) -> None:
        self._white = np.array([config.gps_std_m, config.gps_std_m, config.compass_std_rad])
        self._walk = np.array([config.gps_walk_m, config.gps_walk_m, config.compass_walk_rad])
        self._drift: NDArray[np.float64] | None = None

    def begin(self, gloss: NDArray[np.float32]) -> None:
        """Starts an episode: its first reading has no drift."""
        del gloss
        self._drift = None

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> dict[str, NDArray]:
        """Returns gps (2,) in metres and compass (1,) in radians with noise, in new memory."""
        del images
        gps, compass = readings["gps"], readings["compass"]
        walked = self._walk * rng.standard_normal(3)
        self._drift = np.zeros(3) if self._drift is None else self._drift + walked
        error = self._drift + self._white * rng.standard_normal(3)
        yaw_rad = _at_most_pi(np.float32(wrap_angle(float(compass[0]) + float(error[2]))))
        return {"gps": (gps + error[:2]).astype(np.float32), "compass": np.array([yaw_rad], np.float32)}


def _at_most_pi(yaw_rad: np.float32) -> np.float32:
    """Returns an angle of (-pi, pi] that does not leave the interval by rounding to float32."""
    return np.clip(yaw_rad, -np.float32(np.pi), np.float32(np.pi))
