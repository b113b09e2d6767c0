"""Noise of gps and compass: white, and a drift that grows with the square root of the number of actions."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.interface import wrap_angle
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


class NoisyPose:
    """Puts a `PoseNoise` on the readings of one episode after another; remembers the drift."""

    def __init__(self, config: PoseNoise) -> None:
        self._white = np.array([config.gps_std_m, config.gps_std_m, config.compass_std_rad])
        self._walk = np.array([config.gps_walk_m, config.gps_walk_m, config.compass_walk_rad])
        self._drift: NDArray[np.float64] | None = None

    def begin(self) -> None:
        """A new episode: the first reading has no drift."""
        self._drift = None

    def apply(
        self, gps: NDArray[np.float32], compass: NDArray[np.float32], rng: np.random.Generator
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """gps (2,) metres and compass (1,) radians as the sensors give them, in new memory."""
        walked = self._walk * rng.standard_normal(3)
        self._drift = np.zeros(3) if self._drift is None else self._drift + walked
        error = self._drift + self._white * rng.standard_normal(3)
        yaw_rad = _at_most_pi(np.float32(wrap_angle(float(compass[0]) + float(error[2]))))
        return (gps + error[:2]).astype(np.float32), np.array([yaw_rad], np.float32)


def _at_most_pi(yaw_rad: np.float32) -> np.float32:
    """An angle in (-pi, pi] stays inside when it is rounded to float32."""
    return np.clip(yaw_rad, -np.float32(np.pi), np.float32(np.pi))
