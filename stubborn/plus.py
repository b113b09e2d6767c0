"""`stubborn-plus`, our agent: the paper's agent with tracks of objects and a tour over what is left to see."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from sim.interface import MAX_STEPS, CameraModel, RobotModel, Segmenter, SuccessRule
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.detection.distances import StopDistances
from stubborn.detection.track_seeker import TrackSeeker, TrackSeekerConfig
from stubborn.detection.verification import Verifier
from stubborn.detection.viewpoints import ViewpointFinder
from stubborn.exploration.explorer import ExplorerConfig
from stubborn.exploration.tour import INFORMED_TOUR
from stubborn.planning.avoidance import collision_policies
from stubborn.planning.planner import Planner


@dataclass(frozen=True, kw_only=True)
class PlusConfig(AgentConfig):
    """All parameters of `stubborn-plus`."""

    explorer: ExplorerConfig = INFORMED_TOUR
    """See `AgentConfig`."""
    seeker: TrackSeekerConfig = field(default_factory=TrackSeekerConfig)
    """Tracks of objects, and the decisions on them."""


def plus_agent(
    *,
    camera: CameraModel,
    robot: RobotModel,
    segmenter: Segmenter,
    config: PlusConfig,
    success: SuccessRule = SuccessRule(),  # noqa: B008 - frozen
    max_steps: int = MAX_STEPS,
    verifier: Verifier | None = None,
    **parts: Any,
) -> StubbornAgent:
    """Returns the agent; see `sim.interface.AgentFactory`. The verifier of the paper's features is not used."""
    policies = collision_policies(config.avoidance, config.untrap)
    distances = StopDistances.of(config.target, success, segmenter.spec)
    planner = Planner(config.planning, policies.proven_ground)
    seeker = TrackSeeker(
        config.seeker,
        config.target,
        camera=camera,
        robot=robot,
        segmenter=segmenter,
        finder=ViewpointFinder(planner, policies.approach, distances, config.target.target_edge_m),
        distances=distances,
        max_steps=max_steps,
    )
    return StubbornAgent(
        camera=camera, robot=robot, segmenter=segmenter, success=success, config=config, seeker=seeker, **parts
    )
