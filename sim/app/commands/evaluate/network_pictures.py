"""Pictures of a model card: the confusion matrix and the curves of a training. Needs matplotlib (extra `train`)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Int64

from sim.core.interface import GOAL_CATEGORIES, MPCAT40_ID, ConfigError
from sim.training.figures import empty_figure
from sim.training.segmentation.evaluation import GOAL_CHANNELS
from sim.training.training_files import read_columns

BACKGROUND = ("wall", "floor", "ceiling", "door", "window", "mirror", "shelving", "appliances", "lighting")
"""Categories with columns of their own, in addition to the goals: objects are often confused with them."""
DPI = 110


def draw_confusion(matrix: Int64[np.ndarray, "classes classes"], file: Path) -> None:
    """Draws which category the pixels of each goal category get, in percent, as a PNG.

    Args:
        matrix: pixels by true (row) and predicted (column) class.
        file: where the picture is written.

    Raises:
        ConfigError: matplotlib is not installed.
    """
    figure = empty_figure(10.5, 7.2, what="The pictures of a card")
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
    figure = empty_figure(9.0, 3.4, what="The pictures of a card")
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
