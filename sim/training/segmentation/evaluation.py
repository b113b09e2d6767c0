"""Evaluates a network: intersection over union, and the reliability of its scores."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import cv2
import numpy as np
import torch
from jaxtyping import Float32, Float64, Int64, UInt8
from torch import Tensor

from sim.core.interface import GOAL_CATEGORIES, MPCAT40, MPCAT40_ID
from sim.training.segmentation.samples import SURFACES
from stubborn.segmentation.calibration import fit_calibration
from stubborn.segmentation.rednet import CLASSES, RedNet

GOAL_CHANNELS = np.array([MPCAT40_ID[name] - 1 for name in GOAL_CATEGORIES])
"""Output channels of the goal categories."""
RELIABILITY_BINS = 10
DRAWS = 1000
"""Number of draws of houses for an interval."""
SLIVER_PX = 24
"""A sliver at an edge of the image extends less than this from the edge, in pixels of the 640 x 480 image."""


def confusion(
    predicted: Int64[np.ndarray, "*shape"], truth: Int64[np.ndarray, "*shape"]
) -> Int64[np.ndarray, "classes classes"]:
    """Returns the number of pixels by true class (row) and predicted class (column), without ignored pixels."""
    counts = truth >= 0
    joint = truth[counts] * CLASSES + predicted[counts]
    return np.bincount(joint, minlength=CLASSES * CLASSES).reshape(CLASSES, CLASSES)


@dataclass(frozen=True)
class Iou:
    """The intersection over union of each class on one set of views."""

    by_category: dict[str, float]
    """Values of the categories that appear in the views."""
    goals: float
    """Mean over the goal categories in the views (mIoU)."""
    everything: float
    """Mean over all categories in the views."""
    accuracy: float
    """Share of pixels that are classified correctly."""

    @classmethod
    def of(cls, matrix: Int64[np.ndarray, "classes classes"]) -> Iou:
        """Returns the values of a confusion matrix."""
        right, truth, predicted = np.diag(matrix), matrix.sum(axis=1), matrix.sum(axis=0)
        union = truth + predicted - right
        by_category = {
            MPCAT40[i + 1]: float(right[i] / union[i]) for i in range(CLASSES) if truth[i] > 0 and union[i] > 0
        }
        goals = [by_category[name] for name in GOAL_CATEGORIES if name in by_category]
        return cls(
            by_category,
            float(np.mean(goals)) if goals else math.nan,
            float(np.mean(list(by_category.values()))) if by_category else math.nan,
            float(right.sum() / max(1, truth.sum())),
        )


@dataclass
class Confusions:
    """Confusion matrices of the views of each house, for the interval of the mIoU over houses."""

    matrices: dict[tuple[str, str], Int64[np.ndarray, "classes classes"]] = field(default_factory=dict)
    """By folder of views and house."""

    def add(self, folder: str, house: str, matrix: Int64[np.ndarray, "classes classes"]) -> None:
        """Adds a matrix; see `confusion`."""
        self.matrices[folder, house] = matrix + self.matrices.get((folder, house), 0)

    def of(self, folder: str | None = None) -> Int64[np.ndarray, "classes classes"]:
        """Returns the sum of the matrices of one folder, or of all."""
        return sum(self._by_house(folder).values(), np.zeros((CLASSES, CLASSES), np.int64))

    def folders(self) -> list[str]:
        """Returns the names of the folders in the order in which they came."""
        return list(dict.fromkeys(folder for folder, _ in self.matrices))

    def goals_text(self, folder: str | None = None) -> str:
        """Returns the mIoU over the goal categories with its 95 % interval, such as `0.512 [0.470, 0.548]`.

        The interval holds the 2.5th to the 97.5th percentile of `DRAWS` sets of as many houses, drawn with replacement.
        One house has no interval.
        """
        value, drawn = self._goals(folder)
        return f"{value:.3f}{_interval(drawn)}"

    def difference_text(self, other: Confusions, folder: str | None = None) -> str:
        """Returns this mIoU minus another one on the same views, and its interval, such as `+0.031 [0.018, 0.036]`.

        Both take the same draws of houses.
        """
        (ours, our_draws), (theirs, their_draws) = self._goals(folder), other._goals(folder)
        return f"{ours - theirs:+.3f}{_interval(our_draws - their_draws)}"

    def _goals(self, folder: str | None) -> tuple[float, Float64[np.ndarray, " draws"]]:
        """Returns the mIoU over the goal categories, and that of each draw of houses; no draws for one house."""
        by_house = self._by_house(folder)
        houses = np.stack([by_house[name] for name in sorted(by_house)])
        rng, count = np.random.default_rng(0), len(houses)
        drawn = (houses[rng.integers(count, size=count)].sum(axis=0) for _ in range(DRAWS if count > 1 else 0))
        return Iou.of(houses.sum(axis=0)).goals, np.array([Iou.of(matrix).goals for matrix in drawn])

    def _by_house(self, folder: str | None) -> dict[str, Int64[np.ndarray, "classes classes"]]:
        summed = dict[str, Int64[np.ndarray, "classes classes"]]()
        for (name, house), matrix in self.matrices.items():
            if folder in (None, name):
                summed[house] = matrix + summed.get(house, 0)
        return summed


def _interval(drawn: Float64[np.ndarray, " draws"]) -> str:
    """Returns the 95 % interval of the values of the draws, such as ` [0.470, 0.548]`; "" without draws."""
    if len(drawn) == 0:
        return ""
    low, high = np.nanquantile(drawn, (0.025, 0.975))
    return f" [{low:.3f}, {high:.3f}]"


@dataclass
class Reliability:
    """The share of correct classes at a score p, in bins of p, over the goal categories' scores of every pixel."""

    count: Int64[np.ndarray, " bins"]
    """Number of scores."""
    score: Float64[np.ndarray, " bins"]
    """Sum of the scores."""
    right: Float64[np.ndarray, " bins"]
    """Number of correct classes."""

    @classmethod
    def empty(cls) -> Reliability:
        """Returns counts of zero."""
        n = RELIABILITY_BINS
        return cls(np.zeros(n, np.int64), np.zeros(n), np.zeros(n))

    def add(self, probability: Float32[np.ndarray, "classes n"], truth: Int64[np.ndarray, " n"]) -> None:
        """Counts the goal categories' scores of pixels with these true channels; scores below 0.01 are left out."""
        p = probability[GOAL_CHANNELS]
        hit = GOAL_CHANNELS[:, None] == truth[None]
        kept = p >= 0.01
        p, hit = p[kept], hit[kept]
        bins = np.minimum((p * RELIABILITY_BINS).astype(np.int64), RELIABILITY_BINS - 1)
        self.count += np.bincount(bins, minlength=RELIABILITY_BINS)
        self.score += np.bincount(bins, weights=p, minlength=RELIABILITY_BINS)
        self.right += np.bincount(bins, weights=hit, minlength=RELIABILITY_BINS)

    def rows(self) -> list[tuple[int, float, float]]:
        """Returns the count, the mean score and the share of correct classes of each bin that is not empty."""
        return [
            (int(n), float(s / n), float(r / n))
            for n, s, r in zip(self.count, self.score, self.right, strict=True)
            if n > 0
        ]

    @property
    def error(self) -> float:
        """Expected calibration error: mean of |score - share|, weighted by counts (Naeini et al. 2015)."""
        total = max(1, int(self.count.sum()))
        return float(sum(n * abs(score - right) for n, score, right in self.rows()) / total)


class Evaluation(NamedTuple):
    """Results of a network on some views."""

    iou: Iou
    """Intersection over union of the network's own logits."""
    reliability: Reliability
    """Reliability of the network's own scores."""
    calibrated: Iou
    """Intersection over union of logits calibrated as the agent uses them: each half of the views by a calibration that
    was fitted to the other half. It uses every second pixel in each direction."""


def evaluate(
    model: RedNet,
    batches: Iterable[tuple[Tensor, Tensor, Tensor]],
    *,
    device: torch.device,
) -> Evaluation:
    """Returns the intersection over union and the reliability of a network over batches of samples.

    Args:
        model: the network.
        batches: samples without augmentation; see `sim.training.segmentation.samples.Sample`. Views of one house must
            follow one another, so that the two halves of the views show different houses.
        device: device of the model.
    """
    matrix = np.zeros((CLASSES, CLASSES), np.int64)
    reliability = Reliability.empty()
    thinned: list[tuple[Tensor, Tensor]] = []
    model.eval()
    with torch.inference_mode():
        for rgb, depth, target in batches:
            logits = model(rgb.to(device), depth.to(device)).float().cpu()
            truth = target.numpy()
            matrix += confusion(logits.argmax(dim=1).numpy(), truth)
            some = logits[:, :, 2::8, 2::8].softmax(dim=1)
            kept = truth[:, 2::8, 2::8]
            flat = some.permute(1, 0, 2, 3).reshape(CLASSES, -1).numpy()
            counts = kept.reshape(-1) >= 0
            reliability.add(flat[:, counts], kept.reshape(-1)[counts])
            thinned += zip(logits[:, :, 1::2, 1::2].half(), target[:, 1::2, 1::2], strict=True)
    iou = Iou.of(matrix)
    return Evaluation(iou, reliability, calibrated_iou(thinned) if len(thinned) > 1 else iou)


def calibrated_iou(views: Sequence[tuple[Tensor, Tensor]]) -> Iou:
    """Returns the intersection over union of logits, each half of them calibrated by a fit to the other half.

    Args:
        views: logits (classes, h, w) and true channels (h, w) of each view, at least two.
    """
    matrix = np.zeros((CLASSES, CLASSES), np.int64)
    middle = len(views) // 2
    for fitted, judged in ((views[:middle], views[middle:]), (views[middle:], views[:middle])):
        pairs = [
            (logits[:, ::4, ::4].reshape(CLASSES, -1).t(), truth[::4, ::4].reshape(-1)) for logits, truth in fitted
        ]
        logits, truth = torch.cat([pair[0] for pair in pairs]).float(), torch.cat([pair[1] for pair in pairs])
        if not (truth >= 0).any():
            continue
        calibration = fit_calibration(logits[truth >= 0].clone(), truth[truth >= 0].clone())
        for view, target in judged:
            matrix += confusion(calibration.applied(view.float()).argmax(dim=0).numpy(), target.numpy())
    return Iou.of(matrix)


def without_slivers(semantic: UInt8[np.ndarray, "h w"], block_px: int) -> UInt8[np.ndarray, "h w"]:
    """Returns the labels with slivers at the image's edges as void, which no evaluation counts.

    A sliver is a connected region of one category, other than walls, floors and ceilings, that touches the left or the
    right edge and is less than `SLIVER_PX` wide, or touches the upper or the lower edge and is less than `SLIVER_PX`
    high.

    Args:
        semantic: mpcat40 ids.
        block_px: edge of the square of pixels of the 640 x 480 image that one pixel stands for.
    """
    kept, (height, width) = semantic.copy(), semantic.shape
    edge = np.concatenate([semantic[0], semantic[-1], semantic[:, 0], semantic[:, -1]])
    for category in np.setdiff1d(edge, SURFACES).tolist():
        count, regions, boxes, _ = cv2.connectedComponentsWithStats((semantic == category).astype(np.uint8))
        for number in range(1, count):
            left, top, cols, rows = boxes[number, :4].tolist()
            at_side = (left == 0 or left + cols == width) and cols * block_px < SLIVER_PX
            above = (top == 0 or top + rows == height) and rows * block_px < SLIVER_PX
            if at_side or above:
                kept[regions == number] = 0
    return kept
