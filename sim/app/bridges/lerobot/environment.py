"""The Gymnasium environment that LeRobot evaluates policies in; the package `lerobot_env_stubborn` registers it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sim.app.bridges.lerobot.features import (
    ACTION,
    FPS,
    STATE,
    VECTORS,
    action_of,
    goal_of,
    picture_of,
    require_one_text,
    state_of,
    task_of,
)
from sim.core.interface import MAX_STEPS
from sim.env.objectnav import ObjectNavEnv

Observation = dict[str, NDArray]


class LeRobotEnv(gymnasium.Env[Any, Any]):  # the observation is a dict of arrays, which `spaces.Dict` does not type
    """`ObjectNavEnv` with observations and actions as `features` has them.

    `pixels`, `agent_pos` and `environment_state` become `observation.image`, `observation.state` and
    `observation.environment_state`. `task` and `task_description` are the goal as text. `info["is_success"]` is
    whether a STOP has succeeded.

    Args:
        split: name of a split, or a folder laid out like one.
        goal: only episodes with this goal, a category or words; "": all.
        width_px: width of the pictures, that of the dataset.
        max_steps: actions of an episode.
        profile, noise: see `ObjectNavEnv`.
        render_mode: as `ObjectNavEnv`.

    Raises:
        ConfigError: see `ObjectNavEnv`, `features.picture_of` and `features.require_one_text`.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": FPS}  # noqa: RUF012 - declared by Gymnasium

    def __init__(
        self,
        *,
        split: str = "val",
        goal: str = "",
        width_px: int = 320,
        max_steps: int = MAX_STEPS,
        profile: str = "fast",
        noise: str = "none",
        render_mode: str | None = "rgb_array",
    ) -> None:
        self._env = ObjectNavEnv(
            split=split,
            goal=goal or None,
            max_steps=max_steps,
            profile=profile,
            noise=noise,
            sensors=("rgb",),
            render_mode=render_mode,
        )
        require_one_text(self._env.split.episodes)
        self._width_px, self._max_episode_steps = width_px, max_steps
        self.render_mode = render_mode
        camera = self._env.camera_model
        black = picture_of(np.zeros((camera.height_px, camera.width_px, 3), np.uint8), width_px)
        vectors = {
            name: spaces.Box(-np.inf, np.inf, (size,), np.float32)
            for name, size in (("agent_pos", len(VECTORS[STATE])), ("environment_state", len(goal_of(""))))
        }
        self.observation_space = spaces.Dict({"pixels": spaces.Box(0, 255, black.shape, np.uint8), **vectors})
        self.action_space = spaces.Box(-np.inf, np.inf, (len(VECTORS[ACTION]),), np.float32)
        self.task = self.task_description = ""
        self._picture: NDArray[np.uint8] | None = None

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, object] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Starts an episode; see `ObjectNavEnv.reset`."""
        super().reset(seed=seed)
        observation, info = self._env.reset(seed=seed, options=options)
        self._goal = self._env.episode.goal
        self.task = self.task_description = task_of(self._goal)
        return self._seen(observation), info | {"is_success": False}

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Carries out the action with the largest value.

        Raises:
            ConfigError: see `features.action_of`.
        """
        observation, reward, terminated, truncated, info = self._env.step(action_of(action))
        return self._seen(observation), reward, terminated, truncated, info | {"is_success": bool(reward)}

    def render(self) -> NDArray[np.uint8] | None:
        """Returns the picture of the robot's camera, (h, w, 3); None without `render_mode`."""
        if self.render_mode is None:
            return None
        if self._picture is None:
            raise gymnasium.error.ResetNeeded("Call reset() before the first picture.")
        return self._picture

    def close(self) -> None:
        """Frees the renderer."""
        self._env.close()

    def _seen(self, observation: Mapping[str, NDArray]) -> Observation:
        self._picture = picture_of(observation["rgb"], self._width_px)
        return {
            "pixels": self._picture,
            "agent_pos": state_of(observation),
            "environment_state": goal_of(self._goal),
        }
