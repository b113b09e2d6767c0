"""Training batches made on a GPU: views are decoded once into its memory, and windows and augmentation computed there.

A core makes about 110 samples a second (`sim.training.segmentation.samples`); an H100 trained on 1,800. The samples are
those of `Sampler`: the same windows, augmentation and weights, with other random numbers. Colour in a window is
interpolated linearly between pixels; `Sampler` averages areas.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float32, Int16, Int64, UInt8
from torch import Tensor
from torch.nn import functional
from torch.utils.data import DataLoader, Dataset

from sim.core.interface import CameraModel, ConfigError
from sim.training.segmentation.balanced import StoredView, ViewIndex
from sim.training.segmentation.recipe import Recipe
from sim.training.segmentation.samples import IGNORED, MAX_WEIGHT, Augmentation, Sampler, pixel_weights
from stubborn.segmentation import geometry
from stubborn.segmentation.preprocess import DEPTH_MEAN, DEPTH_STD, RGB_MEAN, RGB_STD, padding

WEIGHT_UNIT = MAX_WEIGHT / 255
"""Weights of pixels are stored in this unit, as one byte."""
VIEWS_PER_READ = 32
"""Views that a loading process passes on at a time."""
BYTES_PER_PIXEL = 3 + 2 + 1 + 2 + 1
"""Memory of a pixel of a view: colour, depth, category, instance and weight."""
TRAINING_BYTES = 4 << 30
"""Memory of a GPU that is left for the training."""


def room_for(views: Sequence[StoredView], device: torch.device) -> int:
    """Returns how many views of this size fit in the free memory of a GPU in addition to a training."""
    pixels = views[0].read().semantic.size
    return max(0, torch.cuda.mem_get_info(device)[0] - TRAINING_BYTES) // (pixels * BYTES_PER_PIXEL)


class DeviceViews(NamedTuple):
    """Decoded views on a device."""

    rgb: UInt8[Tensor, "n h w 3"]
    depth_mm: Int16[Tensor, "n h w"]
    semantic: UInt8[Tensor, "n h w"]
    instances: Int16[Tensor, "n h w"]
    weights: UInt8[Tensor, "n h w"]
    """Weights in units of `WEIGHT_UNIT`."""

    @classmethod
    def read(cls, views: Sequence[StoredView], device: torch.device, *, workers: int = 0) -> DeviceViews:
        """Returns decoded views on a device; `workers` processes decode them.

        Raises:
            ConfigError: a view is broken or has no instances.
        """
        height, width = views[0].read().semantic.shape
        shapes = ((3,), (), (), (), ())
        kinds = (torch.uint8, torch.int16, torch.uint8, torch.int16, torch.uint8)
        held = cls(
            *(
                torch.empty((len(views), height, width, *shape), dtype=kind, device=device)
                for shape, kind in zip(shapes, kinds, strict=True)
            )
        )
        done = 0
        for parts in DataLoader(_Decoded(views), batch_size=None, num_workers=workers):
            count = len(parts[0])
            for to, part in zip(held, parts, strict=True):
                to[done : done + count] = part.to(device)
            done += count
        return held


class DeviceBatches(Dataset):
    """The batches of a training, computed on a device; see `sim.training.segmentation.balanced.Batches`.

    Args:
        index: the views; all are of one size.
        sampler: augmentation, kind of the second input and resolution; its `block_px` is 1 and its pixels have weights.
        recipe: phases and sampling.
        batch: samples of a step, multiplied by those of the phase.
        seed: seeds all batches.
        device: holds the views and computes the samples.
        workers: number of processes that decode the views.

    Raises:
        ConfigError: no view shows an object of a goal category.
    """

    def __init__(
        self, index: ViewIndex, sampler: Sampler, recipe: Recipe, *, batch: int, seed: int, device: torch.device,
        workers: int = 0,
    ) -> None:  # fmt: skip
        if not index.objects:
            raise ConfigError("No view shows an object of a goal category.")
        self.index, self.sampler, self.recipe, self.batch, self.seed = index, sampler, recipe, batch, seed
        self._device = device
        self._views = DeviceViews.read(index.views, device, workers=workers)

    def __getitem__(self, key: tuple[int, float]) -> tuple[Tensor, ...]:
        """Returns the samples of one step: see `sim.training.segmentation.samples.WeightedSample`."""
        step, progress = key
        rng, phase = np.random.default_rng([self.seed, step]), self.recipe.phase(progress)
        height_px, stored_px = self._views.semantic.shape[1:]
        used_px = stored_px // (self.sampler.used_block_px or 1)
        width_px = self.recipe.width_px(phase, used_px, stored_px, rng)
        share, count = self.recipe.object_share, phase.batches * self.batch
        drawn = [self.index.draw(rng, object_share=share) for _ in range(count)]
        views = torch.tensor([sample.view for sample in drawn], device=self._device)
        shown = torch.tensor([sample.number for sample in drawn], device=self._device)
        random = torch.Generator(self._device).manual_seed(int(rng.integers(2**62)))
        windows = random_windows(
            self._views.instances[views], shown, width_px, phase.whole_share, rng, random=random
        )  # fmt: skip
        rows_px = round(height_px * width_px / stored_px)
        return self.samples(views, windows, (rows_px, width_px), random)

    def samples(
        self, views: Int64[Tensor, " n"], windows: Windows, size_px: tuple[int, int], random: torch.Generator
    ) -> tuple[Tensor, ...]:
        """Returns the samples of some windows, resized to a height and width."""
        augmentation, camera = self.sampler.augmentation, self.sampler.camera
        held = self._views
        depth_m = jitter_depth(held.depth_mm[views].float() / 1000.0, augmentation, random)
        channels = _second_channels(depth_m, self.sampler.second, camera)
        row, col = windows.pixels(size_px)
        rows = torch.arange(len(views), device=self._device)[:, None, None]
        cut = channels.permute(0, 2, 3, 1)[rows, row, col].permute(0, 3, 1, 2)
        enlargement = size_px[1] * (self.sampler.used_block_px or 1) / windows.cols
        second = _normalised(cut, enlargement[:, None, None], self.sampler.second, camera)
        target = held.semantic[views[:, None, None], row, col].long() - 1
        target[target < 0] = IGNORED
        weights = held.weights[views[:, None, None], row, col].float() * WEIGHT_UNIT
        rgb = windows.colour(held.rgb[views].permute(0, 3, 1, 2).float(), size_px)
        if augmentation.mirror:
            flipped = torch.rand(len(views), device=self._device, generator=random) < 0.5
            rgb, target, weights = (_mirrored(part, flipped) for part in (rgb, target, weights))
            second = _mirrored(second, flipped)
            if self.sampler.second != "depth":
                second[flipped, second.shape[1] - len(geometry.CHANNELS) + geometry.RIGHT] *= -1.0
        rgb = jitter_colour(rgb.round(), augmentation, random)
        mean, std = (torch.from_numpy(part).to(self._device)[:, None, None] for part in (RGB_MEAN, RGB_STD))
        pad = padding(*size_px)
        around = (pad.left, pad.right, pad.top, pad.bottom)
        return (
            functional.pad((rgb / 255.0 - mean) / std, around, mode="replicate"),
            functional.pad(second, around, mode="replicate"),
            functional.pad(target, around, value=IGNORED),
            functional.pad(weights[:, None], around, mode="replicate")[:, 0],
        )


@dataclass(frozen=True)
class Windows:
    """Rectangles of views with the proportions of the view; see `sim.training.segmentation.samples.random_window`."""

    top: Int64[Tensor, " n"]
    left: Int64[Tensor, " n"]
    rows: Int64[Tensor, " n"]
    cols: Int64[Tensor, " n"]
    view_px: tuple[int, int]
    """Height and width of the views."""

    def pixels(self, size_px: tuple[int, int]) -> tuple[Int64[Tensor, "n h 1"], Int64[Tensor, "n 1 w"]]:
        """Returns the rows and the columns of the view that the pixels of a resized window take."""
        y, x = (torch.arange(length, device=self.top.device) for length in size_px)
        row = self.top[:, None] + y * self.rows[:, None] // size_px[0]
        col = self.left[:, None] + x * self.cols[:, None] // size_px[1]
        return row[:, :, None], col[:, None, :]

    def colour(self, rgb: Float32[Tensor, "n 3 h w"], size_px: tuple[int, int]) -> Float32[Tensor, "n 3 rows cols"]:
        """Returns resized windows of images."""
        axes = []
        for start, length, size, whole in zip(
            (self.top, self.left), (self.rows, self.cols), size_px, self.view_px, strict=True
        ):
            middle = (torch.arange(size, device=rgb.device) + 0.5) * length[:, None] / size + start[:, None]
            axes.append(2.0 * middle / whole - 1.0)
        y, x = torch.broadcast_tensors(axes[0][:, :, None], axes[1][:, None, :])
        grid = torch.stack([x, y], dim=3).float()
        return functional.grid_sample(rgb, grid, mode="bilinear", padding_mode="border", align_corners=False)


def random_windows(
    instances: Int16[Tensor, "n h w"], shown: Int64[Tensor, " n"], width_px: int, whole_share: float,
    rng: np.random.Generator, *, random: torch.Generator,
) -> Windows:  # fmt: skip
    """Returns windows at random positions and scales that contain a pixel of the instance `shown`; 0: of any place."""
    count, (height, width) = len(instances), instances.shape[1:]
    smallest = np.where(rng.random(count) < whole_share, 0.0, math.log(width_px / width))
    cols = np.rint(width * np.exp(rng.uniform(size=count) * smallest)).astype(int)
    rows = np.rint(height * cols / width).astype(int)
    device = instances.device
    # A random pixel of the instance: the largest of random numbers, which are negative elsewhere.
    noise = torch.rand(instances.shape, device=device, generator=random)
    noise[instances != shown[:, None, None]] = -1.0
    best, pixel = noise.flatten(1).max(dim=1)
    known = (best >= 0.0) & (shown > 0)
    place = torch.rand((2, count), device=device, generator=random)
    starts = []
    for axis, (size, lengths) in enumerate(((height, rows), (width, cols))):
        length = torch.from_numpy(lengths).to(device)
        at = pixel // width if axis == 0 else pixel % width
        first, last = torch.zeros_like(length), size - length
        first = torch.where(known, torch.maximum(first, at - length + 1), first)
        last = torch.where(known, torch.minimum(last, at), last)
        starts.append((first + (place[axis] * (last - first + 1)).long()).minimum(last))
    top, left = starts
    return Windows(top, left, torch.from_numpy(rows).to(device), torch.from_numpy(cols).to(device), (height, width))


def jitter_depth(
    depth_m: Float32[Tensor, "n h w"], augmentation: Augmentation, random: torch.Generator
) -> Float32[Tensor, "n h w"]:
    """Returns depth with the noise and the holes of `sim.training.segmentation.samples.jitter_depth`."""
    (count, height, width), device = depth_m.shape, depth_m.device
    if augmentation.depth_noise > 0.0:
        scale = torch.rand((count, 1, 1), device=device, generator=random) * (2.0 * augmentation.depth_noise)
        noise = torch.empty_like(depth_m).normal_(generator=random)
        depth_m = depth_m + noise * scale * depth_m * depth_m
    if augmentation.holes == 0:
        return depth_m
    draws = torch.rand((5, count, augmentation.holes), device=device, generator=random)
    rows, cols = (2 + (draws[i] * (size // 5 - 2)).long() for i, size in enumerate((height, width)))
    top, left = (draws[2] * (height - rows)).long(), (draws[3] * (width - cols)).long()
    number = (draws[4, :, :1] * (augmentation.holes + 1)).long()
    used = torch.arange(augmentation.holes, device=device) < number
    y, x = (torch.arange(size, device=device)[None, None] for size in (height, width))
    in_rows = (y >= top[..., None]) & (y < (top + rows)[..., None]) & used[..., None]
    in_cols = (x >= left[..., None]) & (x < (left + cols)[..., None])
    holes = torch.bmm(in_rows.float().transpose(1, 2), in_cols.float()) > 0.0
    return depth_m.masked_fill(holes, 0.0)


def jitter_colour(
    image: Float32[Tensor, "n 3 h w"], augmentation: Augmentation, random: torch.Generator
) -> Float32[Tensor, "n 3 h w"]:
    """Returns images from 0 to 255 with the changes of `sim.training.segmentation.samples.jitter_colour`."""
    a, count, device = augmentation, len(image), image.device
    if max(a.brightness, a.contrast, a.saturation, a.hue_rad, a.noise_rgb, a.grey) == 0.0:
        return image

    def uniform(channels: int = 1) -> Float32[Tensor, "n channels 1 1"]:
        return torch.rand((count, channels, 1, 1), device=device, generator=random) * 2.0 - 1.0

    image = image * (1.0 + a.brightness * uniform()) * (1.0 + 0.5 * a.brightness * uniform(3))
    mean = image.mean(dim=(1, 2, 3), keepdim=True)
    image = mean + (image - mean) * (1.0 + a.contrast * uniform())
    grey = image.mean(dim=1, keepdim=True)
    image = grey + (image - grey) * (1.0 + a.saturation * uniform())
    without = torch.rand((count, 1, 1, 1), device=device, generator=random) < a.grey
    image = torch.where(without, grey.expand_as(image), _turn_hue(image, a.hue_rad * uniform()[:, 0, 0, 0]))
    sigma = 0.5 * a.noise_rgb * (1.0 + uniform())
    image = image + torch.empty_like(image).normal_(generator=random) * sigma
    return image.clamp(0.0, 255.0).floor()


def geometry_channels(depth_m: Float32[Tensor, "n h w"], camera: CameraModel) -> Float32[Tensor, "n 6 h w"]:
    """Returns the channels of `stubborn.segmentation.geometry.geometry_image` for whole depth images."""
    height, width = depth_m.shape[1:]
    focal_px, device = 0.5 * width / math.tan(0.5 * camera.hfov_rad), depth_m.device
    step = max(1, round(math.tan(math.radians(geometry.BASELINE_DEG)) * focal_px))
    right = (torch.arange(width, device=device) + 0.5 - 0.5 * width) / focal_px
    up = ((0.5 * height - torch.arange(height, device=device) - 0.5) / focal_px)[:, None]
    valid = (depth_m > 0.0) & (depth_m < camera.max_depth_m)
    points = torch.stack([right * depth_m, up * depth_m, depth_m], dim=1)
    along_row, found_row = _towards_neighbour(points, valid, step, dim=3)
    along_col, found_col = _towards_neighbour(points, valid, step, dim=2)
    normal = torch.linalg.cross(along_row, along_col, dim=1)
    normal = normal / normal.norm(dim=1, keepdim=True).clamp(min=1e-20)
    away = (normal * torch.stack(torch.broadcast_tensors(right, up, torch.ones_like(up * right)))).sum(1) > 0.0
    normal = torch.where(away[:, None], -normal, normal)
    normal = normal * (valid & found_row & found_col)[:, None]
    inverse = torch.where(depth_m > 0.0, 1.0 / depth_m.clamp(min=1e-6), 0.0)
    heights = camera.height_m + points[:, 1]
    return torch.cat([torch.stack([inverse, valid.float(), heights], dim=1), normal], dim=1)


def _towards_neighbour(
    points: Float32[Tensor, "n 3 h w"], valid: Bool[Tensor, "n h w"], step: int, *, dim: int
) -> tuple[Float32[Tensor, "n 3 h w"], Bool[Tensor, "n h w"]]:
    """Returns the vector to the neighbour, of two opposite ones, that is nearer in depth, and where one is valid."""
    differences, gaps = [], []
    size = points.shape[dim]
    index = torch.arange(size, device=points.device)
    for sign in (1, -1):
        neighbour = index + sign * step
        inside = ((neighbour >= 0) & (neighbour < size)).view([-1 if d == dim - 1 else 1 for d in range(3)])
        neighbour = neighbour.clamp(0, size - 1)
        difference = points.index_select(dim, neighbour) - points
        usable = valid.index_select(dim - 1, neighbour) & inside
        differences.append(difference)
        gaps.append(torch.where(usable, difference[:, 2].abs(), torch.inf))
    second = gaps[1] < gaps[0]
    return torch.where(second[:, None], differences[1], differences[0]), torch.minimum(*gaps) < torch.inf


def _second_channels(
    depth_m: Float32[Tensor, "n h w"], kind: str, camera: CameraModel
) -> Float32[Tensor, "n c h w"]:  # fmt: skip
    """Returns the channels of the second input of a kind, not yet normalised."""
    if kind == "depth":
        return depth_m[:, None]
    channels = geometry_channels(depth_m, camera)
    return channels if kind == "geometry" else torch.cat([depth_m[:, None], channels], dim=1)


def _normalised(
    cut: Float32[Tensor, "n c h w"], enlargement: Float32[Tensor, "n 1 1"], kind: str, camera: CameraModel
) -> Float32[Tensor, "n c h w"]:
    """Returns the second input of windows, with distances that keep the metric size of objects."""
    parts = []
    if kind != "geometry":
        scaled = (cut[:, 0] / enlargement - camera.min_depth_m) / (camera.max_depth_m - camera.min_depth_m)
        parts.append((scaled.clamp(0.0, 1.0)[:, None] - DEPTH_MEAN) / DEPTH_STD)
    if kind != "depth":
        channels = cut[:, -len(geometry.CHANNELS) :].clone()
        channels[:, geometry.INVERSE_DEPTH] *= enlargement
        mean, std = (torch.tensor(part, device=cut.device)[:, None, None] for part in geometry.STATISTICS)
        parts.append((channels - mean) / std)
    return torch.cat(parts, dim=1)


def _mirrored(part: Tensor, flipped: Bool[Tensor, " n"]) -> Tensor:
    """Returns the images; those with True in `flipped` are mirrored left to right."""
    return torch.where(flipped.view(-1, *[1] * (part.ndim - 1)), part.flip(-1), part)


def _turn_hue(image: Float32[Tensor, "n 3 h w"], angle_rad: Float32[Tensor, " n"]) -> Float32[Tensor, "n 3 h w"]:
    """Returns colours rotated about the axis of greys."""
    c, s = torch.cos(angle_rad), torch.sin(angle_rad) / math.sqrt(3)
    even, ahead, behind = (1 + 2 * c) / 3, (1 - c) / 3 - s, (1 - c) / 3 + s
    rows = [torch.stack(row, dim=1) for row in ((even, ahead, behind), (behind, even, ahead), (ahead, behind, even))]
    return torch.einsum("nij,njhw->nihw", torch.stack(rows, dim=1), image)


class _Decoded(Dataset):
    """The arrays of `VIEWS_PER_READ` views at a time, as `DeviceViews` holds them."""

    def __init__(self, views: Sequence[StoredView]) -> None:
        self._views = views

    def __len__(self) -> int:
        return -(-len(self._views) // VIEWS_PER_READ)

    def __getitem__(self, i: int) -> tuple[Tensor, ...]:
        read = [stored.read() for stored in self._views[i * VIEWS_PER_READ : (i + 1) * VIEWS_PER_READ]]
        weights = [np.rint(pixel_weights(view, 1) / WEIGHT_UNIT).astype(np.uint8) for view in read]
        read = [replace(view, depth_m=np.rint(view.depth_m * 1000.0)) for view in read]
        return (
            torch.from_numpy(np.stack([view.rgb for view in read])),
            torch.from_numpy(np.stack([view.depth_m for view in read]).astype(np.int16)),
            torch.from_numpy(np.stack([view.semantic for view in read])),
            torch.from_numpy(
                np.stack([view.instances for view in read if view.instances is not None]).astype(np.int16)
            ),
            torch.from_numpy(np.stack(weights)),
        )
