"""Makes training samples of a network from labelled views: labels, random windows and augmentation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import torch
from jaxtyping import Bool, Float32, Int64, Shaped, UInt8, UInt16
from torch import Tensor
from torch.utils.data import Dataset

from sim.core.interface import MPCAT40_ID, CameraModel, ConfigError
from sim.training.segmentation.dataset import LabelledView
from stubborn.segmentation.inputs import INPUTS, InputKind
from stubborn.segmentation.preprocess import normalise_rgb, pad_edges, padding, shrink

IGNORED = -100
"""Label of pixels that do not count: void and padding."""

SMALL_SHARE, MAX_WEIGHT = 1 / 16, 4.0
"""Objects with a smaller share of the image weigh more per pixel: area^-0.5, at most this much."""
SURFACES = np.array([MPCAT40_ID[name] for name in ("void", "wall", "floor", "ceiling")])
"""Pixels of these categories weigh 1."""

Sample = tuple[Float32[Tensor, "3 h w"], Float32[Tensor, "c h w"], Int64[Tensor, "h w"]]
"""Normalised colour, the normalised second input, and class channels or `IGNORED`."""
WeightedSample = tuple[Float32[Tensor, "3 h w"], Float32[Tensor, "c h w"], Int64[Tensor, "h w"], Float32[Tensor, "h w"]]
"""A sample with the weights of its pixels."""


@dataclass(frozen=True, kw_only=True)
class Augmentation:
    """The largest random differences of a training sample from its view; `NONE` changes nothing."""

    mirror: bool = True
    """Half of the samples are mirrored left to right."""
    brightness: float = 0.3
    """Colour is scaled by 1 +- this, and each channel also by 1 +- half of it, to imitate other walls and lamps."""
    contrast: float = 0.3
    saturation: float = 0.6
    hue_rad: float = 0.6
    """Largest rotation of the hue: furniture has other colours in other houses."""
    grey: float = 0.1
    """Share of the samples without colour, so that the network learns shapes."""
    noise_rgb: float = 4.0
    """Largest standard deviation of Gaussian noise, for colours from 0 to 255."""
    depth_noise: float = 0.0012
    """The standard deviation of depth is this times depth squared, as with structured light (Nguyen et al. 2012)."""
    holes: int = 6
    """Largest number of rectangles without depth."""


NONE = Augmentation(
    mirror=False,
    brightness=0.0,
    contrast=0.0,
    saturation=0.0,
    hue_rad=0.0,
    grey=0.0,
    noise_rgb=0.0,
    depth_noise=0.0,
    holes=0,
)


@dataclass(frozen=True)
class Sampler:
    """A function that returns a training sample of a view; as a class it can be pickled for a loader's workers."""

    camera: CameraModel
    block_px: int = 1
    """Views are first shrunk by this factor; 1 where they are stored small."""
    augmentation: Augmentation = NONE
    window_px: int | None = None
    """Samples are windows of this width, see `random_window`; None: whole views."""
    whole_share: float = 0.0
    """Share of the windows that show the whole view, shrunk, for a network that works on shrunk images."""
    second: InputKind = "depth"
    """Kind of the network's second input. It is computed from the whole view, before the window is cut out."""
    used_block_px: int | None = None
    """Factor by which views are shrunk when the network is used. The distances in a window are changed to those at
    which objects have the same size in such images. None: `block_px`."""
    area_weights: bool = False
    """True: samples include weights of their pixels, which are larger for small objects (`pixel_weights`)."""

    def __call__(
        self, view: LabelledView, rng: np.random.Generator, *, instance: int | None = None
    ) -> Sample | WeightedSample:
        """Returns a sample of a view; a window contains a pixel of the instance with this number, if it is given."""
        augmentation, second = self.augmentation, INPUTS[self.second]
        weights = pixel_weights(view, self.block_px) if self.area_weights else None
        rgb, semantic = shrink(view.rgb, self.block_px), shrink(view.semantic, self.block_px)
        channels = second.of(jitter_depth(shrink(view.depth_m, self.block_px), augmentation, rng), self.camera)
        if self.window_px is not None:
            height, width = semantic.shape
            shown = None
            if instance is not None:
                shown = random_pixel(shrink(_instances(view), self.block_px) == instance, rng)
            window = random_window(height, width, self.window_px, self.whole_share, rng, shown=shown)
            rgb, semantic = window.colour(rgb), window.nearest(semantic)
            cut = channels[window.cut]
            zoom = window.width_px / cut.shape[1]
            enlargement = zoom * (self.used_block_px or self.block_px) / self.block_px
            weights = None if weights is None else window.nearest(weights)
            channels = second.zoomed(cut, window.width_px, window.height_px, enlargement)
        if augmentation.mirror and rng.random() < 0.5:
            rgb, channels, semantic = _mirrored(rgb), second.mirrored(channels), _mirrored(semantic)
            weights = None if weights is None else _mirrored(weights)
        sample = (
            torch.from_numpy(normalise_rgb(jitter_colour(rgb, augmentation, rng))),
            torch.from_numpy(second.normalised(channels, self.camera)),
            torch.from_numpy(labels(semantic)),
        )
        return sample if weights is None else (*sample, torch.from_numpy(pad_edges(weights[None])[0]))


class Samples(Dataset):
    """A data set of the samples of views in memory; the random numbers of a sample depend only on its index."""

    def __init__(self, views: Sequence[LabelledView], sampler: Sampler) -> None:
        self._views, self._sampler = views, sampler

    def __len__(self) -> int:
        return len(self._views)

    def __getitem__(self, i: int) -> Sample | WeightedSample:
        return self._sampler(self._views[i], np.random.default_rng(i))


def pixel_weights(view: LabelledView, block_px: int) -> Float32[np.ndarray, "h w"]:
    """Returns the weight of each pixel of a shrunk view: area^-0.5 of its object in the view, from 1 to `MAX_WEIGHT`.

    The weight depends on the whole object in the view and not on the part of it in a window. Pixels of surfaces weigh
    1.

    Raises:
        ConfigError: the view has no instances.
    """
    instances = shrink(_instances(view), block_px)
    area = np.bincount(instances.reshape(-1)) / instances.size
    weights = np.clip(np.sqrt(SMALL_SHARE / np.maximum(area, 1e-9)), 1.0, MAX_WEIGHT).astype(np.float32)
    weights[0] = 1.0
    return np.where(np.isin(shrink(view.semantic, block_px), SURFACES), np.float32(1.0), weights[instances])


def _instances(view: LabelledView) -> UInt16[np.ndarray, "h w"]:
    if view.instances is None:
        raise ConfigError(f"View '{view.key}' has no instances; `stubborn views --extras instances` stores them.")
    return view.instances


def _mirrored(image: Shaped[np.ndarray, "h w *channels"]) -> Shaped[np.ndarray, "h w *channels"]:
    return np.ascontiguousarray(image[:, ::-1])


def labels(semantic: UInt8[np.ndarray, "h w"]) -> Int64[np.ndarray, "padded_h padded_w"]:
    """Returns the class channels of mpcat40 ids, padded like the images; void and padding are `IGNORED`."""
    channel = semantic.astype(np.int64) - 1
    channel[semantic == 0] = IGNORED
    pad = padding(*semantic.shape)
    return np.pad(channel, (pad[:2], pad[2:]), constant_values=IGNORED)


@dataclass(frozen=True)
class Window:
    """A rectangle of a view, and the resolution at which it is used."""

    cut: tuple[slice, slice]
    """Rows and columns of the view."""
    width_px: int
    height_px: int

    def colour(self, rgb: UInt8[np.ndarray, "h w 3"]) -> UInt8[np.ndarray, "rows cols 3"]:
        """Returns the window of a colour image; pixels are averaged."""
        return cv2.resize(rgb[self.cut], (self.width_px, self.height_px), interpolation=cv2.INTER_AREA).astype(
            np.uint8, copy=False
        )

    def nearest(self, image: Shaped[np.ndarray, "h w"]) -> Shaped[np.ndarray, "rows cols"]:
        """Returns the window of an image of labels or weights; each pixel takes one pixel of the view."""
        return np.asarray(cv2.resize(image[self.cut], (self.width_px, self.height_px), interpolation=cv2.INTER_NEAREST))


def random_pixel(mask: Bool[np.ndarray, "h w"], rng: np.random.Generator) -> tuple[int, int] | None:
    """Returns row and column of a pixel of a mask, each equally often; None if it is empty."""
    pixels = np.flatnonzero(mask)
    if pixels.size == 0:
        return None
    row, col = divmod(int(rng.choice(pixels)), mask.shape[1])
    return row, col


def random_window(
    height_px: int,
    width_px: int,
    window_px: int,
    whole_share: float,
    rng: np.random.Generator,
    *,
    shown: tuple[int, int] | None = None,
) -> Window:
    """Returns a window at a random position and scale, for fewer pixels per step and objects in several sizes.

    A window has the proportions of the view and is `window_px` wide. Its scale is between that of the whole view,
    shrunk, and that of the view's own pixels. With a probability of `whole_share` it is the whole view. If a pixel is
    given as `shown`, row and column, the window contains it.

    Raises:
        ConfigError: the view is narrower than the window.
    """
    if window_px > width_px:
        raise ConfigError(f"A view of {width_px} columns has no window of {window_px}.")
    smallest = 0.0 if rng.random() < whole_share else np.log(window_px / width_px)
    cols = round(width_px * float(np.exp(rng.uniform(smallest, 0.0))))
    rows, window_rows = round(height_px * cols / width_px), round(height_px * window_px / width_px)
    row, col = (None, None) if shown is None else shown
    top, left = _random_start(height_px, rows, row, rng), _random_start(width_px, cols, col, rng)
    return Window((slice(top, top + rows), slice(left, left + cols)), window_px, window_rows)


def _random_start(size_px: int, length_px: int, shown: int | None, rng: np.random.Generator) -> int:
    """Returns a random start of `length_px` of `size_px` pixels that contain pixel `shown`, if it is given."""
    first, last = 0, size_px - length_px
    if shown is not None:
        first, last = max(first, shown - length_px + 1), min(last, shown)
    return int(rng.integers(first, last + 1))


def turn_hue(image: Float32[np.ndarray, "h w 3"], angle_rad: float) -> Float32[np.ndarray, "h w 3"]:
    """Returns colours rotated about the axis of greys."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    even, ahead, behind = (1 + 2 * c) / 3, (1 - c) / 3 - s / math.sqrt(3), (1 - c) / 3 + s / math.sqrt(3)
    turn = np.array([[even, ahead, behind], [behind, even, ahead], [ahead, behind, even]], np.float32)
    return image @ turn.T


def jitter_colour(
    rgb: UInt8[np.ndarray, "h w 3"], augmentation: Augmentation, rng: np.random.Generator
) -> UInt8[np.ndarray, "h w 3"]:
    """Returns an image with random brightness, white balance, contrast, saturation, hue and noise."""
    a = augmentation
    if max(a.brightness, a.contrast, a.saturation, a.hue_rad, a.noise_rgb, a.grey) == 0.0:
        return rgb
    image = rgb.astype(np.float32)
    gain = (1.0 + rng.uniform(-a.brightness, a.brightness)) * (1.0 + 0.5 * rng.uniform(-1, 1, 3) * a.brightness)
    image *= gain.astype(np.float32)
    mean = image.mean()
    image = mean + (image - mean) * np.float32(1.0 + rng.uniform(-a.contrast, a.contrast))
    grey = image.mean(axis=2, keepdims=True)
    image = grey + (image - grey) * np.float32(1.0 + rng.uniform(-a.saturation, a.saturation))
    if a.grey > 0.0 and rng.random() < a.grey:
        image = np.broadcast_to(grey, image.shape).copy()
    elif a.hue_rad > 0.0:
        image = turn_hue(image, rng.uniform(-a.hue_rad, a.hue_rad))
    sigma = rng.uniform(0.0, a.noise_rgb)
    if sigma > 0.0:
        image += rng.standard_normal(image.shape, np.float32) * np.float32(sigma)
    return np.clip(image, 0.0, 255.0).astype(np.uint8)


def jitter_depth(
    depth_m: Float32[np.ndarray, "h w"], augmentation: Augmentation, rng: np.random.Generator
) -> Float32[np.ndarray, "h w"]:
    """Returns depth with noise that grows with the square of the distance, and with rectangles that have no return."""
    if augmentation.depth_noise == 0.0 and augmentation.holes == 0:
        return depth_m
    scale = np.float32(rng.uniform(0.0, 2.0) * augmentation.depth_noise)
    noisy = depth_m + rng.standard_normal(depth_m.shape, np.float32) * (scale * depth_m * depth_m)
    height, width = depth_m.shape
    for _ in range(int(rng.integers(0, augmentation.holes + 1))):
        h, w = rng.integers(2, height // 5), rng.integers(2, width // 5)
        top, left = rng.integers(0, height - h), rng.integers(0, width - w)
        noisy[top : top + h, left : left + w] = 0.0
    return noisy.astype(np.float32, copy=False)
