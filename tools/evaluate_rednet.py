"""Evaluates a network on labelled views: intersection over union, calibration of its scores, time per frame.

    python tools/evaluate_rednet.py --views runs/views_val_fast runs/views_val_good
    python tools/evaluate_rednet.py --weights runs/rednet/rednet.safetensors --views runs/views_val_fast \\
        --calibrate --card stubborn/segmentation/weights/README.md

With --calibrate a factor and an offset of each category's logit are fitted to the views of every second house, written
to the file of the weights, and evaluated on the other houses; --block-px sets another resolution. --card writes the
model card that is shipped with the weights.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import DataLoader

from sim import cli
from sim.composition.segmenters import weights_file
from sim.interface import GOAL_CATEGORIES, CameraModel, ConfigError
from stubborn.segmentation.calibration import Calibration, fit_calibration
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.dataset import LabelledView, list_shards, read_shard, stored_block_px
from stubborn.segmentation.evaluation import Iou, Reliability, evaluate
from stubborn.segmentation.network import NetworkSegmenter
from stubborn.segmentation.networks import Network
from stubborn.segmentation.rednet import CLASSES
from stubborn.segmentation.samples import NONE, Sampler, Samples

TIMED_FRAMES = 30
ABOUT = """A RedNet ({parameters:,} parameters, {size_mb:.1f} MB) for images of {width} x {height} pixels and
the categories of mpcat40; MIT licence.
It was trained from random weights on views of this repository's houses only (pools train and wide). It was evaluated
on houses of `val`, whose furniture styles and textures are in no train house, and its calibration on the half of them
to which it was not fitted. Checkpoint and resolution were chosen by mIoU on views of these houses as
well, so that the mIoU is slightly optimistic."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Evaluates a network on views."""

    views: tuple[Path, ...]
    """Folders of shards of one size (tools/generate_views.py), of houses that the network was not trained on."""
    weights: Path | None = None
    """Weights of the network; None: the shipped ones."""
    calibrate: bool = False
    """Fit the calibration and write it to the file of the weights."""
    card: cli.OutFile | None = None
    """File of the model card to write."""
    block_px: cli.Count | None = None
    """Factor by which the 640 x 480 image is shrunk, in place of the stored one; --calibrate stores it."""
    threads: cli.Count = 2
    """Number of threads of PyTorch."""


@dataclass(frozen=True)
class Measured:
    """The results of an evaluation."""

    iou: Iou
    by_folder: dict[str, float]
    """mIoU over the goal categories of each folder of views."""
    views: int
    before: Reliability
    """On the houses to which the calibration was not fitted, without one."""
    after: Reliability
    """The same with the network's calibration."""
    calibration: Calibration
    frame_ms: float


def main(args: Args) -> int:
    """Evaluates, prints and, where asked to, writes; returns the exit status."""
    for name in ("threads", "block_px"):
        value = getattr(args, name)
        if value is not None and value < 1:
            raise ConfigError(f"--{name.replace('_', '-')} must be at least 1, got {value}.")
    torch.set_num_threads(args.threads)
    file = weights_file(args.weights)
    model, metadata = load_network(file)
    if args.block_px is not None:
        metadata["block_px"] = args.block_px
    measured = measure(args, model, metadata)
    if args.calibrate:
        metadata.pop("temperature", None)
        metadata["calibration"] = measured.calibration.to_metadata()
        save_network(file, model, metadata)
    text = card(args, file, metadata, measured)
    print(text)
    if args.card is not None:
        args.card.write_text(text, encoding="utf-8")
    return 0


def measure(args: Args, model: Network, metadata: dict[str, Any]) -> Measured:
    """Returns the results of a network on the views of some folders."""
    block_px = int(metadata.get("block_px", 1))
    matrix = np.zeros((CLASSES, CLASSES), np.int64)
    by_folder, views = {}, []
    for folder in args.views:
        shards = list_shards(folder)
        found = [view for shard in shards for view in read_shard(shard)]
        iou, _ = evaluate(
            model, loader(model, found, block_px, stored_block_px(shards)), device=torch.device("cpu"), into=matrix
        )
        by_folder[folder.name] = iou.goals
        views += [(view, stored_block_px(shards)) for view in found]
    fitted, others = split_by_house(views)
    calibration = Calibration.from_metadata(metadata)
    if args.calibrate:
        calibration = fit_calibration(*sampled_logits(model, fitted, block_px))
    logits, truth = sampled_logits(model, others, block_px)
    before, after = Reliability.empty(), Reliability.empty()
    for reliability, used in ((before, Calibration.of_temperature(1.0)), (after, calibration)):
        scores = (logits * used.scale + used.offset).softmax(dim=1)
        reliability.add(scores.T.numpy(), truth.numpy())
    return Measured(Iou.of(matrix), by_folder, len(views), before, after, calibration, frame_ms(model, block_px))


def loader(model: Network, views: Sequence[LabelledView], block_px: int, stored_px: int) -> DataLoader:
    """Returns batches of views at the network's resolution.

    Raises:
        ConfigError: the views are stored at a lower resolution.
    """
    if block_px % stored_px:
        raise ConfigError(
            f"The network needs blocks of {block_px} pixels, but the views are stored in blocks of {stored_px}."
        )
    sampler = Sampler(CameraModel(), block_px // stored_px, NONE, second=model.config.second)
    return DataLoader(Samples(views, sampler), batch_size=8)


def split_by_house(views: Sequence[tuple[LabelledView, int]]) -> tuple[list, list]:
    """Returns the views of every second house, and those of the other houses.

    Raises:
        ConfigError: all views are of one house.
    """
    houses = sorted({view.record["house"] for view, _ in views})
    if len(houses) < 2:
        raise ConfigError(
            "--views are of one house only; calibration needs houses to fit and other houses to evaluate."
        )
    first = set(houses[::2])
    return [v for v in views if v[0].record["house"] in first], [v for v in views if v[0].record["house"] not in first]


def sampled_logits(model: Network, views: Sequence[tuple[LabelledView, int]], block_px: int) -> tuple[Tensor, Tensor]:
    """Returns logits (k, classes) and class channels (k,) of the labelled pixels in every eighth row and column."""
    logits, truth = [], []
    with torch.inference_mode():
        for stored_px in sorted({px for _, px in views}):
            some_views = [view for view, px in views if px == stored_px]
            for rgb, depth, target in loader(model, some_views, block_px, stored_px):
                some = model(rgb, depth)[:, :, 2::8, 2::8].permute(0, 2, 3, 1).reshape(-1, CLASSES)
                kept = target[:, 2::8, 2::8].reshape(-1)
                logits.append(some[kept >= 0])
                truth.append(kept[kept >= 0])
    return torch.cat(logits).clone(), torch.cat(truth).clone()  # a clone is not an inference tensor


def frame_ms(model: Network, block_px: int) -> float:
    """Returns the median time of one frame in milliseconds, from 640 x 480 images to scores."""
    segmenter = NetworkSegmenter(model, block_px=block_px)
    rng = np.random.default_rng(0)
    frame = {
        "rgb": rng.integers(0, 255, (480, 640, 3), np.uint8),
        "depth": rng.uniform(0.5, 5.0, (480, 640)).astype("f4"),
    }
    times_s = []
    for _ in range(TIMED_FRAMES):
        start_s = time.perf_counter()
        segmenter.scores(frame, "chair")  # pyright: ignore[reportArgumentType] - the two images that it reads
        times_s.append(time.perf_counter() - start_s)
    return 1000.0 * float(np.median(times_s))


def card(args: Args, file: Path, metadata: dict[str, Any], measured: Measured) -> str:
    """Returns the model card, Markdown."""
    parameters = sum(tensor.numel() for tensor in load_network(file)[0].parameters())
    iou, px = measured.iou, int(metadata.get("block_px", 1))
    stages = list(training_stages(metadata))
    rows = [f"| {name} | {iou.by_category[name]:.3f} |" for name in GOAL_CATEGORIES if name in iou.by_category]
    absent = [name for name in GOAL_CATEGORIES if name not in iou.by_category]
    bins = zip(measured.before.rows(), measured.after.rows(), strict=False)
    reliability = [f"| {b[1]:.2f} | {b[2]:.2f} | {b[0]} | {a[1]:.2f} | {a[2]:.2f} | {a[0]} |" for b, a in bins]
    return "\n".join(
        [
            f"# {file.name}",
            "",
            ABOUT.format(parameters=parameters, size_mb=file.stat().st_size / 1e6, width=640 // px, height=480 // px),
            "",
            "| | |",
            "|---|---|",
            f"| mIoU, goal categories present | {iou.goals:.3f} |",
            *(f"| mIoU, views `{name}` | {value:.3f} |" for name, value in measured.by_folder.items()),
            f"| mIoU, all categories present | {iou.everything:.3f} |",
            f"| pixel accuracy | {iou.accuracy:.3f} |",
            f"| number of views | {measured.views} |",
            f"| time per frame, {args.threads} threads | {measured.frame_ms:.0f} ms |",
            *(f"| training | {stage.get('step', '?')} steps, {stage.get('hours', '?')} h |" for stage in stages),
            f"| calibration error without calibration | {measured.before.error:.3f} |",
            f"| calibration error, calibrated | {measured.after.error:.3f} |",
            "",
            "```sh",
            *(_command(stage) for stage in stages),
            "```",
            "",
            "| category | IoU |",
            "|---|---|",
            *rows,
            "",
            *([f"Not in these views: {', '.join(absent)}.", ""] if absent else []),
            "Share of correct pixels by the score of a goal category, before and after calibration:",
            "",
            "| mean score | share correct | pixels | mean score | share correct | pixels |",
            "|---|---|---|---|---|---|",
            *reliability,
            "",
        ]
    )


def training_stages(metadata: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yields the metadata of each training that led to a network, the first one first."""
    if "started_from" in metadata:
        yield from training_stages(metadata["started_from"])
    yield metadata


def _command(stage: dict[str, Any]) -> str:
    """Returns the command of one training."""
    options = (
        f"--{key.replace('_', '-')} {' '.join(value) if isinstance(value, list) else value}"
        for key, value in stage.get("options", {}).items()
        if value
    )
    return " ".join(["python tools/train_rednet.py", *options])


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
