"""The network that predicts the potentials of frontiers from a partial semantic map (Ramakrishnan et al. 2022).

The network is a U-Net (Ronneberger et al. 2015, arXiv:1505.04597) over the patch of the map around the robot. Its first
layer turns squares of 2 x 2 cells into channels and its last layer turns channels into such squares, so that a pass
costs a quarter of one at full size and no cell is lost. Only this module of the explorer imports PyTorch.
"""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import msgspec
import numpy as np
import torch
from jaxtyping import Float, Float32, UInt8
from torch import Tensor, nn
from torch.nn import functional

from sim.core.interface import GOAL_CATEGORIES, ConfigError
from stubborn.exploration.patches import LAYERS
from stubborn.network_files import Family

SHIPPED = Path(__file__).with_name("weights") / "poni.safetensors"
"""The shipped weights."""
CHANNELS = len(LAYERS) + len(GOAL_CATEGORIES)
MAPS = 1 + len(GOAL_CATEGORIES)
"""Number of predicted maps: the area potential, then the object potential of each goal category."""

_Width = Annotated[int, msgspec.Meta(ge=1, le=1024)]


@dataclass(frozen=True, kw_only=True)
class PoniNetConfig:
    """The size of the network and of its patch."""

    cells: Annotated[int, msgspec.Meta(ge=16, le=1024)] = 128
    """Edge of the patch in blocks, a multiple of 16."""
    pool: Annotated[int, msgspec.Meta(ge=1, le=100)] = 5
    """Edge of a block in map cells."""
    widths: tuple[_Width, _Width, _Width, _Width] = (32, 64, 96, 128)
    """Channels at 1/2, 1/4, 1/8 and 1/16 of the patch."""

    def __post_init__(self) -> None:
        if self.cells % 16:
            raise ConfigError(f"PoniNetConfig.cells must be a multiple of 16, got {self.cells}.")


class PoniNet(nn.Module):
    """Computes the logits of the potentials."""

    def __init__(self, config: PoniNetConfig = PoniNetConfig()) -> None:
        super().__init__()
        self.config = config
        widths = config.widths
        self.stem = nn.Sequential(_conv(4 * CHANNELS, widths[0], 3), _conv(widths[0], widths[0], 3))
        self.down = nn.ModuleList(
            nn.Sequential(_conv(above, below, 3, stride=2), _conv(below, below, 3))
            for above, below in itertools.pairwise(widths)
        )
        self.up = nn.ModuleList(_conv(below, above, 1) for above, below in itertools.pairwise(widths))
        self.refine = nn.ModuleList(_conv(width, width, 3) for width in widths[:-1])
        self.head = nn.Conv2d(widths[0], 4 * MAPS, 1)
        with torch.no_grad():
            self.head.bias.fill_(-2.0)  # pyright: ignore[reportOptionalMemberAccess] - most potentials are small

    def forward(self, channels: Float[Tensor, "n channels cells cells"]) -> Float[Tensor, "n maps cells cells"]:
        """Returns the logits of the area potential and of the object potential of each goal category."""
        features = [self.stem(functional.pixel_unshuffle(channels, 2))]
        for down in self.down:
            features.append(down(features[-1]))
        x = features[-1]
        for level in reversed(range(len(self.up))):
            x = self.refine[level](features[level] + functional.interpolate(self.up[level](x), scale_factor=2.0))
        return functional.pixel_shuffle(self.head(x), 2)


class Predictor:
    """Predicts the potentials of one patch at a time."""

    def __init__(self, model: PoniNet) -> None:
        self.cells, self.pool = model.config.cells, model.config.pool
        self._model = model.eval()
        self._model.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue] - its stub lacks it

    @torch.inference_mode()
    def predict(self, channels: UInt8[np.ndarray, "channels cells cells"]) -> Float32[np.ndarray, "maps cells cells"]:
        """Returns the area potential and the object potential of each goal category, in [0, 1].

        The values are meaningful only at frontiers.
        """
        images = torch.from_numpy(channels[None]).to(torch.float32, memory_format=torch.channels_last)
        return torch.sigmoid(self._model(images))[0].contiguous().numpy()


@functools.lru_cache(maxsize=4)
def shared_predictor(file: str | None) -> Predictor:
    """Returns the predictor with the weights of a file, or with the shipped weights; explorers share it.

    Raises:
        ConfigError: see `Family.load`.
    """
    return Predictor(FILES.load(SHIPPED if file is None else Path(file))[0])


def _conv(channels_in: int, channels_out: int, size: int, *, stride: int = 1) -> nn.Sequential:
    """Returns a convolution with batch normalisation and rectification."""
    return nn.Sequential(
        nn.Conv2d(channels_in, channels_out, size, stride=stride, padding=size // 2, bias=False),
        nn.BatchNorm2d(channels_out),
        nn.ReLU(inplace=True),
    )


FILES = Family("poni", PoniNetConfig, PoniNet, "`stubborn train poni`")
"""Reads and writes files of weights."""
