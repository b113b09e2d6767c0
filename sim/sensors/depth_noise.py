"""Noise of the depth image of a stereo camera: random and systematic errors, steps, shadows, flying pixels and holes.

Sources (facts and formulas only):
- Keselman, Woodfill, Grunnet-Jepsen, Bhowmik, "Intel RealSense stereoscopic depth cameras", CVPR workshops 2017, and
  Intel's notes on tuning the D400: error s z^2 / (f b) for a disparity error of s px, focal length f px, baseline b m;
  disparity in steps of 1/32 px; matching sums costs over windows of 7 x 7 px, so that errors of neighbours are alike;
  no depth where the two images do not match: on glass, mirrors, metal.
- Data sheet of the D400 series: depth exists where both imagers see a surface. The left one is the reference; hence a
  band of f b / z px at the left border is lost, and a shadow of f b (1 / near - 1 / far) px left of each near object.
  The systematic error is at most 2 % at 2 m.
- Teichman, Miller, Thrun, "Unsupervised intrinsic calibration of depth sensors via SLAM", RSS 2013: the systematic
  error is a smooth field over the image and grows with the distance.
- Nguyen, Izadi, Lovell, "Modeling Kinect sensor noise for improved 3D reconstruction and tracking", 3DIMPVT 2012: axial
  standard deviation 0.0012 + 0.0019 (z - 0.4)^2 metres; lateral about 0.8 px, nearly the same up to 60 deg of slant.
- Konolige, Mihelich, "Technical description of Kinect calibration", 2012: a Kinect matches windows of 9 x 9 px over a
  baseline of 7.5 cm.
- Barron, Malik, "Intrinsic scene properties from a single RGB-D image", CVPR 2013, and Handa, Whelan, McDonald,
  Davison, "A benchmark for RGB-D visual odometry, 3D reconstruction and SLAM", ICRA 2014: pixels are shifted by
  normal jitter (0.5 px), then disparity, 1 / z, is rounded to whole steps, so that steps in z grow with z^2.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.core.interface import CameraModel, ConfigError
from sim.sensors.depth_kernels import add_errors, cast_shadows, find_edges, make_holes, shift_pixels
from sim.sensors.random_fields import levels, shift_pairs, smooth_normal, uniform_bytes
from sim.sensors.ranges import require_range

_BYTE_MEAN, _BYTE_STD = 127.5, math.sqrt((256.0**2 - 1.0) / 12.0)
"""Mean and standard deviation of uniform numbers of 8 bits."""


@dataclass(frozen=True, kw_only=True)
class DepthNoise:
    """Noise of the depth image; every default is off. Saturated pixels (5 m or farther) change only by being lost.

    Values in pixels are given at the camera's own resolution.
    """

    axial_m: float = 0.0
    """Standard deviation along the optical axis at the distance `axial_from_m`."""
    axial_1_m: float = 0.0
    """Growth of that standard deviation: this times (z - axial_from_m)^2 is added."""
    axial_from_m: float = 0.0
    window_px: int = 7
    """Side of the square of pixels over which matching averages errors: the correlation of two pixels in a row falls
    linearly with their distance, to 0 at this one."""
    bias_1_m: float = 0.0
    """Standard deviation of the systematic error of 1 / z, which is constant during an episode; that of z is this
    times z^2 metres."""
    bias_patch_px: float = 80.0
    """Distance over which the systematic error varies in the image."""
    step_1_m: float = 0.0
    """Step of 1 / z; a step of z is this times z^2 metres."""
    lateral_px: float = 0.0
    """Standard deviation of the shift of each pixel, right and down, before rounding to whole pixels."""
    baseline_m: float = 0.0
    """Distance between the two imagers; depth is lost where only the left one sees a surface. 0: no such shadows."""
    edge_flying: float = 0.0
    """Share of the pixels at depth edges that lie anywhere between the near and the far side."""
    edge_radius_px: int = 1
    """Pixels within this distance of a jump in depth are edge pixels."""
    edge_jump_1_m: float = 0.05
    """A jump is a difference in 1 / z of at least this: 5 cm at 1 m, 20 cm at 2 m; a pixel of disparity of a D435."""
    hole_share: float = 0.0
    """Share of pixels without return on a surface of gloss 1 (see `sim.renderer.gloss`)."""
    hole_gloss: float = 0.3
    """Gloss at which that share has fallen linearly to 0."""
    hole_patch_px: float = 8.0
    """Size of the holes."""

    def __post_init__(self) -> None:
        lengths = ("axial_m", "axial_1_m", "axial_from_m", "step_1_m", "lateral_px", "edge_jump_1_m", "hole_patch_px")
        require_range(self, 0.0, math.inf, *lengths, "bias_1_m", "bias_patch_px", "baseline_m")
        require_range(self, 0.0, 1.0, "edge_flying", "hole_share", "hole_gloss")
        require_range(self, 1, 10, "edge_radius_px")
        require_range(self, 3, 31, "window_px")
        for name, value in (("edge_radius_px", self.edge_radius_px), ("window_px", self.window_px)):
            if value != int(value):
                raise ConfigError(f"DepthNoise.{name} must be a whole number, got {value}.")
        if self.window_px % 2 == 0:
            raise ConfigError(f"DepthNoise.window_px must be odd, got {self.window_px}.")
        if self.hole_gloss >= 1.0:
            raise ConfigError(f"DepthNoise.hole_gloss must be below 1, got {self.hole_gloss}.")

    def hole_shares(self, gloss: NDArray[np.float32]) -> NDArray[np.float64]:
        """Returns the share of pixels without return on surfaces of this gloss."""
        return self.hole_share * np.clip(
            (gloss.astype(np.float64) - self.hole_gloss) / (1.0 - self.hole_gloss), 0.0, 1.0
        )

    def model(self, camera: CameraModel) -> NoisyDepth | None:
        """Returns a new noise model for this camera; None if all noise is off."""
        return None if self == DepthNoise() else NoisyDepth(self, camera)


class NoisyDepth:
    """Applies a `DepthNoise` to the images of one camera.

    It reuses its intermediate images: to allocate them for every frame would take longer than the computation.
    """

    sensors = ("depth",)

    def __init__(self, config: DepthNoise, camera: CameraModel) -> None:
        self._config, self._camera = config, camera
        self.images = ("geom",) if config.hole_share > 0.0 else ()
        shape = (camera.height_px, camera.width_px)
        self._seen_m, self._near_m, self._far_m = (np.empty(shape, np.float32) for _ in range(3))
        self._edges = np.empty(camera.height_px * camera.width_px + 1, np.int64)
        side = 2 * int(config.edge_radius_px) + 1
        self._neighbours = np.ones((side, side), np.uint8)
        self._window = int(config.window_px)
        around = self._window - 1  # pixels beyond the border belong to the windows of those inside
        self._sums = np.zeros((shape[0] + around, shape[1] + around), np.int32)
        self._bias_1_m: NDArray[np.float32] | None = None
        self._hole_level = np.full(1, -np.inf, np.float32)

    def begin(self, gloss: NDArray[np.float32]) -> None:
        """Starts an episode in a house; `gloss` (ngeom,) is the gloss of its geoms."""
        from scipy.special import ndtri  # on demand: a quarter of a second at every start

        shares = np.append(self._config.hole_shares(gloss), 0.0)  # the last entry is for id -1, no geom
        self._hole_level = ndtri(shares).astype(np.float32)
        self._bias_1_m = None

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> dict[str, NDArray]:
        """Returns the depth image (h, w) with noise, in new memory."""
        depth_m = readings["depth"]
        noisy_m = np.empty_like(depth_m)
        self._jitter(noisy_m, self._seen_by_both(depth_m), rng)
        self._break_edges(noisy_m, depth_m, rng)
        self._add_errors(noisy_m, rng)
        if self.images:
            self._add_holes(noisy_m, images["geom"], rng)
        return {"depth": noisy_m}

    def _seen_by_both(self, depth_m: NDArray[np.float32]) -> NDArray[np.float32]:
        """Returns the depth image with the shadows of a stereo camera."""
        if self._config.baseline_m == 0.0:
            return depth_m
        cast_shadows(depth_m, np.float32(self._camera.focal_px * self._config.baseline_m), self._seen_m)
        return self._seen_m

    def _jitter(self, noisy_m: NDArray[np.float32], depth_m: NDArray[np.float32], rng: np.random.Generator) -> None:
        """Writes the depth image with each pixel taken from a randomly shifted place."""
        if self._config.lateral_px == 0.0:
            noisy_m[:] = depth_m
            return
        chosen = levels(rng, depth_m.shape)
        shift_pixels(depth_m, chosen, shift_pairs(self._config.lateral_px), noisy_m)

    def _break_edges(
        self, noisy_m: NDArray[np.float32], depth_m: NDArray[np.float32], rng: np.random.Generator
    ) -> None:
        """Writes flying pixels where the true depth jumps."""
        config = self._config
        if config.edge_flying == 0.0:
            return
        cv2.erode(depth_m, self._neighbours, dst=self._near_m)
        cv2.dilate(depth_m, self._neighbours, dst=self._far_m)
        near_m, far_m = self._near_m.reshape(-1), self._far_m.reshape(-1)
        edges = self._edges[: find_edges(near_m, far_m, np.float32(config.edge_jump_1_m), self._edges)]
        fly = edges[rng.random(edges.size, np.float32) < config.edge_flying]
        between = rng.random(fly.size, np.float32)
        noisy_m.reshape(-1)[fly] = near_m[fly] + (far_m[fly] - near_m[fly]) * between

    def _add_errors(self, noisy_m: NDArray[np.float32], rng: np.random.Generator) -> None:
        """Adds random and systematic errors, rounds 1 / z, and keeps the range of the camera."""
        config, camera = self._config, self._camera
        if config.axial_m == config.axial_1_m == config.bias_1_m == config.step_1_m == 0.0:
            return
        if self._bias_1_m is None:
            self._bias_1_m = self._draw_bias(rng)
        if config.axial_m > 0.0 or config.axial_1_m > 0.0:
            white, window = uniform_bytes(rng, self._sums.shape), (self._window, self._window)
            cv2.boxFilter(white, cv2.CV_32S, window, dst=self._sums, normalize=False)
        count = self._window**2
        scale = np.float32(count * _BYTE_MEAN), np.float32(1.0 / (self._window * _BYTE_STD))
        std = np.float32(config.axial_m), np.float32(config.axial_1_m), np.float32(config.axial_from_m)
        limits_m = np.float32(camera.min_depth_m), np.float32(camera.max_depth_m)
        add_errors(noisy_m, self._sums, scale, self._bias_1_m, std, np.float32(config.step_1_m), limits_m)

    def _draw_bias(self, rng: np.random.Generator) -> NDArray[np.float32]:
        """Returns the systematic error (h, w) of 1 / z of an episode's camera."""
        config, shape = self._config, self._seen_m.shape
        if config.bias_1_m == 0.0:
            return np.zeros(shape, np.float32)
        return np.float32(config.bias_1_m) * smooth_normal(rng, shape, config.bias_patch_px)

    def _add_holes(self, noisy_m: NDArray[np.float32], geom: NDArray[np.int32], rng: np.random.Generator) -> None:
        """Writes patches without return on glossy and glass surfaces."""
        field = smooth_normal(rng, noisy_m.shape, self._config.hole_patch_px)
        make_holes(noisy_m, geom, self._hole_level, field)
