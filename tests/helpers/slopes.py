"""A predictor of potentials with known answers."""

from __future__ import annotations

import numpy as np

from sim.core.interface import GOAL_CATEGORIES
from stubborn.exploration.poni_net import MAPS, Predictor

BED = GOAL_CATEGORIES.index("bed")


class Slopes(Predictor):
    """Predicts potentials that rise evenly across the patch: the area to the west, the bed to the east."""

    cells, pool = 64, 4

    def __init__(self) -> None:
        self.shown: list[np.ndarray] = []

    def predict(self, channels: np.ndarray) -> np.ndarray:
        self.shown.append(channels.copy())
        maps = np.zeros((MAPS, self.cells, self.cells), np.float32)
        maps[0] = np.linspace(1.0, 0.0, self.cells)
        maps[1 + BED] = np.linspace(0.0, 1.0, self.cells)
        return maps
