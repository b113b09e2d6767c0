"""Runs the Stubborn agent in a plan: its map comes from the plan's camera, the rest of the agent is unchanged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from sim.core.geometry.pose import Pose
from sim.core.interface import GOAL_CATEGORIES, MAX_STEPS, CameraModel, ConfigError, Observation, RobotModel
from sim.homes.plans.episode import PlanEpisode
from sim.homes.plans.sight import PlanCamera
from stubborn.agent import AgentConfig, StubbornAgent
from stubborn.detection.seeker import TargetSeekerConfig
from stubborn.mapping.mapper import MappingConfig, Sighting, note_sighting
from stubborn.segmentation.ground_truth import GroundTruthSegmenter


class PlanAgent(StubbornAgent):
    """A `StubbornAgent` whose frames are looks in a plan; with ground truth, so that a candidate is the target."""

    def __init__(self, config: AgentConfig, camera: CameraModel | None = None) -> None:
        """Builds the agent; `begin` gives it an episode."""
        self._episode: PlanEpisode | None = None
        super().__init__(
            camera=camera or CameraModel(), robot=RobotModel(), segmenter=GroundTruthSegmenter(), config=config
        )

    def begin(self, episode: PlanEpisode, seed: int) -> None:
        """Starts an episode."""
        self._episode = episode
        self.reset(episode.goal, seed)

    def _map(self, observation: Observation, pose: Pose) -> Sighting:
        """Enters the look from the present pose into the map, and returns the target points in it."""
        assert self._episode is not None
        look = self._episode.camera.look(
            self._episode.robot.pose, self._episode.goal, self.navmap, pose, self.step, self.navmap.goals_seen
        )
        self._episode.see(look)
        if look.touched is not None:
            self.navmap.grow_known(*look.touched)
        whole = self.navmap.frame.part(slice(None), slice(None))
        return note_sighting(self.navmap, whole, look.target_rows, look.target_cols, pose)


def run_episode(
    agent: PlanAgent,
    camera: PlanCamera,
    goal: str,
    start: Pose,
    *,
    seed: int,
    until_sight: bool = False,
    max_steps: int = MAX_STEPS,
) -> Mapping[str, Any]:
    """Runs one episode and returns its metrics, with `end_reason`: `stop`, `sight` or `max_steps`.

    Args:
        agent: the agent; the episode's map remains in it.
        camera: of the plan.
        goal: the goal category.
        start: in the world.
        seed: of the agent.
        until_sight: the episode ends with the first frame that shows the goal, also with that after the last action.
        max_steps: largest number of actions.

    Raises:
        EpisodeError: no STOP for the goal succeeds anywhere in the plan.
    """
    episode = PlanEpisode(camera, goal, start, max_steps=max_steps)
    agent.begin(episode, seed)
    while not episode.done:
        action = agent.act(observation_of(episode))
        if until_sight and episode.first_seen_step is not None:
            break
        episode.act(action)
    if episode.done:
        _look_once_more(agent, episode)
    return {**episode.metrics(), "end_reason": _end_reason(episode, until_sight)}


def _end_reason(episode: PlanEpisode, until_sight: bool) -> str:
    """Returns the reason why an episode of `run_episode` ended."""
    if episode.stopped:
        return "stop"
    return "sight" if until_sight and episode.first_seen_step is not None else "max_steps"


def observation_of(episode: PlanEpisode) -> Observation:
    """Returns the pose sensors and the goal; a plan has no images."""
    pose = episode.pose
    return {
        "gps": np.array([pose.x_m, pose.y_m], np.float32),
        "compass": np.array([pose.yaw_rad], np.float32),
        "objectgoal": np.array([GOAL_CATEGORIES.index(episode.goal)], np.int64),
    }


def _look_once_more(agent: PlanAgent, episode: PlanEpisode) -> None:
    """Counts the frame after the last action, which no agent sees."""
    look = episode.camera.look(episode.robot.pose, episode.goal, agent.navmap, episode.pose, episode.num_steps)
    episode.see(look)


def plan_agent_config(config: AgentConfig) -> AgentConfig:
    """Returns the configuration without what a plan has no data for: drops of the floor.

    Raises:
        ConfigError: another setting of `mapping` is changed, which the camera of a plan (`SightConfig`) does not read,
            or the seeker reads images.
    """
    if not isinstance(config.seeker, TargetSeekerConfig):
        raise ConfigError("The twin has no images, which the agent's seeker reads; give it agent.seeker of stubborn.")
    default = MappingConfig(drops=config.mapping.drops, candidate_score=config.mapping.candidate_score)
    changed = [field.name for field in fields(default) if vars(config.mapping)[field.name] != vars(default)[field.name]]
    if changed:
        raise ConfigError(f"The twin has a camera of its own, without the agent's mapping.{changed[0]}.")
    return replace(config, mapping=replace(config.mapping, drops=replace(config.mapping.drops, enabled=False)))
