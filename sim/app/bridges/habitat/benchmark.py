"""Provides `Benchmark` and `Challenge`, which evaluate agents as Habitat does."""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping, Sequence
from typing import Any

from sim.app.bridges.habitat.config import get_config
from sim.app.bridges.habitat.conversions import HabitatsAgent
from sim.app.bridges.habitat.env import Env, Metrics
from sim.core.errors import ConfigError

_LOG = logging.getLogger("habitat")
ConfigPaths = Mapping[str, object] | str | Sequence[str] | None


class Benchmark:
    """Evaluates agents over the episodes of an `Env`.

    Args:
        config_paths: argument of `get_config`, or a configuration that it returned.
        eval_remote: must be False: there is no server.
        options: further arguments of `Env`, such as `split` and `episodes`.
    """

    def __init__(self, config_paths: ConfigPaths = None, eval_remote: bool = False, **options: Any) -> None:
        if eval_remote:
            raise ConfigError("eval_remote must be False: there is no evaluation server.")
        self._env = Env(config_paths if isinstance(config_paths, Mapping) else get_config(config_paths), **options)

    def evaluate(self, agent: HabitatsAgent, num_episodes: int | None = None) -> dict[str, float]:
        """Runs the agent and returns the mean of each metric; `collisions` gives `collisions/count` and so on.

        Each call begins with the first episode, so that agents are compared on the same ones.

        Args:
            agent: an object with `reset()` and `act(observations)`.
            num_episodes: number of episodes; None: all.
        """
        env = self._env
        count = env.number_of_episodes if num_episodes is None else num_episodes
        if not 1 <= count <= env.number_of_episodes:
            raise ConfigError(f"num_episodes must be 1 to {env.number_of_episodes}, got {num_episodes}.")
        sums: dict[str, float] = {}
        env.rewind()
        for _ in range(count):
            observations = env.reset()
            agent.reset()
            while not env.episode_over:
                observations = env.step(agent.act(observations))
            for name, value in _flat(env.get_metrics()).items():
                sums[name] = sums.get(name, 0.0) + value
        return {name: total / count for name, total in sums.items()}


class Challenge(Benchmark):
    """Habitat's loop for challenges; the environment variable `CHALLENGE_CONFIG_FILE` names the configuration."""

    def __init__(self, eval_remote: bool = False, **options: Any) -> None:
        super().__init__(os.environ.get("CHALLENGE_CONFIG_FILE"), eval_remote, **options)

    def submit(self, agent: HabitatsAgent) -> dict[str, float]:
        """Evaluates the agent, logs the mean of each metric and returns the means."""
        means = self.evaluate(agent)
        for name, value in means.items():
            _LOG.info("%s: %s", name, value)
        return means


def _flat(metrics: Metrics) -> dict[str, float]:
    """Returns metrics without nesting: `collisions/count` for the entry `count` of `collisions`."""
    flat: dict[str, float] = {}
    for name, value in metrics.items():
        inner = {f"{name}/{key}": part for key, part in value.items()} if isinstance(value, dict) else {name: value}
        flat |= {key: float(number) for key, number in inner.items()}
    return flat
