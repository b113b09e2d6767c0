"""Agents by name: each is a composition of the same parts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from types import MappingProxyType
from typing import Any

from sim.core.errors import did_you_mean
from sim.core.interface import MAX_STEPS, Agent, AgentSpec, CameraModel, ConfigError, RobotModel, Segmenter, SuccessRule
from stubborn.agent import AgentConfig, CollisionAvoidance, StubbornAgent
from stubborn.baselines.cloned import ClonedConfig, cloned_agent
from stubborn.baselines.random import RandomConfig, random_agent
from stubborn.detection.seeker import TargetSeekerConfig
from stubborn.detection.track_seeker import TrackSeekerConfig
from stubborn.detection.verification import Verifier
from stubborn.drawing.map_painter import make_painter
from stubborn.exploration.corners import CornerConfig
from stubborn.exploration.explorer import ExplorerConfig
from stubborn.exploration.frontier import FrontierConfig
from stubborn.exploration.poni import PoniConfig
from stubborn.exploration.semexp import SemExpConfig
from stubborn.exploration.tour import INFORMED_TOUR, TourConfig
from stubborn.mapping.felt import FeelConfig
from stubborn.mapping.object_layers import ObjectLayersConfig
from stubborn.planning.untrap import UntrapConfig

NO_AVOIDANCE = CollisionAvoidance(
    untrap=False, collision_layers=False, averse_exploration=False, optimistic_fallback=False, visited_is_free=False
)
"""The configuration without the paper's measures against collisions."""

ABLATION: Mapping[str, CollisionAvoidance] = MappingProxyType(
    {
        "stubborn-i": NO_AVOIDANCE,
        "stubborn-ii": replace(NO_AVOIDANCE, untrap=True),
        "stubborn-iii": replace(NO_AVOIDANCE, untrap=True, collision_layers=True),
        "stubborn-iv": CollisionAvoidance(optimistic_fallback=False, visited_is_free=False),
        "stubborn-v": CollisionAvoidance(),
    }
)
"""The rows of the paper's ablation table; v is the full agent."""
_ROW_WORDS: Mapping[str, str] = MappingProxyType(
    {
        "stubborn-i": "no measure against collisions",
        "stubborn-ii": "untrap moves only",
        "stubborn-iii": "untrap moves, and collisions in the map",
        "stubborn-iv": ("as v, without the optimistic map and free visited ground"),
        "stubborn-v": "all measures; the same as stubborn",
    }
)

EXPLORERS: Mapping[str, ExplorerConfig] = MappingProxyType(
    {
        "corners": CornerConfig(),
        "frontier": FrontierConfig(),
        "tour": TourConfig(),
        "informed-tour": INFORMED_TOUR,
        "semexp": SemExpConfig(),
        "poni": PoniConfig(),
    }
)
"""The explorers by name, for `AgentConfig.explorer`: a configuration with `make`, which returns the explorer."""


PLUS = AgentConfig(
    explorer=INFORMED_TOUR,
    seeker=TrackSeekerConfig(),
    feel=FeelConfig(),
    untrap=UntrapConfig(turns_reset=False),  # its traps were measured with it
)
"""`stubborn-plus`: the paper's agent with object tracks. It explores by a tour over the unseen areas. It infers from
collisions the surfaces that depth does not show."""


PRESETS: Mapping[str, tuple[str, AgentConfig]] = MappingProxyType(
    {
        "stubborn": ("the paper's agent, with all four measures against collisions", AgentConfig()),
        **{
            name: (
                f"row {name.removeprefix('stubborn-')} of the paper's ablation: {_ROW_WORDS[name]}",
                AgentConfig(avoidance=row),
            )
            for name, row in ABLATION.items()
        },
        "stubborn-plus": (
            "our agent: tracks and verifies objects, tours unseen areas, feels its way along panes",
            PLUS,
        ),
        "single-frame": (
            "stubborn without verification (--verification none)",
            AgentConfig(seeker=TargetSeekerConfig(verify=False)),
        ),
        "latest-frame": (
            "stubborn without verification and memory: the latest frame decides",
            AgentConfig(seeker=TargetSeekerConfig(verify=False), layers=ObjectLayersConfig(latest_frame_only=True)),
        ),
        "frontier": (
            "goes to the nearest frontier (Yamauchi 1997), without measures against collisions",
            AgentConfig(explorer=FrontierConfig(), avoidance=NO_AVOIDANCE),
        ),
        "frontier-avoid": ("frontier with all measures against collisions", AgentConfig(explorer=FrontierConfig())),
        "semexp": (
            "stubborn with long-term goals from a learned policy (Chaplot et al. 2020)",
            AgentConfig(explorer=SemExpConfig()),
        ),
        "poni": (
            "stubborn that goes to the frontier with the best predicted potential (PONI, 2022)",
            AgentConfig(explorer=PoniConfig()),
        ),
    }
)
"""The agents that build a map: description and configuration of each name. All of them are a `StubbornAgent`."""

SENSORS = ("depth", "imu")
"""What the agents that build a map read; the inertia sensor levels the images of a robot that leans."""

SPECS: Mapping[str, AgentSpec] = MappingProxyType(
    {
        **{
            name: AgentSpec(
                make=StubbornAgent,
                description=description,
                config=config,
                sensors=SENSORS,
                painter=make_painter,
                words=("rgb", "goal"),
                pictures=("rgb", "goal_picture"),
            )
            for name, (description, config) in PRESETS.items()
        },
        "cloned": AgentSpec(
            make=cloned_agent,
            description="a recurrent policy cloned from demonstrations, end to end, without a map",
            config=ClonedConfig(),
            sensors=("depth",),
        ),
        "random": AgentSpec(
            make=random_agent,
            description="random moves and, rarely, a STOP",
            config=RandomConfig(),
            sensors=(),
            uses_segmentation=False,
            words=(),
            pictures=(),
        ),
    }
)
"""All agents that `make` can build."""

NAMES: tuple[str, ...] = tuple(SPECS)
"""Their names."""


def make(
    name: str,
    *,
    camera: CameraModel,
    robot: RobotModel,
    segmenter: Segmenter,
    verifier: Verifier | None = None,
    success: SuccessRule = SuccessRule(),  # noqa: B008 - frozen
    max_steps: int = MAX_STEPS,
    **options: Any,
) -> Agent:
    """Builds an agent by name.

    Args:
        name: one of `NAMES`.
        camera: camera of the observations.
        robot: the robot that the agent drives.
        segmenter: source of the scores.
        verifier: judges candidates (`stubborn.detection.verification`); None accepts all.
        success: the rule by which a STOP counts.
        max_steps: actions of an episode, for agents that take more risk near its end.
        options: fields of `SPECS[name].config`. `explorer` also takes a name of `EXPLORERS`.

    Raises:
        ConfigError: an unknown name, option or explorer.
    """
    spec = SPECS[_known(name, SPECS, "agent")]
    config = spec.config
    allowed = [field.name for field in fields(config)]
    for option in options:
        if option not in allowed:
            raise ConfigError(f"Agent {name!r} has no option {option!r}. It has: {', '.join(allowed)}.")
    if isinstance(options.get("explorer"), str):
        options["explorer"] = EXPLORERS[_known(options["explorer"], EXPLORERS, "explorer")]
    return spec.build(
        name,
        camera=camera,
        robot=robot,
        success=success,
        segmenter=segmenter,
        verifier=verifier,
        config=replace(config, **options),
        max_steps=max_steps,
    )


def _known(name: str, table: Mapping[str, object], kind: str) -> str:
    """Returns the name when it is in the table."""
    if name not in table:
        raise ConfigError(f"No {kind} {name!r}.{did_you_mean(name, table)} Available: {', '.join(table)}.")
    return name
