"""Enters the scores of one frame into the object layers of the map (paper: Mapping Module, channels 4 to 7).

A cell takes the highest score of its pixels, for the target and for the other categories.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from jaxtyping import Bool, Float32, Int

from stubborn.kernels.frames import highest_scores
from stubborn.mapping.navmap import NavMap


@dataclass(frozen=True, kw_only=True)
class ObjectLayersConfig:
    """Defines how long the object layers remember scores."""

    latest_frame_only: bool = False
    """False: the layers of the paper, over all frames. True: the score of the frame that showed a cell last."""

    def make(self, candidate_score: float) -> ObjectLayers:
        """Returns the layers; a cell becomes a candidate at a score higher than `candidate_score`."""
        return LatestFrame(candidate_score) if self.latest_frame_only else AllFrames(candidate_score)


class ObjectLayers(Protocol):
    """Writes one frame of scores into the object layers."""

    def add(self, view: NavMap, frame: FrameScores, step: int) -> None:
        """Enters a frame seen at `step` into a view of the map that contains everything in it."""
        ...


class FrameScores:
    """The pixels of one frame reduced to one score per cell, on the grid of a view."""

    def __init__(
        self,
        shape: tuple[int, int],
        rows: Int[np.ndarray, "h w"],
        cols: Int[np.ndarray, "h w"],
        target: Float32[np.ndarray, "h w"],
        other: Float32[np.ndarray, "h w"],
        *,
        other_of_target_pixel: bool = False,
    ) -> None:
        """`rows` and `cols` are the cell of each pixel (negative: no cell); `target` and `other` are in [0, 1].

        With `other_of_target_pixel`, other scores count only at the pixels of a cell with its highest target score.
        """
        in_view, highest, other_of = np.zeros(shape, np.bool_), np.zeros(shape, np.float32), np.zeros(shape, np.float32)
        scored = highest_scores(rows, cols, target, other, other_of_target_pixel, in_view, highest, other_of)
        self.in_view: Bool[np.ndarray, "rows cols"] = in_view
        """True where a pixel lies."""
        self.target: Float32[np.ndarray, "rows cols"] | None = highest if scored else None
        """Highest score of the target; 0 out of view. None: 0 everywhere."""
        self.other: Float32[np.ndarray, "rows cols"] = other_of
        """Highest score of any other category; 0 out of view."""


class AllFrames:
    """The paper's layers: the number of frames, the sum of the target's scores, the highest target and other score."""

    def __init__(self, candidate_score: float) -> None:
        """A cell becomes a candidate at a score higher than `candidate_score`."""
        self.candidate_score = candidate_score

    def add(self, view: NavMap, frame: FrameScores, step: int) -> None:
        """See `ObjectLayers`."""
        view.frames_in_view += frame.in_view
        np.maximum(view.other_max, frame.other, out=view.other_max)
        if frame.target is None:
            return
        _note_found(view, frame.target, self.candidate_score, step)
        view.score_sum += frame.target
        np.maximum(view.score_max, frame.target, out=view.score_max)


class LatestFrame(AllFrames):
    """The score of one frame in place of the layers: that of the frame in which a cell was last in view.

    The memory of the agent `latest-frame`. `frames_in_view` still counts frames: exploration reads it.
    """

    def add(self, view: NavMap, frame: FrameScores, step: int) -> None:
        """See `ObjectLayers`."""
        view.frames_in_view += frame.in_view
        target = np.zeros_like(frame.other) if frame.target is None else frame.target
        _note_found(view, target, self.candidate_score, step)
        for layer, score in ((view.score_sum, target), (view.score_max, target), (view.other_max, frame.other)):
            np.copyto(layer, score, where=frame.in_view)


def _note_found(view: NavMap, target: Float32[np.ndarray, "rows cols"], candidate_score: float, step: int) -> None:
    """Notes the step for cells that become candidates."""
    view.found_step[(target > candidate_score) & (view.score_max <= candidate_score)] = step
