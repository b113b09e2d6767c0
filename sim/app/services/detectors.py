"""What a detector sees in a frame: by the truth, by the truth with a network's errors, or by the shipped network."""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.app.services.frames import Frame
from sim.app.services.words import categories_in, category_of
from sim.core.errors import ConfigError
from sim.core.interface import MPCAT40, CameraModel
from sim.core.reading import reason_of
from sim.detectors.noisy import LabelledObjects, NoisyConfig, NoisySegmenter
from stubborn.segmentation.shipped import SHIPPED_REDNET

if TYPE_CHECKING:
    from stubborn.segmentation.network import NetworkSegmenter

MIN_SHARE = 0.0005
"""Smaller segments are not reported, as a share of the picture."""
Source = Literal["truth", "noisy", "network"]


@dataclass(frozen=True, kw_only=True)
class Segment:
    """One object that a detector reports."""

    category: str
    """Category of mpcat40."""
    score: float
    mask: NDArray[np.bool_]
    """(h, w)."""
    phrase: str = ""
    """The word of the service for it; "": it has none."""

    @functools.cached_property
    def box(self) -> tuple[float, float, float, float]:
        """Left, top, right and bottom edge, as shares of width and height."""
        height, width = self.mask.shape
        rows, columns = np.flatnonzero(self.mask.any(axis=1)), np.flatnonzero(self.mask.any(axis=0))
        return columns[0] / width, rows[0] / height, (columns[-1] + 1) / width, (rows[-1] + 1) / height


Detector = Callable[[Frame], list[Segment]]


def make_detector(source: Source) -> Detector:
    """Returns the detector of a source."""
    return {"truth": true_segments, "noisy": noisy_segments, "network": NetworkDetector()}[source]


def true_segments(frame: Frame) -> list[Segment]:
    """Returns each object in view, with its exact outline and score 1."""
    return _segments(frame.objects, frame.categories, np.ones(len(frame.categories)))


def noisy_segments(frame: Frame) -> list[Segment]:
    """Returns the objects in view with errors of a network: `sim.detectors.noisy`."""
    count = len(frame.names)
    if not count:
        return []
    objects = LabelledObjects.named(frame.names, frame.categories, frame.middles_xy_m, np.arange(count))
    share = np.bincount(frame.objects.reshape(-1) + 1, minlength=count + 1)[1:] / frame.objects.size
    rng = np.random.default_rng([frame.seed & 0xFFFFFFFF, frame.number])
    detector = NoisySegmenter.without_episode(NoisyConfig(stride_px=1))
    classified = detector.classify(objects, share, frame.eye_xy_m, frame.seed, rng)
    shown = detector.with_outlines(frame.objects.astype(np.intp), rng)
    shown[(classified.first == 0)[shown] & (shown >= 0)] = -1
    return _segments(shown, [MPCAT40[number] for number in classified.first], classified.confidence)


def _segments(
    shown: NDArray[np.signedinteger], categories: Sequence[str], scores: NDArray[np.float64]
) -> list[Segment]:
    """Returns the segments of an image of object indices, -1 for none."""
    counts = np.bincount(shown.reshape(-1) + 1, minlength=len(categories) + 1)[1:]
    return [
        Segment(category=categories[index], score=float(scores[index]), mask=shown == index)
        for index in np.flatnonzero(counts >= max(1.0, MIN_SHARE * shown.size)).tolist()
    ]


class NetworkDetector:
    """The shipped network: a segment is a connected area whose most probable category is the same."""

    def __init__(self) -> None:
        self._lock = threading.Lock()

    def posteriors(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32], camera: CameraModel) -> NDArray:
        """Returns the probability of each category except void, float32 (40, h / 4, w / 4).

        Raises:
            ConfigError: the network cannot take images of this size.
        """
        with self._lock:
            try:
                return _network(camera).posteriors({"rgb": rgb, "depth": depth})
            except (RuntimeError, ValueError, IndexError) as error:
                raise ConfigError(f"The network cannot take these images: {reason_of(error)}.") from None

    def __call__(self, frame: Frame) -> list[Segment]:
        """Returns the segments of a frame; the score is the mean probability of the category."""
        posteriors = self.posteriors(frame.rgb, frame.depth, frame.camera)
        best, segments = posteriors.argmax(axis=0), list[Segment]()
        height, width = frame.depth.shape
        for channel in np.unique(best):
            count, areas, statistics, _ = cv2.connectedComponentsWithStats((best == channel).astype(np.uint8))
            for area in range(1, count):
                if statistics[area, cv2.CC_STAT_AREA] >= MIN_SHARE * best.size:
                    small = areas == area
                    mask = cv2.resize(small.astype(np.uint8), (width, height), interpolation=cv2.INTER_NEAREST) > 0
                    score = float(posteriors[channel][small].mean())
                    segments.append(Segment(category=MPCAT40[channel + 1], score=score, mask=mask))
        return segments


@functools.lru_cache(maxsize=4)
def _network(camera: CameraModel) -> NetworkSegmenter:
    """Returns the shipped network for a camera, as a run with `--semantics rednet` makes it."""
    from stubborn.segmentation.network import NetworkSegmenter
    from stubborn.segmentation.processor import computes_bf16

    return NetworkSegmenter.from_file(SHIPPED_REDNET, camera=camera, threads=1, mirrored=computes_bf16())


def detections(segments: Sequence[Segment], phrases: Mapping[str, str], least_score: float) -> dict[str, Any]:
    """Returns the reply of GroundingDINO and YOLO in VLFM's form.

    Args:
        segments: what the detector sees.
        phrases: the phrase for each category that is asked for.
        least_score: segments with a lower score are left out.
    """
    chosen = [segment for segment in segments if segment.category in phrases and segment.score >= least_score]
    chosen.sort(key=lambda segment: -segment.score)
    return {
        "boxes": [list(segment.box) for segment in chosen],
        "logits": [segment.score for segment in chosen],
        "phrases": [phrases[segment.category] for segment in chosen],
    }


def phrases_of(caption: str) -> dict[str, str]:
    """Returns the phrase for each category that a caption such as `chair . potted plant .` asks for."""
    phrases = [phrase.strip() for phrase in caption.split(".")]
    named = [(category, phrase) for phrase in phrases if (category := category_of(phrase))]
    return dict(reversed(named))  # the first phrase of a category counts


def mask_in(segments: Sequence[Segment], box: Sequence[float], shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Returns the mask (h, w) of the segment whose box overlaps a box most; empty if none overlaps it.

    Args:
        segments: what the detector sees.
        box: left, top, right and bottom edge, pixels.
        shape: rows and columns of the picture.
    """
    scale = np.array([shape[1], shape[0], shape[1], shape[0]])
    overlaps = [_overlap(np.array(segment.box) * scale, np.array(box, float)) for segment in segments]
    if not overlaps or max(overlaps) <= 0.0:
        return np.zeros(shape, np.bool_)
    return segments[int(np.argmax(overlaps))].mask


def _overlap(first: NDArray, second: NDArray) -> float:
    """Returns the intersection of two boxes over their union."""
    sides = np.minimum(first[2:], second[2:]) - np.maximum(first[:2], second[:2])
    shared = float(np.prod(np.maximum(sides, 0.0)))
    union = float(np.prod(first[2:] - first[:2]) + np.prod(second[2:] - second[:2])) - shared
    return shared / union if union > 0.0 else 0.0


def share_of(segments: Sequence[Segment], text: str) -> float:
    """Returns the share of the picture that shows objects which a sentence names."""
    named = categories_in(text)
    masks = [segment.mask for segment in segments if segment.category in named]
    return float(np.logical_or.reduce(masks).mean()) if masks else 0.0
