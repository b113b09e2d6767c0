"""Computes geometric input channels of a network from a depth image and the known camera.

Height above the floor, surface normals and inverse depth show what a pixel belongs to, independent of its colour (Gupta
et al. 2014, arXiv:1407.5736, encode depth by disparity, height and angle for this reason). They are computed from the
whole image, before any crop, so that heights and metric sizes are right in a window of it.
"""

from __future__ import annotations

import math

import cv2
import numpy as np
from jaxtyping import Float32

from sim.core.interface import CameraModel, ConfigError
from stubborn.kernels.surfaces import fill_surface_channels

CHANNELS: tuple[str, ...] = ("inverse_depth", "valid", "height", "right", "up", "forward")
"""Order of the channels: 1/m, 1 where the depth is in the camera's range, metres above the floor, and the components
of the unit normal, which points to the camera, in the camera's level frame."""
INVERSE_DEPTH, VALID, HEIGHT, RIGHT, UP, FORWARD = range(len(CHANNELS))
_MEAN = tuple(map(np.float32, (0.5, 0.8, 0.9, 0.0, 0.1, -0.5)))
_STD = tuple(map(np.float32, (0.5, 0.4, 0.7, 0.5, 0.4, 0.4)))
"""Rounded values near the statistics of generated houses; the network's first normalisation corrects the rest."""
STATISTICS = (_MEAN, _STD)
"""Mean and standard deviation by which the channels are scaled."""
BASELINE_DEG = 0.5
"""Angle between the two pixels that give a normal: a smaller angle gives more noise, a larger one rounds more
edges."""


def geometry_image(depth_m: Float32[np.ndarray, "h w"], camera: CameraModel) -> Float32[np.ndarray, "h w 6"]:
    """Returns the geometric channels of a depth image, in the order of `CHANNELS`.

    Normals are zero where the depth is not valid, or has no valid neighbour.

    Args:
        depth_m: whole image of the camera, at its resolution or shrunk; 0: no return; the camera's largest depth: this
            depth or more.
        camera: field of view, height above the floor and range of depth.

    Raises:
        ConfigError: the camera's range is not finite, or the proportions of the image differ from the camera's.
    """
    height, width = depth_m.shape
    if not math.isfinite(camera.max_depth_m):
        raise ConfigError(f"A network needs a depth camera with a finite range, got max_depth_m {camera.max_depth_m}.")
    if abs(height * camera.width_px - width * camera.height_px) > max(camera.width_px, camera.height_px):
        raise ConfigError(
            f"The depth image has {width} x {height} pixels, but the camera {camera.width_px} x {camera.height_px}: "
            "give the whole image."
        )
    focal_px = 0.5 * width / math.tan(0.5 * camera.hfov_rad)
    step = max(1, round(math.tan(math.radians(BASELINE_DEG)) * focal_px))
    channels = np.empty((height, width, len(CHANNELS)), np.float32)
    fill_surface_channels(np.ascontiguousarray(depth_m), focal_px, camera.height_m, camera.max_depth_m, step, channels)
    return channels


def normalised(channels: Float32[np.ndarray, "h w 6"]) -> Float32[np.ndarray, "6 h w"]:
    """Returns the channels scaled to about zero mean and unit variance, channels first."""
    planar = np.empty((len(CHANNELS), *channels.shape[:2]), np.float32)
    for i, (mean, std) in enumerate(zip(_MEAN, _STD, strict=True)):
        np.multiply(channels[..., i] - mean, 1.0 / std, out=planar[i])
    return planar


def mirrored(channels: Float32[np.ndarray, "h w 6"]) -> Float32[np.ndarray, "h w 6"]:
    """Returns the channels of the mirrored scene."""
    flipped = np.ascontiguousarray(channels[:, ::-1])
    flipped[..., RIGHT] *= -1.0
    return flipped


def zoomed(
    channels: Float32[np.ndarray, "h w 6"], width_px: int, height_px: int, enlargement: float
) -> Float32[np.ndarray, "rows cols 6"]:
    """Returns a window of the channels at another resolution, as seen from the place where its objects have that size.

    A window that is enlarged by a factor shows its objects as from a place that is nearer by this factor, so inverse
    depth is multiplied by it: the size in pixels times the depth stays the same. Heights and normals do not depend on
    the distance.
    """
    resized = cv2.resize(channels, (width_px, height_px), interpolation=cv2.INTER_NEAREST)
    resized[..., INVERSE_DEPTH] *= enlargement
    return resized
