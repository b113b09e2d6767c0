"""Calibration of a network's logits, so that a score of 0.8 means that the category is right in 80 % of such pixels.

Vector scaling (Guo et al. 2017, arXiv:1706.04599) multiplies each category's logit by a factor and adds an offset. It
is fitted to views of houses that the network was not trained on. A penalty keeps it near one temperature, because rare
categories have few pixels.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import torch
from jaxtyping import Float, Float32, Int64
from torch import Tensor, nn

from sim.core.interface import ConfigError
from stubborn.segmentation.rednet import CLASSES

HOLD = 0.02
"""Weight of the squared distance of factors and offsets from a single temperature, per pixel."""


@dataclass(frozen=True)
class Calibration:
    """A factor and an offset of each category's logit."""

    scale: Float32[Tensor, " classes"]
    offset: Float32[Tensor, " classes"]

    @classmethod
    def of_temperature(cls, temperature: float) -> Calibration:
        """Returns the calibration that divides all logits by one temperature.

        Raises:
            ConfigError: the temperature is not positive.
        """
        if not temperature > 0:
            raise ConfigError(f"The softmax temperature must be > 0, got {temperature}.")
        return cls(torch.full((CLASSES,), 1.0 / temperature), torch.zeros(CLASSES))

    @classmethod
    def from_metadata(cls, metadata: Mapping[str, Any]) -> Calibration:
        """Returns the calibration that is stored with weights; temperature 1 if no calibration is stored.

        Raises:
            ConfigError: there is not exactly one stored number for each category.
        """
        stored = metadata.get("calibration")
        if stored is None:
            return cls.of_temperature(float(metadata.get("temperature", 1.0)))
        scale, offset = torch.tensor(stored["scale"]), torch.tensor(stored["offset"])
        if scale.shape != (CLASSES,) or offset.shape != (CLASSES,):
            raise ConfigError(f"A calibration has {CLASSES} factors and offsets, got {len(scale)} and {len(offset)}.")
        return cls(scale.float(), offset.float())

    def to_metadata(self) -> dict[str, list[float]]:
        """Returns the numbers for the header of a file of weights."""
        return {
            "scale": [round(float(v), 4) for v in self.scale],
            "offset": [round(float(v), 4) for v in self.offset],
        }

    def applied(self, logits: Float[Tensor, "*batch classes rows cols"]) -> Float[Tensor, "*batch classes rows cols"]:
        """Returns the calibrated logits."""
        return (logits * self.scale[:, None, None]).add_(self.offset[:, None, None])


def fit_calibration(
    logits: Float32[Tensor, "k classes"], truth: Int64[Tensor, " k"], *, hold: float = HOLD
) -> Calibration:
    """Returns the calibration of highest likelihood, with a penalty that keeps it near one temperature.

    Args:
        logits: logits of the pixels that count.
        truth: class channels of these pixels.
        hold: weight of the squared distance from one temperature without offsets; infinity gives the temperature alone.
    """
    temperature = fit_temperature(logits, truth)
    start = 1.0 / temperature
    scale = torch.full((CLASSES,), start, requires_grad=True)
    offset = torch.zeros(CLASSES, requires_grad=True)

    def loss() -> Tensor:
        likelihood = nn.functional.cross_entropy(logits * scale + offset, truth)
        return likelihood + hold * ((scale / start - 1.0).square().mean() + offset.square().mean())

    if hold != float("inf"):
        _minimise([scale, offset], loss)
    return Calibration(scale.detach().clone(), offset.detach().clone())


def fit_temperature(logits: Float32[Tensor, "k classes"], truth: Int64[Tensor, " k"]) -> float:
    """Returns the temperature that maximises the likelihood of the softmax of the logits (Guo et al. 2017).

    Args:
        logits: logits of the pixels that count.
        truth: class channels of these pixels.
    """
    log_t = torch.zeros((), requires_grad=True)
    _minimise([log_t], lambda: nn.functional.cross_entropy(logits / log_t.exp(), truth))
    return float(log_t.detach().exp())


def _minimise(parameters: list[Tensor], loss_of: Callable[[], Tensor]) -> None:
    """Minimises a function of some parameters."""
    optimiser = torch.optim.LBFGS(parameters, lr=0.1, max_iter=50)

    def closure() -> Tensor:
        optimiser.zero_grad()
        loss = loss_of()
        loss.backward()
        return loss

    optimiser.step(closure)
