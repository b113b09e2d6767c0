"""The lower bound of all baselines: random actions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.core.interface import Action, ConfigError, Observation


@dataclass(frozen=True, kw_only=True)
class RandomConfig:
    """The distribution of the actions."""

    stop_probability: float = 0.004
    """Probability of STOP at each step; the three moves share the rest. 0.004 stops after 250 steps on average."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.stop_probability <= 1.0:
            raise ConfigError(f"RandomConfig.stop_probability must lie in [0, 1], got {self.stop_probability}.")


class RandomAgent:
    """Samples each action independently of the observations."""

    def __init__(self, config: RandomConfig = RandomConfig()) -> None:
        self.config = config
        self.reset("", 0)

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode with its own stream of random numbers."""
        self._rng = np.random.default_rng(seed)

    def act(self, observation: Observation) -> Action:
        """Returns the next action."""
        move = (1.0 - self.config.stop_probability) / 3.0
        return Action(int(self._rng.choice(4, p=(self.config.stop_probability, move, move, move))))


def random_agent(*, config: RandomConfig, **parts: Any) -> RandomAgent:
    """Returns the random agent; it does not use the other parts."""
    return RandomAgent(config)
