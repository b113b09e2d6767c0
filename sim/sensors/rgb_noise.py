"""Noise of the colour image of a real camera: varying exposure, shot noise and read noise.

The model is that of the EMVA standard 1288: a pixel counts electrons, and reading them adds normal noise. Their number
is Poisson distributed; it is sampled from the normal distribution with the same mean and variance.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.interface import CameraModel
from sim.sensors.random_fields import fill_normal
from sim.sensors.ranges import require_range


@dataclass(frozen=True, kw_only=True)
class RgbNoise:
    """Noise of the colour image; every default is off."""

    gain_std: float = 0.0
    """Standard deviation of the gain of a whole frame about 1."""
    shot_electrons_1: float = 0.0
    """Variance of the shot noise at full white, relative to white squared: 1 / (number of electrons at white)."""
    read_std: float = 0.0
    """Standard deviation of the read noise, in grey levels of 255."""

    def __post_init__(self) -> None:
        require_range(self, 0.0, math.inf, "shot_electrons_1", "read_std")
        require_range(self, 0.0, 0.3, "gain_std")

    def model(self, camera: CameraModel) -> NoisyRgb | None:
        """Returns a new noise model for this camera; None if all noise is off."""
        return None if self == RgbNoise() else NoisyRgb(self, camera)


class NoisyRgb:
    """Applies an `RgbNoise` to the images of one camera."""

    sensors = ("rgb",)
    images = ()

    def __init__(self, config: RgbNoise, camera: CameraModel) -> None:
        self._config = config
        self._normal = np.empty((camera.height_px, camera.width_px, 3), np.float32)

    def begin(self, gloss: NDArray[np.float32]) -> None:
        """Starts an episode: nothing is kept between episodes."""

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> dict[str, NDArray]:
        """Returns the colour image (h, w, 3) with noise, in new memory."""
        del images
        config, rgb = self._config, readings["rgb"]
        gain = max(0.0, 1.0 + config.gain_std * rng.standard_normal())
        mean = np.arange(256) * gain
        std = np.sqrt(mean * (255.0 * config.shot_electrons_1) + config.read_std**2)
        fill_normal(rng, self._normal)
        self._normal *= cv2.LUT(rgb, std.astype(np.float32))
        self._normal += cv2.LUT(rgb, mean.astype(np.float32))
        np.maximum(self._normal, 0.0, out=self._normal)
        return {"rgb": np.asarray(cv2.convertScaleAbs(self._normal), np.uint8)}  # rounds and stops at 255
