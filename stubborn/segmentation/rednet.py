"""RedNet, an encoder-decoder for RGB-D segmentation (Jiang et al. 2018, arXiv:1806.01054).

The network has two residual encoders, one for colour and one for depth; depth features are added to colour features
after the stem and after each of the four stages. 1x1 convolutions convert the sums to the width of the decoder. Its
residual blocks double the resolution stage by stage and add the sums as skips. Side heads on four decoder stages are
trained as well (pyramid supervision). Module names are those of the published checkpoints, which load without
conversion.
"""

from __future__ import annotations

import copy
import functools
import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn import functional
from torch.nn.utils.fusion import fuse_conv_bn_eval

from sim.core.interface import MPCAT40, ConfigError
from stubborn.segmentation.inputs import INPUTS, InputKind
from stubborn.segmentation.preprocess import require_whole_strides

CLASSES = len(MPCAT40) - 1
"""Number of mpcat40 categories without void: channel c of the output is category id c + 1."""


@dataclass(frozen=True, kw_only=True)
class RedNetConfig:
    """The size of a RedNet; the default is the published network (81,972,552 parameters)."""

    width: int = 64
    """Number of channels after the stem."""
    encoder_blocks: tuple[int, int, int, int] = (3, 4, 6, 3)
    """Residual blocks of each encoder stage."""
    bottleneck: bool = True
    """True: blocks of 1x1, 3x3, 1x1 convolutions, 4 x the channels (ResNet-50); False: two 3x3 (ResNet-18)."""
    decoder_blocks: tuple[int, int, int, int] = (6, 4, 3, 3)
    """Residual blocks of each decoder stage, including the upsampling block."""
    final_blocks: int = 3
    """Residual blocks at half the input's resolution, before the last upsampling."""
    classes: int = CLASSES
    second: InputKind = "depth"
    """Kind of the second input; the published network takes depth."""
    names: tuple[str, ...] = ()
    """The everyday names that a second head tells apart (`NamesHead`); none: there is no such head."""

    def __post_init__(self) -> None:
        counts = (self.width, self.classes, self.final_blocks, *self.encoder_blocks, *self.decoder_blocks)
        if min(counts) < 1:
            raise ConfigError(f"RedNetConfig needs at least one channel, block and class everywhere, got {self}.")


PUBLISHED = RedNetConfig()
"""The network of the paper, with ResNet-50 encoders."""
COMPACT = RedNetConfig(
    width=32, encoder_blocks=(2, 2, 2, 2), bottleneck=False, decoder_blocks=(2, 2, 2, 2), final_blocks=1
)
"""A narrow and shallow network that a CPU can run at the same time as a simulator."""


class BasicBlock(nn.Module):
    """A residual block of two 3x3 convolutions (He et al. 2015)."""

    expansion = 1

    def __init__(self, channels_in: int, channels: int, stride: int = 1) -> None:
        super().__init__()
        self.conv1 = _conv3x3(channels_in, channels, stride)
        self.bn1 = nn.BatchNorm2d(channels)
        self.conv2 = _conv3x3(channels, channels)
        self.bn2 = nn.BatchNorm2d(channels)
        self.relu = nn.ReLU(inplace=True)
        self.downsample = _shortcut(channels_in, channels, stride)

    def forward(self, x: Float[Tensor, "n c h w"]) -> Float[Tensor, "n channels rows cols"]:
        """Returns features with `channels` channels; rows and columns are those of `x` divided by the stride."""
        y = self.relu(self.bn1(self.conv1(x)))
        y = self.bn2(self.conv2(y))
        return self.relu(y + (x if self.downsample is None else self.downsample(x)))


class Bottleneck(nn.Module):
    """A residual block of 1x1, 3x3 and 1x1 convolutions with the stride on the 3x3 (He et al. 2015)."""

    expansion = 4

    def __init__(self, channels_in: int, channels: int, stride: int = 1) -> None:
        super().__init__()
        channels_out = channels * self.expansion
        self.conv1 = nn.Conv2d(channels_in, channels, 1, bias=False)
        self.bn1 = nn.BatchNorm2d(channels)
        self.conv2 = _conv3x3(channels, channels, stride)
        self.bn2 = nn.BatchNorm2d(channels)
        self.conv3 = nn.Conv2d(channels, channels_out, 1, bias=False)
        self.bn3 = nn.BatchNorm2d(channels_out)
        self.relu = nn.ReLU(inplace=True)
        self.downsample = _shortcut(channels_in, channels_out, stride)

    def forward(self, x: Float[Tensor, "n c h w"]) -> Float[Tensor, "n channels rows cols"]:
        """Returns features with 4 x `channels` channels; rows and columns are those of `x` divided by the stride."""
        y = self.relu(self.bn1(self.conv1(x)))
        y = self.relu(self.bn2(self.conv2(y)))
        y = self.bn3(self.conv3(y))
        return self.relu(y + (x if self.downsample is None else self.downsample(x)))


class DecoderBlock(nn.Module):
    """A residual block of two 3x3 convolutions; with `upsample` it doubles the resolution."""

    def __init__(self, channels_in: int, channels_out: int, *, upsample: bool) -> None:
        super().__init__()
        self.conv1 = _conv3x3(channels_in, channels_in)
        self.bn1 = nn.BatchNorm2d(channels_in)
        self.conv2: nn.Module = _conv3x3(channels_in, channels_out)
        self.upsample: nn.Module | None = None
        if upsample:
            self.conv2 = nn.ConvTranspose2d(
                channels_in, channels_out, 3, stride=2, padding=1, output_padding=1, bias=False
            )
        self.bn2 = nn.BatchNorm2d(channels_out)
        self.relu = nn.ReLU(inplace=True)
        if upsample:
            self.upsample = nn.Sequential(
                nn.ConvTranspose2d(channels_in, channels_out, 2, stride=2, bias=False), nn.BatchNorm2d(channels_out)
            )

    def forward(self, x: Float[Tensor, "n channels_in h w"]) -> Float[Tensor, "n channels_out rows cols"]:
        """Returns features of the same height and width as `x`, or twice as high and wide."""
        y = self.relu(self.bn1(self.conv1(x)))
        y = self.bn2(self.conv2(y))
        return self.relu(y + (x if self.upsample is None else self.upsample(x)))


class NamesHead(nn.Module):
    """Computes logits of everyday names from the features of all decoder stages, at a quarter of the input's size.

    Args:
        channels: channels of the stages, from the coarsest.
        names: number of names.
    """

    def __init__(self, channels: Sequence[int], names: int) -> None:
        super().__init__()
        width = 4 * channels[-1]
        self.layers = nn.Sequential(
            nn.Conv2d(sum(channels), width, 1, bias=False), nn.BatchNorm2d(width), nn.ReLU(inplace=True),
            _conv3x3(width, width), nn.BatchNorm2d(width), nn.ReLU(inplace=True),
            nn.Conv2d(width, names, 1),
        )  # fmt: skip

    def forward(self, stages: Sequence[Float[Tensor, "n _ _ _"]]) -> Float[Tensor, "n names rows cols"]:
        """Returns the logits; `stages` are the outputs of the decoder at 1/16, 1/8, 1/4 and 1/2 of the input's size."""
        size = stages[2].shape[-2:]
        coarse = [functional.interpolate(x, size, mode="bilinear", align_corners=False) for x in stages[:2]]
        return self.layers(torch.cat([*coarse, stages[2], functional.avg_pool2d(stages[3], 2)], dim=1))


class RedNet(nn.Module):
    """A network that computes class logits from colour and depth (or geometric channels), normalised."""

    def __init__(self, config: RedNetConfig = PUBLISHED) -> None:
        super().__init__()
        self.config = config
        block = Bottleneck if config.bottleneck else BasicBlock
        w = config.width
        widths = (w, 2 * w, 4 * w, 8 * w)
        self.conv1, self.bn1 = _stem(3, w)
        self.layer1, self.layer2, self.layer3, self.layer4 = _stages(block, w, widths, config.encoder_blocks)
        self.conv1_d, self.bn1_d = _stem(INPUTS[config.second].channels, w)
        self.layer1_d, self.layer2_d, self.layer3_d, self.layer4_d = _stages(block, w, widths, config.encoder_blocks)
        self.relu = nn.ReLU(inplace=True)
        self.maxpool = nn.MaxPool2d(3, stride=2, padding=1)

        ends = (4 * w, 2 * w, w, w)  # channels after each decoder stage
        counts = config.decoder_blocks
        self.deconv1 = _decoder_stage(8 * w, ends[0], counts[0])
        self.deconv2 = _decoder_stage(ends[0], ends[1], counts[1])
        self.deconv3 = _decoder_stage(ends[1], ends[2], counts[2])
        self.deconv4 = _decoder_stage(ends[2], ends[3], counts[3])
        self.agant0 = _skip(w, ends[3])
        self.agant1 = _skip(widths[0] * block.expansion, ends[2])
        self.agant2 = _skip(widths[1] * block.expansion, ends[1])
        self.agant3 = _skip(widths[2] * block.expansion, ends[0])
        self.agant4 = _skip(widths[3] * block.expansion, 8 * w)
        self.final_conv = nn.Sequential(*(DecoderBlock(w, w, upsample=False) for _ in range(config.final_blocks)))
        self.final_deconv_custom = nn.ConvTranspose2d(w, config.classes, 2, stride=2)
        self.out5_conv_custom = nn.Conv2d(ends[0], config.classes, 1)
        self.out4_conv_custom = nn.Conv2d(ends[1], config.classes, 1)
        self.out3_conv_custom = nn.Conv2d(ends[2], config.classes, 1)
        self.out2_conv_custom = nn.Conv2d(ends[3], config.classes, 1)
        self.names_head = NamesHead(ends, len(config.names)) if config.names else None
        self._initialise()

    def forward(self, rgb: Float[Tensor, "n 3 h w"], depth: Float[Tensor, "n c h w"]) -> Float[Tensor, "n classes h w"]:
        """Returns the logits at full size."""
        return self.pyramid(rgb, depth, sides=False)[0]

    def pyramid(
        self,
        rgb: Float[Tensor, "n 3 h w"],
        depth: Float[Tensor, "n c h w"],
        *,
        sides: bool = True,
        subpixel: tuple[int, int] | None = None,
    ) -> tuple[Float[Tensor, "n classes _ _"], ...]:
        """Returns the logits at full size and, with `sides`, at 1/2, 1/4, 1/8 and 1/16 of it.

        With `subpixel`, row and column in {0, 1}, the first logits are those of this pixel of every 2 x 2 block only:
        `full[..., row::2, column::2]`. They cost a quarter of the time in training.

        Raises:
            ConfigError: height or width is not a multiple of 32.
        """
        stages, x = self.features(rgb, depth)
        heads = (self.out5_conv_custom, self.out4_conv_custom, self.out3_conv_custom, self.out2_conv_custom)
        outputs = [head(stage) for head, stage in zip(heads, stages, strict=True)] if sides else []
        return (self._finest(x, subpixel), *reversed(outputs))

    def features(
        self, rgb: Float[Tensor, "n 3 h w"], depth: Float[Tensor, "n c h w"]
    ) -> tuple[list[Tensor], Float[Tensor, "n width _ _"]]:
        """Returns the output of each decoder stage, from 1/16 to 1/2 of the input's size, and the last features.

        `names_head` takes the former, `final_deconv_custom` the latter.

        Raises:
            ConfigError: height or width is not a multiple of 32.
        """
        require_whole_strides(*rgb.shape[-2:])
        *skips, x = self._encode(rgb, depth)
        outputs = list[Tensor]()
        for stage, skip in zip((self.deconv1, self.deconv2, self.deconv3, self.deconv4), reversed(skips), strict=True):
            outputs.append(stage(x))
            x = outputs[-1] + skip
        return outputs, self.final_conv(x)

    def _finest(self, x: Tensor, subpixel: tuple[int, int] | None) -> Tensor:
        """Returns the logits at full size, or those of one pixel of every 2 x 2 block."""
        head = self.final_deconv_custom
        if subpixel is None:
            return head(x)
        row, column = (
            subpixel  # the kernel is as large as its stride: each of its elements gives one of the four pixels
        )
        return functional.conv2d(x, head.weight[:, :, row, column].t()[..., None, None], head.bias)

    def _encode(self, rgb: Tensor, depth: Tensor) -> list[Tensor]:
        """Returns the skips from the finest (1/2 of the input) to the coarsest (1/32), with the decoder's channels."""
        y = self.relu(self.bn1_d(self.conv1_d(depth)))
        x = self.relu(self.bn1(self.conv1(rgb))) + y
        skips = [self.agant0(x)]
        x, y = self.maxpool(x), self.maxpool(y)
        for layer, layer_d, skip in (
            (self.layer1, self.layer1_d, self.agant1),
            (self.layer2, self.layer2_d, self.agant2),
            (self.layer3, self.layer3_d, self.agant3),
            (self.layer4, self.layer4_d, self.agant4),
        ):
            y = layer_d(y)
            x = layer(x) + y
            skips.append(skip(x))
        return skips

    def _initialise(self) -> None:
        for module in self.modules():
            if isinstance(module, nn.Conv2d | nn.ConvTranspose2d):
                nn.init.kaiming_normal_(module.weight, mode="fan_out", nonlinearity="relu")
                if module.bias is not None:
                    nn.init.zeros_(module.bias)


def folded(model: RedNet) -> RedNet:
    """Returns a copy for inference; its batch normalisations are part of the convolutions before them.

    The copy is faster and cannot be trained. Its outputs differ from the model's by rounding only. It shares the
    tensors that the folding does not change.
    """
    shared = {id(tensor): tensor for tensor in (*model.parameters(), *model.buffers())}
    copied = copy.deepcopy(model, shared).eval()
    for module in list(copied.modules()):
        for (conv_name, conv), (norm_name, norm) in itertools.pairwise(list(module.named_children())):
            if isinstance(norm, nn.BatchNorm2d) and isinstance(conv, nn.Conv2d | nn.ConvTranspose2d):
                setattr(module, conv_name, fuse_conv_bn_eval(conv, norm, isinstance(conv, nn.ConvTranspose2d)))
                setattr(module, norm_name, nn.Identity())
    return copied


def as_functions(model: RedNet) -> RedNet:
    """Replaces all modules of a folded network by functions with the same results, and returns the network.

    A pass then takes a sixth less time on one core, because a call of a module costs much more than one of a function.
    The network has no parameters and no modules afterwards: its type and memory format must be final.
    """
    _function_of(model)
    return model


def _function_of(module: nn.Module) -> Callable[..., Tensor]:
    """Returns what a module computes; its modules become functions, which are attributes of the same names."""
    match module:
        case nn.Conv2d():
            return functools.partial(
                _conv2d, (module.weight, module.bias, module.stride, module.padding, module.dilation, module.groups)
            )
        case nn.ConvTranspose2d():
            return functools.partial(
                _conv_transpose2d, (module.weight, module.bias, module.stride, module.padding, module.output_padding)
            )
        case nn.ReLU():
            return torch.relu_
        case nn.Identity():
            return _same
        case nn.Sequential():
            return functools.partial(_in_turn, [_function_of(child) for child in module])
    for name, child in list(module.named_children()):
        delattr(module, name)
        setattr(module, name, _function_of(child))
    return module.forward


def _conv2d(arguments: tuple[Any, ...], x: Tensor) -> Tensor:
    return torch.conv2d(x, *arguments)


def _conv_transpose2d(arguments: tuple[Any, ...], x: Tensor) -> Tensor:
    return torch.conv_transpose2d(x, *arguments)


def _same(x: Tensor) -> Tensor:
    return x


def _in_turn(functions: Sequence[Callable[[Tensor], Tensor]], x: Tensor) -> Tensor:
    for function in functions:
        x = function(x)
    return x


def _conv3x3(channels_in: int, channels_out: int, stride: int = 1) -> nn.Conv2d:
    return nn.Conv2d(channels_in, channels_out, 3, stride=stride, padding=1, bias=False)


def _stem(channels_in: int, channels: int) -> tuple[nn.Conv2d, nn.BatchNorm2d]:
    return nn.Conv2d(channels_in, channels, 7, stride=2, padding=3, bias=False), nn.BatchNorm2d(channels)


def _shortcut(channels_in: int, channels_out: int, stride: int) -> nn.Module | None:
    if stride == 1 and channels_in == channels_out:
        return None
    return nn.Sequential(
        nn.Conv2d(channels_in, channels_out, 1, stride=stride, bias=False), nn.BatchNorm2d(channels_out)
    )


def _stages(
    block: type[BasicBlock] | type[Bottleneck], channels_in: int, widths: Sequence[int], counts: Sequence[int]
) -> list[nn.Sequential]:
    stages = []
    for number, (width, count) in enumerate(zip(widths, counts, strict=True)):
        blocks = [block(channels_in, width, stride=1 if number == 0 else 2)]
        channels_in = width * block.expansion
        blocks += [block(channels_in, width) for _ in range(count - 1)]
        stages.append(nn.Sequential(*blocks))
    return stages


def _decoder_stage(channels_in: int, channels_out: int, count: int) -> nn.Sequential:
    blocks = [DecoderBlock(channels_in, channels_in, upsample=False) for _ in range(count - 1)]
    return nn.Sequential(*blocks, DecoderBlock(channels_in, channels_out, upsample=True))


def _skip(channels_in: int, channels_out: int) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(channels_in, channels_out, 1, bias=False),
        nn.BatchNorm2d(channels_out),
        nn.ReLU(inplace=True),
    )
