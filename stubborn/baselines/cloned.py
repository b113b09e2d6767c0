"""The end-to-end baseline: a small recurrent policy cloned from demonstrations, without map or planner.

It represents the agents that Luo et al. (2022, Table "leaderboard") compare with, which map images to actions by one
network: EEAux (Ye et al. 2021, arXiv:2104.04112) and Habitat-Web (Ramrakhya et al. 2022, arXiv:2204.03514). The
latter is cloned, as this one is; both are far larger. docs/explorers.md describes the training.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, Action, ConfigError, Observation, Segmenter
from stubborn.baselines.cloned_input import NO_ACTION, motion_of, small_categories, small_depth

if TYPE_CHECKING:
    from torch import Tensor

SHIPPED = Path(__file__).with_name("weights") / "cloned.safetensors"
"""The weights that ship with the package."""


@dataclass(frozen=True, kw_only=True)
class ClonedConfig:
    """Selects the weights, and how an action is taken from the policy."""

    weights: str | None = None
    """File of weights; None: the shipped weights."""
    sampled: bool = True
    """True: actions are sampled from the policy. False: the most probable action is taken, which often leads to endless
    turns left and right."""
    stop_above: float = 0.0
    """If this is more than 0, the agent stops exactly when the policy's probability of STOP is higher than this."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.stop_above < 1.0:
            raise ConfigError(f"ClonedConfig.stop_above must lie in [0, 1), got {self.stop_above}.")


class ClonedAgent:
    """Feeds each observation to the policy and takes one of its actions."""

    reads_posteriors = True
    """See `sim.core.interface.ReadsPosteriors`."""

    def __init__(self, config: ClonedConfig, segmenter: Segmenter) -> None:
        """Reads the weights.

        Raises:
            ConfigError: the file of weights does not exist, or holds another kind of network.
        """
        import torch  # takes a second

        from stubborn.baselines.cloned_net import FILES

        self.config = config
        self.segmenter = segmenter
        self._torch = torch
        self._net, _ = FILES.load(SHIPPED if config.weights is None else Path(config.weights))
        self.reset(GOAL_CATEGORIES[0], 0)

    def reset(self, goal: str, seed: int) -> None:
        """Starts a new episode with its own stream of random numbers."""
        self._goal = GOAL_CATEGORIES.index(goal)
        self._rng = np.random.default_rng(seed)
        self._state: Tensor | None = None
        self._pose: Pose | None = None
        self._before = NO_ACTION
        self._step = 0

    def overridden(self, action: Action) -> None:
        """See `sim.core.interface.Overridable`."""
        self._before = int(action)

    def act(self, observation: Observation) -> Action:
        """Returns the next action."""
        gps, compass = observation["gps"], observation["compass"]
        pose = Pose(float(gps[0]), float(gps[1]), float(compass[0]))
        tensor, torch = self._torch.from_numpy, self._torch
        with torch.inference_mode():
            logits, self._state = self._net(
                tensor(small_depth(observation["depth"]))[None, None],
                tensor(small_categories(self.segmenter.posteriors(observation)))[None, None],
                tensor(motion_of(pose, self._pose, self._step))[None, None],
                torch.tensor([[self._before]], dtype=torch.uint8),
                torch.tensor([self._goal]),
                self._state,
            )
        action = self._chosen(logits[0, 0].double().softmax(0).numpy())
        self._pose, self._before = pose, int(action)
        self._step += 1
        return action

    def _chosen(self, shares: np.ndarray) -> Action:
        """Returns an action, given the probability of each."""
        threshold = self.config.stop_above
        if threshold > 0.0:
            if shares[Action.STOP] > threshold:
                return Action.STOP
            shares = shares.copy()
            shares[Action.STOP] = 0.0
        if not self.config.sampled:
            return Action(int(np.argmax(shares)))
        return Action(int(self._rng.choice(len(shares), p=shares / shares.sum())))


def cloned_agent(*, config: ClonedConfig, segmenter: Segmenter, **parts: Any) -> ClonedAgent:
    """Returns the cloned policy; it does not use the other parts."""
    return ClonedAgent(config, segmenter)
