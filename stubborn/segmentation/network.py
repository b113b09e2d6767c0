"""A segmenter that scores each frame with a RedNet."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float, Float32, UInt8
from torch import Tensor

from sim.interface import MPCAT40_ID, CameraModel, ConfigError, Observation, Scores, SegmenterSpec
from stubborn.segmentation.checkpoints import load_rednet
from stubborn.segmentation.preprocess import normalise_depth, normalise_rgb, padding, shrink
from stubborn.segmentation.rednet import RedNet, folded


class RedNetSegmenter:
    """A segmenter whose scores are the softmax of a RedNet's logits.

    Args:
        model: the network, in evaluation mode.
        camera: gives the range by which depth is scaled.
        block_px: the network's input is the image shrunk by this factor.
        score_block_px: edge of the image block that one score stands for; a multiple of `block_px`.
        temperature: divides the logits before the softmax.
        threads: number of PyTorch's threads in this process; None does not change it.

    Raises:
        ConfigError: `score_block_px` is not a multiple of `block_px`, or the temperature is not positive.
    """

    spec = SegmenterSpec(sensors=("rgb",))

    def __init__(
        self,
        model: RedNet,
        *,
        camera: CameraModel | None = None,
        block_px: int = 2,
        score_block_px: int = 4,
        temperature: float = 1.0,
        threads: int | None = None,
    ) -> None:
        if block_px < 1 or score_block_px % block_px:
            raise ConfigError(f"score_block_px must be a multiple of block_px >= 1, got {score_block_px}, {block_px}.")
        if temperature <= 0:
            raise ConfigError(f"The softmax temperature must be > 0, got {temperature}.")
        if threads is not None:
            torch.set_num_threads(threads)
        self.model = folded(model)
        self.model.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue] - its stub lacks it
        self.camera = camera or CameraModel()
        self.block_px = block_px
        self.temperature = temperature
        every = score_block_px // block_px
        self._middle = slice(every // 2, None, every)

    @classmethod
    def from_file(cls, file: Path, **options: object) -> RedNetSegmenter:
        """Returns a segmenter with the weights of a file, and with the resolution and temperature stored in it.

        Args:
            file: weights; see `load_rednet`.
            options: arguments of the class that replace the stored values.

        Raises:
            ConfigError: see `load_rednet` and the class.
        """
        model, metadata = load_rednet(file)
        stored = {key: metadata[key] for key in ("block_px", "temperature") if key in metadata}
        if model.config.bottleneck and "block_px" not in stored:
            stored["block_px"] = 1  # the published network was trained on whole images
        return cls(model, **{**stored, **options})  # pyright: ignore[reportArgumentType]

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Returns the scores of one frame, float32 (h / score_block_px, w / score_block_px).

        Raises:
            ConfigError: the goal is not a category of the network.
        """
        if goal not in MPCAT40_ID or goal == "void":
            raise ConfigError(f"No category {goal!r} that a network knows. There is: {', '.join(MPCAT40_ID)}.")
        logits = self.logits(observation["rgb"], observation["depth"])[:, self._middle, self._middle]
        return _scores(logits / self.temperature, MPCAT40_ID[goal] - 1)

    def logits(
        self, rgb: UInt8[np.ndarray, "h w 3"], depth_m: Float32[np.ndarray, "h w"]
    ) -> Float[Tensor, "classes rows cols"]:
        """Returns the logits of one frame; rows and columns are those of the image divided by `block_px`."""
        small_rgb, small_depth = shrink(rgb, self.block_px), shrink(depth_m, self.block_px)
        with torch.inference_mode():
            colour = torch.from_numpy(normalise_rgb(small_rgb))[None].to(memory_format=torch.channels_last)
            metres = torch.from_numpy(normalise_depth(small_depth, self.camera))[None]
            out = self.model(colour, metres)[0]
        return out[:, *padding(*small_depth.shape).inner]


def _scores(logits: Float[Tensor, "classes h w"], goal_channel: int) -> Scores:
    """Returns the softmax of the goal's channel and the highest of the other channels."""
    probability = torch.softmax(logits, dim=0)
    target = probability[goal_channel].clone()
    probability[goal_channel] = 0.0
    return Scores(target.numpy(), probability.amax(dim=0).numpy())
