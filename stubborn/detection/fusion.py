"""Computes the probability of each category from the views of an object.

The posteriors of a track's pixels contain two facts: how much of it is wall, floor or ceiling (a voxel holds a part of
what is behind the object), and which object the rest shows. They are separated: the object's categories compete with
each other, and the share of surface shows whether there is an object at all. Views are averaged with a weight for each
range of distance; the average is sharpened more when there are more views, and each category has an offset. Objects
nearby are additional evidence, see `stubborn.detection.context`.

The parameters describe the errors of one kind of segmentation. `stubborn train fusion` fits them to tracks in houses
with furniture that the network has not seen, and writes `stubborn/detection/fusions/<kind>.json`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
from jaxtyping import Float32

from sim.core.interface import MPCAT40, ConfigError, SegmenterSpec
from sim.core.reading import Number, read_json
from stubborn.detection.verification import DEFAULT_KIND

FOLDER = Path(__file__).parent / "fusions"
"""Folder of the shipped parameters."""
SURFACES = ("wall", "floor", "ceiling")
"""Categories of the surfaces behind, below and above every object."""
IS_SURFACE = np.array([name in SURFACES for name in MPCAT40[1:]])
"""One entry for each category of `MPCAT40` except void."""
_OBJECTS = tuple(name for name in MPCAT40[1:] if name not in SURFACES)
_Positive = Annotated[float, msgspec.Meta(gt=0.0, le=1e3)]


@dataclass(frozen=True, kw_only=True)
class Fusion:
    """Parameters of the fusion; the default is for exact posteriors, which are only averaged."""

    ring_weights: tuple[float, ...] = (0.3, 1.0, 0.6, 0.3)
    """Weight of a view in each range of distance (`EvidenceConfig.rings_m`)."""
    sharpness: float = 1.0
    """Factor of the logarithm of the averaged probabilities, for views of total weight 1."""
    growth: float = 0.0
    """The factor grows with this power of the total weight."""
    floor: float = 0.002
    """Added to each averaged probability, so that a single view cannot exclude a category."""
    surface: tuple[float, float, float] = (-3.0, 1.0, 0.0)
    """Log-odds of no object: a constant, the factor of the log-odds of the surface's share, and the factor of the
    logarithm of the total weight."""
    offsets: Mapping[str, float] = field(default_factory=dict)
    """Log-odds to add for a category: positive where the segmenter misses it more often than it reports it falsely."""

    def __post_init__(self) -> None:
        unknown = sorted(set(self.offsets) - set(_OBJECTS))
        if unknown:
            raise ConfigError(f"Fusion.offsets must name categories of objects, got '{unknown[0]}'.")
        if not (self.sharpness > 0.0 and self.floor > 0.0 and min(self.ring_weights, default=0.0) > 0.0):
            raise ConfigError(
                "Fusion needs ring_weights, sharpness and floor > 0, "
                f"got {self.ring_weights}, {self.sharpness} and {self.floor}."
            )

    def probabilities(
        self, mean: Float32[np.ndarray, "n views classes"], weight: Float32[np.ndarray, "n views"]
    ) -> Float32[np.ndarray, "n classes"]:
        """Returns the probability of each category, for each track.

        Args:
            mean: mean posterior of the track's pixels in each view; any finite values in views without weight.
            weight: weight of each view, including the factor of its distance; 0 for directions without a view.
        """
        objects, surface = mean[:, :, ~IS_SURFACE], mean[:, :, IS_SURFACE]
        of_objects, of_surface = objects.sum(axis=2), surface.sum(axis=2)
        total = np.maximum(weight.sum(axis=1), np.float32(1e-6))
        share = (weight / total[:, None] / np.maximum(of_objects, np.float32(1e-3)))[:, None, :]
        averaged = (share @ objects)[:, 0]
        behind = of_surface / np.maximum(of_objects + of_surface, np.float32(1e-6))
        behind = np.clip((weight * behind).sum(axis=1) / total, 1e-3, 1.0 - 1e-3)
        total = np.maximum(total, np.float32(0.05))
        z = (self.sharpness * total**self.growth)[:, None] * np.log(averaged + np.float32(self.floor))
        z -= z.max(axis=1, keepdims=True)
        z -= np.log(np.exp(z).sum(axis=1, keepdims=True))
        z += self._offsets
        constant, slope, growth = self.surface
        none = constant + slope * np.log(behind / (1.0 - behind)) + growth * np.log(total)
        odds, odds_of_none = np.exp(z), np.exp(none)
        whole = odds.sum(axis=1) + odds_of_none
        result = np.empty((len(mean), len(IS_SURFACE)), np.float32)
        result[:, ~IS_SURFACE] = odds / whole[:, None]
        shown = (weight[:, None, :] @ surface)[:, 0] + np.float32(1e-6)
        result[:, IS_SURFACE] = shown / shown.sum(axis=1, keepdims=True) * (odds_of_none / whole)[:, None]
        return result

    @property
    def _offsets(self) -> Float32[np.ndarray, " objects"]:
        return np.array([self.offsets.get(name, 0.0) for name in _OBJECTS], np.float32)


class _Parameters(msgspec.Struct):
    """The part of a file that the agent reads."""

    ring_weights: tuple[_Positive, _Positive, _Positive, _Positive]
    sharpness: _Positive
    growth: Number
    floor: _Positive
    surface: tuple[Number, Number, Number]
    offsets: dict[str, Number]


class _File(msgspec.Struct):
    """A file of `stubborn train fusion`."""

    fusion: _Parameters


def read_fusion(file: Path) -> Fusion:
    """Returns the parameters in a file that `stubborn train fusion` wrote.

    Raises:
        ConfigError: the file is missing or holds something else.
    """
    return Fusion(**msgspec.structs.asdict(read_json(file, _File, what="Fusion file").fusion))


def fusion_for(spec: SegmenterSpec, file: Path | None = None) -> Fusion:
    """Returns the parameters for a segmenter: those in `file`, or the shipped ones of its kind, else of `DEFAULT_KIND`.

    Raises:
        ConfigError: the file is missing or broken.
    """
    if file is not None:
        return read_fusion(file)
    if not spec.needs_verification:
        return Fusion()
    own = FOLDER / f"{spec.kind}.json"
    return read_fusion(own if own.is_file() else FOLDER / f"{DEFAULT_KIND}.json")
