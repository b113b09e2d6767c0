"""Evaluates a network on labelled views: intersection over union, objects found, calibration, time per frame.

    stubborn evaluate --views runs/views_val_fast runs/views_val_good
    stubborn evaluate --views runs/views_val_fast --semantics my_network:SEGMENTATION --config detector.weights=my.pt
    stubborn evaluate --views runs/views_val_fast --weights new.safetensors --against old.safetensors
    stubborn evaluate --views runs/views_train --semantics http://localhost:8000 --calibration server.json
    stubborn evaluate --weights runs/rednet/rednet.safetensors --views runs/views_val_fast \\
        --calibrate --card stubborn/segmentation/weights/README.md

With --calibrate a factor and an offset of each category's logit are fitted to the views of every second house, written
to the file of the weights, and evaluated on the other houses; --block-px sets another resolution. --card writes the
model card that is shipped with the weights, and next to it the confusion matrix as a picture and, with --curves, the
learning curves of the trainings that led to the network.
"""

from __future__ import annotations

import itertools
import json
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Int64
from torch import Tensor
from torch.utils.data import DataLoader

from sim.app import cli
from sim.app.commands.evaluate.network_card import Evaluated, Measured, card_text, training_stages, write_card
from sim.app.commands.evaluate.own import LogitSamples, fitted_calibration, joined, measure_own, own_text
from sim.app.composition.segmenters import weights_file
from sim.app.services.client import is_address
from sim.core.files import write_atomically
from sim.core.interface import CameraModel, ConfigError
from sim.training.segmentation.breakdown import Breakdown
from sim.training.segmentation.dataset import LabelledView, list_shards, read_shard, spread_views, stored_block_px
from sim.training.segmentation.evaluation import Confusions, Iou, Reliability, confusion, without_slivers
from sim.training.segmentation.samples import NONE, Sampler, Samples
from stubborn.segmentation.calibration import Calibration, fit_calibration
from stubborn.segmentation.checkpoints import load_network, save_network
from stubborn.segmentation.network import NetworkSegmenter
from stubborn.segmentation.preprocess import padding, shrink
from stubborn.segmentation.rednet import CLASSES, RedNet
from stubborn.segmentation.shipped import SHIPPED_REDNET

TIMED_FRAMES = 30
BATCH = 8


@dataclass(frozen=True, kw_only=True)
class Args:
    """Evaluate a segmentation network on labelled views."""

    views: tuple[Path, ...]
    """Folders of shards of one size (`stubborn views`), of houses that the network was not trained on."""
    weights: Path | None = None
    """Weights of the network; None: the shipped ones."""
    against: Path | None = None
    """Weights of another network: print the difference between the two mIoUs on the same views."""
    semantics: str | None = None
    """A segmentation of your own, package.module:NAME, or a server, http://HOST:PORT, in place of a network of this
    project."""
    config: tuple[str, ...] = ()
    """With --semantics: fields of its configuration, detector.FIELD=VALUE."""
    count: cli.Amount = 0
    """Number of views of each folder, spread over its shards; 0: all."""
    calibrate: bool = False
    """Fit the calibration and write it to the file of the weights, --weights."""
    shipped: bool = False
    """With --calibrate: allow that the file is that of the weights that ship."""
    calibration: cli.OutFile | None = None
    """With a server: fit its calibration and write it to this file, for detector.calibration of a run."""
    card: cli.OutFile | None = None
    """File of the model card to write."""
    curves: tuple[Path, ...] = ()
    """With --card: folders of the trainings that led to the network, in their order, for a picture of the curves."""
    block_px: cli.Count | None = None
    """Factor by which the 640 x 480 image is shrunk, in place of the stored one; --calibrate stores it."""
    mirror: bool = False
    """Average the logits of each view and of its mirror image, as `NetworkSegmenter(mirrored=True)` does."""
    slivers: cli.OnUnlessNo = True
    """Leave out regions that the image's edge cuts to less than 24 of 640 pixels; by default they count."""
    threads: cli.Count = 1
    """Number of threads of PyTorch. On cores that other processes use, two are far slower than one."""


@dataclass
class Predictions:
    """The predictions of a network on the views of some folders."""

    matrix: Int64[np.ndarray, "classes classes"]
    """Confusion matrix, see `sim.training.segmentation.evaluation.confusion`."""
    breakdown: Breakdown = field(default_factory=Breakdown)
    calibrated: Confusions = field(default_factory=Confusions)
    """Confusion matrices of calibrated logits, as the agent uses them."""
    samples: LogitSamples = field(default_factory=dict)
    """Those of labelled pixels."""
    views: int = 0


def main(args: Args) -> int:
    """Evaluates the network, prints and writes the results; returns the exit status."""
    torch.set_num_threads(args.threads)
    if args.semantics is not None:
        return _evaluate_own(args, args.semantics)
    if args.config or args.calibration is not None:
        raise ConfigError("--config and --calibration need --semantics.")
    if args.card is None:
        cli.require_unset(args, ("curves",), "needs --card: the picture of the curves is written next to it.")
    file = weights_file(args.weights)
    if args.calibrate and not args.shipped and file.resolve() == SHIPPED_REDNET.resolve():
        raise ConfigError(
            "--calibrate writes into the file of the weights, and these are those that ship. Give --weights FILE, a "
            "copy of them for example, or --shipped to change the shipped file."
        )
    if args.calibrate and file.suffix != ".safetensors":
        raise ConfigError(
            f"--calibrate writes into the file of the weights, and '{file}' is not of this project; train with --init "
            f"'{file}' first, which writes a .safetensors file."
        )
    model, metadata = load_network(file)
    if args.block_px is not None:
        metadata["block_px"] = args.block_px
    measured = measure(args, model, metadata)
    if args.calibrate:
        metadata.pop("temperature", None)
        metadata["calibration"] = measured.calibration.to_metadata()
        save_network(file, model, metadata)
    about = Evaluated(file, model, metadata, args.threads)
    print(card_text(about, measured))
    if args.against is not None:
        print("\n".join(comparison_lines(args, measured.calibrated, args.against)))
    if args.card is not None:
        write_card(args.card, about, measured, args.curves)
    return 0


def _evaluate_own(args: Args, semantics: str) -> int:
    """Evaluates a user's segmentation or a server and prints the results; returns the exit status.

    Raises:
        ConfigError: an option is for networks of this project only, or as `measure_own`.
    """
    allowed = {"views", "semantics", "config", "count", "threads", "card", "calibration"}
    others = {option.name for option in fields(args)} - allowed
    cli.require_unset(args, others, "is for networks of this project, not --semantics.")
    if args.calibration is not None and not is_address(semantics):
        raise ConfigError(f"--calibration is for a server, http://HOST:PORT, not for '{semantics}'.")
    if args.calibration is not None and any(text.startswith("detector.calibration=") for text in args.config):
        raise ConfigError("--calibration fits raw scores: leave out detector.calibration.")
    measured = measure_own(semantics, args.views, count=args.count, config=args.config)
    text = own_text(measured)
    if args.calibration is not None:
        calibration, before, after = fitted_calibration(measured)
        write_atomically(args.calibration, json.dumps(calibration.to_metadata()) + "\n")
        text += f"\n\nLog loss on every second house: {before:.3f}, calibrated {after:.3f}."
    print(text)
    if args.card is not None:
        write_atomically(args.card, text + "\n")
    return 0


def measure(args: Args, model: RedNet, metadata: Mapping[str, object]) -> Measured:
    """Returns the results of a network on the views of some folders.

    Raises:
        ConfigError: all views are of one house, or they are stored at a lower resolution than the network needs.
    """
    block_px = training_stages(metadata)[-1].block_px
    calibration = Calibration.from_metadata(metadata)
    seen = predict(args, model, block_px, calibration)
    houses = sorted(seen.samples)
    if len(houses) < 2:
        raise ConfigError(
            "--views are of one house only; calibration needs houses to fit and other houses to evaluate."
        )
    if args.calibrate:
        calibration = fit_calibration(*joined(seen.samples, houses[::2]))
        seen = predict(args, model, block_px, calibration)
    logits, truth = joined(seen.samples, houses[1::2])
    before, after = Reliability.empty(), Reliability.empty()
    for reliability, used in ((before, Calibration.of_temperature(1.0)), (after, calibration)):
        scores = (logits * used.scale + used.offset).softmax(dim=1)
        reliability.add(scores.T.numpy(), truth.numpy())
    return Measured(
        Iou.of(seen.matrix),
        seen.calibrated,
        seen.matrix,
        seen.breakdown,
        seen.views,
        before,
        after,
        calibration,
        frame_ms(model, block_px, mirrored=args.mirror),
    )


def comparison_lines(args: Args, ours: Confusions, against: Path) -> Iterator[str]:
    """Yields the difference between the mIoU of a network and that of another one, for all views and for each folder.

    Args:
        args: views and options; the resolution is that of the other network's weights.
        ours: results of the network, calibrated as its weights say.
        against: weights of the other network.

    Raises:
        ConfigError: the weights cannot be read, or the views are stored at a lower resolution than they need.
    """
    model, metadata = load_network(against)
    block_px, calibration = training_stages(metadata)[-1].block_px, Calibration.from_metadata(metadata)
    theirs = predict(args, model, block_px, calibration).calibrated
    yield f"mIoU over the goal categories minus that of '{against}', with 95 % intervals over houses:\n"
    yield f"all views: {ours.difference_text(theirs)}"
    if len(names := ours.folders()) > 1:
        yield from (f"{name}: {ours.difference_text(theirs, name)}" for name in names)


def predict(args: Args, model: RedNet, block_px: int, calibration: Calibration) -> Predictions:
    """Returns the predictions of a network on the views of the folders of `args`; each is computed once.

    Raises:
        ConfigError: views are stored at a lower resolution than the network needs.
    """
    seen = Predictions(np.zeros((CLASSES, CLASSES), np.int64))
    model.eval()
    for folder in args.views:
        shards = list_shards(folder)
        stored_px = stored_block_px(shards)
        parts = [spread_views(shards, args.count)] if args.count else (list(read_shard(shard)) for shard in shards)
        for part in parts:
            views = part
            if not args.slivers:
                views = [replace(view, semantic=without_slivers(view.semantic, stored_px)) for view in part]
            for view, logits, truth in _predicted(model, views, block_px, stored_px, args.mirror):
                _add_view(seen, folder.name, view, logits, truth, block_px, stored_px, calibration)
    return seen


def _predicted(
    model: RedNet, views: Sequence[LabelledView], block_px: int, stored_px: int, mirror: bool
) -> Iterator[tuple[LabelledView, Tensor, Tensor]]:
    """Yields each view with its logits (classes, h, w) and class channels (h, w), both padded."""
    batches = loader(model, views, block_px, stored_px)
    turned = (
        loader(model, [_mirrored(view) for view in views], block_px, stored_px) if mirror else itertools.repeat(None)
    )
    with torch.inference_mode():
        for number, ((rgb, second, target), other) in enumerate(zip(batches, turned, strict=False)):
            logits = model(rgb, second)
            if other is not None:
                logits = 0.5 * (logits + model(other[0], other[1]).flip(-1))
            yield from zip(views[number * BATCH :], logits, target, strict=False)


def _mirrored(view: LabelledView) -> LabelledView:
    """Returns the images of a view mirrored left to right."""
    return replace(
        view, rgb=view.rgb[:, ::-1].copy(), depth_m=view.depth_m[:, ::-1].copy(), semantic=view.semantic[:, ::-1].copy()
    )


def _add_view(
    seen: Predictions, folder: str, view: LabelledView, logits: Tensor, truth: Tensor, block_px: int, stored_px: int,
    calibration: Calibration,
) -> None:  # fmt: skip
    """Adds the prediction on one view: its logits (classes, h, w) and class channels (h, w), both padded."""
    predicted = logits.argmax(dim=0).numpy()
    seen.matrix += confusion(predicted, truth.numpy())
    calibrated = calibration.applied(logits).argmax(dim=0).numpy()
    seen.calibrated.add(folder, view.record["house"], confusion(calibrated, truth.numpy()))
    semantic = shrink(view.semantic, block_px // stored_px)
    rows, cols = padding(*semantic.shape).inner
    depth_m = shrink(view.depth_m, block_px // stored_px)
    seen.breakdown.add(calibrated[rows, cols], semantic, depth_m, block_px)
    some, kept = logits[:, 2::8, 2::8].permute(1, 2, 0).reshape(-1, CLASSES), truth[2::8, 2::8].reshape(-1)
    pair = some[kept >= 0].clone(), kept[kept >= 0].clone()  # a clone is not an inference tensor
    seen.samples.setdefault(view.record["house"], []).append(pair)
    seen.views += 1


def loader(model: RedNet, views: Sequence[LabelledView], block_px: int, stored_px: int) -> DataLoader:
    """Returns batches of views at the network's resolution.

    Raises:
        ConfigError: the views are stored at a lower resolution.
    """
    if block_px % stored_px:
        raise ConfigError(
            f"The network needs blocks of {block_px} pixels, but the views are stored in blocks of {stored_px}."
        )
    sampler = Sampler(CameraModel(), block_px // stored_px, NONE, second=model.config.second)
    return DataLoader(Samples(views, sampler), batch_size=BATCH)


def frame_ms(model: RedNet, block_px: int, *, mirrored: bool = False) -> float:
    """Returns the median time of one frame in milliseconds, from 640 x 480 images to scores."""
    segmenter = NetworkSegmenter(model, block_px=block_px, mirrored=mirrored)
    rng = np.random.default_rng(0)
    frame = {
        "rgb": rng.integers(0, 255, (480, 640, 3), np.uint8),
        "depth": rng.uniform(0.5, 5.0, (480, 640)).astype("f4"),
    }
    times_s = []
    for _ in range(TIMED_FRAMES):
        frame = {name: image.copy() for name, image in frame.items()}  # the result of the same arrays is kept
        start_s = time.perf_counter()
        segmenter.scores(frame, "chair")
        times_s.append(time.perf_counter() - start_s)
    return 1000.0 * float(np.median(times_s))
