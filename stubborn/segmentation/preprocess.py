"""Converts camera images to the input of a RedNet: resolution, normalisation, padding. NumPy and OpenCV only."""

from __future__ import annotations

import math
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Float32, Shaped, UInt8

from sim.core.interface import CameraModel, ConfigError

RGB_MEAN = np.array([0.493, 0.468, 0.438], np.float32)
RGB_STD = np.array([0.544, 0.521, 0.499], np.float32)
DEPTH_MEAN, DEPTH_STD = 0.213, 0.285
"""Statistics of the published network, for RGB / 255 and for depth scaled to [0, 1] over the sensor's range."""
STRIDE_PX = 32
"""Height and width of a network's input must be multiples of this: five halvings."""


class Padding(NamedTuple):
    """Rows and columns around an image that make each size a multiple of `STRIDE_PX`."""

    top: int
    bottom: int
    left: int
    right: int

    @property
    def inner(self) -> tuple[slice, slice]:
        """Rows and columns of the image in the padded image."""
        return slice(self.top, -self.bottom or None), slice(self.left, -self.right or None)

    def quarter(self, height_px: int, width_px: int) -> tuple[slice, slice]:
        """Returns rows and columns of an image of this size in the padded image, at a quarter of the size of both."""
        top, left = self.top // 4, self.left // 4
        return slice(top, top + height_px // 4), slice(left, left + width_px // 4)


def require_whole_strides(height_px: int, width_px: int) -> None:
    """Raises ConfigError if height or width is not a multiple of `STRIDE_PX`."""
    if height_px % STRIDE_PX or width_px % STRIDE_PX:
        raise ConfigError(
            f"A network takes multiples of {STRIDE_PX} pixels in height and width, got {height_px} x {width_px}."
        )


def padding(height_px: int, width_px: int) -> Padding:
    """Returns the padding that an image of this size needs; an even number, about half, is at the top and left."""
    rows, cols = -height_px % STRIDE_PX, -width_px % STRIDE_PX
    top, left = rows // 4 * 2, cols // 4 * 2
    return Padding(top, rows - top, left, cols - left)


def shrink(image: Shaped[np.ndarray, "h w *channels"], block_px: int) -> Shaped[np.ndarray, "rows cols *channels"]:
    """Returns an image with one pixel per block: colour is averaged, depth and labels take the block's middle pixel.

    Args:
        image: colour with three channels, or depth or labels without a channel axis.
        block_px: edge of a block.

    Raises:
        ConfigError: height or width is not a multiple of `block_px`.
    """
    height, width = image.shape[:2]
    if height % block_px or width % block_px:
        raise ConfigError(f"An image of {height} x {width} pixels is not a whole number of {block_px} pixel blocks.")
    if block_px == 1:
        return image
    if image.ndim == 3:
        return cv2.resize(image, (width // block_px, height // block_px), interpolation=cv2.INTER_AREA)
    middle = block_px // 2
    return np.ascontiguousarray(image[middle::block_px, middle::block_px])


def normalise_rgb(rgb: UInt8[np.ndarray, "h w 3"]) -> Float32[np.ndarray, "3 padded_h padded_w"]:
    """Returns normalised colour, padded by repeating the edge."""
    planes = np.ascontiguousarray(rgb.transpose(2, 0, 1)).astype(np.float32)
    return pad_edges((planes / 255.0 - RGB_MEAN[:, None, None]) / RGB_STD[:, None, None])


def normalise_depth(
    depth_m: Float32[np.ndarray, "h w"], camera: CameraModel
) -> Float32[np.ndarray, "1 padded_h padded_w"]:
    """Returns normalised depth, padded by repeating the edge; 0 (no return or too near) counts as the nearest depth.

    Raises:
        ConfigError: the camera's range is not finite.
    """
    if not math.isfinite(camera.max_depth_m):
        raise ConfigError(f"A network needs a depth camera with a finite range, got max_depth_m {camera.max_depth_m}.")
    scaled = np.clip((depth_m - camera.min_depth_m) / (camera.max_depth_m - camera.min_depth_m), 0.0, 1.0)
    scaled = ((scaled - DEPTH_MEAN) / DEPTH_STD).astype(np.float32)
    return pad_edges(scaled[None])


def pad_edges(channels: Float32[np.ndarray, "c h w"]) -> Float32[np.ndarray, "c padded_h padded_w"]:
    """Returns an image of a size that a network takes, padded by repeating the edge."""
    pad = padding(*channels.shape[1:])
    return np.pad(channels, ((0, 0), pad[:2], pad[2:]), mode="edge")
