"""A RedNet as the agent's segmenter: one frame in, scores of the goal and of the best other category out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sim.interface import MPCAT40_ID, CameraModel, ConfigError, Observation, Scores, SegmenterSpec
from stubborn.segmentation.checkpoints import load_rednet
from stubborn.segmentation.preprocess import normalise_depth, normalise_rgb, padding, shrink
from stubborn.segmentation.rednet import RedNet, folded


class RedNetSegmenter:
    """Softmax scores of a RedNet.

    Args:
        model: the network, in evaluation mode.
        camera: gives the range that depth is scaled over.
        block_px: the network sees the image shrunk by this factor.
        score_block_px: edge of the image block that one score stands for; a multiple of `block_px`.
        temperature: logits are divided by it before the softmax.
        threads: of PyTorch in this process; None leaves its choice.
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
        self._every = score_block_px // block_px

    @classmethod
    def from_file(cls, file: Path, **options: object) -> RedNetSegmenter:
        """A segmenter with the weights of a file and the resolution and temperature that it names.

        Raises:
            ConfigError: see `load_rednet`.
        """
        model, metadata = load_rednet(file)
        stored = {key: metadata[key] for key in ("block_px", "temperature") if key in metadata}
        if model.config.bottleneck and "block_px" not in stored:
            stored["block_px"] = 1  # the published network was trained on whole images
        return cls(model, **{**stored, **options})  # pyright: ignore[reportArgumentType]

    def scores(self, observation: Observation, goal: str) -> Scores:
        """Scores of one frame, float32 (h / score_block_px, w / score_block_px); see `sim.interface.Segmenter`."""
        if goal not in MPCAT40_ID or goal == "void":
            raise ConfigError(f"No category {goal!r} that a network knows. There is: {', '.join(MPCAT40_ID)}.")
        logits = self.logits(observation["rgb"], observation["depth"])[:, self._middle, self._middle]
        return _scores(logits / self.temperature, MPCAT40_ID[goal] - 1)

    def logits(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> Tensor:
        """Logits (classes, h / block_px, w / block_px) of one frame."""
        small_rgb, small_depth = shrink(rgb, self.block_px), shrink(depth, self.block_px)
        with torch.inference_mode():
            colour = torch.from_numpy(normalise_rgb(small_rgb))[None].to(memory_format=torch.channels_last)
            metres = torch.from_numpy(normalise_depth(small_depth, self.camera))[None]
            out = self.model(colour, metres)[0]
        pad = padding(*small_depth.shape)
        height, width = out.shape[-2:]
        return out[:, pad.top : height - pad.bottom, pad.left : width - pad.right]

    @property
    def _middle(self) -> slice:
        return slice(self._every // 2, None, self._every)


def _scores(logits: Tensor, goal_channel: int) -> Scores:
    probability = torch.softmax(logits, dim=0)
    target = probability[goal_channel].clone()
    probability[goal_channel] = 0.0
    return Scores(target.numpy(), probability.amax(dim=0).numpy())
