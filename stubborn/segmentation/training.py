"""Training a RedNet: samples with augmentation, the loss at five scales, the learning rate, intersection over union.

Pure functions over arrays and tensors; the loop that calls them is `tools/train_rednet.py`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.utils.data import Dataset

from sim.interface import GOAL_CATEGORIES, MPCAT40, MPCAT40_ID, CameraModel, ConfigError
from stubborn.segmentation.dataset import LabelledView
from stubborn.segmentation.preprocess import normalise_depth, normalise_rgb, padding, shrink
from stubborn.segmentation.rednet import CLASSES, RedNet

DtypeT = TypeVar("DtypeT", bound=np.generic)
IGNORED = -100
"""Label of pixels that do not count: void and padding."""


@dataclass(frozen=True, kw_only=True)
class Augmentation:
    """How much a training sample may differ from the view it is made of; `NONE` leaves it as it is."""

    mirror: bool = True
    """Left and right are swapped in half of the samples."""
    brightness: float = 0.3
    """Colour is scaled by 1 +- this, each channel by half of it more: other walls and lamps."""
    contrast: float = 0.3
    saturation: float = 0.6
    hue_rad: float = 0.6
    """Colours turn about grey by up to this: furniture comes in other colours in other houses."""
    noise_rgb: float = 4.0
    """Largest standard deviation of Gaussian noise, of 255."""
    depth_noise: float = 0.0012
    """Standard deviation of depth grows as this times its square, as with structured light (Nguyen et al. 2012)."""
    holes: int = 6
    """Up to so many rectangles of depth are lost."""


NONE = Augmentation(
    mirror=False,
    brightness=0.0,
    contrast=0.0,
    saturation=0.0,
    hue_rad=0.0,
    noise_rgb=0.0,
    depth_noise=0.0,
    holes=0,
)


@dataclass(frozen=True)
class Sampler:
    """Makes a training sample of a view: normalised colour (3, h, w), depth (1, h, w) and labels (h, w).

    A class and not a closure, so that a loader's workers can be given it.
    """

    camera: CameraModel
    block_px: int = 1
    """Views are shrunk by this first; 1 where they are stored small."""
    augmentation: Augmentation = NONE
    window_px: int | None = None
    """Samples are windows of so many columns, see `random_window`; None: whole views."""
    whole_share: float = 0.0
    """This share of the windows is the whole view, shrunk: what a network that works on shrunk images will see."""

    def __call__(self, view: LabelledView, rng: np.random.Generator) -> tuple[Tensor, Tensor, Tensor]:
        """Tensors float32, float32 and int64; labels are class channels, `IGNORED` where there is none."""
        rgb: NDArray[np.uint8] = shrink(view.rgb, self.block_px)
        depth_m: NDArray[np.float32] = shrink(view.depth_m, self.block_px)
        semantic: NDArray[np.uint8] = shrink(view.semantic, self.block_px)
        if self.window_px is not None:
            rgb, depth_m, semantic = random_window(rgb, depth_m, semantic, self.window_px, self.whole_share, rng)
        a = self.augmentation
        if a.mirror and rng.random() < 0.5:
            rgb, depth_m, semantic = _mirrored(rgb), _mirrored(depth_m), _mirrored(semantic)
        rgb, depth_m = jitter_colour(rgb, a, rng), jitter_depth(depth_m, a, rng)
        return (
            torch.from_numpy(normalise_rgb(rgb)),
            torch.from_numpy(normalise_depth(depth_m, self.camera)),
            torch.from_numpy(labels(semantic)),
        )


class Samples(Dataset):
    """Views in memory, as samples without chance."""

    def __init__(self, views: Sequence[LabelledView], sampler: Sampler) -> None:
        """The sampler must not augment."""
        self._views, self._sampler = views, sampler

    def __len__(self) -> int:
        return len(self._views)

    def __getitem__(self, i: int) -> tuple[Tensor, Tensor, Tensor]:
        return self._sampler(self._views[i], np.random.default_rng(0))


def _mirrored(image: NDArray[DtypeT]) -> NDArray[DtypeT]:
    return np.ascontiguousarray(image[:, ::-1])


def labels(semantic: NDArray[np.uint8]) -> NDArray[np.int64]:
    """(h, w) mpcat40 ids to class channels, padded like the images; void and padding are `IGNORED`."""
    channel = semantic.astype(np.int64) - 1
    channel[semantic == 0] = IGNORED
    pad = padding(*semantic.shape)
    return np.pad(channel, (pad[:2], pad[2:]), constant_values=IGNORED)


def random_window(
    rgb: NDArray[np.uint8],
    depth_m: NDArray[np.float32],
    semantic: NDArray[np.uint8],
    window_px: int,
    whole_share: float,
    rng: np.random.Generator,
) -> tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.uint8]]:
    """A window of the same shape as the view and `window_px` wide, anywhere in it, at a random scale.

    Between the whole view, shrunk, and a cut-out with the view's own pixels: fewer pixels to a step, things in several
    sizes. With a probability of `whole_share` it is the whole view.

    Raises:
        ConfigError: the view is narrower than the window.
    """
    height, width = semantic.shape
    if window_px > width:
        raise ConfigError(f"A view of {width} columns has no window of {window_px}.")
    smallest = 0.0 if rng.random() < whole_share else np.log(window_px / width)
    cols = round(width * float(np.exp(rng.uniform(smallest, 0.0))))
    rows, window_rows = round(height * cols / width), round(height * window_px / width)
    top, left = rng.integers(0, height - rows + 1), rng.integers(0, width - cols + 1)
    cut = (slice(top, top + rows), slice(left, left + cols))
    shape = (window_px, window_rows)
    return (
        cv2.resize(rgb[cut], shape, interpolation=cv2.INTER_AREA).astype(np.uint8, copy=False),
        cv2.resize(depth_m[cut], shape, interpolation=cv2.INTER_NEAREST).astype(np.float32, copy=False),
        cv2.resize(semantic[cut], shape, interpolation=cv2.INTER_NEAREST).astype(np.uint8, copy=False),
    )


def turn_hue(image: NDArray[np.float32], angle_rad: float) -> NDArray[np.float32]:
    """(h, w, 3) colours turned about the axis of greys."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    even, ahead, behind = (1 + 2 * c) / 3, (1 - c) / 3 - s / math.sqrt(3), (1 - c) / 3 + s / math.sqrt(3)
    turn = np.array([[even, ahead, behind], [behind, even, ahead], [ahead, behind, even]], np.float32)
    return image @ turn.T


def jitter_colour(rgb: NDArray[np.uint8], a: Augmentation, rng: np.random.Generator) -> NDArray[np.uint8]:
    """Another brightness, white balance, contrast, saturation, hue and some noise."""
    if max(a.brightness, a.contrast, a.saturation, a.hue_rad, a.noise_rgb) == 0.0:
        return rgb
    image = rgb.astype(np.float32)
    gain = (1.0 + rng.uniform(-a.brightness, a.brightness)) * (1.0 + 0.5 * rng.uniform(-1, 1, 3) * a.brightness)
    image *= gain.astype(np.float32)
    mean = image.mean()
    image = mean + (image - mean) * np.float32(1.0 + rng.uniform(-a.contrast, a.contrast))
    grey = image.mean(axis=2, keepdims=True)
    image = grey + (image - grey) * np.float32(1.0 + rng.uniform(-a.saturation, a.saturation))
    if a.hue_rad > 0.0:
        image = turn_hue(image, rng.uniform(-a.hue_rad, a.hue_rad))
    sigma = rng.uniform(0.0, a.noise_rgb)
    if sigma > 0.0:
        image += rng.standard_normal(image.shape, np.float32) * np.float32(sigma)
    return np.clip(image, 0.0, 255.0).astype(np.uint8)


def jitter_depth(depth_m: NDArray[np.float32], a: Augmentation, rng: np.random.Generator) -> NDArray[np.float32]:
    """Noise that grows with the square of the distance, and holes without return."""
    if a.depth_noise == 0.0 and a.holes == 0:
        return depth_m
    scale = np.float32(rng.uniform(0.0, 2.0) * a.depth_noise)
    noisy = depth_m + rng.standard_normal(depth_m.shape, np.float32) * (scale * depth_m * depth_m)
    height, width = depth_m.shape
    for _ in range(int(rng.integers(0, a.holes + 1))):
        h, w = rng.integers(2, height // 5), rng.integers(2, width // 5)
        top, left = rng.integers(0, height - h), rng.integers(0, width - w)
        noisy[top : top + h, left : left + w] = 0.0
    return noisy.astype(np.float32, copy=False)


def pyramid_loss(outputs: Sequence[Tensor], target: Tensor, weights: Tensor) -> Tensor:
    """Sum over scales of the weighted cross entropy, labels taken every 2nd, 4th, 8th and 16th pixel.

    Args:
        outputs: logits (n, classes, h / 2^k, w / 2^k).
        target: class channels (n, h, w).
        weights: of each class (classes,).
    """
    total = outputs[0].new_zeros(())
    for out in outputs:
        step = target.shape[-1] // out.shape[-1]
        middle = step // 2
        small = target[:, middle::step, middle::step].reshape(-1)
        logits = out.permute(0, 2, 3, 1).reshape(-1, out.shape[1])  # classes last: several times faster on a CPU
        loss = nn.functional.cross_entropy(logits.float(), small, weight=weights, ignore_index=IGNORED)
        total = total + torch.nan_to_num(loss)  # a scale whose labels are all void gives 0 / 0
    return total


def learning_rate(step: int, total: int, *, peak: float, warmup: int) -> float:
    """Linear warm-up, then half a cosine down to a hundredth of the peak."""
    if step < warmup:
        return peak * (step + 1) / warmup
    done = min(1.0, (step - warmup) / max(1, total - warmup))
    return peak * (0.01 + 0.99 * 0.5 * (1.0 + math.cos(math.pi * done)))


def confusion(predicted: NDArray[np.int64], truth: NDArray[np.int64]) -> NDArray[np.int64]:
    """(classes, classes) counts of pixels by true and predicted class; ignored ones left out."""
    counts = truth >= 0
    joint = truth[counts] * CLASSES + predicted[counts]
    return np.bincount(joint, minlength=CLASSES * CLASSES).reshape(CLASSES, CLASSES)


@dataclass(frozen=True)
class Iou:
    """Intersection over union of each class on one set of views."""

    by_category: dict[str, float]
    """Of each category whose pixels are in the views."""
    goals: float
    """Mean over the goal categories that are there (mIoU)."""
    everything: float
    """Mean over all categories that are there."""
    accuracy: float
    """Share of pixels that are right."""

    @classmethod
    def of(cls, matrix: NDArray[np.int64]) -> Iou:
        """From a confusion matrix."""
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


GOAL_CHANNELS = np.array([MPCAT40_ID[name] - 1 for name in GOAL_CATEGORIES])
RELIABILITY_BINS = 10


@dataclass
class Reliability:
    """How often a class scored p is right, in bins of p, over the goal categories' scores of every pixel."""

    count: NDArray[np.int64]
    score: NDArray[np.float64]
    right: NDArray[np.float64]

    @classmethod
    def empty(cls) -> Reliability:
        """Nothing counted yet."""
        n = RELIABILITY_BINS
        return cls(np.zeros(n, np.int64), np.zeros(n), np.zeros(n))

    def add(self, probability: NDArray[np.float32], truth: NDArray[np.int64]) -> None:
        """Count goal scores (classes, k) of pixels whose true channels are (k,); scores under 0.01 are left out."""
        p = probability[GOAL_CHANNELS]
        hit = GOAL_CHANNELS[:, None] == truth[None]
        kept = p >= 0.01
        p, hit = p[kept], hit[kept]
        bins = np.minimum((p * RELIABILITY_BINS).astype(np.int64), RELIABILITY_BINS - 1)
        self.count += np.bincount(bins, minlength=RELIABILITY_BINS)
        self.score += np.bincount(bins, weights=p, minlength=RELIABILITY_BINS)
        self.right += np.bincount(bins, weights=hit, minlength=RELIABILITY_BINS)

    def rows(self) -> list[tuple[int, float, float]]:
        """Count, mean score and share that was right, of each bin that has any."""
        return [
            (int(n), float(s / n), float(r / n))
            for n, s, r in zip(self.count, self.score, self.right, strict=True)
            if n > 0
        ]

    @property
    def error(self) -> float:
        """Expected calibration error: mean distance of score and share, weighted by counts (Naeini et al. 2015)."""
        total = max(1, int(self.count.sum()))
        return float(sum(n * abs(score - right) for n, score, right in self.rows()) / total)


def fit_temperature(logits: Tensor, truth: Tensor) -> float:
    """The temperature at which the softmax of the logits is likeliest (Guo et al. 2017).

    Args:
        logits: (k, classes) of pixels that count.
        truth: (k,) class channels.
    """
    log_t = torch.zeros((), requires_grad=True)
    optimiser = torch.optim.LBFGS([log_t], lr=0.1, max_iter=50)

    def closure() -> Tensor:
        optimiser.zero_grad()
        loss = nn.functional.cross_entropy(logits / log_t.exp(), truth)
        loss.backward()
        return loss

    optimiser.step(closure)
    return float(log_t.detach().exp())


def evaluate(
    model: RedNet,
    batches: Iterable[tuple[Tensor, Tensor, Tensor]],
    *,
    device: torch.device,
    temperature: float = 1.0,
    into: NDArray[np.int64] | None = None,
) -> tuple[Iou, Reliability]:
    """Intersection over union and reliability of a network over batches of samples.

    Args:
        model: the network.
        batches: of samples without augmentation.
        device: where it computes.
        temperature: of the softmax.
        into: a confusion matrix that these batches' counts are added to; see `confusion`.
    """
    matrix = np.zeros((CLASSES, CLASSES), np.int64)
    reliability = Reliability.empty()
    model.eval()
    with torch.inference_mode():
        for rgb, depth, target in batches:
            logits = model(rgb.to(device), depth.to(device)).float().cpu()
            truth = target.numpy()
            matrix += confusion(logits.argmax(dim=1).numpy(), truth)
            some = (logits[:, :, 2::8, 2::8] / temperature).softmax(dim=1)
            kept = truth[:, 2::8, 2::8]
            flat = some.permute(1, 0, 2, 3).reshape(CLASSES, -1).numpy()
            counts = kept.reshape(-1) >= 0
            reliability.add(flat[:, counts], kept.reshape(-1)[counts])
    if into is not None:
        into += matrix
    return Iou.of(matrix), reliability
