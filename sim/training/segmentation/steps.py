"""The loss with which `stubborn train segmentation` trains a network, and averages of weights."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Float32, Float64, Int64
from torch import Tensor, nn
from torch.optim.swa_utils import get_ema_multi_avg_fn

from sim.training.segmentation.samples import IGNORED
from stubborn.segmentation.checkpoints import load_network, mean_of, save_network
from stubborn.segmentation.rednet import RedNet

PREFIX = "step-"
MAX_RATIO = 10.0
"""Largest ratio of the weights of two classes."""


def pyramid_loss(
    outputs: Sequence[Float[Tensor, "n classes _ _"]],
    target: Int64[Tensor, "n h w"],
    weights: Float32[Tensor, " classes"],
    *,
    subpixel: tuple[int, int] | None = None,
    pixels: Float32[Tensor, "n h w"] | None = None,
) -> Float[Tensor, ""]:
    """Returns the sum of the weighted cross entropies of all scales; coarser ones use every 2nd, 4th, ... label.

    Args:
        outputs: logits at full size, and at 1/2, 1/4, ... of it.
        target: class channels, or `IGNORED`.
        weights: weights of the classes.
        subpixel: pixel of every 2 x 2 block that the first logits are for (see `RedNet.pyramid`).
        pixels: weights of the pixels; None: all are 1.
    """
    total = outputs[0].new_zeros(())
    for number, out in enumerate(outputs):
        step = target.shape[-1] // out.shape[-1]
        row, column = subpixel if subpixel is not None and number == 0 else (step // 2, step // 2)
        small = target[:, row::step, column::step].reshape(-1)
        logits = out.permute(0, 2, 3, 1).reshape(-1, out.shape[1]).float()  # classes last: this is faster
        if pixels is None:
            loss = nn.functional.cross_entropy(logits, small, weight=weights, ignore_index=IGNORED)
        else:
            own = pixels[:, row::step, column::step].reshape(-1)
            by_pixel = nn.functional.cross_entropy(
                logits, small, weight=weights, ignore_index=IGNORED, reduction="none"
            )
            counted = torch.where(small == IGNORED, 0.0, weights[small.clamp(min=0)])
            loss = (by_pixel * own).sum() / (counted * own).sum()
        total = total + torch.nan_to_num(loss)  # a scale with void labels only gives 0 / 0
    return total


def root_class_weights(pixels: Float64[np.ndarray, " 41"]) -> Float32[torch.Tensor, " classes"]:
    """Returns class weights that are larger for rare categories: share^-0.5, at most `MAX_RATIO` times the smallest.

    Args:
        pixels: pixels of each mpcat40 category, with void.
    """
    counts = np.asarray(pixels, np.float64)[1:]
    weights = np.where(counts > 0, 1.0 / np.sqrt(np.maximum(counts, 1.0)), 0.0)
    if (counts > 0).any():
        weights = np.minimum(weights, MAX_RATIO * weights[counts > 0].min())
        weights = weights / weights[counts > 0].mean()
    return torch.tensor(weights, dtype=torch.float32)


def exponential_average(decay: float) -> Callable[[Sequence[Tensor], Sequence[Tensor], Tensor | int], None]:
    """Returns a function with which `torch.optim.swa_utils.AveragedModel` updates its average of the weights.

    After n updates the decay is at most (1 + n) / (10 + n), so that the average forgets the initial weights soon.
    Integers, such as the counts of batches, are copied.
    """

    def update(averaged: Sequence[Tensor], current: Sequence[Tensor], count: Tensor | int) -> None:
        n = int(count)
        ema = get_ema_multi_avg_fn(min(decay, (1 + n) / (10 + n)))
        pairs = [(old, new.to(old.dtype)) for old, new in zip(averaged, current, strict=True)]
        floats = [pair for pair in pairs if torch.is_floating_point(pair[0])]
        if floats:
            ema([old for old, _ in floats], [new for _, new in floats], n)
        for old, new in pairs:
            if not torch.is_floating_point(old):
                old.copy_(new)

    return update


def set_normalisation(model: nn.Module, batches: Iterable[tuple[Tensor, Tensor]]) -> None:
    """Sets mean and variance of all batch normalisations to those of these batches of the two inputs.

    After training on windows the network has the statistics of windows, which differ from those of the whole views that
    the network is used with: objects are larger, and other surfaces are frequent. Weights do not change.

    Raises:
        ValueError: `batches` is empty.
    """
    layers = [layer for layer in model.modules() if isinstance(layer, nn.BatchNorm2d)]
    momenta, mode, count = [layer.momentum for layer in layers], model.training, 0
    for layer in layers:
        layer.reset_running_stats()
        layer.momentum = None  # the mean over all batches
    model.train()
    with torch.no_grad():
        for count, (rgb, second) in enumerate(batches, start=1):  # noqa: B007
            model(rgb, second)
    model.train(mode)
    for layer, momentum in zip(layers, momenta, strict=True):
        layer.momentum = momentum
    if count == 0:
        raise ValueError("set_normalisation needs at least one batch.")


class AveragedCheckpoints:
    """Keeps the networks of the last evaluations in the folder of a run, `step-0001000.safetensors` and so on.

    Args:
        folder: folder of the run.
        most: number of networks that are kept.
        share: only networks of this last share of the steps are averaged: earlier ones had a higher learning rate.
    """

    def __init__(self, folder: Path, most: int, share: float = 1.0) -> None:
        self._folder, self._most, self._share = folder, most, share

    def add(self, network: RedNet, step: int) -> RedNet:
        """Stores the network of a step and returns a new one with the mean weights of the last networks."""
        save_network(self._folder / f"{PREFIX}{step:07d}.safetensors", network)
        files = self._files()
        for file in files[: -self._most]:
            file.unlink()
        late = [file for file in files[-self._most :] if _step(file) >= (1.0 - self._share) * step]
        return mean_of([load_network(file)[0] for file in late])

    def cut(self, step: int) -> None:
        """Removes the networks of later steps, which a killed process stored after its last state."""
        for file in self._files():
            if _step(file) > step:
                file.unlink()

    def _files(self) -> list[Path]:
        """Returns the files, that of the earliest step first."""
        return sorted(self._folder.glob(f"{PREFIX}*.safetensors"))


def _step(file: Path) -> int:
    return int(file.stem.removeprefix(PREFIX))
