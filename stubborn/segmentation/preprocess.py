"""From camera images to what a RedNet takes: normalisation, working resolution, padding. NumPy and OpenCV only."""

from __future__ import annotations

import math
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.interface import CameraModel, ConfigError

RGB_MEAN = np.array([0.493, 0.468, 0.438], np.float32)
RGB_STD = np.array([0.544, 0.521, 0.499], np.float32)
DEPTH_MEAN, DEPTH_STD = 0.213, 0.285
"""Of the published network, for RGB / 255 and for depth scaled to [0, 1] over the sensor's range."""
STRIDE_PX = 32
"""Height and width of a RedNet's input must be multiples of this: five halvings."""


class Padding(NamedTuple):
    """Rows and columns added around an image so that each size is a multiple of 32."""

    top: int
    bottom: int
    left: int
    right: int

    def crop(self, image: NDArray) -> NDArray:
        """The image (..., h, w) without them."""
        height, width = image.shape[-2:]
        return image[..., self.top : height - self.bottom, self.left : width - self.right]


def padding(height_px: int, width_px: int) -> Padding:
    """What an image of this size lacks, shared between its two sides."""
    rows, cols = -height_px % STRIDE_PX, -width_px % STRIDE_PX
    return Padding(rows // 2, rows - rows // 2, cols // 2, cols - cols // 2)


def shrink(image: NDArray, block_px: int) -> NDArray:
    """Every block of pixels as one: colour is averaged, anything else takes the pixel in the block's middle.

    Args:
        image: (h, w, 3) colour or (h, w) depth or labels; sizes are multiples of `block_px`.
        block_px: edge of a block.

    Raises:
        ConfigError: the image is no whole number of blocks.
    """
    height, width = image.shape[:2]
    if height % block_px or width % block_px:
        raise ConfigError(f"An image of {height} x {width} pixels is no whole number of {block_px} pixel blocks.")
    if block_px == 1:
        return image
    if image.ndim == 3:
        return cv2.resize(image, (width // block_px, height // block_px), interpolation=cv2.INTER_AREA)
    middle = block_px // 2
    return np.ascontiguousarray(image[middle::block_px, middle::block_px])


def normalise_rgb(rgb: NDArray[np.uint8]) -> NDArray[np.float32]:
    """(h, w, 3) uint8 to (3, h + padding, w + padding) float32; the border repeats the edge."""
    scaled = (rgb.astype(np.float32) / 255.0 - RGB_MEAN) / RGB_STD
    pad = padding(*rgb.shape[:2])
    return np.pad(scaled.transpose(2, 0, 1), ((0, 0), pad[:2], pad[2:]), mode="edge")


def normalise_depth(depth: NDArray[np.float32], camera: CameraModel) -> NDArray[np.float32]:
    """(h, w) metres to (1, h + padding, w + padding); no return and too near read as the nearest distance."""
    if not math.isfinite(camera.max_depth_m):
        raise ConfigError("A network needs a depth camera with a finite range.")
    scaled = np.clip((depth - camera.min_depth_m) / (camera.max_depth_m - camera.min_depth_m), 0.0, 1.0)
    scaled = ((scaled - DEPTH_MEAN) / DEPTH_STD).astype(np.float32)
    pad = padding(*depth.shape)
    return np.pad(scaled[None], ((0, 0), pad[:2], pad[2:]), mode="edge")
