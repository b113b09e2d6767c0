"""Habitat's base class of environments with rewards, which published training and evaluation code extends."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sim.app.bridges.habitat.config import Config
from sim.app.bridges.habitat.conversions import Observations
from sim.app.bridges.habitat.env import Env
from sim.app.bridges.habitat.episodes import ObjectGoalNavEpisode


class RLEnv:
    """An `Env` whose `step` also returns a reward, whether the episode is over, and further values.

    A subclass defines `get_reward_range`, `get_reward`, `get_done` and `get_info`, and may read the `Env` as `_env`.

    Args:
        config, dataset, options: arguments of `Env`.
    """

    def __init__(self, config: Mapping[str, object] | None = None, dataset: None = None, **options: Any) -> None:
        self._env = Env(config, dataset, **options)
        self.action_space = self._env.action_space
        self.observation_space = self._env.observation_space
        self.number_of_episodes = self._env.number_of_episodes

    @property
    def habitat_env(self) -> Env:
        """The environment without rewards."""
        return self._env

    @property
    def config(self) -> Mapping[str, object] | Config:
        """The configuration."""
        return self._env.config

    @property
    def episodes(self) -> list[ObjectGoalNavEpisode]:
        """The episodes, in their order."""
        return self._env.episodes

    @property
    def current_episode(self) -> ObjectGoalNavEpisode:
        """The running episode."""
        return self._env.current_episode

    def reset(self) -> Observations:
        """Starts the next episode and returns its observations."""
        return self._env.reset()

    def step(self, *arguments: object, **named: object) -> tuple[Observations, object, bool, Any]:
        """Carries out an action (see `Env.step`) and returns observations, reward, end and further values."""
        observations = self._env.step(*arguments, **named)
        return observations, self.get_reward(observations), self.get_done(observations), self.get_info(observations)

    def get_reward_range(self) -> object:
        """Returns the smallest and the largest reward."""
        raise NotImplementedError

    def get_reward(self, observations: Observations) -> object:
        """Returns the reward of the last action."""
        raise NotImplementedError

    def get_done(self, observations: Observations) -> bool:
        """Returns whether the episode is over."""
        raise NotImplementedError

    def get_info(self, observations: Observations) -> Any:
        """Returns further values of the step."""
        raise NotImplementedError

    def seed(self, seed: int | None = None) -> None:
        """Sets the seed of sensor noise from the next `reset` on."""
        self._env.seed(seed or 0)

    def close(self) -> None:
        """Frees the renderers; the environment cannot be used any more."""
        self._env.close()

    def __enter__(self) -> RLEnv:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
