"""Noise of the lidar: normal noise that grows with the distance, and rays without a return.

The data sheet of the RPLIDAR A1 (Slamtec, LD108) states an accuracy of 1 % of the distance up to 3 m and of 2 to 2.5 %
beyond; that of the LDS-01 (Robotis) 15 mm up to 0.5 m and 5 % beyond.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.core.interface import CameraModel
from sim.sensors.ranges import require_range
from sim.sensors.scan import ScanConfig


@dataclass(frozen=True, kw_only=True)
class ScanNoise:
    """Noise of the lidar; every default is off."""

    std_m: float = 0.0
    """Standard deviation of a distance at 0 m."""
    std_share: float = 0.0
    """Growth of that standard deviation, as a share of the distance."""
    dropout: float = 0.0
    """Share of the rays without a return; they read the maximum range."""

    def __post_init__(self) -> None:
        require_range(self, 0.0, math.inf, "std_m", "std_share")
        require_range(self, 0.0, 1.0, "dropout")

    def model(self, camera: CameraModel) -> NoisyScan | None:
        """Returns a new noise model for the default lidar; None if all noise is off."""
        return self.model_of(ScanConfig())

    def model_of(self, scan: ScanConfig) -> NoisyScan | None:
        """Returns a new noise model for this lidar; None if all noise is off."""
        return None if self == ScanNoise() else NoisyScan(self, scan)


class NoisyScan:
    """Applies a `ScanNoise` to the readings of one lidar (`sim.sensors.sensor.NoiseModel`)."""

    sensors = ("scan",)
    images = ()

    def __init__(self, config: ScanNoise, scan: ScanConfig) -> None:
        self._config, self._scan = config, scan

    def begin(self, gloss: NDArray[np.float32]) -> None:
        """Starts an episode; the noise has no memory."""
        del gloss

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> dict[str, NDArray]:
        """Returns the distances (rays,) with noise, in new memory; rays without a return stay so."""
        del images
        config, scan, true_m = self._config, self._scan, readings["scan"]
        returned = (true_m > 0.0) & (true_m < scan.max_range_m)
        normal = rng.standard_normal(true_m.shape, np.float32)
        lost = rng.random(true_m.shape, np.float32) < config.dropout
        noisy_m = true_m + np.where(returned, (config.std_m + config.std_share * true_m) * normal, 0.0)
        noisy_m = np.minimum(noisy_m, scan.max_range_m)
        noisy_m[returned & (noisy_m < scan.min_range_m)] = 0.0
        noisy_m[returned & lost] = scan.max_range_m
        return {"scan": noisy_m.astype(np.float32)}
