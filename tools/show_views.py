"""Draws a sheet of random views from shards: colour, depth and labels side by side.

python tools/show_views.py --views runs/views --out runs/views.png
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sim import cli
from sim.files import write_picture
from sim.interface import ConfigError
from sim.viewers.palette import with_legend
from stubborn.segmentation.dataset import LabelledView, list_shards, read_shard, tile

WIDTH_PX = 400


@dataclass(frozen=True, kw_only=True)
class Args:
    """Draw a sheet of random views."""

    views: Path
    """Folder of shards."""
    out: cli.OutFile
    """The PNG file."""
    count: cli.Count = 12
    """Number of views."""
    seed: cli.Seed = 0
    """Seed of the choice of views."""


def main(args: Args) -> int:
    """Draws the sheet and prints its path."""
    if args.count < 1:
        raise ConfigError(f"--count must be at least 1, got {args.count}.")
    rng = np.random.default_rng(args.seed)
    shards = list_shards(args.views)
    picked = [shards[i] for i in rng.permutation(len(shards))[: args.count]]
    views: list[LabelledView] = []
    for number, shard in enumerate(picked):
        in_shard = list(read_shard(shard))
        share = -(-(args.count - len(views)) // (len(picked) - number))
        views += [in_shard[i] for i in rng.permutation(len(in_shard))[:share]]
    write_picture(args.out, tile([draw(view) for view in views], columns=2))
    print(f"{len(views)} views in {args.out}")
    return 0


def draw(view: LabelledView) -> NDArray[np.uint8]:
    """Returns an image of colour, depth (near is bright, no return is black) and labels of a view."""
    near = np.where(view.depth_m > 0.0, 255.0 - 230.0 * view.depth_m / max(float(view.depth_m.max()), 0.1), 0.0)
    grey = cv2.cvtColor(near.astype(np.uint8), cv2.COLOR_GRAY2RGB)
    height_px = round(WIDTH_PX * view.rgb.shape[0] / view.rgb.shape[1])
    labels = cv2.resize(view.semantic, (WIDTH_PX, height_px), interpolation=cv2.INTER_NEAREST)
    panels = [cv2.resize(panel, (WIDTH_PX, height_px), interpolation=cv2.INTER_AREA) for panel in (view.rgb, grey)]
    return np.hstack([*panels, with_legend(labels.astype(np.uint8))], dtype=np.uint8)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
