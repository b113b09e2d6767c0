"""Evaluates a user's segmentation or a server of detectors on labelled views, and fits the calibration of a server.

Results are intersection over union, objects found, and time per frame.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float32, Int64
from torch import Tensor

from sim.app.commands.evaluate.network_card import distances_and_sizes, folder_lines
from sim.app.composition.own_segmentation import OwnSegmenter, built, load_specification
from sim.app.services.client import is_address
from sim.app.services.remote import HttpConfig, HttpSegmenter
from sim.core.configuration import parse_assignments, with_fields
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, CameraModel, ConfigError, Observation
from sim.training.segmentation.breakdown import Breakdown
from sim.training.segmentation.dataset import LabelledView, list_shards, read_shard, spread_views, stored_block_px
from sim.training.segmentation.evaluation import Confusions, Iou, confusion
from stubborn.segmentation.calibration import Calibration, fit_calibration
from stubborn.segmentation.preprocess import shrink

NO_GOAL = MPCAT40_ID["misc"] - 1
"""Channel of the pixels in which a segmenter that has only `scores` finds no goal category."""

GRID_PX = 4
"""Edge of the square of pixels of the 640 x 480 image that counts as one, as for the shipped network: the results can
be compared."""


LogitSamples = dict[str, list[tuple[Tensor, Tensor]]]
"""Logits (k, classes) and true class channels (k,) to which a calibration is fitted, by house."""


@dataclass(frozen=True)
class _Settings:
    """The fields that `--config` sets: `detector.FIELD`."""

    detector: object


@dataclass
class OwnMeasured:
    """The results of a user's segmentation."""

    name: str
    confusions: Confusions = field(default_factory=Confusions)
    breakdown: Breakdown = field(default_factory=Breakdown)
    frames_ms: list[float] = field(default_factory=list)
    """Time of each frame, milliseconds."""
    samples: LogitSamples = field(default_factory=dict)
    """Of a server: what a calibration is fitted to; see `HttpSegmenter.samples`."""


def measure_own(name: str, folders: Sequence[Path], *, count: int, config: Sequence[str]) -> OwnMeasured:
    """Returns the results of a user's segmentation on the views of some folders.

    Args:
        name: `package.module:NAME` or the address of a server, as in `--semantics` of a run.
        folders: folders with shards of views.
        count: number of views of each folder; 0: all.
        config: `detector.FIELD=VALUE` for its configuration.

    Raises:
        ConfigError: the segmentation reads sensors that views do not have or cannot be built, or there are no such
            views or fields.
        AgentError: the user's code or the server failed on a view, or returned another type, shape or range.
    """
    measured, segmenter = OwnMeasured(name), None
    shape: tuple[int, ...] = ()
    for folder in folders:
        shards = list_shards(folder)
        block_px = stored_block_px(shards)
        views = spread_views(shards, count) if count else (view for shard in shards for view in read_shard(shard))
        for view in views:
            if segmenter is None or view.semantic.shape != shape:
                shape = view.semantic.shape
                camera = CameraModel(width_px=shape[1], height_px=shape[0])
                segmenter = segmenter_for(name, camera, parse_assignments(config))
            _add_view(measured, segmenter, folder.name, view, block_px)
            if isinstance(segmenter.inner, HttpSegmenter):
                observation, channels = {"rgb": view.rgb, "depth": view.depth_m}, view.semantic.astype(np.int64) - 1
                logits, truth = map(torch.from_numpy, segmenter.inner.samples(observation, channels))
                measured.samples.setdefault(view.record["house"], []).append((logits, truth))
    return measured


def segmenter_for(name: str, camera: CameraModel, settings: Mapping[str, object]) -> OwnSegmenter:
    """Returns a user's segmenter for images without an environment.

    Args:
        name: `package.module:NAME`, or the address of a server.
        camera: of the images.
        settings: values of `detector.FIELD`.

    Raises:
        ConfigError: it reads other sensors than rgb and depth, cannot be built, or has no such field.
    """
    if is_address(name):
        config = with_fields(_Settings(HttpConfig(url=name)), settings).detector
        assert isinstance(config, HttpConfig)
        return OwnSegmenter(name, HttpSegmenter(camera, config), HttpSegmenter.spec, camera)
    own = load_specification(name)
    sensors = [sensor if isinstance(sensor, str) else sensor.name for sensor in own.spec.sensors]
    missing = [*own.spec.truth, *(sensor for sensor in sensors if sensor not in ("rgb", "depth"))]
    if missing:
        raise ConfigError(f"--semantics '{name}' reads '{missing[0]}', and stored views have rgb and depth only.")
    return built(name, own, camera=camera, config=with_fields(_Settings(own.config), settings).detector)


def _add_view(measured: OwnMeasured, segmenter: OwnSegmenter, folder: str, view: LabelledView, block_px: int) -> None:
    began_s = time.perf_counter()
    channels = _channels(segmenter, {"rgb": view.rgb, "depth": view.depth_m})
    measured.frames_ms.append(1000.0 * (time.perf_counter() - began_s))
    fraction = view.semantic.shape[0] // channels.shape[0]
    whole = channels.repeat(fraction, axis=0).repeat(fraction, axis=1).astype(np.uint8)
    coarser = max(1, GRID_PX // block_px)
    predicted, truth, depth_m = (shrink(image, coarser) for image in (whole, view.semantic, view.depth_m))
    matrix = confusion(predicted.astype(np.int64), truth.astype(np.int64) - 1)
    measured.confusions.add(folder, view.record["house"], matrix)
    measured.breakdown.add(predicted.astype(np.int64), truth, depth_m, block_px * coarser)


def fitted_calibration(measured: OwnMeasured) -> tuple[Calibration, float, float]:
    """Returns the calibration of a server by every second house, and the log loss on the others without and with it.

    Raises:
        ConfigError: fewer than two houses have samples.
    """
    houses = sorted(house for house, parts in measured.samples.items() if any(len(truth) for _, truth in parts))
    if len(houses) < 2:
        raise ConfigError("A calibration needs views of two houses in which the server reports something.")
    calibration = fit_calibration(*joined(measured.samples, houses[::2]))
    logits, truth = joined(measured.samples, houses[1::2])
    losses = (
        torch.nn.functional.cross_entropy(scores, truth)
        for scores in (logits, logits * calibration.scale + calibration.offset)
    )
    before, after = (float(loss) for loss in losses)
    return calibration, before, after


def joined(samples: LogitSamples, houses: Sequence[str]) -> tuple[Tensor, Tensor]:
    """Returns the logits (k, classes) and the class channels (k,) of some houses."""
    parts = [part for house in houses for part in samples[house]]
    return torch.cat([logits for logits, _ in parts]), torch.cat([truth for _, truth in parts])


def _channels(segmenter: OwnSegmenter, observation: Observation) -> Int64[np.ndarray, "h w"]:
    """Returns the most probable class channel (mpcat40 id - 1) of each pixel, at the resolution of the segmenter."""
    named = segmenter.categories(observation) if segmenter.names else None
    if named is not None:
        return np.where(named == 0, NO_GOAL + 1, named).astype(np.int64) - 1
    best: Float32[np.ndarray, "h w"] | None = None
    channels = np.array(NO_GOAL)
    for goal in GOAL_CATEGORIES:
        target, best_other = segmenter.scores(observation, goal)
        if best is None:
            best, channels = np.zeros(target.shape, np.float32), np.full(target.shape, NO_GOAL)
        chosen = (target > best) & (target >= best_other)
        best, channels = np.where(chosen, target, best), np.where(chosen, MPCAT40_ID[goal] - 1, channels)
    return channels


def own_text(measured: OwnMeasured) -> str:
    """Returns the results as Markdown."""
    return "\n".join(_lines(measured))


def _lines(measured: OwnMeasured) -> Iterator[str]:
    iou, recall = Iou.of(measured.confusions.of()), measured.breakdown.found_by_category()
    yield f"# {measured.name}\n\n| | |\n|---|---|"
    yield f"| mIoU, goal categories present | {measured.confusions.goals_text()} |"
    yield from folder_lines(measured.confusions)
    yield f"| pixel accuracy | {iou.accuracy:.3f} |"
    yield f"| number of views | {len(measured.frames_ms)} |"
    yield f"| time per frame | {float(np.median(measured.frames_ms)):.0f} ms |\n"
    yield "| category | IoU | objects | found |\n|---|--:|--:|--:|"
    for name in GOAL_CATEGORIES:
        if name in iou.by_category:
            count, share = recall.get(name, (0, float("nan")))
            yield f"| {name} | {iou.by_category[name]:.3f} | {count} | {100 * share:.0f} % |"
    yield ""
    yield from distances_and_sizes(measured.breakdown)
