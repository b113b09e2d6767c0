"""The environment that trains the global policy of `semexp`, with the observations and actions of a real episode."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.interface import GOAL_CATEGORIES
from sim.plans.plan import Plan
from sim.plans.sight import SightConfig
from sim.twin.env import TwinConfig, TwinEnv, require_reset
from stubborn.exploration.semexp import SemExpConfig
from stubborn.exploration.semexp_input import GEOMETRY, PolicyInput, ViewConfig, observe

FAST = TwinConfig(
    actions="goal",
    ends_at_sight=True,
    goal_steps=SemExpConfig().goal_steps,
    goal_radius_m=SemExpConfig().goal_radius_m,
    arrived_m=SemExpConfig().arrived_m,
    plan_every=8,
    plan_pool=2,
    sight=SightConfig(stride_px=8),
)
"""The twin for training: every eighth pixel, plans on cells of 10 cm at every eighth step, end at first sight."""


@dataclass(frozen=True, kw_only=True)
class RewardConfig:
    """The reward of `SemExpEnv`."""

    per_metre: float = 0.1
    """Reward for each metre by which the path to the target became shorter."""
    per_m2: float = 0.05
    """Reward for each square metre of floor that was never in view before; the published code has such a term, too."""
    per_25_steps: float = -0.2
    """Reward for 25 primitive actions: about minus what a random policy gets for new floor meanwhile."""
    rest_at_sight: bool = True
    """True: the step that sees the target is also given the rest of the path, which the agent then drives by itself."""
    at_sight: float = 0.5
    """Reward for seeing the target."""


class SemExpEnv(TwinEnv):
    """The twin with the input, the goals and the reward of the global policy of `semexp`.

    ## Actions
    `Discrete(goal_cells ** 2)`: a cell of the grid of long-term goals, row by row.

    ## Observations
    A dict of float32: `near`, `far` (cells, cells) and `near_goals`, `far_goals` (goal_cells, goal_cells), whole
    numbers whose bits are layers; `heading` (2,); `goal` (1,), the index of the goal category. They are those of
    `stubborn.exploration.semexp_input.PolicyInput`. Only for the critic of a training: `truth` (3,), as
    `stubborn.exploration.semexp_net.TRUTH` says.

    ## Reward, end, info
    As `RewardConfig` says; the episode ends at first sight of the target or after `max_steps`. The rest is as in
    `TwinEnv`.

    Args:
        plans: plan files, or a folder of them.
        config: of the twin, with `actions="goal"`.
        view: sizes of the input.
        reward: the reward.
        read: see `TwinEnv`.

    Raises:
        ConfigError: there is no plan.
    """

    def __init__(
        self,
        plans: Path | Sequence[Path],
        config: TwinConfig = FAST,
        *,
        view: ViewConfig = ViewConfig(),  # noqa: B008 - frozen
        reward: RewardConfig = RewardConfig(),
        read: Callable[[Path], Plan] | None = None,
    ) -> None:
        super().__init__(plans, config, read=read)
        self.view, self.reward = view, reward
        cells, blocks = (view.cells,) * 2, (view.goal_cells,) * 2
        geometry = spaces.Box(0, 2 ** len(GEOMETRY) - 1, cells, np.float32)
        goals = spaces.Box(0, 2 ** len(GOAL_CATEGORIES) - 1, blocks, np.float32)
        self.observation_space = spaces.Dict(
            {
                **{"near": geometry, "near_goals": goals, "far": geometry, "far_goals": goals},
                "heading": spaces.Box(-1.0, 1.0, (2,), np.float32),
                "goal": spaces.Box(0, len(GOAL_CATEGORIES) - 1, (1,), np.float32),
                "truth": spaces.Box(0.0, np.inf, (3,), np.float32),
            }
        )
        self.action_space = spaces.Discrete(view.goal_cells**2)
        self._given: PolicyInput | None = None
        self._floor_m2 = 0.0
        """Area of the plan's floor; 0 until it is known."""

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, NDArray], dict[str, Any]]:
        """Starts an episode; see `TwinEnv`."""
        self._floor_m2 = 0.0
        observation, info = super().reset(seed=seed, options=options)
        plan = self.episode.plan
        self._floor_m2 = float(np.count_nonzero(plan.floor)) * plan.frame.cell_m**2
        return {**observation, "truth": self._truth()}, info

    def step(self, action: Any) -> tuple[dict[str, NDArray], float, bool, bool, dict[str, Any]]:
        """Drives towards a goal cell; see the class."""
        before_m2, before_steps = self.episode.camera.area_seen_m2, self.episode.num_steps
        observation, progress_m, terminated, truncated, info = super().step(action)
        rest_m = self.episode.distance_m()
        if terminated and self.reward.rest_at_sight and math.isfinite(rest_m):
            progress_m += rest_m
        shown_m2 = self.episode.camera.area_seen_m2 - before_m2
        spent = (self.episode.num_steps - before_steps) / 25.0
        reward = self.reward.per_metre * progress_m + self.reward.per_m2 * shown_m2 + self.reward.per_25_steps * spent
        reward += self.reward.at_sight * terminated
        return observation, reward, terminated, truncated, info

    @property
    def given(self) -> PolicyInput:
        """The last observation, as the policy gets it in an episode; raises ResetNeeded before the first episode."""
        return require_reset(self._given)

    def _act(self, action: Any) -> None:
        self._head_for(self.given.place_xy_m(int(action)))

    def _observe(self) -> dict[str, NDArray]:
        self._given = given = observe(self.navmap, self._pose, self.episode.goal, self.view)
        return {
            "near": given.near.geometry.astype(np.float32),
            "near_goals": given.near.goals.astype(np.float32),
            "far": given.far.geometry.astype(np.float32),
            "far_goals": given.far.goals.astype(np.float32),
            "heading": given.heading,
            "goal": np.array([given.goal], np.float32),
            "truth": self._truth(),
        }

    def _truth(self) -> NDArray[np.float32]:
        episode = self.episode
        path_m = episode.distance_m()
        unseen_m2 = max(self._floor_m2, episode.camera.area_seen_m2) - episode.camera.area_seen_m2
        left = 1.0 - episode.num_steps / episode.max_steps
        return np.array(
            [path_m / 10.0 if math.isfinite(path_m) else 0.0, math.log1p(unseen_m2 / 20.0), left], np.float32
        )
