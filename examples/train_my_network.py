"""Trains `MyNetwork` of examples/my_segmentation.py on labelled views (docs/tutorials/own_segmentation.md).

python -m examples.train_my_network --views views --minutes 10 --out my_network.pt
"""

import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch.nn.functional import cross_entropy
from torch.utils.data import DataLoader

from examples.my_segmentation import MyNetwork
from sim import LabelledView, ViewDataset
from sim.app import cli
from sim.training.segmentation.dataset import list_shards


def batch_of(views: list[LabelledView]) -> tuple[torch.Tensor, torch.Tensor]:
    """Returns images (n, 3, h, w) in [0, 1], and categories (n, h / 4, w / 4), -1 where they are unknown."""
    images = torch.from_numpy(np.stack([view.rgb for view in views])).permute(0, 3, 1, 2).float() / 255
    ids = torch.from_numpy(np.stack([view.semantic for view in views])[:, 2::4, 2::4]).long()
    return images, ids - 1  # id 0 is void


@dataclass(frozen=True, kw_only=True)
class Args:
    """Trains a small network on labelled views."""

    views: Path
    """Folder of views."""
    minutes: cli.Positive = 10.0
    """Time of the training."""
    out: Path = Path("my_network.pt")
    """File of the weights."""


def main(args: Args) -> int:
    """Trains for some minutes, and saves the weights."""
    network = MyNetwork().train()
    optimizer = torch.optim.Adam(network.parameters(), 1e-3)
    end_s, step, smooth = time.monotonic() + 60.0 * args.minutes, 0, 0.0
    while step == 0 or time.monotonic() < end_s:
        for images, ids in DataLoader(ViewDataset(list_shards(args.views)), batch_size=8, collate_fn=batch_of):
            loss = cross_entropy(network(images), ids, ignore_index=-1)
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            step, smooth = step + 1, 0.98 * smooth + 0.02 * loss.item()
            if step in (1, 10) or step % 50 == 0:
                print(f"step {step}: loss {smooth / (1.0 - 0.98**step):.2f}", flush=True)
            if time.monotonic() > end_s:
                break
    torch.save(network.state_dict(), args.out)
    print(f"{args.out} has the weights after {step} steps")
    return 0


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
