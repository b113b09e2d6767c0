"""Predicted potentials of the frontiers, for the explorers that choose or order frontiers by them.

Reference: Ramakrishnan et al. (2022), "PONI: Potential Functions for ObjectGoal Navigation with Interaction-free
Learning", CVPR, arXiv:2201.10029. A network (`stubborn.exploration.poni_net`) predicts two potentials at each frontier
of a partial semantic map: the share of the unexplored floor that the frontier leads to, and, for each goal category,
the nearness of its objects. It was trained on house plans alone (`stubborn train poni`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import Bool, Float32

from sim.core.geometry.grid import GridFrame
from sim.core.interface import GOAL_CATEGORIES, ConfigError
from stubborn.exploration.explorer import Ground
from stubborn.exploration.patches import patch_around

if TYPE_CHECKING:
    from stubborn.exploration.poni_net import Predictor

GoalKind = Literal["true", "wrong"]
SemanticsKind = Literal["seen", "shuffled", "none"]


@dataclass(frozen=True, kw_only=True)
class PotentialConfig:
    """The network, the weights of its two potentials, and the controls."""

    weights: str | None = None
    """File of the network's weights (`stubborn train poni`); None: the shipped weights."""
    alpha: float = 0.5
    """Weight of the area potential; the object potential of the goal has the weight 1 - `alpha`."""
    goal: GoalKind = "true"
    """Category of the object potential; `wrong`: another category, sampled for each episode, as a control."""
    semantics: SemanticsKind = "seen"
    """Goal categories on the map: as seen or, as controls, in a wrong order that is sampled for each episode, or left
    out."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.alpha <= 1.0:
            raise ConfigError(f"{type(self).__name__}.alpha must lie in [0, 1], got {self.alpha}.")

    def predictor(self) -> Predictor:
        """Returns the network.

        Raises:
            ConfigError: the weights do not exist or are of another network.
        """
        from stubborn.exploration.poni_net import shared_predictor  # PyTorch takes seconds to import

        return shared_predictor(self.weights)


class Potentials:
    """The weighted potentials of the frontiers of a map."""

    def __init__(self, config: PotentialConfig, predictor: Predictor) -> None:
        self.config = config
        self.predictor = predictor
        self.reset()

    def reset(self, seed: int = 0) -> None:
        """Samples the controls of an episode."""
        rng = np.random.default_rng(seed)
        self._order: list[int] = rng.permutation(len(GOAL_CATEGORIES)).tolist()
        self._other = int(rng.integers(1, len(GOAL_CATEGORIES)))

    def of(
        self, ground: Ground, frame: GridFrame, cells: Bool[np.ndarray, "rows cols"]
    ) -> Float32[np.ndarray, "rows cols"]:
        """Returns the weighted sum of the potentials, in [0, 1], at some cells of a part of the map; -inf elsewhere.

        Args:
            ground: map, pose and goal at this step.
            frame: the grid of the part of the map.
            cells: frontiers in it. Outside the network's patch the potential is 0.
        """
        config, predictor = self.config, self.predictor
        patch = patch_around(ground.navmap, ground.pose, cells=predictor.cells, pool=predictor.pool)
        channels = patch.channels(self._order if config.semantics == "shuffled" else None)
        if config.semantics == "none":
            channels[-len(GOAL_CATEGORIES) :] = 0
        goal = GOAL_CATEGORIES.index(ground.goal)
        if config.goal == "wrong":
            goal = (goal + self._other) % len(GOAL_CATEGORIES)
        predicted = predictor.predict(channels)
        potential = np.float32(config.alpha) * predicted[0] + np.float32(1.0 - config.alpha) * predicted[1 + goal]
        score = np.full(frame.shape, -np.inf, np.float32)
        rows, cols = np.nonzero(cells)
        at = patch.frame.cells(*frame.centres(rows, cols))
        inside = patch.frame.contains(*at)
        score[rows, cols] = 0.0
        score[rows[inside], cols[inside]] = potential[at[0][inside], at[1][inside]]
        return score
