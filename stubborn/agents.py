"""Names to agents: each a composition of the same parts."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

from sim.interface import Agent, CameraModel, ConfigError, RobotModel, Segmenter
from stubborn.agent import AgentConfig, CollisionAvoidance, StubbornAgent
from stubborn.baselines.random import RandomAgent, RandomConfig
from stubborn.baselines.single_frame import single_frame_agent
from stubborn.exploration.corners import ExplorationConfig
from stubborn.exploration.frontier import FrontierConfig, FrontierExplorer
from stubborn.exploration.glance import GlanceConfig
from stubborn.planning.planner import Planner
from stubborn.target.verification import Verifier

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


def make(
    name: str,
    *,
    camera: CameraModel,
    robot: RobotModel,
    segmenter: Segmenter,
    verifier: Verifier | None = None,
    **options: Any,
) -> Agent:
    """Build an agent by name.

    Args:
        name: one of `NAMES`.
        camera: what the observations are taken with.
        robot: the body that is driven.
        segmenter: where scores come from.
        verifier: judges candidates where the agent verifies at all (`stubborn.target.verification`); None accepts all.
        options: fields of the agent's config (`stubborn.agent.AgentConfig`, `RandomConfig`), and `frontier`, a
            `FrontierConfig`, for the frontier agents.

    Raises:
        ConfigError: a name or an option that there is not.
    """
    if name not in _FACTORIES:
        near = difflib.get_close_matches(name, NAMES, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise ConfigError(f"No agent {name!r}.{hint} There is: {', '.join(NAMES)}.")
    return _FACTORIES[name](name, _Given(camera, robot, segmenter, verifier), options)


class _Given(NamedTuple):
    """What every agent is built from."""

    camera: CameraModel
    robot: RobotModel
    segmenter: Segmenter
    verifier: Verifier | None


def _stubborn(name: str, given: _Given, options: Mapping[str, Any]) -> StubbornAgent:
    config = AgentConfig(avoidance=ABLATION.get(name, CollisionAvoidance()))
    if name == "stubborn-plus":
        config = replace(config, **ADDITIONS)
    return StubbornAgent(**given._asdict(), config=_configured(config, name, options))


def _single_frame(name: str, given: _Given, options: Mapping[str, Any]) -> StubbornAgent:
    config = _configured(AgentConfig(), name, options)
    return single_frame_agent(camera=given.camera, robot=given.robot, segmenter=given.segmenter, config=config)


def _frontier(name: str, given: _Given, options: Mapping[str, Any]) -> StubbornAgent:
    """The Stubborn agent with another explorer; collision avoidance is that of the ablation's last or first row."""
    avoidance = ABLATION["stubborn-v" if name == "frontier-avoid" else "stubborn-i"]
    options = dict(options)
    frontier = options.pop("frontier", FrontierConfig())
    config = _configured(AgentConfig(avoidance=avoidance), name, options)
    avoidance = config.avoidance
    explorer = FrontierExplorer(
        frontier,
        Planner(config.planning, trust_visited=avoidance.visited_is_free),
        averse=avoidance.averse_exploration,
        bumps=avoidance.collision_layers,
    )
    return StubbornAgent(**given._asdict(), explorer=explorer, config=config)


def _random(name: str, given: _Given, options: Mapping[str, Any]) -> RandomAgent:
    return RandomAgent(_configured(RandomConfig(), name, options))


def _configured(config: C, name: str, options: Mapping[str, Any]) -> C:
    """The config with options put in."""
    known = [f.name for f in fields(config)]
    for option in options:
        if option not in known:
            raise ConfigError(f"Agent {name!r} has no option {option!r}. It has: {', '.join(known)}.")
    return replace(config, **options)


_FACTORIES: Mapping[str, Callable[[str, _Given, Mapping[str, Any]], Agent]] = MappingProxyType(
    {
        "stubborn": _stubborn,
        **dict.fromkeys(ABLATION, _stubborn),
        "stubborn-plus": _stubborn,
        "single-frame": _single_frame,
        "frontier": _frontier,
        "frontier-avoid": _frontier,
        "random": _random,
    }
)

NAMES: tuple[str, ...] = tuple(_FACTORIES)
"""All agents that `make` knows."""
