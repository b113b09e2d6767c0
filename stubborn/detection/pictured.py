"""Tests whether tracked objects are the object of a picture: by the colours of the object, and by those around it.

The picture comes from another camera, in another place. What both views share are colours: a histogram of the object's
pixels, and one of all others, which is that of walls, floor and furniture nearby. `attributes.json` holds a
logistic regression from the similarities of the two histograms to the probability that both views show the same object,
fitted in houses of `train` by `tools.training.fit_attributes`. Local features (SIFT) added nothing to them there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import cv2
import numpy as np
from jaxtyping import Float32, Int, UInt8

from sim.core.interface import GOAL_CATEGORIES, MPCAT40, MPCAT40_ID
from stubborn.detection.attributes import AT_LAST, UNDECIDED, fitted, follow_merges
from stubborn.detection.tracks import Pixels, Tracks

CELLS = 384
"""Cells of CIELAB that are counted: six of lightness, eight of each of the other two coordinates."""
_MIDDLE = 0.5
"""Standard deviation, as a share of half the side, of the weight that pixels in the middle of a picture have."""
_MIN_PIXELS, _MIN_SHARE = 60, 0.004
"""Pixels of a track, at the resolution of the posteriors, from which it is judged, and their share of a frame whose
surroundings are those of the track."""


@dataclass(frozen=True, eq=False)
class PictureGoal:
    """What a picture shows."""

    category: str
    """The goal category of the object in the middle."""
    own: Float32[np.ndarray, " cells"]
    """Colours of the object's pixels, shares."""
    around: Float32[np.ndarray, " cells"]
    """Colours of all other pixels, shares."""

    @classmethod
    def of(cls, picture: UInt8[np.ndarray, "h w 3"], posteriors: Float32[np.ndarray, "classes rows cols"]) -> Self:
        """Reads a picture.

        Args:
            picture: colours.
            posteriors: the probability of each category of `MPCAT40` except void, at any resolution.
        """
        channels = [MPCAT40_ID[name] - 1 for name in GOAL_CATEGORIES]
        rows, cols = posteriors.shape[1:]
        down, right = np.linspace(-1.0, 1.0, rows)[:, None], np.linspace(-1.0, 1.0, cols)[None]
        weight = np.exp(-(down**2 + right**2) / (2.0 * _MIDDLE**2))
        best = int(np.argmax((posteriors[channels] * weight).sum(axis=(1, 2))))
        shows = posteriors.argmax(axis=0) == channels[best]
        cells = colour_cells(cv2.resize(picture, (cols, rows), interpolation=cv2.INTER_AREA))
        return cls(GOAL_CATEGORIES[best], _shares(cells[shows]), _shares(cells[~shows]))


class PictureEvidence:
    """The colours of the tracks of one episode, which tell whether a track is the object of a picture.

    Args:
        most_tracks: limit of the number of tracks.
    """

    def __init__(self, most_tracks: int) -> None:
        self._own = np.zeros((most_tracks, CELLS), np.float32)
        self._around = np.zeros((most_tracks, CELLS), np.float32)

    def add(self, pixels: Pixels, rgb: UInt8[np.ndarray, "h w 3"]) -> None:
        """Enters one frame: tracks and colours of its pixels."""
        cells, tracks = colour_cells(rgb).ravel(), pixels.track.ravel()
        frame = np.bincount(cells, minlength=CELLS).astype(np.float32)
        numbers, counts = np.unique(tracks[tracks > 0], return_counts=True)
        for track in numbers[counts >= max(_MIN_PIXELS, _MIN_SHARE * tracks.size)].tolist():
            own = np.bincount(cells[tracks == track], minlength=CELLS)
            self._own[track] += own
            self._around[track] += frame - own

    def factors(
        self, goal: PictureGoal, tracks: Tracks, candidates: Int[np.ndarray, " n"], late: bool
    ) -> Float32[np.ndarray, " n"]:
        """Returns the factor of a picture for each candidate; see `Attributes.factors`."""
        follow_merges(tracks.now(), self._own, self._around)
        undecided = AT_LAST if late else UNDECIDED
        return np.array([self._probability(goal, track, undecided) for track in candidates.tolist()], np.float32)

    def _probability(self, goal: PictureGoal, track: int, undecided: float) -> float:
        """Returns the probability that a track is the object of a picture."""
        if self._own[track].sum() < _MIN_PIXELS:
            return undecided
        alike = similarities(goal, _shares_of(self._own[track]), _shares_of(self._around[track]))
        return fitted().picture.probability(alike)


def colour_cells(rgb: UInt8[np.ndarray, "h w 3"]) -> Int[np.ndarray, "h w"]:
    """Returns the cell of CIELAB of each pixel, 0 to 383."""
    lab = cv2.cvtColor(np.ascontiguousarray(rgb), cv2.COLOR_RGB2LAB).astype(np.int32)
    a, b = (np.clip((lab[..., channel] - 96) // 8, 0, 7) for channel in (1, 2))
    return lab[..., 0] // 43 * 64 + a * 8 + b


def one_hot(categories: UInt8[np.ndarray, "h w"]) -> Float32[np.ndarray, "classes h w"]:
    """Returns the probabilities of the categories of `MPCAT40` except void for known mpcat40 ids."""
    return (categories == np.arange(1, len(MPCAT40), dtype=np.uint8)[:, None, None]).astype(np.float32)


def similarities(
    goal: PictureGoal, own: Float32[np.ndarray, " cells"], around: Float32[np.ndarray, " cells"]
) -> tuple[float, float]:
    """Returns the Bhattacharyya coefficients, 0 to 1, of an object and its surroundings with those of a picture."""
    return float(np.sqrt(goal.own * own).sum()), float(np.sqrt(goal.around * around).sum())


def _shares(cells: Int[np.ndarray, " n"]) -> Float32[np.ndarray, " cells"]:
    return _shares_of(np.bincount(cells, minlength=CELLS).astype(np.float32))


def _shares_of(counts: Float32[np.ndarray, " cells"]) -> Float32[np.ndarray, " cells"]:
    return counts / max(float(counts.sum()), 1.0)
