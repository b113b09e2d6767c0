"""The floor under all baselines: actions drawn at random."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.interface import Action, ConfigError, Observation


@dataclass(frozen=True, kw_only=True)
class RandomConfig:
    """How the dice are loaded."""

    stop_probability: float = 0.004
    """Of STOP at each step; the three moves share the rest. 0.004 stops after 250 steps on average."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.stop_probability <= 1.0:
            raise ConfigError(f"RandomConfig.stop_probability must lie in [0, 1], got {self.stop_probability}.")


class RandomAgent:
    """Draws each action independently; knows nothing."""

    def __init__(self, config: RandomConfig = RandomConfig()) -> None:
        self.config = config
        self.reset("", 0)

    def reset(self, goal: str, seed: int) -> None:
        """Start a new episode with its own stream of random numbers."""
        self._rng = np.random.default_rng(seed)

    def act(self, observation: Observation) -> Action:
        """The next action, whatever is seen."""
        move = (1.0 - self.config.stop_probability) / 3.0
        return Action(int(self._rng.choice(4, p=(self.config.stop_probability, move, move, move))))
