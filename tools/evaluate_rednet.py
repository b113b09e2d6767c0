"""Measure a RedNet on labelled views: intersection over union, what its scores are worth, time a frame.

    python tools/evaluate_rednet.py --views runs/views_val_fast runs/views_val_good
    python tools/evaluate_rednet.py --weights runs/rednet/rednet.safetensors --views runs/views_val_fast \\
        --fit-temperature --card stubborn/segmentation/weights/README.md

With --fit-temperature the temperature of the softmax is fitted on the views of every second house, written into the
file of the weights, and judged on the other houses; --block-px tries another working resolution. --card writes the
model card that ships beside the weights.
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
from stubborn.segmentation.checkpoints import load_rednet, save_rednet
from stubborn.segmentation.dataset import LabelledView, list_shards, read_shard, stored_block_px
from stubborn.segmentation.evaluation import Iou, Reliability, evaluate, fit_temperature
from stubborn.segmentation.network import RedNetSegmenter
from stubborn.segmentation.rednet import CLASSES, RedNet
from stubborn.segmentation.samples import NONE, Sampler, Samples

TIMED_FRAMES = 30
ABOUT = """A RedNet ({parameters:,} parameters, {size_mb:.1f} MB) that sees {width} x {height} pixels and knows mpcat40.
Trained from random weights on views of this repository's houses (pools train and wide), nothing else; MIT licence.
Measured on houses of `val`, whose furniture styles and textures are in no train house; calibration on those half of
them that the temperature was not fitted on. Checkpoint and working resolution were chosen by mIoU on views of these
houses as well, so the figure flatters a little."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Which network, on which views."""

    views: tuple[Path, ...]
    """Folders of shards of one size (tools/generate_views.py), of houses that the network was not trained on."""
    weights: Path | None = None
    """The network; the shipped one when not given."""
    fit_temperature: bool = False
    """Fit the softmax's temperature and write it into the file of the weights."""
    card: Path | None = None
    """Write a model card here."""
    block_px: int | None = None
    """Let it see the image shrunk by this (of 640 x 480), not by what its file says; --fit-temperature writes it."""
    threads: int = 2
    """Of PyTorch."""


@dataclass(frozen=True)
class Measured:
    """What was found out about a network."""

    iou: Iou
    by_folder: dict[str, float]
    """mIoU over the goal categories of each folder of views."""
    views: int
    before: Reliability
    """On the houses that the temperature was not fitted on, with temperature 1."""
    after: Reliability
    """The same with the network's temperature."""
    temperature: float
    frame_ms: float


def main(args: Args) -> int:
    """Measure, tell and, if asked to, write; returns the exit status."""
    for name in ("threads", "block_px"):
        value = getattr(args, name)
        if value is not None and value < 1:
            raise ConfigError(f"--{name.replace('_', '-')} must be at least 1, got {value}.")
    torch.set_num_threads(args.threads)
    file = weights_file(args.weights)
    model, metadata = load_rednet(file)
    if args.block_px is not None:
        metadata["block_px"] = args.block_px
    measured = measure(args, model, metadata)
    if args.fit_temperature:
        metadata["temperature"] = round(measured.temperature, 4)
        save_rednet(file, model, metadata)
    text = card(args, file, metadata, measured)
    print(text)
    if args.card is not None:
        args.card.write_text(text, encoding="utf-8")
    return 0


def measure(args: Args, model: RedNet, metadata: dict[str, Any]) -> Measured:
    """Everything about a network on the views of some folders."""
    block_px = int(metadata.get("block_px", 1))
    matrix = np.zeros((CLASSES, CLASSES), np.int64)
    by_folder, views = {}, []
    for folder in args.views:
        shards = list_shards(folder)
        found = [view for shard in shards for view in read_shard(shard)]
        iou, _ = evaluate(
            model, loader(found, block_px, stored_block_px(shards)), device=torch.device("cpu"), into=matrix
        )
        by_folder[folder.name] = iou.goals
        views += [(view, stored_block_px(shards)) for view in found]
    fitted, others = split_by_house(views)
    temperature = float(metadata.get("temperature", 1.0))
    if args.fit_temperature:
        temperature = fit_temperature(*sampled_logits(model, fitted, block_px))
    logits, truth = sampled_logits(model, others, block_px)
    before, after = Reliability.empty(), Reliability.empty()
    for reliability, t in ((before, 1.0), (after, temperature)):
        reliability.add((logits / t).softmax(dim=1).T.numpy(), truth.numpy())
    return Measured(Iou.of(matrix), by_folder, len(views), before, after, temperature, frame_ms(model, block_px))


def loader(views: Sequence[LabelledView], block_px: int, stored_px: int) -> DataLoader:
    """Batches of views at the network's resolution.

    Raises:
        ConfigError: they are stored smaller than that.
    """
    if block_px % stored_px:
        raise ConfigError(f"The network sees every {block_px} pixels, the views are stored every {stored_px}.")
    return DataLoader(Samples(views, Sampler(CameraModel(), block_px // stored_px, NONE)), batch_size=8)


def split_by_house(views: Sequence[tuple[LabelledView, int]]) -> tuple[list, list]:
    """Views of every second house, and those of the others.

    Raises:
        ConfigError: all are of one house.
    """
    houses = sorted({view.record["house"] for view, _ in views})
    if len(houses) < 2:
        raise ConfigError("--views are of one house only; calibration is judged on other houses than it is fitted on.")
    first = set(houses[::2])
    return [v for v in views if v[0].record["house"] in first], [v for v in views if v[0].record["house"] not in first]


def sampled_logits(model: RedNet, views: Sequence[tuple[LabelledView, int]], block_px: int) -> tuple[Tensor, Tensor]:
    """Logits (k, classes) and class channels (k,) of every eighth pixel each way that has a label."""
    logits, truth = [], []
    with torch.inference_mode():
        for stored_px in sorted({px for _, px in views}):
            for rgb, depth, target in loader([view for view, px in views if px == stored_px], block_px, stored_px):
                some = model(rgb, depth)[:, :, 2::8, 2::8].permute(0, 2, 3, 1).reshape(-1, CLASSES)
                kept = target[:, 2::8, 2::8].reshape(-1)
                logits.append(some[kept >= 0])
                truth.append(kept[kept >= 0])
    return torch.cat(logits).clone(), torch.cat(truth).clone()  # clones are no inference tensors


def frame_ms(model: RedNet, block_px: int) -> float:
    """Median milliseconds of one frame, from 640 x 480 images to scores."""
    segmenter = RedNetSegmenter(model, block_px=block_px, score_block_px=max(4, block_px))
    rng = np.random.default_rng(0)
    frame = {
        "rgb": rng.integers(0, 255, (480, 640, 3), np.uint8),
        "depth": rng.uniform(0.5, 5.0, (480, 640)).astype("f4"),
    }
    took_s = []
    for _ in range(TIMED_FRAMES):
        began = time.perf_counter()
        segmenter.scores(frame, "chair")  # pyright: ignore[reportArgumentType] - what it reads of an observation
        took_s.append(time.perf_counter() - began)
    return 1000.0 * float(np.median(took_s))


def card(args: Args, file: Path, metadata: dict[str, Any], measured: Measured) -> str:
    """The model card, Markdown."""
    parameters = sum(tensor.numel() for tensor in load_rednet(file)[0].parameters())
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
            *(f"| the same, views `{name}` | {value:.3f} |" for name, value in measured.by_folder.items()),
            f"| mIoU, all categories present | {iou.everything:.3f} |",
            f"| pixel accuracy | {iou.accuracy:.3f} |",
            f"| views measured | {measured.views} |",
            f"| time a frame, {args.threads} threads | {measured.frame_ms:.0f} ms |",
            *(f"| training | {stage.get('step', '?')} steps, {stage.get('hours', '?')} h |" for stage in stages),
            f"| calibration error, temperature 1 | {measured.before.error:.3f} |",
            f"| calibration error, temperature {measured.temperature:.2f} | {measured.after.error:.3f} |",
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
            "How often a goal category scored p is right, before and after the temperature:",
            "",
            "| mean score | share right | pixels | mean score | share right | pixels |",
            "|---|---|---|---|---|---|",
            *reliability,
            "",
        ]
    )


def training_stages(metadata: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """What is known of each training that led to a network, the first one first."""
    if "started_from" in metadata:
        yield from training_stages(metadata["started_from"])
    yield metadata


def _command(stage: dict[str, Any]) -> str:
    told = (
        f"--{key.replace('_', '-')} {' '.join(value) if isinstance(value, list) else value}"
        for key, value in stage.get("options", {}).items()
        if value
    )
    return " ".join(["python tools/train_rednet.py", *told])


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
