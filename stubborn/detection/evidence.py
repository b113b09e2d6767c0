"""The views from which objects were seen, and the class probabilities that follow from them.

Frames of one view (a sector of directions and a range of distances) have the same errors, so they are averaged.
Different views are fused by `stubborn.detection.fusion`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int

from sim.core.interface import ConfigError
from stubborn.detection.fusion import IS_SURFACE, Fusion


@dataclass(frozen=True, kw_only=True)
class EvidenceConfig:
    """Divides the poses around an object into views."""

    sectors: int = 12
    """Number of directions from which an object can be seen, 30 deg each."""
    rings_m: tuple[float, float, float] = (1.2, 3.0, 4.2)
    """Distances to the middle of an object at which the view changes."""
    near_ring: int = 1
    """The range of distances from which an object is seen well: from nearer than 1.2 m the image does not show the
    whole object, and a far object covers only a few pixels."""
    full_pixels: int = 40
    """A frame with fewer pixels of the object counts in proportion."""
    fusion: Path | None = None
    """File of `stubborn train fusion`; None: the shipped parameters of the kind of segmentation."""

    def __post_init__(self) -> None:
        if self.sectors < 1 or self.full_pixels < 1:
            raise ConfigError(
                f"EvidenceConfig needs sectors and full_pixels >= 1, got {self.sectors} and {self.full_pixels}."
            )
        if not 0.0 < self.rings_m[0] < self.rings_m[1] < self.rings_m[2]:
            raise ConfigError(f"EvidenceConfig.rings_m must be three growing distances > 0 m, got {self.rings_m}.")
        if not 0 <= self.near_ring <= len(self.rings_m):
            raise ConfigError(f"EvidenceConfig.near_ring must be one of the {len(self.rings_m) + 1} ranges of rings_m.")


class Evidence:
    """The views of all tracks; tracks are numbered from 1, and number 0 means no track."""

    def __init__(self, config: EvidenceConfig, fusion: Fusion, tracks: int) -> None:
        self.config = config
        self.fusion = fusion
        views, classes = config.sectors * (len(config.rings_m) + 1), len(IS_SURFACE)
        self._sums = np.zeros((tracks, views, classes), np.float32)
        self._weights = np.zeros((tracks, views), np.float32)
        self._whole = np.zeros((tracks, views), np.float32)
        """The part of the weights from frames in which the edge of the image does not cut the track."""
        self._ring_weight = np.repeat(np.array(fusion.ring_weights, np.float32), config.sectors)
        self.probability: Float32[np.ndarray, "tracks classes"] = np.full((tracks, classes), 1.0 / classes, np.float32)
        """Fused probability of each class."""

    def add(
        self,
        tracks: Int[np.ndarray, " n"],
        mean: Float32[np.ndarray, "n classes"],
        pixels: Int[np.ndarray, " n"],
        dx_m: Float64[np.ndarray, " n"],
        dy_m: Float64[np.ndarray, " n"],
        whole: Bool[np.ndarray, " n"] | bool = True,
    ) -> None:
        """Enters one frame.

        Args:
            tracks: the tracks in view.
            mean: mean posteriors of their pixels.
            pixels: number of these pixels.
            dx_m: offset in x from the middle of each track to the camera; `dy_m` is the offset in y.
            whole: False for a track that the edge of the image cuts.
        """
        view = self._view(dx_m, dy_m)
        weight = np.minimum(pixels / np.float32(self.config.full_pixels), np.float32(1.0)).astype(np.float32)
        self._sums[tracks, view] += weight[:, None] * mean
        self._weights[tracks, view] += weight
        self._whole[tracks, view] += weight * whole
        self.probability[tracks] = self._fused(tracks)

    def merge(self, track: int, into: int) -> None:
        """Moves the views of a track to another one."""
        self._sums[into] += self._sums[track]
        self._weights[into] += self._weights[track]
        self._whole[into] += self._whole[track]
        self._sums[track] = 0.0
        self._weights[track] = 0.0
        self._whole[track] = 0.0
        self.probability[[track, into]] = self._fused(np.array([track, into]))

    def near_sectors(self, track: int) -> Bool[np.ndarray, " sectors"]:
        """Returns the directions from which a track was seen well: whole, at the right distance, with enough pixels."""
        return np.asarray(self._whole[track].reshape(-1, self.config.sectors)[self.config.near_ring] >= 1.0)

    def side(self, track: int) -> tuple[float, float]:
        """Returns the sum of the directions from which a track was seen, x and y, by the weights of its views."""
        weight = self._weights[track].reshape(-1, self.config.sectors).sum(axis=0)
        angle_rad = np.arange(self.config.sectors) * (math.tau / self.config.sectors)
        return float(weight @ np.cos(angle_rad)), float(weight @ np.sin(angle_rad))

    def _view(self, dx_m: Float64[np.ndarray, " n"], dy_m: Float64[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
        sector = self.sector_of(np.arctan2(dy_m, dx_m))
        ring = np.searchsorted(np.array(self.config.rings_m), np.hypot(dx_m, dy_m))
        return np.asarray(ring * self.config.sectors + sector)

    def sector_of(self, bearing_rad: Float64[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
        """Returns the number of the sector around each direction from the object to the camera."""
        turns = bearing_rad / math.tau * self.config.sectors
        return np.rint(turns).astype(np.intp) % self.config.sectors

    def views(self, tracks: Int[np.ndarray, " n"]) -> tuple[np.ndarray, np.ndarray]:
        """Returns the mean posterior of each view (n, views, classes) and its weight (n, views), at most 1.

        Views are numbered by range of distance, then by direction. The weight does not include the factor of the
        distance.
        """
        count = self._weights[tracks]
        return self._sums[tracks] / np.maximum(count, 1e-6)[:, :, None], np.minimum(count, 1.0)

    def _fused(self, tracks: Int[np.ndarray, " n"]) -> Float32[np.ndarray, "n classes"]:
        mean, weight = self.views(tracks)
        used = weight.any(axis=0)
        return self.fusion.probabilities(mean[:, used], (weight * self._ring_weight)[:, used])
