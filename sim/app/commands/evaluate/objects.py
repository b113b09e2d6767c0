"""Draws the objects of labelled views that a network misses worst: colour with a frame, true and predicted categories.

    stubborn evaluate objects --views runs/views_val --out runs/worst.png
    stubborn evaluate objects --views runs/views_val --weights runs/rednet/rednet.safetensors --out runs/worst.png

An object is a connected region of one goal category. The worst ones have the most pixels of another category; there is
at most one per category and house.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import torch
from jaxtyping import UInt8
from numpy.typing import NDArray

from sim.app import cli
from sim.app.commands.evaluate.segmentation import BATCH, loader
from sim.app.composition.segmenters import weights_file
from sim.app.viewers.palette import with_legend
from sim.core.files import write_picture
from sim.core.interface import GOAL_CATEGORIES, MPCAT40
from sim.core.pictures import tiled
from sim.core.vocabulary import counted
from sim.training.segmentation.dataset import GOAL_IDS, LabelledView, list_shards, read_shard, stored_block_px
from stubborn.segmentation.calibration import Calibration
from stubborn.segmentation.checkpoints import load_network
from stubborn.segmentation.preprocess import padding, shrink
from stubborn.segmentation.rednet import RedNet

WIDTH_PX = 400
FRAME = (255, 0, 200)


@dataclass(frozen=True, kw_only=True)
class Args:
    """Draw the objects that a network misses worst."""

    views: Path
    """Folder of shards (`stubborn views`)."""
    out: cli.OutPicture
    """The picture, a .png or .jpg file."""
    weights: Path | None = None
    """Weights of the network; None: the shipped ones."""
    count: cli.Count = 10
    """Number of objects."""
    threads: cli.Count = 1
    """Number of threads of PyTorch. On cores that other processes use, two are far slower than one."""


@dataclass(frozen=True)
class Missed:
    """An object of which the network misses some pixels."""

    house: str
    category: str
    taken_for: str
    """The most frequent category of its wrong pixels."""
    missed_px: int
    """Number of its wrong pixels, of the 640 x 480 image."""
    box: tuple[int, int, int, int]
    """Left, top, width and height in the network's image."""
    view: LabelledView
    truth: UInt8[np.ndarray, "h w"]
    """mpcat40 ids at the network's resolution."""
    predicted: UInt8[np.ndarray, "h w"]


def main(args: Args) -> int:
    """Draws the sheet and prints one line for each object."""
    torch.set_num_threads(args.threads)
    model, metadata = load_network(weights_file(args.weights))
    block_px, calibration = int(metadata.get("block_px", 1)), Calibration.from_metadata(metadata)
    worst: dict[tuple[str, str], Missed] = {}
    for missed in missed_objects(list_shards(args.views), model, block_px, calibration):
        key = missed.house, missed.category
        if key not in worst or missed.missed_px > worst[key].missed_px:
            worst[key] = missed
    chosen = sorted(worst.values(), key=lambda missed: -missed.missed_px)[: args.count]
    if not chosen:
        print("The network misses no object of these views.")
        return 0
    for missed in chosen:
        print(f"{missed.view.key}: {missed.category}, {missed.missed_px} px missed, mostly as {missed.taken_for}")
    write_picture(args.out, tiled([draw(missed) for missed in chosen], columns=1))
    print(f"{counted(len(chosen), 'object')} in {args.out}")
    return 0


def missed_objects(shards: Sequence[Path], model: RedNet, block_px: int, calibration: Calibration) -> Iterator[Missed]:
    """Yields the objects of goal categories that a network, calibrated as agents use it, misses in part.

    Raises:
        ConfigError: the views are stored at a lower resolution than the network needs.
    """
    model.eval()
    stored_px = stored_block_px(shards)
    for shard in shards:
        views = list(read_shard(shard))
        with torch.inference_mode():
            for number, (rgb, second, _) in enumerate(loader(model, views, block_px, stored_px)):
                channels = calibration.applied(model(rgb, second)).argmax(dim=1).numpy()
                for view, of_view in zip(views[number * BATCH :], channels, strict=False):
                    truth = shrink(view.semantic, block_px // stored_px)
                    rows, cols = padding(*truth.shape).inner
                    yield from _missed_in(view, truth, (of_view[rows, cols] + 1).astype(np.uint8), block_px)


def _missed_in(
    view: LabelledView, truth: UInt8[np.ndarray, "h w"], predicted: UInt8[np.ndarray, "h w"], block_px: int
) -> Iterator[Missed]:
    """Yields the objects of one view."""
    for name, category in zip(GOAL_CATEGORIES, GOAL_IDS, strict=True):
        count, regions, stats, _ = cv2.connectedComponentsWithStats((truth == category).astype(np.uint8))
        for i in range(1, count):
            wrong = predicted[(regions == i) & (predicted != category)]
            if wrong.size:
                left, top, width, height = map(int, stats[i, :4])
                taken_for = MPCAT40[int(np.bincount(wrong).argmax())]
                pixels, box = int(wrong.size) * block_px**2, (left, top, width, height)
                yield Missed(view.record["house"], name, taken_for, pixels, box, view, truth, predicted)


def draw(missed: Missed) -> NDArray[np.uint8]:
    """Returns an image of the view with a frame around the object, the true and the predicted categories."""
    height_px = round(WIDTH_PX * missed.truth.shape[0] / missed.truth.shape[1])
    size, scale = (WIDTH_PX, height_px), WIDTH_PX / missed.truth.shape[1]
    colour = cv2.resize(missed.view.rgb, size, interpolation=cv2.INTER_AREA)
    left, top, width, height = (round(scale * value) for value in missed.box)
    cv2.rectangle(colour, (left, top), (left + width, top + height), FRAME, 2)
    text = f"{missed.category}, taken for {missed.taken_for}"
    cv2.putText(colour, text, (6, height_px - 8), cv2.FONT_HERSHEY_SIMPLEX, 0.5, FRAME, 1, cv2.LINE_AA)
    panels = [
        with_legend(cv2.resize(ids, size, interpolation=cv2.INTER_NEAREST).astype(np.uint8))
        for ids in (missed.truth, missed.predicted)
    ]
    return np.hstack([colour, *panels], dtype=np.uint8)
