"""The model card of a network: what it is, how it was trained, and what `stubborn evaluate` measured."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import msgspec
import numpy as np
from jaxtyping import Int64

from sim.core.files import write_atomically
from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, ConfigError
from sim.core.reading import convert
from sim.core.vocabulary import counted
from sim.training.figures import empty_figure
from sim.training.segmentation.breakdown import Breakdown
from sim.training.segmentation.evaluation import GOAL_CHANNELS, Confusions, Iou, Reliability
from sim.training.segmentation.options import Args
from sim.training.training_files import read_columns
from stubborn.segmentation.calibration import Calibration
from stubborn.segmentation.rednet import RedNet

ABOUT = """A RedNet ({parameters:,} parameters, {size_mb:.1f} MB) for images of {width} x {height} pixels and
the categories of mpcat40. Brackets hold the 95 % interval over houses. The calibration was evaluated on the half of the
houses to which it was not fitted. If the checkpoint was chosen by views of these houses as well, the mIoU is
optimistic."""
BACKGROUND = ("wall", "floor", "ceiling", "door", "window", "mirror", "shelving", "appliances", "lighting")
"""Categories with columns of their own, in addition to the goals: objects are often confused with them."""
DPI = 110


@dataclass(frozen=True)
class Evaluated:
    """The network that was evaluated."""

    file: Path
    model: RedNet
    metadata: Mapping[str, object]
    threads: int


class Training(msgspec.Struct):
    """The metadata of one training, as it is stored with the weights; foreign weights have none."""

    block_px: int = 1
    step: object = "?"
    hours: object = "?"
    code: str | None = None
    averaged: bool = False
    """True: the weights were averaged by hand."""
    options: dict[str, object] = {}
    started_from: Training | None = None


@dataclass(frozen=True)
class Measured:
    """The results of an evaluation."""

    iou: Iou
    """Results of the network's own logits."""
    calibrated: Confusions
    """Results of calibrated logits, as the agent uses them; the fields below are of these too, except for `matrix`."""
    matrix: Int64[np.ndarray, "classes classes"]
    """Confusion matrix, see `sim.training.segmentation.evaluation.confusion`."""
    breakdown: Breakdown
    views: int
    before: Reliability
    """Reliability without a calibration, on the houses to which the calibration was not fitted."""
    after: Reliability
    """Reliability with the network's calibration, on the same houses."""
    calibration: Calibration
    frame_ms: float


def write_card(file: Path, network: Evaluated, measured: Measured, trainings: Sequence[Path]) -> None:
    """Writes the model card and `<name>_confusion.png`; if `trainings` is not empty, also `<name>_curves.png`.

    Raises:
        ConfigError: matplotlib is not installed, or a folder holds no training.
    """
    confusion, curves = (file.with_name(f"{file.stem}_{name}.png") for name in ("confusion", "curves"))
    draw_confusion(measured.matrix, confusion)
    pictures = [f"![Confusion matrix]({confusion.name})"]
    if trainings:
        draw_curves(trainings, curves)
        pictures.append(f"![Curves of the training]({curves.name})")
    write_atomically(file, card_text(network, measured) + "\n" + "\n\n".join(pictures) + "\n")


def card_text(network: Evaluated, measured: Measured) -> str:
    """Returns the text of the model card, Markdown."""
    absent = [name for name in GOAL_CATEGORIES if name not in measured.iou.by_category]
    stages = training_stages(network.metadata)
    return "\n".join(
        [
            *_about(network, stages[-1].block_px),
            *_summary(network, measured, stages),
            *training_commands(stages),
            *_categories(measured),
            *([f"Not in these views: {', '.join(absent)}.", ""] if absent else []),
            *distances_and_sizes(measured.breakdown),
            *_reliability(measured),
        ]
    )


def _about(network: Evaluated, block_px: int) -> Iterable[str]:
    yield f"# {network.file.name}\n"
    yield ABOUT.format(
        parameters=sum(tensor.numel() for tensor in network.model.parameters()),
        size_mb=network.file.stat().st_size / 1e6,
        width=640 // block_px,
        height=480 // block_px,
    )
    yield ""


def _summary(network: Evaluated, measured: Measured, stages: Sequence[Training]) -> Iterable[str]:
    iou, own = Iou.of(measured.calibrated.of()), measured.iou
    yield "| | |\n|---|---|"
    yield f"| mIoU, goal categories present, calibrated as agents use it | {measured.calibrated.goals_text()} |"
    yield f"| mIoU, goal categories present, without calibration | {own.goals:.3f} |"
    yield from folder_lines(measured.calibrated)
    yield f"| mIoU, all categories present | {iou.everything:.3f} |"
    yield f"| pixel accuracy | {iou.accuracy:.3f} |"
    yield f"| pixel accuracy without calibration | {own.accuracy:.3f} |"
    yield f"| number of views | {measured.views} |"
    yield f"| time per frame, {counted(network.threads, 'thread')} | {measured.frame_ms:.0f} ms |"
    yield from (f"| training | {training_text(stage)} |" for stage in stages)
    yield f"| calibration error without calibration | {measured.before.error:.3f} |"
    yield f"| calibration error with calibration | {measured.after.error:.3f} |"
    yield ""


def folder_lines(confusions: Confusions) -> Iterator[str]:
    """Yields a line with the mIoU of each folder of views, Markdown, if there are several."""
    names = confusions.folders()
    yield from (f"| mIoU, views `{name}` | {confusions.goals_text(name)} |" for name in names if len(names) > 1)


def training_text(stage: Training) -> str:
    """Returns the length of a training, its code, and whether its weights were averaged."""
    phrases = [f"{stage.step} steps", f"{stage.hours} h", *([] if stage.code is None else [stage.code])]
    phrases += ["then averaged with the weights before it"] if stage.averaged else []
    return ", ".join(phrases)


def _categories(measured: Measured) -> Iterable[str]:
    recall, iou = measured.breakdown.found_by_category(), Iou.of(measured.calibrated.of())
    yield "An object is a connected region of a category in a view; it is found if half of its pixels are right.\n"
    yield "| category | IoU | IoU without calibration | objects | found |\n|---|--:|--:|--:|--:|"
    for name in GOAL_CATEGORIES:
        if name in measured.iou.by_category:
            count, share = recall.get(name, (0, float("nan")))
            calibrated, own = (of.by_category[name] for of in (iou, measured.iou))
            yield f"| {name} | {calibrated:.3f} | {own:.3f} | {count} | {100 * share:.0f} % |"
    yield ""


def distances_and_sizes(breakdown: Breakdown) -> Iterable[str]:
    """Yields tables of the results by distance and by the size of objects, Markdown."""
    yield "| distance | mIoU | pixel accuracy |\n|---|--:|--:|"
    for low, high, iou in breakdown.iou_by_distance():
        yield f"| {low:g} to {high:g} m | {iou.goals:.3f} | {iou.accuracy:.3f} |"
    yield "\nSize is the square root of an object's area in the image of 640 x 480 pixels.\n"
    yield "| size | objects | found |\n|---|--:|--:|"
    for low, high, count, share in breakdown.found_by_size():
        yield f"| {low} to {high} px | {count} | {100 * share:.0f} % |"
    yield ""


def _reliability(measured: Measured) -> Iterable[str]:
    yield "Share of correct pixels by the score of a goal category, before and after calibration:\n"
    yield "| mean score | share correct | pixels | mean score | share correct | pixels |\n|---|---|---|---|---|---|"
    for b, a in zip(measured.before.rows(), measured.after.rows(), strict=False):
        yield f"| {b[1]:.2f} | {b[2]:.2f} | {b[0]} | {a[1]:.2f} | {a[2]:.2f} | {a[0]} |"
    yield ""


def training_stages(metadata: Mapping[str, object]) -> list[Training]:
    """Returns the trainings that led to a network, the first one first.

    Raises:
        ConfigError: a field of the metadata has another type.
    """
    stages = [convert(metadata, Training, where="The metadata of the weights")]
    while (earlier := stages[0].started_from) is not None:
        stages.insert(0, earlier)
    return stages


def training_commands(stages: Sequence[Training]) -> Iterator[str]:
    """Yields the block with the command of each training, and a sentence if an option no longer exists."""
    yield "```sh"
    yield from map(_command, stages)
    yield "```\n"
    if {key for stage in stages for key in stage.options} - {option.name for option in fields(Args)}:
        yield "Options that `stubborn train segmentation --help` does not list are those of earlier versions.\n"


def _command(stage: Training) -> str:
    """Returns the command of one training."""
    options = (
        f"--{key.replace('_', '-')} {' '.join(map(str, value)) if isinstance(value, list) else value}"
        for key, value in stage.options.items()
        if value
    )
    return " ".join(["stubborn train segmentation", *options])


def draw_confusion(matrix: Int64[np.ndarray, "classes classes"], file: Path) -> None:
    """Draws which category the pixels of each goal category get, in percent, as a PNG.

    Args:
        matrix: pixels by true (row) and predicted (column) class.
        file: where the picture is written.

    Raises:
        ConfigError: matplotlib is not installed.
    """
    figure = empty_figure(10.5, 7.2)
    channels = [*GOAL_CHANNELS, *(MPCAT40_ID[name] - 1 for name in BACKGROUND)]
    goals = matrix[GOAL_CHANNELS].astype(np.float64)
    percent = 100.0 * goals / np.maximum(goals.sum(axis=1, keepdims=True), 1.0)
    shown = np.column_stack([percent[:, channels], 100.0 - percent[:, channels].sum(axis=1)])
    shown[goals.sum(axis=1) == 0] = np.nan
    axes = figure.add_subplot()
    axes.imshow(shown, cmap="Blues", vmin=0, vmax=100, aspect="auto")
    for (row, col), value in np.ndenumerate(shown):
        if value >= 1.5:
            colour = "white" if value > 55 else "black"
            axes.text(col, row, f"{value:.0f}", ha="center", va="center", fontsize=7, color=colour)
    columns = [*GOAL_CATEGORIES, *BACKGROUND, "others"]
    axes.set_xticks(range(len(columns)), columns, rotation=60, ha="right", fontsize=8)
    axes.set_yticks(range(len(GOAL_CATEGORIES)), GOAL_CATEGORIES, fontsize=8)
    axes.axvline(len(GOAL_CATEGORIES) - 0.5, color="grey", linewidth=0.8)
    axes.set_xlabel("predicted")
    axes.set_ylabel("true")
    axes.set_title("Share of each category's pixels that get a category, in percent", fontsize=10)
    figure.savefig(file, dpi=DPI)


def draw_curves(trainings: Sequence[Path], file: Path) -> None:
    """Draws loss and mIoU against the hours of some trainings, one after the other, as a PNG.

    Args:
        trainings: folders with train.csv and val.csv, as `stubborn train segmentation` writes them.
        file: where the picture is written.

    Raises:
        ConfigError: a folder holds no training, or matplotlib is not installed.
    """
    figure = empty_figure(9.0, 3.4)
    left, right = figure.subplots(1, 2)
    begin_h = 0.0
    for folder in trainings:
        losses, values = _column(folder / "train.csv", "loss"), _column(folder / "val.csv", "miou_goals")
        accuracy = _column(folder / "val.csv", "accuracy")
        left.plot(losses[:, 0] + begin_h, losses[:, 1], linewidth=0.8, color="tab:blue")
        right.plot(values[:, 0] + begin_h, values[:, 1], marker=".", color="tab:blue")
        right.plot(accuracy[:, 0] + begin_h, accuracy[:, 1], marker=".", color="tab:grey")
        begin_h += float(max(losses[-1, 0], values[-1, 0]))
    left.set_ylabel("training loss")
    right.set_ylim(0.0, 1.0)
    right.legend(["mIoU of the goal categories", "pixel accuracy"], fontsize=8)
    for axes in (left, right):
        axes.set_xlabel("hours")
        axes.grid(alpha=0.3)
    figure.savefig(file, dpi=DPI)


def _column(file: Path, name: str) -> np.ndarray:
    """Returns hours and one column of a file of curves, (n, 2).

    Raises:
        ConfigError: the file is missing or has no rows.
    """
    if not file.is_file():
        raise ConfigError(f"'{file.parent}' holds no training: {file.name} is missing.")
    columns = read_columns(file)
    if not {"hours", name} <= set(columns):
        raise ConfigError(f"'{file}' has no rows with 'hours' and '{name}'.")
    return np.array([columns["hours"], columns[name]]).T
