"""Names to agents: each a composition of the same parts."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from types import MappingProxyType
from typing import Any, TypeVar

from sim.interface import Agent, CameraModel, ConfigError, RobotModel, Segmenter
from stubborn.agent import AgentConfig, CollisionAvoidance, StubbornAgent
from stubborn.baselines.random import RandomAgent, RandomConfig
from stubborn.exploration import ExplorationConfig
from stubborn.glance import GlanceConfig
from stubborn.target import Verifier

Factory = Callable[..., Agent]
C = TypeVar("C", AgentConfig, RandomConfig)

ABLATION: Mapping[str, CollisionAvoidance] = MappingProxyType(
    {
        "stubborn-i": CollisionAvoidance(
            untrap=False, collision_layers=False, averse_exploration=False, visited_is_free=False
        ),
        "stubborn-ii": CollisionAvoidance(collision_layers=False, averse_exploration=False, visited_is_free=False),
        "stubborn-iii": CollisionAvoidance(averse_exploration=False, visited_is_free=False),
        "stubborn-iv": CollisionAvoidance(visited_is_free=False),
        "stubborn-v": CollisionAvoidance(),
    }
)
"""The rows of the paper's ablation table; v is the full agent."""

ADDITIONS: Mapping[str, Any] = MappingProxyType(
    {
        "exploration": ExplorationConfig(
            look_around_turns=11, unseen_area_m2=(0.25, 0.05), unvisited_m=(1.5, 1.0, 0.6)
        ),
        "glance": GlanceConfig(gain_per_turn_m2=0.75),
    }
)
"""What `stubborn-plus` does that the paper's agent does not: it looks around and aside, and goes where it never was."""


def make(name: str, *, camera: CameraModel, robot: RobotModel, segmenter: Segmenter, **options: Any) -> Agent:
    """Build an agent by name.

    Options are the fields of the agent's config (`stubborn.agent.AgentConfig`, `RandomConfig`), and `verifier` for the
    agents that verify. Raises `ConfigError` for a name or an option that there is not.
    """
    if name not in _FACTORIES:
        near = difflib.get_close_matches(name, NAMES, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise ConfigError(f"No agent {name!r}.{hint} There is: {', '.join(NAMES)}.")
    return _FACTORIES[name](name, camera=camera, robot=robot, segmenter=segmenter, **options)


def _stubborn(
    name: str,
    *,
    camera: CameraModel,
    robot: RobotModel,
    segmenter: Segmenter,
    verifier: Verifier | None = None,
    **options: Any,
) -> StubbornAgent:
    config = AgentConfig(avoidance=ABLATION.get(name, CollisionAvoidance()))
    if name == "stubborn-plus":
        config = replace(config, **ADDITIONS)
    config = _configured(config, name, options)
    return StubbornAgent(camera=camera, robot=robot, segmenter=segmenter, verifier=verifier, config=config)


def _random(name: str, *, camera: CameraModel, robot: RobotModel, segmenter: Segmenter, **options: Any) -> RandomAgent:
    return RandomAgent(_configured(RandomConfig(), name, options))


def _configured(config: C, name: str, options: Mapping[str, Any]) -> C:
    """The config with options put in."""
    known = [f.name for f in fields(config)]
    for option in options:
        if option not in known:
            raise ConfigError(f"Agent {name!r} has no option {option!r}. It has: {', '.join(known)}.")
    return replace(config, **options)


_FACTORIES: Mapping[str, Factory] = MappingProxyType(
    {
        "stubborn": _stubborn,
        **dict.fromkeys(ABLATION, _stubborn),
        "stubborn-plus": _stubborn,
        "random": _random,
    }
)

NAMES: tuple[str, ...] = tuple(_FACTORIES)
"""All agents that `make` knows."""
