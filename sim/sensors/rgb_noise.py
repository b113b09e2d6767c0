"""What a real colour camera makes of an image: wandering exposure, shot noise and read noise.

The model is that of the EMVA standard 1288: a pixel counts electrons, whose number is Poisson distributed, and reading
them adds normal noise. The Poisson part is drawn from the normal distribution of the same mean and variance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.interface import CameraModel
from sim.sensors.random_fields import fill_normal
from sim.sensors.ranges import require_range


@dataclass(frozen=True, kw_only=True)
class RgbNoise:
    """Noise of the colour image; every default is off."""

    gain_std: float = 0.0
    """Standard deviation of the gain of a whole frame about 1."""
    shot_electrons_1: float = 0.0
    """Variance of the shot noise at full white, as a share of white squared: 1 / (electrons that white stands for)."""
    read_std: float = 0.0
    """Standard deviation of the read noise, in grey levels of 255."""

    def __post_init__(self) -> None:
        require_range(self, 0.0, math.inf, "shot_electrons_1", "read_std")
        require_range(self, 0.0, 0.3, "gain_std")


class NoisyRgb:
    """Puts an `RgbNoise` on the images of one camera."""

    def __init__(self, config: RgbNoise, camera: CameraModel) -> None:
        self._config = config
        self._normal = np.empty((camera.height_px, camera.width_px, 3), np.float32)

    def apply(self, rgb: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
        """The image (h, w, 3) as the sensor gives it, in new memory."""
        config = self._config
        gain = max(0.0, 1.0 + config.gain_std * rng.standard_normal())
        mean = np.arange(256) * gain
        std = np.sqrt(mean * (255.0 * config.shot_electrons_1) + config.read_std**2)
        fill_normal(rng, self._normal)
        self._normal *= cv2.LUT(rgb, std.astype(np.float32))
        self._normal += cv2.LUT(rgb, mean.astype(np.float32))
        np.maximum(self._normal, 0.0, out=self._normal)
        return np.asarray(cv2.convertScaleAbs(self._normal), np.uint8)  # rounds and stops at 255
