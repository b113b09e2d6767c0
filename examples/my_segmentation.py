"""A segmentation of your own, with a PyTorch network.

stubborn run --semantics examples.my_segmentation:SEGMENTATION --config detector.weights=my_network.pt
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import nn

from sim import CameraModel, Observation, SegmentationSpec, SegmenterSpec


class MyNetwork(nn.Sequential):
    """Put your network here: from images (n, 3, h, w) in [0, 1] to logits (n, 40, h / 4, w / 4), without void."""

    def __init__(self, width: int = 32) -> None:
        super().__init__(
            nn.Conv2d(3, width, 5, 4, 2), nn.ReLU(),
            nn.Conv2d(width, 2 * width, 3, 2, 1), nn.BatchNorm2d(2 * width), nn.ReLU(),
            nn.Conv2d(2 * width, 2 * width, 3, 1, 2, 2), nn.BatchNorm2d(2 * width), nn.ReLU(),
            nn.Conv2d(2 * width, 2 * width, 3, 1, 4, 4), nn.BatchNorm2d(2 * width), nn.ReLU(),
            nn.Conv2d(2 * width, 40, 3, 1, 1), nn.Upsample(scale_factor=2),
        )  # fmt: skip


@dataclass(frozen=True)
class MyConfig:
    """The options."""

    weights: Path = Path("my_network.pt")


class MySegmenter:
    """Computes probabilities."""

    def __init__(self, camera: CameraModel, config: MyConfig) -> None:
        self.network = MyNetwork().eval()
        self.network.load_state_dict(torch.load(config.weights, weights_only=True))

    @torch.inference_mode()
    def posteriors(self, observation: Observation) -> np.ndarray:
        """Returns probabilities, (40, h / 4, w / 4)."""
        image = torch.from_numpy(observation["rgb"]).permute(2, 0, 1)[None].float() / 255
        return self.network(image)[0].softmax(dim=0).numpy()


SEGMENTATION = SegmentationSpec(
    make=MySegmenter, config=MyConfig(), spec=SegmenterSpec(sensors=("rgb",), kind="my-network")
)
