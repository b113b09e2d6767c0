"""U-Nets for colour and geometric channels that run on a CPU: encoder, narrow decoder, logits at half the size.

The dense encoder sees colour and geometry (`stubborn.segmentation.geometry`) together from the first convolution on.
The mobile encoder is EfficientNet-Lite0 for colour (`stubborn.segmentation.lite0`), to which a small encoder adds
geometric features at each scale, weighted by channel as in ESANet (Seichter et al. 2021, arXiv:2011.06961). The
decoder doubles the resolution stage by stage and adds the encoder's features (Ronneberger et al. 2015,
arXiv:1505.04597). Heads on the coarser stages are trained as well.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, get_args

from jaxtyping import Float
from torch import Tensor, cat, nn
from torch.nn import functional

from sim.core.interface import ConfigError
from stubborn.segmentation.inputs import INPUTS, InputKind
from stubborn.segmentation.lite0 import Lite0
from stubborn.segmentation.preprocess import require_whole_strides
from stubborn.segmentation.rednet import CLASSES, BasicBlock

EncoderKind = Literal["dense", "lite0"]
COLOURS = 3


@dataclass(frozen=True, kw_only=True)
class UNetConfig:
    """The size of a U-Net."""

    encoder: EncoderKind = "dense"
    widths: tuple[int, int, int, int, int] = (16, 32, 64, 128, 256)
    """Channels of the encoder (for `lite0`: of its geometric part) at 1/2, 1/4, 1/8, 1/16 and 1/32 of the input."""
    blocks: tuple[int, int, int, int] = (1, 2, 3, 3)
    """Residual blocks of the dense encoder at 1/4, 1/8, 1/16 and 1/32."""
    decoder: tuple[int, int, int, int] = (16, 24, 48, 96)
    """Channels of the decoder at 1/2, 1/4, 1/8 and 1/16."""
    classes: int = CLASSES
    second: InputKind = "geometry"
    """Kind of the second input."""

    def __post_init__(self) -> None:
        if self.encoder not in get_args(EncoderKind):
            raise ConfigError(f"UNetConfig.encoder must be one of {', '.join(get_args(EncoderKind))}.")
        if min(*self.widths, *self.blocks, *self.decoder, self.classes) < 1:
            raise ConfigError(f"UNetConfig needs at least one channel, block and class everywhere, got {self}.")


class UNet(nn.Module):
    """A network that computes class logits from colour and geometric channels."""

    stride_px = 2
    """Edge of the square of input pixels that one logit of the finest output stands for."""

    def __init__(self, config: UNetConfig = UNetConfig()) -> None:
        super().__init__()
        self.config = config
        self.encoder: DenseEncoder | MobileEncoder = ENCODERS[config.encoder](config)
        widths = self.encoder.channels
        self.context = _Context(widths[-1])
        ends = config.decoder
        inputs = (ends[1], ends[2], ends[3], widths[-1])
        self.decoder = nn.ModuleList(
            _Up(below, skip, end) for below, skip, end in zip(inputs, widths[:-1], ends, strict=True)
        )
        self.heads = nn.ModuleList(nn.Conv2d(end, config.classes, 1) for end in ends)

    def forward(
        self, rgb: Float[Tensor, "n 3 h w"], channels: Float[Tensor, "n c h w"]
    ) -> Float[Tensor, "n classes h w"]:
        """Returns the logits at full size, interpolated from half of it."""
        half = self.pyramid(rgb, channels, sides=False)[0]
        return functional.interpolate(half, scale_factor=2, mode="bilinear", align_corners=False)

    def pyramid(
        self, rgb: Float[Tensor, "n 3 h w"], channels: Float[Tensor, "n c h w"], *, sides: bool = True
    ) -> tuple[Float[Tensor, "n classes _ _"], ...]:
        """Returns the logits at 1/2 of the input's size and, with `sides`, at 1/4, 1/8 and 1/16 of it.

        Raises:
            ConfigError: height or width is not a multiple of 32.
        """
        require_whole_strides(*rgb.shape[-2:])
        skips = self.encoder(rgb, channels)
        x = self.context(skips[-1])
        outputs: list[Tensor] = []
        for level in (3, 2, 1, 0):
            x = self.decoder[level](x, skips[level])
            if sides or level == 0:
                outputs.append(self.heads[level](x))
        return tuple(reversed(outputs))


class DenseEncoder(nn.Module):
    """Residual blocks of full convolutions over colour and geometry together."""

    def __init__(self, config: UNetConfig) -> None:
        super().__init__()
        self.channels: Sequence[int] = config.widths
        self.stem = _conv(COLOURS + INPUTS[config.second].channels, config.widths[0], 5, stride=2)
        self.stages = nn.ModuleList()
        for before, width, count in zip(config.widths[:-1], config.widths[1:], config.blocks, strict=True):
            blocks = [BasicBlock(before, width, stride=2), *(BasicBlock(width, width) for _ in range(count - 1))]
            self.stages.append(nn.Sequential(*blocks))

    def forward(self, rgb: Tensor, channels: Tensor) -> list[Tensor]:
        """Returns the features at 1/2, 1/4, 1/8, 1/16 and 1/32 of the input."""
        features = [self.stem(cat([rgb, channels], dim=1))]
        for stage in self.stages:
            features.append(stage(features[-1]))
        return features


class MobileEncoder(nn.Module):
    """EfficientNet-Lite0 for colour; a small encoder adds geometric features at each of its scales."""

    def __init__(self, config: UNetConfig) -> None:
        super().__init__()
        self.colour = Lite0()
        self.channels: Sequence[int] = self.colour.channels
        widths = (INPUTS[config.second].channels, *config.widths)
        self.geometry = nn.ModuleList(
            _conv(before, width, 5 if i == 0 else 3, stride=2)
            for i, (before, width) in enumerate(itertools.pairwise(widths))
        )
        self.fusions = nn.ModuleList(
            _Fusion(width, channels) for width, channels in zip(config.widths, self.channels, strict=True)
        )

    def forward(self, rgb: Tensor, channels: Tensor) -> list[Tensor]:
        """Returns the features at 1/2, 1/4, 1/8, 1/16 and 1/32 of the input."""
        features, x, y = [], rgb, channels
        for level, (convolution, fusion) in enumerate(zip(self.geometry, self.fusions, strict=True)):
            y = convolution(y)
            x = fusion(self.colour.stage(level, x), y)
            features.append(x)
        return features


ENCODERS: Mapping[str, Callable[[UNetConfig], DenseEncoder | MobileEncoder]] = MappingProxyType(
    {"dense": DenseEncoder, "lite0": MobileEncoder}
)


class _Fusion(nn.Module):
    """Adds geometric features to colour features, each channel weighted by its mean over the image."""

    def __init__(self, geometric: int, channels: int) -> None:
        super().__init__()
        self.project = _conv(geometric, channels, 1)
        self.weigh = nn.Sequential(
            nn.AdaptiveAvgPool2d(1),
            nn.Conv2d(channels, max(8, channels // 8), 1),
            nn.ReLU(inplace=True),
            nn.Conv2d(max(8, channels // 8), channels, 1),
            nn.Sigmoid(),
        )

    def forward(self, colour: Tensor, geometric: Tensor) -> Tensor:
        """Returns features of the same shape as `colour`."""
        added = self.project(geometric)
        return colour + added * self.weigh(added)


class _Context(nn.Module):
    """Adds the mean over the image to the coarsest features: the kind of room indicates which objects may be in it."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.mean = nn.Sequential(nn.AdaptiveAvgPool2d(1), nn.Conv2d(channels, channels, 1), nn.ReLU(inplace=True))

    def forward(self, x: Tensor) -> Tensor:
        """Returns features of the same shape as `x`."""
        return x + self.mean(x)


class _Up(nn.Module):
    """Doubles the resolution, adds the encoder's features and refines the sum by one residual block."""

    def __init__(self, below: int, skip: int, channels: int) -> None:
        super().__init__()
        self.below = _conv(below, channels, 1)
        self.skip = _conv(skip, channels, 1)
        self.refine = BasicBlock(channels, channels)

    def forward(self, x: Tensor, skip: Tensor) -> Tensor:
        """Returns features at the resolution of `skip`."""
        up = functional.interpolate(self.below(x), size=skip.shape[-2:], mode="nearest")
        return self.refine(up + self.skip(skip))


def _conv(channels_in: int, channels_out: int, size: int, *, stride: int = 1) -> nn.Sequential:
    """Returns a convolution with batch normalisation and rectification."""
    return nn.Sequential(
        nn.Conv2d(channels_in, channels_out, size, stride=stride, padding=size // 2, bias=False),
        nn.BatchNorm2d(channels_out),
        nn.ReLU(inplace=True),
    )
