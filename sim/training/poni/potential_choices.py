"""Measures how often predicted potentials choose the best frontier, against a random and the nearest one."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float, Int

from sim.training.poni.potential_files import Batch

TIE = 0.02
"""A frontier is as good as the best one if its true potential is less than this below."""


@dataclass
class Choices:
    """Sums over maps in which there is something to choose: two frontiers or more, of different potential."""

    count: int = 0
    hits: dict[str, float] = field(default_factory=lambda: dict.fromkeys(("predicted", "random", "nearest"), 0.0))
    """Number of maps in which the choice is the best one; for `random` its expectation."""
    gained: dict[str, float] = field(default_factory=lambda: dict.fromkeys(("predicted", "random", "nearest"), 0.0))
    """Sum of the true potentials of the choices."""
    most: float = 0.0
    """Sum of the true potentials of the best frontiers."""

    def add(self, true: Float[np.ndarray, " n"], predicted: Float[np.ndarray, " n"], path_m: Float[np.ndarray, " n"]):
        """Counts the choice among the frontiers of a map; nothing if all are equally good."""
        best = true >= true.max() - TIE
        if best.all():
            return
        self.count += 1
        self.most += float(true.max())
        for name, number in (("predicted", np.argmax(predicted)), ("nearest", np.argmin(path_m))):
            self.hits[name] += float(best[number])
            self.gained[name] += float(true[number])
        self.hits["random"] += float(best.mean())
        self.gained["random"] += float(true.mean())

    def shares(self) -> dict[str, float]:
        """Returns the share of best choices, and the potential of the choices as a share of the best ones."""
        shares = {f"{name}_best": value / max(self.count, 1) for name, value in self.hits.items()}
        return shares | {f"{name}_potential": value / max(self.most, 1e-9) for name, value in self.gained.items()}


def add_choices(batch: Batch, predicted: Float[np.ndarray, "m maps"], area: Choices, objects: Choices) -> None:
    """Counts the choices in the maps of a batch, by the area potential and by each object potential that counts.

    Args:
        batch: the samples.
        predicted: potentials at the batch's frontier cells.
        area: is changed.
        objects: is changed.
    """
    for sample in range(int(batch.sample.max(initial=-1)) + 1):
        cells = np.flatnonzero(batch.sample == sample)
        part = np.unique(batch.part[cells], return_inverse=True)[1]
        true, guess = (_highest(values[cells], part) for values in (batch.potentials, predicted))
        path_m = -_highest(-batch.path_m[cells, None], part)[:, 0]
        area.add(true[:, 0], guess[:, 0], path_m)
        for goal in np.flatnonzero(batch.counts[cells[0], 1:]) + 1:
            objects.add(true[:, goal], guess[:, goal], path_m)


def _highest(values: Float[np.ndarray, "m maps"], part: Int[np.ndarray, " m"]) -> Float[np.ndarray, "parts maps"]:
    """Returns the highest value of each frontier."""
    highest = np.full((int(part.max()) + 1, values.shape[1]), -np.inf)
    np.maximum.at(highest, part, values)
    return highest
