"""Habitat's interface for evaluation scripts and agents: the names that published code of ObjectNav uses.

`from sim.app.bridges import habitat` in place of `import habitat` is all that an evaluation loop needs: `habitat.Env`,
`habitat.Benchmark`, `habitat.Agent`, `habitat.get_config`. `sim.app.bridges.habitat.stand_in` provides the same names
as modules called `habitat`, so that published code runs unchanged; docs/habitat.md describes both.
"""

from sim.app.bridges.habitat.benchmark import Benchmark, Challenge
from sim.app.bridges.habitat.config import get_config
from sim.app.bridges.habitat.conversions import HabitatSimActions, Observations
from sim.app.bridges.habitat.env import Env
from sim.app.bridges.habitat.episodes import ObjectGoal, ObjectGoalNavEpisode
from sim.app.bridges.habitat.follower import ShortestPathFollower
from sim.app.bridges.habitat.rl_env import RLEnv
from sim.app.bridges.habitat_client import Agent, Config, read_write

__all__ = [
    "Agent",
    "Benchmark",
    "Challenge",
    "Config",
    "Env",
    "HabitatSimActions",
    "ObjectGoal",
    "ObjectGoalNavEpisode",
    "Observations",
    "RLEnv",
    "ShortestPathFollower",
    "get_config",
    "read_write",
]
