"""A dense reward for learning: progress to the goal, success, and a price of steps and of collisions."""

from __future__ import annotations

from typing import Any, SupportsFloat

import gymnasium
from gymnasium.core import ActType, ObsType

from sim.core.errors import ConfigError
from sim.core.geometry.numbers import is_number


class ProgressReward(gymnasium.Wrapper[ObsType, ActType, ObsType, ActType], gymnasium.utils.RecordConstructorArgs):
    """Replaces the sparse reward of `stubborn/ObjectNav-v0` by a dense one.

    The reward of an action is

        per_metre * (distance_to_goal before - after) + success * (STOP succeeded) - per_step - per_collision * collided

    `distance_to_goal` is the length in metres of the shortest path to the nearest place where a STOP succeeds. Its
    decreases add up to the same sum on every route, so that a detour is not rewarded. An action before or after which
    there is no path counts as no progress. `info` is unchanged: `success` and `spl` remain the measures of an agent.

    `gymnasium.make_vec(..., wrappers=[ProgressReward])` takes it as well.

    Args:
        env: the environment, or a wrapper around it that does not change `info`.
        per_metre: reward for each metre of progress.
        success: reward for a STOP that succeeds.
        per_step: price of an action.
        per_collision: price of an action whose motion a contact stopped.

    Raises:
        ConfigError: a weight is not a finite number.
    """

    def __init__(
        self,
        env: gymnasium.Env[ObsType, ActType],
        *,
        per_metre: float = 1.0,
        success: float = 2.5,
        per_step: float = 0.01,
        per_collision: float = 0.0,
    ) -> None:
        weights = {"per_metre": per_metre, "success": success, "per_step": per_step, "per_collision": per_collision}
        for name, value in weights.items():
            if not is_number(value):
                raise ConfigError(f"ProgressReward({name}=...) must be a finite number, got {value!r}.")
        gymnasium.utils.RecordConstructorArgs.__init__(
            self, per_metre=per_metre, success=success, per_step=per_step, per_collision=per_collision
        )
        gymnasium.Wrapper.__init__(self, env)
        self._per_metre, self._success = per_metre, success
        self._per_step, self._per_collision = per_step, per_collision
        self._distance_m: float | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, object] | None = None
    ) -> tuple[ObsType, dict[str, Any]]:
        """Starts an episode.

        Raises:
            ConfigError: the environment does not report `distance_to_goal`.
        """
        observation, info = super().reset(seed=seed, options=options)
        if "distance_to_goal" not in info:
            raise ConfigError(f"ProgressReward needs an environment whose info has 'distance_to_goal', not {self.env}.")
        self._distance_m = info["distance_to_goal"]
        return observation, info

    def step(self, action: ActType) -> tuple[ObsType, SupportsFloat, bool, bool, dict[str, Any]]:
        """Carries out one action and returns the dense reward in place of the sparse one."""
        observation, _, terminated, truncated, info = super().step(action)
        ended = info.get("ended_goal", info)  # of a chain: its next goal has another distance
        before_m, after_m = self._distance_m, ended["distance_to_goal"]
        self._distance_m = info["distance_to_goal"]
        progress_m = 0.0 if before_m is None or after_m is None else before_m - after_m
        reward = self._per_metre * progress_m + self._success * float(ended["success"])
        reward -= self._per_step + self._per_collision * float(info["collided"])
        return observation, reward, terminated, truncated, info
