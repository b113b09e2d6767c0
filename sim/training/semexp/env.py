"""The environment that trains the global policy of `semexp`, with the observations and actions of a real episode."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.core.interface import GOAL_CATEGORIES
from sim.homes.plans.plan import Plan
from sim.homes.plans.sight import SightConfig
from sim.training.plan_env.env import PlanEnv, PlanEnvConfig, require_reset
from stubborn.exploration.semexp import SemExpConfig, sigmoid
from stubborn.exploration.semexp_input import CELLS, GEOMETRY, HEADINGS, PolicyInput, observe
from stubborn.exploration.semexp_net import as_arrays

FAST = PlanEnvConfig(
    actions="goal",
    ends_at_sight=True,
    goal_steps=SemExpConfig().goal_steps,
    goal_radius_m=SemExpConfig().goal_radius_m,
    arrived_m=SemExpConfig().arrived_m,
    plan_every=8,
    plan_pool=2,
    sight=SightConfig(stride_px=8),
)
"""Every eighth pixel, plans on cells of 10 cm at every eighth step, end at first sight."""


@dataclass(frozen=True, kw_only=True)
class RewardConfig:
    """The reward of `SemExpEnv`."""

    per_metre: float = 0.1
    """Reward for each metre by which the path to the target became shorter, with the published weight."""
    per_m2: float = 0.02
    """Reward for each square metre that was never in view before, with the published weight."""
    per_step: float = -0.01
    """Reward for each primitive step, more than a step earns in new area (0.006 in val): without it, that reward would
    pay for not seeing the target, since an episode ends when it is seen."""
    rest_at_sight: bool = True
    """True: the step that sees the target is also given the rest of the path, which the agent then drives by itself."""


class SemExpEnv(PlanEnv):
    """The 2-D environment with the input, the goals and the reward of the global policy of `semexp`.

    ## Actions
    `Box(2)` in [-10, 10]: its sigmoid is a point of the local map, as shares of its rows and columns.

    ## Observations
    A dict of float32: `geometry` and `goals` (cells, cells), whole numbers with one layer per bit; `heading` (1,) and
    `goal` (1,), indices. They are those of `stubborn.exploration.semexp_input.PolicyInput`.

    ## Reward, end, info
    As `RewardConfig` says; the episode ends at first sight of the target or after `max_steps`. The rest is as in
    `PlanEnv`.

    Args:
        plans: plan files, or a folder of them.
        config: of the environment, with `actions="goal"`.
        cells: edge of the maps of the input.
        reward: the reward.
        read: see `PlanEnv`.

    Raises:
        ConfigError: no plan is given.
    """

    def __init__(
        self,
        plans: Path | Sequence[Path],
        config: PlanEnvConfig = FAST,
        *,
        cells: int = CELLS,
        reward: RewardConfig = RewardConfig(),
        read: Callable[[Path], Plan] | None = None,
    ) -> None:
        super().__init__(plans, config, read=read)
        self.cells, self.reward = cells, reward
        self.observation_space = spaces.Dict(
            {
                "geometry": spaces.Box(0, 4 ** len(GEOMETRY) - 1, (cells, cells), np.float32),
                "goals": spaces.Box(0, 2 ** len(GOAL_CATEGORIES) - 1, (cells, cells), np.float32),
                "heading": spaces.Box(0, HEADINGS - 1, (1,), np.float32),
                "goal": spaces.Box(0, len(GOAL_CATEGORIES) - 1, (1,), np.float32),
            }
        )
        self.action_space = spaces.Box(-10.0, 10.0, (2,), np.float32)
        self._given: PolicyInput | None = None

    def step(self, action: Any) -> tuple[dict[str, NDArray], float, bool, bool, dict[str, Any]]:
        """Drives towards a goal cell; see the class."""
        before_m2, before_steps = self.episode.camera.area_seen_m2, self.episode.num_steps
        observation, progress_m, terminated, truncated, info = super().step(action)
        rest_m = self.episode.distance_m()
        if terminated and self.reward.rest_at_sight and math.isfinite(rest_m):
            progress_m += rest_m
        shown_m2, steps = self.episode.camera.area_seen_m2 - before_m2, self.episode.num_steps - before_steps
        reward = self.reward.per_metre * progress_m + self.reward.per_m2 * shown_m2 + self.reward.per_step * steps
        return observation, reward, terminated, truncated, info

    @property
    def given(self) -> PolicyInput:
        """The last observation, as the policy gets it in an episode; raises ResetNeeded before the first episode."""
        return require_reset(self._given)

    def _act(self, action: Any) -> None:
        self._head_for(self.given.place_xy_m(sigmoid(np.asarray(action, np.float64).reshape(2))))

    def _observe(self) -> dict[str, NDArray]:
        goal = GOAL_CATEGORIES.index(self.episode.goal)
        self._given = policy_input = observe(self.navmap, self._pose, goal, cells=self.cells)
        return as_arrays(policy_input)
