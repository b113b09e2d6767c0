"""A segmenter that scores each frame with a network."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from jaxtyping import Float, Float32, UInt8
from torch import Tensor

from sim.core.interface import CameraModel, ConfigError, Observation, Scores, SegmenterSpec, scores_of
from stubborn.segmentation.calibration import Calibration
from stubborn.segmentation.checkpoints import load_network
from stubborn.segmentation.inputs import INPUTS
from stubborn.segmentation.names import NameGroups
from stubborn.segmentation.preprocess import normalise_rgb, padding, shrink
from stubborn.segmentation.processor import computes_bf16
from stubborn.segmentation.rednet import RedNet, as_functions, folded


class _Frame(NamedTuple):
    """The results of the last frame: whatever is asked of one frame costs one pass of the network."""

    rgb: UInt8[np.ndarray, "h w 3"]
    posteriors: Float32[np.ndarray, "classes rows cols"]
    stages: list[Tensor]
    """What the head for names takes; empty without such a head."""


def block_px_of(model: RedNet, metadata: Mapping[str, Any]) -> int:
    """Returns the edge of the block of camera pixels that one input pixel of a stored network stands for."""
    return int(metadata.get("block_px", 1 if model.config.bottleneck else 2))  # the published one saw whole images


class NetworkSegmenter:
    """A segmenter with the calibrated softmax of a network's logits as scores.

    Args:
        model: the network, in evaluation mode.
        camera: gives the field of view, the height and the range of the depth image.
        block_px: the network's input is the image shrunk by this factor.
        score_block_px: edge of the image block of one score; None: 4, or `block_px` if it is larger.
        calibration: applied to the logits before the softmax; None changes nothing.
        threads: number of PyTorch's threads in this process; None does not change it.
        mirrored: True averages the logits of the image and of its mirror image, which are computed as one batch, and
            in bf16 where the processor has instructions for it.

    Raises:
        ConfigError: `block_px` is less than 1 or does not divide `score_block_px`.
    """

    spec = SegmenterSpec(sensors=("rgb",))

    def __init__(
        self,
        model: RedNet,
        *,
        camera: CameraModel | None = None,
        block_px: int = 2,
        score_block_px: int | None = None,
        calibration: Calibration | None = None,
        threads: int | None = None,
        mirrored: bool = False,
    ) -> None:
        score_block_px = score_block_px or max(4, block_px)
        if block_px < 1 or score_block_px % block_px:
            raise ConfigError(
                f"block_px must be at least 1 and divide score_block_px, got {block_px} and {score_block_px}."
            )
        if threads is not None:
            torch.set_num_threads(threads)
        self.second = INPUTS[model.config.second]
        self.mirrored = mirrored
        self.bf16 = mirrored and computes_bf16()
        self._dtype = torch.bfloat16 if self.bf16 else torch.float32
        self.model = folded(model)
        if self.bf16:  # weights that are converted once, not by autocast at each frame: a fifth faster, same outputs
            self.model = copy.deepcopy(self.model).to(self._dtype)
        self.model.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue] - its stub lacks it
        self.model = as_functions(self.model)
        self.camera = camera or CameraModel()
        self.block_px = block_px
        self.calibration = calibration or Calibration.of_temperature(1.0)
        every = score_block_px // block_px
        self._middle = slice(every // 2, None, every)
        self._last: _Frame | None = None
        self._names = NameGroups.of(model.config.names) if model.config.names else None

    @classmethod
    def from_file(
        cls,
        file: Path,
        *,
        temperature: float | None = None,
        camera: CameraModel | None = None,
        threads: int | None = None,
        mirrored: bool = False,
    ) -> NetworkSegmenter:
        """Returns a segmenter with the weights of a file, and with the resolution and calibration stored in it.

        Args:
            file: weights; see `load_network`.
            temperature: temperature of the softmax, in place of the stored calibration.
            camera: see the class.
            threads: see the class.
            mirrored: see the class.

        Raises:
            ConfigError: see `load_network`, `Calibration` and the class.
        """
        model, metadata = load_network(file)
        calibration = (
            Calibration.from_metadata(metadata) if temperature is None else Calibration.of_temperature(temperature)
        )
        return cls(
            model,
            camera=camera,
            block_px=block_px_of(model, metadata),
            calibration=calibration,
            threads=threads,
            mirrored=mirrored,
        )

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the scores of one frame, float32 (h / score_block_px, w / score_block_px).

        Raises:
            ConfigError: the goal is not a category of the network.
        """
        return scores_of(self.posteriors(observation), goal)

    def posteriors(self, observation: Observation) -> Float32[np.ndarray, "classes rows cols"]:
        """Returns the probability of each mpcat40 category except void, in their order, at the resolution of `scores`.

        The array must not be changed: the scores of the same frame are read from it.
        """
        return self._seen(observation).posteriors

    def named(self, observation: Observation) -> tuple[Float32[np.ndarray, "names h w"], Sequence[str]] | None:
        """Returns the probability of each everyday name, and the names; see `sim.core.interface.GuessesNames`.

        A probability is for 4 x 4 pixels of the network's input. None: the network has no head for names.
        """
        head = self.model.names_head
        if head is None or self._names is None:
            return None
        frame = self._seen(observation)
        with torch.inference_mode():
            logits = head(frame.stages)[0].float()
        size = (observation["depth"].shape[0] // self.block_px, observation["depth"].shape[1] // self.block_px)
        image = logits[:, *padding(*size).quarter(*size)]
        return self._names.probabilities(image.numpy(), frame.posteriors), self._names.names

    def _seen(self, observation: Observation) -> _Frame:
        if self._last is None or self._last.rgb is not observation["rgb"]:
            logits, stages = self._pass(observation["rgb"], observation["depth"])
            calibrated = self.calibration.applied(logits[:, self._middle, self._middle])
            self._last = _Frame(observation["rgb"], torch.softmax(calibrated, dim=0).numpy(), stages)
        return self._last

    def categories(self, observation: Observation) -> UInt8[np.ndarray, "rows cols"]:
        """Returns the most probable mpcat40 id of each pixel, never void, at the resolution of `scores`."""
        return (self.posteriors(observation).argmax(axis=0) + 1).astype(np.uint8)

    def logits(
        self, rgb: UInt8[np.ndarray, "h w 3"], depth_m: Float32[np.ndarray, "h w"]
    ) -> Float[Tensor, "classes rows cols"]:
        """Returns the logits of one frame; each is for a square of `block_px` pixels."""
        return self._pass(rgb, depth_m)[0]

    def _pass(
        self, rgb: UInt8[np.ndarray, "h w 3"], depth_m: Float32[np.ndarray, "h w"]
    ) -> tuple[Float[Tensor, "classes rows cols"], list[Tensor]]:
        """Returns the logits of one frame and, of the image that is not mirrored, what the head for names takes."""
        small_rgb, small_depth = shrink(rgb, self.block_px), shrink(depth_m, self.block_px)
        channels = self.second.of(small_depth, self.camera)
        images, seconds = [small_rgb], [channels]
        if self.mirrored:
            images.append(np.ascontiguousarray(small_rgb[:, ::-1]))
            seconds.append(self.second.mirrored(channels))
        colour = torch.from_numpy(np.stack([normalise_rgb(image) for image in images]))
        second = torch.from_numpy(np.stack([self.second.normalised(image, self.camera) for image in seconds]))
        with torch.inference_mode():
            colour = colour.to(self._dtype, memory_format=torch.channels_last)
            second = second.to(self._dtype, memory_format=torch.channels_last)
            stages = list[Tensor]()
            if self._names is None:
                out = self.model.pyramid(colour, second, sides=False)[0].float()
            else:
                stages, last = self.model.features(colour, second)
                out = self.model.final_deconv_custom(last)
            own = out[:, :, *padding(*small_depth.shape).inner]
            logits = own[0].float()
            if self.mirrored:  # in place: new memory for each result would take longer than the sums
                logits.add_(own[1].flip(-1)).mul_(0.5)
        return logits, [stage[:1] for stage in stages]
