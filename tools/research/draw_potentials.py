"""Draws partial maps of plans with the true and the predicted potentials of their frontiers, side by side.

    python -m tools.research.draw_potentials --samples runs/poni/samples --out potentials.png

Each column is one map of a held-back plan: the share of the unexplored floor behind each frontier, true and predicted,
and how near the objects of one goal category are, that was not seen yet, true and predicted.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.app import cli
from sim.core.interface import GOAL_CATEGORIES, ConfigError
from sim.training.figures import empty_figure
from sim.training.poni.potential_files import Batch, SampleSet, held_back
from stubborn.exploration.patches import LAYERS
from stubborn.exploration.poni_net import FILES, SHIPPED, Predictor

COLOURS = {"unknown": (255, 255, 255), "seen": (224, 224, 224), "obstacle": (110, 110, 110), "trail": (150, 190, 255)}
LEAST_SPREAD = 0.3
"""A map is drawn when the object potential of some category differs by this much between its frontiers."""


@dataclass(frozen=True, kw_only=True)
class Args:
    """Draws true and predicted potentials."""

    samples: Path
    """Folder of samples (`stubborn train poni`)."""
    out: cli.OutFile
    """The picture, PNG."""
    weights: Path = SHIPPED
    """Weights of the network."""
    count: cli.Count = 6
    """Number of maps, of different plans."""
    seed: cli.Seed = 0
    """Seed of the choice of maps."""


def main(args: Args) -> int:
    """Draws the picture; returns the exit status."""
    files = [file for file in sorted(args.samples.glob("*.npz")) if held_back(file)]
    if not files:
        raise ConfigError(f"No samples of a held-back plan in '{args.samples}': `stubborn train poni` writes them.")
    predictor = Predictor(FILES.load(args.weights)[0])
    rng = np.random.default_rng(args.seed)
    maps = []
    for file in rng.permutation(np.array([str(file) for file in files])).tolist():
        maps += _interesting(SampleSet.read([Path(file)]), rng)
        if len(maps) == args.count:
            break
    if not maps:
        raise ConfigError(f"No map in '{args.samples}' has frontiers that differ enough.")
    draw(maps, predictor, args.out)
    return 0


def _interesting(samples: SampleSet, rng: np.random.Generator) -> list[tuple[Batch, int]]:
    """Returns one map of a plan and the goal category to draw; nothing when no map has frontiers that differ."""
    for number in rng.permutation(len(samples)).tolist():
        batch = samples.batch([number])
        spread = (batch.potentials.max(axis=0) - batch.potentials.min(axis=0)) * batch.counts[0]
        goals = np.flatnonzero(spread[1:] >= LEAST_SPREAD)
        if goals.size:
            return [(batch, int(rng.choice(goals)))]
    return []


def draw(maps: Sequence[tuple[Batch, int]], predictor: Predictor, out: Path) -> None:
    """Writes the picture.

    Args:
        maps: batches of one sample each, and a goal category for each.
        predictor: of the potentials.
        out: the file.
    """
    figure = empty_figure(1.75 * len(maps), 7.4, what="Maps of potentials")
    from matplotlib import colors

    axes = figure.subplots(4, len(maps), squeeze=False)
    dots, norm = None, colors.PowerNorm(0.5, 0.0, 1.0)  # most potentials are small
    for column, (batch, goal) in zip(axes.T, maps, strict=True):
        cells = batch.channels.shape[-1]
        rows, cols = np.divmod(batch.cell, cells)
        predicted = predictor.predict(batch.channels[0])[:, rows, cols]
        image, name = _image(batch.channels[0]), GOAL_CATEGORIES[goal].replace("_", " ")
        values = (batch.potentials[:, 0], predicted[0], batch.potentials[:, 1 + goal], predicted[1 + goal])
        titles = ("area, true", "area, predicted", f"{name}, true", f"{name}, predicted")
        limits = _limits(batch.channels[0, LAYERS.index("seen")])
        robot = np.argwhere(batch.channels[0, LAYERS.index("robot")])[0]
        for axis, value, title in zip(column, values, titles, strict=True):
            axis.imshow(image, origin="lower", interpolation="nearest")
            dots = axis.scatter(cols, rows, c=value, cmap="plasma", norm=norm, s=6, linewidths=0)
            axis.plot(robot[1], robot[0], marker="*", color="tab:green", markersize=8)
            axis.set_title(title, fontsize=8)
            axis.set(xlim=limits[1], ylim=limits[0], xticks=[], yticks=[])
    if dots is not None:
        bar = figure.colorbar(dots, ax=axes, fraction=0.012, pad=0.01, ticks=[0.0, 0.1, 0.25, 0.5, 1.0])
        bar.ax.tick_params(labelsize=7)
    out.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(out, dpi=72, format="png", bbox_inches="tight", pad_inches=0.05)


def _image(channels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Returns the map as an image (cells, cells, 3)."""
    image = np.full((*channels.shape[1:], 3), COLOURS["unknown"], np.uint8)
    for layer in ("seen", "obstacle", "trail"):
        image[channels[LAYERS.index(layer)] > 0] = COLOURS[layer]
    return image


def _limits(seen: NDArray[np.uint8]) -> tuple[tuple[float, float], tuple[float, float]]:
    """Returns the limits of rows and columns of a square around what was seen."""
    rows, cols = np.nonzero(seen)
    half = 0.5 * max(np.ptp(rows), np.ptp(cols)) + 3.0
    row, col = 0.5 * (rows.min() + rows.max()), 0.5 * (cols.min() + cols.max())
    return (row - half, row + half), (col - half, col + half)


if __name__ == "__main__":
    sys.exit(cli.run(Args, main))
