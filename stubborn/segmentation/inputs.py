"""The second input of a network, in addition to colour: the depth of the published RedNet, geometry, or both.

All kinds are computed from the whole image before any crop. A network states the kind that it takes; training and the
agent use the same functions.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, Protocol

import cv2
import numpy as np
from jaxtyping import Float32

from sim.core.interface import CameraModel
from stubborn.segmentation import geometry
from stubborn.segmentation.preprocess import normalise_depth, pad_edges

InputKind = Literal["depth", "geometry", "depth-geometry"]


class SecondInput(Protocol):
    """One kind of input in addition to colour."""

    channels: int
    """Number of channels."""

    def of(self, depth_m: Float32[np.ndarray, "h w"], camera: CameraModel) -> Float32[np.ndarray, "h w c"]:
        """Returns the channels of a whole depth image, not yet normalised.

        Raises:
            ConfigError: the camera's range is not finite, or the image is not a whole image of this camera.
        """
        ...

    def mirrored(self, channels: Float32[np.ndarray, "h w c"]) -> Float32[np.ndarray, "h w c"]:
        """Returns the channels of the scene mirrored left to right."""
        ...

    def zoomed(
        self, channels: Float32[np.ndarray, "h w c"], width_px: int, height_px: int, enlargement: float
    ) -> Float32[np.ndarray, "rows cols c"]:
        """Returns a window at another resolution, with distances that keep the metric size of its objects.

        `enlargement` is the size of objects in the result relative to their size in the images for which the network is
        made.
        """
        ...

    def normalised(
        self, channels: Float32[np.ndarray, "h w c"], camera: CameraModel
    ) -> Float32[np.ndarray, "c padded_h padded_w"]:
        """Returns the network's input: scaled, channels first, padded by repeating the edge."""
        ...


class DepthInput:
    """Depth along the optical axis, scaled over the sensor's range as in the published network."""

    channels = 1

    def of(self, depth_m: Float32[np.ndarray, "h w"], camera: CameraModel) -> Float32[np.ndarray, "h w 1"]:
        """Returns the depth in metres."""
        return depth_m[..., None]

    def mirrored(self, channels: Float32[np.ndarray, "h w 1"]) -> Float32[np.ndarray, "h w 1"]:
        """Returns the depth of the mirrored scene."""
        return np.ascontiguousarray(channels[:, ::-1])

    def zoomed(
        self, channels: Float32[np.ndarray, "h w 1"], width_px: int, height_px: int, enlargement: float
    ) -> Float32[np.ndarray, "rows cols 1"]:
        """Returns a window with its depth divided by its enlargement."""
        resized = cv2.resize(channels[..., 0], (width_px, height_px), interpolation=cv2.INTER_NEAREST)
        return (resized / np.float32(enlargement))[..., None]

    def normalised(
        self, channels: Float32[np.ndarray, "h w 1"], camera: CameraModel
    ) -> Float32[np.ndarray, "1 padded_h padded_w"]:
        """Returns the normalised depth; 0 (no return or too near) counts as the nearest depth."""
        return normalise_depth(np.ascontiguousarray(channels[..., 0]), camera)


class GeometryInput:
    """Inverse depth, validity, height above the floor and surface normal."""

    channels = len(geometry.CHANNELS)
    of = staticmethod(geometry.geometry_image)
    mirrored = staticmethod(geometry.mirrored)
    zoomed = staticmethod(geometry.zoomed)

    def normalised(
        self, channels: Float32[np.ndarray, "h w 6"], camera: CameraModel
    ) -> Float32[np.ndarray, "6 padded_h padded_w"]:
        """Returns the normalised geometric channels."""
        return pad_edges(geometry.normalised(channels))


class DepthGeometryInput:
    """Depth, then the geometric channels: a network that takes depth can be trained further with these channels."""

    channels = DepthInput.channels + GeometryInput.channels

    def __init__(self) -> None:
        self._parts = (DepthInput(), GeometryInput())

    def of(self, depth_m: Float32[np.ndarray, "h w"], camera: CameraModel) -> Float32[np.ndarray, "h w 7"]:
        """Returns depth in metres and the geometric channels."""
        return np.concatenate([part.of(depth_m, camera) for part in self._parts], axis=2)

    def mirrored(self, channels: Float32[np.ndarray, "h w 7"]) -> Float32[np.ndarray, "h w 7"]:
        """Returns the channels of the mirrored scene."""
        return np.concatenate([part.mirrored(own) for part, own in self._each(channels)], axis=2)

    def zoomed(
        self, channels: Float32[np.ndarray, "h w 7"], width_px: int, height_px: int, enlargement: float
    ) -> Float32[np.ndarray, "rows cols 7"]:
        """Returns a window in which distances and inverse depth fit its enlargement."""
        parts = [part.zoomed(own, width_px, height_px, enlargement) for part, own in self._each(channels)]
        return np.concatenate(parts, axis=2)

    def normalised(
        self, channels: Float32[np.ndarray, "h w 7"], camera: CameraModel
    ) -> Float32[np.ndarray, "7 padded_h padded_w"]:
        """Returns the normalised channels."""
        return np.concatenate([part.normalised(own, camera) for part, own in self._each(channels)])

    def _each(self, channels: Float32[np.ndarray, "h w 7"]) -> zip[tuple[SecondInput, Float32[np.ndarray, "h w c"]]]:
        """Returns each part with its channels."""
        return zip(self._parts, np.split(channels, [DepthInput.channels], axis=2), strict=True)


INPUTS: Mapping[InputKind, SecondInput] = MappingProxyType(
    {"depth": DepthInput(), "geometry": GeometryInput(), "depth-geometry": DepthGeometryInput()}
)
"""Kinds of second input by name."""
