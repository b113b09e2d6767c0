"""Noise of the depth image of a real depth camera: axial noise, steps, ragged edges and holes.

Sources (facts and formulas only):
- Nguyen, Izadi, Lovell, "Modeling Kinect sensor noise for improved 3D reconstruction and tracking", 3DIMPVT 2012: axial
  standard deviation 0.0012 + 0.0019 (z - 0.4)^2 metres; lateral about 0.8 px, nearly the same up to 60 deg of slant.
- Barron, Malik, "Intrinsic scene properties from a single RGB-D image", CVPR 2013, and Handa, Whelan, McDonald,
  Davison, "A benchmark for RGB-D visual odometry, 3D reconstruction and SLAM", ICRA 2014: pixels are shifted by
  normal jitter (0.5 px), then disparity, 1 / z, is rounded to whole steps, so that steps in z grow with z^2.
- Keselman, Woodfill, Grunnet-Jepsen, Bhowmik, "Intel RealSense stereoscopic depth cameras", CVPR workshops 2017, and
  Intel's notes on tuning the D400: error s z^2 / (f b) for a disparity error of s px, focal length f px, baseline b m;
  disparity in steps of 1/32 px; no depth where the two images do not match: at edges, on glass, mirrors, metal.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.interface import CameraModel, ConfigError
from sim.sensors.random_fields import fill_normal, fill_shifts, smooth_normal
from sim.sensors.ranges import require_range


@dataclass(frozen=True, kw_only=True)
class DepthNoise:
    """Noise of the depth image; every default is off. Saturated pixels (5 m or farther) change by dropouts only.

    Values in pixels are given at the camera's own resolution.
    """

    axial_m: float = 0.0
    """Standard deviation along the optical axis at the distance `axial_from_m`."""
    axial_1_m: float = 0.0
    """Growth of that standard deviation: this times (z - axial_from_m)^2 is added."""
    axial_from_m: float = 0.0
    step_1_m: float = 0.0
    """Step of 1 / z; a step of z is this times z^2 metres."""
    lateral_px: float = 0.0
    """Standard deviation of the shift of each pixel, right and down, before rounding to whole pixels."""
    edge_dropout: float = 0.0
    """Share of the pixels at depth edges without return."""
    edge_flying: float = 0.0
    """Share of the pixels at depth edges that lie anywhere between the near and the far side."""
    edge_radius_px: int = 1
    """Pixels within this distance of a jump in depth are edge pixels."""
    edge_jump_1_m: float = 0.05
    """A jump is a difference in 1 / z of at least this: 5 cm at 1 m, 20 cm at 2 m; a pixel of disparity of a D435."""
    hole_share: float = 0.0
    """Share of pixels without return on a surface whose gloss is 1 (see `sim.sensors.gloss`)."""
    hole_gloss: float = 0.3
    """Gloss at which that share has fallen linearly to 0."""
    hole_patch_px: float = 8.0
    """Size of the holes."""

    def __post_init__(self) -> None:
        lengths = ("axial_m", "axial_1_m", "axial_from_m", "step_1_m", "lateral_px", "edge_jump_1_m", "hole_patch_px")
        require_range(self, 0.0, math.inf, *lengths)
        require_range(self, 0.0, 1.0, "edge_dropout", "edge_flying", "hole_share", "hole_gloss")
        require_range(self, 1, 10, "edge_radius_px")
        if self.edge_radius_px != int(self.edge_radius_px):
            raise ConfigError(f"DepthNoise.edge_radius_px must be a whole number, got {self.edge_radius_px}.")
        if self.edge_dropout + self.edge_flying > 1.0:
            raise ConfigError(
                "DepthNoise.edge_dropout + edge_flying must be at most 1, got "
                f"{self.edge_dropout} + {self.edge_flying}."
            )
        if self.hole_gloss >= 1.0:
            raise ConfigError(f"DepthNoise.hole_gloss must be below 1, got {self.hole_gloss}.")

    def axial_std_m(self, depth_m: NDArray[np.float32], out: NDArray[np.float32] | None = None) -> NDArray[np.float32]:
        """Returns the standard deviation along the optical axis at these depths, metres."""
        std_m = np.subtract(depth_m, np.float32(self.axial_from_m), out=out)
        std_m *= std_m
        std_m *= np.float32(self.axial_1_m)
        std_m += np.float32(self.axial_m)
        return std_m

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
        columns, rows = np.meshgrid(np.arange(shape[1], dtype=np.int16), np.arange(shape[0], dtype=np.int16))
        self._pixels = np.stack([columns, rows], axis=2)  # (h, w, 2) column and row of each pixel
        self._shifts = np.empty((*shape, 2), np.int16)
        self._normal, self._near_m, self._far_m, self._work = (np.empty(shape, np.float32) for _ in range(4))
        self._lost, self._saturated, self._mask = (np.empty(shape, np.bool_) for _ in range(3))
        side = 2 * int(config.edge_radius_px) + 1
        self._neighbours = np.ones((side, side), np.uint8)
        self._hole_level = np.full(1, -np.inf, np.float32)

    def begin(self, gloss: NDArray[np.float32]) -> None:
        """Starts an episode in a house whose geoms have this gloss (ngeom,)."""
        from scipy.special import ndtri  # on demand: a quarter of a second at every start

        shares = np.append(self._config.hole_shares(gloss), 0.0)  # the last entry is for id -1, no geom
        self._hole_level = ndtri(shares).astype(np.float32)

    def apply(
        self, readings: Mapping[str, NDArray], images: Mapping[str, NDArray], rng: np.random.Generator
    ) -> dict[str, NDArray]:
        """Returns the depth image (h, w) with noise, in new memory."""
        camera, depth_m = self._camera, readings["depth"]
        noisy_m = np.empty_like(depth_m)
        self._jitter(noisy_m, depth_m, rng)
        self._break_edges(noisy_m, depth_m, rng)
        lost = np.less_equal(noisy_m, 0.0, out=self._lost)
        saturated = np.greater_equal(noisy_m, camera.max_depth_m, out=self._saturated)
        self._add_axial_noise(noisy_m, rng)
        self._round(noisy_m)
        np.minimum(noisy_m, np.float32(camera.max_depth_m), out=noisy_m)
        np.copyto(noisy_m, camera.max_depth_m, where=saturated)
        lost |= np.less(noisy_m, camera.min_depth_m, out=self._mask)
        if self.images:
            self._add_holes(lost, images["geom"], rng)
        np.copyto(noisy_m, 0.0, where=lost)
        return {"depth": noisy_m}

    def _jitter(self, noisy_m: NDArray[np.float32], depth_m: NDArray[np.float32], rng: np.random.Generator) -> None:
        """Writes the depth image with each pixel taken from a randomly shifted place."""
        if self._config.lateral_px == 0.0:
            noisy_m[:] = depth_m
            return
        fill_shifts(rng, self._config.lateral_px, self._shifts)
        cv2.add(self._shifts, self._pixels, dst=self._shifts)
        no_fractions = np.empty(0)  # the second map holds fractions of pixels
        cv2.remap(depth_m, self._shifts, no_fractions, cv2.INTER_NEAREST, dst=noisy_m, borderMode=cv2.BORDER_REPLICATE)

    def _break_edges(
        self, noisy_m: NDArray[np.float32], depth_m: NDArray[np.float32], rng: np.random.Generator
    ) -> None:
        """Writes dropouts and flying pixels where the true depth jumps."""
        config = self._config
        if config.edge_dropout + config.edge_flying == 0.0:
            return
        cv2.erode(depth_m, self._neighbours, dst=self._near_m)
        cv2.dilate(depth_m, self._neighbours, dst=self._far_m)
        least_jump_m = np.multiply(self._near_m, self._far_m, out=self._work)  # no division: near may be 0
        least_jump_m *= np.float32(config.edge_jump_1_m)
        jump_m = np.subtract(self._far_m, self._near_m, out=self._far_m).reshape(-1)
        edges = np.flatnonzero(np.greater(self._far_m, least_jump_m, out=self._mask))
        chance = rng.random(edges.size, np.float32)
        pixels, near_m = noisy_m.reshape(-1), self._near_m.reshape(-1)
        pixels[edges[chance < config.edge_dropout]] = 0.0
        fly = edges[(chance >= config.edge_dropout) & (chance < config.edge_dropout + config.edge_flying)]
        fly = fly[near_m[fly] > 0.0]  # a surface next to pixels without return has no flying pixels
        pixels[fly] = near_m[fly] + jump_m[fly] * rng.random(fly.size, np.float32)

    def _add_axial_noise(self, noisy_m: NDArray[np.float32], rng: np.random.Generator) -> None:
        """Adds normal noise along the optical axis."""
        config = self._config
        if config.axial_m == config.axial_1_m == 0.0:
            return
        fill_normal(rng, self._normal)
        self._normal *= config.axial_std_m(noisy_m, out=self._work)
        noisy_m += self._normal

    def _round(self, noisy_m: NDArray[np.float32]) -> None:
        """Rounds 1 / z to whole steps."""
        step = np.float32(self._config.step_1_m)
        if step == 0.0:
            return
        with np.errstate(divide="ignore"):
            np.divide(np.float32(1.0) / step, noisy_m, out=noisy_m)
            np.rint(noisy_m, out=noisy_m)
            np.divide(np.float32(1.0) / step, noisy_m, out=noisy_m)

    def _add_holes(self, lost: NDArray[np.bool_], geom: NDArray[np.int32], rng: np.random.Generator) -> None:
        """Marks patches without return on glossy and glass surfaces."""
        level = np.take(self._hole_level, geom, mode="wrap", out=self._work)
        if level.max() > -np.inf:
            field = smooth_normal(rng, lost.shape, self._config.hole_patch_px)
            lost |= np.less(field, level, out=self._mask)
