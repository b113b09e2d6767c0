"""Class probabilities of an object, fused over the views from which it was seen.

Frames of one view (a sector of directions and a range of distances) err in the same way, so they are averaged. Views
that differ are fused as the geometric mean of their probabilities, sharpened by the number of views that are worth as
much as independent ones (a logarithmic opinion pool: Genest and Zidek 1986).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int

from sim.interface import ConfigError


@dataclass(frozen=True, kw_only=True)
class EvidenceConfig:
    """Views, and what each is worth. The values are reasoned, not fitted."""

    sectors: int = 12
    """Number of directions from which an object can be seen, 30 deg each."""
    rings_m: tuple[float, ...] = (1.2, 3.0, 4.2)
    """Distances to the middle of an object at which the view changes."""
    ring_weights: tuple[float, ...] = (0.3, 1.0, 0.6, 0.3)
    """Weight of a view within the first distance, the second, ..., and beyond the last: nearer than 1.2 m the image
    does not hold the whole object, and a far object is a few pixels."""
    full_pixels: int = 40
    """A frame with fewer pixels of the object counts in proportion."""
    floor: float = 0.002
    """Least probability of a class in a view, so that one confident view cannot decide alone."""
    extra_view: float = 0.3
    """A further view is worth this much of an independent one: views of one object share its looks."""
    most_views: float = 3.0
    """All views together are worth at most so many independent ones."""

    def __post_init__(self) -> None:
        if len(self.ring_weights) != len(self.rings_m) + 1:
            raise ConfigError(
                f"EvidenceConfig needs a weight within each of rings_m and one beyond, got {len(self.ring_weights)} "
                f"for {len(self.rings_m)} distances."
            )


class Evidence:
    """The views of all tracks; tracks are numbered, and number 0 is none."""

    def __init__(self, config: EvidenceConfig, tracks: int, classes: int) -> None:
        self.config = config
        views = config.sectors * len(config.ring_weights)
        self._sums = np.zeros((tracks, views, classes), np.float32)
        self._weights = np.zeros((tracks, views), np.float32)
        self._ring_weight = np.repeat(np.array(config.ring_weights, np.float32), config.sectors)
        self.probability: Float32[np.ndarray, "tracks classes"] = np.full((tracks, classes), 1.0 / classes, np.float32)
        """Fused probability of each class."""

    def add(
        self,
        tracks: Int[np.ndarray, " n"],
        mean: Float32[np.ndarray, "n classes"],
        pixels: Int[np.ndarray, " n"],
        dx_m: Float64[np.ndarray, " n"],
        dy_m: Float64[np.ndarray, " n"],
    ) -> None:
        """Enters one frame.

        Args:
            tracks: those in view.
            mean: mean posteriors of their pixels.
            pixels: number of these.
            dx_m: from the middle of each to the camera; also `dy_m`.
        """
        view = self._view(dx_m, dy_m)
        weight = np.minimum(pixels / np.float32(self.config.full_pixels), np.float32(1.0)).astype(np.float32)
        self._sums[tracks, view] += weight[:, None] * mean
        self._weights[tracks, view] += weight
        self.probability[tracks] = self._fused(tracks)

    def merge(self, track: int, into: int) -> None:
        """Gives the views of a track to another one; the first has none afterwards."""
        self._sums[into] += self._sums[track]
        self._weights[into] += self._weights[track]
        self._sums[track] = 0.0
        self._weights[track] = 0.0
        self.probability[[track, into]] = self._fused(np.array([track, into]))

    def near_sectors(self, track: int) -> Bool[np.ndarray, " sectors"]:
        """Returns the directions from which a track was seen well: in a ring of full weight, with enough pixels."""
        full = self._ring_weight >= 1.0
        seen = (self._weights[track] >= 1.0) & full
        return np.asarray(seen.reshape(-1, self.config.sectors).any(axis=0))

    def _view(self, dx_m: Float64[np.ndarray, " n"], dy_m: Float64[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
        sector = self.sector_of(np.arctan2(dy_m, dx_m))
        ring = np.searchsorted(np.array(self.config.rings_m), np.hypot(dx_m, dy_m))
        return np.asarray(ring * self.config.sectors + sector)

    def sector_of(self, bearing_rad: Float64[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
        """Returns the number of the sector around each direction from the object to the camera."""
        turns = bearing_rad / math.tau * self.config.sectors
        return np.rint(turns).astype(np.intp) % self.config.sectors

    def _fused(self, tracks: Int[np.ndarray, " n"]) -> Float32[np.ndarray, "n classes"]:
        c = self.config
        count = self._weights[tracks]
        mean = self._sums[tracks] / np.maximum(count, 1e-6)[:, :, None]
        weight = np.minimum(count, 1.0) * self._ring_weight
        total = np.maximum(weight.sum(axis=1, keepdims=True), 1e-6)
        worth = np.where(total > 1.0, np.minimum(1.0 + c.extra_view * (total - 1.0), c.most_views), total)
        log = np.einsum("nv,nvc->nc", weight, np.log(np.maximum(mean, c.floor))) / total * worth
        odds = np.exp(log - log.max(axis=1, keepdims=True))
        return np.asarray(odds / odds.sum(axis=1, keepdims=True), np.float32)
